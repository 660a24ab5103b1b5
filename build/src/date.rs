//! The date that an FMU bears.

/// `generationDateAndTime`: `SOURCE_DATE_EPOCH` (seconds since 1970) where it is set, else the zip
/// format's first day, so that the same robot gives the same bytes on every day.
pub fn text(source_date_epoch: Option<&str>) -> String {
    /// 1980-01-01T00:00:00Z
    const FIXED: i64 = 315_532_800;
    let seconds = source_date_epoch
        .and_then(|text| text.trim().parse().ok())
        // Four digits for the year.
        .filter(|s| (0..253_402_300_800).contains(s))
        .unwrap_or(FIXED);
    let (days, second) = (seconds.div_euclid(86_400), seconds.rem_euclid(86_400));
    // Days since 1970 to a Gregorian date, by eras of 400 years that begin on a first of March, so
    // that the leap day is the last day of its year.
    let z = days + 719_468;
    let (era, day_of_era) = (z.div_euclid(146_097), z.rem_euclid(146_097));
    let year_of_era =
        (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = (month_from_march + 2) % 12 + 1;
    let year = era * 400 + year_of_era + i64::from(month <= 2);
    format!(
        "{year:04}-{month:02}-{day:02}T{:02}:{:02}:{:02}Z",
        second / 3600,
        second / 60 % 60,
        second % 60
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Expected values: `date -u -d @SECONDS`.
    #[test]
    fn date_follows_the_calendar() {
        for (seconds, expected) in [
            ("0", "1970-01-01T00:00:00Z"),
            ("951782399", "2000-02-28T23:59:59Z"),
            ("951782400", "2000-02-29T00:00:00Z"),
            ("1709208000", "2024-02-29T12:00:00Z"),
            ("4107542400", "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(text(Some(seconds)), expected);
        }
    }

    #[test]
    fn the_date_is_1980_without_a_valid_source_date_epoch() {
        for nothing in [
            None,
            Some(""),
            Some("-1"),
            Some("tomorrow"),
            Some("99999999999999999"),
        ] {
            assert_eq!(text(nothing), "1980-01-01T00:00:00Z");
        }
    }
}
