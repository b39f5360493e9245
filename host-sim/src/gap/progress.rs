//! How far the workflow is.

/// Receives how far the workflow is.
pub trait Progress: Sync {
    /// `share` of the work is done (0 to 1), and `what` is done next.
    fn at(&self, share: f64, what: &str);
}

/// Ignores how far the workflow is.
#[derive(Clone, Copy, Debug)]
pub struct Silent;

impl Progress for Silent {
    fn at(&self, _share: f64, _what: &str) {}
}

/// A part of the work: its own shares lie between two of the whole.
pub(super) struct Within<'a> {
    whole: &'a dyn Progress,
    from: f64,
    to: f64,
}

impl<'a> Within<'a> {
    pub(super) fn new(whole: &'a dyn Progress, from: f64, to: f64) -> Within<'a> {
        Within { whole, from, to }
    }
}

impl Progress for Within<'_> {
    fn at(&self, share: f64, what: &str) {
        self.whole
            .at(self.from + share * (self.to - self.from), what);
    }
}
