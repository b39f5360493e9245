//! The files of a crate as modules, without their tests.

use super::token::{Token, tokens};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A function and its length.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Function {
    /// Its name.
    pub name: String,
    /// The line of `fn`.
    pub line: usize,
    /// Lines from `fn` to the closing brace, both included.
    pub length: usize,
}

/// A file without what is compiled for its tests alone.
#[derive(Clone, Debug)]
pub struct Source {
    pub(super) tokens: Vec<Token>,
    /// Lines that are not of its tests.
    pub lines: usize,
    /// Children that it declares for its tests.
    test_children: BTreeSet<String>,
}

/// The files of a crate by the path of their module: `physics::law`; the root is empty.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    pub(super) files: BTreeMap<String, Source>,
}

impl Sources {
    /// All files of the crate whose root is `src/lib.rs` in a folder.
    ///
    /// # Panics
    /// If a file cannot be read.
    pub fn read(package: &Path) -> Sources {
        let mut files = Vec::new();
        collect(&package.join("src"), "", &mut files);
        Sources::of(files)
    }

    /// A crate from the paths of its modules and their text.
    pub fn of(files: impl IntoIterator<Item = (String, String)>) -> Sources {
        let all: BTreeMap<String, Source> = files
            .into_iter()
            .map(|(module, text)| (module, Source::of(&text)))
            .collect();
        let is_of_tests = |module: &str| {
            let mut part = module;
            loop {
                let (parent, name) = part.rsplit_once("::").unwrap_or(("", part));
                let declared = all
                    .get(parent)
                    .is_some_and(|own| own.test_children.contains(name));
                if declared {
                    return true;
                }
                if parent.is_empty() {
                    return false;
                }
                part = parent;
            }
        };
        let of_tests: Vec<String> = all.keys().filter(|own| is_of_tests(own)).cloned().collect();
        let mut files = all;
        files.retain(|module, _| !of_tests.contains(module));
        Sources { files }
    }

    /// The modules and their files.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Source)> {
        self.files
            .iter()
            .map(|(module, file)| (module.as_str(), file))
    }
}

fn collect(folder: &Path, module: &str, files: &mut Vec<(String, String)>) {
    let entries = std::fs::read_dir(folder).expect("the folder of a crate can be read");
    for entry in entries {
        let path = entry.expect("a folder's entry can be read").path();
        let name = path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let inside = if module.is_empty() {
            name.clone()
        } else {
            format!("{module}::{name}")
        };
        if path.is_dir() {
            collect(&path, &inside, files);
        } else if path.extension().is_some_and(|ending| ending == "rs") && name != "main" {
            let text = std::fs::read_to_string(&path).expect("a source can be read");
            let module = match name.as_str() {
                "lib" | "mod" => module.to_string(),
                _ => inside,
            };
            files.push((module, text));
        }
    }
}

impl Source {
    fn of(text: &str) -> Source {
        let all = tokens(text);
        let mut kept = Vec::new();
        let mut test_children = BTreeSet::new();
        let mut lines = text.lines().count();
        let mut at = 0;
        while at < all.len() {
            if !is_test_attribute(&all[at..]) {
                kept.push(all[at].clone());
                at += 1;
                continue;
            }
            let end = end_of_item(&all, at + TEST_ATTRIBUTE.len());
            if let Some(child) = declared_module(&all[at..end]) {
                test_children.insert(child);
            }
            lines -= all[end - 1].line - all[at].line + 1;
            at = end;
        }
        Source {
            tokens: kept,
            lines,
            test_children,
        }
    }

    /// Its functions; what is nested counts for both.
    pub fn functions(&self) -> Vec<Function> {
        let mut functions = Vec::new();
        for (at, token) in self.tokens.iter().enumerate() {
            let name = self
                .tokens
                .get(at + 1)
                .map_or("", |next| next.text.as_str());
            // Not the type `fn(T)`, nor a fragment `fn $name` of a macro.
            if token.text != "fn" || !is_name(name) {
                continue;
            }
            let end = end_of_item(&self.tokens, at);
            functions.push(Function {
                name: name.to_string(),
                line: token.line,
                length: self.tokens[end - 1].line - token.line + 1,
            });
        }
        functions
    }
}

const TEST_ATTRIBUTE: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];

fn is_test_attribute(tokens: &[Token]) -> bool {
    let mut texts = tokens.iter().map(|token| token.text.as_str());
    TEST_ATTRIBUTE.iter().all(|part| texts.next() == Some(part))
}

/// Whether a token is a name.
pub(super) fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// The `x` of `mod x;`.
fn declared_module(item: &[Token]) -> Option<String> {
    let at = item.iter().position(|token| token.text == "mod")?;
    let (name, end) = (item.get(at + 1)?, item.get(at + 2)?);
    (end.text == ";").then(|| name.text.clone())
}

/// Behind the `;` or the closing brace of the item that begins at a token.
fn end_of_item(tokens: &[Token], from: usize) -> usize {
    let mut depth = 0_usize;
    for (at, token) in tokens.iter().enumerate().skip(from) {
        match token.text.as_str() {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => {
                depth = depth.saturating_sub(1);
                if depth == 0 && token.text == "}" {
                    return at + 1;
                }
            }
            ";" if depth == 0 => return at + 1,
            _ => {}
        }
    }
    tokens.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_function_is_as_long_as_its_lines_from_fn_to_the_closing_brace() {
        let source = Source::of(
            "/// Doc.\npub fn a<const N: usize>(\n    x: [u8; N],\n) -> u8 {\n    x[0]\n}\nfn b();\n",
        );
        let expected = [("a", 2, 5), ("b", 7, 1)].map(|(name, line, length)| Function {
            name: name.into(),
            line,
            length,
        });
        assert_eq!(source.functions(), expected);
    }

    #[test]
    fn tests_do_not_count() {
        let text =
            "fn a() {}\n#[cfg(test)]\nmod tests {\n    fn b() {}\n}\n#[cfg(test)]\nmod more;\n";
        let sources = Sources::of([
            (String::new(), text.to_string()),
            ("more".into(), "fn c() {}".into()),
            ("more::deep".into(), "fn d() {}".into()),
        ]);
        assert_eq!(sources.files.keys().collect::<Vec<_>>(), [""]);
        let root = &sources.files[""];
        assert_eq!((root.lines, root.functions().len()), (1, 1));
    }
}
