//! One rig's answer from the library, without a program or an answer's files.

use super::answer::Answer;
use super::run::Scored;
use super::truth::Truth;
use palpate::gap::{Options, gap};
use palpate::log::{Log, ReadOptions, UniformLog};
use palpate::model::Model;
use std::path::Path;
use std::time::Instant;

/// Reads the files of a folder as `palpate gap` does, and scores what it finds.
pub(crate) fn score(rig: &Path) -> Result<Scored, String> {
    let started = Instant::now();
    let answer = finding(rig, &["measured.csv"]).map(|found| Answer {
        seconds: started.elapsed().as_secs_f64(),
        ..found
    });
    Ok(Scored {
        rig: rig.to_path_buf(),
        truth: Truth::read(&rig.join("truth.json"))?,
        answer,
        further: None,
    })
}

fn finding(rig: &Path, logs: &[&str]) -> Result<Answer, String> {
    let model = Model::read(&rig.join("base.toml")).map_err(|e| e.to_string())?;
    let read = |name: &&str| -> Result<UniformLog, String> {
        let log = Log::read(&rig.join(name), &ReadOptions::default());
        log.and_then(|log| log.uniform()).map_err(|e| e.to_string())
    };
    let logs: Vec<UniformLog> = logs.iter().map(read).collect::<Result<_, _>>()?;
    let found = gap(&model, &logs, &Options::default()).map_err(|e| e.to_string())?;
    Ok(Answer::of(&found, f64::NAN))
}
