//! `palpate gap`: where simulation and measurement disagree, what is missing, and the proof.
//!
//! The steps, a file a word: `floor` says what noise leaves without any model; `course` makes block
//! means of the logs; `shape` says which numbers a law with effects has, `fit` finds them; `weights`
//! says what a residual may be; `propose` says where a candidate starts and what it promises;
//! `search` adds, swaps and drops effects, each time refitting everything.

mod course;
mod fit;
mod floor;
mod propose;
mod search;
mod shape;
mod weights;

pub use floor::Floor;

use estimator_core::effect::EffectId;

use course::{Course, Scales};
use fit::Problem;
use search::Search;

use crate::log::UniformLog;
use crate::model::Model;

/// Blocks of a search.
const SEARCHED: usize = 5_000;

/// debugging
pub fn try_it(model: &Model, logs: &[UniformLog]) {
    let clock = std::time::Instant::now();
    let floors: Vec<Floor> = logs.iter().map(Floor::of).collect();
    let samples: usize = logs.iter().map(UniformLog::len).sum();
    let block = samples.div_ceil(SEARCHED);
    let courses: Vec<Course> = logs.iter().map(|log| Course::of(log).thinned(block)).collect();
    let scales = Scales::of(&courses);
    println!("{floors:?}\n{scales:?} block {block}");
    let given = Vec::new();
    let flat: Vec<f64> = courses
        .iter()
        .zip(&floors)
        .flat_map(|(c, f)| c.count.iter().map(|n| if *n > 0.0 { 1.0 / f.variance(*n) } else { 0.0 }).collect::<Vec<_>>())
        .collect();
    let mut search = Search {
        problem: Problem { courses: &courses, weights: &flat },
        base: &model.environment,
        given: &given,
        scales: &scales,
        ids: EffectId::ALL,
        floor: 0.0,
        correlation: 1.0,
    };
    let base = search.base_fit();
    let weights = weights::weights(&weights::variances(&base, &courses, &floors));
    search.problem.weights = &weights;
    search.floor = weights.iter().filter(|w| **w > 0.0).count() as f64;
    let base = search.problem.fit(&base.shape, base.numbers);
    let show = |fit: &fit::Fit| {
        println!("  ratio {:.4} {:?} env {:?}", (fit.cost / search.floor).sqrt(), search::added(fit), fit.shape.environment_at(&fit.numbers).iter().map(|v| format!("{v:.5}")).collect::<Vec<_>>());
        for t in fit.shape.terms_at(&fit.numbers) { println!("      {:?} {:?}", t.id, t.row); }
    };
    println!("base {:.2}s", clock.elapsed().as_secs_f64());
    show(&base);
    let found = search.run(base);
    let t=std::time::Instant::now(); for _ in 0..10 { let _=search.problem.linear(&found.best.shape,&found.best.numbers); } println!("linear {:.2} ms n {} nodes {}", t.elapsed().as_secs_f64()*100.0, found.best.numbers.len(), search.problem.weights.len());
    let t=std::time::Instant::now(); for _ in 0..10 { let _=search.problem.cost(&found.best.shape,&found.best.numbers); } println!("cost {:.2} ms", t.elapsed().as_secs_f64()*100.0);
    println!("found {:.2}s", clock.elapsed().as_secs_f64());
    show(&found.best);
    if std::env::var("DUMP").is_ok() { let mut row=0; let v=weights::variances(&found.best,&courses,&floors); for c in &courses { fit::along(&found.best.shape,&found.best.numbers,c,|at,rd: estimator_core::rig::Reading<f64>| { println!("D {:.4} {:.6e} {:.4e} {:.4} {:.4} {:.4} {:.3e}", c.time_s[at], c.position_m[at], c.speed_mps[at], c.force_n[at], c.force_n[at]-rd.force_n, v[row].sqrt(), rd.touch.depth_m); row+=1; }); } }
    for r in &found.rivals { for f in r.iter().take(3) { show(f); } }
}
