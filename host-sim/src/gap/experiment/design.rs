//! The motion to record next, predicted on the log and the further motion together, with the numbers of
//! the fit.

use rayon::prelude::*;

use crate::gap::data::fit_data::FitData;
use crate::gap::experiment::excitations::{Excitation, ExcitationRange, bounded};
use crate::gap::experiment::plan::{FurtherMotion, best_excitation};
use crate::gap::experiment::recordings::{Recordings, Sensor};
use crate::gap::model::{dataset::Dataset, fit::Fit, simulate::forces};
use crate::gap::noise::floor::NoiseFloor;
use crate::motion::Motion;
use crate::stats::{highest, rounding_step};

/// Samples of the log that are kept.
const SAMPLES: usize = 2_000;
/// Paces of the motions, in that of the log: a lag of 5 ms and a delay of 5 ms are the same at 0.2 Hz
/// and at three times that, whatever the motion. The slowest pace that suffices is advised.
const PACES: [f64; 3] = [1.0, 4.0, 16.0];

/// The thinned log, and the motions that its rig could do next.
pub(super) struct ExperimentDesign {
    /// The log alone.
    pub(super) recordings: Recordings,
    sensor: Sensor,
    /// The motions at each pace.
    excitations: Vec<Vec<Excitation>>,
}

impl ExperimentDesign {
    pub(super) fn new(dataset: &Dataset<'_>, fit: &Fit) -> ExperimentDesign {
        let samples: usize = dataset.logs.iter().map(FitData::len).sum();
        let step = samples.div_ceil(SAMPLES);
        let logs: Vec<FitData> = dataset.logs.iter().map(|log| log.thinned(step)).collect();
        let sensor = Sensor {
            rate_hz: 1.0 / dataset.logs[0].period_s,
            position_step_m: rounding_step(dataset.scales.position_noise_m),
            noise_n: dataset.floors[0].used_n.max(f64::MIN_POSITIVE),
        };
        let peak_n = |motion: &Motion| {
            let alone = Recordings::default().and(motion, sensor);
            let forces = forces(&fit.shape, &fit.numbers, &alone.logs);
            highest(forces.into_iter().map(f64::abs))
        };
        // What the rig's cell has shown it can read; in air the weight and drag of a faster stroke are what is asked for.
        let most_n = match fit.shape.base.is_free() {
            true => f64::INFINITY,
            false => {
                let forces = dataset.logs.iter().flat_map(|log| &log.force_n);
                highest(forces.map(|force| force.abs()))
            }
        };
        let at_pace = |pace: &f64| bounded(range(dataset, fit, *pace), most_n, peak_n);
        ExperimentDesign {
            recordings: Recordings {
                repeats: vec![step as f64; logs.len()],
                // A design asks for raw forces.
                floors: dataset.floors.iter().map(NoiseFloor::raw).collect(),
                logs,
            },
            sensor,
            excitations: PACES.iter().map(at_pace).collect(),
        }
    }

    /// The log and a motion, with the force that the fit predicts for it.
    pub(super) fn with(&self, excitation: &Excitation, fit: &Fit) -> Recordings {
        let mut both = self.recordings.and(&excitation.motion, self.sensor);
        if let Some(log) = both.logs.last_mut() {
            log.force_n = forces(&fit.shape, &fit.numbers, std::slice::from_ref(log));
        }
        both
    }

    /// The motion with the most standard deviations at the slowest pace at which they suffice.
    pub(super) fn best(
        &self,
        sigma: impl Fn(&Excitation) -> Option<f64> + Copy + Sync + Send,
        least: f64,
    ) -> Option<FurtherMotion> {
        self.excitations.iter().find_map(|excitations| {
            let each: Vec<Option<f64>> = excitations.par_iter().map(sigma).collect();
            best_excitation(excitations, |at| each[at], least)
        })
    }
}

/// The range of motions as deep as the log, and `pace` times as fast.
fn range(dataset: &Dataset<'_>, fit: &Fit, pace: f64) -> ExcitationRange {
    let scales = dataset.scales;
    let touches = !fit.shape.base.is_free();
    let parameters = fit.shape.base.parameters().into_iter();
    let surface = parameters
        .zip(fit.shape.environment_at(&fit.numbers))
        .find(|(parameter, _)| parameter.name == "surface")
        .map(|(_, value)| value);
    let surface_m = surface
        .filter(|_| touches)
        .unwrap_or(scales.deepest_m - 0.5 * scales.travel_m);
    let depth = scales.deepest_m - surface_m;
    let depth_m = if depth > 0.05 * scales.travel_m {
        depth
    } else {
        0.5 * scales.travel_m
    };
    // The fastest stroke of a palpation goes 7.2 depths in the time of a stroke.
    let stroke_s = 7.2 * depth_m / (pace * scales.speed_mps).max(f64::MIN_POSITIVE);
    let period_s = dataset.logs[0].period_s;
    ExcitationRange {
        surface_m,
        touches,
        depth_m,
        stroke_s: stroke_s.clamp(100.0 * period_s, scales.duration_s.max(100.0 * period_s)),
    }
}
