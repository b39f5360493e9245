//! The monitor on a terminal: keys in, pictures out.

use std::error::Error;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event as Input, KeyCode, KeyEventKind, KeyModifiers};

use super::args::MonitorArgs;
use super::scene::Scene;
use super::screen;
use super::source::{Source, silence};
use crate::interrupt;
use crate::link::device::SILENCE;

/// The longest time between two pictures: a silent board is seen as one.
const STILL: Duration = Duration::from_millis(300);
/// Where the instants that were marked during a recording stand, beside it.
const MARKS: &str = "marks.csv";

/// What a key asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Key {
    Pause,
    Mark,
    Record,
    Quit,
}

/// Watches until somebody quits, the source ends it, or so many looks are over.
pub(super) fn watch(source: Box<dyn Source>, args: &MonitorArgs) -> Result<(), Box<dyn Error>> {
    // A panic leaves the terminal as it was, too.
    let mut terminal = ratatui::try_init()?;
    let mut session = Session {
        scene: Scene::new(source.name()),
        source,
        args,
        folder: PathBuf::new(),
    };
    let watched = session.run(&mut terminal);
    ratatui::restore();
    session.end();
    if !session.scene.said.is_empty() {
        println!("{}", session.scene.said);
    }
    watched
}

struct Session<'a> {
    scene: Scene,
    source: Box<dyn Source>,
    args: &'a MonitorArgs,
    /// Where the recording that runs goes.
    folder: PathBuf,
}

impl Session<'_> {
    fn run(&mut self, terminal: &mut DefaultTerminal) -> Result<(), Box<dyn Error>> {
        let (mut looks, mut heard, mut drawn) = (0, Instant::now(), Instant::now());
        self.draw(terminal)?;
        while self.args.looks.is_none_or(|most| looks < most) && !interrupt::is_interrupted() {
            let frame = self.source.next_frame()?;
            let mut is_due = drawn.elapsed() > STILL;
            match frame {
                Some(frame) => {
                    heard = Instant::now();
                    if !self.scene.is_paused {
                        let every_us = (self.args.every * 1e6) as u64;
                        let look = self.scene.take(&frame, every_us);
                        looks += u64::from(look);
                        is_due |= look;
                    }
                }
                None if self.source.has_ended() => self.scene.has_ended = true,
                None if heard.elapsed() > SILENCE => {
                    return Err(silence(&self.source.statistics()).into());
                }
                None => {}
            }
            if !is_due {
                continue;
            }
            drawn = Instant::now();
            while let Some(key) = pressed()? {
                if key == Key::Quit {
                    return Ok(());
                }
                self.act(key);
            }
            self.draw(terminal)?;
        }
        Ok(())
    }

    fn draw(&mut self, terminal: &mut DefaultTerminal) -> std::io::Result<()> {
        let statistics = self.source.statistics();
        terminal.draw(|frame| screen::draw(frame, &self.scene, &statistics))?;
        Ok(())
    }

    fn act(&mut self, key: Key) {
        match key {
            Key::Pause => self.scene.is_paused = !self.scene.is_paused,
            Key::Mark => self.mark(),
            Key::Record if self.scene.recording.is_some() => self.end(),
            Key::Record => self.begin(),
            Key::Quit => {}
        }
    }

    fn mark(&mut self) {
        self.scene.mark();
        if self.scene.recording.is_none() {
            return;
        }
        let line = format!("{:.6},{}\n", self.scene.time_s, self.scene.marks);
        let path = self.folder.join(MARKS);
        let is_new = !path.exists();
        let file = OpenOptions::new().create(true).append(true).open(&path);
        let written = file.and_then(|mut file| {
            let head = if is_new { "t_s,mark\n" } else { "" };
            file.write_all(format!("{head}{line}").as_bytes())
        });
        if let Err(error) = written {
            self.scene.said = format!("cannot write {}: {error}", path.display());
        }
    }

    fn begin(&mut self) {
        let free = (1..).map(|number| self.args.out.join(format!("recording-{number}")));
        let folder = free.into_iter().find(|folder| !folder.exists());
        self.folder = folder.unwrap_or_default();
        match self.source.begin_recording(&self.folder) {
            Ok(note) => {
                self.scene.said = note.unwrap_or_default();
                let to = self.folder.display().to_string();
                self.scene.recording = Some((self.scene.time_s, to));
            }
            Err(error) => self.scene.said = format!("no recording: {error}"),
        }
    }

    fn end(&mut self) {
        if self.scene.recording.take().is_none() {
            return;
        }
        self.scene.said = match self.source.end_recording() {
            Ok(said) => said.trim_end().replace('\n', "; "),
            Err(error) => format!("the recording is in {}: {error}", self.folder.display()),
        };
    }
}

/// A key that asks for something, if one has been pressed.
fn pressed() -> std::io::Result<Option<Key>> {
    while event::poll(Duration::ZERO)? {
        let Input::Key(key) = event::read()? else {
            continue;
        };
        let control = key.modifiers.contains(KeyModifiers::CONTROL);
        let key = match key.code {
            _ if key.kind != KeyEventKind::Press => None,
            KeyCode::Char('c') if control => Some(Key::Quit),
            KeyCode::Char('q') | KeyCode::Esc => Some(Key::Quit),
            KeyCode::Char('p' | ' ') => Some(Key::Pause),
            KeyCode::Char('m') => Some(Key::Mark),
            KeyCode::Char('r') => Some(Key::Record),
            _ => None,
        };
        if key.is_some() {
            return Ok(key);
        }
    }
    Ok(None)
}
