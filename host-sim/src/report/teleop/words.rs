//! What schemes and findings are called, in reports and on the terminal.

use crate::number::{quantity, setting};
use crate::teleop::measure::stability::Rest;
use crate::teleop::{Limit, Measures, Options, SchemeId};

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

/// Whether the system comes to rest, and on which material; the beginning of a sentence or its end.
pub fn rest(options: &Options, measures: &Measures) -> String {
    let environment = &options.environment;
    let second = measures.changed_s.and(environment.second.as_ref());
    let judged = match (second, measures.rest_first) {
        (None, _) => vec![(&environment.first.name, measures.rest)],
        (Some(second), None) => vec![(&second.name, measures.rest)],
        (Some(second), Some(first)) => {
            vec![
                (&environment.first.name, first),
                (&second.name, measures.rest),
            ]
        }
    };
    let on = |rest: Rest| {
        let own = judged.iter().filter(|(_, own)| *own == rest);
        let names: Vec<&str> = own.map(|(name, _)| name.as_str()).collect();
        names.join(" and on ")
    };
    match measures.rests() {
        Rest::Rests => format!("the system comes to rest on {}", on(Rest::Rests)),
        Rest::Moves => format!("the system does not come to rest on {}", on(Rest::Moves)),
        Rest::CannotTell => format!(
            "whether the system comes to rest on {} cannot be told: the last press is too short for it, or the motion \
             does not end in one",
            on(Rest::CannotTell)
        ),
    }
}

/// Up to which round trip a scheme comes to rest.
pub(super) fn limit(limit: &Limit, own_s: f64) -> Result<String, &'static str> {
    let Some(rests_to_s) = limit.rests_to_s else {
        return Err("none, not even without delay");
    };
    let to = setting(rests_to_s, "s");
    Ok(match limit.ends_at_s {
        None => format!("{to}, the longest that was tried"),
        Some(ends_at_s) => {
            let again = match limit.rests_again {
                true => format!("; again at {}", setting(own_s, "s")),
                false => String::new(),
            };
            let (to, at) = (quantity(rests_to_s, 2, "s"), quantity(ends_at_s, 2, "s"));
            format!("{to}, and not at {at}{again}")
        }
    })
}
