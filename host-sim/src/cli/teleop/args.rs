//! The arguments of `palpate teleop`.

use std::path::PathBuf;

use clap::Args;

use crate::teleop::SchemeId;

/// Arguments of `palpate teleop`.
#[derive(Args, Clone, Debug)]
#[command(
    about = "Teleoperate: what an operator feels of a material across delay and loss, by eight schemes",
    long_about = "Simulate a teleoperation: an operator moves a master, a slave touches a material, a channel \
                  with delay, jitter and loss lies in between. Measures what is felt against what there is to \
                  feel, and compares impedance reflection (the boards' own code) with seven other schemes.",
    after_help = "Examples:\n  palpate teleop --delay-ms 150 --out run\n  palpate teleop --scheme \
                  position_force --delay-ms 20 --out run\n  palpate teleop --compare --seeds 2 --out table\n  palpate \
                  teleop --slave /dev/ttyUSB0 --master /dev/ttyUSB1 --delay-ms 100\n  palpate teleop --slave \
                  /dev/ttyUSB0 --listen 0.0.0.0:4700 --key bridge.key\n  palpate teleop --master /dev/ttyUSB0 \
                  --connect 192.0.2.7:4700 --key bridge.key\n\n\
                  An operator, in SI units (all keys optional):\n  [[grip]]              # the hand, from a time on\n  \
                  from = 0.0            # s\n  mass = 0.35           # kg\n  damping = 9.0         # N s/m\n  \
                  stiffness = 700.0     # N/m\n  [task]\n  inside = 0.014        # m, intended depth\n\n\
                  A channel (all keys optional; [there] master to slave, [back] slave to master):\n  [there]\n  \
                  delay = 0.05          # s, one way\n  jitter = 0.3          # share of the delay\n  loss = 0.05           \
                  # share of the messages\n  burst = 4             # messages lost in a row, on average"
)]
pub struct TeleopArgs {
    /// How master and slave are coupled: position_position, position_force, four_channel,
    /// wave_variables, passivity, reflection, reflection_both, reflection_shaped.
    #[arg(long, value_name = "SCHEME", default_value = "reflection", value_parser = scheme)]
    pub scheme: SchemeId,
    /// Mean delay, one way (ms).
    #[arg(long, value_name = "MS", value_parser = delay)]
    pub delay_ms: Option<f64>,
    /// How far the delay varies, as a share of it (0 to 1).
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub jitter: Option<f64>,
    /// Share of the messages that is lost (0 to 0.99).
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub loss: Option<f64>,
    /// What the slave touches (TOML, as simulate takes it); its surface is put to 0 m. Without one: the
    /// chapter's gel, and from halfway its plastic.
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Hand and task of the operator who moves the master (TOML).
    #[arg(long, value_name = "FILE")]
    pub operator: Option<PathBuf>,
    /// The channel (TOML); the flags above override it.
    #[arg(long, value_name = "FILE")]
    pub channel: Option<PathBuf>,
    /// All schemes over round trips of 0 to 5 s, jitter and loss, on four materials (or on --model).
    #[arg(long)]
    pub compare: bool,
    /// Seeds per cell of the comparison.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u64).range(1..=1000))]
    pub seeds: u64,
    /// Seed of noise and channel; one seed is one run.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Bridge: the port of the slave's board (serial, emulator's directory, or `simulated`).
    #[arg(long, value_name = "PORT", conflicts_with_all = ["compare", "model", "operator"])]
    pub slave: Option<String>,
    /// Bridge: the port of the master's board.
    #[arg(long, value_name = "PORT", conflicts_with_all = ["compare", "model", "operator"])]
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
    #[arg(long, value_name = "S")]
    pub seconds: Option<f64>,
    /// Where teleop.json and report.html go.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
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

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=0.99).contains(&value) => Ok(value),
        _ => Err("must be a share from 0 to 0.99, such as 0.05".into()),
    }
}
