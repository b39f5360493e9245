//! What a host and a board say to each other, beyond samples and estimates: commands, answers, and
//! the state of the board. The bytes are those of a frame's body ([`crate::board::frame`]).

mod wire;

use crate::board::{history::History, reflection::Packet, settings::Bounds, settings::Key};
use crate::estimate::fault::Faults;
use core::fmt;

/// A command to the board.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Command {
    /// 1: asks who is there. Answer: [`Answer::Identity`].
    Identify,
    /// 2: asks for the value of a setting, by number. Answer: [`Answer::Value`].
    Get(u8),
    /// 3: gives a setting a value, in force at once and kept until the power goes. Answer: [`Answer::Value`].
    Set(u8, f32),
    /// 4: keeps the settings through a power cut. Answer: [`Answer::Done`].
    Save,
    /// 5: goes back to what was saved. Answer: [`Answer::Done`].
    Reload,
    /// 6: goes back to the defaults, and saves nothing. Answer: [`Answer::Done`].
    Defaults,
    /// 7: forgets the estimates and settles anew, in contact as well. Answer: [`Answer::Done`].
    Restart,
    /// 8: forgets what was prepared. Answer: [`Answer::Done`].
    Discard,
    /// 9: prepares a value for a setting, which comes into force together with others at
    /// [`Command::Commit`]. Answer: [`Answer::Value`].
    Prepare(u8, f32),
    /// 10: puts what was prepared into force at once and as a whole, or not at all; kept until the
    /// power goes. Answer: [`Answer::Done`].
    Commit,
    /// 11: arms the force output, which a reset, a save, a restart and a fault disarm. Answer: [`Answer::Done`].
    Arm,
    /// 12: puts the force output to rest. Answer: [`Answer::Done`].
    Disarm,
    /// 13: asks what the first setting from a number on is. Answer: [`Answer::Description`].
    Describe(u8),
    /// Renders an impedance. The command has no number: it is the frame that the other board sends
    /// ([`crate::board::frame::Frame::Reflection`]). Answer: [`Answer::Done`].
    Reflect(Packet),
    /// A command with a number that this version does not know. Answer: [`Refusal::UnknownCommand`].
    Unknown(u8),
}

/// The board's answer to a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reply {
    /// Sequence number of the command.
    pub to: u16,
    /// The answer.
    pub answer: Answer,
}

/// What a board answers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Answer {
    /// 1: the board says who it is.
    Identity(Identity),
    /// 2: a setting and its value.
    Value(u8, f32),
    /// 3: the command is done.
    Done,
    /// 4: the command is refused; with the reason, and the number of the setting that it is about or 0.
    Refused(Refusal, u8),
    /// 5: what a setting is.
    Description(Description),
}

/// What a setting is, as the board knows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Description {
    /// Its number.
    pub id: u8,
    /// Its name.
    pub name: Text<48>,
    /// Its unit.
    pub unit: Text<12>,
    /// The values that it can have.
    pub bounds: Bounds,
    /// Its default.
    pub default: f32,
    /// Whether a change restarts the estimator.
    pub restarts: bool,
}

/// A board's name and versions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Identity {
    /// Name of the board.
    pub board: Name,
    /// Version of the firmware.
    pub firmware: Name,
    /// Layout of the board's settings: [`crate::board::settings::store::LAYOUT`].
    pub layout: u8,
    /// Samples per second (Hz).
    pub rate_hz: u16,
    /// The counts of [`Health`]'s meters between two samples: 84 000 counts on the F405, of 84 MHz.
    pub tick: u32,
    /// Whether the settings differ from what is saved.
    pub unsaved: bool,
}

/// The name of a board or a version: up to 12 bytes.
pub type Name = Text<12>;

/// Up to so many bytes of text; longer ones are cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Text<const N: usize>(pub(super) [u8; N]);

impl<const N: usize> Default for Text<N> {
    fn default() -> Self {
        Text([0; N])
    }
}

impl<const N: usize> Text<N> {
    /// A text; what does not fit, is not ASCII or is a space is left out.
    pub const fn new(text: &str) -> Self {
        Text::kept(text, false)
    }

    /// The same with its spaces.
    pub const fn spaced(text: &str) -> Self {
        Text::kept(text, true)
    }

    const fn kept(text: &str, spaces: bool) -> Self {
        let bytes = text.as_bytes();
        let mut name = [0; N];
        let (mut from, mut to) = (0, 0);
        while from < bytes.len() && to < name.len() {
            if bytes[from].is_ascii_graphic() || (spaces && bytes[from] == b' ') {
                name[to] = bytes[from];
                to += 1;
            }
            from += 1;
        }
        Text(name)
    }

    /// The text.
    pub fn as_str(&self) -> &str {
        let text = self.0.split(|byte| *byte == 0).next().unwrap_or(&[]);
        core::str::from_utf8(text).unwrap_or("?")
    }
}

impl<const N: usize> fmt::Display for Text<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// Why a command is refused. The numbers are stable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
#[non_exhaustive]
pub enum Refusal {
    /// No such command in this version.
    UnknownCommand = 1,
    /// No such setting in this version.
    UnknownSetting = 2,
    /// The value is outside the setting's bounds, or contradicts another setting.
    Unusable = 3,
    /// The probe is in contact: nothing that restarts the estimator or stalls the core.
    InContact = 4,
    /// The flash failed; the old settings are still there.
    FlashFailed = 5,
    /// The settings that are saved cannot be used.
    SavedUnusable = 6,
    /// The last change has not been taken over yet; ask again.
    Busy = 7,
    /// Nothing is rendered: the largest force is 0 N.
    NotRendering = 8,
    /// The impedance has a parameter that no material has.
    NotRenderable = 9,
    /// A later packet has overtaken this one.
    Overtaken = 10,
    /// The force output is not armed.
    NotArmed = 11,
}

impl Refusal {
    /// All of them, in the order of their numbers.
    pub const ALL: [Refusal; 11] = [
        Refusal::UnknownCommand,
        Refusal::UnknownSetting,
        Refusal::Unusable,
        Refusal::InContact,
        Refusal::FlashFailed,
        Refusal::SavedUnusable,
        Refusal::Busy,
        Refusal::NotRendering,
        Refusal::NotRenderable,
        Refusal::Overtaken,
        Refusal::NotArmed,
    ];

    /// A sentence for people.
    pub const fn describe(self) -> &'static str {
        match self {
            Refusal::UnknownCommand => "the board does not know this command",
            Refusal::UnknownSetting => "the board does not know this setting",
            Refusal::Unusable => "the board cannot use this value",
            Refusal::InContact => "the probe is in contact; lift it off first",
            Refusal::FlashFailed => "the flash failed, the old settings are still there",
            Refusal::SavedUnusable => "the saved settings cannot be used",
            Refusal::Busy => "the board is still taking over the last change; ask again",
            Refusal::NotRendering => "the board renders nothing: its largest force is 0 N",
            Refusal::NotRenderable => "the impedance has a parameter that no material has",
            Refusal::Overtaken => "a later packet has overtaken this one",
            Refusal::NotArmed => "the force output is not armed",
        }
    }
}

/// The least, the mean and the largest of a number that is measured at every sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Range {
    /// The least of all samples.
    pub min: u32,
    /// The mean of all samples.
    pub mean: u32,
    /// The largest of all samples.
    pub max: u32,
}

/// The state of a board, which it sends once a second. Counts are since start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Health {
    /// Time since start (µs).
    pub time_us: u64,
    /// Samples that went through the estimator.
    pub samples: u32,
    /// Samples that are in no frame, since the queue to the link was full.
    pub dropped: u32,
    /// Times that the sampling task took longer than a tick, or was started a tick late.
    pub overruns: u32,
    /// Instants without a sample.
    pub missed: u32,
    /// Frames to the board that could not be read.
    pub garbled: u32,
    /// The time between two starts of the sampling task, whose range is the jitter, in units of
    /// [`Identity::tick`].
    pub period: Range,
    /// The time of the estimator's step, in the same units.
    pub step: Range,
    /// The time of the whole sampling task, in the same units.
    pub task: Range,
    /// Bytes of stack that have never been used.
    pub stack_free: u32,
    /// The faults at this moment.
    pub faults: Faults,
    /// The setting that could not be used, if one is why the board runs on defaults.
    pub concerns: Option<Key>,
    /// Whether the clock is the internal oscillator: times are off by up to 1 % at 25 °C, by 4 % from −10 to 85 °C,
    /// and by 8 % from −40 to 105 °C.
    pub clock_fallback: bool,
    /// The time from the instant at which a sample was due to the end of its task, in the same units as the
    /// other ranges. This and what follows is zero on a board with an older firmware.
    pub response: Range,
    /// Whether the force output is armed and no fault holds it at rest.
    pub armed: bool,
    /// The faults since the last arming that hold the force output at rest.
    pub latched: Faults,
    /// Why the board started, and what ended the run before.
    pub history: History,
}
