//! From arguments to what is simulated.

use std::path::{Path, PathBuf};

use super::args::TeleopArgs;
use crate::diagnostic::Diagnostic;
use crate::kind::Kind;
use crate::model::Model;
use crate::plant::Sensors;
use crate::teleop::channel::ChannelConfig;
use crate::teleop::environment::{Environment, Material};
use crate::teleop::file::{ChannelFile, OperatorFile};
use crate::teleop::{Options, SchemeId, Trace};

/// What the arguments ask for, and what of them has no effect.
pub(super) fn options(args: &TeleopArgs) -> Result<(Options, Vec<String>), Diagnostic> {
    let mut options = Options::default().with_scheme(args.scheme);
    let mut notes = Vec::new();
    if let Some(environment) = environment(&args.model, &mut notes)? {
        options.environment = environment;
    }
    if let Some(path) = &args.operator {
        let file = OperatorFile::read(path)?;
        (options.operator, options.task) = (file.operator, file.task);
        if let Some(excitation) = file.excitation {
            options.reflection.excitation = excitation;
            options.reflection.excites = true;
        }
        options.reflection.shape = file.shape.unwrap_or(options.reflection.shape);
    }
    if let Some(path) = &args.channel {
        let file = ChannelFile::read(path)?;
        options.clock_offset_us = file.clock_offset_us;
        options.waves = file.waves.unwrap_or(options.waves);
    }
    options.channels = channels(args)?;
    if options
        .channels
        .iter()
        .any(|way| way.jitter > 0.0 && way.delay_s == 0.0)
        && !args.compare
    {
        notes.push("a jitter does nothing where there is no delay: it is a share of it".into());
    }
    let mut options = options.with_task_for_delay();
    if let Some(path) = &args.operator {
        changes(&mut options, args, path)?;
    }
    Ok((options, notes))
}

/// Refuses a second material that would never be there, and a change that would never come.
fn changes(options: &mut Options, args: &TeleopArgs, path: &Path) -> Result<(), Diagnostic> {
    let wrong = |what: &str, key: &str| Diagnostic::new(what).in_file(path).at_key(key);
    let two = args.model.len() == 2;
    let Some(task) = &options.task else {
        if two {
            return Err(wrong("a motion of your own never changes the material", "motion").remedy(
                "give one --model, or a [task] instead of `motion`: the second material comes when its hand slides off",
            ));
        }
        options.environment.second = None;
        return Ok(());
    };
    let Some(changes_s) = task.changes_s else {
        return Ok(());
    };
    let end_s = options.duration_s();
    if options.environment.second.is_none() {
        return Err(
            wrong("there is no second material to change to", "task.changes")
                .value(changes_s)
                .remedy("give a second --model, or leave `changes` out"),
        );
    }
    if changes_s >= end_s {
        return Err(wrong(
            "the material changes after the end of the run",
            "task.changes",
        )
        .value(changes_s)
        .remedy(format!(
            "give a time before {end_s:.2} s, or leave `changes` out"
        )));
    }
    Ok(())
}

/// Says that the second material was never there.
pub(super) fn never_changed(options: &Options, trace: &Trace) -> Option<String> {
    let second = options.environment.second.as_ref()?;
    let never = trace.changed_s.is_none();
    never.then(|| {
        format!(
            "{} was never touched: the slave did not leave {} when the hand had slid off",
            second.name, options.environment.first.name
        )
    })
}

/// The way from master to slave, and back.
pub(super) fn channels(args: &TeleopArgs) -> Result<[ChannelConfig; 2], Diagnostic> {
    let file = args.channel.as_deref().map(ChannelFile::read).transpose()?;
    let mut channels = file.unwrap_or_default().channels;
    for channel in &mut channels {
        channel.delay_s = args.delay_ms.map_or(channel.delay_s, |ms| 1e-3 * ms);
        channel.jitter = args.jitter.unwrap_or(channel.jitter);
        channel.loss = args.loss.unwrap_or(channel.loss);
    }
    Ok(channels)
}

/// What the models are, one after the other; `None` without any.
fn environment(
    models: &[PathBuf],
    notes: &mut Vec<String>,
) -> Result<Option<Environment>, Diagnostic> {
    let mut material = |path: &Path| material(path, notes);
    match models {
        [] => Ok(None),
        [only] => Ok(Some(Environment::throughout(material(only)?))),
        [first, second] => {
            let first = material(first)?;
            Ok(Some(Environment::changing(first, material(second)?)))
        }
        [.., last] => Err(Diagnostic::new("more than two models")
            .in_file(last)
            .remedy("give one, or two of which the second takes the place of the first")),
    }
}

fn material(path: &Path, notes: &mut Vec<String>) -> Result<Material, Diagnostic> {
    let name = path
        .file_stem()
        .map_or("model".into(), |stem| stem.to_string_lossy());
    let model = Model::read(path)?;
    if model.kind == Some(Kind::Rotary) {
        return Err(Diagnostic::new("a machine that turns")
            .in_file(path)
            .at_key("kind")
            .value("rotary")
            .remedy(
                "give a model in m and N: motor, hand and limits of the simulated teleoperation move along a line",
            ));
    }
    if model.sensors != Sensors::default() {
        notes.push(format!(
            "[sensors] of {} is not used: master and slave have load cells and encoders of their own",
            path.display()
        ));
    }
    let material = Material {
        name: name.into_owned(),
        rig: model.rig()?,
    };
    Ok(material.at_zero())
}

/// The schemes whose transparency is drawn: the chosen one, and those that people know.
pub(super) fn beside(chosen: SchemeId) -> Vec<SchemeId> {
    let known = [
        SchemeId::PositionForce,
        SchemeId::FourChannel,
        SchemeId::WaveVariables,
        SchemeId::Reflection,
    ];
    let others = known.into_iter().filter(|id| *id != chosen);
    std::iter::once(chosen).chain(others.take(3)).collect()
}
