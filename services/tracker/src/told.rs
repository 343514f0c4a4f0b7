//! What an aircraft tells: its fields as long as they are fresh.
//!
//! Callsign, category, squawk and whether it is on the ground are told as long as the aircraft is tracked; all else for
//! [`FIELD_LIFE_MS`](crate::FIELD_LIFE_MS).

use crate::aircraft::{Aircraft, PositionSource, SELECTED_UNIT_FT, unpacked};
use crate::counts::Counts;
use crate::field::{Field, Updated};
use crate::flags::Flag;
use crate::status::{Airframe, Status};
use mode_s::nic::nic;
use mode_s::quality::nucp;
use mode_s::{Address, AltitudeFt, AutopilotModes, Callsign, Category, CentiDegrees};
use mode_s::{EmergencyState, ModeACode, NicSupplements, Position, VerticalRate};

/// A wind that an aircraft has measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wind {
    /// Knots.
    pub speed_kt: u16,
    /// Where it comes from, true.
    pub direction: CentiDegrees,
}

impl Aircraft {
    /// A value while its field is fresh.
    fn told<T>(&self, field: Field, value: T, now_ms: u64) -> Option<T> {
        self.freshness.is_alive(field, now_ms).then_some(value)
    }

    /// The address, and whether it is an ICAO one.
    pub fn address(&self) -> Address {
        unpacked(self.packed_address)
    }

    /// Milliseconds since the last frame; 0 for one that is stamped a little ahead.
    pub fn silent_ms(&self, now_ms: u64) -> u32 {
        self.heard_at.age_ms(now_ms).unwrap_or(0)
    }

    /// Nanoseconds from the last PPS to the last frame.
    pub fn heard_after_pps_ns(&self) -> Option<u32> {
        self.heard_after_pps.checked_sub(1)
    }

    /// Milliseconds since a field was told, while it is known. What has no life of its own is at most 200 s old here.
    pub fn age_ms(&self, field: Field, now_ms: u64) -> Option<u32> {
        self.freshness.age_ms(field, now_ms)
    }

    /// The callsign, once heard.
    pub fn callsign(&self) -> Option<Callsign> {
        self.freshness
            .is_known(Field::Callsign)
            .then_some(self.callsign)
    }

    /// The emitter category, once heard.
    pub fn category(&self) -> Option<Category> {
        self.freshness
            .is_known(Field::Category)
            .then_some(self.category)
    }

    /// The Mode A code (squawk), once heard.
    pub fn squawk(&self) -> Option<ModeACode> {
        self.freshness
            .is_known(Field::Squawk)
            .then_some(self.squawk)
    }

    /// The confirmed position.
    pub fn position(&self, now_ms: u64) -> Option<Position> {
        self.places.shown(now_ms)
    }

    /// Where the confirmed position came from.
    pub fn position_source(&self, now_ms: u64) -> Option<PositionSource> {
        self.position(now_ms).map(|_| self.position_source)
    }

    /// Pressure altitude.
    pub fn baro_altitude(&self, now_ms: u64) -> Option<AltitudeFt> {
        self.told(Field::BaroAltitude, self.baro_altitude, now_ms)
    }

    /// Height above the ellipsoid: as sent, or pressure altitude and the difference of a velocity message together.
    pub fn gnss_altitude(&self, now_ms: u64) -> Option<AltitudeFt> {
        self.told(Field::GnssAltitude, self.gnss_altitude, now_ms)
    }

    /// Track over the ground. On the surface some aircraft send their heading instead.
    pub fn track(&self, now_ms: u64) -> Option<CentiDegrees> {
        self.told(Field::Track, self.track, now_ms)
    }

    /// Ground speed in eighths of a knot.
    pub fn ground_speed_eighths(&self, now_ms: u64) -> Option<u16> {
        self.told(Field::GroundSpeed, self.ground_speed_eighths, now_ms)
    }

    /// Heading: of aircraft that send no track, and of Comm-B replies (there magnetic).
    pub fn heading(&self, now_ms: u64) -> Option<CentiDegrees> {
        self.told(Field::Heading, self.heading, now_ms)
    }

    /// Whether the heading is from magnetic north, not from true north.
    pub fn heading_is_magnetic(&self) -> bool {
        self.flags.has(Flag::HeadingIsMagnetic)
    }

    /// Indicated airspeed, knots.
    pub fn indicated_airspeed_kt(&self, now_ms: u64) -> Option<u16> {
        self.told(Field::IndicatedAirspeed, self.indicated_airspeed_kt, now_ms)
    }

    /// True airspeed, knots.
    pub fn true_airspeed_kt(&self, now_ms: u64) -> Option<u16> {
        self.told(Field::TrueAirspeed, self.true_airspeed_kt, now_ms)
    }

    /// Mach number, thousandths.
    pub fn mach_thousandths(&self, now_ms: u64) -> Option<u16> {
        self.told(Field::Mach, self.mach, now_ms)
    }

    /// Vertical rate.
    pub fn vertical_rate(&self, now_ms: u64) -> Option<VerticalRate> {
        let rate = VerticalRate {
            feet_per_minute: self.vertical_rate_fpm,
            is_barometric: self.flags.has(Flag::RateIsBaro),
        };
        self.told(Field::VerticalRate, rate, now_ms)
    }

    /// Roll, hundredths of a degree, right wing down positive.
    pub fn roll_centidegrees(&self, now_ms: u64) -> Option<i16> {
        self.told(Field::Roll, self.roll, now_ms)
    }

    /// Rate of turn, hundredths of a degree a second, to the right positive.
    pub fn track_rate_centidegrees(&self, now_ms: u64) -> Option<i16> {
        self.told(Field::TrackRate, self.track_rate, now_ms)
    }

    /// Altitude selected on the mode control panel.
    pub fn selected_altitude_mcp(&self, now_ms: u64) -> Option<AltitudeFt> {
        let feet = AltitudeFt(i32::from(self.selected_mcp) * SELECTED_UNIT_FT);
        self.told(Field::SelectedMcp, feet, now_ms)
    }

    /// Altitude selected in the flight management system.
    pub fn selected_altitude_fms(&self, now_ms: u64) -> Option<AltitudeFt> {
        let feet = AltitudeFt(i32::from(self.selected_fms) * SELECTED_UNIT_FT);
        self.told(Field::SelectedFms, feet, now_ms)
    }

    /// Altimeter setting, tenths of a hectopascal.
    pub fn pressure_setting_tenths(&self, now_ms: u64) -> Option<u16> {
        self.told(Field::PressureSetting, self.pressure_setting, now_ms)
    }

    /// Selected heading.
    pub fn selected_heading(&self, now_ms: u64) -> Option<CentiDegrees> {
        self.told(Field::SelectedHeading, self.selected_heading, now_ms)
    }

    /// Autopilot modes.
    pub fn modes(&self, now_ms: u64) -> Option<AutopilotModes> {
        self.told(Field::Modes, self.flags.modes(), now_ms)
    }

    /// Wind.
    pub fn wind(&self, now_ms: u64) -> Option<Wind> {
        let wind = Wind {
            speed_kt: self.wind_speed_kt,
            direction: self.wind_direction,
        };
        self.told(Field::Wind, wind, now_ms)
    }

    /// Static air temperature, hundredths of a degree Celsius.
    pub fn temperature_centidegrees(&self, now_ms: u64) -> Option<i16> {
        self.told(Field::Temperature, self.temperature, now_ms)
    }

    /// Static pressure, hectopascals.
    pub fn static_pressure_hpa(&self, now_ms: u64) -> Option<u16> {
        self.told(Field::StaticPressure, self.static_pressure, now_ms)
    }

    /// Turbulence, 0 none to 3 severe.
    pub fn turbulence(&self, now_ms: u64) -> Option<u8> {
        self.told(Field::Turbulence, self.turbulence, now_ms)
    }

    /// Relative humidity, per cent.
    pub fn humidity_percent(&self, now_ms: u64) -> Option<u8> {
        self.told(Field::Humidity, self.humidity, now_ms)
    }

    /// Emergency state.
    pub fn emergency(&self, now_ms: u64) -> Option<EmergencyState> {
        self.told(Field::Emergency, self.emergency, now_ms)
    }

    /// Whether the aircraft is on the ground, where a frame has said so.
    pub fn on_ground(&self) -> Option<bool> {
        self.freshness
            .is_known(Field::OnGround)
            .then_some(self.flags.has(Flag::OnGround))
    }

    /// IDENT (SPI) is on.
    pub fn ident(&self, now_ms: u64) -> bool {
        self.told(Field::Ident, self.flags.has(Flag::Ident), now_ms) == Some(true)
    }

    /// An alert, permanent or temporary, is on.
    pub fn alert(&self, now_ms: u64) -> bool {
        self.told(Field::Alert, self.flags.has(Flag::Alert), now_ms) == Some(true)
    }

    /// It has sent a military squitter (DF19).
    pub fn is_military(&self) -> bool {
        self.flags.has(Flag::Military)
    }

    /// NIC of the last position message, by the version and the supplements as far as they are known.
    pub fn nic(&self, now_ms: u64) -> Option<u8> {
        let type_code = self.told(Field::Integrity, self.position_type_code, now_ms)?;
        let supplements = NicSupplements {
            b: self.flags.has(Flag::NicBOrSingleAntenna),
            ..self.nic_supplements(now_ms)
        };
        Some(nic(type_code, self.version, supplements))
    }

    /// NUCp of the last position message, as version 0 means its type code.
    pub fn nucp(&self, now_ms: u64) -> Option<u8> {
        self.told(Field::Integrity, nucp(self.position_type_code), now_ms)
    }

    /// NIC supplements A and C, as far as they are known; B comes with each position.
    pub fn nic_supplements(&self, now_ms: u64) -> NicSupplements {
        let status = self.status(now_ms).unwrap_or_default();
        NicSupplements {
            a: status.nic_a(),
            b: false,
            c: status.nic_c(),
        }
    }

    /// Version of ADS-B: 0 until an operational status tells it.
    pub fn version(&self) -> u8 {
        self.version
    }

    /// Quality and equipment, where a status message has told of them.
    pub fn status(&self, now_ms: u64) -> Option<Status> {
        self.told(Field::Status, self.status, now_ms)
    }

    /// Size and place of the antenna.
    pub fn airframe(&self) -> Airframe {
        self.airframe
    }

    /// One antenna alone: told by airborne positions before version 2, by the operational status from then on.
    pub fn single_antenna(&self, now_ms: u64) -> bool {
        if self.version < 2 {
            let bit_8 = self.flags.has(Flag::NicBOrSingleAntenna);
            self.told(Field::Integrity, bit_8, now_ms) == Some(true)
        } else {
            self.status(now_ms)
                .is_some_and(|status| status.single_antenna())
        }
    }

    /// A resolution advisory is active.
    pub fn tcas_ra(&self, now_ms: u64) -> bool {
        self.told(Field::TcasRa, self.flags.has(Flag::TcasRa), now_ms) == Some(true)
    }

    /// NACv of the last velocity message, or of an operational status on the surface.
    pub fn nacv(&self, now_ms: u64) -> Option<u8> {
        self.told(Field::Nacv, self.nacv, now_ms)
    }

    /// Fields updated in the last whole second.
    pub fn updated_last_second(&self) -> Updated {
        self.freshness.last_second()
    }

    /// Messages in the last whole second.
    pub fn counts_last_second(&self) -> Counts {
        self.counts_last_second
    }

    /// Mean level of the last second with a frame whose level is known, hundredths of a dBm.
    pub fn level_cdbm(&self) -> Option<i16> {
        self.signal.level_cdbm()
    }

    /// Mean level over the noise floor, hundredths of a dB.
    pub fn quality_cdb(&self) -> Option<i16> {
        self.signal.quality_cdb()
    }

    /// Whether a frame with exact parity has confirmed that the aircraft exists; until then two weak ones have agreed.
    pub fn is_confirmed(&self) -> bool {
        self.flags.has(Flag::Confirmed)
    }
}
