//! How far an estimate can be trusted, in one word.

/// The state of an estimate. Names and numbers are stable: JSON, frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// Nothing has been touched yet.
    #[default]
    NoContact = 0,
    /// In contact, but the motion so far does not tell all parameters apart.
    Unobservable = 1,
    /// Parameters still move, or their standard errors are above the bound.
    Converging = 2,
    /// Parameters are steady and their standard errors are within the bound.
    Converged = 3,
    /// The material has just changed; the old values are being left.
    Changed = 4,
    /// The law does not explain the force: innovations stay far above the measured noise.
    ModelSuspect = 5,
}

impl Status {
    /// All states in the order of their numbers.
    pub const ALL: [Status; 6] = [
        Status::NoContact,
        Status::Unobservable,
        Status::Converging,
        Status::Converged,
        Status::Changed,
        Status::ModelSuspect,
    ];

    /// The stable number.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The one with a number.
    pub fn from_code(code: u8) -> Option<Status> {
        Status::ALL.into_iter().find(|one| one.code() == code)
    }

    /// The name in `estimate.json`.
    pub const fn name(self) -> &'static str {
        match self {
            Status::NoContact => "no_contact",
            Status::Unobservable => "unobservable",
            Status::Converging => "converging",
            Status::Converged => "converged",
            Status::Changed => "changed",
            Status::ModelSuspect => "model_suspect",
        }
    }
}
