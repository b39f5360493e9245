//! A rig with its motion before anything is hidden in it, and the strength at which an effect shows.

use super::case::Case;
use super::draw::machine::{MACHINE, given_cable};
use super::draw::{self, Hidden, Scale};
use super::effect::{Effect, Stranger};
use super::fit::Target;
use super::kind::Kind;
use super::material::{Law, Material};
use super::motion::{Profile, SUBSTEPS, Track};
use super::plant::Plant;
use super::random::Random;
use super::sensor::{Noise, Sensor, code_n};
use super::write::Units;

/// Sub-steps in a sample while strengths are sought: 4 kHz are enough for 10 %.
pub(super) const COARSE: usize = 4;

/// A rig before anything is hidden in it.
pub(super) struct Bare {
    pub(super) material: Material,
    profile: Profile,
    pub(super) track: Track,
    pub(super) scale: Scale,
    /// The noise that the sensor is to have (N rms).
    noise_n: f64,
    start: Vec<f64>,
    seed: u64,
    /// A cable that the base model has: its stiffness (N/m), and what the model says of it.
    pub(super) given: Option<(f64, f64)>,
}

impl Bare {
    pub(super) fn draw(law: Law, profile: Profile, random: &mut Random) -> Self {
        let material = material(law, random);
        let mut depth_m = 1.2e-3;
        let wanted_n = random.log_between(5.0, 25.0);
        while depth_m < 5.5e-3 && material.elastic(depth_m) < wanted_n {
            depth_m += 0.1e-3;
        }
        let track = Track::draw(profile, material.surface, depth_m, random);
        let (low, high) = track.range_m();
        let mut scale = Scale {
            material,
            peak_n: 1.0,
            depth_m: high - material.surface,
            fastest_mps: track.fastest_mps(),
            way_m: high - low,
            seconds: track.seconds(),
        };
        let mut rig = Bare {
            material,
            profile,
            track,
            scale,
            noise_n: random.log_between(4e-4, 3e-3),
            start: off(&material, random),
            seed: (random.unit() * 2f64.powi(52)) as u64,
            given: None,
        };
        let bare = Plant::bare(material).samples(&rig.track, COARSE);
        scale.peak_n = bare.iter().copied().fold(0.0, f64::max);
        rig.scale = scale;
        rig.noise_n *= scale.peak_n;
        rig
    }

    /// The rig with the cable in its base model that an effect needs.
    pub(super) fn with_given(mut self, ids: &[&str], random: &mut Random) -> Self {
        if ids.iter().any(|id| MACHINE.contains(id)) {
            let cable = given_cable(ids[0], &self.scale, random);
            self.given = cable.map(|k| (k, k * (1.0 + random.sign() * random.between(0.1, 0.2))));
        }
        self
    }

    /// The columns that the base is fitted with beside its law: the cable's.
    pub(super) fn columns(&self, x: &[f64]) -> Vec<Vec<f64>> {
        self.given.iter().map(|_| x.to_vec()).collect()
    }

    /// The rig with these effects hidden in it.
    pub(super) fn plant(&self, hidden: Vec<Effect>, stranger: Option<(Stranger, f64)>) -> Plant {
        let cable = self.given.map(|(stiffness, _)| Effect::cable(stiffness));
        Plant {
            hidden: hidden.into_iter().chain(cable).collect(),
            stranger,
            peak_n: self.scale.peak_n,
            seed: self.seed,
            ..Plant::bare(self.material)
        }
    }

    /// What the best fit of the base leaves of a rig without noise (N).
    fn left_n(&self, plant: &Plant) -> f64 {
        let force = plant.samples(&self.track, COARSE);
        let read = plant.readings(&self.track);
        let thin: Vec<f64> = read.iter().copied().step_by(4).collect();
        let target = Target::base(self.material.law, &read, &force, 4);
        let columns = self.columns(&thin);
        target.fit(&self.material.numbers(), &columns).rmse_n
    }

    /// The strength at which the base leaves what the wanted gap ratio needs; `None` where there is none.
    fn sought(&self, from: f64, ratio: f64, plant: impl Fn(f64) -> Plant) -> Option<f64> {
        let wanted_n = self.noise_n * (ratio * ratio - 1.0).sqrt();
        let mut strength = from;
        let mut reached = 0.0;
        for _ in 0..7 {
            let left_n = self.left_n(&plant(strength));
            reached = left_n / wanted_n;
            if !(1e-6..1e6).contains(&reached) {
                return None;
            }
            if (0.85..1.2).contains(&reached) {
                return Some(strength);
            }
            strength *= (1.0 / reached).clamp(0.05, 20.0);
        }
        // The strength is capped or the force steep in it: good all the same if it shows.
        (0.5..2.0).contains(&reached).then_some(strength)
    }

    /// Draws an effect at the strength that the kind wants.
    pub(super) fn strengthened(
        &self,
        id: &'static str,
        kind: Kind,
        random: &mut Random,
    ) -> Option<Hidden> {
        let ratio = kind.wanted(random);
        let stream = Random::new((random.unit() * 2f64.powi(52)) as u64, 5);
        let built = |strength: f64| {
            let other = matches!(
                kind,
                Kind::Mismatched | Kind::PairMismatched | Kind::MachineMismatched
            );
            draw::build(id, other, strength, &self.scale, &mut stream.clone())
        };
        let strength = self.sought(1.0, ratio, |s| self.plant(vec![built(s).effect], None))?;
        Some(built(strength))
    }

    /// Seeks the strength of a misfit that is in no catalogue.
    pub(super) fn strange(&self, which: Stranger, random: &mut Random) -> Option<(Stranger, f64)> {
        let from = match which {
            Stranger::GainWalk
            | Stranger::TouchStiffness
            | Stranger::Crackle
            | Stranger::Swap
            | Stranger::Fatigue => 0.03,
            Stranger::Dropouts => 0.3,
            _ => 0.02 * self.scale.peak_n,
        };
        let ratio = Kind::Unknown.wanted(random);
        let strength = self.sought(from, ratio, |s| self.plant(Vec::new(), Some((which, s))))?;
        Some((which, strength))
    }

    /// Records the rig with a converter whose range fits the forces of this motion.
    pub(super) fn record(&self, plant: &Plant, noise: Noise, random: &mut Random) -> Case {
        let clean = plant.samples(&self.track, SUBSTEPS);
        let top_n = clean.iter().fold(0.0, |top: f64, f| f.abs().max(top));
        let sensor = Sensor {
            noise,
            noise_n: self.noise_n,
            code_n: code_n(top_n),
        };
        let recorded = sensor.recorded(&clean, plant, &self.track, random);
        Case {
            kind: Kind::None,
            seed: 0,
            index: 0,
            every: 1,
            material: self.material,
            hidden: Vec::new(),
            stranger: None,
            profile: self.profile,
            sensor,
            plant: plant.clone(),
            track: self.track.clone(),
            rows: recorded.rows,
            units: Units::SI,
            richer: None,
            start: self.start.clone(),
            floor_n: recorded.floor_n,
            also: Vec::new(),
            base_rmse_n: 0.0,
            form_rmse_n: None,
            given: self.given,
        }
    }
}

fn material(law: Law, random: &mut Random) -> Material {
    let surface = random.between(-0.3e-3, 0.3e-3);
    let numbers = match law {
        Law::KelvinVoigt => {
            let k = random.log_between(800.0, 6000.0);
            vec![k, k * random.log_between(4e-3, 15e-3), surface]
        }
        Law::HuntCrossley => {
            let k = random.log_between(700.0, 14_000.0);
            vec![
                k,
                k * random.log_between(4e-3, 25e-3),
                random.between(1.15, 1.6),
                surface,
            ]
        }
        Law::QuasiLinear => {
            let (k, n) = (random.log_between(1000.0, 4000.0), random.between(1.2, 1.7));
            vec![
                k,
                n,
                random.between(0.2, 0.45),
                random.log_between(0.6, 5.0),
                surface,
            ]
        }
        Law::Zener => {
            let k = random.log_between(1000.0, 5000.0);
            let second = k * random.between(0.8, 2.5);
            vec![
                k,
                second,
                (k + second) / random.log_between(0.8, 6.0),
                surface,
            ]
        }
    };
    Material::from_numbers(law, &numbers)
}

/// The parameters in the model file: 10–20 % off, the exponent up to 5 %, the surface at zero.
fn off(material: &Material, random: &mut Random) -> Vec<f64> {
    let names = material.law.parameters();
    names
        .iter()
        .zip(material.numbers())
        .map(|(name, value)| match *name {
            "surface" => 0.0,
            "exponent" => value * (1.0 + random.between(-0.05, 0.05)),
            _ => value * (1.0 + random.sign() * random.between(0.1, 0.2)),
        })
        .collect()
}
