//! What `AT+INFO` tells: the device, the firmware that runs, why it started, its last crash.
//!
//! ```text
//!   Device: adsbee_1090
//!   Serial number: 5351554954544552
//!   Firmware: 0.1.0.0 (Nov 24 2026), slot A, confirmed
//!   Started by: watchdog
//!   Last crash: watchdog: core 1 stopped; firmware 0.1.0.0 after 12.345 s; blocks=… (2 since power-on)
//! ```

use crate::receiver::Receiver;
use boot_contract::boot_log::SlotName;
use boot_contract::hand_over::Cause;
use shell::{Device, Out};

/// Tells it.
pub fn tell(receiver: &Receiver, out: &mut dyn Out) {
    let identity = receiver.identity();
    let slot = receiver.confirm.slot().map_or("unknown", SlotName::letter);
    let standing = if receiver.confirm.is_confirmed() {
        "confirmed"
    } else {
        "on trial"
    };
    out.line(format_args!("Device: {}", identity.device));
    out.line(format_args!("Serial number: {}", identity.serial));
    let version = identity.version;
    out.line(format_args!("Firmware: {version}, slot {slot}, {standing}"));
    let start = receiver.start.map_or("unknown", Cause::name);
    out.line(format_args!("Started by: {start}"));
    match receiver.crash {
        Some(crash) => out.line(format_args!(
            "Last crash: {crash} ({} since power-on)",
            crash.count
        )),
        None => out.line(format_args!("Last crash: none since power-on")),
    }
}
