//! The self-test: each part checked where it can be, with what was found.
//!
//! | check | does | passes when |
//! |---|---|---|
//! | `FLASH` | reads the unique id; the CRC-32 of the image that runs | the id is one, the CRC is the header's |
//! | `EEPROM` | reads a page that is the self-test's own; writes it where it does not hold its pattern, and reads it back | it holds the pattern |
//! | `SETTINGS` | loads the settings | the memory answers; whether there are any is told |
//! | `RX_GAIN` | sets another gain, reads it back, sets the one before | both read back |
//! | `RSSI` | the mean of 2048 conversions of the detector's output | 50 to 3250 mV: neither end of the converter |
//! | `TRIGGER_LEVEL`, `TRIGGER_LEVEL_LOW` | reads the level at the comparator; waits for its RC if it is off | within 40 mV of what is set |
//! | `GNSS` | tells sentences and pulses seen since the start | unless what came holds no whole sentence; nothing attached is no failure |
//! | `CAPTURE` | counts words of samples for 12.8 ms, which run on also while reception is off | 250 000 words a second within 2 % |
//! | `CLOCK_SYS`, `CLOCK_USB` | the frequency counter, against the crystal | 120 000 and 48 000 kHz within 0.1 % |
//! | `STACK_0`, `STACK_1` | bytes of each core's stack that were never used | enough is left |
//!
//! A check of a part that the board does not have is absent. What has no line is not tested: that a pulse at the antenna
//! reaches the comparator, and the ESP32. Takes 60 ms, 60 more where a level is off, in which core 0 does nothing else; core 1 and the ports' DMA go on.

use crate::hardware::Refused;
use crate::receiver::Receiver;
use crate::store::{SCRATCH_PAGE_AT, Trouble};
use core::fmt::{self, Display, Write};
use core::sync::atomic::Ordering;
use drivers::eeprom::{Eeprom, EepromError, PAGE};
use embedded_hal::i2c::I2c;
use hal::clocks::{Clock, measured_khz};
use hal::{boot, stack, timer};

/// Checks of the board with the most parts.
const MOST: usize = 14;
/// Bytes of a value.
const VALUE: usize = 64;
/// The capture is watched for so many blocks of 32 words, 128 us each.
const BLOCKS: u32 = 100;
const BLOCK_US: u32 = 128;
/// A detector's output, mV: this far from both ends of the converter, where an open or a shorted input reads.
const RSSI_MV: (u16, u16) = (50, 3250);
/// A level may read so far off what is set, mV: the converter's errors of offset and linearity (RP2040 datasheet, 4.9.3; erratum E11), 50 codes in all.
const LEVEL_OFF_MV: u16 = 40;
/// Six time constants of a level's RC (10 ms), after which a step over the full scale is 8 mV off.
const LEVEL_SETTLES_US: u64 = 60_000;
/// Bytes of stack that shall never have been used.
const STACK_RESERVE: u32 = 1024;
/// What the self-test's page holds: each byte another, so that a line that sticks shows.
const PATTERN: [u8; PAGE] = {
    let mut pattern = [0; PAGE];
    let mut n = 0;
    while n < PAGE {
        pattern[n] = (n as u8).wrapping_mul(0x35) ^ 0xA5;
        n += 1;
    }
    pattern
};

/// A check that was made.
pub struct Check {
    pub name: &'static str,
    pub passed: bool,
    value: heapless::String<VALUE>,
}

impl Display for Check {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = if self.passed { "PASS" } else { "FAIL" };
        write!(out, "{} {verdict} {}", self.name, self.value)
    }
}

/// All checks of this board.
pub type Checks = heapless::Vec<Check, MOST>;

/// Makes them.
pub fn run(receiver: &mut Receiver) -> Checks {
    let mut checks = Checks::new();
    flash(receiver, &mut checks);
    if let Some(eeprom) = receiver.store.eeprom() {
        let found = scratch_page(eeprom);
        let (Ok(text) | Err(text)) = found;
        add(&mut checks, "EEPROM", found.is_ok(), format_args!("{text}"));
    }
    settings(receiver, &mut checks);
    rssi(receiver, &mut checks);
    trigger_levels(receiver, &mut checks);
    rx_gain(receiver, &mut checks);
    gnss(receiver, &mut checks);
    capture(receiver, &mut checks);
    clock(&mut checks, "CLOCK_SYS", Clock::System, 120_000);
    clock(&mut checks, "CLOCK_USB", Clock::Usb, 48_000);
    for (name, unused) in [
        ("STACK_0", stack::core0_unused()),
        ("STACK_1", stack::core1_unused()),
    ] {
        let enough = unused >= STACK_RESERVE;
        add(
            &mut checks,
            name,
            enough,
            format_args!("{unused} bytes never used"),
        );
    }
    checks
}

fn add(checks: &mut Checks, name: &'static str, passed: bool, value: fmt::Arguments<'_>) {
    let mut check = Check {
        name,
        passed,
        value: heapless::String::new(),
    };
    // Values are shorter than the place for them, and there is a place for each check of the board with the most.
    let _ = check.value.write_fmt(value);
    let _ = checks.push(check);
}

fn flash(receiver: &Receiver, checks: &mut Checks) {
    // All zeros or all ones is what a line that nobody drives reads.
    let id = receiver.serial.as_str();
    let has_id = id.bytes().any(|digit| Some(digit) != id.bytes().next());
    let running = receiver.confirm.slot().zip(receiver.confirm.header());
    let Some((slot, header)) = running else {
        return add(checks, "FLASH", false, format_args!("{id}, no header"));
    };
    let crc = boot_contract::crc32(boot::flash(slot.slot().image, header.image_length));
    add(
        checks,
        "FLASH",
        has_id && crc == header.image_crc,
        format_args!("id {id}, image CRC {crc:08X}"),
    );
}

/// The page of the self-test: its pattern, written if it is not there. A device that works is written once in its life.
fn scratch_page<B: I2c>(eeprom: &mut Eeprom<B>) -> Result<&'static str, &'static str> {
    if scratch_reads_back(eeprom).map_err(EepromError::reason)? {
        return Ok("read back");
    }
    write_scratch(eeprom).map_err(EepromError::reason)?;
    if scratch_reads_back(eeprom).map_err(EepromError::reason)? {
        Ok("written and read back")
    } else {
        Err("does not hold what is written")
    }
}

fn scratch_reads_back<B: I2c>(eeprom: &mut Eeprom<B>) -> Result<bool, EepromError> {
    let mut page = [0; PAGE];
    eeprom.read(SCRATCH_PAGE_AT, &mut page)?;
    Ok(page == PATTERN)
}

fn write_scratch<B: I2c>(eeprom: &mut Eeprom<B>) -> Result<(), EepromError> {
    eeprom.write(SCRATCH_PAGE_AT, &PATTERN)?;
    while eeprom.is_busy()? {}
    Ok(())
}

fn settings(receiver: &mut Receiver, checks: &mut Checks) {
    let place = receiver.store.place();
    let loaded = receiver.store.load().map(<[u8]>::len);
    let (number, _) = receiver.store.counts();
    match loaded {
        Ok(length) => add(
            checks,
            "SETTINGS",
            true,
            format_args!("{length} bytes in {place}, save {number}"),
        ),
        Err(Trouble::Missing) => add(
            checks,
            "SETTINGS",
            true,
            format_args!("none saved in {place}"),
        ),
        Err(trouble) => add(
            checks,
            "SETTINGS",
            false,
            format_args!("{}", trouble.reason()),
        ),
    }
}

fn rssi(receiver: &Receiver, checks: &mut Checks) {
    let mv = receiver.air.rssi_mv();
    let (least, most) = RSSI_MV;
    let possible = (least..=most).contains(&mv);
    add(checks, "RSSI", possible, format_args!("{mv} mV"));
}

/// A level that was set just now is still on its way: it gets the time for it.
fn trigger_levels(receiver: &mut Receiver, checks: &mut Checks) {
    let air = &mut receiver.air;
    let (low_set, set) = air.levels_mv();
    let start_us = timer::now_us();
    let read = loop {
        let read = (air.read_mv(), air.read_low_mv());
        let near = is_near(read.0, set) && read.1.is_none_or(|low| is_near(low, low_set));
        if near || timer::now_us() - start_us >= LEVEL_SETTLES_US {
            break read;
        }
    };
    let levels = [
        ("TRIGGER_LEVEL", set, Some(read.0)),
        ("TRIGGER_LEVEL_LOW", low_set, read.1),
    ];
    for (name, set, read) in levels {
        if let Some(read) = read {
            let value = format_args!("{read} mV, set {set} mV");
            add(checks, name, is_near(read, set), value);
        }
    }
}

fn is_near(read_mv: u16, set_mv: u16) -> bool {
    read_mv.abs_diff(set_mv) <= LEVEL_OFF_MV
}

fn gnss(receiver: &Receiver, checks: &mut Checks) {
    if let Some((good, bad, pulses)) = receiver.clock.heard() {
        let value = format_args!("{good} sentences, {bad} bad, {pulses} pulses");
        add(checks, "GNSS", good > 0 || bad == 0, value);
    }
}

fn rx_gain(receiver: &mut Receiver, checks: &mut Checks) {
    let (hardware, store) = (&mut receiver.hardware, &mut receiver.store);
    let before = match hardware.rx_gain(store) {
        Err(Refused::Absent(_)) => return,
        before => before,
    };
    let other = |gain: u8| if gain == 50 { 51 } else { 50 };
    let tried = before.and_then(|before| {
        hardware.set_rx_gain(store, other(before))?;
        let read = hardware.rx_gain(store)?;
        hardware.set_rx_gain(store, before)?;
        Ok(read == other(before) && hardware.rx_gain(store)? == before)
    });
    match (before, tried) {
        (Ok(gain), Ok(passed)) => add(checks, "RX_GAIN", passed, format_args!("{gain}")),
        (_, Err(cause)) | (Err(cause), _) => {
            add(checks, "RX_GAIN", false, format_args!("{}", cause.reason()));
        }
    }
}

fn capture(receiver: &Receiver, checks: &mut Checks) {
    let words = &receiver.shared.capture.words;
    let (start_us, before) = (timer::now_us(), words.load(Ordering::Relaxed));
    while timer::now_us() - start_us < u64::from(BLOCKS * BLOCK_US) {}
    let counted = words.load(Ordering::Relaxed).wrapping_sub(before);
    let elapsed_us = (timer::now_us() - start_us) as u32;
    let expected = elapsed_us / 4;
    let passed = counted.abs_diff(expected) <= expected / 50;
    let rate = counted.saturating_mul(1000) / elapsed_us * 1000;
    add(checks, "CAPTURE", passed, format_args!("{rate} words/s"));
}

fn clock(checks: &mut Checks, name: &'static str, clock: Clock, expected_khz: u32) {
    match measured_khz(clock) {
        Some(khz) => add(
            checks,
            name,
            khz.abs_diff(expected_khz) <= expected_khz / 1000,
            format_args!("{khz} kHz"),
        ),
        None => add(checks, name, false, format_args!("does not run")),
    }
}
