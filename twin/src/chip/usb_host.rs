//! A USB host with one CDC-ACM driver: enumerates what is plugged in, opens the port, moves bytes.
//!
//! Source: USB 2.0 specification chapters 5, 8 and 9; CDC PSTN subclass 1.2. It runs frames of 1 ms with at most 19 bulk transactions of
//! 64 bytes each, the most a full-speed host can do (USB 2.0 table 5-9).
//!
//! ```text
//! detached → (pull-up seen, 10 ms) → reset → wait for the device → control transfers → open
//! ```
//!
//! Bytes to the device wait in `to_device`, bytes from it in `from_device`; when `reading` is off the host leaves IN data in the device,
//! as a terminal that nobody reads does.

use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

use super::cdc_data::{Endpoints, data_endpoints};
use super::usb::{Data, Handshake, Usb};
use super::usb_control::{Control, Stage};
use super::usb_urbs::{Completed, Ended, Urbs};

/// Transactions a frame holds.
const SLOTS: u64 = 19;
/// Debounce after attach (USB 2.0, 7.1.7.3: 100 ms at least; shortened, since no contact bounces here), in frames.
const DEBOUNCE_FRAMES: u64 = 10;
/// Frames after which an unanswered control transfer is given up (USB 2.0, 9.2.6.4: 5 s).
const CONTROL_TIMEOUT_FRAMES: u64 = 5_000;

/// Frames without traffic after which a device is suspended (USB 2.0, 7.1.7.6: 3 ms).
const SUSPEND_FRAMES: u64 = 3;

#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
enum State {
    Detached,
    Debounce(u64),
    Resetting,
    Running,
}

/// The host and its view of the device.
#[derive(Clone, Serialize, Deserialize)]
pub struct UsbHost {
    state: State,
    plugged: bool,
    frame: u64,
    /// Frame of the last one with a host.
    idle_since: u64,
    slot: u64,
    next: u64,
    /// Cycle at which the frame began.
    frame_start: u64,
    /// The host sends no frames.
    asleep: bool,
    /// The device may end that.
    may_wake: bool,
    queue: VecDeque<Control>,
    stage: Stage,
    moved: usize,
    buffer: Vec<u8>,
    started: u64,
    packet0: usize,
    /// PID of the next packet of a control transfer.
    pid0: bool,
    endpoints: Endpoints,
    /// Packets the device sent again, or with the wrong PID: acknowledged and dropped.
    pub repeated: u64,
    /// Bulk packets moved, in all and in the fullest frame.
    pub packets: u64,
    pub most_in_a_frame: u64,
    in_this_frame: u64,
    /// Descriptors read, in order: (type, bytes).
    pub descriptors: Vec<(u8, Vec<u8>)>,
    /// The port is configured and DTR is set.
    pub open: bool,
    /// The host takes IN data.
    pub reading: bool,
    /// Whoever reads from the host has room.
    pub room: bool,
    /// The host opens the console once the device is configured.
    pub opens: bool,
    pub to_device: VecDeque<u8>,
    pub from_device: VecDeque<u8>,
    /// Bytes the host has taken since it was made.
    pub received: u64,
    /// What went wrong, for people.
    pub faults: Vec<String>,
    /// The driver is outside; the twin's own is quiet.
    #[serde(skip)]
    pub urbs: Option<Urbs>,
}

impl Default for UsbHost {
    fn default() -> Self {
        Self {
            state: State::Detached,
            plugged: true,
            frame: 0,
            idle_since: 0,
            slot: 0,
            next: 0,
            frame_start: 0,
            asleep: false,
            may_wake: false,
            queue: VecDeque::new(),
            stage: Stage::Setup,
            moved: 0,
            buffer: Vec::new(),
            started: 0,
            packet0: 64,
            pid0: false,
            endpoints: Endpoints::default(),
            repeated: 0,
            packets: 0,
            most_in_a_frame: 0,
            in_this_frame: 0,
            descriptors: Vec::new(),
            open: false,
            reading: true,
            room: true,
            opens: true,
            to_device: VecDeque::new(),
            from_device: VecDeque::new(),
            received: 0,
            faults: Vec::new(),
            urbs: None,
        }
    }
}

impl UsbHost {
    /// Cycle of the next transaction slot.
    pub fn next_event(&self) -> u64 {
        self.next
    }

    /// Plugs the cable in or out.
    pub fn plug(&mut self, plugged: bool) {
        self.plugged = plugged;
    }

    /// The cable is in.
    pub fn plugged(&self) -> bool {
        self.plugged
    }

    /// The device was reset: its pull-up is gone for a moment.
    pub fn device_reset(&mut self) {
        self.detach();
    }

    fn detach(&mut self) {
        self.state = State::Detached;
        self.open = false;
        self.queue.clear();
        self.descriptors.clear();
        self.stage = Stage::Setup;
        if let Some(urbs) = &mut self.urbs {
            urbs.detach();
        }
    }

    /// Puts the bus to sleep (no frames any longer), or ends that.
    pub fn sleep(&mut self, asleep: bool) {
        self.asleep = asleep;
    }

    /// The host sends no frames.
    pub fn asleep(&self) -> bool {
        self.asleep
    }

    /// Lets the device end a sleep, as SET_FEATURE(DEVICE_REMOTE_WAKEUP) does.
    pub fn allow_wake(&mut self) {
        self.may_wake = true;
        self.request([0x00, 3, 1, 0, 0, 0, 0, 0], &[]);
    }

    /// Another slot, and a frame after the last. Slots divide the frame evenly.
    fn count_slot(&mut self, now: u64, cycles_per_ms: u64) {
        self.slot += 1;
        if self.slot >= SLOTS {
            self.slot = 0;
            self.frame += 1;
            self.frame_start = now;
            self.in_this_frame = 0;
        }
        let next = self.frame_start + cycles_per_ms * (self.slot + 1) / SLOTS;
        self.next = next.max(now + 1);
    }

    /// Nothing happens on the bus; after 3 ms of that the device is suspended. True if that is now.
    fn idle(&self, usb: &mut Usb) -> bool {
        let now = self.idle_since + SUSPEND_FRAMES == self.frame && self.slot == 0;
        if now {
            usb.suspend();
        }
        now
    }

    /// The host sleeps: it wakes when told to, or by the device.
    fn sleeps(&mut self, usb: &mut Usb) -> bool {
        if usb.take_wake_request() && self.may_wake {
            self.asleep = false;
        }
        if self.asleep {
            return true;
        }
        if usb.suspended() {
            usb.resume();
        }
        false
    }

    /// One slot at cycle `now`; `cycles_per_ms` sets the pace. Returns whether the device saw anything.
    pub fn advance(&mut self, usb: &mut Usb, now: u64, cycles_per_ms: u64) -> bool {
        self.count_slot(now, cycles_per_ms);
        if !self.plugged || !usb.attached() {
            if self.state != State::Detached {
                self.detach();
                self.idle_since = self.frame;
                usb.disconnect();
            }
            self.idle(usb);
            return false;
        }
        if self.state == State::Running {
            if self.sleeps(usb) {
                return self.idle(usb);
            }
            self.idle_since = self.frame;
            if self.slot == 0 {
                usb.start_of_frame(self.frame as u32);
            }
        }
        match self.state {
            State::Detached => {
                self.state = State::Debounce(self.frame + DEBOUNCE_FRAMES);
                false
            }
            State::Debounce(until) if self.frame < until => false,
            State::Debounce(_) => {
                usb.bus_reset();
                self.state = State::Resetting;
                true
            }
            State::Resetting => {
                if !usb.bus_reset_pending() {
                    self.enumerate();
                    self.state = State::Running;
                }
                false
            }
            State::Running if self.queue.is_empty() => match &mut self.urbs {
                Some(urbs) => urbs.slot(usb),
                None => self.bulk(usb),
            },
            State::Running => self.control(usb),
        }
    }

    fn request(&mut self, setup: [u8; 8], data: &[u8]) {
        self.queue.push_back(Control {
            setup,
            data: data.to_vec(),
            id: None,
        });
    }

    /// A control transfer of the driver outside.
    pub fn submit_control(&mut self, id: u32, setup: [u8; 8], data: &[u8]) {
        self.request(setup, data);
        if let Some(last) = self.queue.back_mut() {
            last.id = Some(id);
        }
    }

    /// Tells the driver outside of the end of its transfer at the head of the queue.
    fn tell(&mut self, transfer: &Control, ended: Ended) {
        let (Some(id), Some(urbs)) = (transfer.id, &mut self.urbs) else {
            return;
        };
        match (ended, [transfer.setup[0], transfer.setup[1]]) {
            (Ended::Done, [0x00, 9] | [0x01, 11]) => urbs.configured(),
            (Ended::Done, [0x02, 1]) => urbs.halt_cleared(transfer.setup[4]),
            _ => {}
        }
        let data = std::mem::take(&mut self.buffer);
        let moved = data.len().max(self.moved);
        urbs.completed.push_back(Completed {
            id,
            ended,
            data,
            moved,
        });
    }

    fn enumerate(&mut self) {
        self.packet0 = 8;
        self.request([0x80, 6, 0, 1, 0, 0, 8, 0], &[]);
        self.request([0x00, 5, 7, 0, 0, 0, 0, 0], &[]);
        self.request([0x80, 6, 0, 1, 0, 0, 18, 0], &[]);
        self.request([0x80, 6, 0, 2, 0, 0, 9, 0], &[]);
        self.stage = Stage::Setup;
    }

    /// A slot of the control transfer at the head of the queue.
    fn control(&mut self, usb: &mut Usb) -> bool {
        let Some(transfer) = self.queue.front().cloned() else {
            return false;
        };
        let length = usize::from(u16::from_le_bytes([transfer.setup[6], transfer.setup[7]]));
        let to_host = transfer.setup[0] & 0x80 != 0;
        if self.stage != Stage::Setup && self.frame > self.started + CONTROL_TIMEOUT_FRAMES {
            self.tell(&transfer, Ended::TimedOut);
            self.fault(format!(
                "control transfer {:02x?} timed out",
                transfer.setup
            ));
            return false;
        }
        let answer = match self.stage {
            Stage::Setup => {
                usb.setup(transfer.setup);
                self.pid0 = true;
                self.started = self.frame;
                self.buffer.clear();
                self.moved = 0;
                self.stage = match (to_host, length) {
                    (_, 0) => Stage::StatusIn,
                    (true, _) => Stage::DataIn,
                    (false, _) => Stage::DataOut,
                };
                return true;
            }
            Stage::DataIn | Stage::StatusIn => usb.token_in(0),
            Stage::DataOut => {
                let end = (self.moved + self.packet0).min(transfer.data.len());
                let bytes = transfer.data[self.moved..end].to_vec();
                let pid = self.pid0;
                usb.token_out(0, &Data { pid, bytes })
            }
            Stage::StatusOut => {
                let (pid, bytes) = (true, Vec::new());
                usb.token_out(0, &Data { pid, bytes })
            }
        };
        // The status stage is always DATA1 (USB 2.0, 8.5.3).
        let wanted = self.pid0 || self.stage == Stage::StatusIn;
        match (self.stage, answer) {
            (_, Handshake::Nak | Handshake::Silence) => return false,
            (_, Handshake::Data(data)) if data.pid != wanted => {
                self.repeated += 1;
                return true;
            }
            (_, Handshake::Stall) => {
                self.tell(&transfer, Ended::Stalled);
                self.fault(format!("control transfer {:02x?} stalled", transfer.setup));
                return true;
            }
            (Stage::DataIn, Handshake::Data(Data { bytes, .. })) => {
                let short = bytes.len() < self.packet0;
                self.pid0 = !self.pid0;
                self.buffer.extend(&bytes);
                if short || self.buffer.len() >= length {
                    self.stage = Stage::StatusOut;
                }
            }
            (Stage::DataOut, Handshake::Ack) => {
                self.pid0 = !self.pid0;
                self.moved = (self.moved + self.packet0).min(transfer.data.len());
                if self.moved == transfer.data.len() {
                    self.stage = Stage::StatusIn;
                }
            }
            _ => {
                self.queue.pop_front();
                self.stage = Stage::Setup;
                self.finished(&transfer);
            }
        }
        true
    }

    fn fault(&mut self, text: String) {
        self.faults.push(text);
        self.queue.pop_front();
        self.stage = Stage::Setup;
    }

    fn finished(&mut self, transfer: &Control) {
        if transfer.id.is_some() {
            return self.tell(transfer, Ended::Done);
        }
        if transfer.setup[1] == 6 {
            let kind = transfer.setup[3];
            let bytes = std::mem::take(&mut self.buffer);
            match (kind, bytes.len()) {
                (1, 8..=17) => self.packet0 = usize::from(bytes[7]).max(8),
                // Manufacturer, product, serial number, in US English, as far as there are any (USB 2.0, 9.6.1).
                (1, _) => {
                    for index in bytes.iter().skip(14).take(3).filter(|n| **n != 0) {
                        self.request([0x80, 6, *index, 3, 0x09, 0x04, 255, 0], &[]);
                    }
                }
                (2, 4..=9) => {
                    let total = u16::from_le_bytes([bytes[2], bytes[3]]).to_le_bytes();
                    self.request([0x80, 6, 0, 2, 0, 0, total[0], total[1]], &[]);
                }
                (2, _) if self.urbs.is_some() => {
                    // The rest is the driver's.
                    if let Some(urbs) = &mut self.urbs {
                        urbs.ready = true;
                    }
                }
                (2, _) => match data_endpoints(&bytes) {
                    Some(endpoints) => {
                        self.endpoints = endpoints;
                        self.request([0x00, 9, 1, 0, 0, 0, 0, 0], &[]);
                        // Line coding 115200 8N1, then DTR and RTS.
                        self.request(
                            [0x21, 0x20, 0, 0, 0, 0, 7, 0],
                            &[0x00, 0xc2, 0x01, 0x00, 0, 0, 8],
                        );
                        if self.opens {
                            self.request([0x21, 0x22, 3, 0, 0, 0, 0, 0], &[]);
                        }
                    }
                    None => self.faults.push("no CDC data interface".into()),
                },
                _ => {}
            }
            self.descriptors.push((kind, bytes));
        }
        if transfer.setup[..2] == [0x21, 0x22] {
            self.open = transfer.setup[2] & 1 != 0;
        }
    }

    /// A bulk transaction: OUT while there is something to say, IN otherwise, in turn.
    fn bulk(&mut self, usb: &mut Usb) -> bool {
        if !self.open {
            return false;
        }
        if self.slot.is_multiple_of(2) && !self.to_device.is_empty() {
            let bytes: Vec<u8> = self.to_device.iter().take(64).copied().collect();
            let (pid, len) = (self.endpoints.out_pid, bytes.len());
            match usb.token_out(self.endpoints.bulk_out, &Data { pid, bytes }) {
                Handshake::Ack => {
                    self.endpoints.out_pid = !pid;
                    self.to_device.drain(..len);
                    self.count_packet();
                    return true;
                }
                Handshake::Stall => self.clear_halt(self.endpoints.bulk_out),
                _ => {}
            }
        }
        if !self.reading || !self.room {
            return false;
        }
        match usb.token_in(self.endpoints.bulk_in) {
            Handshake::Data(Data { pid, .. }) if pid != self.endpoints.in_pid => {
                self.repeated += 1;
                true
            }
            Handshake::Data(Data { bytes, pid }) => {
                self.endpoints.in_pid = !pid;
                self.received += bytes.len() as u64;
                self.from_device.extend(bytes);
                self.count_packet();
                true
            }
            Handshake::Stall => {
                self.clear_halt(self.endpoints.bulk_in | 0x80);
                false
            }
            _ => false,
        }
    }

    fn count_packet(&mut self) {
        self.packets += 1;
        self.in_this_frame += 1;
        self.most_in_a_frame = self.most_in_a_frame.max(self.in_this_frame);
    }

    /// A bulk endpoint is halted: the host asks the device to go on, from DATA0 (USB 2.0, 9.4.5).
    fn clear_halt(&mut self, endpoint: usize) {
        match endpoint & 0x80 {
            0 => self.endpoints.out_pid = false,
            _ => self.endpoints.in_pid = false,
        }
        self.request([0x02, 1, 0, 0, endpoint as u8, 0, 0, 0], &[]);
    }
}
