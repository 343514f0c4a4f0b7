//! Which encoder makes a message, for what a port carries. Every function gives the message's length, 0 where nothing is to be sent.
//!
//! | port carries | a frame | an aircraft | once a second | end of a round |
//! |---|---|---|---|---|
//! | HEX, HEXd, JSON raw | a line | | | |
//! | BEAST | a message | | its status, with GPS stamps | |
//! | CSBEE, CSV, JSON | | a line | CSBEE: `#S` | |
//! | AERO_JSON | `raw` | `adsb` | `status`, `gnss`; each section where the mask has its bit | |
//! | MAVLINK1, MAVLINK2 | | ADSB_VEHICLE | HEARTBEAT | MESSAGE_INTERVAL |
//! | GDL90 | | traffic | heartbeat, ForeFlight's id, ownship and its altitude | |
//! | ASTERIX | | CAT021 | CAT023 | |
//!
//! Statistics and what the GNSS receiver says stand beside text protocols as they are set ([`statistics`], [`gnss`]).

use crate::reporter::Context;
use report::{
    AltitudeOrder, FrameReport, Full, Statistics, aero, asterix, beast, csbee, gdl90, json,
    mavlink, radarcape, raw,
};
use settings::Settings;
use settings::choices::{
    self, AdsbStatistics, BeastTimestamp, Decoded, GnssDecoded, JsonProfile, Raw, RawFilter,
    SystemStatistics,
};
use tracker::Aircraft;

/// A slice that holds any frame as text or Beast tell it; JSON's is [`json::MAX_MESSAGE`].
pub(crate) const MAX_FRAME: usize = most(&[raw::MAX_HEX, beast::MAX_MESSAGE]);
/// A slice that holds any aircraft's message; JSON's is [`json::MAX_AIRCRAFT`].
pub(crate) const MAX_AIRCRAFT: usize = most(&[
    csbee::MAX_LINE,
    aero::MAX_LINE,
    asterix::MAX_BLOCK,
    gdl90::MAX_MESSAGE,
    mavlink::MAX_MESSAGE,
]);
/// A slice that holds any message that goes out once a second.
pub(crate) const MAX_SECOND: usize = most(&[MAX_AIRCRAFT, MAX_FRAME, json::MAX_MESSAGE]);

const fn most(lengths: &[usize]) -> usize {
    let (mut most, mut n) = (0, 0);
    while n < lengths.len() {
        if lengths[n] > most {
            most = lengths[n];
        }
        n += 1;
    }
    most
}

/// Settings that decide how messages look, and the state of what counts its messages.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look {
    beast: beast::Stamp,
    filtered: bool,
    altitude: AltitudeOrder,
    asterix: asterix::Source,
    json: json::Profile,
    json_sections: u8,
    mavlink: mavlink::Link,
}

impl Look {
    /// As set for a port that carries `decoded`; MAVLink's sequence goes on after `sequence`.
    pub(crate) fn of(settings: &Settings, decoded: Decoded, sequence: u8) -> Self {
        Look {
            beast: match settings.beast_timestamp {
                BeastTimestamp::TwelveMhz => beast::Stamp::Count12Mhz,
                BeastTimestamp::Gps => beast::Stamp::Gps,
            },
            filtered: settings.raw_filter == RawFilter::Accepted,
            altitude: match settings.altitude_order {
                choices::AltitudeOrder::GeometricFirst => AltitudeOrder::GeometricFirst,
                choices::AltitudeOrder::BarometricFirst => AltitudeOrder::BarometricFirst,
            },
            asterix: asterix::Source {
                sac: settings.asterix_sac,
                sic: settings.asterix_sic,
            },
            json: match settings.json_profile {
                JsonProfile::Tt => json::Profile::Sg1a,
                JsonProfile::Sf1 => json::Profile::Sf1,
            },
            json_sections: settings.json_sections,
            mavlink: mavlink::Link {
                version: match decoded {
                    Decoded::Mavlink2 => mavlink::Version::V2,
                    _ => mavlink::Version::V1,
                },
                system: settings.mavlink_system,
                component: settings.mavlink_component,
                sequence,
            },
        }
    }

    /// MAVLink's next sequence number.
    pub(crate) fn sequence(&self) -> u8 {
        self.mavlink.sequence
    }

    fn has(&self, section: u8) -> bool {
        self.json_sections & section != 0
    }

    /// Whether raw frames go out as JSON.
    pub(crate) fn tells_raw_json(&self, decoded: Decoded, raw: Raw) -> bool {
        raw == Raw::Json || decoded == Decoded::AeroJson && self.has(json::section::RAW)
    }
}

/// A frame, unless it goes out as JSON.
pub(crate) fn frame(
    protocol: Raw,
    look: &Look,
    report: &FrameReport<'_>,
    out: &mut [u8],
) -> Result<usize, Full> {
    match protocol {
        Raw::None | Raw::Json => Ok(0),
        Raw::Hex => raw::hex(report, out),
        Raw::Hexd => raw::hexd(report, out),
        Raw::Beast => beast::frame(report, look.beast, out),
    }
}

/// Bytes that an aircraft's message may take.
pub(crate) const fn most_of_aircraft(protocol: Decoded) -> usize {
    match protocol {
        Decoded::Json | Decoded::AeroJson => json::MAX_AIRCRAFT,
        _ => MAX_AIRCRAFT,
    }
}

/// An aircraft.
pub(crate) fn aircraft(
    protocol: Decoded,
    look: &mut Look,
    aircraft: &Aircraft,
    context: &Context<'_>,
    out: &mut [u8],
) -> Result<usize, Full> {
    let moment = &context.moment;
    match protocol {
        Decoded::None => Ok(0),
        Decoded::AeroJson if !look.has(json::section::ADSB) => Ok(0),
        Decoded::Json | Decoded::AeroJson => {
            json::aircraft(context.source(), aircraft, moment, look.json, out)
        }
        Decoded::Csbee => csbee::aircraft(aircraft, moment, out),
        Decoded::Csv => aero::aircraft(aircraft, moment, out),
        Decoded::Mavlink1 | Decoded::Mavlink2 => {
            look.mavlink.vehicle(aircraft, moment, look.altitude, out)
        }
        Decoded::Gdl90 => gdl90::traffic(aircraft, moment, look.altitude, out),
        Decoded::Asterix => asterix::target(aircraft, moment, look.asterix, out),
    }
}

/// What closes a round.
pub(crate) fn round_end(protocol: Decoded, look: &mut Look, out: &mut [u8]) -> Result<usize, Full> {
    match protocol {
        Decoded::Mavlink1 | Decoded::Mavlink2 => look.mavlink.interval(out),
        _ => Ok(0),
    }
}

/// The `n`-th message that the port's protocols send once a second; `None` after the last.
pub(crate) fn each_second(
    n: usize,
    (decoded, raw): (Decoded, Raw),
    mode_ac: bool,
    look: &mut Look,
    context: &Context<'_>,
    statistics: &Statistics,
    out: &mut [u8],
) -> Option<Result<usize, Full>> {
    let Context { moment, gnss, .. } = context;
    Some(match (raw, decoded, n) {
        (Raw::Beast, _, 0) if look.beast == beast::Stamp::Gps => {
            let stream = radarcape::Stream {
                stamp: look.beast,
                filtered: look.filtered,
                mode_ac,
            };
            radarcape::status(&stream, &context.second_began, out)
        }
        (_, Decoded::Csbee, 0) => csbee::statistics(statistics, out),
        (_, Decoded::Mavlink1 | Decoded::Mavlink2, 0) => look.mavlink.heartbeat(out),
        (_, Decoded::Asterix, 0) => asterix::station_status(moment, look.asterix, out),
        (_, Decoded::Gdl90, 0) => gdl90::heartbeat(gnss, statistics, moment, out),
        (_, Decoded::Gdl90, 1) => {
            let device = gdl90::Device {
                serial: context.unique_id,
                name: "Squitter",
                long_name: "Squitter 1090",
            };
            gdl90::foreflight_id(&device, out)
        }
        (_, Decoded::Gdl90, 2) => gdl90::ownship(gnss, 0, out),
        (_, Decoded::Gdl90, 3) => gdl90::ownship_altitude(gnss, out),
        (_, Decoded::AeroJson, 0) if look.has(json::section::STATUS) => {
            json::status(context.source(), context.firmware, moment, out)
        }
        (_, Decoded::AeroJson, 1) if look.has(json::section::GNSS) => {
            json::gnss(context.source(), gnss, moment, out)
        }
        (_, Decoded::AeroJson, 0 | 1) => Ok(0),
        _ => return None,
    })
}

/// A line of statistics of reception and one of the device, each as set for a port.
pub(crate) fn statistics(
    adsb: AdsbStatistics,
    system: SystemStatistics,
    context: &Context<'_>,
    statistics: &Statistics,
    mut tell: impl FnMut(&[u8], Result<usize, Full>),
) {
    let (source, moment) = (context.source(), &context.moment);
    let mut out = [0; json::MAX_MESSAGE];
    let made = match system {
        SystemStatistics::None => Ok(0),
        SystemStatistics::Csv => aero::system_statistics(statistics, &mut out),
        SystemStatistics::Json => json::system_statistics(source, statistics, moment, &mut out),
    };
    tell(&out, made);
    let made = match adsb {
        AdsbStatistics::None => Ok(0),
        AdsbStatistics::Csv => aero::adsb_statistics(statistics, &mut out),
        AdsbStatistics::CsvSf1 => aero::sf1_statistics(statistics, &mut out),
        AdsbStatistics::Json => json::adsb_statistics(source, statistics, moment, &mut out),
    };
    tell(&out, made);
}

/// The GNSS receiver's fix, as set for a port.
pub(crate) fn gnss(
    protocol: GnssDecoded,
    context: &Context<'_>,
    out: &mut [u8],
) -> Result<usize, Full> {
    match protocol {
        GnssDecoded::None => Ok(0),
        GnssDecoded::Json => json::gnss(context.source(), context.gnss, &context.moment, out),
    }
}
