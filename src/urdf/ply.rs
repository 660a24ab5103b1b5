//! PLY → points and triangles: text, and binary of both byte orders.
//!
//! Of the element `vertex` the properties `x`, `y` and `z` are read, of `face` the list
//! `vertex_indices`; everything else is skipped. Coordinates are in m, as the file has them.
//!
//! Source: Greg Turk, "The PLY polygon file format", 1994.

use super::faces::{self, MeshError};
use crate::spatial::Vec3;

/// Most elements, and most properties of one: meshes have two elements and a dozen properties.
const MOST_PROPERTIES: usize = 256;

/// Corners that faces name; all vertices where there is no face.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<Vec3>, MeshError> {
    faces::named(|face| read_faces(bytes, face))
}

/// All faces, cut into triangles.
pub(super) fn triangles(bytes: &[u8]) -> Result<Vec<[Vec3; 3]>, MeshError> {
    faces::triangles(|face| read_faces(bytes, face))
}

fn problem(what: impl Into<String>) -> MeshError {
    MeshError::Content(what.into())
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    Text,
    Little,
    Big,
}

/// Number types: bytes, and how they are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Number {
    fn named(word: &str) -> Option<Self> {
        Some(match word {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The number in as many little-endian bytes as [`Number::size`] says.
    fn of(self, bytes: [u8; 8]) -> f64 {
        let [a, b, c, d, ..] = bytes;
        match self {
            Self::I8 => f64::from(i8::from_le_bytes([a])),
            Self::U8 => f64::from(a),
            Self::I16 => f64::from(i16::from_le_bytes([a, b])),
            Self::U16 => f64::from(u16::from_le_bytes([a, b])),
            Self::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Self::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Self::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Self::F64 => f64::from_le_bytes(bytes),
        }
    }
}

struct Property<'d> {
    name: &'d str,
    /// Of the number of entries, where the property is a list.
    count: Option<Number>,
    kind: Number,
}

struct Element<'d> {
    name: &'d str,
    count: u64,
    properties: Vec<Property<'d>>,
}

/// The lines up to `end_header`, and what comes after them.
fn header(bytes: &[u8]) -> Result<(Encoding, Vec<Element<'_>>, &[u8]), MeshError> {
    let mut rest = bytes;
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut first = true;
    loop {
        let end = rest.iter().position(|&byte| byte == b'\n');
        let end = end.ok_or_else(|| problem("the header has no end"))?;
        let line = std::str::from_utf8(&rest[..end]).map_err(|_| problem("no PLY file"))?;
        rest = &rest[end + 1..];
        let words: Vec<&str> = line.split_whitespace().collect();
        let wrong = || problem(format!("'{}' is no line of a PLY header", line.trim()));
        if first {
            if words[..] != ["ply"] {
                return Err(problem("no PLY file"));
            }
            first = false;
            continue;
        }
        match words[..] {
            ["format", "ascii", _] => encoding = Some(Encoding::Text),
            ["format", "binary_little_endian", _] => encoding = Some(Encoding::Little),
            ["format", "binary_big_endian", _] => encoding = Some(Encoding::Big),
            ["element", name, count] if elements.len() < MOST_PROPERTIES => {
                elements.push(Element {
                    name,
                    count: count.parse().map_err(|_| wrong())?,
                    properties: Vec::new(),
                });
            }
            ["property", ref property @ ..] => {
                let (name, count, kind) = match *property {
                    ["list", count, kind, name] => (name, Some(count), kind),
                    [kind, name] => (name, None, kind),
                    _ => return Err(wrong()),
                };
                let count = count.map(|word| Number::named(word).ok_or_else(wrong));
                let kind = Number::named(kind).ok_or_else(wrong)?;
                let element = elements.last_mut().ok_or_else(wrong)?;
                if element.properties.len() == MOST_PROPERTIES {
                    return Err(wrong());
                }
                let count = count.transpose()?;
                element.properties.push(Property { name, count, kind });
            }
            ["end_header"] => break,
            [] | ["comment" | "obj_info", ..] => {}
            _ => return Err(wrong()),
        }
    }
    let encoding = encoding.ok_or_else(|| problem("the header names no format"))?;
    Ok((encoding, elements, rest))
}

/// The numbers behind the header, one after the other.
struct Body<'d> {
    encoding: Encoding,
    rest: &'d [u8],
}

impl Body<'_> {
    fn next(&mut self, kind: Number) -> Result<f64, MeshError> {
        let cut = || problem("the file is cut short");
        if self.encoding == Encoding::Text {
            self.rest = self.rest.trim_ascii_start();
            let end = self.rest.iter().position(u8::is_ascii_whitespace);
            let (word, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
            self.rest = rest;
            if word.is_empty() {
                return Err(cut());
            }
            let word = String::from_utf8_lossy(word);
            let number = word.parse();
            return number.map_err(|_| problem(faces::no_number(&word)));
        }
        let size = kind.size();
        let (number, rest) = self.rest.split_at_checked(size).ok_or_else(cut)?;
        self.rest = rest;
        let mut bytes = [0; 8];
        bytes[..size].copy_from_slice(number);
        if self.encoding == Encoding::Big {
            bytes[..size].reverse();
        }
        Ok(kind.of(bytes))
    }

    /// A whole number that is no more than what is left of the file.
    fn length(&mut self, kind: Number) -> Result<usize, MeshError> {
        let count = self.next(kind)?;
        whole(count)
            .filter(|&count| count <= self.rest.len())
            .ok_or_else(|| problem(format!("a list of {count} numbers")))
    }
}

/// A number that counts something.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "in range and whole"
)]
fn whole(number: f64) -> Option<usize> {
    let legal = (0.0..=f64::from(u32::MAX)).contains(&number)
        && libm::trunc(number).to_bits() == number.to_bits();
    legal.then_some(number as usize)
}

/// All vertices; shows each face with them and the indices of its corners.
fn read_faces(
    bytes: &[u8],
    mut face: impl FnMut(&[Vec3], &[usize]),
) -> Result<Vec<Vec3>, MeshError> {
    let (encoding, elements, rest) = header(bytes)?;
    let mut body = Body { encoding, rest };
    let mut vertices: Vec<Vec3> = Vec::new();
    let mut corners: Vec<usize> = Vec::new();
    for element in &elements {
        // An element without properties takes no bytes, so its count says nothing.
        let count = if element.properties.is_empty() {
            0
        } else {
            element.count
        };
        let vertex = element.name == "vertex";
        let axis = |name: &str| ["x", "y", "z"].iter().position(|&axis| axis == name);
        let axes = element.properties.iter().filter_map(|p| axis(p.name));
        if vertex && axes.count() != 3 {
            return Err(problem("the vertices have no x, y and z"));
        }
        for _ in 0..count {
            let mut point = Vec3::zeros();
            corners.clear();
            let mut named = false;
            for property in &element.properties {
                let Some(length) = property.count else {
                    let number = body.next(property.kind)?;
                    if let (true, Some(axis)) = (vertex, axis(property.name)) {
                        point[axis] = number;
                    }
                    continue;
                };
                let indices = element.name == "face"
                    && ["vertex_indices", "vertex_index"].contains(&property.name);
                for _ in 0..body.length(length)? {
                    let number = body.next(property.kind)?;
                    if indices {
                        let index = whole(number).filter(|&index| index < vertices.len());
                        let index =
                            index.ok_or_else(|| problem(format!("there is no vertex {number}")))?;
                        corners.push(index);
                    }
                }
                named |= indices;
            }
            if vertex {
                vertices.push(point);
            } else if named {
                face(&vertices, &corners);
            }
        }
    }
    Ok(vertices)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "comment a\nelement vertex 4\nproperty float x\nproperty double y\n\
                          property short z\nproperty uchar red\nelement face 2\n\
                          property list uchar int vertex_indices\nproperty list uint8 float w\n";

    fn text(body: &str) -> Vec<u8> {
        format!("ply\nformat ascii 1.0\n{HEADER}end_header\n{body}").into_bytes()
    }

    const BODY: &str = "0 0 0 255\n1 0 0 1\n1 2 0 2\n9 9 9 0\n3 0 1 2 0\n3 0 2 1 2 0.5 1\n";

    /// The same as [`BODY`], in bytes.
    fn binary(big: bool) -> Vec<u8> {
        let kind = if big { "big" } else { "little" };
        let mut bytes =
            format!("ply\r\nformat binary_{kind}_endian 1.0\r\n{HEADER}end_header\n").into_bytes();
        let mut put = |mut number: Vec<u8>| {
            if big {
                number.reverse();
            }
            bytes.extend(number);
        };
        for (x, y, z, red) in [
            (0_f32, 0_f64, 0_i16, 255_u8),
            (1.0, 0.0, 0, 1),
            (1.0, 2.0, 0, 2),
            (9.0, 9.0, 9, 0),
        ] {
            put(x.to_le_bytes().to_vec());
            put(y.to_le_bytes().to_vec());
            put(z.to_le_bytes().to_vec());
            put(vec![red]);
        }
        for (corners, weights) in [([0_i32, 1, 2], &[][..]), ([0, 2, 1], &[0.5_f32, 1.0])] {
            put(vec![3]);
            for corner in corners {
                put(corner.to_le_bytes().to_vec());
            }
            put(vec![u8::try_from(weights.len()).expect("few")]);
            for weight in weights {
                put(weight.to_le_bytes().to_vec());
            }
        }
        bytes
    }

    #[test]
    fn text_and_both_byte_orders_give_the_corners_of_faces() {
        let expected = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0]].map(Vec3::from);
        let [a, b, c] = expected;
        for bytes in [text(BODY), binary(false), binary(true)] {
            assert_eq!(read(&bytes), Ok(expected.to_vec()));
            assert_eq!(triangles(&bytes), Ok(vec![[a, b, c], [a, c, b]]));
            // Cut anywhere, it is refused or has the vertices that it says.
            for end in 0..bytes.len() - 1 {
                if let Ok(points) = read(&bytes[..end]) {
                    assert_eq!(points.len(), 3, "{end}");
                }
            }
        }
    }

    #[test]
    fn a_cloud_of_points_is_taken_whole() {
        let cloud = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n\
                     property float z\nend_header\n1 2 3\n4 5 6\n";
        let points = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]].map(Vec3::from);
        assert_eq!(read(cloud.as_bytes()), Ok(points.to_vec()));
    }

    #[test]
    fn faults_are_told() {
        for (from, to, what) in [
            ("ply", "plx", "no PLY file"),
            ("ascii", "packed", "'format packed 1.0' is no line"),
            ("short", "half", "'property half z' is no line"),
            ("float x", "float u", "no x, y and z"),
            ("element vertex 4", "element vertex x", "is no line"),
            ("9 9 9 0", "9 nine 9 0", "'nine' is not a number"),
            ("3 0 1 2 0", "3 0 1 7 0", "there is no vertex 7"),
            ("3 0 1 2 0", "-3 0 1 2 0", "a list of -3 numbers"),
            ("3 0 2 1 2 0.5 1", "3 0 2", "cut short"),
            ("end_header", "end", "is no line"),
        ] {
            let whole = String::from_utf8(text(BODY)).expect("text");
            let broken = whole.replacen(from, to, 1);
            assert_ne!(broken, whole);
            let told = read(broken.as_bytes()).expect_err(from).to_string();
            assert!(told.contains(what), "{told}");
        }
    }
}
