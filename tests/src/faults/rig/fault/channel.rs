//! Faults of the load cell and of the encoder.

use super::{Fault, Scene, row};
use crate::faults::rig::NOISE_N;
use crate::faults::rig::plan::{Force, Plan, Position};

/// A plan with a faulty load cell from the start.
fn force(force: Force) -> Plan {
    Plan {
        force,
        ..Plan::default()
    }
}

/// A plan with a faulty encoder from the start.
fn position(position: Position) -> Plan {
    Plan {
        position,
        ..Plan::default()
    }
}

/// A plan whose fault lasts from the first span's start to its end.
fn during(spans: &[std::ops::Range<f64>], plan: Plan) -> Plan {
    let span = spans.first().cloned().unwrap_or(0.0..0.0);
    Plan {
        onset_s: span.start,
        end_s: Some(span.end),
        ..plan
    }
}

/// A load cell that stands still for these spans.
fn stuck_force(spans: super::Spans) -> Plan {
    during(
        &spans.clone(),
        force(Force {
            stuck: spans,
            ..Force::default()
        }),
    )
}

/// An encoder that stands still for these spans.
fn stuck_position(spans: super::Spans) -> Plan {
    during(
        &spans.clone(),
        position(Position {
            stuck: spans,
            ..Position::default()
        }),
    )
}

/// One spike in a press.
fn one(scene: &mut Scene, size: f64) -> (f64, f64) {
    let at = scene.pressing();
    (at, size * scene.random.sign())
}

/// Seconds that a channel stands still for.
const STUCK_S: [f64; 3] = [0.005, 0.05, 0.5];

pub(super) const FORCE: &[Fault] = &[
    row("none", "5, 20, 100 mN of noise", |scene| {
        let noise_n = scene.of([0.005, NOISE_N, 0.1]);
        force(Force {
            noise_n,
            ..Force::default()
        })
    }),
    row("noise", "60, 200, 600 mN of noise", |scene| {
        let noise_n = NOISE_N * scene.of([3.0, 10.0, 30.0]);
        force(Force {
            noise_n,
            ..Force::default()
        })
    }),
    row("hum", "20, 100, 500 mN at 50 Hz", |scene| {
        let hum_n = scene.of([0.02, 0.1, 0.5]);
        force(Force {
            hum_n,
            ..Force::default()
        })
    }),
    row("coarse_adc", "steps of 20, 100, 500 mN", |scene| {
        let step_n = scene.of([0.02, 0.1, 0.5]);
        force(Force {
            step_n,
            ..Force::default()
        })
    }),
    row("skew", "force ± 0.5, 1.5, 3 ms late", |scene| {
        let late_s = scene.of([5e-4, 1.5e-3, 3e-3]) * scene.random.sign();
        force(Force {
            late_s,
            ..Force::default()
        })
    }),
    row("lag", "first order, 1, 4, 15 ms", |scene| {
        let lag_s = scene.of([1e-3, 4e-3, 15e-3]);
        force(Force {
            lag_s,
            ..Force::default()
        })
    }),
    row("stuck_adc", "5, 50, 500 ms in a press", |scene| {
        let seconds = scene.of(STUCK_S);
        stuck_force(scene.span(seconds))
    })
    .passes(),
    row(
        "stuck_adc_first",
        "5, 50, 500 ms in the first press",
        |scene| {
            let (from, seconds) = (scene.first_press(), scene.of(STUCK_S));
            stuck_force(vec![from..from + seconds])
        },
    ),
    row("stuck_adc_often", "5, 50, 500 ms every 1 s", |scene| {
        let seconds = scene.of(STUCK_S);
        let spans = scene.spans(seconds, 1.0);
        let plan = stuck_force(spans);
        Plan {
            end_s: None,
            ..plan
        }
    }),
    row("saturated", "at 90, 70, 50 % of the peak", |scene| {
        let limit_n = scene.peak_n * scene.of([0.9, 0.7, 0.5]);
        force(Force {
            limit_n,
            ..Force::default()
        })
    }),
    row("bit_flip", "0.16, 1.28, 10.24 N, three a second", |scene| {
        let bit = scene.of([5, 8, 11]);
        let spikes = scene.spikes(0.0, 3.0);
        force(Force {
            flips: spikes.iter().map(|(at, _)| (*at, bit)).collect(),
            ..Force::default()
        })
    }),
    row("stuck_bit", "the bit of 40, 160, 640 mN", |scene| {
        let bit = scene.of([3, 5, 7]);
        force(Force {
            stuck_bit: Some(bit),
            ..Force::default()
        })
    }),
    row("spikes_force", "1, 10, 1000 N, five a second", |scene| {
        let spikes = scene.spikes(scene.of([1.0, 10.0, 1000.0]), 5.0);
        force(Force {
            spikes,
            ..Force::default()
        })
    }),
    row("spike_one", "1, 10, 1000 N, once in a press", |scene| {
        let spike = one(scene, scene.of([1.0, 10.0, 1000.0]));
        during(
            &[spike.0..spike.0 + 1e-3],
            force(Force {
                spikes: vec![spike],
                ..Force::default()
            }),
        )
    })
    .passes(),
    row("offset_drift", "5, 20, 100 mN/s", |scene| {
        let drift_nps = scene.of([5e-3, 0.02, 0.1]) * scene.random.sign();
        force(Force {
            drift_nps,
            ..Force::default()
        })
    }),
    row("offset_step", "0.05, 0.2, 1 N", |scene| {
        let offset_n = scene.of([0.05, 0.2, 1.0]) * scene.random.sign();
        let plan = force(Force {
            offset_n,
            ..Force::default()
        });
        let onset_s = scene.middle();
        Plan { onset_s, ..plan }
    }),
    row(
        "reversed_force",
        "from the start, from the middle in air, in a press",
        |scene| {
            let onset_s = match scene.severity {
                0 => 0.0,
                1 => scene.in_air(),
                _ => scene.pressing(),
            };
            let plan = force(Force {
                gain: -1.0,
                ..Force::default()
            });
            Plan { onset_s, ..plan }
        },
    ),
    row("scaled_force", "force × 1.1, 1.5, 3", |scene| {
        let gain = scene.of([1.1, 1.5, 3.0]);
        force(Force {
            gain,
            ..Force::default()
        })
    }),
];

pub(super) const POSITION: &[Fault] = &[
    row("coarse_enc", "counts of 5, 20, 100 µm", |scene| {
        let count_m = scene.of([5e-6, 2e-5, 1e-4]);
        position(Position {
            count_m,
            ..Position::default()
        })
    }),
    row(
        "toggling",
        "0.15 counts of noise, counts of 1, 5, 20 µm",
        |scene| {
            let count_m = scene.of([1e-6, 5e-6, 2e-5]);
            position(Position {
                count_m,
                noise_counts: 0.15,
                ..Position::default()
            })
        },
    ),
    row("stuck_enc", "5, 50, 500 ms in a press", |scene| {
        let seconds = scene.of(STUCK_S);
        stuck_position(scene.span(seconds))
    })
    .passes(),
    row(
        "stuck_enc_first",
        "5, 50, 500 ms in the first press",
        |scene| {
            let (from, seconds) = (scene.first_press(), scene.of(STUCK_S));
            stuck_position(vec![from..from + seconds])
        },
    ),
    row("stuck_enc_often", "5, 50, 500 ms every 1 s", |scene| {
        let seconds = scene.of(STUCK_S);
        let spans = scene.spans(seconds, 1.0);
        let plan = stuck_position(spans);
        Plan {
            end_s: None,
            ..plan
        }
    }),
    row(
        "spikes_position",
        "0.05, 0.5, 50 mm, five a second",
        |scene| {
            let spikes = scene.spikes(scene.of([5e-5, 5e-4, 5e-2]), 5.0);
            position(Position {
                spikes,
                ..Position::default()
            })
        },
    ),
    row(
        "spike_one_position",
        "0.05, 0.5, 50 mm, once in a press",
        |scene| {
            let spike = one(scene, scene.of([5e-5, 5e-4, 5e-2]));
            during(
                &[spike.0..spike.0 + 1e-3],
                position(Position {
                    spikes: vec![spike],
                    ..Position::default()
                }),
            )
        },
    )
    .passes(),
    row("enc_jump", "10, 50, 250 µm in a press", |scene| {
        let jump_m = scene.of([1e-5, 5e-5, 2.5e-4]) * scene.random.sign();
        let onset_s = scene.pressing();
        let plan = position(Position {
            jump_m,
            ..Position::default()
        });
        Plan {
            onset_s,
            end_s: Some(onset_s),
            ..plan
        }
    })
    .passes(),
    row("enc_jump_air", "10, 50, 250 µm in free air", |scene| {
        let jump_m = scene.of([1e-5, 5e-5, 2.5e-4]) * scene.random.sign();
        let onset_s = scene.in_air();
        let plan = position(Position {
            jump_m,
            ..Position::default()
        });
        Plan {
            onset_s,
            end_s: Some(onset_s),
            ..plan
        }
    })
    .passes(),
    row(
        "reversed_position",
        "from the start, from the middle in air, in a press",
        |scene| {
            let onset_s = match scene.severity {
                0 => 0.0,
                1 => scene.in_air(),
                _ => scene.pressing(),
            };
            let plan = position(Position {
                gain: -1.0,
                ..Position::default()
            });
            Plan { onset_s, ..plan }
        },
    ),
    row("scaled_position", "position × 1.1, 1.5, 3", |scene| {
        let gain = scene.of([1.1, 1.5, 3.0]);
        position(Position {
            gain,
            ..Position::default()
        })
    }),
    row(
        "power_cycle",
        "in a press, zero taken anew: of the force, of the encoder, of both",
        |scene| {
            let (tared, restarted) = scene.of([(true, false), (false, true), (true, true)]);
            let onset_s = scene.pressing();
            Plan {
                onset_s,
                force: Force {
                    tared,
                    ..Force::default()
                },
                position: Position {
                    restarted,
                    ..Position::default()
                },
                clock: crate::faults::rig::plan::Clock {
                    dropped: vec![onset_s - 0.2..onset_s],
                    ..Default::default()
                },
                ..Plan::default()
            }
        },
    ),
];
