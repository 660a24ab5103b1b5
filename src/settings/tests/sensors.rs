//! `[[sensor]]`.

#![expect(clippy::float_cmp, reason = "exact numbers are expected")]

use super::*;

#[test]
fn a_sensor_has_errors_and_samples_on_request() {
    let settings = parse(
        "[[sensor]]\ntype = \"imu\"\nlink = \"a\"\nrate = 100\nseed = 5\n\
         angular_velocity = { bias = [1, 2, 3], noise_density = [0.1, 0.2, 0.3] }\n\
         [[sensor]]\ntype = \"ray\"\nlink = \"a\"\nname = \"b\"\ndistance.bias = 0.5\n",
    );
    let [imu, ray] = &settings.sensors[..] else {
        panic!("{:?}", settings.sensors);
    };
    assert_eq!((imu.rate, imu.seed), (Some(100.0), 5));
    assert_eq!(imu.errors[0].bias, [1.0, 2.0, 3.0]);
    // A density times the root of 100 samples a second.
    for (noise, expected) in imu.errors[0].noise.into_iter().zip([1.0, 2.0, 3.0]) {
        assert!((noise - expected).abs() < 1e-15, "{noise}");
    }
    assert_eq!(imu.errors[1], Errors::default());
    assert_eq!((ray.rate, ray.errors[0].bias[0]), (None, 0.5));
}

/// Code, line, and a word of the message or the help.
#[test]
fn sensors_refuse_what_they_cannot_be() {
    let imu = "type = \"imu\"\nlink = \"a\"\n";
    let ray = "type = \"ray\"\nlink = \"a\"\n";
    let encoder = "type = \"encoder\"\njoint = \"a\"\n";
    for (table, text, code, line, word) in [
        ("", "link = \"a\"", "S107", 1, "encoder"),
        ("", "type = \"imu\"", "S107", 1, "link"),
        ("", "type = \"sonar\"\nlink = \"a\"", "S104", 2, "ray"),
        (imu, "rate = 0", "S104", 4, "1e-3"),
        (imu, "rate = -5", "S104", 4, "1e-3"),
        (imu, "rate = nan", "S104", 4, "nan"),
        (imu, "seed = 2", "S106", 4, "noise"),
        (imu, "rate = 9\nseed = 2", "S106", 5, "noise"),
        (
            imu,
            "rate = 9\nseed = 2\nangular_velocity.bias = [1, 1, 1]",
            "S106",
            5,
            "noise",
        ),
        (
            encoder,
            "counts = 10\nrate = 9\nseed = 2",
            "S106",
            6,
            "noise",
        ),
        (imu, "rays = 2", "S106", 4, "imu"),
        (
            imu,
            "linear_acceleration.noise = [1, 1, 1]",
            "S107",
            4,
            "rate",
        ),
        (imu, "force.bias = [1, 1, 1]", "S106", 4, "imu"),
        (
            imu,
            "rate = 1\nlinear_acceleration.noise = [-1, 1, 1]",
            "S104",
            5,
            "0.0",
        ),
        (
            imu,
            "rate = 1\nlinear_acceleration.noise = [1, 1]",
            "S103",
            5,
            "3",
        ),
        (
            imu,
            "rate = 1\nlinear_acceleration = { noise = [1, 1, 1], noise_density = [1, 1, 1] }",
            "S106",
            5,
            "twice",
        ),
        (ray, "rays = 0", "S104", 4, "1"),
        (ray, "range = -1", "S104", 4, "1e-9"),
        (ray, "range = nan", "S104", 4, "nan"),
        (ray, "range = 2\nmin_range = 2", "S106", 5, "below"),
        (
            ray,
            "rays = 200\nfov = 1\nrows = 200\nvertical_fov = 1",
            "S106",
            6,
            "10000",
        ),
        (ray, "vertical_fov = 1", "S106", 4, "rows"),
        (ray, "distance.noise = 0.1", "S107", 4, "rate"),
        (encoder, "", "S107", 1, "counts"),
        (encoder, "counts = 0", "S104", 4, "1e-3"),
        (encoder, "counts = 10\nrange = 1", "S106", 5, "encoder"),
        (
            "",
            "type = \"contact\"\nlink = \"a\"\nsize = [0, 1, 1]",
            "S104",
            4,
            "1e-9",
        ),
    ] {
        let found = finding(&format!("[[sensor]]\n{table}{text}\n"));
        let said = format!("{} {:?}", found.message, found.help);
        let at = found.place.as_ref().map(|p| p.line);
        assert_eq!((found.code, at), (code, Some(line)), "{text}: {said}");
        assert!(said.to_lowercase().contains(word), "{text}: {said}");
    }
}

/// What is left is checked further; what was told here must not be told again as wrong there.
#[test]
fn what_a_sensor_was_told_to_be_wrong_in_is_left_out() {
    let text = "[[sensor]]\ntype = \"imu\"\nlink = \"a\"\nlinear_acceleration.noise = [1, 1, 1]\n\
                [[sensor]]\ntype = \"ray\"\nlink = \"a\"\nname = \"b\"\nrange = 1\nmin_range = 2\n\
                rays = 200\nrows = 200\n";
    let (settings, findings) = Settings::read_by(Reader::new("f", text), None);
    assert_eq!(findings.len(), 3, "{findings:?}");
    let sensors = settings.expect("the rest").sensors;
    assert_eq!(sensors[0].errors, [Errors::default(); 2]);
    let SensorSettingsKind::Ray {
        rows, near, range, ..
    } = &sensors[1].kind
    else {
        panic!("{sensors:?}");
    };
    assert!(near < range && rows.count == 1, "{sensors:?}");
}
