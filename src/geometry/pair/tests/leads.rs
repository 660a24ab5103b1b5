//! Faces that a direction out of a solid leads out of.

use super::*;
use crate::geometry::pair::placed::Face;

/// Of hulls of random points, with corners between three to about ten faces. A direction between
/// the normals of two faces with a common edge leads out of these alone: from them it is made. Any
/// other one is a sum of three normals, with factors that are not negative, found by inversion.
#[test]
fn a_direction_leads_out_of_the_faces_whose_normals_it_is_a_sum_of() {
    let mut random = Random(5);
    let (mut edges, mut corners) = (0, 0);
    for _ in 0..100 {
        let count = 8 + random.below(40);
        let solid = solid(&cloud(count, 0.1, &mut random));
        let mesh = &solid.mesh;
        let leads = |d: &Vec3| -> Vec<Face> { solid.leads(d).into_iter().flatten().collect() };
        let normals: Vec<Vec3> = solid.faces().map(|face| face.0).collect();
        for (i, a) in normals.iter().enumerate() {
            let found = leads(a);
            assert!(found.len() == 1 && found[0].0 == *a, "{a:?}: {found:?}");
            for (j, b) in normals.iter().enumerate().take(i) {
                let common = mesh.face(i).iter().filter(|k| mesh.face(j).contains(k));
                if common.count() != 2 {
                    continue;
                }
                let part = random.uniform(0.01, 0.99);
                let found = leads(&(a * part + b * (1.0 - part)).normalize());
                let has = |n: &Vec3| found.iter().any(|face| face.0 == *n);
                assert!(found.len() == 2 && has(a) && has(b), "{i} {j}: {found:?}");
                edges += 1;
            }
        }
        for _ in 0..100 {
            let d = random.unit();
            let found = leads(&d);
            assert!(found.len() == 3, "{d:?}: {found:?}");
            let all = Mat3::from_columns(&[found[0].0, found[1].0, found[2].0]);
            let factors = all.try_inverse().expect("three directions") * d;
            assert!(factors.min() > 0.0, "{d:?}: {factors:?}");
            corners += 1;
        }
    }
    assert!(edges > 3000 && corners == 10_000, "{edges} {corners}");
}

/// A box, and a cylinder at its rim, whose normals are at right angles: all to which it leads.
#[test]
fn a_direction_leads_out_of_all_faces_at_right_angles_that_it_leans_to() {
    let mut random = Random(6);
    for kind in [2, 3] {
        for _ in 0..1000 {
            let solid = solid(&any_shape(kind, 0.1, &mut random));
            let d = random.unit();
            let leads = solid.leads(&d);
            let all: Vec<Face> = solid.walls(&d).filter(|(n, _)| n.dot(&d) > 0.0).collect();
            let found: Vec<&Face> = leads.iter().flatten().collect();
            assert_eq!(found.len(), all.len(), "{d:?}: {found:?} {all:?}");
            assert!(
                all.iter().all(|face| leads.contains(&Some(*face))),
                "{found:?} {all:?}"
            );
        }
    }
}
