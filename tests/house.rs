//! The house: arrows between its rooms point down, files and functions are short.

use std::path::Path;
use tests::house::{Sources, circles};

/// Lines of a file without its tests.
const LONGEST_FILE: usize = 400;
/// Lines of a function, from `fn` to its closing brace.
const LONGEST_FUNCTION: usize = 60;

/// The rooms of the core from the ground up: each knows only those before it.
const ROOMS: [&str; 4] = ["maths", "physics", "estimate", "board"];

/// Packages whose rooms know each other in one direction.
const PACKAGES: [&str; 2] = ["estimator-core", "host-sim"];

fn sources(package: &str) -> Sources {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    Sources::read(&repository.join(package))
}

fn core() -> Sources {
    sources("estimator-core")
}

#[test]
fn no_package_has_a_circle_between_its_files_or_rooms() {
    for package in PACKAGES {
        let circles = circles(&sources(package).graph());
        let shown: Vec<String> = circles.iter().map(|circle| circle.join(" ↔ ")).collect();
        assert!(circles.is_empty(), "{package}: {}", shown.join("\n"));
    }
}

#[test]
fn the_rooms_of_the_core_stand_on_each_other() {
    let floor = |module: &str| {
        let room = module.split("::").next().unwrap_or_default();
        ROOMS.iter().position(|own| *own == room)
    };
    for (module, needs) in core().graph() {
        // The root only names things.
        let Some(own) = floor(&module) else {
            assert!(module.is_empty(), "{module} is in no room");
            continue;
        };
        for need in needs {
            assert!(
                floor(&need).is_some_and(|lower| lower <= own),
                "{module} needs {need}"
            );
        }
    }
}

#[test]
fn a_circle_that_is_planted_in_the_core_is_found() {
    let mut graph = core().graph();
    let lowest = graph
        .get_mut("maths::scalar")
        .expect("the scalars have a file");
    lowest.insert("estimate::config".into());
    let circles = circles(&graph);
    assert!(
        circles
            .iter()
            .any(|circle| circle.contains(&"maths".into())),
        "{circles:?}"
    );
}

#[test]
fn a_circle_that_is_planted_in_the_host_is_found() {
    let mut graph = sources("host-sim").graph();
    let lower = graph
        .get_mut("number")
        .expect("what a number prints as has a file");
    lower.insert("cli".into());
    let circles = circles(&graph);
    assert!(
        circles
            .iter()
            .any(|circle| circle.contains(&"number".into())),
        "{circles:?}"
    );
}

#[test]
fn no_file_and_no_function_is_long() {
    let mut long = Vec::new();
    for package in PACKAGES {
        for (module, source) in sources(package).iter() {
            if source.lines > LONGEST_FILE {
                long.push(format!("{package} {module}: {} lines", source.lines));
            }
            let functions = source.functions().into_iter();
            long.extend(
                functions
                    .filter(|function| function.length > LONGEST_FUNCTION)
                    .map(|function| {
                        format!(
                            "{package} {module}:{}: {} has {} lines",
                            function.line, function.name, function.length
                        )
                    }),
            );
        }
    }
    assert!(long.is_empty(), "{}", long.join("\n"));
}
