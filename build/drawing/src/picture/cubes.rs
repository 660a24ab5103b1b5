//! The robot as the sky sees it: made of cubes, and what is nearest first.

use super::aim::{Point, dot};
use super::raster::floor;
use super::solid;
use std::collections::HashMap;
use std::hash::BuildHasherDefault;
use urdf2fmu_core::hash::Quick;
use urdf2fmu_core::parallel;
use urdf2fmu_core::spatial::Vec3;

/// Triangles whose corners are moved to the middles of cubes.
pub(super) struct Cubes {
    /// Those of all cubes with a corner.
    middles: Vec<Point>,
    /// Places in `middles`, without triangles that became lines, and of those that became one only
    /// the first: of a fine mesh most are left out.
    faces: Vec<[u32; 3]>,
}

impl Cubes {
    /// - `cell`: side of a cube, m
    pub(super) fn new(points: &[Point], faces: impl Iterator<Item = [u32; 3]>, cell: f64) -> Self {
        /// A point that no face has had yet.
        const NEW: u32 = u32::MAX;
        #[allow(clippy::cast_possible_truncation, reason = "a length")]
        let cell = cell as f32;
        #[allow(clippy::cast_precision_loss, reason = "a few hundred cubes")]
        let along = |n: i32| (n as f32 + 0.5) * cell;
        let mut cubes = Self {
            middles: Vec::new(),
            faces: Vec::new(),
        };
        let mut places: HashMap<[i32; 3], u32, BuildHasherDefault<Quick>> = HashMap::default();
        let mut known = Known::default();
        let mut cube_of = vec![NEW; points.len()];
        let mut cube = |i: u32| {
            let cube = &mut cube_of[i as usize];
            if *cube == NEW {
                let number = points[i as usize].map(|x| floor(x / cell));
                *cube = *places.entry(number).or_insert_with(|| {
                    cubes.middles.push(number.map(along));
                    solid::place(cubes.middles.len() - 1)
                });
            }
            *cube
        };
        for face in faces {
            let [a, b, c] = face.map(&mut cube);
            if a != b && b != c && c != a && known.insert(sorted([a, b, c])) {
                cubes.faces.push([a, b, c]);
            }
        }
        cubes
    }
}

/// Triangles that are known. Those of a corner are few and near each other in memory, unlike those
/// of a table of all.
#[derive(Default)]
struct Known {
    /// The last triangle of which this corner is the greatest, as a place in `list`.
    last: Vec<u32>,
    /// The other two corners, and the triangle before this one.
    list: Vec<([u32; 2], u32)>,
}

impl Known {
    /// Whether the triangle is new; its corners ascend.
    fn insert(&mut self, [a, b, greatest]: [u32; 3]) -> bool {
        /// There is no triangle.
        const NONE: u32 = u32::MAX;
        // The middle of a fan is seen before its rim, so that rarely many triangles share the
        // greatest corner.
        let greatest = greatest as usize;
        if self.last.len() <= greatest {
            self.last.resize(greatest + 1, NONE);
        }
        let mut at = self.last[greatest];
        while let Some((others, before)) = self.list.get(at as usize) {
            if *others == [a, b] {
                return false;
            }
            at = *before;
        }
        self.list.push(([a, b], self.last[greatest]));
        self.last[greatest] = solid::place(self.list.len() - 1);
        true
    }
}

/// Triangles of cubes, roughly the nearest first for each quarter of the sky: most of those behind
/// are then left out as soon as they are looked at. The order changes no picture.
pub(super) struct Sorted {
    pub(super) middles: Vec<Point>,
    /// For the quarters of x and y above zero or not.
    quarters: Vec<Vec<[u32; 3]>>,
}

impl Cubes {
    pub(super) fn sorted(self) -> Sorted {
        /// Faces of one slab keep their order, and so their neighbours in the processor's memory.
        const SLABS: f32 = 32.0;
        /// Upwards, for the middle of a quarter of the sky.
        const UP: f32 = 0.8;
        let quarter = |[x, y]: &[f32; 2]| {
            let toward = [*x, *y, UP];
            let near = |face: &[u32; 3]| dot(&toward, &self.middles[face[0] as usize]);
            let all = || self.faces.iter().map(near);
            let low = all().fold(f32::INFINITY, f32::min);
            let high = all().fold(f32::NEG_INFINITY, f32::max);
            let part = (high - low).max(1e-6) / SLABS;
            let mut slabs: Vec<Vec<[u32; 3]>> = Vec::new();
            for face in &self.faces {
                let slab = usize::try_from(floor((high - near(face)) / part)).unwrap_or(0);
                if slabs.len() <= slab {
                    slabs.resize(slab + 1, Vec::new());
                }
                slabs[slab].push(*face);
            }
            slabs.concat()
        };
        let quarters = parallel::map(
            &[[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]],
            quarter,
        );
        Sorted {
            middles: self.middles,
            quarters,
        }
    }
}

impl Sorted {
    pub(super) const QUARTERS: usize = 4;

    /// Which quarter a lamp is in.
    pub(super) fn quarter(lamp: &Vec3) -> usize {
        2 * usize::from(lamp.x > 0.0) + usize::from(lamp.y > 0.0)
    }

    /// The faces as they are drawn for lamps in a quarter.
    pub(super) fn toward(&self, quarter: usize) -> &[[u32; 3]] {
        &self.quarters[quarter]
    }
}

/// The same for a triangle whichever corner comes first and whichever way it is wound.
fn sorted(mut face: [u32; 3]) -> [u32; 3] {
    face.sort_unstable();
    face
}
