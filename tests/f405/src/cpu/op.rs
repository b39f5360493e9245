//! The instructions of the Cortex-M4F, decoded. Numbers of registers are those of the core; two more
//! than it has keep the interpreter free of special cases.

/// A register that takes results nobody wants: the destination of a comparison.
pub(crate) const NOWHERE: u8 = 16;
/// A register that is always 0.
pub(crate) const ZERO: u8 = 17;

/// An instruction with its condition (14: always) and its length in bytes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Instruction {
    pub(crate) op: Op,
    pub(crate) condition: u8,
    pub(crate) length: u8,
}

/// A function of two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Alu {
    And,
    Bic,
    Orr,
    Orn,
    Eor,
    Mov,
    Mvn,
    Add,
    Adc,
    Sbc,
    Sub,
    Rsb,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shift {
    Lsl,
    Lsr,
    Asr,
    Ror,
    Rrx,
}

/// What an immediate operand makes of the carry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Carry {
    Kept,
    Clear,
    Set,
}

/// Width and sign of an access.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Width {
    Word,
    Half,
    Byte,
    SignedHalf,
    SignedByte,
}

/// When the base of an access takes the offset over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    Offset,
    Pre,
    Post,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extend {
    SignedByte,
    SignedHalf,
    Byte,
    Half,
    SignedBytes,
    Bytes,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unary {
    Clz,
    Rbit,
    Rev,
    Rev16,
    Revsh,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Long {
    Smull,
    Umull,
    Smlal,
    Umlal,
    Umaal,
}

/// Additions and subtractions of bytes or half words side by side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Lanes {
    pub(crate) bytes: bool,
    pub(crate) subtract: bool,
    pub(crate) signed: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Float {
    Mla,
    Mls,
    Nmla,
    Nmls,
    Mul,
    Nmul,
    Add,
    Sub,
    Div,
    Fma,
    Fms,
    Fnma,
    Fnms,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FloatUnary {
    Mov,
    Abs,
    Neg,
    Sqrt,
    FromSigned,
    FromUnsigned,
    ToSigned,
    ToUnsigned,
    ToSignedRounded,
    ToUnsignedRounded,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Op {
    Nop,
    /// A branch to itself, or over nothing but `nop`: nothing happens until an interrupt comes.
    Idle {
        target: u32,
    },
    Wfi,
    Wfe,
    Sev,
    Clrex,
    Cps {
        disable: bool,
        i: bool,
        f: bool,
    },
    Mrs {
        d: u8,
        special: u8,
    },
    Msr {
        n: u8,
        special: u8,
    },
    Svc,
    Bkpt,
    Undefined {
        code: u32,
    },
    Alu {
        f: Alu,
        s: bool,
        d: u8,
        n: u8,
        m: u8,
        shift: Shift,
        by: u8,
    },
    AluImm {
        f: Alu,
        s: bool,
        d: u8,
        n: u8,
        imm: u32,
        carry: Carry,
    },
    ShiftReg {
        shift: Shift,
        s: bool,
        d: u8,
        n: u8,
        m: u8,
    },
    Movt {
        d: u8,
        imm: u16,
    },
    /// With the source [`ZERO`] it is `bfc`.
    Bfi {
        d: u8,
        n: u8,
        lsb: u8,
        width: u8,
    },
    Bfx {
        signed: bool,
        d: u8,
        n: u8,
        lsb: u8,
        width: u8,
    },
    Saturate {
        signed: bool,
        d: u8,
        n: u8,
        to: u8,
        shift: Shift,
        by: u8,
    },
    Pkh {
        d: u8,
        n: u8,
        m: u8,
        by: u8,
        top: bool,
    },
    Extend {
        kind: Extend,
        d: u8,
        n: u8,
        m: u8,
        rotate: u8,
    },
    Unary {
        f: Unary,
        d: u8,
        m: u8,
    },
    /// Saturating lanes.
    Lanes {
        f: Lanes,
        d: u8,
        n: u8,
        m: u8,
    },
    Mul {
        s: bool,
        d: u8,
        n: u8,
        m: u8,
    },
    Mla {
        subtract: bool,
        d: u8,
        n: u8,
        m: u8,
        a: u8,
    },
    SmlaHalf {
        d: u8,
        n: u8,
        m: u8,
        a: u8,
        n_top: bool,
        m_top: bool,
    },
    SmlaWord {
        d: u8,
        n: u8,
        m: u8,
        a: u8,
        m_top: bool,
    },
    Smmla {
        d: u8,
        n: u8,
        m: u8,
        a: u8,
        round: bool,
    },
    Long {
        f: Long,
        low: u8,
        high: u8,
        n: u8,
        m: u8,
    },
    Div {
        signed: bool,
        d: u8,
        n: u8,
        m: u8,
    },
    Load {
        width: Width,
        t: u8,
        n: u8,
        imm: i32,
        mode: Mode,
    },
    Store {
        width: Width,
        t: u8,
        n: u8,
        imm: i32,
        mode: Mode,
    },
    LoadReg {
        width: Width,
        t: u8,
        n: u8,
        m: u8,
        by: u8,
    },
    StoreReg {
        width: Width,
        t: u8,
        n: u8,
        m: u8,
        by: u8,
    },
    /// The address is known where the instruction is.
    LoadAt {
        width: Width,
        t: u8,
        at: u32,
    },
    LoadTwo {
        t: u8,
        t2: u8,
        n: u8,
        imm: i32,
        mode: Mode,
    },
    StoreTwo {
        t: u8,
        t2: u8,
        n: u8,
        imm: i32,
        mode: Mode,
    },
    LoadMany {
        n: u8,
        list: u16,
        back: bool,
        before: bool,
    },
    StoreMany {
        n: u8,
        list: u16,
        back: bool,
        before: bool,
    },
    LoadEx {
        width: Width,
        t: u8,
        n: u8,
        imm: u16,
    },
    StoreEx {
        width: Width,
        d: u8,
        t: u8,
        n: u8,
        imm: u16,
    },
    TableBranch {
        half: bool,
        n: u8,
        m: u8,
    },
    Branch {
        target: u32,
    },
    BranchLink {
        target: u32,
    },
    BranchReg {
        m: u8,
        link: bool,
    },
    BranchZero {
        n: u8,
        nonzero: bool,
        target: u32,
    },
    Float {
        f: Float,
        d: u8,
        n: u8,
        m: u8,
    },
    FloatUnary {
        f: FloatUnary,
        d: u8,
        m: u8,
    },
    FloatImm {
        d: u8,
        bits: u32,
    },
    /// Fixed point to float and back; the number is in the destination.
    Fixed {
        d: u8,
        to_fixed: bool,
        unsigned: bool,
        half: bool,
        fraction: u8,
    },
    /// Compares with 0 if `m` is 32.
    FloatCompare {
        d: u8,
        m: u8,
    },
    FloatFromCore {
        s: u8,
        t: u8,
    },
    FloatToCore {
        s: u8,
        t: u8,
    },
    FloatsFromCore {
        s: u8,
        t: u8,
        t2: u8,
    },
    FloatsToCore {
        s: u8,
        t: u8,
        t2: u8,
    },
    /// To register 15: the flags.
    FloatStatus {
        t: u8,
    },
    SetFloatStatus {
        t: u8,
    },
    FloatLoad {
        s: u8,
        words: u8,
        n: u8,
        imm: i32,
    },
    FloatStore {
        s: u8,
        words: u8,
        n: u8,
        imm: i32,
    },
    FloatMany {
        load: bool,
        s: u8,
        words: u8,
        n: u8,
        back: bool,
        before: bool,
    },
}
