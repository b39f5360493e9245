//! A rig with its truth and the answer to it.

use super::answer::Answer;
use super::judge::{Mark, mark};
use super::truth::Truth;
use std::path::PathBuf;

/// A rig with what is hidden in it and what was answered.
#[derive(Clone, Debug)]
pub struct Scored {
    /// The folder of the rig.
    pub rig: PathBuf,
    /// What is hidden.
    pub truth: Truth,
    /// What was answered, or why there is no answer.
    pub answer: Result<Answer, String>,
    /// For poor excitation that was left open: the answer to both logs after the motion that was
    /// advised had been recorded; `None` where no motion was advised.
    pub further: Option<Result<Answer, String>>,
}

impl Scored {
    /// What the answer is worth.
    pub fn mark(&self) -> Mark {
        let marked = |answer| mark(&self.truth, answer);
        self.answer.as_ref().map_or(Mark::Failed, marked)
    }

    /// Whether the answer is the truth, or a group of names that holds it.
    pub(crate) fn is_right(&self) -> bool {
        [Mark::Exact, Mark::InGroup].contains(&self.mark())
    }

    /// The RMSE on the held-out part with the named effects, over the true noise floor.
    pub fn ratio(&self) -> f64 {
        let ratio = |a: &Answer| a.rmse_after_n / self.truth.floor_n;
        self.answer.as_ref().map_or(f64::NAN, ratio)
    }

    /// The verdict, empty where there is no answer.
    pub(crate) fn verdict(&self) -> &str {
        self.answer.as_ref().map_or("", |a| a.verdict.as_str())
    }

    /// Whether the answer names any effect.
    pub(crate) fn names_effects(&self) -> bool {
        self.answer.as_ref().is_ok_and(|a| !a.effects.is_empty())
    }
}
