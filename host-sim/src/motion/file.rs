//! Motions from TOML.
//!
//! ```toml
//! start = -0.002          # m; where the motion begins, at rest (default -2 mm)
//! [[segment]]
//! kind = "ramp"           # to (m), speed (m/s)
//! to = 0.003
//! speed = 0.03
//! [[segment]]
//! kind = "hold"           # seconds
//! seconds = 50.0
//! ```
//! and `sine` (mean, amplitude, frequency, seconds), `multisine` (mean, amplitude, frequencies,
//! seconds), `chirp` (mean, amplitude, from, to, seconds), in m, Hz and s.

use std::path::Path;

use super::{Motion, Segment};
use crate::diagnostic::{Diagnostic, listed, nearest};
use crate::toml_reader::{Bounds, Table, TomlFile};

/// Where a motion begins unless it says so (m): 2 mm above a surface at 0.
const USUAL_START_M: f64 = -2e-3;

/// Longest segment (s): a day. More is a mistyped unit.
const LONGEST_S: f64 = 86_400.0;

/// Fastest ramp (m/s) and wave (Hz) that a rig with 1 kHz and millimetres can mean.
const FASTEST_MPS: f64 = 100.0;
const FASTEST_HZ: f64 = 1e4;

const KINDS: [&str; 5] = ["ramp", "hold", "sine", "multisine", "chirp"];

impl Motion {
    /// Reads a motion file.
    ///
    /// # Errors
    /// A [`Diagnostic`] with line, key, value and remedy.
    pub fn read(path: &Path) -> Result<Motion, Diagnostic> {
        Motion::from_toml(&TomlFile::read(path)?)
    }

    /// A motion from a parsed file.
    ///
    /// # Errors
    /// As [`Motion::read`].
    pub fn from_toml(file: &TomlFile) -> Result<Motion, Diagnostic> {
        let root = file.root();
        let start_m = root.number("start", Bounds::Any)?.unwrap_or(USUAL_START_M);
        let tables = root.tables("segment")?;
        root.finish()?;
        if tables.is_empty() {
            return Err(root
                .wrong("segment", "the motion has no segment")
                .remedy("write at least one [[segment]]"));
        }
        let segments: Result<Vec<Segment>, Diagnostic> = tables.iter().map(segment).collect();
        Motion::new(start_m, segments?)
    }
}

fn keys_of(kind: &str) -> &'static [&'static str] {
    match kind {
        "ramp" => &["to", "speed"],
        "hold" => &["seconds"],
        "sine" => &["mean", "amplitude", "frequency", "seconds"],
        "multisine" => &["mean", "amplitude", "frequencies", "seconds"],
        "chirp" => &["mean", "amplitude", "from", "to", "seconds"],
        _ => &[],
    }
}

fn segment(table: &Table<'_>) -> Result<Segment, Diagnostic> {
    let kind = table.required_text("kind", &KINDS)?;
    table.understand(keys_of(kind));
    let length = |key: &str| table.required_number(key, Bounds::Any);
    let amplitude_m = || table.required_number("amplitude", Bounds::Positive);
    let frequency = |key: &str| table.required_number(key, Bounds::Within(1e-6, FASTEST_HZ));
    let seconds = || table.required_number("seconds", Bounds::Within(1e-6, LONGEST_S));
    let segment = match kind {
        "ramp" => Segment::Ramp {
            to_m: length("to")?,
            speed_mps: table.required_number("speed", Bounds::Within(1e-12, FASTEST_MPS))?,
        },
        "hold" => Segment::Hold {
            seconds: seconds()?,
        },
        "sine" => Segment::Sine {
            mean_m: length("mean")?,
            amplitude_m: amplitude_m()?,
            frequency_hz: frequency("frequency")?,
            seconds: seconds()?,
        },
        "multisine" => Segment::Multisine {
            mean_m: length("mean")?,
            amplitude_m: amplitude_m()?,
            frequencies_hz: frequencies(table)?,
            seconds: seconds()?,
        },
        "chirp" => Segment::Chirp {
            mean_m: length("mean")?,
            amplitude_m: amplitude_m()?,
            from_hz: frequency("from")?,
            to_hz: frequency("to")?,
            seconds: seconds()?,
        },
        other => return Err(unknown_kind(table, other)),
    };
    table.finish()?;
    Ok(segment)
}

fn frequencies(table: &Table<'_>) -> Result<Vec<f64>, Diagnostic> {
    let list = table.numbers("frequencies", Bounds::Within(1e-6, FASTEST_HZ))?;
    match list {
        Some(list) if !list.is_empty() => Ok(list),
        _ => Err(table
            .wrong("frequencies", "a multisine without frequencies")
            .remedy("write frequencies = [0.5, 1.3, 3.1], in Hz")),
    }
}

fn unknown_kind(table: &Table<'_>, kind: &str) -> Diagnostic {
    let diagnostic = table
        .wrong("kind", format!("unknown kind of segment `{kind}`"))
        .note(format!("the kinds are {}", listed(KINDS)));
    match nearest(kind, KINDS) {
        Some(near) => diagnostic.remedy(format!("write \"{near}\"")),
        None => diagnostic.remedy("write one of them"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Motion, Diagnostic> {
        Motion::from_toml(&TomlFile::parse(text.into(), Path::new("motion.toml"))?)
    }

    #[test]
    fn every_kind_reads() {
        let motion = parse(
            "start = -0.001
             [[segment]]
             kind = \"ramp\"
             to = 0.003
             speed = 0.03
             [[segment]]
             kind = \"hold\"
             seconds = 2
             [[segment]]
             kind = \"sine\"
             mean = 0.002
             amplitude = 0.001
             frequency = 1.0
             seconds = 3.0
             [[segment]]
             kind = \"multisine\"
             mean = 0.002
             amplitude = 0.001
             frequencies = [1, 2.5]
             seconds = 3.0
             [[segment]]
             kind = \"chirp\"
             mean = 0.002
             amplitude = 0.001
             from = 1.0
             to = 5.0
             seconds = 3.0
            ",
        )
        .unwrap();
        // 4 mm at 30 mm/s, 20 ms of blend, 2 + 3·3 s.
        assert!((motion.duration_s() - (4.0 / 30.0 + 0.02 + 11.0)).abs() < 1e-12);
        assert_eq!(motion.position(0.0), (-0.001, 0.0));
    }

    #[test]
    fn mistakes_are_named_with_line_and_remedy() {
        for (text, line, part) in [
            ("[[segment]]\nkind = \"sin\"\n", Some(2), "`sin`"),
            (
                "[[segment]]\nkind = \"hold\"\nsecond = 1.0\n",
                Some(3),
                "unknown key `second`",
            ),
            (
                "[[segment]]\nkind = \"hold\"\nseconds = 0\n",
                Some(3),
                "bounds",
            ),
            (
                "[[segment]]\nkind = \"ramp\"\nto = 1.0\n",
                Some(1),
                "`speed` is missing",
            ),
            (
                "[[segments]]\nkind = \"hold\"\n",
                Some(1),
                "unknown key `segments`",
            ),
            ("start = 0.0\n", None, "no segment"),
        ] {
            let error = parse(text).unwrap_err();
            assert_eq!(error.line, line, "{error}");
            assert!(error.what.contains(part), "{error}");
            assert!(error.remedy.is_some(), "{error}");
        }
    }
}
