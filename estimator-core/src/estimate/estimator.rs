//! The whole loop on one screen.

use crate::estimate::contact::{Contact, ContactState, SurfacePosition};
use crate::estimate::fault::{Fault, Faults};
use crate::estimate::filter::{Aligned, FilterState};
use crate::estimate::identify::{self, ForceNoise, Identifier, Instant};
use crate::estimate::monitor::ConvergenceMonitor;
use crate::estimate::params::Params;
use crate::estimate::sample::Sample;
use crate::estimate::{Estimate, Event, Innovation, Phase};
use crate::maths::scalar::Real;

/// All that the estimator remembers. Plain data: copy it, keep it, throw it away.
#[derive(Clone, Debug)]
pub struct State<T: Real = f32> {
    filter: FilterState<T>,
    contact: ContactState<T>,
    identifier: Identifier<T>,
    monitor: ConvergenceMonitor<T>,
    last_time_us: Option<u64>,
    /// Samples until the filter has forgotten something that must not be learned from.
    holdoff_samples: u32,
    learning: bool,
    last: Estimate<T>,
}

impl<T: Real> State<T> {
    /// Before the first sample; also how an estimator is reset.
    pub fn new(params: &Params<T>) -> Self {
        State {
            filter: FilterState::new(&params.filter),
            contact: ContactState::new(&params.contact),
            identifier: Identifier::new(&params.identify),
            monitor: ConvergenceMonitor::new(),
            last_time_us: None,
            holdoff_samples: 0,
            learning: true,
            last: Estimate::nothing(params.law()),
        }
    }

    /// The force (N) as the load cell read it, before a sample that went through the window of a
    /// [`crate::estimate::compensation::Compensation`]: what is averaged there is no measure of the noise any more, and
    /// the estimates would look ten times better than they are.
    pub fn observe_raw_force(&mut self, force_n: T) {
        self.contact.observe_raw_force(force_n);
    }

    /// Whether samples teach: on at the start. Off, the estimates stay as they are, and prediction,
    /// innovation and contact go on.
    pub fn enable_learning(&mut self, on: bool) {
        self.learning = on;
    }

    /// Forgets the material, values and covariance, as if nothing had been touched: they start again
    /// from [`crate::estimate::config::Initial`]. Filter, resting force, noise and contact go on.
    pub fn reset_estimates(&mut self, params: &Params<T>) {
        self.identifier = Identifier::new(&params.identify);
        self.monitor = ConvergenceMonitor::new();
        self.last.parameters = Estimate::nothing(params.law()).parameters;
    }

    /// What the force reads in free air (N), as it is taken off now; 0 while settling.
    pub fn resting_force_n(&self) -> T {
        self.contact.resting_force_n()
    }

    /// Position of the surface (m) that depths are measured from, once there is one.
    pub fn surface_m(&self, params: &Params<T>) -> Option<T> {
        if params.contact.surface_known() {
            return self.contact.surface_m();
        }
        let found = self
            .identifier
            .surface(&params.identify, &ForceNoise::default())
            .map(|surface| surface.position_m);
        found.or(self.contact.surface_m())
    }

    /// Standard deviation of the raw force (N) that thresholds and standard errors rest on.
    pub fn force_noise_n(&self) -> T {
        self.contact.force_noise_n()
    }
}

/// A sample is usable when its force and position are within this many times the reference force and
/// depth: beyond it, squares would leave the range of single precision.
pub const RANGE: f64 = 1e6;
/// An instant is learned from when its force is above this many standard deviations.
const LEARN_SIGMAS: f64 = 6.0;
/// An instant is learned from within this many reference depths and speeds: 1 m and 10 m/s at 1 mm.
/// What an encoder that jumps makes of the motion would otherwise settle the estimates for good.
const PLAUSIBLE: f64 = 1e3;
/// Standard deviation of the error of a count, in counts: 1/√12.
const COUNT_ERROR: f64 = 0.288_675_134_594_812_9;
/// Most samples that a count of the encoder is taken to last: what a hold is worth.
const LONGEST_COUNT: f64 = 256.0;
/// Least standard error of a surface from an impact, over the reference depth: 5 µm at 1 mm.
const IMPACT_FLOOR: f64 = 5e-3;

/// With one of these, a sample goes through filters and contact detection, but is not learned from,
/// nor is anything that the filter still remembers of it.
const NOT_LEARNED_FROM: [Fault; 5] = [
    Fault::SampleMissed,
    Fault::ForceSaturated,
    Fault::ForceStuck,
    Fault::PositionJump,
    Fault::PositionStuck,
];

/// Takes one sample and says what is known after it. Never panics, never allocates; every number in
/// the result is finite, whatever comes in.
pub fn step<T: Real>(params: &Params<T>, state: &mut State<T>, sample: Sample<T>) -> Estimate<T> {
    let elapsed_s = state.elapsed_s(params, &sample);
    let faults = state.admit(params, &sample);
    if is_dropped(faults) {
        return Estimate {
            faults,
            event: None,
            forgetting: T::one(),
            ..state.last
        };
    }
    let aligned = state.filter.update(&params.filter, &sample);
    let contact = state.contact.update(&params.contact, &sample);
    let (instant, noise) = scaled(params, &aligned, &contact);
    let instant = Instant {
        elapsed_s,
        ..instant
    };
    if contact.phase == Phase::Contact {
        state.monitor.touched();
    }
    let innovation = state.predict(params, &contact, &instant, &noise);
    let learned = state.learn(params, &contact, &instant, &noise, &innovation);
    let change = learned.and_then(|_| state.assess(params, &contact, &noise, &innovation));
    let estimate = Estimate {
        time_us: sample.time_us.saturating_sub(params.delay_us()),
        law: state.last.law,
        phase: contact.phase,
        status: state.monitor.status(),
        depth_m: state.depth_m(params, &contact, &aligned),
        speed_mps: aligned.speed_mps,
        force_n: instant.force * params.identify.scale.force_n,
        parameters: state.last.parameters,
        innovation: innovation.in_newtons(params.identify.scale.force_n),
        forgetting: learned.unwrap_or(T::one()),
        event: change.or(contact.event()),
        faults,
    };
    state.keep(params, estimate)
}

impl<T: Real> State<T> {
    /// Since the last sample that was used (s).
    fn elapsed_s(&self, params: &Params<T>, sample: &Sample<T>) -> T {
        let elapsed_us = match self.last_time_us {
            Some(last) => sample.time_us.saturating_sub(last),
            None => params.period_us,
        };
        T::from_f64(1e-6 * elapsed_us as f64)
    }

    /// What is wrong with the sample; restarts the filters after a gap.
    fn admit(&mut self, params: &Params<T>, sample: &Sample<T>) -> Faults {
        let mut faults = sample.faults;
        if !within(sample.force_n, params.identify.scale.force_n) {
            faults = faults.with(Fault::ForceUnusable);
        }
        if !within(sample.position_m, params.identify.scale.depth_m) {
            faults = faults.with(Fault::PositionUnusable);
        }
        let elapsed = self
            .last_time_us
            .map(|last| sample.time_us.saturating_sub(last));
        if elapsed == Some(0) {
            faults = faults.with(Fault::TimeNotAdvancing);
        }
        if is_dropped(faults) {
            return faults;
        }
        self.last_time_us = Some(sample.time_us);
        if elapsed.is_some_and(|elapsed| elapsed > params.period_us + params.period_us / 2) {
            faults = faults.with(Fault::SampleMissed);
            self.filter.restart(sample);
        } else if faults.has(Fault::PositionJump) {
            self.filter.restart(sample);
        }
        self.holdoff_samples = self.holdoff_samples.saturating_sub(1);
        if NOT_LEARNED_FROM.iter().any(|fault| faults.has(*fault)) {
            self.holdoff_samples = params.filter.memory_samples();
        }
        faults
    }

    /// The surface as the estimator finds it, else as the contact detector does.
    fn surface(&self, params: &Params<T>, contact: &Contact<T>) -> Option<SurfacePosition<T>> {
        if params.contact.surface_known() {
            return contact.surface;
        }
        let noise = force_noise(params, contact);
        self.identifier
            .surface(&params.identify, &noise)
            .or(contact.surface)
    }

    /// Penetration (m); 0 while no surface is known.
    fn depth_m(&self, params: &Params<T>, contact: &Contact<T>, aligned: &Aligned<T>) -> T {
        match self.surface(params, contact) {
            Some(surface) => aligned.position_m - surface.position_m,
            None => T::zero(),
        }
    }

    /// Prediction against observation, scaled; nothing outside contact.
    fn predict(
        &self,
        params: &Params<T>,
        contact: &Contact<T>,
        at: &Instant<T>,
        noise: &ForceNoise<T>,
    ) -> Innovation<T> {
        if contact.phase != Phase::Contact {
            return Innovation::default();
        }
        let (prediction, model_variance) =
            self.identifier
                .predict(at, noise, surface_error(params, contact));
        Innovation::new(
            at.force,
            prediction,
            noise.filtered * noise.filtered + model_variance,
        )
    }

    /// Learns if there is something to learn from, and gives the forgetting factor that it used.
    /// The whole window of the filter must lie inside the contact, and the force above the noise.
    fn learn(
        &mut self,
        params: &Params<T>,
        contact: &Contact<T>,
        at: &Instant<T>,
        noise: &ForceNoise<T>,
        innovation: &Innovation<T>,
    ) -> Option<T> {
        let filled = contact.run >= params.filter.memory_samples();
        let known = contact.fresh && contact.run > 0 && self.identifier.is_inside(at);
        let inside = (filled || known) && self.holdoff_samples == 0;
        let above = at.force > T::from_f64(LEARN_SIGMAS) * noise.filtered;
        let widest = T::from_f64(PLAUSIBLE);
        let plausible = at.depth.abs() < widest && at.speed.abs() < widest;
        let usable = self.learning && inside && above && plausible;
        let touching = contact.phase == Phase::Contact;
        self.identifier.follow(at, noise, usable, touching);
        if !usable {
            return None;
        }
        let error_n = innovation.innovation_n * params.identify.scale.force_n;
        let beta = params.identify.forgetting.beta(error_n, contact.noise_n);
        self.identifier.learn(&params.identify, at, noise, beta)
    }

    /// What the new parameters are worth; refreshes the ones that are reported.
    fn assess(
        &mut self,
        params: &Params<T>,
        contact: &Contact<T>,
        noise: &ForceNoise<T>,
        innovation: &Innovation<T>,
    ) -> Option<Event> {
        let surface = self.surface(params, contact).unwrap_or_default();
        let mut estimates = self
            .identifier
            .estimates(noise, surface_error(params, contact));
        // What the law does not explain makes every parameter less certain.
        let misfit = self.monitor.misfit();
        estimates
            .iter_mut()
            .for_each(|parameter| parameter.std_error *= misfit);
        let law = self.identifier.law(&params.identify);
        let own = estimates.get(..law.parameters().len() - 1).unwrap_or(&[]);
        let event = self
            .monitor
            .update(&params.monitor, own, innovation.test_ratio);
        self.last.law = law;
        self.last.parameters = identify::report(&params.identify, law, own, surface);
        if event == Some(Event::MaterialChange) {
            self.identifier.reset_covariance(&params.identify);
        }
        event
    }

    /// Keeps the record for the next sample, or starts anew if it is not finite.
    fn keep(&mut self, params: &Params<T>, estimate: Estimate<T>) -> Estimate<T> {
        if estimate.is_finite() {
            self.last = estimate;
            return estimate;
        }
        self.filter = FilterState::new(&params.filter);
        self.identifier = Identifier::new(&params.identify);
        self.monitor = ConvergenceMonitor::new();
        self.holdoff_samples = params.filter.memory_samples();
        self.last = Estimate::nothing(params.law());
        let faults = estimate.faults.with(Fault::NotFinite);
        Estimate {
            time_us: estimate.time_us,
            faults,
            event: None,
            ..self.last
        }
    }
}

fn within<T: Real>(value: T, reference: T) -> bool {
    value.abs() < T::from_f64(RANGE) * reference
}

fn is_dropped(faults: Faults) -> bool {
    [
        Fault::ForceUnusable,
        Fault::PositionUnusable,
        Fault::TimeNotAdvancing,
    ]
    .into_iter()
    .any(|fault| faults.has(fault))
}

/// Standard error of the surface position, scaled. An impact is never known better than its floor, a
/// surface that is told no better than the encoder can place it: a count is 1/√12 uncertain.
fn surface_error<T: Real>(params: &Params<T>, contact: &Contact<T>) -> T {
    let own = contact.surface.unwrap_or_default().std_error_m / params.identify.scale.depth_m;
    if params.contact.surface_known() {
        contact.position_step_m * T::from_f64(COUNT_ERROR) / params.identify.scale.depth_m
    } else {
        own.max_of(T::from_f64(IMPACT_FLOOR))
    }
}

/// The aligned signals and the noise in the scales of the estimators.
fn scaled<T: Real>(
    params: &Params<T>,
    aligned: &Aligned<T>,
    contact: &Contact<T>,
) -> (Instant<T>, ForceNoise<T>) {
    let scale = &params.identify.scale;
    let surface = match contact.surface {
        Some(surface) => surface.position_m,
        None => aligned.position_m,
    };
    let instant = Instant {
        depth: (aligned.position_m - surface) / scale.depth_m,
        speed: aligned.speed_mps / scale.speed_mps,
        force: (aligned.force_n - contact.rest_n) / scale.force_n,
        surface: surface / scale.depth_m,
        surface_error: surface_error(params, contact),
        spread: aligned.spread_m2 / (scale.depth_m * scale.depth_m),
        coupling: aligned.coupling_m2ps / (scale.depth_m * scale.speed_mps),
        elapsed_s: T::zero(),
        rate: aligned.force_rate_nps * scale.depth_m / (scale.speed_mps * scale.force_n),
        jitter: jitter_m2(params, aligned, contact) / (scale.depth_m * scale.depth_m),
        rest_error: contact.rest_error_n / scale.force_n,
    };
    (instant, force_noise(params, contact))
}

/// Variance that the counts of an encoder give an instant (m²): q²/12, times the samples that a count
/// lasts, since they all err alike.
fn jitter_m2<T: Real>(params: &Params<T>, aligned: &Aligned<T>, contact: &Contact<T>) -> T {
    let step_m = contact.position_step_m;
    let moved_m = aligned.speed_mps.abs() * params.period_s;
    let error_m = step_m * T::from_f64(COUNT_ERROR);
    let lasts = T::one().max_of(step_m / (moved_m + step_m * T::from_f64(1.0 / LONGEST_COUNT)));
    error_m * error_m * lasts
}

/// What the force channel is worth, scaled.
fn force_noise<T: Real>(params: &Params<T>, contact: &Contact<T>) -> ForceNoise<T> {
    let raw = contact.noise_n / params.identify.scale.force_n;
    ForceNoise {
        raw,
        filtered: raw * params.filter.noise_gain().sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::config::{Config, Surface};
    use crate::estimate::status::Status;
    use crate::physics::law::{ContactLaw, HuntCrossley};

    fn params() -> Params<f32> {
        let mut config = Config::default();
        config.contact.surface = Surface::Known { position_m: 0.0 };
        config.contact.force_noise_n = Some(0.02);
        config.validate().unwrap()
    }

    /// Sample number `i` of 0.5 s of rest and then 1.2 Hz strokes to 3 mm on gel, 5 mN steps.
    fn stroke(i: u32) -> Sample<f32> {
        let gel = HuntCrossley::new(1350.0_f64, 36.0, 1.35, 1e-3);
        let omega = core::f64::consts::TAU * 1.2;
        let angle = omega * (f64::from(i.max(500)) - 500.0) * 1e-3;
        let position_m = -5e-4 + 1.75e-3 * (1.0 - libm::cos(angle));
        let force_n = gel.force_n(position_m, 1.75e-3 * omega * libm::sin(angle));
        Sample {
            time_us: u64::from(i + 1) * 1000,
            position_m: position_m as f32,
            force_n: (libm::round(force_n / 5e-3) * 5e-3) as f32,
            faults: Faults::NONE,
        }
    }

    fn run(state: &mut State<f32>, samples: core::ops::Range<u32>) -> Estimate<f32> {
        let params = params();
        samples
            .map(|i| step(&params, state, stroke(i)))
            .last()
            .unwrap()
    }

    #[test]
    fn gel_is_found_from_nothing() {
        let mut state = State::new(&params());
        let end = run(&mut state, 0..7000);
        assert_eq!(end.status, Status::Converged);
        let value = |slot: usize| end.parameters[slot].unwrap().value;
        // The two stages' own error on gel: 0.3 % (median of 200 materials 0.5 %).
        assert!((value(0) / 1350.0 - 1.0).abs() < 0.02, "{}", value(0));
        assert!((value(1) / 36.0 - 1.0).abs() < 0.02, "{}", value(1));
        assert!((value(2) / 1.35 - 1.0).abs() < 0.02, "{}", value(2));
    }

    #[test]
    fn learning_can_be_switched_off_and_the_estimates_cleared() {
        let params = params();
        let mut state = State::new(&params);
        let learned = run(&mut state, 0..3000);
        state.enable_learning(false);
        let held = run(&mut state, 3000..4000);
        assert_eq!(held.parameters, learned.parameters);
        assert!(held.innovation.variance_n2 > 0.0 || held.phase != Phase::Contact);
        state.enable_learning(true);
        assert_ne!(run(&mut state, 4000..4500).parameters, learned.parameters);
        state.reset_estimates(&params);
        assert_eq!(run(&mut state, 4500..4501).parameters[0], None);
        let anew = run(&mut state, 4501..7000).parameters[0].unwrap().value;
        // What gel_is_found_from_nothing allows.
        assert!((anew / 1350.0 - 1.0).abs() < 0.02, "{anew}");
    }

    #[test]
    fn what_is_not_a_number_is_dropped_and_changes_nothing() {
        let params = params();
        let mut state = State::new(&params);
        run(&mut state, 0..3000);
        let mut disturbed = state.clone();
        let bad = [
            (f32::NAN, 0.0),
            (f32::INFINITY, 0.0),
            (0.0, f32::NAN),
            (1e30, 0.0),
            (0.0, 1e30),
        ];
        for (i, (force_n, position_m)) in bad.into_iter().enumerate() {
            let time_us = 3_000_001 + i as u64;
            let faults = Faults::NONE;
            let out = step(
                &params,
                &mut disturbed,
                Sample {
                    time_us,
                    position_m,
                    force_n,
                    faults,
                },
            );
            assert!(out.is_finite());
            let fault = if position_m == 0.0 {
                Fault::ForceUnusable
            } else {
                Fault::PositionUnusable
            };
            assert!(out.faults.has(fault), "{:?}", out.faults);
        }
        assert_eq!(run(&mut state, 3000..4000), run(&mut disturbed, 3000..4000));
    }

    #[test]
    fn time_that_stands_still_or_runs_back_is_dropped() {
        let params = params();
        let mut state = State::new(&params);
        run(&mut state, 0..3000);
        for i in [2999, 17] {
            let out = step(&params, &mut state, stroke(i));
            assert_eq!(out.faults, Faults::NONE.with(Fault::TimeNotAdvancing));
        }
    }

    #[test]
    fn after_a_gap_the_filter_window_is_refilled_before_anything_is_learned() {
        let params = params();
        let mut state = State::new(&params);
        run(&mut state, 0..900);
        let after = step(&params, &mut state, stroke(920));
        assert_eq!(after.faults, Faults::NONE.with(Fault::SampleMissed));
        assert_eq!(after.phase, Phase::Contact);
        // 17 samples of window, the first of them the one after the gap.
        assert_eq!(run(&mut state, 921..936).forgetting, 1.0);
        assert!(run(&mut state, 936..956).forgetting < 1.0);
    }

    #[test]
    fn every_fault_of_the_sensor_is_passed_on() {
        let params = params();
        let mut state = State::new(&params);
        let faults = Faults::NONE
            .with(Fault::Overrun)
            .with(Fault::ForceSaturated);
        let out = step(
            &params,
            &mut state,
            Sample {
                faults,
                ..stroke(0)
            },
        );
        assert_eq!(out.faults, faults);
    }

    /// Fault × what the estimate does with a sample that a board reports it for, in the middle of a
    /// stroke: dropped, learned from, and for how many samples nothing is learned.
    #[test]
    fn what_an_estimate_does_with_each_reported_fault() {
        let memory = 17;
        let table = [
            (Fault::ForceUnusable, true, 0),
            (Fault::PositionUnusable, true, 0),
            (Fault::TimeNotAdvancing, true, 0),
            (Fault::SampleMissed, false, memory),
            (Fault::ForceSaturated, false, memory),
            (Fault::Overrun, false, 0),
            (Fault::NotFinite, false, 0),
            (Fault::ForceStuck, false, memory),
            (Fault::PositionJump, false, memory),
            (Fault::PositionStuck, false, memory),
            (Fault::SettingsInvalid, false, 0),
            (Fault::NotCalibrated, false, 0),
            (Fault::EstimatorSuspect, false, 0),
            (Fault::ClockInternal, false, 0),
            (Fault::RenderStopped, false, 0),
            (Fault::RenderUnusable, false, 0),
        ];
        assert_eq!(table.map(|(fault, ..)| fault), Fault::ALL);
        let params = params();
        for (fault, dropped, unlearned) in table {
            let mut state = State::new(&params);
            // On the way down into the gel, where every sample is learned from.
            let before = run(&mut state, 0..800);
            assert!(before.phase == Phase::Contact && before.forgetting < 1.0);
            let faults = Faults::NONE.with(fault);
            let bad = Sample {
                faults,
                ..stroke(800)
            };
            let out = step(&params, &mut state, bad);
            assert!(out.faults.has(fault) && out.is_finite());
            assert_eq!(out.time_us == before.time_us, dropped, "{fault:?}");
            // A dropped sample leaves a hole of one period: the next one counts as missed after 1.5.
            let last = (0..60)
                .filter(|i| step(&params, &mut state, stroke(801 + i)).forgetting == 1.0)
                .last();
            let quiet = last.map_or(0, |i| i + 2);
            let expected = if dropped { memory + 1 } else { unlearned };
            assert_eq!(quiet, expected, "{fault:?}");
        }
    }
}
