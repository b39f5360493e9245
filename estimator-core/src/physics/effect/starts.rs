//! Where a fit starts an effect. A row says it in the sizes of the log that is fitted.

use crate::physics::fit_range::Scaled;

/// Values of one parameter at which a fit starts.
#[derive(Clone, Copy, Debug)]
pub enum StartValues {
    /// One value.
    At(Scaled),
    /// Each of these values.
    Each(&'static [Scaled]),
    /// A geometric series.
    Series(Series),
    /// The number itself, which the fit does not move.
    Held(f64),
}

/// A geometric series of values: `first` times each power of `ratio`.
#[derive(Clone, Copy, Debug)]
pub struct Series {
    /// The value whose power is 0.
    pub first: Scaled,
    /// The factor from one value to the next.
    pub ratio: f64,
    /// The lowest and the highest power.
    pub powers: [i32; 2],
    /// What is not below this value is left out.
    pub below: Scaled,
}

/// Starts of an effect: every combination of the values of its parameters.
#[derive(Clone, Copy, Debug)]
pub struct Starts {
    /// The values of each parameter, in the order of the effect's row. A parameter that is not listed
    /// is 0, and the fit does not move it.
    pub values: &'static [StartValues],
    /// The starts are for logs of which the first number exceeds the second.
    pub exceeds: Option<[Scaled; 2]>,
    /// The starts are for models that have this effect.
    pub beside: Option<&'static str>,
    /// Whether a fit with this start also begins at the law's values in the model file, whatever the
    /// residuals promise: the fitted law imitates the effect.
    pub from_file: bool,
}

impl Starts {
    /// Starts for every log.
    pub(super) const fn at(values: &'static [StartValues]) -> Starts {
        Starts {
            values,
            exceeds: None,
            beside: None,
            from_file: false,
        }
    }

    /// The same starts, for logs of which `one` exceeds `other`.
    pub(super) const fn where_exceeds(self, one: Scaled, other: Scaled) -> Starts {
        Starts {
            exceeds: Some([one, other]),
            ..self
        }
    }

    /// The same starts, for models that have the effect of this name.
    pub(super) const fn beside(self, name: &'static str) -> Starts {
        Starts {
            beside: Some(name),
            ..self
        }
    }

    /// The same starts, which a fit also tries from the law's values in the model file.
    pub(super) const fn also_from_the_file(self) -> Starts {
        Starts {
            from_file: true,
            ..self
        }
    }
}
