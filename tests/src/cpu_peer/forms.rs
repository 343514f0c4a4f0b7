//! Forms in which the twin's CPU core is known to differ. `tests/peers/cpu_accepted.txt` has a line for each with its reason.
//!
//! The generator leaves them out, since a core that differs there cannot finish a random block. Each is tried on its own in every run,
//! so that a line whose difference went away is noticed, and the shipped image is searched for it.

use super::image::Block;
use super::{Difference, generator, image, sides};

/// A form.
pub struct Form {
    /// Its name in the table.
    pub name: &'static str,
    /// Instructions that show the difference.
    pub code: &'static [u16],
    /// Whether two halfwords of an image are of the form.
    pub is: fn(u16, u16) -> bool,
}

/// All that are tried. Those without a line in the table must agree.
pub const FORMS: &[Form] = &[
    Form {
        name: "mrs iapsr",
        code: &[0xf3ef, 0x8301],
        is: |h0, h1| reads(h0, h1, 1),
    },
    Form {
        name: "mrs eapsr",
        code: &[0xf3ef, 0x8302],
        is: |h0, h1| reads(h0, h1, 2),
    },
    Form {
        name: "mrs epsr",
        code: &[0xf3ef, 0x8306],
        is: |h0, h1| reads(h0, h1, 6),
    },
    Form {
        name: "mrs iepsr",
        code: &[0xf3ef, 0x8307],
        is: |h0, h1| reads(h0, h1, 7),
    },
    // movs r3, #8; lsls r3, r3, #24; msr iapsr, r3; mrs r4, apsr.
    Form {
        name: "msr iapsr",
        code: &[0x2308, 0x061b, 0xf383, 0x8801, 0xf3ef, 0x8400],
        is: |h0, h1| writes(h0, h1, 1),
    },
    Form {
        name: "msr eapsr",
        code: &[0x2308, 0x061b, 0xf383, 0x8802, 0xf3ef, 0x8400],
        is: |h0, h1| writes(h0, h1, 2),
    },
    Form {
        name: "msr epsr",
        code: &[0xf383, 0x8806],
        is: |h0, h1| writes(h0, h1, 6),
    },
    Form {
        name: "msr iepsr",
        code: &[0xf383, 0x8807],
        is: |h0, h1| writes(h0, h1, 7),
    },
    // movs r3, #8; lsls r3, r3, #24; msr apsr, r3; mrs r4, apsr.
    Form {
        name: "msr apsr, bit 27 set",
        code: &[0x2308, 0x061b, 0xf383, 0x8800, 0xf3ef, 0x8400],
        is: |h0, h1| writes(h0, h1, 0) || writes(h0, h1, 3),
    },
    // movs r3, #7; msr psp, r3; mrs r4, psp.
    Form {
        name: "msr psp, bits 1:0 set",
        code: &[0x2307, 0xf383, 0x8809, 0xf3ef, 0x8409],
        is: |h0, h1| writes(h0, h1, 9),
    },
];

fn reads(h0: u16, h1: u16, register: u16) -> bool {
    h0 == 0xf3ef && h1 & 0xf0ff == 0x8000 | register
}

fn writes(h0: u16, h1: u16, register: u16) -> bool {
    h0 & 0xfff0 == 0xf380 && h1 == 0x8800 | register
}

/// The committed table: names and reasons.
pub fn accepted() -> Result<Vec<(String, String)>, String> {
    include_str!("../../peers/cpu_accepted.txt")
        .lines()
        .filter(|line| !line.trim().is_empty() && !line.starts_with('#'))
        .map(|line| {
            line.split_once('|')
                .map(|(name, reason)| (name.trim().to_owned(), reason.trim().to_owned()))
                .ok_or_else(|| format!("cpu_accepted.txt: no | in: {line}"))
        })
        .collect()
}

/// Tries a form on both sides: how they differ, if they do.
pub fn difference(form: &Form, seed: u64) -> Result<Option<Difference>, String> {
    let block: Block = generator::fixed(seed, 0, form.code);
    let ram = image::build(std::slice::from_ref(&block));
    let (twin, qemu) = (sides::in_twin(&ram), sides::in_qemu(&ram)?);
    Ok(Difference::between(&twin, &qemu, 0, seed))
}

/// How often the halfwords of an image are of a form.
pub fn occurrences(form: &Form, halfwords: &[u16]) -> usize {
    halfwords
        .windows(2)
        .filter(|pair| (form.is)(pair[0], pair[1]))
        .count()
}
