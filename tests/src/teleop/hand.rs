//! The rows of the bar that the operator's hand has to reach.

use palpate::motion::{Motion, Segment};
use palpate::teleop::environment::{Environment, Material};
use palpate::teleop::hand::Excitation;
use palpate::teleop::operator::{Grip, HAND};
use palpate::teleop::{Options, SchemeId, System, Trace};

use super::bar::Row;
use crate::quantile::quantile;
use crate::tolerance;

/// When the hand is looked at (s): after eight seconds of palpation.
const AFTER_S: f64 = 9.0;

/// The relative errors of a hand's stiffness, damping and mass at a time (s).
fn hand_errors(trace: &Trace, at_s: f64, grip: &Grip) -> [f64; 3] {
    let row = trace.rows.iter().rfind(|row| row.time_s <= at_s);
    let exact = [grip.stiffness_n_per_m, grip.damping_ns_per_m, grip.mass_kg];
    let found = row.and_then(|row| row.hand).unwrap_or([None; 3]);
    let mut errors = [f64::INFINITY; 3];
    for ((error, found), exact) in errors.iter_mut().zip(found).zip(exact) {
        *error = found.map_or(f64::INFINITY, |(value, _)| value / exact - 1.0);
    }
    errors
}

/// The operator's impedance: with and without a known force, and a change of the grip.
pub fn hand(seeds: u64) -> Vec<Row> {
    let bounds = tolerance::HAND;
    let grips = [
        HAND,
        Grip {
            mass_kg: 0.6,
            damping_ns_per_m: 15.0,
            stiffness_n_per_m: 400.0,
            ..HAND
        },
        Grip {
            mass_kg: 0.5,
            damping_ns_per_m: 25.0,
            stiffness_n_per_m: 1200.0,
            ..HAND
        },
    ];
    let run = |excitation: Option<Excitation>, grips: Vec<Grip>, seed: u64| {
        let mut options = Options::default().with_scheme(SchemeId::ReflectionBoth);
        options.environment = Environment::throughout(Material::gel());
        options.operator.grips = grips;
        (options.reflection.excitation, options.reflection.excites) = (excitation, true);
        let options = options.with_channel(0.05, 0.0, 0.0).with_task_for_delay();
        System::new(&options, seed).run()
    };
    let excitation = Some(Excitation { force_n: 0.3 });
    let mut rows: Vec<Row> = [
        (None, bounds.0, "from what the hand does anyway"),
        (excitation, bounds.1, "with a known force of 0.3 N"),
    ]
    .into_iter()
    .map(|(excitation, bound, how)| {
        let mut errors: [Vec<f64>; 3] = Default::default();
        for grip in grips {
            for seed in 1..=seeds {
                let trace = run(excitation, vec![grip], seed);
                for (all, error) in errors.iter_mut().zip(hand_errors(&trace, AFTER_S, &grip)) {
                    all.push(error.abs());
                }
            }
        }
        let worst = errors.clone().map(|own| quantile(&own, 1.0));
        let median = errors.map(|own| quantile(&own, 0.5));
        Row {
            asked: format!(
                "hand's k, b, m within {:.0} % {how} (3–20 Hz)",
                100.0 * bound
            ),
            measured: format!(
                "median {:.1}, {:.1}, {:.1} %; worst {:.1}, {:.1}, {:.1} %",
                100.0 * median[0],
                100.0 * median[1],
                100.0 * median[2],
                100.0 * worst[0],
                100.0 * worst[1],
                100.0 * worst[2]
            ),
            reached: worst.iter().all(|error| *error <= bound),
        }
    })
    .collect();
    rows.push(grip_change(seeds, |grips, seed| {
        run(excitation, grips, seed)
    }));
    rows.push(starts_and_stops(seeds));
    rows
}

/// Ramps with holds between them: an intention that starts and stops at once, seven times.
fn ramps() -> Motion {
    let mut segments = vec![Segment::Hold { seconds: 0.6 }];
    for (to_m, seconds) in [(8e-3, 3.0), (-4e-3, 2.0), (6e-3, 1.5), (-2e-3, 0.7)] {
        let speed_mps = 0.05;
        segments.extend([Segment::Ramp { to_m, speed_mps }, Segment::Hold { seconds }]);
    }
    Motion::new(-6e-3, segments).expect("a motion")
}

/// The share of a run's time, from 2 s on, in which stiffness or damping are more than 15 % and three claimed errors off.
fn standing_wrong(trace: &Trace, grip: &Grip) -> f64 {
    let rows = trace.between(2.0, f64::INFINITY);
    let wrong = |row: &&palpate::teleop::Row| {
        let Some([stiffness, damping, _]) = row.hand else {
            return false;
        };
        let pairs = [
            (stiffness, grip.stiffness_n_per_m),
            (damping, grip.damping_ns_per_m),
        ];
        pairs.into_iter().any(|(found, exact)| {
            found.is_some_and(|(value, error)| {
                let off = (value - exact).abs();
                off > tolerance::HAND.0 * exact && off > 3.0 * error
            })
        })
    };
    rows.iter().filter(wrong).count() as f64 / rows.len() as f64
}

/// An intention that starts or stops at once is in the band of the identification: the press at the end of the built-in
/// task, and ramps. What it makes of the hand is doubted and not believed.
fn starts_and_stops(seeds: u64) -> Row {
    let (mut most, mut ends) = (0.0_f64, Vec::new());
    for intention in [None, Some(ramps())] {
        for excites in [true, false] {
            for seed in 1..=seeds {
                let mut options = Options::default().with_scheme(SchemeId::ReflectionBoth);
                options.environment = Environment::throughout(Material::gel());
                options.reflection.excitation = excites.then_some(Excitation { force_n: 0.3 });
                options.reflection.excites = true;
                let mut options = options.with_channel(0.02, 0.0, 0.0).with_task_for_delay();
                if let Some(intention) = &intention {
                    options.task = None;
                    options.operator.intention = intention.clone();
                }
                let trace = System::new(&options, seed).run();
                most = most.max(standing_wrong(&trace, &HAND));
                if intention.is_none() {
                    ends.extend(hand_errors(&trace, f64::INFINITY, &HAND)[..1].to_vec());
                }
            }
        }
    }
    let end = ends.iter().map(|error| error.abs()).fold(0.0, f64::max);
    Row {
        asked: "an intention that starts or stops at once: no hand 15 % and three errors off for more than 1 % of the \
                time"
            .into(),
        measured: format!(
            "{:.2} % of the time at most; after the last press k is {:.1} % off at most",
            100.0 * most,
            100.0 * end
        ),
        // What it takes until residuals show it: 20 ms of each start.
        reached: most <= 0.01 && end <= tolerance::HAND.1,
    }
}

/// A change of the grip in the midst of a palpation.
fn grip_change(seeds: u64, run: impl Fn(Vec<Grip>, u64) -> Trace) -> Row {
    let changed = Grip {
        from_s: 6.0,
        stiffness_n_per_m: 1200.0,
        damping_ns_per_m: 20.0,
        ..HAND
    };
    let times = (1..=seeds).map(|seed| {
        let trace = run(vec![HAND, changed], seed);
        let off = |at_s: f64| hand_errors(&trace, at_s, &changed)[0].abs() > tolerance::HAND.0;
        let last = (0..300)
            .rev()
            .find(|step| off(6.0 + 0.01 * f64::from(*step)));
        last.map_or(0.0, |step| 0.01 * f64::from(step + 1))
    });
    let times: Vec<f64> = times.collect();
    let slowest = quantile(&times, 1.0);
    Row {
        asked: format!(
            "a change of the grip (k 700 to 1200 N/m) followed within 15 % in {} s",
            tolerance::GRIP_S
        ),
        measured: format!(
            "{:.2} s in the median, at most {slowest:.2} s",
            quantile(&times, 0.5)
        ),
        reached: slowest <= tolerance::GRIP_S,
    }
}
