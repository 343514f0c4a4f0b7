//! What the statistics lines of all protocols tell, in one struct; each protocol takes its part.

/// Counts of the last whole second, and what goes with them; `None` is sent as an empty field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// DPS: attempted demodulations.
    pub demodulations: Option<u32>,
    /// ACFPS, FPSAC: Mode A and Mode C frames.
    pub mode_ac_frames: Option<u32>,
    /// SFPS, FPSS: valid Mode S frames.
    pub mode_s_frames: Option<u32>,
    /// TSCAL, CALIB: measured frequency of the clock behind the stamps, Hz; needs PPS.
    pub stamp_clock_hz: Option<u32>,
    /// UPTIME: seconds since RUN was entered.
    pub uptime_s: u32,
    /// UPT: seconds since the statistics were enabled.
    pub enabled_s: u32,
    /// CPL, CPU: load of the busier core, tenths of a per cent.
    pub load_permille: Option<u16>,
    /// Aircraft tracked now.
    pub aircraft: Option<u32>,
    /// Messages this port took whole.
    pub sent: Option<u32>,
    /// Messages this port had no room for.
    pub dropped: Option<u32>,
}
