//! The USB device controller: registers, packet memory, and what a token from the host does to them.
//!
//! Source: RP2040 datasheet 4.1. Only device mode; single-buffered endpoints (the double-buffer bit is an error, so that it cannot be
//! used by mistake). The host side is [`super::usb_host`].
//!
//! | DPRAM 5010_0000 | | REGS 5011_0000 | |
//! |---|---|---|---|
//! | 000-007 | setup packet | 00 | ADDR_ENDP |
//! | 008-07f | EPn IN/OUT control | 40 48 4c 50 | MAIN_CTRL SOF_RD SIE_CTRL SIE_STATUS |
//! | 080-0ff | EPn IN/OUT buffer control | 58 | BUFF_STATUS |
//! | 100 | EP0 buffer | 60 64 68 | EP_ABORT EP_ABORT_DONE EP_STALL_ARM |
//! | 180- | data buffers | 74 78 | USB_MUXING USB_PWR |
//! | | | 8c 90 94 98 | INTR INTE INTF INTS |

/// Size of the packet memory.
pub const DPRAM: usize = 4096;

const LEN: u32 = 0x3ff;
const AVAILABLE: u32 = 1 << 10;
const STALL: u32 = 1 << 11;
const FULL: u32 = 1 << 15;

const SETUP_REC: u32 = 1 << 17;
const TRANS_COMPLETE: u32 = 1 << 18;
const BUS_RESET: u32 = 1 << 19;
const SUSPENDED: u32 = 1 << 4;
const CONNECTED: u32 = 1 << 16;
const VBUS: u32 = 1;
/// Bits of SIE_STATUS that software clears by writing one.
const SIE_CLEARABLE: u32 = 0xff0f_0810 & !CONNECTED;

/// What the device answers to a token.
#[derive(Debug, PartialEq, Eq)]
pub enum Handshake {
    Ack,
    Data(Vec<u8>),
    Nak,
    Stall,
}

/// Controller state.
pub struct Usb {
    pub dpram: Vec<u8>,
    addr_endp: u32,
    main_ctrl: u32,
    sie_ctrl: u32,
    sie_status: u32,
    buff_status: u32,
    frame: u32,
    muxing: u32,
    power: u32,
    stall_arm: u32,
    abort: u32,
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
            frame: 0,
            muxing: 0,
            power: 0,
            stall_arm: 0,
            abort: 0,
            inte: 0,
            intf: 0,
            other: [0; 16],
        }
    }
}

impl Usb {
    /// The device has switched its pull-up on.
    pub fn attached(&self) -> bool {
        self.main_ctrl & 1 != 0 && self.sie_ctrl & (1 << 16) != 0
    }

    /// Device address the firmware has set.
    pub fn address(&self) -> u8 {
        (self.addr_endp & 0x7f) as u8
    }

    /// A word of packet memory.
    pub fn word(&self, offset: usize) -> u32 {
        let o = offset & (DPRAM - 4);
        u32::from_le_bytes(self.dpram[o..o + 4].try_into().expect("four bytes"))
    }

    fn set_word(&mut self, offset: usize, value: u32) {
        self.dpram[offset..offset + 4].copy_from_slice(&value.to_le_bytes());
    }

    fn buffer_control(ep: usize, to_device: bool) -> usize {
        0x80 + 8 * ep + 4 * usize::from(to_device)
    }

    fn buffer(&self, ep: usize, to_device: bool) -> usize {
        if ep == 0 {
            return 0x100;
        }
        (self.word(8 * ep + 4 * usize::from(to_device)) & 0xffc0) as usize & (DPRAM - 1)
    }

    /// The host signals a bus reset.
    pub fn bus_reset(&mut self) {
        self.sie_status |= BUS_RESET | CONNECTED;
        self.addr_endp &= !0x7f;
    }

    /// Whether the firmware has not yet taken the bus reset.
    pub fn bus_reset_pending(&self) -> bool {
        self.sie_status & BUS_RESET != 0
    }

    /// Cable pulled: no VBUS, no connection.
    pub fn disconnect(&mut self) {
        self.sie_status &= !CONNECTED;
    }

    /// The bus has been idle for 3 ms.
    pub fn suspend(&mut self) {
        self.sie_status |= SUSPENDED;
    }

    /// Start of frame.
    pub fn start_of_frame(&mut self, number: u32) {
        self.frame = number & 0x7ff;
    }

    /// A SETUP token with its eight bytes; always accepted.
    pub fn setup(&mut self, packet: [u8; 8]) {
        self.dpram[..8].copy_from_slice(&packet);
        self.sie_status |= SETUP_REC;
        self.stall_arm &= !3;
    }

    fn stalled(&self, ep: usize, to_device: bool, control: u32) -> bool {
        let armed = ep != 0 || self.stall_arm & if to_device { 2 } else { 1 } != 0;
        control & STALL != 0 && armed
    }

    fn done(&mut self, ep: usize, to_device: bool) {
        self.buff_status |= 1 << (2 * ep + usize::from(to_device));
        self.sie_status |= TRANS_COMPLETE;
    }

    /// An IN token.
    pub fn token_in(&mut self, ep: usize) -> Handshake {
        let at = Self::buffer_control(ep, false);
        let control = self.word(at);
        if self.stalled(ep, false, control) {
            return Handshake::Stall;
        }
        if control & AVAILABLE == 0 || control & FULL == 0 {
            return Handshake::Nak;
        }
        let from = self.buffer(ep, false);
        let len = (control & LEN) as usize;
        let data = self.dpram[from..(from + len).min(DPRAM)].to_vec();
        self.set_word(at, control & !(AVAILABLE | FULL));
        self.done(ep, false);
        Handshake::Data(data)
    }

    /// An OUT token with its data.
    pub fn token_out(&mut self, ep: usize, data: &[u8]) -> Handshake {
        let at = Self::buffer_control(ep, true);
        let control = self.word(at);
        if self.stalled(ep, true, control) {
            return Handshake::Stall;
        }
        if control & AVAILABLE == 0 || control & FULL != 0 {
            return Handshake::Nak;
        }
        let to = self.buffer(ep, true);
        let len = data.len().min(DPRAM - to);
        self.dpram[to..to + len].copy_from_slice(&data[..len]);
        self.set_word(at, control & !(AVAILABLE | LEN) | FULL | len as u32);
        self.done(ep, true);
        Handshake::Ack
    }

    fn intr(&self) -> u32 {
        u32::from(self.sie_status & TRANS_COMPLETE != 0) << 3
            | u32::from(self.buff_status != 0) << 4
            | u32::from(self.sie_status & BUS_RESET != 0) << 12
            | u32::from(self.sie_status & SUSPENDED != 0) << 14
            | u32::from(self.sie_status & (1 << 11) != 0) << 15
            | u32::from(self.sie_status & SETUP_REC != 0) << 16
    }

    /// The interrupt output.
    pub fn irq_line(&self) -> bool {
        (self.intr() | self.intf) & self.inte != 0
    }

    /// Reads a register.
    pub fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => self.addr_endp,
            0x04..=0x3c => self.other[offset as usize / 4],
            0x40 => self.main_ctrl,
            0x48 => self.frame,
            0x4c => self.sie_ctrl,
            0x50 => self.sie_status | VBUS | 1 << 8,
            0x54 => 0,
            0x58 => self.buff_status,
            0x5c => 0,
            0x60 => self.abort,
            // An abort is done at once: no transaction is ever half-way when software looks.
            0x64 => self.abort,
            0x68 => self.stall_arm,
            0x6c | 0x70 => 0,
            0x74 => self.muxing,
            0x78 => self.power,
            0x8c => self.intr(),
            0x90 => self.inte,
            0x94 => self.intf,
            0x98 => (self.intr() | self.intf) & self.inte,
            _ => return None,
        })
    }

    /// Writes a register.
    pub fn write(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0x00 => self.addr_endp = value & 0x000f_007f,
            0x04..=0x3c => self.other[offset as usize / 4] = value,
            0x40 => self.main_ctrl = value & 0x8000_0003,
            0x4c => self.sie_ctrl = value,
            0x50 => self.sie_status &= !(value & SIE_CLEARABLE),
            0x58 => self.buff_status &= !value,
            0x60 => self.abort = value,
            0x68 => self.stall_arm = value & 3,
            0x74 => self.muxing = value & 0xf,
            0x78 => self.power = value & 0x3f,
            0x90 => self.inte = value & 0x000f_ffff,
            0x94 => self.intf = value & 0x000f_ffff,
            // Host-mode and PHY registers: storage without effect in device mode, as rp2040-hal clears them all at start.
            0x44 | 0x48 | 0x54 | 0x5c | 0x64 | 0x6c | 0x70 | 0x7c..=0x8c | 0x98 => {}
            _ => return false,
        }
        true
    }

    /// A write reached packet memory; false if it asks for what is not modelled.
    pub fn dpram_written(&self, offset: usize) -> bool {
        // Double buffering (bit 30 of an endpoint control word).
        !(8..0x80).contains(&offset) || self.word(offset) & (1 << 30) == 0
    }
}
