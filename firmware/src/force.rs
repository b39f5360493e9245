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

    /// Puts a code out, or `rest` while the output is held.
    pub fn put(&mut self, code: u16, rest: u16) {
        let code = if self.held { rest } else { code };
        self.output.put(code, rest);
    }

    /// Returns whether the hardware has put the output to rest since the last code.
    pub fn rested(&mut self) -> bool {
        self.output.rested()
    }

    /// Puts out `rest`, the code of 0 N, and holds it. While settings are saved the core stands still, for
    /// seconds if flash is erased.
    pub fn hold(&mut self, rest: u16) {
        self.output.put(rest, rest);
        self.held = true;
    }

    /// Gives the output back, once the sampling task has taken over that it is not armed.
    pub fn release(&mut self) {
        self.held = false;
    }
}
