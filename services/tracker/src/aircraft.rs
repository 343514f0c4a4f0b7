//! One tracked aircraft: its values, packed, and the time of each.
//!
//! What it is not: it does not say what a message changes (`hear`, `hear_me`), nor how a value is told (`told`). A value means something only
//! while its [`Field`] is alive in `freshness`.
//!
//! Budget: 240 bytes; 232 are taken, which leaves room for the rest of the tracker within its 96 KiB. Asserted below.

use crate::counts::Counts;
use crate::field::{Field, Freshness};
use crate::flags::{Flag, Flags};
use crate::place::Places;
use crate::signal::Signal;
use crate::stamp::Stamp;
use crate::status::{Airframe, Status};
use mode_s::ModeACode;
use mode_s::{Address, AltitudeFt, Callsign, Category, CentiDegrees, EmergencyState, Icao};

/// Bytes of an aircraft, at most.
const MOST_BYTES: usize = 232;
const _: () = assert!(size_of::<Aircraft>() <= MOST_BYTES);

/// Unit of stored selected altitudes, feet.
pub(crate) const SELECTED_UNIT_FT: i32 = 4;

/// How the aircraft's own position came last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PositionSource {
    /// From its own transmitter.
    Direct,
    /// Its own position, sent again by a ground station from another link (ADS-R).
    Rebroadcast,
    /// What a ground station's radar says (TIS-B).
    Radar,
}

/// A tracked aircraft.
#[derive(Clone, Copy, Debug)]
pub struct Aircraft {
    /// Packed: see `packed`.
    pub(crate) packed_address: u32,
    pub(crate) heard_at: Stamp,
    /// Nanoseconds from the last PPS to the same frame, and one more: 0 is unknown.
    pub(crate) heard_after_pps: u32,
    pub(crate) freshness: Freshness,
    pub(crate) places: Places,
    pub(crate) signal: Signal,
    pub(crate) counts_now: Counts,
    pub(crate) counts_last_second: Counts,
    pub(crate) baro_altitude: AltitudeFt,
    pub(crate) gnss_altitude: AltitudeFt,
    pub(crate) status: Status,
    pub(crate) callsign: Callsign,
    /// Its own last extended squitter.
    pub(crate) direct_at: Stamp,
    pub(crate) squawk: ModeACode,
    pub(crate) gnss_minus_baro_ft: i16,
    pub(crate) track: CentiDegrees,
    pub(crate) ground_speed_eighths: u16,
    pub(crate) heading: CentiDegrees,
    pub(crate) indicated_airspeed_kt: u16,
    pub(crate) true_airspeed_kt: u16,
    /// Thousandths.
    pub(crate) mach: u16,
    pub(crate) vertical_rate_fpm: i16,
    /// Hundredths of a degree, right wing down positive.
    pub(crate) roll: i16,
    /// Hundredths of a degree a second, to the right positive.
    pub(crate) track_rate: i16,
    /// Tenths of a hectopascal.
    pub(crate) pressure_setting: u16,
    pub(crate) selected_heading: CentiDegrees,
    /// Units of four feet, of which all steps of selected altitudes are multiples.
    pub(crate) selected_mcp: i16,
    /// The same.
    pub(crate) selected_fms: i16,
    pub(crate) wind_speed_kt: u16,
    pub(crate) wind_direction: CentiDegrees,
    /// Hundredths of a degree Celsius.
    pub(crate) temperature: i16,
    /// Hectopascals.
    pub(crate) static_pressure: u16,
    pub(crate) airframe: Airframe,
    pub(crate) category: Category,
    /// 0 none to 3 severe.
    pub(crate) turbulence: u8,
    /// Per cent.
    pub(crate) humidity: u8,
    /// Registers that the aircraft fills: see `hear_comm_b`.
    pub(crate) announced: u8,
    pub(crate) emergency: EmergencyState,
    pub(crate) nacv: u8,
    pub(crate) version: u8,
    pub(crate) position_type_code: u8,
    pub(crate) position_source: PositionSource,
    pub(crate) flags: Flags,
}

impl Aircraft {
    /// The blank of which every place in a table is made. All bits zero, so that a static table costs no flash.
    pub(crate) const BLANK: Aircraft = Aircraft {
        packed_address: 0,
        heard_at: Stamp::NEVER,
        heard_after_pps: 0,
        freshness: Freshness::NONE,
        places: Places::NONE,
        signal: Signal::NONE,
        counts_now: Counts::ZERO,
        counts_last_second: Counts::ZERO,
        baro_altitude: AltitudeFt(0),
        gnss_altitude: AltitudeFt(0),
        status: Status::NONE,
        callsign: Callsign::NUL,
        direct_at: Stamp::NEVER,
        squawk: ModeACode(0),
        gnss_minus_baro_ft: 0,
        track: CentiDegrees(0),
        ground_speed_eighths: 0,
        heading: CentiDegrees(0),
        indicated_airspeed_kt: 0,
        true_airspeed_kt: 0,
        mach: 0,
        vertical_rate_fpm: 0,
        roll: 0,
        track_rate: 0,
        pressure_setting: 0,
        selected_heading: CentiDegrees(0),
        selected_mcp: 0,
        selected_fms: 0,
        wind_speed_kt: 0,
        wind_direction: CentiDegrees(0),
        temperature: 0,
        static_pressure: 0,
        airframe: Airframe::NONE,
        category: Category {
            type_code: 0,
            ca: 0,
        },
        turbulence: 0,
        humidity: 0,
        announced: 0,
        emergency: EmergencyState::None,
        nacv: 0,
        version: 0,
        position_type_code: 0,
        position_source: PositionSource::Direct,
        flags: Flags::NONE,
    };

    pub(crate) fn new(address: Address, at_ms: u64) -> Self {
        Aircraft {
            packed_address: packed(address),
            heard_at: Stamp::at(at_ms),
            ..Aircraft::BLANK
        }
    }

    /// Takes a value as told now.
    pub(crate) fn tell(&mut self, field: Field, at_ms: u64) {
        self.freshness.touch(field, at_ms);
    }

    /// Ends a second.
    pub(crate) fn second_ends(&mut self, now_ms: u64) {
        self.freshness.second_ends(now_ms);
        self.places.second_ends(now_ms);
        self.direct_at.hold(now_ms);
        self.signal.second_ends();
        self.counts_last_second = core::mem::replace(&mut self.counts_now, Counts::ZERO);
    }

    /// What the aircraft is worth to the table, ms: the one worth least leaves when another needs its place.
    ///
    /// ```text
    ///   less the silence since its last frame
    ///   and   20 s   its position is shown
    ///     or  10 s   it sends extended squitters, so a position may come
    ///     or   5 s   a frame with exact parity has confirmed that it exists
    /// ```
    pub(crate) fn worth_ms(&self, now_ms: u64) -> i32 {
        let credit = if self.places.shown(now_ms).is_some() {
            20_000
        } else {
            credit_ms(
                self.flags.has(Flag::HasSquitters),
                self.flags.has(Flag::Confirmed),
            )
        };
        credit - self.silent_ms(now_ms) as i32
    }
}

/// An address in 25 bits: bit 24 says that it is none of ICAO.
pub(crate) fn packed(address: Address) -> u32 {
    address.bits() | u32::from(!address.is_icao()) << 24
}

/// The address of a packed one.
pub(crate) fn unpacked(packed: u32) -> Address {
    let bits = packed & 0xFF_FFFF;
    if packed >> 24 == 0 {
        Address::Icao(Icao(bits))
    } else {
        Address::NonIcao(bits)
    }
}

/// Worth of an aircraft without a position that was heard just now, ms.
pub(crate) const fn credit_ms(has_squitters: bool, is_confirmed: bool) -> i32 {
    if has_squitters {
        10_000
    } else if is_confirmed {
        5_000
    } else {
        0
    }
}
