//! This room holds the scalars that laws and estimators compute with, their derivatives, and units.

pub mod dual;
pub mod scalar;
mod trig;
pub mod units;

pub use dual::Dual;
pub use num_traits::{One, Zero};
pub use scalar::{Real, Scalar};
pub use units::Unit;
