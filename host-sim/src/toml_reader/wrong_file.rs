//! Files that are given where a TOML file should be.

use std::io;
use std::path::Path;

use crate::diagnostic::Diagnostic;

/// What TOML looks like.
pub(super) const FORM: &str =
    "a table is [name], a value is key = 1.0, text stands in double quotes";

/// What the operating system says about a file.
pub(super) fn unreadable(path: &Path, error: &io::Error) -> Diagnostic {
    let remedy = match error.kind() {
        io::ErrorKind::NotFound => "check the path",
        io::ErrorKind::PermissionDenied => "check the file's permissions",
        io::ErrorKind::IsADirectory => "give the file in the folder, not the folder",
        io::ErrorKind::InvalidData => FORM,
        _ => "make sure that it is a file that can be read to its end",
    };
    let what = match error.kind() {
        io::ErrorKind::InvalidData => "this is not UTF-8 text, so it cannot be TOML".into(),
        _ => format!("cannot read the file: {error}"),
    };
    Diagnostic::new(what).in_file(path).remedy(remedy)
}

/// Text of another kind, told by its first line.
pub(super) fn not_toml(text: &str) -> Option<Diagnostic> {
    let lines = text.lines().enumerate();
    let (index, line) = lines
        .map(|(index, line)| (index, line.trim()))
        .find(|(_, line)| !line.is_empty())?;
    let delimiters = line.matches([',', ';', '\t']).count();
    let kind = match line.as_bytes()[0] {
        b'{' => "a JSON file",
        b'<' => "an HTML or XML page",
        b'#' | b'[' => return None,
        _ if delimiters >= 2 && !line.contains('=') => "a table, such as a log",
        _ => return None,
    };
    Some(
        Diagnostic::new(format!("this is {kind}, not TOML"))
            .at_line(index + 1)
            .excerpt(line, 0..0)
            .remedy(FORM),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_files_are_called_by_their_name_and_toml_is_left_alone() {
        for (text, kind) in [
            ("t_s,x_m,f_n\n0,1,2\n", "a log"),
            ("\n{\"law\": 1}\n", "JSON"),
            ("<!DOCTYPE html>\n", "HTML"),
        ] {
            let wrong = not_toml(text).unwrap();
            assert!(wrong.what.contains(kind), "{wrong}");
        }
        for text in [
            "",
            "# a, b, c\n",
            "[environment]\n",
            "fixed = [\"a\", \"b\", \"c\"]",
        ] {
            assert_eq!(not_toml(text), None);
        }
    }
}
