//! Mesh files → points: STL, OBJ, PLY, COLLADA, glTF.
//!
//! Only the corners of faces are kept: the collision shape is their convex hull. Own readers for
//! the two plain formats, a page each: `stl_io` takes binary files that start with `solid` for text
//! and refuses text that is not laid out line by line as it expects; both happen.

use super::faces::{
    BYTE_ORDER_MARK, LARGEST_FILE, LFS_POINTER, MeshError, misnamed, other_kind, three,
};
use super::{collada, gltf, obj, ply};
use crate::reading;
use crate::spatial::Vec3;
use std::ffi::OsStr;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Endings of the formats that are read.
const KINDS: [&str; 6] = ["stl", "obj", "ply", "dae", "glb", "gltf"];

/// The ending of a mesh's name in small letters, where it is none of a format that is read.
pub(super) fn unread_kind(name: &str) -> Option<String> {
    let kind = Path::new(name).extension()?.to_string_lossy();
    let kind = kind.to_ascii_lowercase();
    (!KINDS.contains(&kind.as_str())).then_some(kind)
}

/// Whether a mesh never names other files that its corners and triangles need.
pub(super) fn stands_alone(path: &Path) -> bool {
    let kind = path.extension().map(OsStr::to_ascii_lowercase);
    kind.is_some_and(|kind| {
        ["stl", "obj", "ply", "dae"]
            .iter()
            .any(|known| kind == *known)
    })
}

/// Bytes of a file, to begin with the largest.
pub(super) fn size(path: &Path) -> usize {
    let bytes = path.metadata().map_or(0, |file| file.len());
    usize::try_from(bytes).unwrap_or(usize::MAX)
}

/// A mesh file's bytes, read once for all that is asked of them.
pub(super) struct MeshFile {
    /// The name's ending in small letters: a format that is read.
    kind: String,
    bytes: Vec<u8>,
    /// Of COLLADA.
    known: collada::Known,
    gltf: Option<gltf::File>,
    /// Files that it names and needs.
    beside: Vec<PathBuf>,
}

impl MeshFile {
    /// - `beside`: where a file is that the mesh names, `None` where it cannot be had
    pub(super) fn open(
        path: &Path,
        beside: &dyn Fn(&str) -> Option<PathBuf>,
    ) -> Result<Self, MeshError> {
        let kind = path
            .extension()
            .map(|e| e.to_string_lossy().to_ascii_lowercase())
            .unwrap_or_default();
        if kind.is_empty() {
            return Err(MeshError::NoFormat);
        }
        if !KINDS.contains(&kind.as_str()) {
            return Err(MeshError::Format(format!(".{kind}")));
        }
        let own = bytes(path)?;
        if own.is_empty() {
            return Err(MeshError::Empty);
        }
        if own.starts_with(LFS_POINTER) {
            return Err(MeshError::Pointer);
        }
        if let Some(what) = other_kind(&own) {
            return Err(MeshError::Other(what));
        }
        if let Some(own) = misnamed(&kind, &own) {
            return Err(MeshError::Misnamed(own));
        }
        let mut used = Vec::new();
        let mut file = Self::made(kind, own, |name| {
            let path = beside(name)?;
            let content = bytes(&path);
            used.push(path);
            Some(content)
        })?;
        file.beside = used;
        Ok(file)
    }

    /// A file without others beside it.
    pub(super) fn of(kind: &str, bytes: &[u8]) -> Result<Self, MeshError> {
        Self::made(kind.to_owned(), bytes.to_vec(), |_| None)
    }

    fn made(
        kind: String,
        mut bytes: Vec<u8>,
        beside: impl FnMut(&str) -> Option<Result<Vec<u8>, MeshError>>,
    ) -> Result<Self, MeshError> {
        if bytes.starts_with(BYTE_ORDER_MARK) {
            bytes.drain(..BYTE_ORDER_MARK.len());
        }
        let scene = is_gltf(&kind).then(|| gltf::File::read(&bytes, beside));
        Ok(Self {
            gltf: scene.transpose()?,
            kind,
            bytes,
            known: collada::Known::default(),
            beside: Vec::new(),
        })
    }

    /// Corners of the mesh's faces in m, as the file has them.
    pub(super) fn corners(&self) -> Result<Vec<Vec3>, MeshError> {
        match &self.gltf {
            Some(scene) => checked(scene.corners()?),
            None if self.kind == "dae" => checked(collada::read(&self.bytes, &self.known)?),
            None => parse(&self.kind, &self.bytes),
        }
    }

    /// The name's ending.
    pub(super) fn kind(&self) -> &str {
        &self.kind
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// What has been read of COLLADA.
    pub(super) fn known(&self) -> &collada::Known {
        &self.known
    }

    pub(super) fn gltf(&self) -> Option<&gltf::File> {
        self.gltf.as_ref()
    }

    /// Files that were read beside it.
    pub(super) fn beside(&self) -> &[PathBuf] {
        &self.beside
    }

    /// The mesh's faces, cut into triangles: what [`MeshFile::corners`] has read without complaint.
    pub(super) fn triangles(&self) -> Result<Vec<[Vec3; 3]>, MeshError> {
        match &self.gltf {
            Some(scene) => scene.triangles(),
            None => triangles_of(&self.kind, &self.bytes),
        }
    }

    /// The triangles of each object of the file; none where its format knows of none.
    pub(super) fn objects(&self) -> Result<Vec<Vec<[Vec3; 3]>>, MeshError> {
        match &self.gltf {
            Some(scene) => scene.objects(),
            None if self.kind == "obj" => obj::objects(&String::from_utf8_lossy(&self.bytes)),
            None if self.kind == "dae" => collada::objects(&self.bytes, &self.known),
            None => Ok(Vec::new()),
        }
    }
}

fn is_gltf(kind: &str) -> bool {
    kind == "glb" || kind == "gltf"
}

/// [`MeshFile::triangles`] for the bytes of a file, as [`parse`].
pub(super) fn triangles_of(kind: &str, bytes: &[u8]) -> Result<Vec<[Vec3; 3]>, MeshError> {
    match kind {
        "stl" => Ok(stl(bytes)?
            .chunks_exact(3)
            .map(|t| [t[0], t[1], t[2]])
            .collect()),
        "obj" => obj::triangles(&String::from_utf8_lossy(bytes)),
        "ply" => ply::triangles(bytes),
        kind if is_gltf(kind) => gltf::File::read(bytes, |_| None)?.triangles(),
        _ => collada::triangles(bytes),
    }
}

/// [`MeshFile::corners`] for the bytes of a file, without files beside it; `kind` is its ending in
/// small letters.
pub(super) fn parse(kind: &str, bytes: &[u8]) -> Result<Vec<Vec3>, MeshError> {
    checked(match kind {
        "stl" => stl(bytes)?,
        "obj" => obj::corners(&String::from_utf8_lossy(bytes))?,
        "ply" => ply::read(bytes)?,
        kind if is_gltf(kind) => gltf::File::read(bytes, |_| None)?.corners()?,
        _ => collada::read(bytes, &collada::Known::default())?,
    })
}

fn checked(points: Vec<Vec3>) -> Result<Vec<Vec3>, MeshError> {
    if points.is_empty() {
        return Err(MeshError::NoFaces);
    }
    if points.iter().any(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(MeshError::NotFinite);
    }
    Ok(points)
}

fn bytes(path: &Path) -> Result<Vec<u8>, MeshError> {
    let io = |error: std::io::Error| MeshError::Io(error.to_string());
    let file = reading::open(path).map_err(io)?;
    let size = file.metadata().map_err(io)?.len();
    if size > LARGEST_FILE {
        return Err(MeshError::TooLarge(size));
    }
    // Room for all of it at once: copies of a large file would take longer than reading it.
    let mut bytes = Vec::with_capacity(usize::try_from(size).unwrap_or(0) + 1);
    // The file may grow while it is read.
    file.take(LARGEST_FILE)
        .read_to_end(&mut bytes)
        .map_err(io)?;
    Ok(bytes)
}

/// Header and triangle count of a binary STL.
const STL_HEADER: usize = 84;
/// A triangle of a binary STL: normal, three corners, two bytes.
const STL_TRIANGLE: usize = 50;

fn stl(bytes: &[u8]) -> Result<Vec<Vec3>, MeshError> {
    let text = bytes.trim_ascii_start();
    let solid = text
        .get(..5)
        .is_some_and(|w| w.eq_ignore_ascii_case(b"solid"));
    let binary = bytes.get(80..STL_HEADER).map(|count| {
        let triangles = u32::from_le_bytes([count[0], count[1], count[2], count[3]]);
        let expected = STL_HEADER as u64 + u64::from(triangles) * STL_TRIANGLE as u64;
        (triangles, expected)
    });
    let found = bytes.len() as u64;
    match binary {
        // The length decides: many binary files start with "solid" too.
        Some((_, expected)) if expected == found => Ok(stl_binary(bytes, expected)),
        _ if solid => stl_text(&String::from_utf8_lossy(bytes)),
        // Some programs append data of their own, which are no whole triangles.
        Some((triangles, expected)) if triangles > 0 && expected < found => {
            let rest = found - STL_HEADER as u64;
            if rest.is_multiple_of(STL_TRIANGLE as u64) {
                let found = rest / STL_TRIANGLE as u64;
                return Err(MeshError::Miscounted { triangles, found });
            }
            Ok(stl_binary(bytes, expected))
        }
        Some((triangles, expected)) if expected > found => Err(MeshError::Truncated {
            triangles,
            expected,
            found,
        }),
        _ => Err(MeshError::NotStl),
    }
}

/// `end` is at most the length of `bytes`.
fn stl_binary(bytes: &[u8], end: u64) -> Vec<Vec3> {
    let end = usize::try_from(end).map_or(bytes.len(), |end| end.min(bytes.len()));
    let triangles = bytes[STL_HEADER.min(end)..end].chunks_exact(STL_TRIANGLE);
    let mut points = Vec::with_capacity(3 * triangles.len());
    for triangle in triangles {
        for corner in triangle[12..48].chunks_exact(12) {
            let number = |i: usize| {
                let at = 4 * i;
                let four = [corner[at], corner[at + 1], corner[at + 2], corner[at + 3]];
                f64::from(f32::from_le_bytes(four))
            };
            points.push(Vec3::new(number(0), number(1), number(2)));
        }
    }
    points
}

/// Reads words, not lines: `vertex x y z`, and that `endsolid` or a whole facet comes last.
fn stl_text(text: &str) -> Result<Vec<Vec3>, MeshError> {
    let mut points = Vec::new();
    let mut open = false;
    for (i, line) in text.lines().enumerate() {
        let problem = |what: String| MeshError::Line { line: i + 1, what };
        let mut words = line.split_whitespace().peekable();
        // The rest of such a line is a name, of any words.
        let named = |word: &&str| {
            word.eq_ignore_ascii_case("solid") || word.eq_ignore_ascii_case("endsolid")
        };
        if words.peek().is_some_and(named) {
            continue;
        }
        while let Some(word) = words.next() {
            if word.eq_ignore_ascii_case("vertex") {
                points.push(three(&mut words).map_err(problem)?);
            } else if word.eq_ignore_ascii_case("facet") {
                open = true;
            } else if word.eq_ignore_ascii_case("endfacet") {
                open = false;
                if points.len() % 3 != 0 {
                    return Err(problem("a facet has three vertices".to_owned()));
                }
            }
        }
    }
    if open {
        return Err(MeshError::Unfinished);
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A binary STL of the given triangles.
    fn binary(header: &[u8], triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, 0);
        bytes.extend(u32::try_from(triangles.len()).expect("few").to_le_bytes());
        for triangle in triangles {
            bytes.extend([0; 12]);
            for x in triangle.iter().flatten() {
                bytes.extend(x.to_le_bytes());
            }
            bytes.extend([0; 2]);
        }
        bytes
    }

    const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.5], [1.0, 0.0, 0.0], [0.0, -2.0, 0.0]];

    fn corners() -> Vec<Vec3> {
        TRIANGLE
            .iter()
            .map(|p| Vec3::from(p.map(f64::from)))
            .collect()
    }

    #[test]
    fn binary_stl_is_read_even_if_it_starts_with_solid() {
        assert_eq!(stl(&binary(b"part", &[TRIANGLE])), Ok(corners()));
        assert_eq!(stl(&binary(b"solid part", &[TRIANGLE])), Ok(corners()));
    }

    #[test]
    fn binary_stl_with_a_tail_is_read_and_one_cut_short_is_refused() {
        let mut bytes = binary(b"part", &[TRIANGLE]);
        bytes.extend(b"tail");
        assert_eq!(stl(&bytes), Ok(corners()));
        for length in 0..134 {
            assert!(stl(&bytes[..length]).is_err(), "{length}");
        }
        // Six triangles with a count of four.
        let mut bytes = binary(b"part", &[TRIANGLE; 6]);
        bytes[80..84].copy_from_slice(&4_u32.to_le_bytes());
        let told = stl(&bytes).map_err(|error| error.to_string());
        let message = "its count says 4 triangles, but the file has 6";
        assert_eq!(told, Err(message.to_owned()));
        // A count of four thousand million triangles must not be believed.
        let mut bytes = binary(b"part", &[TRIANGLE]);
        bytes[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(matches!(stl(&bytes), Err(MeshError::Truncated { .. })));
    }

    #[test]
    fn ascii_stl_is_read_in_any_case_and_layout() {
        let text = "solid my vertex part\nFACET NORMAL 0 0 nan OUTER LOOP VERTEX 0 0 0.5\n\
                    vertex 1 0 0 vertex 0 -2e0 0 endloop endfacet\nendsolid my vertex part\n";
        assert_eq!(stl(text.as_bytes()), Ok(corners()));
    }

    #[test]
    fn ascii_stl_with_a_fault_is_refused_with_the_line() {
        let text = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0,5\n";
        let Err(MeshError::Line { line: 4, what }) = stl(text.as_bytes()) else {
            panic!("no error in line 4");
        };
        assert!(what.contains("0,5"));
        let cut = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n";
        assert_eq!(stl(cut.as_bytes()), Err(MeshError::Unfinished));
    }

    #[test]
    fn obj_keeps_what_faces_use() {
        let text = "# a\nv 0 0 0\nv 1 0 0 1\nv 0 1 0\nv 9 9 9\nvn 0 0 1\nv 0 0 1\nf 1/1/1 2//1 -1\nf 3 2 1\n";
        let expected = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
        ];
        assert_eq!(obj::corners(text), Ok(expected.map(Vec3::from).to_vec()));
        assert_eq!(
            obj::corners("v 1 2 3\n"),
            Ok(vec![Vec3::new(1.0, 2.0, 3.0)])
        );
        // A byte order mark, and a face over three lines: the same corners.
        let text = text.replace("f 1/1/1 2//1 -1", "f 1/1/1 \\\r\n 2//1\\\n -1");
        assert_eq!(
            obj::corners(&format!("\u{feff}{text}")),
            Ok(expected.map(Vec3::from).to_vec())
        );
        let whole = obj::triangles(&text).map(|triangles| triangles.len());
        assert_eq!(whole, Ok(2));
        for wrong in [
            "f 1 2 3",
            "v 0 0 0\nf 1 2",
            "v 0 0",
            "v 0 0 a",
            "v 0 0 0\nf 0",
            "v 0 0 0\nf -2",
            "v 0 0 0\nf x",
        ] {
            assert!(obj::corners(wrong).is_err(), "{wrong}");
        }
    }

    /// Random changes to valid files: points or an error, never a panic, and never more points than
    /// bytes.
    #[test]
    fn mutated_meshes_never_panic() {
        let mut random = crate::testing::Random(0x9E37_79B9_7F4A_7C15);
        let mut below = |end: usize| random.below(end);
        let meshes = ["ascii.STL", "solid.stl", "corner.obj", "corner.dae"].map(|name| {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/robots/meshes");
            std::fs::read(path.join(name)).expect("a mesh")
        });
        let mut read_well = [0; 4];
        for _ in 0..2000 {
            for (kind, mesh) in meshes.iter().enumerate() {
                let mut bytes = mesh.clone();
                for _ in 0..=below(3) {
                    let at = below(bytes.len());
                    match below(4) {
                        0 => bytes.truncate(at),
                        1 => bytes.insert(at, b"0123456789-.e <>\"/#"[below(19)]),
                        2 => drop(bytes.drain(at..(at + below(20)).min(bytes.len()))),
                        _ if bytes.is_empty() => {}
                        _ => bytes[at] = u8::try_from(below(256)).unwrap_or(0),
                    }
                }
                let points = match kind {
                    0 | 1 => stl(&bytes),
                    2 => obj::corners(&String::from_utf8_lossy(&bytes)),
                    _ => collada::read(&bytes, &collada::Known::default()),
                };
                if let Ok(points) = points {
                    assert!(points.len() <= bytes.len());
                    read_well[kind] += usize::from(crate::geometry::convex_hull(&points).is_ok());
                }
            }
        }
        // Else the changes are too rough to reach the later checks.
        assert!(read_well.iter().all(|&n| n > 100), "{read_well:?}");
    }
}
