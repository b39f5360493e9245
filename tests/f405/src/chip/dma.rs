//! The two DMA controllers (RM0090, chapter 10): eight streams each, in direct mode, one item a request;
//! circular mode and double buffers. FIFO and bursts are left out.

/// Who asks for an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Request {
    /// Of TIM1 to TIM8: the number, and 0 for the update, 1 to 4 for the channels, 5 for the trigger.
    Timer(u8, u8),
    Adc1,
    Uart4Tx,
    Uart4Rx,
    Spi3Tx,
    Spi3Rx,
}

impl Request {
    fn number(self) -> u32 {
        match self {
            Request::Timer(timer, what) => u32::from(timer) * 6 + u32::from(what),
            Request::Adc1 => 60,
            Request::Uart4Tx => 61,
            Request::Uart4Rx => 62,
            Request::Spi3Tx => 58,
            Request::Spi3Rx => 59,
        }
    }
}

/// The requests of a channel of a stream: tables 42 and 43.
fn requests(dma: usize, stream: usize, channel: u32) -> &'static [Request] {
    use Request::{Adc1, Spi3Rx, Spi3Tx, Timer, Uart4Rx, Uart4Tx};
    match (dma, channel, stream) {
        (0, 0, 0 | 2) => &[Spi3Rx],
        (0, 0, 5 | 7) => &[Spi3Tx],
        (0, 1, 2 | 4) => &[Timer(7, 0)],
        (0, 2, 0) => &[Timer(4, 1)],
        (0, 2, 3) => &[Timer(4, 2)],
        (0, 2, 6) => &[Timer(4, 0)],
        (0, 2, 7) => &[Timer(4, 3)],
        (0, 3, 1) => &[Timer(2, 0), Timer(2, 3)],
        (0, 3, 5) => &[Timer(2, 1)],
        (0, 3, 6) => &[Timer(2, 2), Timer(2, 4)],
        (0, 3, 7) => &[Timer(2, 0), Timer(2, 4)],
        (0, 4, 2) => &[Uart4Rx],
        (0, 4, 4) => &[Uart4Tx],
        (0, 5, 2) => &[Timer(3, 4), Timer(3, 0)],
        (0, 5, 4) => &[Timer(3, 1), Timer(3, 5)],
        (0, 5, 5) => &[Timer(3, 2)],
        (0, 5, 7) => &[Timer(3, 3)],
        (0, 6, 0) => &[Timer(5, 3), Timer(5, 0)],
        (0, 6, 1 | 3) => &[Timer(5, 4), Timer(5, 5)],
        (0, 6, 2) => &[Timer(5, 1)],
        (0, 6, 4) => &[Timer(5, 2)],
        (0, 6, 6) => &[Timer(5, 0)],
        (0, 7, 1) => &[Timer(6, 0)],
        (1, 0, 0 | 4) => &[Adc1],
        (1, 0, 2) => &[Timer(8, 1), Timer(8, 2), Timer(8, 3)],
        (1, 0, 6) => &[Timer(1, 1), Timer(1, 2), Timer(1, 3)],
        (1, 6, 0) => &[Timer(1, 5)],
        (1, 6, 1 | 3) => &[Timer(1, 1)],
        (1, 6, 2) => &[Timer(1, 2)],
        (1, 6, 4) => &[Timer(1, 4), Timer(1, 5)],
        (1, 6, 5) => &[Timer(1, 0)],
        (1, 6, 6) => &[Timer(1, 3)],
        (1, 7, 1) => &[Timer(8, 0)],
        (1, 7, 2) => &[Timer(8, 1)],
        (1, 7, 3) => &[Timer(8, 2)],
        (1, 7, 4) => &[Timer(8, 3)],
        (1, 7, 7) => &[Timer(8, 4), Timer(8, 5)],
        _ => &[],
    }
}

#[derive(Clone, Copy, Default)]
pub(crate) struct Stream {
    pub(crate) cr: u32,
    left: u32,
    reload: u32,
    par: u32,
    memory: [u32; 2],
    fcr: u32,
}

/// An item to be moved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item {
    pub(crate) from: u32,
    pub(crate) to: u32,
    pub(crate) bytes: u32,
}

/// Both controllers.
pub(crate) struct Dma {
    pub(crate) streams: [[Stream; 8]; 2],
    flags: [u64; 2],
    /// Requests that no stream has served.
    waiting: u64,
}

/// A stream's flags are at six bits' distance, with gaps.
const PLACE: [u32; 8] = [0, 6, 16, 22, 32, 38, 48, 54];
const TRANSFER_ERROR: u64 = 1 << 3;
const HALF: u64 = 1 << 4;
const COMPLETE: u64 = 1 << 5;

impl Dma {
    pub(crate) fn new() -> Self {
        Dma {
            streams: [[Stream {
                fcr: 0x21,
                ..Stream::default()
            }; 8]; 2],
            flags: [0; 2],
            waiting: 0,
        }
    }

    /// A request comes; it waits until a stream takes it.
    pub(crate) fn raise(&mut self, request: Request) {
        self.waiting |= 1 << request.number();
    }

    pub(crate) fn withdraw(&mut self, request: Request) {
        self.waiting &= !(1 << request.number());
    }

    pub(crate) fn is_waiting(&self, request: Request) -> bool {
        self.waiting >> request.number() & 1 == 1
    }

    pub(crate) fn anything_waits(&self) -> bool {
        self.waiting != 0
    }

    /// The next item that a stream moves for a request, with the request.
    pub(crate) fn next(&mut self) -> Option<Item> {
        for dma in 0..2 {
            for index in 0..8 {
                let stream = self.streams[dma][index];
                if stream.cr & 1 == 0 {
                    continue;
                }
                let channel = stream.cr >> 25 & 7;
                for request in requests(dma, index, channel) {
                    if self.is_waiting(*request) {
                        self.withdraw(*request);
                        return Some(self.advance(dma, index));
                    }
                }
            }
        }
        None
    }

    fn advance(&mut self, dma: usize, index: usize) -> Item {
        let stream = &mut self.streams[dma][index];
        let done = stream.reload - stream.left;
        let bytes = 1 << (stream.cr >> 11 & 3);
        let current = (stream.cr >> 19 & 1) as usize;
        let step = |bit: u32| {
            if stream.cr >> bit & 1 == 1 {
                bytes * done
            } else {
                0
            }
        };
        let memory = stream.memory[current] + step(10);
        let peripheral = stream.par + step(9);
        let item = match stream.cr >> 6 & 3 {
            0 => Item {
                from: peripheral,
                to: memory,
                bytes,
            },
            _ => Item {
                from: memory,
                to: peripheral,
                bytes,
            },
        };
        stream.left -= 1;
        if stream.left == stream.reload / 2 {
            self.flags[dma] |= HALF << PLACE[index];
        }
        if stream.left == 0 {
            self.flags[dma] |= COMPLETE << PLACE[index];
            let double = stream.cr >> 18 & 1 == 1;
            if double {
                stream.cr ^= 1 << 19;
            }
            match double || stream.cr >> 8 & 1 == 1 {
                true => stream.left = stream.reload,
                false => stream.cr &= !1,
            }
        }
        item
    }

    /// A stream meets a bus error and stops.
    pub(crate) fn fail(&mut self, dma: usize, index: usize) {
        self.streams[dma][index].cr &= !1;
        self.flags[dma] |= TRANSFER_ERROR << PLACE[index];
    }

    /// Whether a stream's interrupt line is high.
    pub(crate) fn line(&self, dma: usize, index: usize) -> bool {
        let flags = self.flags[dma] >> PLACE[index];
        let cr = u64::from(self.streams[dma][index].cr);
        // TEIE, HTIE and TCIE stand one bit below their flags; DMEIE and its flag are left out.
        flags & cr << 1 & (TRANSFER_ERROR | HALF | COMPLETE) != 0
    }

    pub(crate) fn read(&self, dma: usize, offset: u32) -> u32 {
        match offset {
            0 => self.flags[dma] as u32,
            4 => (self.flags[dma] >> 32) as u32,
            8 | 12 => 0,
            _ => {
                let stream = &self.streams[dma][((offset - 0x10) / 0x18 % 8) as usize];
                match (offset - 0x10) % 0x18 {
                    0x00 => stream.cr,
                    0x04 => stream.left,
                    0x08 => stream.par,
                    0x0c => stream.memory[0],
                    0x10 => stream.memory[1],
                    _ => stream.fcr,
                }
            }
        }
    }

    pub(crate) fn write(&mut self, dma: usize, offset: u32, value: u32) {
        match offset {
            0 | 4 => {}
            8 => self.flags[dma] &= !u64::from(value),
            12 => self.flags[dma] &= !(u64::from(value) << 32),
            _ => {
                let stream = &mut self.streams[dma][((offset - 0x10) / 0x18 % 8) as usize];
                let on = stream.cr & 1 == 1;
                match (offset - 0x10) % 0x18 {
                    0x00 if on => {
                        // While it runs, only the interrupts and EN may change.
                        let may = 0x1f;
                        stream.cr = stream.cr & !may | value & may;
                    }
                    0x00 => {
                        stream.cr = value;
                        if value & 1 == 1 && stream.left == 0 {
                            stream.cr &= !1;
                        }
                    }
                    0x04 if !on => (stream.left, stream.reload) = (value & 0xffff, value & 0xffff),
                    0x08 if !on => stream.par = value,
                    0x0c if !on || stream.cr >> 19 & 1 == 1 => stream.memory[0] = value,
                    0x10 if !on || stream.cr >> 19 & 1 == 0 => stream.memory[1] = value,
                    0x14 if !on => stream.fcr = value,
                    _ => {}
                }
            }
        }
    }
}
