//! A proof by linking: the panic handler calls a function that does not exist, so this program
//! links only if the optimiser has shown that no panic can be reached from the sampling task as it
//! runs on the board (`sampling.rs`: read the sensors, convert, render, compensate, step, queue, count,
//! take over other settings), from making a setup of settings, from encoding the task's records, and
//! from taking commands apart. The feature `panic-control` adds a panic, and the link must fail;
//! `cargo xtask test` does both. The proof needs the release profile and a board: the emulator's sensors
//! are a file, and stop when it is broken. No logger is linked, so code that logs does not link either
//! (`proof.x`), a `defmt::panic!` included.
#![no_std]
#![no_main]
#![deny(missing_docs)]

use core::hint::black_box;
use core::panic::PanicInfo;
use cortex_m_rt::entry;
use estimator_core::board::budget::Budget;
use estimator_core::board::frame::{Decoder, Frame, MAX_ENCODED, encode};
use estimator_core::board::sampling::{PERIOD_US, Record, Sampler};
use estimator_core::board::settings::Settings;
use palpate_firmware::board::{Board, Selected};
use palpate_firmware::sampling::{Output, Sampling, Tick};

unsafe extern "C" {
    fn a_panic_path_is_left() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    // SAFETY: this never runs, since a program that calls it does not link.
    unsafe { a_panic_path_is_left() }
}

/// Refers to everything that the proof covers, with arguments, codes and settings of which the optimiser
/// knows nothing. It is linked and never run.
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

/// Runs the sampling task.
fn sample(sampling: &mut Sampling, output: &mut Output, budget: &mut Budget) {
    if let Tick::Sampled(sampled) = sampling.tick(output) {
        budget.count(&sampled, PERIOD_US, Selected::TICK);
        #[cfg(feature = "panic-control")]
        black_box([budget.ticks][budget.samples as usize]);
    }
    if sampling.change() {
        output.release();
    }
}

/// Encodes the frames of a record and of the board's health.
fn report(budget: &Budget, record: &Record) {
    send(&Frame::Health(budget.health()));
    record.for_each_frame(send);
}

fn send(frame: &Frame) {
    let mut bytes = [0; MAX_ENCODED];
    let length = encode(frame, black_box(0), &mut bytes);
    black_box((length, bytes));
}
