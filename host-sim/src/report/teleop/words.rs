//! What a scheme is called in a report.

use crate::teleop::SchemeId;

/// The name of a scheme for people.
pub(super) fn words(scheme: SchemeId) -> &'static str {
    match scheme {
        SchemeId::PositionPosition => "position–position",
        SchemeId::PositionForce => "position–force",
        SchemeId::FourChannel => "four channels",
        SchemeId::WaveVariables => "wave variables",
        SchemeId::Passivity => "time-domain passivity",
        SchemeId::Reflection => "impedance reflection",
        SchemeId::ReflectionBoth => "reflection of both sides",
        SchemeId::ReflectionShaped => "shaped reflection",
    }
}
