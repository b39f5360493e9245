//! A rig that gives way: a spring between the motor and the tip.

use super::row::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// A spring in series: tip = x − u(F_contact), u = F/k_s; or a spring whose stiffness grows with its
    /// force, as that of a tendon, a rope or a bolted joint does.
    SeriesCompliance = "series_compliance" {
        /// k_s (N/m), unloaded
        stiffness_n_per_m = "stiffness", NewtonPerMetre, Positive, Shape, Logarithmic(Times(0.1, Stiffness), Times(1e3, Stiffness));
        /// F_h (N): the force at which it is twice as stiff; 0: it is always as stiff.
        hardening_n = "hardening_force", Newton, NotNegative = 0.0,
            Form("it is always as stiff", TakenOn { start: Times(0.5, Force), first: 1.0 }),
            Logarithmic(Times(0.02, Force), Times(20.0, Force));
    }
    stage: Transmission, sign: OneWay, proportional: false, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [12_000.0, 0.0, 0.0, 0.0, 0.0], starts: &[
        Starts::at(&[Each(&[Times(8.0, Stiffness), Times(40.0, Stiffness)])]),
        Starts::at(&[At(Times(4.0, Stiffness)), At(Times(0.1, Force))]),
        Starts::at(&[At(Times(12.0, Stiffness)), At(Times(0.3, Force))]),
    ],
    law: "tip = x − F_contact/k_s; with a hardening force F_h the stiffness is k_s(1 + |F|/F_h)",
    signature: "a softer and less damped contact at high force; couples force into depth",
    motion: "fast and slow strokes of the same depth",
}

impl<S: Scalar> SeriesCompliance<S> {
    /// How far it gives way (m): ∫dF/k = (F_h/k_s) ln(1 + |F|/F_h), with the sign of F.
    pub fn deflection_m(&self, force_n: S) -> S {
        if self.hardening_n <= S::zero() {
            return force_n / self.stiffness_n_per_m;
        }
        let size = self.hardening_n / self.stiffness_n_per_m * self.stiffening(force_n).ln();
        if force_n < S::zero() { -size } else { size }
    }

    /// How much further per newton (m/N).
    pub(crate) fn softness_m_per_n(&self, force_n: S) -> S {
        let stiffness = if self.hardening_n > S::zero() {
            self.stiffness_n_per_m * self.stiffening(force_n)
        } else {
            self.stiffness_n_per_m
        };
        S::one() / stiffness
    }

    /// 1 + |F|/F_h
    fn stiffening(&self, force_n: S) -> S {
        S::one() + force_n.abs() / self.hardening_n
    }
}
