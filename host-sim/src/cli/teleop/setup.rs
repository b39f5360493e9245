//! From arguments to what is simulated.

use std::path::{Path, PathBuf};

use super::args::TeleopArgs;
use crate::diagnostic::Diagnostic;
use crate::kind::Kind;
use crate::model::Model;
use crate::teleop::channel::ChannelConfig;
use crate::teleop::environment::{Environment, Material};
use crate::teleop::file::{ChannelFile, OperatorFile};
use crate::teleop::{Options, SchemeId};

/// What the arguments ask for.
pub(super) fn options(args: &TeleopArgs) -> Result<Options, Diagnostic> {
    let mut options = Options::default().with_scheme(args.scheme);
    if let Some(environment) = environment(&args.model)? {
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
    Ok(options.with_task_for_delay())
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
fn environment(models: &[PathBuf]) -> Result<Option<Environment>, Diagnostic> {
    match models {
        [] => Ok(None),
        [only] => Ok(Some(Environment::throughout(material(only)?))),
        [first, second] => Ok(Some(Environment::changing(
            material(first)?,
            material(second)?,
        ))),
        [.., last] => Err(Diagnostic::new("more than two models")
            .in_file(last)
            .remedy("give one, or two of which the second takes the place of the first")),
    }
}

fn material(path: &Path) -> Result<Material, Diagnostic> {
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
