//! The short form of `cargo xtask bench cpu-peers`: the twin's CPU core against QEMU's Cortex-M0 on random programs. Needs
//! `qemu-system-arm` and fails without it.

use tests::cpu_peer::{compare, find_qemu, forms};

/// Instructions that must agree.
const INSTRUCTIONS: u64 = 25_000;

#[test]
fn random_programs_end_the_same_in_the_twin_and_in_qemu() {
    find_qemu().expect("the peer");
    let outcome = compare(20_000, INSTRUCTIONS).expect("both sides run");
    assert!(
        outcome.unexplained.is_empty(),
        "{}\n{}",
        outcome.unexplained.join("\n"),
        outcome.result()
    );
    assert!(outcome.agreed() >= INSTRUCTIONS);
}

#[test]
fn the_image_uses_no_form_that_is_accepted_as_different() {
    let image = std::fs::read(tests::image()).expect("the image");
    // UF2: blocks of 512 bytes, payload from byte 32, its length at byte 16.
    let flash: Vec<u8> = image
        .chunks_exact(512)
        .flat_map(|block| {
            let length = u32::from_le_bytes([block[16], block[17], block[18], block[19]]);
            block[32..32 + length as usize].to_vec()
        })
        .collect();
    let halfwords: Vec<u16> = flash
        .chunks_exact(2)
        .map(|pair| u16::from_le_bytes([pair[0], pair[1]]))
        .collect();
    let accepted = forms::accepted().expect("the table");
    let mut tried = 0;
    for form in forms::FORMS {
        if accepted.iter().any(|(name, _)| name == form.name) {
            tried += 1;
            assert_eq!(forms::occurrences(form, &halfwords), 0, "{}", form.name);
        }
    }
    assert_eq!(tried, accepted.len());
}
