//! The `palpate` command: arguments in, exit status out.

use std::error::Error;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};
use palpate::cli::{
    check, config, demo, effects, estimate, gap, manual, monitor, record, simulate, teleop,
};
use palpate::diagnostic::Diagnostic;
use palpate::wrap::wrapped;
use palpate::{interrupt, output};

/// Contact estimation: what a load cell and an encoder say about what they touch.
///
/// Without a verb it runs the demo: a simulated rig palpates the gel and the plastic of Biagiotti &
/// Melchiorri, and the estimator tells them apart.
#[derive(Parser)]
#[command(
    name = "palpate",
    version,
    about,
    long_about,
    arg_required_else_help = false
)]
struct Command {
    /// Write only the result to standard output, as JSON.
    #[arg(long, global = true)]
    json: bool,
    /// Print errors only.
    #[arg(long, short, global = true)]
    quiet: bool,
    #[command(subcommand)]
    verb: Option<Verb>,
}

#[derive(Subcommand)]
enum Verb {
    /// Run the board's estimator over logs and report what was touched
    Estimate(estimate::EstimateArgs),
    /// Find where a model and a log disagree, name the missing effect, add it, show the gap shrink
    Gap(gap::GapArgs),
    /// Run a model on the simulated rig and write what its sensors read
    Simulate(simulate::SimulateArgs),
    /// Teleoperate: what an operator feels of a material across delay and loss, by eight schemes
    Teleop(Box<teleop::TeleopArgs>),
    /// Say what is in a log: rate, gaps, units, noise, contacts, and what it is good for
    Check(check::CheckArgs),
    /// The catalogue of effects that a rig can hide, and what each does to an estimate
    Effects(effects::EffectsArgs),
    /// Record a board's samples into a file that survives a crash, and write them as a log
    Record(record::RecordArgs),
    /// Watch a board: what it touches, what is wrong, whether it keeps its deadlines
    Monitor(monitor::MonitorArgs),
    /// Read, change, save, back up and restore a board's settings; calibrate its sensors
    Config(config::ConfigArgs),
    /// Palpate gel and plastic on the simulated rig; also what `palpate` alone does
    Demo(demo::DemoArgs),
    /// Print the completions of the command for a shell
    Completions(manual::CompletionsArgs),
    /// Write the manual pages
    Man(manual::ManArgs),
}

impl Verb {
    /// Verbs whose answer is no result that a program would read.
    fn has_no_result(&self) -> bool {
        matches!(
            self,
            Verb::Record(_)
                | Verb::Monitor(_)
                | Verb::Config(_)
                | Verb::Completions(_)
                | Verb::Man(_)
                | Verb::Demo(_)
        )
    }
}

fn main() -> ExitCode {
    let command = Command::parse();
    output::speak(command.json, command.quiet);
    interrupt::catch();
    if command.json && command.verb.as_ref().is_none_or(Verb::has_no_result) {
        let refused = Diagnostic::new("this verb has no result to write as JSON");
        return fail(&refused.value("--json").remedy("leave --json out"));
    }
    let done = match &command.verb {
        Some(Verb::Estimate(args)) => estimate::run(args),
        Some(Verb::Gap(args)) => gap::run(args),
        Some(Verb::Check(args)) => check::run(args),
        Some(Verb::Simulate(args)) => simulate::run(args).map_err(|error| error as Box<dyn Error>),
        Some(Verb::Teleop(args)) => teleop::run(args),
        Some(Verb::Effects(args)) => effects::run(args),
        Some(Verb::Record(args)) => record::run(args),
        Some(Verb::Monitor(args)) => monitor::run(args),
        Some(Verb::Config(args)) => config::run(args),
        Some(Verb::Demo(args)) => demo::run(args),
        Some(Verb::Completions(args)) => manual::completions(args, &mut Command::command()),
        Some(Verb::Man(args)) => manual::man(args, Command::command()),
        None => demo::run(&demo::DemoArgs::default()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => fail(error.as_ref()),
    }
}

/// Bad input is 2, everything else that goes wrong 1.
fn fail(error: &(dyn Error + 'static)) -> ExitCode {
    let (text, code) = match error.is::<Diagnostic>() {
        true => (error.to_string(), ExitCode::from(2)),
        false => (wrapped("error: ", &error.to_string()), ExitCode::FAILURE),
    };
    output::complain(&text);
    code
}
