//! What is true or not of an aircraft, a bit each.

use mode_s::AutopilotModes;

/// One bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Flag {
    OnGround,
    Ident,
    Alert,
    TcasRa,
    /// The vertical rate is of the barometer.
    RateIsBaro,
    /// Bit 8 of the last airborne position; not set on the surface.
    NicBOrSingleAntenna,
    /// A military squitter was heard.
    Military,
    /// A frame with exact parity was heard, of which no bit was repaired.
    Confirmed,
    /// An extended squitter was heard.
    HasSquitters,
    /// The heading is from magnetic north.
    HeadingIsMagnetic,
    Autopilot,
    Vnav,
    AltitudeHold,
    Approach,
    Lnav,
    /// Which of two alternating turns of the second has closed its last one: see `table`.
    Turn,
}

/// All of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Flags(u16);

impl Flags {
    /// None is set.
    pub(crate) const NONE: Flags = Flags(0);

    pub(crate) const fn has(self, flag: Flag) -> bool {
        self.0 >> flag as u8 & 1 != 0
    }

    pub(crate) fn set(&mut self, flag: Flag, value: bool) {
        self.0 = self.0 & !(1 << flag as u8) | u16::from(value) << flag as u8;
    }

    pub(crate) const fn modes(self) -> AutopilotModes {
        AutopilotModes {
            autopilot: self.has(Flag::Autopilot),
            vnav: self.has(Flag::Vnav),
            altitude_hold: self.has(Flag::AltitudeHold),
            approach: self.has(Flag::Approach),
            lnav: self.has(Flag::Lnav),
        }
    }

    pub(crate) fn set_modes(&mut self, modes: AutopilotModes) {
        self.set(Flag::Autopilot, modes.autopilot);
        self.set(Flag::Vnav, modes.vnav);
        self.set(Flag::AltitudeHold, modes.altitude_hold);
        self.set(Flag::Approach, modes.approach);
        self.set(Flag::Lnav, modes.lnav);
    }
}
