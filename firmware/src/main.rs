//! Palpate on a motor controller: reads the load cell and the encoder at 1 kHz and identifies what
//! is being touched. Tasks only; what they do stands in the modules.
//!
//! The application commands no motion: it measures while something else (a hand, another
//! controller) moves the probe. At the master of a teleoperation it renders what another board has
//! identified, as a force.
#![no_std]
#![no_main]
#![deny(missing_docs)]

mod halt;

// Where the log goes.
#[cfg(feature = "f405")]
use defmt_rtt as _;
#[cfg(feature = "qemu")]
use defmt_semihosting as _;

#[rtic::app(device = stm32f4xx_hal::pac, dispatchers = [CAN1_TX])]
mod app {
    use core::mem::MaybeUninit;
    use estimator_core::board::budget::Budget;
    use estimator_core::board::link::Change;
    use estimator_core::board::reflection::Packet;
    use estimator_core::board::sampling::{Record, Sampler};
    use heapless::spsc::{Consumer, Queue};
    use palpate_firmware::board::{Board, Outcome, Parts, Selected};
    use palpate_firmware::force::Force;
    use palpate_firmware::sampling::{CHANGES, Output, PACKETS, Sampling, Tick};
    use palpate_firmware::service::Service;
    use palpate_firmware::telemetry::{QUEUE, Telemetry};

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
        // Made where it stays: 10 KiB that the stack need not hold twice.
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
        } = Selected::start(cx.core, cx.device);
        let (outbox, inbox) = cx.local.records.split();
        let (to_sampler, changes) = cx.local.setups.split();
        let (to_renderer, packets) = cx.local.impedances.split();
        let service = Service::new(store, watchdog, to_sampler, to_renderer, clock_fallback);
        let Some(setup) = service.setup() else {
            defmt::panic!("the default settings are not valid");
        };
        (
            Shared {
                budget: Budget::new(),
                output: Force::new(output),
            },
            Local {
                sampling: Sampling {
                    sensors,
                    sampler: cx.local.sampler.write(Sampler::new(setup)),
                    outbox,
                    changes,
                    packets,
                },
                inbox,
                telemetry: Telemetry::new(link, light),
                service,
            },
        )
    }

    /// 1 kHz, above everything else: read, convert, render, compensate, step, push.
    #[task(binds = DMA2_STREAM0, priority = 3, local = [sampling], shared = [budget, output])]
    fn sample(mut cx: sample::Context) {
        let sampling = cx.local.sampling;
        let ticked = cx.shared.output.lock(|output| sampling.tick(output));
        cx.shared.budget.lock(|budget| match &ticked {
            Tick::Sampled(sampled) => sampled.count(budget),
            Tick::Nothing => {}
            Tick::End => budget.finished = true,
        });
        sampling.change();
        // Already spawned is as good: it drains everything that it finds.
        let _ = telemetry::spawn();
    }

    /// Sends what has been queued and answers commands; says once a second how the board is.
    #[task(priority = 1, local = [inbox, telemetry, service], shared = [budget, output])]
    async fn telemetry(mut cx: telemetry::Context) {
        let (telemetry, service) = (cx.local.telemetry, cx.local.service);
        // Before draining: whatever was queued before the end is then still sent.
        let budget = cx.shared.budget.lock(|budget| *budget);
        // Before the records: on a line that they fill, there would never be room for an answer.
        service.answer(telemetry, &mut cx.shared.output);
        while telemetry.has_room()
            && let Some(record) = cx.local.inbox.dequeue()
        {
            telemetry.send(&record);
        }
        service.report(telemetry, &budget);
        telemetry.poll();
        if budget.finished {
            telemetry.finish();
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
