//! JSON: one object a message, no white space, a line end behind it.
//!
//! ```text
//!   {"src":"<serial>","ts":<ms since UTC midnight>,"ver":1,"<section>":…}\r\n
//!
//!   section        content                       known from
//!   adsb           [{one aircraft}]               tracker, each second
//!   raw            [["<hex>",SIGS,SIGQ,"TS24h"]]  each frame; null where unknown
//!   status         {"fw":"…"}
//!   gnss           {…}                            the GNSS
//!   system, adsbStatistics                        names of ours, see docs/protocols/json.md
//! ```
//! A field that is not known is left out, `ts` too. NACp, NACv, NICbaro, NIC and GVA are left out where they are 0, which is unknown. Two
//! profiles of the `adsb` names, never both in one message: the OEM TT-SG1a's (`altBaro`, track 0-360) and the OEM TT-SF1's (`baroAlt`, track
//! -180 to 180).
//!
//! Source: the OEM TT-SG1a document, 6.6, 7.2 and 8.2.2; the OEM TT-SF1 document, 6.7.

use crate::Full;
use crate::frame_report::{Bits, FrameReport};
use crate::json_object::Object;
use crate::moment::Moment;
use crate::statistics::Statistics;
use crate::text::{Text, whole_decibels};

pub use crate::json_aircraft::aircraft;
pub use crate::json_gnss::gnss;

/// A slice that holds any message but an aircraft's.
pub const MAX_MESSAGE: usize = 448;
/// A slice that holds any aircraft's message.
pub const MAX_AIRCRAFT: usize = 1_024;
/// Bytes of a serial number or a version that are sent at most.
pub(crate) const MOST_TEXT: usize = 32;

/// Sections of `AERO_JSON_BITMASK`.
pub mod section {
    /// Aircraft.
    pub const ADSB: u8 = 0x01;
    /// FLARM targets.
    pub const FLARM: u8 = 0x02;
    /// Raw frames.
    pub const RAW: u8 = 0x04;
    /// Firmware and device.
    pub const STATUS: u8 = 0x08;
    /// The receiver's GNSS.
    pub const GNSS: u8 = 0x10;
    /// Sensors, which no board has.
    pub const SENSOR: u8 = 0x20;
}

/// Names of the `adsb` section (`JSON_PROFILE`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Profile {
    /// 0: the OEM TT-SG1a's.
    #[default]
    Sg1a,
    /// 1: the OEM TT-SF1's.
    Sf1,
}

/// Head and section, between the braces of the message.
pub(crate) fn message(
    source: &str,
    moment: &Moment,
    out: &mut [u8],
    section: impl FnOnce(&mut Object<'_, '_>) -> Result<(), Full>,
) -> Result<usize, Full> {
    let mut text = Text::new(out);
    let mut object = Object::open(&mut text)?;
    object.text("src", source)?;
    if let Some(ms) = moment.utc_ms {
        object.key("ts")?.digits(ms, 1)?;
    }
    object.number("ver", 1)?;
    section(&mut object)?;
    object.close()?;
    text.bytes(b"\r\n")?;
    Ok(text.len())
}

/// The `raw` section with one frame.
pub fn raw(
    source: &str,
    report: &FrameReport<'_>,
    moment: &Moment,
    out: &mut [u8],
) -> Result<usize, Full> {
    message(source, moment, out, |object| {
        let text = object.key("raw")?;
        text.bytes(b"[[\"")?;
        match report.bits {
            Bits::ModeS(frame) => text.hex_bytes(frame.bytes())?,
            Bits::ModeAc { code, .. } => text.octal4(code)?,
        }
        text.byte(b'"')?;
        for value in [report.level_cdbm, report.quality_cdb] {
            text.byte(b',')?;
            match value {
                Some(value) => text.decimal(whole_decibels(value))?,
                None => text.bytes(b"null")?,
            }
        }
        text.byte(b',')?;
        match report.times.ts24h_ns() {
            Some(ns) => {
                text.byte(b'"')?;
                text.hex_long(ns)?;
                text.byte(b'"')?;
            }
            None => text.bytes(b"null")?,
        }
        text.bytes(b"]]")
    })
}

/// The `status` section.
pub fn status(
    source: &str,
    firmware: &str,
    moment: &Moment,
    out: &mut [u8],
) -> Result<usize, Full> {
    message(source, moment, out, |object| {
        let mut status = object.object("status")?;
        status.text("fw", firmware)?;
        status.close()
    })
}

/// SYSTEM_STATISTICS: section `systemStatistics`.
pub fn system_statistics(
    source: &str,
    statistics: &Statistics,
    moment: &Moment,
    out: &mut [u8],
) -> Result<usize, Full> {
    message(source, moment, out, |object| {
        let mut section = object.object("systemStatistics")?;
        if let Some(load) = statistics.load_permille {
            section.key("cpl")?.tenths(load)?;
        }
        section.key("upt")?.digits(statistics.enabled_s, 1)?;
        section.key("uptime")?.digits(statistics.uptime_s, 1)?;
        section.count("sent", statistics.sent)?;
        section.count("dropped", statistics.dropped)?;
        section.close()
    })
}

/// ADSB_STATISTICS: section `adsbStatistics`.
pub fn adsb_statistics(
    source: &str,
    statistics: &Statistics,
    moment: &Moment,
    out: &mut [u8],
) -> Result<usize, Full> {
    message(source, moment, out, |object| {
        let mut section = object.object("adsbStatistics")?;
        section.count("dps", statistics.demodulations)?;
        section.count("fpss", statistics.mode_s_frames)?;
        section.count("fpsac", statistics.mode_ac_frames)?;
        section.count("calib", statistics.stamp_clock_hz)?;
        section.count("aircraft", statistics.aircraft)?;
        section.close()
    })
}

#[cfg(test)]
#[path = "json_tests.rs"]
mod tests;
