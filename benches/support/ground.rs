//! Terrain and things that stand still, for benches.

use std::sync::Arc;
use urdf2fmu_core::assemble::{self, Guest};
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::geometry::surface::{Surface, Triangles};
use urdf2fmu_core::model::RootKind;
use urdf2fmu_core::settings::{ObjectSettings, ObjectSource, Settings};
use urdf2fmu_core::spatial::Vec3;

/// Triangles over a square grid about the origin.
pub fn triangles(extent: f64, cells: u32, height: impl Fn(f64, f64) -> f64) -> Shape {
    let place = |i: u32| (f64::from(i) / f64::from(cells) - 0.5) * extent;
    let corner = |i, j| Vec3::new(place(i), place(j), height(place(i), place(j)));
    let places = (0..cells).flat_map(|j| (0..cells).map(move |i| (i, j)));
    let list: Vec<[Vec3; 3]> = places
        .flat_map(|(i, j)| {
            let [a, b] = [corner(i, j), corner(i + 1, j)];
            let [c, d] = [corner(i + 1, j + 1), corner(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let surface = Arc::new(Surface::try_from(Triangles::new(&list)).expect("triangles"));
    Shape::Surface { surface }
}

/// A shape that never moves, with its origin at `xyz`, m, turned by `rpy`, rad.
pub fn still(name: &str, shape: &Shape, [xyz, rpy]: [Vec3; 2], settings: &Settings) -> Guest {
    let mut object = ObjectSettings {
        name: Some(name.into()),
        source: ObjectSource::Solid {
            shape: shape.clone(),
            mass: 0.0,
        },
        initial: settings.initial.clone(),
        fixed: true,
        conveyor: false,
        friction: None,
        restitution: None,
        place: None,
    };
    object.initial.xy = [xyz.x, xyz.y];
    object.initial.z = Some(xyz.z);
    object.initial.rpy = rpy;
    object.initial.joints.clear();
    Guest {
        kind: RootKind::Object,
        description: assemble::solid(name, shape, 0.0),
        settings: assemble::of_object(&object, settings),
        name: name.into(),
    }
}
