//! Which estimator runs: its number, and the facts about it that others read.

use crate::physics::law::LawKind;

/// A method of estimation, by the stable number that settings of boards hold.
///
/// The methods that exist are constants that stand beside the estimators that run them.
/// [`Config::validate`](crate::Config::validate) refuses a number that is none of theirs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Method(u8);

impl Method {
    /// The method with a number.
    pub const fn from_code(code: u8) -> Self {
        Method(code)
    }

    /// The stable number.
    pub const fn code(self) -> u8 {
        self.0
    }
}

/// When the command line runs a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offer {
    /// For its law, unless another method is asked for by name.
    Default,
    /// When it is asked for by name.
    ByName,
    /// When it is asked for by a name that `--help` does not list.
    Unlisted,
    /// When it is asked for by name and no law is, as it chooses the law itself.
    ChoosesLaw,
}

/// The facts about a method, one row beside the estimator that runs it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodInfo {
    /// The method.
    pub method: Method,
    /// The law that the method identifies, or starts with if it chooses among several.
    pub law: LawKind,
    /// The name on the command line. Methods for different laws may share it.
    pub name: &'static str,
    /// The line in `--help`.
    pub about: &'static str,
    /// When the command line runs the method.
    pub offer: Offer,
    /// Whether the surface is among the parameters, rather than taken from the impact.
    pub finds_surface: bool,
    /// Whether the method goes over a history again and again, which a board has no time for.
    pub has_history: bool,
    /// α₁ of (24) where the configuration leaves it open: 1 − α₁ is the forgetting factor for large
    /// errors.
    pub alpha_1: f32,
}

/// Declares the methods of an estimator: the constant of each, with its number, and `METHODS`, the
/// rows with their facts. A fact that is left out is that of most methods: asked for by name, the
/// surface taken from the impact, no history, and large errors forgotten within a thousand samples.
macro_rules! methods {
    ($($(#[$doc:meta])* $constant:ident = $code:literal, $law:ident, $name:literal, $about:literal
        $(, $fact:ident: $value:expr)*;)*) => {
        impl $crate::estimate::method::Method {
            $($(#[$doc])* pub const $constant: Self = Self::from_code($code);)*
        }

        const METHODS: &[$crate::estimate::method::MethodInfo] = &[$({
            #[allow(unused_mut)]
            let mut row = $crate::estimate::method::MethodInfo {
                method: $crate::estimate::method::Method::$constant,
                law: $crate::physics::law::LawKind::$law,
                name: $name,
                about: $about,
                offer: $crate::estimate::method::Offer::ByName,
                finds_surface: false,
                has_history: false,
                alpha_1: 0.001,
            };
            $(row.$fact = $value;)*
            row
        }),*];
    };
}

pub(crate) use methods;
