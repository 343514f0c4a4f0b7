//! The controller from both its sides: registers and packet memory as firmware sets them, tokens as the bus brings them.

use super::{Damage, Data, Handshake, Usb};
use crate::chip::usb_host::UsbHost;

const SIE_CTRL: u32 = 0x4c;
const SIE_STATUS: u32 = 0x50;
const BUFF_STATUS: u32 = 0x58;
const SHOULD_HANDLE: u32 = 0x5c;
const EP_ABORT: u32 = 0x60;
const EP_ABORT_DONE: u32 = 0x64;
const EP_STALL_ARM: u32 = 0x68;
const EP_STATUS_STALL_NAK: u32 = 0x70;
const INTR: u32 = 0x8c;
const INTE: u32 = 0x90;
const INTS: u32 = 0x98;

const ENABLED: u32 = 1 << 31;
const DOUBLE: u32 = 1 << 30;
const EACH: u32 = 1 << 29;
const BOTH: u32 = 1 << 28;
const BULK: u32 = 2 << 26;
const FULL: u32 = 1 << 15;
const LAST: u32 = 1 << 14;
const PID: u32 = 1 << 13;
const RESET: u32 = 1 << 12;
const STALL: u32 = 1 << 11;
const AVAILABLE: u32 = 1 << 10;

/// Bits of BUFF_STATUS and its like.
const EP1_IN: u32 = 1 << 2;
const EP1_OUT: u32 = 1 << 3;

/// A controller with endpoint 1 in both directions at 180 and 200.
fn device(settings: u32) -> Usb {
    let mut usb = Usb::default();
    usb.write(0x40, 1);
    usb.write(SIE_CTRL, 1 << 16 | 1 << 29);
    put(&mut usb, 0x08, ENABLED | BULK | settings | 0x180);
    put(&mut usb, 0x0c, ENABLED | BULK | settings | 0x200);
    usb
}

fn put(usb: &mut Usb, at: usize, word: u32) -> bool {
    usb.dpram[at..at + 4].copy_from_slice(&word.to_le_bytes());
    usb.dpram_written(at)
}

fn get(usb: &Usb, at: usize) -> u32 {
    usb.word(at)
}

fn reg(usb: &mut Usb, offset: u32) -> u32 {
    usb.read(offset).expect("a register")
}

fn data(pid: bool, bytes: &[u8]) -> Data {
    Data {
        pid,
        bytes: bytes.to_vec(),
    }
}

/// Buffer control words of endpoint 1.
const IN: usize = 0x88;
const OUT: usize = 0x8c;

#[test]
fn an_in_buffer_is_sent_once_with_its_pid_and_told() {
    let mut usb = device(EACH);
    usb.write(INTE, 1 << 4);
    assert_eq!(usb.token_in(1), Handshake::Nak, "nothing there");
    usb.dpram[0x180..0x183].copy_from_slice(b"abc");
    put(&mut usb, IN, FULL | PID | AVAILABLE | 3);
    assert_eq!(usb.token_in(1), Handshake::Data(data(true, b"abc")));
    assert_eq!(
        get(&usb, IN),
        PID | 3,
        "AVAILABLE and FULL fall, the rest stays"
    );
    assert_eq!(reg(&mut usb, BUFF_STATUS), EP1_IN);
    assert!(usb.irq_line());
    usb.write(BUFF_STATUS, EP1_IN);
    assert!(!usb.irq_line());
    assert_eq!(usb.token_in(1), Handshake::Nak);
}

#[test]
fn an_out_packet_with_the_wrong_pid_is_acknowledged_and_dropped() {
    let mut usb = device(EACH);
    put(&mut usb, OUT, AVAILABLE | PID | 64);
    assert_eq!(usb.token_out(1, &data(false, b"old")), Handshake::Ack);
    assert_eq!(get(&usb, OUT), AVAILABLE | PID | 64, "still waiting");
    assert_ne!(reg(&mut usb, SIE_STATUS) & 1 << 31, 0, "DATA_SEQ_ERROR");
    assert_ne!(reg(&mut usb, INTR) & 1 << 5, 0);
    usb.write(SIE_STATUS, 1 << 31);
    assert_eq!(usb.token_out(1, &data(true, b"new")), Handshake::Ack);
    assert_eq!(get(&usb, OUT), FULL | PID | 3);
    assert_eq!(&usb.dpram[0x200..0x203], b"new");
    assert_eq!(reg(&mut usb, SIE_STATUS) & 1 << 31, 0);
    assert_eq!(usb.token_out(1, &data(false, b"x")), Handshake::Nak, "full");
}

#[test]
fn a_packet_longer_than_its_buffer_is_not_answered() {
    let mut usb = device(EACH);
    put(&mut usb, OUT, AVAILABLE | 2);
    assert_eq!(usb.token_out(1, &data(false, b"abc")), Handshake::Silence);
    assert_ne!(reg(&mut usb, INTR) & 1 << 7, 0, "RX_OVERFLOW");
    assert_eq!(get(&usb, OUT), AVAILABLE | 2);
}

#[test]
fn a_disabled_endpoint_does_not_answer() {
    let mut usb = device(EACH);
    put(&mut usb, 0x08, BULK | EACH | 0x180);
    put(&mut usb, IN, FULL | AVAILABLE | 1);
    assert_eq!(usb.token_in(1), Handshake::Silence);
    assert_eq!(usb.token_in(2), Handshake::Silence);
}

#[test]
fn both_halves_of_a_double_buffer_take_turns() {
    let mut usb = device(DOUBLE | EACH);
    usb.dpram[0x180] = b'a';
    usb.dpram[0x180 + 64] = b'b';
    put(
        &mut usb,
        IN,
        (FULL | AVAILABLE | 1) | (FULL | PID | AVAILABLE | 1) << 16,
    );
    assert_eq!(usb.token_in(1), Handshake::Data(data(false, b"a")));
    assert_eq!(
        (reg(&mut usb, BUFF_STATUS), reg(&mut usb, SHOULD_HANDLE)),
        (EP1_IN, 0)
    );
    usb.write(BUFF_STATUS, EP1_IN);
    assert_eq!(usb.token_in(1), Handshake::Data(data(true, b"b")));
    assert_eq!(reg(&mut usb, SHOULD_HANDLE), EP1_IN, "the second half now");
    assert_eq!(get(&usb, IN), 1 | (PID | 1) << 16);
    // Only the second half is filled: the first is next, so the host waits.
    put(&mut usb, IN, 1 | (FULL | AVAILABLE | 1) << 16);
    assert_eq!(usb.token_in(1), Handshake::Nak);
    put(
        &mut usb,
        IN,
        (FULL | AVAILABLE | 1) | (FULL | AVAILABLE | 1) << 16,
    );
    assert_eq!(usb.token_in(1), Handshake::Data(data(false, b"a")));
    // Out: the second half lies 64 behind the first.
    put(
        &mut usb,
        OUT,
        (AVAILABLE | 64) | (AVAILABLE | PID | 64) << 16,
    );
    assert_eq!(usb.token_out(1, &data(false, b"1")), Handshake::Ack);
    assert_eq!(usb.token_out(1, &data(true, b"2")), Handshake::Ack);
    assert_eq!((usb.dpram[0x200], usb.dpram[0x240]), (b'1', b'2'));
    assert_eq!(get(&usb, OUT), (FULL | 1) | (FULL | PID | 1) << 16);
}

#[test]
fn the_selector_goes_back_to_the_first_half_when_told() {
    let mut usb = device(DOUBLE | EACH);
    put(
        &mut usb,
        IN,
        (FULL | AVAILABLE | 1) | (FULL | AVAILABLE | 2) << 16,
    );
    usb.token_in(1);
    put(
        &mut usb,
        IN,
        RESET | FULL | AVAILABLE | 1 | (FULL | AVAILABLE | 2) << 16,
    );
    match usb.token_in(1) {
        Handshake::Data(data) => assert_eq!(data.bytes.len(), 1, "the first half again"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_interrupt_for_both_buffers_comes_after_the_second_or_the_last() {
    let mut usb = device(DOUBLE | BOTH);
    put(
        &mut usb,
        IN,
        (FULL | AVAILABLE | 1) | (FULL | AVAILABLE | 1) << 16,
    );
    usb.token_in(1);
    assert_eq!(reg(&mut usb, BUFF_STATUS), 0);
    usb.token_in(1);
    assert_eq!(reg(&mut usb, BUFF_STATUS), EP1_IN);
    usb.write(BUFF_STATUS, EP1_IN);
    put(&mut usb, IN, FULL | LAST | AVAILABLE | 1);
    usb.token_in(1);
    assert_eq!(reg(&mut usb, BUFF_STATUS), EP1_IN);
    assert_ne!(reg(&mut usb, INTR) & 1 << 3, 0, "TRANS_COMPLETE");
}

#[test]
fn a_single_buffer_without_its_interrupt_tells_nobody() {
    let mut usb = device(0);
    put(&mut usb, OUT, AVAILABLE | 64);
    assert_eq!(usb.token_out(1, &data(false, b"")), Handshake::Ack);
    assert_eq!(reg(&mut usb, BUFF_STATUS) & EP1_OUT, 0);
}

#[test]
fn endpoint_0_stalls_only_while_armed_and_setup_disarms_it() {
    let mut usb = device(EACH);
    put(&mut usb, 0x80, STALL);
    assert_eq!(usb.token_in(0), Handshake::Nak);
    usb.write(EP_STALL_ARM, 1);
    assert_eq!(usb.token_in(0), Handshake::Stall);
    usb.setup([0; 8]);
    assert_eq!(reg(&mut usb, EP_STALL_ARM), 0);
    assert_eq!(usb.token_in(0), Handshake::Nak);
    assert_ne!(reg(&mut usb, INTR) & 1 << 16, 0, "SETUP_REQ");
    put(&mut usb, IN, STALL);
    assert_eq!(usb.token_in(1), Handshake::Stall, "others need no arming");
}

#[test]
fn stalls_and_naks_are_noted_where_asked() {
    let mut usb = device(1 << 16 | 1 << 17);
    usb.write(INTE, 1 << 19);
    usb.token_in(1);
    assert_eq!(reg(&mut usb, EP_STATUS_STALL_NAK), EP1_IN);
    assert!(usb.irq_line());
    usb.write(EP_STATUS_STALL_NAK, EP1_IN);
    put(&mut usb, OUT, STALL);
    usb.token_out(1, &data(false, b""));
    assert_eq!(reg(&mut usb, EP_STATUS_STALL_NAK), EP1_OUT);
    // Endpoint 0 has its bits in SIE_CTRL.
    usb.write(EP_STATUS_STALL_NAK, EP1_OUT);
    usb.token_in(0);
    assert_eq!(reg(&mut usb, EP_STATUS_STALL_NAK), 0);
    usb.write(SIE_CTRL, 1 << 16 | 1 << 27);
    usb.token_in(0);
    assert_eq!(reg(&mut usb, EP_STATUS_STALL_NAK), 1);
}

#[test]
fn an_aborted_endpoint_naks_until_it_is_let_go() {
    let mut usb = device(EACH);
    usb.write(INTE, 1 << 18);
    put(&mut usb, IN, FULL | AVAILABLE | 1);
    usb.write(EP_ABORT, EP1_IN);
    assert_eq!(reg(&mut usb, EP_ABORT_DONE), EP1_IN);
    assert!(usb.irq_line());
    assert_eq!(usb.token_in(1), Handshake::Nak);
    usb.write(EP_ABORT_DONE, EP1_IN);
    assert!(!usb.irq_line());
    usb.write(EP_ABORT, 0);
    assert!(matches!(usb.token_in(1), Handshake::Data(_)));
}

#[test]
fn suspend_resume_and_remote_wake_up() {
    let mut usb = device(EACH);
    usb.write(INTE, 1 << 14 | 1 << 15);
    usb.write(SIE_CTRL, 1 << 16 | 1 << 12);
    assert!(!usb.take_wake_request(), "nothing to wake");
    usb.suspend();
    assert_eq!(reg(&mut usb, INTS), 1 << 14);
    usb.write(SIE_STATUS, 1 << 4);
    assert_eq!(reg(&mut usb, INTS), 0);
    usb.write(SIE_CTRL, 1 << 16 | 1 << 12);
    assert_eq!(reg(&mut usb, SIE_CTRL) & 1 << 12, 0, "clears itself");
    assert!(usb.take_wake_request());
    assert!(!usb.take_wake_request(), "told once");
    usb.resume();
    assert!(!usb.suspended());
    assert_eq!(reg(&mut usb, INTS), 1 << 15);
    usb.write(SIE_STATUS, 1 << 11);
    assert_eq!(reg(&mut usb, INTS), 0);
}

#[test]
fn frames_connection_reset_and_damage_show_in_their_bits() {
    let mut usb = device(EACH);
    usb.start_of_frame(0x801);
    assert_ne!(reg(&mut usb, INTR) & 1 << 17, 0);
    assert_eq!(reg(&mut usb, 0x48), 1, "eleven bits");
    assert_eq!(
        reg(&mut usb, INTR) & 1 << 17,
        0,
        "cleared by reading SOF_RD"
    );
    usb.write(0x00, 5);
    usb.bus_reset();
    assert_eq!(reg(&mut usb, 0x00), 0, "the address is gone");
    assert_eq!(reg(&mut usb, INTR) >> 12 & 3, 3, "reset and connection");
    usb.write(SIE_STATUS, 1 << 19 | 1 << 16);
    assert_eq!(reg(&mut usb, INTR) >> 12 & 3, 0);
    assert_ne!(
        reg(&mut usb, SIE_STATUS) & 1 << 16,
        0,
        "CONNECTED is no event"
    );
    usb.disconnect();
    assert_eq!(reg(&mut usb, INTR) >> 12 & 3, 2);
    for (damage, bit) in [
        (Damage::Crc, 9),
        (Damage::BitStuff, 8),
        (Damage::Overflow, 7),
        (Damage::Timeout, 6),
    ] {
        usb.damaged(damage);
        assert_ne!(reg(&mut usb, INTR) & 1 << bit, 0, "{damage:?}");
        usb.write(SIE_STATUS, 0x0f00_0000);
        assert_eq!(reg(&mut usb, INTR) & 1 << bit, 0);
    }
}

#[test]
fn what_is_not_modelled_is_refused() {
    let mut usb = device(EACH);
    assert!(
        !put(&mut usb, 0x10, ENABLED | 1 << 26 | 0x180),
        "isochronous"
    );
    assert!(put(&mut usb, 0x10, 1 << 26), "not before it is enabled");
    assert!(!usb.write(0x40, 0b11), "host mode");
    assert!(!usb.write(SIE_CTRL, 1), "host's transactions");
    assert!(!usb.write(0x7c, 1), "the PHY by hand");
    assert!(usb.write(0x7c, 0));
}

/// A descriptor with a CDC data interface: bulk IN 1, OUT 1.
const CONFIGURATION: [u8; 32] = [
    9, 2, 32, 0, 1, 1, 0, 0x80, 50, 9, 4, 0, 0, 2, 10, 0, 0, 0, 7, 5, 0x81, 2, 64, 0, 0, 7, 5, 1,
    2, 64, 0, 0,
];
const DEVICE: [u8; 18] = [18, 1, 0, 2, 2, 0, 0, 64, 9, 0x12, 1, 0, 0, 1, 0, 0, 0, 1];

/// The least firmware that the host opens: answers control transfers, sends full packets without end.
#[derive(Default)]
struct Firmware {
    in_pid: u32,
    reply: Vec<u8>,
    sent: usize,
}

impl Firmware {
    /// Looks at the controller once, as a main loop does.
    fn poll(&mut self, usb: &mut Usb) {
        if usb.bus_reset_pending() {
            usb.write(SIE_STATUS, 1 << 19);
            *self = Self::default();
            put(usb, IN, 0);
        }
        if reg(usb, SIE_STATUS) & 1 << 17 != 0 {
            usb.write(SIE_STATUS, 1 << 17);
            let setup: [u8; 8] = usb.dpram[..8].try_into().expect("eight bytes");
            let length = usize::from(setup[6]) | usize::from(setup[7]) << 8;
            let answer: &[u8] = match (setup[0], setup[1], setup[3]) {
                (0x80, 6, 1) => &DEVICE,
                (0x80, 6, 2) => &CONFIGURATION,
                _ => &[],
            };
            self.reply = answer[..length.min(answer.len())].to_vec();
            self.sent = 0;
            if setup[0] & 0x80 == 0 && length > 0 {
                put(usb, 0x84, AVAILABLE | PID | 64);
            }
            self.answer(usb);
        }
        if usb.word(0x84) & FULL != 0 {
            put(usb, 0x84, AVAILABLE | PID | 64);
        }
        if usb.word(IN) & AVAILABLE == 0 {
            put(usb, IN, FULL | self.in_pid | AVAILABLE | 64);
            self.in_pid ^= PID;
        }
    }

    fn answer(&mut self, usb: &mut Usb) {
        let part = &self.reply[self.sent..];
        usb.dpram[0x100..0x100 + part.len()].copy_from_slice(part);
        put(usb, 0x80, FULL | PID | AVAILABLE | part.len() as u32);
        if !self.reply.is_empty() {
            put(usb, 0x84, AVAILABLE | PID | 64);
        }
    }
}

const CYCLES_PER_MS: u64 = 120_000;

/// Runs host and firmware for so many milliseconds from a cycle on; the cycle after them.
fn run(host: &mut UsbHost, usb: &mut Usb, firmware: &mut Firmware, from: u64, ms: u64) -> u64 {
    let mut now = from;
    while now < from + ms * CYCLES_PER_MS {
        host.advance(usb, now, CYCLES_PER_MS);
        firmware.poll(usb);
        now = host.next_event();
    }
    now
}

#[test]
fn a_host_takes_nineteen_bulk_packets_a_frame_and_no_more() {
    let (mut host, mut usb) = (UsbHost::default(), device(EACH));
    let mut firmware = Firmware::default();
    let now = run(&mut host, &mut usb, &mut firmware, 0, 100);
    assert!(host.open, "{:?}", host.faults);
    let before = (host.packets, host.received);
    run(&mut host, &mut usb, &mut firmware, now, 100);
    assert_eq!(host.most_in_a_frame, 19);
    let packets = host.packets - before.0;
    assert!((1_899..=1_901).contains(&packets), "{packets} in 100 ms");
    assert_eq!(host.received - before.1, 64 * packets);
    assert_eq!(host.repeated, 0);
}

#[test]
fn a_device_that_forgets_its_toggle_loses_every_second_packet() {
    let (mut host, mut usb) = (UsbHost::default(), device(EACH));
    let mut firmware = Firmware::default();
    let now = run(&mut host, &mut usb, &mut firmware, 0, 100);
    let mut next = now;
    let (mut sent, before) = (0, host.packets);
    while sent < 100 {
        host.advance(&mut usb, next, CYCLES_PER_MS);
        next = host.next_event();
        if usb.word(IN) & AVAILABLE == 0 {
            put(&mut usb, IN, FULL | AVAILABLE | 64);
            sent += 1;
        }
    }
    assert!(host.repeated >= 97, "{}", host.repeated);
    assert!(host.packets - before <= 3, "{}", host.packets - before);
}

#[test]
fn a_sleeping_host_suspends_the_device_and_wakes_by_itself_or_by_the_device() {
    let (mut host, mut usb) = (UsbHost::default(), device(EACH));
    let mut firmware = Firmware::default();
    let mut now = run(&mut host, &mut usb, &mut firmware, 0, 100);
    host.sleep(true);
    let packets = host.packets;
    now = run(&mut host, &mut usb, &mut firmware, now, 2);
    assert!(!usb.suspended(), "not yet");
    now = run(&mut host, &mut usb, &mut firmware, now, 4);
    assert!(usb.suspended());
    assert!(host.packets - packets <= 19, "it sends nothing");
    // Not allowed to wake it.
    usb.write(SIE_CTRL, 1 << 16 | 1 << 29 | 1 << 12);
    now = run(&mut host, &mut usb, &mut firmware, now, 4);
    assert!(usb.suspended());
    host.sleep(false);
    now = run(&mut host, &mut usb, &mut firmware, now, 4);
    assert!(!usb.suspended());
    assert!(host.packets > packets + 19);
    assert_ne!(reg(&mut usb, SIE_STATUS) & 1 << 11, 0, "RESUME");
    host.allow_wake();
    now = run(&mut host, &mut usb, &mut firmware, now, 4);
    host.sleep(true);
    now = run(&mut host, &mut usb, &mut firmware, now, 10);
    assert!(usb.suspended());
    usb.write(SIE_CTRL, 1 << 16 | 1 << 29 | 1 << 12);
    run(&mut host, &mut usb, &mut firmware, now, 4);
    assert!(!usb.suspended() && !host.asleep());
}

#[test]
fn a_halted_endpoint_is_cleared_by_the_host() {
    let (mut host, mut usb) = (UsbHost::default(), device(EACH));
    let mut firmware = Firmware::default();
    let now = run(&mut host, &mut usb, &mut firmware, 0, 100);
    put(&mut usb, IN, STALL | AVAILABLE);
    let mut next = now;
    while reg(&mut usb, SIE_STATUS) & 1 << 17 == 0 {
        assert!(next < now + CYCLES_PER_MS, "the host asks at once");
        host.advance(&mut usb, next, CYCLES_PER_MS);
        next = host.next_event();
    }
    // CLEAR_FEATURE(ENDPOINT_HALT) for IN 1.
    assert_eq!(&usb.dpram[..8], [2, 1, 0, 0, 0x81, 0, 0, 0]);
}
