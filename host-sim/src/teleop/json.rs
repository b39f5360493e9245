//! `teleop.json`.

use serde_json::{Value, json};

use super::bridge::{Clock, Summary};
use super::channel::{ChannelConfig, Jitter};
use super::compare::Cell;
use super::limit::Limit;
use super::measure::felt::NotCompared;
use super::measure::stability::Rest;
use super::measure::transparency::Line;
use super::measure::{Measures, Packets};
use super::operator::Grip;
use super::options::{Options, SchemeId};
use super::trace::Parameters;
use crate::json::number;

/// A run; `delay_s`, `jitter` and `loss` are those of the way from master to slave, and of both ways in `there` and
/// `back`.
pub fn run(options: &Options, measures: &Measures, seed: u64, notes: &[String]) -> Value {
    let [there, back] = options.channels;
    let environment = &options.environment.first.name;
    let mut value = object(
        options.scheme,
        (there.delay_s, there.jitter, there.loss),
        environment,
        measures,
    );
    value["round_trip_s"] = number(there.delay_s + back.delay_s);
    (value["there"], value["back"]) = (way(&there), way(&back));
    value["shaping"] = number(options.shaping()[0]);
    // The grip that was the last to be taken.
    let grip = options.operator.grip(options.duration_s());
    value["operator"] = operator(Some(grip), measures.hand);
    let second = options.environment.second.as_ref();
    value["second_environment"] = json!(second.map(|material| &material.name));
    value["changed_s"] = measures.changed_s.map_or(Value::Null, number);
    value["stable_on"] = rests_on(measures);
    value["seed"] = json!(seed);
    value["notes"] = json!(notes);
    value
}

/// Whether the system comes to rest on the first and on the second material.
fn rests_on(measures: &Measures) -> Value {
    let second = measures.changed_s.map(|_| measures.rest);
    let first = match second {
        Some(_) => measures.rest_first,
        None => Some(measures.rest),
    };
    json!({
        "first": first.and_then(Rest::known),
        "second": second.and_then(Rest::known),
    })
}

/// One way of the channel.
fn way(channel: &ChannelConfig) -> Value {
    json!({
        "delay_s": number(channel.delay_s),
        "jitter": number(channel.jitter),
        "distribution": match channel.distribution {
            Jitter::Uniform => "uniform",
            Jitter::Gamma => "gamma",
        },
        "loss": number(channel.loss),
        "burst": number(channel.burst),
        "bytes_per_s": number(channel.bytes_per_s),
        "outage_s": channel.outage_s.map(|(from_s, to_s)| [number(from_s), number(to_s)]),
    })
}

/// What only a report asks for: the transparency of some schemes, and up to which round trip the run's own comes to
/// rest (s).
pub fn add_sweeps(value: &mut Value, transparency: &[(SchemeId, Vec<Line>)], limit: &Limit) {
    value["rests_to_round_trip_s"] = limit.rests_to_s.map_or(Value::Null, number);
    value["rest_ends_at_round_trip_s"] = limit.ends_at_s.map_or(Value::Null, number);
    let lines = transparency.iter().map(|(scheme, lines)| {
        let column = |of: fn(&Line) -> f64| {
            lines
                .iter()
                .map(|line| number(of(line)))
                .collect::<Vec<_>>()
        };
        json!({
            "scheme": scheme.name(),
            "frequency_hz": column(|line| line.frequency_hz),
            "magnitude": column(|line| line.magnitude),
            "phase_rad": column(|line| line.phase_rad),
        })
    });
    value["transparency"] = lines.collect();
}

/// A cell of the comparison: the medians over its seeds.
pub fn cell(cell: &Cell) -> Value {
    let Some(first) = cell.runs.first() else {
        return Value::Null;
    };
    let median = |of: fn(&Measures) -> f64| cell.median(|run| Some(of(run))).unwrap_or(f64::NAN);
    let measures = Measures {
        felt_force_rmse_share: cell.median(|run| run.felt_force_rmse_share),
        felt_force_rmse_share_whole: median(|run| run.felt_force_rmse_share_whole),
        felt_force_rmse_share_after: cell.median(|run| run.felt_force_rmse_share_after),
        felt_stiffness_error: cell.median(|run| run.felt_stiffness_error),
        felt_damping_error: cell.median(|run| run.felt_damping_error),
        position_rmse_m: median(|run| run.position_rmse_m),
        felt_force_not_compared: cell.not_compared(),
        rest: cell.rest(),
        rest_first: None,
        decay_per_s: median(|run| run.decay_per_s),
        created_energy_j: median(|run| run.created_energy_j),
        coupling_energy_j: median(|run| run.coupling_energy_j),
        exchanged_energy_j: median(|run| run.exchanged_energy_j),
        peak_touch_n: median(|run| run.peak_touch_n),
        peak_change_n: cell.median(|run| run.peak_change_n),
        settled_s: cell.median(|run| run.settled_s),
        resettled_s: cell.median(|run| run.resettled_s),
        ages_s: [0, 1].map(|way| cell.age_s(way)),
        ..first.clone()
    };
    let channel = (0.5 * cell.round_trip_s, cell.jitter, cell.loss);
    let mut value = object(cell.scheme, channel, &cell.environment, &measures);
    value["round_trip_s"] = number(cell.round_trip_s);
    value["seeds"] = json!(cell.runs.len());
    value
}

/// A bridge that has ended.
pub fn bridge(summary: &Summary) -> Value {
    let of_clock = |of: fn(&Clock) -> f64| {
        let clock = summary.clock.as_ref();
        clock.map_or(Value::Null, |clock| number(1e-6 * of(clock)))
    };
    let counts = &summary.counts;
    let rejected = counts.overtaken + counts.late + counts.replayed + counts.strangers;
    let rendered = summary.master.and_then(|master| master.rendered);
    json!({
        "bridge": summary.role,
        "duration_s": number(summary.duration_s),
        "round_trip_s": of_clock(|clock| clock.round_trip_us),
        "clock_offset_s": of_clock(|clock| clock.offset_us),
        "packets": {
            "sent": counts.sent,
            "passed": counts.passed,
            "lost": counts.lost,
            "rejected": rejected,
            "overtaken": counts.overtaken,
            "late": counts.late,
            "replayed": counts.replayed,
            "strangers": counts.strangers,
        },
        "force_n": rendered.map_or(Value::Null, |rendered| number(f64::from(rendered.force_n))),
        "faded_out": summary.master.map_or(Value::Null, |master| json!(master.has_stopped())),
    })
}

fn object(
    scheme: SchemeId,
    (delay_s, jitter, loss): (f64, f64, f64),
    environment: &str,
    measures: &Measures,
) -> Value {
    let optional = |value: Option<f64>| value.map_or(Value::Null, number);
    json!({
        "scheme": scheme.name(),
        "delay_s": number(delay_s),
        "jitter": number(jitter),
        "loss": number(loss),
        "environment": environment,
        "felt_force_rmse_share": optional(measures.felt_force_rmse_share),
        "felt_force_not_compared": measures.felt_force_not_compared.map(NotCompared::name),
        "felt_force_rmse_share_whole": number(measures.felt_force_rmse_share_whole),
        "felt_force_rmse_share_after": optional(measures.felt_force_rmse_share_after),
        "felt_stiffness_error": optional(measures.felt_stiffness_error),
        "felt_damping_error": optional(measures.felt_damping_error),
        "position_rmse_m": number(measures.position_rmse_m),
        "stable": measures.rests().known(),
        "decay_per_s": number(measures.decay_per_s),
        "created_energy_j": number(measures.created_energy_j),
        "coupling_energy_j": number(measures.coupling_energy_j),
        "exchanged_energy_j": number(measures.exchanged_energy_j),
        "peak_touch_n": number(measures.peak_touch_n),
        "peak_change_n": optional(measures.peak_change_n),
        "settled_s": optional(measures.settled_s),
        "resettled_s": optional(measures.resettled_s),
        "operator": Value::Null,
        "limits": measures.limits.iter()
            .map(|(name, share)| json!({ "limit": name, "share": number(*share) }))
            .collect::<Vec<_>>(),
        "packets": packets(&measures.packets),
        "effective_age_s": {
            "there": optional(measures.ages_s[0]),
            "back": optional(measures.ages_s[1]),
        },
    })
}

fn packets(packets: &Packets) -> Value {
    json!({
        "sent": packets.sent,
        "lost": packets.lost,
        "lost_to_rate": packets.lost_to_rate,
        "rejected": packets.rejected,
        "bytes_per_s": packets.bytes_per_s,
    })
}

/// The hand: as it is, and as it was identified, where the scheme does that.
fn operator(grip: Option<Grip>, identified: Option<Parameters>) -> Value {
    let Some(grip) = grip else {
        return Value::Null;
    };
    let identified = identified.map(|[stiffness, damping, mass]| {
        let measured = |known: Option<(f64, f64)>, unit: &str| {
            known.map_or(Value::Null, |(value, std_error)| {
                json!({ "value": number(value), "std_error": number(std_error), "unit": unit })
            })
        };
        json!({
            "stiffness": measured(stiffness, "N/m"),
            "damping": measured(damping, "N s/m"),
            "mass": measured(mass, "kg"),
        })
    });
    json!({
        "stiffness": number(grip.stiffness_n_per_m),
        "damping": number(grip.damping_ns_per_m),
        "mass": number(grip.mass_kg),
        "identified": identified.unwrap_or(Value::Null),
    })
}
