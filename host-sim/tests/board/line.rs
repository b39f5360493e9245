//! The line between board and host: what it carries, what it loses, what it disturbs.

use crate::{HELD, device, world};
use estimator_core::board::frame::{Frame, MAX_ENCODED, encode};
use estimator_core::board::link::{BYTES_PER_MS, Command};
use estimator_core::board::settings::{Key, Settings};
use estimator_core::{State, step};
use palpate::link::port::Simulated;
use palpate::link::world::Hand;
use palpate::link::{Device, Port, SimulatedBoard};
use std::io;

/// WHEN everything goes out at every sample for an hour, over a line that drains as the board's does, THEN
/// nothing is lost and health comes every second.
#[test]
fn an_hour_at_a_kilohertz_goes_over_two_megabaud_without_a_loss() {
    const HOUR: u32 = 3_600_000;
    let mut device = device(&world(Hand::Palpating), BYTES_PER_MS);
    // The cheapest estimator: what is tested is the link.
    device.set(Key::EstimatorMethod, 1.0).unwrap();
    let (mut last_us, mut samples, mut estimates, mut last_dropped) = (None, 0_u32, 0_u32, None);
    let mut healths = Vec::new();
    while samples < HOUR {
        match device.next_frame().unwrap() {
            Some(Frame::Sample(sample)) => {
                assert_next(&mut last_us, sample.time_us);
                samples += 1;
            }
            Some(Frame::Estimate(_)) => estimates += 1,
            Some(Frame::Health(health)) => {
                last_dropped = Some(health.dropped);
                healths.push(health.samples);
            }
            Some(_) | None => {}
        }
    }
    let statistics = device.statistics();
    assert_eq!((statistics.lost, statistics.garbled), (0, 0));
    assert_eq!(last_dropped, Some(0));
    assert!(samples - estimates <= 1);
    assert!(healths.len() >= 3599, "{}", healths.len());
    assert!(healths.windows(2).all(|pair| pair[1] - pair[0] == 1000));
}

/// WHEN commands, packets and saves come between full telemetry, THEN health still comes every second,
/// nothing is dropped, and what was late has caught up.
#[test]
fn commands_and_saves_at_full_telemetry_cost_no_record_and_no_health() {
    let mut device = device(&world(HELD), BYTES_PER_MS);
    let (mut healths, mut samples, mut last_us) = (Vec::new(), 0_u32, None);
    while samples < 60_000 {
        // Twenty commands a second and a save every ten seconds, whose answers nobody waits for.
        if samples.is_multiple_of(50) {
            let command = match samples.is_multiple_of(10_000) {
                true => Command::Save,
                false => Command::Get(Key::ForcePerCode.id()),
            };
            let mut bytes = [0; MAX_ENCODED];
            let length = encode(&Frame::Command(command), samples as u16, &mut bytes);
            device.port().write(&bytes[..length]).unwrap();
        }
        match device.next_frame().unwrap() {
            Some(Frame::Sample(sample)) => {
                assert_next(&mut last_us, sample.time_us);
                samples += 1;
            }
            Some(Frame::Health(health)) => healths.push(health),
            Some(_) | None => {}
        }
    }
    assert!(healths.len() >= 59, "{}", healths.len());
    assert!(
        healths
            .windows(2)
            .all(|pair| pair[1].samples - pair[0].samples == 1000)
    );
    assert_eq!(healths.last().map(|health| health.dropped), Some(0));
    assert_eq!(device.statistics().lost, 0);
}

#[test]
fn what_a_slower_line_cannot_carry_is_missing_by_the_count_that_the_board_gives() {
    // 61 % of what a record takes at every sample: 68 bytes a millisecond for 111.
    let mut device = device(&world(Hand::Palpating), 68);
    let (mut received, mut missing, mut last_us) = (0_u32, 0_u64, 0);
    while received < 30_000 {
        if let Some(Frame::Sample(sample)) = device.next_frame().unwrap() {
            missing += (sample.time_us - last_us) / 1000 - 1;
            last_us = sample.time_us;
            received += 1;
        }
    }
    assert_eq!(device.statistics().lost, 0, "what was sent has come");
    let (samples, dropped) = device.port().board().counts();
    // Those that were taken but are still on their way: the queue and the line.
    let underway = i64::from(samples) - i64::from(received) - i64::from(dropped);
    assert!((0..=80).contains(&underway), "{underway}");
    let late = i64::from(dropped) - missing as i64;
    assert!(
        (0..=80).contains(&late),
        "{late}: dropped since the last that came"
    );
    assert!(dropped > 10_000, "{dropped}");
}

/// A port that disturbs some of its bytes.
struct Noisy {
    port: Simulated,
    random: u64,
    disturbed: u64,
}

impl Noisy {
    fn random(&mut self) -> u64 {
        // Knuth's MMIX generator.
        self.random = self
            .random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.random >> 33
    }
}

impl Port for Noisy {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.port.read(into)?;
        let mut kept = 0;
        for index in 0..count {
            let mut byte = into[index];
            // One byte in 2000 is flipped, lost, or doubled into garbage: one frame in forty.
            if self.random().is_multiple_of(2000) {
                self.disturbed += 1;
                match self.random() % 3 {
                    0 => byte ^= 1 << (self.random() % 8),
                    1 => byte = self.random() as u8,
                    _ => continue,
                }
            }
            into[kept] = byte;
            kept += 1;
        }
        Ok(kept)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.write(bytes)
    }
}

#[test]
fn no_disturbed_frame_is_taken_for_a_good_one_and_all_that_are_lost_are_counted() {
    // A second world with the same noise tells the good frames.
    let board = SimulatedBoard::new(world(Hand::Palpating), BYTES_PER_MS);
    let mut noisy = Device::new(Noisy {
        port: Simulated::at_once(board),
        random: 7,
        disturbed: 0,
    });
    let mut twin = device(&world(Hand::Palpating), BYTES_PER_MS);
    let mut expected = std::collections::HashMap::new();
    for _ in 0..400_000 {
        if let Some(Frame::Sample(sample)) = twin.next_frame().unwrap() {
            expected.insert(sample.time_us, sample);
        }
    }
    let (mut good, mut frames) = (0, 0);
    while frames < 200_000 {
        match noisy.next_frame().unwrap() {
            Some(Frame::Sample(sample)) => {
                assert_eq!(expected.get(&sample.time_us), Some(&sample));
                (good, frames) = (good + 1, frames + 1);
            }
            Some(_) => frames += 1,
            None => {}
        }
    }
    let statistics = noisy.statistics();
    let disturbed = noisy.port().disturbed;
    assert!(good > 60_000 && disturbed > 3_000, "{good} {disturbed}");
    // A disturbance spoils a frame, or two where it makes or takes a zero; two may hit the same.
    assert!(statistics.lost > disturbed / 2 && statistics.lost <= 2 * disturbed);
    assert!(statistics.garbled > disturbed / 2);
}

#[test]
fn what_the_board_estimated_is_what_the_host_estimates_from_the_same_samples() {
    let mut device = device(&world(Hand::Palpating), BYTES_PER_MS);
    let params = Settings::default().config().validate::<f32>().unwrap();
    let mut state = State::new(&params);
    let (mut sample, mut compared) = (None, 0);
    while compared < 5000 {
        match device.next_frame().unwrap() {
            Some(Frame::Sample(next)) => sample = Some(next),
            Some(Frame::Estimate(estimate)) => {
                let host = step(&params, &mut state, sample.take().unwrap());
                assert_eq!(host.parameters, estimate.parameters);
                assert_eq!(host.force_n.to_bits(), estimate.force_n.to_bits());
                compared += 1;
            }
            _ => {}
        }
    }
}

/// A sample comes a millisecond after the one before.
fn assert_next(last_us: &mut Option<u64>, time_us: u64) {
    let due_us = last_us.map_or(time_us, |last| last + 1000);
    assert_eq!(time_us, due_us);
    *last_us = Some(time_us);
}
