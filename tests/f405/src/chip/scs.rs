//! The system control space: NVIC, SCB, SysTick, DWT's cycle counter. DDI 0403E, chapter B3 and C1.

use super::NEVER;

/// The first interrupt's exception number.
pub(crate) const IRQ: u32 = 16;
const NMI: u32 = 2;
const HARD_FAULT: u32 = 3;
const PENDSV: u32 = 14;
const SYSTICK: u32 = 15;
/// Exceptions of the system, which need no enabling.
const SYSTEM: u128 = 0xffff;

/// The registers.
pub struct Scs {
    pub(crate) pending: u128,
    pub(crate) active: u128,
    enabled: u128,
    /// Lines that were high when they were last looked at.
    lines: u128,
    priority: [u8; 128],
    pub(crate) primask: bool,
    pub(crate) faultmask: bool,
    pub(crate) basepri: u8,
    pub(crate) vtor: u32,
    shcsr: u32,
    ccr: u32,
    scr: u32,
    pub(crate) cpacr: u32,
    pub(crate) fpccr: u32,
    pub(crate) fpcar: u32,
    pub(crate) fpdscr: u32,
    /// Why a fault came.
    pub cfsr: u32,
    pub(crate) hfsr: u32,
    demcr: u32,
    /// The program has asked for a reset.
    pub(crate) reset: bool,
    systick: SysTick,
    dwt: Dwt,
}

impl Scs {
    pub(crate) fn new() -> Self {
        Scs {
            pending: 0,
            active: 0,
            enabled: 0,
            lines: 0,
            priority: [0; 128],
            primask: false,
            faultmask: false,
            basepri: 0,
            vtor: super::FLASH,
            shcsr: 0,
            ccr: 0x200,
            scr: 0,
            cpacr: 0,
            fpccr: 0xc000_0000,
            fpcar: 0,
            fpdscr: 0,
            cfsr: 0,
            hfsr: 0,
            demcr: 0,
            reset: false,
            systick: SysTick::default(),
            dwt: Dwt::default(),
        }
    }

    pub(crate) fn pend(&mut self, number: u32) {
        self.pending |= 1 << number;
    }

    pub(crate) fn pend_nmi(&mut self) {
        self.pend(NMI);
    }

    /// Takes the state of the interrupts' lines: a line that is high pends unless its handler runs, and a
    /// rise pends even then.
    pub(crate) fn set_lines(&mut self, lines: u128) {
        let lines = lines << IRQ;
        self.pending |= lines & (!self.active | !self.lines);
        self.lines = lines;
    }

    fn level(&self, number: u32) -> i32 {
        match number {
            NMI => -2,
            HARD_FAULT => -1,
            number => i32::from(self.priority[number as usize]),
        }
    }

    /// The level of what runs, and of what a mask allows.
    fn running(&self, with_primask: bool) -> i32 {
        let mut level = 256;
        let mut active = self.active;
        while active != 0 {
            level = level.min(self.level(active.trailing_zeros()));
            active &= active - 1;
        }
        if self.basepri != 0 {
            level = level.min(i32::from(self.basepri));
        }
        if self.primask && with_primask {
            level = level.min(0);
        }
        if self.faultmask {
            level = level.min(-1);
        }
        level
    }

    fn best(&self, held: u128) -> Option<(i32, u32)> {
        let mut ready = self.pending & (self.enabled | SYSTEM) & !held;
        let mut best: Option<(i32, u32)> = None;
        while ready != 0 {
            let number = ready.trailing_zeros();
            ready &= ready - 1;
            let level = self.level(number);
            if best.is_none_or(|(least, _)| level < least) {
                best = Some((level, number));
            }
        }
        best
    }

    /// The exception that has to be taken now, of those that are not held back.
    pub(crate) fn due(&self, held: u128) -> Option<u32> {
        let (level, number) = self.best(held)?;
        (level < self.running(true)).then_some(number)
    }

    /// Whether something wakes a core that sleeps.
    pub(crate) fn wakes(&self) -> bool {
        self.best(0)
            .is_some_and(|(level, _)| level < self.running(false))
    }

    /// A fault within a handler of faults.
    pub(crate) fn locked_up(&self) -> bool {
        self.pending >> HARD_FAULT & 1 == 1 && self.running(true) <= -1
    }

    pub(crate) fn begin(&mut self, number: u32) {
        self.pending &= !(1 << number);
        self.active |= 1 << number;
    }

    pub(crate) fn end(&mut self, number: u32) {
        self.active &= !(1 << number);
        self.pending |= self.lines & (1 << number);
        if number != NMI {
            self.faultmask = false;
        }
    }

    /// When SysTick next reaches zero.
    pub(crate) fn event(&self) -> u64 {
        self.systick.event
    }

    pub(crate) fn at_event(&mut self, now: u64, cycle: u64) {
        if now >= self.systick.event {
            self.systick.flag = true;
            self.systick.since = self.systick.event;
            self.systick.schedule(cycle);
            if self.systick.csr & 2 != 0 {
                self.pend(SYSTICK);
            }
        }
    }

    /// The core's clock changes.
    pub(crate) fn new_clock(&mut self, now: u64, old: u64, new: u64) {
        self.dwt.rebase(now, old);
        let left = u64::from(self.systick.count(now, old));
        if self.systick.event != NEVER {
            self.systick.since = now;
            self.systick.event = now + (left + 1) * new;
        }
    }

    /// The cycle counter stands still while the core sleeps.
    pub(crate) fn sleeps(&mut self, now: u64, cycle: u64, asleep: bool) {
        self.dwt.rebase(now, cycle);
        self.dwt.asleep = asleep;
    }

    /// A debugger turns the trace unit off, with its cycle counter.
    pub(crate) fn trace_off(&mut self, now: u64, cycle: u64) {
        self.dwt.rebase(now, cycle);
        self.dwt.ctrl = 0;
        self.demcr = 0;
    }

    fn bits(&self, offset: u32) -> (u32, u32) {
        (IRQ + 8 * (offset & 0xf & !3), offset & !0x7f)
    }

    pub(crate) fn read(&mut self, at: u32, now: u64, cycle: u64) -> u32 {
        let offset = at & 0xfff;
        match at {
            0xe000_1000 => 0x4000_0000 | self.dwt.ctrl,
            0xe000_1004 => self.dwt.value(now, cycle),
            0xe000_e010 => {
                let flag = u32::from(std::mem::take(&mut self.systick.flag)) << 16;
                self.systick.csr | flag
            }
            0xe000_e014 => self.systick.reload,
            0xe000_e018 => self.systick.count(now, cycle),
            0xe000_e01c => 0x8000_0000,
            0xe000_e100..=0xe000_e31f => {
                let (shift, kind) = self.bits(offset);
                let set = match kind {
                    0x100 | 0x180 => self.enabled,
                    0x200 | 0x280 => self.pending,
                    _ => self.active,
                };
                (set >> shift) as u32
            }
            0xe000_e400..=0xe000_e45f => self.priorities(IRQ + (offset - 0x400)),
            0xe000_ed00 => 0x410f_c241,
            0xe000_ed04 => self.icsr(),
            0xe000_ed08 => self.vtor,
            0xe000_ed0c => 0xfa05_0000,
            0xe000_ed10 => self.scr,
            0xe000_ed14 => self.ccr,
            0xe000_ed18..=0xe000_ed23 => self.priorities(4 + (offset - 0xd18)),
            0xe000_ed24 => self.shcsr,
            0xe000_ed28 => self.cfsr,
            0xe000_ed2c => self.hfsr,
            0xe000_ed88 => self.cpacr,
            0xe000_edf0 => 0,
            0xe000_edfc => self.demcr,
            0xe000_ef34 => self.fpccr,
            0xe000_ef38 => self.fpcar,
            0xe000_ef3c => self.fpdscr,
            _ => 0,
        }
    }

    fn icsr(&self) -> u32 {
        let running = match self.active {
            0 => 0,
            active => (active.trailing_zeros()) & 0x1ff,
        };
        let pending = self.best(0).map_or(0, |(_, number)| number);
        let irq = u32::from(self.pending >> IRQ != 0) << 22;
        running | pending << 12 | irq | ((self.pending >> PENDSV & 1) as u32 * (1 << 28))
    }

    fn priorities(&self, first: u32) -> u32 {
        let first = first as usize & !3;
        let four = self.priority.get(first..first + 4).unwrap_or(&[0; 4]);
        four.iter().rev().fold(0, |all, p| all << 8 | u32::from(*p))
    }

    /// Writes a register; priorities may be written by the byte.
    pub(crate) fn write(&mut self, at: u32, bytes: u32, value: u32, now: u64, cycle: u64) {
        let offset = at & 0xfff;
        match at {
            0xe000_1000 => {
                self.dwt.rebase(now, cycle);
                self.dwt.ctrl = value & 1;
            }
            0xe000_1004 => self.dwt.set(value, now),
            0xe000_e010 => self.systick.control(value, now, cycle),
            0xe000_e014 => self.systick.reload = value & 0xff_ffff,
            0xe000_e018 => self.systick.clear(now, cycle),
            0xe000_e100..=0xe000_e31f => {
                let (shift, kind) = self.bits(offset);
                let set = u128::from(value) << shift;
                match kind {
                    0x100 => self.enabled |= set,
                    0x180 => self.enabled &= !set,
                    0x200 => self.pending |= set,
                    0x280 => self.pending &= !(set & !self.lines),
                    _ => {}
                }
            }
            0xe000_e400..=0xe000_e45f => self.prioritize(IRQ + (offset - 0x400), bytes, value),
            0xe000_ed04 => self.set_icsr(value),
            0xe000_ed08 => self.vtor = value,
            0xe000_ed0c => self.reset |= value >> 16 == 0x05fa && value & 4 != 0,
            0xe000_ed10 => self.scr = value,
            0xe000_ed14 => self.ccr = value,
            0xe000_ed18..=0xe000_ed23 => self.prioritize(4 + (offset - 0xd18), bytes, value),
            0xe000_ed24 => self.shcsr = value,
            0xe000_ed28 => self.cfsr &= !value,
            0xe000_ed2c => self.hfsr &= !value,
            0xe000_ed88 => self.cpacr = value,
            0xe000_edfc => {
                self.dwt.rebase(now, cycle);
                self.demcr = value;
                self.dwt.traced = value >> 24 & 1 == 1;
            }
            0xe000_ef00 => self.pend(IRQ + (value & 0x1ff)),
            0xe000_ef34 => self.fpccr = value,
            0xe000_ef38 => self.fpcar = value,
            0xe000_ef3c => self.fpdscr = value,
            _ => {}
        }
    }

    fn set_icsr(&mut self, value: u32) {
        for (bit, number) in [(31, NMI), (28, PENDSV), (26, SYSTICK)] {
            if value >> bit & 1 == 1 {
                self.pend(number);
            }
        }
        for (bit, number) in [(27, PENDSV), (25, SYSTICK)] {
            if value >> bit & 1 == 1 {
                self.pending &= !(1 << number);
            }
        }
    }

    fn prioritize(&mut self, first: u32, bytes: u32, value: u32) {
        for index in 0..bytes {
            // The part has four bits of priority.
            if let Some(slot) = self.priority.get_mut((first + index) as usize) {
                *slot = (value >> (8 * index)) as u8 & 0xf0;
            }
        }
    }
}

struct SysTick {
    csr: u32,
    reload: u32,
    since: u64,
    event: u64,
    flag: bool,
}

impl Default for SysTick {
    fn default() -> Self {
        SysTick {
            csr: 4,
            reload: 0,
            since: 0,
            event: NEVER,
            flag: false,
        }
    }
}

impl SysTick {
    fn control(&mut self, value: u32, now: u64, cycle: u64) {
        let was = self.csr & 1;
        self.csr = value & 7;
        if self.csr & 1 == 0 {
            self.event = NEVER;
        } else if was == 0 {
            self.since = now;
            self.schedule(cycle);
        }
    }

    fn clear(&mut self, now: u64, cycle: u64) {
        self.flag = false;
        if self.csr & 1 == 1 {
            self.since = now;
            self.schedule(cycle);
        }
    }

    fn schedule(&mut self, cycle: u64) {
        let period = (u64::from(self.reload) + 1) * cycle * self.divided();
        self.event = if self.reload == 0 {
            NEVER
        } else {
            self.since + period
        };
    }

    /// The core's clock, or an eighth of it.
    fn divided(&self) -> u64 {
        if self.csr & 4 != 0 { 1 } else { 8 }
    }

    fn count(&self, now: u64, cycle: u64) -> u32 {
        match self.event {
            NEVER => 0,
            event => (event.saturating_sub(now) / (cycle * self.divided())) as u32,
        }
    }
}

#[derive(Default)]
struct Dwt {
    ctrl: u32,
    traced: bool,
    asleep: bool,
    count: u32,
    since: u64,
}

impl Dwt {
    fn value(&self, now: u64, cycle: u64) -> u32 {
        match self.ctrl & 1 == 1 && self.traced && !self.asleep {
            true => {
                let run = now.saturating_sub(self.since) / cycle;
                self.count.wrapping_add(run as u32)
            }
            false => self.count,
        }
    }

    fn rebase(&mut self, now: u64, cycle: u64) {
        self.set(self.value(now, cycle), now);
    }

    fn set(&mut self, count: u32, now: u64) {
        (self.count, self.since) = (count, now);
    }
}
