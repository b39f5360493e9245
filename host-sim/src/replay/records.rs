//! The records of a replay in little memory: an hour at 1 kHz has 3.6 million of 232 bytes.
//!
//! Depth, speed and force change with every sample and stand in columns. Phase, status, law, event and faults change
//! rarely and stand once for every stretch in which they stay. Of the other numbers a record keeps those that are not
//! what the record before it lets expect, and a mask of which they are: 25 bytes in contact, 5 in free air. What is
//! read is what was written, to the bit.

use std::ops::Range;
use std::sync::Mutex;

use estimator_core::estimate::{Estimated, Event, PARAMETER_SLOTS, Phase, status};
use estimator_core::{Estimate, Faults, LawKind, Status};

type Record = Estimate<f32>;

/// Records between two that are stored whole, so that any can be read without all before it.
const BLOCK: usize = 256;
/// Words of a record that are stored by what is expected of them: time, observation, prediction, innovation, its
/// variance and test ratio, forgetting factor, and value and standard error of every parameter.
const WORDS: usize = FIRST_PARAMETER + 2 * PARAMETER_SLOTS;
const TIME: usize = 0;
const OBSERVATION: usize = 2;
const PREDICTION: usize = 3;
const INNOVATION: usize = 4;
const VARIANCE: usize = 5;
const TEST_RATIO: usize = 6;
const FORGETTING: usize = 7;
/// The words from here on have bytes of the mask to themselves.
const FIRST_PARAMETER: usize = 8;
/// Bytes of a mask of so many words.
const MASK: usize = WORDS.div_ceil(8);
/// A parameter that is not there: no number that an estimator gives has these bits.
const NONE: u32 = u32::MAX;

/// What is said of a sample in words rather than in numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Said {
    /// The law that the parameters belong to.
    pub law: LawKind,
    /// Where the probe is.
    pub phase: Phase,
    /// How far the parameters can be trusted.
    pub status: Status,
    /// Why not further.
    pub reason: Option<status::Reason>,
    /// The event at the sample.
    pub event: Option<Event>,
    /// The faults of the sample.
    pub faults: Faults,
}

impl Said {
    fn of(record: &Record) -> Said {
        Said {
            law: record.law,
            phase: record.phase,
            status: record.status,
            reason: record.reason,
            event: record.event,
            faults: record.faults,
        }
    }
}

/// Records in the order of their samples.
#[derive(Debug, Default)]
pub struct Records {
    depth_m: Vec<f32>,
    speed_mps: Vec<f32>,
    force_n: Vec<f32>,
    /// Where each stretch begins, and what is said in it.
    said: Vec<(usize, Said)>,
    blocks: Vec<Block>,
    /// The bytes of the last block, which still grows.
    open: Vec<u8>,
    last: Option<Record>,
    /// The block that was read last: reading goes mostly forward or back.
    read: Mutex<Option<(usize, Vec<Record>)>>,
}

/// A record that is whole, and what the others of its block need beside it.
#[derive(Clone, Debug)]
struct Block {
    first: Record,
    /// Empty of the last block.
    bytes: Box<[u8]>,
}

impl Clone for Records {
    fn clone(&self) -> Self {
        Records {
            depth_m: self.depth_m.clone(),
            speed_mps: self.speed_mps.clone(),
            force_n: self.force_n.clone(),
            said: self.said.clone(),
            blocks: self.blocks.clone(),
            open: self.open.clone(),
            last: self.last,
            read: Mutex::default(),
        }
    }
}

impl Records {
    /// No records, with room for so many.
    pub(crate) fn with_capacity(count: usize) -> Records {
        Records {
            depth_m: Vec::with_capacity(count),
            speed_mps: Vec::with_capacity(count),
            force_n: Vec::with_capacity(count),
            ..Records::default()
        }
    }

    /// Adds the record of the next sample.
    pub(crate) fn push(&mut self, record: Record) {
        let index = self.len();
        let said = Said::of(&record);
        if self.said.last().is_none_or(|(_, last)| *last != said) {
            self.said.push((index, said));
        }
        match self.last {
            Some(before) if !index.is_multiple_of(BLOCK) => {
                push_words(&mut self.open, &before, &record);
            }
            _ => {
                if let Some(done) = self.blocks.last_mut() {
                    done.bytes = self.open.as_slice().into();
                    self.open.clear();
                }
                self.blocks.push(Block {
                    first: record,
                    bytes: Box::default(),
                });
            }
        }
        self.depth_m.push(record.depth_m);
        self.speed_mps.push(record.speed_mps);
        self.force_n.push(record.force_n);
        self.last = Some(record);
    }

    /// Number of records.
    pub fn len(&self) -> usize {
        self.depth_m.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.depth_m.is_empty()
    }

    /// The record of a sample; `None` beyond the last.
    pub fn get(&self, index: usize) -> Option<Record> {
        let number = index / BLOCK;
        let mut read = self
            .read
            .lock()
            .unwrap_or_else(|broken| broken.into_inner());
        if read.as_ref().is_none_or(|(own, _)| *own != number) {
            *read = Some((number, self.block(number)?));
        }
        read.as_ref()?.1.get(index % BLOCK).copied()
    }

    /// The record of a sample.
    ///
    /// # Panics
    /// Beyond the last.
    pub fn at(&self, index: usize) -> Record {
        self.get(index)
            .unwrap_or_else(|| panic!("record {index} of {}", self.len()))
    }

    /// The last record.
    pub fn last(&self) -> Option<&Record> {
        self.last.as_ref()
    }

    /// All records in order.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = Record> + ExactSizeIterator + Clone + '_ {
        (0..self.len()).map(|index| self.at(index))
    }

    /// Records of a range, for a reader of its own: several may read at once.
    pub fn range(&self, range: Range<usize>) -> impl Iterator<Item = Record> + '_ {
        let range = range.start.min(self.len())..range.end.min(self.len());
        let blocks = range.start / BLOCK..range.end.div_ceil(BLOCK);
        let records = blocks.filter_map(|number| self.block(number)).flatten();
        records.skip(range.start % BLOCK).take(range.len())
    }

    /// Penetration (m) of a record.
    pub fn depth_m(&self, index: usize) -> f32 {
        self.depth_m[index]
    }

    /// Its rate (m/s).
    pub fn speed_mps(&self, index: usize) -> f32 {
        self.speed_mps[index]
    }

    /// Force (N) of a record.
    pub fn force_n(&self, index: usize) -> f32 {
        self.force_n[index]
    }

    /// The stretches in which all that is said stays the same.
    pub fn stretches(&self) -> impl DoubleEndedIterator<Item = (Range<usize>, Said)> + '_ {
        (0..self.said.len()).map(|at| {
            let (start, said) = self.said[at];
            let end = self.said.get(at + 1).map_or(self.len(), |next| next.0);
            (start..end, said)
        })
    }

    /// The last record at which an event was raised.
    pub fn last_with(&self, event: Event) -> Option<usize> {
        let mut stretches = self.stretches().rev();
        let last = stretches.find(|(_, said)| said.event == Some(event));
        last.map(|(range, _)| range.end - 1)
    }

    /// The records of a block.
    fn block(&self, number: usize) -> Option<Vec<Record>> {
        let block = self.blocks.get(number)?;
        let start = number * BLOCK;
        let end = (start + BLOCK).min(self.len());
        let mut bytes = match number + 1 == self.blocks.len() {
            true => self.open.as_slice(),
            false => &block.bytes,
        };
        let mut said = self.said.partition_point(|(from, _)| *from <= start) - 1;
        let mut record = block.first;
        let mut last = words(&record);
        let mut out = Vec::with_capacity(BLOCK);
        out.push(record);
        for index in start + 1..end {
            take_words(&mut bytes, &mut last, &mut record, self.force_n[index]);
            record.depth_m = self.depth_m[index];
            record.speed_mps = self.speed_mps[index];
            while self
                .said
                .get(said + 1)
                .is_some_and(|(from, _)| *from <= index)
            {
                said += 1;
            }
            let own = self.said[said].1;
            (record.law, record.phase, record.status) = (own.law, own.phase, own.status);
            (record.reason, record.event, record.faults) = (own.reason, own.event, own.faults);
            out.push(record);
        }
        Some(out)
    }
}

/// The words of a record.
fn words(record: &Record) -> [u32; WORDS] {
    let mut words = [0; WORDS];
    words[TIME] = record.time_us as u32;
    words[TIME + 1] = (record.time_us >> 32) as u32;
    let innovation = &record.innovation;
    words[OBSERVATION] = innovation.observation_n.to_bits();
    words[PREDICTION] = innovation.prediction_n.to_bits();
    words[INNOVATION] = innovation.innovation_n.to_bits();
    words[VARIANCE] = innovation.variance_n2.to_bits();
    words[TEST_RATIO] = innovation.test_ratio.to_bits();
    words[FORGETTING] = record.forgetting.to_bits();
    let pairs = words[FIRST_PARAMETER..].chunks_exact_mut(2);
    for (pair, parameter) in pairs.zip(&record.parameters) {
        let bits = parameter.map_or([NONE; 2], |p| [p.value.to_bits(), p.std_error.to_bits()]);
        pair.copy_from_slice(&bits);
    }
    words
}

/// What a word of a record is expected to be, from those of the record before it, from its own before this one, and
/// from its force.
fn expected(
    at: usize,
    before: &[u32; WORDS],
    own: &[u32; WORDS],
    (force_before, force): (u32, u32),
) -> u32 {
    let number = |word: usize| f32::from_bits(own[word]);
    match at {
        // Samples a millisecond apart; of another rate only the masks grow.
        TIME => before[TIME].wrapping_add(1000),
        OBSERVATION if before[OBSERVATION] == force_before => force,
        INNOVATION => (number(OBSERVATION) - number(PREDICTION)).to_bits(),
        TEST_RATIO if number(VARIANCE) > 0.0 => {
            (number(INNOVATION) * number(INNOVATION) / number(VARIANCE)).to_bits()
        }
        _ => before[at],
    }
}

fn push_words(bytes: &mut Vec<u8>, before: &Record, record: &Record) {
    let (old, own) = (words(before), words(record));
    let forces = (before.force_n.to_bits(), record.force_n.to_bits());
    let start = bytes.len();
    bytes.extend([0; MASK]);
    for at in 0..WORDS {
        if own[at] != expected(at, &old, &own, forces) {
            bytes[start + at / 8] |= 1 << (at % 8);
            bytes.extend(own[at].to_le_bytes());
        }
    }
}

/// Makes a record of the one before it, and its words of the words of that one.
fn take_words(bytes: &mut &[u8], last: &mut [u32; WORDS], record: &mut Record, force_n: f32) {
    let old = *last;
    let forces = (record.force_n.to_bits(), force_n.to_bits());
    let (mask, mut rest) = bytes.split_at(MASK);
    let mut own = old;
    let mut take = |at: usize, own: &mut [u32; WORDS]| {
        if mask[at / 8] >> (at % 8) & 1 == 1
            && let Some((word, after)) = rest.split_first_chunk::<4>()
        {
            rest = after;
            own[at] = u32::from_le_bytes(*word);
        }
    };
    // What hangs on the words before it, in their order; the parameters are as in the record before or stored.
    for at in 0..FIRST_PARAMETER {
        own[at] = expected(at, &old, &own, forces);
        take(at, &mut own);
    }
    let are_new = mask[FIRST_PARAMETER / 8..].iter().any(|byte| *byte != 0);
    if are_new {
        (FIRST_PARAMETER..WORDS).for_each(|at| take(at, &mut own));
    }
    *bytes = rest;
    *last = own;
    record.force_n = force_n;
    record.time_us = u64::from(own[TIME]) | u64::from(own[TIME + 1]) << 32;
    let number = |at: usize| f32::from_bits(own[at]);
    let innovation = &mut record.innovation;
    innovation.observation_n = number(OBSERVATION);
    innovation.prediction_n = number(PREDICTION);
    innovation.innovation_n = number(INNOVATION);
    innovation.variance_n2 = number(VARIANCE);
    innovation.test_ratio = number(TEST_RATIO);
    record.forgetting = number(FORGETTING);
    if !are_new {
        return;
    }
    let pairs = own[FIRST_PARAMETER..].chunks_exact(2);
    for (parameter, pair) in record.parameters.iter_mut().zip(pairs) {
        *parameter = (pair[0] != NONE).then(|| Estimated {
            value: f32::from_bits(pair[0]),
            std_error: f32::from_bits(pair[1]),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::{Config, Sample, State, step};

    /// Three presses of 0.3 s into a spring, with noise that repeats.
    fn palpated(count: u64) -> Vec<Record> {
        let params = Config::default().validate::<f32>().unwrap();
        let mut state = State::new(&params);
        let sample = |at: u64| {
            let time_s = at as f32 * 1e-3;
            let depth = (3e-3 * (6.0 * (time_s - 0.4)).sin()).max(-1e-3);
            let noise = 0.02 * ((at * 7919 % 1000) as f32 / 500.0 - 1.0);
            Sample {
                time_us: at * 1000,
                position_m: depth,
                force_n: 1400.0 * depth.max(0.0) + noise,
                ..Sample::default()
            }
        };
        (0..count)
            .map(|at| step(&params, &mut state, sample(at)))
            .collect()
    }

    #[test]
    fn what_is_read_is_what_was_written_to_the_bit() {
        let written = palpated(3000);
        let mut records = Records::with_capacity(written.len());
        written.iter().for_each(|record| records.push(*record));
        assert!(written.iter().any(|record| record.phase == Phase::Contact));
        let bits = |record: &Record| format!("{record:?}");
        for (index, (read, own)) in records.iter().zip(&written).enumerate() {
            assert_eq!(bits(&read), bits(own), "record {index}");
        }
        let backward: Vec<Record> = records.iter().rev().collect();
        assert_eq!(backward, written.iter().rev().copied().collect::<Vec<_>>());
        let part: Vec<Record> = records.range(700..1300).collect();
        assert_eq!(part, written[700..1300]);
        assert_eq!(records.last(), written.last());
        assert_eq!(records.get(written.len()), None);
        // Stretches cover all of them, once.
        let covered: usize = records.stretches().map(|(range, _)| range.len()).sum();
        assert_eq!(covered, written.len());
        for (range, said) in records.stretches() {
            assert!(range.clone().all(|at| Said::of(&written[at]) == said));
        }
    }

    #[test]
    fn a_record_takes_a_sixth_of_its_own_size() {
        let written = palpated(3000);
        let mut records = Records::with_capacity(written.len());
        written.iter().for_each(|record| records.push(*record));
        let of_blocks: usize = records
            .blocks
            .iter()
            .map(|block| block.bytes.len() + size_of::<Block>())
            .sum();
        let bytes = of_blocks as f64 / written.len() as f64 + 12.0;
        // Measured: 32, of 232.
        assert!(bytes < 40.0, "{bytes}");
    }
}
