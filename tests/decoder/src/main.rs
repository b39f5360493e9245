//! Turns the bytes that a firmware logs with defmt into lines: `defmt-lines ELF < bytes`.
//! Exit 1 if bytes are left that are no log of this ELF.

use defmt_decoder::{DecodeError, StreamDecoder, Table};
use std::io::{self, Read, Write};
use std::{env, fs, process};

fn main() {
    if let Err(error) = decode() {
        eprintln!("defmt-lines: {error}");
        process::exit(1);
    }
}

fn decode() -> Result<(), String> {
    let path = env::args_os()
        .nth(1)
        .ok_or("usage: defmt-lines ELF < bytes")?;
    let elf = fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let table = Table::parse(&elf)
        .map_err(|error| error.to_string())?
        .ok_or_else(|| format!("{} logs nothing with defmt", path.display()))?;
    let mut decoder = table.new_stream_decoder();
    let mut bytes = [0; 4096];
    loop {
        match io::stdin().read(&mut bytes) {
            Ok(0) => return Ok(()),
            Ok(count) => decoder.received(&bytes[..count]),
            Err(error) => return Err(error.to_string()),
        }
        print(decoder.as_mut())?;
    }
}

/// Every line that is complete, at once: a person may be watching.
fn print(decoder: &mut dyn StreamDecoder) -> Result<(), String> {
    let mut out = io::stdout().lock();
    loop {
        match decoder.decode() {
            Ok(frame) => {
                let level = frame.level().map_or("println", |level| level.as_str());
                writeln!(out, "{level:5} {}", frame.display_message())
                    .map_err(|e| e.to_string())?;
            }
            Err(DecodeError::UnexpectedEof) => return out.flush().map_err(|e| e.to_string()),
            Err(DecodeError::Malformed) => return Err("malformed log".into()),
        }
    }
}
