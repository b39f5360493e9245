//! Harder rigs: the kinds of [`super::kind`], recorded with sensors and sampling as they are.

use super::case::{Case, LEAST_RATIO};
use super::kind::Kind;
use super::motion::{Profile, Track};
use super::random::Random;
use super::sensor::Noise;
use super::world::{MAINS_HZ, Stamps, World};
use super::write::Units;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::Path;

/// A group of rigs: a row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Group {
    /// Its name, which is the kind in truth.json.
    pub name: &'static str,
    kind: Kind,
    world: Sampling,
}

/// What is drawn, and what is the row's own.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sampling {
    /// All of a bench, at 200 Hz to 5 kHz.
    Bench,
    /// The same at 5 kHz, from micrometres and micronewtons to centimetres and kilonewtons.
    Scale,
    /// Only missing samples: this share.
    Drops(f64),
    /// Only a rate (Hz); below 200 Hz a slow machine.
    Rate(f64),
    /// Only jitter: of the sampling with true stamps, of the sampling with even stamps, of the stamps.
    Jitter(Stamps),
    /// Only thinned holds.
    Thinned,
    /// An hour at 100 Hz.
    Hour,
    /// Only noise behind a filter.
    Filtered,
    /// The same under a motion that never rests, and stays in contact.
    Restless,
}

const fn group(name: &'static str, kind: Kind, world: Sampling) -> Group {
    Group { name, kind, world }
}

const fn sampling(name: &'static str, world: Sampling) -> Group {
    group(name, Kind::None, world)
}

/// The rows: groups with something hidden and without on a bench, and then nothing hidden, with one fault of
/// the sampling each.
pub const GROUPS: [Group; 26] = [
    group("foreign", Kind::Foreign, Sampling::Bench),
    group("mismatched", Kind::Mismatched, Sampling::Bench),
    group("single", Kind::Single, Sampling::Bench),
    group("none", Kind::None, Sampling::Bench),
    group("pair", Kind::Pair, Sampling::Bench),
    group("triple", Kind::Triple, Sampling::Bench),
    group("unknown", Kind::Unknown, Sampling::Bench),
    group("weak", Kind::Weak, Sampling::Bench),
    group("poor", Kind::Poor, Sampling::Bench),
    group("scale", Kind::Single, Sampling::Scale),
    sampling("drops 0.5 %", Sampling::Drops(0.005)),
    sampling("drops 2 %", Sampling::Drops(0.02)),
    sampling("drops 30 %", Sampling::Drops(0.3)),
    sampling("stamps off 5 µs", Sampling::Jitter(Stamps::Scattered(5e-6))),
    sampling(
        "stamps off 20 µs",
        Sampling::Jitter(Stamps::Scattered(20e-6)),
    ),
    sampling(
        "stamps off 200 µs",
        Sampling::Jitter(Stamps::Scattered(200e-6)),
    ),
    sampling(
        "uneven 200 µs, true",
        Sampling::Jitter(Stamps::True(200e-6)),
    ),
    sampling(
        "uneven 50 µs, unseen",
        Sampling::Jitter(Stamps::Hidden(50e-6)),
    ),
    sampling("rate 10 Hz", Sampling::Rate(10.0)),
    sampling("rate 200 Hz", Sampling::Rate(200.0)),
    sampling("rate 5 kHz", Sampling::Rate(5000.0)),
    sampling("rate 20 kHz", Sampling::Rate(20_000.0)),
    sampling("thinned holds", Sampling::Thinned),
    sampling("an hour", Sampling::Hour),
    sampling("filtered", Sampling::Filtered),
    sampling("filtered, no rest", Sampling::Restless),
];

/// A rig in its files.
#[derive(Clone, Debug)]
pub struct Rig {
    case: Case,
    world: World,
    rows: Vec<[f64; 3]>,
    group: &'static str,
}

impl Rig {
    /// Draws the rig `index` of a group.
    pub fn draw(group: &Group, seed: u64, index: u64) -> Rig {
        let place = GROUPS.iter().position(|known| known.name == group.name);
        for attempt in 0..50 {
            // The streams of the cases themselves stay below 2⁴⁰.
            let stream = (1 << 44) + (place.unwrap_or(0) as u64 * 1000 + index) * 64 + attempt;
            let mut random = Random::new(seed, stream);
            let drawn = (random.unit() * 2f64.powi(50)) as u64;
            let case = Case::generate(group.kind, drawn, index);
            let rig = Rig::recorded(case, group, &mut random);
            let something = ![Kind::None, Kind::Weak].contains(&group.kind);
            if !something || rig.case.gap_ratio() >= LEAST_RATIO {
                return rig;
            }
        }
        panic!("no rig shows {} {index} of seed {seed}", group.name);
    }

    fn recorded(mut case: Case, group: &Group, random: &mut Random) -> Rig {
        let world = world(&mut case, group.world, random);
        // What the base leaves beside the noise stays; the floor is another one.
        let beyond = (case.base_rmse_n.powi(2) - case.floor_n.powi(2)).max(0.0);
        if group.world == Sampling::Hour {
            case.track = an_hour(&case, random);
        }
        if group.world == Sampling::Restless {
            case.track = restless(&case, random);
        }
        // Drawn apart, so that it moves no other draw.
        let apart = Random::new(case.plant.seed, 1 << 43).chance(0.5);
        case.plant.creeps = group.world == Sampling::Bench && apart;
        let recorded = world.record(&case.plant, &case.track, random);
        case.floor_n = recorded.floor_n;
        case.base_rmse_n = (beyond + recorded.floor_n.powi(2)).sqrt();
        Rig {
            case,
            world,
            rows: recorded.rows,
            group: group.name,
        }
    }

    /// What is special about the sensors and the surface, in words.
    fn words(&self) -> String {
        let surface = match self.case.plant.keeps_a_dent() {
            true => ", a dent that creeps back",
            false => "",
        };
        self.world.words() + surface
    }

    /// The text of truth.json.
    pub fn truth(&self) -> Value {
        let mut truth = self.case.truth();
        truth["kind"] = json!(self.group);
        truth["noise"] = json!(self.world.noise.name());
        truth["world"] = json!(self.words());
        truth["rate_hz"] = json!(self.world.rate_hz / self.case.units.time);
        let mut tolerate: Vec<String> = Vec::new();
        if self.world.hum_n > 0.0 {
            let hz = [1.0, 3.0].map(|of| format!("periodic_disturbance@{}", of * MAINS_HZ));
            tolerate.extend(hz);
        }
        // A load cell that rings is late by 2ζ/ω, up to 0.25 ms, and one that bends stiffens or saturates.
        let late = ["force_lag", "time_delay"];
        let bent = [
            "exponential_stiffening",
            "power_law_stiffness",
            "force_saturation",
        ];
        if self.world.cell.is_some() {
            tolerate.extend(late.map(String::from));
        }
        if self.world.bends != 0.0 {
            tolerate.extend(bent.map(String::from));
        }
        if self
            .case
            .hidden
            .iter()
            .any(|hidden| hidden.id == "force_drift")
        {
            tolerate.push("force_offset".into());
        }
        truth["tolerate"] = json!(tolerate);
        truth
    }

    /// The text of measured.csv.
    pub fn csv(&self) -> String {
        let Units {
            length,
            force,
            time,
            ..
        } = self.case.units;
        let mut text = String::from("t_s,x_m,f_n\n");
        for [t, x, f] in &self.rows {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{:.6},{:.9e},{:.7e}", t * time, x * length, f * force);
        }
        text
    }

    /// Writes base.toml, measured.csv and truth.json into a folder.
    pub fn save(&self, dir: &Path) -> std::io::Result<()> {
        std::fs::create_dir_all(dir)?;
        std::fs::write(dir.join("base.toml"), self.case.base_toml())?;
        std::fs::write(dir.join("measured.csv"), self.csv())?;
        std::fs::write(dir.join("truth.json"), format!("{:#}\n", self.truth()))
    }
}

/// Group, index, hidden effects and what is special about the sensors.
impl std::fmt::Display for Rig {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {} ({})", self.group, self.case, self.words())
    }
}

/// The sensors and the size of a rig.
fn world(case: &mut Case, sampling: Sampling, random: &mut Random) -> World {
    let sensor = case.sensor;
    let plain = |rate_hz| World::plain(sensor, rate_hz);
    match sampling {
        Sampling::Bench => {
            let rate_hz = *random.pick(&[1000.0, 1000.0, 1000.0, 200.0, 500.0, 2000.0, 5000.0]);
            World::draw(sensor, rate_hz, random)
        }
        Sampling::Scale => {
            let (length, force) = (
                random.log_between(1e-3, 10.0),
                random.log_between(1e-6, 300.0),
            );
            case.units = Units {
                length,
                force,
                time: 1.0,
                turns: false,
            };
            let mut world = World::draw(sensor, 5000.0, random);
            world.hum_n = 0.0;
            world
        }
        Sampling::Drops(share) => World {
            drops: share,
            ..plain(1000.0)
        },
        Sampling::Rate(hz) => {
            let slower = (200.0 / hz).max(1.0);
            case.units = Units {
                time: slower,
                ..Units::SI
            };
            plain(hz * slower)
        }
        Sampling::Jitter(stamps) => World {
            stamps,
            ..plain(1000.0)
        },
        Sampling::Thinned => World {
            thins: true,
            ..plain(1000.0)
        },
        Sampling::Hour => World {
            noise: Noise::White,
            ..plain(100.0)
        },
        Sampling::Filtered | Sampling::Restless => World {
            noise: Noise::Filtered(random.log_between(10.0, 100.0)),
            ..plain(1000.0)
        },
    }
}

/// Half a second to the middle of the depth, and then two sines that stay in contact.
fn restless(case: &Case, random: &mut Random) -> Track {
    let (from_m, to_m) = case.track.range_m();
    let depth_m = to_m - case.material.surface;
    let waves = [
        (0.22 * depth_m, random.log_between(0.4, 1.0)),
        (0.12 * depth_m, random.log_between(1.5, 3.0)),
    ];
    let middle_m = case.material.surface + 0.5 * depth_m;
    case.track.with_set_point(20.0, |t| {
        let wave =
            |(size_m, hz): &(f64, f64)| size_m * (std::f64::consts::TAU * hz * (t - 0.5)).sin();
        match t < 0.5 {
            true => from_m + (middle_m - from_m) * t / 0.5,
            false => middle_m + waves.iter().map(wave).sum::<f64>(),
        }
    })
}

/// An hour of motions of the same kind, one after another: what remembers one is pressed again by the next.
fn an_hour(case: &Case, random: &mut Random) -> Track {
    let surface = case.material.surface;
    let depth_m = case.track.range_m().1 - surface;
    let mut hour = case.track.clone();
    while hour.seconds() < 3600.0 {
        hour.go_on(&Track::draw(Profile::Mixed, surface, depth_m, random));
    }
    hour
}
