//! What a log says for and against a fit, besides its parameters.

use super::assemble::Given;
use super::blocks::Use;
use super::family::Family;
use super::fit::Fit;
use super::natural::natural;
use super::result::Batch;
use crate::estimate::{Evidence, NOISE_ALONE, Reason, judged, may_be_the_filter};
use crate::inspect::Inspection;
use crate::signal;
use crate::stats::{lowest, rms};

/// Exponents beyond these are at the bounds of the fit, ½ and 4.
const EXPONENTS: std::ops::Range<f64> = 0.55..3.9;
/// A stiffening rate times the deepest depth beyond these is a spring, or a wall.
const STIFFENING: std::ops::Range<f64> = 0.02..30.0;
/// A material that relaxes by more than this share keeps no elastic force.
const MOST_RELAXING: f64 = 0.99;
/// A surface is late if the force has left its baseline so many standard errors before it.
const LATE_SIGMAS: f64 = 3.0;
/// A pull of less than so many times what a low-pass swings below rest by is that.
const RINGS: f64 = 1.5;
/// Most of a time constant that passes within a sample.
const FASTEST_A_SAMPLE: f64 = 0.5;

impl Given<'_> {
    /// The fit with its status judged.
    pub(super) fn judged(&self, mut batch: Batch, fit: &Fit) -> Batch {
        let late = self.late.and_then(|late| late.reason());
        batch.allowed_n = batch.noise_n.hypot(self.counts_n(fit));
        let misfit = batch.force_rmse_n.map(|rmse| rmse / batch.allowed_n);
        // 21 ± 4 N s/m of 5 beside a pull of 0.27 N, 1.2 times the noise.
        let sticks = batch.inspection.pull_n > 0.0 && misfit.is_some_and(|own| own > NOISE_ALONE);
        let evidence = Evidence {
            told: None,
            misfit,
            explained: self.course.thresholds.report.explained,
            is_saturated: batch.inspection.saturated_n.is_some(),
            has_no_zero: self.course.free() < self.course.thresholds.report.fewest_free,
            drifts: false,
            has_other_force: sticks,
            // A dent is among what is fitted.
            is_dented: false,
            is_at_bound: self.is_at_bound(fit)
                || batch.has_negative_damping(&self.course.thresholds.report),
            // A delay is among the parameters, and a lag is not.
            lateness: match self.is_filter(fit) {
                true => Some(Reason::Lag),
                false => late.filter(|reason| *reason == Reason::Lag),
            },
            relaxes: relaxes(&batch.inspection, fit.family),
            has_better_law: false,
            has_nearer_law: false,
            is_surface_doubtful: self.is_surface_late(&batch),
        };
        (batch.status, batch.reason) = judged(batch.status, &evidence);
        batch
    }

    /// The fit without a pull that is the low-pass's own: one of second order and more swings below rest after a release.
    pub(super) fn without_ringing(&self, mut batch: Batch, fit: &Fit) -> Batch {
        if self.filtered.is_some() {
            let rest_n = natural(fit.family, &fit.free, &self.course.scales).offset_n;
            let rings_n = rest_n - lowest(self.forces(fit));
            if batch.inspection.pull_n < RINGS * rings_n {
                batch.inspection.pull_n = 0.0;
            }
        }
        batch
    }

    /// What the counts of the position leave of the force of a fit in contact (N rms): 0.3 N of 1 µm on 1 N/µm. 0 without
    /// counts.
    fn counts_n(&self, fit: &Fit) -> f64 {
        if signal::step(&self.log.position_m).is_none() {
            return 0.0;
        }
        let rounding_m = self.course.scales.position_noise_m;
        let moved = self.course.moved_n(fit, rounding_m);
        let nodes = self.course.nodes.iter().zip(moved);
        let in_contact = nodes.filter(|(node, _)| matches!(node.used, Use::Contact(_)));
        rms(in_contact.map(|(_, moved)| moved))
    }

    /// Whether a relaxation of a fit may be that of the low-pass that the force went through.
    fn is_filter(&self, fit: &Fit) -> bool {
        if self.filtered.is_some() {
            return false;
        }
        let law = natural(fit.family, &fit.free, &self.course.scales);
        let mut modes = law.modes.iter().filter(|mode| mode.fraction > 0.0);
        modes.any(|mode| may_be_the_filter(self.log, mode.rate_per_s))
    }

    fn is_at_bound(&self, fit: &Fit) -> bool {
        let scales = &self.course.scales;
        let law = natural(fit.family, &fit.free, scales);
        let relaxing: f64 = law.modes.iter().map(|mode| mode.fraction).sum();
        let stiffening = law.stiffening_rate * scales.depth_m;
        // Within two samples a relaxation is a damper: a spring and a damper, read 5 ms late, had 80 ± 40 N/mm that
        // relaxed at 1500 ± 800/s.
        let is_too_fast = law.modes.iter().any(|mode| {
            mode.fraction > 0.0 && mode.rate_per_s * scales.period_s > FASTEST_A_SAMPLE
        });
        (fit.family.exponent().is_some() && !EXPONENTS.contains(&law.exponent))
            || (fit.family.stiffening_rate().is_some() && !STIFFENING.contains(&stiffening))
            || relaxing > MOST_RELAXING
            || is_too_fast
    }

    /// Whether the force has left its baseline before the surface, by more than its error and a sample.
    fn is_surface_late(&self, batch: &Batch) -> bool {
        let both = batch.value("surface").zip(self.departure);
        both.is_some_and(|(surface, left)| {
            surface.value - left.to_m > LATE_SIGMAS * surface.std_error + left.step_m
        })
    }
}

/// Whether the force decays in a hold, and the law does not.
fn relaxes(inspection: &Inspection, family: Family) -> bool {
    let decays = inspection
        .holds
        .iter()
        .any(|hold| hold.relaxed > crate::estimate::RELAXES);
    family.modes == 0 && decays
}
