//! An image of 16 KiB that runs blocks one after the other and leaves each one's end state in its record.
//!
//! ```text
//!   2000_0000  driver: load a record's registers, enter its block, store them again, next
//!   2000_0100  variables: current record, DONE, ON_QEMU, end of the records; arguments of semihosting
//!   2000_0200  24 slots:  16 registers | 32 words of data | 32 words of stack | code and literals
//! ```
//! The same bytes run on both sides; ON_QEMU alone differs. There, with DONE written, the driver has the host write the RAM to a file
//! (ARM semihosting); in the twin it loops and the RAM is read from outside.

use super::assembly::Assembly;
use super::class::Class;

/// Start of RAM on both machines.
pub const RAM: u32 = 0x2000_0000;
/// Bytes of RAM: the microbit's, the first of the RP2040's.
pub const RAM_BYTES: usize = 0x4000;
/// Slots an image.
pub const SLOTS: usize = 24;
/// Words of a record: registers, data, stack.
pub const RECORD_WORDS: usize = 80;
/// Bytes of a slot's code and literals.
pub const CODE_BYTES: usize = 0x150;
/// First byte of a record's data.
pub const DATA: u32 = 16 * 4;
/// First byte of a record's stack, and where its data ends.
pub const STACK: u32 = 48 * 4;
/// Where a record's stack ends and its code starts.
pub const CODE: u32 = RECORD_WORDS as u32 * 4;
/// Set when the driver has run everything.
pub const DONE: u32 = RAM + 0x104;
/// [`DONE`] after the last block.
pub const DONE_WELL: u32 = 0x600d;
/// [`DONE`] after a fault.
pub const DONE_FAULT: u32 = 0xdead;

const SLOT_BYTES: usize = RECORD_WORDS * 4 + CODE_BYTES;
const CURRENT: u32 = RAM + 0x100;
const ON_QEMU: u32 = RAM + 0x108;
const END: u32 = RAM + 0x10c;
const OPEN: u32 = RAM + 0x110;
const WRITE: u32 = RAM + 0x120;
const FILE_NAME: u32 = RAM + 0x130;
const SLOTS_AT: u32 = RAM + 0x200;
/// File that the QEMU side writes, in its working folder.
pub const RESULT_FILE: &str = "ram.bin";

/// A block of instructions with its start.
pub struct Block {
    /// Registers r0-r12, lr, sp, APSR, then data, then stack.
    pub record: Vec<u32>,
    /// Code and literals.
    pub code: Vec<u8>,
    /// Address and class of each instruction.
    pub listing: Vec<(u32, Class)>,
}

/// Where slot `n` lies.
pub fn slot(n: usize) -> u32 {
    SLOTS_AT + (n * SLOT_BYTES) as u32
}

/// The record of slot `n` in a dump of the RAM.
pub fn record(ram: &[u8], n: usize) -> &[u8] {
    let at = (slot(n) - RAM) as usize;
    &ram[at..at + RECORD_WORDS * 4]
}

/// A word of a dump of the RAM.
pub fn word(ram: &[u8], at: u32) -> u32 {
    let at = (at - RAM) as usize;
    u32::from_le_bytes([ram[at], ram[at + 1], ram[at + 2], ram[at + 3]])
}

/// The record at which a dump stopped.
pub fn stopped_at(ram: &[u8]) -> usize {
    (word(ram, CURRENT).saturating_sub(SLOTS_AT)) as usize / SLOT_BYTES
}

/// The image for the twin; [`for_qemu`] makes it QEMU's.
pub fn build(blocks: &[Block]) -> Vec<u8> {
    let mut ram = vec![0; RAM_BYTES];
    let (driver, _) = driver();
    put(&mut ram, RAM, &driver.code);
    put_words(&mut ram, CURRENT, &[slot(0), 0, 0, slot(blocks.len())]);
    put_semihosting(&mut |at, words| put_words(&mut ram, at, words));
    for (n, block) in blocks.iter().enumerate() {
        put_words(&mut ram, slot(n), &block.record);
        put(&mut ram, slot(n) + CODE, &block.code);
    }
    ram
}

/// The same with the flag set.
pub fn for_qemu(mut ram: Vec<u8>) -> Vec<u8> {
    put_words(&mut ram, ON_QEMU, &[1]);
    ram
}

/// QEMU's flash: a vector table that starts the driver and sends every fault to its end.
pub fn vectors() -> Vec<u8> {
    let fault = driver().0.fault | 1;
    let mut table = vec![RAM + RAM_BYTES as u32, RAM | 1];
    table.resize(16, fault);
    table.iter().flat_map(|word| word.to_le_bytes()).collect()
}

/// Where a block goes at its end, after `push {r0-r7, lr}`.
pub fn leave() -> u32 {
    driver().0.leave
}

fn put(ram: &mut [u8], at: u32, bytes: &[u8]) {
    let at = (at - RAM) as usize;
    ram[at..at + bytes.len()].copy_from_slice(bytes);
}

fn put_words(ram: &mut [u8], at: u32, words: &[u32]) {
    for (k, word) in words.iter().enumerate() {
        put(ram, at + 4 * k as u32, &word.to_le_bytes());
    }
}

struct Driver {
    code: Vec<u8>,
    leave: u32,
    fault: u32,
}

/// Where semihosting finds its arguments: the file's name, and what goes into it.
pub fn put_semihosting(put: &mut impl FnMut(u32, &[u32])) {
    // "wb" is mode 5 (ARM semihosting, SYS_OPEN).
    put(OPEN, &[FILE_NAME, 5, RESULT_FILE.len() as u32]);
    put(WRITE, &[0, RAM, RAM_BYTES as u32]);
    let name = RESULT_FILE.as_bytes().chunks(4);
    let words: Vec<u32> = name
        .map(|part| {
            part.iter()
                .rfold(0, |word, byte| word << 8 | u32::from(*byte))
        })
        .collect();
    put(FILE_NAME, &words);
}

/// Ends the run: [`DONE`] becomes `how`, and on QEMU the host writes the RAM to a file.
pub fn tell(a: &mut Assembly, how: u32) {
    a.literal(1, how);
    tell_r1(a);
}

/// The same with the value in r1.
fn tell_r1(a: &mut Assembly) {
    let emit = |a: &mut Assembly, halfwords: &[u16]| {
        for halfword in halfwords {
            a.put(Class::BarrierHint, *halfword);
        }
    };
    a.literal(0, DONE);
    emit(a, &[0x6001]); // str r1, [r0]
    a.literal(0, ON_QEMU);
    emit(a, &[0x6800, 0x2800, 0xd0fe]); // ldr r0, [r0]; cmp r0, #0; beq .
    emit(a, &[0x2001]); // movs r0, #SYS_OPEN
    a.literal(1, OPEN);
    emit(a, &[0xbeab]); // bkpt 0xab
    a.literal(1, WRITE);
    emit(a, &[0x6008, 0x2005, 0xbeab]); // str r0, [r1]; movs r0, #SYS_WRITE; bkpt 0xab
    emit(a, &[0x2018]); // movs r0, #SYS_EXIT
    a.literal(1, 0x2_0026); // ADP_Stopped_ApplicationExit
    emit(a, &[0xbeab, 0xe7fe]); // bkpt 0xab; b .
}

/// The driver's code. Its classes mean nothing; its instructions are not counted.
fn driver() -> (Driver, usize) {
    let mut a = Assembly::new(RAM);
    let emit = |a: &mut Assembly, halfwords: &[u16]| {
        for halfword in halfwords {
            a.put(Class::BarrierHint, *halfword);
        }
    };
    // The twin starts with interrupts masked, QEMU does not.
    emit(&mut a, &[0xb672]); // cpsid i
    let next = a.here();
    a.literal(0, CURRENT);
    emit(&mut a, &[0x6807]); // ldr r7, [r0]
    a.literal(1, END);
    emit(&mut a, &[0x6809, 0x428f]); // ldr r1, [r1]; cmp r7, r1
    let to_finish = a.here();
    emit(&mut a, &[0xd000]);
    // r8-r12 and lr.
    for (k, high) in [8u16, 9, 10, 11, 12, 14].into_iter().enumerate() {
        let load = 0x6800 | (8 + k as u16) << 6 | 7 << 3 | 1; // ldr r1, [r7, #32+4k]
        emit(
            &mut a,
            &[load, 0x4600 | (high & 8) << 4 | 1 << 3 | high & 7],
        );
    }
    emit(&mut a, &[0x6bb9, 0x468d]); // ldr r1, [r7, #56]; mov sp, r1
    a.literal(2, CODE + 1);
    emit(&mut a, &[0x19d2, 0xb404]); // adds r2, r2, r7; push {r2}
    emit(&mut a, &[0x6bf9]); // ldr r1, [r7, #60]
    emit(&mut a, &[0xf381, 0x8800]); // msr apsr, r1
    emit(&mut a, &[0xcfff, 0xbd00]); // ldm r7, {r0-r7}; pop {pc}
    let leave = a.here();
    emit(&mut a, &[0xf3ef, 0x8400]); // mrs r4, apsr
    a.literal(0, CURRENT);
    emit(&mut a, &[0x6800]); // ldr r0, [r0]
    emit(&mut a, &[0xbc0e, 0xc00e, 0xbc0e, 0xc00e]); // pop {r1-r3}; stm r0!, {r1-r3}, twice
    emit(&mut a, &[0xbc06, 0xc006]); // pop {r1, r2}; stm r0!, {r1, r2}
    emit(&mut a, &[0xbc02, 0x466d]); // pop {r1}; mov r5, sp
    emit(&mut a, &[0x4642, 0x464b, 0xc00c]); // mov r2, r8; mov r3, r9; stm r0!, {r2, r3}
    emit(&mut a, &[0x4652, 0x465b, 0xc00c]); // r10, r11
    emit(&mut a, &[0x4662, 0xc004, 0xc002, 0xc020, 0xc010]); // r12, lr, sp, APSR
    emit(&mut a, &[0xb672]); // cpsid i
    a.literal(0, CURRENT);
    emit(&mut a, &[0x6801]); // ldr r1, [r0]
    a.literal(2, SLOT_BYTES as u32);
    emit(&mut a, &[0x1889, 0x6001]); // adds r1, r1, r2; str r1, [r0]
    a.branch(next);
    let finish = a.here();
    a.literal(1, DONE_WELL);
    let to_tell = a.here();
    emit(&mut a, &[0xe000]);
    let fault = a.here();
    a.literal(1, DONE_FAULT);
    let tell = a.here();
    tell_r1(&mut a);
    a.patch(to_finish, |a| a.branch_if(0, finish));
    a.patch(to_tell, |a| a.branch(tell));
    let (code, listing) = a.finish();
    assert!(code.len() <= (CURRENT - RAM) as usize, "the driver grew");
    (Driver { code, leave, fault }, listing.len())
}
