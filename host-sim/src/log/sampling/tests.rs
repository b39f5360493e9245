//! Logs with known faults of their sampling.

use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, Normal};

use super::*;

const SEED: u64 = 13;

/// A press of 2 mm at 1 Hz on 3 N/mm with 10 mN of noise, sampled at some instants and stamped with others.
fn log(taken_s: &[f64], stamped_s: Vec<f64>) -> Log {
    let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED);
    let noise = Normal::new(0.0, 0.01).unwrap();
    let way = |t: &f64| 1e-3 * (1.0 - (std::f64::consts::TAU * t).cos());
    let position: Vec<f64> = taken_s.iter().map(way).collect();
    let force = position.iter().map(|x| 3000.0 * x + noise.sample(&mut rng));
    let (force, steps) = (
        force.collect(),
        position.iter().map(|x| (x * 1e6).round() * 1e-6),
    );
    Log::from_channels(stamped_s, steps.collect(), force)
}

fn even(count: u32) -> Vec<f64> {
    (0..count).map(|i| f64::from(i) * 1e-3).collect()
}

fn scattered(stamps: &[f64], sigma_s: f64) -> Vec<f64> {
    let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED + 1);
    let jitter = Normal::new(0.0, sigma_s).unwrap();
    let mut scattered: Vec<f64> = stamps.iter().map(|t| t + jitter.sample(&mut rng)).collect();
    scattered.sort_unstable_by(f64::total_cmp);
    scattered
}

#[test]
fn an_even_log_is_even_and_its_stamps_have_the_resolution_of_their_period() {
    let facts = log(&even(4000), even(4000)).sampling();
    assert_eq!((facts.stamps, facts.rate_hz), (Stamps::Even, 1000.0));
    assert_eq!(facts.resolution_s, Some(1e-3));
    assert_eq!(facts.drops, Drops::default());
    assert_eq!(facts.segments, [(0.0, 3.999)]);
    assert!(facts.slower.is_empty() && facts.jitter_s < 1e-12);
}

#[test]
fn force_and_position_tell_whether_the_stamps_or_the_instants_scatter() {
    for sigma_s in [2e-5, 6e-5, 2e-4] {
        let scattered = scattered(&even(4000), sigma_s);
        // WHEN only the stamps scatter, THEN the line takes their place, and every sample stays.
        let stamped = log(&even(4000), scattered.clone());
        let facts = stamped.sampling();
        assert_eq!(facts.stamps, Stamps::Jittered, "{sigma_s}");
        assert!((facts.jitter_s / sigma_s - 1.0).abs() < 0.1);
        assert_eq!((facts.rate_hz, facts.drops.missing), (1000.0, 0));
        let grid = stamped.uniform().unwrap();
        assert_eq!(grid.force_n, stamped.force_n);
        assert!(!grid.in_gap.contains(&true));
        assert!(grid.notes[0].contains("scatter"), "{:?}", grid.notes);
        // WHEN the instants scatter, THEN the stamps are believed.
        let taken = log(&scattered, scattered.clone());
        assert_eq!(taken.sampling().stamps, Stamps::Uneven, "{sigma_s}");
    }
}

#[test]
fn missing_samples_are_counted_with_and_without_jitter() {
    let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED + 2);
    for (share, sigma_s) in [(0.005, 0.0), (0.02, 2e-5), (0.3, 0.0), (0.3, 1e-4)] {
        let stamps = scattered(&even(4000), sigma_s);
        let kept: Vec<bool> = (0..4000)
            .map(|i| i == 0 || i == 3999 || rng.random::<f64>() >= share)
            .collect();
        let pick = |all: &[f64]| -> Vec<f64> {
            let pairs = all.iter().zip(&kept);
            pairs.filter(|(_, kept)| **kept).map(|(t, _)| *t).collect()
        };
        let log = log(&pick(&even(4000)), pick(&stamps));
        let facts = log.sampling();
        let missing = kept.iter().filter(|kept| !**kept).count();
        assert_eq!(facts.drops.missing, missing, "{share} {sigma_s}");
        assert!((facts.drops.share - missing as f64 / 4000.0).abs() < 1e-12);
        // Each sample that is there stays as it was measured, in its place.
        let grid = log.uniform().unwrap();
        assert_eq!(grid.in_gap, kept.iter().map(|k| !k).collect::<Vec<_>>());
        let measured = grid.force_n.iter().zip(&grid.in_gap);
        let measured: Vec<f64> = measured
            .filter(|(_, gap)| !**gap)
            .map(|(f, _)| *f)
            .collect();
        assert_eq!(measured, log.force_n);
    }
}

#[test]
fn a_thinned_hold_is_a_slower_rate_and_a_pause_makes_a_segment() {
    // GIVEN 2 s at 1 kHz, a hold of 100 s at 2 Hz, 2 s at 1 kHz, a pause of 30 s, and 2 s more
    let fast = even(2000);
    let mut stamps = fast.clone();
    stamps.extend((0..200).map(|i| 2.0 + 0.5 * f64::from(i)));
    stamps.extend(fast.iter().map(|t| 102.0 + t));
    stamps.extend(fast.iter().map(|t| 134.0 + t));
    let facts = log(&stamps, stamps.clone()).sampling();
    assert_eq!(facts.rate_hz, 1000.0);
    assert_eq!(facts.slower, [(2.0, 102.0)]);
    assert_eq!(facts.drops.gaps.len(), 1);
    assert_eq!(facts.segments.len(), 2, "{:?}", facts.segments);
}

#[test]
fn rounded_stamps_show_their_resolution_and_no_jitter() {
    let stamps = (0..2000).map(|i| (f64::from(i) / 256.0 * 1e5).round() / 1e5);
    let taken: Vec<f64> = (0..2000).map(|i| f64::from(i) / 256.0).collect();
    let facts = log(&taken, stamps.collect()).sampling();
    assert_eq!((facts.stamps, facts.rate_hz), (Stamps::Even, 256.0));
    assert_eq!(facts.resolution_s, Some(1e-5));
}
