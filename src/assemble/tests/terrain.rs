//! What has no height of its own stands on the terrain below it.

use super::world::guests;
use super::*;
use crate::assemble::{solid, world};
use crate::geometry::field::{Field, Samples};
use crate::geometry::pair::tests::lifts::lifts;
use crate::geometry::surface::{Surface, Triangles};
use crate::geometry::tests::corners;
use crate::settings::{ObjectSource, Settings};
use crate::spatial::rotation_from_rpy;
use crate::testing::Random;

/// A mesh of triangles.
fn mesh(triangles: &[[Vec3; 3]]) -> Shape {
    Shape::Surface {
        surface: Arc::new(Surface::try_from(Triangles::new(triangles)).expect("triangles")),
    }
}

/// Two triangles with a square of 4 m about a place, seen from above, or from below.
fn square(middle: Vec3, above: bool) -> [[Vec3; 3]; 2] {
    let corner = |x, y| middle + Vec3::new(x, y, 0.0);
    let [a, b, c, d] = [
        corner(-2.0, -2.0),
        corner(2.0, -2.0),
        corner(2.0, 2.0),
        corner(-2.0, 2.0),
    ];
    if above {
        [[a, b, c], [a, c, d]]
    } else {
        [[a, c, b], [a, d, c]]
    }
}

/// Hills of triangles over a square of 4 m.
fn hills(random: &mut Random) -> Vec<[Vec3; 3]> {
    let samples = Samples {
        size: [4.0, 4.0],
        counts: [9, 9],
        heights: (0..81).map(|_| random.uniform(-0.5, 0.5)).collect(),
    };
    Field::try_from(samples).expect("a grid").triangles()
}

/// The height of the object `plate` of the settings beside a cart that is far away, with these
/// shapes as the terrains, and what has been told of it.
fn height(text: &str, shapes: &[Shape]) -> (f64, String) {
    let terrain = |i| format!("[[world.terrain]]\nname = \"t{i}\"\ntype = \"plane\"\n");
    let terrains: String = (0..shapes.len()).map(terrain).collect();
    let text = format!("initial.xyz = [50, 0, 9]\n{text}\n{terrains}");
    let settings = Settings::parse(&text, "test.toml").expect("legal settings");
    let mut shapes = shapes.iter();
    let guests = guests(&settings, |name, source| match source {
        ObjectSource::Terrain(_) => solid(name, shapes.next().expect("a shape"), 0.0),
        _ => panic!("an object of a file"),
    });
    let built = world(&cart(), &settings, &guests);
    let built = built.unwrap_or_else(|findings| panic!("{}", texts(&findings).join("\n")));
    let told = built.diagnostics.iter();
    let told = told.filter(|d| d.code == "A111" && d.message.contains("plate"));
    let told: Vec<_> = told.map(|d| d.message.clone()).collect();
    let plate = built.model.roots.iter().find(|root| root.name == "plate");
    (plate.expect("the plate").position.z, told.join("\n"))
}

fn plate(size: Vec3, [x, y]: [f64; 2], rpy: Vec3) -> String {
    format!(
        "[[world.object]]\nname = \"plate\"\nmass = 1\nshape = {{ box = {:?} }}\n\
         xyz = [{x:?}, {y:?}]\nrpy = {:?}",
        size.as_slice(),
        rpy.as_slice()
    )
}

/// Half of its thickness above the mesh, however thin it is, and wherever that is.
#[test]
fn a_flat_body_stands_on_the_mesh_below_it() {
    for size in [
        [0.4, 0.4, 0.02],
        [0.3, 0.2, 0.01],
        [0.6, 0.4, 0.05],
        [0.2, 0.2, 1e-3],
    ] {
        for height_of_mesh in [0.0, 0.13, 0.31, 0.5, -0.2, -7.3] {
            let mesh = mesh(&square(Vec3::z() * height_of_mesh, true));
            let size = Vec3::from(size);
            let (z, told) = height(&plate(size, [0.1, 0.1], Vec3::zeros()), &[mesh]);
            let expected = height_of_mesh + 0.5 * size.z;
            assert!((z - expected).abs() < 1e-12, "{z} {expected}: {told}");
            assert!(told.contains("touches"), "{told}");
        }
    }
}

/// The expected heights are the greatest of those at which corners and edges meet those of the
/// triangles, each by itself, and at which the lowest corner meets an inclined plane.
#[test]
fn bodies_at_any_attitude_stand_on_the_highest_of_several_terrains() {
    let mut random = Random(0x6A09_E667);
    let mut places = [0; 3];
    for round in 0..60 {
        let thickness = [0.3, 0.02, 1e-3][round % 3];
        let size = Vec3::new(
            random.uniform(0.1, 0.6),
            random.uniform(0.1, 0.4),
            thickness,
        );
        let lean = [0.0, 0.3, 3.0][round / 3 % 3];
        let rpy = random.vector(1.0) * lean;
        let [x, y] = [(); 2].map(|()| random.uniform(-1.9, 1.9));
        let ground = hills(&mut random);
        // A table over a part of them, with its outside up and below it another one.
        let table = square(Vec3::new(2.0, 2.0, random.uniform(0.0, 1.0)), true);
        let under = square(Vec3::new(2.0, 2.0, -0.5), true);
        let shapes = [mesh(&ground), mesh(&[table, under].concat()), Shape::Plane];
        let (z, told) = height(&plate(size, [x, y], rpy), &shapes);
        let R = rotation_from_rpy(&rpy);
        let own: Vec<Vec3> = corners(&(size * 0.5))
            .iter()
            .map(|c| R * c + Vec3::new(x, y, 0.0))
            .collect();
        let most = |triangles: &[[Vec3; 3]]| {
            let lifts = triangles.iter().filter_map(|t| lifts(&own, t));
            lifts
                .map(|[_, most]| most)
                .fold(f64::NEG_INFINITY, f64::max)
        };
        let lowest = own.iter().map(|c| c.z).fold(f64::INFINITY, f64::min);
        let expected = [most(&ground), most(&table), -lowest];
        let highest = expected.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        assert!(
            (z - highest).abs() < 1e-9,
            "{round}: {z} {expected:?}: {told}"
        );
        for (place, expected) in places.iter_mut().zip(expected) {
            *place += u32::from((z - expected).abs() < 1e-9);
        }
    }
    assert!(places.iter().all(|count| *count > 5), "{places:?}");
}

/// On ground that carries everywhere, what begins in a hill or a stage comes up on it, however thin
/// it is; what is below a bridge stays there, as its underside shows, and so does what is beside.
#[test]
fn on_ground_only_what_begins_inside_of_terrain_is_lifted() {
    let [low, high] = [0.0, 0.4].map(|z| Vec3::z() * z);
    let hill = square(high, true);
    let stage = [square(high, true), square(low, false)].concat();
    let bridge = [square(high, true), square(high * 0.75, false)].concat();
    let size = Vec3::new(0.3, 0.2, 0.01);
    let inside = [0.1, 0.1];
    for (triangles, place, expected) in [
        (hill.to_vec(), inside, 0.405),
        (stage.clone(), inside, 0.405),
        (bridge, inside, 0.005),
        (stage, [5.0, 0.0], 0.005),
    ] {
        let text = format!(
            "world.ground = {{ friction = 0.5 }}\n{}",
            plate(size, place, Vec3::zeros())
        );
        let (z, told) = height(&text, &[mesh(&triangles)]);
        // On the ground it sinks.
        assert!((z - expected).abs() < 1.01e-4, "{z} {expected}: {told}");
    }
}
