//! The regions in which a model and a log disagree.

use crate::number::quantity;
use crate::phase::PHASES;

/// A region and its share of the excess.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// `free`, `touch`, `loading`, `hold`, `unloading`, `lift_off`, `depth_low`, `depth_mid`,
    /// `depth_high`, `slow`, `fast`, `early`, `late`, `line` or `pitch`; where nothing is touched `forward`, `backward`,
    /// `travel_low`, `travel_mid` and `travel_high` instead of phases and depths.
    pub id: &'static str,
    /// The region's share of the energy above the noise; a line's share of the whole residual.
    pub share: f64,
    /// Root mean square of the residual in the region (N).
    pub rms_n: f64,
    /// The region's share of the samples.
    pub samples: f64,
    /// Frequency of a line (Hz).
    pub hz: Option<f64>,
    /// Pitch of a line along the travel (m).
    pub pitch_m: Option<f64>,
}

/// A region is mentioned beside the phase if its share of the excess is this many times its share of the
/// samples.
const TELLING: f64 = 1.3;
/// Most regions that are mentioned beside the phase.
const MOST_TELLING: usize = 2;

/// Describes the most telling regions: "68 % of the excess is in holds, 54 % in the deepest third".
pub fn regions_in_words(regions: &[Region]) -> String {
    let phase = regions.iter().find(|region| PHASES.contains(&region.id));
    let telling = regions
        .iter()
        .filter(|region| !PHASES.contains(&region.id) && region.share > TELLING * region.samples)
        .take(MOST_TELLING);
    let mut words: Vec<String> = Vec::new();
    for region in phase.into_iter().chain(telling) {
        let of = if words.is_empty() {
            "of the excess is "
        } else {
            ""
        };
        words.push(format!(
            "{:.0} % {of}{}",
            100.0 * region.share,
            place(region.id)
        ));
    }
    words.extend(regions.iter().filter_map(line_in_words));
    words.join(", ")
}

fn line_in_words(line: &Region) -> Option<String> {
    let percent = 100.0 * line.share;
    match (line.hz, line.pitch_m) {
        (Some(hz), _) => Some(format!("{percent:.0} % in a line at {hz:.3} Hz")),
        (_, Some(pitch_m)) => Some(format!(
            "{percent:.0} % repeats every {} along the way",
            quantity(pitch_m, 3, "m")
        )),
        _ => None,
    }
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
        "forward" => "on the way forward",
        "backward" => "on the way back",
        "travel_low" => "in the lowest third of the travel",
        "travel_mid" => "in the middle third of the travel",
        "travel_high" => "in the highest third of the travel",
        "slow" => "at the slower half of the speeds",
        "fast" => "at the faster half of the speeds",
        "early" => "in the first half of the log",
        "late" => "in the second half of the log",
        _ => "there",
    }
}
