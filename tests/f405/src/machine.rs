//! Core and chip together: time goes on, resets happen, and something can be broken on purpose.

use crate::chip::flash::Operation;
use crate::chip::{Chip, FLASH, MICROSECOND, Part, Reset, UNITS_PER_SECOND};
use crate::cpu::Core;
use crate::elf::Image;
use crate::world::World;

/// A board with its program.
pub struct Machine {
    /// The core.
    pub core: Core,
    /// The part around it.
    pub chip: Chip,
    /// The core has met a fault within a fault and stands still.
    locked: bool,
    /// What the flash held before an operation number, if that was asked for.
    stop_at_operation: Option<usize>,
}

impl Machine {
    /// A board that has just been switched on.
    pub fn new(image: &Image, part: Part, world: Box<dyn World>) -> Self {
        let mut chip = Chip::new(part, world);
        let mut end = 0;
        for (at, bytes) in &image.pieces {
            let from = (at - FLASH) as usize;
            chip.flash.memory[from..from + bytes.len()].copy_from_slice(bytes);
            end = end.max(from + bytes.len());
        }
        let mut core = Core::new(end);
        core.reset(&mut chip);
        Machine {
            core,
            chip,
            locked: false,
            stop_at_operation: None,
        }
    }

    /// Goes on for some time (s).
    pub fn run(&mut self, seconds: f64) {
        let until = self.chip.now + (seconds * UNITS_PER_SECOND as f64) as u64;
        self.run_until(until);
    }

    /// Goes on until a time (units).
    pub fn run_until(&mut self, until: u64) {
        while self.chip.now < until {
            if self.chip.attention || self.chip.now >= self.chip.next_event {
                self.service();
                if self.stop_at_operation == Some(self.chip.flash.operations.len()) {
                    return;
                }
            }
            let limit = until.min(self.chip.next_event);
            if self.core.asleep || self.locked || self.chip.rcc.stopped {
                self.chip.now = self.chip.now.max(limit);
            } else {
                self.core.run(&mut self.chip, limit);
            }
        }
    }

    /// Looks at everything besides instructions: faults, the flash, events, resets, exceptions.
    fn service(&mut self) {
        const BUS_FAULT: u32 = 1 << 9;
        let chip = &mut self.chip;
        chip.attention = false;
        if std::mem::take(&mut chip.fault) {
            chip.scs.cfsr |= BUS_FAULT;
            chip.scs.hfsr |= 1 << 30;
            chip.scs.pend(3);
        }
        self.wait_for_flash();
        let chip = &mut self.chip;
        chip.advance();
        chip.attention = false;
        if let Some(why) = chip.reset {
            self.reset(why);
            return;
        }
        if self.core.asleep && chip.scs.wakes() {
            self.core.asleep = false;
            chip.scs.sleeps(chip.now, chip.cycle(), false);
        } else if self.core.asleep {
            chip.scs.sleeps(chip.now, chip.cycle(), true);
        }
        if self.locked || chip.rcc.stopped {
            return;
        }
        if chip.scs.locked_up() {
            self.locked = true;
            return;
        }
        let held = if chip.now < chip.held.1 {
            chip.held.0
        } else {
            0
        };
        if let Some(number) = chip.scs.due(held) {
            self.core.begin_exception(chip, number);
        }
    }

    /// While the flash is busy, a core that runs from it stands still.
    fn wait_for_flash(&mut self) {
        const SIZE: u32 = 1 << 20;
        let chip = &mut self.chip;
        let until = chip.flash.busy_until;
        let runs_from_flash = self.core.next.wrapping_sub(FLASH) < SIZE;
        while runs_from_flash && chip.now < until && chip.reset.is_none() {
            let next = chip.next_event.clamp(chip.now, until);
            chip.now = next;
            chip.advance();
        }
    }

    fn reset(&mut self, why: Reset) {
        self.chip.reset(why);
        // What hung does not hang again.
        self.core.forget();
        self.core.reset(&mut self.chip);
        self.locked = false;
    }

    /// The supply sinks below the threshold and comes back.
    pub fn brown_out(&mut self) {
        self.reset(Reset::BrownOut);
    }

    /// The supply sinks to 2.85 V, too little for the flash at 168 MHz and too much for a reset, and comes back.
    pub fn sink_supply(&mut self) {
        self.chip.sink_supply();
    }

    /// The supply goes altogether: only the flash stays.
    pub fn lose_power(&mut self) {
        self.chip.lose_power();
        self.brown_out();
    }

    /// Whether the core stands still for good.
    pub fn is_locked_up(&self) -> bool {
        self.locked
    }

    /// The next instruction at an address hangs, from now until a reset by power.
    pub fn hang_at(&mut self, at: u32) {
        self.core.hang_at(at & !1);
    }

    /// The core hangs where it is, with interrupts off.
    pub fn hang_without_interrupts(&mut self) {
        self.chip.scs.primask = true;
        self.core.hang_at(self.core.next);
    }

    /// The core meets a hard fault.
    pub fn crash(&mut self) {
        self.chip.scs.pend(3);
        self.chip.attention = true;
    }

    /// The PLL does not lock on the internal oscillator either.
    pub fn internal_never_locks(&mut self) {
        self.chip.rcc.internal_unlockable = true;
    }

    /// The cable of the encoder on SPI comes off.
    pub fn cut_encoder(&mut self) {
        self.chip.sensors.cut[0] = true;
    }

    /// The cable of the bridge converter on SPI comes off.
    pub fn cut_converter(&mut self) {
        self.chip.sensors.cut[1] = true;
    }

    /// Stops a stream of a DMA controller (1 or 2), as a bus error does.
    pub fn stop_stream(&mut self, dma: usize, stream: usize) {
        self.chip.fail_stream(dma - 1, stream);
    }

    /// Loses a conversion of the ADC.
    pub fn overrun_adc(&mut self) {
        self.chip.overrun_adc();
    }

    /// Holds the interrupts with these numbers back for a time (µs).
    pub fn hold_interrupts(&mut self, irqs: &[u32], us: u64) {
        let mask = irqs.iter().fold(0, |all, irq| all | 1 << (irq + 16));
        self.chip.held = (mask, self.chip.now + us * MICROSECOND);
        self.chip.attention = true;
    }

    /// A debugger leaves and switches the trace unit off, with the cycle counter.
    pub fn trace_off(&mut self) {
        let (now, cycle) = (self.chip.now, self.chip.cycle());
        self.chip.scs.trace_off(now, cycle);
    }

    /// A debugger has had the trace's pins.
    pub fn give_trace_its_pins(&mut self) {
        self.chip.give_trace_its_pins();
    }

    /// The supply of the bridge converter is gone for an instant: its registers are those of its start.
    pub fn brown_out_converter(&mut self) {
        self.chip.sensors.brown_out_converter();
    }

    /// The operations on the flash so far, with their times.
    pub fn flash_operations(&self) -> &[(u64, Operation)] {
        &self.chip.flash.operations
    }

    /// The contents of the flash.
    pub fn flash(&self) -> &[u8] {
        &self.chip.flash.memory
    }

    /// Replaces the contents of the flash.
    pub fn set_flash(&mut self, memory: &[u8]) {
        self.chip.flash.memory.copy_from_slice(memory);
    }

    /// Lets [`Machine::run_until`] return when so many operations on the flash have begun.
    pub fn stop_at_operation(&mut self, count: Option<usize>) {
        self.stop_at_operation = count;
    }

    /// The address of the next instruction, for a message.
    pub fn program_counter(&self) -> u32 {
        self.core.next
    }
}
