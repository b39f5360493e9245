//! A log and its truth as files.

use super::case::{Case, names};
use serde_json::json;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Digits of a stamp: a microsecond.
const STAMP_DIGITS: usize = 6;

impl Case {
    /// The name of its files.
    pub fn name(&self) -> String {
        let (material, motion) = names(self.index);
        format!(
            "{}-{}-{material}-{motion}-{}",
            self.fault.name, self.severity, self.index
        )
    }

    /// The log.
    pub fn csv(&self) -> String {
        let rows = &self.rows;
        let mut text = "t_s,x_m,f_n\n".to_string();
        let channels = rows.time_s.iter().zip(&rows.position_m).zip(&rows.force_n);
        for ((t, x), f) in channels {
            let _ = writeln!(text, "{t:.STAMP_DIGITS$},{x:.8},{f:.4}");
        }
        text
    }

    /// What is true.
    pub fn truth_json(&self) -> String {
        let (material, motion) = names(self.index);
        let truth = self.stages.iter().map(|stage| {
            let [stiffness, damping, exponent] = stage.material.numbers;
            json!({
                "from_s": stage.from_s,
                "stiffness": stiffness,
                "damping": damping,
                "exponent": exponent,
            })
        });
        let counts_from_s = self.counts_from_s.is_finite().then_some(self.counts_from_s);
        let truth = json!({
            "fault": self.fault.name,
            "severity": self.severity,
            "severities": self.fault.severities,
            "material": material,
            "motion": motion,
            "onset_s": self.plan.onset_s,
            "end_s": self.plan.end_s,
            "counts_from_s": counts_from_s,
            "surface_m": self.surface_m,
            "truth": truth.collect::<Vec<_>>(),
        });
        format!("{truth:#}\n")
    }

    /// Writes NAME.csv and NAME.json into a folder; gives the path of the log.
    pub fn save(&self, folder: &Path) -> std::io::Result<PathBuf> {
        std::fs::create_dir_all(folder)?;
        let path = folder.join(format!("{}.csv", self.name()));
        std::fs::write(&path, self.csv())?;
        std::fs::write(path.with_extension("json"), self.truth_json())?;
        Ok(path)
    }
}
