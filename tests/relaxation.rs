//! x
use estimator_core::Config;
use estimator_core::config::Method;
use estimator_core::law::{Elastic, QuasiLinear, RelaxationMode, Zener};
use palpate::estimate::{Choices, Estimation, estimate};
use palpate::motion::{Motion, Segment};
use palpate::plant::{Contact, Law, Rig, Run, Stage};

fn show(name: &str, estimation: &Estimation) {
    let o = &estimation.outcome;
    print!(
        "{name} {:?} rmse {:?} settled {:?} ",
        o.status, o.force_rmse_n, o.settled_at_s
    );
    for (info, e) in o.named(&o.parameters) {
        match e {
            Some(e) => print!("{} {:.5}±{:.5}; ", info.name, e.value, e.std_error),
            None => print!("{} -; ", info.name),
        }
    }
    println!(
        "events {:?}",
        o.events
            .iter()
            .filter(|e| format!("{:?}", e.kind).contains("Change"))
            .count()
    );
}

fn e5_motion(hold: f64) -> Motion {
    Motion::new(
        -2e-3,
        vec![
            Segment::Hold { seconds: 0.6 },
            Segment::Ramp {
                to_m: 3.5e-3,
                speed_mps: 0.03,
            },
            Segment::Hold { seconds: hold },
            Segment::Ramp {
                to_m: -2e-3,
                speed_mps: 0.03,
            },
            Segment::Hold { seconds: 0.5 },
        ],
    )
    .unwrap()
}

fn run(law: Law, motion: &Motion, seed: u64) -> Run {
    Rig::default()
        .run(
            &Stage::throughout(Contact {
                law,
                surface_m: 0.0,
            }),
            motion,
            seed,
        )
        .unwrap()
}

fn with(run: &Run, method: Method) -> Estimation {
    let choices = Choices {
        surface_m: Some(0.0),
        ..Choices::default()
    };
    estimate(
        &run.log.uniform().unwrap(),
        Config::default(),
        &[method],
        choices,
    )
    .unwrap()
}

fn polyurethane(modes: &[(f64, f64)]) -> Law {
    let mut all = [RelaxationMode {
        fraction: 0.0,
        rate_per_s: 0.0,
    }; 4];
    for (m, (c, r)) in all.iter_mut().zip(modes) {
        *m = RelaxationMode {
            fraction: *c,
            rate_per_s: *r,
        };
    }
    Law::QuasiLinear(QuasiLinear {
        elastic: Elastic::Power {
            stiffness_n_per_m: 1700.0,
            exponent: 1.5,
            reference_depth_m: 1e-3,
        },
        modes: all,
    })
}

#[test]
fn scratch() {
    let motion = e5_motion(50.0);
    for modes in [&[(0.3, 0.12)][..], &[(0.3, 1.0)], &[(0.2, 2.0), (0.2, 0.1)]] {
        for seed in 1..4 {
            let r = run(polyurethane(modes), &motion, seed);
            println!(
                "{modes:?} peak {}",
                r.truth.force_n.iter().copied().fold(0.0, f64::max)
            );
            show("r1", &with(&r, Method::HammersteinCascade));
            show("r2", &with(&r, Method::HammersteinCascade2));
        }
    }
    let once = Motion::palpation(4.2e-3);
    let twice = once.then(&once);
    for seed in 1..4 {
        let r = run(polyurethane(&[(0.3, 1.0)]), &twice, seed);
        show("palpated r1", &with(&r, Method::HammersteinCascade));
        for nu in [0.2, 5.0, 30.0] {
            let z = Zener {
                stiffness_n_per_m: 3000.0,
                second_stiffness_n_per_m: 4000.0,
                damping_ns_per_m: 7000.0 / nu,
            };
            let r = run(Law::Zener(z), &twice, seed);
            show(
                &format!("zener {nu} lambda {}", 7000.0 / nu),
                &with(&r, Method::ZenerArx),
            );
        }
    }
}
