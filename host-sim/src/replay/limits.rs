//! What the readings of a log stay within, read off the log: the limits with which the board's own code
//! ([`estimator_core::board::sensing`]) recognises the faults in it.
//!
//! A board knows its sensors from its settings. A log has to tell: how often the force repeats a code,
//! where its range ends, how sharply force and position turn. Each limit is a multiple of what the log
//! does nearly all the time, so that a fault of a few samples does not hide itself.

use estimator_core::board::sensing::{Limits, Standstill};

use crate::log::UniformLog;
use crate::signal;
use crate::stats::{extent, quantile, range};

/// Codes in the range of a channel without steps: exact in f32.
const FINEST_CODES: f64 = 4_194_304.0;
/// Chance that noise repeats a code for as long as a stuck converter: one sample in 10¹⁰ is one in
/// four months at 1 kHz.
const BY_CHANCE: f64 = 1e-10;
/// The same for as long as one that hung, where a leap follows that noise makes less than once in 10¹¹ samples. A converter
/// that hung for 5 ms of a first press, six readings, made a damping 7 % wrong, `converged` for a second.
const HUNG_BY_CHANCE: f64 = 1e-4;
/// Samples of the blocks over which it is found how often a code repeats, and the share of them that may
/// be worse: a converter that hung for a twentieth of the log does not hide.
const BLOCK: usize = 100;
const WORST_BLOCKS: f64 = 0.05;
/// Above this share of repeated codes the noise does not reach a code, and a repeated one says nothing.
const MOST_REPEATED: f64 = 0.8;
/// Shortest run that is stuck or saturated (samples).
const SHORTEST_RUN: usize = 5;
/// Samples that repeat at rest take so many times longer than in motion to be stuck.
const AT_REST: usize = 4;
/// A spike leaves its neighbours by this many standard deviations of the noise: 5.7 of those of the difference.
const SPIKE_SIGMAS: f64 = 7.0;
/// A way is one beyond this many counts or standard deviations of the position.
const WAY_COUNTS: f64 = 8.0;
/// Where a position has no noise, a way is one beyond this many times the step that all but a twentieth stay within.
const CORNER: f64 = 1.5;
const COMMON: f64 = 0.95;
/// Samples that a position must stand in the midst of a motion.
const STANDING: f64 = 16.0;

/// The scale of the codes that a log is turned into, and their limits.
#[derive(Clone, Copy, Debug)]
pub(super) struct LogSensors {
    /// Force of a code (N).
    pub(super) n_per_code: f64,
    /// Position of a code (m).
    pub(super) m_per_code: f64,
    /// What the codes stay within.
    pub(super) limits: Limits,
}

impl LogSensors {
    /// Reads them off the measured samples of a log.
    pub(super) fn of(log: &UniformLog) -> LogSensors {
        let force = signal::measured(&log.force_n, &log.in_gap);
        let position = signal::measured(&log.position_m, &log.in_gap);
        let (n_per_code, m_per_code) = (code(&force), code(&position));
        let (noise_n, noise_m) = (signal::loud_noise(&force), signal::noise(&position));
        let way_m = WAY_COUNTS * noise_m.max(signal::step(&position).unwrap_or(0.0));
        // A command without noise turns corners, which are no jumps.
        let way_m = match way_m > 0.0 {
            true => way_m,
            false => CORNER * quantile(changes(&position), COMMON),
        };
        let codes: Vec<i64> = force
            .iter()
            .map(|f| (f / n_per_code).round() as i64)
            .collect();
        let period_us = 1e6 / log.rate_hz;
        let us = |samples: usize| ((samples as f64 - 1.5) * period_us) as u64;
        let often = repeated(&codes);
        let stuck = often.map(|often| shortest_run(often, BY_CHANCE));
        let hung = often.map(|often| shortest_run(often, HUNG_BY_CHANCE));
        // Noise that does not reach a code, and none at all, leave flat tops that are no rails.
        let visible = noise_n > 0.5 * n_per_code && stuck.is_some();
        let (lowest, highest) = match visible {
            true => rails(&codes, &position, way_m, stuck.unwrap_or(SHORTEST_RUN)),
            false => (f64::NEG_INFINITY, f64::INFINITY),
        };
        let spike_n = (SPIKE_SIGMAS * noise_n).max(0.5 * signal::sharpest(&force));
        let limits = Limits {
            lowest: lowest as f32,
            highest: highest as f32,
            stuck_us: stuck.map_or(0, |samples| us(AT_REST * samples)),
            stuck_moving_us: stuck.map_or(0, us),
            stuck_way_m: way_m as f32,
            hung_us: hung.map_or(0, |samples| us(samples + 1)),
            spike_n: spike_n as f32,
            jump_m: way_m.max(signal::sharpest(&position)) as f32,
            standstill: Standstill {
                after_us: ((STANDING - 0.5) * period_us) as u64,
                way_m: way_m as f32,
            },
            ..Limits::NONE
        };
        LogSensors {
            n_per_code,
            m_per_code,
            limits,
        }
    }
}

/// How far a channel goes from sample to sample.
fn changes(channel: &[f64]) -> impl Iterator<Item = f64> {
    channel.windows(2).map(|pair| (pair[1] - pair[0]).abs())
}

/// The step of a channel, or one fine enough that nothing is lost.
fn code(channel: &[f64]) -> f64 {
    let fine = (range(channel) / FINEST_CODES).max(f64::MIN_POSITIVE.sqrt());
    signal::step(channel).unwrap_or(fine).max(fine)
}

/// For how many samples a code must repeat before noise, which repeats one so often, has not done it but by chance.
fn shortest_run(often: f64, by_chance: f64) -> usize {
    let repeats = (by_chance.ln() / often.max(1e-6).ln()).ceil() as usize;
    (repeats + 1).max(SHORTEST_RUN)
}

/// How often noise repeats a code; `None` if it shows in too few samples to say.
fn repeated(codes: &[i64]) -> Option<f64> {
    // At the ends of a range codes repeat for another reason.
    let (lowest, highest) = (codes.iter().min(), codes.iter().max());
    let inside = |code: &i64| Some(code) != lowest && Some(code) != highest;
    let blocks = codes.chunks_exact(BLOCK).map(|block| {
        let pairs = block.windows(2).filter(|pair| pair[0] == pair[1]);
        let repeated = pairs.filter(|pair| inside(&pair[0])).count();
        repeated as f64 / (BLOCK - 1) as f64
    });
    let often = quantile(blocks, 1.0 - WORST_BLOCKS);
    (codes.len() >= 2 * BLOCK && often <= MOST_REPEATED).then_some(often)
}

/// The codes between which the converter is within its range: beyond them its ends, where the same code
/// repeats while the probe goes on.
fn rails(codes: &[i64], position: &[f64], way_m: f64, shortest: usize) -> (f64, f64) {
    let ends = |end: i64| {
        let mut at = 0;
        codes.chunk_by(|a, b| a == b).any(|run| {
            let here = at..at + run.len();
            at = here.end;
            let (low, high) = extent(&position[here]);
            run.len() >= shortest && run[0] == end && high - low >= way_m
        })
    };
    let lowest = codes.iter().copied().min().unwrap_or(0);
    let highest = codes.iter().copied().max().unwrap_or(0);
    let low = if ends(lowest) {
        lowest as f64 + 0.5
    } else {
        f64::NEG_INFINITY
    };
    let high = if ends(highest) {
        highest as f64 - 0.5
    } else {
        f64::INFINITY
    };
    (low, high)
}
