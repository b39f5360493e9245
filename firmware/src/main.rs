//! Palpate on a motor controller: reads the load cell and the encoder at 1 kHz and identifies the mechanical
//! impedance of whatever the probe touches. This file has the tasks only; their work is in the modules.
//!
//! The application commands no motion: it measures while something else (a hand, another
//! controller) moves the probe. At the master of a teleoperation it renders the impedance that another
//! board has identified, as a force.
#![no_std]
#![no_main]
#![deny(missing_docs)]

mod halt;

// `TICK` and `SPARE` are the names of `board::device` for two interrupts of the selected board.
#[rtic::app(device = palpate_firmware::board::device, peripherals = false, dispatchers = [SPARE])]
mod app {
    use core::mem::MaybeUninit;
    use estimator_core::board::budget::Budget;
    use estimator_core::board::history::Stage;
    use estimator_core::board::link::Change;
    use estimator_core::board::reflection::Packet;
    use estimator_core::board::sampling::{PERIOD_US, QUEUE, Record, Sampler};
    use heapless::spsc::{Consumer, Queue};
    use palpate_firmware::board::{Board, Outcome, Parts, Selected, Sensors};
    use palpate_firmware::force::Force;
    use palpate_firmware::sampling::{CHANGES, Output, PACKETS, Sampling, Tick};
    use palpate_firmware::service::{Outlets, Service};
    use palpate_firmware::telemetry::Telemetry;
    use palpate_firmware::{crash, stack};

    #[shared]
    struct Shared {
        budget: Budget,
        output: Output,
    }

    #[local]
    struct Local {
        sampling: Sampling,
        inbox: Consumer<'static, Record>,
        telemetry: Telemetry<<Selected as Board>::Link, <Selected as Board>::Light>,
        service: Service<Selected>,
    }

    #[init(local = [
        records: Queue<Record, QUEUE> = Queue::new(),
        setups: Queue<Change, CHANGES> = Queue::new(),
        impedances: Queue<Packet, PACKETS> = Queue::new(),
        // The sampler is made where it stays: the stack need not hold its 10 KiB a second time.
        sampler: MaybeUninit<Sampler> = MaybeUninit::uninit(),
    ])]
    fn init(cx: init::Context) -> (Shared, Local) {
        defmt::info!(
            "palpate {=str} on {=str}",
            env!("CARGO_PKG_VERSION"),
            Selected::NAME
        );
        let Parts {
            sensors,
            link,
            light,
            store,
            watchdog,
            output,
            clock_fallback,
            reset,
        } = Selected::start(cx.core);
        let history = crash::found(reset);
        let (outbox, inbox) = cx.local.records.split();
        let (to_sampler, changes) = cx.local.setups.split();
        let (to_renderer, packets) = cx.local.impedances.split();
        let outlets = Outlets {
            changes: to_sampler,
            packets: to_renderer,
        };
        let service = Service::new(store, watchdog, outlets, history, clock_fallback);
        let Some(setup) = service.setup() else {
            defmt::panic!("the default settings are not valid");
        };
        let mut sampling = Sampling {
            sensors,
            sampler: cx.local.sampler.write(Sampler::new(setup)),
            outbox,
            changes,
            packets,
        };
        let telemetry = Telemetry::new(link, light);
        stack::never_used();
        // The last thing: nobody takes a tick before this function returns.
        sampling.sensors.start();
        (
            Shared {
                budget: Budget::new(),
                output: Force::new(output),
            },
            Local {
                sampling,
                inbox,
                telemetry,
                service,
            },
        )
    }

    /// Runs a tick at 1 kHz, above everything else: read, convert, render, compensate, step, queue.
    #[task(binds = TICK, priority = 3, local = [sampling], shared = [budget, output])]
    fn sample(mut cx: sample::Context) {
        let before = crash::mark(Stage::Read);
        let sampling = cx.local.sampling;
        let ticked = cx.shared.output.lock(|output| sampling.tick(output));
        crash::mark(Stage::Count);
        cx.shared.budget.lock(|budget| match &ticked {
            Tick::Sampled(sampled) => budget.count(sampled, PERIOD_US, Selected::TICK),
            Tick::Nothing => {}
            Tick::End => budget.finished = true,
        });
        if sampling.change() {
            cx.shared.output.lock(Force::release);
        }
        crash::mark(before);
        if !matches!(ticked, Tick::Nothing) {
            // An error says that the task is spawned already; it then sends this record as well.
            let _ = telemetry::spawn();
        }
    }

    /// Sends the queued records, answers commands, and reports the board's health once a second.
    #[task(priority = 1, local = [inbox, telemetry, service], shared = [budget, output])]
    async fn telemetry(mut cx: telemetry::Context) {
        crash::mark(Stage::Answer);
        let (telemetry, service) = (cx.local.telemetry, cx.local.service);
        // It is read before the queue is emptied: records from before the end are then still sent.
        let finished = cx.shared.budget.lock(|budget| budget.finished);
        // Answers and health go before the records: a line that these fill would have no room for them.
        service.answer(telemetry, &mut cx.shared.output, &mut cx.shared.budget);
        crash::mark(Stage::Send);
        service.report(telemetry, &mut cx.shared.budget);
        while telemetry.has_room_for_a_record()
            && let Some(record) = cx.local.inbox.peek()
        {
            telemetry.send(record);
            cx.local.inbox.dequeue();
        }
        telemetry.poll();
        crash::mark(Stage::Idle);
        if finished {
            telemetry.finish();
            let budget = cx.shared.budget.lock(|budget| *budget);
            Service::<Selected>::log(&budget, &telemetry.encode);
            Selected::stop(Outcome::Done);
        }
    }

    #[idle]
    fn idle(_: idle::Context) -> ! {
        loop {
            Selected::idle();
        }
    }
}
