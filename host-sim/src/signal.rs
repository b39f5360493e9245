//! What a channel says about itself, before any model.

mod noise;
mod parabola;
mod toggling;

pub(crate) use noise::{
    loud_noise, measured, measured_windows, noise_of_measured, second_differences_of_measured,
    sharpest,
};
pub use noise::{noise, step};
pub use parabola::parabola;
pub(crate) use toggling::{measured_without_toggling, toggling};
pub use toggling::{toggles, without_toggling};
