//! What a reader of a batch fit must know: what was left out, what was assumed, what does not fit.

use estimator_core::physics::law::Recovery;

use super::assemble::Given;
use super::{
    course::Course, filtered::Filtered, options::Options, result::Batch, thresholds::Report,
};
use crate::estimate::{Form, NEGATIVE_DAMPING, RELAXES, carrier, stiffening};
use crate::inspect::suspicions;
use crate::log::UniformLog;
use crate::model::law_title;
use crate::number::{Measured, quantity};

/// Of a log in which nothing is touched.
pub(super) fn nothing(log: &UniformLog, batch: &Batch) -> Vec<String> {
    let mut notes = suspicions(log);
    notes.push(format!(
        "no contact: the force never rose above its noise in free air ({} rms)",
        quantity(batch.noise_n, 2, "N")
    ));
    notes
}

/// That the noise is slower than a sample.
pub(super) fn rest_noise(noise_n: f64, fast_n: f64) -> String {
    format!(
        "at rest in free air the force wanders by {} rms, {} of it from sample to sample: all of it counts as noise",
        quantity(noise_n, 2, "N"),
        quantity(fast_n, 2, "N")
    )
}

/// Of a fit.
pub(super) fn notes(given: &Given, batch: &Batch, options: &Options) -> Vec<String> {
    let (log, course) = (given.log, given.course);
    let decide = &course.thresholds.report;
    let mut notes = suspicions(log);
    notes.extend(left_out(log, course));
    notes.extend(offset(course, decide));
    notes.extend(misfit(batch, decide));
    notes.extend(relaxation(batch));
    notes.extend(faster(batch));
    notes.extend(recovery(batch));
    notes.extend(stiffening(&batch.touches, batch.family.law));
    notes.extend(held(options));
    notes.extend(damping(batch, decide));
    notes.extend(low_pass(given));
    notes.extend(skew(given, batch));
    notes.extend(adhesion(batch));
    notes.extend(surface(batch, options));
    notes.extend(modulus(batch));
    if let Some(limit) = batch.inspection.saturated_n {
        notes.push(format!(
            "the force stays at its largest value, {}: the channel saturates there",
            quantity(limit, 4, "N")
        ));
    }
    notes
}

/// That a material relaxes faster than a log shows, where it does so at all times that the log shows.
fn faster(batch: &Batch) -> Option<String> {
    let rate = batch
        .value("relaxation_rate_1")
        .filter(|_| batch.relaxes_at_all_times())?;
    Some(format!(
        "the force falls in {} modes, as one that falls at all times would: the stiffness at once is that of the first {} \
         that this motion shows, and a faster one would find more; its standard error is that of one mode more",
        batch.family.modes,
        quantity(1.0 / rate.value, 1, "s")
    ))
}

fn left_out(log: &UniformLog, course: &Course) -> Option<String> {
    let (out, all) = course.left_out(log);
    (out > 0).then(|| {
        format!(
            "{:.1} % of the samples in contact were left out: on the way out, from where the force \
             has fallen to {} % of the touch's peak, a surface that sticks or recovers slowly does \
             what no law here says",
            100.0 * out as f64 / all as f64,
            (100.0 * course.thresholds.samples.released_force).round()
        )
    })
}

fn offset(course: &Course, decide: &Report) -> Option<String> {
    (course.free() < decide.fewest_free).then(|| {
        "no free air: the resting force was fitted with the parameters, and their standard errors \
         include it"
            .into()
    })
}

fn misfit(batch: &Batch, decide: &Report) -> Option<String> {
    let rmse = batch.force_rmse_n?;
    let multiple = rmse / batch.noise_n;
    (multiple > decide.explained).then(|| {
        format!(
            "{} leaves {} rms, {multiple:.1} × the noise: it does not explain this force, and its parameters describe it only on average",
            law_title(batch.family.name()),
            quantity(rmse, 3, "N"),
        )
    })
}

fn relaxation(batch: &Batch) -> Option<String> {
    let holds = batch.inspection.holds.iter();
    let hold = holds.max_by(|a, b| a.relaxed.total_cmp(&b.relaxed))?;
    let relaxes = match batch.family.modes {
        0 => format!(": {} does not", law_title(batch.family.name())),
        _ => String::new(),
    };
    (hold.relaxed > RELAXES).then(|| {
        format!(
            "the force relaxes by {:.0} % during the hold from {:.3} to {:.3} s{relaxes}",
            100.0 * hold.relaxed,
            hold.from_s,
            hold.to_s,
        )
    })
}

/// That the material had not recovered when it was touched again.
fn recovery(batch: &Batch) -> Option<String> {
    let own = batch.family;
    let left = |family| {
        let mut tried = batch.selection.iter();
        Some(tried.find(|one| one.family == family)?.force_rmse_n)
    };
    (own.recovery == Recovery::ByCreep).then(|| {
        let instead = match left(own.with_probe()).zip(left(own)) {
            Some((held, creeping)) => format!(
                ": the force then leaves {} rms, and {} if the surface followed the probe out",
                quantity(creeping, 3, "N"),
                quantity(held, 3, "N")
            ),
            None => String::new(),
        };
        format!(
            "the material was touched again before it had recovered, and its dent is fitted as one that fills by \
             creep alone{instead}"
        )
    })
}

/// The laws that have a parameter which is held, in no form in which they could hold it.
fn held(options: &Options) -> Option<String> {
    let laws = options.laws_that_cannot_hold();
    (!laws.is_empty()).then(|| {
        format!(
            "not tried: {}. Stiffness, and a damping other than 0, are held at a depth only together with the exponent, \
             and the fraction only of one mode",
            laws.join(", ")
        )
    })
}

fn damping(batch: &Batch, decide: &Report) -> Option<String> {
    let is_negative = batch.has_negative_damping(decide);
    is_negative.then(|| NEGATIVE_DAMPING.into())
}

/// How late the force is (s), if that is significant and not the resolution of the time stamps.
pub(super) fn late_s(given: &Given, batch: &Batch) -> Option<f64> {
    let decide = &given.course.thresholds.report;
    let skew = batch.skew?;
    let late = skew.value.abs();
    let least = decide.least_skew * given.log.period_s();
    (late > decide.skew_sigmas * skew.std_error && late > least).then_some(skew.value)
}

/// Which low-pass the force went through, where the law is fitted behind it.
fn low_pass(given: &Given) -> Option<String> {
    let Filtered { low_pass, ln_error } = given.filtered?;
    let corner_hz = low_pass.corner_hz;
    let delay = match low_pass.delay_s() {
        0.0 => "without delay".into(),
        delay_s => format!("{} late", quantity(delay_s, 2, "s")),
    };
    Some(format!(
        "the law was fitted behind the low-pass that the force went through before it was logged: {}, corner at {}, {delay}; \
         what is left tells it, and the standard errors include its own",
        low_pass.title(),
        Measured::new(corner_hz, Some(ln_error * corner_hz), "Hz"),
    ))
}

fn skew(given: &Given, batch: &Batch) -> Option<String> {
    let value = late_s(given, batch)?;
    let late = quantity(value.abs(), 3, "s");
    let carrier = carrier(batch.family.law);
    Some(match given.late.map(|late| late.form) {
        Some(Form::Lag) => format!(
            "the force lags behind the contact with a time constant of about {late}: a filter or a soft load \
             cell; the fit has it as a delay, and {carrier} carries what differs"
        ),
        Some(Form::Either) => format!(
            "the force comes {late} late: it is read later than the position, or lags behind the contact by \
             that time constant, which this motion does not tell apart; the fit has it as a delay"
        ),
        _ => format!(
            "the force is {late} {} than the position; {carrier} would carry that otherwise",
            if value > 0.0 { "later" } else { "earlier" }
        ),
    })
}

fn adhesion(batch: &Batch) -> Option<String> {
    (batch.inspection.pull_n > 0.0).then(|| {
        format!(
            "the force falls to {} below rest: adhesion (or a resting force that moves), which the \
             law does not have",
            quantity(batch.inspection.pull_n, 3, "N")
        )
    })
}

fn surface(batch: &Batch, options: &Options) -> Option<String> {
    let surface = batch.value("surface")?;
    let is_held = options.surface_m.is_some() || options.held.value("surface").is_some();
    (!is_held).then(|| {
        format!(
            "the surface was fitted, at {}: the standard errors of the other parameters include its uncertainty",
            Measured::new(surface.value, Some(surface.std_error), "m")
        )
    })
}

fn modulus(batch: &Batch) -> Vec<String> {
    let Some((modulus, own)) = batch.modulus.as_ref().zip(batch.force_rmse_n) else {
        return Vec::new();
    };
    let with = quantity(modulus.force_rmse_n, 3, "N");
    let fitted = match batch.value("exponent") {
        Some(found) => format!("the fit has {:.3}", found.value),
        None => format!("the fit is {}", law_title(batch.family.name())),
    };
    let assumed = format!(
        "Young's modulus takes the exponent of the indenter, {}, where {fitted}: the force then leaves \
         {with} rms instead of {}",
        modulus.exponent_assumed,
        quantity(own, 3, "N")
    );
    let why = modulus
        .why
        .iter()
        .map(|why| format!("Young's modulus is not valid here: {why}"));
    std::iter::once(assumed).chain(why).collect()
}
