//! Tests of terrain from files and formulas.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use super::*;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use urdf2fmu_core::geometry::field::Samples;
use urdf2fmu_core::settings::{GeneratedHeights, HeightForm};

fn shape(
    name: &str,
    settings: &TerrainSettings,
    place: Option<&Place>,
) -> Result<Shape, Box<Diagnostic>> {
    Ok(super::shape(name, settings, place)?.0)
}

/// A grey PNG, row by row from the top.
fn png(width: u32, rows: &[u8], depth: png::BitDepth) -> Vec<u8> {
    let each = if depth == png::BitDepth::Sixteen {
        2
    } else {
        1
    };
    let height = u32::try_from(rows.len()).unwrap() / each / width;
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(rows).unwrap();
    writer.finish().unwrap();
    bytes
}

/// An NPY file as `numpy.save` writes it, version 1.0.
fn npy(kind: &str, columns_first: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if columns_first { "True" } else { "False" };
    let header = format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(u16::try_from(header.len()).unwrap().to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

fn heights_of(path: PathBuf, height: Option<f64>) -> Result<Samples, Box<Diagnostic>> {
    let settings = TerrainSettings::Heights {
        source: HeightSource::File(path),
        size: [2.0, 4.0],
        height,
    };
    match shape("hills", &settings, None)? {
        Shape::Field { field } => Ok(field.samples().clone()),
        other => panic!("{other:?}"),
    }
}

fn write(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn heights_are_read_from_images_tables_and_arrays() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str, bytes: &[u8]| write(folder.path(), name, bytes);
    // 3 x 2: the upper row of an image is at the larger y.
    let image = png(3, &[0, 51, 255, 102, 153, 204], png::BitDepth::Eight);
    let samples = heights_of(at("a.png", &image), Some(5.0)).unwrap();
    assert_eq!((samples.counts, samples.size), ([3, 2], [2.0, 4.0]));
    let expected = [2.0, 3.0, 4.0, 0.0, 1.0, 5.0];
    for (found, expected) in samples.heights.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-12, "{:?}", samples.heights);
    }
    let wide: Vec<u8> = [0_u16, 1, 65535, 32768]
        .iter()
        .flat_map(|x| x.to_be_bytes())
        .collect();
    let image = png(2, &wide, png::BitDepth::Sixteen);
    let samples = heights_of(at("b.PNG", &image), None).unwrap();
    assert_eq!(
        samples.heights,
        [1.0, 32768.0 / 65535.0, 0.0, 1.0 / 65535.0]
    );

    let table = "# heights in m\n0.5, \"1\", 1.5\n-2, 2.5e-1, 3,\n\n";
    let samples = heights_of(at("c.csv", table.as_bytes()), Some(2.0)).unwrap();
    assert_eq!(samples.heights, [1.0, 2.0, 3.0, -4.0, 0.5, 6.0]);
    let samples = heights_of(at("d.txt", b"1 2\n3\t4\n"), None).unwrap();
    assert_eq!(samples.heights, [1.0, 2.0, 3.0, 4.0]);

    let data: Vec<u8> = [1.5_f64, 2.0, 3.0, 4.0, 5.0, 6.0]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let array = npy("<f8", false, "(2, 3)", &data);
    let samples = heights_of(at("e.npy", &array), None).unwrap();
    assert_eq!(
        (samples.counts, &samples.heights[..2]),
        ([3, 2], &[1.5, 2.0][..])
    );
    let array = npy("<f8", true, "(2, 3)", &data);
    let samples = heights_of(at("f.npy", &array), None).unwrap();
    assert_eq!(samples.heights, [1.5, 3.0, 5.0, 2.0, 4.0, 6.0]);
    let data: Vec<u8> = [1_i16, -2, 3, 4]
        .iter()
        .flat_map(|x| x.to_be_bytes())
        .collect();
    let array = npy(">i2", false, "(2, 2)", &data);
    let samples = heights_of(at("g.npy", &array), None).unwrap();
    assert_eq!(samples.heights, [1.0, -2.0, 3.0, 4.0]);
    // What NumPy's float16 makes of these numbers.
    let data: Vec<u8> = [0x3c00_u16, 0xc580, 0x0001, 0x7bff]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let array = npy("<f2", false, "(2, 2)", &data);
    let samples = heights_of(at("h.npy", &array), None).unwrap();
    let least = 5.960_464_477_539_063e-8;
    assert_eq!(samples.heights, [1.0, -5.5, least, 65504.0]);
}

#[test]
fn files_without_usable_heights_are_errors_that_say_why() {
    let folder = tempfile::tempdir().unwrap();
    let one = npy("<f8", false, "(4,)", &[0; 32]);
    let short = npy("<f8", false, "(2, 3)", &[0; 32]);
    let text = npy("<U4", false, "(2, 2)", &[0; 64]);
    let colour = {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().unwrap();
        writer
            .write_image_data(&[1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 1, 1])
            .unwrap();
        writer.finish().unwrap();
        bytes
    };
    // Two colours and a third of one, of which each row takes the last.
    let palette = {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_palette(vec![0, 0, 0, 9, 9, 9, 1]);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&[0, 1, 2, 1]).unwrap();
        writer.finish().unwrap();
        bytes
    };
    let broken = &png(2, &[0, 1, 2, 3], png::BitDepth::Eight)[..40];
    let row = png(4, &[0, 1, 2, 3], png::BitDepth::Eight);
    let cases: [(&str, &[u8], &str, &str); 16] = [
        (
            "a.csv",
            b"1, 2\n3, x\n",
            "T002",
            "line 2, column 2: 'x' is no number",
        ),
        (
            "b.csv",
            b"1, 2\n3, 4, 5\n",
            "T002",
            "line 2 has 3 heights, the lines before have 2",
        ),
        (
            "c.csv",
            b"1, 2\n3, nan\n",
            "T002",
            "height 2 of row 2 is not a finite number",
        ),
        ("d.csv", b"1\n", "T002", "1 x 1 heights"),
        ("e.csv", b"", "T002", "0 x 0 heights"),
        ("f.csv", b"\xff\xfe1,2", "T002", "no text"),
        ("g.npy", &one, "T002", "two dimensions"),
        ("h.npy", &short, "T002", "ends early"),
        ("i.npy", &text, "T002", "neither integers nor"),
        ("j.npy", b"PK\x03\x04", "T002", "no NPY file"),
        ("k.png", &colour, "T002", "pixel 1 of row 2 has a colour"),
        ("l.png", broken, "T002", "cannot be read"),
        ("m.png", &row, "T002", "4 x 1 heights"),
        ("o.png", &palette, "T002", "palette has 7 bytes"),
        ("n.tif", b"II*\0", "T002", "'tif' is no kind of file"),
        (
            "p.csv",
            b"1,5;2,5\n3,5;4,5\n",
            "T002",
            "line 1 has commas and semicolons",
        ),
    ];
    for (name, bytes, code, part) in cases {
        let path = write(folder.path(), name, bytes);
        let error = heights_of(path, None).unwrap_err();
        assert!(
            error.code == code && error.message.contains(part),
            "{name}: {error:?}"
        );
        assert!(
            error.message.contains(name) && error.help.is_some(),
            "{error:?}"
        );
    }
    for path in [folder.path().join("none.csv"), folder.path().to_owned()] {
        let error = heights_of(path, None).unwrap_err();
        assert_eq!(error.code, "T001", "{error:?}");
    }
    let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n";
    let error = heights_of(write(folder.path(), "lfs.png", pointer), None).unwrap_err();
    assert!(error.message.contains("Git LFS"), "{error:?}");
    let error = heights_of(folder.path().join("lfss.png"), None).unwrap_err();
    assert!(error.message.contains("did you mean"), "{error:?}");
}

#[test]
fn heights_that_are_generated_are_what_their_words_say() {
    let heights = |form, seed| {
        let settings = TerrainSettings::Heights {
            source: HeightSource::Generated(GeneratedHeights {
                form,
                resolution: 0.25,
                wavelength: 2.0,
                seed,
                steps: 3,
            }),
            size: [6.0, 2.0],
            height: Some(0.9),
        };
        match shape("made", &settings, None).unwrap() {
            Shape::Field { field } => field.samples().clone(),
            other => panic!("{other:?}"),
        }
    };
    let ramp = heights(HeightForm::Ramp, 1);
    assert_eq!(ramp.counts, [25, 9]);
    // Even, up over the middle two metres, even.
    for (i, expected) in [(0, 0.0), (8, 0.0), (12, 0.45), (16, 0.9), (24, 0.9)] {
        assert!(
            (ramp.heights[i] - expected).abs() < 1e-12,
            "{i} {}",
            ramp.heights[i]
        );
    }
    let steps = heights(HeightForm::Steps, 1);
    for (i, expected) in [
        (0, 0.0),
        (5, 0.0),
        (6, 0.3),
        (12, 0.6),
        (18, 0.9),
        (24, 0.9),
    ] {
        assert!(
            (steps.heights[i] - expected).abs() < 1e-12,
            "{i} {}",
            steps.heights[i]
        );
    }
    let waves = heights(HeightForm::Waves, 1);
    for (i, x) in [(12, 0.0_f64), (14, 0.5), (16, 1.0)] {
        let expected = 0.45 * (1.0 - (std::f64::consts::PI * x).cos());
        assert!((waves.heights[i] - expected).abs() < 1e-12);
    }
    let noise = heights(HeightForm::Noise, 1);
    let low = noise.heights.iter().copied().fold(f64::INFINITY, f64::min);
    let high = noise
        .heights
        .iter()
        .copied()
        .fold(f64::NEG_INFINITY, f64::max);
    assert!(low.abs() < 1e-15 && (high - 0.9).abs() < 1e-15);
    assert_eq!(noise, heights(HeightForm::Noise, 1));
    assert_ne!(noise, heights(HeightForm::Noise, 2));
}

/// One square of 1 m at the height 0.5 m in each format: binary STL as Marshall Burns gives it,
/// ASCII STL, OBJ, PLY, and COLLADA 1.4 with the square placed by the matrix of a node.
#[test]
fn each_format_of_meshes_gives_the_same_terrain() {
    let folder = tempfile::tempdir().unwrap();
    let corners = [
        [0.0_f32, 0.0, 0.5],
        [1.0, 0.0, 0.5],
        [1.0, 1.0, 0.5],
        [0.0, 1.0, 0.5],
    ];
    let triangles = [[0, 1, 2], [0, 2, 3]];
    let mut binary = vec![0_u8; 80];
    binary.extend(2_u32.to_le_bytes());
    let mut ascii = "solid square\n".to_owned();
    for triangle in triangles {
        let normal = [0.0_f32, 0.0, 1.0];
        let places = triangle.map(|i: usize| corners[i]);
        for x in normal.iter().chain(places.iter().flatten()) {
            binary.extend(x.to_le_bytes());
        }
        binary.extend([0, 0]);
        ascii += "facet normal 0 0 1\nouter loop\n";
        for [x, y, z] in places {
            writeln!(ascii, "vertex {x} {y} {z}").unwrap();
        }
        ascii += "endloop\nendfacet\n";
    }
    ascii += "endsolid square\n";
    let obj = "v 0 0 0.5\nv 1 0 0.5\nv 1 1 0.5\nv 0 1 0.5\nf 1 2 3\nf 1 3 4\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
               property float z\nelement face 2\nproperty list uchar int vertex_indices\n\
               end_header\n0 0 0.5\n1 0 0.5\n1 1 0.5\n0 1 0.5\n3 0 1 2\n3 0 2 3\n";
    let dae = r##"<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="1"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">0 0 0 1 0 0 1 1 0 0 1 0</float_array>
<technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="2"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 0 2 3</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node>
<matrix>1 0 0 0 0 1 0 0 0 0 1 0.5 0 0 0 1</matrix>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"##;
    for (name, bytes) in [
        ("a.stl", &binary[..]),
        ("b.stl", ascii.as_bytes()),
        ("c.obj", obj.as_bytes()),
        ("d.ply", ply.as_bytes()),
        ("e.dae", dae.as_bytes()),
    ] {
        let file = write(folder.path(), name, bytes);
        let settings = TerrainSettings::Mesh { file, scale: 1.0 };
        let Shape::Surface { surface } = shape("hall", &settings, None).unwrap() else {
            panic!("{name}");
        };
        let facets = surface.facets();
        assert_eq!(facets.len(), 2, "{name}");
        for (facet, triangle) in facets.iter().zip(triangles) {
            for (found, i) in facet.corners.iter().zip(triangle) {
                let expected = Vec3::from(corners[i].map(f64::from));
                assert!((found - expected).norm() < 1e-15, "{name}: {found}");
            }
            assert!((facet.normal - Vec3::z()).norm() < 1e-15, "{name}");
        }
    }
}

#[test]
fn meshes_are_read_and_those_without_an_area_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = |name: &str, text: &str| {
        let file = write(folder.path(), name, text.as_bytes());
        shape("hall", &TerrainSettings::Mesh { file, scale: 2.0 }, None)
    };
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    let Shape::Surface { surface } = mesh("a.obj", square).unwrap() else {
        panic!("a mesh");
    };
    assert_eq!(surface.facets().len(), 2);
    assert!((surface.reach() - 8.0_f64.sqrt()).abs() < 1e-12);
    for (name, text, part) in [
        (
            "b.obj",
            "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
            "0 triangles with an area",
        ),
        ("c.stl", "", "c.stl"),
        ("d.fbx", "x", "d.fbx"),
    ] {
        let error = mesh(name, text).unwrap_err();
        assert!(
            error.code == "T002" && error.message.contains(part),
            "{error:?}"
        );
    }
}

/// Which way triangles look is the order of their corners, and the volume that a closed surface
/// encloses is `Σ a·(b × c)/6`.
#[test]
fn meshes_that_look_down_or_are_in_millimetres_are_told_of() {
    let folder = tempfile::tempdir().unwrap();
    let told = |scale: f64, text: &str| {
        let file = write(folder.path(), "a.obj", text.as_bytes());
        let settings = TerrainSettings::Mesh { file, scale };
        let shape = shape("hall", &settings, None).unwrap();
        let found = findings("hall", &shape, &Vec3::new(0.1, 0.0, 2.0), None);
        let brief = |f: &Diagnostic| (f.code, f.severity);
        (
            found.iter().map(brief).collect::<Vec<_>>(),
            format!("{found:?}"),
        )
    };
    let square = "v 0 0 0\nv 9 0 0\nv 9 9 0\nv 0 9 0\n";
    let warned = vec![("T003", Severity::Warning)];
    assert_eq!(told(1.0, &format!("{square}f 1 2 3 4\n")).0, []);
    let down = told(1.0, &format!("{square}f 4 3 2 1\n"));
    assert_eq!(down.0, warned);
    assert!(down.1.contains("its outside is down"), "{}", down.1);
    // One of two triangles.
    let half = told(1.0, &format!("{square}f 1 2 3\nf 4 3 1\n"));
    assert_eq!(half.0, warned);
    assert!(half.1.contains("50 %"), "{}", half.1);
    let large = told(1000.0, &format!("{square}f 1 2 3 4\n"));
    assert_eq!(large.0, [("T004", Severity::Warning)]);
    let cube = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
    let outside = "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    let inside = "f 1 2 3 4\nf 8 7 6 5\nf 5 6 2 1\nf 6 7 3 2\nf 7 8 4 3\nf 8 5 1 4\n";
    assert_eq!(told(1.0, &format!("{cube}{outside}")).0, []);
    let room = told(1.0, &format!("{cube}{inside}"));
    assert_eq!(room.0, [("T003", Severity::Note)]);
}

/// A closed wedge of 0.2 rad, whose slope is divided along its diagonal. While columns ran along
/// diagonals, too, lines of sight passed between its two triangles and met its underside alone:
/// its outside was said to be down.
#[test]
fn a_closed_wedge_has_its_outside_up() {
    let folder = tempfile::tempdir().unwrap();
    for angle in [0.2_f64, 0.5, 0.9] {
        let rise = 0.6 * angle.tan();
        let text = format!(
            "v -0.6 -0.4 0\nv -0.6 0.4 0\nv 0 -0.4 0\nv 0 0.4 0\nv -0.6 -0.4 {rise}\n\
             v -0.6 0.4 {rise}\nf 1 2 4\nf 1 4 3\nf 5 3 4\nf 5 4 6\nf 1 5 6\nf 1 6 2\n\
             f 1 3 5\nf 2 6 4\n"
        );
        for text in [text.replace("f 5 3 4\nf 5 4 6", "f 5 3 6\nf 3 4 6"), text] {
            let file = write(folder.path(), "wedge.obj", text.as_bytes());
            let settings = TerrainSettings::Mesh { file, scale: 1.0 };
            let shape = shape("wedge", &settings, None).unwrap();
            let found = findings("wedge", &shape, &Vec3::zeros(), None);
            assert!(found.is_empty(), "{rise}: {found:?}");
        }
    }
}

/// A floor of 9 by 9 squares of 1 m ends at its border, which is no hole. Of squares that are left
/// out, the larger hole is told of with its area and its middle, turned as the mesh is. A box
/// without a lid has no hole, and triangles that meet a longer edge leave none.
#[test]
fn holes_of_meshes_are_told_of_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let told = |text: &str, rpy: Vec3| {
        let file = write(folder.path(), "a.obj", text.as_bytes());
        let settings = TerrainSettings::Mesh { file, scale: 1.0 };
        let shape = shape("hall", &settings, None).unwrap();
        let found = findings("hall", &shape, &rpy, None);
        let found = found.iter().filter(|f| f.code == "T005");
        found.map(|f| f.message.clone()).collect::<Vec<_>>()
    };
    let floor = |left_out: &[(usize, usize)]| {
        let mut text = String::new();
        for (j, i) in (0..10).flat_map(|j| (0..10).map(move |i| (j, i))) {
            writeln!(text, "v {i} {j} 0.1").unwrap();
        }
        for (j, i) in (0..9).flat_map(|j| (0..9).map(move |i| (j, i))) {
            if !left_out.contains(&(i, j)) {
                let at = 10 * j + i + 1;
                let [b, c, d] = [at + 1, at + 11, at + 10];
                writeln!(text, "f {at} {b} {c} {d}").unwrap();
            }
        }
        text
    };
    let level = Vec3::zeros();
    assert!(told(&floor(&[]), level).is_empty());
    // At the border it is a bay.
    assert!(told(&floor(&[(0, 4)]), level).is_empty());
    let one = told(
        &floor(&[(2, 3)]),
        Vec3::new(0.0, 0.0, 0.5 * std::f64::consts::PI),
    );
    assert_eq!(one.len(), 1);
    assert!(
        one[0].contains("a hole of 1 m² about -3.5, 2.5, 0.1 m"),
        "{one:?}"
    );
    // Turned by 45 degrees its middle, at 4.5, 4.5, comes to 0, 4.5 √2 but for round-off.
    let turned = told(
        &floor(&[(4, 4)]),
        Vec3::new(0.0, 0.0, 0.25 * std::f64::consts::PI),
    );
    assert!(turned[0].contains("about 0, 6.364, 0.1 m"), "{turned:?}");
    let two = told(&floor(&[(2, 3), (6, 6), (7, 6)]), level);
    assert!(
        two[0].contains("2 holes, the largest of 2 m² about 7, 6.5, 0.1 m"),
        "{two:?}"
    );
    let corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
    let sides = "f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    assert!(told(&format!("{corners}{sides}"), level).is_empty());
    assert!(told(&format!("{corners}{sides}f 5 6 7 8\n"), level).is_empty());
    // Two squares beside one of twice their side.
    let joint = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 3 0 0\nv 3 1 0\nv 2 1 0\nv 3 2 0\n\
                 f 1 2 3 4\nf 2 5 6 7\nf 7 6 8 3\n";
    assert!(told(joint, level).is_empty());
}
