//! Tests of terrain files and settings that can be read, but are meant otherwise, and of what is
//! advised about those that cannot.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use super::*;

/// A shape, with all that is told of it.
fn told(file: &Path, mesh: bool) -> Vec<Diagnostic> {
    let settings = if mesh {
        TerrainSettings::Mesh {
            file: file.to_owned(),
            scale: 1.0,
        }
    } else {
        TerrainSettings::Heights {
            source: HeightSource::File(file.to_owned()),
            size: [2.0, 2.0],
            height: None,
        }
    };
    match shape("t", &settings, None) {
        Ok((shape, _, mut notes)) => {
            notes.extend(findings("t", &shape, &Vec3::zeros(), None));
            notes
        }
        Err(finding) => vec![*finding],
    }
}

#[test]
fn advice_about_meshes_is_that_for_their_fault() {
    let folder = tempfile::tempdir().unwrap();
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let utf_16: Vec<u8> = ("\u{feff}".to_owned() + obj)
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1,5 0 0\n";
    let cases: [(&str, &[u8], &str, &str); 8] = [
        (
            "a.obj",
            b"v 0 0 0\nv 1,5 0 0\n",
            "line 2: '1,5' is not a number: the decimal sign is a point",
            "correct what is named",
        ),
        (
            "b.stl",
            stl.as_bytes(),
            "'1,5' is not a number: the decimal sign is a point",
            "correct what is named",
        ),
        (
            "c.obj",
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
            "line 4: there is no vertex '9'",
            "correct what is named",
        ),
        ("d.obj", &utf_16, "text in UTF-16", "save it as UTF-8"),
        (
            "e.gltf",
            b"{\"asset\":{\"version\":\"1.0\"}}",
            "it is glTF 1.0; glTF 2 is read",
            "export the mesh again",
        ),
        (
            "f.obj",
            b"<html></html>",
            "a web page",
            "put the mesh itself",
        ),
        ("g.obj", b"", "the file is empty", "it is not whole"),
        (
            "h.step",
            b"ISO-10303-21;",
            "'.step' files are not read",
            "STL",
        ),
    ];
    for (name, bytes, message, help) in cases {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let found = told(&path, true);
        let [found] = &found[..] else {
            panic!("{name}: {found:?}")
        };
        assert!(
            found.code == "T002" && found.message.contains(message),
            "{found:?}"
        );
        assert!(found.help.as_ref().unwrap().contains(help), "{found:?}");
    }
    // A name in other letters.
    std::fs::write(folder.path().join("hall.obj"), obj).unwrap();
    let found = told(&folder.path().join("halls.obj"), true);
    assert_eq!(found[0].code, "T001", "{found:?}");
    assert!(found[0].message.contains("did you mean"), "{found:?}");
}

/// A grid of 2 x 2 points with their heights; heights of as many columns that are none.
#[test]
fn tables_of_points_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.csv");
    for (text, points) in [
        ("0,0,0.5\n0,1,0.6\n1,0,0.7\n1,1,0.8\n", true),
        ("-1 2 0\n-1 3 0\n-1 4 0\n0.5 2 0\n0.5 3 0\n0.5 4 1\n", true),
        // A point twice, one that is missing, a single row of points, and no points.
        ("0,0,0.5\n0,1,0.6\n1,0,0.7\n1,0,0.8\n", false),
        ("0,0,0.5\n0,1,0.6\n1,0,0.7\n", false),
        ("0,0,0.5\n0,1,0.6\n0,2,0.7\n", false),
        (
            "0.1,0.2,0.5\n0.3,0.1,0.6\n0.2,0.4,0.7\n0.3,0.3,0.1\n",
            false,
        ),
        ("0,0,0,0\n0,1,0,0\n1,0,0,0\n1,1,0,0\n", false),
    ] {
        std::fs::write(&path, text).unwrap();
        let found = told(&path, false);
        assert_eq!(
            found.iter().any(|d| d.code == "T006"),
            points,
            "{text}{found:?}"
        );
    }
}

#[test]
fn alpha_of_heights_that_is_not_opaque_is_told() {
    let folder = tempfile::tempdir().unwrap();
    for (alpha, dropped) in [(255, false), (128, true)] {
        let path = folder.path().join("a.png");
        let file = std::fs::File::create(&path).unwrap();
        let mut encoder = png::Encoder::new(file, 2, 2);
        encoder.set_color(png::ColorType::GrayscaleAlpha);
        let mut writer = encoder.write_header().unwrap();
        writer
            .write_image_data(&[9, 255, 9, 255, 9, 255, 9, alpha])
            .unwrap();
        writer.finish().unwrap();
        let found = told(&path, false);
        assert_eq!(found.iter().any(|d| d.code == "T007"), dropped, "{found:?}");
    }
}

#[test]
fn a_plane_upside_down_is_told() {
    use std::f64::consts::PI;
    for (rpy, down) in [
        ([0.0, 0.0, PI], false),
        ([0.0, 0.5 * PI - 1e-3, 0.0], false),
        ([0.0, PI, 0.0], true),
        ([PI, 0.0, 0.0], true),
        ([0.0, PI - 3e-6, 0.0], true),
    ] {
        let found = findings("t", &Shape::Plane, &Vec3::from(rpy), None);
        assert_eq!(found.iter().any(|d| d.code == "T003"), down, "{rpy:?}");
    }
}

/// `numpy.save` twice into one file writes one array behind the other, and `numpy.load` reads the
/// first one alone.
#[test]
fn bytes_behind_the_array_of_an_npy_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2), }";
    let header = format!("{header:<117}\n");
    let mut array = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    array.extend(header.as_bytes());
    array.extend([0; 16]);
    for (bytes, behind) in [
        (array.clone(), None),
        ([array.clone(), array.clone()].concat(), Some(144)),
        ([array, vec![7]].concat(), Some(1)),
    ] {
        let path = folder.path().join("a.npy");
        std::fs::write(&path, bytes).unwrap();
        let found = told(&path, false);
        let found = found.iter().find(|d| d.code == "T007");
        assert_eq!(found.is_some(), behind.is_some(), "{found:?}");
        if let (Some(found), Some(behind)) = (found, behind) {
            let part = format!("{behind} bytes behind its array are not used");
            assert!(found.message.contains(&part), "{found:?}");
            assert_eq!(found.severity, Severity::Warning);
        }
    }
}

/// A wave from its trough in the middle rises by ½ (1 − cos π x) at half of the extent: x = ½ gives
/// half of its height.
#[test]
fn waves_without_a_crest_are_told_with_how_high_they_rise() {
    use urdf2fmu_core::settings::GeneratedHeights;
    let told = |wavelength: f64, form: HeightForm| {
        let made = GeneratedHeights {
            form,
            resolution: 0.1,
            wavelength,
            seed: 1,
            steps: 5,
        };
        let settings = TerrainSettings::Heights {
            source: HeightSource::Generated(made),
            size: [4.0, 20.0],
            height: Some(0.3),
        };
        let (shape, _, notes) = shape("t", &settings, None).unwrap();
        let Shape::Field { field } = shape else {
            panic!("{shape:?}")
        };
        let heights = field.samples().heights.iter().copied();
        (notes, heights.fold(0.0, f64::max))
    };
    assert!(told(4.0, HeightForm::Waves).0.is_empty());
    assert!(told(8.0, HeightForm::Noise).0.is_empty());
    let (notes, highest) = told(8.0, HeightForm::Waves);
    assert!((highest - 0.15).abs() < 1e-12, "{highest}");
    assert_eq!(notes[0].code, "T008");
    let part = "a wave of 8 m is longer than its extent of 4 m along x: it has no crest, and rises to \
                0.15 m instead of 0.3 m";
    assert!(notes[0].message.contains(part), "{notes:?}");
}
