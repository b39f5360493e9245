//! The runs, a line each.

use super::wrapped;
use crate::hidden::score::scored::Scored;

/// Every run with `list`, else every run that is not right.
pub(super) fn text(scored: &[Scored], list: bool) -> String {
    let listed = scored.iter().filter(|one| list || !one.is_right());
    listed.map(line).collect()
}

/// One run: what was hidden, what was answered, and how good that is.
pub(super) fn line(one: &Scored) -> String {
    wrapped("", &story(one))
}

fn story(one: &Scored) -> String {
    let truth = &one.truth;
    let lead = format!("{} {}: {} →", one.rig.display(), truth.kind, truth.label);
    match &one.answer {
        Ok(answer) => format!(
            "{lead} {} [{:?}] R {:.3} floor {:.2} {:.1} s",
            answer.label(),
            one.mark(),
            one.ratio(),
            answer.floor_n / truth.floor_n,
            answer.seconds,
        ),
        Err(error) => format!("{lead} {error}"),
    }
}
