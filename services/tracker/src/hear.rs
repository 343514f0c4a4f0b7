//! What a message changes in an aircraft.
//!
//! | message | fields |
//! |---|---|
//! | DF0, 16 | on ground, pressure altitude |
//! | DF4, 20 | on ground, IDENT, alert, pressure altitude; what its register says (`hear_comm_b`) |
//! | DF5, 21 | on ground, IDENT, alert, Mode A code; what its register says |
//! | DF11, CA of DF17 | on ground |
//! | no position | pressure altitude |
//! | identification | callsign, category |
//! | surface position | on ground, ground speed, track, position, type code for NIC |
//! | airborne position | airborne, altitude of either kind, IDENT, alert, position, type code and bit 8 for NIC |
//! | velocity | ground speed and track, or airspeed and heading; vertical rate, GNSS-baro difference, NACv |
//! | DF19 | military |
//! | emergency status | emergency state, Mode A code |
//! | ACAS RA | TCAS RA |
//! | target state | selected altitude, heading and pressure setting, autopilot modes, status (NACp, SIL, NICbaro, TCAS); TCAS RA and emergency state in version 1 |
//! | operational status | version, status, NACv, airframe, TCAS RA, IDENT |
//!
//! A ground station's message about an aircraft (TIS-B, ADS-R: DF18 of CF 2, 5 and 6) counts as heard, but changes nothing while the aircraft's own
//! squitters are fresh: what the station tells is older, and where radar told it, less exact.

use crate::aircraft::{Aircraft, PositionSource};
use crate::counters::PositionOutcome;
use crate::field::Field;
use crate::flags::Flag;
use crate::place::Surroundings;
use crate::reach::Motion;
use crate::reference::References;
use crate::signal::Heard;
use crate::stamp::Stamp;
use mode_s::{AltitudeFt, Body, Cpr, FlightStatus, MeBits, Message, ModeACode, Origin, Parity};

/// Most time between pressure altitude and GNSS-baro difference that are added, ms. Within it a steep climb changes neither much.
const DIFFERENCE_LIFE_MS: u32 = 10_000;
/// How long speed and track limit where a position may have moved, ms. Later the aircraft may have others.
const MOTION_LIFE_MS: u32 = 10_000;
/// How long an aircraft's own squitters keep those of ground stations out, ms. It sends four a second in the air: when none is heard for so long, it is
/// out of range or behind a mountain, and the station sees it better.
const DIRECT_LIFE_MS: u32 = 20_000;

/// One frame of an aircraft.
pub(crate) struct Hearing<'a> {
    pub(crate) message: &'a Message,
    pub(crate) heard: Heard,
    pub(crate) references: &'a References,
}

/// Who tells what an extended squitter tells.
fn source(origin: Origin) -> PositionSource {
    match origin {
        Origin::Transponder(_) | Origin::Device | Origin::AnonymousDevice | Origin::Military => {
            PositionSource::Direct
        }
        Origin::Tisb | Origin::AnonymousTisb => PositionSource::Radar,
        Origin::Rebroadcast => PositionSource::Rebroadcast,
    }
}

impl Aircraft {
    /// Takes a message of this aircraft; tells what became of an encoded position in it.
    pub(crate) fn hear(&mut self, hearing: &Hearing<'_>) -> Option<PositionOutcome> {
        let Hearing { message, heard, .. } = hearing;
        let at_ms = heard.at_ms;
        self.heard_at = Stamp::at(at_ms);
        self.heard_after_pps = heard.since_pps_ns.map_or(0, |ns| ns + 1);
        self.signal.hear(heard);
        self.counts_now.hear_mode_s();
        if is_proof(message, heard) {
            self.flags.set(Flag::Confirmed, true);
        }
        match message.body {
            Body::AirAir {
                on_ground,
                altitude,
                ..
            } => {
                self.hear_ground(Some(on_ground), at_ms);
                self.hear_baro(altitude, at_ms);
            }
            Body::AltitudeReply {
                flight_status,
                altitude,
                mb,
                ..
            } => {
                self.hear_status(flight_status, at_ms);
                self.hear_baro(altitude, at_ms);
                self.hear_mb(mb, at_ms);
            }
            Body::IdentityReply {
                flight_status,
                squawk,
                mb,
                ..
            } => {
                self.hear_status(flight_status, at_ms);
                self.hear_squawk(squawk, at_ms);
                self.hear_mb(mb, at_ms);
            }
            Body::AllCallReply { capability } => self.hear_ground(capability.on_ground(), at_ms),
            Body::ExtendedSquitter { origin, ref me } => {
                self.flags.set(Flag::HasSquitters, true);
                if origin == Origin::Military {
                    self.flags.set(Flag::Military, true);
                }
                let source = source(origin);
                if source == PositionSource::Direct {
                    self.direct_at = Stamp::at(at_ms);
                } else if self.direct_at.is_within(DIRECT_LIFE_MS, at_ms) {
                    return None;
                }
                let capability = origin.capability();
                self.hear_ground(capability.and_then(|ca| ca.on_ground()), at_ms);
                let cpr = self.hear_me(me, at_ms)?;
                return Some(self.hear_position(cpr, source, hearing));
            }
            // Twelve bits of a coordinate are too coarse to be shown as a place.
            Body::CoarsePosition(_)
            | Body::Management { .. }
            | Body::Military { .. }
            | Body::CommD(_)
            | Body::NotDecoded => {}
        }
        None
    }

    fn hear_position(
        &mut self,
        cpr: Cpr,
        source: PositionSource,
        hearing: &Hearing<'_>,
    ) -> PositionOutcome {
        let at_ms = hearing.heard.at_ms;
        let is_fresh = |field| self.freshness.is_within(field, MOTION_LIFE_MS, at_ms);
        let around = Surroundings {
            motion: Motion {
                ground_speed_eighths: is_fresh(Field::GroundSpeed)
                    .then_some(self.ground_speed_eighths),
                track: is_fresh(Field::Track).then_some(self.track),
            },
            is_repaired: hearing.heard.is_repaired,
            references: hearing.references,
        };
        let outcome = self.places.offer(cpr, &around, at_ms);
        if outcome == PositionOutcome::Shown {
            self.position_source = source;
            self.tell(Field::Position, at_ms);
        }
        outcome
    }

    fn hear_mb(&mut self, mb: Option<MeBits>, at_ms: u64) {
        if let Some(mb) = mb {
            self.hear_comm_b(mb, at_ms);
        }
    }

    fn hear_status(&mut self, status: FlightStatus, at_ms: u64) {
        self.hear_ground(status.on_ground(), at_ms);
        if let Some(ident) = status.ident() {
            self.hear_ident(ident, at_ms);
        }
        if let Some(alert) = status.alert() {
            self.hear_alert(alert, at_ms);
        }
    }

    pub(crate) fn hear_ident(&mut self, ident: bool, at_ms: u64) {
        self.flags.set(Flag::Ident, ident);
        self.tell(Field::Ident, at_ms);
    }

    pub(crate) fn hear_alert(&mut self, alert: bool, at_ms: u64) {
        self.flags.set(Flag::Alert, alert);
        self.tell(Field::Alert, at_ms);
    }

    pub(crate) fn hear_squawk(&mut self, squawk: ModeACode, at_ms: u64) {
        self.squawk = squawk;
        self.tell(Field::Squawk, at_ms);
    }

    pub(crate) fn hear_ground(&mut self, on_ground: Option<bool>, at_ms: u64) {
        if let Some(on_ground) = on_ground {
            self.flags.set(Flag::OnGround, on_ground);
            self.tell(Field::OnGround, at_ms);
        }
    }

    pub(crate) fn hear_baro(&mut self, altitude: Option<AltitudeFt>, at_ms: u64) {
        if let Some(altitude) = altitude {
            self.baro_altitude = altitude;
            self.tell(Field::BaroAltitude, at_ms);
            self.add_difference(at_ms);
        }
    }

    pub(crate) fn hear_gnss(&mut self, altitude: AltitudeFt, at_ms: u64) {
        self.gnss_altitude = altitude;
        self.tell(Field::GnssAltitude, at_ms);
    }

    /// GNSS height from pressure altitude and difference, where both are recent.
    pub(crate) fn add_difference(&mut self, at_ms: u64) {
        let is_recent = |field| self.freshness.is_within(field, DIFFERENCE_LIFE_MS, at_ms);
        if is_recent(Field::BaroAltitude) && is_recent(Field::GnssMinusBaro) {
            let AltitudeFt(baro) = self.baro_altitude;
            self.hear_gnss(AltitudeFt(baro + i32::from(self.gnss_minus_baro_ft)), at_ms);
        }
    }
}

/// Whether a frame proves that its sender exists: its parity is exact, and no bit was repaired to make it so.
pub(crate) fn is_proof(message: &Message, heard: &Heard) -> bool {
    matches!(message.parity, Parity::Exact(_)) && !heard.is_repaired
}
