//! Resolution advisories: of a squitter, of register 3,0 and of a DF16 that coordinates one.

use super::Fields;
use mode_s::{AcasRa, Icao, Threat};

/// Bits of ARA where it speaks of one sense.
const ONE_SENSE: [(u32, &str); 6] = [
    (10, "corrective"),
    (11, "downward_sense"),
    (12, "increased_rate"),
    (13, "sense_reversal"),
    (14, "altitude_crossing"),
    (15, "positive"),
];
/// The same where several threats need different senses; pyModeS has no names for them.
const DIFFERENT_SENSES: [(u32, &str); 6] = [
    (10, "corrects_upward"),
    (11, "climb"),
    (12, "corrects_downward"),
    (13, "descend"),
    (14, "altitude_crossing"),
    (15, "sense_reversal"),
];
/// Bits of RAC.
const COMPLEMENTS: [(u32, &str); 4] = [
    (23, "no_below"),
    (24, "no_above"),
    (25, "no_left"),
    (26, "no_right"),
];

pub(super) fn put(advisory: &AcasRa, fields: &mut Fields) {
    fields.put("issued_ra", advisory.bit(9));
    let senses = if advisory.has_different_senses() {
        DIFFERENT_SENSES
    } else {
        ONE_SENSE
    };
    for (bit, name) in senses.into_iter().chain(COMPLEMENTS) {
        fields.put(name, advisory.bit(bit));
    }
    fields.put("ra_terminated", advisory.terminated);
    fields.put("multiple_threat", advisory.multiple_threats);
    fields.put("tcas_ra", advisory.is_active());
}

/// TTI and TID, which a coordination does not have.
pub(super) fn put_threat(threat: &Threat, fields: &mut Fields) {
    let indicator = match threat {
        Threat::Unknown => 0,
        Threat::Address(Icao(bits)) => {
            fields.put("threat_icao", format!("{bits:06X}"));
            1
        }
        Threat::Place {
            altitude,
            range_tenths_nm,
            bearing_degrees,
        } => {
            fields.may_put("threat_altitude", altitude.map(|feet| feet.0));
            let range = range_tenths_nm.map(|tenths| f64::from(tenths) / 10.0);
            fields.may_put("threat_range", range);
            fields.may_put("threat_bearing", *bearing_degrees);
            2
        }
        Threat::NotAssigned => 3,
    };
    fields.put("threat_type_indicator", indicator);
}
