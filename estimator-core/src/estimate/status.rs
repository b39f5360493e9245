//! The status of an estimate says in one word how far it can be trusted, and its reason why not further.

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

/// Reason why an estimate is not trusted further than its status says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[repr(u8)]
pub enum Reason {
    /// The residuals are larger, or less white, than the noise of the force.
    Residual = 1,
    /// A parameter is at the bound of what the law allows.
    Bound = 2,
    /// The force is read later or earlier than the position.
    Skew = 3,
    /// The force lags behind the contact.
    Lag = 4,
    /// The resting force has never been seen in free air.
    Zero = 5,
    /// The position of the surface is not known well enough.
    Surface = 6,
    /// The motion so far does not determine all parameters.
    Excitation = 7,
    /// The force is at the end of its range.
    Saturated = 8,
    /// The force decays in holds.
    Relaxing = 9,
    /// Another law explains the force clearly better.
    Law = 10,
}

impl Reason {
    /// All reasons in the order of their codes.
    pub const ALL: [Reason; 10] = [
        Reason::Residual,
        Reason::Bound,
        Reason::Skew,
        Reason::Lag,
        Reason::Zero,
        Reason::Surface,
        Reason::Excitation,
        Reason::Saturated,
        Reason::Relaxing,
        Reason::Law,
    ];

    /// The stable code of the reason.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The reason with this code.
    pub fn from_code(code: u8) -> Option<Reason> {
        Reason::ALL.into_iter().find(|reason| reason.code() == code)
    }

    /// The name of the reason in `estimate.json`.
    pub const fn name(self) -> &'static str {
        match self {
            Reason::Residual => "residual",
            Reason::Bound => "bound",
            Reason::Skew => "skew",
            Reason::Lag => "lag",
            Reason::Zero => "zero",
            Reason::Surface => "surface",
            Reason::Excitation => "excitation",
            Reason::Saturated => "saturated",
            Reason::Relaxing => "relaxing",
            Reason::Law => "law",
        }
    }
}

/// What an estimator knows against its own estimates, whatever their standard errors say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// The data speak against them.
    Against(Reason),
    /// The data have not yet ruled out what would make them wrong.
    NotYetRuledOut(Reason),
}

impl Doubt {
    /// The reason for the doubt.
    pub const fn reason(self) -> Reason {
        match self {
            Doubt::Against(reason) | Doubt::NotYetRuledOut(reason) => reason,
        }
    }
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
