//! UART 0 at 115 200 baud: bytes in by polling, then by interrupt, then a message out. After the record 0x57 bytes come from outside (`scenario.rs`).
#![no_std]
#![no_main]

use peer_images::registers::{read, wait_for_event, write};
use peer_images::trace::{DONE, count_handled, finish, handled, record};
use peer_images::{clocks, start};

const UART0: u32 = 0x4003_4000;
const FR: u32 = UART0 + 0x18;
const IMSC: u32 = UART0 + 0x38;
const MIS: u32 = UART0 + 0x40;
const ICR: u32 = UART0 + 0x44;
const BUSY: u32 = 1 << 3;
const RXFE: u32 = 1 << 4;
const RX_TIMEOUT_AND_LEVEL: u32 = 1 << 6 | 1 << 4;
const UART0_IRQ: u32 = 20;
/// Bytes of each part.
const POLLED: u32 = 8;
const INTERRUPTED: u32 = 8;

extern "C" fn received() {
    record(0x20, read(MIS) & 1 << 4);
    while read(FR) & RXFE == 0 {
        record(0x21, read(UART0) & 0xff);
        count_handled();
    }
    write(ICR, RX_TIMEOUT_AND_LEVEL);
}

#[unsafe(no_mangle)]
extern "C" fn main() -> ! {
    clocks::start(clocks::IO_BANK0 | clocks::PADS_BANK0 | clocks::UART0);
    // 125 MHz / 16 / 115200 = 67.82: 67 + 52/64.
    write(UART0 + 0x24, 67);
    write(UART0 + 0x28, 52);
    // Eight bits; FIFOs off for what comes in: the peer knows no FIFO level.
    write(UART0 + 0x2c, 3 << 5);
    write(UART0 + 0x30, 1 << 9 | 1 << 8 | 1);
    record(0x01, read(UART0 + 0x24));
    record(0x02, read(UART0 + 0x28));
    record(0x03, read(UART0 + 0x2c));
    record(0x04, read(UART0 + 0x30));
    record(0x57, 0);
    for _ in 0..POLLED {
        while read(FR) & RXFE != 0 {}
        record(0x05, read(UART0) & 0xff);
    }
    start::handle(UART0_IRQ, 2, received);
    write(IMSC, 1 << 4);
    while handled() < INTERRUPTED {
        wait_for_event();
    }
    write(UART0 + 0x2c, 3 << 5 | 1 << 4);
    for byte in b"Nothing is quietly zero.\r\n" {
        write(UART0, u32::from(*byte));
        record(0x06, u32::from(*byte));
    }
    while read(FR) & BUSY != 0 {}
    finish(DONE)
}
