//! Start-up times, lock, the frequency counter and resus, worked out from the datasheet's formulas.

use super::oscillators::XOSC_HZ;
use crate::chip::Chip;
use crate::chip::bus::Fault;
use crate::chip::flash::Flash;
use crate::chip::test_chip::*;

const XOSC_STATUS: u32 = XOSC_CTRL + 4;
const XOSC_STARTUP: u32 = XOSC_CTRL + 0xc;
const CLOCKS: u32 = 0x4000_8000;
const RESUS: u32 = CLOCKS + 0x78;
const FC0: u32 = CLOCKS + 0x80;
const STABLE: u32 = 1 << 31;
const ROSC_HZ: u64 = 6_500_000;

/// As after power-on: from the ring oscillator, no program.
fn cold() -> Chip {
    let mut chip = Chip::new(Flash::new(1 << 20, [0; 8]));
    assert_eq!(chip.bus.fault.take(), Some(Fault::Boot2));
    chip.bus.write32(RESETS, 0);
    chip
}

fn pass(chip: &mut Chip, cycles: u64) {
    let until = chip.bus.now + cycles;
    chip.bus.advance(until);
    chip.bus.core_time = until;
}

#[test]
fn the_crystal_is_stable_after_its_start_up_delay() {
    let mut chip = cold();
    assert_eq!(chip.bus.sys_hz(), ROSC_HZ);
    // 47 × 256 periods: 1.003 ms.
    chip.bus.write32(XOSC_STARTUP, 47);
    chip.bus.write32(XOSC_CTRL, 0x00fa_baa0);
    let delay = 47 * 256 * ROSC_HZ / XOSC_HZ;
    assert_eq!(chip.bus.read32(XOSC_STATUS), 1 << 12, "enabled, not stable");
    pass(&mut chip, delay);
    assert_eq!(chip.bus.read32(XOSC_STATUS) & STABLE, 0);
    pass(&mut chip, 1);
    assert_eq!(chip.bus.read32(XOSC_STATUS) & STABLE, STABLE);
    // Enabled again, it stays stable; disabled, it is gone.
    chip.bus.write32(XOSC_CTRL, 0x00fa_baa0);
    assert_eq!(chip.bus.read32(XOSC_STATUS) & STABLE, STABLE);
    chip.bus.write32(XOSC_CTRL, 0x00d1_eaa0);
    assert_eq!(chip.bus.read32(XOSC_STATUS), 0);
}

#[test]
fn nothing_runs_from_a_crystal_that_is_not_stable() {
    let mut chip = cold();
    chip.bus.write32(XOSC_CTRL, 0x00fa_baa0);
    chip.bus.write32(CLK_REF_CTRL, 2);
    assert_eq!(chip.bus.fault, Some(Fault::ClockStopped));
}

#[test]
fn a_dead_crystal_never_becomes_stable() {
    let mut chip = cold();
    chip.bus.clocks.stop_crystal(0);
    chip.bus.write32(XOSC_CTRL, 0x00fa_baa0);
    pass(&mut chip, 10 * ROSC_HZ);
    assert_eq!(chip.bus.read32(XOSC_STATUS), 1 << 12);
}

#[test]
fn a_pll_locks_500_reference_periods_after_the_last_change_and_only_in_range() {
    let mut chip = chip(&FOREVER);
    assert_eq!(chip.bus.read32(PLL_SYS) & STABLE, STABLE);
    // PLL_USB: 12 MHz × 100.
    let usb = 0x4002_c000;
    chip.bus.write32(usb + 0x8, 100);
    chip.bus.write32(usb + 0x4, 0);
    // 500 / 12 MHz at 120 MHz.
    pass(&mut chip, 4_999);
    assert_eq!(chip.bus.read32(usb) & STABLE, 0);
    pass(&mut chip, 1);
    assert_eq!(chip.bus.read32(usb) & STABLE, STABLE);
    // The post dividers do not unsettle it; the feedback does, and 12 MHz × 40 is below the VCO's range.
    chip.bus.write32(usb + 0xc, 5 << 16 | 5 << 12);
    assert_eq!(chip.bus.read32(usb) & STABLE, STABLE);
    chip.bus.write32(usb + 0x8, 40);
    pass(&mut chip, 1_000_000);
    assert_eq!(chip.bus.read32(usb) & STABLE, 0);
}

#[test]
fn selected_names_the_source_of_the_glitchless_multiplexers() {
    let mut chip = chip(&FOREVER);
    assert_eq!(chip.bus.read32(CLOCKS + 0x38), 1 << 2, "clk_ref: crystal");
    assert_eq!(chip.bus.read32(CLOCKS + 0x44), 1 << 1, "clk_sys: auxiliary");
    chip.bus.write32(CLK_SYS_CTRL, 0);
    assert_eq!(chip.bus.read32(CLOCKS + 0x44), 1 << 0);
    assert_eq!(chip.bus.sys_hz(), XOSC_HZ);
    assert_eq!(chip.bus.read32(CLOCKS + 0x50), 1, "clk_peri has one input");
}

#[test]
fn the_frequency_counter_measures_against_clk_ref() {
    let mut chip = chip(&FOREVER);
    for (offset, value) in [(0x0, 12_000), (0x4, 119_000), (0x8, 121_000), (0x10, 10)] {
        chip.bus.write32(FC0 + offset, value);
    }
    // clk_sys.
    chip.bus.write32(FC0 + 0x14, 9);
    assert_eq!(chip.bus.read32(FC0 + 0x18), 1 << 8, "running");
    // 1024 × 0.98 µs.
    pass(&mut chip, 120_300);
    assert_eq!(chip.bus.read32(FC0 + 0x18), 1 << 8);
    pass(&mut chip, 200);
    assert_eq!(chip.bus.read32(FC0 + 0x18), 1 << 4 | 1, "done, passed");
    assert_eq!(chip.bus.read32(FC0 + 0x1c) >> 5, 120_000);
    // The ring oscillator is slower than that, and a stopped clock died.
    for (source, status) in [(3, 1 << 4 | 1 << 16 | 1 << 20), (12, 1 << 4 | 1 << 28)] {
        chip.bus.write32(FC0 + 0x14, source);
        pass(&mut chip, 130_000);
        assert_eq!(chip.bus.read32(FC0 + 0x18), status, "source {source}");
    }
}

#[test]
fn resus_puts_a_stopped_clk_sys_back_on_clk_ref() {
    let mut chip = chip(&FOREVER);
    chip.bus.write32(RESUS, 1 << 8 | 0xff);
    chip.bus.write32(CLOCKS + 0xbc, 1);
    // The system PLL goes down under clk_sys.
    chip.bus.write32(PLL_SYS + 0x4, 1);
    assert_eq!(chip.bus.fault, None);
    assert_eq!(chip.bus.sys_hz(), XOSC_HZ);
    assert_eq!(chip.bus.read32(RESUS + 4), 1);
    assert!(chip.bus.clocks.irq_line());
    // Mended and cleared, it goes on from where CTRL says.
    chip.bus.write32(PLL_SYS + 0x4, 0);
    wait_for(&mut chip, PLL_SYS);
    chip.bus.write32(RESUS, 1 << 16 | 1 << 8 | 0xff);
    assert_eq!(chip.bus.sys_hz(), 120_000_000);
}

#[test]
fn without_resus_a_stopped_clk_sys_stops_the_run() {
    let mut chip = chip(&FOREVER);
    chip.bus.write32(PLL_SYS + 0x4, 1);
    assert_eq!(chip.bus.fault, Some(Fault::ClockStopped));
}

#[test]
fn a_watchdog_reset_leaves_the_crystal_running() {
    let mut chip = chip(&FOREVER);
    chip.bus.write32(0x4001_0008, 0x1_fffc);
    chip.bus.write32(WATCHDOG, 1 << 31);
    let halt = run(&mut chip, 1_000).expect_err("no boot2");
    assert_eq!(halt.fault, Fault::Boot2);
    assert_eq!(chip.bus.sys_hz(), ROSC_HZ);
    assert_eq!(chip.bus.read32(XOSC_STATUS) & STABLE, STABLE);
}
