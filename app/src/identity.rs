//! Who the device is, as text: from the image's header and the flash part.

use crate::confirm::Confirm;
use crate::receiver::Text;
use core::fmt::Write;

/// `a.b.c.d (Mon D YYYY)`, the day being the commit's.
pub fn version(confirm: &Confirm) -> Text {
    let mut text = Text::new();
    if let Some(header) = confirm.header() {
        // At most 28 bytes.
        let _ = write!(text, "{}", header.version_text());
    }
    text
}

/// The board the image is for.
pub fn board(confirm: &Confirm) -> Text {
    let mut text = Text::new();
    if let Some(header) = confirm.header() {
        // At most 16 bytes.
        let _ = write!(text, "{}", header.board_name());
    }
    text
}

/// The flash part's unique id, as USB's serial number shows it.
pub fn serial(unique_id: [u8; 8]) -> Text {
    let mut text = Text::new();
    // 16 bytes.
    let _ = write!(text, "{:016X}", u64::from_be_bytes(unique_id));
    text
}
