use estimator_core::physics::effect::EffectId;

use super::*;
use crate::gap::{
    Candidate, Curves, Episode, Grade, MissingEffect, NoiseFloor, ParameterEstimate, Region,
    Support, Verdict,
};

/// Two seconds of presses at 1 kHz whose base model lacks 0.4 N of friction.
fn curves() -> Curves {
    let time_s: Vec<f64> = (0..2000).map(|at| f64::from(at) * 1e-3).collect();
    let phase = |t: &f64| std::f64::consts::TAU * 2.0 * t;
    let depth_m: Vec<f64> = time_s
        .iter()
        .map(|t| 2e-3 * (0.4 - phase(t).cos()))
        .collect();
    let speed_mps: Vec<f64> = time_s.iter().map(|t| 0.025 * phase(t).sin()).collect();
    let friction = speed_mps.iter().map(|v| 0.4 * v.signum());
    let before_n: Vec<f64> = depth_m.iter().map(|d| 1000.0 * d.max(0.0)).collect();
    let after_n: Vec<f64> = before_n
        .iter()
        .zip(friction)
        .map(|(f, own)| f + own)
        .collect();
    let noise = |at: usize| 0.02 * (at as f64 * 1.7).sin();
    Curves {
        position_m: depth_m.clone(),
        measured_n: after_n
            .iter()
            .enumerate()
            .map(|(at, f)| f + noise(at))
            .collect(),
        allowed_n: (0..2000)
            .map(|at| if at == 7 { 0.0 } else { 0.02 })
            .collect(),
        held_out: (0..2000).map(|at| (at / 170) % 3 == 1).collect(),
        time_s,
        speed_mps,
        depth_m,
        before_n,
        after_n,
    }
}

fn known(name: &str, value: f64, std_error: Option<f64>, unit: &'static str) -> ParameterEstimate {
    ParameterEstimate {
        at_bound: false,
        name: name.into(),
        value,
        std_error,
        unit,
    }
}

/// 259 µm ± 92 µm before and 0.9 µm after: the change is as uncertain as both, and 2.8 of that.
#[test]
fn the_error_of_a_change_is_that_of_both_fits() {
    let before = known("surface", 0.0, Some(92e-6), "m");
    let after = known("surface", 259.2e-6, Some(0.9e-6), "m");
    let said = tables::change(&before, &after);
    assert!(said.contains("± 90"), "{said}");
    let moved = format!("{:?}", tables::moved(&before, &after));
    assert!(moved.contains("2.8 σ"), "{moved}");
}

fn finding(verdict: Verdict) -> Finding {
    let named = MissingEffect {
        id: EffectId::CoulombFriction,
        parameters: vec![known("force", 0.41, Some(0.003), "N")],
        grade: match verdict {
            Verdict::Ambiguous => Grade::Open,
            Verdict::PartlyExplained => Grade::Strong,
            _ => Grade::Certain,
        },
        support: Support::default(),
        alternatives: match verdict {
            Verdict::Ambiguous => vec![EffectId::Backlash],
            _ => Vec::new(),
        },
        place: "60 % of the excess is while loading".into(),
        held_out_gain: 0.97,
    };
    let region = Region {
        id: "loading",
        share: 0.6,
        rms_n: 0.3,
        samples: 0.4,
        pattern: None,
    };
    let has_effects = !matches!(verdict, Verdict::NoMissingEffect | Verdict::Unexplained);
    Finding {
        mistaken: None,
        episode: None,
        left_out: Vec::new(),
        surface_off: Vec::new(),
        verdict,
        effects: if has_effects { vec![named] } else { Vec::new() },
        rmse_before_n: 0.4,
        rmse_after_n: 0.0201,
        noise_floor_n: 0.02,
        remainder_n: 0.002,
        floors: vec![NoiseFloor::white(0.02, "from second differences")],
        ratio_before: 20.0,
        ratio_after: 1.005,
        slow_remainder: None,
        nothing_new: false,
        is_beside_remainder: false,
        base_before: vec![
            known("stiffness", 1100.0, Some(3.0), "N/m"),
            known("exponent", 1.0, None, "1"),
        ],
        base_after: vec![
            known("stiffness", 1000.0, Some(2.0), "N/m"),
            known("exponent", 1.0, None, "1"),
        ],
        changed: None,
        differs: None,
        disagreement: vec![region],
        remaining: Vec::new(),
        advice: "Use model.toml <now>".into(),
        advised: None,
        ladder: vec![
            Candidate {
                ids: vec![EffectId::CoulombFriction],
                ratio: 1.005,
            },
            Candidate {
                ids: vec![EffectId::Backlash],
                ratio: 1.01,
            },
            Candidate {
                ids: Vec::new(),
                ratio: 20.0,
            },
        ],
        model: model(),
        bandwidth_hz: None,
        curves: vec![curves()],
        notes: vec!["a & b".into()],
    }
}

fn model() -> crate::model::Model {
    let text = "[environment]\nlaw = \"kelvin_voigt\"\nstiffness = 1000.0\ndamping = 0.0\n\n\
                [[effect]]\nid = \"tool_inertia\"\nmass = 0.1\n";
    let path = std::path::Path::new("base.toml");
    let file = crate::toml_reader::TomlFile::parse(text.into(), path).unwrap();
    crate::model::Model::from_toml(&file, path).unwrap()
}

fn html(finding: &Finding) -> String {
    let report = GapReport {
        title: "Gap",
        finding,
        names: &["measured.csv".into()],
        provenance: Provenance::new("palpate gap"),
    };
    report.document().to_html()
}

#[test]
fn every_verdict_gives_a_well_formed_page_that_says_it_first() {
    for (verdict, words) in [
        (
            Verdict::NoMissingEffect,
            "The base model explains the measurement",
        ),
        (
            Verdict::MissingEffects,
            "The model lacks Coulomb friction (force 0.4100 ± 0.0030",
        ),
        (
            Verdict::Ambiguous,
            "or backlash: this log does not tell them apart",
        ),
        (
            Verdict::PartlyExplained,
            "What remains no effect of the catalogue explains",
        ),
        (
            Verdict::Unexplained,
            "Something is missing that no effect of the catalogue explains",
        ),
    ] {
        let html = html(&finding(verdict));
        let options = roxmltree::ParsingOptions {
            allow_dtd: true,
            ..Default::default()
        };
        roxmltree::Document::parse_with_options(&html, options).unwrap();
        let said = html.replace(['\u{a0}', '\u{202f}'], " ");
        let at = said
            .find(words)
            .unwrap_or_else(|| panic!("{words} in {verdict:?}"));
        assert!(at < said.find("<table").unwrap());
        assert!(
            !html.contains("NaN") && !html.contains("inf "),
            "{verdict:?}"
        );
    }
}

#[test]
fn a_remainder_that_is_as_small_as_noise_and_slower_is_said() {
    let slow = Finding {
        slow_remainder: Some(2.4),
        remaining: Vec::new(),
        ..finding(Verdict::PartlyExplained)
    };
    let said = html(&slow).replace(['\u{a0}', '\u{202f}'], " ");
    assert!(said.contains("too slow for noise: means of 32 samples are 2.4 times as large"));
    assert!(!said.contains("nothing significant remains"));
}

#[test]
fn a_log_that_is_as_the_model_says_has_nothing_new() {
    let as_before = Finding {
        nothing_new: true,
        ..finding(Verdict::Unexplained)
    };
    let said = html(&as_before).replace(['\u{a0}', '\u{202f}'], " ");
    assert!(said.contains("Beside the model nothing is new: "));
    assert!(said.contains("hardly more than was left when it was identified"));
    assert!(!said.contains("Something is missing"));
}

#[test]
fn the_page_shows_what_moved_what_was_tried_and_every_picture() {
    let html = html(&finding(Verdict::Ambiguous)).replace(['\u{a0}', '\u{202f}'], " ");
    for words in [
        "an alternative to the answer",
        "the answer",
        "base model",
        "yes, by 28 σ",
        "not fitted",
        "Use model.toml &lt;now&gt;",
        "a &amp; b",
        "Residual over time",
        "Force over time",
        "Hysteresis loop",
        "Residual over depth",
        "Residual over speed",
        "Spectrum of the residual",
        "class=\"heat\"",
    ] {
        assert!(html.contains(words), "{words}");
    }
}

#[test]
fn the_map_puts_friction_of_twenty_times_the_noise_into_every_cell_that_moves() {
    let finding = finding(Verdict::MissingEffects);
    let log = bins::LogCurves::of(&finding, 0).unwrap();
    let maps: Vec<String> = map::maps(&log)
        .iter()
        .map(|map| format!("{map:?}"))
        .collect();
    let [before, after] = &maps[..] else {
        panic!("{maps:?}")
    };
    // 0.4 N over 0.02 N.
    assert!(before.contains("20 ×"), "{before}");
    assert!(!after.contains("20 ×"), "{after}");
}

#[test]
fn a_stretch_that_was_left_out_stands_red_in_the_strip() {
    let whole = finding(Verdict::PartlyExplained);
    assert!(!html(&whole).contains("left out"));
    let episode = |log| Episode {
        log,
        from_s: 0.7,
        until_s: 1.1,
    };
    let part = Finding {
        left_out: vec![episode(0)],
        ..whole.clone()
    };
    let part = html(&part);
    assert!(part.contains("red what was left out") && part.contains(">left out<"));
    let of_another = Finding {
        left_out: vec![episode(1)],
        ..whole
    };
    assert!(!html(&of_another).contains("left out"));
}

#[test]
fn a_rig_that_touches_nothing_has_a_travel_and_no_depth() {
    // GIVEN the same rig with a law of free motion
    let mut free = finding(Verdict::MissingEffects);
    free.curves[0].depth_m.fill(0.0);
    let html = html(&free);
    // THEN its loops and maps are of the position, and nothing is in air or touched.
    for words in [
        "Force over position",
        "Residual over position",
        "position \\ motion",
        "Force over speed",
        "forward, fast",
        "By position, speed and frequency",
    ] {
        assert!(html.contains(words), "{words}");
    }
    for words in ["Hysteresis loop", "<th>free air", "out, fast"] {
        assert!(!html.contains(words), "{words}");
    }
}

#[test]
fn an_effect_that_the_model_had_already_is_shown_with_its_base() {
    let html = html(&finding(Verdict::NoMissingEffect));
    assert!(
        html.contains("<caption><span>Tool inertia</span></caption>"),
        "{html}"
    );
}

#[test]
fn nothing_at_all_is_still_a_page() {
    let mut empty = finding(Verdict::Unexplained);
    empty.curves = vec![Curves::default()];
    empty.effects.clear();
    empty.ladder.clear();
    empty.disagreement.clear();
    assert!(html(&empty).contains("no data"));
}

#[test]
fn a_log_of_thirty_thousand_samples_takes_less_than_two_megabytes() {
    let mut long = finding(Verdict::MissingEffects);
    let one = curves();
    for at in 0..30_000_usize {
        let from = at % 2000;
        let own = &mut long.curves[0];
        if at < 2000 {
            continue;
        }
        own.time_s.push(at as f64 * 1e-3);
        own.position_m.push(one.position_m[from]);
        own.speed_mps.push(one.speed_mps[from]);
        own.depth_m.push(one.depth_m[from]);
        own.measured_n.push(one.measured_n[from]);
        own.before_n.push(one.before_n[from]);
        own.after_n.push(one.after_n[from]);
        own.allowed_n.push(one.allowed_n[from]);
        own.held_out.push(one.held_out[from]);
    }
    let length = html(&long).len();
    assert!((50_000..2_000_000).contains(&length), "{length}");
}
