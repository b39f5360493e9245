//! What a scheme is called in a report.

use crate::teleop::SchemeId;

/// The name of a scheme for people.
pub(super) fn words(scheme: SchemeId) -> String {
    match scheme {
        SchemeId::PositionPosition => "position–position".into(),
        SchemeId::PositionForce => "position–force".into(),
        other => other.name().replace('_', " "),
    }
}
