//! What the board does besides sampling: answers commands, keeps the settings, says how it is.

use crate::board::{Board, ForceOutput, Link, RATE_HZ, Watchdog};
use crate::force::Force;
use crate::stack;
use crate::telemetry::Telemetry;
use embedded_hal::digital::OutputPin;
use estimator_core::board::budget::{Budget, Meter};
use estimator_core::estimate::Phase;
use estimator_core::board::frame::Frame;
use estimator_core::board::link::{Answer, Command};
use estimator_core::board::link::{Change, Health, Identity, Name, Range, Refusal, Reply, Responder};
use estimator_core::board::reflection::Packet;
use estimator_core::board::settings::Setup;
use estimator_core::board::settings::store::{LAYOUT, Store};
use heapless::spsc::Producer;
use rtic::Mutex;

/// A line of the log with all costs, every so many samples: 10 s.
const LOG_EVERY: u32 = 10 * RATE_HZ;

/// Settings, commands, health.
pub struct Service<B: Board> {
    responder: Responder<B::Flash>,
    watchdog: B::Watchdog,
    changes: Producer<'static, Change>,
    packets: Producer<'static, Packet>,
    clock_fallback: bool,
    reported: u32,
    logged: u32,
    fed: u32,
    overruns: u32,
}

impl<B: Board> Service<B> {
    /// Loads the settings.
    pub fn new(
        store: Store<B::Flash>,
        watchdog: B::Watchdog,
        changes: Producer<'static, Change>,
        packets: Producer<'static, Packet>,
        clock_fallback: bool,
    ) -> Self {
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
            changes,
            packets,
            clock_fallback,
            reported: 0,
            logged: 0,
            fed: 0,
            overruns: 0,
        }
    }

    /// What the sampling task starts with.
    pub fn setup(&self) -> Option<Setup> {
        self.responder.setup()
    }

    /// Answers the commands that have come, as long as there is room for answers. `output`: the force's,
    /// held at 0 N while a command is obeyed during which the core may stand still.
    pub fn answer<L: Link, P: OutputPin>(
        &mut self,
        telemetry: &mut Telemetry<L, P>,
        output: &mut impl Mutex<T = Force<B::Output>>,
    ) {
        while telemetry.has_room()
            && let Some(byte) = telemetry.receive()
        {
            if let Some((to, command)) = self.responder.push(byte) {
                self.obey(to, command, telemetry, output);
            }
        }
    }

    fn obey<L: Link, P: OutputPin>(
        &mut self,
        to: u16,
        command: Command,
        telemetry: &mut Telemetry<L, P>,
        output: &mut impl Mutex<T = Force<B::Output>>,
    ) {
        let in_contact = telemetry.phase() == Phase::Contact;
        let busy = !self.changes.is_empty();
        // An erase may take 4 s, during which nothing runs, and a force would stand.
        let stalls = command == Command::Save && !in_contact && !busy;
        if stalls {
            self.watchdog.feed();
            let rest = self.responder.settings().output();
            output.lock(|output| output.hold(rest.code(0.0, B::Output::FULL)));
        }
        let mut answered = self.responder.answer(to, command, in_contact, busy);
        if stalls {
            output.lock(Force::release);
        }
        if let Some(change) = answered.change
            && self.changes.enqueue(change).is_err()
        {
            // Not reached: the responder refuses while one is on its way.
            answered.reply = Reply {
                to,
                answer: Answer::Refused(Refusal::Busy, 0),
            };
        }
        if let Some(packet) = answered.packet
            && self.packets.enqueue(packet).is_err()
        {
            answered.reply.answer = Answer::Refused(Refusal::Busy, 0);
        }
        telemetry.send_frame(&Frame::Reply(answered.reply));
    }

    /// Feeds the watchdog while samples come in time; once a second says how the board is.
    pub fn report<L: Link, P: OutputPin>(
        &mut self,
        telemetry: &mut Telemetry<L, P>,
        budget: &Budget,
    ) {
        if budget.samples.wrapping_sub(self.fed) >= RATE_HZ / 10 {
            self.fed = budget.samples;
            // A task that is late again and again starves the watchdog: 100 samples, 100 overruns.
            if budget.overruns.wrapping_sub(self.overruns) < RATE_HZ / 10 {
                self.watchdog.feed();
            }
            self.overruns = budget.overruns;
        }
        let due = budget.samples.wrapping_sub(self.reported) >= RATE_HZ;
        if due && telemetry.has_room() {
            self.reported = budget.samples;
            telemetry.send_frame(&Frame::Health(self.health(telemetry, budget)));
        }
        if budget.samples.wrapping_sub(self.logged) >= LOG_EVERY {
            self.logged = budget.samples;
            Self::log(budget, &telemetry.encode);
        }
    }

    fn health<L: Link, P: OutputPin>(
        &self,
        telemetry: &Telemetry<L, P>,
        budget: &Budget,
    ) -> Health {
        Health {
            time_us: telemetry.time_us(),
            samples: budget.samples,
            dropped: budget.dropped,
            overruns: budget.overruns,
            missed: budget.missed,
            garbled: self.responder.garbled(),
            period: budget.period.range(),
            step: budget.step.range(),
            task: budget.task.range(),
            stack_free: stack::never_used(),
            faults: telemetry.faults(),
            concerns: self.responder.concerns(),
            clock_fallback: self.clock_fallback,
        }
    }

    /// Logs everything, as `key=value` (tests/src/emulator reads it) with min/mean/max.
    pub fn log(budget: &Budget, encode: &Meter) {
        let [
            period,
            convert,
            render,
            compensate,
            step,
            queue,
            task,
            encode,
        ] = [
            &budget.period,
            &budget.convert,
            &budget.render,
            &budget.compensate,
            &budget.step,
            &budget.queue,
            &budget.task,
            encode,
        ]
        .map(|meter| Shown(meter.range()));
        defmt::info!(
            "budget: unit={=str} samples={=u32} ticks={=u32} dropped={=u32} overruns={=u32} missed={=u32} stack_free={=u32} tick={=u32} period={} convert={} render={} compensate={} step={} queue={} task={} encode={}",
            B::COST_UNIT,
            budget.samples,
            budget.ticks,
            budget.dropped,
            budget.overruns,
            budget.missed,
            stack::never_used(),
            B::TICK,
            period,
            convert,
            render,
            compensate,
            step,
            queue,
            task,
            encode
        );
    }
}

/// min/mean/max in a log.
struct Shown(Range);

impl defmt::Format for Shown {
    fn format(&self, f: defmt::Formatter) {
        defmt::write!(f, "{}/{}/{}", self.0.min, self.0.mean, self.0.max)
    }
}
