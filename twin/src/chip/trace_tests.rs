//! The value change dump: what it says, and that recording changes nothing.

use super::test_chip::*;
use super::trace::{Signal, UnknownSignal};

const SIO_OUT: u32 = 0xd000_0010;
const SIO_OE: u32 = 0xd000_0020;
const GPIO15_CTRL: u32 = 0x4001_407c;

/// A chip whose core 0 turns GPIO 15 over every 5 cycles: loop: str r1, [r0]; nop; nop; b loop, with r0 at GPIO_OUT_XOR.
fn blinking() -> super::Chip {
    let mut chip = chip(&[0x6001, 0xbf00, 0xbf00, 0xe7fb]);
    chip.bus.write32(GPIO15_CTRL, 5);
    chip.bus.write32(SIO_OUT, 0);
    chip.bus.write32(SIO_OE, 1 << 15);
    let regs = &mut chip.cores[0].cpu.regs;
    (regs.r[0], regs.r[1]) = (SIO_OUT + 0xc, 1 << 15);
    chip
}

/// Times in ps and values of the signal with this identifier.
fn changes(vcd: &str, identifier: &str) -> Vec<(u128, String)> {
    let mut at = 0;
    let mut found = Vec::new();
    for line in vcd.lines() {
        if let Some(time) = line.strip_prefix('#') {
            at = time.parse().expect("a time");
        } else if let Some(value) = line.strip_suffix(identifier)
            && !line.starts_with('$')
        {
            found.push((at, value.trim().to_owned()));
        }
    }
    found
}

#[test]
fn a_pin_is_recorded_at_its_cycles() {
    let mut chip = blinking();
    let signals = ["LED", "[20002000]"].map(|name| {
        let signal = Signal::parse(name, &[("LED", 15)]).expect("a signal");
        (name.to_owned(), signal)
    });
    chip.bus.start_trace(&signals);
    run(&mut chip, 1_000).expect("it runs");
    let trace = chip.bus.trace.as_mut().expect("it records");
    let vcd = trace.take_text();
    assert!(vcd.starts_with("$timescale 1 ps $end\n"), "{vcd}");
    assert!(vcd.contains("$var wire 1 ! LED $end\n"), "{vcd}");
    assert!(vcd.contains("$var wire 32 \" [20002000] $end\n"), "{vcd}");
    let changes = changes(&vcd, "!");
    assert!(changes.len() > 190, "{}", changes.len());
    for pair in changes.windows(2).skip(1) {
        // 5 cycles at 120 MHz are 41 666.7 ps.
        let apart = pair[1].0 - pair[0].0;
        assert!((41_666..=41_667).contains(&apart), "{apart}");
        assert_ne!(pair[0].1, pair[1].1);
    }
}

#[test]
fn recording_changes_nothing() {
    let [plain, recorded] = [false, true].map(|records| {
        let mut chip = blinking();
        if records {
            let signal = Signal::parse("GPIO15", &[]).expect("a signal");
            chip.bus.start_trace(&[("GPIO15".into(), signal)]);
        }
        run(&mut chip, 10_007).expect("it runs");
        let cpu = &chip.cores[0].cpu;
        (
            chip.now(),
            cpu.time,
            cpu.regs.pc(),
            cpu.regs.r,
            chip.bus.sio.out,
        )
    });
    assert_eq!(plain, recorded);
}

#[test]
fn signals_have_the_names_the_table_says() {
    for name in [
        "GPIO0",
        "gpio29",
        "PIO1.SM3.RX",
        "DMA.BUSY",
        "CORE1.EXCEPTION",
        "CORE0.SLEEP",
        "[20041ffc]",
    ] {
        assert!(Signal::parse(name, &[]).is_ok(), "{name}");
    }
    for name in [
        "GPIO30",
        "PIO2.SM0.PC",
        "PIO0.SM4.PC",
        "[20001235]",
        "[20042000]",
        "LED",
        "",
    ] {
        assert_eq!(Signal::parse(name, &[]), Err(UnknownSignal(name.into())));
    }
}
