//! What the readers of mesh files share: their errors, polygons cut into triangles, and triangles
//! sorted by what they are painted with.

use crate::spatial::Vec3;
use std::borrow::Cow;
use std::sync::Arc;

/// Mesh files larger than this, in bytes, are refused. Five million triangles.
pub(super) const LARGEST_FILE: u64 = 256 << 20;

/// What a text in UTF-8 may begin with.
pub(super) const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Most objects of a file that have hulls of their own: decompositions have 64 or fewer by default,
/// those of `pybullet_data` up to 127, and a contact is looked for between all of them.
pub(super) const MOST_OBJECTS: usize = 128;

/// What a file starts with that Git LFS keeps elsewhere.
pub const LFS_POINTER: &[u8] = b"version https://git-lfs.github.com/";

/// The formats that are read, for people.
pub(super) const FORMATS: &str = "STL, OBJ, PLY, COLLADA and glTF (.glb, .gltf)";

/// Why a mesh cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(super) enum MeshError {
    #[error("the file cannot be read: {0}")]
    Io(String),
    #[error("the file has {0} bytes, more than the {LARGEST_FILE} that are read")]
    TooLarge(u64),
    #[error("it is a pointer of Git LFS, not the mesh itself")]
    Pointer,
    #[error("it is {0}, not the mesh itself")]
    Other(&'static str),
    #[error("the file is empty")]
    Empty,
    #[error("'{0}' files are not read; {FORMATS} are")]
    Format(String),
    #[error("its name has no ending, which tells the format; {FORMATS} are read")]
    NoFormat,
    #[error(
        "the file is cut short: {expected} bytes for {triangles} triangles, but it has {found}"
    )]
    Truncated {
        triangles: u32,
        expected: u64,
        found: u64,
    },
    #[error("its count says {triangles} triangles, but the file has {found}")]
    Miscounted { triangles: u32, found: u64 },
    #[error("the file is cut short: it ends within a facet")]
    Unfinished,
    #[error("line {line}: {what}")]
    Line { line: usize, what: String },
    #[error("neither ASCII nor binary STL")]
    NotStl,
    #[error("it begins as a .{0} file does")]
    Misnamed(&'static str),
    #[error("{0}")]
    Collada(String),
    #[error("{0}")]
    Content(String),
    #[error("there is no face in it")]
    NoFaces,
    #[error("a coordinate is not finite")]
    NotFinite,
}

impl MeshError {
    /// What to do.
    pub(super) fn help(&self) -> String {
        match self {
            Self::Io(_) => "name a file that can be read".to_owned(),
            Self::Pointer => {
                "fetch the files where the robot was cloned: git lfs install && git lfs pull"
                    .to_owned()
            }
            Self::Misnamed(kind) => format!("end its name with .{kind}, in the URDF, too"),
            Self::Other(UTF_16) => "save it as UTF-8, or export the mesh again".to_owned(),
            Self::Other(_) => "put the mesh itself there".to_owned(),
            Self::NoFormat => "give the file its ending".to_owned(),
            Self::Truncated { .. } | Self::Miscounted { .. } | Self::Unfinished | Self::Empty => {
                "copy or export the mesh again: it is not whole".to_owned()
            }
            Self::Line { .. } | Self::Collada(_) | Self::Content(_) | Self::NotFinite => {
                format!("correct what is named, or export the mesh again; {FORMATS} are read")
            }
            Self::TooLarge(_) => "export the mesh with fewer triangles".to_owned(),
            Self::NoFaces => "export the mesh with triangles; points and lines are none".to_owned(),
            Self::Format(_) | Self::NotStl => {
                format!("export the mesh again; {FORMATS} are read")
            }
        }
    }
}

/// What [`other_kind`] calls a text of two bytes a letter.
const UTF_16: &str = "text in UTF-16";

/// What is wrong with a word in the place of a number.
pub(super) fn no_number(word: &str) -> String {
    let point = word.replace(',', ".").parse::<f64>().is_ok();
    let why = if point {
        ": the decimal sign is a point"
    } else {
        ""
    };
    format!("'{word}' is not a number{why}")
}

/// What a file is that stands in the place of a mesh, by its first bytes.
pub(super) fn other_kind(bytes: &[u8]) -> Option<&'static str> {
    let text = bytes
        .strip_prefix(BYTE_ORDER_MARK)
        .unwrap_or(bytes)
        .trim_ascii_start();
    let starts = |with: &str| {
        let start = text.get(..with.len());
        start.is_some_and(|start| start.eq_ignore_ascii_case(with.as_bytes()))
    };
    if starts("<!doctype html") || starts("<html") {
        Some("a web page")
    } else if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"\x1f\x8b") {
        Some("a compressed file")
    } else if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        Some(UTF_16)
    } else {
        None
    }
}

/// Of which format a mesh is, by its first bytes, where its name has the ending of another one that
/// cannot begin so.
pub(super) fn misnamed(kind: &str, bytes: &[u8]) -> Option<&'static str> {
    let text = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    let count = text.get(80..84).and_then(|count| count.try_into().ok());
    let triangles = count.map_or(0, u32::from_le_bytes);
    let stl = triangles > 0 && text.len() as u64 == 84 + 50 * u64::from(triangles);
    let own = match text.trim_ascii_start() {
        text if text.starts_with(b"ply\n") || text.starts_with(b"ply\r\n") => "ply",
        text if text.starts_with(b"glTF") => "glb",
        text if text.starts_with(b"<?xml") || text.starts_with(b"<COLLADA") => "dae",
        text if text.starts_with(b"v ") || text.starts_with(b"mtllib ") => "obj",
        text if kind != "obj" && text.starts_with(b"solid") => "stl",
        _ if stl => "stl",
        _ => return None,
    };
    (own != kind).then_some(own)
}

/// The lines of an OBJ text or of its materials with their numbers: a line that ends with a
/// backslash goes on in the next one.
pub(super) fn obj_lines(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text.lines().zip(1..);
    std::iter::from_fn(move || {
        let (first, number) = lines.next()?;
        let Some(begun) = first.trim_end().strip_suffix('\\') else {
            return Some((number, Cow::Borrowed(first)));
        };
        let mut whole = begun.to_owned();
        for (next, _) in lines.by_ref() {
            whole.push(' ');
            let Some(more) = next.trim_end().strip_suffix('\\') else {
                whole.push_str(next);
                break;
            };
            whole.push_str(more);
        }
        Some((number, Cow::Owned(whole)))
    })
}

/// The next three words as the coordinates of a point.
pub(super) fn three<'w>(words: &mut impl Iterator<Item = &'w str>) -> Result<Vec3, String> {
    let mut point = Vec3::zeros();
    for coordinate in point.iter_mut() {
        let word = words.next().ok_or("three numbers are needed")?;
        *coordinate = word.parse().map_err(|_| no_number(word))?;
    }
    Ok(point)
}

/// OBJ counts from 1, or backwards from -1.
pub(super) fn vertex_index(word: &str, count: usize) -> Option<usize> {
    let index: i64 = word.parse().ok()?;
    let count = i64::try_from(count).ok()?;
    let index = if index < 0 { count + index } else { index - 1 };
    (0..count)
        .contains(&index)
        .then(|| usize::try_from(index).ok())?
}

/// Triangles with factors on their coordinates.
pub(super) fn scaled(triangles: &[[Vec3; 3]], factors: &Vec3) -> Vec<[Vec3; 3]> {
    let scaled = |p: Vec3| p.component_mul(factors);
    triangles.iter().map(|t| t.map(scaled)).collect()
}

/// Triangles from the first corner of a polygon to its other sides.
pub(super) fn fan<T: Copy>(corners: &[T]) -> impl Iterator<Item = [T; 3]> + '_ {
    let sides = corners.get(1..).unwrap_or_default().windows(2);
    sides.map(|side| [corners[0], side[0], side[1]])
}

/// What a reader shows each face: all vertices so far, and the indices of its corners among them.
type Face<'a> = dyn FnMut(&[Vec3], &[usize]) + 'a;

/// Vertices that a face names; all of them where there is no face.
///
/// - `read`: gives all vertices, and shows each face on the way
pub(super) fn named(
    read: impl FnOnce(&mut Face) -> Result<Vec<Vec3>, MeshError>,
) -> Result<Vec<Vec3>, MeshError> {
    let mut used: Vec<bool> = Vec::new();
    let mut vertices = read(&mut |vertices, corners| {
        used.resize(vertices.len(), false);
        for &corner in corners {
            used[corner] = true;
        }
    })?;
    if used.contains(&true) {
        // None names what comes after the last face.
        let mut used = used.into_iter();
        vertices.retain(|_| used.next() == Some(true));
    }
    Ok(vertices)
}

/// All faces, cut into triangles; `read` as in [`named`].
pub(super) fn triangles(
    read: impl FnOnce(&mut Face) -> Result<Vec<Vec3>, MeshError>,
) -> Result<Vec<[Vec3; 3]>, MeshError> {
    let (mut triangles, mut polygon) = (Vec::new(), Vec::new());
    read(&mut |vertices, corners| {
        polygon.clear();
        polygon.extend(corners.iter().map(|&corner| vertices[corner]));
        triangles.extend(fan(&polygon));
    })?;
    Ok(triangles)
}

/// What triangles are painted with.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Paint {
    /// Red, green, blue, each 0 … 1.
    pub(super) color: Option<[f64; 3]>,
    pub(super) image: Option<Image>,
    /// What the image is multiplied by, likewise; none for white.
    pub(super) tint: Option<[f64; 3]>,
}

/// The image of a texture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Image {
    /// Name of its file, as the mesh has it.
    Named(String),
    /// Content of an image file, which the mesh's file holds.
    Held(Arc<[u8]>),
}

/// Triangles that are painted alike.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Part {
    pub(super) paint: Paint,
    /// Corners in the order in which triangles first have them, some of them several times.
    pub(super) corners: Vec<Vec3>,
    /// Places in `corners`: a reader that knows which triangles share a corner keeps it only once,
    /// because most of the time of a large mesh goes into memory.
    pub(super) triangles: Vec<[u32; 3]>,
    /// One for each triangle or none at all; (0, 0) is the lower left corner of the texture.
    pub(super) uv: Vec<[[f64; 2]; 3]>,
}

impl Part {
    /// Adds a triangle; `uv` is there where [`Parts::of`] was told so.
    pub(super) fn push(&mut self, triangle: [Vec3; 3], uv: Option<[[f64; 2]; 3]>) {
        let first = place(self.corners.len());
        self.corners.extend(triangle);
        self.triangles.push([first, first + 1, first + 2]);
        if self.paint.image.is_some() {
            self.uv.push(uv.unwrap_or_default());
        }
    }

    /// The corners of each triangle.
    #[cfg(test)]
    pub(super) fn whole(&self) -> Vec<[Vec3; 3]> {
        let corner = |i: u32| self.corners[i as usize];
        self.triangles.iter().map(|t| t.map(corner)).collect()
    }
}

/// A place in a list that is far shorter than a u32 can count.
pub(super) fn place(i: usize) -> u32 {
    u32::try_from(i).unwrap_or(u32::MAX)
}

/// Parts, each paint once, in the order in which they were first used.
#[derive(Default)]
pub(super) struct Parts {
    list: Vec<Part>,
    /// Faces of one paint follow each other.
    last: usize,
}

impl Parts {
    /// The triangles with this paint; without texture coordinates there is no texture.
    pub(super) fn of(&mut self, paint: &Paint, textured: bool) -> &mut Part {
        let image = paint.image.as_ref().filter(|_| textured);
        let tint = paint.tint.filter(|_| image.is_some());
        let same = |part: &Part| {
            let known = &part.paint;
            known.color == paint.color && known.image.as_ref() == image && known.tint == tint
        };
        if !self.list.get(self.last).is_some_and(same) {
            self.last = self.list.iter().position(same).unwrap_or(self.list.len());
        }
        if self.last == self.list.len() {
            let paint = Paint {
                color: paint.color,
                image: image.cloned(),
                tint,
            };
            self.list.push(Part {
                paint,
                ..Part::default()
            });
        }
        &mut self.list[self.last]
    }

    /// Those with triangles; corners that are not finite are refused.
    pub(super) fn finish(mut self) -> Result<Vec<Part>, MeshError> {
        self.list.retain(|part| !part.triangles.is_empty());
        if self.list.is_empty() {
            return Err(MeshError::NoFaces);
        }
        let finite = |p: &Vec3| p.iter().all(|x| x.is_finite());
        if !self.list.iter().all(|part| part.corners.iter().all(finite)) {
            return Err(MeshError::NotFinite);
        }
        for part in &mut self.list {
            for x in part.uv.iter_mut().flatten().flatten() {
                if !x.is_finite() {
                    *x = 0.0;
                }
            }
        }
        Ok(self.list)
    }
}
