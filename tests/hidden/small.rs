//! The whole workflow on six short rigs, one of each kind of answer, by the scorer of the big table.

use crate::rig::case::{Case, Kind};
use crate::score::answer::Answer;
use crate::score::judge::{Mark, errors};
use crate::score::library;
use crate::score::run::Scored;
use crate::score::table;
use std::path::Path;

/// Draws the rigs.
const SEED: u64 = 1;

/// The rig `index` of a kind as files, and the answer to them.
fn scored(kind: Kind, index: u64) -> Scored {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("hidden-{}", kind.name()));
    let written = Case::brief(kind, SEED, index).save(&folder);
    written.unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    library::score(&folder).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn probe() {
    let all: Vec<Scored> = [
        (Kind::Unknown, 1),
        (Kind::Unknown, 2),
        (Kind::Unknown, 7),
        (Kind::Unknown, 9),
        (Kind::Unknown, 11),
        (Kind::Unknown, 12),
    ]
    .into_iter()
    .map(|(kind, index)| {
        let t = std::time::Instant::now();
        let s = scored(kind, index);
        println!(
            "{kind:?} {index} {} {:.2}",
            s.truth.label,
            t.elapsed().as_secs_f64()
        );
        if let Ok(a) = &s.answer {
            println!("{:.2?}", errors(&s.truth, a));
        }
        s
    })
    .collect();
    println!("{}", table::text(&all, true));
    let _ = |a: &Answer| (Mark::Exact, errors(&all[0].truth, a));
}
