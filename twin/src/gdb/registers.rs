//! The register file as GDB sees it: r0 to r12, sp, lr, pc, xpsr, each 32 bits, little-endian in hexadecimal.

use crate::board::Board;

/// Registers of a core.
const COUNT: usize = 17;
const PC: usize = 15;
const XPSR: usize = 16;

/// The target description: the M profile with these registers.
const DESCRIPTION: &str = concat!(
    "<?xml version=\"1.0\"?><!DOCTYPE target SYSTEM \"gdb-target.dtd\"><target version=\"1.0\">",
    "<architecture>arm</architecture><feature name=\"org.gnu.gdb.arm.m-profile\">",
    "<reg name=\"r0\" bitsize=\"32\"/><reg name=\"r1\" bitsize=\"32\"/><reg name=\"r2\" bitsize=\"32\"/>",
    "<reg name=\"r3\" bitsize=\"32\"/><reg name=\"r4\" bitsize=\"32\"/><reg name=\"r5\" bitsize=\"32\"/>",
    "<reg name=\"r6\" bitsize=\"32\"/><reg name=\"r7\" bitsize=\"32\"/><reg name=\"r8\" bitsize=\"32\"/>",
    "<reg name=\"r9\" bitsize=\"32\"/><reg name=\"r10\" bitsize=\"32\"/><reg name=\"r11\" bitsize=\"32\"/>",
    "<reg name=\"r12\" bitsize=\"32\"/><reg name=\"sp\" bitsize=\"32\" type=\"data_ptr\"/>",
    "<reg name=\"lr\" bitsize=\"32\"/><reg name=\"pc\" bitsize=\"32\" type=\"code_ptr\"/>",
    "<reg name=\"xpsr\" bitsize=\"32\"/></feature></target>",
);

/// `offset,length` of the description, marked as the last part or not.
pub fn description(range: &str) -> Option<String> {
    let (offset, length) = super::range(range)?;
    let from = (offset as usize).min(DESCRIPTION.len());
    let to = (from + length as usize).min(DESCRIPTION.len());
    let mark = if to == DESCRIPTION.len() { 'l' } else { 'm' };
    Some(format!("{mark}{}", &DESCRIPTION[from..to]))
}

/// Bytes of hexadecimal text.
pub fn bytes(text: &str) -> Option<Vec<u8>> {
    let pairs = text.as_bytes().chunks(2);
    pairs
        .map(|pair| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok())
        .collect()
}

fn value(board: &Board, core: usize, n: usize) -> Option<u32> {
    let regs = board.chip.registers(core);
    match n {
        0..PC => Some(regs.r[n]),
        PC => Some(regs.pc()),
        XPSR => Some(regs.xpsr()),
        _ => None,
    }
}

fn set(board: &mut Board, core: usize, n: usize, value: u32) -> Option<()> {
    let regs = board.chip.registers_mut(core);
    match n {
        0..PC => regs.r[n] = value,
        PC => regs.set_pc(value),
        // The exception number is not GDB's to change.
        XPSR => regs.set_apsr(value),
        _ => return None,
    }
    Some(())
}

fn text(value: u32) -> String {
    format!("{:08x}", value.swap_bytes())
}

fn number(text: &str) -> Option<u32> {
    super::hex(text).map(u32::swap_bytes)
}

/// All registers of a core.
pub fn all(board: &Board, core: usize) -> String {
    (0..COUNT)
        .filter_map(|n| value(board, core, n))
        .map(text)
        .collect()
}

/// Sets all of them.
pub fn set_all(board: &mut Board, core: usize, text: &str) -> Option<()> {
    for n in 0..COUNT {
        let value = number(text.get(8 * n..8 * n + 8)?)?;
        set(board, core, n, value)?;
    }
    Some(())
}

/// One register by its number.
pub fn one(board: &Board, core: usize, n: &str) -> Option<String> {
    value(board, core, super::hex(n)? as usize).map(text)
}

/// `number=value`.
pub fn set_one(board: &mut Board, core: usize, assignment: &str) -> Option<()> {
    let (n, value) = assignment.split_once('=')?;
    set(board, core, super::hex(n)? as usize, number(value)?)
}
