//! From the codes of the converters to a [`Sample`]: scale, zero, and the faults that the codes show.
//! It is the same for every set of sensors; a board only reads codes.

mod outlier;
mod standstill;

pub use outlier::LATE;
pub use standstill::Standstill;

use crate::estimate::{fault::Fault, fault::Faults, sample::Sample};
use outlier::Recent;
use standstill::{Moving, micros};

/// The codes of the position in one count of the encoder: the sum of 32 latches, or a count times 32.
pub const CODES_PER_COUNT: i32 = 32;

/// One instant as the hardware gave it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Codes {
    /// Time since start (µs).
    pub time_us: u64,
    /// The sum of all conversions of the load cell in the instant.
    pub force: i32,
    /// The lowest single conversion of the instant.
    pub force_low: i32,
    /// The highest single conversion of the instant.
    pub force_high: i32,
    /// The code of the encoder, without the wraps of its counter.
    pub position: i32,
    /// The faults that the reader of the hardware has seen.
    pub faults: Faults,
}

/// Scale and limits, ready to use. Made by [`crate::board::settings::Settings::setup`], or of the limits
/// that a host reads off a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conversion {
    n_per_code: f32,
    zero_code: f32,
    m_per_code: f32,
    limits: Limits,
    /// Faults that last as long as the settings do.
    standing: Faults,
}

/// What the readings of sensors in order stay within.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// A single conversion below this is saturated.
    pub lowest: f32,
    /// A single conversion above this is saturated.
    pub highest: f32,
    /// A single conversion that is so many codes beyond these is none: a cable is off; 0: never.
    pub broken_beyond: f32,
    /// A position further from zero than this is none (m); 0: never.
    pub reach_m: f32,
    /// The same code for this long is a stuck converter; 0: never.
    pub stuck_us: u64,
    /// The same code for this long, while the position has gone `stuck_way_m`, is one as well; 0: never.
    pub stuck_moving_us: u64,
    /// See `stuck_moving_us` (m).
    pub stuck_way_m: f32,
    /// The same code for this long, and then one that is off by more than `spike_n`, was one as well; 0: never.
    pub hung_us: u64,
    /// A force that stands out of its neighbours by more is a spike (N); 0: never.
    pub spike_n: f32,
    /// A faster motion between two samples is a jump; 0: never.
    pub fastest_m_per_us: f32,
    /// A position that stands out of its neighbours by more, or a change that does, is a jump (m); 0: never.
    pub jump_m: f32,
    /// A force that rises by this much over a standing position is a stuck encoder; 0: never.
    pub stuck_n: f32,
    /// A position that stops in the midst of a motion and then jumps is one as well.
    pub standstill: Standstill,
}

impl Limits {
    /// Limits that everything stays within.
    pub const NONE: Limits = Limits {
        lowest: f32::NEG_INFINITY,
        highest: f32::INFINITY,
        broken_beyond: 0.0,
        reach_m: 0.0,
        stuck_us: 0,
        stuck_moving_us: 0,
        stuck_way_m: 0.0,
        hung_us: 0,
        spike_n: 0.0,
        fastest_m_per_us: 0.0,
        jump_m: 0.0,
        stuck_n: 0.0,
        standstill: Standstill {
            after_us: 0,
            way_m: 0.0,
        },
    };
}

/// The state of [`Conversion::sample`] from one instant to the next.
#[derive(Clone, Copy, Debug, Default)]
pub struct Watch {
    last: Option<Last>,
    force: Recent,
    position: Recent,
    moving: Moving,
}

#[derive(Clone, Copy, Debug)]
struct Last {
    time_us: u64,
    position_m: f32,
    force: i32,
    /// The time since which the force has had this code (µs), and where the position was then.
    force_since_us: u64,
    force_since_m: f32,
    position: i32,
    /// The least force since the position has had this code (N).
    least_n: f32,
}

impl Conversion {
    /// A conversion with a scale (N and m per code), the code of 0 N, and limits.
    pub const fn new(n_per_code: f32, zero_code: f32, m_per_code: f32, limits: Limits) -> Self {
        Conversion {
            n_per_code,
            zero_code,
            m_per_code,
            limits,
            standing: Faults::NONE,
        }
    }

    /// The same conversion with faults that last, such as settings that could not be read.
    pub fn with_standing(self, faults: Faults) -> Self {
        Conversion {
            standing: self.standing | faults,
            ..self
        }
    }

    /// The sample that the estimator sees.
    ///
    /// The zero is taken off before the scale is applied, in f32: exact for codes up to 2²⁴.
    pub fn sample(&self, watch: &mut Watch, codes: &Codes) -> Sample<f32> {
        let force_n = (codes.force as f32 - self.zero_code) * self.n_per_code;
        let position_m = codes.position as f32 * self.m_per_code;
        let broken = self.broken(codes, position_m);
        let faults = codes.faults | self.standing | self.saturation(codes) | broken;
        let (last, seen) = self.watched(watch.last, codes, force_n, position_m);
        watch.last = Some(last);
        let seen = seen | self.outliers(watch, codes.time_us, force_n, position_m);
        Sample {
            time_us: codes.time_us,
            position_m,
            force_n,
            faults: faults | seen,
        }
    }

    /// Returns whether the encoder's counter may have gone round unseen since the last instant: instants are missing
    /// before that at `time_us` (µs), of which one comes every `period_us` (µs), and the fastest motion would have gone
    /// half of the counter's range of `counts` in that time. A range of 0 never ends.
    pub fn may_have_gone_round(
        &self,
        watch: &Watch,
        time_us: u64,
        period_us: u64,
        counts: u32,
    ) -> bool {
        let Some(last) = watch.last.as_ref().filter(|_| counts > 0) else {
            return false;
        };
        let elapsed_us = time_us.saturating_sub(last.time_us);
        // From one instant to the next the count is followed, and a jump of it shows.
        if elapsed_us < 2 * period_us {
            return false;
        }
        let half_m = (counts / 2) as f32 * CODES_PER_COUNT as f32 * self.m_per_code.abs();
        self.limits.fastest_m_per_us * micros(elapsed_us) > half_m
    }

    fn saturation(&self, codes: &Codes) -> Faults {
        let saturated = (codes.force_low as f32) < self.limits.lowest
            || codes.force_high as f32 > self.limits.highest;
        only(saturated, Fault::ForceSaturated)
    }

    /// A cable that is off: codes that no force gives, or a position where the rig cannot be.
    fn broken(&self, codes: &Codes, position_m: f32) -> Faults {
        let limits = &self.limits;
        let below = limits.lowest - codes.force_low as f32;
        let above = codes.force_high as f32 - limits.highest;
        let beyond = limits.broken_beyond;
        let force = beyond > 0.0 && below.max(above) >= beyond;
        let position = limits.reach_m > 0.0 && position_m.abs() > limits.reach_m;
        only(force, Fault::ForceUnusable) | only(position, Fault::PositionUnusable)
    }

    /// A spike of the force, a jump of the position and an encoder that was stuck, [`LATE`] samples late.
    fn outliers(&self, watch: &mut Watch, time_us: u64, force_n: f32, position_m: f32) -> Faults {
        let limits = &self.limits;
        if limits.spike_n == 0.0 && limits.jump_m == 0.0 {
            return Faults::NONE;
        }
        let full = watch.force.update(force_n) & watch.position.update(position_m);
        let moving = &mut watch.moving;
        let since_standstill = moving.update(&limits.standstill, time_us, position_m);
        let spike = full && limits.spike_n > 0.0 && watch.force.spike(limits.spike_n);
        let watched = full && limits.jump_m > 0.0;
        let jump = watched && watch.position.spike(limits.jump_m);
        let step = watched && watch.position.step(limits.jump_m);
        let stuck = step && usize::from(since_standstill) == LATE + 1;
        only(spike, Fault::ForceUnusable)
            | only(jump || step, Fault::PositionJump)
            | only(stuck, Fault::PositionStuck)
    }

    fn watched(
        &self,
        last: Option<Last>,
        codes: &Codes,
        force_n: f32,
        position_m: f32,
    ) -> (Last, Faults) {
        let first = Last {
            time_us: codes.time_us,
            position_m,
            force: codes.force,
            force_since_us: codes.time_us,
            force_since_m: position_m,
            position: codes.position,
            least_n: force_n,
        };
        let Some(last) = last else {
            return (first, Faults::NONE);
        };
        let elapsed_us = codes.time_us.saturating_sub(last.time_us);
        let way_m = (position_m - last.position_m).abs();
        let fastest = self.limits.fastest_m_per_us;
        let jumped = fastest > 0.0 && way_m > fastest * micros(elapsed_us);
        let (force_since_us, force_since_m) = match codes.force == last.force {
            true => (last.force_since_us, last.force_since_m),
            false => (codes.time_us, position_m),
        };
        let now = Last {
            force_since_us,
            force_since_m,
            least_n: match codes.position == last.position {
                true => force_n.min(last.least_n),
                false => force_n,
            },
            ..first
        };
        // A force that falls over a standing probe is relaxation; one that rises is not.
        let stuck_n = self.limits.stuck_n;
        let position_stuck = stuck_n > 0.0 && force_n - now.least_n > stuck_n;
        // At the end of its range a converter repeats its code without hanging.
        let force_stuck = (self.force_stuck(&now) || self.force_hung(&last, &now))
            && self.saturation(codes) == Faults::NONE;
        let faults = only(jumped, Fault::PositionJump)
            | only(force_stuck, Fault::ForceStuck)
            | only(position_stuck, Fault::PositionStuck);
        (now, faults)
    }

    fn force_stuck(&self, now: &Last) -> bool {
        let limits = &self.limits;
        let still_us = now.time_us.saturating_sub(now.force_since_us);
        let way_m = (now.position_m - now.force_since_m).abs();
        let stuck = limits.stuck_us > 0 && still_us >= limits.stuck_us;
        let moving = limits.stuck_moving_us > 0 && still_us >= limits.stuck_moving_us;
        stuck || (moving && way_m >= limits.stuck_way_m)
    }

    /// Whether the force goes on after it hung: noise repeats a code as often, but does not leap then.
    fn force_hung(&self, last: &Last, now: &Last) -> bool {
        let limits = &self.limits;
        let held_us = now.time_us.saturating_sub(last.force_since_us);
        let leap_n = now.force.abs_diff(last.force) as f32 * self.n_per_code.abs();
        limits.hung_us > 0 && held_us >= limits.hung_us && leap_n > limits.spike_n
    }
}

fn only(is: bool, fault: Fault) -> Faults {
    match is {
        true => Faults::NONE.with(fault),
        false => Faults::NONE,
    }
}

#[cfg(test)]
mod tests;
