//! The estimators by number and name.

use crate::physics::law::LawKind;

/// The estimators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Method {
    /// Recursive least squares on Kelvin–Voigt (1), (20)–(23).
    KelvinVoigt = 1,
    /// Two recursive least squares in feedback on Hunt–Crossley (25)–(37).
    HuntCrossleyTwoStage = 2,
    /// One recursive least squares on the logarithm of Hunt–Crossley (Haddadi & Hashtrudi-Zaad 2012).
    HuntCrossleyLogLinear = 9,
    /// Recursive least squares on Zener as ARX (18).
    ZenerArx = 3,
    /// Two recursive least squares in cascade on the quasi-linear law, one mode (39)–(42).
    HammersteinCascade = 4,
    /// The same with two modes.
    HammersteinCascade2 = 7,
    /// Hunt–Crossley by a bank of exact fits and a recursive Gauss–Newton refiner, the surface among
    /// the parameters.
    HuntCrossleyBank = 5,
    /// The same with the skew, by how much the force is read later than the position.
    HuntCrossleyBankSkew = 8,
    /// Kelvin–Voigt by recursive least squares, the surface among the parameters.
    KelvinVoigtSurface = 6,
    /// Zener by a bank of exact fits over surface and rate, refined over a history; the surface
    /// among the parameters.
    ZenerBank = 10,
    /// The quasi-linear law with one mode by a bank over exponent, surface and rate, refined over a
    /// history; the surface among the parameters.
    QuasiLinearBank = 11,
    /// The same with two modes, once the force speaks for the second.
    QuasiLinearBank2 = 12,
    /// Kelvin–Voigt, Hunt–Crossley, Zener and quasi-linear with one mode side by side over the same
    /// history; the records say which law they are of.
    Selection = 13,
}

impl Method {
    /// The law that the method identifies.
    pub const fn law(self) -> LawKind {
        match self {
            // The law that a selection starts with.
            Method::KelvinVoigt | Method::KelvinVoigtSurface | Method::Selection => {
                LawKind::KelvinVoigt
            }
            Method::HuntCrossleyTwoStage
            | Method::HuntCrossleyBank
            | Method::HuntCrossleyLogLinear => LawKind::HuntCrossley,
            Method::HuntCrossleyBankSkew => LawKind::HuntCrossleySkew,
            Method::ZenerArx | Method::ZenerBank => LawKind::Zener,
            Method::HammersteinCascade | Method::QuasiLinearBank => LawKind::QuasiLinear,
            Method::HammersteinCascade2 | Method::QuasiLinearBank2 => LawKind::QuasiLinear2,
        }
    }
}

impl Method {
    /// Whether the method is one over a history, which a build for the board leaves out.
    pub const fn has_history(self) -> bool {
        matches!(
            self,
            Method::ZenerBank
                | Method::QuasiLinearBank
                | Method::QuasiLinearBank2
                | Method::Selection
        )
    }

    /// Whether the surface is among the parameters, rather than taken from the impact.
    pub const fn finds_surface(self) -> bool {
        matches!(
            self,
            Method::HuntCrossleyBank
                | Method::HuntCrossleyBankSkew
                | Method::KelvinVoigtSurface
                | Method::ZenerBank
                | Method::QuasiLinearBank
                | Method::QuasiLinearBank2
                | Method::Selection
        )
    }
}
