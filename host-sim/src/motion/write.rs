//! Motions back to TOML.

use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, Table, value};

use super::{Motion, Segment};

impl Motion {
    /// The motion as a motion file; reading it back gives the same motion.
    pub fn to_toml(&self) -> String {
        let mut document = DocumentMut::new();
        document["start"] = value(self.start_m);
        let segments = self.pieces.iter().map(|piece| table(&piece.segment));
        document["segment"] = Item::ArrayOfTables(segments.collect::<ArrayOfTables>());
        document.to_string()
    }
}

fn table(segment: &Segment) -> Table {
    let (kind, numbers) = segment.numbers();
    let mut table = Table::new();
    table["kind"] = value(kind);
    for (name, number) in numbers {
        table[name] = value(number);
    }
    if let Segment::Multisine { frequencies_hz, .. } = segment {
        table["frequencies"] = value(frequencies_hz.iter().copied().collect::<Array>());
    }
    table
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::toml_reader::TomlFile;

    #[test]
    fn a_motion_reads_back_to_the_bit() {
        let every_kind = vec![
            Segment::Hold { seconds: 0.6 },
            Segment::Ramp {
                to_m: 1.0 / 3.0 * 1e-3,
                speed_mps: 2.0,
            },
            Segment::Sine {
                mean_m: -0.1e-3,
                amplitude_m: 1.7e-9,
                frequency_hz: 12.0,
                seconds: 3.0,
            },
            Segment::Multisine {
                mean_m: 0.0,
                amplitude_m: 1e-3,
                frequencies_hz: vec![0.7, 3.0, 1e4],
                seconds: 1e-4,
            },
            Segment::Chirp {
                mean_m: 1e-3,
                amplitude_m: 1e-3,
                from_hz: 0.5,
                to_hz: 10.0,
                seconds: 86_400.0,
            },
        ];
        // GIVEN every kind of segment at the ends of the scale
        for start_m in [0.0, -2.0, 5.1e-8 / 3.0] {
            let motion = Motion::new(start_m, every_kind.clone()).unwrap();
            // WHEN it is written and read
            let file = TomlFile::parse(motion.to_toml(), Path::new("motion.toml")).unwrap();
            // THEN it is the same.
            assert_eq!(Motion::from_toml(&file).unwrap(), motion);
        }
    }
}
