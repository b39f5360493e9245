//! A log as the fits see it: position, speed, acceleration and force, at the log's rate or thinned.

use std::ops::Range;

use crate::gap::data::{low_pass::LowPass, standstill};
use crate::kinematics::kinematics;
use crate::log::{Taken, UniformLog};

/// Where the samples of a log lie in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Spacing {
    /// One period apart.
    Even,
    /// A period apart, but for the jitter of their instants.
    Scattered,
    /// Rests are thinned more than motions, by steps that grow with the time since they began.
    Thinned {
        /// How long the longest of them is (s).
        longest_rest_s: f64,
        /// The longest step (s).
        longest_step_s: f64,
    },
}

/// The data of one log that a fit uses, one value for each sample.
#[derive(Clone, Debug)]
pub(crate) struct FitData {
    /// Time between samples (s); where the spacing is not even, between samples of a motion.
    pub(crate) period_s: f64,
    pub(crate) spacing: Spacing,
    /// Time (s) on the clock of the log.
    pub(crate) time_s: Vec<f64>,
    /// Smoothed position (m).
    pub(crate) position_m: Vec<f64>,
    /// Speed (m/s).
    pub(crate) speed_mps: Vec<f64>,
    /// Acceleration (m/s²).
    pub(crate) acceleration_mps2: Vec<f64>,
    /// Measured force (N).
    pub(crate) force_n: Vec<f64>,
    /// Standard deviation of the position (m).
    pub(crate) position_noise_m: f64,
    /// Standard deviation of the speed (m/s).
    pub(crate) speed_noise_mps: Vec<f64>,
    /// Standard deviation of the acceleration (m/s²).
    pub(crate) acceleration_noise_mps2: Vec<f64>,
    /// Whether the acceleration turns within the windows around a sample.
    pub(crate) is_corner: Vec<bool>,
    /// What smoothing leaves out of position (m) and speed (m/s), with their own noise.
    pub(crate) position_left_m: Vec<f64>,
    pub(crate) speed_left_mps: Vec<f64>,
    /// 1 for a measured sample, 0 for one in a gap, or so near a long one that its motion is not known.
    pub(crate) count: Vec<f64>,
    /// Frequencies (Hz) of waves in a long rest that its samples, thinned, do not show any more.
    pub(crate) rest_waves_hz: Vec<f64>,
    /// Instants (s) from each of which on the zero is off by a force that a fit finds.
    pub(crate) stepped_s: Vec<f64>,
    /// Instants (s) from each of which on the surface is farther by so much (m).
    pub(crate) surface_steps: Vec<(f64, f64)>,
}

/// A rest is short if it takes less than this share of a log.
const SHORT_REST: f64 = 0.25;
/// Samples of a wave where they are furthest apart.
const SAMPLES_A_WAVE: f64 = 8.0;

/// Samples and seconds to either side of one that a filter of the motion reaches, and the fewest samples of a gap that no
/// cubic closes.
const REACH: usize = 15;
const REACH_S: f64 = 15e-3;

/// 1 for a measured sample, 0 for one in a gap or within reach of a long one: a line across a quarter of a second of a
/// stage's stroke made corners of 14 N at its ends, and an unchanged rig `unexplained`.
fn measured(log: &UniformLog) -> Vec<f64> {
    let mut count: Vec<f64> = log
        .in_gap
        .iter()
        .map(|gap| f64::from(u8::from(!gap)))
        .collect();
    // Of a log that is mostly missing the lines are how it moved.
    if 2.0 * count.iter().sum::<f64>() < count.len() as f64 {
        return count;
    }
    let reach = REACH.max((REACH_S * log.rate_hz) as usize);
    let mut from = 0;
    for run in log.in_gap.chunk_by(|a, b| a == b) {
        let gap = from..from + run.len();
        from = gap.end;
        // A hold that was thinned on purpose stands still between its samples.
        if run[0] && gap.len() > REACH && !log.is_slower(gap.start) {
            let near = gap.start.saturating_sub(reach)..(gap.end + reach).min(count.len());
            count[near].fill(0.0);
        }
    }
    count
}

impl FitData {
    /// Takes every sample of a log.
    pub(crate) fn of(log: &UniformLog) -> FitData {
        let mut motion = kinematics(log);
        standstill::shrink_speeds(&mut motion);
        // After the shrinking: a stop that the sampling does not resolve is a motion, however badly it is known.
        let each = motion
            .speed_noise_mps
            .iter_mut()
            .zip(&motion.unresolved_mps);
        each.for_each(|(noise, unresolved)| *noise = noise.hypot(*unresolved));
        FitData {
            period_s: log.period_s(),
            spacing: Spacing::Even,
            time_s: log.time_s.clone(),
            position_m: motion.position_m,
            speed_mps: motion.speed_mps,
            acceleration_mps2: motion.acceleration_mps2,
            force_n: log.force_n.clone(),
            position_noise_m: motion.noise_m,
            speed_noise_mps: motion.speed_noise_mps,
            acceleration_noise_mps2: motion.acceleration_noise_mps2,
            is_corner: motion.is_corner,
            position_left_m: motion.position_left_m,
            speed_left_mps: motion.speed_left_mps,
            count: measured(log),
            rest_waves_hz: Vec::new(),
            stepped_s: log.compensated.stepped_s.clone(),
            surface_steps: log.compensated.surface_steps.clone(),
        }
    }

    /// The samples between each instant at which the zero stepped and the next.
    pub(crate) fn after_steps(&self) -> impl Iterator<Item = Range<usize>> {
        let at = |time_s: &f64| self.time_s.partition_point(|stamp| stamp < time_s);
        let starts = self.stepped_s.iter().map(at);
        let ends = self.stepped_s.iter().skip(1).map(at);
        starts
            .zip(ends.chain([self.len()]))
            .map(|(from, to)| from..to)
    }

    /// The samples at the instants at which they were taken, and the motion there: interpolated forces are
    /// less noisy than measured ones, and by how much depends on where the instants lie.
    pub(crate) fn as_taken(&self, taken: &Taken) -> FitData {
        let (Some(first), Some(last)) = (self.time_s.first(), self.len().checked_sub(1)) else {
            return self.clone();
        };
        let place = |time: &f64| ((time - first) / self.period_s).round().max(0.0) as usize;
        let nearest: Vec<usize> = taken.time_s.iter().map(|t| place(t).min(last)).collect();
        let mut at_stamps = self.picked(nearest.iter().copied());
        at_stamps.spacing = Spacing::Scattered;
        at_stamps.count = vec![1.0; nearest.len()];
        at_stamps.force_n.clone_from(&taken.force_n);
        for (at, stamp) in taken.time_s.iter().enumerate() {
            let later_s = stamp - at_stamps.time_s[at];
            let bend = at_stamps.acceleration_mps2[at] * later_s;
            at_stamps.position_m[at] += (at_stamps.speed_mps[at] + 0.5 * bend) * later_s;
            at_stamps.speed_mps[at] += bend;
            at_stamps.time_s[at] = *stamp;
        }
        at_stamps
    }

    /// Whether a spectrum of the samples means anything: with a jitter of a fifth of a period a line keeps
    /// 95 % of its amplitude up to a quarter of the rate.
    pub(crate) fn is_nearly_even(&self) -> bool {
        !matches!(self.spacing, Spacing::Thinned { .. })
    }

    /// Up to which frequency (Hz) a wave is looked for in time; `None` where it would be a rest's own course. Between the
    /// samples of one that takes most of a log a line of 11 Hz was found under a cantilever, and a foam lost its bond
    /// to slow waves. Through several short ones a wave goes on.
    pub(crate) fn fastest_wave_hz(&self) -> Option<f64> {
        match self.spacing {
            Spacing::Even | Spacing::Scattered => Some(0.5 / self.period_s),
            Spacing::Thinned {
                longest_rest_s,
                longest_step_s,
            } => (longest_rest_s < SHORT_REST * self.duration_s())
                .then(|| 1.0 / (SAMPLES_A_WAVE * longest_step_s.max(self.period_s))),
        }
    }

    /// The time from the first sample to the last (s).
    pub(crate) fn duration_s(&self) -> f64 {
        match (self.time_s.first(), self.time_s.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// A channel with each sample in the slot of its instant, for a spectrum: between scattered instants the
    /// count of samples runs away from the time by several periods, and a line of 26.8 Hz was read as 27.0 Hz.
    pub(crate) fn in_slots(&self, channel: impl Iterator<Item = f64>) -> Vec<f64> {
        if self.spacing == Spacing::Even {
            return channel.collect();
        }
        let mut slots = vec![0.0; self.slots().next_back().unwrap_or(0) + 1];
        let each = self.slots().zip(channel);
        let last = slots.len() - 1;
        each.for_each(|(slot, value)| slots[slot.min(last)] += value);
        slots
    }

    /// The slot of each sample's instant.
    fn slots(&self) -> impl DoubleEndedIterator<Item = usize> {
        let first_s = self.time_s.first().copied().unwrap_or(0.0);
        let slot =
            move |time_s: &f64| ((time_s - first_s) / self.period_s).round().max(0.0) as usize;
        self.time_s.iter().map(slot)
    }

    /// The same of a channel that stays as it is until the next sample, where rests are thinned.
    pub(crate) fn held_in_slots(&self, channel: impl Iterator<Item = f64>) -> Vec<f64> {
        if self.is_nearly_even() {
            return self.in_slots(channel);
        }
        let mut slots = Vec::new();
        for (slot, value) in self.slots().zip(channel) {
            let before = slots.last().copied().unwrap_or(value);
            slots.resize(slot.max(slots.len()), before);
            slots.push(value);
        }
        slots
    }

    /// Keeps every `step`-th sample. Means over blocks would be wrong where a force jumps (at a reversal
    /// under friction, at a touch): the mean force is not the force of the mean motion.
    pub(crate) fn thinned(&self, step: usize) -> FitData {
        FitData {
            period_s: self.period_s * step as f64,
            ..self.picked(FitData::thinned_rows(self.len(), step))
        }
    }

    /// The samples that [`FitData::thinned`] keeps of so many.
    pub(crate) fn thinned_rows(count: usize, step: usize) -> impl Iterator<Item = usize> + Clone {
        (step / 2..count).step_by(step)
    }

    /// Keeps the samples at some indices.
    pub(crate) fn picked(&self, indices: impl Iterator<Item = usize> + Clone) -> FitData {
        let picked =
            |channel: &[f64]| -> Vec<f64> { indices.clone().map(|at| channel[at]).collect() };
        FitData {
            period_s: self.period_s,
            spacing: self.spacing,
            time_s: picked(&self.time_s),
            position_m: picked(&self.position_m),
            speed_mps: picked(&self.speed_mps),
            acceleration_mps2: picked(&self.acceleration_mps2),
            force_n: picked(&self.force_n),
            position_noise_m: self.position_noise_m,
            speed_noise_mps: picked(&self.speed_noise_mps),
            acceleration_noise_mps2: picked(&self.acceleration_noise_mps2),
            is_corner: indices.clone().map(|at| self.is_corner[at]).collect(),
            position_left_m: picked(&self.position_left_m),
            speed_left_mps: picked(&self.speed_left_mps),
            count: picked(&self.count),
            rest_waves_hz: self.rest_waves_hz.clone(),
            stepped_s: self.stepped_s.clone(),
            surface_steps: self.surface_steps.clone(),
        }
    }

    /// The time (s) from the sample before to this one.
    pub(crate) fn step_s(&self, at: usize) -> f64 {
        match at.checked_sub(1) {
            Some(before) if self.spacing != Spacing::Even => self.time_s[at] - self.time_s[before],
            _ => self.period_s,
        }
    }

    /// Passes the force through a low-pass.
    pub(crate) fn filtered(&self, low_pass: Option<LowPass>) -> FitData {
        let mut filtered = self.clone();
        if let Some(low_pass) = low_pass {
            low_pass.apply(&mut filtered.force_n, self.period_s);
        }
        filtered
    }

    /// The number of samples.
    pub(crate) fn len(&self) -> usize {
        self.time_s.len()
    }

    /// How many samples there are for each time (s) that noise remembers; at least 1. Those of a thinned rest may be
    /// further apart than that.
    pub(crate) fn samples_for_each(&self, memory_s: f64) -> f64 {
        if memory_s <= self.period_s {
            return 1.0;
        }
        let apart = self.time_s.windows(2).map(|t| (t[1] - t[0]) / memory_s);
        let independent: f64 = apart.map(|share| share.min(1.0)).sum();
        (self.len() as f64 / independent.max(1.0)).max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;
    use crate::stats::rms;

    #[test]
    fn samples_of_a_thinned_rest_are_as_independent_as_they_are_apart() {
        // GIVEN a second at 1 kHz, and ten samples a second apart
        let fast = (0..=1000).map(|at| 1e-3 * f64::from(at));
        let time_s: Vec<f64> = fast.chain((2..12).map(f64::from)).collect();
        let even = FitData::of(
            &Log::from_channels(
                (0..20).map(f64::from).collect(),
                vec![0.0; 20],
                vec![0.0; 20],
            )
            .uniform()
            .unwrap(),
        );
        let log = FitData {
            period_s: 1e-3,
            time_s,
            ..even
        };
        // THEN noise that remembers for 0.1 s has ten values in the second and ten after it,
        assert!((log.samples_for_each(0.1) - 1011.0 / 20.0).abs() < 1e-9);
        // AND white noise one in each sample.
        assert_eq!(log.samples_for_each(1e-3), 1.0);
    }

    #[test]
    fn an_uneven_log_is_fitted_at_the_instants_at_which_it_was_taken() {
        // GIVEN 2 mm at 1.5 Hz, sampled up to 0.3 ms before or after every millisecond, a white force
        let instant = |i: i32| 1e-3 * f64::from(i) + 3e-4 * (f64::from(i * i % 97) / 48.0 - 1.0);
        let place = |t: f64| 1e-3 * (9.42 * t).sin();
        let time: Vec<f64> = (0..4000).map(instant).collect();
        let position: Vec<f64> = time.iter().map(|t| place(*t)).collect();
        let force: Vec<f64> = (0..4000).map(|i| f64::from(i * 31 % 64) - 31.5).collect();
        let log = Log::from_channels(time.clone(), position.clone(), force.clone());
        let grid = log.uniform().unwrap();
        let taken = grid.taken.as_ref().unwrap();
        let data = FitData::of(&grid).as_taken(taken);
        // THEN force and instant are those of the file, and the motion is that at the instant: 0.3 ms of 9.4 mm/s
        // are 2.8 µm.
        assert_eq!((&data.force_n, &data.time_s), (&force, &time));
        assert_eq!(data.spacing, Spacing::Scattered);
        let inner = 20..3980;
        let error_m = rms(inner.clone().map(|at| data.position_m[at] - position[at]));
        assert!(error_m < 1e-7, "{error_m:e} m");
        // A delay of 2.5 ms is one in time, and not of samples.
        let late = inner.map(|at| {
            let motion = data.delayed_motion::<f64>(at, 2.5e-3);
            motion.position_m - place(time[at] - 2.5e-3)
        });
        let error_m = rms(late);
        assert!(error_m < 1e-7, "{error_m:e} m, delayed");
        // Interpolated forces are smoother than measured ones.
        assert!(rms(grid.force_n.iter().copied()) < 0.95 * rms(force));
    }

    #[test]
    fn a_sample_is_in_the_slot_of_its_instant() {
        // GIVEN every millisecond, a fifth of a period later from the second half on, and one missing
        let time: Vec<f64> = [0.0, 1.0, 2.2, 3.2, 5.2, 6.2, 7.2]
            .map(|ms| 1e-3 * ms)
            .into();
        let log = Log::from_channels(
            (0..40).map(|at| 1e-3 * f64::from(at)).collect(),
            vec![0.0; 40],
            vec![0.0; 40],
        );
        let mut data = FitData::of(&log.uniform().unwrap()).picked(0..time.len());
        let values = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
        // THEN even samples are their own slots, and scattered ones are where their time is.
        assert_eq!(data.in_slots(values.into_iter()), values);
        (data.spacing, data.time_s) = (Spacing::Scattered, time);
        let slots = [1.0, 2.0, 3.0, 4.0, 0.0, 5.0, 6.0, 7.0];
        assert_eq!(data.in_slots(values.into_iter()), slots);
    }
}
