//! Progress on a terminal; nothing in a pipe.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::gap::Progress;

/// What is done sooner needs no progress.
const SOON: Duration = Duration::from_secs(2);

/// A bar on standard error if that is a terminal; nothing in a pipe.
pub(super) struct Bar(ProgressBar);

impl Bar {
    pub(super) fn new() -> Bar {
        Bar(ticking(
            ProgressBar::new(100),
            "  {bar:24} {percent:>3} %  {elapsed:>3}  {msg}",
        ))
    }
}

fn ticking(bar: ProgressBar, template: &str) -> ProgressBar {
    if crate::output::is_quiet() {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    // A template that holds no mistake: the fallback is the bar's own.
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
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

/// How many logs are done, and for how long the work goes on; it appears after two seconds.
pub(super) struct Spinner(ProgressBar);

impl Spinner {
    pub(super) fn new(logs: usize) -> Spinner {
        let bar = ProgressBar::with_draw_target(Some(logs as u64), ProgressDrawTarget::hidden());
        let template = match logs {
            1 => "  {spinner} {elapsed}",
            _ => "  {spinner} {pos} of {len} logs  {elapsed}",
        };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        if !crate::output::is_quiet() {
            let shown = bar.downgrade();
            // Ends with the bar, or appears once.
            std::thread::spawn(move || {
                std::thread::sleep(SOON);
                if let Some(bar) = shown.upgrade().filter(|bar| !bar.is_finished()) {
                    bar.set_draw_target(ProgressDrawTarget::stderr());
                    bar.enable_steady_tick(Duration::from_millis(200));
                }
            });
        }
        Spinner(bar)
    }

    pub(super) fn one_more(&self) {
        self.0.inc(1);
    }
}

impl Drop for Spinner {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
