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
