//! The three channels of a log, and where in a file they stand.

use super::units::Unit;
use crate::kind::Kind;

/// One of the three channels of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Time (s).
    Time,
    /// Position (m).
    Position,
    /// Force (N).
    Force,
}

impl Channel {
    /// All three, in the order of a log's columns.
    pub const ALL: [Channel; 3] = [Channel::Time, Channel::Position, Channel::Force];

    /// The name of its column in a log of our own.
    pub const fn column(self) -> &'static str {
        match self {
            Channel::Time => "t_s",
            Channel::Position => "x_m",
            Channel::Force => "f_n",
        }
    }

    /// The name of its column in a log of our own of a rig that turns: rad and N m.
    pub const fn rotary_column(self) -> &'static str {
        match self {
            Channel::Time => "t_s",
            Channel::Position => "x_rad",
            Channel::Force => "f_nm",
        }
    }

    /// The name of its column in a log of our own of a machine of this kind.
    pub const fn column_of(self, kind: Kind) -> &'static str {
        match kind {
            Kind::Linear => self.column(),
            Kind::Rotary => self.rotary_column(),
        }
    }

    /// Its letter in `--columns`.
    pub const fn letter(self) -> char {
        match self {
            Channel::Time => 't',
            Channel::Position => 'x',
            Channel::Force => 'f',
        }
    }

    /// Quantity and unit, for sentences.
    pub const fn quantity(self) -> &'static str {
        match self {
            Channel::Time => "time in seconds",
            Channel::Position => "position in metres",
            Channel::Force => "force in newtons",
        }
    }

    /// Its name in sentences.
    pub const fn noun(self) -> &'static str {
        match self {
            Channel::Time => "time",
            Channel::Position => "position",
            Channel::Force => "force",
        }
    }
}

/// Where in a row a channel stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    pub(super) index: usize,
    pub(super) factor: f64,
    /// The unit in the file, where it is known; `None` where a factor was given.
    pub(super) unit: Option<Unit>,
    pub(super) origin: Origin,
}

/// Why a column is a channel's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// It has the name of our own logs: SI, with our signs.
    Own,
    /// It was named.
    Named,
    /// Its name and unit tell.
    Guessed,
}

/// What is known of the columns of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Header<'a> {
    pub(super) names: &'a [String],
    /// The cells of a row of units; empty without one.
    pub(super) units: &'a [String],
    /// The first rows.
    pub(super) sample: &'a [Vec<String>],
}
