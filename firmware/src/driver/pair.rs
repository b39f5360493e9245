//! Both sensors as one instant, in the same codes as the reference wiring's.

use estimator_core::board::sensing::Codes;
use estimator_core::{Fault, Faults};

/// The middle of a conversion, in 1/32 of a tick after its start: it takes 0.5 to 0.6 ms of the tick's
/// 1 ms. What is left, 0.02 ms, is 0.03 N s/m of damping at a stiffness of 1350 N/m.
const MIDDLE: i32 = 9;
/// Position codes per count of the encoder.
pub const CODES_PER_COUNT: i32 = 32;

/// What is remembered from tick to tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pair {
    last: Option<Last>,
}

#[derive(Clone, Copy, Debug)]
struct Last {
    time_us: u64,
    /// As the encoder gave it, 14 bits, and that without its wraps.
    angle: u16,
    count: i32,
    force: i32,
    /// Whether that tick's angle was a good one.
    good: bool,
}

impl Pair {
    /// What was read at a tick of time `time_us`, the angle first, since the next conversion starts
    /// right after it; `ready`: what the converter's DRDY pin said before. Gives the instant of the
    /// conversion that the last tick started; nothing at the first.
    ///
    /// The conversion lasts from the last tick to its middle: its position lies between the angle of
    /// then and that of now, [`MIDDLE`] of the way.
    pub fn sample(
        &mut self,
        time_us: u64,
        ready: bool,
        angle: Option<u16>,
        force: Option<i32>,
    ) -> Option<Codes> {
        let Some(last) = self.last else {
            self.last = Some(Last {
                time_us,
                angle: angle.unwrap_or(0),
                count: 0,
                force: 0,
                good: angle.is_some(),
            });
            return None;
        };
        let now = Last {
            time_us,
            angle: angle.unwrap_or(last.angle),
            count: (last.count).wrapping_add(moved(last.angle, angle.unwrap_or(last.angle))),
            force: force.unwrap_or(last.force),
            good: angle.is_some(),
        };
        self.last = Some(now);
        let mut faults = Faults::NONE;
        if !(last.good && now.good) {
            faults = faults.with(Fault::PositionUnusable);
        }
        if !ready || force.is_none() {
            faults = faults.with(Fault::ForceUnusable);
        }
        Some(Codes {
            time_us: last.time_us,
            force: now.force,
            force_low: now.force,
            force_high: now.force,
            position: CODES_PER_COUNT
                .wrapping_mul(last.count)
                .wrapping_add(MIDDLE * now.count.wrapping_sub(last.count)),
            faults,
        })
    }
}

/// Counts from one angle to the next, the short way round: right below half a turn a tick.
fn moved(from: u16, to: u16) -> i32 {
    let turned = to.wrapping_sub(from) << 2;
    i32::from(turned as i16) >> 2
}
