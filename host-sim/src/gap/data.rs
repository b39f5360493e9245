//! The logs as the fits see them: checked, within a budget, with speed and acceleration, and their scales.

pub(crate) mod budget;
pub(crate) mod fit_data;
pub(crate) mod hangs;
pub(crate) mod input;
pub(crate) mod leaps;
pub(crate) mod low_pass;
pub(crate) mod motion;
pub(crate) mod motion_errors;
pub(crate) mod orientation;
pub(crate) mod repetition;
mod rest_waves;
pub(crate) mod ringing;
pub(crate) mod scales;
pub(crate) mod spikes;
pub(crate) mod standstill;
