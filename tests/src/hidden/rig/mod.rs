//! A rig that hides something, independent of the project: it has its own physics, integration at
//! 20 kHz, noise and base fit in plain f64, and uses no code of `estimator-core` or `host-sim`.

pub(crate) mod bare;
pub mod case;
pub mod draw;
pub(crate) mod drive;
pub mod effect;
pub mod fit;
pub mod form;
mod hand;
pub mod harder;
pub mod inject;
pub mod kind;
pub mod material;
pub mod motion;
pub mod plant;
pub mod random;
pub(crate) mod sensor;
pub(crate) mod stranger;
pub(crate) mod world;
pub mod write;
