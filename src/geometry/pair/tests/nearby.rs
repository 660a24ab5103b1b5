//! What is remembered of a mesh changes no look.

use super::super::Nearby;
use super::*;
use crate::geometry::surface::{Surface, Triangles};
use std::sync::Arc;

/// Hills of triangles with steps in between, so that all kinds of edges occur.
fn hills(random: &mut Random) -> Shape {
    let mut heights = [[0.0; 17]; 17];
    for height in heights.iter_mut().flatten() {
        *height = match random.uniform(0.0, 1.0) {
            x if x < 0.5 => 0.0,
            x if x < 0.9 => random.uniform(-0.05, 0.05),
            _ => random.uniform(-0.4, 0.4),
        };
    }
    let corner = |i: usize, j: usize| {
        let place = |i: usize| f64::from(u32::try_from(i).expect("small")) * 0.125 - 1.0;
        Vec3::new(place(i), place(j), heights[j][i])
    };
    let cells = (0..16).flat_map(|j| (0..16).map(move |i| (i, j)));
    let pairs = cells.flat_map(|(i, j)| {
        let [a, b] = [corner(i, j), corner(i + 1, j)];
        let [c, d] = [corner(i + 1, j + 1), corner(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    let triangles = Triangles::new(&pairs.collect::<Vec<_>>());
    let surface = Arc::new(Surface::try_from(triangles).expect("triangles"));
    Shape::Surface { surface }
}

/// Shapes of each kind wander over hills, turn, and are looked at with reaches of a step, of a
/// slower one, and of none. Rare jumps take them elsewhere.
#[test]
fn a_look_with_what_was_near_before_finds_the_same_bits() {
    let random = &mut Random(7);
    let shapes = [
        Shape::Sphere { radius: 0.05 },
        Shape::Capsule {
            radius: 0.04,
            half_length: 0.1,
        },
        Shape::Cylinder {
            radius: 0.1,
            half_length: 0.03,
        },
        Shape::Cylinder {
            radius: 0.03,
            half_length: 0.1,
        },
        cube(0.08),
        dodecahedron(0.1),
    ];
    let mut touched = 0;
    for round in 0..6 {
        let ground = solid(&hills(random));
        let X_WG = at(random.unit() * 0.3, any_rotation(random));
        for shape in &shapes {
            let shape = solid(shape);
            let mut nearby = Nearby::new();
            let (mut with, mut without) = (Patch::new(), Patch::new());
            let mut X = at(Vec3::zeros(), any_rotation(random));
            for look in 0..600 {
                if look % 60 == 0 {
                    let flat = [0, 1].map(|_| random.uniform(-0.9, 0.9));
                    X.p = Vec3::new(flat[0], flat[1], random.uniform(-0.02, 0.12));
                    X.R = any_rotation(random);
                }
                X.p += random.unit() * random.uniform(0.0, 0.004);
                X.R = turned(random.unit(), random.uniform(0.0, 0.04)) * X.R;
                let reach = [0.0, 0.002, 0.01][look % 3];
                let (a, b) = ((&shape, &X_WG.compose(&X)), (&ground, &X_WG));
                let found = [
                    with.find_near([a, b], None, reach, Some(&mut nearby)),
                    without.find(a, b, reach),
                ];
                assert_eq!(found[0], found[1], "round {round}, look {look}, seed 7");
                assert_eq!(
                    with.points(),
                    without.points(),
                    "round {round}, look {look}"
                );
                touched += usize::from(found[0]);
            }
        }
    }
    assert!(touched > 5000, "{touched} looks found something");
}
