//! One reading that is off, and a count that is lost: what five readings in a row show.
//!
//! Both are seen two samples late. A touch is a kink as sharp as a spike and friction that turns a step
//! as high, and only what follows tells them apart.

/// How late (samples) an outlier shows.
pub const LATE: usize = 2;
/// Share of what a spike leaves the mean of its neighbours by, by which it must leave the lines through the
/// two readings on either side. One reading that is off leaves all three alike, a step the line behind it
/// hardly.
const OFF_LINES: f32 = 0.5;

/// The last five readings, the newest last.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Recent {
    readings: [f32; 5],
    count: u8,
}

impl Recent {
    /// Takes a reading; says whether there are five.
    pub(super) fn update(&mut self, reading: f32) -> bool {
        let [_, a, b, c, d] = self.readings;
        self.readings = [a, b, c, d, reading];
        self.count = self.count.saturating_add(1);
        self.count >= 5
    }

    /// Whether the middle reading leaves the mean of its neighbours by more than `limit`, and the lines
    /// through the two readings before and behind it to the same side.
    pub(super) fn spike(&self, limit: f32) -> bool {
        let [first, before, middle, behind, last] = self.readings;
        let off = middle - 0.5 * (before + behind);
        let from_before = middle - (before + before - first);
        let from_behind = middle - (behind + behind - last);
        let beyond = |line: f32| line * off > 0.0 && line.abs() > OFF_LINES * off.abs();
        off.abs() > limit && beyond(from_before) && beyond(from_behind)
    }

    /// Whether the change to the middle reading lies outside of the others by more than `limit` and what
    /// these differ by: the way is the same before and after, and a piece of it is missing.
    pub(super) fn step(&self, limit: f32) -> bool {
        let [first, before, middle, behind, last] = self.readings;
        let change = middle - before;
        let others = [before - first, behind - middle, last - behind];
        let low = others.into_iter().fold(f32::INFINITY, f32::min);
        let high = others.into_iter().fold(f32::NEG_INFINITY, f32::max);
        let beyond = limit + (high - low);
        change > high + beyond || change < low - beyond
    }
}
