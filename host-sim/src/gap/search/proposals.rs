//! Where a candidate effect starts, and what it promises: the change it makes to the force, projected
//! off what the model can do already, compared with the residuals.

use estimator_core::physics::effect::{ChainStage, Effect, EffectId, Role, Sign};
use estimator_core::physics::rig::{Environment, Rig};
use rayon::prelude::*;

use crate::gap::data::scales::Scales;
use crate::gap::model::{fit::Fit, problem::Problem, shape::Term, start::starts};
use crate::lsq::basis::{add_column, dot, project_out};
use crate::lsq::minimize::blocked;

/// An effect with numbers to start from.
#[derive(Clone, Debug)]
pub(crate) struct Proposal {
    pub(crate) term: Term,
    /// What the effect takes off Σ w r², to first order.
    pub(crate) gain: f64,
}

/// A fit and its linearization: an orthonormal basis of the changes that its numbers can make.
pub(crate) struct LinearizedModel<'a> {
    pub(super) problem: Problem<'a>,
    pub(super) fit: &'a Fit,
    pub(super) scales: &'a Scales,
    /// The rig that is fitted, and the forces (N) that it predicts.
    rig: Rig<f64>,
    forces: Vec<f64>,
    /// The rig without what a force between contact and load cell does not change, if it changes nothing else.
    path: Option<Rig<f64>>,
    /// √w r, projected off the basis.
    pub(super) residuals: Vec<f64>,
    /// Orthonormal columns, in units of √w r.
    pub(super) basis: Vec<Vec<f64>>,
    /// √w for each sample.
    pub(super) roots: Vec<f64>,
}

/// The two best starts of every effect, the best effects first.
pub(super) fn ranked(mut proposals: Vec<Proposal>) -> Vec<Vec<Proposal>> {
    proposals.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let mut ranked: Vec<Vec<Proposal>> = Vec::new();
    for proposal in proposals {
        let same = |starts: &&mut Vec<Proposal>| starts[0].term.id == proposal.term.id;
        match ranked.iter_mut().find(same) {
            Some(starts) if starts.len() < 2 => starts.push(proposal),
            Some(_) => {}
            None => ranked.push(vec![proposal]),
        }
    }
    ranked
}

impl<'a> LinearizedModel<'a> {
    pub(crate) fn new(
        problem: Problem<'a>,
        fit: &'a Fit,
        scales: &'a Scales,
    ) -> LinearizedModel<'a> {
        let linear = problem.linearize(&fit.shape, &fit.numbers);
        let roots: Vec<f64> = problem.weights.iter().map(|w| w.sqrt()).collect();
        let weighted = |column: &[f64]| -> Vec<f64> {
            column.iter().zip(&roots).map(|(c, w)| c * w).collect()
        };
        // Behind the samples stands what is known beside them, which no effect changes.
        let beside = |at: usize| {
            let each = linear.readings.iter();
            each.map(move |own| if own.number == at { own.slope } else { 0.0 })
        };
        let normal = problem.normal_equations(&linear);
        let blocked = blocked(&fit.shape.limits(), &fit.numbers, &normal.downhill);
        let mut basis: Vec<Vec<f64>> = Vec::new();
        // A number that its bound keeps from moving can do nothing: a damping of 0 that a lag would have
        // negative.
        let columns = linear.columns.iter().zip(&blocked).enumerate();
        for (at, (column, _)) in columns.filter(|(_, (_, blocked))| !**blocked) {
            let mut column = weighted(column);
            column.extend(beside(at));
            add_column(&mut basis, column, &[]);
        }
        let mut residuals = weighted(&linear.residuals);
        residuals.extend(linear.readings.iter().map(|own| own.residual));
        project_out(&mut residuals, &basis);
        let rig = fit.shape.rig(&fit.numbers);
        LinearizedModel {
            problem,
            fit,
            scales,
            forces: problem.forces_of(&rig),
            path: path(&rig),
            rig,
            residuals,
            basis,
            roots,
        }
    }

    /// What starts with the sizes of the log promise. An effect whose size would be negative promises `wrong_sign` times as
    /// much.
    pub(super) fn of_sizes(&self, ids: &[EffectId], wrong_sign: f64) -> Vec<Proposal> {
        let each = ids.iter();
        let starts = each.flat_map(|id| starts(*id, &self.fit.shape, self.scales));
        self.promised(starts.collect(), wrong_sign)
    }

    /// The same of waves, from the spectrum of the residuals.
    pub(super) fn of_waves(&self, ids: &[EffectId], wrong_sign: f64) -> Vec<Proposal> {
        self.promised(self.periodic_starts(ids), wrong_sign)
    }

    fn promised(&self, starts: Vec<Term>, wrong_sign: f64) -> Vec<Proposal> {
        let starts = starts.into_par_iter();
        starts.map(|term| self.proposal(term, wrong_sign)).collect()
    }

    /// What a start promises, its size fitted where the force is proportional to one.
    fn proposal(&self, term: Term, wrong_sign: f64) -> Proposal {
        let mut change = self.change_by(&term);
        let whole = dot(&change, &change);
        project_out(&mut change, &self.basis);
        let left = dot(&change, &change);
        // A change that the model can make as well promises nothing.
        if !left.is_finite() || left <= 1e-9 * whole || left <= 0.0 {
            return Proposal { term, gain: 0.0 };
        }
        let along = dot(&change, &self.residuals);
        let share = along / left;
        let mut gain = along * along / left;
        if share < 0.0 && term.id.info().sign != Sign::Either {
            gain *= wrong_sign;
        }
        Proposal {
            term: scaled(term, share),
            gain,
        }
    }

    /// The change (√w N) that an effect makes to the predicted force.
    fn change_by(&self, term: &Term) -> Vec<f64> {
        let effect = Effect::new(term.id, &term.row);
        let mut change = match self.path.filter(|_| is_added_to_the_load(term.id)) {
            Some(path) => self.problem.forces_of(&path.with(effect)),
            None => {
                let mut with = self.problem.forces_of(&self.rig.with(effect));
                let each = with.iter_mut().zip(&self.forces);
                each.for_each(|(with, without)| *with -= without);
                with
            }
        };
        let each = change.iter_mut().zip(&self.roots);
        each.for_each(|(change, root)| *change *= root);
        change.resize(self.residuals.len(), 0.0);
        change
    }
}

/// Whether an effect adds a force between contact and load cell that depends on the motion alone.
fn is_added_to_the_load(id: EffectId) -> bool {
    let info = id.info();
    info.stage == ChainStage::LoadPath && !changes_the_load(id)
}

/// Whether an effect of the load path acts through others, or depends on the contact's force: it adds nothing by
/// itself in free air.
fn changes_the_load(id: EffectId) -> bool {
    id.needs().is_some()
}

/// A rig's path from the contact to the reading, which is all that a force in it has to pass: the contact takes most
/// of the time of a run. `None` if what it does to a force depends on the others.
fn path(rig: &Rig<f64>) -> Option<Rig<f64>> {
    let is_linear = |effect: &Effect<f64>| {
        effect.id() != EffectId::ForceSaturation && !changes_the_load(effect.id())
    };
    let stays = |effect: &Effect<f64>| {
        let stage = effect.id().info().stage;
        matches!(
            stage,
            ChainStage::PositionReading | ChainStage::ForceReading
        )
    };
    rig.effects().all(is_linear).then(|| Rig {
        environment: Environment::free(),
        effects: rig.effects.filtered(stays),
    })
}

/// Multiplies the sizes of an effect by what the residuals ask for, where its force is proportional to them.
fn scaled(mut term: Term, share: f64) -> Term {
    let facts = term.id.info();
    if facts.is_proportional(&term.row) {
        let share = if facts.sign == Sign::Either {
            share
        } else {
            share.max(0.05)
        };
        let factor = share.signum() * share.abs().clamp(0.02, 50.0);
        for (value, fit) in term.row.iter_mut().zip(facts.fits) {
            match fit.role {
                Role::Size => *value *= factor,
                Role::SizeUpTo(most) => *value = (*value * factor).min(most),
                Role::Shape | Role::Form(..) | Role::Switch(_) => {}
            }
        }
    }
    term
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::data::fit_data::FitData;
    use crate::gap::model::simulate::forces_of;
    use crate::log::Log;
    use estimator_core::physics::law::HuntCrossley;

    #[test]
    fn the_path_of_a_rig_changes_a_force_as_the_whole_rig_does() {
        // GIVEN presses of a millimetre into a material behind whatever a force in the load path has to pass
        let time: Vec<f64> = (0..800).map(|at| 2e-3 * f64::from(at)).collect();
        let position = time.iter().map(|t| 1e-3 * (9.0 * t).sin()).collect();
        let log = Log::from_channels(time, position, vec![0.0; 800]);
        let logs = [FitData::of(&log.uniform().unwrap())];
        let material = HuntCrossley {
            stiffness_n_per_m: 2e3,
            damping_ns_per_m: 5.0,
            exponent: 1.4,
            damping_exponent: 1.4,
            reference_depth_m: 1e-3,
        };
        let example = |id: EffectId| Effect::new(id, &id.info().example);
        let rig = Rig {
            environment: Environment::from(material),
            effects: [
                EffectId::EncoderPeriodicError,
                EffectId::CoulombFriction,
                EffectId::ForceLag,
                EffectId::TimeDelay,
            ]
            .map(example)
            .into_iter()
            .collect(),
        };
        let before = forces_of(&rig, &logs);
        let path = path(&rig).unwrap();
        let added = EffectId::ALL.iter().filter(|id| is_added_to_the_load(**id));
        let mut count = 0;
        for id in added {
            let whole = forces_of(&rig.with(example(*id)), &logs);
            let alone = forces_of(&path.with(example(*id)), &logs);
            let largest = alone
                .iter()
                .fold(0.0_f64, |most, force| most.max(force.abs()));
            for ((whole, before), alone) in whole.iter().zip(&before).zip(&alone) {
                let error_n = (whole - before - alone).abs();
                assert!(
                    error_n < 1e-9 * largest.max(1.0),
                    "{}: {error_n:e} N",
                    id.name()
                );
            }
            count += usize::from(largest > 0.0);
        }
        assert!(count >= 10, "{count} effects");
        // A friction that grows with the load and a limit of the reading see the contact as well.
        for id in [EffectId::LoadFriction, EffectId::ForceSaturation] {
            assert_eq!(super::path(&rig.with(example(id))), None);
        }
    }
}
