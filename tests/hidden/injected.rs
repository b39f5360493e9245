//! Effects put into measured records, on thinned ones: the table of
//! `cargo run --release -p tests --example hidden -- injected` in small.

use std::path::Path;
use tests::hidden::rig::fit::rms;
use tests::hidden::rig::inject::{EFFECTS, Record, inject};
use tests::hidden::score::injected::{Examined, Question, examine};
use tests::hidden::score::table;

/// A record as a function of time.
fn record(x: impl Fn(f64) -> f64, f: impl Fn(f64) -> f64) -> Record {
    let t: Vec<f64> = (0..4000).map(|k| f64::from(k) * 1e-3).collect();
    Record {
        x: t.iter().map(|t| x(*t)).collect(),
        f: t.iter().map(|t| f(*t)).collect(),
        t,
    }
}

/// 1 mm at 1 Hz against a spring of 2 N/mm.
fn sine() -> Record {
    let x = |t: f64| 1e-3 * (std::f64::consts::TAU * t).sin();
    record(x, |t| 2000.0 * x(t))
}

#[test]
fn an_effect_changes_the_force_by_the_size_that_is_asked_for_and_nothing_else() {
    let clean = sine();
    for (id, _) in EFFECTS {
        let injection = inject(id, &clean, 0.1).unwrap_or_else(|e| panic!("{id}: {e}"));
        let by = |of: fn(&Record) -> &Vec<f64>| -> f64 {
            let pairs = of(&injection.record).iter().zip(of(&clean));
            rms(&pairs.map(|(a, b)| a - b).collect::<Vec<f64>>())
        };
        assert_eq!(injection.record.t, clean.t, "{id}");
        let (moved, changed) = (by(|r| &r.x), by(|r| &r.f));
        if id == "series_compliance" {
            // The stiffness of the sine over the way behind the touch at a twentieth of the peak.
            assert!(
                (0.09..0.11).contains(&(2000.0 * moved)) && changed == 0.0,
                "{moved} m"
            );
        } else {
            assert!(
                (changed - 0.1).abs() < 1e-6 && moved == 0.0,
                "{id}: {changed} N"
            );
        }
        assert!(injection.value > 0.0, "{id}: {}", injection.value);
    }
}

#[test]
fn the_sizes_are_those_of_closed_forms() {
    let (clean, w) = (sine(), std::f64::consts::TAU);
    let value = |id: &str| {
        inject(id, &clean, 0.01)
            .map(|injection| injection.value)
            .unwrap_or(f64::NAN)
    };
    let force = rms(&clean.f);
    for (id, expected, off) in [
        // A shift by T changes a sine by 2 sin(ωT/2) of itself; the first T seconds stand still.
        ("time_delay", 2.0 / w * (0.005 / force).asin(), 0.01),
        // A lag by ωτ/√(1+(ωτ)²), and so does the start.
        ("force_lag", 0.01 / force / w, 0.01),
        ("tool_inertia", 0.01 / (1e-3 * w * w * 0.5f64.sqrt()), 0.01),
        ("asymmetric_drag", 0.01 / (1e-3 * w * 0.5f64.sqrt()), 0.01),
        ("cable_stiffness", 0.01 / (1e-3 * 0.5f64.sqrt()), 1e-9),
        ("periodic_disturbance", 0.01 * 2f64.sqrt(), 0.01),
        ("force_drift", 0.01 * 3f64.sqrt() / 4.0, 0.001),
        // It bends by 0.2 % of the travel.
        ("coulomb_friction", 0.01, 0.02),
    ] {
        let found = value(id);
        assert!(
            (found / expected - 1.0).abs() < off,
            "{id}: {found} for {expected}"
        );
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let clean = sine();
    let delay = inject("time_delay", &clean, 1e3);
    assert!(delay.is_err_and(|e| e.contains("absurdly")));
    let still = record(|_| 1e-3, |_| 1.0);
    assert!(inject("tool_inertia", &still, 0.1).is_err());
    // A press that is logged densely with 1 µm of noise, and thinned afterwards: the mean interval is not the press's.
    let time = |k: u32| f64::from(k.min(3000)) * 1e-4 + f64::from(k.saturating_sub(3000)) * 0.1;
    let noise = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 16) / 65536.0 - 0.5;
    let read = Record {
        t: (0..4000).map(time).collect(),
        x: (0..4000)
            .map(|k| 1e-3 * time(k).min(0.3) + 1e-6 * noise(k))
            .collect(),
        f: vec![1.0; 4000],
    };
    let unseen = inject("tool_inertia", &read, 0.1);
    assert!(unseen.is_err_and(|e| e.contains("how it accelerates")));
    assert!(inject("perpetual_motion", &clean, 0.1).is_err());
}

fn small(only: &[&str], every: usize, size: f64) -> Vec<Examined> {
    let question = Question {
        sizes: vec![size],
        only: only.iter().map(|name| (*name).to_string()).collect(),
        every,
        keep: None,
    };
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    examine(&question, &[data], &|_| {})
}

/// All that a thinned record must show: its own model again finds nothing, and what is put into it is named.
fn named(only: &[&str], every: usize) {
    let examined = small(only, every, 5.0);
    let text = table::injected::text(&examined);
    let [one] = examined.as_slice() else {
        panic!("{text}")
    };
    let clean = one.clean.as_ref().unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(clean.again.group(), 0, "{text}");
    assert_eq!(one.injected.len(), only.len() - 1, "{text}");
    for injected in &one.injected {
        let outcome = injected
            .outcome
            .as_ref()
            .unwrap_or_else(|e| panic!("{}: {e}", injected.id));
        assert!(outcome.named && outcome.close(), "{text}");
    }
}

#[test]
fn a_cogging_in_a_drives_record_is_named() {
    named(&["emps/data", "cogging"], 16);
}

#[test]
fn a_cogging_in_a_servos_record_is_named() {
    named(&["bam/kp400_up", "cogging"], 2);
}

#[test]
fn a_friction_in_a_foams_record_is_new_beside_what_the_foams_model_left() {
    // Against the noise alone four effects without a friction left less than the model had left before. The size is
    // not right: the friction that is put in sticks before it slides.
    let examined = small(&["nist/0da", "coulomb_friction"], 1, 5.0);
    let text = table::injected::text(&examined);
    let outcome = examined[0].injected[0].outcome.as_ref();
    let outcome = outcome.unwrap_or_else(|e| panic!("{e}"));
    assert!(outcome.named && !outcome.companion, "{text}");
}

#[test]
fn what_a_base_that_is_known_cannot_follow_is_told_from_what_it_could() {
    // With numbers that moved freely a drag was open or a relaxation instead of the cogging, and the drag by direction a
    // hysteretic damping.
    let cell = small(&["cell1-0001", "cogging"], 1, 2.0);
    let foam = small(&["nist/3da", "asymmetric_drag"], 1, 2.0);
    let text = table::injected::text(&[cell.clone(), foam.clone()].concat());
    let outcome = |examined: &[Examined]| {
        let outcome = examined[0].injected[0].outcome.clone();
        outcome.unwrap_or_else(|e| panic!("{e}"))
    };
    let (cogging, drag) = (outcome(&cell), outcome(&foam));
    assert!(cogging.named && !cogging.companion, "{text}");
    assert!(drag.open && !drag.companion, "{text}");
}
