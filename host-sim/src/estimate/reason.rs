//! Status of a result and the reason why it is not trusted further: the one place where evidence about a
//! fit becomes a word of `estimate.json`.

use estimator_core::Status;
pub use estimator_core::estimate::status::Reason;

/// A law that leaves more than this many times the noise (rms) does not explain the force. The noise that a
/// log's own samples give is good to some per cent, and a law that fits leaves 0.9 to 1.15 of it in the
/// project's tests; the largest misfit of wrong numbers that stays below 2 moves a stiffness by less than 5 %.
pub const EXPLAINED: f64 = 2.0;

/// A residual of up to this many times the noise (rms) is the noise alone: what a law that fits leaves in the
/// project's tests is 0.9 to 1.15. Between this and [`EXPLAINED`] a law describes the force, and another form
/// may still put its parameters elsewhere: a power law leaves 1.6 times the noise of tissue that stiffens
/// exponentially, and puts its surface 0.5 mm out.
pub const NOISE_ALONE: f64 = 1.15;

/// What a negative damping says.
pub(crate) const NEGATIVE_DAMPING: &str = "the damping is negative, which no material's is: the force follows the \
    position instead of running ahead of it, as one that is read late does";

/// What is known about a fit besides its parameters.
#[derive(Clone, Copy, Debug)]
pub struct Evidence {
    /// The reason that the method itself gives, where there is one.
    pub told: Option<Reason>,
    /// Residual over the noise; `None` where there is none.
    pub misfit: Option<f64>,
    /// A larger misfit is not explained: [`EXPLAINED`] unless a sweep asks for another.
    pub explained: f64,
    /// The force stands still at its largest value.
    pub is_saturated: bool,
    /// The log has no free air before its first touch.
    pub has_no_zero: bool,
    /// The resting force drifts by what the damping feels.
    pub drifts: bool,
    /// A force acts that the law does not have, and a number takes it on: a friction that free air shows, an adhesion.
    pub has_other_force: bool,
    /// A parameter is at a bound of the law.
    pub is_at_bound: bool,
    /// The force is late (or early), or lags, by more than its errors.
    pub lateness: Option<Reason>,
    /// The force decays in holds, and the law does not.
    pub relaxes: bool,
    /// Another law that was tried leaves clearly less.
    pub has_better_law: bool,
    /// Another law that was tried leaves less than scatter allows, and its method has not converged.
    pub has_nearer_law: bool,
    /// The material was touched again before it had recovered, and the surface was not where the method takes it to be.
    pub is_dented: bool,
    /// The surface is not where the force leaves its baseline, or its error alone explains the misfit.
    pub is_surface_doubtful: bool,
}

impl Default for Evidence {
    fn default() -> Evidence {
        Evidence {
            told: None,
            misfit: None,
            explained: EXPLAINED,
            is_saturated: false,
            has_no_zero: false,
            is_dented: false,
            drifts: false,
            has_other_force: false,
            is_at_bound: false,
            lateness: None,
            relaxes: false,
            has_better_law: false,
            has_nearer_law: false,
            is_surface_doubtful: false,
        }
    }
}

impl Evidence {
    /// Whether more is left than the noise.
    pub(crate) fn is_unexplained(&self) -> bool {
        self.misfit.is_some_and(|misfit| misfit > self.explained)
    }
}

/// Status and reason of a result whose method has said `status`.
pub fn judged(status: Status, evidence: &Evidence) -> (Status, Option<Reason>) {
    let unexplained = evidence.is_unexplained();
    match status {
        Status::NoContact | Status::Changed => (status, Some(Reason::Excitation)),
        Status::ModelSuspect => {
            let told = evidence.told.filter(|told| *told != Reason::Residual);
            // A method knows how late the force is, and not in which way.
            let told = match (told, evidence.lateness) {
                (Some(Reason::Skew), Some(late)) => Some(late),
                (told, _) => told,
            };
            (status, Some(told.unwrap_or_else(|| cause(evidence))))
        }
        _ if unexplained => (Status::ModelSuspect, Some(cause(evidence))),
        Status::Unobservable | Status::Converging => {
            // What the method met on its way is no residual of what it came to.
            let told = evidence
                .told
                .filter(|told| !matches!(told, Reason::Excitation | Reason::Residual));
            (status, Some(told.unwrap_or_else(|| missing(evidence))))
        }
        Status::Converged => match doubt(evidence) {
            Some(reason) => (Status::ModelSuspect, Some(reason)),
            None => (status, None),
        },
    }
}

/// What a reason says, as the end of a sentence.
pub(crate) fn in_words(reason: Reason) -> &'static str {
    match reason {
        Reason::Residual => "more than the noise is left",
        Reason::Bound => "a parameter is at the end of its range",
        Reason::Skew => "the force is read later or earlier than the position",
        Reason::Lag => "the force lags behind the contact",
        Reason::Zero => "its resting force was not seen well enough in free air",
        Reason::Surface => "the position of the surface is not known well enough",
        Reason::Excitation => "the motion does not determine all of its parameters well",
        Reason::Saturated => "the force is at the end of its range",
        Reason::Relaxing => "the force decays in holds",
        Reason::Law => "another law explains the force better",
        // The core may get more of them.
        reason => reason.name(),
    }
}

/// What the word in brackets behind a status says, and what to do about it: a sentence for every reason.
pub(crate) fn meaning(status: Status, reason: Reason) -> String {
    let says = match status {
        Status::NoContact => "nothing was touched",
        Status::Changed => "the material has just changed, and too little of it was pressed since",
        _ => in_words(reason),
    };
    let remedy = match (status, reason) {
        (Status::NoContact, _) => "record presses into the material that begin in free air",
        (Status::Changed, _) => "press it again, several times",
        (_, reason) => remedy(reason),
    };
    format!("{says}: {remedy}")
}

/// What to do about a reason.
fn remedy(reason: Reason) -> &'static str {
    match reason {
        Reason::Residual => {
            "no law that was tried describes all of the force, so read the parameters as an average; palpate gap \
             names what else acts on the probe"
        }
        Reason::Bound => {
            "the true value may lie beyond it, so look at units and signs first, and then try another law (--law)"
        }
        Reason::Skew => {
            "it bends the damping, so read both channels at the same instant, or take the delay off (palpate gap, then \
             --compensate)"
        }
        Reason::Lag => {
            "a filter or an elastic part of the rig stands between them, so switch the filter off or take the lag off \
             (palpate gap, then --compensate)"
        }
        Reason::Zero => {
            "begin and end the log in free air for half a second, and tare before the touch and not in it"
        }
        Reason::Surface => {
            "approach more slowly from free air, or give the position of the surface (--surface)"
        }
        Reason::Excitation => {
            "press more than once, at different speeds and depths, and hold the depth for a second"
        }
        Reason::Saturated => "press less deeply, or use a cell with a larger range",
        Reason::Relaxing => {
            "a law that relaxes describes it (--law zener or --law quasi_linear); hold for longer to see all of it"
        }
        Reason::Law => "compare the laws above (--law NAME), and take the one that leaves least",
        // The core may get more of them.
        _ => "see the notes",
    }
}

/// Whether a law is trusted, as the verb of a sentence; `misfit` is what it leaves over the noise.
pub(crate) fn trust_in_words(status: Status, reason: Option<Reason>, misfit: f64) -> String {
    let but = |what: &str| match reason {
        Some(reason) => format!("{what}: {}", in_words(reason)),
        None => what.into(),
    };
    match status {
        Status::Converged => "explains the force".into(),
        Status::ModelSuspect if misfit > EXPLAINED => "does not explain the force".into(),
        Status::ModelSuspect => but("follows the force and is not to be trusted"),
        _ => but("is not certain yet"),
    }
}

/// What stays wrong however small the residual is.
fn doubt(evidence: &Evidence) -> Option<Reason> {
    let found = |reason, is_so: bool| is_so.then_some(reason);
    evidence
        .lateness
        .or(found(Reason::Bound, evidence.is_at_bound))
        .or(found(
            Reason::Surface,
            evidence.is_surface_doubtful || evidence.is_dented,
        ))
        .or(found(Reason::Zero, evidence.drifts))
        .or(found(
            Reason::Law,
            evidence.has_nearer_law || evidence.has_other_force,
        ))
}

/// Why a law leaves more than the noise: what damages the force itself first, then what the law lacks.
fn cause(evidence: &Evidence) -> Reason {
    let causes = [
        (evidence.is_saturated, Reason::Saturated),
        (evidence.lateness.is_some(), Reason::Skew),
        (evidence.has_better_law, Reason::Law),
        (evidence.relaxes, Reason::Relaxing),
        (evidence.has_no_zero || evidence.drifts, Reason::Zero),
        (evidence.is_at_bound, Reason::Bound),
        (
            evidence.is_surface_doubtful || evidence.is_dented,
            Reason::Surface,
        ),
    ];
    let found = causes.into_iter().find(|(is_so, _)| *is_so);
    match (found, evidence.lateness) {
        (Some((_, Reason::Skew)), Some(lateness)) => lateness,
        (Some((_, reason)), _) => reason,
        (None, _) => Reason::Residual,
    }
}

/// Why parameters are not known yet.
fn missing(evidence: &Evidence) -> Reason {
    match evidence {
        _ if evidence.is_at_bound => Reason::Bound,
        _ if evidence.has_no_zero => Reason::Zero,
        _ if evidence.is_surface_doubtful => Reason::Surface,
        _ => Reason::Excitation,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(misfit: f64) -> Evidence {
        Evidence {
            misfit: Some(misfit),
            ..Evidence::default()
        }
    }

    #[test]
    fn a_residual_above_twice_the_noise_is_never_converged() {
        for status in Status::ALL {
            let (judged, reason) = judged(status, &with(2.01));
            assert_ne!(judged, Status::Converged, "{status:?}");
            assert!(reason.is_some(), "{status:?}");
        }
        assert_eq!(
            judged(Status::Converged, &with(1.9)),
            (Status::Converged, None)
        );
        let suspect = (Status::ModelSuspect, Some(Reason::Residual));
        assert_eq!(judged(Status::Converged, &with(2.01)), suspect);
    }

    #[test]
    fn a_law_that_leaves_the_noise_is_never_said_not_to_explain_the_force() {
        let suspect = |misfit| trust_in_words(Status::ModelSuspect, Some(Reason::Zero), misfit);
        assert!(suspect(2.1).starts_with("does not explain"));
        let (text, why) = (suspect(1.0), in_words(Reason::Zero));
        assert!(
            text.starts_with("follows the force") && text.ends_with(why),
            "{text}"
        );
    }

    #[test]
    fn every_reason_of_every_status_is_a_sentence_with_what_to_do() {
        for status in Status::ALL {
            for reason in Reason::ALL {
                let text = meaning(status, reason);
                assert_ne!(in_words(reason), reason.name(), "{reason:?}");
                let (says, remedy) = text.split_once(": ").unwrap();
                assert!(says.len() > 10 && remedy.len() > 15, "{text}");
                assert_ne!(remedy, "see the notes", "{reason:?}");
            }
        }
    }

    #[test]
    fn every_status_but_converged_has_a_reason() {
        for status in Status::ALL {
            let (judged, reason) = judged(status, &Evidence::default());
            assert_eq!(judged, status);
            assert_eq!(reason.is_none(), status == Status::Converged, "{status:?}");
        }
    }

    #[test]
    fn lateness_and_bounds_are_doubts_even_within_the_noise() {
        let late = Evidence {
            lateness: Some(Reason::Lag),
            ..with(1.0)
        };
        let suspect = |reason| (Status::ModelSuspect, Some(reason));
        assert_eq!(judged(Status::Converged, &late), suspect(Reason::Lag));
        let late = Evidence {
            misfit: Some(5.0),
            ..late
        };
        assert_eq!(judged(Status::Converged, &late), suspect(Reason::Lag));
        let bound = Evidence {
            is_at_bound: true,
            ..with(1.0)
        };
        assert_eq!(judged(Status::Converged, &bound), suspect(Reason::Bound));
        // And so is another law that leaves less.
        let nearer = Evidence {
            has_nearer_law: true,
            ..with(1.0)
        };
        assert_eq!(judged(Status::Converged, &nearer), suspect(Reason::Law));
    }
}
