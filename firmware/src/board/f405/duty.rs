//! The instants of a period of the 32 kHz event: where the force is held and the encoder latched, where the
//! conversion starts for that, and where the edges of the force output's PWM lie. Counts are those of TIM2 at
//! 84 MHz; tests/pwm.rs checks the distances.

/// Counts of a period, which is also the code of the full output.
pub const PERIOD: u16 = 2625;
/// The count at which the ADC's hold capacitor closes and the encoder is latched. No edge of the PWM comes
/// within 2.6 µs of it, whatever the output is.
pub const HOLD: u16 = 2400;
/// Counts from the trigger of a conversion to the hold: 2 cycles of the ADC until it starts (DS table 67),
/// and 480 in which it samples, of 4 counts each at 21 MHz.
pub const SAMPLING: u16 = 4 * (2 + 480);
/// The count that triggers the conversion, so that force and position are of the same instant.
pub const CONVERT: u16 = HOLD - SAMPLING;

/// Where the pulse of a period lies: at its begin, or at its end.
///
/// A short pulse starts with the period, so that both edges come before the hold. A long one ends with it: then
/// the moving edge is again in the first half. In between the pulse stays where it was, from 45 to 55 % of the
/// output, so that noise does not move it to and fro. A change shows a wrong pulse for two periods at most, 62 µs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pulse {
    at_end: bool,
}

impl Pulse {
    /// Takes the next code of the output, of at most [`PERIOD`], and returns whether the pulse ends with the period.
    pub fn place(&mut self, code: u16) -> bool {
        const UP: u16 = PERIOD / 20 * 11;
        const DOWN: u16 = PERIOD / 20 * 9;
        self.at_end = match self.at_end {
            false => code > UP,
            true => code >= DOWN,
        };
        self.at_end
    }

    /// Returns the count at which the pulse of a code starts or ends.
    pub fn edge(self, code: u16) -> u16 {
        match self.at_end {
            false => code,
            true => PERIOD.saturating_sub(code),
        }
    }
}
