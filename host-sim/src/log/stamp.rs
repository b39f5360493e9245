//! Times of day and dates as time stamps.

/// A stamp of a later century is no stamp.
const YEARS: std::ops::RangeInclusive<i64> = 1900..=2199;

/// Seconds of a date with a time of day (`2026-03-01T12:00:00.125Z`, `01.03.2026 12:00:00,125`,
/// `3/1/2026 12:00:00.125 PM`), or of a time of day or a running time alone (`12:00:00.125`, `00:01.5`).
/// An offset from Greenwich is left out: within one log it does not change.
pub(super) fn seconds(text: &str) -> Option<f64> {
    let text = text.trim();
    // Most cells are numbers: a stamp has a colon.
    if !text.contains(':') {
        return None;
    }
    match text.split_once(['T', ' ', '_']) {
        Some((day, time)) if day.len() >= 8 && !day.contains(':') => {
            Some(date(day)? as f64 * 86_400.0 + time_of_day(time)?)
        }
        _ => time_of_day(text),
    }
}

/// Whether a text is a date without a time.
pub(super) fn is_date(text: &str) -> bool {
    let text = text.trim();
    text.len() >= 8 && date(text).is_some()
}

/// Days since the first of March of the year 0.
fn date(text: &str) -> Option<i64> {
    let mut parts = text.split(['-', '/', '.']);
    let mut next = || parts.next()?.trim().parse::<i64>().ok();
    let (a, b, c) = (next()?, next()?, next()?);
    let (year, month, day) = match (YEARS.contains(&a), YEARS.contains(&c)) {
        (true, _) => (a, b, c),
        // 3/1/2026 is the first of March; 13/1/2026 can only be January.
        (_, true) if text.contains('/') && a <= 12 => (c, a, b),
        (_, true) => (c, b, a),
        _ => return None,
    };
    if parts.next().is_some() || !(1..=12).contains(&month) || !(1..=31).contains(&day) {
        return None;
    }
    // Years that begin in March have their leap day at their end.
    let (year, month) = if month > 2 {
        (year, month - 3)
    } else {
        (year - 1, month + 9)
    };
    Some(365 * year + year / 4 - year / 100 + year / 400 + (153 * month + 2) / 5 + day - 1)
}

fn time_of_day(text: &str) -> Option<f64> {
    let upper = text.trim().to_ascii_uppercase();
    let (clock, half) = match (upper.strip_suffix("AM"), upper.strip_suffix("PM")) {
        (Some(clock), _) => (clock, Some(0.0)),
        (_, Some(clock)) => (clock, Some(12.0)),
        _ => (upper.as_str(), None),
    };
    let clock = clock.trim().trim_end_matches('Z');
    let clock = clock.split(['+', '−']).next()?;
    // An offset to the west stands behind the seconds.
    let clock = clock.split('-').next()?.trim();
    let parts: Vec<&str> = clock.split(':').collect();
    let whole = |text: &str| text.trim().parse::<u32>().ok().map(f64::from);
    let last = parts.last()?.replace(',', ".");
    let seconds: f64 = last.parse().ok().filter(|s| (0.0..61.0).contains(s))?;
    match parts.len() {
        2 => Some(60.0 * whole(parts[0])? + seconds),
        3 => {
            let hours = whole(parts[0])?;
            let hours = half.map_or(hours, |half| hours % 12.0 + half);
            Some(3600.0 * hours + 60.0 * whole(parts[1])? + seconds)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_is_a_second_however_the_date_is_written() {
        for (from, to) in [
            ("2026-03-01T12:00:00.125Z", "2026-03-01T12:00:01.125Z"),
            ("2026-02-28 23:59:59,5", "2026-03-01 00:00:00,5"),
            ("28.02.2024 23:59:59.5", "29.02.2024 00:00:00.5"),
            ("3/1/2026 11:59:59.5 AM", "3/1/2026 12:00:00.5 PM"),
            ("12:00:59.9", "12:01:00.9"),
            ("00:59.9", "01:00.9"),
            ("2026-03-01T12:00:00-05:00", "2026-03-01T12:00:01-05:00"),
        ] {
            let step = seconds(to).unwrap() - seconds(from).unwrap();
            assert!((step - 1.0).abs() < 1e-4, "{from} to {to}: {step}");
        }
    }

    #[test]
    fn what_is_no_time_is_none() {
        for text in ["0.5", "a:b", "12:99", "99/99/2026 12:00:00", "1:2:3:4"] {
            assert_eq!(seconds(text), None, "{text}");
        }
        assert!(is_date("2026-03-01") && is_date("01.03.2026") && !is_date("1.5"));
    }
}
