//! What the crate `gdl90` understands of a byte stream: a value a message, with the names of `tests/clients/gdl90_client.py`.
//!
//! A weaker reader than the reference parser. It swaps nibbles (alert with address type, emergency with spare), knows no unknown altitude and no ForeFlight message, reads
//! message 11 low byte first, and does not undo escapes inside the frame check sequence. Of messages that it cannot read so, the value says only
//! `{"message": "left out"}`; fields that it does not separate are absent.

use gdl90::datalink::Gdl90DatalinkMessage;
use gdl90::types::report::{Altitude, Report, VelocityType};
use serde_json::{Value, json};

const FLAG: u8 = 0x7E;
const ESCAPE: u8 = 0x7D;
/// Ownship geometric altitude, and ForeFlight's extension.
const LEFT_OUT: [u8; 2] = [11, 0x65];
/// Bytes at the end of a message that may hold its frame check sequence, escaped.
const CHECK: usize = 3;
/// Degrees a 256th of a turn.
const ANGLE: f64 = 360.0 / 256.0;
/// What 0xFFF reads as: the crate takes the field for a number of 25 ft.
const UNKNOWN_ALTITUDE: i32 = 0xFFF * 25 - 1_000;

/// Reads messages between flags.
pub fn read(stream: &[u8]) -> Vec<Value> {
    let pieces = stream.split(|&byte| byte == FLAG);
    pieces
        .filter(|piece| !piece.is_empty())
        .map(message)
        .collect()
}

fn message(piece: &[u8]) -> Value {
    let check = &piece[piece.len().saturating_sub(CHECK)..];
    if LEFT_OUT.contains(&piece[0]) || check.contains(&ESCAPE) {
        return json!({"message": "left out"});
    }
    let framed = [&[FLAG], piece, &[FLAG]].concat();
    match gdl90::read_raw(&framed) {
        Err(error) => json!({"invalid": error.to_string()}),
        Ok(message) => match message.message_data {
            Gdl90DatalinkMessage::Heartbeat {
                status_byte_1,
                status_byte_2,
                uat_timestamp,
                ..
            } => json!({
                "message": "heartbeat",
                "gps_valid": u8::from(status_byte_1.gps_pos_valid()),
                "utc_ok": u8::from(status_byte_2.utc_ok()),
                "seconds": u32::from(uat_timestamp) + (u32::from(status_byte_2.timestamp_msb()) << 16),
            }),
            Gdl90DatalinkMessage::TrafficReport { report } => told("traffic", &report),
            Gdl90DatalinkMessage::OwnshipReport { report } => told("ownship", &report),
            other => json!({"invalid": format!("{other:?}")}),
        },
    }
}

fn told(name: &str, report: &Report) -> Value {
    let altitude_ft = match report.altitude() {
        Altitude::Valid(feet) if feet != UNKNOWN_ALTITUDE => Some(feet),
        _ => None,
    };
    let velocity = report.velocity();
    let speed_kt = match velocity.h_vel {
        VelocityType::Horizontal(knots) => Some(knots),
        _ => None,
    };
    let rate_fpm = match velocity.v_vel {
        VelocityType::Vertical(feet_per_minute) => Some(feet_per_minute),
        _ => None,
    };
    json!({
        "message": name,
        "address": report.participant().participant_address,
        "latitude": report.latitude(),
        "longitude": report.longitude(),
        "altitude_ft": altitude_ft,
        "nic": report.nic(),
        "nac_p": report.nacp(),
        "speed_kt": speed_kt,
        "rate_fpm": rate_fpm,
        "angle": f64::from(report.track_heading()) * ANGLE,
        "emitter": report.emmiter_cattegory() as u8,
        // The crate's nibbles are swapped.
        "emergency": report.reserved(),
        "callsign": report.call_sign().tail_number,
    })
}
