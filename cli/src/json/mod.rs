//! One decoded frame as a JSON object. Where pyModeS 3 has a name for a field it is that name and that unit; `help` lists all.
//!
//! ```text
//!   frame, Message ─► header (address, parity) ─► replies   DF 0, 4, 5, 11, 16, 20, 21, 24 ─► registers   MB of DF 20, 21
//!                                              └► squitter  DF 17, 18, 19                  ─► status      TC 28, 29, 31
//!   tracked aircraft ─► position, integrity
//! ```
//! A field that the frame does not have, or that holds nothing, is left out. Numbers are numbers, flags that pyModeS prints as 0 and 1 are
//! that, the others true and false.

mod advisory;
mod help;
mod registers;
mod replies;
mod squitter;
mod status;

use mode_s::{
    Address, AltitudeFt, Body, CentiDegrees, Frame, Inference, Interrogator, Known, Me, Message,
    ModeACode, NicSupplements, Parity, infer, quality,
};
use serde_json::{Map, Value};
use tracker::{Aircraft, Heard, Tracker};

pub use help::FIELDS;

/// The fields of one object.
pub struct Fields(Map<String, Value>);

impl Fields {
    fn put(&mut self, name: &str, value: impl Into<Value>) {
        self.0.insert(name.into(), value.into());
    }

    fn may_put(&mut self, name: &str, value: Option<impl Into<Value>>) {
        if let Some(value) = value {
            self.put(name, value);
        }
    }

    /// A flag that pyModeS prints as a number.
    fn may_put_bit(&mut self, name: &str, value: Option<bool>) {
        self.may_put(name, value.map(u8::from));
    }

    fn altitude(&mut self, altitude: Option<AltitudeFt>) {
        self.may_put("altitude", altitude.map(|feet| feet.0));
    }

    fn angle(&mut self, name: &str, angle: Option<CentiDegrees>) {
        self.may_put(name, angle.map(|angle| f64::from(angle.0) / 100.0));
    }

    fn squawk(&mut self, squawk: ModeACode) {
        self.put("squawk", format!("{:04o}", squawk.0));
    }
}

/// What the tracker knows of a frame's sender.
pub struct Tracked<'a> {
    /// What was known before the frame: a Comm-B register is guessed by it.
    pub known: Known,
    /// The aircraft after the frame.
    pub aircraft: Option<&'a Aircraft>,
    /// Milliseconds, as the tracker counts them.
    pub now_ms: u64,
}

impl<'a> Tracked<'a> {
    /// Lets the tracker hear a frame.
    pub fn hear<const N: usize>(
        tracking: &'a mut Tracker<N>,
        frame: &Frame,
        message: &Message,
        heard: Heard,
    ) -> Tracked<'a> {
        let now_ms = heard.at_ms;
        let address = message.address();
        let before = address.and_then(|address| tracking.find(address));
        let known = before.map_or(Known::NOTHING, |aircraft| aircraft.known(now_ms));
        tracking.on_frame(frame, message, heard);
        Tracked {
            known,
            aircraft: address.and_then(|address| tracking.find(address)),
            now_ms,
        }
    }
}

/// The object of a frame.
pub fn object(
    hex: &str,
    seconds: Option<f64>,
    message: &Message,
    tracked: Option<&Tracked>,
) -> Value {
    let mut fields = Fields(Map::new());
    fields.may_put("time", seconds);
    fields.put("frame", hex);
    header(message, &mut fields);
    let known = tracked.map_or(Known::NOTHING, |tracked| tracked.known);
    match &message.body {
        Body::ExtendedSquitter { origin, me } => squitter::put(*origin, me, &mut fields),
        Body::CoarsePosition(position) => squitter::put_coarse(position, &mut fields),
        _ => replies::put(message, &mut fields),
    }
    if let Some(mb) = message.mb() {
        let bytes = mb.bytes().map(|byte| format!("{byte:02X}"));
        fields.put("mb", bytes.concat());
        inferred(&infer(mb, &at_its_altitude(message, known)), &mut fields);
    }
    if let Some(Tracked {
        aircraft: Some(aircraft),
        now_ms,
        ..
    }) = tracked
    {
        put_aircraft(aircraft, *now_ms, message, &mut fields);
    }
    Value::Object(fields.0)
}

/// A DF20 tells the altitude itself.
fn at_its_altitude(message: &Message, known: Known) -> Known {
    match message.body {
        Body::AltitudeReply {
            altitude: Some(altitude),
            ..
        } => Known {
            altitude: Some(altitude),
            ..known
        },
        _ => known,
    }
}

fn header(message: &Message, fields: &mut Fields) {
    fields.put("df", message.df.number());
    fields.put("kind", message.kind().name());
    let crc = match message.parity {
        Parity::Exact(_) => "exact",
        Parity::Interrogator { .. } => "interrogator",
        Parity::Address(_) => "address",
        Parity::Broken => "broken",
        Parity::Unjudged => "unjudged",
    };
    fields.put("crc", crc);
    if matches!(message.df.number(), 17..=19) && message.parity != Parity::Unjudged {
        fields.put("crc_valid", message.parity != Parity::Broken);
    }
    if let Parity::Interrogator { code, .. } = message.parity {
        fields.put("interrogator_code", code);
        match Interrogator::of_code(code) {
            Some(Interrogator::Ii(number)) => fields.put("interrogator_ii", number),
            Some(Interrogator::Si(number)) => fields.put("interrogator_si", number),
            None => {}
        }
    }
    if let Some(address) = message.address() {
        fields.put("icao", format!("{:06X}", address.bits()));
        if let Address::NonIcao(_) = address {
            fields.put("address_type", "other");
        }
    }
}

fn inferred(inference: &Inference, fields: &mut Fields) {
    match inference {
        Inference::Found(register) => registers::put(register, fields),
        Inference::Ambiguous(candidates) => {
            let names: Vec<String> = candidates.iter().map(registers::name).collect();
            fields.put("bds_candidates", names);
        }
        Inference::Empty | Inference::Unknown => {}
    }
}

/// Position, and how good it is by what the aircraft has told of itself.
fn put_aircraft(aircraft: &Aircraft, now_ms: u64, message: &Message, fields: &mut Fields) {
    if let Some(place) = aircraft.position(now_ms) {
        fields.put("latitude", f64::from(place.latitude) * 1e-7);
        fields.put("longitude", f64::from(place.longitude) * 1e-7);
    }
    let Body::ExtendedSquitter { me, .. } = message.body else {
        return;
    };
    let b = match me {
        Me::AirbornePosition(position) => position.nic_b_or_single_antenna,
        Me::SurfacePosition(_) => false,
        _ => return,
    };
    fields.may_put("nic", aircraft.nic(now_ms));
    let supplements = NicSupplements {
        b,
        ..aircraft.nic_supplements(now_ms)
    };
    let radius = quality::radius_dm(me.type_code(), aircraft.version(), supplements);
    fields.may_put("rc", radius.map(|dm| f64::from(dm) / 10.0));
}

#[cfg(test)]
mod tests;
