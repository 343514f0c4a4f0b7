//! An image in the twin, looked at after every cycle.

use std::collections::VecDeque;

use twin::chip::Chip;
use twin::chip::flash::Flash;

use super::Account;
use super::scenario::{Event, MARK, Scenario};

/// Where the trace lies in SRAM: count, end mark, pairs.
const TRACE: usize = 0x2_0000;
const FLASH_BYTES: usize = 2 << 20;
/// Cycles between two looks where no cycle is compared.
const COARSE: u64 = 500;

/// Runs it.
pub fn run(scenario: &Scenario, image: &[u8]) -> Result<Account, String> {
    let mut flash = Flash::new(FLASH_BYTES, [0; 8]);
    flash.bytes[..image.len()].copy_from_slice(image);
    let mut chip = Chip::new(flash);
    for pin in 0..30 {
        // Nothing floats: the peer's inputs are low until they are driven.
        chip.bus.pins.drive(pin, false);
    }
    let mut account = Account::default();
    let mut bytes = VecDeque::new();
    let (mut marked, mut levels) = (false, 0);
    let step = if scenario.stamped { 1 } else { COARSE };
    while chip.now() < scenario.most && account.end == 0 {
        let until = chip.now() + step;
        chip.run_until(until)
            .map_err(|halt| format!("{}: the twin stopped: {halt}", scenario.image))?;
        // What an instruction did is there one cycle after it began.
        let began = chip.now() - 1;
        if read_records(&chip.bus.sram[..], began, &mut account) && !marked {
            marked = true;
            start(&mut chip, scenario, began, &mut bytes);
        }
        while bytes.front().is_some_and(|(at, _)| *at <= chip.now()) {
            if let Some((_, byte)) = bytes.pop_front() {
                let now = chip.now();
                chip.bus.uart[0].send(&[byte], now);
                chip.bus.touched();
            }
        }
        let seen = chip.bus.pins.levels() & scenario.watched;
        if seen != levels {
            levels = seen;
            if marked {
                account.pins.push((chip.now(), levels));
            }
        }
        talk(&mut chip, scenario, &mut account);
        account.end = word(&chip.bus.sram[..], TRACE + 4);
    }
    let sent = chip.bus.uart[0]
        .sent
        .iter()
        .map(|(_, byte)| *byte)
        .collect();
    account.bytes.insert("uart".into(), sent);
    Ok(account)
}

fn word(sram: &[u8], at: usize) -> u32 {
    u32::from_le_bytes([sram[at], sram[at + 1], sram[at + 2], sram[at + 3]])
}

/// Takes new records; true once the mark is among them.
fn read_records(sram: &[u8], cycle: u64, account: &mut Account) -> bool {
    let count = word(sram, TRACE) as usize;
    while account.records.len() < count {
        let at = TRACE + 8 + 8 * account.records.len();
        let record = (cycle, word(sram, at), word(sram, at + 4));
        account.records.push(record);
    }
    account
        .records
        .last()
        .is_some_and(|record| record.1 == MARK)
}

fn start(chip: &mut Chip, scenario: &Scenario, mark: u64, bytes: &mut VecDeque<(u64, u8)>) {
    for event in (scenario.events)() {
        match event {
            Event::Pin(after, pin, level) => chip.bus.pins.change_at(pin, level, mark + after),
            Event::Byte(after, byte) => bytes.push_back((mark + after, byte)),
        }
    }
    chip.bus.touched();
}

/// The USB host: sends its line once the port is open, and keeps what comes back.
fn talk(chip: &mut Chip, scenario: &Scenario, account: &mut Account) {
    let host = &mut chip.bus.usb_host;
    if scenario.usb.is_empty() || !host.open {
        return;
    }
    if host.received == 0 && host.to_device.is_empty() && !account.bytes.contains_key("usb") {
        host.to_device.extend(scenario.usb.bytes());
        account.bytes.insert("usb".into(), Vec::new());
        let configuration = host.descriptors.iter().rev().find(|d| d.0 == 2);
        let configuration = configuration.map(|d| d.1.clone()).unwrap_or_default();
        account.bytes.insert("configuration".into(), configuration);
    }
    let received = host.from_device.drain(..);
    account
        .bytes
        .entry("usb".into())
        .or_default()
        .extend(received);
}
