//! Palpate on a motor controller: reads the load cell and the encoder at 1 kHz and identifies what
//! is being touched. Tasks only; what they do stands in the modules.
//!
//! The application commands no motion: it measures while something else (a hand, another
//! controller) moves the probe.
#![no_std]
#![no_main]
#![deny(missing_docs)]

mod board;
#[cfg(feature = "spi-sensors")]
mod driver;
mod halt;
mod service;
mod stack;
mod telemetry;

#[rtic::app(device = stm32f4xx_hal::pac, dispatchers = [CAN1_TX])]
mod app {
    use crate::board::{Acquired, Board, Outcome, Parts, RATE_HZ, Selected, Sensors};
    use crate::service::Service;
    use crate::telemetry::{QUEUE, Telemetry};
    use core::mem::MaybeUninit;
    use estimator_core::budget::{Budget, Stations};
    use estimator_core::link::Change;
    use estimator_core::sampling::{Record, Sampler};
    use heapless::spsc::{Consumer, Producer, Queue};

    const PERIOD_US: u64 = 1_000_000 / RATE_HZ as u64;

    #[shared]
    struct Shared {
        budget: Budget,
    }

    #[local]
    struct Local {
        sensors: <Selected as Board>::Sensors,
        sampler: &'static mut Sampler,
        outbox: Producer<'static, Record>,
        changes: Consumer<'static, Change>,
        inbox: Consumer<'static, Record>,
        telemetry: Telemetry<<Selected as Board>::Link, <Selected as Board>::Light>,
        service: Service<Selected>,
    }

    #[init(local = [
        records: Queue<Record, QUEUE> = Queue::new(),
        setups: Queue<Change, 2> = Queue::new(),
        // Made where it stays: 10 KiB that the stack need not hold twice.
        sampling: MaybeUninit<Sampler> = MaybeUninit::uninit(),
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
            clock_fallback,
        } = Selected::start(cx.core, cx.device);
        let (outbox, inbox) = cx.local.records.split();
        let (to_sampler, changes) = cx.local.setups.split();
        let service = Service::new(store, watchdog, to_sampler, clock_fallback);
        let Some(setup) = service.setup() else {
            defmt::panic!("the default settings are not valid");
        };
        (
            Shared {
                budget: Budget::new(),
            },
            Local {
                sensors,
                sampler: cx.local.sampling.write(Sampler::new(setup)),
                outbox,
                changes,
                inbox,
                telemetry: Telemetry::new(link, light),
                service,
            },
        )
    }

    /// 1 kHz, above everything else: read, convert, compensate, step, push.
    #[task(binds = DMA2_STREAM0, priority = 3, local = [sensors, sampler, outbox, changes], shared = [budget])]
    fn sample(mut cx: sample::Context) {
        let start = Selected::now();
        let sampler = &mut **cx.local.sampler;
        let (codes, sample, acquired) = match cx.local.sensors.sample() {
            Acquired::Codes(codes) => {
                let acquired = Selected::now();
                (Some(codes), sampler.convert(&codes), acquired)
            }
            Acquired::Sample(sample) => (None, sample, Selected::now()),
            Acquired::Nothing => return,
            Acquired::End => {
                cx.shared.budget.lock(|budget| budget.finished = true);
                let _ = telemetry::spawn();
                return;
            }
        };
        let converted = Selected::now();
        let contact = sampler.compensate(sample);
        let compensated = Selected::now();
        let estimate = sampler.step(contact);
        let stepped = Selected::now();
        let record = Record {
            codes,
            sample,
            estimate,
        };
        let dropped = sampler.is_sent(&estimate) && cx.local.outbox.enqueue(record).is_err();
        let at = Stations {
            start,
            acquired,
            converted,
            compensated,
            stepped,
            queued: Selected::now(),
        };
        cx.shared
            .budget
            .lock(|budget| budget.sample(&at, &sample, dropped, PERIOD_US, Selected::TICK));
        // After the sample, and after the stopwatch: a change comes once in a while.
        if let Some(change) = cx.local.changes.dequeue() {
            sampler.apply(&change);
        }
        // Already spawned is as good: it drains everything that it finds.
        let _ = telemetry::spawn();
    }

    /// Sends what has been queued and answers commands; says once a second how the board is.
    #[task(priority = 1, local = [inbox, telemetry, service], shared = [budget])]
    async fn telemetry(mut cx: telemetry::Context) {
        let (telemetry, service) = (cx.local.telemetry, cx.local.service);
        // Before draining: whatever was queued before the end is then still sent.
        let budget = cx.shared.budget.lock(|budget| *budget);
        while telemetry.has_room()
            && let Some(record) = cx.local.inbox.dequeue()
        {
            telemetry.send(&record);
        }
        service.answer(telemetry);
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
