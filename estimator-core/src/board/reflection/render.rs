//! Local rendering: the received impedance as a force at the master's own position and speed, within
//! what a sampled master can render without generating energy ([`RenderParams`]).

use super::{
    impedance::Bounded, impedance::RenderedState, packet::Packet, render_params::RenderParams,
    renderable::NotRenderable, rendered::Limit, rendered::Rendered,
};
use crate::estimate::fault::Fault;
use crate::maths::scalar::{Scalar, seconds};

/// The impedance that comes next, `None` while one is not known yet, and the number of its packet.
type Next = (Option<Bounded>, u16);

/// The state of the rendering.
#[derive(Clone, Copy, Debug, Default)]
pub struct Renderer {
    next: Option<Next>,
    law: Option<Bounded>,
    state: RenderedState,
    sequence: u16,
    /// The force that is added to the law's, so that it goes on where the law before it was (N), and
    /// the time for which it still is (s).
    offset_n: f32,
    left_s: f32,
    /// 1 while packets come; 0 when the force has faded out.
    gain: f32,
    /// The force of the last step (N).
    force_n: f32,
    last_us: Option<u64>,
    /// When the last packet was taken over.
    heard_us: Option<u64>,
    /// Whether a fault has put the force to zero; it comes back as a new packet's would.
    broken: bool,
}

impl Renderer {
    /// The state before the first packet: nothing is put out.
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
            None => Some(u64::from((1e6 * params.period_s) as u32)),
        };
        self.last_us = Some(now_us);
        // A clock that starts anew must not put the timeout off.
        self.heard_us = self.heard_us.map(|heard_us| heard_us.min(now_us));
        let force_n = elapsed_us
            .filter(|_| position_m.is_finite() && speed_mps.is_finite())
            .and_then(|elapsed_us| {
                let elapsed_s = seconds(elapsed_us);
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

    /// Puts the force to zero at once and without a ramp: nobody knows what is wrong with the position
    /// or the time.
    fn broken(&mut self) {
        self.force_n = 0.0;
        (self.offset_n, self.left_s) = (0.0, 0.0);
        self.state = None;
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
        let law_n = of(&self.law, &mut self.state, params, at, Some(out));
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

    /// Fades the force out when packets have stopped.
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
            (self.law, self.state) = (None, None);
            (self.offset_n, self.left_s) = (0.0, 0.0);
        }
    }

    fn take_over(&mut self, params: &RenderParams, next: Next, at: (f32, f32, f32), now_us: u64) {
        let (law, sequence) = next;
        if law != self.law || self.gain != 1.0 {
            let mut state = self.state;
            let before_n = of(&self.law, &mut state, params, at, None) + self.offset_n;
            let put_out_n = (self.gain * before_n).max(0.0).min(params.most_n);
            let mut state = self.state;
            let after_n = of(&law, &mut state, params, at, None);
            self.offset_n = put_out_n - after_n;
            self.left_s = params.fade_s;
        }
        (self.law, self.sequence, self.gain) = (law, sequence, 1.0);
        self.heard_us = Some(now_us);
    }

    /// Moves the offset towards 0 in a straight line, at whose end it is exactly 0.
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
    state: &mut RenderedState,
    params: &RenderParams,
    (position_m, speed_mps, elapsed_s): (f32, f32, f32),
    out: Option<&mut Rendered>,
) -> f32 {
    let Some(law) = law else {
        return 0.0;
    };
    let (force_n, stiffness, damping) = law.force_n(state, position_m, speed_mps, elapsed_s);
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
