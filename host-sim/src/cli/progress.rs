//! A progress bar.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::gap::Progress;

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
