//! The second set of sensors: AS5047P and ADS1220 on SPI3, read at every tick of SysTick.
//!
//! PC10 to PC12 are the bus (on the ODrive's header). The select lines of both motor drivers (PC13, PC14)
//! are held high, so that the drivers ignore the bus. It runs at 5.25 MHz in mode 1, within both data sheets.

use super::clock::CORE_HZ;
use super::{Clock, event};
use crate::board::{Acquired, Sensors};
use crate::driver::{ads1220, ads1220::Silence, as5047p, pair::Pair};
use crate::systick;
use cortex_m::peripheral::SYST;
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::{ErrorType, MODE_1, Operation, SpiBus, SpiDevice};
use estimator_core::board::sampling::Reading;
use stm32f4xx_hal::gpio::{Input, Output, PA2, PA3, PB2, PC10, PC11, PC12, Speed};
use stm32f4xx_hal::pac::SPI3;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::spi::Spi;

/// The bus, the select lines, DRDY and the tick.
pub struct Wires {
    /// SPI3 drives the bus.
    pub spi3: SPI3,
    /// SCK, MISO and MOSI are on these pins.
    pub bus: (PC10, PC11, PC12),
    /// This line selects the encoder.
    pub encoder: PA2<Output>,
    /// This line selects the converter.
    pub bridge: PA3<Output>,
    /// The converter's DRDY is low when a conversion is done.
    pub ready: PB2<Input>,
    /// SysTick makes the tick.
    pub tick: SYST,
}

/// Both sensors on their bus.
pub struct SpiSensors {
    bus: Spi<SPI3>,
    encoder: PA2<Output>,
    bridge: PA3<Output>,
    ready: PB2<Input>,
    silence: Silence,
    pair: Pair,
    clock: Clock,
    tick: Option<SYST>,
}

/// Sets both sensors up and logs their errors.
pub fn set_up(wires: Wires, clock: Clock, rcc: &mut Rcc) -> SpiSensors {
    let (sck, miso, mosi) = wires.bus;
    // A line that nobody drives reads ones, which the encoder's driver takes for an error; zeros would be angle 0.
    let miso = miso.into_pull_up_input();
    // With slow edges of SCK the last bit that comes in may be wrong: erratum "corrupted last bit of data received in
    // master mode with delayed SCK feedback" of ES0182.
    let sck = sck.into_alternate::<6>().speed(Speed::High);
    let mosi = mosi.into_alternate::<6>().speed(Speed::High);
    let pins = (Some(sck), Some(miso), Some(mosi));
    // 42 MHz / 8.
    let bus = wires.spi3.spi(pins, MODE_1, 5_250.kHz(), rcc);
    let mut sensors = SpiSensors {
        bus,
        encoder: wires.encoder,
        bridge: wires.bridge,
        ready: wires.ready,
        silence: Silence::default(),
        pair: Pair::default(),
        clock,
        tick: Some(wires.tick),
    };
    sensors.set_up();
    sensors
}

impl SpiSensors {
    /// Sets both sensors up. A sensor that does not answer now may answer later: its samples are faulty until
    /// then.
    fn set_up(&mut self) {
        let mut bridge = Chip(&mut self.bus, &mut self.bridge);
        // The errors are logged field by field: `Debug` of the drivers' types costs 4 KiB of flash.
        match ads1220::set_up(&mut bridge) {
            Ok(()) => {}
            Err(ads1220::Error::Spi(_)) => defmt::warn!("ADS1220: the bus failed"),
            Err(ads1220::Error::Readback(read)) => {
                defmt::warn!(
                    "ADS1220: its registers read {=[u8; 4]}, not as written",
                    read
                );
            }
        }
        let mut encoder = Chip(&mut self.bus, &mut self.encoder);
        match as5047p::diagnose(&mut encoder) {
            Ok(magnet) if magnet.too_strong || magnet.too_weak || magnet.overflow => {
                defmt::warn!(
                    "AS5047P: magnet too strong {=bool}, too weak {=bool}, overflow {=bool}, gain {=u8}",
                    magnet.too_strong,
                    magnet.too_weak,
                    magnet.overflow,
                    magnet.gain
                );
            }
            Ok(_) => {}
            Err(as5047p::Error::Spi(_)) => defmt::warn!("AS5047P: the bus failed"),
            Err(as5047p::Error::Parity(word)) => {
                defmt::warn!("AS5047P: odd parity in {=u16:#06x}", word);
            }
            Err(as5047p::Error::Reported(what)) => defmt::warn!(
                "AS5047P: reports framing {=bool}, command {=bool}, parity {=bool}",
                what.framing,
                what.command,
                what.parity
            ),
        }
    }
}

impl Sensors for SpiSensors {
    const COUNTS: u32 = as5047p::COUNTS;

    fn start(&mut self) {
        if let Some(tick) = self.tick.take() {
            systick::start(tick, CORE_HZ, 1);
        }
        event::start();
        self.clock.resume();
    }

    fn sample(&mut self) -> Acquired {
        let Some(at) = self.clock.tick() else {
            return Acquired::Nothing;
        };
        let ready = self.ready.is_low();
        let angle = as5047p::angle(&mut Chip(&mut self.bus, &mut self.encoder)).ok();
        let mut bridge = Chip(&mut self.bus, &mut self.bridge);
        if self.silence.lasts(ready) {
            // What it has forgotten it is told again; the next ticks show whether that was it.
            let _ = ads1220::write_registers(&mut bridge);
        }
        let force = ads1220::fetch_and_start(&mut bridge).ok();
        match self.pair.sample(at.time_us, ready, angle, force) {
            Some(mut codes) => {
                codes.faults = codes.faults | at.faults;
                Acquired::Reading(Reading::Codes(codes), at.due)
            }
            None => Acquired::Nothing,
        }
    }
}

/// A chip on the shared bus: its select line is low during the operations.
struct Chip<'a, B, P>(&'a mut B, &'a mut P);

impl<B: SpiBus, P> ErrorType for Chip<'_, B, P> {
    type Error = B::Error;
}

impl<B: SpiBus, P: OutputPin> SpiDevice for Chip<'_, B, P> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), B::Error> {
        select(self.0, self.1, operations)
    }
}

/// Pause around a frame and between two frames (cycles): 357 ns, of which the encoder needs 350.
const SELECT_CYCLES: u32 = 60;

fn select<B: SpiBus, P: OutputPin>(
    bus: &mut B,
    pin: &mut P,
    operations: &mut [Operation<'_, u8>],
) -> Result<(), B::Error> {
    // Pins of this part do not fail.
    let _ = pin.set_low();
    cortex_m::asm::delay(SELECT_CYCLES);
    let done = operations
        .iter_mut()
        .try_for_each(|operation| match operation {
            Operation::Read(bytes) => bus.read(bytes),
            Operation::Write(bytes) => bus.write(bytes),
            Operation::Transfer(read, write) => bus.transfer(read, write),
            Operation::TransferInPlace(bytes) => bus.transfer_in_place(bytes),
            Operation::DelayNs(nanoseconds) => {
                // 168 cycles are a microsecond; one cycle more makes up for the rounding.
                let cycles = nanoseconds.saturating_mul(CORE_HZ / 1_000_000) / 1000;
                cortex_m::asm::delay(cycles + 1);
                Ok(())
            }
        });
    let flushed = bus.flush();
    let _ = pin.set_high();
    cortex_m::asm::delay(SELECT_CYCLES);
    done.and(flushed)
}
