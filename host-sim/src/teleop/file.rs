//! Operator and channel from TOML files, with errors that name line, key, value and remedy.
//!
//! [`OPERATOR_KEYS`] and [`CHANNEL_KEYS`] say what can stand in them.

use std::path::Path;

use super::channel::{ChannelConfig, Jitter};
use super::hand::Excitation;
use super::operator::{Grip, HAND, Operator, Task};
use super::scheme::shape::Shape;
use super::scheme::wave_variables::Waves;
use crate::diagnostic::Diagnostic;
use crate::motion::Motion;
use crate::toml_reader::{Bounds, Table, TomlFile};

/// Every key of an operator's file, with its default; all are optional.
pub const OPERATOR_KEYS: &str = r#"force_limit = 30.0      # N
excitation = 0.3        # N, known force at the master that shows the hand (reflection_both); 0: none
motion = "motion.toml"  # the intended motion, as `palpate simulate` takes it; otherwise [task]
[[grip]]                # one or more, in the order of time
from = 0.0              # s
mass = 0.35             # kg
damping = 9.0           # N s/m
stiffness = 700.0       # N/m
[task]
outside = -0.006        # m, where the hand rests
inside = 0.014          # m, intended depth
frequency = 0.8         # Hz
palpates = [8.75, 6.25] # s, before and after it slides off
presses = 3.4           # s
changes = 6.0           # s, when the second --model takes the place of the first, touched or not; otherwise it
                        # does when the hand has slid off
[shape]                 # what reflection_shaped makes of the material: K' = gain·K·(K/reference)^(power − 1)
gain = 0.7
power = 1.0             # below 1: materials come closer to each other
reference = 3000.0      # N/m"#;

/// Every key of a channel's file; all are optional. `[back]` has the keys of `[there]`.
pub const CHANNEL_KEYS: &str = r#"clock_offset = 0.0      # s, how far the slave's clock is ahead
[there]
delay = 0.05            # s, one way
jitter = 0.3            # share of the delay
distribution = "gamma"  # or "uniform"
loss = 0.05             # share of the messages
burst = 1.0             # messages lost in a row, on average
rate = 12000            # bytes/s
outage = [8.0, 10.0]    # s, from and until when nothing arrives
[waves]                 # of wave_variables
impedance = 30.0        # N s/m
servo = "stiff"         # of the slave; or "matched" to the waves"#;

/// What an operator's file says.
#[derive(Clone, Debug, PartialEq)]
pub struct OperatorFile {
    /// Who moves the master.
    pub operator: Operator,
    /// The task, unless the motion is another file's.
    pub task: Option<Task>,
    /// The known force at the master; `Some(None)`: none is wanted.
    pub excitation: Option<Option<Excitation>>,
    /// How the impedance is changed before it is rendered, if that was said.
    pub shape: Option<Shape>,
}

/// What a channel's file says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChannelFile {
    /// From master to slave, and back.
    pub channels: [ChannelConfig; 2],
    /// How far the slave's clock is ahead of the master's (µs).
    pub clock_offset_us: u64,
    /// How waves are made, if that was said.
    pub waves: Option<Waves>,
}

impl OperatorFile {
    /// Reads an operator.
    ///
    /// # Errors
    /// A [`Diagnostic`] with line, key, value and remedy.
    pub fn read(path: &Path) -> Result<OperatorFile, Diagnostic> {
        OperatorFile::from_toml(&TomlFile::read(path)?, path)
    }

    /// An operator from a parsed file; a motion's path is relative to it.
    ///
    /// # Errors
    /// As [`OperatorFile::read`].
    pub fn from_toml(file: &TomlFile, path: &Path) -> Result<OperatorFile, Diagnostic> {
        let root = file.root();
        root.understand(&[
            "force_limit",
            "excitation",
            "motion",
            "grip",
            "task",
            "shape",
        ]);
        let force_limit = root.number("force_limit", Bounds::Within(0.1, 1e3))?;
        let excitation = root.number("excitation", Bounds::Within(0.0, 10.0))?;
        let grips = root.tables("grip")?;
        let grips = grips.iter().map(grip).collect::<Result<Vec<_>, _>>()?;
        if let Some(at) = grips
            .windows(2)
            .position(|pair| pair[0].from_s >= pair[1].from_s)
        {
            return Err(root
                .wrong_table("the grips do not follow each other in time")
                .at_key(&format!("grip[{}].from", at + 2))
                .value(grips[at + 1].from_s)
                .remedy("order the grips by `from`"));
        }
        let task = root
            .table("task")?
            .map(|table| self::task(&table))
            .transpose()?;
        let shape = root
            .table("shape")?
            .map(|table| self::shape(&table))
            .transpose()?;
        let motion = match root.text("motion")? {
            Some(_) if task.is_some() => {
                return Err(root
                    .wrong("motion", "both `motion` and [task] say where the hand goes")
                    .remedy("remove one of them"));
            }
            Some(name) => Some(Motion::read(&path.with_file_name(name))?),
            None => None,
        };
        root.finish()?;
        let usual = Operator::default();
        let task = motion.is_none().then(|| task.unwrap_or_default());
        Ok(OperatorFile {
            operator: Operator {
                intention: motion
                    .unwrap_or_else(|| task.map_or(usual.intention, |task| task.motion())),
                grips: if grips.is_empty() { usual.grips } else { grips },
                force_limit_n: force_limit.unwrap_or(usual.force_limit_n),
            },
            task,
            excitation: excitation.map(|force_n| (force_n > 0.0).then_some(Excitation { force_n })),
            shape,
        })
    }
}

fn grip(table: &Table<'_>) -> Result<Grip, Diagnostic> {
    table.understand(&["from", "mass", "damping", "stiffness"]);
    let or = |key: &str, bounds, usual: f64| -> Result<f64, Diagnostic> {
        Ok(table.number(key, bounds)?.unwrap_or(usual))
    };
    let grip = Grip {
        from_s: or("from", Bounds::NotNegative, HAND.from_s)?,
        mass_kg: or("mass", Bounds::Within(0.0, 100.0), HAND.mass_kg)?,
        damping_ns_per_m: or("damping", Bounds::Within(0.0, 1e4), HAND.damping_ns_per_m)?,
        stiffness_n_per_m: or(
            "stiffness",
            Bounds::Within(1.0, 1e5),
            HAND.stiffness_n_per_m,
        )?,
    };
    table.finish()?;
    Ok(grip)
}

fn task(table: &Table<'_>) -> Result<Task, Diagnostic> {
    table.understand(&[
        "outside",
        "inside",
        "frequency",
        "palpates",
        "presses",
        "changes",
    ]);
    let usual = Task::default();
    let or = |key: &str, bounds, usual: f64| -> Result<f64, Diagnostic> {
        Ok(table.number(key, bounds)?.unwrap_or(usual))
    };
    let seconds = Bounds::Within(0.1, 3600.0);
    let palpates_s = match table.numbers("palpates", seconds)?.as_deref() {
        None => usual.palpates_s,
        Some([before, after]) => (*before, *after),
        Some(_) => {
            return Err(table
                .wrong("palpates", "not two times")
                .remedy("`palpates` is two times in s, before and after the hand slides off"));
        }
    };
    let task = Task {
        outside_m: or("outside", Bounds::Within(-1.0, 0.0), usual.outside_m)?,
        inside_m: or("inside", Bounds::Within(1e-6, 1.0), usual.inside_m)?,
        frequency_hz: or("frequency", Bounds::Within(0.01, 20.0), usual.frequency_hz)?,
        palpates_s,
        presses_s: or("presses", seconds, usual.presses_s)?,
        changes_s: table.number("changes", seconds)?,
    };
    table.finish()?;
    Ok(task)
}

impl ChannelFile {
    /// Reads a channel.
    ///
    /// # Errors
    /// A [`Diagnostic`] with line, key, value and remedy.
    pub fn read(path: &Path) -> Result<ChannelFile, Diagnostic> {
        ChannelFile::from_toml(&TomlFile::read(path)?)
    }

    /// A channel from a parsed file.
    ///
    /// # Errors
    /// As [`ChannelFile::read`].
    pub fn from_toml(file: &TomlFile) -> Result<ChannelFile, Diagnostic> {
        let root = file.root();
        root.understand(&["clock_offset", "there", "back", "waves"]);
        let way = |key: &str| -> Result<ChannelConfig, Diagnostic> {
            root.table(key)?
                .map_or(Ok(ChannelConfig::default()), |table| way(&table))
        };
        let offset_s = root.number("clock_offset", Bounds::Within(0.0, 1e6))?;
        let channels = [way("there")?, way("back")?];
        let waves = root
            .table("waves")?
            .map(|table| self::waves(&table))
            .transpose()?;
        root.finish()?;
        Ok(ChannelFile {
            channels,
            clock_offset_us: (offset_s.unwrap_or(0.0) * 1e6) as u64,
            waves,
        })
    }
}

fn shape(table: &Table<'_>) -> Result<Shape, Diagnostic> {
    table.understand(&["gain", "power", "reference"]);
    let usual = Shape::default();
    let or = |key: &str, bounds, usual: f64| -> Result<f64, Diagnostic> {
        Ok(table.number(key, bounds)?.unwrap_or(usual))
    };
    let shape = Shape {
        gain: or("gain", Bounds::Within(0.01, 10.0), usual.gain)?,
        power: or("power", Bounds::Within(0.0, 3.0), usual.power)?,
        reference_n_per_m: or(
            "reference",
            Bounds::Within(1.0, 1e6),
            usual.reference_n_per_m,
        )?,
    };
    table.finish()?;
    Ok(shape)
}

fn waves(table: &Table<'_>) -> Result<Waves, Diagnostic> {
    table.understand(&["impedance", "servo"]);
    let usual = Waves::default();
    let impedance = table.number("impedance", Bounds::Within(0.1, 1e4))?;
    let matched = match table.text("servo")? {
        None | Some("stiff") => false,
        Some("matched") => true,
        Some(_) => {
            return Err(table
                .wrong("servo", "an unknown servo of the slave")
                .remedy("write \"stiff\" or \"matched\""));
        }
    };
    table.finish()?;
    Ok(Waves {
        impedance_ns_per_m: impedance.unwrap_or(usual.impedance_ns_per_m),
        matched,
        ..usual
    })
}

fn way(table: &Table<'_>) -> Result<ChannelConfig, Diagnostic> {
    table.understand(&[
        "delay",
        "jitter",
        "distribution",
        "loss",
        "burst",
        "rate",
        "outage",
    ]);
    let usual = ChannelConfig::default();
    let or = |key: &str, bounds, usual: f64| -> Result<f64, Diagnostic> {
        Ok(table.number(key, bounds)?.unwrap_or(usual))
    };
    let distribution = match table.text("distribution")? {
        None | Some("uniform") => Jitter::Uniform,
        Some("gamma") => Jitter::Gamma,
        Some(_) => {
            return Err(table
                .wrong("distribution", "an unknown distribution of the delay")
                .remedy("write \"uniform\" or \"gamma\""));
        }
    };
    let outage_s = match table.numbers("outage", Bounds::NotNegative)?.as_deref() {
        None => None,
        Some([from, to]) if from < to => Some((*from, *to)),
        Some(_) => {
            return Err(table
                .wrong("outage", "not a time and a later one")
                .remedy("`outage` is two times in s, such as [8.0, 10.0]"));
        }
    };
    let channel = ChannelConfig {
        delay_s: or("delay", Bounds::Within(0.0, 100.0), usual.delay_s)?,
        jitter: or("jitter", Bounds::Within(0.0, 1.0), usual.jitter)?,
        distribution,
        loss: or("loss", Bounds::Within(0.0, 0.99), usual.loss)?,
        burst: or("burst", Bounds::Within(1.0, 1e4), usual.burst)?,
        bytes_per_s: or("rate", Bounds::Within(1.0, 1e12), usual.bytes_per_s)?,
        outage_s,
    };
    table.finish()?;
    Ok(channel)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> TomlFile {
        TomlFile::parse(text.into(), Path::new("o.toml")).unwrap()
    }

    fn operator(text: &str) -> Result<OperatorFile, Diagnostic> {
        OperatorFile::from_toml(&file(text), Path::new("o.toml"))
    }

    #[test]
    fn an_empty_file_is_the_built_in_operator_and_the_perfect_channel() {
        assert_eq!(operator("").unwrap().operator, Operator::default());
        let channel = ChannelFile::from_toml(&file("")).unwrap();
        assert_eq!(channel, ChannelFile::default());
    }

    #[test]
    fn grips_task_and_both_ways_are_read() {
        let read = operator(
            "excitation = 0.0\n[[grip]]\nstiffness = 400\n[[grip]]\nfrom = 8\nstiffness = 900\n\
             [task]\ninside = 0.01\npalpates = [3.0, 4.0]\n",
        )
        .unwrap();
        assert_eq!(read.operator.grips[1].stiffness_n_per_m, 900.0);
        assert_eq!(read.task.unwrap().palpates_s, (3.0, 4.0));
        assert_eq!(read.excitation, Some(None));
        let channel = ChannelFile::from_toml(&file(
            "clock_offset = 0.25\n[there]\ndelay = 0.1\n[back]\nloss = 0.2\ndistribution = \"gamma\"\n",
        ))
        .unwrap();
        assert_eq!(channel.channels[0].delay_s, 0.1);
        assert_eq!(channel.channels[1].loss, 0.2);
        assert_eq!(channel.clock_offset_us, 250_000);
    }

    #[test]
    fn every_key_that_the_help_shows_is_read() {
        let text = OPERATOR_KEYS.replace("motion = ", "# motion = ");
        let read = operator(&text).unwrap();
        assert_eq!(
            read.operator.force_limit_n,
            Operator::default().force_limit_n
        );
        assert_eq!(read.operator.grips, Operator::default().grips);
        assert_eq!(read.task.unwrap().changes_s, Some(6.0));
        assert_eq!(read.shape.unwrap().gain, 0.7);
        let read = ChannelFile::from_toml(&file(CHANNEL_KEYS)).unwrap();
        assert_eq!(read.channels[0].outage_s, Some((8.0, 10.0)));
        assert_eq!(read.waves, Some(Waves::default()));
    }

    #[test]
    fn what_cannot_be_used_is_named_with_line_key_and_remedy() {
        for (text, line, key) in [
            ("stifness = 3\n", Some(1), "stifness"),
            ("[[grip]]\nstiffness = -3\n", Some(2), "grip[1].stiffness"),
            ("[task]\npalpates = [1.0]\n", Some(2), "task.palpates"),
            (
                "[[grip]]\nfrom = 2\n[[grip]]\nfrom = 1\n",
                None,
                "grip[2].from",
            ),
        ] {
            let error = operator(text).unwrap_err();
            assert!(error.to_string().contains(key), "{error}");
            assert!(error.remedy.is_some(), "{error}");
            if line.is_some() {
                assert_eq!(error.line, line, "{error}");
            }
        }
        for text in [
            "[there]\nloss = 2\n",
            "[back]\noutage = [3, 1]\n",
            "[ther]\n",
        ] {
            let error = ChannelFile::from_toml(&file(text)).unwrap_err();
            assert!(error.remedy.is_some(), "{error}");
        }
    }
}
