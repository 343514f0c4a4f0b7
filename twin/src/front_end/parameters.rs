//! Every number of the front end that decides reception, with its origin.
//!
//! Frozen before the demodulator is tuned: changing one means a decision record and all reception tables again. "Assumed" marks
//! what no public document of the board says.
//!
//! | board kind | slicer | origin |
//! |---|---|---|
//! | `adsbee_1090` (revision F and later) | RC-following | its receiver is an AC-coupled data slicer: the threshold rides on the recent level |
//! | `adsbee_1090_e` (to revision E) | fixed | comparator against the PWM's DC level |
//! | none | peak-following | the best slicer of the prototype study, to compare with |

/// Slope of the level: 60 dB a volt (AD8313 at 18 mV/dB nominal, as scaled on the board; the vendor's own conversion).
pub const MILLIVOLT_PER_DB: f32 = 1000.0 / 60.0;

/// Level at 0 dBm at the detector, mV: the vendor's conversion dBm = 60 (mV - 1600) / 1000 - gain.
pub const MILLIVOLT_AT_ZERO_DBM: f32 = 1600.0;

/// Gain from antenna to detector, dB: 44 on current boards (the same conversion).
pub const GAIN_DB: f32 = 44.0;

/// Least level of the detector, mV: AD8313's lower end of range, -73 dBm at its input on the same slope.
pub const LEAST_MILLIVOLT: f32 = MILLIVOLT_AT_ZERO_DBM - 73.0 * MILLIVOLT_PER_DB;

/// Greatest level of the detector, mV: AD8313 limits a little above 0 dBm at its input.
pub const GREATEST_MILLIVOLT: f32 = MILLIVOLT_AT_ZERO_DBM + 3.0 * MILLIVOLT_PER_DB;

/// Rise of the detector, 10 to 90 %, ns: AD8313 data sheet, 40 ns.
pub const RISE_NS: f32 = 40.0;

/// Fall of the detector, 10 to 90 %, ns: "100 ns and more" on the board; assumed 100.
pub const FALL_NS: f32 = 100.0;

/// Noise bandwidth before the detector, MHz: the SAW filter's; assumed 8, as in the prototype study.
pub const NOISE_BANDWIDTH_MHZ: f32 = 8.0;

/// Noise level at the antenna, dBm: -174 dBm/Hz + 69 dB (8 MHz) + 3 dB noise figure (assumed).
pub const NOISE_DBM: f32 = -102.0;

/// Time constant of the RC-following slicer, ns: the prototype study's 2 µs (assumed for the board).
pub const RC_NS: f32 = 2_000.0;

/// Peak-following slicer: threshold this far under the peak, dB (prototype study).
pub const UNDER_PEAK_DB: f32 = 7.0;

/// Peak-following slicer: decay of the peak, dB/µs (prototype study).
pub const PEAK_DECAY_DB_PER_US: f32 = 0.25;

/// The comparator's hysteresis, mV, half to each side (assumed: a small one is usual inside such comparators).
pub const HYSTERESIS_MV: f32 = 4.0;

/// Full scale of a recording at the antenna, dBm (assumed; a recording does not say).
pub const RECORDING_FULL_SCALE_DBM: f32 = -40.0;

/// Trigger level until the firmware sets one, mV: the vendor's default.
pub const TRIGGER_LEVEL_MV: f64 = 1300.0;

/// RC-following slicer: the level at which the AC-coupled signal is biased, mV. The trigger level minus this is what the level must exceed its own
/// average by (assumed: the vendor's default trigger level then stands 0.9 dB above the average).
pub const RC_BIAS_MV: f64 = 1285.0;

/// How the comparator's threshold comes about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slicer {
    /// The trigger level itself.
    Fixed,
    /// The level's RC average plus what the trigger level stands above the bias.
    RcFollowing,
    /// The greater of the trigger level and [`UNDER_PEAK_DB`] under a decaying peak.
    PeakFollowing,
}

/// The front end of one board kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrontEnd {
    /// How the threshold comes about.
    pub slicer: Slicer,
    /// Detector rise, 10 to 90 %, ns.
    pub rise_ns: f32,
    /// Detector fall, 10 to 90 %, ns.
    pub fall_ns: f32,
    /// Time constant of the RC average, ns.
    pub rc_ns: f32,
    /// Comparator hysteresis, mV.
    pub hysteresis_mv: f32,
    /// Trigger level until one is set, mV.
    pub trigger_level_mv: f64,
}

impl FrontEnd {
    /// `adsbee_1090`: RC-following.
    pub const ADSBEE_1090: FrontEnd = FrontEnd::with_slicer(Slicer::RcFollowing);

    /// `adsbee_1090_e`: fixed threshold.
    pub const ADSBEE_1090_E: FrontEnd = FrontEnd::with_slicer(Slicer::Fixed);

    /// The parameters above with this slicer.
    pub const fn with_slicer(slicer: Slicer) -> FrontEnd {
        FrontEnd {
            slicer,
            rise_ns: RISE_NS,
            fall_ns: FALL_NS,
            rc_ns: RC_NS,
            hysteresis_mv: HYSTERESIS_MV,
            trigger_level_mv: TRIGGER_LEVEL_MV,
        }
    }
}
