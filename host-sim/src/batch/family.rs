//! The laws as the fit sees them: which numbers are free, and where they stand.
//!
//! **Skew.** Force and position of one row are rarely of one instant: 1 ms between them makes the
//! damping of a stiff plastic wrong by 27–53 %. Under Hunt–Crossley the two differ in how they grow
//! with depth, so the delay of the force is a free number there, δ(t − τ) and δ̇(t − τ) to first order
//! in τ, with a prior of ±5 % of a sample period for motions that do not tell (a single ramp). A log that
//! contradicts the prior is fitted again with its motion shifted by what [`lateness`](super::lateness())
//! finds. Under the other laws a delay is a damping or a fast mode, and stays 0.

use estimator_core::physics::law::{
    LawId, ParameterInfo, RELAXATION, Recovery, STIFFENING_RATE, SURFACE as SURFACE_INFO,
};

use crate::estimate::Estimation;

/// Positions of the free numbers that all laws have.
pub(super) const SURFACE: usize = 0;
pub(super) const OFFSET: usize = 1;
pub(super) const STIFFNESS: usize = 2;

/// Prior of the skew of Hunt–Crossley, in sample periods.
const SKEW_PRIOR: f64 = 0.05;

/// A law, with the number of its relaxation modes, and what its surface does between touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Family {
    /// The law.
    pub law: LawId,
    /// The number of its relaxation modes.
    pub modes: usize,
    /// How the force grows with depth, where the law leaves that open.
    pub elastic: Form,
    /// How the surface comes back where the probe has left it; of a law without memory, with the probe.
    pub recovery: Recovery,
}

/// How an elastic force grows with depth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// Kδ₀(δ/δ₀)ⁿ
    #[default]
    Power,
    /// (m/b)(e^{bδ} − 1), (13).
    Exponential,
}

impl Form {
    /// Both.
    pub const ALL: [Form; 2] = [Form::Power, Form::Exponential];

    /// Name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Form::Power => "power",
            Form::Exponential => "exponential",
        }
    }
}

impl Family {
    /// Kelvin–Voigt.
    pub const KELVIN_VOIGT: Family = Family::with(LawId::KelvinVoigt, 0);
    /// Hunt–Crossley.
    pub const HUNT_CROSSLEY: Family = Family::with(LawId::HuntCrossley, 0);
    /// Zener.
    pub const ZENER: Family = Family::with(LawId::Zener, 1);

    /// The quasi-linear law with this many modes.
    pub const fn quasi_linear(modes: usize) -> Family {
        Family::with(LawId::QuasiLinear, modes)
    }

    /// The same with a mode more, if its law can have several.
    pub(super) fn with_a_mode_more(self) -> Option<Family> {
        let modes = self.modes + 1;
        (self.law == LawId::QuasiLinear).then_some(Family { modes, ..self })
    }

    /// This family with another elastic response, if its law can have it.
    pub fn shaped(self, elastic: Form) -> Option<Family> {
        let can = elastic == Form::Power || !self.law.info().optional.is_empty();
        can.then_some(Family { elastic, ..self })
    }

    /// The same with a surface that recovers by creep, if the law creeps.
    pub(super) fn creeping(self) -> Option<Family> {
        let recovery = Recovery::ByCreep;
        (self.modes > 0).then_some(Family { recovery, ..self })
    }

    /// The same with the chapter's surface.
    pub(super) fn with_probe(self) -> Family {
        Family {
            recovery: Recovery::WithProbe,
            ..self
        }
    }

    const fn with(law: LawId, modes: usize) -> Family {
        Family {
            law,
            modes,
            elastic: Form::Power,
            recovery: Recovery::WithProbe,
        }
    }

    /// The families of a law: one for each number of modes that it can have.
    pub fn of(law: LawId) -> impl Iterator<Item = Family> {
        let modes = match law.info().most_modes {
            0 => usize::from(law.info().relaxes)..=usize::from(law.info().relaxes),
            most => 1..=most,
        };
        modes.map(move |modes| Family::with(law, modes))
    }

    /// The family of a recursion, with the surface that explains its log.
    pub(super) fn of_estimation(estimation: &Estimation) -> Option<Family> {
        let kind = estimation.outcome.law;
        let family = match kind.law() {
            LawId::QuasiLinear => Family::quasi_linear(kind.modes().max(1)),
            law => Family::of(law).next()?,
        };
        let creeping = family.creeping().filter(|_| estimation.evidence.is_dented);
        Some(creeping.unwrap_or(family))
    }

    /// The name in files.
    pub fn name(self) -> &'static str {
        self.law.name()
    }

    /// Modes that are parameters themselves; the one of a Zener material follows from its springs and
    /// damper.
    pub(crate) fn listed_modes(self) -> usize {
        self.modes.min(self.law.info().most_modes)
    }

    /// Free numbers of the fit: those of the law, and the force offset.
    pub fn free(self) -> usize {
        self.first_mode() + 2 * self.modes + usize::from(self.skew().is_some())
    }

    /// Where the skew stands among the free numbers.
    pub(super) fn skew(self) -> Option<usize> {
        (self.law == LawId::HuntCrossley).then_some(self.first_mode())
    }

    /// Free numbers that are known before the fit: which, and 1/σ² around 0.
    pub(super) fn prior(self) -> Option<(usize, f64)> {
        Some((self.skew()?, SKEW_PRIOR.powi(-2)))
    }

    /// Where the exponent stands among the free numbers.
    pub(super) fn exponent(self) -> Option<usize> {
        self.position("exponent")
    }

    /// Where the rate of an exponential response stands among the free numbers: in place of the exponent.
    pub(super) fn stiffening_rate(self) -> Option<usize> {
        let law = Family {
            elastic: Form::Power,
            ..self
        };
        law.exponent().filter(|_| self.elastic == Form::Exponential)
    }

    /// Where the damping stands among the free numbers.
    pub(super) fn damping(self) -> Option<usize> {
        self.position("damping")
    }

    /// Where a parameter of the law stands among the free numbers, if it is one.
    fn position(self, name: &str) -> Option<usize> {
        let mut infos = self.own().take(self.first_mode() - STIFFNESS);
        Some(STIFFNESS + infos.position(|info| info.name == name)?)
    }

    /// The law's own parameters; an exponential response has its rate in place of the exponent.
    pub(super) fn own(self) -> impl Iterator<Item = &'static ParameterInfo> {
        let is_exponent = |info: &ParameterInfo| info.name == "exponent";
        self.law.info().parameters.iter().map(move |info| {
            match self.elastic == Form::Exponential && is_exponent(info) {
                true => &STIFFENING_RATE,
                false => info,
            }
        })
    }

    /// Where fraction and rate of the modes begin: behind the law's parameters, of which Zener has the
    /// stiffness alone, since its mode stands for the others.
    pub(super) fn first_mode(self) -> usize {
        match self.law {
            LawId::Zener => STIFFNESS + 1,
            law => STIFFNESS + law.info().parameters.len(),
        }
    }

    /// The parameters in the order of `estimate.json`.
    pub fn parameters(self) -> impl Iterator<Item = &'static ParameterInfo> {
        let modes = RELAXATION[..self.listed_modes()].iter().flatten();
        self.own().chain(modes).chain([&SURFACE_INFO])
    }
}
