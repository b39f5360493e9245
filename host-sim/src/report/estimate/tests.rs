use super::*;
use crate::replay::{EventKind, EventMark, Touch};
use crate::report::{Provenance, Tone};
use estimator_core::Status;
use estimator_core::estimate::{Estimated, Event};

fn report<'a>(runs: &'a [Run<'a>], notes: &'a [String]) -> EstimateReport<'a> {
    EstimateReport {
        title: "Estimate",
        tone: Tone::Neutral,
        badge: "no contact",
        verdict: "A <verdict>.",
        runs,
        notes,
        provenance: Provenance::new("palpate estimate log.csv"),
    }
}

fn well_formed(html: &str) {
    let options = roxmltree::ParsingOptions {
        allow_dtd: true,
        ..Default::default()
    };
    roxmltree::Document::parse_with_options(html, options).unwrap();
}

/// A log at 1 kHz of touches of one second each, with two between.
struct Log {
    time: Vec<f64>,
    depth: Vec<f64>,
    force: Vec<f64>,
    wiggle: Vec<f64>,
    status: Vec<Status>,
    stiffness: Vec<Option<Estimated<f64>>>,
    touches: Vec<Touch>,
    events: Vec<EventMark>,
}

impl Log {
    fn new(touches: usize) -> Log {
        let time: Vec<f64> = (0..touches * 2000).map(|i| i as f64 * 1e-3).collect();
        let wave = |t: &f64| 3e-3 * (std::f64::consts::PI * t).sin();
        let touch = |i: usize| Touch {
            from_s: 2.0 * i as f64,
            to_s: 2.0 * i as f64 + 1.0,
            peak_force_n: 4.2,
            peak_depth_m: 3e-3,
            ..Touch::default()
        };
        let stiffness = |t: &f64| {
            let value = 1350.0 + 4e5 * (-20.0 * t).exp();
            let std_error = 0.01 * value;
            (*t > 0.1).then_some(Estimated { value, std_error })
        };
        let events = (0..touches).map(|i| EventMark {
            time_s: 2.0 * i as f64,
            kind: EventKind::Estimator(Event::Contact),
        });
        Log {
            depth: time.iter().map(wave).collect(),
            force: time.iter().map(|t| 1400.0 * wave(t).max(0.0)).collect(),
            wiggle: time.iter().map(|t| 0.02 * (1e4 * t * t).sin()).collect(),
            status: time.iter().map(|_| Status::Converged).collect(),
            stiffness: time.iter().map(stiffness).collect(),
            touches: (0..touches).map(touch).collect(),
            events: events.collect(),
            time,
        }
    }

    fn html(&self, names: &[&str]) -> String {
        let parameters = vec![Trajectory {
            name: "stiffness",
            unit: "N/m",
            values: (&self.stiffness).into(),
        }];
        let finals = vec![
            FinalParameter {
                name: "stiffness",
                unit: "N/m",
                estimate: self.stiffness.last().copied().flatten(),
                truth: Some(1350.0),
            },
            FinalParameter {
                name: "damping",
                unit: "N s/m",
                estimate: None,
                truth: None,
            },
        ];
        let run = Run {
            law: "hunt_crossley",
            time_s: (&self.time).into(),
            depth_m: (&self.depth).into(),
            speed_mps: (&self.depth).into(),
            measured_n: (&self.force).into(),
            estimated_n: (&self.force).into(),
            innovation_n: (&self.wiggle).into(),
            forgetting: (&self.force).into(),
            status: (&self.status).into(),
            noise_n: Some(0.02),
            forgetting_law: Some(FORGETTING),
            parameters,
            finals,
            touches: (&self.touches).into(),
            events: (&self.events).into(),
            ..Run::default()
        };
        let runs: Vec<Run> = names
            .iter()
            .map(|name| Run {
                name,
                ..run.clone()
            })
            .collect();
        report(&runs, &[]).document().to_html()
    }
}

const FORGETTING: ForgettingLaw = ForgettingLaw {
    alpha_1: 0.05,
    alpha_2_per_n: 40.0,
    alpha_3_n: 0.12,
};

#[test]
fn beta_goes_from_almost_one_to_one_less_alpha_1_with_the_middle_at_alpha_3() {
    assert!((FORGETTING.beta(0.12) - 0.975).abs() < 1e-12);
    assert!((0.996..0.998).contains(&FORGETTING.beta(0.0)));
    assert!((0.9500..0.9502).contains(&FORGETTING.beta(-10.0)));
}

#[test]
fn nothing_at_all_is_still_a_report() {
    let empty = report(&[], &[]).document().to_html();
    well_formed(&empty);
    assert!(empty.contains("A &lt;verdict&gt;."));
    let runs = [Run::default()];
    let without_samples = report(&runs, &[]).document().to_html();
    well_formed(&without_samples);
    assert!(without_samples.contains("no data"));
}

#[test]
fn a_log_of_nan_constants_and_slices_of_different_length_is_still_a_report() {
    let (nan, one) = ([f64::NAN; 50], [1.0; 7]);
    let run = Run {
        time_s: (&one[..]).into(),
        depth_m: (&nan[..]).into(),
        speed_mps: (&one[..]).into(),
        measured_n: (&one[..]).into(),
        estimated_n: (&nan[..]).into(),
        innovation_n: (&nan[..]).into(),
        forgetting: (&one[..]).into(),
        status: vec![Status::Converged].into(),
        noise_n: Some(f64::NAN),
        forgetting_law: Some(ForgettingLaw {
            alpha_1: f64::NAN,
            alpha_2_per_n: f64::INFINITY,
            alpha_3_n: -1.0,
        }),
        parameters: vec![Trajectory {
            name: "",
            unit: "",
            values: vec![None, None].into(),
        }],
        ..Run::default()
    };
    well_formed(&report(&[run], &[]).document().to_html());
}

#[test]
fn the_figures_that_readers_of_the_chapter_expect_are_there() {
    let html = Log::new(3).html(&[""]);
    well_formed(&html);
    for title in [
        "Hysteresis loop",
        "Power exchange",
        "Stiffness K",
        "Force",
        "Displacement",
        "Residual",
        "β over the force error",
        "β over time",
    ] {
        assert!(html.contains(&format!("<h3>{title}</h3>")), "{title}");
    }
    assert!(html.contains("not observable"));
    assert!(html.contains("Force F [N]") && html.contains("Depth δ [mm]"));
    // The first estimates are 40 times too large; the axis must not follow them.
    assert!(html.contains("the transient leaves it"));
}

#[test]
fn runs_stand_side_by_side_in_one_table_and_in_pairs_of_figures() {
    let html = Log::new(2).html(&["gel", "plastic"]);
    let at = |what: &str| html.find(what).unwrap_or_else(|| panic!("{what}"));
    assert!(html.contains(">gel</th>") && html.contains(">plastic</th>"));
    assert!(at("<h3>Hysteresis loop, gel</h3>") < at("<h3>Hysteresis loop, plastic</h3>"));
    assert!(at("<h3>Hysteresis loop, plastic</h3>") < at("<h3>Power exchange, gel</h3>"));
    assert!(!html.contains("<figure class=\"wide\">"));
}

#[test]
fn an_hour_at_1_khz_stays_below_half_a_megabyte_and_says_what_it_leaves_out() {
    let html = Log::new(1800).html(&[""]);
    well_formed(&html);
    // Measured: 172 kB.
    assert!((60_000..500_000).contains(&html.len()), "{}", html.len());
    assert!(html.contains("in the first 3 touches of 1800."));
    assert!(html.contains("in the last 3 touches of 1800."));
    assert!(html.contains("… 1786 more …"));
}

#[test]
fn a_fault_in_every_sample_is_one_row_and_no_wall_of_markers() {
    let fault = |i: usize| EventMark {
        time_s: i as f64 * 1e-3,
        kind: EventKind::Fault {
            code: 5,
            description: "force at the end of its range".into(),
        },
    };
    let mut log = Log::new(2);
    log.events = (0..4000).map(fault).collect();
    let html = log.html(&[""]);
    assert_eq!(html.matches("5: force at the end of its range").count(), 1);
    assert!(html.contains(">4000</td>") && html.contains(">3.999</td>"));
    assert!(!html.contains("class=\"event major\""));
    log.events.truncate(3);
    assert!(log.html(&[""]).contains("class=\"event major\""));
}

#[test]
fn parameters_get_their_symbol_and_unknown_ones_their_name() {
    assert_eq!(label("stiffness"), "Stiffness K");
    assert_eq!(label("relaxation_rate"), "Relaxation rate");
    assert_eq!(label(""), "");
}
