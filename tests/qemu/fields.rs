//! The fields of a record with their bits, to name the first one that differs.

use estimator_core::board::reflection::Rendered;
use estimator_core::estimate::PARAMETER_SLOTS;
use estimator_core::{Estimate, Sample};

/// The name of a field and its bits.
pub(crate) type Field = (&'static str, u64);

/// Fails at the first field in which what the emulator sent differs from what the host calculated.
pub(crate) fn assert_same<T: std::fmt::Debug>(
    index: usize,
    host: &T,
    qemu: &T,
    fields: fn(&T) -> Vec<Field>,
) {
    if let Some(difference) = differs(&fields(host), &fields(qemu)) {
        panic!("sample {index}: {difference}\nhost: {host:?}\nQEMU: {qemu:?}");
    }
}

/// The first field in which two records differ, with both values.
fn differs(host: &[Field], qemu: &[Field]) -> Option<String> {
    let (host, qemu) = host.iter().zip(qemu).find(|(host, qemu)| host != qemu)?;
    let (a, b) = (f32::from_bits(host.1 as u32), f32::from_bits(qemu.1 as u32));
    Some(format!(
        "{} differs: host {:#x} ({a}), QEMU {:#x} ({b})",
        host.0, host.1, qemu.1
    ))
}

fn bits(value: f32) -> u64 {
    u64::from(value.to_bits())
}

pub(crate) fn sample_fields(sample: &Sample<f32>) -> Vec<Field> {
    vec![
        ("sample.time_us", sample.time_us),
        ("sample.faults", u64::from(sample.faults.bits())),
        ("sample.position_m", bits(sample.position_m)),
        ("sample.force_n", bits(sample.force_n)),
    ]
}

/// The fields in the order in which they are calculated, as far as there is one: the first that differs is
/// closest to the cause.
pub(crate) fn estimate_fields(estimate: &Estimate<f32>) -> Vec<Field> {
    let innovation = &estimate.innovation;
    let mut fields = vec![
        ("time_us", estimate.time_us),
        ("faults", u64::from(estimate.faults.bits())),
        ("depth_m", bits(estimate.depth_m)),
        ("speed_mps", bits(estimate.speed_mps)),
        ("force_n", bits(estimate.force_n)),
        ("phase", estimate.phase as u64),
        ("event", estimate.event.map_or(0, |event| event as u64)),
        ("law", u64::from(estimate.law.code())),
        ("prediction_n", bits(innovation.prediction_n)),
        ("variance_n2", bits(innovation.variance_n2)),
        ("test_ratio", bits(innovation.test_ratio)),
        ("forgetting", bits(estimate.forgetting)),
    ];
    macro_rules! parameter {
        ($slot:literal) => {
            [
                concat!("parameter ", $slot, " observable"),
                concat!("parameter ", $slot),
                concat!("parameter ", $slot, " std_error"),
            ]
        };
    }
    let names: [[&str; 3]; PARAMETER_SLOTS] = [
        parameter!(0),
        parameter!(1),
        parameter!(2),
        parameter!(3),
        parameter!(4),
        parameter!(5),
        parameter!(6),
        parameter!(7),
        parameter!(8),
        parameter!(9),
        parameter!(10),
        parameter!(11),
    ];
    for (slot, parameter) in estimate.parameters.iter().enumerate() {
        let known = parameter.unwrap_or_default();
        let [observable, value, std_error] = names[slot];
        fields.push((observable, u64::from(parameter.is_some())));
        fields.push((value, bits(known.value)));
        fields.push((std_error, bits(known.std_error)));
    }
    fields.push(("status", u64::from(estimate.status.code())));
    fields
}

pub(crate) fn rendered_fields(rendered: &Rendered) -> Vec<Field> {
    vec![
        ("rendered.time_us", rendered.time_us),
        ("rendered.faults", u64::from(rendered.faults.bits())),
        ("rendered.limits", u64::from(rendered.limits)),
        ("rendered.sequence", u64::from(rendered.sequence)),
        ("rendered.force_n", bits(rendered.force_n)),
    ]
}
