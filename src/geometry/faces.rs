//! What share of a face's load each corner of a convex hull carries.
//!
//! A flat face that rests on the ground gives way by the same depth however many corners a mesh
//! gives it: the shares of its corners sum up to one. The share of a corner is its exterior angle
//! over 2π, so that a corner that is split in two keeps its share. A box has a quarter at each.
//!
//! In: the corners of a hull. Out: its faces, and each corner's share in the faces that it belongs
//! to. Corners within a given distance of a plane count as in it: the many triangles of a flat or
//! hardly curved side are one face.

use super::hull::{Simplices, hull};
use crate::spatial::{Vec3, across};
use crate::tuning::FACING;

/// The faces of a hull, and the shares of its corners.
#[derive(Clone, Debug, Default)]
pub struct Faces {
    /// Unit normal of each, outwards.
    normals: Vec<Vec3>,
    /// Face and share of each corner, those of corner `i` from `first[i]` to `first[i + 1]`.
    shares: Vec<(usize, f64)>,
    first: Vec<usize>,
    /// Share of a corner without a face: of a rod or a point.
    alone: f64,
}

impl Faces {
    /// The faces of the hull of `corners`, each as thick as `thickness`, m.
    #[cfg_attr(small, optimize(size))]
    pub fn new(corners: &[Vec3], thickness: f64) -> Self {
        let mut faces = Self {
            alone: 1.0,
            ..Self::default()
        };
        let mut members: Vec<Vec<(usize, f64)>> = Vec::new();
        let mut add = |normal: Vec3| {
            let height = |i: usize| normal.dot(&corners[i]);
            let top = (0..corners.len())
                .map(height)
                .fold(f64::NEG_INFINITY, f64::max);
            let list: Vec<usize> = (0..corners.len())
                .filter(|&i| height(i) > top - thickness)
                .collect();
            let known = members.iter().any(|m| m.iter().map(|(i, _)| i).eq(&list));
            if !known && list.len() > 2 {
                let shares = shares(corners, &list, &normal);
                members.push(list.into_iter().zip(shares).collect());
                faces.normals.push(normal);
            }
        };
        if let Some(hull) = hull(corners, corners.len().max(4)) {
            let plane = |a: usize, b: usize, c: usize| {
                let [a, b, c] = [a, b, c].map(|i| hull.corners[i]);
                (b - a).cross(&(c - a)).try_normalize(0.0)
            };
            match &hull.simplices {
                Simplices::Faces(triangles) => {
                    for &[a, b, c] in triangles {
                        if let Some(normal) = plane(a, b, c) {
                            add(normal);
                        }
                    }
                }
                Simplices::Polygon(order) if order.len() > 2 => {
                    if let Some(normal) = plane(order[0], order[1], order[2]) {
                        add(normal);
                        add(-normal);
                    }
                }
                Simplices::Segment => faces.alone = 0.5,
                _ => {}
            }
        }
        for i in 0..corners.len() {
            faces.first.push(faces.shares.len());
            for (face, list) in members.iter().enumerate() {
                let own = list.iter().filter(|(corner, _)| *corner == i);
                faces.shares.extend(own.map(|(_, share)| (face, *share)));
            }
        }
        faces.first.push(faces.shares.len());
        faces
    }

    /// Share of corner `index` where the hull presses along the unit vector `down`. Each of its
    /// faces counts by a high power of the cosine to it: smooth in the pose, and the face that the
    /// hull rests on decides.
    pub fn share(&self, index: usize, down: &Vec3) -> f64 {
        let list = &self.shares[self.first[index]..self.first[index + 1]];
        let (mut sum, mut total) = (0.0, 0.0);
        for &(face, share) in list {
            let mut weight = self.normals[face].dot(down).max(0.0);
            for _ in 0..FACING {
                weight *= weight;
            }
            // A corner that nothing of its faces turns to the ground takes their mean.
            let weight = weight + f64::MIN_POSITIVE;
            sum += weight * share;
            total += weight;
        }
        if list.is_empty() {
            self.alone
        } else {
            sum / total
        }
    }
}

/// Shares of the corners `list` of one face: exterior angles over 2π of those on its outline; the
/// others, which lie in its midst, take the mean. They sum up to one.
fn shares(corners: &[Vec3], list: &[usize], normal: &Vec3) -> Vec<f64> {
    let x = across(normal);
    let y = normal.cross(&x);
    let flat: Vec<(f64, f64)> = list
        .iter()
        .map(|&i| (x.dot(&corners[i]), y.dot(&corners[i])))
        .collect();
    let outline = outline(&flat);
    let mut shares = vec![0.0; list.len()];
    let count = outline.len();
    for (k, &i) in outline.iter().enumerate() {
        let (before, after) = (outline[(k + count - 1) % count], outline[(k + 1) % count]);
        let (a, b, c) = (flat[before], flat[i], flat[after]);
        let (u, v) = ((b.0 - a.0, b.1 - a.1), (c.0 - b.0, c.1 - b.1));
        let turn = libm::atan2(u.0 * v.1 - u.1 * v.0, u.0 * v.0 + u.1 * v.1);
        shares[i] = turn.max(0.0) / std::f64::consts::TAU;
    }
    #[expect(clippy::cast_precision_loss, reason = "counts of corners")]
    let mean = 1.0 / list.len() as f64;
    for share in &mut shares {
        if *share <= 0.0 {
            *share = mean;
        }
    }
    let total: f64 = shares.iter().sum();
    for share in &mut shares {
        *share /= total;
    }
    shares
}

/// Indices of the points on the convex outline, counter-clockwise (Andrew's monotone chain).
#[cfg_attr(small, optimize(size))]
pub(super) fn outline(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| {
        points[a]
            .partial_cmp(&points[b])
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    let left = |a: usize, b: usize, c: usize| {
        let (a, b, c) = (points[a], points[b], points[c]);
        (b.0 - a.0) * (c.1 - b.1) - (b.1 - a.1) * (c.0 - b.0) > 0.0
    };
    let chain = |order: &mut dyn Iterator<Item = usize>| {
        let mut chain: Vec<usize> = Vec::new();
        for i in order {
            while chain.len() > 1 && !left(chain[chain.len() - 2], chain[chain.len() - 1], i) {
                chain.pop();
            }
            chain.push(i);
        }
        chain.pop();
        chain
    };
    let mut all = chain(&mut order.iter().copied());
    all.extend(chain(&mut order.iter().rev().copied()));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(x: f64, y: f64, z: f64) -> Vec<Vec3> {
        (0..8)
            .map(|i| {
                let sign = |bit: u32| if i & bit == 0 { -1.0 } else { 1.0 };
                Vec3::new(x * sign(1), y * sign(2), z * sign(4))
            })
            .collect()
    }

    #[test]
    fn a_corner_of_a_box_carries_a_quarter_of_each_of_its_faces() {
        let corners = bar(0.1, 0.2, 0.3);
        let faces = Faces::new(&corners, 3e-4);
        for down in [Vec3::z(), -Vec3::x(), Vec3::new(1.0, 1.0, 1.0).normalize()] {
            for i in 0..8 {
                assert!((faces.share(i, &down) - 0.25).abs() < 1e-12);
            }
        }
    }

    /// By hand: the end of a prism of `n` sides has `1/n` at each corner, a side 1/4.
    #[test]
    fn shares_of_a_face_sum_up_to_one_however_many_corners_it_has() {
        for n in [3_u32, 8, 31] {
            let corners: Vec<Vec3> = (0..2 * n)
                .map(|i| {
                    let angle = std::f64::consts::TAU * f64::from(i / 2) / f64::from(n);
                    let z = if i % 2 == 0 { 0.1 } else { -0.1 };
                    Vec3::new(libm::cos(angle), libm::sin(angle), z)
                })
                .collect();
            let faces = Faces::new(&corners, 1e-4);
            for i in 0..corners.len() {
                let up = if i % 2 == 0 { Vec3::z() } else { -Vec3::z() };
                assert!(
                    (faces.share(i, &up) - 1.0 / f64::from(n)).abs() < 1e-9,
                    "{n}"
                );
            }
            let middle = std::f64::consts::PI / f64::from(n);
            let side = Vec3::new(libm::cos(middle), libm::sin(middle), 0.0);
            let sum: f64 = (0..4).map(|i| faces.share(i, &side)).sum();
            assert!((sum - 1.0).abs() < 0.05, "{n}: {sum}");
        }
    }

    /// A mesh may split a corner, or have corners in the midst of a face.
    #[test]
    fn a_split_corner_keeps_its_share() {
        let mut corners = bar(0.1, 0.1, 0.1);
        corners.push(corners[0] + Vec3::new(1e-3, 0.0, 0.0));
        corners[0].y += 1e-3;
        let faces = Faces::new(&corners, 1e-5);
        let down = -Vec3::z();
        let split = faces.share(0, &down) + faces.share(8, &down);
        assert!((split - 0.25).abs() < 1e-2, "{split}");
        let sum: f64 = [0, 1, 2, 3, 8].iter().map(|&i| faces.share(i, &down)).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{sum}");
    }

    #[test]
    fn rods_and_points_share_alike() {
        let rod = [Vec3::zeros(), Vec3::x()];
        assert!((Faces::new(&rod, 1e-4).share(1, &Vec3::z()) - 0.5).abs() < 1e-15);
        let point = [Vec3::zeros()];
        assert!((Faces::new(&point, 1e-4).share(0, &Vec3::z()) - 1.0).abs() < 1e-15);
        let plate = [Vec3::zeros(), Vec3::x(), Vec3::x() + Vec3::y(), Vec3::y()];
        for i in 0..4 {
            assert!((Faces::new(&plate, 1e-4).share(i, &Vec3::z()) - 0.25).abs() < 1e-12);
        }
    }
}
