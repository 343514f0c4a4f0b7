//! Messages of an aircraft in a second, by kind.

/// Messages within a second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Mode S frames of any format (SFPS, FPSS).
    pub mode_s: u16,
    /// Mode A/C replies that this aircraft alone can have sent (ACFPS, FPSAC).
    pub mode_ac: u16,
}

impl Counts {
    /// None.
    pub(crate) const ZERO: Counts = Counts {
        mode_s: 0,
        mode_ac: 0,
    };

    pub(crate) fn hear_mode_s(&mut self) {
        self.mode_s = self.mode_s.saturating_add(1);
    }
}
