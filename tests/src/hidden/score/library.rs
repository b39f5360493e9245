//! The answer of the library to one rig, without running the program.

use super::answer::Answer;
use super::run::measured;
use super::scored::Scored;
use super::truth::Truth;
use palpate::gap::{Options, gap};
use palpate::log::{Log, ReadOptions};
use palpate::model::Model;
use std::path::Path;
use std::time::Instant;

/// Reads the files of a rig's folder as `palpate gap` does, and scores what the library finds.
pub fn score(rig: &Path, options: &Options) -> Result<Scored, String> {
    let started = Instant::now();
    let answer = answer(rig, options).map(|found| Answer {
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

fn answer(rig: &Path, options: &Options) -> Result<Answer, String> {
    let model = Model::read(&rig.join("base.toml")).map_err(|e| e.to_string())?;
    let log = Log::read(&measured(rig), &ReadOptions::default());
    let log = log.and_then(|log| log.uniform());
    let log = log.map_err(|e| e.to_string())?;
    let found = gap(&model, &[log], options).map_err(|e| e.to_string())?;
    Answer::of(&found, f64::NAN)
}
