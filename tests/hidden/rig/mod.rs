//! A rig with something hidden in it, independent of the project: its own physics, integration at
//! 20 kHz, noise and base fit in plain f64, and no code of `estimator-core` or `host-sim`.

pub(crate) mod bare;
pub(crate) mod case;
pub(crate) mod draw;
pub(crate) mod drive;
pub(crate) mod effect;
pub(crate) mod fit;
pub(crate) mod form;
pub(crate) mod material;
pub(crate) mod motion;
pub(crate) mod plant;
pub(crate) mod random;
pub(crate) mod sensor;
pub(crate) mod stranger;
pub(crate) mod write;
