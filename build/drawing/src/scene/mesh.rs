//! Triangles in few bytes: equal vertices are stored once, coordinates are fractions of the
//! bounding box.
//!
//! A block holds `vertices` positions of three u16, then, where there is a texture, as many texture
//! coordinates of two u16, then `triangles` times three indices: u16, or u32 where there are more
//! than 65,536 vertices. Each of the three begins at a multiple of four bytes. A coordinate is
//! `low + size · number / 65535`.

use super::format::{ALIGNMENT, Mesh, Scene, short};
use std::collections::HashMap;
use std::hash::BuildHasherDefault;
use urdf2fmu_core::hash::Quick;
use urdf2fmu_core::spatial::Vec3;

/// The greatest number of a u16.
const STEPS: f64 = 65535.0;

/// Vertices that a u16 tells apart.
const MOST_SHORT: usize = 65_536;

/// Triangles of a mesh beyond which vertices that are close together become one.
const MANY_TRIANGLES: usize = 100_000;

/// Cells along the longest side in which vertices become one, in the order in which they are tried.
const COARSER: [f64; 6] = [2048.0, 1024.0, 512.0, 256.0, 128.0, 96.0];

/// Triangles as they are drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangles {
    /// m
    pub positions: Vec<[f64; 3]>,
    /// One for each position, or none at all; (0, 0) is the lower left corner of the texture.
    pub uv: Vec<[f64; 2]>,
    /// Places in `positions`.
    pub indices: Vec<[u32; 3]>,
}

/// A range of numbers as u16.
#[derive(Clone, Copy)]
struct Scale<const N: usize> {
    low: [f64; N],
    size: [f64; N],
}

impl<const N: usize> Scale<N> {
    fn of(points: impl Iterator<Item = [f64; N]>) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; N], [f64::NEG_INFINITY; N]);
        for point in points {
            for i in 0..N {
                low[i] = low[i].min(point[i]);
                high[i] = high[i].max(point[i]);
            }
        }
        // The numbers in the head are rounded: they must still hold all points.
        let low = low.map(|x| short(x - 1e-7));
        let size = std::array::from_fn(|i| short(high[i] - low[i] + 2e-7));
        Self { low, size }
    }

    /// The nearest steps; of two that are equally near, the upper one.
    fn pack(&self, point: &[f64; N]) -> [u16; N] {
        std::array::from_fn(|i| {
            let part = (point[i] - self.low[i]) / self.size[i];
            let x = (part * STEPS).clamp(0.0, STEPS);
            // In range by the clamp.
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "clamped"
            )]
            let below = x as u16;
            below + u16::from(x - f64::from(below) >= 0.5)
        })
    }

    fn unpack(&self, point: [u16; N]) -> [f64; N] {
        std::array::from_fn(|i| self.low[i] + self.size[i] * f64::from(point[i]) / STEPS)
    }
}

/// Triangles in numbers of a few bits, not yet in a body: meshes are packed at the same time, and
/// put into the body one after the other.
pub(super) struct Packed {
    scale: Scale<3>,
    uv_scale: Option<Scale<2>>,
    vertices: usize,
    triangles: usize,
    block: Vec<u8>,
}

/// `None` where nothing has an area.
///
/// - `points`: corners, each of which some triangle has, in the order in which they first have them
/// - `triangles`: places in `points`
/// - `uv`: one entry for each triangle or none
pub(super) fn pack(
    points: &[Vec3],
    triangles: &[[u32; 3]],
    uv: &[[[f64; 2]; 3]],
) -> Option<Packed> {
    let scale = Scale::of(points.iter().map(|&p| p.into()));
    let uv_scale = (!uv.is_empty()).then(|| Scale::of(uv.iter().flatten().copied()));
    let corners = Corners::new(points, triangles, uv);
    // What is finer than the format is one vertex in any case.
    let mut keys = corners.keys(|p| scale.pack(p.as_ref()));
    if triangles.len() > MANY_TRIANGLES {
        let longest = scale.size.iter().fold(0.0_f64, |a, &b| a.max(b));
        for cells in COARSER {
            if corners.apart(&keys).count() <= MANY_TRIANGLES {
                break;
            }
            let cell = longest / cells;
            keys = corners.keys(|p| {
                // Fewer cells than a u16 has numbers; none is below the first.
                #[allow(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a cell's number is small and not negative"
                )]
                std::array::from_fn(|i| ((p[i] - scale.low[i]) / cell) as u16)
            });
        }
    }
    let welded = Welded::new(&corners, &keys, &scale, uv_scale.as_ref());
    (!welded.indices.is_empty()).then(|| Packed {
        scale,
        uv_scale,
        vertices: welded.positions.len(),
        triangles: welded.indices.len(),
        block: welded.block(uv_scale.is_some()),
    })
}

/// [`pack`] for triangles with their corners.
pub(super) fn pack_whole(triangles: &[[Vec3; 3]], uv: &[[[f64; 2]; 3]]) -> Option<Packed> {
    let numbers = (0..triangles.len()).map(|t| [0, 1, 2].map(|k| place(3 * t + k)));
    pack(triangles.as_flattened(), &numbers.collect::<Vec<_>>(), uv)
}

/// Appends triangles to a body.
pub(super) fn append(body: &mut Vec<u8>, mesh: &Packed) -> Mesh {
    align(body);
    let at = body.len();
    body.extend_from_slice(&mesh.block);
    Mesh {
        at,
        vertices: mesh.vertices,
        triangles: mesh.triangles,
        low: mesh.scale.low,
        size: mesh.scale.size,
        uv: mesh.uv_scale.map(|uv| [uv.low, uv.size]),
    }
}

/// Fills up with zeros to where the next block may begin.
pub(super) fn align(body: &mut Vec<u8>) {
    body.resize(body.len().next_multiple_of(ALIGNMENT), 0);
}

/// Vertices that are told apart, in the order of their first use.
#[derive(Default)]
struct Welded {
    positions: Vec<[u16; 3]>,
    uv: Vec<[u16; 2]>,
    indices: Vec<[u32; 3]>,
}

/// Corners of triangles, those that are the same to the last bit once, in the order of their first
/// use: welding looks at each of them only once, however many triangles have it.
struct Corners {
    list: Vec<(Vec3, [f64; 2])>,
    /// Places in `list`.
    triangles: Vec<[u32; 3]>,
}

/// A quick table from keys to places.
type Table<K> = HashMap<K, u32, BuildHasherDefault<Quick>>;

fn table<K>(size: usize) -> Table<K> {
    HashMap::with_capacity_and_hasher(size, BuildHasherDefault::default())
}

fn place(i: usize) -> u32 {
    u32::try_from(i).unwrap_or(u32::MAX)
}

impl Corners {
    /// The arguments are those of [`pack`].
    fn new(points: &[Vec3], triangles: &[[u32; 3]], uv: &[[[f64; 2]; 3]]) -> Self {
        // Each corner stands in some six triangles, and some readers give it anew for each.
        let size = points.len().min(triangles.len());
        let mut places: Table<[u64; 3]> = table(size);
        let mut list = Vec::with_capacity(size);
        let mut place_of = |p: &Vec3| {
            let bits = [p.x, p.y, p.z].map(f64::to_bits);
            *places.entry(bits).or_insert_with(|| {
                list.push((*p, [0.0; 2]));
                place(list.len() - 1)
            })
        };
        let own: Vec<u32> = points.iter().map(&mut place_of).collect();
        let triangles = triangles.iter().map(|t| t.map(|i| own[i as usize]));
        if uv.is_empty() {
            let triangles = triangles.collect();
            return Self { list, triangles };
        }
        // With its texture coordinates a point may be several corners.
        let mut places: Table<(u32, [u64; 2])> = table(list.len());
        let mut both = Vec::with_capacity(list.len());
        let number = |(triangle, uv): ([u32; 3], &[[f64; 2]; 3])| {
            std::array::from_fn(|k| {
                let (own, uv) = (triangle[k], uv[k]);
                *places
                    .entry((own, uv.map(f64::to_bits)))
                    .or_insert_with(|| {
                        both.push((list[own as usize].0, uv));
                        place(both.len() - 1)
                    })
            })
        };
        let triangles = triangles.zip(uv).map(number).collect();
        Self {
            list: both,
            triangles,
        }
    }

    /// What tells corners apart, as one number each.
    fn keys(&self, of: impl Fn(&Vec3) -> [u16; 3]) -> Vec<u64> {
        let key = |(p, _): &(Vec3, [f64; 2])| {
            let [x, y, z] = of(p).map(u64::from);
            x | y << 16 | z << 32
        };
        self.list.iter().map(key).collect()
    }

    /// Triangles whose corners all have other keys.
    fn apart<'s>(&'s self, keys: &'s [u64]) -> impl Iterator<Item = &'s [u32; 3]> {
        self.triangles.iter().filter(|triangle| {
            let [a, b, c] = triangle.map(|i| keys[i as usize]);
            a != b && b != c && c != a
        })
    }
}

impl Welded {
    /// Its bytes, which begin where a block may.
    fn block(&self, textured: bool) -> Vec<u8> {
        let vertices = self.positions.len();
        let mut block = Vec::with_capacity(10 * vertices + 12 * self.indices.len() + ALIGNMENT);
        for x in self.positions.as_flattened() {
            block.extend_from_slice(&x.to_le_bytes());
        }
        align(&mut block);
        if textured {
            for x in self.uv.as_flattened() {
                block.extend_from_slice(&x.to_le_bytes());
            }
        }
        let indices = self.indices.as_flattened().iter();
        if vertices > MOST_SHORT {
            block.extend(indices.flat_map(|index| index.to_le_bytes()));
        } else {
            for index in indices {
                let [low, high, ..] = index.to_le_bytes();
                block.extend_from_slice(&[low, high]);
            }
        }
        block
    }

    /// - `keys`: of all corners; those of one key become the first of them
    fn new(corners: &Corners, keys: &[u64], scale: &Scale<3>, uv_scale: Option<&Scale<2>>) -> Self {
        let mut welded = Self::default();
        let mut places: Table<(u64, u32)> = table(corners.list.len());
        let place_of = |((p, uv), key): (&(Vec3, [f64; 2]), &u64)| {
            let uv = uv_scale.map_or([0; 2], |uv_scale| uv_scale.pack(uv));
            let [u, v] = uv.map(u32::from);
            *places.entry((*key, u | v << 16)).or_insert_with(|| {
                welded.positions.push(scale.pack(p.as_ref()));
                welded.uv.push(uv);
                place(welded.positions.len() - 1)
            })
        };
        let places: Vec<u32> = corners.list.iter().zip(keys).map(place_of).collect();
        let kept = corners.apart(keys);
        welded.indices = kept.map(|t| t.map(|i| places[i as usize])).collect();
        welded
    }
}

impl Scene {
    /// The triangles of a mesh; `None` where the body does not hold them.
    pub fn triangles(&self, mesh: &Mesh) -> Option<Triangles> {
        let mut at = mesh.at;
        let mut block = |count: usize, size: usize| {
            let end = at.checked_add(count.checked_mul(size)?)?;
            let bytes = self.body.get(at..end)?;
            at = end.checked_next_multiple_of(ALIGNMENT)?;
            Some(bytes)
        };
        let short = |bytes: &[u8]| u16::from_le_bytes([bytes[0], bytes[1]]);
        let scale = Scale {
            low: mesh.low,
            size: mesh.size,
        };
        let positions = block(mesh.vertices, 6)?
            .chunks_exact(6)
            .map(|p| scale.unpack([short(p), short(&p[2..]), short(&p[4..])]))
            .collect();
        let mut uv = Vec::new();
        if let Some([low, size]) = mesh.uv {
            let scale = Scale { low, size };
            let packed = block(mesh.vertices, 4)?.chunks_exact(4);
            uv = packed
                .map(|p| scale.unpack([short(p), short(&p[2..])]))
                .collect();
        }
        let width = if mesh.vertices > MOST_SHORT { 4 } else { 2 };
        let index = |bytes: &[u8]| match *bytes {
            [a, b, c, d] => u32::from_le_bytes([a, b, c, d]),
            _ => u32::from(short(bytes)),
        };
        let indices: Vec<[u32; 3]> = block(mesh.triangles, 3 * width)?
            .chunks_exact(3 * width)
            .map(|t| std::array::from_fn(|k| index(&t[k * width..(k + 1) * width])))
            .collect();
        let inside = indices
            .iter()
            .flatten()
            .all(|&i| (i as usize) < mesh.vertices);
        inside.then_some(Triangles {
            positions,
            uv,
            indices,
        })
    }
}
