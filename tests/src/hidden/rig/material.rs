//! The material that is touched, without any effect: four laws in plain f64.

/// The depth at which stiffness and damping are given (m).
pub(crate) const REFERENCE_M: f64 = 1e-3;

/// The law of the base model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// F = Kδ + λδ̇.
    KelvinVoigt,
    /// F = (Kδ₀ + λδ̇)·(δ/δ₀)ⁿ.
    HuntCrossley,
    /// A power-law elastic response with one relaxation mode.
    QuasiLinear,
    /// A spring in parallel with a spring and a damper in series.
    Zener,
}

impl Law {
    /// The name in the model file.
    pub fn name(self) -> &'static str {
        match self {
            Law::KelvinVoigt => "kelvin_voigt",
            Law::HuntCrossley => "hunt_crossley",
            Law::QuasiLinear => "quasi_linear",
            Law::Zener => "zener",
        }
    }

    /// The names of `Material::numbers`, as the catalogue calls them.
    pub(crate) fn parameters(self) -> &'static [&'static str] {
        match self {
            Law::KelvinVoigt => &["stiffness", "damping", "surface"],
            Law::HuntCrossley => &["stiffness", "damping", "exponent", "surface"],
            Law::QuasiLinear => &[
                "stiffness",
                "exponent",
                "relaxation_fraction_1",
                "relaxation_rate_1",
                "surface",
            ],
            Law::Zener => &["stiffness", "second_stiffness", "damping", "surface"],
        }
    }
}

/// A material and its surface. The Zener solid is kept as its equivalent, a linear elastic response with
/// one mode c = κ₁/(κ₁+κ₂), ν = (κ₁+κ₂)/λ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// The law.
    pub law: Law,
    /// F/δ at the reference depth (N/m).
    pub(crate) stiffness: f64,
    /// Damping of the contact at the reference depth (N s/m); zero for the relaxing laws.
    pub(crate) damping: f64,
    pub(crate) exponent: f64,
    /// The damper's exponent.
    pub(crate) damping_exponent: f64,
    /// The relaxation of the base: fraction, rate (1/s).
    pub(crate) mode: Option<(f64, f64)>,
    /// Where the material starts (m).
    pub surface: f64,
}

impl Material {
    /// The material with these parameters, in the order of [`Law::parameters`].
    pub fn from_numbers(law: Law, p: &[f64]) -> Self {
        let linear = Material {
            law,
            stiffness: p[0],
            damping: 0.0,
            exponent: 1.0,
            damping_exponent: 0.0,
            mode: None,
            surface: p[p.len() - 1],
        };
        match law {
            Law::KelvinVoigt => Material {
                damping: p[1],
                ..linear
            },
            Law::HuntCrossley => Material {
                damping: p[1],
                exponent: p[2],
                damping_exponent: p[2],
                ..linear
            },
            Law::QuasiLinear => Material {
                exponent: p[1],
                mode: Some((p[2], p[3])),
                ..linear
            },
            Law::Zener => {
                let sum = p[0] + p[1];
                Material {
                    mode: Some((p[0] / sum, sum / p[2])),
                    ..linear
                }
            }
        }
    }

    /// The parameters in the order of [`Law::parameters`].
    pub fn numbers(&self) -> Vec<f64> {
        let (c, nu) = self.mode.unwrap_or((0.0, 1.0));
        match self.law {
            Law::KelvinVoigt => vec![self.stiffness, self.damping, self.surface],
            Law::HuntCrossley => vec![self.stiffness, self.damping, self.exponent, self.surface],
            Law::QuasiLinear => vec![self.stiffness, self.exponent, c, nu, self.surface],
            Law::Zener => {
                // c = κ₁/(κ₁+κ₂), so κ₁+κ₂ = κ₁/c.
                let sum = self.stiffness / c;
                vec![self.stiffness, sum - self.stiffness, sum / nu, self.surface]
            }
        }
    }

    /// The elastic force (N) at a depth (m) before anything relaxes.
    pub(crate) fn elastic(&self, depth: f64) -> f64 {
        if depth <= 0.0 {
            0.0
        } else if self.exponent == 1.0 {
            self.stiffness * depth
        } else {
            self.stiffness * REFERENCE_M * (depth / REFERENCE_M).powf(self.exponent)
        }
    }

    /// The damping λ (N s/m) at a depth (m).
    pub(crate) fn damping(&self, depth: f64) -> f64 {
        if self.damping_exponent == 0.0 || self.damping == 0.0 {
            self.damping
        } else {
            self.damping * (depth / REFERENCE_M).powf(self.damping_exponent)
        }
    }
}
