//! Comm-B: the registers that this project finds, each field beside rs1090's decoder of that register.
//!
//! Which register a reply copies is a guess; it is judged elsewhere (`cargo xtask bench golden` counts agreement with ADS-B). Here rs1090
//! is told the register and must read the same values.

use crate::ledger::{Difference, Ledger, Peer, Subject};
use crate::view::Said;
use mode_s::bds::bds40::TargetSource;
use mode_s::{Body, Frame, Known, MeBits, Message, Register, infer};
use rs1090::decode::bds::{DecodedBds, decode_bds};
use serde_json::Value;
use tracker::{Heard, Tracker};

/// What a register says, by rs1090's names.
type Fields = Vec<(&'static str, Said)>;

/// A tracker that tells what is known, and what it has counted.
pub struct CommB {
    tracker: Box<Tracker<400>>,
    second: u64,
}

impl CommB {
    pub fn new() -> CommB {
        CommB {
            tracker: Box::new(Tracker::new()),
            second: 0,
        }
    }

    pub fn hear(&mut self, ledger: &mut Ledger, at_ms: u64, frame: &Frame, message: &Message) {
        if at_ms / 1_000 != self.second {
            self.second = at_ms / 1_000;
            self.tracker.each_second(at_ms);
        }
        if let Some(mb) = message.mb()
            && let Some(register) = infer(mb, &self.known(message, at_ms)).found()
        {
            compare(ledger, frame, mb, &register);
        }
        self.tracker.on_frame(frame, message, Heard::at(at_ms));
    }

    fn known(&self, message: &Message, at_ms: u64) -> Known {
        let aircraft = message
            .address()
            .and_then(|address| self.tracker.find(address));
        let known = aircraft.map_or(Known::NOTHING, |aircraft| aircraft.known(at_ms));
        match message.body {
            Body::AltitudeReply { altitude, .. } => Known {
                altitude: altitude.or(known.altitude),
                ..known
            },
            _ => known,
        }
    }
}

fn compare(ledger: &mut Ledger, frame: &Frame, mb: MeBits, register: &Register) {
    let theirs = theirs(mb, register);
    let mut note = |name, is_same, ours: &Said, theirs| {
        ledger.compare(
            is_same,
            Difference {
                peer: Peer::Rs1090,
                subject: Subject::Register(name),
                ours: ours.clone(),
                theirs,
                frame,
            },
        );
    };
    let taken = Said::Whole(i64::from(theirs.is_some()));
    note("taken", theirs.is_some(), &Said::Whole(1), taken);
    for (name, ours) in ours(register) {
        let Some(theirs) = theirs.as_ref() else {
            continue;
        };
        let said = said(&theirs[name]);
        note(name, is_same(&ours, &said), &ours, said);
    }
}

/// rs1090's fields of the register, as JSON.
fn theirs(mb: MeBits, register: &Register) -> Option<Value> {
    let decoded = decode_bds(&mb.bytes(), register.bds().0).ok()?;
    let value = match decoded {
        DecodedBds::Bds10(told) => serde_json::to_value(told),
        DecodedBds::Bds17(told) => serde_json::to_value(told),
        DecodedBds::Bds20(told) => serde_json::to_value(told),
        DecodedBds::Bds30(told) => serde_json::to_value(told),
        DecodedBds::Bds40(told) => serde_json::to_value(told),
        DecodedBds::Bds44(told) => serde_json::to_value(told),
        DecodedBds::Bds45(told) => serde_json::to_value(told),
        DecodedBds::Bds50(told) => serde_json::to_value(told),
        DecodedBds::Bds60(told) => serde_json::to_value(told),
        other => panic!("another register: {other:?}"),
    };
    Some(value.expect("JSON"))
}

fn said(value: &Value) -> Said {
    match value {
        Value::Bool(flag) => Said::Whole((*flag).into()),
        Value::Number(number) => Said::real(number.as_f64()),
        Value::String(text) => Said::Text(text.trim().to_owned()),
        _ => Said::Nothing,
    }
}

/// Angles are hundredths of a degree here and floats there; the rest is exact.
fn is_same(ours: &Said, theirs: &Said) -> bool {
    match (ours.number(), theirs.number()) {
        (Some(ours), Some(theirs)) => (ours - theirs).abs() <= 0.0051,
        _ => ours == theirs,
    }
}

fn ours(register: &Register) -> Fields {
    let feet = |altitude: Option<mode_s::AltitudeFt>| Said::whole(altitude.map(|feet| feet.0));
    let degrees = |angle: Option<mode_s::CentiDegrees>| {
        Said::real(angle.map(|angle| f64::from(angle.0) / 100.0))
    };
    match register {
        Register::DataLinkCapability(told) => {
            let flags = [
                ("config", 9),
                ("ovc", 15),
                ("acas", 16),
                ("level5", 24),
                ("mode_s", 25),
                ("identification", 33),
                ("squitter", 34),
                ("sic", 35),
                ("gicb", 36),
                ("acas_hybrid", 37),
                ("acas_ra", 38),
            ];
            let flag = |(name, bit)| (name, Said::Whole(told.bit(bit).into()));
            let mut fields: Fields = flags.into_iter().map(flag).collect();
            fields.push(("subnet", Said::Whole(told.subnetwork_version().into())));
            fields.push(("dte", Said::Whole(told.terminals.into())));
            fields
        }
        Register::GicbCapability(told) => {
            let announced = |code| told.announces(mode_s::Bds(code)) == Some(true);
            // It leaves a register out that is not announced.
            [
                ("bds05", 0x05),
                ("bds06", 0x06),
                ("bds07", 0x07),
                ("bds08", 0x08),
                ("bds09", 0x09),
                ("bds0a", 0x0A),
                ("bds20", 0x20),
                ("bds21", 0x21),
                ("bds40", 0x40),
                ("bds44", 0x44),
                ("bds45", 0x45),
                ("bds50", 0x50),
                ("bds51", 0x51),
                ("bds52", 0x52),
                ("bds53", 0x53),
                ("bds60", 0x60),
            ]
            .map(|(name, code)| (name, Said::whole(announced(code).then_some(1))))
            .to_vec()
        }
        Register::AircraftIdentification(told) => {
            let text = told.callsign.map(|callsign| {
                let text = String::from_utf8_lossy(callsign.as_bytes());
                Said::Text(text.trim().to_owned())
            });
            vec![("callsign", text.unwrap_or(Said::Nothing))]
        }
        Register::AcasRa(told) => vec![
            ("issued_ra", Said::Whole(told.bit(9).into())),
            ("terminated", Said::Whole(told.terminated.into())),
            ("multiple", Said::Whole(told.multiple_threats.into())),
        ],
        Register::SelectedVerticalIntention(told) => vec![
            ("selected_mcp", feet(told.mcp_altitude)),
            ("selected_fms", feet(told.fms_altitude)),
            (
                "barometric_setting",
                Said::real(told.pressure_setting_tenths.map(|t| f64::from(t) / 10.0)),
            ),
            (
                "target_source",
                match told.target_source {
                    Some(TargetSource::AircraftAltitude) => Said::Text("AircraftAltitude".into()),
                    Some(TargetSource::Mcp) => Said::Text("FcpMcuSelectedAltitude".into()),
                    Some(TargetSource::Fms) => Said::Text("FmsSelectedAltitude".into()),
                    Some(TargetSource::Unknown) | None => Said::Nothing,
                },
            ),
        ],
        Register::MetRoutineReport(report) => vec![
            (
                "wind_speed",
                Said::whole(report.wind.map(|wind| wind.speed_kt)),
            ),
            ("wind_direction", degrees(report.wind.map(|wind| wind.from))),
            (
                "temperature",
                Said::Real(f64::from(report.temperature_quarters) / 4.0),
            ),
            ("pressure", Said::whole(report.pressure_hpa)),
        ],
        Register::MetHazardReport(report) => vec![
            (
                "static_temperature",
                Said::real(report.temperature_quarters.map(|q| f64::from(q) / 4.0)),
            ),
            ("static_pressure", Said::whole(report.pressure_hpa)),
            ("radio_height", Said::whole(report.radio_height_ft)),
        ],
        Register::TrackAndTurn(turn) => vec![
            (
                "roll",
                Said::real(turn.roll_steps.map(|steps| f64::from(steps) * 45.0 / 256.0)),
            ),
            ("track", degrees(turn.track)),
            ("groundspeed", Said::whole(turn.ground_speed_kt)),
            (
                "track_rate",
                Said::real(turn.track_rate_32nds.map(|rate| f64::from(rate) / 32.0)),
            ),
            ("TAS", Said::whole(turn.true_airspeed_kt)),
        ],
        Register::HeadingAndSpeed(speed) => vec![
            ("heading", degrees(speed.heading)),
            ("IAS", Said::whole(speed.indicated_airspeed_kt)),
            (
                "Mach",
                Said::real(speed.mach_thousandths.map(|mach| f64::from(mach) / 1e3)),
            ),
            ("vrate_barometric", Said::whole(speed.baro_rate_fpm)),
            ("vrate_inertial", Said::whole(speed.inertial_rate_fpm)),
        ],
    }
}
