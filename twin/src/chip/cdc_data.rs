//! Where a configuration descriptor has its CDC data interface (USB 2.0, 9.6; CDC PSTN subclass 1.2).

use serde::{Deserialize, Serialize};

/// Where the CDC data interface was found.
#[derive(Clone, Copy, Default, Debug, Serialize, Deserialize)]
pub struct Endpoints {
    pub bulk_in: usize,
    pub bulk_out: usize,
    /// The PID that the next packet of each must have.
    pub in_pid: bool,
    pub out_pid: bool,
}

/// Finds the bulk endpoints of the first CDC data interface (class 0x0a) in a configuration descriptor.
pub fn data_endpoints(mut rest: &[u8]) -> Option<Endpoints> {
    let mut found = Endpoints::default();
    let mut in_data_interface = false;
    while let [len, kind, ..] = *rest {
        let len = usize::from(len);
        if len < 2 || len > rest.len() {
            break;
        }
        match kind {
            4 if len >= 9 => in_data_interface = rest[5] == 0x0a,
            5 if len >= 7 && in_data_interface => {
                let n = usize::from(rest[2] & 0xf);
                if rest[2] & 0x80 != 0 {
                    found.bulk_in = n;
                } else {
                    found.bulk_out = n;
                }
            }
            _ => {}
        }
        rest = &rest[len..];
    }
    (found.bulk_in != 0 && found.bulk_out != 0).then_some(found)
}
