//! Runs `palpate gap` on every rig below some folders.

use super::answer::Answer;
use super::truth::Truth;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// A run that takes longer has failed (s).
const TOO_LONG_S: u64 = 300;

/// How to run.
#[derive(Clone, Debug)]
pub(crate) struct Options {
    pub(crate) palpate: PathBuf,
    pub(crate) out: PathBuf,
    pub(crate) jobs: usize,
    /// Score the answers of the last run.
    pub(crate) reuse: bool,
    /// Give the second log of a rig that has one (richer.csv) along.
    pub(crate) richer: bool,
    /// Passed on to `gap`.
    pub(crate) arguments: Vec<String>,
}

/// A rig with what was there and what was answered.
#[derive(Clone, Debug)]
pub(crate) struct Scored {
    pub(crate) rig: PathBuf,
    pub(crate) truth: Truth,
    pub(crate) answer: Result<Answer, String>,
}

/// Folders with a truth.json, sorted, at any depth.
pub(crate) fn rigs(dir: &Path) -> Vec<PathBuf> {
    if dir.join("truth.json").is_file() {
        return vec![dir.to_path_buf()];
    }
    let entries = std::fs::read_dir(dir).into_iter().flatten().flatten();
    let mut below: Vec<PathBuf> = entries.map(|e| e.path()).filter(|p| p.is_dir()).collect();
    below.sort();
    below.iter().flat_map(|path| rigs(path)).collect()
}

/// All rigs, `jobs` at a time.
pub(crate) fn all(rigs: &[PathBuf], options: &Options) -> Result<Vec<Scored>, String> {
    let next = AtomicUsize::new(0);
    let scored: Mutex<Vec<(usize, Result<Scored, String>)>> = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..options.jobs.max(1) {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(rig) = rigs.get(index) else { break };
                    let one = score(rig, index, options);
                    eprint!("\r{} of {}", index + 1, rigs.len());
                    if let Ok(mut scored) = scored.lock() {
                        scored.push((index, one));
                    }
                }
            });
        }
    });
    eprintln!();
    let mut scored = scored.into_inner().map_err(|e| e.to_string())?;
    scored.sort_by_key(|(index, _)| *index);
    scored.into_iter().map(|(_, one)| one).collect()
}

fn score(rig: &Path, index: usize, options: &Options) -> Result<Scored, String> {
    let truth = Truth::read(&rig.join("truth.json"))?;
    let parent = rig.parent().and_then(Path::file_name).unwrap_or_default();
    let name = rig.file_name().unwrap_or_default();
    let out = options.out.join(format!(
        "{index:04}-{}-{}",
        parent.display(),
        name.display()
    ));
    let answer = if options.reuse {
        Answer::read(&out.join("gap.json"))
    } else {
        run(rig, &out, options)
    };
    Ok(Scored {
        rig: rig.to_path_buf(),
        truth,
        answer,
    })
}

fn run(rig: &Path, out: &Path, options: &Options) -> Result<Answer, String> {
    std::fs::create_dir_all(out).map_err(|e| format!("{}: {e}", out.display()))?;
    let gap_json = out.join("gap.json");
    // An old answer must not stand for a run that fails; that there is none is no error.
    let _ = std::fs::remove_file(&gap_json);
    let log = std::fs::File::create(out.join("stderr.txt")).map_err(|e| e.to_string())?;
    let started = Instant::now();
    let mut command = Command::new(&options.palpate);
    let richer = rig.join("richer.csv");
    if options.richer && richer.is_file() {
        command.arg("gap").arg("--log").arg(richer);
    } else {
        command.arg("gap");
    }
    let mut child = command
        .args(["--model".as_ref(), rig.join("base.toml").as_os_str()])
        .args(["--log".as_ref(), rig.join("measured.csv").as_os_str()])
        .args(["--out".as_ref(), out.as_os_str()])
        .args(&options.arguments)
        .stdout(Stdio::null())
        .stderr(log)
        .spawn()
        .map_err(|e| format!("{}: {e}", options.palpate.display()))?;
    let status = loop {
        if let Some(status) = child.try_wait().map_err(|e| e.to_string())? {
            break status;
        }
        if started.elapsed() > Duration::from_secs(TOO_LONG_S) {
            // It may have ended meanwhile.
            let _ = child.kill();
            let _ = child.wait();
            return Err(format!("longer than {TOO_LONG_S} s"));
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    let seconds = started.elapsed().as_secs_f64();
    if !status.success() {
        return Err(format!(
            "{status}, see {}",
            out.join("stderr.txt").display()
        ));
    }
    Ok(Answer {
        seconds,
        ..Answer::read(&gap_json)?
    })
}
