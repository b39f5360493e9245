//! `estimate.json`, `estimate.csv` and `report.html` of a batch fit.
//!
//! The fields of the recursive methods, and more: `per_touch`, `youngs_modulus`, `force_offset`,
//! `force_skew`, `force_low_pass`, `misfit`, and `parameters`, `modes` and `score` in `selection`.

use std::io;
use std::path::Path;

use estimator_core::estimate::Estimated;
use serde_json::{Map, Value, json};

use super::show;
use crate::batch::{Batch, FoundLowPass, Modulus, Parameter};
use crate::cli::estimate::json::{events, measured, touches};
use crate::estimate::Reason;
use crate::json::{number, seconds, write_json};
use crate::kind;
use crate::log::UniformLog;
use crate::output::write_atomically;

/// Writes all three into `folder`; every `every`-th sample into the table.
///
/// # Errors
/// What the file system says.
pub(crate) fn write(
    folder: &Path,
    path: &Path,
    log: &UniformLog,
    batch: &Batch,
    numbers: &Value,
    every: usize,
) -> io::Result<()> {
    write_json(&folder.join("estimate.json"), numbers)?;
    write_csv(&folder.join("estimate.csv"), log, batch, every)?;
    show::document(log, batch, path)?.write(&folder.join("report.html"))?;
    Ok(())
}

/// The content of `estimate.json` for a log.
pub(crate) fn numbers(log: &UniformLog, batch: &Batch) -> Value {
    let mut numbers = json(batch);
    numbers["compensated"] = json!(log.compensated.effects);
    numbers
}

fn estimated(estimate: Option<Estimated<f64>>, unit: &str) -> Value {
    estimate.map_or(Value::Null, |estimate| {
        json!({
            "value": number(estimate.value),
            "std_error": number(estimate.std_error),
            "unit": kind::unit(unit),
        })
    })
}

fn parameters(parameters: &[Parameter]) -> Value {
    let entries = parameters.iter().map(|parameter| {
        (
            parameter.name.to_string(),
            estimated(parameter.estimate, parameter.unit),
        )
    });
    Value::Object(entries.collect::<Map<String, Value>>())
}

/// Young's modulus; null where the log does not determine it.
fn modulus(modulus: &Modulus) -> Value {
    json!({
        "value": modulus.value.map(|value| number(value.value)),
        "std_error": modulus.value.map(|value| number(value.std_error)),
        "unit": "Pa",
        "kind": modulus.kind.name(),
        "valid": modulus.why.is_empty(),
        "why": (!modulus.why.is_empty()).then(|| modulus.why.join("; ")),
        "relaxed": modulus.relaxed_pa.map(number),
        "indenter": modulus.indenter,
        "poisson": number(modulus.poisson),
        "exponent_assumed": number(modulus.exponent_assumed),
        "force_rmse_n": number(modulus.force_rmse_n),
    })
}

/// The content of `estimate.json`.
pub(super) fn json(batch: &Batch) -> Value {
    let per_touch = batch.per_touch.iter().map(|touch| {
        json!({
            "from_s": seconds(touch.from_s),
            "to_s": seconds(touch.to_s),
            "parameters": parameters(&touch.parameters),
            "block_rmse_n": number(touch.block_rmse_n),
        })
    });
    let selection = batch.selection.iter().map(|tried| {
        json!({
            "law": tried.family.name(),
            "modes": tried.family.modes,
            "elastic": tried.family.elastic.name(),
            "recovery": tried.family.recovery.name(),
            "parameters": tried.parameters,
            "force_rmse_n": number(tried.force_rmse_n),
            "score": number(tried.score),
        })
    });
    let ends = batch.touches.first().zip(batch.touches.last());
    let segments = ends.map(|(first, last)| {
        json!({
            "from_s": seconds(first.from_s),
            "to_s": seconds(last.to_s),
            "parameters": parameters(&batch.parameters),
        })
    });
    json!({
        "law": batch.family.name(),
        "elastic": batch.family.elastic.name(),
        "recovery": batch.family.recovery.name(),
        "method": "batch",
        "reference_depth_m": number(batch.reference_depth_m),
        "status": batch.status.name(),
        "status_reason": batch.reason.map(Reason::name),
        "parameters": parameters(&batch.parameters),
        "force_rmse_n": batch.force_rmse_n.map(number),
        "force_noise_n": number(batch.noise_n),
        "force_offset": estimated(batch.offset, "N"),
        "force_skew": estimated(batch.skew, "s"),
        "skew_s": measured(batch.skew),
        "force_low_pass": batch.low_pass.as_ref().map(low_pass),
        "misfit": number(batch.misfit),
        // Nothing settles where everything is seen at once.
        "settled_at_s": Value::Null,
        "segments": segments.into_iter().collect::<Vec<_>>(),
        "touches": touches(&batch.touches),
        "per_touch": per_touch.collect::<Vec<_>>(),
        "modulus": batch.modulus.as_ref().map(modulus),
        // The name that this had before.
        "youngs_modulus": batch.modulus.as_ref().map(modulus),
        "events": events(&batch.events),
        "selection": selection.collect::<Vec<_>>(),
        "notes": batch.notes,
    })
}

fn low_pass(own: &FoundLowPass) -> Value {
    json!({
        "corner": estimated(Some(own.corner_hz), "Hz"),
        "shape": own.shape,
        "order": own.order,
        "both_ways": own.both_ways,
        "delay_s": number(own.delay_s),
    })
}

/// A row for every `every`-th sample: what was measured, what the law says, and whether it was
/// fitted to.
fn write_csv(path: &Path, log: &UniformLog, batch: &Batch, every: usize) -> io::Result<()> {
    let columns = &batch.columns;
    write_atomically(path, |writer| {
        let mut table = csv::Writer::from_writer(writer);
        table.write_record([
            "t_s",
            "depth_m",
            "speed_mps",
            "force_n",
            "prediction_n",
            "fitted",
        ])?;
        for at in (0..columns.depth_m.len()).step_by(every) {
            let predicted = columns.estimated_n[at];
            table.write_record([
                format!("{:.6}", log.time_s[at]),
                format!("{:.6e}", columns.depth_m[at]),
                format!("{:.4e}", columns.speed_mps[at]),
                format!("{:.6e}", columns.measured_n[at]),
                if predicted.is_nan() {
                    String::new()
                } else {
                    format!("{predicted:.6e}")
                },
                u8::from(columns.used[at]).to_string(),
            ])?;
        }
        table.flush()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::{Options, batch};
    use crate::motion::Motion;
    use crate::plant::{GEL, Rig, Stage};
    use estimator_core::Config;

    const SEED: u64 = 3;

    #[test]
    fn the_fields_of_the_recursive_methods_are_there_and_the_added_ones() {
        let motion = Motion::palpation(GEL.peak_depth_m);
        let run = Rig::default().run(&Stage::throughout(GEL.at(0.0)), &motion, SEED);
        let log = run.unwrap().log.uniform().unwrap();
        let options = Options {
            indenter: "sphere:0.003".parse().ok(),
            ..Options::default()
        };
        let found = json(&batch(&log, Config::default(), &options).unwrap());
        assert_eq!(found["method"], "batch");
        for key in [
            "law",
            "reference_depth_m",
            "status",
            "force_rmse_n",
            "force_noise_n",
            "settled_at_s",
            "segments",
            "touches",
            "events",
            "notes",
        ] {
            assert!(found.get(key).is_some(), "{key}");
        }
        let damping = &found["parameters"]["damping"];
        assert!(damping["value"].is_f64() && damping["std_error"].is_f64());
        assert_eq!(damping["unit"], "N s/m");
        let count = found["touches"].as_array().unwrap().len();
        let per_touch = found["per_touch"].as_array().unwrap();
        assert_eq!(per_touch.len(), count);
        assert_eq!(per_touch[0]["parameters"]["stiffness"]["unit"], "N/m");
        let modulus = &found["youngs_modulus"];
        assert_eq!(modulus["unit"], "Pa");
        assert_eq!(modulus["indenter"], "sphere:0.003");
        assert_eq!(modulus["exponent_assumed"], 1.5);
        let chosen = found["selection"].as_array().unwrap().iter();
        let chosen = chosen.filter(|tried| tried["score"] == 0.0).count();
        assert_eq!(chosen, 1);
    }
}
