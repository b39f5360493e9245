//! All effects under one type.

use super::*;

macro_rules! catalogue {
    ($($Effect:ident = $code:literal),+ $(,)?) => {
        /// An effect of the catalogue by its stable number.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(u8)]
        pub enum EffectId {
            $(
                #[doc = concat!("See [`", stringify!($Effect), "`].")]
                $Effect = $code,
            )+
        }

        /// An effect with its parameters.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Effect<S> {
            $(
                #[doc = concat!("See [`", stringify!($Effect), "`].")]
                $Effect($Effect<S>),
            )+
        }

        impl EffectId {
            /// The whole catalogue.
            pub const ALL: &'static [EffectId] = &[$(EffectId::$Effect),+];

            /// Where in the chain it enters, without what else the catalogue says: a board has no
            /// flash for that.
            pub const fn place(self) -> Place {
                match self {
                    $(EffectId::$Effect => const { $Effect::<f64>::INFO.place },)+
                }
            }

            /// What the catalogue says of it.
            pub const fn info(self) -> &'static EffectInfo {
                match self {
                    $(EffectId::$Effect => &$Effect::<f64>::INFO,)+
                }
            }
        }

        impl<S: Scalar> Effect<S> {
            /// An effect from its parameters in the order of the catalogue; what is missing in the
            /// row is 0.
            pub fn new(id: EffectId, row: &[S; MOST_PARAMETERS]) -> Effect<S> {
                match id {
                    $(EffectId::$Effect => Effect::$Effect($Effect::from_row(row)),)+
                }
            }

            /// Which one.
            pub const fn id(&self) -> EffectId {
                match self {
                    $(Effect::$Effect(_) => EffectId::$Effect,)+
                }
            }

            /// Its parameters in the order of the catalogue.
            pub fn row(&self) -> [S; MOST_PARAMETERS] {
                match self {
                    $(Effect::$Effect(own) => own.row(),)+
                }
            }
        }
    };
}

catalogue! {
    StressRelaxation = 1,
    PowerLawStiffness = 2,
    DepthDependentDamping = 3,
    ExponentialStiffening = 4,
    Adhesion = 5,
    PermanentSet = 6,
    BuriedLayer = 7,
    SurfaceMotion = 8,
    HystereticDamping = 9,
    CyclicSoftening = 10,
    CoulombFriction = 11,
    StribeckFriction = 12,
    ViscousDrag = 13,
    AsymmetricDrag = 14,
    ToolInertia = 15,
    ForceOffset = 16,
    ForceDrift = 17,
    CableStiffness = 18,
    Cogging = 19,
    PeriodicDisturbance = 20,
    SeriesCompliance = 21,
    Backlash = 22,
    ForceLag = 23,
    TimeDelay = 24,
    ForceSaturation = 25,
    EncoderPeriodicError = 26,
}

impl EffectId {
    /// The id as files write it.
    pub const fn name(self) -> &'static str {
        self.info().name
    }

    /// The effect with an id of files.
    pub fn from_name(name: &str) -> Option<EffectId> {
        EffectId::ALL.iter().copied().find(|id| id.name() == name)
    }
}

impl<S: Scalar> Effect<S> {
    /// What it adds to the force between contact and load cell (N), the motor side having gone
    /// `change_m` since the last sample; 0 of an effect that enters elsewhere. `z` is its memory.
    pub(crate) fn load_n(&self, z: &mut S, motor: &Motion<S>, change_m: S) -> S {
        match self {
            Effect::CoulombFriction(own) => own.force_n(z, motor.speed_mps, change_m),
            Effect::StribeckFriction(own) => own.force_n(motor.speed_mps),
            Effect::ViscousDrag(own) => own.force_n(motor.speed_mps),
            Effect::AsymmetricDrag(own) => own.force_n(motor.speed_mps),
            Effect::ToolInertia(own) => own.force_n(motor.acceleration_mps2),
            Effect::CableStiffness(own) => own.force_n(motor.position_m),
            Effect::Cogging(own) => own.force_n(motor.position_m),
            Effect::PeriodicDisturbance(own) => own.force_n(motor.time_s),
            Effect::ForceOffset(own) => own.force_n(),
            Effect::ForceDrift(own) => own.force_n(motor.time_s),
            _ => S::zero(),
        }
    }
}
