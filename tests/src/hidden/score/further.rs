//! Records the same rig, with the same effects hidden, under a motion that was advised.
//!
//! `gap` writes the motion that it advises to OUT/motion.toml, in the format that `simulate --motion`
//! reads. The rig is drawn again from the seed in its truth.json; that it is the same one is checked
//! on the first log.

use crate::hidden::rig::case::Case;
use palpate::motion::Motion;
use std::path::{Path, PathBuf};

/// The longest motion that is recorded (s): those that `gap` plans last a few dozen strokes.
const LONGEST_S: f64 = 600.0;

/// The name of the motion's file in the folder of an answer.
pub(crate) const MOTION: &str = "motion.toml";

/// Records `motion` on the rig of a folder into the folder `out`, and returns the log's path.
pub fn record(rig: &Path, motion: &Path, out: &Path) -> Result<PathBuf, String> {
    let read = |name: &str| {
        let path = rig.join(name);
        std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))
    };
    let truth = serde_json::from_str(&read("truth.json")?).map_err(|e| e.to_string())?;
    let case = Case::of_truth(&truth).ok_or("this rig was not drawn here")?;
    if case.csv() != read("measured.csv")? {
        return Err("the rig was written by another generator: write it again".into());
    }
    let motion = Motion::read(motion).map_err(|e| e.to_string())?;
    let seconds = motion.duration_s();
    if seconds > LONGEST_S * case.units.time {
        return Err(format!("a motion of {seconds} s"));
    }
    let csv = case.further_csv(seconds, |t| motion.position(t).0);
    let to = out.join("further.csv");
    std::fs::write(&to, csv).map_err(|e| format!("{}: {e}", to.display()))?;
    Ok(to)
}
