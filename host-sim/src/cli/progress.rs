//! Progress on a terminal; nothing in a pipe.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::gap::Progress;

/// What is done sooner needs no progress.
const SOON: Duration = Duration::from_secs(2);
/// Time between two pictures of a bar.
const TICK: Duration = Duration::from_millis(200);

/// A bar on standard error if that is a terminal; nothing in a pipe.
pub(super) struct Bar(ProgressBar);

impl Bar {
    pub(super) fn new() -> Bar {
        let bar = Bar::hidden();
        if !crate::output::is_quiet() {
            bar.0.set_draw_target(ProgressDrawTarget::stderr());
            bar.0.enable_steady_tick(TICK);
        }
        bar
    }

    /// A bar that appears after two seconds, for what is usually done by then.
    pub(super) fn after_a_while() -> Bar {
        let bar = Bar::hidden();
        appear_late(&bar.0);
        bar
    }

    fn hidden() -> Bar {
        let bar = ProgressBar::with_draw_target(Some(100), ProgressDrawTarget::hidden());
        Bar(styled(
            bar,
            "  {bar:24} {percent:>3} %  {elapsed:>3}  {msg}",
        ))
    }

    /// Runs something that writes to the terminal, without the bar in its way.
    pub(super) fn suspend<T>(&self, run: impl FnOnce() -> T) -> T {
        self.0.suspend(run)
    }
}

/// Shows a hidden bar after two seconds, unless it has ended or nothing is to be said.
fn appear_late(bar: &ProgressBar) {
    if crate::output::is_quiet() {
        return;
    }
    let shown = bar.downgrade();
    // Ends with the bar, or appears once.
    std::thread::spawn(move || {
        std::thread::sleep(SOON);
        if let Some(bar) = shown.upgrade().filter(|bar| !bar.is_finished()) {
            bar.set_draw_target(ProgressDrawTarget::stderr());
            bar.enable_steady_tick(TICK);
        }
    });
}

/// The bar with a template that holds no mistake: the fallback is the bar's own.
fn styled(bar: ProgressBar, template: &str) -> ProgressBar {
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
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

/// How many logs are done, and for how long the work goes on; it appears after two seconds.
pub(super) struct Spinner(ProgressBar);

impl Spinner {
    pub(super) fn new(logs: usize) -> Spinner {
        let bar = ProgressBar::with_draw_target(Some(logs as u64), ProgressDrawTarget::hidden());
        let template = match logs {
            1 => "  {spinner} {elapsed}",
            _ => "  {spinner} {pos} of {len} logs  {elapsed}",
        };
        let bar = styled(bar, template);
        appear_late(&bar);
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
