//! What was found on a rig is taken off what the board reads.

use crate::SAMPLES;
use crate::budget::{contains, within};
use crate::codes::FROM_CODES;
use crate::fields::{assert_same, estimate_fields, sample_fields};
use crate::frames::{codes, every_frame_is_numbered, measured_codes, records};
use crate::settings::{changed, save};
use estimator_core::board::frame::Frame;
use estimator_core::board::sampling::Sampler;
use estimator_core::board::sensing::Codes;
use estimator_core::board::settings::{Key, Settings};
use estimator_core::estimate::Event;
use std::sync::LazyLock;
use tests::emulator::{Budget, Emulator, Run};
use tests::signal::palpation;

/// One run with eight effects that are taken off, as many as a board can take off, each of another law. They
/// are small, so that what is left is still a palpation.
static COMPENSATED: LazyLock<(Settings, Vec<Codes>, Run, Budget)> = LazyLock::new(|| {
    let settings = changed(
        [
            ("coulomb_friction.force", 0.05),
            ("coulomb_friction.transition_speed", 5e-4),
            ("viscous_drag.coefficient", 0.5),
            ("tool_inertia.mass", 0.02),
            ("cogging.amplitude", 0.01),
            ("cogging.pitch", 2e-3),
            ("cogging.phase", 0.3),
            ("series_compliance.stiffness", 2e5),
            ("force_lag.time_constant", 1e-3),
            ("time_delay.delay", 1.3e-3),
            ("encoder_periodic_error.amplitude", 2e-6),
            ("encoder_periodic_error.pitch", 1e-3),
        ]
        .map(|(name, value)| {
            let key = Key::from_name(&format!("compensation.{name}"));
            (key.expect(name), value)
        }),
    );
    let mut codes = codes(&palpation(SAMPLES / 4, 5));
    codes[10_000].force_high = 4095;
    codes[15_000..]
        .iter_mut()
        .for_each(|c| c.position += 32 * 6000);
    codes.drain(20_000..20_250);
    let emulator = Emulator::from_env("compensated").expect("set-up");
    save(&emulator, &settings);
    let (run, budget) = measured_codes(&emulator, &codes);
    (settings, codes, run, budget)
});

#[test]
fn with_what_was_saved_taken_off_the_emulator_has_the_bits_of_the_host() {
    let (settings, codes, run, _) = &*COMPENSATED;
    let mut host = Sampler::new(settings.setup().expect("eight effects"));
    every_frame_is_numbered(&run.frames);
    let frames = records(&run.frames);
    assert_eq!(frames.len(), 3 * codes.len());
    let (mut contacts, mut taken_off) = (0, 0);
    for (index, (codes, frames)) in codes.iter().zip(frames.chunks(3)).enumerate() {
        let read = host.convert(codes);
        let contact = host.compensate(read);
        let estimate = host.step(contact);
        taken_off += usize::from((contact.force_n - read.force_n).abs() > 0.02);
        contacts += usize::from(estimate.event == Some(Event::Contact));
        let [
            Frame::Codes(_),
            Frame::Sample(input),
            Frame::Estimate(output),
        ] = frames
        else {
            panic!("sample {index}: not codes, sample and estimate: {frames:?}");
        };
        // The board sends what it read, so that it can be replayed with other settings.
        assert_same(index, &read, input, sample_fields);
        assert_same(index, &estimate, output, estimate_fields);
    }
    assert!(contacts > 10, "{contacts}");
    assert!(taken_off > codes.len() / 4, "{taken_off}");
}

#[test]
fn eight_effects_at_once_cost_what_the_budget_says() {
    let (_, _, _, budget) = &*COMPENSATED;
    within("compensate", &budget.compensate);
    contains("stack_free", budget.stack_free);
    // Without any effect to take off the stage costs next to nothing.
    contains("compensate.none", FROM_CODES.2.compensate.max);
}
