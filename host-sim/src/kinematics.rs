//! Depth and speed without delay: local cubics through the position, each as wide as the noise of
//! the position allows and no wider.
//!
//! A fixed window either rounds the corner between a ramp and a hold off (a damper then
//! misses newtons there) or leaves the encoder's steps in the speed. Here every sample takes the widest
//! window whose cubic still leaves no more than the noise.

mod bend;
mod beyond;
mod counts;
mod misfit;
mod missing;
mod width;

use std::borrow::Cow;

use crate::log::UniformLog;
use crate::signal;
use crate::stats::{median, rms, rounding_deviation};
use bend::{Bends, around};
use beyond::{Beyond, left_at_bend};
use misfit::within;

/// Half-widths that are tried, widest first. 15 samples: one count of 1 µm at 1 kHz then leaves
/// 14 µm/s of noise in the speed.
const HALF_WIDTHS: [usize; 7] = [15, 10, 7, 5, 3, 2, 1];

/// Samples of a block in which the noise of a moving position is read: an rms to 15 %.
const NOISE_BLOCK: usize = 32;
/// Fewest such blocks.
const FEWEST_BLOCKS: usize = 8;

/// Second differences see the motion if fifth ones leave less than this share: of white noise they leave as much, of one
/// behind a low-pass at a tenth of the rate a third.
const SEEN: f64 = 0.3;

/// What is left out of a speed is no noise if its square is so many times that of the noise.
const LEFT_OUT: f64 = 3.0;

/// Position and speed at every sample of a log.
#[derive(Clone, Debug)]
pub(crate) struct Kinematics {
    /// Smoothed position (m).
    pub(crate) position_m: Vec<f64>,
    /// Its rate (m/s).
    pub(crate) speed_mps: Vec<f64>,
    /// And the rate of that (m/s²), noisier: for corrections of small delays only.
    pub(crate) acceleration_mps2: Vec<f64>,
    /// Standard deviations of the noise of the speed (m/s) and of the acceleration (m/s²).
    pub(crate) speed_noise_mps: Vec<f64>,
    pub(crate) acceleration_noise_mps2: Vec<f64>,
    /// What three samples leave out of the speed where they go through a bend (m/s); 0 elsewhere. There that is no bias
    /// within the noise but most of the error: a motor of 25 Hz that stops, sampled at 100 Hz, was 2.4 mm/s off at one
    /// sample, known to 0.02, and an hour with nothing missing stayed unexplained for twenty such samples.
    pub(crate) unresolved_mps: Vec<f64>,
    /// Whether the acceleration turns within the windows around a sample, however narrow: a corner of the set point.
    pub(crate) is_corner: Vec<bool>,
    /// What smoothing leaves out of position (m) and speed (m/s), each under a noise of its own.
    pub(crate) position_left_m: Vec<f64>,
    pub(crate) speed_left_mps: Vec<f64>,
    /// Whether what is left out of the speed is more than its noise, all in all.
    leaves_out: bool,
    /// Standard deviation of the raw position's noise (m).
    pub(crate) noise_m: f64,
    /// Samples around each over which the error of the position stays the same: those that read the
    /// same code of an encoder; 1 if the position has no steps.
    pub(crate) held: Vec<f64>,
}

impl Kinematics {
    /// The motion with what smoothing leaves out, where that is more than its noise: of taps of 3.3 Hz at 100 Hz,
    /// read without noise, a fit left 3.5 mN, and 2.0 mN with it.
    pub(crate) fn completed(mut self) -> Kinematics {
        if self.leaves_out {
            let add = |own: &mut [f64], left: &[f64]| {
                own.iter_mut()
                    .zip(left)
                    .for_each(|(own, left)| *own += left);
            };
            add(&mut self.position_m, &self.position_left_m);
            add(&mut self.speed_mps, &self.speed_left_mps);
        }
        self
    }

    /// The motion of so many samples ago at every sample; at the ends of the log its first or last.
    pub(crate) fn delayed(&self, samples: f64) -> Kinematics {
        let last = self.position_m.len().saturating_sub(1);
        let shifted = |channel: &[f64]| {
            let at = |index: usize| {
                let at = (index as f64 - samples).clamp(0.0, last as f64);
                let (before, share) = (at as usize, at.fract());
                let (a, b) = (channel[before], channel[(before + 1).min(last)]);
                a + share * (b - a)
            };
            (0..channel.len()).map(at).collect()
        };
        Kinematics {
            position_m: shifted(&self.position_m),
            speed_mps: shifted(&self.speed_mps),
            acceleration_mps2: shifted(&self.acceleration_mps2),
            position_left_m: shifted(&self.position_left_m),
            speed_left_mps: shifted(&self.speed_left_mps),
            ..self.clone()
        }
    }
}

/// Sums of even powers of −m..m.
struct Window {
    half_width: usize,
    /// What its cubic may leave.
    within: f64,
    even: [f64; 4],
    beyond: Beyond,
}

impl Window {
    fn new(half_width: usize) -> Window {
        let mut even = [0.0; 4];
        for k in 1..=half_width {
            let square = (k * k) as f64;
            for (power, sum) in even.iter_mut().enumerate() {
                *sum += 2.0 * square.powi(power as i32);
            }
        }
        even[0] += 1.0;
        Window {
            half_width,
            within: within((even[0] - 4.0).max(1.0)),
            even,
            beyond: Beyond::new(half_width),
        }
    }

    /// Standard deviations of slope and bend per sample, for a white noise of 1.
    fn noise(&self) -> [f64; 2] {
        let [s0, s2, s4, s6] = self.even;
        let slope = if self.half_width == 1 {
            1.0 / s2
        } else {
            s6 / (s2 * s6 - s4 * s4)
        };
        [slope.sqrt(), 2.0 * (s0 / (s0 * s4 - s2 * s2)).sqrt()]
    }

    /// Value, slope and bend per sample, and rms of what the cubic leaves.
    fn cubic(&self, channel: &[f64], at: usize) -> ([f64; 3], f64) {
        let centre = channel[at];
        // Σ kʲ(x − centre), and Σ(x − centre)².
        let (mut moments, mut squares) = ([0.0; 4], 0.0);
        for k in 1..=self.half_width {
            let (before, after) = (channel[at - k] - centre, channel[at + k] - centre);
            let (sum, difference, k) = (after + before, after - before, k as f64);
            moments[0] += sum;
            moments[1] += k * difference;
            moments[2] += k * k * sum;
            moments[3] += k * k * k * difference;
            squares += before * before + after * after;
        }
        let [s0, s2, s4, s6] = self.even;
        let norm = s0 * s4 - s2 * s2;
        let value = (s4 * moments[0] - s2 * moments[2]) / norm;
        let bend = (s0 * moments[2] - s2 * moments[0]) / norm;
        if self.half_width == 1 {
            // Three samples: the parabola goes through them.
            return ([centre + value, moments[1] / s2, 2.0 * bend], 0.0);
        }
        let norm = s2 * s6 - s4 * s4;
        let slope = (s6 * moments[1] - s4 * moments[3]) / norm;
        let twist = (s2 * moments[3] - s4 * moments[1]) / norm;
        let explained =
            value * moments[0] + slope * moments[1] + bend * moments[2] + twist * moments[3];
        let left = (squares - explained).max(0.0) / (s0 - 4.0);
        ([centre + value, slope, 2.0 * bend], left.sqrt())
    }
}

/// What smooths the position of a log, sample by sample.
pub(crate) struct Smoother<'a> {
    position_m: Cow<'a, [f64]>,
    /// Whether most of the log is missing, so that what is filled in counts as measured.
    is_taken_as_it_is: bool,
    rate_hz: f64,
    noise_m: f64,
    /// Whether that is of counts.
    is_counted: bool,
    /// Its noise while it moves; `None` if it hardly does.
    moving_m: Option<f64>,
    /// Half-widths (samples) above those at 1 kHz, widest first.
    wider: Vec<usize>,
    windows: Vec<Window>,
}

impl<'a> Smoother<'a> {
    pub(crate) fn of(log: &'a UniformLog) -> Smoother<'a> {
        let mut position_m = signal::measured_without_toggling(&log.position_m, &log.in_gap);
        let missing = log.in_gap.iter().filter(|gap| **gap).count();
        // What was measured of a log that is mostly missing is how it moved, and says nothing of its thinned holds.
        let is_taken_as_it_is = 2 * missing >= log.len();
        let (in_gap, step_m) = match is_taken_as_it_is {
            true => (Cow::Owned(vec![false; log.len()]), None),
            false => (Cow::Borrowed(log.in_gap.as_slice()), log.position_step_m),
        };
        let noise_m = signal::noise_of_measured(&position_m, &in_gap);
        let moving_m = moving_noise(&position_m, &in_gap);
        let step_m = step_m.or_else(|| signal::step(&position_m));
        let counts_m = of_counts(step_m, noise_m, moving_m);
        let wider = match counts_m {
            Some(_) => width::at_rate(log.rate_hz, HALF_WIDTHS[0]),
            // What a servo or an amplifier makes of a position remembers: a wider window takes less off than it claims.
            None => Vec::new(),
        };
        let all: Vec<usize> = wider.iter().copied().chain(HALF_WIDTHS).collect();
        let noise_m = counts_m.unwrap_or_else(|| of_motion(noise_m, moving_m));
        if in_gap.contains(&true) {
            missing::fill(position_m.to_mut(), &in_gap, &all, noise_m);
        }
        Smoother {
            is_taken_as_it_is,
            rate_hz: log.rate_hz,
            noise_m,
            is_counted: counts_m.is_some(),
            moving_m,
            windows: all.into_iter().map(Window::new).collect(),
            wider,
            position_m,
        }
    }

    /// How far the position may be off.
    pub(crate) fn errors(&self) -> counts::Errors {
        counts::errors(self.noise_m, self.is_counted)
    }

    /// Position (m) and its rate (m/s) at a sample.
    pub(crate) fn motion(&self, at: usize) -> (f64, f64) {
        let ([position, slope, _], _) = self.cubic(at);
        (position, slope * self.rate_hz)
    }

    /// Samples on either side that there are.
    fn room(&self, at: usize) -> usize {
        at.min(self.position_m.len() - 1 - at)
    }

    /// Value, slope and bend per sample, and the window that they are from; none at the ends of the log.
    fn cubic(&self, at: usize) -> ([f64; 3], Option<&Window>) {
        let (channel, room) = (&*self.position_m, self.room(at));
        let fitting = self.windows.iter().filter(|own| own.half_width <= room);
        let smoothed = fitting
            .map(|window| (window, window.cubic(channel, at)))
            .find(|(window, (_, left))| *left <= window.within * self.noise_m)
            .map(|(window, (cubic, _))| (cubic, Some(window)));
        smoothed.unwrap_or(([channel[at], edge_slope(channel, at), 0.0], None))
    }
}

/// Smooths the position of a log.
pub(crate) fn kinematics(log: &UniformLog) -> Kinematics {
    let smoother = Smoother::of(log);
    let (channel, noise_m) = (&*smoother.position_m, smoother.noise_m);
    let moving_m = smoother.moving_m.map_or(noise_m, |own| own.max(noise_m));
    let bends = Bends::of(channel, &smoother.wider, moving_m);
    let (mut position_m, mut speed_mps, mut acceleration_mps2) =
        (Vec::new(), Vec::new(), Vec::new());
    let (mut position_left_m, mut speed_left_mps) = (Vec::new(), Vec::new());
    let (mut left_square, mut noise_square) = (0.0, 0.0);
    let mut unresolved_mps = Vec::new();
    let (mut speed_noise_mps, mut acceleration_noise_mps2) = (Vec::new(), Vec::new());
    let mut is_corner = vec![false; channel.len()];
    for at in 0..channel.len() {
        let ([position, slope, bend], window) = smoother.cubic(at);
        let noise = window.map_or([1.5; 2], Window::noise);
        let left = window.map_or([0.0; 2], |own| own.beyond.at(channel, at));
        left_square += left[1].powi(2);
        noise_square += window.map_or(0.0, |own| (own.beyond.noise() * noise_m).powi(2));
        let quintic = bends.at(channel, at);
        let (bend, bend_noise, unresolved) = quintic.unwrap_or((bend, noise[1], None));
        // The windows that reach there see some of a corner.
        if let Some(width) = unresolved {
            around(&mut is_corner, at, 2 * width).fill(true);
        }
        speed_noise_mps.push(noise[0] * noise_m * log.rate_hz);
        acceleration_noise_mps2.push(bend_noise * noise_m * log.rate_hz * log.rate_hz);
        position_m.push(position);
        position_left_m.push(left[0]);
        speed_left_mps.push(left[1] * log.rate_hz);
        // The noise of a log that is mostly missing is that of the straight lines across it, beside which everything is
        // a bend: a foam's hold that was thinned to a fortieth.
        let is_bend = !smoother.is_taken_as_it_is && window.is_some_and(|own| own.half_width == 1);
        unresolved_mps.push(left_at_bend(channel, at, is_bend) * log.rate_hz);
        speed_mps.push(slope * log.rate_hz);
        acceleration_mps2.push(bend * log.rate_hz * log.rate_hz);
    }
    let held = held(channel, &log.in_gap);
    // A position that has read the same for a while, or will, moves by less than a count in that time. The length of
    // the run says less: what settles after a stop does so in its first samples.
    let each = speed_noise_mps.iter_mut().zip(&speed_mps);
    for ((noise, speed), samples) in each.zip(to_change(&held)) {
        if speed.abs() <= *noise {
            *noise = noise.min(noise_m * log.rate_hz / samples);
        }
    }
    Kinematics {
        position_m,
        speed_mps,
        acceleration_mps2,
        speed_noise_mps,
        acceleration_noise_mps2,
        is_corner,
        unresolved_mps,
        position_left_m,
        speed_left_mps,
        leaves_out: left_square > LEFT_OUT * noise_square,
        noise_m,
        held,
    }
}

/// Standard deviation (m) of the noise of a position that counts of `step_m` make, where it is `noise_m` all in all
/// and `moving` while it moves; `None` where something else makes more.
///
/// The median of second differences, which [`signal::noise`] takes, is then a whole count or none: a position in
/// counts that were rounded once more read 0.29 of one for 0.45. Fifth differences while the position moves have
/// variance 252 σ² for white noise and hardly see 5 Hz at 200 Hz. The median over blocks keeps corners out.
fn of_counts(step_m: Option<f64>, noise_m: f64, moving: Option<f64>) -> Option<f64> {
    let step_m = step_m.filter(|step_m| noise_m < *step_m)?;
    Some(moving.map_or(noise_m, |noise_m| noise_m.max(rounding_deviation(step_m))))
}

/// Standard deviation (m) of the noise of a position without counts, that second differences say is `noise_m`: where it
/// moves so fast that they see the motion, fifth differences say less. Taps of 3 Hz at 100 Hz read as a noise of 20 µm,
/// which smoothed them until a stiffness was 6 % off.
fn of_motion(noise_m: f64, moving_m: Option<f64>) -> f64 {
    let seen = moving_m.filter(|moving_m| *moving_m < SEEN * noise_m);
    seen.unwrap_or(noise_m)
}

/// Standard deviation (m) of the noise of a position while it moves, from what was measured; `None` if it hardly
/// does.
fn moving_noise(channel: &[f64], in_gap: &[bool]) -> Option<f64> {
    let fifth = |w: &[f64]| w[5] - w[0] + 5.0 * (w[1] - w[4]) + 10.0 * (w[3] - w[2]);
    let blocks = channel.chunks_exact(NOISE_BLOCK);
    let moving = blocks
        .zip(in_gap.chunks_exact(NOISE_BLOCK))
        .filter(|(block, _)| {
            let changes = block.windows(2).filter(|pair| pair[0] != pair[1]);
            4 * changes.count() > NOISE_BLOCK
        });
    let of_block = |(block, gaps): (&[f64], &[bool])| {
        let each = block.windows(6).zip(gaps.windows(6));
        let measured = each.filter(|(_, gaps)| !gaps.contains(&true));
        let differences: Vec<f64> = measured.map(|(window, _)| fifth(window)).collect();
        (!differences.is_empty()).then(|| rms(differences) / 252.0_f64.sqrt())
    };
    let noises: Vec<f64> = moving.filter_map(of_block).collect();
    (noises.len() >= FEWEST_BLOCKS).then(|| median(noises))
}

/// Length of the run of equal positions that each sample stands in, of what was measured.
fn held(channel: &[f64], in_gap: &[bool]) -> Vec<f64> {
    let mut held = vec![1.0; channel.len()];
    let Some(step) = signal::step(&signal::measured(channel, in_gap)) else {
        return held;
    };
    let taken: Vec<usize> = (0..channel.len()).filter(|at| !in_gap[*at]).collect();
    let same = |a: &usize, b: &usize| (channel[*a] - channel[*b]).abs() < 0.5 * step;
    for run in taken.chunk_by(same) {
        if let [first, .., last] = run {
            held[*first..=*last].fill((last + 1 - first) as f64);
        }
    }
    held
}

/// Samples from each to the nearer end of its run; `held` are their lengths.
fn to_change(held: &[f64]) -> Vec<f64> {
    let mut all = Vec::with_capacity(held.len());
    while let Some(run) = held.get(all.len()) {
        let run = *run as usize;
        all.extend((1..=run).map(|at| at.min(run + 1 - at) as f64));
    }
    all
}

/// Slope per sample at the first or last sample of a channel.
fn edge_slope(channel: &[f64], at: usize) -> f64 {
    match channel {
        [] | [_] => 0.0,
        _ if at == 0 => channel[1] - channel[0],
        _ => channel[at] - channel[at - 1],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;
    use crate::stats::rounding_step;

    fn of(position: impl Fn(f64) -> f64) -> (Kinematics, Vec<f64>) {
        let time: Vec<f64> = (0..2000).map(|i| f64::from(i) * 1e-3).collect();
        let rounded = time.iter().map(|t| (position(*t) / 1e-6).round() * 1e-6);
        let force = vec![0.0; 2000];
        let log = Log::from_channels(time.clone(), rounded.collect(), force);
        (kinematics(&log.uniform().unwrap()), time)
    }

    #[test]
    fn a_palpation_on_a_1_um_encoder_keeps_its_speed() {
        // GIVEN 2 mm at 1.5 Hz and 0.1 mm at 5 Hz
        let (slow, fast) = (9.42, 31.4);
        let (found, time) = of(|t| 2e-3 * (1.0 - (slow * t).cos()) + 1e-4 * (fast * t).sin());
        let errors = (20..1980).map(|i| {
            let t = time[i];
            let speed = 2e-3 * slow * (slow * t).sin() + 1e-4 * fast * (fast * t).cos();
            found.speed_mps[i] - speed
        });
        // THEN the speed, up to 22 mm/s, is good to 40 µm/s: 27 µm/s is a parabola of 11 samples.
        let rms = crate::stats::rms(errors);
        assert!((1e-6..4e-5).contains(&rms), "{rms:e}");
    }

    #[test]
    fn more_samples_of_a_motion_make_less_noise() {
        // GIVEN the same motion on the same encoder, at 1 and at 5 kHz, rounded once more on its way to a file
        let rms_of = |rate_hz: f64| {
            let motion = |t: f64| 2e-3 * (1.0 - (9.42 * t).cos());
            let time: Vec<f64> = (0..(2.0 * rate_hz) as usize)
                .map(|i| i as f64 / rate_hz)
                .collect();
            let read = |t: &f64| ((motion(*t) / 1.3e-6).round() * 1.3).round() * 1e-6;
            let position = time.iter().map(read).collect();
            let log = Log::from_channels(time.clone(), position, vec![0.0; time.len()]);
            let found = kinematics(&log.uniform().unwrap());
            let inner = 200..time.len() - 200;
            rms(inner.map(|i| found.speed_mps[i] - 2e-3 * 9.42 * (9.42 * time[i]).sin()))
        };
        // THEN the speed is as good or better: white noise would make it √5 times as good, counts are not white.
        let (slow, fast) = (rms_of(1000.0), rms_of(5000.0));
        assert!(fast < 0.8 * slow, "{fast:e} at 5 kHz, {slow:e} at 1 kHz");
    }

    #[test]
    fn a_stop_between_two_samples_is_not_known_to_a_count() {
        // GIVEN strokes at 20 mm/s that a motor of 25 Hz stops, in counts of 1 µm at 100 Hz
        let turn = std::f64::consts::TAU * 25.0;
        let (ramp_s, mps) = (0.2, 0.02);
        // What a critically damped motor lags behind a ramp, and the stop of it.
        let behind = |t: f64| mps * (t - 2.0 / turn + (t + 2.0 / turn) * (-turn * t).exp());
        let way = |t: f64| match t.rem_euclid(1.003) {
            into if into < ramp_s => behind(into),
            into => behind(into) - behind(into - ramp_s),
        };
        let speed = |t: f64| (way(t + 1e-6) - way(t - 1e-6)) / 2e-6;
        let time: Vec<f64> = (0..3000).map(|i| f64::from(i) * 1e-2).collect();
        let position = time
            .iter()
            .map(|t| (way(*t) * 1e6).round() * 1e-6)
            .collect();
        let log = Log::from_channels(time.clone(), position, vec![0.0; time.len()]);
        let found = kinematics(&log.uniform().unwrap());
        // THEN where the speed is 1 mm/s off and more its error says so, within a factor of 4; as white noise it would
        // be 20 µm/s.
        let off = |at: &usize| (found.speed_mps[*at] - speed(time[*at])).abs();
        let within = |at: &usize| time[*at].rem_euclid(1.003) > 0.02;
        let far: Vec<usize> = (5..2995)
            .filter(within)
            .filter(|at| off(at) > 1e-3)
            .collect();
        assert!(far.len() > 10, "{}", far.len());
        let known = far.iter().filter(|at| {
            off(at) < 4.0 * found.speed_noise_mps[**at].hypot(found.unresolved_mps[**at])
        });
        assert!(10 * known.count() > 9 * far.len());
    }

    #[test]
    fn a_third_of_the_samples_may_be_missing() {
        // GIVEN 2 mm at 1.5 Hz in counts of 1 µm at 1 kHz, without 3 of every 10 samples, in no order
        let taken = |at: &u32| (at.wrapping_mul(2_654_435_761) >> 16) % 10 > 2;
        let time: Vec<f64> = (0..4000)
            .filter(taken)
            .map(|at| 1e-3 * f64::from(at))
            .collect();
        let read = |t: &f64| (2e3 * (1.0 - (9.42 * t).cos())).round() * 1e-6;
        let position = time.iter().map(read).collect();
        let log = Log::from_channels(time.clone(), position, vec![0.0; time.len()]);
        let log = log.uniform().unwrap();
        let missing = log.in_gap.iter().filter(|gap| **gap).count();
        assert!((1000..1400).contains(&missing), "{missing}");
        let found = kinematics(&log);
        // THEN the noise is that of a count, and not of the lines across the gaps, and the speed as good as ever.
        assert!((rounding_step(found.noise_m) / 1e-6 - 1.0).abs() < 1e-6);
        let speed = |at: usize| 2e-3 * 9.42 * (9.42 * log.time_s[at]).sin();
        let error_mps = rms((20..3970).map(|at| found.speed_mps[at] - speed(at)));
        assert!(error_mps < 4e-5, "{error_mps:e}");
    }

    #[test]
    fn what_is_missing_of_a_run_is_in_it_and_what_is_between_two_is_not() {
        let channel: Vec<f64> = [0.0, 1.0, 1.0, 1.0, 1.5, 2.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]
            .into_iter()
            .chain((8..20).map(f64::from))
            .collect();
        let in_gap: Vec<bool> = (0..channel.len()).map(|at| at == 2 || at == 4).collect();
        let held = held(&channel, &in_gap);
        assert_eq!(held[..8], [1.0, 3.0, 3.0, 3.0, 1.0, 2.0, 2.0, 1.0]);
    }

    #[test]
    fn a_run_of_equal_positions_says_most_at_its_middle() {
        let held = [1.0, 5.0, 5.0, 5.0, 5.0, 5.0, 1.0];
        assert_eq!(to_change(&held), [1.0, 1.0, 2.0, 3.0, 2.0, 1.0, 1.0]);
    }

    #[test]
    fn the_corner_between_a_ramp_and_a_hold_stays_a_corner() {
        // GIVEN a slow approach, which shows the counts, 30 mm/s for 100 ms, then a hold
        let (found, _) = of(|t| 7e-4 * t.min(1.0) + 0.03 * (t - 1.0).clamp(0.0, 0.1));
        // THEN three samples away the speed is that of the ramp or that of the hold, to 0.3 mm/s.
        for (at, speed) in [(1097, 0.03), (1103, 0.0)] {
            assert!(
                (found.speed_mps[at] - speed).abs() < 3e-4,
                "{at}: {}",
                found.speed_mps[at]
            );
        }
        // The rest of the hold is still.
        assert!(found.speed_mps[1130].abs() < 1e-9);
    }
}
