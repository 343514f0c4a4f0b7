//! What an extended squitter's ME field changes in an aircraft. The table is in `hear`.

use crate::aircraft::{Aircraft, SELECTED_UNIT_FT};
use crate::field::Field;
use crate::flags::Flag;
use mode_s::{AirbornePosition, AltitudeSource, Cpr, EmergencyState, HorizontalVelocity, Me};
use mode_s::{OperationalStatus, SelectionSource, SurfacePosition, TargetState, Velocity};

/// SS of an airborne position: SPI.
const SS_IDENT: u8 = 3;

impl Aircraft {
    /// Takes an ME field; gives the encoded position in it.
    pub(crate) fn hear_me(&mut self, me: &Me, at_ms: u64) -> Option<Cpr> {
        match me {
            Me::Identification(identification) => {
                self.category = identification.category;
                self.tell(Field::Category, at_ms);
                if let Some(callsign) = identification.callsign {
                    self.callsign = callsign;
                    self.tell(Field::Callsign, at_ms);
                }
            }
            Me::SurfacePosition(position) => {
                self.hear_surface(position, at_ms);
                return position.cpr;
            }
            Me::AirbornePosition(position) => {
                self.hear_airborne(position, at_ms);
                return position.cpr;
            }
            Me::NoPosition(position) => self.hear_baro(position.altitude, at_ms),
            Me::TisbVelocity(told) => self.hear_velocity(&told.velocity, at_ms),
            Me::Velocity(velocity) => self.hear_velocity(velocity, at_ms),
            Me::Emergency(emergency) => {
                self.hear_emergency(emergency.state, at_ms);
                if let Some(squawk) = emergency.squawk {
                    self.hear_squawk(squawk, at_ms);
                }
            }
            Me::AcasRa(ra) => self.hear_ra(ra.is_active(), at_ms),
            Me::TargetState(state) => self.hear_target(state, at_ms),
            Me::OperationalStatus(status) => self.hear_operational(status, at_ms),
            Me::NotDecoded { .. } => {}
        }
        None
    }

    fn hear_integrity(&mut self, type_code: u8, bit_8: bool, at_ms: u64) {
        self.position_type_code = type_code;
        self.flags.set(Flag::NicBOrSingleAntenna, bit_8);
        self.tell(Field::Integrity, at_ms);
    }

    fn hear_surface(&mut self, position: &SurfacePosition, at_ms: u64) {
        self.hear_ground(Some(true), at_ms);
        self.hear_integrity(position.type_code, false, at_ms);
        if let Some(speed) = position.ground_speed_eighths {
            self.ground_speed_eighths = speed;
            self.tell(Field::GroundSpeed, at_ms);
        }
        if let Some(track) = position.track {
            self.track = track;
            self.tell(Field::Track, at_ms);
        }
    }

    fn hear_airborne(&mut self, position: &AirbornePosition, at_ms: u64) {
        self.hear_ground(Some(false), at_ms);
        let bit_8 = position.nic_b_or_single_antenna;
        self.hear_integrity(position.type_code, bit_8, at_ms);
        let status = position.surveillance_status;
        self.hear_ident(status == SS_IDENT, at_ms);
        self.hear_alert(matches!(status, 1 | 2), at_ms);
        match position.altitude.map(|a| (a.source, a.altitude)) {
            Some((AltitudeSource::Barometric, altitude)) => self.hear_baro(Some(altitude), at_ms),
            Some((AltitudeSource::Gnss, altitude)) => self.hear_gnss(altitude, at_ms),
            None => {}
        }
    }

    fn hear_velocity(&mut self, velocity: &Velocity, at_ms: u64) {
        self.hear_nacv(velocity.nacv, at_ms);
        match velocity.horizontal {
            Some(HorizontalVelocity::Ground { speed_kt, track }) => {
                self.ground_speed_eighths = speed_kt * 8;
                self.tell(Field::GroundSpeed, at_ms);
                if let Some(track) = track {
                    self.track = track;
                    self.tell(Field::Track, at_ms);
                }
            }
            Some(HorizontalVelocity::Air { heading, airspeed }) => {
                if let Some(heading) = heading {
                    self.heading = heading;
                    // HRD says it from version 1 on; in version 0 headings are magnetic.
                    let hrd = self.status(at_ms).map(|status| status.magnetic_heading());
                    let is_magnetic = self.version == 0 || hrd == Some(true);
                    self.flags.set(Flag::HeadingIsMagnetic, is_magnetic);
                    self.tell(Field::Heading, at_ms);
                }
                match airspeed.map(|speed| (speed.is_true, speed.knots)) {
                    Some((true, knots)) => self.hear_true_airspeed(knots, at_ms),
                    Some((false, knots)) => self.hear_indicated_airspeed(knots, at_ms),
                    None => {}
                }
            }
            None => {}
        }
        if let Some(rate) = velocity.vertical_rate {
            self.hear_vertical_rate(rate.feet_per_minute, rate.is_barometric, at_ms);
        }
        if let Some(difference) = velocity.gnss_minus_baro_ft {
            self.gnss_minus_baro_ft = difference;
            self.tell(Field::GnssMinusBaro, at_ms);
            self.add_difference(at_ms);
        }
    }

    fn hear_target(&mut self, state: &TargetState, at_ms: u64) {
        let mut status = self.status(at_ms).unwrap_or_default();
        status.hear_target(state);
        self.status = status;
        self.tell(Field::Status, at_ms);
        if let Some(selected) = state.selected_altitude {
            match selected.source {
                SelectionSource::Mcp => self.hear_selected_mcp(selected.altitude, at_ms),
                SelectionSource::Fms => self.hear_selected_fms(selected.altitude, at_ms),
                // The altitude held is the one flown, not one selected.
                SelectionSource::Held => {}
            }
        }
        if let Some(tenths) = state.pressure_setting_tenths {
            self.hear_pressure_setting(tenths, at_ms);
        }
        if let Some(heading) = state.selected_heading {
            self.selected_heading = heading;
            self.tell(Field::SelectedHeading, at_ms);
        }
        if let Some(modes) = state.modes {
            self.flags.set_modes(modes);
            self.tell(Field::Modes, at_ms);
        }
        if let Some(active) = state.tcas_ra {
            self.hear_ra(active, at_ms);
        }
        if let Some(emergency) = state.emergency {
            self.hear_emergency(emergency, at_ms);
        }
    }

    fn hear_operational(&mut self, told: &OperationalStatus, at_ms: u64) {
        self.version = told.version;
        let mut status = self.status(at_ms).unwrap_or_default();
        status.hear_operational(told);
        self.status = status;
        self.tell(Field::Status, at_ms);
        self.airframe.hear_operational(told);
        if let Some(nacv) = told.nac_v {
            self.hear_nacv(nacv, at_ms);
        }
        if let Some(active) = told.tcas_ra {
            self.hear_ra(active, at_ms);
        }
        if let Some(ident) = told.ident {
            self.hear_ident(ident, at_ms);
        }
    }

    fn hear_emergency(&mut self, state: EmergencyState, at_ms: u64) {
        self.emergency = state;
        self.tell(Field::Emergency, at_ms);
    }

    fn hear_nacv(&mut self, nacv: u8, at_ms: u64) {
        self.nacv = nacv;
        self.tell(Field::Nacv, at_ms);
    }

    pub(crate) fn hear_vertical_rate(
        &mut self,
        feet_per_minute: i16,
        is_barometric: bool,
        at_ms: u64,
    ) {
        self.vertical_rate_fpm = feet_per_minute;
        self.flags.set(Flag::RateIsBaro, is_barometric);
        self.tell(Field::VerticalRate, at_ms);
    }

    pub(crate) fn hear_ra(&mut self, active: bool, at_ms: u64) {
        self.flags.set(Flag::TcasRa, active);
        self.tell(Field::TcasRa, at_ms);
    }

    pub(crate) fn hear_true_airspeed(&mut self, knots: u16, at_ms: u64) {
        self.true_airspeed_kt = knots;
        self.tell(Field::TrueAirspeed, at_ms);
    }

    pub(crate) fn hear_indicated_airspeed(&mut self, knots: u16, at_ms: u64) {
        self.indicated_airspeed_kt = knots;
        self.tell(Field::IndicatedAirspeed, at_ms);
    }

    pub(crate) fn hear_selected_mcp(&mut self, altitude: mode_s::AltitudeFt, at_ms: u64) {
        self.selected_mcp = (altitude.0 / SELECTED_UNIT_FT) as i16;
        self.tell(Field::SelectedMcp, at_ms);
    }

    pub(crate) fn hear_selected_fms(&mut self, altitude: mode_s::AltitudeFt, at_ms: u64) {
        self.selected_fms = (altitude.0 / SELECTED_UNIT_FT) as i16;
        self.tell(Field::SelectedFms, at_ms);
    }

    pub(crate) fn hear_pressure_setting(&mut self, tenths: u16, at_ms: u64) {
        self.pressure_setting = tenths;
        self.tell(Field::PressureSetting, at_ms);
    }
}
