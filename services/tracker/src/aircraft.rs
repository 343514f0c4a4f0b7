//! One tracked aircraft: its fields, each with its time.

use crate::field::{Field, age_ms};
use crate::place::Places;
use crate::status::{Airframe, Status};
use mode_s::nic::nic;
use mode_s::{Address, Airspeed, AltitudeFt, Callsign, Category, CentiDegrees, Icao};
use mode_s::{ModeACode, NicSupplements, Position, VerticalRate};

/// How long a position, an altitude or a velocity is still told after its last update, ms. As long as the aircraft itself.
pub const FIELD_LIFE_MS: u32 = 60_000;

/// Fields updated within an interval, a bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Updated(u8);

impl Updated {
    /// Barometric altitude.
    pub const BARO_ALTITUDE: Updated = Updated(1 << 0);
    /// GNSS height.
    pub const GNSS_ALTITUDE: Updated = Updated(1 << 1);
    /// Position.
    pub const POSITION: Updated = Updated(1 << 2);
    /// Track.
    pub const TRACK: Updated = Updated(1 << 3);
    /// Ground speed.
    pub const HORIZONTAL_VELOCITY: Updated = Updated(1 << 4);
    /// Vertical rate.
    pub const VERTICAL_VELOCITY: Updated = Updated(1 << 5);

    /// The six bits, bit 0 barometric altitude to bit 5 vertical velocity.
    pub const fn bits(self) -> u8 {
        self.0
    }

    /// Whether all of `other` are among these.
    pub const fn contains(self, other: Updated) -> bool {
        self.0 & other.0 == other.0
    }

    pub(crate) fn mark(&mut self, other: Updated) {
        self.0 |= other.0;
    }
}

/// What the last position message says of its own integrity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Integrity {
    pub(crate) type_code: u8,
    /// Bit 8 of an airborne position; `false` on the surface.
    pub(crate) nic_b_or_single_antenna: bool,
}

/// A tracked aircraft.
#[derive(Clone, Copy, Debug)]
pub struct Aircraft {
    pub(crate) address: Address,
    pub(crate) last_heard_ms: u32,
    pub(crate) callsign: Field<Callsign>,
    pub(crate) category: Field<Category>,
    pub(crate) squawk: Field<ModeACode>,
    pub(crate) baro_altitude: Field<AltitudeFt>,
    pub(crate) gnss_altitude: Field<AltitudeFt>,
    pub(crate) gnss_minus_baro: Field<i16>,
    pub(crate) track: Field<CentiDegrees>,
    pub(crate) ground_speed: Field<u16>,
    pub(crate) heading: Field<CentiDegrees>,
    pub(crate) airspeed: Field<Airspeed>,
    pub(crate) vertical_rate: Field<VerticalRate>,
    pub(crate) on_ground: Field<bool>,
    pub(crate) ident: Field<bool>,
    pub(crate) alert: Field<bool>,
    pub(crate) integrity: Field<Integrity>,
    pub(crate) nacv: Field<u8>,
    pub(crate) status: Field<Status>,
    pub(crate) tcas_ra: Field<bool>,
    pub(crate) airframe: Airframe,
    pub(crate) version: u8,
    pub(crate) places: Places,
    pub(crate) updated_now: Updated,
    pub(crate) updated_last_second: Updated,
    pub(crate) frames_now: u16,
    pub(crate) frames_last_second: u16,
}

impl Aircraft {
    /// The blank of which every place in a table is made. All bits zero, so that a static table costs no flash.
    pub(crate) const BLANK: Aircraft = Aircraft {
        address: Address::Icao(Icao(0)),
        last_heard_ms: 0,
        callsign: Field::unknown(Callsign::NUL),
        category: Field::unknown(Category {
            type_code: 0,
            ca: 0,
        }),
        squawk: Field::unknown(ModeACode(0)),
        baro_altitude: Field::unknown(AltitudeFt(0)),
        gnss_altitude: Field::unknown(AltitudeFt(0)),
        gnss_minus_baro: Field::unknown(0),
        track: Field::unknown(CentiDegrees(0)),
        ground_speed: Field::unknown(0),
        heading: Field::unknown(CentiDegrees(0)),
        airspeed: Field::unknown(Airspeed {
            knots: 0,
            is_true: false,
        }),
        vertical_rate: Field::unknown(VerticalRate {
            feet_per_minute: 0,
            is_barometric: false,
        }),
        on_ground: Field::unknown(false),
        ident: Field::unknown(false),
        alert: Field::unknown(false),
        integrity: Field::unknown(Integrity {
            type_code: 0,
            nic_b_or_single_antenna: false,
        }),
        nacv: Field::unknown(0),
        status: Field::unknown(Status::NONE),
        tcas_ra: Field::unknown(false),
        airframe: Airframe::NONE,
        version: 0,
        places: Places::NONE,
        updated_now: Updated(0),
        updated_last_second: Updated(0),
        frames_now: 0,
        frames_last_second: 0,
    };

    pub(crate) fn new(address: Address, at_ms: u64) -> Self {
        Aircraft {
            address,
            last_heard_ms: at_ms as u32,
            ..Aircraft::BLANK
        }
    }

    /// The address, and whether it is an ICAO one.
    pub fn address(&self) -> Address {
        self.address
    }

    /// Milliseconds since the last frame.
    pub fn silent_ms(&self, now_ms: u64) -> u32 {
        age_ms(self.last_heard_ms, now_ms)
    }

    /// The callsign, once heard.
    pub fn callsign(&self) -> Option<Callsign> {
        self.callsign.last()
    }

    /// The emitter category, once heard.
    pub fn category(&self) -> Option<Category> {
        self.category.last()
    }

    /// The Mode A code (squawk), once heard.
    pub fn squawk(&self) -> Option<ModeACode> {
        self.squawk.last()
    }

    /// The confirmed position.
    pub fn position(&self, now_ms: u64) -> Option<Position> {
        self.places.shown(now_ms)
    }

    /// Pressure altitude.
    pub fn baro_altitude(&self, now_ms: u64) -> Option<AltitudeFt> {
        self.baro_altitude.within(FIELD_LIFE_MS, now_ms)
    }

    /// Height above the ellipsoid: as sent, or pressure altitude and the difference of a velocity message together.
    pub fn gnss_altitude(&self, now_ms: u64) -> Option<AltitudeFt> {
        self.gnss_altitude.within(FIELD_LIFE_MS, now_ms)
    }

    /// Track over the ground. On the surface some aircraft send their heading instead.
    pub fn track(&self, now_ms: u64) -> Option<CentiDegrees> {
        self.track.within(FIELD_LIFE_MS, now_ms)
    }

    /// Ground speed in eighths of a knot.
    pub fn ground_speed_eighths(&self, now_ms: u64) -> Option<u16> {
        self.ground_speed.within(FIELD_LIFE_MS, now_ms)
    }

    /// Heading, of aircraft that send no track.
    pub fn heading(&self, now_ms: u64) -> Option<CentiDegrees> {
        self.heading.within(FIELD_LIFE_MS, now_ms)
    }

    /// Airspeed, of aircraft that send no ground speed.
    pub fn airspeed(&self, now_ms: u64) -> Option<Airspeed> {
        self.airspeed.within(FIELD_LIFE_MS, now_ms)
    }

    /// Vertical rate.
    pub fn vertical_rate(&self, now_ms: u64) -> Option<VerticalRate> {
        self.vertical_rate.within(FIELD_LIFE_MS, now_ms)
    }

    /// Whether the aircraft is on the ground, where a frame has said so.
    pub fn on_ground(&self) -> Option<bool> {
        self.on_ground.last()
    }

    /// IDENT (SPI) is on.
    pub fn ident(&self, now_ms: u64) -> bool {
        self.ident.within(FIELD_LIFE_MS, now_ms) == Some(true)
    }

    /// An alert, permanent or temporary, is on.
    pub fn alert(&self, now_ms: u64) -> bool {
        self.alert.within(FIELD_LIFE_MS, now_ms) == Some(true)
    }

    /// NIC of the last position message, by the version and the supplements as far as they are known.
    pub fn nic(&self, now_ms: u64) -> Option<u8> {
        let position = self.integrity.within(FIELD_LIFE_MS, now_ms)?;
        let supplements = NicSupplements {
            b: position.nic_b_or_single_antenna,
            ..self.nic_supplements(now_ms)
        };
        Some(nic(position.type_code, self.version, supplements))
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
        self.status.within(FIELD_LIFE_MS, now_ms)
    }

    /// Size and place of the antenna.
    pub fn airframe(&self) -> Airframe {
        self.airframe
    }

    /// One antenna alone: told by airborne positions before version 2, by the operational status from then on.
    pub fn single_antenna(&self, now_ms: u64) -> bool {
        if self.version < 2 {
            let position = self.integrity.within(FIELD_LIFE_MS, now_ms);
            position.is_some_and(|position| position.nic_b_or_single_antenna)
        } else {
            self.status(now_ms)
                .is_some_and(|status| status.single_antenna())
        }
    }

    /// A resolution advisory is active.
    pub fn tcas_ra(&self, now_ms: u64) -> bool {
        self.tcas_ra.within(FIELD_LIFE_MS, now_ms) == Some(true)
    }

    /// NACv of the last velocity message, or of an operational status on the surface.
    pub fn nacv(&self, now_ms: u64) -> Option<u8> {
        self.nacv.within(FIELD_LIFE_MS, now_ms)
    }

    /// Fields updated in the last whole second.
    pub fn updated_last_second(&self) -> Updated {
        self.updated_last_second
    }

    /// Mode S frames in the last whole second.
    pub fn frames_last_second(&self) -> u16 {
        self.frames_last_second
    }

    pub(crate) fn second_ends(&mut self, now_ms: u64) {
        self.baro_altitude.expire(FIELD_LIFE_MS, now_ms);
        self.gnss_altitude.expire(FIELD_LIFE_MS, now_ms);
        self.gnss_minus_baro.expire(FIELD_LIFE_MS, now_ms);
        self.track.expire(FIELD_LIFE_MS, now_ms);
        self.ground_speed.expire(FIELD_LIFE_MS, now_ms);
        self.heading.expire(FIELD_LIFE_MS, now_ms);
        self.airspeed.expire(FIELD_LIFE_MS, now_ms);
        self.vertical_rate.expire(FIELD_LIFE_MS, now_ms);
        self.ident.expire(FIELD_LIFE_MS, now_ms);
        self.alert.expire(FIELD_LIFE_MS, now_ms);
        self.integrity.expire(FIELD_LIFE_MS, now_ms);
        self.nacv.expire(FIELD_LIFE_MS, now_ms);
        self.status.expire(FIELD_LIFE_MS, now_ms);
        self.tcas_ra.expire(FIELD_LIFE_MS, now_ms);
        self.places.second_ends(now_ms);
        self.updated_last_second = core::mem::take(&mut self.updated_now);
        self.frames_last_second = core::mem::take(&mut self.frames_now);
    }
}
