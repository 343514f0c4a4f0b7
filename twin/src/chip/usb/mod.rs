//! The USB device controller: registers, and what the bus does to them. [`endpoints`] has what a token of the host does to packet memory;
//! the host is [`super::usb_host`].
//!
//! Source: RP2040 datasheet 4.1 and the field descriptions of `rp2040-pac`. Device mode only: host mode, direct control of the lines and
//! isochronous endpoints are errors that name the register. Not modelled either: erratum RP2040-E15 (an IN transfer hit by an error can
//! hang the controller).
//!
//! | DPRAM 5010_0000 | | REGS 5011_0000 | |
//! |---|---|---|---|
//! | 000-007 | setup packet | 00 | ADDR_ENDP |
//! | 008-07f | EPn IN/OUT control | 40 48 4c 50 | MAIN_CTRL SOF_RD SIE_CTRL SIE_STATUS |
//! | 080-0ff | EPn IN/OUT buffer control | 58 5c | BUFF_STATUS BUFF_CPU_SHOULD_HANDLE |
//! | 100 | EP0 buffer | 60 64 68 | EP_ABORT EP_ABORT_DONE EP_STALL_ARM |
//! | 180- | data buffers | 70 74 78 | EP_STATUS_STALL_NAK USB_MUXING USB_PWR |
//! | | | 8c 90 94 98 | INTR INTE INTF INTS |

use serde::{Deserialize, Serialize};
mod endpoints;

#[cfg(test)]
mod usb_tests;

pub use endpoints::{Data, Handshake};

/// Size of the packet memory.
pub const DPRAM: usize = 4096;

/// SIE_STATUS.
mod sie {
    pub const VBUS_DETECTED: u32 = 1;
    pub const LINE_J: u32 = 1 << 2;
    pub const SUSPENDED: u32 = 1 << 4;
    pub const RESUME: u32 = 1 << 11;
    pub const CONNECTED: u32 = 1 << 16;
    pub const SETUP_REC: u32 = 1 << 17;
    pub const TRANS_COMPLETE: u32 = 1 << 18;
    pub const BUS_RESET: u32 = 1 << 19;
    pub const CRC_ERROR: u32 = 1 << 24;
    pub const BIT_STUFF_ERROR: u32 = 1 << 25;
    pub const RX_OVERFLOW: u32 = 1 << 26;
    pub const RX_TIMEOUT: u32 = 1 << 27;
    pub const ACK_REC: u32 = 1 << 30;
    pub const DATA_SEQ_ERROR: u32 = 1 << 31;
    /// Bits that software clears by writing one.
    pub const CLEARABLE: u32 = 0xff0e_0810;
}

/// SIE_CTRL.
mod ctrl {
    pub const PULLUP: u32 = 1 << 16;
    /// Remote wake-up; clears itself.
    pub const RESUME: u32 = 1 << 12;
    /// What belongs to host mode or drives the lines directly.
    pub const OTHERS: u32 = 0x0700_2f5f;
}

/// A packet that arrived damaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Damage {
    Crc,
    BitStuff,
    Overflow,
    /// The host's handshake did not come.
    Timeout,
}

/// Controller state.
#[derive(Clone, Serialize, Deserialize)]
pub struct Usb {
    pub dpram: Vec<u8>,
    addr_endp: u32,
    main_ctrl: u32,
    sie_ctrl: u32,
    sie_status: u32,
    buff_status: u32,
    /// BUFF_CPU_SHOULD_HANDLE: the half that completed last, a bit an endpoint and direction.
    should_handle: u32,
    /// The half that the controller uses next, likewise.
    selector: u32,
    frame: u32,
    /// A frame has begun since SOF_RD was read; a suspend began; the connection state changed.
    sof_seen: bool,
    suspend_changed: bool,
    connection_changed: bool,
    /// The bus is suspended; the device has asked the host to end that.
    asleep: bool,
    wake_requested: bool,
    muxing: u32,
    power: u32,
    stall_arm: u32,
    abort: u32,
    abort_done: u32,
    stall_nak: u32,
    inte: u32,
    intf: u32,
    other: [u32; 16],
}

impl Default for Usb {
    fn default() -> Self {
        Self {
            dpram: vec![0; DPRAM],
            addr_endp: 0,
            main_ctrl: 0,
            sie_ctrl: 0,
            sie_status: 0,
            buff_status: 0,
            should_handle: 0,
            selector: 0,
            frame: 0,
            sof_seen: false,
            suspend_changed: false,
            connection_changed: false,
            asleep: false,
            wake_requested: false,
            muxing: 0,
            power: 0,
            stall_arm: 0,
            abort: 0,
            abort_done: 0,
            stall_nak: 0,
            inte: 0,
            intf: 0,
            other: [0; 16],
        }
    }
}

impl Usb {
    /// The device has switched its pull-up on.
    pub fn attached(&self) -> bool {
        self.main_ctrl & 1 != 0 && self.sie_ctrl & ctrl::PULLUP != 0
    }

    /// Device address the firmware has set.
    pub fn address(&self) -> u8 {
        (self.addr_endp & 0x7f) as u8
    }

    // ---- the bus -----------------------------------------------------------------------------------------------------------

    /// The host signals a bus reset, which also ends a suspend.
    pub fn bus_reset(&mut self) {
        self.connection_changed |= self.sie_status & sie::CONNECTED == 0;
        self.asleep = false;
        self.sie_status &= !sie::SUSPENDED;
        self.sie_status |= sie::BUS_RESET | sie::CONNECTED;
        self.addr_endp &= !0x7f;
        self.selector = 0;
    }

    /// Whether the firmware has not yet taken the bus reset.
    pub fn bus_reset_pending(&self) -> bool {
        self.sie_status & sie::BUS_RESET != 0
    }

    /// Cable pulled: no VBUS, no connection.
    pub fn disconnect(&mut self) {
        self.connection_changed |= self.sie_status & sie::CONNECTED != 0;
        self.sie_status &= !sie::CONNECTED;
    }

    /// The bus has been idle for 3 ms.
    pub fn suspend(&mut self) {
        self.suspend_changed |= !self.asleep;
        self.asleep = true;
        self.sie_status |= sie::SUSPENDED;
    }

    /// The bus is suspended, as far as the device knows.
    pub fn suspended(&self) -> bool {
        self.asleep
    }

    /// The host ends a suspend.
    pub fn resume(&mut self) {
        self.asleep = false;
        self.sie_status &= !sie::SUSPENDED;
        self.sie_status |= sie::RESUME;
    }

    /// The device asks the host to end a suspend; told once.
    pub fn take_wake_request(&mut self) -> bool {
        std::mem::take(&mut self.wake_requested)
    }

    /// Start of frame.
    pub fn start_of_frame(&mut self, number: u32) {
        self.frame = number & 0x7ff;
        self.sof_seen = true;
    }

    /// A packet for the device arrives damaged; it answers nothing.
    pub fn damaged(&mut self, how: Damage) {
        self.sie_status |= match how {
            Damage::Crc => sie::CRC_ERROR,
            Damage::BitStuff => sie::BIT_STUFF_ERROR,
            Damage::Overflow => sie::RX_OVERFLOW,
            Damage::Timeout => sie::RX_TIMEOUT,
        };
    }

    // ---- registers ---------------------------------------------------------------------------------------------------------

    fn intr(&self) -> u32 {
        let status = |bit: u32| u32::from(self.sie_status & bit != 0);
        status(sie::TRANS_COMPLETE) << 3
            | u32::from(self.buff_status != 0) << 4
            | status(sie::DATA_SEQ_ERROR) << 5
            | status(sie::RX_TIMEOUT) << 6
            | status(sie::RX_OVERFLOW) << 7
            | status(sie::BIT_STUFF_ERROR) << 8
            | status(sie::CRC_ERROR) << 9
            | u32::from(self.vbus()) << 11
            | status(sie::BUS_RESET) << 12
            | u32::from(self.connection_changed) << 13
            | u32::from(self.suspend_changed) << 14
            | status(sie::RESUME) << 15
            | status(sie::SETUP_REC) << 16
            | u32::from(self.sof_seen) << 17
            | u32::from(self.abort_done != 0) << 18
            | u32::from(self.stall_nak != 0) << 19
    }

    /// VBUS is there, or USB_PWR says so: the boards force it, since the pin is not wired.
    fn vbus(&self) -> bool {
        self.power & 0b1100 == 0b1100 || self.power & 0b100 == 0
    }

    /// The interrupt output.
    pub fn irq_line(&self) -> bool {
        self.ints() != 0
    }

    fn ints(&self) -> u32 {
        self.intr() & self.inte | self.intf
    }

    fn status(&self) -> u32 {
        let line = match self.attached() {
            true => sie::LINE_J,
            false => 0,
        };
        let vbus = match self.vbus() {
            true => sie::VBUS_DETECTED,
            false => 0,
        };
        self.sie_status | line | vbus
    }

    /// Reads a register.
    pub fn read(&mut self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => self.addr_endp,
            0x04..=0x3c => self.other[offset as usize / 4],
            0x40 => self.main_ctrl,
            0x48 => {
                self.sof_seen = false;
                self.frame
            }
            0x4c => self.sie_ctrl,
            0x50 => self.status(),
            0x58 => self.buff_status,
            0x5c => self.should_handle,
            0x60 => self.abort,
            0x64 => self.abort_done,
            0x68 => self.stall_arm,
            0x70 => self.stall_nak,
            0x74 => self.muxing,
            0x78 => self.power,
            0x8c => self.intr(),
            0x90 => self.inte,
            0x94 => self.intf,
            0x98 => self.ints(),
            _ => return None,
        })
    }

    /// Writes a register; false if nothing models it or what is asked for.
    pub fn write(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0x00 => self.addr_endp = value & 0x000f_007f,
            // Host mode's endpoints: storage, as rp2040-hal clears them all at start.
            0x04..=0x3c => self.other[offset as usize / 4] = value,
            0x40 => {
                self.main_ctrl = value & 0x8000_0003;
                return value & 0b10 == 0;
            }
            0x4c => {
                self.wake_requested |= value & ctrl::RESUME != 0 && self.asleep;
                self.sie_ctrl = value & !ctrl::RESUME;
                return value & ctrl::OTHERS == 0;
            }
            0x50 => {
                self.suspend_changed &= value & sie::SUSPENDED == 0;
                self.connection_changed &= value & sie::CONNECTED == 0;
                self.sie_status &= !(value & sie::CLEARABLE);
            }
            0x58 => self.buff_status &= !value,
            0x60 => {
                // No transaction is ever half-way when software looks: an abort is done at once.
                self.abort_done |= value & !self.abort;
                self.abort = value;
            }
            0x64 => self.abort_done &= !value,
            0x68 => self.stall_arm = value & 3,
            0x70 => self.stall_nak &= !value,
            0x74 => self.muxing = value & 0xf,
            0x78 => self.power = value & 0x3f,
            0x90 => self.inte = value & 0x000f_ffff,
            0x94 => self.intf = value & 0x000f_ffff,
            // Read-only.
            0x48 | 0x5c | 0x8c | 0x98 => {}
            // Host mode and the PHY's overrides: only off.
            0x44 | 0x54 | 0x6c | 0x7c..=0x88 => return value == 0,
            _ => return false,
        }
        true
    }
}
