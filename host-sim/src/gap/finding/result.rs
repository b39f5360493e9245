//! What the workflow says.

use estimator_core::physics::effect::EffectId;

use super::region::Region;
use crate::gap::noise::floor::Floor;
use crate::model::Model;
use crate::motion::{Limits, Motion};

/// The four answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The base model explains the log to the noise.
    NoMissingEffect,
    /// Named, and with them the log is explained to the noise.
    MissingEffects,
    /// Something is missing, and this log cannot tell which of a group.
    Ambiguous,
    /// Something is missing that nothing in the catalogue explains, or not all of it.
    Unexplained,
}

impl Verdict {
    /// As `gap.json` writes it.
    pub const fn name(self) -> &'static str {
        match self {
            Verdict::NoMissingEffect => "no_missing_effect",
            Verdict::MissingEffects => "missing_effects",
            Verdict::Ambiguous => "ambiguous",
            Verdict::Unexplained => "unexplained",
        }
    }
}

/// A parameter with its standard error.
#[derive(Clone, Debug, PartialEq)]
pub struct Known {
    /// The key in model files.
    pub name: String,
    /// Value.
    pub value: f64,
    /// Standard error; `None` of a parameter that was fixed, or that stands at a bound.
    pub std_error: Option<f64>,
    /// Whether a fit wanted it beyond what it can be.
    pub at_bound: bool,
    /// Unit as in reports.
    pub unit: &'static str,
}

/// An effect that is missing in the base model.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// Which one.
    pub id: EffectId,
    /// Its parameters.
    pub parameters: Vec<Known>,
    /// Effects that this log cannot tell from it, nested relatives left out.
    pub alternatives: Vec<EffectId>,
    /// Where it takes the most from the residuals, in words.
    pub place: String,
    /// 1 − (RMSE with/without)² on the held-out part, all else refitted.
    pub held_out_gain: f64,
}

/// A set of effects that was refitted jointly, for the ladder of the report.
#[derive(Clone, Debug, PartialEq)]
pub struct Tried {
    /// What was added to the base model.
    pub ids: Vec<EffectId>,
    /// Root mean square of the residuals over what noise would leave.
    pub ratio: f64,
}

/// One log's curves for pictures, a value per sample of the fit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curves {
    /// Time (s).
    pub time_s: Vec<f64>,
    /// Motor-side position (m).
    pub position_m: Vec<f64>,
    /// Its rate (m/s).
    pub speed_mps: Vec<f64>,
    /// Penetration (m) in the model after.
    pub depth_m: Vec<f64>,
    /// Measured force (N).
    pub measured_n: Vec<f64>,
    /// The base model's force, refitted (N).
    pub before_n: Vec<f64>,
    /// The force with the effects (N).
    pub after_n: Vec<f64>,
    /// What a residual may be (N), one standard deviation.
    pub allowed_n: Vec<f64>,
    /// Whether the sample was held out when the RMSE was taken.
    pub held_out: Vec<bool>,
}

/// A motion to record as well.
#[derive(Clone, Debug, PartialEq)]
pub struct Advised {
    /// The motion, at the log's positions.
    pub motion: Motion,
    /// The same in words.
    pub words: String,
    /// What it is for, a sentence.
    pub purpose: String,
}

/// All of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The answer.
    pub verdict: Verdict,
    /// What is missing.
    pub effects: Vec<Named>,
    /// RMSE (N) on the held-out part, fitted to the rest: the base model's, and with the effects.
    pub rmse_before_n: f64,
    /// With the effects.
    pub rmse_after_n: f64,
    /// What noise would leave (N).
    pub noise_floor_n: f64,
    /// How it was found, log by log.
    pub floors: Vec<Floor>,
    /// Residuals over what is allowed, errors of the motion included, on the held-out part.
    pub ratio_before: f64,
    /// With the effects.
    pub ratio_after: f64,
    /// The base's parameters, refitted without the effects.
    pub base_before: Vec<Known>,
    /// And with them.
    pub base_after: Vec<Known>,
    /// Where the base model and the log disagree.
    pub disagreement: Vec<Region>,
    /// Where the model with the effects still does.
    pub remaining: Vec<Region>,
    /// What to record next, or what to do with the result.
    pub advice: String,
    /// The motion that the advice is about, where it is about one.
    pub advised: Option<Advised>,
    /// The best sets, best first.
    pub ladder: Vec<Tried>,
    /// The base model with the effects and refitted values.
    pub model: Model,
    /// Corner of the low-pass that both forces went through (Hz).
    pub bandwidth_hz: Option<f64>,
    /// Pictures' curves, log by log.
    pub curves: Vec<Curves>,
    /// What a reader must know.
    pub notes: Vec<String>,
}

impl Finding {
    /// Where the logs went and how fast.
    pub fn limits(&self) -> Limits {
        let each = self.curves.iter().flat_map(|own| {
            let speeds = own.speed_mps.iter().copied();
            own.position_m.iter().copied().zip(speeds)
        });
        Limits::of(each)
    }

    /// The effects that the base model had already, with their refitted parameters.
    pub fn given(&self) -> Vec<(EffectId, Vec<Known>)> {
        let count = self.model.effects.len().saturating_sub(self.effects.len());
        let given = self.model.effects.iter().take(count);
        given
            .filter_map(|own| {
                let id = EffectId::ALL.iter().find(|id| id.name() == own.id)?;
                let known = id.info().parameters.iter().filter_map(|info| {
                    let of = |(name, _): &&(String, f64)| name == info.name;
                    let (name, value) = own.parameters.iter().find(of)?;
                    Some(Known {
                        name: name.clone(),
                        value: *value,
                        std_error: own.fit.std_error.iter().find(of).map(|own| own.1),
                        at_bound: false,
                        unit: info.unit.symbol(),
                    })
                });
                Some((*id, known.collect()))
            })
            .collect()
    }
}

/// What leaving an effect out multiplies the held-out squared error by, in words.
pub fn times_larger(gain: f64) -> String {
    match 1.0 / (1.0 - gain).max(1e-9) {
        times if times >= 9.95 => format!("{times:.0} times as large"),
        times if times >= 1.095 => format!("{times:.1} times as large"),
        times if times >= 1.0 => "hardly larger".into(),
        // It pays on the whole log, or it would not be named.
        _ => "no larger: the held-out windows hardly contain where it acts".into(),
    }
}
