//! A stretch of a log in which something else happens.

/// A stretch of a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Episode {
    /// The number of the log.
    pub log: usize,
    /// Where it begins (s).
    pub from_s: f64,
    /// Where it ends (s).
    pub until_s: f64,
}

impl Episode {
    /// How long it is (s).
    pub(in crate::gap) fn length_s(&self) -> f64 {
        self.until_s - self.from_s
    }
}
