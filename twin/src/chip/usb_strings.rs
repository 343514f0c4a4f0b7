//! What the host has read of the device's names.

use super::usb_host::UsbHost;

/// Type of a string descriptor (USB 2.0, table 9-5).
const STRING: u8 = 3;

impl UsbHost {
    /// Manufacturer, product and serial number, as far as the device told them since it was attached.
    pub fn strings(&self) -> Vec<String> {
        let strings = self.descriptors.iter().filter(|(kind, _)| *kind == STRING);
        strings.map(|(_, bytes)| text(bytes)).collect()
    }
}

/// UTF-16, little-endian, behind length and type (USB 2.0, 9.6.7).
fn text(descriptor: &[u8]) -> String {
    let units = descriptor.get(2..).unwrap_or_default().chunks_exact(2);
    let units: Vec<u16> = units.map(|u| u16::from_le_bytes([u[0], u[1]])).collect();
    String::from_utf16_lossy(&units)
}
