//! Where a disagreement is.

/// A region and its share of the excess.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// `free`, `touch`, `loading`, `hold`, `unloading`, `lift_off`, `depth_low`, `depth_mid`,
    /// `depth_high`, `slow`, `fast`, `early`, `late`, `line`, `pitch`.
    pub id: &'static str,
    /// Its share of the energy above the floor; of a line, of the whole residual.
    pub share: f64,
    /// Root mean square of the residual in it (N).
    pub rms_n: f64,
    /// Share of the samples.
    pub samples: f64,
    /// Frequency of a line (Hz).
    pub hz: Option<f64>,
    /// Pitch of a line along the way (m).
    pub pitch_m: Option<f64>,
}

/// The most telling regions in words: "68 % of the excess is in holds, 54 % in the deepest third".
pub fn words(regions: &[Region]) -> String {
    let phases = ["free", "touch", "loading", "hold", "unloading", "lift_off"];
    let mut said = Vec::new();
    if let Some(phase) = regions.iter().find(|region| phases.contains(&region.id)) {
        said.push(format!(
            "{:.0} % of the excess is {}",
            100.0 * phase.share,
            place(phase.id)
        ));
    }
    // Besides, what has more of the excess than its share of the samples explains.
    let telling = regions
        .iter()
        .filter(|region| !phases.contains(&region.id) && region.share > 1.3 * region.samples)
        .take(2);
    for region in telling {
        let of = if said.is_empty() {
            "of the excess is "
        } else {
            ""
        };
        said.push(format!(
            "{:.0} % {of}{}",
            100.0 * region.share,
            place(region.id)
        ));
    }
    for line in regions {
        match (line.hz, line.pitch_m) {
            (Some(hz), _) => said.push(format!(
                "{:.0} % in a line at {hz:.3} Hz",
                100.0 * line.share
            )),
            (_, Some(pitch)) => said.push(format!(
                "{:.0} % repeats every {:.4} mm along the way",
                100.0 * line.share,
                1e3 * pitch
            )),
            _ => {}
        }
    }
    said.join(", ")
}

fn place(id: &str) -> &'static str {
    match id {
        "free" => "in free air",
        "touch" => "at touch",
        "loading" => "while loading",
        "hold" => "in holds",
        "unloading" => "while unloading",
        "lift_off" => "at lift-off",
        "depth_low" => "in the shallowest third",
        "depth_mid" => "in the middle third",
        "depth_high" => "in the deepest third",
        "slow" => "at the slower half of the speeds",
        "fast" => "at the faster half of the speeds",
        "early" => "in the first half of the log",
        "late" => "in the second half of the log",
        _ => "there",
    }
}
