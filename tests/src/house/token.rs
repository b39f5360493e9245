//! Rust as tokens with their lines: comments and the content of literals are left out.

/// A name, a path separator, or any other sign.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Token {
    pub(super) text: String,
    /// From 1.
    pub(super) line: usize,
}

/// The tokens of a source.
pub(super) fn tokens(source: &str) -> Vec<Token> {
    let characters: Vec<char> = source.chars().collect();
    let mut reader = Reader {
        characters: &characters,
        at: 0,
        line: 1,
    };
    let mut tokens = Vec::new();
    while let Some(next) = reader.peek(0) {
        let line = reader.line;
        if next == '/' && reader.peek(1) == Some('/') {
            reader.skip_while(|c| c != '\n');
        } else if next == '/' && reader.peek(1) == Some('*') {
            reader.skip_block_comment();
        } else if next == '"' {
            reader.skip_string();
        } else if next == '\'' {
            reader.skip_quote();
        } else if next.is_alphabetic() || next == '_' {
            let name = reader.take_while(|c| c.is_alphanumeric() || c == '_');
            match (name.as_str(), reader.peek(0)) {
                ("b" | "c", Some('"')) => reader.skip_string(),
                ("b", Some('\'')) => reader.skip_quote(),
                ("r" | "br", Some('"' | '#')) => reader.skip_raw_string(),
                _ => tokens.push(Token { text: name, line }),
            }
        } else if next == ':' && reader.peek(1) == Some(':') {
            reader.skip(2);
            tokens.push(Token {
                text: "::".into(),
                line,
            });
        } else {
            reader.skip(1);
            if !next.is_whitespace() {
                tokens.push(Token {
                    text: next.into(),
                    line,
                });
            }
        }
    }
    tokens
}

struct Reader<'a> {
    characters: &'a [char],
    at: usize,
    line: usize,
}

impl Reader<'_> {
    fn peek(&self, ahead: usize) -> Option<char> {
        self.characters.get(self.at + ahead).copied()
    }

    fn skip(&mut self, count: usize) {
        for _ in 0..count {
            self.line += usize::from(self.peek(0) == Some('\n'));
            self.at += 1;
        }
    }

    fn skip_while(&mut self, is_part: impl Fn(char) -> bool) {
        while self.peek(0).is_some_and(&is_part) {
            self.skip(1);
        }
    }

    fn take_while(&mut self, is_part: impl Fn(char) -> bool) -> String {
        let from = self.at;
        self.skip_while(is_part);
        self.characters[from..self.at].iter().collect()
    }

    fn skip_block_comment(&mut self) {
        let mut depth = 0;
        while let Some(next) = self.peek(0) {
            match (next, self.peek(1)) {
                ('/', Some('*')) => depth += 1,
                ('*', Some('/')) => depth -= 1,
                _ => {
                    self.skip(1);
                    continue;
                }
            }
            self.skip(2);
            if depth == 0 {
                return;
            }
        }
    }

    fn skip_string(&mut self) {
        self.skip(1);
        while let Some(next) = self.peek(0) {
            self.skip(if next == '\\' { 2 } else { 1 });
            if next == '"' {
                return;
            }
        }
    }

    /// `r"…"` or `r#"…"#`, from behind the `r`; a raw identifier ends at its `#`.
    fn skip_raw_string(&mut self) {
        let hashes = self.take_while(|c| c == '#').len();
        if self.peek(0) != Some('"') {
            return;
        }
        self.skip(1);
        while self.peek(0).is_some() {
            let ends = self.peek(0) == Some('"')
                && (1..=hashes).all(|ahead| self.peek(ahead) == Some('#'));
            self.skip(if ends { 1 + hashes } else { 1 });
            if ends {
                return;
            }
        }
    }

    /// A character literal, or a lifetime, which has no closing quote.
    fn skip_quote(&mut self) {
        if self.peek(1) == Some('\\') {
            self.skip(3);
            self.skip_while(|c| c != '\'');
            self.skip(1);
        } else if self.peek(2) == Some('\'') {
            self.skip(3);
        } else {
            self.skip(1);
            self.skip_while(|c| c.is_alphanumeric() || c == '_');
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(source: &str) -> Vec<String> {
        tokens(source).into_iter().map(|token| token.text).collect()
    }

    #[test]
    fn comments_and_literals_are_left_out_and_lifetimes_are_no_literals() {
        let source = "a // crate::b\n/* crate::c /* d */ */ e(\"crate::f\\\"\", 'g', '\\'', r#\"h\"\"#, b'i') 'j: k";
        assert_eq!(
            texts(source),
            ["a", "e", "(", ",", ",", ",", ",", ")", ":", "k"]
        );
    }

    #[test]
    fn lines_are_counted_through_comments_and_strings() {
        let lines: Vec<usize> = tokens("a\n/*\n*/ b \"\n\" c")
            .iter()
            .map(|token| token.line)
            .collect();
        assert_eq!(lines, [1, 3, 4]);
    }
}
