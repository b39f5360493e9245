//! Access to the force output: the sampling task puts a force out at every tick, except while the core is
//! about to stand still.

use crate::board::ForceOutput;

/// A force output that can be held at rest.
pub struct Force<O> {
    output: O,
    held: bool,
}

impl<O: ForceOutput> Force<O> {
    /// Takes the output, which stays as it is until the first tick.
    pub const fn new(output: O) -> Self {
        Force {
            output,
            held: false,
        }
    }

    /// Puts a code out, or ignores it while the output is held.
    pub fn put(&mut self, code: u16) {
        if !self.held {
            self.output.put(code);
        }
    }

    /// Puts out `rest`, the code of 0 N, and holds it. While settings are saved the core stands still, for
    /// seconds if flash is erased, and the last force would stay on.
    pub fn hold(&mut self, rest: u16) {
        self.output.put(rest);
        self.held = true;
    }

    /// Gives the output back to the sampling task.
    pub fn release(&mut self) {
        self.held = false;
    }
}
