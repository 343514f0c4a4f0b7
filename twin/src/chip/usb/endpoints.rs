//! Endpoints: what a token does to the buffers in packet memory.
//!
//! Source: RP2040 datasheet 4.1.2.5 (buffers, data PIDs, double buffering) and the DPRAM's field descriptions.
//!
//! | endpoint control (EP0: SIE_CTRL) | | buffer control, half 0 (half 1: 16 higher) | |
//! |---|---|---|---|
//! | 31 | enabled | 15 | FULL: IN data is valid, OUT data has come |
//! | 30 | double buffered | 14 | LAST of the transfer: TRANS_COMPLETE |
//! | 29 28 | BUFF_STATUS after each buffer, after both | 13 | data PID |
//! | 27:26 | type; 1 is isochronous | 12 | RESET the selector (half 0 alone) |
//! | 17 16 | note STALL, NAK | 11 | STALL (for both halves) |
//! | 15:0 | buffer, the second half 64 behind it | 10, 9:0 | AVAILABLE, length |
//!
//! ```text
//!   disabled: silence   EP_ABORT: NAK   STALL: STALL   half not AVAILABLE: NAK   else data or ACK; AVAILABLE falls, next half
//! ```
//! An OUT packet with the wrong PID is acknowledged and dropped (USB 2.0, 8.6.2) and sets DATA_SEQ_ERROR. EP0 stalls only while EP_STALL_ARM
//! is set, which the next SETUP clears.

use super::{DPRAM, Usb, sie};
use serde::{Deserialize, Serialize};

const LEN: u32 = 0x3ff;
const AVAILABLE: u32 = 1 << 10;
const STALL: u32 = 1 << 11;
const RESET_SELECTOR: u32 = 1 << 12;
const PID: u32 = 1 << 13;
const LAST: u32 = 1 << 14;
const FULL: u32 = 1 << 15;

const ENABLED: u32 = 1 << 31;
const DOUBLE: u32 = 1 << 30;
const EACH: u32 = 1 << 29;
const BOTH: u32 = 1 << 28;
const NOTE_STALL: u32 = 1 << 17;
const NOTE_NAK: u32 = 1 << 16;
const ISOCHRONOUS: u32 = 1;
/// Endpoint 0's buffer.
const BUFFER_0: usize = 0x100;
/// Bytes between the halves.
const HALF: usize = 64;

/// A data packet: its PID (DATA1 is true) and its bytes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Data {
    pub pid: bool,
    pub bytes: Vec<u8>,
}

/// What the device answers to a token.
#[derive(Debug, PartialEq, Eq)]
pub enum Handshake {
    Ack,
    Data(Data),
    Nak,
    Stall,
    /// No such endpoint: the host sees a timeout.
    Silence,
}

/// One half of an endpoint as a token finds it.
#[derive(Clone, Serialize, Deserialize)]
struct Half {
    /// Offset of the buffer control word.
    at: usize,
    /// 0 or 16.
    shift: u32,
    /// Sixteen bits of the buffer control word.
    control: u32,
    /// Offset of the data.
    buffer: usize,
}

/// Bit of an endpoint and direction in BUFF_STATUS and its like.
fn bit(ep: usize, to_device: bool) -> u32 {
    1 << (2 * ep + usize::from(to_device))
}

impl Usb {
    /// A word of packet memory.
    pub fn word(&self, offset: usize) -> u32 {
        let o = offset & (DPRAM - 4);
        u32::from_le_bytes(self.dpram[o..o + 4].try_into().expect("four bytes"))
    }

    fn set_word(&mut self, offset: usize, value: u32) {
        self.dpram[offset..offset + 4].copy_from_slice(&value.to_le_bytes());
    }

    /// An endpoint's control word; endpoint 0 has its in SIE_CTRL, at other places.
    fn control(&self, ep: usize, to_device: bool) -> u32 {
        if ep > 0 {
            return self.word(8 * ep + 4 * usize::from(to_device));
        }
        let moved = |from: u32, to: u32| (self.sie_ctrl >> from & 1) << to;
        ENABLED
            | self.sie_ctrl & (DOUBLE | EACH | BOTH)
            | moved(31, NOTE_STALL.trailing_zeros())
            | moved(27, NOTE_NAK.trailing_zeros())
    }

    /// The half of an endpoint that the next packet concerns.
    fn half(&self, ep: usize, to_device: bool) -> Half {
        let control = self.control(ep, to_device);
        let second = control & DOUBLE != 0 && self.selector & bit(ep, to_device) != 0;
        let shift = if second { 16 } else { 0 };
        let at = 0x80 + 8 * ep + 4 * usize::from(to_device);
        let base = match ep {
            0 => BUFFER_0,
            _ => (control & 0xffc0) as usize & (DPRAM - 1),
        };
        Half {
            at,
            shift,
            control: self.word(at) >> shift & 0xffff,
            buffer: base + if second { HALF } else { 0 },
        }
    }

    /// A write reached packet memory; false if it asks for what is not modelled.
    pub fn dpram_written(&mut self, offset: usize) -> bool {
        match offset {
            8..0x80 => {
                let word = self.word(offset);
                word & ENABLED == 0 || word >> 26 & 3 != ISOCHRONOUS
            }
            0x80..0x100 => {
                let word = self.word(offset);
                if word & RESET_SELECTOR != 0 {
                    self.selector &= !(1 << ((offset - 0x80) / 4));
                    self.set_word(offset, word & !RESET_SELECTOR);
                }
                true
            }
            _ => true,
        }
    }

    /// A SETUP token with its eight bytes; always accepted.
    pub fn setup(&mut self, packet: [u8; 8]) {
        self.dpram[..8].copy_from_slice(&packet);
        self.sie_status |= sie::SETUP_REC;
        self.stall_arm &= !3;
    }

    /// What a token meets before any data: silence, NAK or STALL.
    fn refusal(&mut self, ep: usize, to_device: bool, half: &Half) -> Option<Handshake> {
        let control = self.control(ep, to_device);
        let here = bit(ep, to_device);
        if control & ENABLED == 0 {
            return Some(Handshake::Silence);
        }
        // STALL is for both halves and stands in the first.
        let armed = ep != 0 || self.stall_arm & here != 0;
        if self.abort & here == 0 && self.word(half.at) & STALL != 0 && armed {
            if control & NOTE_STALL != 0 {
                self.stall_nak |= here;
            }
            return Some(Handshake::Stall);
        }
        let full = half.control & FULL != 0;
        if self.abort & here != 0 || half.control & AVAILABLE == 0 || full == to_device {
            if control & NOTE_NAK != 0 {
                self.stall_nak |= here;
            }
            return Some(Handshake::Nak);
        }
        None
    }

    /// A half is done: its new control bits, the next half, and who is told.
    fn done(&mut self, ep: usize, to_device: bool, half: &Half, control: u32) {
        let word = self.word(half.at) & !(0xffff << half.shift) | control << half.shift;
        self.set_word(half.at, word);
        let settings = self.control(ep, to_device);
        let here = bit(ep, to_device);
        let second = half.shift != 0;
        let last = control & LAST != 0;
        if last {
            self.sie_status |= sie::TRANS_COMPLETE;
        }
        let double = settings & DOUBLE != 0;
        if settings & EACH != 0 || double && settings & BOTH != 0 && (second || last) {
            self.buff_status |= here;
            self.should_handle = self.should_handle & !here | if second { here } else { 0 };
        }
        if double {
            self.selector ^= here;
        }
    }

    /// An IN token; the host acknowledges what it gets.
    pub fn token_in(&mut self, ep: usize) -> Handshake {
        let half = self.half(ep, false);
        if let Some(refusal) = self.refusal(ep, false, &half) {
            return refusal;
        }
        let end = (half.buffer + (half.control & LEN) as usize).min(DPRAM);
        let data = Data {
            pid: half.control & PID != 0,
            bytes: self.dpram[half.buffer.min(end)..end].to_vec(),
        };
        self.sie_status |= sie::ACK_REC;
        self.done(ep, false, &half, half.control & !(AVAILABLE | FULL));
        Handshake::Data(data)
    }

    /// An OUT token with its data.
    pub fn token_out(&mut self, ep: usize, data: &Data) -> Handshake {
        let half = self.half(ep, true);
        if let Some(refusal) = self.refusal(ep, true, &half) {
            return refusal;
        }
        if data.pid != (half.control & PID != 0) {
            self.sie_status |= sie::DATA_SEQ_ERROR;
            return Handshake::Ack;
        }
        let room = (half.control & LEN) as usize;
        if data.bytes.len() > room {
            // More than the buffer takes: nothing is kept, nothing answered.
            self.sie_status |= sie::RX_OVERFLOW;
            return Handshake::Silence;
        }
        let len = data.bytes.len().min(DPRAM - half.buffer);
        self.dpram[half.buffer..half.buffer + len].copy_from_slice(&data.bytes[..len]);
        let kept = half.control & !(AVAILABLE | LEN) | FULL | len as u32;
        self.done(ep, true, &half, kept);
        Handshake::Ack
    }
}
