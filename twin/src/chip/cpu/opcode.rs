//! Halfwords decoded into operations: a table of all 65 536.
//!
//! Source: ARMv6-M ARM (DDI 0419), A5.2 (16-bit encodings) and A5.3 (the first halfword of the 32-bit ones).
//!
//! | bits 15:10 | group |
//! |---|---|
//! | 00xxxx | shift, add, subtract, move, compare (immediate) |
//! | 010000 | register to register |
//! | 010001 | high registers, BX, BLX |
//! | 01001x | LDR literal |
//! | 0101xx 011xxx 100xxx | load and store of one |
//! | 10100x 10101x | ADR, ADD from SP |
//! | 1011xx | SP adjust, extend, PUSH, POP, CPS, REV, BKPT, hints |
//! | 11000x 11001x | STM, LDM |
//! | 1101xx | B with condition, UDF, SVC |
//! | 11100x | B |
//! | 11110x | first half of BL, MSR, MRS, barriers |

use std::sync::LazyLock;

/// What an operation does. The operands are named as the manual names them.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum Kind {
    /// `a` = Rd, `b` = Rm, `c` = shift (LSR and ASR: 1 to 32).
    LslImm,
    LsrImm,
    AsrImm,
    /// `a` = Rd, `b` = Rn, `c` = Rm.
    AddReg,
    SubReg,
    /// `a` = Rd, `b` = Rn, `c` = immediate.
    AddImm,
    SubImm,
    /// `a` = Rd or Rn, `c` = immediate.
    MovImm,
    CmpImm,
    /// `a` = Rdn, `b` = Rm.
    And,
    Eor,
    LslReg,
    LsrReg,
    AsrReg,
    Adc,
    Sbc,
    RorReg,
    Tst,
    Rsb,
    CmpReg,
    Cmn,
    Orr,
    Mul,
    Bic,
    Mvn,
    /// `a` = Rdn (any), `b` = Rm (any).
    AddHigh,
    CmpHigh,
    MovHigh,
    /// `b` = Rm (any).
    Bx,
    Blx,
    /// `a` = Rt, `c` = words from the aligned PC.
    LdrLiteral,
    /// `a` = Rt, `b` = Rn, `c` = Rm.
    StrReg,
    StrhReg,
    StrbReg,
    LdrsbReg,
    LdrReg,
    LdrhReg,
    LdrbReg,
    LdrshReg,
    /// `a` = Rt, `b` = Rn, `c` = offset in bytes.
    StrImm,
    LdrImm,
    StrbImm,
    LdrbImm,
    StrhImm,
    LdrhImm,
    /// `a` = Rt, `c` = words from SP.
    StrSp,
    LdrSp,
    /// `a` = Rd, `c` = words from the aligned PC, from SP.
    Adr,
    AddSpTo,
    /// `c` = words.
    AddSp,
    SubSp,
    /// `a` = Rd, `b` = Rm.
    Sxth,
    Sxtb,
    Uxth,
    Uxtb,
    Rev,
    Rev16,
    Revsh,
    /// `c` = list, `a` = 1 with LR or PC.
    Push,
    Pop,
    /// `a` = 1 disables.
    Cps,
    /// `c` = the immediate.
    Bkpt,
    Nop,
    Wfe,
    Wfi,
    Sev,
    /// `a` = Rn, `c` = list.
    Stm,
    Ldm,
    Beq,
    Bne,
    Bcs,
    Bcc,
    Bmi,
    Bpl,
    Bvs,
    Bvc,
    Bhi,
    Bls,
    Bge,
    Blt,
    Bgt,
    Ble,
    Svc,
    /// The offset is in the halfword.
    B,
    /// The first half of a 32-bit instruction.
    Wide,
    Undefined,
}

/// A decoded halfword.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Op {
    pub kind: Kind,
    pub a: u8,
    pub b: u8,
    pub c: u8,
}

/// One entry a halfword.
pub type Table = [Op; 1 << 16];

/// The table, made at the first call.
pub fn table() -> &'static Table {
    static TABLE: LazyLock<Box<Table>> = LazyLock::new(|| {
        let all: Vec<Op> = (0..=u16::MAX).map(decode).collect();
        match all.into_boxed_slice().try_into() {
            Ok(table) => table,
            Err(_) => unreachable!("65 536 halfwords"),
        }
    });
    &TABLE
}

/// Decodes one halfword.
pub fn decode(half: u16) -> Op {
    let field = |at: u32, bits: u32| (half >> at & ((1 << bits) - 1)) as u8;
    let op = |kind, a, b, c| Op { kind, a, b, c };
    let (d, m, n) = (field(0, 3), field(3, 3), field(6, 3));
    let (high, byte) = (field(8, 3), field(0, 8));
    match half >> 10 {
        0b00_0000..=0b00_1111 => shift_add_move(half),
        0b01_0000 => op(REGISTER[usize::from(field(6, 4))], d, m, 0),
        0b01_0001 => high_register(half),
        0b01_0010 | 0b01_0011 => op(Kind::LdrLiteral, high, 0, byte),
        0b01_0100..=0b01_0111 => op(BY_REGISTER[usize::from(field(9, 3))], d, m, n),
        0b01_1000..=0b10_0011 => {
            let (kind, scale) = BY_IMMEDIATE[usize::from(half >> 11 & 0x1f) - 0b01100];
            op(kind, d, m, field(6, 5) << scale)
        }
        0b10_0100 | 0b10_0101 => op(Kind::StrSp, high, 0, byte),
        0b10_0110 | 0b10_0111 => op(Kind::LdrSp, high, 0, byte),
        0b10_1000 | 0b10_1001 => op(Kind::Adr, high, 0, byte),
        0b10_1010 | 0b10_1011 => op(Kind::AddSpTo, high, 0, byte),
        0b10_1100..=0b10_1111 => miscellaneous(half),
        0b11_0000 | 0b11_0001 => op(Kind::Stm, high, 0, byte),
        0b11_0010 | 0b11_0011 => op(Kind::Ldm, high, 0, byte),
        0b11_0100..=0b11_0111 => op(CONDITION[usize::from(field(8, 4))], 0, 0, byte),
        0b11_1000 | 0b11_1001 => op(Kind::B, 0, 0, 0),
        0b11_1100 | 0b11_1101 => op(Kind::Wide, 0, 0, 0),
        // 11101x and 11111x are 32-bit encodings that ARMv6-M does not have.
        _ => op(Kind::Undefined, 0, 0, 0),
    }
}

/// A5.2.2: data processing, by bits 9:6.
const REGISTER: [Kind; 16] = [
    Kind::And,
    Kind::Eor,
    Kind::LslReg,
    Kind::LsrReg,
    Kind::AsrReg,
    Kind::Adc,
    Kind::Sbc,
    Kind::RorReg,
    Kind::Tst,
    Kind::Rsb,
    Kind::CmpReg,
    Kind::Cmn,
    Kind::Orr,
    Kind::Mul,
    Kind::Bic,
    Kind::Mvn,
];
/// A5.2.4: register offset, by bits 11:9.
const BY_REGISTER: [Kind; 8] = [
    Kind::StrReg,
    Kind::StrhReg,
    Kind::StrbReg,
    Kind::LdrsbReg,
    Kind::LdrReg,
    Kind::LdrhReg,
    Kind::LdrbReg,
    Kind::LdrshReg,
];
/// A5.2.4: immediate offset, by bits 15:11 from 01100, with the shift of the offset.
const BY_IMMEDIATE: [(Kind, u8); 6] = [
    (Kind::StrImm, 2),
    (Kind::LdrImm, 2),
    (Kind::StrbImm, 0),
    (Kind::LdrbImm, 0),
    (Kind::StrhImm, 1),
    (Kind::LdrhImm, 1),
];
/// A5.2.6: by bits 11:8.
const CONDITION: [Kind; 16] = [
    Kind::Beq,
    Kind::Bne,
    Kind::Bcs,
    Kind::Bcc,
    Kind::Bmi,
    Kind::Bpl,
    Kind::Bvs,
    Kind::Bvc,
    Kind::Bhi,
    Kind::Bls,
    Kind::Bge,
    Kind::Blt,
    Kind::Bgt,
    Kind::Ble,
    Kind::Undefined,
    Kind::Svc,
];

/// A5.2.1.
fn shift_add_move(half: u16) -> Op {
    let field = |at: u32, bits: u32| (half >> at & ((1 << bits) - 1)) as u8;
    let (d, m, n) = (field(0, 3), field(3, 3), field(6, 3));
    // LSR and ASR by 0 mean by 32.
    let by = |imm: u8| if imm == 0 { 32 } else { imm };
    let (kind, a, b, c) = match half >> 9 & 0x1f {
        0b00000..=0b00011 => (Kind::LslImm, d, m, field(6, 5)),
        0b00100..=0b00111 => (Kind::LsrImm, d, m, by(field(6, 5))),
        0b01000..=0b01011 => (Kind::AsrImm, d, m, by(field(6, 5))),
        0b01100 => (Kind::AddReg, d, m, n),
        0b01101 => (Kind::SubReg, d, m, n),
        0b01110 => (Kind::AddImm, d, m, n),
        0b01111 => (Kind::SubImm, d, m, n),
        0b10000..=0b10011 => (Kind::MovImm, field(8, 3), 0, field(0, 8)),
        0b10100..=0b10111 => (Kind::CmpImm, field(8, 3), 0, field(0, 8)),
        0b11000..=0b11011 => (Kind::AddImm, field(8, 3), field(8, 3), field(0, 8)),
        _ => (Kind::SubImm, field(8, 3), field(8, 3), field(0, 8)),
    };
    Op { kind, a, b, c }
}

/// A5.2.3.
fn high_register(half: u16) -> Op {
    let d = (half & 7 | half >> 4 & 8) as u8;
    let m = (half >> 3 & 0xf) as u8;
    let kind = match half >> 7 & 7 {
        0 | 1 => Kind::AddHigh,
        2 | 3 => Kind::CmpHigh,
        4 | 5 => Kind::MovHigh,
        6 => Kind::Bx,
        _ => Kind::Blx,
    };
    Op {
        kind,
        a: d,
        b: m,
        c: 0,
    }
}

/// A5.2.5.
fn miscellaneous(half: u16) -> Op {
    let (d, m) = ((half & 7) as u8, (half >> 3 & 7) as u8);
    let (list, extra) = (half as u8, (half >> 8 & 1) as u8);
    let (kind, a, b, c) = match half >> 5 & 0x7f {
        0b0000000..=0b0000011 => (Kind::AddSp, 0, 0, list & 0x7f),
        0b0000100..=0b0000111 => (Kind::SubSp, 0, 0, list & 0x7f),
        0b0010000..=0b0010111 => {
            let kinds = [Kind::Sxth, Kind::Sxtb, Kind::Uxth, Kind::Uxtb];
            (kinds[usize::from(half >> 6 & 3)], d, m, 0)
        }
        0b0100000..=0b0101111 => (Kind::Push, extra, 0, list),
        0b0110011 if half & 0xf == 2 => (Kind::Cps, (half >> 4 & 1) as u8, 0, 0),
        0b1010000 | 0b1010001 => (Kind::Rev, d, m, 0),
        0b1010010 | 0b1010011 => (Kind::Rev16, d, m, 0),
        0b1010110 | 0b1010111 => (Kind::Revsh, d, m, 0),
        0b1100000..=0b1101111 => (Kind::Pop, extra, 0, list),
        0b1110000..=0b1110111 => (Kind::Bkpt, 0, 0, list),
        0b1111000..=0b1111111 if half & 0xf == 0 => match half >> 4 & 0xf {
            2 => (Kind::Wfe, 0, 0, 0),
            3 => (Kind::Wfi, 0, 0, 0),
            4 => (Kind::Sev, 0, 0, 0),
            // NOP, YIELD and the hints that are none yet.
            _ => (Kind::Nop, 0, 0, 0),
        },
        _ => (Kind::Undefined, 0, 0, 0),
    };
    Op { kind, a, b, c }
}
