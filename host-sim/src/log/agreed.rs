//! The kind of machine that a model and its logs are of.

use super::uniform::UniformLog;
use crate::diagnostic::Diagnostic;
use crate::kind::Kind;

/// The kind of a machine of which a model may say one and logs may show one; along a line if nobody does.
///
/// # Errors
/// A model and a log, or two logs, of different kinds.
pub fn agreed_kind(model: Option<Kind>, logs: &[UniformLog]) -> Result<Kind, Diagnostic> {
    let mut agreed = model;
    for log in logs {
        match (agreed, log.kind) {
            (Some(one), Some(other)) if one != other => {
                return Err(contradiction(one, other, log, model.is_some()));
            }
            (None, kind) => agreed = kind,
            _ => {}
        }
    }
    Ok(agreed.unwrap_or_default())
}

fn contradiction(one: Kind, other: Kind, log: &UniformLog, is_model: bool) -> Diagnostic {
    let who = if is_model {
        "the model says"
    } else {
        "the first log has"
    };
    let name = other.name();
    Diagnostic::new(format!(
        "the log has positions in {} and forces in {}, and {who} {} and {}",
        other.unit("m"),
        other.unit("N"),
        one.unit("m"),
        one.unit("N"),
    ))
    .in_file(&log.path)
    .value(name)
    .remedy(match is_model {
        true => format!(
            "write kind = \"{name}\" at the top of the model, or give the columns that belong together \
             (--columns x=NAME,f=NAME)"
        ),
        false => "give logs of one machine, or the columns that belong together (--columns x=NAME,f=NAME)"
            .into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_and_a_log_of_two_kinds_are_an_error() {
        let log = |kind| UniformLog {
            kind,
            ..UniformLog::default()
        };
        let (turns, unknown) = (log(Some(Kind::Rotary)), log(None));
        assert_eq!(
            agreed_kind(None, &[unknown.clone(), turns.clone()]),
            Ok(Kind::Rotary)
        );
        assert_eq!(
            agreed_kind(Some(Kind::Rotary), &[unknown]),
            Ok(Kind::Rotary)
        );
        let error = agreed_kind(Some(Kind::Linear), &[turns]).unwrap_err();
        assert!(error.to_string().contains("rad"), "{error}");
    }
}
