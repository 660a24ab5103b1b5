//! Terrain and things that stand still, for benches.

use std::sync::Arc;
use urdf2fmu_core::assemble::{self, Guest};
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::geometry::surface::{Surface, Triangles};
use urdf2fmu_core::model::RootKind;
use urdf2fmu_core::settings::{
    InitialSettings, LinkSettings, ObjectSettings, ObjectSource, Settings,
};
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
    let initial = InitialSettings {
        xy: [xyz.x, xyz.y],
        z: Some(xyz.z),
        rpy,
        ..settings.initial.clone()
    };
    object(name, (shape, 0.0), initial, [None; 2], settings)
}

/// A solid beside the robot; without a mass, kg, it never moves.
///
/// - `surface`: its friction and restitution; none: those of what says nothing about them
pub fn object(
    name: &str,
    (shape, mass): (&Shape, f64),
    initial: InitialSettings,
    [friction, restitution]: [Option<f64>; 2],
    settings: &Settings,
) -> Guest {
    let object = ObjectSettings {
        idle_mass: None,
        name: Some(name.into()),
        source: ObjectSource::Solid {
            shape: shape.clone(),
            mass,
        },
        initial: InitialSettings {
            joints: Vec::new(),
            ..initial
        },
        fixed: mass <= 0.0,
        conveyor: false,
        driven: false,
        surface: LinkSettings {
            friction,
            restitution,
            ..LinkSettings::new("*")
        },
        place: None,
        file_place: None,
    };
    Guest {
        kind: RootKind::Object,
        description: assemble::solid(name, shape, mass),
        settings: assemble::of_object(&object, settings),
        name: name.into(),
    }
}
