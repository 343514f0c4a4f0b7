//! The fields of an aircraft whose age is kept, and which of them were updated in an interval.
//!
//! Fields before [`Field::UPDATES_END`] have a bit in [`Updated`]: reports ask for those. A field that lives as long as its aircraft
//! (what was told once stays true until told otherwise) says so in [`Field::life_ms`].

use crate::stamp::Stamp;

/// How long most fields are still told after their last update, ms. As long as the aircraft itself.
pub const FIELD_LIFE_MS: u32 = 60_000;

/// A field with an age of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Field {
    /// Pressure altitude.
    BaroAltitude,
    /// Height above the ellipsoid.
    GnssAltitude,
    /// Confirmed position.
    Position,
    /// Track over the ground.
    Track,
    /// Ground speed.
    GroundSpeed,
    /// Vertical rate of either source.
    VerticalRate,
    /// Callsign.
    Callsign,
    /// Emitter category.
    Category,
    /// Mode A code.
    Squawk,
    /// Heading.
    Heading,
    /// Indicated airspeed.
    IndicatedAirspeed,
    /// True airspeed.
    TrueAirspeed,
    /// Mach number.
    Mach,
    /// Roll angle.
    Roll,
    /// Rate of turn.
    TrackRate,
    /// Altitude selected on the mode control panel.
    SelectedMcp,
    /// Altitude selected in the flight management system.
    SelectedFms,
    /// Altimeter setting.
    PressureSetting,
    /// Selected heading.
    SelectedHeading,
    /// Autopilot modes.
    Modes,
    /// Wind speed and direction.
    Wind,
    /// Static air temperature.
    Temperature,
    /// Static pressure.
    StaticPressure,
    /// Turbulence.
    Turbulence,
    /// Relative humidity.
    Humidity,
    /// Emergency state.
    Emergency,
    /// On the ground or in the air.
    OnGround,
    /// IDENT (SPI).
    Ident,
    /// Alert.
    Alert,
    /// Type code and bit 8 of the last position message, which give NIC.
    Integrity,
    /// NACv.
    Nacv,
    /// Quality and equipment.
    Status,
    /// Resolution advisory.
    TcasRa,
    /// Difference of GNSS height and pressure altitude.
    GnssMinusBaro,
}

impl Field {
    /// Every field, in the order of declaration.
    pub const ALL: [Field; 34] = [
        Field::BaroAltitude,
        Field::GnssAltitude,
        Field::Position,
        Field::Track,
        Field::GroundSpeed,
        Field::VerticalRate,
        Field::Callsign,
        Field::Category,
        Field::Squawk,
        Field::Heading,
        Field::IndicatedAirspeed,
        Field::TrueAirspeed,
        Field::Mach,
        Field::Roll,
        Field::TrackRate,
        Field::SelectedMcp,
        Field::SelectedFms,
        Field::PressureSetting,
        Field::SelectedHeading,
        Field::Modes,
        Field::Wind,
        Field::Temperature,
        Field::StaticPressure,
        Field::Turbulence,
        Field::Humidity,
        Field::Emergency,
        Field::OnGround,
        Field::Ident,
        Field::Alert,
        Field::Integrity,
        Field::Nacv,
        Field::Status,
        Field::TcasRa,
        Field::GnssMinusBaro,
    ];
    /// The first field without a bit in [`Updated`].
    pub const UPDATES_END: Field = Field::TcasRa;

    /// How long the field is told after its last update; `None`: as long as the aircraft is tracked.
    pub const fn life_ms(self) -> Option<u32> {
        match self {
            Field::Callsign | Field::Category | Field::Squawk | Field::OnGround => None,
            // The place keeps it as a reference beyond the minute for which it is told.
            Field::Position => None,
            _ => Some(FIELD_LIFE_MS),
        }
    }
}

/// Fields updated within an interval, a bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Updated(u32);

impl Updated {
    /// None.
    pub const NONE: Updated = Updated(0);

    /// Whether this field was updated; `false` for fields from [`Field::UPDATES_END`] on.
    pub const fn has(self, field: Field) -> bool {
        let bit = field as u32;
        bit < Field::UPDATES_END as u32 && self.0 >> bit & 1 != 0
    }

    fn mark(&mut self, field: Field) {
        let bit = field as u32;
        if bit < Field::UPDATES_END as u32 {
            self.0 |= 1 << bit;
        }
    }
}

/// The time of each field's last update, and what was updated since the last look.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Freshness {
    stamps: [Stamp; Field::ALL.len()],
    now: Updated,
    last_second: Updated,
}

impl Freshness {
    /// Nothing known.
    pub(crate) const NONE: Freshness = Freshness {
        stamps: [Stamp::NEVER; Field::ALL.len()],
        now: Updated::NONE,
        last_second: Updated::NONE,
    };

    /// The field was told.
    pub(crate) fn touch(&mut self, field: Field, at_ms: u64) {
        self.stamps[field as usize] = Stamp::at(at_ms);
        self.now.mark(field);
    }

    /// Whether the field was ever told and is not forgotten.
    pub(crate) fn is_known(&self, field: Field) -> bool {
        self.stamps[field as usize] != Stamp::NEVER
    }

    /// Milliseconds since the field was told.
    pub(crate) fn age_ms(&self, field: Field, now_ms: u64) -> Option<u32> {
        self.stamps[field as usize].age_ms(now_ms)
    }

    /// Whether the field was told at most `life_ms` before `now_ms`.
    pub(crate) fn is_within(&self, field: Field, life_ms: u32, now_ms: u64) -> bool {
        self.age_ms(field, now_ms).is_some_and(|age| age <= life_ms)
    }

    /// Whether the field may be told at `now_ms`.
    pub(crate) fn is_alive(&self, field: Field, now_ms: u64) -> bool {
        match field.life_ms() {
            Some(life_ms) => self.is_within(field, life_ms, now_ms),
            None => self.is_known(field),
        }
    }

    /// Fields updated in the last whole second.
    pub(crate) const fn last_second(&self) -> Updated {
        self.last_second
    }

    /// Ends a second: what is too old is forgotten, so that no age outgrows its stamp.
    pub(crate) fn second_ends(&mut self, now_ms: u64) {
        for (stamp, field) in self.stamps.iter_mut().zip(Field::ALL) {
            match field.life_ms() {
                Some(life_ms) => stamp.expire(life_ms, now_ms),
                None => stamp.hold(now_ms),
            }
        }
        self.last_second = core::mem::replace(&mut self.now, Updated::NONE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_numbered_as_listed() {
        for (number, field) in Field::ALL.into_iter().enumerate() {
            assert_eq!(field as usize, number);
        }
        assert!(Field::UPDATES_END as u32 <= u32::BITS);
    }

    #[test]
    fn each_field_has_its_own_age_and_bit() {
        for field in Field::ALL {
            let mut freshness = Freshness::NONE;
            freshness.touch(field, 8_000);
            for other in Field::ALL {
                assert_eq!(freshness.is_known(other), other == field, "{other:?}");
            }
            freshness.second_ends(9_000);
            let updated = freshness.last_second();
            for other in Field::ALL {
                let expected = other == field && field < Field::UPDATES_END;
                assert_eq!(updated.has(other), expected, "{other:?}");
            }
            assert_eq!(freshness.age_ms(field, 9_000), Some(1_000));
            freshness.second_ends(10_000);
            assert_eq!(freshness.last_second(), Updated::NONE);
        }
    }

    #[test]
    fn a_minute_ends_all_but_what_lives_with_the_aircraft() {
        for field in Field::ALL {
            let mut freshness = Freshness::NONE;
            freshness.touch(field, 1_000);
            for second in 2..=600 {
                let now_ms = second * 1_000;
                freshness.second_ends(now_ms);
                let expected = now_ms <= 61_000 || field.life_ms().is_none();
                assert_eq!(
                    freshness.is_alive(field, now_ms),
                    expected,
                    "{field:?} {second}"
                );
            }
        }
    }
}
