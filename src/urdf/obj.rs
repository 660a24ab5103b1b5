//! OBJ text → points and triangles, all of them or by object.

use super::faces::{self, MOST_OBJECTS, MeshError, fan, obj_lines, three, vertex_index};
use crate::spatial::Vec3;
use std::cell::Cell;

/// Vertices that a face names; all of them where there is no face.
pub(super) fn corners(text: &str) -> Result<Vec<Vec3>, MeshError> {
    faces::named(|face| each_face(text, face))
}

/// Faces of a file that [`corners`] has read.
pub(super) fn triangles(text: &str) -> Result<Vec<[Vec3; 3]>, MeshError> {
    faces::triangles(|face| each_face(text, face))
}

/// [`records`] without its names.
fn each_face(text: &str, face: impl FnMut(&[Vec3], &[usize])) -> Result<Vec<Vec3>, MeshError> {
    records(text, |_| {}, face)
}

/// All vertices; shows each face with the vertices before it and the indices of its corners among
/// them, and the word of each line that names an object (`o`) or a group (`g`).
fn records(
    text: &str,
    mut begin: impl FnMut(&str),
    mut face: impl FnMut(&[Vec3], &[usize]),
) -> Result<Vec<Vec3>, MeshError> {
    let (mut vertices, mut corners) = (Vec::new(), Vec::new());
    for (number, line) in obj_lines(text) {
        let problem = |what: String| MeshError::Line { line: number, what };
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => vertices.push(three(&mut words).map_err(problem)?),
            Some("f") => {
                corners.clear();
                for corner in words.take_while(|word| !word.starts_with('#')) {
                    let word = corner.split('/').next().unwrap_or(corner);
                    let index = vertex_index(word, vertices.len())
                        .ok_or_else(|| problem(format!("there is no vertex '{word}' yet")))?;
                    corners.push(index);
                }
                face(&vertices, &corners);
            }
            Some(word @ ("o" | "g")) => begin(word),
            _ => {}
        }
    }
    Ok(vertices)
}

/// The triangles of each object: what follows a line `o`, or `g` in a text that has no `o`. What
/// comes after more of them than are of use is in the last one.
pub(super) fn objects(text: &str) -> Result<Vec<Vec<[Vec3; 3]>>, MeshError> {
    let count = |word: &str| {
        let lines = obj_lines(text);
        lines
            .filter(|(_, line)| first_word(line) == Some(word))
            .count()
    };
    let word = if count("o") > 0 { "o" } else { "g" };
    if count(word) < 2 {
        return Ok(Vec::new());
    }
    let begun = Cell::new(true);
    let mut list: Vec<Vec<[Vec3; 3]>> = Vec::new();
    let mut polygon = Vec::new();
    records(
        text,
        |found| begun.set(begun.get() || found == word),
        |vertices, corners| {
            if begun.replace(false) && list.len() <= MOST_OBJECTS {
                list.push(Vec::new());
            }
            polygon.clear();
            polygon.extend(corners.iter().map(|&corner| vertices[corner]));
            list.last_mut()
                .into_iter()
                .for_each(|own| own.extend(fan(&polygon)));
        },
    )?;
    Ok(list)
}

fn first_word(line: &str) -> Option<&str> {
    line.split_whitespace().next()
}
