//! How far it is.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

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

/// A bar on standard error if that is a terminal; nothing in a pipe.
pub(super) struct Bar(ProgressBar);

impl Bar {
    pub(super) fn new() -> Bar {
        let bar = ProgressBar::new(100);
        // A template that holds no mistake: the fallback is the bar's own.
        if let Ok(style) =
            ProgressStyle::with_template("  {bar:24} {percent:>3} %  {elapsed:>3}  {msg}")
        {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(200));
        Bar(bar)
    }
}

impl Progress for Bar {
    fn at(&self, share: f64, what: &str) {
        self.0.set_position((100.0 * share).round() as u64);
        self.0.set_message(what.to_string());
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        // What follows stands where the bar was.
        self.0.finish_and_clear();
    }
}
