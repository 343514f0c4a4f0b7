//! What a message changes in an aircraft.
//!
//! | message | fields |
//! |---|---|
//! | DF0, 16 | on ground, pressure altitude |
//! | DF4, 20 | on ground, IDENT, alert, pressure altitude |
//! | DF5, 21 | on ground, IDENT, alert, Mode A code |
//! | DF11, CA of DF17 | on ground |
//! | no position | pressure altitude |
//! | identification | callsign, category |
//! | surface position | on ground, ground speed, track, position, type code for NIC |
//! | airborne position | airborne, altitude of either kind, IDENT, alert, position, type code and bit 8 for NIC |
//! | velocity | ground speed and track, or airspeed and heading; vertical rate, GNSS-baro difference, NACv |
//! | emergency status | Mode A code |
//! | ACAS RA | TCAS RA |
//! | target state | status (NACp, SIL, NICbaro, TCAS), TCAS RA in version 1 |
//! | operational status | version, status, NACv, airframe, TCAS RA, IDENT |

use crate::aircraft::{Aircraft, Integrity, Updated};
use crate::counters::PositionOutcome;
use crate::place::{KnownPlaces, Surroundings};
use mode_s::{
    AirbornePosition, AltitudeFt, AltitudeSource, Body, Cpr, FlightStatus, HorizontalVelocity, Me,
    Message, OperationalStatus, SurfacePosition, TargetState, Velocity,
};

/// Most time between pressure altitude and GNSS-baro difference that are added, ms. Within it a steep climb changes neither much.
const DIFFERENCE_LIFE_MS: u32 = 10_000;
/// SS of an airborne position: SPI.
const SS_IDENT: u8 = 3;

impl Aircraft {
    /// Takes a message of this aircraft; tells what became of an encoded position in it.
    pub(crate) fn hear(
        &mut self,
        message: &Message,
        known: &KnownPlaces,
        at_ms: u64,
    ) -> Option<PositionOutcome> {
        self.last_heard_ms = at_ms as u32;
        self.frames_now = self.frames_now.saturating_add(1);
        match message.body {
            Body::AirAir {
                on_ground,
                altitude,
                ..
            } => {
                self.on_ground.set(on_ground, at_ms);
                self.hear_baro(altitude, at_ms);
            }
            Body::AltitudeReply {
                flight_status,
                altitude,
                ..
            } => {
                self.hear_status(flight_status, at_ms);
                self.hear_baro(altitude, at_ms);
            }
            Body::IdentityReply {
                flight_status,
                squawk,
                ..
            } => {
                self.hear_status(flight_status, at_ms);
                self.squawk.set(squawk, at_ms);
            }
            Body::AllCallReply { capability } => self.hear_ground(capability.on_ground(), at_ms),
            Body::ExtendedSquitter { origin, me } => {
                let capability = origin.capability();
                self.hear_ground(capability.and_then(|ca| ca.on_ground()), at_ms);
                return self.hear_me(&me, known, at_ms);
            }
            Body::CoarsePosition(_)
            | Body::Management { .. }
            | Body::Military { .. }
            | Body::CommD(_)
            | Body::NotDecoded => {}
        }
        None
    }

    fn hear_me(&mut self, me: &Me, known: &KnownPlaces, at_ms: u64) -> Option<PositionOutcome> {
        match me {
            Me::NoPosition(position) => {
                self.hear_baro(position.altitude, at_ms);
                None
            }
            Me::Identification(identification) => {
                self.category.set(identification.category, at_ms);
                if let Some(callsign) = identification.callsign {
                    self.callsign.set(callsign, at_ms);
                }
                None
            }
            Me::SurfacePosition(position) => {
                self.hear_surface(position, at_ms);
                self.hear_position(position.cpr?, known, at_ms)
            }
            Me::AirbornePosition(position) => {
                self.hear_airborne(position, at_ms);
                self.hear_position(position.cpr?, known, at_ms)
            }
            Me::Velocity(velocity) => {
                self.hear_velocity(velocity, at_ms);
                None
            }
            Me::TisbVelocity(told) => {
                self.hear_velocity(&told.velocity, at_ms);
                None
            }
            Me::Emergency(emergency) => {
                if let Some(squawk) = emergency.squawk {
                    self.squawk.set(squawk, at_ms);
                }
                None
            }
            Me::AcasRa(ra) => {
                self.tcas_ra.set(ra.is_active(), at_ms);
                None
            }
            Me::TargetState(state) => {
                self.hear_target(state, at_ms);
                None
            }
            Me::OperationalStatus(status) => {
                self.hear_operational(status, at_ms);
                None
            }
            Me::NotDecoded { .. } => None,
        }
    }

    fn hear_surface(&mut self, position: &SurfacePosition, at_ms: u64) {
        self.on_ground.set(true, at_ms);
        let integrity = Integrity {
            type_code: position.type_code,
            nic_b_or_single_antenna: false,
        };
        self.integrity.set(integrity, at_ms);
        if let Some(speed) = position.ground_speed_eighths {
            self.ground_speed.set(speed, at_ms);
            self.updated_now.mark(Updated::HORIZONTAL_VELOCITY);
        }
        if let Some(track) = position.track {
            self.track.set(track, at_ms);
            self.updated_now.mark(Updated::TRACK);
        }
    }

    fn hear_airborne(&mut self, position: &AirbornePosition, at_ms: u64) {
        self.on_ground.set(false, at_ms);
        let integrity = Integrity {
            type_code: position.type_code,
            nic_b_or_single_antenna: position.nic_b_or_single_antenna,
        };
        self.integrity.set(integrity, at_ms);
        let status = position.surveillance_status;
        self.ident.set(status == SS_IDENT, at_ms);
        self.alert.set(matches!(status, 1 | 2), at_ms);
        match position.altitude.map(|a| (a.source, a.altitude)) {
            Some((AltitudeSource::Barometric, altitude)) => self.hear_baro(Some(altitude), at_ms),
            Some((AltitudeSource::Gnss, altitude)) => self.hear_gnss(altitude, at_ms),
            None => {}
        }
    }

    fn hear_velocity(&mut self, velocity: &Velocity, at_ms: u64) {
        self.nacv.set(velocity.nacv, at_ms);
        match velocity.horizontal {
            Some(HorizontalVelocity::Ground { speed_kt, track }) => {
                self.ground_speed.set(speed_kt * 8, at_ms);
                self.updated_now.mark(Updated::HORIZONTAL_VELOCITY);
                if let Some(track) = track {
                    self.track.set(track, at_ms);
                    self.updated_now.mark(Updated::TRACK);
                }
            }
            Some(HorizontalVelocity::Air { heading, airspeed }) => {
                if let Some(heading) = heading {
                    self.heading.set(heading, at_ms);
                }
                if let Some(airspeed) = airspeed {
                    self.airspeed.set(airspeed, at_ms);
                }
            }
            None => {}
        }
        if let Some(rate) = velocity.vertical_rate {
            self.vertical_rate.set(rate, at_ms);
            self.updated_now.mark(Updated::VERTICAL_VELOCITY);
        }
        if let Some(difference) = velocity.gnss_minus_baro_ft {
            self.gnss_minus_baro.set(difference, at_ms);
            self.add_difference(at_ms);
        }
    }

    fn hear_target(&mut self, state: &TargetState, at_ms: u64) {
        let mut status = self.status(at_ms).unwrap_or_default();
        status.hear_target(state);
        self.status.set(status, at_ms);
        if let Some(active) = state.tcas_ra {
            self.tcas_ra.set(active, at_ms);
        }
    }

    fn hear_operational(&mut self, told: &OperationalStatus, at_ms: u64) {
        self.version = told.version;
        let mut status = self.status(at_ms).unwrap_or_default();
        status.hear_operational(told);
        self.status.set(status, at_ms);
        self.airframe.hear_operational(told);
        if let Some(nacv) = told.nac_v {
            self.nacv.set(nacv, at_ms);
        }
        if let Some(active) = told.tcas_ra {
            self.tcas_ra.set(active, at_ms);
        }
        if let Some(ident) = told.ident {
            self.ident.set(ident, at_ms);
        }
    }

    fn hear_position(
        &mut self,
        cpr: Cpr,
        known: &KnownPlaces,
        at_ms: u64,
    ) -> Option<PositionOutcome> {
        let around = Surroundings {
            ground_speed_eighths: self.ground_speed_eighths(at_ms),
            known,
        };
        let outcome = self.places.offer(cpr, &around, at_ms);
        if outcome == PositionOutcome::Shown {
            self.updated_now.mark(Updated::POSITION);
        }
        Some(outcome)
    }

    fn hear_status(&mut self, status: FlightStatus, at_ms: u64) {
        self.hear_ground(status.on_ground(), at_ms);
        if let Some(ident) = status.ident() {
            self.ident.set(ident, at_ms);
        }
        if let Some(alert) = status.alert() {
            self.alert.set(alert, at_ms);
        }
    }

    fn hear_ground(&mut self, on_ground: Option<bool>, at_ms: u64) {
        if let Some(on_ground) = on_ground {
            self.on_ground.set(on_ground, at_ms);
        }
    }

    fn hear_baro(&mut self, altitude: Option<AltitudeFt>, at_ms: u64) {
        if let Some(altitude) = altitude {
            self.baro_altitude.set(altitude, at_ms);
            self.updated_now.mark(Updated::BARO_ALTITUDE);
            self.add_difference(at_ms);
        }
    }

    fn hear_gnss(&mut self, altitude: AltitudeFt, at_ms: u64) {
        self.gnss_altitude.set(altitude, at_ms);
        self.updated_now.mark(Updated::GNSS_ALTITUDE);
    }

    /// GNSS height from pressure altitude and difference, where both are recent.
    fn add_difference(&mut self, at_ms: u64) {
        let baro = self.baro_altitude.within(DIFFERENCE_LIFE_MS, at_ms);
        let difference = self.gnss_minus_baro.within(DIFFERENCE_LIFE_MS, at_ms);
        if let (Some(AltitudeFt(baro)), Some(difference)) = (baro, difference) {
            self.hear_gnss(AltitudeFt(baro + i32::from(difference)), at_ms);
        }
    }
}
