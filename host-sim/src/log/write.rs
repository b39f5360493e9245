//! Writing a log.

use std::io::{self, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;

use super::channel::Channel;
use super::record::Log;
use crate::output::write_atomically;

/// Digits of a channel, counted from its largest value: a 1 nm step in 1 m of travel survives.
const DIGITS: i32 = 9;

impl Log {
    /// Writes the log as CSV, `t_s,x_m,f_n`, or `t_s,x_rad,f_nm` of a machine that turns, and its further columns; gzipped if the name ends in
    /// `.gz`. Nine digits of each channel's largest value, without trailing zeros. The file appears
    /// whole or not at all.
    ///
    /// # Errors
    /// What the file system says.
    pub fn write_csv(&self, path: &Path) -> io::Result<()> {
        let zipped = path.extension().is_some_and(|extension| extension == "gz");
        write_atomically(path, |writer| {
            if !zipped {
                return self.write_rows(writer);
            }
            let mut encoder = GzEncoder::new(writer, Compression::default());
            self.write_rows(&mut encoder)?;
            encoder.finish().map(|_| ())
        })
    }

    fn write_rows(&self, writer: &mut dyn Write) -> io::Result<()> {
        let mut channels: Vec<&[f64]> = vec![&self.time_s, &self.position_m, &self.force_n];
        channels.extend(self.extra.iter().map(|column| column.values.as_slice()));
        let decimals: Vec<usize> = channels.iter().map(|channel| decimals(channel)).collect();
        let mut line = self.header()?;
        writer.write_all(&line)?;
        for row in 0..self.len() {
            line.clear();
            for (channel, decimals) in channels.iter().zip(&decimals) {
                push_number(&mut line, channel[row], *decimals)?;
                line.push(b',');
            }
            line.pop();
            line.push(b'\n');
            writer.write_all(&line)?;
        }
        Ok(())
    }

    fn header(&self) -> io::Result<Vec<u8>> {
        let names = self.extra.iter().map(|column| column.name.as_str());
        let mut writer = csv::Writer::from_writer(Vec::new());
        let kind = self.kind.unwrap_or_default();
        let own = Channel::ALL.map(|channel| channel.column_of(kind));
        writer.write_record(own.into_iter().chain(names))?;
        writer.into_inner().map_err(|error| error.into_error())
    }
}

fn decimals(channel: &[f64]) -> usize {
    let finite = channel.iter().copied().filter(|value| value.is_finite());
    let largest = finite.fold(0.0, |largest: f64, value| largest.max(value.abs()));
    if largest == 0.0 {
        return 0;
    }
    // 300: the smallest normal f64 has its first digit there.
    (DIGITS - 1 - largest.log10().floor() as i32).clamp(0, 300) as usize
}

fn push_number(line: &mut Vec<u8>, value: f64, decimals: usize) -> io::Result<()> {
    if !value.is_finite() {
        return Ok(());
    }
    let start = line.len();
    write!(line, "{value:.decimals$}")?;
    if decimals > 0 {
        let zeros = line[start..]
            .iter()
            .rev()
            .take_while(|digit| **digit == b'0')
            .count();
        line.truncate(line.len() - zeros);
        if line.ends_with(b".") {
            line.pop();
        }
    }
    if &line[start..] == b"-0" {
        line.remove(start);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::{ExtraColumn, ReadOptions};
    use super::*;
    use std::fs;

    fn sample_log() -> Log {
        let count = 40;
        let channel = |scale: f64| {
            (0..count)
                .map(|i| f64::from(i - 20) * scale)
                .collect::<Vec<_>>()
        };
        let mut log = Log::from_channels(
            (0..count).map(|i| f64::from(i) / 1000.0).collect(),
            channel(1e-6),
            channel(0.005),
        );
        log.extra.push(ExtraColumn {
            name: "temp, °C".into(),
            values: vec![21.5; 40],
        });
        log.extra[0].values[3] = f64::NAN;
        log
    }

    #[test]
    fn numbers_are_short_and_what_is_read_back_is_what_was_written() {
        for name in ["a.csv", "a.csv.gz"] {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(name);
            let log = sample_log();
            log.write_csv(&path).unwrap();
            let back = Log::read(&path, &ReadOptions::default()).unwrap();
            for (written, read) in log.force_n.iter().zip(&back.force_n) {
                // Nine digits of 0.1 N.
                assert!((written - read).abs() < 1e-10);
            }
            assert_eq!(back.extra[0].name, "temp, °C");
            assert!(back.extra[0].values[3].is_nan());
            if name == "a.csv" {
                let text = fs::read_to_string(&path).unwrap();
                assert_eq!(text.lines().nth(1), Some("0,-0.00002,-0.1,21.5"));
                assert_eq!(text.lines().nth(4), Some("0.003,-0.000017,-0.085,"));
            }
        }
    }
}
