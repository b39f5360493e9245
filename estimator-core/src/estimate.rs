//! This room turns samples into estimates: configuration, filters, contact detection, estimators, and
//! the status that says how far an estimate can be trusted.

pub mod compensation;
pub mod config;
pub mod contact;
pub mod error;
pub mod estimator;
pub mod fault;
pub mod filter;
pub mod identify;
pub mod method;
pub mod misfit;
pub mod monitor;
pub mod noise;
pub mod params;
pub mod phase;
pub mod record;
mod regularity;
pub mod rls;
pub mod sample;
mod scaled;
pub mod status;

pub use phase::{Event, Phase};
pub use record::{Estimate, Estimated, Innovation, PARAMETER_SLOTS, Parameters};
