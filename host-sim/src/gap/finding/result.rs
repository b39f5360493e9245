//! The result of the workflow.

use estimator_core::physics::effect::EffectId;

use super::change::ChangesSince;
use super::episode::Episode;
use super::parameter::ParameterEstimate;
use super::region::{Region, regions_in_words};
use crate::gap::noise::floor::NoiseFloor;
use crate::model::Model;
use crate::motion::{Limits, Motion};
use crate::number::quantity;

/// Times what is allowed up to which a remainder may be noise that a floor does not know: it is known to a quarter.
pub(in crate::gap) const NEARLY_NOISE: f64 = 1.5;

/// The five answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The base model explains the log to the noise.
    NoMissingEffect,
    /// With the effects that are named the log is explained to the noise.
    MissingEffects,
    /// Something is missing, and this log cannot tell which effect of a group it is.
    Ambiguous,
    /// The effects that are named are missing, and something remains that nothing in the catalogue explains.
    PartlyExplained,
    /// Something is missing, and nothing in the catalogue stands out as its cause.
    Unexplained,
}

impl Verdict {
    /// The name in `gap.json`.
    pub const fn name(self) -> &'static str {
        match self {
            Verdict::NoMissingEffect => "no_missing_effect",
            Verdict::MissingEffects => "missing_effects",
            Verdict::Ambiguous => "ambiguous",
            Verdict::PartlyExplained => "partly_explained",
            Verdict::Unexplained => "unexplained",
        }
    }

    /// Whether something remains that nothing in the catalogue explains.
    pub(crate) const fn leaves_a_remainder(self) -> bool {
        matches!(self, Verdict::PartlyExplained | Verdict::Unexplained)
    }
}

/// How sure the name of an effect is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grade {
    /// The log is explained to the noise, and no other effect would do.
    Certain,
    /// Something remains, and the best set without the effect leaves several times as much.
    Strong,
    /// Other effects would do as well.
    Open,
}

impl Grade {
    /// The name in `gap.json`.
    pub const fn name(self) -> &'static str {
        match self {
            Grade::Certain => "certain",
            Grade::Strong => "strong",
            Grade::Open => "open",
        }
    }
}

/// What speaks for an effect, over all sets that were fitted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Support {
    /// (Q₋ − Q₊)/(Q₋ − Q₀): the share that it takes off what the best set without it leaves above the noise.
    pub share: f64,
    /// The fraction of blocks in which it does, of those in which it acts.
    pub blocks: f64,
    /// The best rival.
    pub next: Option<Next>,
}

/// The best rival of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Next {
    /// The rival.
    pub id: EffectId,
    /// What it takes off in the place of the effect.
    pub share: f64,
}

/// An effect that is missing in the base model.
#[derive(Clone, Debug, PartialEq)]
pub struct MissingEffect {
    /// The effect.
    pub id: EffectId,
    /// Its parameters.
    pub parameters: Vec<ParameterEstimate>,
    /// How sure the name is.
    pub grade: Grade,
    /// What speaks for it.
    pub support: Support,
    /// Effects that this log cannot tell from it, relatives left out.
    pub alternatives: Vec<EffectId>,
    /// Where it takes the most from the residuals, in words.
    pub place: String,
    /// 1 − (RMSE with/without)² on the held-out part, all else refitted.
    pub held_out_gain: f64,
}

/// A set of effects that was refitted jointly.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The effects that were added to the base model.
    pub ids: Vec<EffectId>,
    /// Root mean square of the residuals over what noise would leave.
    pub ratio: f64,
}

/// The curves of one log, one value for each sample of the fit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curves {
    /// Time (s).
    pub time_s: Vec<f64>,
    /// Position at the motor (m).
    pub position_m: Vec<f64>,
    /// Speed at the motor (m/s).
    pub speed_mps: Vec<f64>,
    /// Penetration (m) in the model with the effects.
    pub depth_m: Vec<f64>,
    /// Measured force (N).
    pub measured_n: Vec<f64>,
    /// Force of the base model, refitted (N).
    pub before_n: Vec<f64>,
    /// Force of the model with the effects (N).
    pub after_n: Vec<f64>,
    /// One standard deviation of what a residual may be (N).
    pub allowed_n: Vec<f64>,
    /// Whether the sample was held out when the RMSE was taken.
    pub held_out: Vec<bool>,
}

/// A motion to record as well.
#[derive(Clone, Debug, PartialEq)]
pub struct AdvisedMotion {
    /// The motion, at the positions of the log.
    pub motion: Motion,
    /// The motion in words.
    pub words: String,
    /// What the motion is for, in a sentence.
    pub purpose: String,
}

/// The finding of the workflow.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The answer.
    pub verdict: Verdict,
    /// The effects that are missing.
    pub effects: Vec<MissingEffect>,
    /// RMSE (N) of the base model on the held-out part, fitted to the rest.
    pub rmse_before_n: f64,
    /// RMSE (N) with the effects.
    pub rmse_after_n: f64,
    /// What noise would leave (N).
    pub noise_floor_n: f64,
    /// What the best set of all leaves above the noise (N), on the held-out part.
    pub remainder_n: f64,
    /// The noise floor of each log.
    pub floors: Vec<NoiseFloor>,
    /// Residuals of the base model over what noise and errors of the motion allow, on the held-out part.
    pub ratio_before: f64,
    /// The same with the effects.
    pub ratio_after: f64,
    /// How many times as large (rms) means of the residuals are in motion as noise makes them, where the residuals are as
    /// small as noise but too slow for it.
    pub slow_remainder: Option<f64>,
    /// Whether no more is left than the model left when it was identified; `false` where its file does not say that.
    pub nothing_new: bool,
    /// Whether what the model left when it was identified is allowed for.
    pub is_beside_remainder: bool,
    /// Parameters of the base, refitted without the effects.
    pub base_before: Vec<ParameterEstimate>,
    /// Parameters of the base, refitted with the effects.
    pub base_after: Vec<ParameterEstimate>,
    /// What has changed since the base model was identified; `None` where its file has no standard errors.
    pub changed: Option<ChangesSince>,
    /// What differs between logs that are explained one by one and not together.
    pub differs: Option<String>,
    /// Where the base model and the log disagree.
    pub disagreement: Vec<Region>,
    /// Where the model with the effects and the log still disagree.
    pub remaining: Vec<Region>,
    /// What to record next, or what to do with the result.
    pub advice: String,
    /// The motion that the advice is about, where it is about one.
    pub advised: Option<AdvisedMotion>,
    /// The sets of effects that came closest, the best first.
    pub ladder: Vec<Candidate>,
    /// The base model with the effects and refitted values.
    pub model: Model,
    /// Corner (Hz) of the low-pass that both forces went through.
    pub bandwidth_hz: Option<f64>,
    /// The curves of each log.
    pub curves: Vec<Curves>,
    /// What a reader must know.
    pub notes: Vec<String>,
    /// Instants (s) of the steps of the surface that were taken off, and by what each is still off (m), to first order.
    pub(crate) surface_off: Vec<(f64, f64)>,
    /// The short stretch that holds most of what the closest set leaves, where something remains.
    pub(crate) episode: Option<Episode>,
    /// Stretches that nothing explains, which were left out.
    pub left_out: Vec<Episode>,
    /// Why the log seems to be in another unit, or with another sign, than the model: then no effect is asked for.
    pub mistaken: Option<String>,
}

impl Finding {
    /// What is new where no effect is, in words.
    pub fn nothing_new_in_words(&self) -> &'static str {
        match self.has_changed() {
            false => "nothing is new",
            true => "no effect is new, but numbers have changed",
        }
    }

    /// What its model leaves of the whole logs (N rms); 0 where that is noise.
    pub(crate) fn whole_n(&self) -> f64 {
        let remainder = self.model.remainder.as_ref();
        remainder.map_or(0.0, |own| own.rms_n)
    }

    /// Whether a number is clearly another than in the model.
    pub fn has_changed(&self) -> bool {
        self.changed
            .as_ref()
            .is_some_and(|changed| !changed.counted.is_empty())
    }

    /// What is no noise though it may be as small, in words; empty where there is none.
    pub fn slow_remainder_in_words(&self) -> String {
        self.slow_remainder.map_or_else(String::new, |times| {
            format!(
                "what remains in motion is too slow for noise: means of 32 samples are {times:.1} times as large as \
                 noise makes them"
            )
        })
    }

    /// " outside 2.8 s that nothing explains" where stretches were left out, and nothing else.
    pub fn outside_in_words(&self) -> String {
        let all_s: f64 = self.left_out.iter().map(Episode::length_s).sum();
        match self.left_out.is_empty() {
            true => String::new(),
            false => format!(" outside {} that nothing explains", quantity(all_s, 2, "s")),
        }
    }

    /// Whether what is not explained may as well be slow noise of the force: it is little, in no part of the log more than
    /// in others, and no rest shows how large such noise is. On complete models of stages and ankles whose sensors had
    /// 1/f noise 1.15 to 1.26 times what second differences allow was left.
    pub fn may_be_slow_noise(&self) -> bool {
        self.verdict == Verdict::Unexplained
            && self.ratio_after < NEARLY_NOISE
            && self.floors.iter().any(|floor| floor.rest_n.is_none())
            && regions_in_words(&self.remaining).is_empty()
    }

    /// The parameters of the base after the fit, each with what it was in the base alone; `None` for one that an effect of
    /// the base took on beside those that are added.
    pub fn base_pairs(
        &self,
    ) -> impl Iterator<Item = (Option<&ParameterEstimate>, &ParameterEstimate)> {
        let after = self.base_after.iter().enumerate();
        after.map(|(at, after)| {
            // Modes of a spectrum share their names, and keep their order.
            let is_same = |own: &&ParameterEstimate| own.name == after.name;
            let earlier = self.base_after[..at].iter().filter(is_same).count();
            (self.base_before.iter().filter(is_same).nth(earlier), after)
        })
    }

    /// The share of the disagreement that the named effects explain: 1 − (after² − floor²)/(before² − floor²);
    /// `None` where the base leaves no more than the noise.
    pub fn explained_share(&self) -> Option<f64> {
        let excess = |rmse_n: f64| rmse_n.powi(2) - self.noise_floor_n.powi(2);
        let (before, after) = (
            excess(self.rmse_before_n),
            excess(self.rmse_after_n).max(0.0),
        );
        let is_some = before > 1e-9 * self.rmse_before_n.powi(2) && !self.effects.is_empty();
        is_some.then(|| (1.0 - after / before).max(0.0))
    }

    /// How far and how fast the logs went.
    pub fn limits(&self) -> Limits {
        let each = self.curves.iter().flat_map(|curves| {
            let speeds = curves.speed_mps.iter().copied();
            curves.position_m.iter().copied().zip(speeds)
        });
        Limits::of(each)
    }

    /// The effects that the base model had already, with their refitted parameters.
    pub fn given(&self) -> Vec<(EffectId, Vec<ParameterEstimate>)> {
        let count = self.model.effects.len().saturating_sub(self.effects.len());
        let given = self.model.effects.iter().take(count);
        given
            .filter_map(|effect| {
                let id = EffectId::ALL.iter().find(|id| id.name() == effect.id)?;
                let estimates = id.info().parameters.iter().filter_map(|info| {
                    let is_it = |(name, _): &&(String, f64)| name == info.name;
                    let (name, value) = effect.parameters.iter().find(is_it)?;
                    let std_error = effect.fit.std_error.iter().find(is_it);
                    Some(ParameterEstimate {
                        name: name.clone(),
                        value: *value,
                        std_error: std_error.map(|(_, error)| *error),
                        at_bound: false,
                        unit: info.unit.symbol(),
                    })
                });
                Some((*id, estimates.collect()))
            })
            .collect()
    }
}

/// How many times larger the held-out squared error is without an effect, in words.
pub fn times_larger(gain: f64) -> String {
    match 1.0 / (1.0 - gain).max(1e-9) {
        times if times >= 999.5 => "more than 1000 times as large".into(),
        times if times >= 9.95 => format!("{times:.0} times as large"),
        times if times >= 1.095 => format!("{times:.1} times as large"),
        times if times >= 1.0 => "hardly larger".into(),
        // The effect is significant on the whole log, or it would not be named.
        _ => "no larger: the held-out windows hardly contain where it acts".into(),
    }
}
