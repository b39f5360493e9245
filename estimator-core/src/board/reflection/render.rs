//! Local rendering: the received impedance as a force at the master's own position and speed, within
//! what a sampled master can render without generating energy.
//!
//! **How stiff.** A spring K and a damper B that are rendered every T on a device whose own damping is
//! b are passive while b > KT/2 + |B| (J. E. Colgate, G. Schenkel, "Passivity of a class of
//! sampled-data systems: application to haptic interfaces", J. Robotic Systems 14(1), 1997). Two things
//! differ here. Speeds come through a low pass of time constant τ, backward differences as theirs: the
//! condition that belongs to B > 0 is then b > KT/2 + BT/(T + 2τ) (J. M. Brown, J. E. Colgate, "Factors
//! affecting the Z-width of a haptic display", ICRA 1994). And a position is the mean of the tick
//! before, T/2 old; a delay t_d counts like as much more of the hold, K(T/2 + t_d) (J. J. Gil et al.,
//! "Stability boundary for haptic rendering: influence of damping and delay", J. Comput. Inf. Sci. Eng.
//! 9, 2009). Half of b is given to each: K ≤ b/2T and B ≤ b(T + 2τ)/2T. Stiffness is the slope of the
//! elastic part, damping the factor of the speed, both at the depth where the master is.

use super::impedance::{Bounded, Memory};
use super::packet::{NotRenderable, Packet};
use super::speed::SPEED_TIME_S;
use crate::estimate::error::{ConfigError, require};
use crate::estimate::fault::{Fault, Faults};
use crate::maths::scalar::Scalar;

/// How to render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderConfig {
    /// Samples per second (Hz).
    pub rate_hz: f32,
    /// Largest force (N).
    pub force_n: f32,
    /// Damping of the master itself, b (N s/m): what bounds the stiffness and damping that it renders.
    pub device_ns_per_m: f32,
    /// Fastest change of the force (N/s), other than to zero on a fault.
    pub slew_n_per_s: f32,
    /// Without a packet for so long (s) the force fades out.
    pub timeout_s: f32,
    /// In which it fades out, and in which a new packet comes in (s).
    pub fade_s: f32,
    /// Factor on the impedance; 1 renders it as it is.
    pub shaping: f32,
}

/// The same, checked. Made by [`RenderConfig::validate`] only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderParams {
    period_s: f32,
    most_n: f32,
    stiffest: f32,
    most_damping: f32,
    slew_n_per_s: f32,
    timeout_us: u64,
    fade_s: f32,
    shaping: f32,
}

impl RenderConfig {
    /// Checks every field.
    ///
    /// # Errors
    /// The first that cannot be used, with its value and what would be right.
    pub fn validate(&self) -> Result<RenderParams, ConfigError> {
        type Field = (&'static str, f32, f32, f32, &'static str);
        let fields: [Field; 7] = [
            (
                "rate_hz",
                self.rate_hz,
                1.0,
                1e6,
                "must lie between 1 Hz and 1 MHz",
            ),
            (
                "force_n",
                self.force_n,
                1e-6,
                1e6,
                "must lie between 1e-6 and 1e6 N",
            ),
            (
                "device_ns_per_m",
                self.device_ns_per_m,
                1e-6,
                1e6,
                "must be the damping of the master itself, above 0 N s/m: it bounds what is rendered",
            ),
            (
                "slew_n_per_s",
                self.slew_n_per_s,
                1e-3,
                1e9,
                "must lie between 1e-3 and 1e9 N/s",
            ),
            (
                "timeout_s",
                self.timeout_s,
                1e-3,
                1e3,
                "must lie between 1e-3 and 1e3 s",
            ),
            (
                "fade_s",
                self.fade_s,
                1e-3,
                1e3,
                "must lie between 1e-3 and 1e3 s",
            ),
            (
                "shaping",
                self.shaping,
                0.0,
                1e3,
                "must lie between 0 and 1e3",
            ),
        ];
        for (field, value, low, high, expected) in fields {
            require((low..=high).contains(&value), field, value, expected)?;
        }
        Ok(self.unchecked())
    }

    /// For a board, whose settings have bounds of their own.
    pub(crate) fn unchecked(&self) -> RenderParams {
        let period_s = 1.0 / self.rate_hz;
        let half = 0.5 * self.device_ns_per_m;
        RenderParams {
            period_s,
            most_n: self.force_n,
            stiffest: half / period_s,
            most_damping: half * (period_s + 2.0 * SPEED_TIME_S) / period_s,
            slew_n_per_s: self.slew_n_per_s,
            timeout_us: (1e6 * self.timeout_s) as u64,
            fade_s: self.fade_s,
            shaping: self.shaping,
        }
    }
}

impl RenderParams {
    /// Largest stiffness (N/m) and damping (N s/m) that are rendered.
    pub fn most(&self) -> (f32, f32) {
        (self.stiffest, self.most_damping)
    }
}

/// What kept the force from being the law's own. The numbers are bits of [`Rendered::limits`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Limit {
    /// The largest force.
    Force = 1,
    /// The largest stiffness.
    Stiffness = 2,
    /// The largest damping.
    Damping = 4,
    /// The fastest change.
    Slew = 8,
    /// Another impedance is coming in.
    Blending = 16,
    /// Packets have stopped, and the force fades out or has.
    Fading = 32,
}

impl Limit {
    /// All of them, in the order of their bits.
    pub const ALL: [Limit; 6] = [
        Limit::Force,
        Limit::Stiffness,
        Limit::Damping,
        Limit::Slew,
        Limit::Blending,
        Limit::Fading,
    ];

    /// A word for people.
    pub const fn name(self) -> &'static str {
        match self {
            Limit::Force => "force",
            Limit::Stiffness => "stiffness",
            Limit::Damping => "damping",
            Limit::Slew => "slew",
            Limit::Blending => "blending",
            Limit::Fading => "fading",
        }
    }
}

/// What was put out at an instant. Kind 8 of [`crate::board::frame`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rendered {
    /// The instant (µs), by the master's clock.
    pub time_us: u64,
    /// Force on the operator (N), pushing out of the material; never negative.
    pub force_n: f32,
    /// Sequence number of the packet that was rendered; 0 before the first.
    pub sequence: u16,
    /// Bits of [`Limit`].
    pub limits: u8,
    /// [`Fault::RenderStopped`], [`Fault::RenderUnusable`], or none.
    pub faults: Faults,
}

impl Rendered {
    /// Whether a limit was at work.
    pub const fn has(&self, limit: Limit) -> bool {
        self.limits & limit as u8 != 0
    }

    fn mark(&mut self, limit: Limit, applies: bool) {
        if applies {
            self.limits |= limit as u8;
        }
    }
}

/// What comes next: an impedance, or none that is known yet; and the number of its packet.
type Next = (Option<Bounded>, u16);

/// The renderer's own memory.
#[derive(Clone, Copy, Debug, Default)]
pub struct Renderer {
    next: Option<Next>,
    law: Option<Bounded>,
    memory: Memory,
    sequence: u16,
    /// What is added to the law's force, so that it goes on where the one before it was: (N), and for
    /// how long yet (s).
    offset_n: f32,
    left_s: f32,
    /// 1 while packets come; 0 when the force has faded out.
    gain: f32,
    /// Of the last step.
    force_n: f32,
    last_us: Option<u64>,
    /// When the last packet was taken over.
    heard_us: Option<u64>,
    /// A fault has put the force to zero: it comes back as a new packet would.
    broken: bool,
}

impl Renderer {
    /// Nothing received, nothing put out.
    pub fn new() -> Self {
        Renderer::default()
    }

    /// Takes a packet; the next step renders it.
    ///
    /// # Errors
    /// A parameter that cannot be rendered; what was rendered so far goes on.
    pub fn take(&mut self, params: &RenderParams, packet: &Packet) -> Result<(), NotRenderable> {
        let bounded = |reflected| {
            let (stiffest, most_damping) = params.most();
            Bounded::new(reflected, params.shaping, stiffest, most_damping)
        };
        self.next = Some((packet.reflected()?.map(bounded), packet.sequence));
        Ok(())
    }

    /// The force at the master's position (m) and speed (m/s) `now` (µs). Finite and from 0 to the
    /// largest force, whatever comes in.
    pub fn step(
        &mut self,
        params: &RenderParams,
        position_m: f32,
        speed_mps: f32,
        now_us: u64,
    ) -> Rendered {
        let mut out = Rendered {
            time_us: now_us,
            ..Rendered::default()
        };
        let elapsed_us = match self.last_us {
            Some(last) => now_us.checked_sub(last).filter(|elapsed| *elapsed > 0),
            None => Some((1e6 * params.period_s) as u64),
        };
        self.last_us = Some(now_us);
        // A clock that starts anew must not put the timeout off.
        self.heard_us = self.heard_us.map(|heard_us| heard_us.min(now_us));
        let force_n = elapsed_us
            .filter(|_| position_m.is_finite() && speed_mps.is_finite())
            .and_then(|elapsed_us| {
                let elapsed_s = 1e-6 * elapsed_us as f32;
                let force_n = self.force(params, &mut out, position_m, speed_mps, elapsed_s);
                Some(force_n).filter(|force_n| force_n.is_finite())
            });
        match force_n {
            Some(force_n) => self.force_n = force_n,
            None => {
                self.broken();
                out.limits = 0;
                out.faults = out.faults.with(Fault::RenderUnusable);
            }
        }
        (out.force_n, out.sequence) = (self.force_n, self.sequence);
        out
    }

    /// At once and without a ramp: what is wrong with the position or the time, nobody knows.
    fn broken(&mut self) {
        self.force_n = 0.0;
        (self.offset_n, self.left_s) = (0.0, 0.0);
        self.memory = None;
        self.broken = true;
    }

    fn force(
        &mut self,
        params: &RenderParams,
        out: &mut Rendered,
        position_m: f32,
        speed_mps: f32,
        elapsed_s: f32,
    ) -> f32 {
        let at = (position_m, speed_mps, elapsed_s);
        self.fade(params, out, elapsed_s);
        // A new packet goes on where the last one would be now, not where it was a step ago.
        if let Some(next) = self.next.take() {
            self.take_over(params, next, at, out.time_us);
        }
        let law_n = of(&self.law, &mut self.memory, params, at, Some(out));
        if core::mem::take(&mut self.broken) {
            self.offset_n = -law_n;
            self.left_s = params.fade_s;
        }
        self.blend(elapsed_s);
        out.mark(Limit::Blending, self.left_s > 0.0);
        let wanted_n = self.gain * (law_n + self.offset_n);
        if wanted_n.is_nan() {
            return wanted_n;
        }
        let wanted_n = wanted_n.max(0.0);
        out.mark(Limit::Force, wanted_n > params.most_n);
        // After a gap, too, no more than two samples' worth.
        let most_change_n = params.slew_n_per_s * elapsed_s.min(2.0 * params.period_s);
        let change_n = wanted_n.min(params.most_n) - self.force_n;
        if change_n.abs() > most_change_n {
            out.mark(Limit::Slew, true);
            return self.force_n + most_change_n.copysign(change_n);
        }
        // Not the last force and the change to it, which would be a rounding away from the law's own.
        wanted_n.min(params.most_n)
    }

    /// Packets that have stopped coming.
    fn fade(&mut self, params: &RenderParams, out: &mut Rendered, elapsed_s: f32) {
        let Some(heard_us) = self.heard_us else {
            return;
        };
        if self.next.is_some() || out.time_us.saturating_sub(heard_us) <= params.timeout_us {
            return;
        }
        out.mark(Limit::Fading, true);
        out.faults = out.faults.with(Fault::RenderStopped);
        self.gain = (self.gain - elapsed_s / params.fade_s).max(0.0);
        if self.gain == 0.0 {
            (self.law, self.memory) = (None, None);
            (self.offset_n, self.left_s) = (0.0, 0.0);
        }
    }

    fn take_over(&mut self, params: &RenderParams, next: Next, at: (f32, f32, f32), now_us: u64) {
        let (law, sequence) = next;
        if law != self.law || self.gain != 1.0 {
            let mut memory = self.memory;
            let before_n = of(&self.law, &mut memory, params, at, None) + self.offset_n;
            let put_out_n = (self.gain * before_n).max(0.0).min(params.most_n);
            let mut memory = self.memory;
            let after_n = of(&law, &mut memory, params, at, None);
            self.offset_n = put_out_n - after_n;
            self.left_s = params.fade_s;
        }
        (self.law, self.sequence, self.gain) = (law, sequence, 1.0);
        self.heard_us = Some(now_us);
    }

    /// The offset goes to 0 in a straight line, and is exactly 0 in the end.
    fn blend(&mut self, elapsed_s: f32) {
        let left_s = self.left_s - elapsed_s;
        if left_s > 0.0 {
            self.offset_n *= left_s / self.left_s;
            self.left_s = left_s;
        } else {
            (self.offset_n, self.left_s) = (0.0, 0.0);
        }
    }
}

/// The law's force within the largest one; it pushes, and never pulls: no law in a packet has adhesion,
/// and what a linear law pulls while unloading is its fault and not the material's.
#[inline(never)]
fn of(
    law: &Option<Bounded>,
    memory: &mut Memory,
    params: &RenderParams,
    (position_m, speed_mps, elapsed_s): (f32, f32, f32),
    out: Option<&mut Rendered>,
) -> f32 {
    let Some(law) = law else {
        return 0.0;
    };
    let (force_n, stiffness, damping) = law.force_n(memory, position_m, speed_mps, elapsed_s);
    if let Some(out) = out {
        out.mark(Limit::Stiffness, stiffness && force_n > 0.0);
        out.mark(Limit::Damping, damping && force_n > 0.0);
        out.mark(Limit::Force, force_n > params.most_n);
    }
    // NaN stays NaN: `max` and `min` of f32 would make a force of it.
    match force_n > 0.0 {
        true => params.most_n.min_of(force_n),
        false if force_n.is_nan() => force_n,
        false => 0.0,
    }
}
