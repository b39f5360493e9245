//! Floors of simulated logs whose noise is known.

use super::*;
use crate::log::Log;
use crate::stats::{rms, rounding_deviation};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

const SEED_NOISE: u64 = 23;
const SIGMA_N: f64 = 4e-3;

fn normals(count: usize, stream: u64) -> Vec<f64> {
    let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED_NOISE + stream);
    (0..count)
        .map(|_| StandardNormal.sample(&mut rng))
        .collect()
}

/// First-order noise of unit variance, corner in Hz at 1 kHz.
fn slow(corner_hz: f64, count: usize, stream: u64) -> Vec<f64> {
    let keep = (-TAU * corner_hz * 1e-3).exp();
    let mut state = 0.0;
    let each = normals(count, stream).into_iter();
    each.map(|normal| {
        state = keep * state + (1.0 - keep * keep).sqrt() * normal;
        state
    })
    .collect()
}

/// Six strokes at 1 kHz of 1 mm into 2 kN/m, half a second of rest before each and 1 s of hold in
/// it, with a noise (N) and what else there is at a time (s) and a speed (mm a sample).
fn log(noise_n: &[f64], else_n: impl Fn(f64, f64) -> f64, code_n: f64) -> UniformLog {
    log_at(1, noise_n, else_n, code_n)
}

/// The same at so many kilohertz.
fn log_at(
    rate_khz: usize,
    noise_n: &[f64],
    else_n: impl Fn(f64, f64) -> f64,
    code_n: f64,
) -> UniformLog {
    let period_s = 1e-3 / rate_khz as f64;
    let place = |at: usize| match (at % (2500 * rate_khz)) as f64 * period_s {
        ..0.5 => -1.0,
        time_s @ ..1.0 => -(TAU * (time_s - 0.5)).cos(),
        ..2.0 => 1.0,
        time_s => (TAU * (time_s - 2.0)).cos(),
    };
    let count = noise_n.len();
    let x: Vec<f64> = (0..count).map(place).collect();
    let force = |at: usize| {
        let more = else_n(period_s * at as f64, x[at] - x[at.saturating_sub(1)]);
        let force_n = 2.0 * x[at].max(0.0) + noise_n[at] + more;
        (force_n / code_n).round() * code_n
    };
    UniformLog {
        rate_hz: 1.0 / period_s,
        time_s: (0..count).map(|at| period_s * at as f64).collect(),
        force_n: (0..count).map(force).collect(),
        position_m: x.iter().map(|x| (1e3 * x).round() * 1e-6).collect(),
        in_gap: vec![false; count],
        ..UniformLog::default()
    }
}

const SAMPLES: usize = 15_000;

fn white() -> Vec<f64> {
    let each = normals(SAMPLES, 0).into_iter();
    each.map(|normal| SIGMA_N * normal).collect()
}

fn assert_near(floor: &NoiseFloor, sigma_n: f64, most: f64) {
    let ratio = floor.used_n / sigma_n;
    assert!((ratio - 1.0).abs() < most, "{ratio}: {floor:?}");
}

#[test]
fn slow_noise_is_seen_where_a_third_of_the_samples_is_missing() {
    // GIVEN noise with a corner of 20 Hz and a fifth of white, three samples of ten invented between others
    let white = normals(SAMPLES, 1);
    let slow = slow(20.0, SAMPLES, 0).into_iter().zip(white);
    let noise: Vec<f64> = slow.map(|(a, b)| SIGMA_N * (a + 0.2 * b)).collect();
    let whole = NoiseFloor::of(&log(&noise, |_, _| 0.0, 1e-9), &Floor::default());
    let mut missing = log(&noise, |_, _| 0.0, 1e-9);
    let is_taken = |at: usize| at % 10 < 2 || (4..9).contains(&(at % 10));
    for at in (1..SAMPLES - 2).filter(|at| !is_taken(*at)) {
        let next = (at..).find(|next| is_taken(*next)).unwrap();
        let before = missing.force_n[at - 1];
        missing.force_n[at] = before + (missing.force_n[next] - before) / (next + 1 - at) as f64;
        missing.in_gap[at] = true;
    }
    let floor = NoiseFloor::of(&missing, &Floor::default());
    // THEN it reads as in the whole log: between neighbours slow noise is what they are, to a tenth.
    assert!(floor.coloured && whole.coloured);
    assert_near(&floor, whole.used_n, 0.1);
}

#[test]
fn a_hum_of_nearly_half_the_power_makes_slow_noise_no_disturbance() {
    // GIVEN noise with a corner of 90 Hz, and a hum with 0.45 of the power, which makes its kurtosis 2.7
    let hum = |t: f64, _: f64| SIGMA_N * (0.82 * 2.0_f64).sqrt() * (TAU * 50.0 * t).sin();
    let noise: Vec<f64> = slow(90.0, 4 * SAMPLES, 0)
        .iter()
        .map(|n| SIGMA_N * n)
        .collect();
    let floor = NoiseFloor::of(&log(&noise, hum, 1e-6), &Floor::default());
    // THEN the floor is that noise, and not the 0.6 of it that second differences see.
    assert!(
        floor.coloured && floor.high_pass_n < 0.7 * SIGMA_N,
        "{floor:?}"
    );
    assert_near(&floor, SIGMA_N, 0.1);
}

#[test]
fn fast_strokes_at_a_slow_rate_are_no_noise() {
    // GIVEN 4 s of rest, then strokes of ± 2 N in contact at 5 Hz, 200 samples a second
    let count = 3000;
    let time_s: Vec<f64> = (0..count).map(|at| at as f64 * 5e-3).collect();
    let depth = |t: &f64| match *t {
        ..4.0 => -1.0,
        t => 1.5 - (TAU * 5.0 * (t - 4.0)).cos(),
    };
    let position_m = time_s.iter().map(|t| 1e-3 * depth(t)).collect();
    let noise = normals(count, 11);
    let pushed = |(t, noise): (&f64, &f64)| 2.0 * depth(t).max(0.0) + SIGMA_N * noise;
    let force_n = time_s.iter().zip(&noise).map(pushed).collect();
    let log = Log::from_channels(time_s.clone(), position_m, force_n);
    let floor = NoiseFloor::of(&log.uniform().unwrap(), &Floor::default());
    // THEN the floor is that of the noise, which the median of second differences takes for 1.7 times as much.
    let second_n = signal::noise(&log.force_n);
    assert!(second_n > 1.5 * SIGMA_N, "{second_n}");
    assert!((floor.used_n / SIGMA_N - 1.0).abs() < 0.1, "{floor:?}");
    assert!(!floor.coloured, "{floor:?}");
}

#[test]
fn a_rest_that_is_too_short_does_not_say_that_a_noise_is_white() {
    let of = |samples: usize| {
        let noise: Vec<f64> = normals(samples, 0).iter().map(|n| SIGMA_N * n).collect();
        NoiseFloor::of(&log(&noise, |_, _| 0.0, 1e-6), &Floor::default()).unseen
    };
    let (short, long) = (of(2500), of(4 * SAMPLES));
    // 450 samples give 3 %, and three times that, upon the 6 % by which rests may differ and agree.
    assert!((1.005..1.25).contains(&short), "{short}");
    assert_eq!(long, 1.0);
}

#[test]
fn a_noise_below_the_converters_step_is_no_spike() {
    // GIVEN coloured noise of 0.6 codes: six in ten samples at rest are the same one
    let noise: Vec<f64> = slow(90.0, SAMPLES, 0).iter().map(|n| SIGMA_N * n).collect();
    let code_n = SIGMA_N / 0.6;
    let floor = NoiseFloor::of(&log(&noise, |_, _| 0.0, code_n), &Floor::default());
    // THEN the floor is what noise and codes make together: not that of second differences, nor what
    // four medians of the sizes leave, 0.5 of it.
    let sigma_n = rms(noise).hypot(rounding_deviation(code_n));
    assert!(
        floor.coloured && floor.high_pass_n < 0.8 * sigma_n,
        "{floor:?}"
    );
    assert_near(&floor, sigma_n, 0.05);
}

#[test]
fn a_hump_is_known_from_the_whole_log_to_three_percent() {
    // GIVEN half of the power within 30 Hz of 120 Hz
    let (a, b) = (slow(30.0, SAMPLES, 1), slow(30.0, SAMPLES, 2));
    let noise: Vec<f64> = (0..SAMPLES)
        .map(|at| {
            let (sin, cos) = (TAU * 0.12 * at as f64).sin_cos();
            (0.5_f64.sqrt() * (a[at] * cos + b[at] * sin)) * SIGMA_N
        })
        .zip(white())
        .map(|(hump, white)| hump + 0.5_f64.sqrt() * white)
        .collect();
    let floor = NoiseFloor::of(&log(&noise, |_, _| 0.0, 1e-5), &Floor::default());
    assert!(floor.coloured && floor.high_pass_n < 0.8 * SIGMA_N);
    assert_near(&floor, rms(noise), 0.03);
    assert!((0.01..0.06).contains(&floor.uncertainty), "{floor:?}");
}

#[test]
fn slow_noise_is_noise_at_any_rate() {
    // GIVEN noise with a corner of 40 Hz at 10 kHz, of which second differences see an eighth
    for stream in 0..4 {
        let noise: Vec<f64> = slow(4.0, 10 * SAMPLES, stream)
            .iter()
            .map(|n| SIGMA_N * n)
            .collect();
        let floor = NoiseFloor::of(&log_at(10, &noise, |_, _| 0.0, 1e-9), &Floor::default());
        // THEN it is the floor, to the scatter of 3 s at rest.
        assert!(
            floor.coloured && floor.high_pass_n < 0.2 * SIGMA_N,
            "{floor:?}"
        );
        assert_near(&floor, SIGMA_N, 0.15);
    }
}

#[test]
fn a_chirp_at_rest_is_no_floor() {
    // GIVEN ten times the noise, from 3 to 30 Hz and back every 3 s, at rest and in motion
    let chirp = |t: f64, _: f64| {
        let u = (t % 3.0) - 1.5;
        14.0 * SIGMA_N * (TAU * (30.0 - 9.0 * u.abs()) * u).sin()
    };
    let floor = NoiseFloor::of(&log(&white(), chirp, 1e-5), &Floor::default());
    // THEN second differences are the floor, a fifth too high for what they see of 30 Hz, and it is said.
    assert_near(&floor, SIGMA_N, 0.2);
    assert!(
        floor.why.contains("no noise") && !floor.coloured,
        "{floor:?}"
    );
}

#[test]
fn a_faint_chirp_and_bursts_at_rest_are_no_floor() {
    // GIVEN a chirp that leaves 2.5 times the noise at rest once its lines are cut, and bursts of five times
    // the noise that last 0.2 s of every 0.3
    let chirp = |t: f64, _: f64| {
        let u = (t % 3.0) - 1.5;
        4.0 * SIGMA_N * (TAU * (30.0 - 9.0 * u.abs()) * u).sin()
    };
    let more = normals(SAMPLES, 4);
    let bursts = |t: f64, _: f64| {
        let at = (1e3 * t).round() as usize;
        let lasts = at % 300 < 200;
        if lasts { 5.0 * SIGMA_N * more[at] } else { 0.0 }
    };
    let of = |else_n: &dyn Fn(f64, f64) -> f64| {
        NoiseFloor::of(&log(&white(), else_n, 1e-5), &Floor::default())
    };
    // THEN the floor is that of the noise between them.
    assert_near(&of(&chirp), SIGMA_N, 0.1);
    assert_near(&of(&bursts), SIGMA_N, 0.1);
}

#[test]
fn a_disturbance_is_no_noise_and_a_wander_of_its_size_is_none() {
    // GIVEN five times the noise at 2.7 Hz: one cycle and a half in a rest, where no bin shows a line
    let line = |t: f64, _: f64| 7.0 * SIGMA_N * (TAU * 2.7 * t + 1.0).sin();
    assert_near(
        &NoiseFloor::of(&log(&white(), line, 1e-5), &Floor::default()),
        SIGMA_N,
        0.03,
    );
    // AND a noise of as much power below 6 Hz
    let wander: Vec<f64> = slow(6.0, SAMPLES, 3)
        .iter()
        .map(|wander| 5.0 * SIGMA_N * wander)
        .collect();
    let floor = NoiseFloor::of(&log(&wander, |_, _| 0.0, 1e-5), &Floor::default());
    // THEN the one is taken out and the other is the floor, and known to be a rough one.
    assert_near(&floor, rms(wander), 0.35);
    assert!(floor.uncertainty > 0.05, "{floor:?}");
}

#[test]
fn what_repeats_with_the_motion_hides_no_disturbance() {
    let both = |t: f64, v: f64| {
        let friction = if v == 0.0 {
            0.0
        } else {
            60.0 * SIGMA_N * v.signum()
        };
        friction + 7.0 * SIGMA_N * (TAU * 2.7 * t + 1.0).sin()
    };
    assert_near(
        &NoiseFloor::of(&log(&white(), both, 1e-5), &Floor::default()),
        SIGMA_N,
        0.05,
    );
}

#[test]
fn spikes_that_last_are_no_noise() {
    // GIVEN 20 ms at 40 standard deviations every 90 ms, a fifth of every rest
    let spikes = |t: f64, _: f64| {
        let lasts = t.rem_euclid(0.09) < 0.02;
        if lasts { 40.0 * SIGMA_N } else { 0.0 }
    };
    // THEN the floor is that of the rest of the time, to a fifth (it was 17 times that).
    assert_near(
        &NoiseFloor::of(&log(&white(), spikes, 1e-5), &Floor::default()),
        SIGMA_N,
        0.2,
    );
}

#[test]
fn without_rests_a_fast_line_is_no_noise() {
    // GIVEN 15 s that never rest, and ten times the noise at 140 Hz; the same with samples up to 0.3 ms early
    // or late, and 4 ms in the middle
    let late = |at: usize| {
        let middle = (2e-4 * at as f64).sin();
        4e-3 * middle + 3e-4 * ((at * at % 97) as f64 / 48.0 - 1.0)
    };
    let line = |time_s: f64| 14.0 * SIGMA_N * (TAU * 140.0 * time_s + 0.7).sin();
    let noise = white();
    let log = |is_even: bool| {
        let time_s: Vec<f64> = (0..SAMPLES)
            .map(|at| 1e-3 * at as f64 + if is_even { 0.0 } else { late(at) })
            .collect();
        let position = time_s.iter().map(|t| 1e-3 * (9.42 * t).sin()).collect();
        let each = time_s.iter().zip(&noise);
        let force = each.map(|(t, noise)| noise + line(*t)).collect();
        Log::from_channels(time_s, position, force)
            .uniform()
            .unwrap()
    };
    for is_even in [true, false] {
        let log = log(is_even);
        assert_eq!(log.taken.is_none(), is_even);
        let floor = NoiseFloor::of(&log, &Floor::default());
        // THEN the floor is the noise, and the line beside it is known to a tenth.
        assert_near(&floor, SIGMA_N, if is_even { 0.02 } else { 0.1 });
        let line_n = 14.0 * SIGMA_N / 2.0_f64.sqrt();
        assert!((floor.lines_n / line_n - 1.0).abs() < 0.1, "{floor:?}");
    }
}

#[test]
fn white_noise_is_white() {
    let floor = NoiseFloor::of(&log(&white(), |_, _| 0.0, 1e-5), &Floor::default());
    assert!(!floor.coloured && floor.uncertainty == 0.0, "{floor:?}");
    assert_near(&floor, SIGMA_N, 0.02);
}

#[test]
fn half_a_second_at_200_hz_is_a_rest_unless_nothing_is_touched() {
    // GIVEN slow noise, of which second differences at 5 ms see half
    let noise_n: Vec<f64> = slow(5.0, SAMPLES, 3)
        .iter()
        .map(|own| SIGMA_N * own)
        .collect();
    let fast = log(&noise_n, |_, _| 0.0, 1e-6);
    let thin = |column: &[f64]| column.iter().copied().step_by(5).collect::<Vec<f64>>();
    let log = UniformLog {
        rate_hz: 200.0,
        time_s: thin(&fast.time_s),
        force_n: thin(&fast.force_n),
        position_m: thin(&fast.position_m),
        in_gap: vec![false; SAMPLES / 5],
        ..UniformLog::default()
    };
    // THEN its rests of 100 samples show it, and are none where they may be an end that is held.
    let decide = Floor::default();
    let floor = NoiseFloor::of(&log, &decide);
    assert!(floor.rest_n.is_some() && floor.coloured, "{floor:?}");
    let of_machine = NoiseFloor::of(&log, &decide.without_free_air());
    assert_eq!(of_machine.rest_n, None);
    assert!(of_machine.used_n < 0.7 * floor.used_n, "{of_machine:?}");
}

/// The same noise twice through a low-pass of first order, with unit variance.
fn filtered(corner_hz: f64, count: usize, stream: u64) -> Vec<f64> {
    let keep = (-TAU * corner_hz * 1e-3).exp();
    let mut state = 0.0;
    let once = slow(corner_hz, count, stream).into_iter();
    let twice: Vec<f64> = once
        .map(|own| {
            state = keep * state + (1.0 - keep) * own;
            state
        })
        .collect();
    let size = rms(twice.iter().copied());
    twice.into_iter().map(|own| own / size).collect()
}

/// 20 s at 1 kHz of a motion that never rests and never leaves 0.9 kN/m and 5 N s/m, with counts of 1 µm.
fn never_at_rest(noise_n: &[f64], else_n: impl Fn(f64, f64) -> f64) -> UniformLog {
    let place = |t: f64| 2e-3 + 8e-4 * (4.4 * t).sin() + 3e-4 * (14.5 * t).sin();
    let speed = |t: f64| 3.52e-3 * (4.4 * t).cos() + 4.35e-3 * (14.5 * t).cos();
    let time_s: Vec<f64> = (0..noise_n.len()).map(|at| 1e-3 * at as f64).collect();
    let force = |(t, noise): (&f64, &f64)| {
        900.0 * place(*t) + 5.0 * speed(*t) + else_n(place(*t), speed(*t)) + noise
    };
    UniformLog {
        rate_hz: 1000.0,
        force_n: time_s.iter().zip(noise_n).map(force).collect(),
        position_m: time_s
            .iter()
            .map(|t| (1e6 * place(*t)).round() * 1e-6)
            .collect(),
        in_gap: vec![false; time_s.len()],
        time_s,
        ..UniformLog::default()
    }
}

#[test]
fn noise_behind_a_filter_is_noise_whether_anything_rests_or_not() {
    // GIVEN noise twice behind a corner of 100 or of 30 Hz: second differences see a third of it, or a sixteenth
    for (corner_hz, seen) in [(100.0, 0.4), (30.0, 0.1)] {
        let noise: Vec<f64> = filtered(corner_hz, 20_000, 5)
            .iter()
            .map(|own| 5.0 * SIGMA_N * own)
            .collect();
        for log in [
            never_at_rest(&noise, |_, _| 0.0),
            log(&noise, |_, _| 0.0, 1e-6),
        ] {
            let floor = NoiseFloor::of(&log, &Floor::default()).with_slow_noise();
            // THEN the floor is the noise, to a tenth.
            assert!(floor.high_pass_n < seen * 5.0 * SIGMA_N, "{floor:?}");
            assert_near(&floor, 5.0 * SIGMA_N, 0.1);
            assert!(floor.coloured && floor.correlation > 3.0, "{floor:?}");
        }
    }
}

#[test]
fn noise_behind_a_slow_filter_is_noise_at_rest() {
    // GIVEN noise twice behind a corner of 14 Hz, and a thirteenth of it that is white: all that second differences see
    let white = normals(20_000, 7);
    let slow = filtered(14.0, 20_000, 6);
    let each = slow.iter().zip(&white);
    let noise: Vec<f64> = each
        .map(|(slow, white)| 5.0 * SIGMA_N * (slow + white / 13.0))
        .collect();
    let log = log(&noise, |_, _| 0.0, 1e-6);
    let floor = NoiseFloor::of(&log, &Floor::default());
    let rest_n = floor.rest_n.unwrap();
    assert!(rest_n > Floor::default().largest_colour * floor.high_pass_n);
    // THEN it is the floor, for its fourth moment is that of noise, as a chirp's is not. Six rests of half a second
    // hardly tell a corner at 14 Hz from noise that rises on: of 200 such logs the floor is 1.6 times too large in ten.
    assert_near(&floor, 5.0 * SIGMA_N, 0.6);
}

#[test]
fn what_an_effect_adds_to_a_motion_without_rest_is_no_noise() {
    // GIVEN white noise or none at all, and a friction, a cogging of 0.2 mm or a line of 8 Hz, ten times as large
    let line = |at: usize| 14.0 * SIGMA_N * (TAU * 8e-3 * at as f64).sin();
    let (friction, cogging) = (
        |_: f64, v: f64| 10.0 * SIGMA_N * v.signum(),
        |x: f64, _: f64| 14.0 * SIGMA_N * (TAU * x / 2e-4).sin(),
    );
    for size in [SIGMA_N, 0.0] {
        let noise: Vec<f64> = normals(20_000, 7).iter().map(|own| size * own).collect();
        let both = noise.iter().enumerate().map(|(at, own)| own + line(at));
        for log in [
            never_at_rest(&noise, friction),
            never_at_rest(&noise, cogging),
            never_at_rest(&both.collect::<Vec<f64>>(), |_, _| 0.0),
        ] {
            let floor = NoiseFloor::of(&log, &Floor::default());
            assert!(floor.slow.is_none() && !floor.coloured, "{floor:?}");
        }
    }
}

#[test]
fn a_low_pass_leaves_more_of_slow_noise_than_of_white() {
    // GIVEN white noise and noise behind corners of 100 and 15 Hz, with rests and without, and a low-pass of 20 Hz
    let sized = |noise: Vec<f64>| -> Vec<f64> { noise.iter().map(|own| SIGMA_N * own).collect() };
    // Rests of half a second do not show noise of 15 Hz, and say a third too much.
    let (noises, decide) = (
        [
            (normals(20_000, 9), true),
            (filtered(100.0, 20_000, 10), true),
            (filtered(15.0, 20_000, 11), false),
        ],
        Floor::default(),
    );
    for (noise, rests_show_it) in noises {
        let noise = sized(noise);
        let left_n = rms(smoothed(&noise));
        let mut logs = vec![never_at_rest(&noise, |_, _| 0.0)];
        logs.extend(rests_show_it.then(|| log(&noise, |_, _| 0.0, 1e-6)));
        for log in logs {
            let filtered = UniformLog {
                force_n: smoothed(&log.force_n),
                ..log.clone()
            };
            let floor = NoiseFloor::of(&log, &decide).with_slow_noise();
            let floor = floor.in_band((&log, &filtered), 0.032, &decide);
            let ratio = floor.noise_n() / left_n;
            // THEN the floor is the noise that is left, to a quarter.
            assert!((0.75..1.25).contains(&ratio), "{ratio}: {floor:?}");
        }
    }
}

/// A channel forwards and backwards through a first-order low-pass of 20 Hz.
fn smoothed(channel: &[f64]) -> Vec<f64> {
    let mut channel = channel.to_vec();
    for _ in 0..2 {
        let mut state = channel.first().copied().unwrap_or(0.0);
        for sample in &mut channel {
            state += (1.0 - (-TAU * 0.02).exp()) * (*sample - state);
            *sample = state;
        }
        channel.reverse();
    }
    channel
}
