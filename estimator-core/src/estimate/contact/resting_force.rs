//! The resting force: what the load cell reads in free air, and whether it has ever been seen there.
//!
//! A board that is switched on in contact takes the contact force for zero. Nothing in the force of a rest
//! says so; motion does. Air lets the probe travel while the force stays, so a zero is seen in free air
//! once the probe has come some way towards a surface without a force, or gone from one and found the
//! force where it was. A force that falls below zero was none.

use crate::maths::scalar::Real;

/// The resting force follows the free-air force with this time constant (s).
const TIME_S: f64 = 1.0;
/// Samples between two of the kept values of the resting force, and their number: a slow touch lifts the
/// resting force before it is known, and then that of up to a second earlier counts.
const KEEP_EVERY: u32 = 128;
const KEPT: usize = 8;
/// Samples of a stretch of which is asked whether it is free air. One begins every half of them: strokes that
/// follow each other leave 130 to 200 ms of air, and stretches one after the other fell beside half of them.
const STRETCH: u32 = 64;
const HALF: u32 = STRETCH / 2;
/// Bounds of the standard deviation in free air over the noise: a flat stretch that has none is a stuck or
/// saturated channel.
const FLAT: (f64, f64) = (0.25, 1.6);
/// Way in free air (counts of the position) that a force would have changed over.
pub(super) const WAY_COUNTS: f64 = 20.0;
/// A stretch of free air that differs from the resting force by more than this many standard errors of its
/// mean has another zero.
const SHIFTED: f64 = 5.0;
/// A mean of the free-air force that is off by more than this many of its standard errors drifts.
const DRIFTED: f64 = 3.5;
/// Share of a drift that is still expected at the next touch.
const KEPT_DRIFT: f64 = 0.7;
/// Samples below zero, by more than the threshold of a lift-off, that make a zero wrong.
const BELOW_SAMPLES: u32 = 8;

/// The resting force with what is known about it.
#[derive(Clone, Debug)]
pub(super) struct RestingForce<T> {
    /// Mean force in free air (N); 0 while settling.
    pub(super) mean_n: T,
    /// 1 over the number of samples that it is a mean of.
    gain: T,
    /// Largest shift (N) that was found after a contact.
    drift_n: T,
    /// How fast the zero drifts, per sample (N).
    drift_per_sample_n: T,
    samples_since_touch: u32,
    kept: [T; KEPT],
    newest: usize,
    until_kept: u32,
    /// Farthest out (m) that the probe has been in free air since the last contact.
    outermost_m: Option<T>,
    /// The last impact (m), and the way from there to where it was noticed.
    impact_m: Option<T>,
    touch_way_m: T,
    /// Mean force (N) in free air before the last touch, and its gain.
    at_last_touch: (T, T),
    seen_in_free_air: bool,
    below_samples: u32,
    half: Stretch<T>,
    /// What the forces of this half of a stretch are taken from (N): the resting force, which goes on following
    /// them, would bend it.
    half_zero_n: T,
    /// The half before it.
    before: Option<Flatness<T>>,
    /// The last flat stretch on a way out, and whether the newest half is part of it.
    on_retreat: Option<Flatness<T>>,
    overlaps: bool,
    /// Samples in free air since the drift was last asked for.
    free: Stretch<T>,
}

/// Sums over a stretch of samples, forces without the resting force.
#[derive(Clone, Copy, Debug, Default)]
struct Stretch<T> {
    samples: u32,
    sum_n: T,
    square_n2: T,
    first_m: T,
    last_m: T,
}

impl<T: Real> Stretch<T> {
    /// Takes a sample; gives the stretch when it has so many, and begins another.
    fn push(&mut self, position_m: T, force_n: T, samples: u32) -> Option<Self> {
        if self.samples == 0 {
            self.first_m = position_m;
        }
        self.samples += 1;
        self.sum_n += force_n;
        self.square_n2 += force_n * force_n;
        self.last_m = position_m;
        (self.samples >= samples).then(|| core::mem::take(self))
    }
}

/// Level of a stretch, and how flat it is.
#[derive(Clone, Copy, Debug)]
struct Flatness<T> {
    level_n: T,
    variance_n2: T,
    first_m: T,
    last_m: T,
}

impl<T: Real> Flatness<T> {
    /// Of half a stretch, whose forces were taken from `zero_n` on.
    fn of(half: &Stretch<T>, zero_n: T) -> Self {
        let share = T::from_f64(1.0 / HALF as f64);
        let mean_n = share * half.sum_n;
        Flatness {
            level_n: zero_n + mean_n,
            variance_n2: T::zero().max_of(share * half.square_n2 - mean_n * mean_n),
            first_m: half.first_m,
            last_m: half.last_m,
        }
    }

    /// Of two halves, one after the other.
    fn joined(&self, next: &Self) -> Self {
        let half = T::from_f64(0.5);
        let apart_n = half * (next.level_n - self.level_n);
        Flatness {
            level_n: self.level_n + apart_n,
            variance_n2: half * (self.variance_n2 + next.variance_n2) + apart_n * apart_n,
            first_m: self.first_m,
            last_m: next.last_m,
        }
    }

    /// Whether it is as noisy as free air, and no more.
    fn is_flat(&self, noise_n: T) -> bool {
        let times = |share: f64| T::from_f64(share * share) * noise_n * noise_n;
        self.variance_n2 > times(FLAT.0) && self.variance_n2 < times(FLAT.1)
    }

    /// Way out (m) from its first to its last sample.
    fn retreat_m(&self) -> T {
        self.first_m - self.last_m
    }
}

/// What one sample says about the resting force.
pub(super) enum Shift {
    /// It stays.
    None,
    /// The probe is in free air, and zero is elsewhere.
    Elsewhere,
}

impl<T: Real> Default for RestingForce<T> {
    fn default() -> Self {
        RestingForce {
            mean_n: T::zero(),
            gain: T::one(),
            drift_n: T::zero(),
            drift_per_sample_n: T::zero(),
            samples_since_touch: 0,
            kept: [T::zero(); KEPT],
            newest: 0,
            until_kept: 0,
            outermost_m: None,
            impact_m: None,
            touch_way_m: T::zero(),
            at_last_touch: (T::zero(), T::one()),
            seen_in_free_air: false,
            below_samples: 0,
            half: Stretch::default(),
            half_zero_n: T::zero(),
            before: None,
            on_retreat: None,
            overlaps: false,
            free: Stretch::default(),
        }
    }
}

/// Gain of the mean that follows the free-air force.
pub(super) fn follow_gain<T: Real>(rate_hz: f32) -> T {
    T::from_f64(1.0 / (TIME_S * f64::from(rate_hz)).max(1.0))
}

impl<T: Real> RestingForce<T> {
    /// Takes the mean (N) of `samples` samples at rest.
    pub(super) fn settle(&mut self, mean_n: T, samples: u32) {
        self.mean_n = mean_n;
        self.gain = T::one() / T::from_u32(samples);
        self.kept = [mean_n; KEPT];
        self.half_zero_n = mean_n;
        self.at_last_touch = (mean_n, self.gain);
    }

    /// Standard error (N) for a white noise of the force.
    pub(super) fn std_error_n(&self, noise_n: T) -> T {
        (noise_n * noise_n * self.gain + self.drift_n * self.drift_n).sqrt()
    }

    /// How fast the zero drifts, per sample (N).
    pub(super) fn drift_per_sample_n(&self) -> T {
        self.drift_per_sample_n
    }

    /// Whether the zero has been seen while the probe moved in free air.
    pub(super) fn seen_in_free_air(&self) -> bool {
        self.seen_in_free_air
    }

    /// Follows a force (N, without the resting force) in free air at a position (m). They lie some samples
    /// back: a touch right after them would be known by now.
    pub(super) fn follow(&mut self, position_m: T, force_n: T, slowest: T, noise_n: T) {
        self.watch_drift(position_m, force_n, noise_n);
        let next = self.gain / (T::one() + self.gain);
        self.gain = slowest.max_of(next);
        self.mean_n += self.gain * force_n;
        self.until_kept = self.until_kept.saturating_sub(1);
        if self.until_kept == 0 {
            self.until_kept = KEEP_EVERY;
            self.newest = (self.newest + 1) % KEPT;
            if let Some(slot) = self.kept.get_mut(self.newest) {
                *slot = self.mean_n;
            }
        }
    }

    /// A zero that drifts leaves a mean that follows it slowly behind: it follows faster, and is as uncertain
    /// as it was wrong. Not while the probe advances or is behind the last surface, since a soft contact
    /// begins and ends like a drift.
    fn watch_drift(&mut self, position_m: T, force_n: T, noise_n: T) {
        let Some(ended) = self.free.push(position_m, force_n, STRETCH) else {
            return;
        };
        let count = T::from_u32(STRETCH);
        let mean_n = ended.sum_n / count;
        let certain_n = T::from_f64(DRIFTED) * noise_n / count.sqrt();
        let outside = self
            .impact_m
            .is_none_or(|impact_m| ended.first_m < impact_m);
        if mean_n.abs() > certain_n && outside && ended.last_m <= ended.first_m {
            self.gain = self.gain.max_of(T::one() / count);
            self.drift_n = self.drift_n.max_of(mean_n.abs());
        }
    }

    /// Goes back to the resting force of this many samples ago, before a slow touch began to lift it; gives
    /// by how much (N) the forces since then are larger.
    pub(super) fn go_back(&mut self, samples: T) -> T {
        let mut slots = 1;
        let mut reached = T::from_u32(KEEP_EVERY);
        while reached < samples && slots < KEPT - 1 {
            reached += T::from_u32(KEEP_EVERY);
            slots += 1;
        }
        let slot = (self.newest + KEPT - slots) % KEPT;
        let before = self.kept.get(slot).copied().unwrap_or(self.mean_n);
        let lifted = self.mean_n - before;
        self.mean_n = before;
        self.kept = [before; KEPT];
        lifted
    }

    /// Takes a position (m) in free air.
    pub(super) fn observe_free(&mut self, position_m: T) {
        let outermost = self.outermost_m.get_or_insert(position_m);
        *outermost = outermost.min_of(position_m);
    }

    /// A surface was met at `impact_m`, and noticed at `touch_m`. The zero stands if the probe has come a
    /// way without a force that is not short beside the way on which it noticed one.
    pub(super) fn touched(
        &mut self,
        impact_m: T,
        touch_m: T,
        step_m: T,
        (noise_n, slowest): (T, T),
    ) {
        self.impact_m = Some(impact_m);
        self.touch_way_m = (touch_m - impact_m).abs();
        // What the zero has moved since the last touch, it will move during this one.
        let (before_n, gain) = self.at_last_touch;
        let moved_n = self.mean_n - before_n;
        let by_chance_n2 = noise_n * noise_n * (gain + self.gain);
        let drift_n = T::zero().max_of(moved_n * moved_n - by_chance_n2).sqrt();
        self.drift_n = drift_n.max_of(T::from_f64(KEPT_DRIFT) * self.drift_n);
        // The mean follows the force over 1/slowest samples: what it moves in fewer is no rate.
        let samples = T::from_u32(self.samples_since_touch);
        let kept_n = T::from_f64(KEPT_DRIFT) * self.drift_per_sample_n;
        self.drift_per_sample_n = kept_n.max_of(drift_n * slowest.min_of(T::one() / samples));
        self.samples_since_touch = 0;
        self.at_last_touch = (self.mean_n, self.gain);
        if let Some(outermost_m) = self.outermost_m.take() {
            let free_m = impact_m - outermost_m;
            let needed_m = T::from_f64(0.5) * self.touch_way_m + T::from_f64(3.0) * step_m;
            self.seen_in_free_air = free_m > needed_m;
        }
    }

    /// Takes a sample, its force (N) with the resting force and without. `below_n` is the threshold of a lift-off,
    /// and the units are what a zero may drift by without having been wrong (in noises), the white noise, and
    /// a count of the position.
    pub(super) fn observe(
        &mut self,
        position_m: T,
        (raw_n, force_n): (T, T),
        below_n: T,
        units: (T, T, T),
    ) -> Shift {
        self.samples_since_touch = self.samples_since_touch.saturating_add(1);
        self.below_samples = if force_n < -below_n {
            self.below_samples.saturating_add(1)
        } else {
            0
        };
        if self.below_samples >= BELOW_SAMPLES {
            self.seen_in_free_air = false;
        }
        let Some(ended) = self.half.push(position_m, raw_n - self.half_zero_n, HALF) else {
            return Shift::None;
        };
        let (_, noise_n, step_m) = units;
        let newest = Flatness::of(&ended, self.half_zero_n);
        self.half_zero_n = self.mean_n;
        let before = self.before.take();
        let overlaps = core::mem::take(&mut self.overlaps);
        // In contact nothing more is worked out.
        if !newest.is_flat(noise_n) || step_m == T::zero() {
            return Shift::None;
        }
        self.before = Some(newest);
        match before.map(|before| before.joined(&newest)) {
            Some(stretch) if stretch.is_flat(noise_n) => self.judge(&stretch, overlaps, units),
            _ => Shift::None,
        }
    }

    /// Zero is elsewhere where the force is flat both on the way out and after it: on the way out alone it may
    /// be friction, and on the way in the beginning of a soft contact.
    fn judge(
        &mut self,
        flat: &Flatness<T>,
        overlaps: bool,
        (drifts, noise_n, step_m): (T, T, T),
    ) -> Shift {
        // The standard error of the mean of a stretch is an eighth of the noise.
        let certain_n = T::from_f64(SHIFTED / 8.0) * noise_n;
        let off_n = flat.level_n - self.mean_n;
        let far = (T::from_f64(WAY_COUNTS) * step_m).max_of(T::from_f64(4.0) * self.touch_way_m);
        if flat.retreat_m() > far {
            self.seen_in_free_air |= off_n.abs() <= certain_n;
            self.on_retreat = Some(*flat);
            self.overlaps = true;
            return Shift::None;
        }
        match self.on_retreat {
            Some(out) if flat.retreat_m() <= T::zero() && flat.last_m <= out.first_m => {
                self.on_retreat = None;
                // The levels of two stretches that share a half differ by half of what others do.
                let share = T::from_f64(if overlaps { 0.5 } else { 1.0 });
                let same = (flat.level_n - out.level_n).abs() < share * certain_n;
                match same && off_n.abs() > certain_n {
                    true => self.shift(off_n, drifts * noise_n),
                    false => Shift::None,
                }
            }
            _ => Shift::None,
        }
    }

    /// Takes a zero that two stretches of free air have shown; one that is off by no more than `drift_n` has
    /// drifted, and was not wrong.
    fn shift(&mut self, by_n: T, drift_n: T) -> Shift {
        self.mean_n += by_n;
        self.gain = T::one() / T::from_u32(STRETCH);
        self.kept = [self.mean_n; KEPT];
        self.seen_in_free_air = true;
        if by_n.abs() <= drift_n {
            self.drift_n = self.drift_n.max_of(by_n.abs());
            return Shift::None;
        }
        // Nothing that was followed until now was free air.
        self.drift_n = T::zero();
        self.drift_per_sample_n = T::zero();
        self.free = Stretch::default();
        self.at_last_touch = (self.mean_n, self.gain);
        Shift::Elsewhere
    }
}
