//! `[[world.terrain]]`.

use super::*;
use crate::settings::{GeneratedHeights, HeightForm, HeightSource, ObjectSource, TerrainSettings};

fn terrain(text: &str) -> TerrainSettings {
    let text = format!("[[world.terrain]]\nname = \"hills\"\n{text}");
    let settings = Settings::parse(&text, "f").expect("valid");
    let [object] = &settings.objects[..] else {
        panic!("one thing");
    };
    assert!(object.fixed && object.called() == "hills");
    // Terrain takes the place of a ground that nobody asked for.
    assert!(settings.world.ground.is_none());
    match &object.source {
        ObjectSource::Terrain(terrain) => terrain.clone(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn terrain_is_a_plane_heights_or_a_mesh() {
    assert_eq!(terrain("type = \"plane\""), TerrainSettings::Plane);
    let found = terrain("type = \"mesh\"\nfile = \"a.stl\"\nscale = 0.001");
    let file = found.file().expect("a file").to_owned();
    assert_eq!(found, TerrainSettings::Mesh { file, scale: 0.001 });
    let found = terrain("type = \"heightfield\"\nfile = \"a.png\"\nsize = [2, 3]\nheight = 4");
    let TerrainSettings::Heights {
        source: HeightSource::File(file),
        size,
        height,
    } = found
    else {
        panic!("{found:?}");
    };
    assert_eq!((size, height), ([2.0, 3.0], Some(4.0)));
    assert!(file.ends_with("a.png"));
    // Without them a hundredth and a tenth of the longer side.
    let found = terrain("type = \"heightfield\"\ngenerate = \"noise\"\nsize = [2, 3]\nseed = 7");
    let expected = TerrainSettings::Heights {
        source: HeightSource::Generated(GeneratedHeights {
            form: HeightForm::Noise,
            resolution: 0.03,
            wavelength: 0.3,
            seed: 7,
            steps: 5,
        }),
        size: [2.0, 3.0],
        height: None,
    };
    assert_eq!(found, expected);
}

#[test]
fn a_ground_that_is_asked_for_stays_beside_terrain() {
    let text = "[[world.terrain]]\nname = \"a\"\ntype = \"plane\"\n[world.ground]\nfriction = 0.5";
    let settings = Settings::parse(text, "f").expect("valid");
    let ground = settings.world.ground.expect("a ground");
    assert!((ground.friction - 0.5).abs() < 1e-15);
}

#[test]
fn terrain_refuses_what_means_nothing() {
    let field = "type = \"heightfield\"\nsize = [1, 1]\n";
    for (text, code, part) in [
        ("", "S107", "type"),
        ("type = \"hills\"", "S104", "hills"),
        ("type = \"mesh\"", "S107", "file"),
        ("type = \"plane\"\nfile = \"a.stl\"", "S106", "file"),
        ("type = \"plane\"\nsize = [1, 1]", "S106", "size"),
        (
            "type = \"mesh\"\nfile = \"a.stl\"\nseed = 1",
            "S106",
            "seed",
        ),
        ("type = \"heightfield\"\nfile = \"a.png\"", "S107", "size"),
        (
            "type = \"heightfield\"\nsize = [0, 1]\nfile = \"a.png\"",
            "S104",
            "size",
        ),
        (field, "S107", "generate"),
        (
            &format!("{field}file = \"a.png\"\ngenerate = \"noise\"") as &str,
            "S106",
            "twice",
        ),
        (
            &format!("{field}file = \"a.png\"\nsteps = 2"),
            "S106",
            "steps",
        ),
        (
            &format!("{field}generate = \"noise\"\nresolution = 1e-6"),
            "S106",
            "too fine",
        ),
        (
            &format!("{field}generate = \"noise\"\nheight = nan"),
            "S104",
            "height",
        ),
        (
            &format!("{field}generate = \"waves\"\nseed = 1"),
            "S106",
            "'seed' means nothing for generate = \"waves\"",
        ),
        (
            &format!("{field}generate = \"noise\"\nsteps = 3"),
            "S106",
            "steps",
        ),
        (
            &format!("{field}generate = \"ramp\"\nwavelength = 1"),
            "S106",
            "wavelength",
        ),
        (
            &format!("{field}generate = \"noise\"\nfoo = 1"),
            "S102",
            "foo",
        ),
    ] {
        let found = finding(&format!("[[world.terrain]]\nname = \"hills\"\n{text}"));
        assert!(
            found.code == code && found.message.contains(part),
            "{text}: {found:?}"
        );
        assert!(found.place.is_some());
    }
    let text = "[[world.object]]\nname = \"a\"\nshape = { sphere = 1 }\nmass = 1\nconveyor = true";
    assert_eq!(finding(text).code, "S106");
    // What else is computed of it does not fail by that.
    let (settings, _) = Settings::read_by(Reader::new("f", text), None);
    assert!(!settings.expect("the rest").objects[0].conveyor);
}

/// What is made of heights of 20 × 20 m, whatever is wrong with them, and what is.
fn made(form: &str, more: &str) -> (GeneratedHeights, Vec<Diagnostic>) {
    let text = format!(
        "[[world.terrain]]\nname = \"a\"\ntype = \"heightfield\"\ngenerate = \"{form}\"\n\
         size = [20, 20]\n{more}"
    );
    let (settings, findings) = Settings::read_by(Reader::new("f", &text), None);
    let settings = settings.expect("the rest");
    let ObjectSource::Terrain(TerrainSettings::Heights {
        source: HeightSource::Generated(made),
        ..
    }) = &settings.objects[0].source
    else {
        panic!("{settings:?}");
    };
    (made.clone(), findings)
}

#[test]
fn heights_that_are_too_fine_are_told_and_not_computed() {
    let (made, findings) = made("noise", "resolution = 1e-5");
    assert_eq!(findings.len(), 1, "{findings:?}");
    // What is right is built all the same, to find other errors: that must not take for ever.
    assert!(made.resolution > 0.01, "{made:?}");
}

/// Waves that were sampled once each came out flat, without a word.
#[test]
fn waves_are_sampled_or_refused() {
    for (form, more, resolution, codes) in [
        ("waves", "", 0.2, &[][..]),
        ("waves", "wavelength = 0.5", 0.05, &[]),
        ("noise", "wavelength = 0.1", 0.02, &[]),
        (
            "waves",
            "wavelength = 0.2\nresolution = 0.2",
            0.2,
            &["S106"],
        ),
        ("noise", "wavelength = 0.03", 0.02, &["S106"]),
        ("steps", "", 0.2, &[]),
    ] {
        let (made, findings) = made(form, more);
        let found = made.resolution;
        let told: Vec<_> = findings.iter().map(|finding| finding.code).collect();
        assert!(
            (found - resolution).abs() < 1e-12,
            "{form}, {more}: {found}"
        );
        assert_eq!(told, codes, "{form}, {more}");
    }
}
