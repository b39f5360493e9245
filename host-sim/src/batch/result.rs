//! What a batch fit comes to: the numbers of `estimate.json`.

use estimator_core::Status;
use estimator_core::estimate::Estimated;
use estimator_core::physics::law::ParameterInfo;

use super::family::Family;
use super::thresholds::Report;
use crate::estimate::Reason;
use crate::inspect::Inspection;
use crate::replay::{EventMark, Touch};

/// Modes of a material that relaxes at all times. A mode or two stand for themselves; of a power law over three decades, or
/// of water that is pressed out of a gel, a log shows three or four.
const AT_ALL_TIMES: usize = 3;

/// A parameter of the law.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// As in files: `stiffness`.
    pub name: &'static str,
    /// Without prefix: `N/m`, `1`.
    pub unit: &'static str,
    /// `None` if the log does not tell it.
    pub estimate: Option<Estimated<f64>>,
}

impl Parameter {
    pub(super) fn new(info: &'static ParameterInfo, estimate: Option<Estimated<f64>>) -> Self {
        Parameter {
            name: info.name,
            unit: info.unit.symbol(),
            estimate,
        }
    }
}

/// A law that was tried.
#[derive(Clone, Debug, PartialEq)]
pub struct Tried {
    /// The law, with its modes.
    pub family: Family,
    /// Free numbers: the law's parameters and the force offset.
    pub parameters: usize,
    /// Raw force against it where it was fitted (N rms).
    pub force_rmse_n: f64,
    /// BIC over that of the best.
    pub score: f64,
}

/// One touch by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchFit {
    /// From (s).
    pub from_s: f64,
    /// To (s).
    pub to_s: f64,
    /// Stiffness, damping and exponent, as far as the law has them, with the log's own surface.
    pub parameters: Vec<Parameter>,
    /// Block means of the force against the law with these (N rms): below the noise of single
    /// samples where the law fits.
    pub block_rmse_n: f64,
}

/// Young's modulus of a given indenter.
#[derive(Clone, Debug, PartialEq)]
pub struct Modulus {
    /// E (Pa); `None` where the log does not determine it.
    pub value: Option<Estimated<f64>>,
    /// Which modulus it is.
    pub kind: ModulusKind,
    /// E (Pa) after everything has relaxed, if the law relaxes and E is known.
    pub relaxed_pa: Option<f64>,
    /// Why it is no constant of the material, a sentence each; empty where it is one.
    pub why: Vec<String>,
    /// The indenter as it was given.
    pub indenter: String,
    /// ν
    pub poisson: f64,
    /// n that the indenter stands for.
    pub exponent_assumed: f64,
    /// Raw force against the law with this exponent (N rms).
    pub force_rmse_n: f64,
}

/// Which modulus of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModulusKind {
    /// Before anything relaxes.
    Instantaneous,
    /// After everything has relaxed.
    Relaxed,
}

impl ModulusKind {
    /// Name in `estimate.json`.
    pub const fn name(self) -> &'static str {
        match self {
            ModulusKind::Instantaneous => "instantaneous",
            ModulusKind::Relaxed => "relaxed",
        }
    }
}

/// A low-pass that a force went through before it was logged.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundLowPass {
    /// Where the power is a half, of one way (Hz).
    pub corner_hz: Estimated<f64>,
    /// `butterworth` or `bessel`.
    pub shape: &'static str,
    /// The number of its poles.
    pub order: u32,
    /// Whether it was applied forth and back.
    pub both_ways: bool,
    /// By how much it delays what is slow (s).
    pub delay_s: f64,
}

/// A fit of a whole log.
#[derive(Clone, Debug)]
pub struct Batch {
    /// The law that was taken.
    pub family: Family,
    /// How far the parameters can be trusted.
    pub status: Status,
    /// Why not further; `None` of a result that has converged.
    pub reason: Option<Reason>,
    /// The parameters.
    pub parameters: Vec<Parameter>,
    /// Force in free air (N).
    pub offset: Option<Estimated<f64>>,
    /// How late the force is (s) against the position, where the law can tell: Hunt–Crossley.
    pub skew: Option<Estimated<f64>>,
    /// The low-pass that the force went through before it was logged, where the law was fitted behind one.
    pub low_pass: Option<FoundLowPass>,
    /// δ₀ (m)
    pub reference_depth_m: f64,
    /// Raw force against the law over the samples that were fitted, in contact (N rms).
    pub force_rmse_n: Option<f64>,
    /// Standard deviation of the raw force (N): from sample to sample, or at rest in free air where that is more.
    pub noise_n: f64,
    /// That, and what the counts of the position leave of the force (N rms): what may remain.
    pub allowed_n: f64,
    /// √(χ²/(N − p)) over the noise and what no candidate explains.
    pub misfit: f64,
    /// The laws that were tried.
    pub selection: Vec<Tried>,
    /// Each touch by itself.
    pub per_touch: Vec<TouchFit>,
    /// Young's modulus, if the indenter is known.
    pub modulus: Option<Modulus>,
    /// All touches.
    pub touches: Vec<Touch>,
    /// All events.
    pub events: Vec<EventMark>,
    /// What is in the log.
    pub inspection: Inspection,
    /// What a reader must know, a sentence each.
    pub notes: Vec<String>,
    /// Columns, a value a sample of the log.
    pub columns: Columns,
    /// Depth (m) and elastic force (N): before anything relaxes.
    pub elastic: (Vec<f64>, Vec<f64>),
}

/// Columns of `estimate.csv` and of the figures.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    /// Penetration (m).
    pub depth_m: Vec<f64>,
    /// Its rate (m/s).
    pub speed_mps: Vec<f64>,
    /// Raw force without the offset (N).
    pub measured_n: Vec<f64>,
    /// Force of the law without the offset (N); NaN in free air.
    pub estimated_n: Vec<f64>,
    /// Whether the fit has seen the sample.
    pub used: Vec<bool>,
}

impl Batch {
    /// Adds to the standard errors what that of a lateness does, which was found beside a law that has none among its
    /// numbers: the numbers go from those without it, `punctual`, to these on the way of `late` (s).
    pub(super) fn widen_by_lateness(&mut self, punctual: &Batch, late: Estimated<f64>) {
        if self.family == Family::KELVIN_VOIGT {
            return self.widen_damper(late.std_error);
        }
        if self.family.skew().is_some() || self.family != punctual.family || late.value == 0.0 {
            return;
        }
        let of_way = (late.std_error / late.value).abs();
        for (own, before) in self.parameters.iter_mut().zip(&punctual.parameters) {
            if let (Some(own), Some(before)) = (&mut own.estimate, before.estimate) {
                let moved = of_way * (own.value - before.value);
                own.std_error = own.std_error.hypot(moved);
            }
        }
    }

    /// The same for Kelvin and Voigt's damper, which a lateness of T bends by K·T and nothing else.
    pub(super) fn widen_damper(&mut self, of_lateness_s: f64) {
        let stiffness = self.value("stiffness").map_or(0.0, |own| own.value);
        self.widen("damping", stiffness * of_lateness_s);
    }

    /// Whether the material relaxes in so many modes as one that does so at all times would.
    pub(super) fn relaxes_at_all_times(&self) -> bool {
        self.family.modes >= AT_ALL_TIMES
    }

    /// Adds to the standard error of a stiffness at once what a faster mode that is as large as the fastest would: a
    /// material whose force falls as t^−0.2 had 5180 ± 160, 4560 ± 160 and 3700 ± 70 N/m, pressed in 0.2, 0.8 and 3 s.
    pub(super) fn widen_by_faster_modes(&mut self) {
        let both = self
            .value("stiffness")
            .zip(self.value("relaxation_fraction_1"));
        if let Some((stiffness, fastest)) = both.filter(|_| self.relaxes_at_all_times()) {
            self.widen("stiffness", stiffness.value * fastest.value);
        }
    }

    /// Adds an independent error to the standard error of a parameter, where it is known.
    pub(super) fn widen(&mut self, name: &str, by: f64) {
        let mut own = self.parameters.iter_mut();
        let own = own.find(|own| own.name == name);
        if let Some(own) = own.and_then(|own| own.estimate.as_mut()) {
            own.std_error = own.std_error.hypot(by);
        }
    }

    /// The parameter of that name.
    pub fn value(&self, name: &str) -> Option<Estimated<f64>> {
        let mut own = self.parameters.iter();
        own.find(|parameter| parameter.name == name)?.estimate
    }

    /// Whether the damping is negative, which no material's is.
    pub(super) fn has_negative_damping(&self, decide: &Report) -> bool {
        let damping = self.value("damping");
        damping.is_some_and(|own| own.value < -decide.negative_damping * own.std_error)
    }
}
