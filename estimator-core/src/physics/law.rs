//! Forward contact laws: penetration and its rate in, force out. Each law is one file and one row of
//! the table below.
//!
//! All laws report their stiffness and damping at a reference depth δ₀ (1 mm unless configured), so
//! that the numbers of different laws can be compared and keep their units whatever the exponent:
//! see "Units" in each.
//!
//! **Adding a law** touches these files:
//! 1. `physics/law/<law>.rs`: the law and its `LawRow`;
//! 2. `physics/law.rs`: its row. Model files, the simulated rig, `gap`, `--law` and the reports have the
//!    law then; if frames carry it too, a row of [`LawKind`], which its estimator fills;
//! 3. `board/reflection/impedance.rs`, if a master is to render it;
//! 4. `host-sim/src/batch/family.rs`, and 5. `host-sim/src/batch/start.rs`, if a whole log is to be
//!    fitted with it: the free numbers that mean the law, and where they start.

mod contact_law;
mod elastic;
mod environment;
mod hunt_crossley;
mod kelvin_voigt;
mod quasi_linear;
mod recovery;
mod relaxation;
mod row;
mod zener;

pub use contact_law::{ContactLaw, RelaxingLaw, unilateral};
pub use elastic::Elastic;
pub use environment::{Damping, Environment};
pub use hunt_crossley::HuntCrossley;
pub use kelvin_voigt::KelvinVoigt;
pub use quasi_linear::{QuasiLinear, QuasiLinearState};
pub use recovery::Recovery;
pub(crate) use recovery::dent_n;
pub(crate) use relaxation::Decay;
pub use relaxation::{MOST_MODES, RelaxationMode};
pub use row::{DEFAULT_REFERENCE_DEPTH_M, LawInfo, RELAXATION, STIFFENING_RATE, SURFACE};
pub use zener::{Zener, ZenerState};

pub use super::parameter::ParameterInfo;
use crate::maths::scalar::Scalar;
use row::{LawRow, SKEW};

macro_rules! laws {
    (
        $($(#[$doc:meta])* [$($generic:tt)+] $Law:ident($Type:ty, $State:ty),)+
    ) => {
        /// A contact law by its name in files.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum LawId {
            $($(#[$doc])* $Law,)+
            /// Nothing to touch.
            Free,
        }

        /// A contact law with its values, with at most `R` relaxation modes; unused modes have
        /// fraction 0.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum Law<S, const R: usize = MOST_MODES> {
            $($(#[$doc])* $Law($Type),)+
            /// Nothing to touch.
            Free,
        }

        /// What a material with a [`Law`] remembers of the touches so far.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum LawState<S, const R: usize = MOST_MODES> {
            $(#[doc = concat!("The state of [`", stringify!($Law), "`].")] $Law($State),)+
            /// Nothing to touch has nothing to remember.
            Free,
        }

        $(impl<$($generic)+> From<$Type> for Environment<S> {
            fn from(law: $Type) -> Environment<S> {
                law.parts(S::from_f64(DEFAULT_REFERENCE_DEPTH_M))
            }
        })+

        impl LawId {
            /// All laws, simplest first; nothing to touch comes last.
            pub const ALL: &'static [LawId] = &[$(LawId::$Law,)+ LawId::Free];
        }

        impl<S: Scalar, const R: usize> Law<S, R> {
            /// The row of a law in the table.
            const fn row(id: LawId) -> &'static LawInfo {
                match id {
                    $(LawId::$Law => const { &<$Type as LawRow<S>>::INFO },)+
                    LawId::Free => &FREE,
                }
            }

            /// Which law it is.
            pub const fn id(&self) -> LawId {
                match self {
                    $(Law::$Law(_) => LawId::$Law,)+
                    Law::Free => LawId::Free,
                }
            }

            /// A law from its values by name, with this many of the relaxation modes that files list.
            /// Its stiffness and damping hold at a depth (m). `None` if a value is missing or there are
            /// more than `R` modes.
            pub fn from_values(
                id: LawId,
                modes: usize,
                value: impl Fn(&str) -> Option<S>,
                reference_depth_m: S,
            ) -> Option<Self> {
                Some(match id {
                    $(LawId::$Law => {
                        Law::$Law(LawRow::from_values(modes, &value, reference_depth_m)?)
                    })+
                    LawId::Free => Law::Free,
                })
            }

            fn step_with(
                &self,
                recovery: Recovery,
                state: &mut LawState<S, R>,
                depth_m: S,
                speed_mps: S,
                period_s: S,
            ) -> S {
                match self {
                    $(Law::$Law(law) => {
                        if !matches!(state, LawState::$Law(_)) {
                            *state = self.at_rest();
                        }
                        match state {
                            LawState::$Law(state) => {
                                recovery.step(law, state, depth_m, speed_mps, period_s)
                            }
                            _ => S::zero(),
                        }
                    })+
                    Law::Free => S::zero(),
                }
            }

            /// The law in the parts that effects act on. The depth (m) is for a law without a reference
            /// depth: it changes nothing until an effect gives a part an exponent.
            pub fn parts(&self, reference_depth_m: S) -> Environment<S> {
                match self {
                    $(Law::$Law(law) => law.parts(reference_depth_m),)+
                    Law::Free => Environment::free(),
                }
            }
        }

        impl<S: Scalar, const R: usize> RelaxingLaw<S> for Law<S, R> {
            type State = LawState<S, R>;

            fn at_rest(&self) -> LawState<S, R> {
                match self {
                    $(Law::$Law(law) => LawState::$Law(law.at_rest()),)+
                    Law::Free => LawState::Free,
                }
            }

            /// The state of another law counts as that of a material at rest.
            fn step(
                &self,
                state: &mut LawState<S, R>,
                depth_m: S,
                speed_mps: S,
                period_s: S,
            ) -> S {
                self.step_with(Recovery::WithProbe, state, depth_m, speed_mps, period_s)
            }

            fn step_creeping(
                &self,
                state: &mut LawState<S, R>,
                depth_m: S,
                speed_mps: S,
                period_s: S,
            ) -> S {
                self.step_with(Recovery::ByCreep, state, depth_m, speed_mps, period_s)
            }

            fn elastic_n(&self, depth_m: S) -> S {
                match self {
                    $(Law::$Law(law) => law.elastic_n(depth_m),)+
                    Law::Free => S::zero(),
                }
            }
        }
    };
}

laws! {
    /// F = Kδ + λδ̇, (1)
    [S: Scalar] KelvinVoigt(KelvinVoigt<S>, ()),
    /// F = (Kδ₀ + λδ̇)(δ/δ₀)ⁿ, (3)
    [S: Scalar] HuntCrossley(HuntCrossley<S>, ()),
    /// The standard linear solid, F + λ/(κ₁+κ₂)·Ḟ = κ₁/(κ₁+κ₂)·(κ₂δ + λδ̇), (2)
    [S: Scalar] Zener(Zener<S>, ZenerState<S>),
    /// An elastic response that relaxes, Kδ₀(δ/δ₀)ⁿ or (m/b)(e^{bδ} − 1), (9)–(17)
    [S: Scalar, const R: usize] QuasiLinear(QuasiLinear<S, R>, QuasiLinearState<S, R>),
}

const FREE: LawInfo = LawInfo {
    name: "free",
    alias: None,
    title: "free",
    relaxes: false,
    summary: "Nothing to touch",
    parameters: &[],
    optional: &[],
    most_modes: 0,
};

impl LawId {
    /// The facts about the law that files and the command line need.
    pub const fn info(self) -> &'static LawInfo {
        Law::<f64>::row(self)
    }

    /// The name in files and on the command line.
    pub const fn name(self) -> &'static str {
        self.info().name
    }

    /// The name of the law and, if it has one, its alias.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        core::iter::once(self.name()).chain(self.info().alias)
    }

    /// The law with a name or an alias of files.
    pub fn from_name(name: &str) -> Option<LawId> {
        let mut laws = LawId::ALL.iter().copied();
        laws.find(|id| id.names().any(|known| known == name))
    }
}

impl<S: Scalar, const R: usize> Law<S, R> {
    /// Force (N) of a material that was at rest until now.
    pub fn force_n(&self, depth_m: S, speed_mps: S) -> S {
        self.step(&mut self.at_rest(), depth_m, speed_mps, S::zero())
    }
}

macro_rules! kinds {
    (
        $($(#[$doc:meta])*
        $Kind:ident = $code:literal, $Law:ident, $modes:literal modes, skewed: $skewed:literal;)+
    ) => {
        /// What the parameters of a frame mean: a law, with a number of relaxation modes and perhaps
        /// the skew of the sensors. The discriminants are stable and stand in frames.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[non_exhaustive]
        #[repr(u8)]
        pub enum LawKind {
            $($(#[$doc])* $Kind = $code,)+
        }

        impl LawKind {
            /// All kinds, by their codes.
            pub const ALL: [LawKind; [$($code),+].len()] = [$(LawKind::$Kind),+];

            /// The law.
            pub const fn law(self) -> LawId {
                match self {
                    $(LawKind::$Kind => LawId::$Law,)+
                }
            }

            /// The number of relaxation modes among the parameters.
            pub const fn modes(self) -> usize {
                match self {
                    $(LawKind::$Kind => $modes,)+
                }
            }

            /// The parameters in the order of their slots in
            /// [`Parameters`](crate::estimate::Parameters); the surface is the last.
            pub const fn parameters(self) -> &'static [ParameterInfo] {
                match self {
                    $(LawKind::$Kind => {
                        const INFO: &LawInfo = LawId::$Law.info();
                        const COUNT: usize =
                            INFO.parameters.len() + 2 * $modes + $skewed as usize + 1;
                        const LIST: [ParameterInfo; COUNT] = slots(INFO, $modes, $skewed);
                        &LIST
                    })+
                }
            }
        }
    };
}

kinds! {
    /// [`KelvinVoigt`].
    KelvinVoigt = 1, KelvinVoigt, 0 modes, skewed: false;
    /// [`HuntCrossley`].
    HuntCrossley = 2, HuntCrossley, 0 modes, skewed: false;
    /// [`Zener`].
    Zener = 3, Zener, 0 modes, skewed: false;
    /// [`QuasiLinear`] with one mode, r = 1.
    QuasiLinear = 4, QuasiLinear, 1 modes, skewed: false;
    /// [`QuasiLinear`] with two modes, r = 2.
    QuasiLinear2 = 5, QuasiLinear, 2 modes, skewed: false;
    /// [`HuntCrossley`] with the skew of the sensors.
    HuntCrossleySkew = 6, HuntCrossley, 0 modes, skewed: true;
}

impl LawKind {
    /// The stable number of frames.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The kind with a number of frames.
    pub fn from_code(code: u8) -> Option<LawKind> {
        LawKind::ALL.into_iter().find(|kind| kind.code() == code)
    }

    /// The law's name in files and on the command line.
    pub const fn name(self) -> &'static str {
        self.law().name()
    }
}

/// The parameters of a law, of its modes, the skew and the surface. Runs at compile time only.
const fn slots<const N: usize>(law: &LawInfo, modes: usize, skewed: bool) -> [ParameterInfo; N] {
    let mut list = [SURFACE; N];
    let mut at = 0;
    while at < law.parameters.len() {
        list[at] = law.parameters[at];
        at += 1;
    }
    let mut mode = 0;
    while mode < modes {
        [list[at], list[at + 1]] = RELAXATION[mode];
        at += 2;
        mode += 1;
    }
    if skewed {
        list[at] = SKEW;
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slots_of_a_frame_are_those_that_loggers_know() {
        let slots = |kind: LawKind| kind.parameters().iter().map(|info| info.name);
        for (code, name, names) in [
            (1, "kelvin_voigt", "stiffness damping surface"),
            (2, "hunt_crossley", "stiffness damping exponent surface"),
            (3, "zener", "stiffness second_stiffness damping surface"),
            (
                4,
                "quasi_linear",
                "stiffness exponent relaxation_fraction_1 relaxation_rate_1 surface",
            ),
            (
                5,
                "quasi_linear",
                "stiffness exponent relaxation_fraction_1 relaxation_rate_1 \
                 relaxation_fraction_2 relaxation_rate_2 surface",
            ),
            (
                6,
                "hunt_crossley",
                "stiffness damping exponent skew surface",
            ),
        ] {
            let kind = LawKind::from_code(code).unwrap();
            assert_eq!(kind.name(), name);
            assert!(slots(kind).eq(names.split(' ')), "{kind:?}");
        }
        assert_eq!(LawKind::ALL.len(), 6);
    }

    #[test]
    fn every_name_leads_back_to_its_law_and_every_law_to_its_values() {
        for id in LawId::ALL {
            assert!(id.names().all(|name| LawId::from_name(name) == Some(*id)));
            let law = Law::<f64>::from_values(*id, 0, |_| Some(1.5), 1e-3).unwrap();
            assert_eq!(law.id(), *id);
            let unknown = Law::<f64>::from_values(*id, 0, |_| None, 1e-3);
            assert_eq!(unknown.is_some(), *id == LawId::Free);
        }
        let five = Law::<f64>::from_values(LawId::QuasiLinear, 5, |_| Some(1.5), 1e-3);
        assert_eq!(five, None);
    }

    #[test]
    fn the_state_of_another_law_is_that_of_a_material_at_rest() {
        let of = |id| Law::<f64>::from_values(id, 1, |_| Some(1.5), 1e-3).unwrap();
        let (zener, quasi_linear) = (of(LawId::Zener), of(LawId::QuasiLinear));
        let mut state = zener.at_rest();
        zener.step(&mut state, 1e-3, 0.0, 1e-3);
        let force_n = quasi_linear.step(&mut state, 2e-3, 0.0, 1e-3);
        assert_eq!(
            force_n,
            quasi_linear.step(&mut quasi_linear.at_rest(), 2e-3, 0.0, 1e-3)
        );
    }
}
