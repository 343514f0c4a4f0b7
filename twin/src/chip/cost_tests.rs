//! What accesses cost and what is refused: XIP cache, bus ports, flash that is busy, stacks, SRAM nobody wrote.

use super::bus::{Cause, Closed, Fault};
use super::test_chip::*;
use super::{Chip, Halt};

const SSI: u32 = 0x1800_0000;
const XIP_CTRL: u32 = 0x1400_0000;
const BUSCTRL: u32 = 0x4003_0000;
const CPSID: u16 = 0xb672;

/// A chip whose SSI is set as `rp2040-boot2`'s generic loader leaves it: 03h, 24 address bits, one line, divider 4.
fn with_flash(code: &[u16]) -> Chip {
    let mut chip = chip(code);
    for (offset, value) in [
        (0x08, 0),
        (0x14, 4),
        (0x00, 31 << 16 | 3 << 8),
        (0xf4, 0x03 << 24 | 2 << 8 | 6 << 2),
        (0x08, 1),
    ] {
        chip.bus.write32(SSI + offset, value);
    }
    for (at, byte) in chip.bus.flash.bytes.iter_mut().enumerate() {
        *byte = at as u8;
    }
    chip
}

/// Cycles of one load from `address` by core 0, which then waits.
fn load(chip: &mut Chip, address: u32) -> u64 {
    chip.cores[0].cpu.regs.r[0] = address;
    chip.cores[0].cpu.regs.set_pc(CODE);
    chip.bus.attention = false;
    let time = chip.cores[0].cpu.time;
    chip.step(0, time + 1);
    chip.cores[0].cpu.time - time
}

/// `ldr r1, [r0]; b .`
const LOAD: [u16; 2] = [0x6801, 0xe7fe];
/// (8 instruction + 24 address + 64 data + 2 chip select) bits of 4 cycles.
const MISS: u64 = 392;

#[test]
fn a_miss_costs_the_serial_transfer_and_a_hit_nothing() {
    let mut chip = with_flash(&LOAD);
    assert_eq!(load(&mut chip, 0x1000_0100), 2 + MISS, "first");
    assert_eq!(chip.cores[0].cpu.regs.r[1], 0x0302_0100);
    assert_eq!(load(&mut chip, 0x1000_0104), 2, "the same line of 8 bytes");
    assert_eq!(load(&mut chip, 0x1000_0108), 2 + MISS, "the next line");
    assert_eq!(chip.bus.read32(XIP_CTRL + 0x0c), 1, "CTR_HIT");
    assert_eq!(chip.bus.read32(XIP_CTRL + 0x10), 3, "CTR_ACC");
    chip.bus.write32(XIP_CTRL + 0x0c, 0);
    assert_eq!(chip.bus.read32(XIP_CTRL + 0x0c), 0, "cleared");
}

/// The SSI set up for quad reads without an instruction, as boot2 of the W25Q080 leaves it but for its divider of `divider`; the flash is told first if
/// `told`.
fn with_quad_reads(divider: u32, told: bool) -> Chip {
    let mut chip = with_flash(&LOAD);
    let quad = 31 << 16 | 3 << 8 | 2 << 21;
    let (address_and_mode, wait) = (8 << 2, 4 << 11);
    if told {
        // EBh on one line, address and mode A0h on four, then nobody takes the data.
        for (offset, value) in [
            (0x08, 0),
            (0x00, quad),
            (0xf4, wait | 2 << 8 | address_and_mode | 1),
            (0x08, 1),
            (0x60, 0xeb),
            (0x60, 0xa0),
        ] {
            chip.bus.write32(SSI + offset, value);
        }
    }
    for (offset, value) in [
        (0x08, 0),
        (0x14, divider),
        (0x00, quad),
        (0xf4, 0xa0 << 24 | wait | address_and_mode | 2),
        (0x08, 1),
    ] {
        chip.bus.write32(SSI + offset, value);
    }
    chip
}

#[test]
fn quad_reads_without_an_instruction_cost_what_they_take() {
    // (8 address and mode + 4 wait + 16 data + 2 chip select) bits.
    for divider in [4, 2] {
        let mut chip = with_quad_reads(divider, true);
        assert_eq!(
            load(&mut chip, 0x1000_0100),
            2 + 30 * u64::from(divider),
            "divider {divider}"
        );
    }
}

#[test]
fn the_interface_and_the_flash_must_agree_whether_an_instruction_is_sent() {
    let closed = |chip: &mut Chip| {
        chip.cores[0].cpu.regs.r[0] = 0x1000_0000;
        match run(chip, 10).expect_err("it stops").fault {
            Fault::FlashClosed { why, .. } => why,
            other => panic!("{other}"),
        }
    };
    assert_eq!(
        closed(&mut with_quad_reads(4, false)),
        Closed::NotContinuous,
        "it was not told"
    );
    // Told, and then read plainly.
    let mut chip = with_quad_reads(4, true);
    chip.bus.write32(SSI + 0xf4, 0x03 << 24 | 2 << 8 | 6 << 2);
    assert_eq!(closed(&mut chip), Closed::Continuous);
    // Mode bits that end it after the first read.
    let mut chip = with_quad_reads(4, true);
    chip.bus.write32(SSI + 0xf4, 4 << 11 | 8 << 2 | 2);
    assert_eq!(closed(&mut chip), Closed::NotContinuous);
}

#[test]
fn a_command_to_a_flash_that_reads_on_is_refused_by_name() {
    let mut chip = with_quad_reads(4, true);
    for (offset, value) in [
        (0x08, 0),
        (0x00, 7 << 16),
        (0x08, 1),
        (0x60, 0x9f),
        (0x08, 0),
    ] {
        chip.bus.write32(SSI + offset, value);
    }
    let halt = run(&mut chip, 10).expect_err("it stops");
    assert_eq!(halt.fault, Fault::FlashCommand(0x9f));
}

#[test]
fn the_cache_has_two_ways_of_8_kib_and_replaces_the_longer_unused() {
    let mut chip = with_flash(&LOAD);
    let [a, b, c] = [0x1000_0000, 0x1000_2000, 0x1000_4000];
    for address in [a, b] {
        load(&mut chip, address);
    }
    assert_eq!(load(&mut chip, a), 2, "both ways hold");
    load(&mut chip, c);
    assert_eq!(load(&mut chip, a), 2, "used later than b");
    assert_eq!(load(&mut chip, b), 2 + MISS, "replaced by c");
}

#[test]
fn the_other_windows_do_not_look_up_or_do_not_keep() {
    let mut chip = with_flash(&LOAD);
    assert_eq!(load(&mut chip, 0x1100_0000), 2 + MISS, "not kept");
    assert_eq!(load(&mut chip, 0x1100_0000), 2 + MISS);
    assert_eq!(load(&mut chip, 0x1200_0000), 2 + MISS, "kept");
    assert_eq!(load(&mut chip, 0x1200_0000), 2 + MISS, "not looked up");
    assert_eq!(load(&mut chip, 0x1000_0000), 2);
    assert_eq!(load(&mut chip, 0x1300_0000), 2 + MISS, "neither");
    chip.bus.write32(XIP_CTRL, 2);
    assert_eq!(load(&mut chip, 0x1000_0000), 2 + MISS, "cache off");
}

#[test]
fn a_flush_forgets_all_and_holds_the_next_access_up() {
    let mut chip = with_flash(&LOAD);
    load(&mut chip, 0x1000_0000);
    chip.bus.core_time = chip.cores[0].cpu.time;
    chip.bus.write32(XIP_CTRL + 0x04, 1);
    assert_eq!(chip.bus.read32(XIP_CTRL + 0x08) & 1, 0, "not ready");
    let cycles = load(&mut chip, 0x1000_0000);
    // The access is in the instruction's second cycle.
    assert_eq!(cycles, 2 + 1023 + MISS);
    chip.bus.core_time = chip.cores[0].cpu.time;
    assert_eq!(chip.bus.read32(XIP_CTRL + 0x08) & 1, 1, "ready");
}

#[test]
fn code_in_flash_pays_for_each_line_once() {
    let mut chip = with_flash(&FOREVER);
    // nops, then `b .` at the end of the fourth line.
    for at in 0..15 {
        chip.bus.flash.bytes[2 * at..2 * at + 2].copy_from_slice(&0xbf00u16.to_le_bytes());
    }
    chip.bus.flash.bytes[30..32].copy_from_slice(&0xe7feu16.to_le_bytes());
    chip.cores[0].cpu.regs.set_pc(0x1000_0000);
    run(&mut chip, 10_000).expect("it runs");
    assert_eq!(chip.bus.xip.misses, [4, 0, 0]);
    assert_eq!(chip.cores[0].cpu.waits, 4 * MISS);
    assert!(chip.bus.xip.hits[0] > 4_000, "{:?}", chip.bus.xip.hits);
}

#[test]
fn dma_from_flash_waits_for_flash() {
    let mut chip = with_flash(&FOREVER);
    for (offset, value) in [
        (0x00, 0x1000_0000),
        (0x04, DATA),
        (0x08, 8),
        (0x0c, 0x3f << 15 | 1 << 5 | 1 << 4 | 2 << 2 | 1),
    ] {
        chip.bus.write32(0x5000_0000 + offset, value);
    }
    run(&mut chip, 3 * MISS + 20).expect("it runs");
    assert_eq!(
        chip.bus.read32(0x5000_0008),
        1,
        "three lines, and the first word of the fourth under way"
    );
    run(&mut chip, 2 * MISS).expect("it runs");
    assert_eq!(chip.bus.read32(0x5000_0008), 0);
    assert_eq!(chip.bus.xip.misses[2], 4);
}

/// Both cores load from `a` and `b`, in loops of 6 and of 7 cycles; the cycles each has waited.
fn contest(a: u32, b: u32, priority: u32) -> [u64; 2] {
    // loop: ldr r1,[r0]; ldr r1,[r0]; b loop
    let even = [0x6801u16, 0x6801, 0xe7fc].map(u16::to_le_bytes).concat();
    // The same with a nop.
    let odd = [0x6801u16, 0x6801, 0xbf00, 0xe7fb]
        .map(u16::to_le_bytes)
        .concat();
    let mut chip = chip(&FOREVER);
    chip.bus.write32(BUSCTRL, priority);
    // Each in a 4 KiB bank of its own, so that only the data meet.
    chip.take_over(0, 0x2004_0000, &even, a);
    chip.take_over(1, 0x2004_1000, &odd, b);
    run(&mut chip, 60_000).expect("it runs");
    [0, 1].map(|k| chip.cores[k].cpu.waits)
}

#[test]
fn two_cores_wait_only_where_they_want_the_same_bank() {
    assert_eq!(contest(0x2000_0000, 0x2000_0004, 0), [0, 0]);
    let [a, b] = contest(0x2000_0000, 0x2000_1000, 0);
    assert!(a > 1_000 && b > 1_000, "{a} {b}");
    assert!(a.abs_diff(b) < (a + b) / 10, "they take turns: {a} {b}");
    // The unstriped alias of bank 1, and a word of bank 1.
    let [a, b] = contest(0x2101_0000, 0x2000_0004, 0);
    assert!(a + b > 1_000, "{a} {b}");
}

#[test]
fn a_core_with_priority_never_waits() {
    assert_eq!(contest(0x2000_0000, 0x2000_1000, 0x01)[0], 0);
    assert_eq!(contest(0x2000_0000, 0x2000_1000, 0x10)[1], 0);
}

#[test]
fn the_performance_counters_count_what_their_event_says() {
    let mut chip = chip(&[0x6801, 0x6801, 0xe7fe]);
    chip.cores[0].cpu.regs.r[0] = 0x2000_0008;
    // SRAM2, all accesses; SRAM5, all accesses.
    chip.bus.write32(BUSCTRL + 0x0c, 11);
    chip.bus.write32(BUSCTRL + 0x14, 5);
    run(&mut chip, 100).expect("it runs");
    let counted = chip.bus.read32(BUSCTRL + 0x08);
    // Two loads, and the fetches of `b .` at CODE + 4 do not lie in bank 2.
    assert_eq!(counted, 2);
    assert_eq!(chip.bus.read32(BUSCTRL + 0x10), 0);
    chip.bus.write32(BUSCTRL + 0x08, 0);
    assert_eq!(chip.bus.read32(BUSCTRL + 0x08), 0);
}

/// Erases a sector by the ROM's function, with interrupts masked or not; core 1 or a handler of core 0 reads flash meanwhile.
fn while_flash_is_busy(core1_reads: bool, interrupts: bool) -> Result<(), Halt> {
    // blx r4 (the ROM's erase); b .
    let mut chip = with_flash(&[if interrupts { 0xbf00 } else { CPSID }, 0x47a0, 0xe7fe]);
    let regs = &mut chip.cores[0].cpu.regs;
    regs.primask = 0;
    (regs.r[0], regs.r[1], regs.r[4]) = (0, 4096, 0x209);
    // The handler of interrupt 0 lies in flash.
    let vectors = 0x2000_0000;
    chip.bus.write32(vectors + 64, 0x1000_0101);
    chip.bus.write32(0xe000_ed08, vectors);
    chip.bus.write32(0xe000_e100, 1);
    if core1_reads {
        // 1000 turns of a loop, then ldr r1, [r0]; b .
        let code = [0x23fau16, 0x009b, 0x3b01, 0xd1fd, 0x6801, 0xe7fe];
        let code = code.map(u16::to_le_bytes).concat();
        chip.take_over(1, 0x2004_0000, &code, 0x1000_0000);
    }
    run(&mut chip, 1_000)?;
    chip.bus.write32(0xe000_e200, 1);
    run(&mut chip, 10_000)?;
    // 45 ms after the call it has returned.
    run(&mut chip, 46 * 120_000)?;
    assert_eq!(chip.program_counter(0), CODE + 4);
    assert_eq!(chip.bus.flash.bytes[..8], [0xff; 8]);
    Ok(())
}

#[test]
fn flash_must_not_be_read_while_it_erases() {
    while_flash_is_busy(false, false).expect("masked interrupts and code in SRAM do no harm");
    for (core1_reads, interrupts, core) in [(true, false, 1), (false, true, 0)] {
        let halt = while_flash_is_busy(core1_reads, interrupts).expect_err("it stops");
        assert!(
            matches!(
                halt.fault,
                Fault::FlashClosed {
                    why: Closed::Busy,
                    ..
                }
            ),
            "{halt}"
        );
        assert_eq!(halt.core, core, "{halt}");
    }
}

#[test]
fn flash_must_not_be_read_before_it_is_set_up_or_in_command_mode() {
    let mut chip = chip(&LOAD);
    chip.cores[0].cpu.regs.r[0] = 0x1000_0000;
    let halt = run(&mut chip, 10).expect_err("boot2 has not run");
    assert!(
        matches!(
            halt.fault,
            Fault::FlashClosed {
                why: Closed::Disabled,
                ..
            }
        ),
        "{halt}"
    );
    // blx r4 (the ROM's connect_internal_flash), then the load.
    let mut chip = with_flash(&[0x47a0, 0x6801, 0xe7fe]);
    chip.cores[0].cpu.regs.r[0] = 0x1000_0000;
    chip.cores[0].cpu.regs.r[4] = 0x201;
    let halt = run(&mut chip, 100).expect_err("command mode");
    assert!(halt.to_string().contains("command mode"), "{halt}");
}

#[test]
fn a_write_to_flash_is_refused_by_name() {
    // str r1, [r0]
    let mut chip = with_flash(&[0x6001, 0xe7fe]);
    chip.cores[0].cpu.regs.r[0] = 0x1000_0040;
    let halt = run(&mut chip, 10).expect_err("it stops");
    assert_eq!(
        halt.fault,
        Fault::FlashWrite {
            address: 0x1000_0040
        }
    );
}

#[test]
fn a_stack_that_grows_below_its_limit_stops_the_chip() {
    // loop: push {r0-r3}; b loop
    let mut chip = chip(&[0xb40f, 0xe7fd]);
    chip.cores[0].cpu.start(STACK, CODE);
    chip.set_stack_limit(0, STACK - 64);
    let halt = run(&mut chip, 1_000).expect_err("it stops");
    assert_eq!(
        halt.fault,
        Fault::HardFault {
            core: 0,
            pc: CODE,
            cause: Cause::StackLimit { sp: STACK - 80 }
        }
    );
    assert_eq!(chip.stack(0).used(), 80);
}

#[test]
fn the_deepest_stack_is_remembered() {
    // push {r0-r3}; pop {r0-r3}; b .
    let mut chip = chip(&[0xb40f, 0xbc0f, 0xe7fe]);
    chip.cores[0].cpu.start(STACK, CODE);
    run(&mut chip, 100).expect("it runs");
    assert_eq!(chip.cores[0].cpu.regs.r[13], STACK);
    assert_eq!(chip.stack(0).used(), 16);
}

#[test]
fn sram_that_nobody_wrote_is_told_with_its_reader() {
    // ldr r1,[r0]; str r1,[r0,#4]; ldr r1,[r0,#4]; ldrb r1,[r0,#7]; b .
    let mut chip = chip(&[0x6801, 0x6041, 0x6841, 0x79c1, 0xe7fe]);
    chip.watch_uninitialised();
    run(&mut chip, 100).expect("it runs");
    let told: Vec<_> = chip.uninitialised().collect();
    assert_eq!(told.len(), 1, "{told:?}");
    let (reader, what) = told[0];
    assert_eq!((reader.core, reader.pc), (0, CODE));
    assert_eq!((what.address, what.reads), (DATA, 1));
}

#[test]
fn causes_of_hard_faults_are_told_apart() {
    for (code, register, cause) in [
        // ldr r1,[r0]
        (
            0x6801,
            0x3000_0000,
            Cause::Bus {
                address: 0x3000_0000,
            },
        ),
        // bx r0
        (
            0x4700,
            0x2000_1000,
            Cause::NotThumb {
                target: 0x2000_1000,
            },
        ),
        (0xde00, 0, Cause::Undefined { half: 0xde00 }),
        (0xbe00, 0, Cause::Breakpoint),
    ] {
        let mut chip = chip(&[code, 0xe7fe]);
        chip.cores[0].cpu.regs.r[0] = register;
        let halt = run(&mut chip, 100).expect_err("it stops");
        let expected = Fault::HardFault {
            core: 0,
            pc: CODE,
            cause,
        };
        assert_eq!(halt.fault, expected);
    }
}

#[test]
fn a_hard_fault_handler_runs_where_it_may() {
    // udf; the handler: str r0,[r0]; b .
    let mut chip = chip(&[0xde00, 0x6000, 0xe7fe]);
    chip.stop_at_hard_fault = false;
    chip.bus.write32(0x2000_000c, (CODE + 2) | 1);
    chip.bus.write32(0xe000_ed08, 0x2000_0000);
    run(&mut chip, 100).expect("the handler has it");
    assert_eq!(chip.bus.read32(DATA), DATA);
}
