//! Palpate on a motor controller: reads the load cell and the encoder at 1 kHz and identifies what
//! is being touched. Tasks only; what they do stands in the modules.
//!
//! The application commands no motion: it measures while something else (a hand, another
//! controller) moves the probe.
#![no_std]
#![no_main]
#![deny(missing_docs)]

mod board;
mod budget;
mod convert;
mod halt;
mod telemetry;

#[rtic::app(device = stm32f4xx_hal::pac, dispatchers = [CAN1_TX])]
mod app {
    use crate::board::{Acquired, Board, Outcome, Selected, Sensors};
    use crate::budget::{Budget, isolated_step};
    use crate::convert;
    use crate::telemetry::{QUEUE, Record, Telemetry};
    use estimator_core::{Config, Params, State};
    use heapless::spsc::{Consumer, Producer, Queue};

    #[shared]
    struct Shared {
        budget: Budget,
    }

    #[local]
    struct Local {
        sensors: <Selected as Board>::Sensors,
        params: Params<f32>,
        state: State<f32>,
        outbox: Producer<'static, Record>,
        inbox: Consumer<'static, Record>,
        telemetry: Telemetry<<Selected as Board>::Link, <Selected as Board>::Light>,
    }

    #[init(local = [queue: Queue<Record, QUEUE> = Queue::new()])]
    fn init(cx: init::Context) -> (Shared, Local) {
        defmt::info!(
            "palpate {=str} on {=str}",
            env!("CARGO_PKG_VERSION"),
            Selected::NAME
        );
        let params = match Config::default().validate::<f32>() {
            Ok(params) => params,
            Err(error) => defmt::panic!("configuration: {}", defmt::Display2Format(&error)),
        };
        let state = State::new(&params);
        let (sensors, link, light) = Selected::start(cx.core, cx.device);
        let (outbox, inbox) = cx.local.queue.split();
        (
            Shared {
                budget: Budget::new(),
            },
            Local {
                sensors,
                params,
                state,
                outbox,
                inbox,
                telemetry: Telemetry::new(link, light),
            },
        )
    }

    /// 1 kHz, above everything else: read, convert, step, push.
    #[task(binds = DMA2_STREAM0, priority = 3, local = [sensors, params, state, outbox], shared = [budget])]
    fn sample(mut cx: sample::Context) {
        let start = Selected::now();
        let acquired = cx.local.sensors.sample();
        cx.shared.budget.lock(|budget| match acquired {
            Acquired::Sample(raw) => {
                budget.tick(start);
                let sample = convert::sample(&raw);
                let before = Selected::now();
                let estimate = isolated_step(cx.local.params, cx.local.state, sample);
                let after = Selected::now();
                let queued = cx.local.outbox.enqueue(Record { sample, estimate }).is_ok();
                budget.sample(before, after, queued);
                budget.end(start, Selected::now());
            }
            Acquired::Nothing => {}
            Acquired::End => budget.finished = true,
        });
        // Already spawned is as good: it drains everything that it finds.
        let _ = telemetry::spawn();
    }

    /// Sends what has been queued; logs the budget every 10 s.
    #[task(priority = 1, local = [inbox, telemetry, since_report: u32 = 0], shared = [budget])]
    async fn telemetry(mut cx: telemetry::Context) {
        // Before draining: whatever was queued before the end is then still sent.
        let finished = cx.shared.budget.lock(|budget| budget.finished);
        while cx.local.telemetry.has_room()
            && let Some(record) = cx.local.inbox.dequeue()
        {
            cx.local.telemetry.send(&record);
            *cx.local.since_report += 1;
        }
        cx.local.telemetry.poll();
        if finished {
            cx.local.telemetry.finish();
        }
        if finished || *cx.local.since_report >= 10_000 {
            *cx.local.since_report = 0;
            cx.shared.budget.lock(|budget| *budget).log();
        }
        if finished {
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
