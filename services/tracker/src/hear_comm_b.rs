//! What a Comm-B reply changes in an aircraft, once `mode_s::infer` is sure which register it copies.
//!
//! | register | fields |
//! |---|---|
//! | 1,7 | which registers the next replies can copy |
//! | 2,0 | callsign |
//! | 3,0 | TCAS RA |
//! | 4,0 | selected altitudes, pressure setting, autopilot modes but LNAV |
//! | 4,4 | wind, temperature, static pressure, turbulence, humidity |
//! | 4,5 | turbulence, temperature, static pressure |
//! | 5,0 | roll, rate of turn, true airspeed; track and ground speed |
//! | 6,0 | magnetic heading, indicated airspeed, Mach; vertical rate |
//!
//! Track, ground speed and vertical rate are taken only from aircraft that send no squitters: those tell the same more often and finer.

use crate::aircraft::Aircraft;
use crate::field::Field;
use crate::flags::Flag;
use mode_s::bds::bds17::{ANNOUNCED, GicbCapability};
use mode_s::bds::bds40::SelectedVerticalIntention;
use mode_s::bds::bds50::TrackAndTurn;
use mode_s::bds::bds60::HeadingAndSpeed;
use mode_s::{AutopilotModes, MeBits, Register, infer};

/// How long squitters keep Comm-B out of the fields that both have, ms: twenty velocities.
const SQUITTERS_LIFE_MS: u32 = 10_000;

/// Registers of 1,7 that can be inferred, a bit each from bit 0, and bit 7: an announcement was heard. The others tell nothing here.
const KEPT: [u8; 6] = [0x20, 0x40, 0x44, 0x45, 0x50, 0x60];
const HEARD: u8 = 1 << 7;

impl Aircraft {
    /// Takes the MB field of a DF20 or DF21.
    pub(crate) fn hear_comm_b(&mut self, mb: MeBits, at_ms: u64) {
        match infer(mb, &self.known(at_ms)).found() {
            Some(Register::GicbCapability(told)) => {
                let bit = |(place, bds): (usize, &u8)| {
                    u8::from(told.registers().any(|told| told.0 == *bds)) << place
                };
                self.announced = HEARD | KEPT.iter().enumerate().map(bit).sum::<u8>();
            }
            Some(Register::AircraftIdentification(told)) => {
                if let Some(callsign) = told.callsign {
                    self.callsign = callsign;
                    self.tell(Field::Callsign, at_ms);
                }
            }
            Some(Register::AcasRa(ra)) => self.hear_ra(ra.is_active(), at_ms),
            Some(Register::SelectedVerticalIntention(told)) => self.hear_selected(&told, at_ms),
            Some(Register::MetRoutineReport(told)) => {
                if let Some(wind) = told.wind {
                    self.wind_speed_kt = wind.speed_kt;
                    self.wind_direction = wind.from;
                    self.tell(Field::Wind, at_ms);
                }
                self.hear_temperature(Some(told.temperature_quarters), at_ms);
                self.hear_static_pressure(told.pressure_hpa, at_ms);
                self.hear_turbulence(told.turbulence, at_ms);
                if let Some(parts) = told.humidity_64ths {
                    // Six bits of 64ths: 98 at most.
                    self.humidity = (u16::from(parts) * 100 / 64) as u8;
                    self.tell(Field::Humidity, at_ms);
                }
            }
            Some(Register::MetHazardReport(told)) => {
                self.hear_temperature(told.temperature_quarters, at_ms);
                self.hear_static_pressure(told.pressure_hpa, at_ms);
                self.hear_turbulence(told.turbulence, at_ms);
            }
            Some(Register::TrackAndTurn(told)) => self.hear_turn(&told, at_ms),
            Some(Register::HeadingAndSpeed(told)) => self.hear_heading_and_speed(&told, at_ms),
            Some(Register::DataLinkCapability(_)) | None => {}
        }
    }

    /// The registers that 1,7 has announced, as far as they were kept.
    pub(crate) fn announced(&self) -> Option<GicbCapability> {
        let kept = |bds: u8| KEPT.iter().position(|&one| one == bds);
        let is_announced =
            |bds: u8| kept(bds).is_some_and(|place| self.announced >> place & 1 != 0);
        (self.announced & HEARD != 0).then(|| {
            GicbCapability(
                ANNOUNCED
                    .iter()
                    .fold(0, |bits, bds| bits << 1 | u32::from(is_announced(bds.0))),
            )
        })
    }

    fn hear_selected(&mut self, told: &SelectedVerticalIntention, at_ms: u64) {
        if let Some(altitude) = told.mcp_altitude {
            self.hear_selected_mcp(altitude, at_ms);
        }
        if let Some(altitude) = told.fms_altitude {
            self.hear_selected_fms(altitude, at_ms);
        }
        if let Some(tenths) = told.pressure_setting_tenths {
            self.hear_pressure_setting(tenths, at_ms);
        }
        if let Some(modes) = told.modes {
            // What the register does not tell stays as a target state has told it, while that is fresh.
            let before = self.modes(at_ms);
            self.flags.set_modes(AutopilotModes {
                vnav: modes.vnav,
                altitude_hold: modes.altitude_hold,
                approach: modes.approach,
                autopilot: before.is_some_and(|modes| modes.autopilot),
                lnav: before.is_some_and(|modes| modes.lnav),
            });
            self.tell(Field::Modes, at_ms);
        }
    }

    fn hear_turn(&mut self, told: &TrackAndTurn, at_ms: u64) {
        if let Some(roll) = told.roll_centidegrees() {
            self.roll = roll;
            self.tell(Field::Roll, at_ms);
        }
        if let Some(rate) = told.track_rate_32nds {
            // 100 / 32 hundredths; the field's 1 024 steps are 32° a second.
            self.track_rate = (i32::from(rate) * 100 / 32) as i16;
            self.tell(Field::TrackRate, at_ms);
        }
        if let Some(knots) = told.true_airspeed_kt {
            self.hear_true_airspeed(knots, at_ms);
        }
        if self.direct_at.is_within(SQUITTERS_LIFE_MS, at_ms) {
            return;
        }
        if let Some(track) = told.track {
            self.track = track;
            self.tell(Field::Track, at_ms);
        }
        if let Some(knots) = told.ground_speed_kt {
            self.ground_speed_eighths = knots * 8;
            self.tell(Field::GroundSpeed, at_ms);
        }
    }

    fn hear_heading_and_speed(&mut self, told: &HeadingAndSpeed, at_ms: u64) {
        if let Some(heading) = told.heading {
            self.heading = heading;
            self.flags.set(Flag::HeadingIsMagnetic, true);
            self.tell(Field::Heading, at_ms);
        }
        if let Some(knots) = told.indicated_airspeed_kt {
            self.hear_indicated_airspeed(knots, at_ms);
        }
        if let Some(thousandths) = told.mach_thousandths {
            self.mach = thousandths;
            self.tell(Field::Mach, at_ms);
        }
        if self.direct_at.is_within(SQUITTERS_LIFE_MS, at_ms) {
            return;
        }
        let rate = told.baro_rate_fpm.or(told.inertial_rate_fpm);
        if let Some(feet_per_minute) = rate {
            self.hear_vertical_rate(feet_per_minute, told.baro_rate_fpm.is_some(), at_ms);
        }
    }

    fn hear_temperature(&mut self, quarters: Option<i16>, at_ms: u64) {
        if let Some(quarters) = quarters {
            self.temperature = quarters * 25;
            self.tell(Field::Temperature, at_ms);
        }
    }

    fn hear_static_pressure(&mut self, hpa: Option<u16>, at_ms: u64) {
        if let Some(hpa) = hpa {
            self.static_pressure = hpa;
            self.tell(Field::StaticPressure, at_ms);
        }
    }

    fn hear_turbulence(&mut self, turbulence: Option<u8>, at_ms: u64) {
        if let Some(turbulence) = turbulence {
            self.turbulence = turbulence;
            self.tell(Field::Turbulence, at_ms);
        }
    }
}
