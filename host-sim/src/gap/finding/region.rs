//! The regions in which a model and a log disagree.

use crate::number::quantity;
use crate::phase::PHASES;

/// A region and its share of the excess.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// `free`, `touch`, `loading`, `hold`, `unloading`, `lift_off`, `depth_low`, `depth_mid`,
    /// `depth_high`, `slow`, `fast`, `early`, `late`, `line`, `pitch`, `step` or `surface_step`; where nothing is touched `forward`,
    /// `backward`, `travel_low`, `travel_mid` and `travel_high` instead of phases and depths.
    pub id: &'static str,
    /// The region's share of the energy above the noise; a pattern's share of the whole residual.
    pub share: f64,
    /// Root mean square of the residual in the region (N).
    pub rms_n: f64,
    /// The region's share of the samples.
    pub samples: f64,
    /// Where it is no part of the log but a pattern all through it.
    pub pattern: Option<Pattern>,
}

/// A pattern in what is left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pattern {
    /// A line in time.
    Line {
        /// Its frequency (Hz).
        hz: f64,
    },
    /// A line along the travel.
    Pitch {
        /// Its pitch (m).
        m: f64,
    },
    /// A force that is off by one amount from an instant on.
    Step {
        /// The instant (s).
        s: f64,
        /// The amount (N).
        n: f64,
    },
    /// A surface that is farther by one amount from an instant on.
    SurfaceStep {
        /// The instant (s), between two touches.
        s: f64,
        /// The amount (m).
        m: f64,
    },
}

impl Region {
    /// Instant (s) and amount (N) of a force that is off from an instant on.
    pub(in crate::gap) fn step(&self) -> Option<(f64, f64)> {
        match self.pattern? {
            Pattern::Step { s, n } => Some((s, n)),
            _ => None,
        }
    }

    /// Instant (s) and amount (m) of a surface that is farther from an instant on.
    pub(in crate::gap) fn surface_step(&self) -> Option<(f64, f64)> {
        match self.pattern? {
            Pattern::SurfaceStep { s, m } => Some((s, m)),
            _ => None,
        }
    }
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
        .filter(|region| region.pattern.is_none() && !PHASES.contains(&region.id))
        .filter(|region| region.share > TELLING * region.samples)
        .take(MOST_TELLING);
    let mut words: Vec<String> = Vec::new();
    for region in phase.into_iter().chain(telling) {
        let of = if words.is_empty() {
            "of the excess is "
        } else {
            ""
        };
        words.push(format!(
            "{} {of}{}",
            share_in_words(region.share),
            place(region.id)
        ));
    }
    words.extend(regions.iter().filter_map(pattern_in_words));
    words.join(", ")
}

/// A share in percent, never rounded to all or nothing.
pub fn share_in_words(share: f64) -> String {
    match 100.0 * share {
        percent if percent > 99.0 => "more than 99 %".into(),
        percent if percent < 1.0 => "less than 1 %".into(),
        percent => format!("{percent:.0} %"),
    }
}

fn pattern_in_words(region: &Region) -> Option<String> {
    let share = share_in_words(region.share);
    Some(match region.pattern? {
        Pattern::Line { hz } => format!("{share} in a line at {hz:.3} Hz"),
        Pattern::Pitch { m } => format!(
            "{share} repeats every {} along the way",
            quantity(m, 3, "m")
        ),
        Pattern::Step { s, n } => {
            format!("{share} in a step of {} at {s:.2} s", quantity(n, 3, "N"))
        }
        Pattern::SurfaceStep { s, m } => format!(
            "{share} in a surface that steps by {} at {s:.2} s",
            quantity(m, 3, "m")
        ),
    })
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
