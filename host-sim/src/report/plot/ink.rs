//! The colours and strokes of curves and strips.

/// The colour of a series. The style sheet chooses colours that people with any colour vision tell apart
/// (Okabe & Ito), and others in dark mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Ink {
    /// The colour of what was measured, which is neutral and dark on light.
    Measured = 0,
    /// The first colour, for the estimate or the better model.
    First = 1,
    /// The second colour.
    Second = 2,
    /// The third colour.
    Third = 3,
    /// The fourth colour.
    Fourth = 4,
    /// The colour of what stays in the background, such as noise bands and references.
    Muted = 5,
}

impl Ink {
    pub(crate) const CLASSES: [&'static str; 6] = ["m", "a", "b", "c", "d", "n"];
    /// The colours for series of equal rank, in order.
    pub const RANKS: [Ink; 4] = [Ink::First, Ink::Second, Ink::Third, Ink::Fourth];
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Stroke {
    /// A line.
    Solid = 0,
    /// A dashed line.
    Dashed = 1,
    /// A dot for each point.
    Dots = 2,
    /// A hairline, for a noisy signal.
    Thin = 3,
}

/// The colours of a strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StripTone {
    /// The state is as it should be.
    Good = 0,
    /// The state is on its way, or should be looked at.
    Warning = 1,
    /// The state is not to be trusted.
    Bad = 2,
    /// The state says neither good nor bad.
    Neutral = 3,
    /// The state is new information.
    Info = 4,
}
