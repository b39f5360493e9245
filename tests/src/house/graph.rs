//! Which file of a crate knows which: paths of `use`, paths in the code, through re-exports to where a
//! name is defined.

use super::source::{Source, Sources, is_name};
use std::collections::{BTreeMap, BTreeSet};

/// From a file to the files that it needs, by module.
pub type Graph = BTreeMap<String, BTreeSet<String>>;

/// A name that a file brings in.
#[derive(Clone, Debug)]
struct Import {
    /// What it is called here; `*` brings in all.
    name: String,
    path: Vec<String>,
    /// For others, too: a re-export.
    public: bool,
}

/// A file as the resolver needs it.
struct File {
    imports: Vec<Import>,
    /// Paths of two names or more outside of `use`.
    paths: Vec<Vec<String>>,
    /// All names outside of `use`.
    names: BTreeSet<String>,
}

impl Sources {
    /// The graph of the files. A re-export is no need by itself: it counts for whoever uses the name.
    pub fn graph(&self) -> Graph {
        let files: BTreeMap<&str, File> = self
            .files
            .iter()
            .map(|(module, source)| (module.as_str(), File::of(source)))
            .collect();
        let resolver = Resolver { files: &files };
        files
            .iter()
            .map(|(module, file)| {
                let mut needs = resolver.needs(module, file);
                needs.remove(*module);
                (module.to_string(), needs)
            })
            .collect()
    }
}

impl File {
    fn of(source: &Source) -> File {
        let texts: Vec<&str> = source
            .tokens
            .iter()
            .map(|token| token.text.as_str())
            .collect();
        let mut file = File {
            imports: Vec::new(),
            paths: Vec::new(),
            names: BTreeSet::new(),
        };
        let mut at = 0;
        while at < texts.len() {
            // `use<'a>` captures lifetimes.
            if texts[at] == "use" && texts.get(at + 1) != Some(&"<") {
                let end = at
                    + texts[at..]
                        .iter()
                        .position(|text| *text == ";")
                        .unwrap_or(0);
                let public = at > 0 && matches!(texts[at - 1], "pub" | ")");
                let mut tree = texts[at + 1..end].iter().copied().peekable();
                use_tree(&mut tree, &[], public, &mut file.imports);
                at = end + 1;
            } else if texts[at] == "in" && at > 0 && texts[at - 1] == "(" {
                // `pub(in crate::room)` says who may look, and needs nothing.
                at += path_at(&texts[at + 1..]).len() * 2;
            } else if is_name(texts[at]) {
                let path = path_at(&texts[at..]);
                file.names.insert(texts[at].to_string());
                let behind = at > 0 && texts[at - 1] == "::";
                if path.len() > 1 && !behind {
                    file.paths.push(path);
                }
                at += 1;
            } else {
                at += 1;
            }
        }
        file
    }
}

/// The names of a path that begins here.
fn path_at(texts: &[&str]) -> Vec<String> {
    let mut path = vec![texts[0].to_string()];
    let mut at = 1;
    while texts.get(at) == Some(&"::") && texts.get(at + 1).is_some_and(|next| is_name(next)) {
        path.push(texts[at + 1].to_string());
        at += 2;
    }
    path
}

fn use_tree<'a>(
    texts: &mut std::iter::Peekable<impl Iterator<Item = &'a str>>,
    before: &[String],
    public: bool,
    imports: &mut Vec<Import>,
) {
    let mut path = before.to_vec();
    while let Some(text) = texts.next() {
        match text {
            "::" => {}
            "{" => {
                while texts.peek().is_some_and(|next| *next != "}") {
                    use_tree(texts, &path, public, imports);
                }
                texts.next();
                if texts.peek() == Some(&",") {
                    texts.next();
                }
                return;
            }
            "," => break,
            "as" => {
                let name = texts.next().unwrap_or("_").to_string();
                imports.push(Import { name, path, public });
                if texts.peek() == Some(&",") {
                    texts.next();
                }
                return;
            }
            name => path.push(name.to_string()),
        }
        if texts.peek() == Some(&"}") {
            break;
        }
    }
    if path.last().is_some_and(|last| last == "self") {
        path.pop();
    }
    if let Some(name) = path.last().cloned() {
        imports.push(Import { name, path, public });
    }
}

struct Resolver<'a> {
    files: &'a BTreeMap<&'a str, File>,
}

impl Resolver<'_> {
    fn needs(&self, module: &str, file: &File) -> BTreeSet<String> {
        let mut needs = BTreeSet::new();
        for import in &file.imports {
            let used = file.names.contains(&import.name);
            if import.name == "*" {
                let from = self.absolute(module, &import.path[..import.path.len() - 1]);
                let from = from.and_then(|path| self.module(&path));
                for name in from.iter().flat_map(|_| &file.names) {
                    let Some(from) = &from else { continue };
                    needs.extend(self.exported(from, name, 0));
                }
            } else if !import.public || used {
                let path = self.absolute(module, &import.path);
                // A module that is brought in counts by what is used of it.
                if let Some(path) = path.filter(|path| self.module(path).is_none()) {
                    needs.extend(self.definition(&path, 0));
                }
            }
        }
        for path in &file.paths {
            let brought = file.imports.iter().find(|import| import.name == path[0]);
            let path = match brought {
                Some(import) => [&import.path[..], &path[1..]].concat(),
                None => path.clone(),
            };
            if let Some(path) = self.absolute(module, &path) {
                needs.extend(self.definition(&path, 0));
            }
        }
        needs
    }

    /// A path from the root; `None` if it leads out of the crate.
    fn absolute(&self, module: &str, path: &[String]) -> Option<Vec<String>> {
        let mut base: Vec<String> = Vec::new();
        let mut here = || {
            if !module.is_empty() {
                base.extend(module.split("::").map(str::to_string));
            }
        };
        let mut rest = path;
        match path.first()?.as_str() {
            "crate" => rest = &path[1..],
            "self" => {
                here();
                rest = &path[1..];
            }
            "super" => {
                here();
                while rest.first().is_some_and(|part| part == "super") {
                    base.pop();
                    rest = &rest[1..];
                }
            }
            first => {
                here();
                let mut child = base.clone();
                child.push(first.to_string());
                self.module(&child)?;
            }
        }
        base.extend(rest.iter().cloned());
        Some(base)
    }

    fn module(&self, path: &[String]) -> Option<String> {
        let name = path.join("::");
        self.files.contains_key(name.as_str()).then_some(name)
    }

    /// The file in which the thing with an absolute path is defined: a name behind the last module
    /// of the path; of a path that names a module, that module.
    fn definition(&self, path: &[String], depth: usize) -> Option<String> {
        let modules = (0..=path.len())
            .rev()
            .find_map(|count| Some((count, self.module(&path[..count])?)));
        let (count, module) = modules?;
        match path.get(count) {
            Some(name) => self.exported(&module, name, depth).or(Some(module)),
            None => Some(module),
        }
    }

    /// The file in which a name of a module is defined, through its re-exports; `None` if the module
    /// does not have it.
    fn exported(&self, module: &str, name: &str, depth: usize) -> Option<String> {
        const LONGEST: usize = 16;
        let file = self.files.get(module).filter(|_| depth < LONGEST)?;
        let named = file.imports.iter().find(|import| import.name == name);
        if let Some(import) = named {
            let path = self.absolute(module, &import.path)?;
            return self.definition(&path, depth + 1);
        }
        let globs = file
            .imports
            .iter()
            .filter(|import| import.name == "*" && import.public);
        for import in globs {
            let path = self.absolute(module, &import.path[..import.path.len() - 1]);
            let from = path.and_then(|path| self.module(&path));
            if let Some(found) = from.and_then(|from| self.exported(&from, name, depth + 1)) {
                return Some(found);
            }
        }
        file.names.contains(name).then(|| module.to_string())
    }
}

/// Circles: among the files, and among the rooms of every folder, whose arrows are those of the files
/// in them. Each as the modules that are on it.
pub fn circles(graph: &Graph) -> Vec<Vec<String>> {
    let mut found = strongly_connected(graph);
    let folders: BTreeSet<&str> = graph
        .keys()
        .filter_map(|module| module.rsplit_once("::").map(|(folder, _)| folder))
        .chain([""])
        .collect();
    for folder in folders {
        found.extend(strongly_connected(&rooms(graph, folder)));
    }
    found.sort();
    found.dedup();
    found
}

/// The rooms right below a folder, each with all that is in it.
fn rooms(graph: &Graph, folder: &str) -> Graph {
    let room = |module: &str| -> Option<String> {
        let below = match folder {
            "" => module,
            _ => module.strip_prefix(folder)?.strip_prefix("::")?,
        };
        let name = below.split("::").next().filter(|name| !name.is_empty())?;
        Some(if folder.is_empty() {
            name.into()
        } else {
            format!("{folder}::{name}")
        })
    };
    let mut rooms = Graph::new();
    for (module, needs) in graph {
        let Some(from) = room(module) else { continue };
        let own = rooms.entry(from.clone()).or_default();
        own.extend(
            needs
                .iter()
                .filter_map(|to| room(to))
                .filter(|to| *to != from),
        );
    }
    rooms
}

/// Sets of nodes each of which leads to every other.
fn strongly_connected(graph: &Graph) -> Vec<Vec<String>> {
    let reach: BTreeMap<&String, BTreeSet<&String>> = graph
        .keys()
        .map(|from| {
            let mut seen: BTreeSet<&String> = BTreeSet::new();
            let mut open: Vec<&String> = graph[from].iter().collect();
            while let Some(next) = open.pop() {
                if seen.insert(next) {
                    open.extend(graph.get(next).into_iter().flatten());
                }
            }
            (from, seen)
        })
        .collect();
    let mut found: Vec<Vec<String>> = Vec::new();
    for (from, reached) in &reach {
        let circle: Vec<String> = graph
            .keys()
            .filter(|to| reached.contains(to) && reach[to].contains(from))
            .cloned()
            .collect();
        if circle.len() > 1 && !found.contains(&circle) {
            found.push(circle);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn graph(files: &[(&str, &str)]) -> Graph {
        let files = files
            .iter()
            .map(|(module, text)| (module.to_string(), text.to_string()));
        Sources::of(files).graph()
    }

    #[test]
    fn a_name_leads_through_re_exports_to_the_file_that_defines_it() {
        let graph = graph(&[
            ("", "pub mod a; pub mod b; pub use a::Deep;"),
            ("a", "mod deep; pub use deep::Deep; pub struct Own;"),
            ("a::deep", "pub struct Deep;"),
            (
                "b",
                "use crate::{Deep, a::Own as Mine}; fn f(_: Deep, _: Mine) {}",
            ),
        ]);
        let needs: Vec<&str> = graph["b"].iter().map(String::as_str).collect();
        assert_eq!(needs, ["a", "a::deep"]);
        // What a room only passes on it does not need.
        assert!(graph["a"].is_empty() && graph[""].is_empty());
    }

    #[test]
    fn paths_in_the_code_count_as_those_of_use() {
        let graph = graph(&[
            ("", "mod a; mod b; mod c; mod d;"),
            ("a", "fn f() -> crate::b::B { super::c::made() }"),
            ("b", "pub struct B;"),
            ("c", "use crate::d; pub fn made() { d::help() }"),
            ("d", "pub fn help() {}"),
        ]);
        let needs = |module: &str| graph[module].iter().cloned().collect::<Vec<_>>();
        assert_eq!(needs("a"), ["b", "c"]);
        assert_eq!(needs("c"), ["d"]);
    }

    #[test]
    fn a_visibility_needs_nothing() {
        let graph = graph(&[
            ("", "mod a;"),
            ("a", "mod b; use b::c;"),
            ("a::b", "pub(in crate::a) fn c() {}"),
        ]);
        assert!(graph["a::b"].is_empty());
    }

    #[test]
    fn all_of_a_module_counts_by_the_names_that_are_used() {
        let graph = graph(&[
            ("", "mod a;"),
            ("a", "mod b; mod c; pub use b::B; struct Unused;"),
            ("a::b", "pub struct B;"),
            ("a::c", "use super::*; fn f(_: B) {}"),
        ]);
        assert_eq!(graph["a::c"].iter().collect::<Vec<_>>(), ["a::b"]);
    }

    #[test]
    fn a_circle_between_rooms_is_found_where_the_files_have_none() {
        let planted = graph(&[
            ("", "mod low; mod high;"),
            ("low", "mod x; mod y;"),
            ("low::x", "pub struct X;"),
            ("low::y", "fn f(_: crate::high::z::Z) {}"),
            ("high", "pub mod w; pub mod z;"),
            ("high::w", "use crate::low::x::X; fn f(_: X) {}"),
            ("high::z", "pub struct Z;"),
        ]);
        assert_eq!(circles(&planted), [["high", "low"]]);
    }

    #[test]
    fn a_circle_between_a_file_and_its_child_is_found() {
        let planted = graph(&[
            ("", "mod a;"),
            ("a", "mod b; pub struct A(b::B);"),
            ("a::b", "pub struct B; fn f(_: super::A) {}"),
        ]);
        assert_eq!(circles(&planted), [["a", "a::b"]]);
    }
}
