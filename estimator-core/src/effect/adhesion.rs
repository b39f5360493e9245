//! A contact that sticks.

use super::effect;
use crate::scalar::Scalar;

effect! {
    /// A constant pull in all contact, and a neck that tears on the way out.
    Adhesion = "adhesion", Contact {
        /// F_a (N)
        force_n = "force", Newton, Positive;
        /// d_a (m)
        neck_length_m = "neck_length", Metre, Positive;
    }
    law: "−F_a in contact; on the way out −F_a(1 + δ/d_a) for −d_a < δ < 0",
    signature: "negative force after lift-off, none before touch",
    motion: "leave the contact slowly, and well clear of it",
}

impl<S: Scalar> Adhesion<S> {
    /// The pull (N, negative) at a depth. `attached` is 1 while the neck holds, and changes here.
    pub(crate) fn force_n(&self, attached: &mut S, depth_m: S) -> S {
        let (nil, one) = (S::nil(), S::unit());
        if depth_m > nil {
            *attached = one;
            return -self.force_n;
        }
        let left = one + depth_m / self.neck_length_m;
        if *attached > nil && left > nil {
            return -(self.force_n * left);
        }
        *attached = nil;
        nil
    }
}
