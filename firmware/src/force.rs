//! The force that is put out, and who may put it out: the sampling task at every tick, unless the core
//! is about to stand still.

use crate::board::ForceOutput;

/// An output that can be held at rest.
pub struct Force<O> {
    output: O,
    held: bool,
}

impl<O: ForceOutput> Force<O> {
    /// Nothing is put out before the first tick.
    pub const fn new(output: O) -> Self {
        Force {
            output,
            held: false,
        }
    }

    /// Puts a code out; not while it is held.
    pub fn put(&mut self, code: u16) {
        if !self.held {
            self.output.put(code);
        }
    }

    /// Puts out the code of 0 N and keeps it: while settings are saved the core stands still, for
    /// seconds if flash is erased, and a force would stand with it.
    pub fn hold(&mut self, rest: u16) {
        self.output.put(rest);
        self.held = true;
    }

    /// Lets the sampling task have it again.
    pub fn release(&mut self) {
        self.held = false;
    }
}
