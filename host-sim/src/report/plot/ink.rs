//! What curves and strips look like.

/// The colour of a series. The style sheet gives them colours that people with any colour vision
/// tell apart (Okabe & Ito), others in dark mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Ink {
    /// What was measured: neutral, dark on light.
    Measured = 0,
    /// The first colour: the estimate, the better model.
    First = 1,
    /// The second colour.
    Second = 2,
    /// The third colour.
    Third = 3,
    /// The fourth colour.
    Fourth = 4,
    /// Background: noise bands, references.
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
    /// As it should be.
    Good = 0,
    /// On its way, or to be looked at.
    Warning = 1,
    /// Not to be trusted.
    Bad = 2,
    /// Nothing to say.
    Neutral = 3,
    /// News.
    Info = 4,
}
