//! The force that a master puts out, and what kept it from being the law's own.

use crate::estimate::fault::Faults;

/// What kept the force from being the law's own. The numbers are bits of [`Rendered::limits`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Limit {
    /// The force is the largest one.
    Force = 1,
    /// The stiffness is the largest one.
    Stiffness = 2,
    /// The damping is the largest one.
    Damping = 4,
    /// The force changes as fast as it may.
    Slew = 8,
    /// Another impedance is coming in.
    Blending = 16,
    /// Packets have stopped, and the force fades out or has.
    Fading = 32,
}

impl Limit {
    /// All limits, in the order of their bits.
    pub const ALL: [Limit; 6] = [
        Limit::Force,
        Limit::Stiffness,
        Limit::Damping,
        Limit::Slew,
        Limit::Blending,
        Limit::Fading,
    ];

    /// The limit in a word.
    pub const fn name(self) -> &'static str {
        match self {
            Limit::Force => "force",
            Limit::Stiffness => "stiffness",
            Limit::Damping => "damping",
            Limit::Slew => "slew",
            Limit::Blending => "blending",
            Limit::Fading => "fading",
        }
    }
}

/// The force that was put out at an instant. Kind 8 of [`crate::board::frame`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rendered {
    /// The instant (µs), by the master's clock.
    pub time_us: u64,
    /// Force on the operator (N), pushing out of the material; never negative.
    pub force_n: f32,
    /// Sequence number of the packet that was rendered; 0 before the first.
    pub sequence: u16,
    /// Bits of [`Limit`].
    pub limits: u8,
    /// `Fault::RenderStopped`, `Fault::RenderUnusable`, or none.
    pub faults: Faults,
}

impl Rendered {
    /// Whether a limit was at work.
    pub const fn has(&self, limit: Limit) -> bool {
        self.limits & limit as u8 != 0
    }

    pub(super) fn mark(&mut self, limit: Limit, applies: bool) {
        if applies {
            self.limits |= limit as u8;
        }
    }
}
