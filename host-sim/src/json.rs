//! Numbers and files of JSON as all results write them.

use std::io;
use std::path::Path;

use serde_json::{Value, json};

use crate::output::write_atomically;

/// Six significant digits, so that a value reads as it was computed: in single precision.
pub(crate) fn number(value: f64) -> Value {
    let text = format!("{value:.6e}");
    text.parse::<f64>()
        .ok()
        .filter(|v| v.is_finite())
        .map_or(Value::Null, |v| json!(v))
}

pub(crate) fn seconds(value: f64) -> Value {
    json!((value * 1e6).round() / 1e6)
}

/// Writes a JSON file.
///
/// # Errors
/// What the file system says; nothing is half written.
pub(crate) fn write_json(path: &Path, value: &Value) -> io::Result<()> {
    write_atomically(path, |writer| {
        serde_json::to_writer_pretty(&mut *writer, value)?;
        writeln!(writer)
    })
}
