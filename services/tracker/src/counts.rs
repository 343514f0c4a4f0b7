//! Messages of an aircraft in a second, by kind.

/// Messages within a second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Mode S frames of any format (SFPS, FPSS).
    pub mode_s: u16,
    /// Extended squitters among them: DF17, 18 and 19.
    pub squitters: u16,
    /// Mode A/C replies that this aircraft alone can have sent (ACFPS, FPSAC).
    pub mode_ac: u16,
}

impl Counts {
    /// None.
    pub(crate) const ZERO: Counts = Counts {
        mode_s: 0,
        squitters: 0,
        mode_ac: 0,
    };

    pub(crate) fn hear_mode_s(&mut self, is_squitter: bool) {
        self.mode_s = self.mode_s.saturating_add(1);
        self.squitters = self.squitters.saturating_add(is_squitter.into());
    }
}
