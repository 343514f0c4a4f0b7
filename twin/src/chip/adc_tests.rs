//! Conversion times, rates and flags as the datasheet's section 4.9 gives them.

use super::{AnalogInput, Steady};
use crate::chip::Chip;
use crate::chip::test_chip::{FOREVER, chip, run, wait_for};

const ADC: u32 = 0x4004_c000;
const CS: u32 = ADC;
const RESULT: u32 = ADC + 0x04;
const FCS: u32 = ADC + 0x08;
const FIFO: u32 = ADC + 0x0c;
const DIV: u32 = ADC + 0x10;
const READY: u32 = 1 << 8;

/// A ramp of 0.1 V a millisecond.
#[derive(Clone)]
struct Ramp;

impl AnalogInput for Ramp {
    fn volts(&mut self, time_ps: u128) -> f64 {
        time_ps as f64 * 1e-10
    }
    fn clone_box(&self) -> Box<dyn AnalogInput> {
        Box::new(self.clone())
    }
}

/// A chip at 120 MHz with clk_adc at 48 MHz, channels 0 to 3 at 0.5, 1.0, 1.5, 2.0 V.
fn adc() -> Chip {
    let mut chip = chip(&FOREVER);
    // PLL_USB: 12 MHz × 100 / 5 / 5 = 48 MHz; clk_adc from it, enabled.
    for (register, value) in [
        (0x4002_c000, 1),
        (0x4002_c008, 100),
        (0x4002_c00c, 5 << 16 | 5 << 12),
        (0x4002_c004, 0),
    ] {
        chip.bus.write32(register, value);
    }
    wait_for(&mut chip, 0x4002_c000);
    chip.bus.write32(0x4000_8060, 1 << 11);
    for channel in 0..4 {
        let volts = 0.5 * (channel + 1) as f64;
        chip.bus.adc.set_input(channel, Box::new(Steady(volts)));
    }
    chip
}

fn code(volts: f64) -> u32 {
    (volts / 3.3 * 4096.0) as u32
}

#[test]
fn a_conversion_takes_96_cycles_of_clk_adc() {
    let mut chip = adc();
    chip.bus.write32(CS, 1 << 2 | 1);
    assert_eq!(chip.bus.read32(CS) & READY, 0, "busy");
    // 2 µs at 120 MHz.
    run(&mut chip, 239).expect("it runs");
    assert_eq!(chip.bus.read32(CS) & READY, 0);
    run(&mut chip, 1).expect("it runs");
    assert_eq!(chip.bus.read32(CS) & READY, READY);
    assert_eq!(chip.bus.read32(RESULT), code(0.5));
    assert_eq!(chip.bus.read32(CS) & 1 << 2, 0, "START_ONCE clears itself");
}

#[test]
fn the_input_is_held_at_the_start_of_the_conversion() {
    let mut chip = adc();
    chip.bus.adc.set_input(0, Box::new(Ramp));
    run(&mut chip, 60_000).expect("it runs");
    let held = chip.bus.time_ps() as f64 * 1e-10;
    chip.bus.write32(CS, 1 << 2 | 1);
    run(&mut chip, 240).expect("it runs");
    assert_eq!(chip.bus.read32(RESULT), code(held));
}

/// Results in the FIFO after `cycles` of START_MANY with this divider, drained as they come.
fn conversions(div: u32, cycles: u64) -> usize {
    let mut chip = adc();
    chip.bus.write32(FCS, 1);
    chip.bus.write32(DIV, div);
    chip.bus.write32(CS, 1 << 3 | 1);
    let mut count = 0;
    for _ in 0..cycles / 100 {
        run(&mut chip, 100).expect("it runs");
        while chip.bus.read32(FCS) & 1 << 8 == 0 {
            chip.bus.read32(FIFO);
            count += 1;
        }
    }
    assert_eq!(chip.bus.read32(FCS) & 0xc00, 0, "none lost");
    count
}

#[test]
fn start_many_runs_back_to_back_or_at_the_dividers_rate() {
    // 120 000 cycles are 1 ms, 48 000 cycles of clk_adc.
    assert_eq!(conversions(0, 120_000), 500);
    assert_eq!(conversions(95 << 8, 120_000), 500);
    // Every 480 cycles from the first one at once: starts at 0, 480, …; the 100th result comes at 47 616.
    assert_eq!(conversions(479 << 8, 120_000), 100);
    // 1 + 479 + 128/256 = 480.5 cycles: 9 990 in 4 800 000 cycles of clk_adc, less none: the last starts at 4 799 714.5.
    assert_eq!(conversions(479 << 8 | 128, 12_000_000), 9_990);
}

#[test]
fn round_robin_goes_through_the_mask_from_ainsel_on() {
    let mut chip = adc();
    chip.bus.write32(FCS, 1);
    // Channels 1, 3 and the temperature sensor, beginning with 3.
    chip.bus
        .write32(CS, 0b11010 << 16 | 3 << 12 | 1 << 3 | 1 << 1 | 1);
    run(&mut chip, 4 * 240).expect("it runs");
    let results: Vec<u32> = (0..4).map(|_| chip.bus.read32(FIFO)).collect();
    // 0.706 V at 27 °C (datasheet 4.9.5).
    assert_eq!(results, [code(2.0), code(0.706), code(1.0), code(2.0)]);
}

#[test]
fn a_warmer_die_gives_less_voltage() {
    let mut chip = adc();
    chip.bus.adc.die_celsius = 47.0;
    chip.bus.write32(CS, 4 << 12 | 1 << 2 | 1 << 1 | 1);
    run(&mut chip, 240).expect("it runs");
    assert_eq!(chip.bus.read32(RESULT), code(0.706 - 20.0 * 0.001_721));
}

#[test]
fn the_fifo_holds_four_and_says_when_it_is_overrun_and_when_it_is_read_empty() {
    let mut chip = adc();
    // SHIFT: bytes. Threshold 3.
    chip.bus.write32(FCS, 3 << 24 | 0b11);
    chip.bus.write32(ADC + 0x18, 1);
    chip.bus.write32(CS, 1 << 12 | 1 << 3 | 1);
    run(&mut chip, 2 * 240).expect("it runs");
    assert!(!chip.bus.adc.irq_line());
    run(&mut chip, 240).expect("it runs");
    assert!(chip.bus.adc.irq_line(), "three results");
    assert_eq!(chip.bus.read32(ADC + 0x20), 1);
    run(&mut chip, 3 * 240).expect("it runs");
    chip.bus.write32(CS, 1);
    // FULL, OVER, level 4.
    assert_eq!(chip.bus.read32(FCS) & 0x000f_0f00, 4 << 16 | 0xa00);
    for _ in 0..4 {
        assert_eq!(chip.bus.read32(FIFO), code(1.0) >> 4);
    }
    chip.bus.read32(FIFO);
    // EMPTY, UNDER, OVER; the last two clear by writing ones.
    assert_eq!(chip.bus.read32(FCS) & 0x000f_0f00, 0xd00);
    chip.bus.write32(FCS, 0xc00);
    assert_eq!(chip.bus.read32(FCS) & 0xf00, 0x100);
}

#[test]
fn a_failed_conversion_is_marked_in_cs_and_in_the_fifo() {
    let mut chip = adc();
    chip.bus.adc.set_input(0, Box::new(Steady(f64::NAN)));
    chip.bus.write32(FCS, 0b101);
    chip.bus.write32(CS, 1 << 2 | 1);
    run(&mut chip, 240).expect("it runs");
    assert_eq!(chip.bus.read32(CS) & 0x600, 0x600);
    assert_eq!(chip.bus.read32(FIFO), 1 << 15);
    // The next one is good: ERR falls, the sticky bit stays until it is cleared.
    chip.bus.adc.set_input(0, Box::new(Steady(1.0)));
    chip.bus.write32(CS, 1 << 2 | 1);
    run(&mut chip, 240).expect("it runs");
    assert_eq!(chip.bus.read32(CS) & 0x600, 0x400);
    chip.bus.write32(CS, 1 << 10 | 1);
    assert_eq!(chip.bus.read32(CS) & 0x600, 0);
}

#[test]
fn dma_takes_the_results_by_dreq_36() {
    let mut chip = adc();
    let (dma, sink) = (0x5000_0000, 0x2000_3000);
    chip.bus.write32(FCS, 1 << 24 | 0b1011);
    for (offset, value) in [
        (0x0, FIFO),
        (0x4, sink),
        (0x8, 8),
        (0xc, 36 << 15 | 1 << 5 | 1),
    ] {
        chip.bus.write32(dma + offset, value);
    }
    chip.bus.write32(CS, 0b11 << 16 | 1 << 3 | 1);
    run(&mut chip, 8 * 240 + 20).expect("it runs");
    let bytes = [code(0.5), code(1.0)].map(|c| c >> 4);
    for n in 0..8 {
        assert_eq!(u32::from(chip.bus.read8(sink + n)), bytes[n as usize % 2]);
    }
    assert_eq!(chip.bus.read8(sink + 8), 0);
}

#[test]
fn without_clk_adc_no_conversion_ends_and_an_open_input_stops_the_chip() {
    let mut without = adc();
    without.bus.write32(0x4000_8060, 0);
    without.bus.write32(CS, 1 << 2 | 1);
    run(&mut without, 100_000).expect("it runs");
    assert_eq!(without.bus.read32(CS) & READY, 0);

    let mut open = chip(&FOREVER);
    open.bus.write32(0x4000_8060, 3 << 5 | 1 << 11);
    open.bus.write32(CS, 1 << 2 | 1);
    let halt = run(&mut open, 100).expect_err("it stops");
    assert!(halt.to_string().contains("ADC input 0"), "{halt}");
}
