//! `motion.toml`: the motion to record next, for `palpate simulate --motion` and for people who copy
//! it to a rig, with what to check before it runs there.

use std::fs;
use std::io;
use std::path::Path;

use crate::gap::MOTION;
use crate::kind;
use crate::motion::{Limits, Motion};
use crate::number::quantity;
use crate::output::write_atomically;
use crate::wrap::wrapped;

/// The first line of the file. Only a file that begins with it may be replaced or removed.
const FIRST_LINE: &str = "# A motion to record, advised by palpate gap.";

/// What the comment above a motion says.
pub(super) struct Note<'a> {
    /// The motion in words.
    pub(super) words: &'a str,
    /// What the motion is for.
    pub(super) purpose: &'a str,
    /// The command to run with its log.
    pub(super) command: &'a str,
    /// How far and how fast the logs so far went, if there are any.
    pub(super) limits: Option<Limits>,
    /// The largest force (N) that the model expects on the way, where it was asked.
    pub(super) peak_n: Option<f64>,
}

/// The file: what it is for, what to check against the rig, the motion.
pub(super) fn text(motion: &Motion, note: &Note<'_>) -> String {
    let so_far = note.limits.map_or(String::new(), |limits| {
        format!(" The log so far: {}.", in_words(limits))
    });
    let force = note.peak_n.map_or(String::new(), |peak_n| {
        format!(
            ", and up to {} as the model expects",
            quantity(peak_n, 2, "N")
        )
    });
    let paragraphs = [
        format!("It is: {}.", note.words),
        note.purpose.to_string(),
        format!("With its log: `{}`", note.command),
        format!(
            "Check it against the rig before it runs: {}, in {}{force}.{so_far}",
            in_words(motion.limits()),
            plain(&quantity(motion.duration_s(), 3, "s")),
        ),
        format!(
            "Positions and lengths are in {}, at the positions of log and model, growing into the material; speeds in \
             {}, frequencies in Hz, times in s. Sines begin at their lowest point.",
            kind::unit("m"),
            kind::unit("m/s")
        ),
    ];
    let mut text = format!("{FIRST_LINE}\n");
    for paragraph in paragraphs {
        for line in wrapped("", &plain(&paragraph)).lines() {
            text += &format!("# {line}\n");
        }
    }
    text + &motion.to_toml()
}

fn in_words(limits: Limits) -> String {
    format!(
        "deepest {}, farthest out {}, fastest {}",
        quantity(limits.highest_m, 3, "m"),
        quantity(limits.lowest_m, 3, "m"),
        quantity(limits.fastest_mps, 3, "m/s"),
    )
}

/// The text with the blanks and the minus of a keyboard: terminals and editors of rigs are old.
fn plain(text: &str) -> String {
    text.replace(['\u{a0}', '\u{202f}'], " ")
        .replace('\u{2212}', "-")
}

/// Writes the motion into a folder. Without a motion it removes that of an earlier run, since nothing there
/// may contradict the answer. A `motion.toml` that somebody else wrote is left alone.
///
/// # Errors
/// An error of the file system, or a file that somebody else wrote.
pub(super) fn put(folder: &Path, text: Option<&str>) -> io::Result<()> {
    let path = folder.join(MOTION);
    // A file that cannot be read is not known to be of an earlier run.
    let is_replaceable =
        || fs::read(&path).is_ok_and(|bytes| bytes.starts_with(FIRST_LINE.as_bytes()));
    match text {
        Some(_) if path.exists() && !is_replaceable() => Err(io::Error::new(
            io::ErrorKind::AlreadyExists,
            format!(
                "{} was not written by gap, and the advised motion would replace it: move it, or give another --out",
                path.display()
            ),
        )),
        Some(text) => write_atomically(&path, |writer| writer.write_all(text.as_bytes())),
        None if is_replaceable() => fs::remove_file(&path),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toml_reader::TomlFile;

    fn note() -> Note<'static> {
        Note {
            words: "a ramp",
            purpose: "This log does not tell force_lag from series_compliance.",
            command: "palpate gap --model base.toml --log old.csv --log NEW.csv --out DIR",
            limits: Some(Limits::of([(1e-3, 0.02), (4e-3, -0.03)])),
            peak_n: None,
        }
    }

    #[test]
    fn the_file_is_the_motion_and_its_head_says_how_far_and_how_fast_it_goes() {
        let motion = Motion::palpation(4e-3).shifted(1e-3);
        let text = text(&motion, &note());
        let file = TomlFile::parse(text.clone(), Path::new(MOTION)).unwrap();
        assert_eq!(Motion::from_toml(&file).unwrap(), motion);
        let head: Vec<&str> = text
            .lines()
            .filter_map(|own| own.strip_prefix("# "))
            .collect();
        let head = head.join(" ");
        for words in [
            "deepest 5.00 mm, farthest out -1.00 mm, fastest 28.9 mm/s, in 8.57 s",
            "The log so far: deepest 4.00 mm, farthest out 1.00 mm, fastest 30.0 mm/s.",
            "force_lag from series_compliance",
            "in Hz",
            "--log old.csv --log NEW.csv",
        ] {
            assert!(head.contains(words), "{words} in {head}");
        }
    }

    #[test]
    fn an_earlier_run_s_motion_goes_and_somebody_else_s_stays() {
        let temporary = tempfile::tempdir().unwrap();
        let folder = temporary.path();
        let path = folder.join(MOTION);
        let own = text(&Motion::palpation(4e-3), &note());
        // GIVEN a motion of an earlier run, WHEN none is advised, THEN it goes.
        put(folder, Some(&own)).unwrap();
        put(folder, Some(&own)).unwrap();
        put(folder, None).unwrap();
        assert!(!path.exists());
        put(folder, None).unwrap();
        // GIVEN a motion that somebody wrote, THEN it stays whatever is advised.
        fs::write(&path, "start = 0.0\n").unwrap();
        put(folder, None).unwrap();
        let refused = put(folder, Some(&own)).unwrap_err();
        assert!(refused.to_string().contains("another --out"), "{refused}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "start = 0.0\n");
    }
}
