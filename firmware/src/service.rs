//! The services of the board besides sampling: it answers commands, keeps the settings, and reports its
//! health.

use crate::board::{Board, ForceOutput, Link, Watchdog};
use crate::crash;
use crate::force::Force;
use crate::stack;
use crate::telemetry::Telemetry;
use embedded_hal::digital::OutputPin;
use estimator_core::board::{
    budget::Budget, budget::Meter, frame::Frame, history::History, history::Stage, link::Answer,
    link::Change, link::Command, link::Health, link::Identity, link::Name, link::Refusal,
    link::Reply, link::Responder, reflection::Packet, sampling::RATE_HZ, settings::Setup,
    settings::store::LAYOUT, settings::store::Store,
};
use estimator_core::estimate::Phase;
use heapless::spsc::Producer;
use rtic::Mutex;

/// Samples between two lines of the log with all costs: 10 s.
const LOG_EVERY: u32 = 10 * RATE_HZ;

/// The state of the services.
pub struct Service<B: Board> {
    responder: Responder<B::Flash>,
    watchdog: B::Watchdog,
    outlets: Outlets,
    history: History,
    clock_fallback: bool,
    /// Number of samples at the last health frame.
    reported: u32,
    /// Number of samples at the last line with all costs.
    logged: u32,
    /// Number of samples when the watchdog was last considered.
    fed: u32,
    /// Number of overruns at that time.
    overruns: u32,
}

/// The ways to the sampling task.
pub struct Outlets {
    /// Settings to take over.
    pub changes: Producer<'static, Change>,
    /// Impedances to render.
    pub packets: Producer<'static, Packet>,
}

impl<B: Board> Service<B> {
    /// Loads the settings; if they cannot be used, the log says so and the defaults count.
    pub fn new(
        store: Store<B::Flash>,
        watchdog: B::Watchdog,
        outlets: Outlets,
        history: History,
        clock_fallback: bool,
    ) -> Self {
        if let Some(crash) = &history.crash {
            defmt::warn!(
                "the last run ended: {=str} while {=str}, at {=u32:#x} from {=u32:#x}; reset: {=str}",
                crash.kind.describe(),
                crash.stage.describe(),
                crash.at,
                crash.from,
                history.reset.describe()
            );
        }
        let identity = Identity {
            board: const { Name::new(B::NAME) },
            firmware: const { Name::new(env!("CARGO_PKG_VERSION")) },
            layout: LAYOUT,
            rate_hz: RATE_HZ as u16,
            tick: B::TICK,
            unsaved: false,
        };
        let responder = Responder::new(store, identity);
        if let Some(key) = responder.concerns() {
            defmt::warn!(
                "saved {=str} cannot be used: running on defaults",
                key.info().name
            );
        }
        Service {
            responder,
            watchdog,
            outlets,
            history,
            clock_fallback,
            reported: 0,
            logged: 0,
            fed: 0,
            overruns: 0,
        }
    }

    /// Returns the setup with which the sampling task starts.
    pub fn setup(&self) -> Option<Setup> {
        self.responder.setup()
    }

    /// Answers the commands that have come, as long as there is room for answers. The force output is held
    /// at 0 N during a command in which the core may stand still.
    pub fn answer<L: Link, P: OutputPin>(
        &mut self,
        telemetry: &mut Telemetry<L, P>,
        output: &mut impl Mutex<T = Force<B::Output>>,
        budget: &mut impl Mutex<T = Budget>,
    ) {
        while telemetry.has_room()
            && let Some(byte) = telemetry.receive()
        {
            if let Some((to, command)) = self.responder.push(byte) {
                self.obey(to, command, telemetry, output, budget);
            }
        }
    }

    /// Obeys a command and sends the reply to the frame number `to`.
    fn obey<L: Link, P: OutputPin>(
        &mut self,
        to: u16,
        command: Command,
        telemetry: &mut Telemetry<L, P>,
        output: &mut impl Mutex<T = Force<B::Output>>,
        budget: &mut impl Mutex<T = Budget>,
    ) {
        let in_contact = budget.lock(|budget| budget.phase) == Phase::Contact;
        let busy = !self.outlets.changes.is_empty();
        // An erase may take 4 s, during which nothing runs.
        let stalls = command == Command::Save && !in_contact && !busy;
        if stalls {
            crash::mark(Stage::Save);
            self.watchdog.lengthen();
            let rest = self.responder.settings().output();
            output.lock(|output| output.hold(rest.code(0.0, B::Output::FULL)));
        }
        let mut answered = self.responder.answer(to, command, in_contact, busy);
        if stalls {
            crash::mark(Stage::Answer);
        }
        // The sampling task takes a change over and gives the output back; a save always makes one.
        if let Some(change) = answered.change
            && self.outlets.changes.enqueue(change).is_err()
        {
            // Not reached: the responder refuses a change while another one waits.
            answered.reply = Reply {
                to,
                answer: Answer::Refused(Refusal::Busy, 0),
            };
        }
        if let Some(packet) = answered.packet
            && self.outlets.packets.enqueue(packet).is_err()
        {
            answered.reply.answer = Answer::Refused(Refusal::Busy, 0);
        }
        telemetry.send_frame(&Frame::Reply(answered.reply));
    }

    /// Feeds the watchdog while samples come in time, switches the light, and reports the board's health once a
    /// second.
    pub fn report<L: Link, P: OutputPin>(
        &mut self,
        telemetry: &mut Telemetry<L, P>,
        budget: &mut impl Mutex<T = Budget>,
    ) {
        let (samples, overruns, latch, phase) =
            budget.lock(|budget| (budget.samples, budget.overruns, budget.latch, budget.phase));
        self.responder.heed(&latch);
        telemetry.show(phase, samples);
        if samples.wrapping_sub(self.fed) >= RATE_HZ / 10 {
            self.fed = samples;
            // The watchdog is not fed by a task that is always late: 100 overruns in 100 samples.
            if overruns.wrapping_sub(self.overruns) < RATE_HZ / 10 {
                self.watchdog.feed();
            }
            self.overruns = overruns;
        }
        let health_is_due = samples.wrapping_sub(self.reported) >= RATE_HZ && telemetry.has_room();
        let log_is_due = samples.wrapping_sub(self.logged) >= LOG_EVERY;
        if !health_is_due && !log_is_due {
            return;
        }
        // The meters are copied only for what shows them: 150 instructions.
        let budget = budget.lock(|budget| *budget);
        if health_is_due {
            self.reported = samples;
            telemetry.send_frame(&Frame::Health(self.health(telemetry, &budget)));
        }
        if log_is_due {
            self.logged = samples;
            Self::log(&budget, &telemetry.encode);
        }
    }

    /// Returns the health of the board.
    fn health<L: Link, P: OutputPin>(
        &self,
        telemetry: &Telemetry<L, P>,
        budget: &Budget,
    ) -> Health {
        Health {
            time_us: telemetry.time_us(),
            garbled: self.responder.garbled(),
            stack_free: stack::never_used(),
            faults: telemetry.faults(),
            concerns: self.responder.concerns(),
            clock_fallback: self.clock_fallback,
            history: self.history,
            ..budget.health()
        }
    }

    /// Logs counters and costs as `key=value`, with min/mean/max of every meter; the emulator's tests read
    /// the line.
    pub fn log(budget: &Budget, encode: &Meter) {
        defmt::info!(
            "budget: unit={=str} samples={=u32} ticks={=u32} dropped={=u32} overruns={=u32} missed={=u32} stack_free={=u32} tick={=u32} period={} convert={} render={} compensate={} step={} queue={} task={} response={} encode={}",
            B::COST_UNIT,
            budget.samples,
            budget.ticks,
            budget.dropped,
            budget.overruns,
            budget.missed,
            stack::never_used(),
            B::TICK,
            Shown(&budget.period),
            Shown(&budget.convert),
            Shown(&budget.render),
            Shown(&budget.compensate),
            Shown(&budget.step),
            Shown(&budget.queue),
            Shown(&budget.task),
            Shown(&budget.response),
            Shown(encode),
        );
    }
}

/// The range of a meter as min/mean/max in a log.
struct Shown<'a>(&'a Meter);

impl defmt::Format for Shown<'_> {
    fn format(&self, f: defmt::Formatter) {
        let range = self.0.range();
        defmt::write!(f, "{}/{}/{}", range.min, range.mean, range.max)
    }
}
