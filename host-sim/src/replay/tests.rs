//! Faults of logs, recognised by the board's own code.

use estimator_core::estimate::method::Method;
use estimator_core::{Config, Fault};

use super::*;
use crate::log::Log;
use crate::motion::Motion;
use crate::plant::{GEL, PLASTIC, Rig, Stage};

const SEED: u64 = 9;

fn palpated(seed: u64) -> Log {
    let material = if seed.is_multiple_of(2) { GEL } else { PLASTIC };
    let motion = Motion::palpation(material.peak_depth_m);
    let run = Rig::default().run(&Stage::throughout(material.at(0.0)), &motion, seed);
    run.unwrap().log
}

/// When each fault began (s), in order.
fn faults(log: &Log) -> Vec<(Fault, f64)> {
    let config = Config {
        method: Method::KELVIN_VOIGT,
        ..Config::default()
    };
    let replay = replay(&log.uniform().unwrap(), &config).unwrap();
    let mut found = Vec::new();
    let mut before = Faults::NONE;
    for (index, record) in replay.records.iter().enumerate() {
        let new = record.faults.iter().filter(|fault| !before.has(*fault));
        found.extend(new.map(|fault| (fault, replay.raw_time_s(index))));
        before = record.faults;
    }
    found
}

/// The sample in which the probe presses fastest after half of the log.
fn fastest(log: &Log) -> usize {
    let speed = |at: &usize| log.position_m[at + 8] - log.position_m[at - 8];
    let later = log.len() / 2..log.len() - 100;
    let pressed = later.filter(|at| log.force_n[*at] > 1.0);
    pressed
        .max_by(|a, b| speed(a).total_cmp(&speed(b)))
        .unwrap()
}

#[test]
fn a_clean_palpation_has_no_fault() {
    for seed in 0..6 {
        assert_eq!(faults(&palpated(seed)), []);
    }
}

#[test]
fn each_fault_of_a_sensor_is_told_where_it_begins() {
    type Break = fn(&mut Log, usize);
    let table: [(&str, Fault, Break); 7] = [
        ("stuck converter, 20 ms", Fault::ForceStuck, |log, at| {
            let held = log.force_n[at];
            log.force_n[at..at + 20].fill(held);
        }),
        ("stuck encoder, 20 ms", Fault::PositionStuck, |log, at| {
            let held = log.position_m[at];
            log.position_m[at..at + 20].fill(held);
        }),
        (
            "a spike of 10 times the noise",
            Fault::ForceUnusable,
            |log, at| {
                log.force_n[at] = 0.5 * (log.force_n[at - 1] + log.force_n[at + 1]) + 0.2;
            },
        ),
        ("a spike of 500 N", Fault::ForceUnusable, |log, at| {
            log.force_n[at] += 500.0;
        }),
        ("a position off once", Fault::PositionJump, |log, at| {
            log.position_m[at] += 1e-4;
        }),
        ("fifty counts lost", Fault::PositionJump, |log, at| {
            let rest = &mut log.position_m[at..];
            rest.iter_mut().for_each(|x| *x += 5e-5);
        }),
        ("twenty rows lost", Fault::SampleMissed, |log, at| {
            log.time_s.drain(at..at + 20);
            log.position_m.drain(at..at + 20);
            log.force_n.drain(at..at + 20);
        }),
    ];
    for (what, fault, break_it) in table {
        for seed in 0..4 {
            let mut log = palpated(seed);
            let at = fastest(&log);
            let time_s = log.time_s[at];
            break_it(&mut log, at);
            let found = faults(&log);
            let told = found.iter().find(|(found, _)| *found == fault);
            let told_s = told
                .unwrap_or_else(|| panic!("{what}, seed {seed}: {found:?}"))
                .1;
            assert!(
                (told_s - time_s).abs() < 2.5e-3,
                "{what}: {told_s} for {time_s}"
            );
            // A stuck encoder jumps when it goes on, and nothing else is told.
            let others = found.iter().filter(|(found, _)| *found != fault);
            let jumps = others
                .clone()
                .all(|(found, _)| *found == Fault::PositionJump);
            assert!(jumps && others.count() <= 1, "{what}: {found:?}");
        }
    }
}

#[test]
fn the_end_of_the_range_is_saturation() {
    let mut log = palpated(SEED);
    let peak = crate::stats::highest(log.force_n.iter().copied());
    log.force_n.iter_mut().for_each(|f| *f = f.min(0.7 * peak));
    let found = faults(&log);
    assert!(!found.is_empty());
    assert!(
        found
            .iter()
            .all(|(fault, _)| *fault == Fault::ForceSaturated)
    );
}

#[test]
fn one_spike_changes_nothing_that_is_learned() {
    let clean = palpated(SEED);
    let mut spiked = clean.clone();
    let at = fastest(&clean);
    spiked.force_n[at] += 50.0;
    let stiffness = |log: &Log| {
        let replay = replay(&log.uniform().unwrap(), &Config::default()).unwrap();
        let last = *replay.last().unwrap();
        (last.parameters[0].unwrap(), last.status)
    };
    let ((with, status), (without, clean_status)) = (stiffness(&spiked), stiffness(&clean));
    assert_eq!(status, clean_status);
    let moved = (with.value - without.value).abs();
    assert!(moved < 0.3 * without.std_error, "{with:?} {without:?}");
}

#[test]
fn instants_that_the_resampling_invented_are_not_learned_from() {
    // GIVEN two neighbours lost in a press,
    let mut log = palpated(SEED);
    let at = fastest(&log);
    for channel in [&mut log.time_s, &mut log.position_m, &mut log.force_n] {
        channel.drain(at..at + 2);
    }
    let replay = replay(&log.uniform().unwrap(), &Config::default()).unwrap();
    // THEN learning pauses at the two records that describe them, and the filter runs on.
    let paused: Vec<bool> = (at..at + 30)
        .map(|index| replay.records.at(index).forgetting == 1.0)
        .collect();
    let expected: Vec<bool> = (at..at + 30)
        .map(|index| (at + 8..at + 10).contains(&index))
        .collect();
    let of_faults = |paused: &[bool]| paused.iter().filter(|p| **p).count();
    assert!(paused[8] && paused[9], "{paused:?}");
    assert_eq!(of_faults(&paused), of_faults(&expected), "{paused:?}");
    assert!(replay.records.at(at).faults.has(Fault::SampleMissed));
}

#[test]
fn a_motion_that_was_sampled_more_slowly_is_not_learned_from_and_is_no_fault() {
    // GIVEN a press of which every 8th sample was kept for 0.1 s,
    let mut log = palpated(SEED);
    let at = fastest(&log) - 50;
    let (from, to) = (at, at + 100);
    let kept = |index: usize| !(from..to).contains(&index) || (index - from).is_multiple_of(8);
    for channel in [&mut log.time_s, &mut log.position_m, &mut log.force_n] {
        let mut index = 0..;
        channel.retain(|_| index.next().is_some_and(kept));
    }
    let uniform = log.uniform().unwrap();
    assert_eq!(uniform.slower.len(), 1, "{:?}", uniform.notes);
    let replay = replay(&uniform, &Config::default()).unwrap();
    // THEN no record that describes it is learned from, in contact and in motion as it is.
    let described = |at: usize| at + replay.delay;
    for index in described(from)..described(to - 8) {
        let record = replay.records.at(index);
        assert_eq!(record.forgetting, 1.0, "{index}");
        assert!(!record.faults.has(Fault::SampleMissed), "{index}");
    }
    let mut around =
        (described(from) - 60..described(from)).chain(described(to)..described(to) + 60);
    assert!(around.any(|index| replay.records.at(index).forgetting < 1.0));
}
