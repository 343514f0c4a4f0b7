//! Any bytes, in any pieces: no panic, and the same lines however they are split.

use nmea_0183::{Fix, Reader, Sentence};
use proptest::prelude::*;

fn lines(bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut reader = Reader::new();
    let mut out = Vec::new();
    for &byte in bytes {
        out.extend(reader.feed(byte).map(<[u8]>::to_vec));
    }
    out
}

/// A sentence with its checksum.
fn whole(text: &str) -> Vec<u8> {
    let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${text}*{sum:02X}\r\n").into_bytes()
}

proptest! {
    #[test]
    fn any_bytes_are_survived(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let mut fix = Fix::new();
        let mut reader = Reader::new();
        for &byte in &bytes {
            if let Some(line) = reader.feed(byte) {
                fix.hear(&Sentence::parse(line), 0);
            }
        }
        let counters = reader.counters();
        let done = counters.good + counters.bad_checksum + counters.broken_off;
        prop_assert!(counters.begun - done <= 1);
        let _ = Sentence::parse(&bytes);
    }

    #[test]
    fn any_fields_with_a_right_checksum_are_survived(
        name in "(RMC|GGA|GSA|GST|ZDA)",
        fields in proptest::collection::vec("[-0-9.NSEWAVM]{0,11}", 0..20),
    ) {
        let text = format!("GN{name},{}", fields.join(","));
        let found = lines(&whole(&text));
        prop_assert_eq!(found.len(), usize::from(text.len() + 4 <= nmea_0183::MAX_LINE));
        for line in found {
            let mut fix = Fix::new();
            fix.hear(&Sentence::parse(&line), 0);
            if let Some(place) = fix.place {
                prop_assert!(place.latitude.abs() <= 900_000_000);
                prop_assert!(place.longitude.abs() <= 1_800_000_000);
            }
        }
    }

    #[test]
    fn garbage_between_sentences_costs_none_of_them(garbage in "[^$\r\n]{0,60}") {
        let text = "GNZDA,030405.00,02,01,2026,00,00";
        let mut stream = whole(text);
        stream.extend(garbage.as_bytes());
        stream.extend(whole(text));
        prop_assert_eq!(lines(&stream).len(), 2);
    }
}
