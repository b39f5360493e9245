//! The ports (RM0090, chapter 8): modes, outputs, alternate functions, and inputs that somebody outside drives.

#[derive(Clone, Copy, Default)]
pub(crate) struct Port {
    moder: u32,
    otyper: u32,
    ospeedr: u32,
    pupdr: u32,
    pub(crate) odr: u32,
    lckr: u32,
    afr: [u32; 2],
    /// What drives the pins from outside.
    pub(crate) driven: u32,
    pub(crate) driven_mask: u32,
}

impl Port {
    /// The ports A, B, C … as after a reset: A and B have the pins of JTAG.
    pub(crate) fn after_reset(index: usize) -> Port {
        let (moder, ospeedr, pupdr) = match index {
            0 => (0xa800_0000, 0x0c00_0000, 0x6400_0000),
            1 => (0x0000_0280, 0x0000_00c0, 0x0000_0100),
            _ => (0, 0, 0),
        };
        Port {
            moder,
            ospeedr,
            pupdr,
            ..Port::default()
        }
    }

    /// The alternate function of a pin, if it is in that mode.
    pub(crate) fn alternate(&self, pin: u32) -> Option<u32> {
        (self.mode(pin) == 2).then(|| self.afr[(pin / 8) as usize] >> (4 * (pin % 8)) & 0xf)
    }

    /// 0 input, 1 output, 2 alternate function, 3 analog.
    pub(crate) fn mode(&self, pin: u32) -> u32 {
        self.moder >> (2 * pin) & 3
    }

    /// Whether a pin is an output that is high; a pin of another mode is not.
    pub(crate) fn is_high(&self, pin: u32) -> bool {
        self.mode(pin) == 1 && self.odr >> pin & 1 == 1
    }

    /// Whether a resistor pulls the pin up.
    pub(crate) fn pulls_up(&self, pin: u32) -> bool {
        self.pupdr >> (2 * pin) & 3 == 1
    }

    /// Whether a pin's edges are as slow as after a reset.
    pub(crate) fn is_slow(&self, pin: u32) -> bool {
        self.ospeedr >> (2 * pin) & 3 == 0
    }

    /// Whether a pin is an output that is low.
    pub(crate) fn is_low(&self, pin: u32) -> bool {
        self.mode(pin) == 1 && self.odr >> pin & 1 == 0
    }

    fn idr(&self) -> u32 {
        (0..16).fold(0, |all, pin| {
            let level = if self.mode(pin) == 1 {
                self.odr >> pin & 1
            } else if self.driven_mask >> pin & 1 == 1 {
                self.driven >> pin & 1
            } else {
                u32::from(self.pulls_up(pin))
            };
            all | level << pin
        })
    }

    pub(crate) fn read(&self, offset: u32) -> u32 {
        match offset {
            0x00 => self.moder,
            0x04 => self.otyper,
            0x08 => self.ospeedr,
            0x0c => self.pupdr,
            0x10 => self.idr(),
            0x14 => self.odr,
            0x1c => self.lckr,
            0x20 => self.afr[0],
            0x24 => self.afr[1],
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) {
        match offset {
            0x00 => self.moder = value,
            0x04 => self.otyper = value,
            0x08 => self.ospeedr = value,
            0x0c => self.pupdr = value,
            0x14 => self.odr = value & 0xffff,
            0x18 => self.odr = self.odr & !(value >> 16) | value & 0xffff,
            0x1c => self.lckr = value,
            0x20 => self.afr[0] = value,
            0x24 => self.afr[1] = value,
            _ => {}
        }
    }
}
