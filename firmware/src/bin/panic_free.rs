//! A proof by linking: the panic handler calls a function that does not exist, so this program
//! links only if the optimiser has shown that no panic can be reached from the sampling task
//! (the core's `sampling` and `budget`: convert, compensate, step, take over other settings, count,
//! queue), from making a setup of settings, from encoding what the task returns, and from taking
//! commands apart. With the feature `panic-control` there is one, and the link must fail;
//! `cargo xtask test` does both. Release profile only.
#![no_std]
#![no_main]
#![deny(missing_docs)]

use core::hint::black_box;
use core::panic::PanicInfo;
use cortex_m_rt::entry;
use estimator_core::budget::{Budget, Stations};
use estimator_core::frame::{Decoder, Frame, MAX_ENCODED, encode};
use estimator_core::link::{Change, Health};
use estimator_core::sampling::{Record, Sampler};
use estimator_core::sensing::Codes;
use estimator_core::settings::{Settings, Setup};
use heapless::spsc::Queue;
// For the interrupt vectors.
use stm32f4xx_hal as _;

unsafe extern "C" {
    fn a_panic_path_is_left() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    // SAFETY: never runs: what calls it does not link.
    unsafe { a_panic_path_is_left() }
}

/// Codes and settings that the optimiser knows nothing about.
#[entry]
fn main() -> ! {
    if let Ok(setup) = black_box(Settings::default()).setup() {
        forever(setup);
    }
    stop()
}

fn forever(setup: Setup) -> ! {
    let mut sampler = Sampler::new(setup);
    let mut budget = Budget::new();
    let mut queue: Queue<Record, 4> = Queue::new();
    let (mut outbox, mut inbox) = queue.split();
    let mut decoder = Decoder::new();
    loop {
        let codes = black_box(Codes::default());
        let sample = sampler.convert(&codes);
        let contact = sampler.compensate(sample);
        let estimate = sampler.step(contact);
        let record = Record {
            codes: Some(codes),
            sample,
            estimate,
        };
        let dropped = sampler.is_sent(&estimate) && outbox.enqueue(record).is_err();
        let [start, acquired, converted, compensated, stepped, queued] = black_box([0; 6]);
        let at = Stations {
            start,
            acquired,
            converted,
            compensated,
            stepped,
            queued,
        };
        budget.sample(&at, &sample, dropped, black_box(1000), black_box(1));
        if black_box(false) {
            let restart = black_box(true);
            sampler.apply(&Change { setup, restart });
        }
        let health = Health {
            samples: budget.samples,
            dropped: budget.dropped,
            overruns: budget.overruns,
            missed: budget.missed,
            period: budget.period.range(),
            task: budget.task.range(),
            ..Health::default()
        };
        black_box((budget.ticks, budget.finished));
        black_box((
            budget.convert.range(),
            budget.compensate.range(),
            budget.step.range(),
            budget.queue.range(),
        ));
        send(&Frame::Health(health));
        if let Some(record) = inbox.dequeue() {
            send(&Frame::Sample(record.sample));
            send(&Frame::Estimate(record.estimate));
            send(&Frame::Codes(record.codes.unwrap_or_default()));
        }
        black_box(decoder.push(black_box(0)));
    }
}

fn send(frame: &Frame) {
    let mut bytes = [0; MAX_ENCODED];
    let length = encode(frame, black_box(0), &mut bytes);
    black_box((length, bytes));
    #[cfg(feature = "panic-control")]
    black_box(bytes[black_box(length)]);
}

fn stop() -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}
