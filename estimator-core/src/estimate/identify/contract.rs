//! What an estimator sees, and what it must do.

use super::params::IdentifyParams;
use crate::estimate::{
    method::MethodInfo, misfit::Excess, monitor::ParameterEstimate, record::PARAMETER_SLOTS,
    status::Doubt,
};
use crate::maths::scalar::Real;
use crate::physics::law::LawKind;

/// One instant of a contact, scaled by [`Scale`](super::Scale).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instant<T> {
    /// Depth δ/δ₀.
    pub depth: T,
    /// Rate of the depth, δ̇/v₀.
    pub speed: T,
    /// Force F/F₀.
    pub force: T,
    /// Position of the surface that the depth is measured from, x₀/δ₀.
    pub surface: T,
    /// Standard error of that position.
    pub surface_error: T,
    /// Variance of the position within the filter's window.
    pub position_variance: T,
    /// Covariance of position and speed within the filter's window.
    pub position_velocity_cov: T,
    /// Time since the instant before (s).
    pub elapsed_s: T,
    /// Rate of the force.
    pub rate: T,
    /// Variance that the steps of the position sensor give the depth: of one instant, as long as
    /// steps follow each other; where the position rests, the error is the same for many instants
    /// and the variance is larger by their number.
    pub quantization_variance: T,
    /// Standard error of the resting force.
    pub rest_error: T,
    /// How fast the resting force drifts, per sample.
    pub rest_drift: T,
    /// Number of samples since the load began.
    pub loaded: T,
    /// Share by which every speed may be too large.
    pub speed_error: T,
    /// Noise of the force.
    pub noise: ForceNoise<T>,
}

impl<T: Real> Instant<T> {
    /// Position x/δ₀.
    pub fn position(&self) -> T {
        self.surface + self.depth
    }
}

#[cfg(test)]
impl Instant<f64> {
    /// An instant of which only the uncertainties matter.
    pub(super) fn uncertain(noise: ForceNoise<f64>, surface_error: f64) -> Self {
        Instant {
            noise,
            surface_error,
            ..Instant::default()
        }
    }
}

/// Standard deviations of the force, scaled by F₀.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceNoise<T> {
    /// Standard deviation of the raw force.
    pub raw: T,
    /// Standard deviation of the filtered force.
    pub filtered: T,
}

/// The contract of an estimator. All quantities are scaled.
///
/// For every sample [`Identify::predict`] is called in contact, and then exactly one of
/// [`Identify::observe`] and [`Identify::learn`].
pub trait Identify<T: Real> {
    /// The methods that the estimator runs, a row each.
    const METHODS: &'static [MethodInfo];

    /// Whether the estimator runs the configured method.
    fn runs(params: &IdentifyParams<T>) -> bool {
        Self::METHODS.iter().any(|row| row.method == params.method)
    }

    /// The law that the estimates are of.
    fn law(&self, params: &IdentifyParams<T>) -> LawKind {
        params.law
    }

    /// Position x₀/δ₀ of the surface and its standard error at a noise of the force, once an
    /// estimator that has it among its parameters knows it.
    fn surface(&self, _noise: &ForceNoise<T>) -> Option<(T, T)> {
        None
    }

    /// Whether the whole window of the filter is in the material for sure, by a surface that is
    /// better known than that of the impact.
    fn is_inside(&self, _at: &Instant<T>) -> bool {
        false
    }

    /// F̂ at an instant, and the variance that the errors of the parameters and of the surface
    /// position give it.
    fn predict(&self, at: &Instant<T>) -> (T, T);

    /// By how much the residuals exceed the noise, from an estimator that can look back on them; else
    /// the innovations say it.
    fn excess(&self) -> Option<Excess<T>> {
        None
    }

    /// A reason not to trust the estimates, whatever their standard errors say.
    fn doubt(&self, _at: &Instant<T>) -> Option<Doubt> {
        None
    }

    /// Takes an instant that gives no equation to learn from: the window of the filter reaches into
    /// free air, the force is within the noise, or a surface that cannot pull has let go. No equation
    /// can reach across it; a material that relaxes recovers in it. `in_contact` is that of the
    /// contact detector.
    fn observe(&mut self, _at: &Instant<T>, _in_contact: bool) {}

    /// Learns from an instant in whose whole window the material pushed; β is what (24) says.
    /// Returns the forgetting factor that was used, or `None` if there was nothing to learn.
    fn learn(&mut self, params: &IdentifyParams<T>, at: &Instant<T>, beta: T) -> Option<T>;

    /// Forgets how certain the parameters are and keeps their values: another material is under the
    /// probe, and has been since the touch began if `since_touch`.
    fn reset_covariance(&mut self, params: &IdentifyParams<T>, since_touch: bool);

    /// Whether estimates from before a change have come back since this was last asked.
    fn has_come_back(&mut self) -> bool {
        false
    }

    /// Values and standard errors in the order of the law's slots, without the surface, with the
    /// noise and the standard error of the surface position at an instant.
    fn estimates(&self, at: &Instant<T>) -> [ParameterEstimate<T>; PARAMETER_SLOTS];
}
