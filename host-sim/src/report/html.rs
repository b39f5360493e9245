//! Escaping of text that goes into HTML or SVG.

use std::borrow::Cow;

/// Escapes the characters that have a meaning in markup, for texts and for attributes. Control characters,
/// which XML forbids, become the replacement character.
pub fn escape(text: &str) -> Cow<'_, str> {
    let special = |c: char| matches!(c, '&' | '<' | '>' | '"' | '\'') || is_forbidden(c);
    if !text.contains(special) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c if is_forbidden(c) => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    Cow::Owned(out)
}

fn is_forbidden(c: char) -> bool {
    (c < ' ' && !matches!(c, '\t' | '\n' | '\r')) || matches!(c, '\u{fffe}' | '\u{ffff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_in_a_file_name_stays_text() {
        assert_eq!(
            escape("<script>\"a\" & 'b'</script>.csv"),
            "&lt;script&gt;&quot;a&quot; &amp; &#39;b&#39;&lt;/script&gt;.csv"
        );
    }

    #[test]
    fn plain_text_is_not_copied_and_control_characters_do_not_pass() {
        assert!(matches!(escape("δ = 4.5 mm"), Cow::Borrowed(_)));
        assert_eq!(escape("a\u{0}b\tc"), "a\u{fffd}b\tc");
    }
}
