//! The instants of a period of the board's 32 kHz event: the PWM's edges, the hold of the ADC, the latch of the
//! encoder. Counts of 84 MHz, limits written down here once more.

// The firmware is a workspace of its own for another target; this file of it knows no hardware.
#[path = "../firmware/src/board/f405/duty.rs"]
#[allow(missing_docs, unreachable_pub)]
mod duty;

use duty::{CONVERT, HOLD, PERIOD, Pulse};

/// A microsecond.
const US: u16 = 84;

/// The edges of a code's pulse, in counts from the period's start.
fn edges(pulse: Pulse, at_end: bool, code: u16) -> [u16; 2] {
    match at_end {
        false => [0, pulse.edge(code)],
        true => [pulse.edge(code), PERIOD],
    }
}

/// WHEN the output goes from 5 to 95 % and back in any steps, THEN no edge comes within 1 µs of the instant at which
/// the ADC holds, and the pulse is as long as the code says.
#[test]
fn no_edge_of_the_output_comes_near_the_hold_and_every_pulse_has_its_length() {
    let (low, high) = (PERIOD / 20, PERIOD - PERIOD / 20);
    for step in [1, 7, 130, 900] {
        let up: Vec<u16> = (low..=high).step_by(step).collect();
        let down: Vec<u16> = up.iter().rev().copied().collect();
        let mut pulse = Pulse::default();
        let mut nearest = u16::MAX;
        for code in up.iter().chain(&down).copied() {
            let at_end = pulse.place(code);
            let [start, end] = edges(pulse, at_end, code);
            assert_eq!(end - start, code);
            nearest = edges(pulse, at_end, code)
                .into_iter()
                .map(|edge| edge.abs_diff(HOLD))
                .min()
                .unwrap_or(0)
                .min(nearest);
        }
        assert!(nearest > 2 * US, "{nearest} counts with steps of {step}");
    }
}

/// A code that moves by noise around the middle does not move its pulse to and fro: each move shows a wrong pulse.
#[test]
fn a_code_that_trembles_around_the_middle_leaves_its_pulse_where_it_is() {
    let mut pulse = Pulse::default();
    let middle = PERIOD / 2;
    let moves = (0..1000_u32)
        .map(|i| pulse.place(middle + (i * 7919 % 240) as u16 - 120))
        .collect::<Vec<_>>()
        .windows(2)
        .filter(|pair| pair[0] != pair[1])
        .count();
    assert_eq!(moves, 0);
    assert!(pulse.place(PERIOD) && !pulse.place(0));
}

/// The conversion is triggered so much earlier than the latch as the ADC samples: 480 of its cycles, of four counts
/// each, and at most 3 until it starts.
#[test]
fn force_and_position_are_of_the_same_instant_within_a_microsecond() {
    for latency_cycles in 0..=3 {
        let held = CONVERT + 4 * (480 + latency_cycles);
        assert!(held.abs_diff(HOLD) <= US, "{held}");
    }
    // Sampling and 12 cycles of conversion end within the period that begins with the trigger.
    const { assert!(4 * (3 + 480 + 12) < PERIOD) };
}
