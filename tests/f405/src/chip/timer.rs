//! A timer: TIM1 to TIM8 as one. RM0090, chapters 17 and 18: up-counting with preload, compare, capture on a
//! trigger, encoder mode, one pulse. Down-counting and dead times are left out.

use super::NEVER;

/// What a timer does at an instant, in the order in which the chip passes it on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Happening {
    Update,
    /// The counter has reached the compare register of a channel, 0 to 3.
    Match(usize),
}

/// The registers, with the shadows of those that are preloaded.
#[derive(Clone)]
pub(crate) struct Timer {
    pub(crate) cr1: u32,
    pub(crate) cr2: u32,
    pub(crate) smcr: u32,
    pub(crate) dier: u32,
    pub(crate) sr: u32,
    ccmr: [u32; 2],
    pub(crate) ccer: u32,
    psc: u32,
    arr: u32,
    ccr: [u32; 4],
    bdtr: u32,
    dcr: u32,
    psc_now: u32,
    arr_now: u32,
    ccr_now: [u32; 4],
    /// The output reference of each channel.
    pub(crate) reference: [bool; 4],
    /// The largest count.
    top: u32,
    /// The timer's clock, in units of time.
    clock: u64,
    since: u64,
    from: u32,
    update_at: u64,
    match_at: [u64; 4],
    /// Channels that somebody outside listens to.
    pub(crate) listened: u8,
    /// The count of the encoder at which this counter reads 0.
    zero: i64,
}

impl Timer {
    pub(crate) fn new(wide: bool) -> Self {
        let top = if wide { u32::MAX } else { 0xffff };
        Timer {
            cr1: 0,
            cr2: 0,
            smcr: 0,
            dier: 0,
            sr: 0,
            ccmr: [0; 2],
            ccer: 0,
            psc: 0,
            arr: top,
            ccr: [0; 4],
            bdtr: 0,
            dcr: 0,
            psc_now: 0,
            arr_now: top,
            ccr_now: [0; 4],
            reference: [false; 4],
            top,
            clock: 1,
            since: 0,
            from: 0,
            update_at: NEVER,
            match_at: [NEVER; 4],
            listened: 0,
            zero: 0,
        }
    }

    pub(crate) fn is_running(&self) -> bool {
        self.cr1 & 1 == 1
    }

    fn is_encoder(&self) -> bool {
        matches!(self.smcr & 7, 1..=3)
    }

    fn tick(&self) -> u64 {
        self.clock * (u64::from(self.psc_now) + 1)
    }

    /// The counter; `encoder` is the count of the encoder's edges.
    pub(crate) fn count(&self, now: u64, encoder: i64) -> u32 {
        if self.is_encoder() {
            return (encoder - self.zero) as u32 & self.top;
        }
        match self.is_running() {
            true => {
                let run = now.saturating_sub(self.since) / self.tick();
                (u64::from(self.from) + run).min(u64::from(self.top)) as u32
            }
            false => self.from,
        }
    }

    fn rebase(&mut self, now: u64, encoder: i64) {
        if self.is_encoder() {
            (self.from, self.since) = (self.count(now, encoder), now);
        } else if self.is_running() {
            let run = now.saturating_sub(self.since) / self.tick();
            self.from = (u64::from(self.from) + run) as u32 & self.top;
            self.since += run * self.tick();
        } else {
            self.since = now;
        }
    }

    pub(crate) fn set_clock(&mut self, now: u64, clock: u64) {
        if clock != self.clock {
            if !self.is_encoder() {
                self.rebase(now, 0);
            }
            self.clock = clock;
            self.schedule(false);
        }
    }

    /// Whether a match of the channel is seen by anything.
    fn is_seen(&self, channel: usize) -> bool {
        let bit = 1 << channel;
        let asks = self.dier >> (channel + 1) & 1 | self.dier >> (channel + 9) & 1;
        let master = self.cr2 >> 4 & 7;
        let is_master = master as usize == channel + 4 || master == 3 && channel == 0;
        asks != 0 || self.listened & bit != 0 || is_master
    }

    /// Sets the times of the next update and matches. A period starts with the matches at count 0.
    fn schedule(&mut self, period_starts: bool) {
        (self.update_at, self.match_at) = (NEVER, [NEVER; 4]);
        if !self.is_running() || self.is_encoder() {
            return;
        }
        let (since, from, tick) = (self.since, self.from, self.tick());
        let ahead = |count: u32| since + u64::from(count - from) * tick;
        if self.arr_now >= self.from {
            self.update_at = ahead(self.arr_now) + self.tick();
        } else {
            let round = u64::from(self.top - self.from) + 1 + u64::from(self.arr_now) + 1;
            self.update_at = self.since + round * self.tick();
        }
        for channel in 0..4 {
            let at = self.ccr_now[channel];
            let coming = at > self.from || period_starts && at == self.from;
            if self.is_seen(channel) && !self.is_input(channel) && coming && at <= self.arr_now {
                self.match_at[channel] = ahead(at);
            }
        }
    }

    pub(crate) fn event(&self) -> u64 {
        let first = self.match_at.iter().copied().min().unwrap_or(NEVER);
        first.min(self.update_at)
    }

    /// What happens at the time of [`Timer::event`].
    pub(crate) fn at_event(&mut self) -> Happening {
        let at = self.event();
        if self.update_at == at {
            self.since = at;
            self.from = 0;
            self.update();
            return Happening::Update;
        }
        let channel = (0..4).find(|c| self.match_at[*c] == at).unwrap_or(0);
        self.match_at[channel] = NEVER;
        self.sr |= 2 << channel;
        self.reference[channel] = match self.mode(channel) {
            1 | 7 => true,
            2 | 6 => false,
            3 => !self.reference[channel],
            _ => self.reference[channel],
        };
        Happening::Match(channel)
    }

    /// An update: the shadows take the preloaded values over.
    fn update(&mut self) {
        if self.cr1 & 2 != 0 {
            self.schedule(true);
            return;
        }
        self.psc_now = self.psc;
        self.arr_now = self.arr;
        self.ccr_now = self.ccr;
        self.sr |= 1;
        if self.cr1 & 8 != 0 {
            self.cr1 &= !1;
        }
        for channel in 0..4 {
            self.reference[channel] = match self.mode(channel) {
                6 => self.ccr_now[channel] > 0,
                7 => self.ccr_now[channel] == 0,
                _ => self.reference[channel],
            };
        }
        self.schedule(true);
    }

    fn half(&self, channel: usize) -> u32 {
        self.ccmr[channel / 2] >> (8 * (channel % 2)) & 0xff
    }

    fn mode(&self, channel: usize) -> u32 {
        match self.is_input(channel) {
            true => 0,
            false => self.half(channel) >> 4 & 7,
        }
    }

    fn is_input(&self, channel: usize) -> bool {
        self.half(channel) & 3 != 0
    }

    fn is_preloaded(&self, channel: usize) -> bool {
        self.half(channel) & 8 != 0
    }

    /// The trigger of another timer arrives: slave modes, and the channels that capture on it. Returns the
    /// channels that captured.
    pub(crate) fn trigger(&mut self, now: u64, encoder: i64) -> u8 {
        self.sr |= 1 << 6;
        match self.smcr & 7 {
            4 => {
                (self.from, self.since) = (0, now);
                self.update();
            }
            6 if !self.is_running() => {
                self.since = now;
                self.cr1 |= 1;
                self.schedule(false);
            }
            _ => {}
        }
        let count = self.count(now, encoder);
        let mut captured = 0;
        for channel in 0..4 {
            let on = self.ccer >> (4 * channel) & 1 == 1;
            if on && self.half(channel) & 3 == 3 {
                if self.sr >> (channel + 1) & 1 == 1 {
                    self.sr |= 1 << (channel + 9);
                }
                self.ccr[channel] = count;
                self.sr |= 2 << channel;
                captured |= 1 << channel;
            }
        }
        captured
    }

    pub(crate) fn read(&mut self, offset: u32, now: u64, encoder: i64) -> u32 {
        match offset {
            0x00 => self.cr1,
            0x04 => self.cr2,
            0x08 => self.smcr,
            0x0c => self.dier,
            0x10 => self.sr,
            0x18 => self.ccmr[0],
            0x1c => self.ccmr[1],
            0x20 => self.ccer,
            0x24 => self.count(now, encoder),
            0x28 => self.psc,
            0x2c => self.arr,
            0x34..=0x40 => {
                let channel = (offset as usize - 0x34) / 4;
                if self.is_input(channel) {
                    self.sr &= !(2 << channel);
                }
                self.ccr[channel]
            }
            0x44 => self.bdtr,
            0x48 => self.dcr,
            _ => 0,
        }
    }

    /// Writes a register; returns whether that made an update.
    pub(crate) fn write(&mut self, offset: u32, value: u32, now: u64, encoder: i64) -> bool {
        self.rebase(now, encoder);
        let mut updated = false;
        match offset {
            0x00 => self.cr1 = value & 0x3ff,
            0x04 => self.cr2 = value,
            0x08 => {
                let was = self.is_encoder();
                self.smcr = value;
                if self.is_encoder() && !was {
                    self.zero = encoder - i64::from(self.from);
                }
            }
            0x0c => self.dier = value,
            0x10 => self.sr &= value,
            0x14 => {
                self.sr |= value & 0x1e;
                if value & 1 == 1 {
                    (self.from, self.since) = (0, now);
                    // An update that software asks for raises no flag with URS.
                    let flag = self.sr & 1;
                    self.update();
                    if self.cr1 & 4 != 0 {
                        self.sr = self.sr & !1 | flag;
                    } else {
                        updated = self.cr1 & 2 == 0;
                    }
                }
            }
            0x18 | 0x1c => self.ccmr[(offset as usize - 0x18) / 4] = value,
            0x20 => self.ccer = value,
            0x24 => {
                self.from = value & self.top;
                self.zero = encoder - i64::from(value);
            }
            0x28 => self.psc = value & 0xffff,
            0x2c => {
                self.arr = value & self.top;
                if self.cr1 & 0x80 == 0 {
                    self.arr_now = self.arr;
                }
            }
            0x34..=0x40 => {
                let channel = (offset as usize - 0x34) / 4;
                self.ccr[channel] = value & self.top;
                if !self.is_preloaded(channel) {
                    self.ccr_now[channel] = self.ccr[channel];
                }
            }
            0x44 => self.bdtr = value,
            0x48 => self.dcr = value,
            _ => {}
        }
        self.schedule(false);
        updated
    }

    /// The share of a period in which a channel's pin is high, if the channel drives its pin; `halted`
    /// says that the counter stands still.
    pub(crate) fn share(&self, channel: usize, now: u64, halted: bool) -> Option<f64> {
        if self.ccer >> (4 * channel) & 1 == 0 || self.is_input(channel) {
            return None;
        }
        let at = self.ccr_now[channel];
        let period = f64::from(self.arr_now) + 1.0;
        let low = (f64::from(at) / period).min(1.0);
        let still = halted || !self.is_running();
        let before = self.count(now, 0) < at;
        let high = match (self.mode(channel), still) {
            (6, true) => f64::from(before),
            (6, false) => low,
            (7, true) => f64::from(!before),
            (7, false) => 1.0 - low,
            (5, _) => 1.0,
            _ => 0.0,
        };
        let inverted = self.ccer >> (4 * channel + 1) & 1 == 1;
        Some(if inverted { 1.0 - high } else { high })
    }

    /// The time (units) from an instant to the nearest edge of a channel's output, while that is high for 5 to 95 %
    /// of a period.
    pub(crate) fn nearest_edge(&self, channel: usize, now: u64) -> Option<u64> {
        let share = self.share(channel, now, false)?;
        if !self.is_running() || !(0.05..=0.95).contains(&share) {
            return None;
        }
        let period = (u64::from(self.arr_now) + 1) * self.tick();
        let phase = (u64::from(self.from) * self.tick() + now - self.since) % period;
        let edge = u64::from(self.ccr_now[channel]) * self.tick();
        let around = |edge: u64| phase.abs_diff(edge).min(period - phase.abs_diff(edge));
        Some(around(0).min(around(edge)))
    }
}
