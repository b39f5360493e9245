//! Sentences that fit a terminal.

/// Widest line (characters).
pub const WIDTH: usize = 100;

/// `lead` and `text`, broken between words into lines of at most [`WIDTH`] characters; further lines
/// stand under the first word. What stands in quotes (a command to copy) is never broken, even if it
/// is longer.
pub fn wrapped(lead: &str, text: &str) -> String {
    let hang = lead.chars().count();
    let mut out = String::from(lead);
    let mut at = hang;
    for (index, word) in words(text).into_iter().enumerate() {
        let length = word.chars().count();
        if index > 0 && at + 1 + length > WIDTH {
            out.push('\n');
            out.extend(std::iter::repeat_n(' ', hang));
            at = hang;
        } else if index > 0 {
            out.push(' ');
            at += 1;
        }
        out.push_str(word);
        at += length;
    }
    out
}

/// Splits at blanks that stand in no quotes. An apostrophe within a word opens none.
fn words(text: &str) -> Vec<&str> {
    let mut words = Vec::new();
    let (mut from, mut quote, mut before) = (0, None, ' ');
    for (at, c) in text.char_indices() {
        match (c, quote) {
            (' ', None) => {
                words.push(&text[from..at]);
                from = at + 1;
            }
            ('\'' | '"' | '`', None) if !before.is_alphanumeric() => quote = Some(c),
            (c, Some(open)) if c == open => quote = None,
            _ => {}
        }
        before = c;
    }
    words.push(&text[from..]);
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_sentence_is_broken_between_words_under_its_first() {
        let text = "word ".repeat(40);
        let out = wrapped("   = note: ", text.trim_end());
        let lines: Vec<&str> = out.lines().collect();
        assert_eq!(lines.len(), 3, "{out}");
        assert!(lines.iter().all(|line| line.chars().count() <= WIDTH));
        assert!(lines[1].starts_with("           word"), "{out}");
        assert_eq!(out.matches("word").count(), 40);
    }

    #[test]
    fn what_stands_in_quotes_is_never_broken() {
        let command = format!("'t=Elapsed Time (s),x={}'", "y ".repeat(60).trim_end());
        let out = wrapped("note: ", &format!("it's perhaps --columns {command} here"));
        assert!(out.contains(&command), "{out}");
        assert!(out.starts_with("note: it's perhaps"), "{out}");
    }

    #[test]
    fn a_short_text_stays_as_it_is() {
        assert_eq!(wrapped("a: ", "b  c"), "a: b  c");
    }
}
