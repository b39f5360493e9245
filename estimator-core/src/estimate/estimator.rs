//! The whole loop on one screen: one sample in, one estimate out.

mod checks;

pub use checks::RANGE;

use checks::{DROPPED, NOT_LEARNED_FROM, faults, is_gap};

use crate::estimate::{
    Estimate, Event, Innovation, Phase, contact::Contact, contact::ContactState,
    contact::SurfacePosition, fault::Fault, fault::Faults, filter::FilterState, identify,
    identify::ForceNoise, identify::Identifier, identify::Instant, monitor::ConvergenceMonitor,
    params::Params, regularity::Regularity, sample::Sample, scaled::scaled, status::Doubt,
    status::Reason,
};
use crate::maths::scalar::Real;

/// Everything that the estimator remembers, as plain data: it can be copied, stored and replaced.
#[derive(Clone, Debug)]
pub struct State<T: Real = f32> {
    filter: FilterState<T>,
    regularity: Regularity<T>,
    contact: ContactState<T>,
    identifier: Identifier<T>,
    monitor: ConvergenceMonitor<T>,
    last_time_us: Option<u64>,
    /// Number of samples until the filter has forgotten a fault that must not be learned from.
    holdoff_samples: u32,
    learning: bool,
    last: Estimate<T>,
}

/// What a sample was good for.
#[derive(Clone, Copy)]
enum Learned<T> {
    /// Nothing: not in contact, too near the noise, or after a fault.
    Unusable,
    /// It repeats what was learned, as those of a hold do.
    Nothing,
    /// It was learned from, with this forgetting factor.
    From(T),
}

impl<T: Real> State<T> {
    /// The state before the first sample; a new state also resets an estimator.
    pub fn new(params: &Params<T>) -> Self {
        State {
            filter: FilterState::new(&params.filter),
            regularity: Regularity::default(),
            contact: ContactState::new(&params.contact),
            identifier: Identifier::new(&params.identify),
            monitor: ConvergenceMonitor::default(),
            last_time_us: None,
            holdoff_samples: 0,
            learning: true,
            last: Estimate::nothing(params.law()),
        }
    }

    /// Takes position (m) and force (N) as the sensors read them, before a [`step`] with a sample that went
    /// through the window of a [`Compensation`](crate::estimate::compensation::Compensation). Averages are no
    /// measure of the noise and of the counts, and with them standard errors would be ten times too small.
    pub fn observe_raw(&mut self, position_m: T, force_n: T) {
        self.contact.observe_raw(position_m, force_n);
    }

    /// Switches learning on or off; it is on at the start. While it is off the estimates stay as they
    /// are, and prediction, innovation and contact detection go on.
    pub fn enable_learning(&mut self, on: bool) {
        self.learning = on;
    }

    /// Forgets the material, as if nothing had been touched: values and covariance start again from
    /// [`Initial`](crate::estimate::config::Initial). Filter, resting force, noise and contact detection
    /// go on.
    pub fn reset_estimates(&mut self, params: &Params<T>) {
        self.identifier = Identifier::new(&params.identify);
        self.monitor = ConvergenceMonitor::default();
        self.last.parameters = Estimate::nothing(params.law()).parameters;
    }

    /// Mean force in free air (N), which is subtracted from every force; 0 while settling.
    pub fn resting_force_n(&self) -> T {
        self.contact.resting_force_n()
    }

    /// Position of the surface (m) that depths are measured from; `None` before the first touch.
    pub fn surface_m(&self, params: &Params<T>) -> Option<T> {
        let noise = ForceNoise::default();
        let surface = self.surface(params, &noise, self.contact.surface());
        surface.map(|surface| surface.position_m)
    }

    /// Standard deviation of the noise of the raw force (N), the unit of thresholds and standard errors.
    pub fn force_noise_n(&self) -> T {
        self.contact.force_noise_n()
    }
}

/// Smallest force that is learned from, in standard deviations of the filtered force.
const LEARN_SIGMAS: f64 = 6.0;
/// Largest depth and speed that are learned from, over the reference depth and speed: 1 m and 10 m/s at
/// 1 mm. The motion that follows from a jump of the encoder would otherwise settle the estimates for
/// good.
const PLAUSIBLE: f64 = 1e3;

/// So many samples of a touch may have agreed with the material before and yet be of another: near the surface all
/// forces are alike.
const AGREED_SAMPLES: u32 = 16;

/// Takes one sample and gives the estimate after it. It never panics and never allocates, and every
/// number of the estimate is finite whatever the sample contains.
pub fn step<T: Real>(params: &Params<T>, state: &mut State<T>, sample: Sample<T>) -> Estimate<T> {
    let elapsed_us = state.elapsed_us(params, &sample);
    let faults = faults(params, &sample, elapsed_us);
    if faults.intersects(DROPPED) {
        return Estimate {
            faults,
            event: None,
            forgetting: T::one(),
            ..state.last
        };
    }
    state.accept(params, &sample, elapsed_us, faults);
    let aligned = state.filter.update(&params.filter, &sample);
    let contact = state.contact.update(&params.contact, &sample);
    let speed_error = state.regularity.missing_share();
    let last_speed_mps = state.last.speed_mps;
    let instant = scaled(
        params,
        &aligned,
        &contact,
        elapsed_us,
        speed_error,
        last_speed_mps,
    );
    state.monitor.observe_phase(contact.phase);
    if contact.zero_was_wrong {
        state.reset_estimates(params);
    }
    let innovation = state.predict(&contact, &instant);
    let learned = state.learn(params, &contact, &instant, &innovation);
    let change = match learned {
        Learned::From(_) => state.assess(params, &contact, &instant, &innovation),
        Learned::Nothing => state.watch(params, &contact, &innovation),
        Learned::Unusable => None,
    };
    let estimate = Estimate {
        time_us: sample.time_us.saturating_sub(params.delay_us()),
        law: state.last.law,
        phase: contact.phase,
        status: state.monitor.status(),
        reason: state.monitor.reason(),
        depth_m: state.depth_m(params, &contact, &instant.noise, aligned.position_m),
        speed_mps: aligned.speed_mps,
        force_n: instant.force * params.identify.scale.force_n,
        parameters: state.last.parameters,
        innovation: innovation.in_newtons(params.identify.scale.force_n),
        forgetting: match learned {
            Learned::From(beta) => beta,
            _ => T::one(),
        },
        event: change.or(contact.event()),
        faults,
    };
    state.keep(params, estimate)
}

impl<T: Real> State<T> {
    /// Time since the last sample that was used (µs); one period at the first sample.
    fn elapsed_us(&self, params: &Params<T>, sample: &Sample<T>) -> u64 {
        match self.last_time_us {
            Some(last) => sample.time_us.saturating_sub(last),
            None => params.period_us,
        }
    }

    /// Restarts the filter where the signals jump, and holds off learning until the filter has forgotten
    /// a fault.
    fn accept(&mut self, params: &Params<T>, sample: &Sample<T>, elapsed_us: u64, faults: Faults) {
        self.last_time_us = Some(sample.time_us);
        let gap = is_gap(params, elapsed_us) || faults.has(Fault::PositionJump);
        let count_m = self.contact.count_m();
        let hops = self.regularity.update(sample.position_m, gap, count_m);
        if gap || hops {
            self.filter.restart(sample);
        }
        self.holdoff_samples = if hops || faults.intersects(NOT_LEARNED_FROM) {
            params.filter.response().memory_samples
        } else {
            self.holdoff_samples.saturating_sub(1)
        };
    }

    /// The surface that the estimator has found, otherwise that of the contact detector.
    fn surface(
        &self,
        params: &Params<T>,
        noise: &ForceNoise<T>,
        of_contact: Option<SurfacePosition<T>>,
    ) -> Option<SurfacePosition<T>> {
        if params.contact.surface_known() {
            return of_contact;
        }
        let found = self.identifier.surface(&params.identify, noise);
        found.or(of_contact)
    }

    /// Penetration (m); 0 before a surface is known.
    fn depth_m(
        &self,
        params: &Params<T>,
        contact: &Contact<T>,
        noise: &ForceNoise<T>,
        position_m: T,
    ) -> T {
        match self.surface(params, noise, contact.surface) {
            Some(surface) => position_m - surface.position_m,
            None => T::zero(),
        }
    }

    /// Compares prediction and observation in scaled units; gives zero outside contact.
    fn predict(&self, contact: &Contact<T>, at: &Instant<T>) -> Innovation<T> {
        if contact.phase != Phase::Contact {
            return Innovation::default();
        }
        let (prediction, model_variance) = self.identifier.predict(at);
        Innovation::new(
            at.force,
            prediction,
            at.noise.filtered * at.noise.filtered + model_variance,
        )
    }

    /// Learns from the instant if it is usable: the whole window of the filter must lie inside the
    /// contact, and the force above the noise.
    fn learn(
        &mut self,
        params: &Params<T>,
        contact: &Contact<T>,
        at: &Instant<T>,
        innovation: &Innovation<T>,
    ) -> Learned<T> {
        let filled = contact.loaded_samples >= params.filter.response().memory_samples;
        let known = contact.loaded_from_surface
            && contact.loaded_samples > 0
            && self.identifier.is_inside(at);
        let inside = (filled || known) && self.holdoff_samples == 0;
        let above_noise = at.force > T::from_f64(LEARN_SIGMAS) * at.noise.filtered;
        let widest = T::from_f64(PLAUSIBLE);
        let plausible = at.depth.abs() < widest && at.speed.abs() < widest;
        let usable = self.learning && inside && above_noise && plausible;
        if !usable {
            let in_contact = contact.phase == Phase::Contact;
            self.identifier.observe(at, in_contact);
            return Learned::Unusable;
        }
        let error_n = innovation.innovation_n * params.identify.scale.force_n;
        let beta = params
            .identify
            .forgetting
            .beta(error_n, contact.force_noise_n);
        let learned = self.identifier.learn(&params.identify, at, beta);
        if self.identifier.has_come_back() {
            self.monitor.forget_innovations();
        }
        learned.map_or(Learned::Nothing, Learned::From)
    }

    /// Watches a hold; gives a change of the material.
    fn watch(
        &mut self,
        params: &Params<T>,
        contact: &Contact<T>,
        innovation: &Innovation<T>,
    ) -> Option<Event> {
        let looks_back = self.identifier.excess().is_some();
        let event = (self.monitor).watch(&params.monitor, innovation, looks_back);
        self.begin_anew_after(params, event, contact, 0)
    }

    /// Updates the status and the parameters that are reported; gives a change of the material.
    fn assess(
        &mut self,
        params: &Params<T>,
        contact: &Contact<T>,
        at: &Instant<T>,
        innovation: &Innovation<T>,
    ) -> Option<Event> {
        let surface = self
            .surface(params, &at.noise, contact.surface)
            .unwrap_or_default();
        let mut estimates = self.identifier.estimates(at);
        // What the law does not explain makes every parameter less certain.
        let excess = self.identifier.excess();
        let inflation = self.monitor.inflation(excess);
        estimates
            .iter_mut()
            .for_each(|parameter| parameter.std_error *= inflation);
        let doubt = match contact.zero_seen {
            true if contact.pulls => Some(Doubt::Against(Reason::Law)),
            true => self.identifier.doubt(at),
            false => Some(Doubt::Against(Reason::Zero)),
        };
        let law = self.identifier.law(&params.identify);
        // The last parameter of every law is the surface.
        let estimates = estimates.get(..law.parameters().len() - 1).unwrap_or(&[]);
        let event = self
            .monitor
            .update(&params.monitor, estimates, innovation, excess, doubt);
        self.last.law = law;
        self.last.parameters = identify::report(&params.identify, law, estimates, surface);
        let waited = excess.map_or(0, |_| params.monitor.change_samples());
        self.begin_anew_after(params, event, contact, waited)
    }

    /// Begins anew after a change of the material that was noticed at least `waited` samples after it.
    fn begin_anew_after(
        &mut self,
        params: &Params<T>,
        event: Option<Event>,
        contact: &Contact<T>,
        waited: u32,
    ) -> Option<Event> {
        if event == Some(Event::MaterialChange) {
            let memory_samples = params.filter.response().memory_samples;
            // Of a touch that was another from its first samples on, all that was seen is of another material.
            let since_touch = contact.loaded_samples <= memory_samples + waited + AGREED_SAMPLES;
            self.identifier
                .reset_covariance(&params.identify, since_touch);
            // Until then the filter's window straddles the change.
            self.holdoff_samples = memory_samples.saturating_sub(waited);
        }
        event
    }

    /// Keeps the estimate for the next sample, or starts anew if it is not finite.
    fn keep(&mut self, params: &Params<T>, estimate: Estimate<T>) -> Estimate<T> {
        if estimate.is_finite() {
            self.last = estimate;
            return estimate;
        }
        self.filter = FilterState::new(&params.filter);
        self.identifier = Identifier::new(&params.identify);
        self.monitor = ConvergenceMonitor::default();
        self.holdoff_samples = params.filter.response().memory_samples;
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

#[cfg(test)]
mod changes;

#[cfg(test)]
mod tests;
