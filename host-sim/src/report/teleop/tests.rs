use super::*;
use crate::teleop::measure::transparency::Line;
use crate::teleop::{Grid, System, compare, measure};

#[test]
fn a_report_of_a_run_and_of_a_comparison_have_their_parts_and_are_well_formed() {
    let options = Options::default().with_scheme(SchemeId::ReflectionBoth);
    let options = options.with_channel(0.05, 0.0, 0.0).with_task_for_delay();
    let trace = System::new(&options, 1).run();
    let measures = measure(&trace);
    let grid = Grid {
        base: Options::default(),
        environments: vec![options.environment.clone()],
        schemes: vec![SchemeId::PositionForce],
        round_trips_s: vec![0.1],
        jitters: vec![0.0],
        losses: vec![0.0],
        seeds: 1,
    };
    let map = compare(&grid, &|_, _| {});
    let line = Line {
        frequency_hz: 1.0,
        magnitude: 0.98,
        phase_rad: 0.0,
    };
    let report = TeleopReport {
        options: &options,
        trace: &trace,
        measures: &measures,
        transparency: &[(
            options.scheme,
            vec![
                line,
                Line {
                    frequency_hz: 2.0,
                    ..line
                },
            ],
        )],
        map: &map,
        limit: crate::teleop::Limit {
            rests_to_s: Some(5.0),
            ..Default::default()
        },
        notes: &["nothing of it is used".into()],
        provenance: Provenance::new("palpate teleop"),
    };
    for html in [
        report.document().to_html(),
        comparison(&map, Provenance::new("palpate teleop --compare")).to_html(),
    ] {
        let parsing = roxmltree::ParsingOptions {
            allow_dtd: true,
            ..Default::default()
        };
        roxmltree::Document::parse_with_options(&html, parsing).unwrap();
        assert!(html.contains("unstable") && html.contains("position–force"));
    }
    let html = report.document().to_html();
    for part in [
        "Force over depth: gel",
        "Energy",
        "Transparency",
        "of the hand",
        "noticed",
        "the longest that was tried",
        "Nothing of it is used.",
    ] {
        assert!(html.contains(part), "{part}");
    }
    assert!(html.contains("transparent"), "{measures:?}");
}
