//! A proof by linking: the panic handler calls a function that does not exist, so this program
//! links only if the optimiser has shown that no panic can be reached from `step`, from building
//! its state, from a compensation before it, and from encoding what it returns. With the feature `panic-control` there is one,
//! and the link must fail; `cargo xtask test` does both. Release profile only.
#![no_std]
#![no_main]
#![deny(missing_docs)]

use core::hint::black_box;
use core::panic::PanicInfo;
use cortex_m_rt::entry;
use estimator_core::frame::{Frame, MAX_ENCODED, encode};
use estimator_core::rig::{Compensation, MOST_EFFECTS};
use estimator_core::{Config, Params, Sample, State, step};
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

/// Samples and settings that the optimiser knows nothing about.
#[entry]
fn main() -> ! {
    let effects = black_box([None; MOST_EFFECTS]);
    let compensation = Compensation::new(&effects, black_box(1000.0), black_box(1e-6));
    if let (Ok(params), Ok(compensation)) = (black_box(Config::default()).validate(), compensation)
    {
        forever(&params, &compensation);
    }
    stop()
}

fn forever(params: &Params<f32>, compensation: &Compensation<f32>) -> ! {
    let (mut state, mut memory) = (State::new(params), compensation.at_rest());
    loop {
        let sample = compensation.step(&mut memory, black_box(Sample::default()));
        let estimate = step(params, &mut state, sample);
        let mut bytes = [0; MAX_ENCODED];
        let length = encode(&Frame::Estimate(estimate), black_box(0), &mut bytes);
        black_box((length, bytes));
        #[cfg(feature = "panic-control")]
        black_box(bytes[black_box(length)]);
    }
}

fn stop() -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}
