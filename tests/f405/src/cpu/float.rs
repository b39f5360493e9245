//! The FPU: single precision, rounding to nearest, as after a reset. Its exception flags are not kept.

use super::Core;
use super::op::{Float, FloatUnary};

const QUIET: u32 = 1 << 22;
const DEFAULT_NAN: u32 = 0x7fc0_0000;

fn is_nan(bits: u32) -> bool {
    bits & 0x7fff_ffff > 0x7f80_0000
}

fn is_signalling(bits: u32) -> bool {
    is_nan(bits) && bits & QUIET == 0
}

/// The NaN of an operation: the first signalling operand, or the first quiet one, or the default
/// (DDI 0403E, A2.5.4).
fn nan_of(operands: [u32; 2]) -> u32 {
    let found = operands.into_iter().find(|bits| is_signalling(*bits));
    match found.or_else(|| operands.into_iter().find(|bits| is_nan(*bits))) {
        Some(bits) => bits | QUIET,
        None => DEFAULT_NAN,
    }
}

fn two(a: u32, b: u32, f: impl FnOnce(f32, f32) -> f32) -> u32 {
    let result = f(f32::from_bits(a), f32::from_bits(b));
    match result.is_nan() {
        true => nan_of([a, b]),
        false => result.to_bits(),
    }
}

fn negated(bits: u32) -> u32 {
    bits ^ 1 << 31
}

fn mul(a: u32, b: u32) -> u32 {
    two(a, b, |a, b| a * b)
}

fn add(a: u32, b: u32) -> u32 {
    two(a, b, |a, b| a + b)
}

fn fused(a: u32, n: u32, m: u32) -> u32 {
    let result = f32::from_bits(n).mul_add(f32::from_bits(m), f32::from_bits(a));
    match result.is_nan() {
        true if is_nan(a) => nan_of([a, n]),
        true => nan_of([n, m]),
        false => result.to_bits(),
    }
}

pub(super) fn binary(f: Float, d: u32, n: u32, m: u32) -> u32 {
    match f {
        Float::Mla => add(d, mul(n, m)),
        Float::Mls => add(d, negated(mul(n, m))),
        Float::Nmla => add(negated(d), negated(mul(n, m))),
        Float::Nmls => add(negated(d), mul(n, m)),
        Float::Mul => mul(n, m),
        Float::Nmul => negated(mul(n, m)),
        Float::Add => add(n, m),
        Float::Sub => two(n, m, |n, m| n - m),
        Float::Div => two(n, m, |n, m| n / m),
        Float::Fma => fused(d, n, m),
        Float::Fms => fused(d, negated(n), m),
        Float::Fnma => fused(negated(d), negated(n), m),
        Float::Fnms => fused(negated(d), n, m),
    }
}

pub(super) fn unary(f: FloatUnary, bits: u32) -> u32 {
    let value = f32::from_bits(bits);
    match f {
        FloatUnary::Mov => bits,
        FloatUnary::Abs => bits & !(1 << 31),
        FloatUnary::Neg => negated(bits),
        FloatUnary::Sqrt => match value.sqrt() {
            root if root.is_nan() => nan_of([bits, bits]),
            root => root.to_bits(),
        },
        FloatUnary::FromSigned => (bits as i32 as f32).to_bits(),
        FloatUnary::FromUnsigned => (bits as f32).to_bits(),
        FloatUnary::ToSigned => value as i32 as u32,
        FloatUnary::ToUnsigned => value as u32,
        FloatUnary::ToSignedRounded => value.round_ties_even() as i32 as u32,
        FloatUnary::ToUnsignedRounded => value.round_ties_even() as u32,
    }
}

/// Fixed point with `fraction` bits behind the point, to float or back.
pub(super) fn fixed(bits: u32, to_fixed: bool, unsigned: bool, half: bool, fraction: u8) -> u32 {
    let scale = f64::from(1_u32 << (fraction % 32));
    if to_fixed {
        let scaled = f64::from(f32::from_bits(bits)) * scale;
        return match (unsigned, half) {
            (true, true) => u32::from(scaled as u16),
            (true, false) => scaled as u32,
            (false, true) => scaled as i16 as u32,
            (false, false) => scaled as i32 as u32,
        };
    }
    let value = match (unsigned, half) {
        (true, true) => f64::from(bits as u16),
        (true, false) => f64::from(bits),
        (false, true) => f64::from(bits as i16),
        (false, false) => f64::from(bits as i32),
    };
    ((value / scale) as f32).to_bits()
}

impl Core {
    /// Compares two values; the flags go to FPSCR.
    pub(super) fn compare(&mut self, a: u32, b: u32) {
        let order = f32::from_bits(a).partial_cmp(&f32::from_bits(b));
        let flags = match order {
            Some(std::cmp::Ordering::Equal) => 0b0110,
            Some(std::cmp::Ordering::Less) => 0b1000,
            Some(std::cmp::Ordering::Greater) => 0b0010,
            None => 0b0011,
        };
        self.fpscr = self.fpscr & 0x0fff_ffff | flags << 28;
    }
}
