//! A proof by linking: the panic handler calls a function that does not exist, so this program
//! links only if the optimiser has shown that no panic can be reached from the sampling task as it
//! runs on the board (`sampling.rs`: read the sensors, convert, render, compensate, step, queue, count,
//! take over other settings), from making a setup of settings, from encoding what the task returns, and
//! from taking commands apart. With the feature `panic-control` there is one, and the link must fail;
//! `cargo xtask test` does both. Release profile only, and for a board: the emulator's sensors are a
//! file, and stop when that is broken. There is no log either: what logs does not link (`proof.x`), a
//! `defmt::panic!` included.
#![no_std]
#![no_main]
#![deny(missing_docs)]

use core::hint::black_box;
use core::panic::PanicInfo;
use cortex_m_rt::entry;
use estimator_core::board::budget::Budget;
use estimator_core::board::frame::{Decoder, Frame, MAX_ENCODED, encode};
use estimator_core::board::link::Health;
use estimator_core::board::sampling::{Record, Sampler};
use estimator_core::board::settings::Settings;
use palpate_firmware::sampling::{Output, Sampling, Tick};

unsafe extern "C" {
    fn a_panic_path_is_left() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    // SAFETY: never runs: what calls it does not link.
    unsafe { a_panic_path_is_left() }
}

/// Nothing here is meant to run. What counts is that it links, for arguments, codes and settings of
/// which the optimiser knows nothing.
#[entry]
fn main() -> ! {
    black_box(sample as fn(&mut Sampling, &mut Output, &mut Budget));
    black_box(report as fn(&Budget, &Record));
    if let Ok(setup) = black_box(Settings::default()).setup() {
        black_box(Sampler::new(setup));
    }
    let mut decoder = Decoder::new();
    loop {
        black_box(decoder.push(black_box(0)));
    }
}

/// The sampling task.
fn sample(sampling: &mut Sampling, output: &mut Output, budget: &mut Budget) {
    if let Tick::Sampled(sampled) = sampling.tick(output) {
        sampled.count(budget);
        #[cfg(feature = "panic-control")]
        black_box([budget.ticks][budget.samples as usize]);
    }
    sampling.change();
}

/// What is sent of it.
fn report(budget: &Budget, record: &Record) {
    let health = Health {
        samples: budget.samples,
        dropped: budget.dropped,
        overruns: budget.overruns,
        missed: budget.missed,
        period: budget.period.range(),
        step: budget.step.range(),
        task: budget.task.range(),
        ..Health::default()
    };
    send(&Frame::Health(health));
    send(&Frame::Sample(record.sample));
    send(&Frame::Estimate(record.estimate));
    send(&Frame::Codes(record.codes.unwrap_or_default()));
    send(&Frame::Rendered(record.rendered.unwrap_or_default()));
    if let Some(packet) = record.packet() {
        send(&Frame::Reflection(packet));
    }
}

fn send(frame: &Frame) {
    let mut bytes = [0; MAX_ENCODED];
    let length = encode(frame, black_box(0), &mut bytes);
    black_box((length, bytes));
}
