//! What `AT+INFO` tells: the device, the firmware that runs, why it started, its last crash.
//!
//! ```text
//!   Device: adsbee_1090
//!   Serial number: 5351554954544552
//!   Firmware: 0.1.0.0 (Nov 24 2026), slot A, confirmed
//!   Started by: watchdog
//!   Last crash: watchdog: core 1 stopped; firmware 0.1.0.0 after 12.345 s; blocks=… (2 since power-on)
//!   OK
//! ```

use crate::console::reply;
use crate::receiver::Receiver;
use boot_contract::boot_log::SlotName;
use boot_contract::hand_over::Cause;
use shell::OK;

/// Tells it on CONSOLE.
pub fn tell(receiver: &mut Receiver) {
    let (start, unique_id, crash) = (receiver.start, receiver.unique_id, receiver.crash);
    let header = receiver.confirm.header();
    let slot = receiver.confirm.slot().map_or("unknown", SlotName::letter);
    let standing = if receiver.confirm.is_confirmed() {
        "confirmed"
    } else {
        "on trial"
    };
    let port = &mut receiver.console.port;
    if let Some(header) = header {
        reply(port, format_args!("Device: {}", header.board_name()));
    }
    let id = u64::from_be_bytes(unique_id);
    reply(port, format_args!("Serial number: {id:016X}"));
    if let Some(header) = header {
        let version = header.version_text();
        reply(
            port,
            format_args!("Firmware: {version}, slot {slot}, {standing}"),
        );
    }
    let start = start.map_or("unknown", Cause::name);
    reply(port, format_args!("Started by: {start}"));
    match crash {
        Some(crash) => reply(
            port,
            format_args!("Last crash: {crash} ({} since power-on)", crash.count),
        ),
        None => reply(port, format_args!("Last crash: none since power-on")),
    }
    reply(port, format_args!("{OK}"));
}
