//! What the model notes while it runs: the output, the exceptions, and what should never happen.

use super::UNITS_PER_SECOND;
use std::collections::BTreeMap;

/// What drives the force output's amplifier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// Nothing does: the resistor outside puts the output to 0 N.
    Floating,
    /// A square wave, high for this share of the time.
    Share(f64),
}

impl Drive {
    /// Whether this is 0 N: floating, or the share that stands for 0 N within half a step.
    pub fn is_rest(self, zero: f64) -> bool {
        match self {
            Drive::Floating => true,
            Drive::Share(share) => (share - zero).abs() < 0.5 / 2625.0,
        }
    }
}

/// What the exception with a number has cost.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cost {
    /// How often it was taken.
    pub count: u64,
    /// Instructions altogether, those of exceptions that came in between included.
    pub instructions: u64,
    /// The largest number of instructions.
    pub most: u64,
    /// Instructions altogether, without those of exceptions that came in between.
    pub own: u64,
    /// The longest time from entry to return (s).
    pub longest_s: f64,
}

/// The notes of a run.
#[derive(Default)]
pub struct Trace {
    /// Changes of the force output.
    pub drive: Vec<(u64, Drive)>,
    /// Exceptions by number.
    pub costs: BTreeMap<u32, Cost>,
    /// Times of entry into exception `followed`.
    pub entries: Vec<u64>,
    /// The exception whose entries are kept.
    pub followed: u32,
    /// Times of entry into the exceptions that are active, and the instructions of those that came in between.
    entered: Vec<(u64, u64)>,
    /// Instructions that the interpreter does not know: address and code.
    pub undefined: Vec<(u32, u32)>,
    /// Accesses to addresses that the model does not have.
    pub unmapped: Vec<u32>,
    /// Resets: when and why.
    pub resets: Vec<(u64, Reset)>,
    /// The smallest distance between a hold of the ADC and an edge of the output, in units.
    pub nearest_edge: Option<u64>,
    /// The holds of the ADC, if they are to be kept.
    pub holds: Vec<u64>,
    /// The latches of the encoder, if they are to be kept.
    pub latches: Vec<u64>,
    /// Whether holds and latches are kept.
    pub keep_instants: bool,
}

/// Why the board was reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reset {
    /// The independent watchdog was not fed.
    Watchdog,
    /// The program asked for it.
    Software,
    /// The supply was too low.
    BrownOut,
}

impl Trace {
    pub(crate) fn entered(&mut self, number: u32, now: u64) {
        self.entered.push((now, 0));
        if number == self.followed {
            self.entries.push(now);
        }
    }

    pub(crate) fn left(&mut self, number: u32, instructions: u64, now: u64) {
        let (since, between) = self.entered.pop().unwrap_or((now, 0));
        if let Some((_, within)) = self.entered.last_mut() {
            *within += instructions;
        }
        let cost = self.costs.entry(number).or_default();
        cost.count += 1;
        cost.instructions += instructions;
        cost.most = cost.most.max(instructions);
        cost.own += instructions.saturating_sub(between);
        let took = (now - since) as f64 / UNITS_PER_SECOND as f64;
        cost.longest_s = cost.longest_s.max(took);
    }

    pub(crate) fn was_reset(&mut self, now: u64, why: Reset) {
        self.entered.clear();
        self.resets.push((now, why));
    }

    pub(crate) fn undefined(&mut self, at: u32, code: u32) {
        if self.undefined.len() < 20 {
            self.undefined.push((at, code));
        }
    }

    pub(crate) fn unmapped(&mut self, at: u32) {
        if self.unmapped.len() < 20 && !self.unmapped.contains(&at) {
            self.unmapped.push(at);
        }
    }

    pub(crate) fn driven(&mut self, now: u64, drive: Drive) {
        if self.drive.last().is_none_or(|(_, last)| *last != drive) {
            self.drive.push((now, drive));
        }
    }
}
