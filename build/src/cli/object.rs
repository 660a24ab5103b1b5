//! `--object`: a file, and where it is.

use std::path::PathBuf;
use urdf2fmu_core::diagnostic::angles;
use urdf2fmu_core::range::Range;
use urdf2fmu_core::settings::{InitialSettings, LinkSettings, ObjectSettings, ObjectSource};
use urdf2fmu_core::spatial::Vec3;

/// `cube.urdf`, `cube.urdf@1,0` or `cube.urdf@1,0,0.5,0,0,1.57`.
pub(super) fn parse(text: &str) -> Result<ObjectSettings, String> {
    // A file, or a folder, may have such a sign in its name, too.
    let numeric = |c: char| c.is_ascii_digit() || "+-.,eE ".contains(c);
    let is_place = |text: &str| {
        let listed = text.contains(',') && !text.contains(['/', '\\']);
        listed || text.chars().all(numeric)
    };
    let (file, place) = match text.rsplit_once('@') {
        Some((file, place)) if is_place(place) => (file, Some(place)),
        _ => (text, None),
    };
    // Else the nearest name would be offered, which lacks the place.
    let mut signs = text.match_indices([' ', ':', ';', '@', '#']);
    let begins = signs.find(|(at, _)| PathBuf::from(&text[..*at]).is_file());
    if let (Some((at, _)), false) = (begins, PathBuf::from(file).exists()) {
        let file = &text[..at];
        return Err(format!(
            "a place follows the sign @: {file}@X,Y or {file}@X,Y,Z"
        ));
    }
    let number = |part: &str| {
        let number = part.trim().parse().ok();
        number.filter(|number| Range::Position.contains(*number))
    };
    let numbers = place.map_or(Some(Vec::new()), |place| {
        place.split(',').map(number).collect::<Option<Vec<f64>>>()
    });
    let numbers = numbers.ok_or_else(|| {
        let legal = Range::Position.expected();
        format!("each number of the place must be {legal}")
    })?;
    if file.is_empty() || !matches!(numbers.len(), 0 | 2 | 3 | 6) {
        return Err(
            "give a file and its place in m and rad: FILE, FILE@X,Y, FILE@X,Y,Z or \
             FILE@X,Y,Z,ROLL,PITCH,YAW"
                .to_owned(),
        );
    }
    let rpy = numbers.get(3..).unwrap_or_default();
    if let Some(message) = angles::attitude("the attitude's", rpy) {
        return Err(format!("{message}; {}", angles::HELP));
    }
    let at = |i: usize| numbers.get(i).copied();
    let or_zero = |i: usize| at(i).unwrap_or_default();
    Ok(ObjectSettings {
        idle_mass: None,
        name: None,
        source: ObjectSource::Urdf(PathBuf::from(file)),
        conveyor: false,
        driven: false,
        initial: InitialSettings {
            xy: [or_zero(0), or_zero(1)],
            z: at(2),
            rpy: Vec3::new(or_zero(3), or_zero(4), or_zero(5)),
            ..InitialSettings::default()
        },
        fixed: false,
        surface: LinkSettings::new("*"),
        file_place: None,
        place: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_has_two_three_or_six_numbers_or_is_left_out() {
        let place = |text: &str| {
            let object = parse(text).expect(text);
            let initial = object.initial;
            let ObjectSource::Urdf(file) = object.source else {
                panic!("{text}")
            };
            let file = file.display().to_string();
            (file, initial.xy, initial.z, initial.rpy)
        };
        let level = Vec3::zeros();
        let cube = || "cube.urdf".to_owned();
        assert_eq!(place("cube.urdf"), (cube(), [0.0, 0.0], None, level));
        assert_eq!(place("cube.urdf@1,-2"), (cube(), [1.0, -2.0], None, level));
        let high = (cube(), [1.0, 0.0], Some(0.5), level);
        assert_eq!(place("cube.urdf@1,0,0.5"), high);
        let turned = (cube(), [1.0, 0.0], Some(0.5), Vec3::new(0.0, 0.0, 1.57));
        assert_eq!(place("cube.urdf@1,0,5e-1,0,0,1.57"), turned);
        // A file may be named so.
        let odd = ("a@b.urdf".to_owned(), [1.0, 2.0], None, level);
        assert_eq!(place("a@b.urdf@1,2"), odd);
        assert_eq!(place("a@b.urdf").0, "a@b.urdf");
        assert_eq!(place("a@b,c/d.urdf").0, "a@b,c/d.urdf");
    }

    /// As in the settings: two turns are 12.566 rad.
    #[test]
    fn an_attitude_in_degrees_is_refused() {
        for rpy in ["0,0,90", "-45,0,0", "0,12.6,0"] {
            let why = parse(&format!("cube.urdf@1,0,0.5,{rpy}")).expect_err(rpy);
            assert!(why.contains("degrees are 1.5708"), "{rpy}: {why}");
        }
        assert!(parse("cube.urdf@90,-45,30,0,12.5,-3.2").is_ok());
    }

    #[test]
    fn other_counts_and_numbers_out_of_range_are_told() {
        for text in ["", "@1,2", "a@1", "a@1,2,3,4", "a@1,2,3,4,5,6,7"] {
            let why = parse(text).expect_err(text);
            assert!(why.contains("FILE@X,Y,Z"), "{text}: {why}");
        }
        for text in ["a@", "a@1,2,", "a@1,e", "a@1,1e300", "a@nan,0", "a@1,x,0"] {
            let why = parse(text).expect_err(text);
            assert!(why.contains("each number"), "{text}: {why}");
        }
    }
}
