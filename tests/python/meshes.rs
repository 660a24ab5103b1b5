//! The mesh readers against trimesh and pycollada (`tests/corpus/meshes.py`) on a sample of
//! published files, and on scenes in COLLADA and glTF with units, up-axes, nested, repeated and
//! mirrored nodes.

#[path = "environment.rs"]
mod environment;

use serde::Deserialize;
use std::path::Path;
use std::process::Command;
use urdf2fmu_core::geometry::{MOST_CORNERS, bounded_hull};
use urdf2fmu_core::spatial::Vec3;
use urdf2fmu_core::urdf;

/// Files of each kind.
const COUNT: usize = 20;
/// Part of a mesh's size that its reach may be off by in any direction: readers keep seven digits.
const TOLERANCE: f64 = 1e-6;

#[derive(Deserialize)]
struct Directions {
    directions: Vec<Vec3>,
}

#[derive(Deserialize)]
struct Reference {
    file: String,
    /// m
    size: f64,
    /// How far it reaches in each direction, m.
    supports: Vec<f64>,
}

/// How far the points reach in a direction, m.
fn support(points: &[Vec3], direction: &Vec3) -> f64 {
    let reach = |most: f64, p: &Vec3| most.max(p.dot(direction));
    points.iter().fold(f64::NEG_INFINITY, reach)
}

#[test]
fn meshes_are_read_as_by_an_independent_reader() {
    let Some(environment) = environment::make() else {
        return;
    };
    let made = environment.folder.join("scenes");
    std::fs::create_dir_all(&made).expect("target/ is writable");
    let robots = Command::new(&environment.interpreter)
        .args(["-B", "-c", "import robots; print(robots.example_robots())"])
        .current_dir(environment::tests())
        .output()
        .expect("the environment has an interpreter");
    let robots = String::from_utf8_lossy(&robots.stdout).trim().to_owned();
    let output = Command::new(&environment.interpreter)
        .arg("-B")
        .arg(environment::tests().join("../corpus/meshes.py"))
        .args(["--reference", &COUNT.to_string()])
        .arg(&made)
        .arg(&environment.pybullet_data)
        .arg(robots)
        .output()
        .expect("the environment has an interpreter");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8_lossy(&output.stdout);
    let mut lines = text.lines();
    let first = lines.next().expect("the directions");
    let Directions { directions } = serde_json::from_str(first).expect("the directions");
    let references: Vec<Reference> = lines
        .map(|line| serde_json::from_str(line).expect("a file"))
        .collect();
    assert!(references.len() >= 3 * COUNT + 50, "{}", references.len());
    for Reference {
        file,
        size,
        supports,
    } in references
    {
        let corners =
            urdf::mesh_corners(Path::new(&file)).unwrap_or_else(|e| panic!("{file}: {e}"));
        // What collides is the hull of at most 64 corners, which says how far it falls short.
        let hull = bounded_hull(&corners, MOST_CORNERS).unwrap_or_else(|e| panic!("{file}: {e}"));
        for (direction, theirs) in directions.iter().zip(supports) {
            let off = (support(&corners, direction) - theirs).abs();
            assert!(off <= TOLERANCE * size, "{file}: {off:e} m of {size} m");
            let short = theirs - support(&hull.vertices, direction);
            let allowed = hull.error + TOLERANCE * size;
            assert!(
                (-TOLERANCE * size..=allowed).contains(&short),
                "{file}: the hull falls {short:e} m short, but says {:e} m",
                hull.error
            );
        }
    }
}
