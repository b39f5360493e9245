//! The arguments of `palpate teleop`.

use std::path::PathBuf;

use clap::Args;

use crate::teleop::SchemeId;
use crate::teleop::file::{CHANNEL_KEYS, OPERATOR_KEYS};

/// Arguments of `palpate teleop`.
#[derive(Args, Clone, Debug)]
#[command(
    about = "Teleoperate: what an operator feels of a material across delay and loss, by eight schemes",
    long_about = "Simulate a teleoperation: an operator moves a master, a slave touches a material, a channel \
                  with delay, jitter and loss lies in between. Measures what is felt against what there is to \
                  feel, and compares impedance reflection (the boards' own code) with seven other schemes.",
    after_help = help()
)]
pub struct TeleopArgs {
    /// How master and slave are coupled: position_position, position_force, four_channel,
    /// wave_variables, passivity, reflection, reflection_both, reflection_shaped.
    #[arg(long, value_name = "SCHEME", default_value = "reflection", value_parser = scheme,
          conflicts_with_all = ["slave", "master"])]
    pub scheme: SchemeId,
    /// Mean delay, one way (ms); of a bridge, what is put in between, on the way from slave to master.
    #[arg(long, value_name = "MS", value_parser = delay)]
    pub delay_ms: Option<f64>,
    /// How far the delay varies, as a share of it (0 to 1).
    #[arg(long, value_name = "SHARE", value_parser = jitter)]
    pub jitter: Option<f64>,
    /// Share of the messages that is lost (0 to 0.99).
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub loss: Option<f64>,
    /// What the slave touches (TOML, as simulate takes it); its surface is put to 0 m. A second one takes the
    /// place of the first when the hand has slid off. Without any: the chapter's gel, and then its plastic.
    #[arg(long, value_name = "FILE")]
    pub model: Vec<PathBuf>,
    /// Hand and task of the operator who moves the master (TOML).
    #[arg(long, value_name = "FILE")]
    pub operator: Option<PathBuf>,
    /// The channel (TOML); the flags above override it.
    #[arg(long, value_name = "FILE")]
    pub channel: Option<PathBuf>,
    /// All schemes over round trips of 0 to 5 s, jitter and loss, on four materials (or on --model). The table has
    /// schemes, delays, jitters, losses and seeds of its own; of --channel it takes the rest.
    #[arg(long, conflicts_with_all = ["scheme", "delay_ms", "jitter", "loss", "seed"])]
    pub compare: bool,
    /// Seeds per cell of the comparison, from 1 on.
    #[arg(long, value_name = "N", default_value_t = 2, requires = "compare", value_parser = clap::value_parser!(u64).range(1..=1000))]
    pub seeds: u64,
    /// Seed of noise and channel; one seed is one run.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Bridge: the port of the slave's board (serial, emulator's directory, or `simulated`).
    #[arg(long, value_name = "PORT", conflicts_with_all = ["compare", "model", "operator", "seeds"])]
    pub slave: Option<String>,
    /// Bridge: the port of the master's board.
    #[arg(long, value_name = "PORT", conflicts_with_all = ["compare", "model", "operator", "seeds"])]
    pub master: Option<String>,
    /// Bridge over a network: wait for the other end at this address (HOST:PORT, UDP).
    #[arg(
        long,
        value_name = "ADDR",
        requires = "key",
        conflicts_with = "connect"
    )]
    pub listen: Option<String>,
    /// Bridge over a network: the address of the end that listens.
    #[arg(long, value_name = "ADDR", requires = "key")]
    pub connect: Option<String>,
    /// Bridge over a network: the file of the key that both ends share, 64 hexadecimal digits that only
    /// its owner can read.
    #[arg(long, value_name = "FILE")]
    pub key: Option<PathBuf>,
    /// Bridge: end after this time (s).
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub seconds: Option<f64>,
    /// Where teleop.json and report.html go; of a bridge teleop.json, when it has ended.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  palpate teleop --delay-ms 150 --out run
  palpate teleop --scheme position_force --delay-ms 20 --out run
  palpate teleop --model gel.toml --model plastic.toml --out run
  palpate teleop --compare --seeds 2 --out table
  palpate teleop --slave simulated --master simulated --delay-ms 100
  palpate teleop --slave /dev/ttyUSB0 --master /dev/ttyUSB1
  palpate teleop --slave /dev/ttyUSB0 --listen 0.0.0.0:4700 --key bridge.key
  palpate teleop --master /dev/ttyUSB0 --connect 192.0.2.7:4700 --key bridge.key";

/// Examples, and every key of the two files.
fn help() -> String {
    let keys = |keys: &str| keys.replace('\n', "\n  ");
    format!(
        "{EXAMPLES}\n\nAn operator, in SI units (all keys optional, with what holds without them):\n  {}\n\nA \
         channel, in SI units (all keys optional; without a file it is perfect):\n  {}",
        keys(OPERATOR_KEYS),
        keys(CHANNEL_KEYS)
    )
}

fn scheme(text: &str) -> Result<SchemeId, String> {
    SchemeId::from_name(text).ok_or_else(|| {
        let names = SchemeId::ALL.map(SchemeId::name);
        format!("must be one of {}", names.join(", "))
    })
}

fn delay(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=60_000.0).contains(&value) => Ok(value),
        _ => Err("must be a delay from 0 to 60000 ms, such as 50".into()),
    }
}

fn jitter(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err("must be a share from 0 to 1, such as 0.3".into()),
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("must be a time greater than 0 s, such as 60".into()),
    }
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=0.99).contains(&value) => Ok(value),
        _ => Err("must be a share from 0 to 0.99, such as 0.05".into()),
    }
}
