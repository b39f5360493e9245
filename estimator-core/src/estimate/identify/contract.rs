//! What an estimator sees, and what it must do.

use super::params::IdentifyParams;
use crate::estimate::monitor::ParameterEstimate;
use crate::estimate::record::PARAMETER_SLOTS;
use crate::maths::scalar::Real;

/// One instant of a contact, scaled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instant<T> {
    /// δ/δ₀
    pub depth: T,
    /// δ̇/v₀
    pub speed: T,
    /// F/F₀
    pub force: T,
    /// Surface that the depth is measured from, x₀/δ₀.
    pub surface: T,
    /// Its standard error.
    pub surface_error: T,
    /// Variance of the depth within the filter's window.
    pub position_variance: T,
    /// Covariance of depth and speed within it.
    pub position_velocity_cov: T,
    /// Since the instant before (s).
    pub elapsed_s: T,
    /// Rate of the force.
    pub rate: T,
    /// Variance that the steps of the position sensor give the depth: of one instant, as long as
    /// steps follow each other; where the position rests, the error is the same for many instants
    /// and this is that much larger.
    pub quantization_variance: T,
    /// Standard error of the resting force.
    pub rest_error: T,
}

impl<T: Real> Instant<T> {
    /// x/δ₀
    pub fn position(&self) -> T {
        self.surface + self.depth
    }
}

/// What the force channel is worth, scaled by F₀.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceNoise<T> {
    /// Standard deviation of the raw force.
    pub raw: T,
    /// Standard deviation of the filtered force.
    pub filtered: T,
}

/// The contract of an estimator. All quantities are scaled.
pub trait Identify<T: Real> {
    /// F̂ at an instant, and the variance that the errors of the parameters and of the surface
    /// position (standard error `surface_error`) give it.
    fn predict(&self, at: &Instant<T>, noise: &ForceNoise<T>, surface_error: T) -> (T, T);

    /// Learns from an instant; β is what (24) says. Gives the forgetting factor that was used, or
    /// `None` if the instant had nothing to teach.
    fn learn(
        &mut self,
        params: &IdentifyParams<T>,
        at: &Instant<T>,
        noise: &ForceNoise<T>,
        beta: T,
    ) -> Option<T>;

    /// Called for every sample, before [`Identify::learn`]: whether the whole window of the filter
    /// is pushed by the material. If not, an equation cannot reach across this sample: in free air,
    /// in the noise, and where a surface that cannot pull has let go.
    fn admit(&mut self, _pushed: bool) {}

    /// Forgets how sure it was, and keeps its values: another material is under the probe.
    fn reset_covariance(&mut self, params: &IdentifyParams<T>);

    /// Values and standard errors in the order of the law's slots, without the surface;
    /// `surface_error` is the standard error of the surface position.
    fn estimates(
        &self,
        noise: &ForceNoise<T>,
        surface_error: T,
    ) -> [ParameterEstimate<T>; PARAMETER_SLOTS];
}
