//! What several stories need.

use estimator_core::board::link::Command;
use estimator_core::board::reflection::Packet;
use estimator_core::board::settings::Key;
use estimator_core::estimate::Estimated;
use estimator_core::{Config, Params, Sample, State, Status, step};
use f405::bench::Bench;
use f405::chip::{Part, UNITS_PER_SECOND};
use f405::elf::Image;
use f405::world::{Material, Motion, Press, Strokes};
use std::sync::Arc;

/// A board whose probe presses into a material again and again, from 0.8 s on.
pub(crate) fn pressing(image: Arc<Image>, part: Part, material: Material, seed: u64) -> Bench {
    let motion = Strokes::random(seed, 0.8, 1000.0, Strokes::depths(material));
    Bench::new(image, part, Box::new(Press::new(motion, material, seed)))
}

/// K, λ and n of the last estimate that had converged.
pub(crate) fn identified(bench: &Bench) -> Option<[f64; 3]> {
    let (_, last) = bench
        .estimates()
        .rev()
        .find(|(_, estimate)| estimate.status == Status::Converged)?;
    let mut values = [0.0; 3];
    for (value, slot) in values.iter_mut().zip(&last.parameters) {
        *value = f64::from((*slot)?.value);
    }
    Some(values)
}

/// Nothing happened that the model does not have.
pub(crate) fn within_the_model(bench: &Bench) {
    let trace = &bench.machine.chip.trace;
    assert!(
        trace.undefined.is_empty() && trace.unmapped.is_empty(),
        "the model lacks instructions {:x?} or addresses {:x?}",
        trace.undefined,
        trace.unmapped
    );
}

/// Seconds of units.
pub(crate) fn seconds(units: u64) -> f64 {
    units as f64 / UNITS_PER_SECOND as f64
}

/// The settings of a board that renders up to 10 N, full at 10 N, 0 N at nothing.
pub(crate) const RENDERING: [(Key, f32); 3] = [
    (Key::RenderDeviceNsPerM, 8.0),
    (Key::RenderTimeoutS, 0.1),
    (Key::RenderForceN, 10.0),
];

/// A packet with an estimate of K, λ, n and surface.
pub(crate) fn packet(sequence: u16, time_us: u64, values: [f32; 4]) -> Packet {
    let params: Params<f32> = Config::default().validate().expect("the default is valid");
    let mut estimate = step(&params, &mut State::new(&params), Sample::default());
    for (slot, value) in estimate.parameters.iter_mut().zip(values) {
        *slot = Some(Estimated {
            value,
            std_error: 0.01,
        });
    }
    estimate.time_us = time_us;
    Packet::of(&estimate, 1e-3, sequence)
}

/// A master's board: its handle is pushed 2.5 mm into what it renders.
pub(crate) struct Rendering {
    pub(crate) bench: Bench,
    sequence: u16,
}

impl Rendering {
    /// Renders gel, in the middle of its range.
    pub(crate) fn start(image: Arc<Image>, part: Part) -> Self {
        let motion = |t: f64| match t {
            ..0.5 => (-0.5e-3, 0.0),
            0.5..0.6 => (-0.5e-3 + (t - 0.5) * 30e-3, 30e-3),
            _ => (2.5e-3, 0.0),
        };
        Rendering::start_along(image, part, motion)
    }

    /// The same with the handle on another way.
    pub(crate) fn start_along(
        image: Arc<Image>,
        part: Part,
        motion: impl Motion + 'static,
    ) -> Self {
        // Nothing touches the master's load cell.
        let air = Material {
            stiffness: 0.0,
            damping: 0.0,
            exponent: 1.0,
        };
        let mut bench = Bench::new(image, part, Box::new(Press::new(motion, air, 5)));
        bench.run(0.3);
        bench.set(&RENDERING);
        bench.arm();
        let mut rendering = Rendering { bench, sequence: 0 };
        rendering.go_on(0.7);
        let share = rendering.bench.share();
        assert!((0.3..0.7).contains(&share), "a force is put out: {share}");
        rendering
    }

    /// Goes on for some time (s), with a packet every 10 ms.
    pub(crate) fn go_on(&mut self, seconds: f64) {
        for _ in 0..(seconds / 0.01).round() as u32 {
            self.sequence = self.sequence.wrapping_add(1);
            let now_us = (self.bench.machine.chip.seconds() * 1e6) as u64;
            // The board counts its positions from where it was switched on.
            let told = packet(self.sequence, now_us, [1350.0, 5.0, 1.35, 0.5e-3]);
            self.bench
                .host
                .send(&mut self.bench.machine, Command::Reflect(told));
            self.bench.run(0.01);
        }
    }

    /// Breaks the board, goes on for some time (s), and returns how long it took until the output rested for good.
    pub(crate) fn rest_after(&mut self, breaks: impl FnOnce(&mut Bench), seconds: f64) -> f64 {
        let from = self.bench.machine.chip.seconds();
        breaks(&mut self.bench);
        self.go_on(seconds);
        within_the_model(&self.bench);
        self.bench.time_to_rest(from, 0.0)
    }
}

/// The longest time until the output rests (s).
pub(crate) const REST_S: f64 = 2e-3;
