#![allow(clippy::unwrap_used, reason = "a test may fail")]
#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::format::*;
use super::{mesh, pose};
use urdf2fmu_core::spatial::Vec3;

/// A robot of one link with one mesh and one texture.
fn scene(triangles: &[[[f64; 3]; 3]], uv: &[[[f64; 2]; 3]]) -> Scene {
    let mut body = Vec::new();
    let triangles: Vec<_> = triangles.iter().map(|t| t.map(Vec3::from)).collect();
    let packed = mesh::pack_whole(&triangles, uv);
    let meshes: Vec<Mesh> = packed
        .iter()
        .map(|mesh| mesh::append(&mut body, mesh))
        .collect();
    mesh::align(&mut body);
    let textures = vec![Texture {
        at: body.len(),
        bytes: 3,
        kind: "image/png".to_owned(),
        width: 1,
        height: 1,
    }];
    body.extend(b"png");
    let track = |start: &[f64]| Track {
        variables: Vec::new(),
        start: start.to_vec(),
    };
    let head = Head {
        format: FORMAT,
        generator: "a test".to_owned(),
        robot: "</script> \"名\" 前".to_owned(),
        guid: String::new(),
        mass: 1.0,
        ground: true,
        roots: vec![Root {
            name: String::new(),
            kind: "robot".to_owned(),
            link: 0,
            position: track(&[0.0; 3]),
            orientation: track(&[0.0, 0.0, 0.0, 1.0]),
        }],
        links: vec![Link {
            name: "a".to_owned(),
            mass: 1.0,
            center_of_mass: [0.0; 3],
        }],
        joints: Vec::new(),
        visuals: vec![Drawn {
            link: 0,
            position: [0.0; 3],
            orientation: [0.0, 0.0, 0.0, 1.0],
            shape: Shape::Mesh(0),
            scale: None,
            color: [1.0; 4],
            texture: Some(0),
        }],
        collisions: Vec::new(),
        ties: Vec::new(),
        meshes,
        textures,
        contacts: Vec::new(),
        wrenches: Vec::new(),
        variables: Vec::new(),
        notes: Vec::new(),
    };
    Scene { head, body }
}

/// Triangles of a sphere of radius 1, `n` strips of `2 n` squares.
fn sphere(n: u32) -> Vec<[[f64; 3]; 3]> {
    let part = |i: u32, of: u32| f64::from(i) / f64::from(of) * std::f64::consts::TAU;
    let point = |i: u32, j: u32| {
        let (a, b) = (part(i, 2 * n), 0.5 * part(j, n));
        [b.sin() * a.cos(), b.sin() * a.sin(), b.cos()]
    };
    let squares = (0..2 * n).flat_map(|i| (0..n).map(move |j| (i, j)));
    squares
        .flat_map(|(i, j)| {
            let [a, b] = [point(i, j), point(i + 1, j)];
            let [c, d] = [point(i, j + 1), point(i + 1, j + 1)];
            [[a, c, d], [a, d, b]]
        })
        .collect()
}

#[test]
fn what_is_written_is_read_again() {
    let uv = [[[0.0, 0.0], [1.0, 0.0], [0.0, 2.5]]; 2];
    let triangles = [
        [[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.0, 0.2, -7.0]],
        [[0.0, 0.0, 0.0], [0.0, 0.2, -7.0], [0.3, 0.0, 0.0]],
    ];
    let scene = scene(&triangles, &uv);
    let bytes = scene.to_bytes().unwrap();
    let again = Scene::from_bytes(&bytes).unwrap();
    assert_eq!(again, scene);
    let mesh = &again.head.meshes[0];
    // Of the three corners two have other texture coordinates in the second triangle.
    assert_eq!((mesh.vertices, mesh.triangles), (5, 2));
    let read = again.triangles(mesh).unwrap();
    // Half a step of the largest side.
    let near = |found: &[f64], given: &[f64], size: f64| {
        let off = found.iter().zip(given).map(|(a, b)| (a - b).abs());
        off.fold(0.0, f64::max) < 0.5 * size / 65535.0
    };
    for (face, (triangle, uv)) in read.indices.iter().zip(triangles.iter().zip(uv)) {
        for k in 0..3 {
            assert!(near(&read.positions[face[k] as usize], &triangle[k], 7.01));
            assert!(near(&read.uv[face[k] as usize], &uv[k], 2.51));
        }
    }
}

#[test]
fn very_many_triangles_become_fewer_and_the_shape_stays() {
    let few = scene(&sphere(140), &[]);
    let mesh = &few.head.meshes[0];
    // Two triangles of each square, but one at the poles.
    assert_eq!(mesh.triangles, 4 * 140 * 140 - 2 * 2 * 140);
    assert!(few.triangles(mesh).is_some());
    let many = sphere(600);
    assert!(many.len() > 1_000_000);
    let scene = scene(&many, &[]);
    let mesh = &scene.head.meshes[0];
    assert!(mesh.triangles <= 100_000, "{}", mesh.triangles);
    // The ball keeps its shape: no corner leaves it, and little of its volume goes.
    let read = scene.triangles(mesh).unwrap();
    let mut volume = 0.0;
    for face in &read.indices {
        let [a, b, c] = face.map(|i| read.positions[i as usize]);
        let cross = [
            b[1] * c[2] - b[2] * c[1],
            b[2] * c[0] - b[0] * c[2],
            b[0] * c[1] - b[1] * c[0],
        ];
        volume += (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6.0;
    }
    let ball = 4.0 / 3.0 * std::f64::consts::PI;
    assert!((volume / ball - 1.0).abs() < 0.01, "{volume}");
}

#[test]
fn more_vertices_than_a_short_index_counts_have_long_indices() {
    // Triangles apart from each other.
    let apart = |i: u32| {
        let x = f64::from(i);
        [[x, 0.0, 0.0], [x + 0.5, 0.0, 0.0], [x, 1.0, 0.0]]
    };
    for (count, vertices) in [(21_845, 65_535), (21_846, 65_538)] {
        let triangles: Vec<_> = (0..count).map(apart).collect();
        let scene = scene(&triangles, &[]);
        let mesh = &scene.head.meshes[0];
        assert_eq!(mesh.vertices, vertices);
        let read = scene.triangles(mesh).unwrap();
        let last = read
            .indices
            .last()
            .unwrap()
            .map(|i| read.positions[i as usize]);
        assert!((last[2][1] - 1.0).abs() < 1e-4 && (last[0][0] - last[2][0]).abs() < 1e-4);
    }
}

#[test]
fn every_tree_stands_where_its_own_base_is() {
    let mut scene = scene(&sphere(3), &[]);
    scene.head.links.push(scene.head.links[0].clone());
    let mut other = scene.head.roots[0].clone();
    (other.name, other.kind, other.link) = ("cube".to_owned(), "object".to_owned(), 1);
    other.position = Track {
        variables: ["x", "y", "z"].map(|axis| format!("cube.{axis}")).to_vec(),
        start: vec![1.0, 2.0, 3.0],
    };
    assert!(
        scene
            .to_bytes()
            .is_ok_and(|bytes| Scene::from_bytes(&bytes).is_err())
    );
    scene.head.roots.push(other);
    let bytes = scene.to_bytes().unwrap();
    let head = Scene::from_bytes(&bytes).unwrap().head;
    let at = |value: &dyn Fn(&str) -> Option<f64>| pose::link_poses(&head, value)[1].p;
    assert_eq!(at(&|_| None).as_slice(), [1.0, 2.0, 3.0]);
    let moved = at(&|name| (name == "cube.y").then_some(5.0));
    assert_eq!(moved.as_slice(), [1.0, 5.0, 3.0]);
    assert_eq!(pose::link_poses(&head, |_| None)[0].p.norm().to_bits(), 0);
    assert_eq!(head.tracks().count(), 4);
    // Two trees on one link.
    scene.head.roots[1].link = 0;
    let bytes = scene.to_bytes().unwrap();
    assert!(Scene::from_bytes(&bytes).is_err());
}

#[test]
fn a_bolted_base_is_where_parameters_mount_it() {
    let parameter = |name: String, start: f64| Variable {
        name,
        reference: 0,
        causality: "parameter".to_owned(),
        variability: "fixed".to_owned(),
        kind: "real".to_owned(),
        unit: String::new(),
        description: String::new(),
        start: Some(start),
        min: None,
        max: None,
    };
    let turned = 0.5 * std::f64::consts::PI;
    for dot in [".", "_"] {
        let mut scene = scene(&sphere(3), &[]);
        for (member, start) in [
            ("position.x", 1.0),
            ("position.y", 2.0),
            ("position.z", 3.0),
            ("rpy.roll", 0.0),
            ("rpy.pitch", 0.0),
            ("rpy.yaw", 0.0),
        ] {
            let name = format!("initial.base.{member}").replace('.', dot);
            scene.head.variables.push(parameter(name, start));
        }
        let unchanged = scene.clone();
        assert!(!scene.mount(&[("gravity".to_owned(), 1.0)].into()));
        assert_eq!(scene, unchanged);
        let set = |member: &str, value| {
            let name = format!("initial.base.{member}").replace('.', dot);
            (name, value)
        };
        let moved = scene.mount(&[set("position.z", 0.05), set("rpy.roll", turned)].into());
        assert!(moved);
        let base = pose::link_poses(&scene.head, |_| None)[0];
        assert_eq!(base.p.as_slice(), [1.0, 2.0, 0.05]);
        assert!((base.R * Vec3::y() - Vec3::z()).norm() < 1e-6, "{base:?}");
        // A base that moves is where the outputs say.
        let mut floating = unchanged.clone();
        floating.head.roots[0].position.variables = vec!["x".to_owned()];
        let before = floating.clone();
        assert!(!floating.mount(&[set("position.z", 0.05)].into()));
        assert_eq!(floating, before);
    }
}

#[test]
fn damaged_scenes_are_refused_without_a_panic() {
    let bytes = scene(&sphere(3), &[]).to_bytes().unwrap();
    for length in 0..bytes.len() {
        assert!(Scene::from_bytes(&bytes[..length]).is_err(), "{length}");
    }
    // A linear congruential generator: Knuth, The Art of Computer Programming, volume 2.
    let mut seed = 1_u64;
    let mut random = |end: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        usize::try_from(seed >> 33).unwrap() % end
    };
    for _ in 0..20_000 {
        let mut changed = bytes.clone();
        for _ in 0..=random(3) {
            let at = random(changed.len());
            changed[at] = b"0123456789-.e[]{}\",:z"[random(21)];
        }
        // Read or refused: both are fine, and what is read can be drawn.
        if let Ok(scene) = Scene::from_bytes(&changed) {
            _ = pose::link_poses(&scene.head, |_| Some(1.0));
        }
    }
    let later = scene(&sphere(3), &[]);
    let later = Scene {
        head: Head {
            format: 99,
            ..later.head
        },
        ..later
    };
    let refused = Scene::from_bytes(&later.to_bytes().unwrap()).unwrap_err();
    assert!(refused.to_string().contains("export again"), "{refused}");
}

/// A frame of four rods of which one is the distance of two points, and a spring to the world.
fn four_bar() -> Scene {
    let link = |name: &str| {
        format!(
            "<link name=\"{name}\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" \
             izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>"
        )
    };
    let joint = |name: &str, child: &str, xyz: &str| {
        format!(
            "<joint name=\"{name}\" type=\"continuous\"><parent link=\"frame\"/>\
             <child link=\"{child}\"/><origin xyz=\"{xyz}\"/><axis xyz=\"0 1 0\"/></joint>"
        )
    };
    let text = [
        "<robot name=\"bars\">".to_owned(),
        link("frame"),
        link("left"),
        link("right"),
        joint("a", "left", "0 0 0"),
        joint("b", "right", "2 0 0"),
        "</robot>".to_owned(),
    ]
    .concat();
    let settings = "[robot]\nbase = \"fixed\"\n[initial]\nxyz = [0, 0, 3]\n\
         [[loop]]\nname = \"rod\"\ntype = \"distance\"\nlinks = [\"left\", \"right\"]\n\
         origins = [[0, 0, 1], [0, 0, 1]]\nlength = 2.0\n\
         [[spring]]\nname = \"coil\"\nlinks = [\"world\", \"right\"]\n\
         origins = [[2, 0, 6], [0, 0, 1]]\nlength = 1.5\nstiffness = 10.0\n";
    let settings = urdf2fmu_core::settings::Settings::parse(settings, "bars.toml").unwrap();
    let options = urdf2fmu_core::urdf::ReadOptions::default();
    let read =
        urdf2fmu_core::urdf::read_str(&text, "bars.urdf", std::path::Path::new(""), &options)
            .unwrap();
    let model = urdf2fmu_core::assemble::build(&read, &settings)
        .unwrap()
        .model;
    let table = urdf2fmu_core::variables::table(&model).unwrap();
    super::make(&[("", &read)], &model, &table, Vec::new(), Vec::new(), "").unwrap()
}

/// A rod goes from point to point, as long as the loop says, wherever the joints are, and so does
/// a spring, whose other end stays in the world.
#[test]
fn rods_and_springs_go_from_point_to_point() {
    let scene = four_bar();
    let again = Scene::from_bytes(&scene.to_bytes().unwrap()).unwrap();
    assert_eq!(again, scene);
    let ties = &scene.head.ties;
    let names: Vec<&str> = ties.iter().map(|tie| tie.name.as_str()).collect();
    assert_eq!(names, ["rod", "coil"]);
    for angle in [0.0, 0.3, -1.2, 2.0] {
        let value = |name: &str| name.starts_with("joint.").then_some(angle);
        let poses = pose::link_poses(&scene.head, value);
        let (sin, cos) = f64::sin_cos(angle);
        // About y the tip goes from z to x.
        let tips = [0.0, 2.0].map(|x| Vec3::new(x + sin, 0.0, 3.0 + cos));
        let ends = [[tips[0], tips[1]], [Vec3::new(2.0, 0.0, 6.0), tips[1]]];
        for (tie, [from, to]) in ties.iter().zip(ends) {
            let (X_WT, length) = super::between(&tie.ends, &poses);
            let along = X_WT.R * Vec3::z() * (0.5 * length);
            assert!(
                (X_WT.p - along - from).norm() < 1e-6,
                "{} {angle}",
                tie.name
            );
            assert!((X_WT.p + along - to).norm() < 1e-6, "{} {angle}", tie.name);
        }
        let (_, length) = super::between(&ties[0].ends, &poses);
        assert!((length - 2.0).abs() < 1e-6);
    }
}

/// What is drawn is 1 m long along z, so that stretching makes it reach both ends.
#[test]
fn the_coil_of_a_spring_is_a_metre_long_and_ends_on_its_axis() {
    let scene = four_bar();
    let Shape::Mesh(mesh) = scene.head.ties[1].shape else {
        panic!("{:?}", scene.head.ties[1].shape);
    };
    let coil = scene.triangles(&scene.head.meshes[mesh]).unwrap();
    let heights = coil.positions.iter().map(|p| p[2]);
    let [low, high] = [
        heights.clone().fold(0.0, f64::min),
        heights.fold(0.0, f64::max),
    ];
    assert!(
        (low + 0.5).abs() < 0.01 && (high - 0.5).abs() < 0.01,
        "{low} {high}"
    );
    // Across, from the axis: of the corners of its ends, and of all.
    let across = |p: &[f64; 3]| p[0].hypot(p[1]);
    let ends = coil.positions.iter().filter(|p| p[2].abs() > 0.49);
    assert!(ends.map(across).fold(0.0, f64::max) < 0.3);
    let all = coil.positions.iter().map(across).fold(0.0, f64::max);
    assert!((1.0..1.2).contains(&all), "{all}");
}

#[test]
fn rods_that_hang_on_nothing_are_refused() {
    let scene = four_bar();
    let mut broken = scene.clone();
    broken.head.ties[0].ends[1].link = Some(3);
    assert!(Scene::from_bytes(&broken.to_bytes().unwrap()).is_err());
    let mut broken = scene;
    broken.head.ties[1].shape = Shape::Mesh(9);
    assert!(Scene::from_bytes(&broken.to_bytes().unwrap()).is_err());
}

/// A chain of links 1 cm apart, with a base and without any shape.
fn chain(links: usize, kind: &str) -> Vec<Drawn> {
    let link = |i: usize| {
        format!(
            "<link name=\"l{i}\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" \
             ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link><joint name=\"j{i}\" type=\"{kind}\">\
             <origin xyz=\"0.01 0 0\"/><parent link=\"l{}\"/><child link=\"l{i}\"/></joint>",
            i - 1
        )
    };
    let others: String = (1..links).map(link).collect();
    let text = format!("<robot name=\"c\"><link name=\"l0\"/>{others}</robot>");
    let options = urdf2fmu_core::urdf::ReadOptions::default();
    let read = urdf2fmu_core::urdf::read_str(&text, "c.urdf", std::path::Path::new(""), &options);
    let read = read.unwrap();
    let settings = urdf2fmu_core::settings::Settings::default();
    let model = urdf2fmu_core::assemble::build(&read, &settings)
        .unwrap()
        .model;
    let table = urdf2fmu_core::variables::table(&model).unwrap();
    let scene = super::make(&[("", &read)], &model, &table, Vec::new(), Vec::new(), "").unwrap();
    scene.head.visuals
}

/// Each ball has thousands of triangles: where they lay within each other, a picture of 500 links
/// took 10 s and 950 MB. In a row that just touch, balls of n links are 1/2n of its length, so that
/// rods are seen between them; welded links need none.
#[test]
fn links_without_shapes_are_balls_that_do_not_lie_in_each_other() {
    for (links, kind, balls) in [
        (5, "continuous", 5),
        (60, "continuous", 60),
        (60, "fixed", 1),
    ] {
        let drawn = chain(links, kind);
        let radii = drawn.iter().filter_map(|one| match one.shape {
            Shape::Sphere(radius) => Some(radius),
            _ => None,
        });
        let radii: Vec<f64> = radii.collect();
        assert_eq!(radii.len(), balls, "{links} {kind}");
        assert!(
            radii.iter().all(|r| *r <= 0.5 * 0.01),
            "{links} {kind}: {radii:?}"
        );
        assert_eq!(drawn.len() - balls, links - 1, "rods: {links} {kind}");
    }
}
