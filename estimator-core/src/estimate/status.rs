//! The status of an estimate says in one word how far it can be trusted.

/// Status of an estimate. Names and codes are stable, since `estimate.json` and frames contain them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// Nothing has been touched yet.
    #[default]
    NoContact = 0,
    /// The motion so far does not determine all parameters.
    Unobservable = 1,
    /// The parameters still move, or their standard errors are above the bound.
    Converging = 2,
    /// The parameters are steady, and their standard errors are within the bound.
    Converged = 3,
    /// The material has just changed, and the parameters are leaving their old values.
    Changed = 4,
    /// The law does not explain the force: the innovations stay far above the measured noise.
    ModelSuspect = 5,
}

impl Status {
    /// All statuses in the order of their codes.
    pub const ALL: [Status; 6] = [
        Status::NoContact,
        Status::Unobservable,
        Status::Converging,
        Status::Converged,
        Status::Changed,
        Status::ModelSuspect,
    ];

    /// The stable code of the status.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The status with this code.
    pub fn from_code(code: u8) -> Option<Status> {
        Status::ALL.into_iter().find(|status| status.code() == code)
    }

    /// The name of the status in `estimate.json`.
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
