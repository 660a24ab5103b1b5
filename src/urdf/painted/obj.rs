//! Wavefront OBJ with its material libraries → painted triangles.
//!
//! Of a material the diffuse colour `Kd` and the texture `map_Kd` are read.

use super::super::faces::{
    Image, MeshError, Paint, Part, Parts, fan, obj_lines, three, vertex_index,
};
use std::collections::HashMap;

/// The painted triangles of an OBJ text; `library` gives the text of a material library.
pub(super) fn parts(
    text: &str,
    library: impl Fn(&str) -> Option<String>,
) -> Result<Vec<Part>, MeshError> {
    let mut parts = Parts::default();
    let mut materials = HashMap::new();
    let (mut positions, mut uvs) = (Vec::new(), Vec::new());
    let mut paint = Paint::default();
    let (mut corners, mut uv_corners) = (Vec::new(), Vec::new());
    for (number, line) in obj_lines(text) {
        let problem = |what: String| MeshError::Line { line: number, what };
        let line = line.trim();
        let (keyword, rest) = line
            .split_once(char::is_whitespace)
            .map_or((line, ""), |(keyword, rest)| (keyword, rest.trim()));
        let mut words = rest.split_whitespace();
        match keyword {
            "v" => positions.push(three(&mut words).map_err(problem)?),
            "vt" => {
                let mut number = || words.next().and_then(|word| word.parse().ok());
                uvs.push([number().unwrap_or(0.0), number().unwrap_or(0.0)]);
            }
            "mtllib" => {
                // A name may hold spaces, or several names may stand in a line.
                let texts: Vec<String> = match library(rest) {
                    Some(text) => vec![text],
                    None => words.filter_map(&library).collect(),
                };
                for text in texts {
                    read_library(&text, &mut materials);
                }
            }
            "usemtl" => paint = materials.get(rest).cloned().unwrap_or_default(),
            "f" => {
                corners.clear();
                uv_corners.clear();
                for word in words.take_while(|word| !word.starts_with('#')) {
                    let mut indices = word.split('/');
                    let word = indices.next().unwrap_or_default();
                    let index = vertex_index(word, positions.len())
                        .ok_or_else(|| problem(format!("there is no vertex '{word}' yet")))?;
                    corners.push(positions[index]);
                    let uv = indices
                        .next()
                        .and_then(|word| vertex_index(word, uvs.len()));
                    uv_corners.extend(uv.map(|index| uvs[index]));
                }
                let textured = uv_corners.len() == corners.len();
                let part = parts.of(&paint, textured);
                let mut uv = fan(&uv_corners);
                for triangle in fan(&corners) {
                    part.push(triangle, uv.next().filter(|_| textured));
                }
            }
            _ => {}
        }
    }
    parts.finish()
}

fn read_library(text: &str, materials: &mut HashMap<String, Paint>) {
    let mut current: Option<&mut Paint> = None;
    for (_, line) in obj_lines(text) {
        let line = line.trim();
        let Some((keyword, rest)) = line.split_once(char::is_whitespace) else {
            continue;
        };
        let rest = rest.trim();
        match (keyword, &mut current) {
            ("newmtl", _) => {
                let paint = materials.entry(rest.to_owned()).or_default();
                *paint = Paint::default();
                current = Some(paint);
            }
            ("Kd", Some(paint)) => {
                let numbers: Vec<f64> = rest
                    .split_whitespace()
                    .map_while(|word| word.parse().ok())
                    .filter(|x: &f64| x.is_finite())
                    .map(|x| x.clamp(0.0, 1.0))
                    .collect();
                // One number is a grey.
                paint.color = match numbers[..] {
                    [grey] => Some([grey; 3]),
                    [red, green, blue, ..] => Some([red, green, blue]),
                    _ => None,
                };
            }
            ("map_Kd", Some(paint)) => paint.image = texture_name(rest).map(Image::Named),
            _ => {}
        }
    }
}

/// The file name behind the options of a texture map, such as `-s 1 1 1` or `-clamp on`.
fn texture_name(rest: &str) -> Option<String> {
    let mut rest = rest.trim();
    while rest.starts_with('-') {
        let (option, values) = rest.split_once(char::is_whitespace)?;
        rest = values.trim_start();
        let numeric = matches!(option, "-o" | "-s" | "-t");
        let fixed = match option {
            "-mm" => 2,
            "-o" | "-s" | "-t" => 3,
            _ => 1,
        };
        for _ in 0..fixed {
            let Some((word, behind)) = rest.split_once(char::is_whitespace) else {
                break;
            };
            // Of three numbers the later ones may be left out.
            if numeric && word.parse::<f64>().is_err() {
                break;
            }
            rest = behind.trim_start();
        }
    }
    (!rest.is_empty()).then(|| rest.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    const MATERIALS: &str = "newmtl red\nKd 1 0 0\nnewmtl  wood grain \nKd 0.5 0.5 0.5\n\
                             map_Kd -s 1 1 1 -clamp on my wood.png\n";

    fn read(text: &str) -> Vec<Part> {
        let library = |name: &str| (name == "my mats.mtl").then(|| MATERIALS.to_owned());
        parts(text, library).expect("an OBJ text")
    }

    #[test]
    fn faces_are_sorted_by_colour_and_texture() {
        let parts = read(
            "mtllib my mats.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
             f 1 2 3\nusemtl wood grain\nf 1/1 2/2 3/3 4/4\nusemtl red\nf 1 2 3\nusemtl wood grain\nf 1 3 4\n",
        );
        let found: Vec<_> = parts
            .iter()
            .map(|p| {
                let image = p.paint.image.as_ref().map(|image| match image {
                    Image::Named(name) => name.as_str(),
                    Image::Held(_) => "held",
                });
                (p.paint.color, image, p.triangles.len(), p.uv.len())
            })
            .collect();
        assert_eq!(
            found,
            [
                (None, None, 1, 0),
                (Some([0.5; 3]), Some("my wood.png"), 2, 2),
                (Some([1.0, 0.0, 0.0]), None, 1, 0),
                // Without texture coordinates there is the colour alone.
                (Some([0.5; 3]), None, 1, 0),
            ]
        );
        assert_eq!(parts[1].uv[1], [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    }

    #[test]
    fn a_library_that_is_not_there_leaves_the_shape() {
        let parts = read("mtllib gone.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n");
        assert_eq!(parts.len(), 1);
        assert_eq!(parts[0].paint, Paint::default());
    }
}
