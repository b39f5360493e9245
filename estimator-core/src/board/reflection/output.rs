//! From a force to what a board puts out: a share of its full output, and the code of that.

/// The conversion of a force to a share of the full output: 0 N is a share of it, and every newton is
/// as much more of it, or less.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// The share of the full output that stands for 0 N, from 0 to 1.
    pub zero: f32,
    /// The force from no output to the full one (N); negative if the output falls with the force.
    pub full_n: f32,
}

impl Output {
    /// The share for a force (N), from 0 to 1; that of 0 N for a force that is no number.
    pub fn share(&self, force_n: f32) -> f32 {
        let share = self.zero + force_n / self.full_n;
        let share = if share.is_finite() { share } else { self.zero };
        share.clamp(0.0, 1.0)
    }

    /// The code for a force (N), of a board whose full output has the code `full`: the nearest.
    pub fn code(&self, force_n: f32, full: u16) -> u16 {
        // From 0 to `full`, since a share is from 0 to 1; what is not would be cut off by `as`.
        (self.share(force_n) * f32::from(full) + 0.5) as u16
    }

    /// Whether the output carries a force (N).
    pub fn carries(&self, force_n: f32) -> bool {
        (0.0..=1.0).contains(&(self.zero + force_n / self.full_n))
    }
}
