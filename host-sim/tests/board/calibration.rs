//! Calibration with weights and a known travel.

use crate::{HELD, Shared, device, world};
use estimator_core::Fault;
use estimator_core::board::frame::Frame;
use estimator_core::board::link::BYTES_PER_MS;
use estimator_core::board::settings::{Key, Settings};
use palpate::cli::config::calibrate::{self, CalibrateArgs, Person};
use palpate::link::world::Hand;
use std::io;
use std::sync::Arc;

/// A person who lays weights on in the simulated world when the command asks for it.
struct Helper {
    world: Shared,
    said: String,
    asked: usize,
    gravity: f64,
    /// The force that stays on the cell after the first weight (N).
    creep_n: f64,
    answer: &'static str,
}

impl Helper {
    fn new(world: &Shared) -> Self {
        Helper {
            world: Arc::clone(world),
            said: String::new(),
            asked: 0,
            gravity: 9.80665,
            creep_n: 0.0,
            answer: "y",
        }
    }
}

impl Person for Helper {
    fn asked(&mut self, request: &str) -> io::Result<String> {
        self.said.push_str(request);
        let number = |unit: &str| -> f64 {
            let words: Vec<&str> = request.split([' ', '\u{a0}']).collect();
            let at = words.iter().position(|word| *word == unit).unwrap();
            words[at - 1].parse().unwrap()
        };
        let mut world = self.world.lock().unwrap();
        let Hand::Holding {
            position_m,
            force_n,
        } = &mut world.hand
        else {
            panic!("the hand should hold still");
        };
        if request.contains(" kg ") {
            *force_n = number("kg") * self.gravity + self.creep_n;
        } else if request.contains("every weight") {
            *force_n = if self.asked > 0 { self.creep_n } else { 0.0 };
        } else if request.contains("Move it") {
            *position_m += number("mm") * 1e-3;
        }
        self.asked += 1;
        Ok(self.answer.into())
    }

    fn told(&mut self, text: &str) -> io::Result<()> {
        self.said.push_str(text);
        Ok(())
    }
}

fn arguments(weights: &[f64]) -> CalibrateArgs {
    CalibrateArgs {
        weights: weights.to_vec(),
        pulling: false,
        gravity: 9.80665,
        travel: None,
        yes: false,
    }
}

#[test]
fn a_calibration_finds_the_cell_and_the_encoder_and_the_fault_is_over() {
    // GIVEN a cell that is 3 % off its data sheet, and an encoder that counts down
    let world = world(HELD);
    world.lock().unwrap().m_per_code = -5e-8;
    let mut device = device(&world, BYTES_PER_MS);
    // WHEN four weights are laid on and the probe is moved by 10 mm
    let mut helper = Helper::new(&world);
    let args = CalibrateArgs {
        travel: Some(10.0),
        ..arguments(&[0.0, 0.5, 1.0, 2.0])
    };
    let said = calibrate::run(&mut device, &args, &mut helper).unwrap();
    // THEN scale and zero are found: 12 codes of noise over 1000 samples are 0.4 codes, of 25 000
    assert!(said.contains("saved"), "{said}");
    assert!(helper.said.contains("good: "), "{}", helper.said);
    assert!(helper.said.contains("zero stays"), "{}", helper.said);
    let settings = device.settings().unwrap();
    let truth = world.lock().unwrap().clone();
    let scale = f64::from(settings.get(Key::ForcePerCode)) / truth.n_per_code;
    assert!((scale - 1.0).abs() < 1e-4, "{scale}");
    assert!((f64::from(settings.get(Key::ForceZeroCode)) - truth.zero_code).abs() < 2.0);
    let counted = f64::from(settings.get(Key::PositionPerCode)) / truth.m_per_code;
    assert!((counted - 1.0).abs() < 1e-5, "{counted}");
    assert!(!device.identity().unwrap().unsaved);
    // and the board measures what lies on it, and is calibrated
    world.lock().unwrap().hand = Hand::Holding {
        position_m: 0.0,
        force_n: 7.5,
    };
    let mut forces = Vec::new();
    while forces.len() < 600 {
        if let Some(Frame::Sample(sample)) = device.next_frame().unwrap() {
            assert!(!sample.faults.has(Fault::NotCalibrated));
            forces.push(f64::from(sample.force_n));
        }
    }
    let late = &forces[100..];
    let mean = late.iter().sum::<f64>() / late.len() as f64;
    assert!((mean - 7.5).abs() < 2e-3, "{mean}");
}

#[test]
fn a_bent_cell_and_a_creeping_zero_are_told() {
    for (bend_codes, creep_n, expected) in [
        (1500.0, 0.0, "usable: "),
        (9000.0, 0.0, "poor: "),
        (0.0, 0.3, "zero drifts"),
    ] {
        let world = world(HELD);
        world.lock().unwrap().bend_codes = bend_codes;
        let mut device = device(&world, BYTES_PER_MS);
        let mut helper = Helper::new(&world);
        helper.creep_n = creep_n;
        helper.answer = "n";
        let weights = arguments(&[0.0, 0.5, 1.0, 1.5, 2.0]);
        let said = calibrate::run(&mut device, &weights, &mut helper).unwrap();
        assert!(helper.said.contains(expected), "{}", helper.said);
        // Declined: nothing has changed.
        assert_eq!(said, "nothing changed\n");
        assert_eq!(device.settings().unwrap(), Settings::default());
    }
}

#[test]
fn a_zero_that_has_crept_does_not_keep_the_calibration_from_the_board() {
    // GIVEN 50 mN that stay on the cell, 5 times its noise: contact, as far as the board can tell
    let world = world(HELD);
    let mut device = device(&world, BYTES_PER_MS);
    let mut helper = Helper::new(&world);
    helper.creep_n = 0.05;
    // WHEN the calibration is accepted
    let weights = arguments(&[0.0, 0.5, 1.0, 2.0]);
    let said = calibrate::run(&mut device, &weights, &mut helper).unwrap();
    // THEN it is in the board, with the zero as it is now
    assert!(said.contains("saved"), "{said}");
    let settings = device.settings().unwrap();
    let truth = world.lock().unwrap().clone();
    let crept = truth.zero_code + helper.creep_n / truth.n_per_code;
    assert!((f64::from(settings.get(Key::ForceZeroCode)) - crept).abs() < 2.0);
}

#[test]
fn two_weights_are_said_to_be_unchecked_and_no_weights_are_refused() {
    let world = world(HELD);
    let mut device = device(&world, BYTES_PER_MS);
    let mut helper = Helper::new(&world);
    calibrate::run(&mut device, &arguments(&[0.0, 1.0]), &mut helper).unwrap();
    assert!(helper.said.contains("unchecked"), "{}", helper.said);
    for (weights, expected) in [
        (&[][..], "nothing to calibrate"),
        (&[1.0][..], "too few"),
        (&[1.0, 1.0][..], "the same"),
        (&[0.0, -1.0][..], "this is not a weight"),
    ] {
        let error = calibrate::run(&mut device, &arguments(weights), &mut helper).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
}
