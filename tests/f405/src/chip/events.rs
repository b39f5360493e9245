//! What happens by itself, in the order of its time, and who hears of it.

use super::dma::Request;
use super::{Chip, NEVER, Reset, adc, timer};

/// Numbers of the interrupts (RM0090, table 62).
const PVD_IRQ: u32 = 1;
const ADC_IRQ: u32 = 18;
const SPI3_IRQ: u32 = 51;
const UART4_IRQ: u32 = 52;
const DMA1_IRQS: [u32; 8] = [11, 12, 13, 14, 15, 16, 17, 47];
const DMA2_IRQS: [u32; 8] = [56, 57, 58, 59, 60, 68, 69, 70];
/// TIM1 and TIM8 have several; those of update and compare are alike here.
const TIMER_IRQS: [u32; 8] = [27, 28, 29, 30, 50, 54, 55, 46];

/// The timers, counted from 0, that a slave's four internal triggers come from (RM0090, tables 93 and 98).
const TRIGGERS: [[usize; 4]; 8] = [
    [4, 1, 2, 3],
    [0, 7, 2, 3],
    [0, 1, 4, 3],
    [0, 1, 2, 7],
    [1, 2, 3, 7],
    [9; 4],
    [9; 4],
    [0, 1, 3, 4],
];

/// The compare events that may trigger the ADC: number of the trigger, timer, channel.
const ADC_COMPARES: [(u32, usize, usize); 12] = [
    (0, 0, 0),
    (1, 0, 1),
    (2, 0, 2),
    (3, 1, 1),
    (4, 1, 2),
    (5, 1, 3),
    (7, 2, 0),
    (9, 3, 3),
    (10, 4, 0),
    (11, 4, 1),
    (12, 4, 2),
    (13, 7, 0),
];

impl Chip {
    /// Does everything that is due and finds the next event.
    pub(crate) fn advance(&mut self) {
        self.advancing = true;
        loop {
            let next = self.first_event();
            if next > self.now {
                self.next_event = next;
                break;
            }
            let now = std::mem::replace(&mut self.now, next);
            self.at_event(next);
            self.now = self.now.max(now);
            self.serve();
        }
        self.serve();
        self.advancing = false;
        self.next_event = self.first_event();
        let lines = self.lines();
        self.scs.set_lines(lines);
        if self.rcc.failed() {
            self.scs.pend_nmi();
        }
        if self.scs.reset {
            self.reset = Some(Reset::Software);
        }
    }

    /// Does what was due before an access to a register: an event that comes within an instruction would
    /// otherwise meet registers of after it.
    pub(super) fn catch_up(&mut self) {
        if self.now >= self.next_event && !self.advancing {
            self.advance();
        }
    }

    fn first_event(&self) -> u64 {
        let watchdog = self.iwdg.event();
        if self.rcc.stopped {
            return watchdog;
        }
        let timers = self.timers.iter().map(timer::Timer::event);
        timers
            .chain([
                watchdog,
                self.rcc.event(),
                self.adc.event(),
                self.uart.event(),
                self.spi.event(),
                self.sensors.event(),
                self.scs.event(),
                self.world.event(),
                if self.held.1 > self.now {
                    self.held.1
                } else {
                    NEVER
                },
            ])
            .min()
            .unwrap_or(NEVER)
    }

    fn at_event(&mut self, at: u64) {
        if self.iwdg.event() <= at {
            self.reset = Some(Reset::Watchdog);
            self.iwdg = super::Iwdg::new(self.part.watchdog_hz);
            return;
        }
        if self.rcc.event() <= at {
            self.crystal_dies();
            return;
        }
        for index in 0..self.timers.len() {
            while self.timers[index].event() <= at {
                self.timer_event(index);
            }
        }
        if self.adc.event() <= at {
            self.adc_event(at);
        }
        if self.uart.event() <= at {
            self.uart.at_event(at);
        }
        if self.spi.event() <= at {
            self.spi_event(at);
        }
        if self.sensors.event() <= at {
            let world = &mut self.world;
            self.sensors.at_event(|from, to| world.bridge(from, to));
        }
        let cycle = self.cycle();
        self.scs.at_event(at, cycle);
        if self.world.event() <= at {
            self.world.at_event(at);
        }
    }

    fn crystal_dies(&mut self) {
        let (now, cycle) = (self.now, self.cycle());
        if !self.rcc.at_event() && self.rcc.stopped {
            self.scs.sleeps(now, cycle, true);
        }
        self.take_clock();
        self.note_drive();
    }

    fn timer_event(&mut self, index: usize) {
        let before = self.timers[index].reference;
        match self.timers[index].at_event() {
            timer::Happening::Update => self.timer_updated(index),
            timer::Happening::Match(channel) => {
                let timer = &self.timers[index];
                if timer.dier >> (channel + 9) & 1 == 1 {
                    let request = Request::Timer(index as u8 + 1, channel as u8 + 1);
                    self.dma.raise(request);
                }
                if timer.cr2 >> 4 & 7 == 3 && channel == 0 {
                    self.trigger_output(index);
                }
            }
        }
        self.references(index, before);
        self.note_drive();
    }

    /// An update of a timer: a request, and the trigger output if it is that.
    pub(super) fn timer_updated(&mut self, index: usize) {
        let timer = &self.timers[index];
        let (dier, master) = (timer.dier, timer.cr2 >> 4 & 7);
        if dier >> 8 & 1 == 1 {
            self.dma.raise(Request::Timer(index as u8 + 1, 0));
        }
        if master == 2 {
            self.trigger_output(index);
        }
    }

    /// The edges of a timer's output references: they may trigger the ADC or be the trigger output.
    fn references(&mut self, index: usize, before: [bool; 4]) {
        let (selected, edges) = self.adc.trigger();
        let after = self.timers[index].reference;
        for (channel, (was, is)) in before.into_iter().zip(after).enumerate() {
            if was == is {
                continue;
            }
            let counts = edges >> u32::from(!is) & 1 == 1;
            if counts && ADC_COMPARES.contains(&(selected, index, channel)) {
                self.adc.start(self.now);
            }
            if is && (self.timers[index].cr2 >> 4 & 7) as usize == channel + 4 {
                self.trigger_output(index);
            }
        }
    }

    /// Tells the timers which of their compare channels the ADC listens to.
    pub(super) fn listen(&mut self) {
        let (selected, edges) = self.adc.trigger();
        for (index, timer) in self.timers.iter_mut().enumerate() {
            timer.listened = ADC_COMPARES
                .iter()
                .filter(|(number, of, _)| edges != 0 && *number == selected && *of == index)
                .fold(0, |all, (_, _, channel)| all | 1 << channel);
        }
    }

    /// The trigger output of a timer: to the ADC, and to the timers that have it as their trigger.
    fn trigger_output(&mut self, index: usize) {
        let (selected, edges) = self.adc.trigger();
        let of_adc = match index {
            1 => 6,
            2 => 8,
            7 => 14,
            _ => u32::MAX,
        };
        if selected == of_adc && edges & 1 == 1 {
            self.adc.start(self.now);
        }
        for (slave, sources) in TRIGGERS.iter().enumerate() {
            let source = (self.timers[slave].smcr >> 4 & 7) as usize;
            if sources.get(source) != Some(&index) || slave == index {
                continue;
            }
            let counts = self.world.counts(self.now);
            let captured = self.timers[slave].trigger(self.now, counts);
            if captured != 0 && self.trace.keep_instants {
                self.trace.latches.push(self.now);
            }
            for channel in (0..4).filter(|channel| captured >> channel & 1 == 1) {
                if self.timers[slave].dier >> (channel + 9) & 1 == 1 {
                    self.dma.raise(Request::Timer(slave as u8 + 1, channel + 1));
                }
            }
        }
    }

    fn adc_event(&mut self, at: u64) {
        match self.adc.at_event() {
            adc::Happening::Hold => {
                let code = match self.adc.channel() {
                    2 => self.world.force_code(at),
                    _ => 1500,
                };
                self.adc.hold(code);
                if self.trace.keep_instants {
                    self.trace.holds.push(at);
                }
                let edge = self.timers[1].nearest_edge(1, at);
                if let Some(edge) = edge {
                    let least = self.trace.nearest_edge.get_or_insert(edge);
                    *least = edge.min(*least);
                }
            }
            adc::Happening::Done => {
                let waiting = self.dma.is_waiting(Request::Adc1);
                if self.adc.done(waiting) {
                    self.dma.raise(Request::Adc1);
                }
            }
        }
    }

    fn spi_event(&mut self, at: u64) {
        let Some(sent) = self.spi.at_event() else {
            return;
        };
        // The encoder is selected by PA2, the converter by PA3.
        // Nobody drives the line of a cable that is off; PC11 may pull it up.
        let open = if self.ports[2].pulls_up(11) { 0xff } else { 0 };
        let [encoder, converter] = self.sensors.cut;
        let answer = match (self.ports[0].is_low(2), self.ports[0].is_low(3)) {
            (true, _) if encoder => open,
            (_, true) if converter => open,
            (true, _) => self.sensors.encoder(sent),
            (_, true) => self.sensors.bridge(sent, at),
            _ => 0xff,
        };
        // Erratum of ES0182, corrupted last bit: with slow edges of SCK, PC10, it comes as the one before it.
        let answer = match self.ports[2].is_slow(10) {
            true => answer & !1 | answer >> 1 & 1,
            false => answer,
        };
        self.spi.received(answer);
    }

    /// A select line may have changed.
    pub(super) fn selected(&mut self, before: [bool; 2]) {
        let now = self.now;
        if before[0] && !self.ports[0].is_low(2) {
            let world = &mut self.world;
            self.sensors.deselect_encoder(|| world.counts(now) as u16);
        }
        if before[1] && !self.ports[0].is_low(3) {
            self.sensors.deselect_bridge();
        }
    }

    /// Puts the levels of the inputs on their pins: DRDY on PB2, which nobody drives while the cable is off.
    pub(super) fn drive_inputs(&mut self) {
        let [_, off] = self.sensors.cut;
        self.ports[1].driven_mask = u32::from(!off) << 2;
        self.ports[1].driven = u32::from(self.sensors.not_ready()) << 2;
    }

    /// Lets the streams move what is asked for.
    fn serve(&mut self) {
        loop {
            if self.uart.wants() {
                self.dma.raise(Request::Uart4Tx);
            } else {
                self.dma.withdraw(Request::Uart4Tx);
            }
            if self.uart.offers() {
                self.dma.raise(Request::Uart4Rx);
            } else {
                self.dma.withdraw(Request::Uart4Rx);
            }
            if !self.dma.anything_waits() {
                return;
            }
            let Some(item) = self.dma.next() else {
                return;
            };
            let value = self.read(item.from, item.bytes);
            self.write(item.to, item.bytes, value);
        }
    }

    fn lines(&self) -> u128 {
        let mut lines = 0;
        for index in 0..8 {
            lines |= u128::from(self.dma.line(0, index)) << DMA1_IRQS[index];
            lines |= u128::from(self.dma.line(1, index)) << DMA2_IRQS[index];
            let timer = &self.timers[index];
            let asks = timer.sr & timer.dier & 0x5f != 0;
            lines |= u128::from(asks) << TIMER_IRQS[index];
        }
        lines
            | u128::from(self.supply_sank) << PVD_IRQ
            | u128::from(self.adc.line()) << ADC_IRQ
            | u128::from(self.uart.line()) << UART4_IRQ
            | u128::from(self.spi.line()) << SPI3_IRQ
    }

    /// Stops a stream, as a bus error does.
    pub(crate) fn fail_stream(&mut self, dma: usize, stream: usize) {
        self.dma.fail(dma, stream);
        self.attention = true;
    }

    /// Lets a conversion get lost, as when its stream was served too late.
    pub(crate) fn overrun_adc(&mut self) {
        self.adc.sr |= 1 << 5;
        self.attention = true;
    }

    /// The registers that hold the window of the watchdog and the longest time between two feeds (s).
    pub fn watchdog(&self) -> (f64, f64) {
        let seconds = |units: u64| units as f64 / super::UNITS_PER_SECOND as f64;
        (seconds(self.iwdg.window()), seconds(self.iwdg.longest))
    }
}
