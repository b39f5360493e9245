//! The values that the registers must have after start-up, from the reference manual and not from the code
//! that sets them: the board checks for itself what no emulator shows. The log gets a line for each register
//! that differs; on a good board it gets one that says so.

use super::pll::Source;

/// The name of a register, its address, a mask of the bits that matter, and the value they must have.
struct Expected(&'static str, u32, u32, u32);

const DBGMCU: u32 = 0xe004_2000;
const PWR: u32 = 0x4000_7000;
const EXTI: u32 = 0x4001_3c00;
const RCC: u32 = 0x4002_3800;
const GPIOB: u32 = 0x4002_0400;
const UART4: u32 = 0x4000_4c00;
const DMA1: u32 = 0x4002_6000;
const TIM2: u32 = 0x4000_0000;
const TIM5: u32 = 0x4000_0c00;
#[cfg(not(feature = "spi-sensors"))]
const TIM3: u32 = 0x4000_0400;
#[cfg(not(feature = "spi-sensors"))]
const ADC1: u32 = 0x4001_2000;
#[cfg(not(feature = "spi-sensors"))]
const DMA2: u32 = 0x4002_6400;
#[cfg(feature = "spi-sensors")]
const GPIOC: u32 = 0x4002_0800;
#[cfg(feature = "spi-sensors")]
const SPI3: u32 = 0x4000_3c00;

/// Registers that have the same value with either set of sensors.
const COMMON: [Expected; 18] = [
    // 7.3.3: SWS (3:2) says that the PLL drives the core; PPRE1 (12:10) divides by 4, PPRE2 (15:13)
    // by 2.
    Expected("RCC_CFGR", RCC + 0x08, 0xfc0c, 0x9408),
    // 38.16.3: no pin of the trace is assigned, which would be PB3.
    Expected("DBGMCU_CR", DBGMCU + 0x04, 1 << 5, 0),
    // 5.4.1: the supply is watched at 2.9 V; 12.3.1: and raises its interrupt.
    Expected("PWR_CR", PWR, 0xf0, 0xf0),
    Expected("EXTI_IMR", EXTI, 1 << 16, 1 << 16),
    // 8.4.1: PB12 is an output, and it is low (8.4.6).
    Expected("GPIOB_MODER", GPIOB, 0b11 << 24, 0b01 << 24),
    Expected("GPIOB_ODR", GPIOB + 0x14, 1 << 12, 0),
    // 8.4.1 and 8.4.9: PB3 is TIM2's channel 2.
    Expected("GPIOB_MODER", GPIOB, 0b11 << 6, 0b10 << 6),
    Expected("GPIOB_AFRL", GPIOB + 0x20, 0xf << 12, 1 << 12),
    // 18.4.7: channel 2 is PWM, its CCR2 taken over with the next period.
    Expected("TIM2_CCMR1", TIM2 + 0x18, 0xff00, 0x6800),
    // 18.4.12: 84 MHz / 2625 = 32 kHz, without a prescaler.
    Expected("TIM2_PSC", TIM2 + 0x28, 0xffff, 0),
    Expected("TIM2_ARR", TIM2 + 0x2c, u32::MAX, 2624),
    // 18.4.4: an update asks for DMA; 10.5.5, stream 1: channel 3, words from a list to the register.
    Expected("TIM2_DIER", TIM2 + 0x0c, 1 << 8, 1 << 8),
    Expected(
        "DMA1_S1CR",
        DMA1 + 0x10 + 0x18,
        0x0e00_7fc1 & !1,
        0x0600_5440,
    ),
    // 10.5.5, stream 4: channel 4, bytes from a ring, interrupts at its end and after an error.
    Expected(
        "DMA1_S4CR",
        DMA1 + 0x10 + 0x18 * 4,
        0x0e00_7fd4,
        0x0800_0454,
    ),
    // 18.4.10 and 18.4.12: the time base counts all 32 bits without a prescaler.
    Expected("TIM5_PSC", TIM5 + 0x28, 0xffff, 0),
    Expected("TIM5_ARR", TIM5 + 0x2c, u32::MAX, u32::MAX),
    // 30.6.3: 42 MHz / 2 Mbaud = 16 · 1 5/16.
    Expected("UART4_BRR", UART4 + 0x08, 0xffff, 0x15),
    // 10.5.5, stream 2: channel 4, circular, counting up the memory, on.
    Expected(
        "DMA1_S2CR",
        DMA1 + 0x10 + 0x18 * 2,
        0x0e00_0501,
        0x0800_0501,
    ),
];

#[cfg(not(feature = "spi-sensors"))]
const SENSORS: [Expected; 10] = [
    // 18.4.2: channel 3's reference is the trigger output, of mode 2 as channel 4 (18.4.8), which is on.
    Expected("TIM2_CR2", TIM2 + 0x04, 0b111 << 4, 0b110 << 4),
    Expected("TIM2_CCMR2", TIM2 + 0x1c, 0x7b7b, 0x7878),
    Expected("TIM2_CCR3", TIM2 + 0x3c, u32::MAX, 2400),
    Expected("TIM2_CCR4", TIM2 + 0x40, u32::MAX, 472),
    // 18.4.3: both edges of both inputs count, ITR1 is the trigger.
    Expected("TIM3_SMCR", TIM3 + 0x08, 0x77, 0x13),
    // 18.4.8 and 18.4.9: channel 3 captures on the trigger; 18.4.4: and asks for DMA.
    Expected("TIM3_CCMR2", TIM3 + 0x1c, 0b11, 0b11),
    Expected("TIM3_DIER", TIM3 + 0x0c, 1 << 11, 1 << 11),
    // 13.13.3: rising edge of TIM2's channel 4, DMA for ever, on.
    Expected("ADC1_CR2", ADC1 + 0x08, 0x3f00_0301, 0x1500_0301),
    // 10.5.5, stream 0: channel 0, double buffer, half words, interrupt when a block is full.
    Expected("DMA2_S0CR", DMA2 + 0x10, 0x0e04_7c10, 0x0004_2c10),
    // Stream 7: channel 5, double buffer, half words.
    Expected(
        "DMA1_S7CR",
        DMA1 + 0x10 + 0x18 * 7,
        0x0e04_7c00,
        0x0a04_2c00,
    ),
];

#[cfg(feature = "spi-sensors")]
const SENSORS: [Expected; 4] = [
    // 8.4.1 and 8.4.10: PC10 to PC12 are SPI3's; 8.4.3: edges of SCK and MOSI at high speed (erratum in ES0182).
    Expected("GPIOC_MODER", GPIOC, 0b11_1111 << 20, 0b10_1010 << 20),
    Expected("GPIOC_AFRH", GPIOC + 0x24, 0xf_ff00, 0x6_6600),
    Expected(
        "GPIOC_OSPEEDR",
        GPIOC + 0x08,
        0b11_0011 << 20,
        0b10_0010 << 20,
    ),
    // 28.5.1: mode 1, master, 42 MHz / 8, the highest bit first; SPE is left open.
    Expected("SPI3_CR1", SPI3, 0x00ff & !(1 << 6), 0b0001_0101),
];

/// Compares the registers and logs those that differ. The PLL runs from `source`, as [`super::pll`] has set it.
pub fn check(source: Source) {
    let mut wrong = 0;
    let pll = Expected("RCC_PLLCFGR", RCC + 0x04, u32::MAX, source.pllcfgr());
    for register in COMMON.iter().chain(&SENSORS).chain([&pll]) {
        let Expected(name, address, mask, value) = *register;
        // SAFETY: the peripheral's clock is on, and none of these registers changes when it is read.
        let read = unsafe { (address as *const u32).read_volatile() };
        if read & mask != value {
            wrong += 1;
            defmt::warn!(
                "register {=str} reads {=u32:#010x}, expected {=u32:#010x} under {=u32:#010x}",
                name,
                read,
                value,
                mask
            );
        }
    }
    if wrong == 0 {
        defmt::info!("registers as expected");
    }
}
