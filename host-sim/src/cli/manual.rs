//! `palpate completions` and `palpate man`: what shells and readers of manuals want.

use std::error::Error;
use std::path::PathBuf;

use clap::{Args, Command};
use clap_complete::Shell;

use crate::output::{say, try_folder};

/// Arguments of `palpate completions`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Example:\n  palpate completions bash > ~/.local/share/bash-completion/completions/palpate"
)]
pub struct CompletionsArgs {
    /// The shell.
    #[arg(value_enum)]
    pub shell: Shell,
}

/// Arguments of `palpate man`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Example:\n  palpate man --out ~/.local/share/man/man1")]
pub struct ManArgs {
    /// Folder for palpate.1 and a page for every verb; made if missing.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// Prints the completions of a command.
///
/// # Errors
/// What the system says about standard output.
pub fn completions(args: &CompletionsArgs, command: &mut Command) -> Result<(), Box<dyn Error>> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, command, "palpate", &mut text);
    say(String::from_utf8(text)?)?;
    Ok(())
}

/// Writes the manual pages of a command.
///
/// # Errors
/// What the file system says.
pub fn man(args: &ManArgs, command: Command) -> Result<(), Box<dyn Error>> {
    try_folder(&args.out)?;
    std::fs::create_dir_all(&args.out)?;
    clap_mangen::generate_to(command, &args.out)?;
    say(format!(
        "manual pages: {}\n",
        args.out.join("palpate.1").display()
    ))?;
    Ok(())
}
