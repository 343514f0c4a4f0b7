//! The chip's own behaviour, seen from its registers: times worked out from the datasheet, and what must be refused.

use super::Chip;
use super::bus::{Cause, Fault, ResetCause};
use super::test_chip::*;

const UART0: u32 = 0x4003_4000;
const TIMER: u32 = 0x4005_4000;
const PSM_WDSEL: u32 = 0x4001_0008;
const DMA: u32 = 0x5000_0000;
const NVIC_ISER: u32 = 0xe000_e100;
const NVIC_ISPR: u32 = 0xe000_e200;
const NVIC_IPR0: u32 = 0xe000_e400;
const VTOR: u32 = 0xe000_ed08;
const VECTORS: u32 = 0x2000_0000;

#[test]
fn a_uart_sends_a_byte_in_ten_bits_of_its_divisors() {
    let mut chip = chip(&FOREVER);
    // 115 200 baud: 120 MHz / 16 / 115200 = 65.104, that is 65 + 7/64.
    for (offset, value) in [(0x24, 65), (0x28, 7), (0x2c, 0x70), (0x30, 0x301)] {
        chip.bus.write32(UART0 + offset, value);
    }
    for byte in b"ab" {
        chip.bus.write32(UART0, u32::from(*byte));
    }
    run(&mut chip, 30_000).expect("it runs");
    let sent: Vec<(u64, u8)> = chip.bus.uart[0].sent.iter().copied().collect();
    let ((first, a), (second, b)) = (sent[0], sent[1]);
    assert_eq!((a, b), (b'a', b'b'));
    // 10 × 16 × (65 + 7/64) = 10 417.5 cycles.
    assert_eq!(second - first, 10_418);
}

#[test]
fn a_uart_receives_at_the_rate_of_its_divisors_and_counts_what_overflows() {
    let mut chip = chip(&FOREVER);
    for (offset, value) in [(0x24, 65), (0x28, 7), (0x2c, 0x70), (0x30, 0x301)] {
        chip.bus.write32(UART0 + offset, value);
    }
    let now = chip.now();
    chip.bus.uart[0].send(&[0x55; 40], now);
    run(&mut chip, 9_800).expect("it runs");
    assert_ne!(
        chip.bus.read32(UART0 + 0x18) & 1 << 4,
        0,
        "RXFE before the first byte"
    );
    run(&mut chip, 1_000).expect("it runs");
    assert_eq!(chip.bus.read32(UART0 + 0x18) & 1 << 4, 0, "RXFE after it");
    run(&mut chip, 40 * 10_418).expect("it runs");
    assert_eq!(chip.bus.uart[0].overruns, 8, "32 fit");
}

#[test]
fn an_alarm_wakes_a_sleeping_core_at_its_microsecond() {
    // wfi; str r0,[r0]; b .
    let mut chip = chip(&[0xbf30, 0x6000, 0xe7fe]);
    chip.bus.write32(TIMER + 0x38, 1);
    chip.bus.write32(NVIC_ISER, 1);
    let target = chip.bus.read32(TIMER + 0x28) + 50;
    chip.bus.write32(TIMER + 0x10, target);
    let start = chip.now();
    run(&mut chip, 49 * 120).expect("it runs");
    assert_eq!(chip.bus.read32(DATA), 0, "still asleep");
    run(&mut chip, 2 * 120).expect("it runs");
    assert_eq!(chip.bus.read32(DATA), DATA, "awake");
    assert!(
        chip.busy_cycles()[0] < 300,
        "it slept until {} from {start}",
        chip.now()
    );
}

#[test]
fn the_watchdog_bites_after_half_its_load_and_keeps_the_scratch_words() {
    let mut chip = chip(&FOREVER);
    chip.bus.write32(PSM_WDSEL, 0x1_fffc);
    chip.bus.write32(WATCHDOG + 0x14, 0xcafe_f00d);
    // Erratum E1: the count falls by two a microsecond.
    chip.bus.write32(WATCHDOG + 0x04, 2_000);
    chip.bus.write32(WATCHDOG, 1 << 30);
    run(&mut chip, 500 * 120).expect("it runs");
    assert_eq!(chip.bus.read32(WATCHDOG) & 0x00ff_ffff, 1_000);
    run(&mut chip, 499 * 120).expect("it runs");
    assert_eq!(chip.resets.len(), 1);
    // The flash is empty, so the start after the reset ends in the ROM.
    let halt = run(&mut chip, 2 * 120).expect_err("no boot2");
    assert_eq!(halt.fault, Fault::Boot2);
    assert_eq!(chip.resets[1].cause, ResetCause::WatchdogTimer);
    assert_eq!(chip.bus.watchdog.scratch[2], 0xcafe_f00d);
    assert_eq!(chip.bus.watchdog.reason, 1);
}

#[test]
fn a_dma_channel_that_a_second_one_reloads_never_ends() {
    let mut chip = chip(&FOREVER);
    let (source, ring, reload) = (DATA, 0x2000_4000, DATA + 4);
    chip.bus.write32(source, 0x1234_5678);
    chip.bus.write32(reload, 8);
    let always = 0x3f << 15 | 2 << 2 | 1;
    // Channel 1 writes 8 into channel 0's AL1_TRANS_COUNT_TRIG; quiet, chained to itself.
    for (offset, value) in [
        (0x40, reload),
        (0x44, DMA + 0x1c),
        (0x48, 1),
        (0x50, always | 1 << 11 | 1 << 21),
    ] {
        chip.bus.write32(DMA + offset, value);
    }
    // Channel 0 fills a ring of 64 bytes, 8 words at a time.
    for (offset, value) in [
        (0x00, source),
        (0x04, ring),
        (0x08, 8),
        (0x10, always | 1 << 5 | 6 << 6 | 1 << 10 | 1 << 11),
    ] {
        chip.bus.write32(DMA + offset, value);
    }
    chip.bus.write32(DMA + 0x430, 1);
    let mut before = 0;
    for _ in 0..10 {
        run(&mut chip, 1_000).expect("it runs");
        chip.bus.write32(DMA + 0x400, 1);
        run(&mut chip, 30).expect("it runs");
        assert_eq!(
            chip.bus.read32(DMA + 0x400) & 1,
            1,
            "a block ends every nine cycles"
        );
        let at = chip.bus.read32(DMA + 0x04);
        assert!((ring..ring + 64).contains(&at), "{at:#x}");
        before += 1;
    }
    assert_eq!(before, 10);
    for word in 0..16 {
        assert_eq!(chip.bus.read32(ring + 4 * word), 0x1234_5678, "word {word}");
    }
    assert_eq!(chip.bus.read32(ring + 64), 0, "nothing beyond the ring");
}

/// Runs handlers of the given priorities: the first waits until the second has run. Says whether the second ran inside it.
fn nests(first: u32, second: u32) -> bool {
    let mut chip = chip(&FOREVER);
    // ldr r0,=DATA; movs r1,#1; str r1,[r0]; loop: ldr r2,[r0,#4]; cmp r2,#0; beq loop; str r1,[r0,#8]; bx lr; DATA
    let waits: [u16; 10] = [
        0x4803, 0x2101, 0x6001, 0x6842, 0x2a00, 0xd0fc, 0x6081, 0x4770, 0x2000, 0x2000,
    ];
    // ldr r0,=DATA; movs r1,#1; str r1,[r0,#4]; bx lr; DATA
    let marks: [u16; 6] = [0x4801, 0x2101, 0x6041, 0x4770, 0x2000, 0x2000];
    let put = |chip: &mut Chip, at: u32, code: &[u16]| {
        for (i, halfword) in code.iter().enumerate() {
            chip.bus.write16(at + 2 * i as u32, *halfword);
        }
    };
    put(&mut chip, CODE + 0x100, &waits);
    put(&mut chip, CODE + 0x200, &marks);
    chip.bus.write32(VECTORS + 16 * 4, (CODE + 0x100) | 1);
    chip.bus.write32(VECTORS + 17 * 4, (CODE + 0x200) | 1);
    chip.bus.write32(VTOR, VECTORS);
    chip.bus.write32(NVIC_IPR0, first | second << 8);
    chip.bus.write32(NVIC_ISER, 3);
    chip.cores[0].cpu.regs.primask = 0;
    chip.bus.write32(NVIC_ISPR, 1);
    run(&mut chip, 1_000).expect("it runs");
    assert_eq!(chip.bus.read32(DATA), 1, "the first handler runs");
    assert_eq!(chip.bus.read32(DATA + 8), 0, "and waits");
    chip.bus.write32(NVIC_ISPR, 2);
    run(&mut chip, 1_000).expect("it runs");
    if chip.bus.read32(DATA + 8) == 1 {
        assert_eq!(chip.bus.ppb[0].active, 0, "both handlers have returned");
        assert_eq!(
            chip.cores[0].cpu.regs.r[13], STACK,
            "and left the stack as it was"
        );
    }
    chip.bus.read32(DATA + 8) == 1
}

#[test]
fn an_interrupt_of_higher_priority_runs_inside_a_handler() {
    assert!(nests(0xc0, 0x00));
    assert!(nests(0x80, 0x40));
}

#[test]
fn an_interrupt_of_equal_or_lower_priority_waits() {
    assert!(!nests(0x40, 0x40));
    assert!(!nests(0x00, 0xc0));
}

#[test]
fn a_register_that_is_not_modelled_stops_the_chip_by_name() {
    let mut chip = chip(&FOREVER);
    chip.bus.read32(0x4006_4010);
    let halt = run(&mut chip, 10).expect_err("it stops");
    assert_eq!(
        halt.fault.to_string(),
        "read of VREG_AND_CHIP_RESET+0x010 (0x40064010) is not modelled"
    );
}

#[test]
fn a_peripheral_in_reset_cannot_be_used() {
    let mut chip = chip(&FOREVER);
    chip.bus.write32(RESETS, 1 << 22);
    chip.bus.write32(UART0, 0x41);
    let halt = run(&mut chip, 10).expect_err("it stops");
    assert!(matches!(halt.fault, Fault::HeldInReset { .. }), "{halt}");
}

#[test]
fn an_unaligned_load_is_a_hard_fault() {
    // adds r0,#1; ldr r1,[r0]
    let mut chip = chip(&[0x3001, 0x6801, 0xe7fe]);
    chip.bus.write32(VECTORS + 3 * 4, CODE | 1);
    chip.bus.write32(VTOR, VECTORS);
    let halt = run(&mut chip, 100).expect_err("it stops");
    assert_eq!(
        halt.fault,
        Fault::HardFault {
            core: 0,
            pc: CODE + 2,
            cause: Cause::Unaligned { address: DATA + 1 }
        }
    );
}

#[test]
fn code_rewritten_in_sram_runs_as_rewritten() {
    // loop: adds r1,#1; b loop
    let mut chip = chip(&[0x3101, 0xe7fd]);
    run(&mut chip, 300).expect("it runs");
    let counted = chip.cores[0].cpu.regs.r[1];
    assert!(counted > 50);
    // subs r1,#1
    chip.bus.write16(CODE, 0x3901);
    run(&mut chip, 300).expect("it runs");
    assert!(chip.cores[0].cpu.regs.r[1] < counted);
}

#[test]
fn time_is_kept_across_a_change_of_the_system_clock() {
    let mut chip = chip(&FOREVER);
    let before = chip.bus.time_ps();
    run(&mut chip, 120_000).expect("it runs");
    assert_eq!(chip.bus.time_ps() - before, 1_000_000_000);
    // From the crystal directly: 12 MHz.
    chip.bus.write32(CLK_SYS_CTRL, 0);
    assert_eq!(chip.bus.sys_hz(), 12_000_000);
    let ticks = chip.bus.read32(TIMER + 0x28);
    run(&mut chip, 12_000).expect("it runs");
    assert_eq!(chip.bus.time_ps() - before, 2_000_000_000);
    assert_eq!(chip.bus.read32(TIMER + 0x28) - ticks, 1_000);
}

#[test]
fn a_fault_without_a_handler_stops_the_chip_instead_of_sleeping_for_ever() {
    // udf #0
    let mut chip = chip(&[0xde00, 0xe7fe]);
    let halt = run(&mut chip, 1_000).expect_err("it stops");
    assert!(
        matches!(halt.fault, Fault::HardFault { core: 0, .. }),
        "{halt}"
    );
}

#[test]
fn a_watchdog_that_counts_outlives_the_reset_it_did_not_make() {
    let mut chip = chip(&FOREVER);
    chip.bus.write32(PSM_WDSEL, 0x1_fffc);
    chip.bus.write32(WATCHDOG + 0x04, 20_000);
    chip.bus.write32(WATCHDOG, 1 << 30);
    run(&mut chip, 1_000 * 120).expect("it runs");
    // TRIGGER, with ENABLE kept.
    chip.bus.write32(WATCHDOG, 1 << 31 | 1 << 30);
    let halt = run(&mut chip, 10).expect_err("no boot2");
    assert_eq!(halt.fault, Fault::Boot2);
    assert_eq!(chip.bus.watchdog.reason, 2);
    assert_eq!(chip.bus.read32(WATCHDOG + 0x2c) & 0x7ff, 12 | 3 << 9);
    assert_ne!(chip.bus.read32(WATCHDOG) & 1 << 30, 0, "still enabled");
    let left = chip.bus.read32(WATCHDOG) & 0x00ff_ffff;
    assert!((17_900..=18_000).contains(&left), "{left}");
}

#[test]
fn the_timer_pauses_and_goes_on() {
    let mut chip = chip(&FOREVER);
    let low = TIMER + 0x28;
    chip.bus.write32(TIMER + 0x30, 1);
    let stood = chip.bus.read32(low);
    run(&mut chip, 12_000).expect("it runs");
    assert_eq!(chip.bus.read32(low), stood);
    chip.bus.write32(TIMER + 0x30, 0);
    run(&mut chip, 12_000).expect("it runs");
    assert_eq!(chip.bus.read32(low), stood + 100);
    assert_eq!(chip.bus.read32(TIMER + 0x2c), 7, "DBGPAUSE");
}

#[test]
fn reading_the_low_word_latches_the_high_one_and_a_set_time_takes_both() {
    let mut chip = chip(&FOREVER);
    chip.bus.write32(TIMER + 0x04, 0xffff_fff0);
    chip.bus.write32(TIMER, 7);
    assert_eq!(chip.bus.read32(TIMER + 0x0c), 0xffff_fff0);
    run(&mut chip, 20 * 120).expect("it runs");
    assert_eq!(chip.bus.read32(TIMER + 0x08), 7, "as latched");
    assert_eq!(chip.bus.read32(TIMER + 0x24), 8, "as it is");
    assert_eq!(chip.bus.read32(TIMER + 0x0c), 4);
    assert_eq!(chip.bus.read32(TIMER + 0x08), 8);
}

#[test]
fn an_alarm_interrupt_can_be_forced() {
    let mut chip = chip(&FOREVER);
    chip.bus.write32(TIMER + 0x3c, 1 << 2);
    assert_eq!(chip.bus.read32(TIMER + 0x34), 0, "INTR");
    assert_eq!(chip.bus.read32(TIMER + 0x40), 1 << 2, "INTS");
    assert_eq!(chip.bus.timer.irq_lines(), 1 << 2);
}
