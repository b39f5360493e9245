//! `palpate monitor`: a board, the emulator or a replayed log, watched by a person.

mod args;
#[cfg(feature = "foxglove")]
mod foxglove;
mod scene;
mod screen;
mod source;
mod terminal;
mod view;

use std::error::Error;
use std::io::{self, IsTerminal};
use std::time::Instant;

pub use args::MonitorArgs;

use crate::diagnostic::Diagnostic;
use crate::interrupt;
use crate::kind;
use crate::link::{Device, Port, device::SILENCE, port};
use crate::output::say;
use source::{Board, Replayed, Source, silence};
use view::View;

/// Runs the verb.
///
/// # Errors
/// A port that is not there or falls silent, or a log that cannot be read.
pub fn run(args: &MonitorArgs) -> Result<(), Box<dyn Error>> {
    let source: Box<dyn Source> = match (&args.port, &args.log) {
        (Some(name), _) => {
            let kind = args.kind.unwrap_or_default();
            Box::new(Board::new(name, kind, Device::new(port::open(name)?)))
        }
        (None, Some(log)) => Box::new(Replayed::read(log, args.speed)?),
        (None, None) => {
            return Err(Diagnostic::new("nothing to watch")
                .remedy("give --port or --log")
                .into());
        }
    };
    interrupt::watch();
    #[cfg(feature = "foxglove")]
    let source: Box<dyn Source> = match &args.foxglove {
        Some(address) => Box::new(foxglove::Served::new(source, address)?),
        None => source,
    };
    kind::worded(source.kind(), || {
        match io::stdout().is_terminal() && !args.plain {
            true => terminal::watch(source, args),
            false => lines(source, args, say),
        }
    })
}

/// Looks as often as asked, by the board's own time, and says what it sees, a line each.
///
/// # Errors
/// What the port or `show` says, or silence.
pub fn watch<P: Port>(
    device: Device<P>,
    args: &MonitorArgs,
    show: impl FnMut(String) -> io::Result<()>,
) -> Result<(), Box<dyn Error>> {
    let kind = args.kind.unwrap_or_default();
    let board = Box::new(Board::new("board", kind, device));
    kind::worded(kind, || lines(board, args, show))
}

fn lines(
    mut source: Box<dyn Source + '_>,
    args: &MonitorArgs,
    mut show: impl FnMut(String) -> io::Result<()>,
) -> Result<(), Box<dyn Error>> {
    let mut view = View::default();
    let (mut looks, mut heard) = (0, Instant::now());
    while args.looks.is_none_or(|most| looks < most) && !interrupt::is_interrupted() {
        let Some(frame) = source.next_frame()? else {
            if source.has_ended() {
                break;
            }
            if heard.elapsed() > SILENCE {
                return Err(silence(&source.statistics()).into());
            }
            continue;
        };
        heard = Instant::now();
        if view.take(&frame, (args.every * 1e6) as u64) {
            looks += 1;
            show(view.line(&source.statistics()))?;
        }
    }
    Ok(())
}
