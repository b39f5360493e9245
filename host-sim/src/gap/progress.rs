//! How far it is.

/// Whoever is told.
pub trait Progress: Sync {
    /// `share` of the work is done (0 to 1); `what` is done next.
    fn at(&self, share: f64, what: &str);
}

/// Nobody.
#[derive(Clone, Copy, Debug)]
pub struct Silent;

impl Progress for Silent {
    fn at(&self, _share: f64, _what: &str) {}
}
