//! What a run was like: what the operator felt against what there was to feel, energy, stability, times.

pub mod energy;
pub mod felt;
pub mod settling;
pub mod stability;
pub mod transparency;

use estimator_core::board::reflection::Limit;

use self::felt::NotCompared;
use self::stability::Rest;
use super::environment::Environment;
use super::options::Options;
use super::system::System;
use super::trace::{Parameters, Trace};
use crate::stats::{highest, rms};

/// The measures of a run; those of the felt force are of the first material. The true force is that of the material at
/// the master's own position, times the factor of a scheme that shapes it on purpose.
#[derive(Clone, Debug, PartialEq)]
pub struct Measures {
    /// Length of the run (s).
    pub duration_s: f64,
    /// RMS of felt minus true force over the peak of the true one, once the scheme has what it needs: an
    /// impedance that has converged and arrived, or the first forces of a touch. `None`: it never had.
    pub felt_force_rmse_share: Option<f64>,
    /// Why there is no such share.
    pub felt_force_not_compared: Option<NotCompared>,
    /// Felt minus true force over every contact, rms over peak from the first touch on.
    pub felt_force_rmse_share_whole: f64,
    /// The first of these of the second material.
    pub felt_force_rmse_share_after: Option<f64>,
    /// Felt stiffness over the true one, minus 1; `None` where the motion determines none.
    pub felt_stiffness_error: Option<f64>,
    /// Felt damping over the true one, minus 1.
    pub felt_damping_error: Option<f64>,
    /// RMS of the slave's position against the master's one delay ago (m).
    pub position_rmse_m: f64,
    /// Whether the system comes to rest in the last press, on the material that is there then.
    pub rest: Rest,
    /// Whether it does on the first material, where the last press is on the second; from a run of its own.
    pub rest_first: Option<Rest>,
    /// How fast a motion in the last press decays (1/s); negative: it grows.
    pub decay_per_s: f64,
    /// Energy that coupling and master together have given to the hand without having got it, beyond what exchanges of
    /// impedances declare (J): what the coupling creates and the master's own damping takes is none.
    pub created_energy_j: f64,
    /// The same before the master's own damping: energy that the coupling alone has given out (J).
    pub coupling_energy_j: f64,
    /// The largest sum of V_new − V_old that was declared (J).
    pub exchanged_energy_j: f64,
    /// The largest force on the material within 0.3 s of the first touch (N).
    pub peak_touch_n: f64,
    /// The same of the first touch after the change; `None` without one.
    pub peak_change_n: Option<f64>,
    /// Contact of the slave and the way back until the felt force is within 5 % (s); `None`: never.
    pub settled_s: Option<f64>,
    /// The same after the change.
    pub resettled_s: Option<f64>,
    /// The share of the contact in which each limit of the renderer was at work; those that were.
    pub limits: Vec<(&'static str, f64)>,
    /// Messages sent both ways, lost, and rejected or overtaken.
    pub packets: Packets,
    /// How old what each end applies is on average, from master to slave and back (s).
    pub ages_s: [Option<f64>; 2],
    /// When the second material took the place of the first (s); `None`: it never did.
    pub changed_s: Option<f64>,
    /// The hand as identified at the end: stiffness, damping, mass.
    pub hand: Option<Parameters>,
}

impl Measures {
    /// Whether the system comes to rest, on each material.
    pub fn rests(&self) -> Rest {
        self.rest_first
            .map_or(self.rest, |first| first.and(self.rest))
    }
}

/// What became of the messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Packets {
    /// Sent, both ways.
    pub sent: u64,
    /// Never arrived.
    pub lost: u64,
    /// Of these, what a limited rate could not carry.
    pub lost_to_rate: u64,
    /// Arrived after a newer one, or refused by a board.
    pub rejected: u64,
    /// Bytes a second, the busier way.
    pub bytes_per_s: u64,
}

/// Runs a system and measures it. Where the last press is on the second material, a shorter run presses into the first.
pub fn run(options: &Options, seed: u64) -> (Trace, Measures) {
    let trace = System::new(options, seed).run();
    let mut measures = measure(&trace);
    measures.rest = stability::rest_of(options, seed, &trace);
    let changed = trace.changed_s.is_some();
    measures.rest_first = changed.then(|| rest_on_the_first(options, seed));
    (trace, measures)
}

/// Whether the system comes to rest on the first material: two cycles of the task for the estimate to converge, slid off,
/// a cycle, and the press.
pub fn rest_on_the_first(options: &Options, seed: u64) -> Rest {
    let mut options = options.clone();
    let mut task = options.task.unwrap_or_default();
    let cycle_s = 1.0 / task.frequency_hz;
    (task.palpates_s, task.changes_s) = ((2.0 * cycle_s, cycle_s), None);
    options.task = Some(task);
    options.environment = Environment::throughout(options.environment.first);
    let options = options.with_task_for_delay();
    stability::rest_of(&options, seed, &System::new(&options, seed).run())
}

/// Measures a run by itself: whether a system that still moves would come to rest later, only [`run`] tells.
pub fn measure(trace: &Trace) -> Measures {
    let each = felt::felt(trace);
    let felt = each.first().copied().unwrap_or_default();
    Measures {
        duration_s: trace.rows.len() as f64 * trace.period_s,
        felt_force_rmse_share: felt.share,
        felt_force_not_compared: felt.not_compared,
        felt_force_rmse_share_whole: felt.whole,
        felt_force_rmse_share_after: each.get(1).and_then(|felt| felt.share),
        felt_stiffness_error: felt.stiffness_error,
        felt_damping_error: felt.damping_error,
        position_rmse_m: position_rmse_m(trace),
        rest: stability::rest(trace),
        rest_first: None,
        decay_per_s: stability::decay_per_s(trace),
        created_energy_j: energy::created_j(trace),
        coupling_energy_j: energy::of_the_coupling_j(trace),
        exchanged_energy_j: highest(trace.rows.iter().map(|row| row.exchanged_j)).max(0.0),
        peak_touch_n: settling::peak_touch_n(trace, 0.0).unwrap_or(0.0),
        peak_change_n: trace
            .changed_s
            .and_then(|changed_s| settling::peak_touch_n(trace, changed_s)),
        settled_s: settling::settled_s(trace),
        resettled_s: settling::resettled_s(trace),
        limits: limits(trace),
        packets: packets(trace),
        ages_s: trace.ages_s,
        changed_s: trace.changed_s,
        hand: trace.rows.last().and_then(|row| row.hand),
    }
}

fn position_rmse_m(trace: &Trace) -> f64 {
    let late = (trace.delays_s[0] / trace.period_s).round() as usize;
    let pairs = trace.rows.iter().skip(late).zip(&trace.rows);
    rms(pairs.map(|(now, then)| now.slave_m - then.master_m))
}

fn limits(trace: &Trace) -> Vec<(&'static str, f64)> {
    let contact: Vec<u8> = trace
        .rows
        .iter()
        .filter(|row| row.felt_n > felt::TOUCH_N)
        .map(|row| row.limits)
        .collect();
    let share = |limit: Limit| {
        let at_work = contact.iter().filter(|bits| **bits & limit as u8 != 0);
        at_work.count() as f64 / contact.len().max(1) as f64
    };
    let all = Limit::ALL
        .into_iter()
        .map(|limit| (limit.name(), share(limit)));
    all.filter(|(_, share)| *share > 0.0).collect()
}

fn packets(trace: &Trace) -> Packets {
    let sum = |of: fn(&super::channel::Counts) -> u64| trace.counts.iter().map(of).sum::<u64>();
    let seconds = trace.rows.len() as f64 * trace.period_s;
    let busier = trace
        .counts
        .iter()
        .map(|counts| counts.bytes)
        .max()
        .unwrap_or(0);
    let refused = trace.rows.last().map_or(0, |row| row.refused);
    Packets {
        sent: sum(|counts| counts.sent),
        lost: sum(|counts| counts.lost),
        lost_to_rate: sum(|counts| counts.lost_to_rate),
        rejected: sum(|counts| counts.overtaken) + refused,
        bytes_per_s: (busier as f64 / seconds.max(1e-3)).round() as u64,
    }
}
