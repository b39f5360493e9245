//! The data of the report: the columns and results of one log or several.

use std::borrow::Cow;

use estimator_core::estimate::{Estimated, status::Status};

use crate::replay::{EventMark, Touch};
use crate::report::{Provenance, Tone, capitalised};

/// Everything that the report shows. Columns of a [`Run`] may be empty; of columns that should have the
/// same length the shortest counts. A figure without data says so.
#[derive(Clone, Debug)]
pub struct EstimateReport<'a> {
    /// The heading: what was estimated from what.
    pub title: &'a str,
    /// How good the result is.
    pub tone: Tone,
    /// The badge: a status in one or two words.
    pub badge: &'a str,
    /// The sentence that says the result.
    pub verdict: &'a str,
    /// One log, or several to compare.
    pub runs: &'a [Run<'a>],
    /// What a reader should know before trusting the numbers.
    pub notes: &'a [String],
    /// What the report was made from.
    pub provenance: Provenance,
}

/// A column with one entry per sample, owned by the report or borrowed.
pub type Column<'a, T = f64> = Cow<'a, [T]>;

/// One log and what was estimated from it. The columns have one entry per sample, in SI units.
#[derive(Clone, Debug, Default)]
pub struct Run<'a> {
    /// What was touched, or the name of the log; may be empty for a single run.
    pub name: &'a str,
    /// The law, as in files: `hunt_crossley`.
    pub law: &'a str,
    /// How the rig moves: it decides the units of axes and tables. The fields below name those of a rig that moves
    /// along a line.
    /// Time (s).
    pub time_s: Column<'a>,
    /// Penetration (m).
    pub depth_m: Column<'a>,
    /// Rate of penetration (m/s).
    pub speed_mps: Column<'a>,
    /// Measured force (N).
    pub measured_n: Column<'a>,
    /// Force of a replay with the estimated parameters (N); NaN where there is none.
    pub estimated_n: Column<'a>,
    /// F − F̂ before the sample was learned from (N): the argument of (24).
    pub innovation_n: Column<'a>,
    /// Times (s) and means (N) of the residual over equal stretches, of a log whose columns hold a part of its
    /// samples; else they are taken of the columns.
    pub mean_residual: Option<(Column<'a>, Column<'a>)>,
    /// β of (24) that was used.
    pub forgetting: Column<'a>,
    /// The status of the estimate, which says how far it can be trusted.
    pub status: Column<'a, Status>,
    /// Standard deviation of the force noise (N).
    pub noise_n: Option<f64>,
    /// The settings of (24).
    pub forgetting_law: Option<ForgettingLaw>,
    /// The parameters over time.
    pub parameters: Vec<Trajectory<'a>>,
    /// The parameters at the end, in the order of the table.
    pub finals: Vec<FinalParameter<'a>>,
    /// The stretches between changes of material.
    pub segments: Vec<Segment<'a>>,
    /// The touches in order.
    pub touches: Column<'a, Touch>,
    /// The events in order of time.
    pub events: Column<'a, EventMark>,
    /// Force over depth at rest.
    pub elastic: Option<Elastic<'a>>,
    /// Root mean square of the raw measured force minus the replay with the final parameters, in contact
    /// (N).
    pub force_rmse_n: Option<f64>,
    /// The time from the first contact until every parameter stays within 5 % of its final value (s).
    pub settled_at_s: Option<f64>,
    /// δ₀ (m), the depth at which stiffness and damping are reported.
    pub reference_depth_m: Option<f64>,
}

/// A parameter over time.
#[derive(Clone, Debug)]
pub struct Trajectory<'a> {
    /// As in files: `stiffness`.
    pub name: &'a str,
    /// Without prefix: `N/m`, `1`.
    pub unit: &'a str,
    /// One estimate per sample; `None` where the parameter is not observable.
    pub values: Column<'a, Option<Estimated<f64>>>,
}

/// A parameter at the end.
#[derive(Clone, Copy, Debug)]
pub struct FinalParameter<'a> {
    /// As in files: `stiffness`.
    pub name: &'a str,
    /// Without prefix: `N/m`, `1`.
    pub unit: &'a str,
    /// The estimate; `None` if the parameter is not observable.
    pub estimate: Option<Estimated<f64>>,
    /// The true value, where a simulated rig knows it.
    pub truth: Option<f64>,
}

/// The stretch from one change of material to the next.
#[derive(Clone, Debug)]
pub struct Segment<'a> {
    /// The start of the stretch (s).
    pub from_s: f64,
    /// The end of the stretch (s).
    pub to_s: f64,
    /// The parameters at its end.
    pub parameters: Vec<FinalParameter<'a>>,
}

/// The settings of (24).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForgettingLaw {
    /// α₁
    pub alpha_1: f64,
    /// α₂ (1/N)
    pub alpha_2_per_n: f64,
    /// α₃ (N)
    pub alpha_3_n: f64,
}

impl ForgettingLaw {
    /// β = 1 − α₁{(1/π)·arctan[α₂(|F − F̂| − α₃)] + ½}, (24).
    pub fn beta(&self, error_n: f64) -> f64 {
        let angle = (self.alpha_2_per_n * (error_n.abs() - self.alpha_3_n)).atan();
        1.0 - self.alpha_1 * (angle / std::f64::consts::PI + 0.5)
    }
}

/// The elastic force over the depth, without damping.
#[derive(Clone, Debug)]
pub struct Elastic<'a> {
    /// Depth (m).
    pub depth_m: Column<'a>,
    /// Estimated elastic force (N).
    pub estimated_n: Column<'a>,
    /// The true elastic force (N) of a simulated rig; empty where it is not known.
    pub true_n: Column<'a>,
}

/// Name of a parameter for people, with its symbol in the equations.
pub(crate) fn label(name: &str) -> String {
    let symbol = match name {
        "stiffness" => " K",
        "damping" => " λ",
        "exponent" => " n",
        "damping_exponent" => " q",
        "second_stiffness" => " κ₂",
        "relaxation_fraction_1" => " c₁",
        "relaxation_rate_1" => " ν₁",
        "relaxation_fraction_2" => " c₂",
        "relaxation_rate_2" => " ν₂",
        _ => "",
    };
    capitalised(&name.replace('_', " ")) + symbol
}
