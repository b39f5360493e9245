//! All effects under one type: what the list of the catalogue becomes.

/// Makes `EffectId` and `Effect` of the catalogue's list.
macro_rules! catalogue {
    ($($(#[$cfg:meta])* $module:ident::$Effect:ident = $code:literal),+ $(,)?) => {
        $($(#[$cfg])* pub use $module::$Effect;)+

        /// An effect of the catalogue by its stable number.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(u8)]
        pub enum EffectId {
            $(
                $(#[$cfg])*
                #[doc = concat!("See [`", stringify!($Effect), "`].")]
                $Effect = $code,
            )+
        }

        /// An effect with its parameters.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Effect<S> {
            $(
                $(#[$cfg])*
                #[doc = concat!("See [`", stringify!($Effect), "`].")]
                $Effect($Effect<S>),
            )+
        }

        impl EffectId {
            /// The whole catalogue, in the order of the numbers.
            pub const ALL: &'static [EffectId] = &[$($(#[$cfg])* EffectId::$Effect),+];

            /// The facts of the effect.
            pub const fn info(self) -> &'static EffectInfo {
                match self {
                    $($(#[$cfg])* EffectId::$Effect => &$Effect::<f64>::INFO,)+
                }
            }

            /// Whether the effect belongs to the rig and is compensated; the others belong to the
            /// material, and an estimator is asked for them. Like the next ones a function of its
            /// own: through [`EffectId::info`] a board would have the catalogue's texts in its flash.
            pub const fn belongs_to_rig(self) -> bool {
                match self {
                    $($(#[$cfg])* EffectId::$Effect => const { $Effect::<f64>::INFO.stage.belongs_to_rig() },)+
                }
            }

            /// Whether a board can compensate the effect: one of the rig, unless it counts the time
            /// from the start of a log.
            pub const fn is_for_boards(self) -> bool {
                self.belongs_to_rig()
                    && match self {
                        $($(#[$cfg])* EffectId::$Effect => const { !$Effect::<f64>::INFO.timed },)+
                    }
            }

            /// Whether the plain form of the effect can be compensated only with speed, acceleration
            /// or the rate of the force.
            pub const fn needs_derivative(self) -> bool {
                match self {
                    $($(#[$cfg])* EffectId::$Effect => const { $Effect::<f64>::INFO.needs_derivative },)+
                }
            }
        }

        impl<S: Scalar> Effect<S> {
            /// The effect with the values of a row, in the order of [`EffectInfo::parameters`].
            pub fn new(id: EffectId, row: &[S; MOST_PARAMETERS]) -> Effect<S> {
                match id {
                    $($(#[$cfg])* EffectId::$Effect => Effect::$Effect($Effect::from_row(row)),)+
                }
            }

            /// The id of the effect.
            pub const fn id(&self) -> EffectId {
                match self {
                    $($(#[$cfg])* Effect::$Effect(_) => EffectId::$Effect,)+
                }
            }

            /// The values of its parameters, in the order of [`EffectInfo::parameters`].
            pub fn row(&self) -> [S; MOST_PARAMETERS] {
                match self {
                    $($(#[$cfg])* Effect::$Effect(effect) => effect.row(),)+
                }
            }
        }
    };
}
pub(super) use catalogue;
