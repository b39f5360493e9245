//! The chapter's materials.

use estimator_core::physics::law::{HuntCrossley, Law};

use super::contact::Contact;

/// δ₀ (m) of the numbers printed in the chapter.
pub const REFERENCE_DEPTH_M: f64 = 1e-3;

/// A material as the chapter identified it, and how deep its rig pressed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Name for reports.
    pub name: &'static str,
    /// Its law.
    pub law: HuntCrossley<f64>,
    /// Depth of the deepest touch (m): where the chapter's figures reach 9 to 12 N.
    pub peak_depth_m: f64,
}

/// The soft gel of experiments E3 and E4.
pub const GEL: Material = Material {
    name: "gel",
    law: hunt_crossley(1350.0, 36.0, 1.35),
    peak_depth_m: 4.2e-3,
};

/// The stiff plastic layer of experiments E1 and E4.
pub const PLASTIC: Material = Material {
    name: "plastic",
    law: hunt_crossley(11_500.0, 70.0, 1.2),
    peak_depth_m: 1.0e-3,
};

impl Material {
    /// The material with its surface at `surface_m` (m).
    pub fn at(&self, surface_m: f64) -> Contact {
        Contact {
            law: Law::HuntCrossley(self.law),
            surface_m,
            ..Contact::FREE
        }
    }
}

const fn hunt_crossley(stiffness: f64, damping: f64, exponent: f64) -> HuntCrossley<f64> {
    HuntCrossley {
        stiffness_n_per_m: stiffness,
        damping_ns_per_m: damping,
        exponent,
        damping_exponent: exponent,
        reference_depth_m: REFERENCE_DEPTH_M,
    }
}
