//! The words after the name of a table.

/// The value after `--name`.
pub fn option<'a>(arguments: &'a [String], name: &str) -> Option<&'a str> {
    let at = arguments.iter().position(|a| a == name)?;
    arguments.get(at + 1).map(String::as_str)
}

/// The whole number after `--name`.
///
/// # Errors
/// What stands there, if it is none.
pub fn number(arguments: &[String], name: &str, default: u64) -> Result<u64, String> {
    option(arguments, name).map_or(Ok(default), |text| {
        text.parse()
            .map_err(|_| format!("{name} {text}: a whole number is expected"))
    })
}

/// Whether the usage knows every option: a table of half an hour is not begun for a `--help`. What follows `--args` is
/// handed on, and has options of its own.
///
/// # Errors
/// The first option that the usage does not have, and the usage.
pub fn known(arguments: &[String], usage: &str) -> Result<(), String> {
    let is_handed_on = |at: usize| at > 0 && arguments[at - 1] == "--args";
    let mut options = arguments
        .iter()
        .enumerate()
        .filter(|(at, word)| word.starts_with("--") && !is_handed_on(*at));
    // A part of an option is none: with `--rig` for `--rigs` the usual table began.
    let is_of_a_word = |c: char| c.is_alphanumeric() || c == '-';
    let has = |word: &str| usage.split(|c| !is_of_a_word(c)).any(|own| own == word);
    match options.find(|(_, word)| !has(word)) {
        Some((_, word)) => Err(format!("{word}: no such option\n\n{usage}")),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const USAGE: &str = "table [--logs N] [--args WORDS]";

    fn words(text: &str) -> Vec<String> {
        text.split_whitespace().map(String::from).collect()
    }

    #[test]
    fn an_option_that_the_usage_does_not_have_is_refused_by_name() {
        assert_eq!(
            known(&words("table --logs 3 --args --quiet"), USAGE),
            Ok(())
        );
        let refused = known(&words("table --help"), USAGE).unwrap_err();
        assert!(refused.starts_with("--help: no such option") && refused.ends_with(USAGE));
        assert!(known(&words("table --log 3"), USAGE).is_err());
    }

    #[test]
    fn a_number_is_what_follows_its_name_or_is_refused_with_it() {
        let arguments = words("table --logs 3 --seed x");
        assert_eq!(number(&arguments, "--logs", 1), Ok(3));
        assert_eq!(number(&arguments, "--jobs", 2), Ok(2));
        assert!(
            number(&arguments, "--seed", 1)
                .unwrap_err()
                .contains("--seed x")
        );
    }
}
