//! PIO and DMA: state machine 0 samples pin 19 into a ring while state machine 1 makes a waveform on pin 8. After the record 0x57 the
//! pin is driven from outside (`scenario.rs`).
#![no_std]
#![no_main]

use peer_images::registers::{read, wait_for_event, write};
use peer_images::trace::{DONE, count_handled, finish, handled, record};
use peer_images::{clocks, start};

const IO_BANK0: u32 = 0x4001_4000;
const PADS_BANK0: u32 = 0x4001_c000;
const DMA: u32 = 0x5000_0000;
const DMA_INTR: u32 = DMA + 0x400;
const DMA_INTE0: u32 = DMA + 0x404;
const PIO0: u32 = 0x5020_0000;
const PIO_CTRL: u32 = PIO0;
const PIO_FDEBUG: u32 = PIO0 + 0x08;
const INSTR_MEM: u32 = PIO0 + 0x48;
const SM0: u32 = PIO0 + 0xc8;
const SM1: u32 = SM0 + 0x18;
const DMA_IRQ_0: u32 = 11;
const SAMPLED: u32 = 19;
const WAVE: u32 = 8;
/// 32 words on a boundary of 128 bytes, in a bank of SRAM of its own, so that the processor never contests a transfer.
const RING: u32 = 0x2004_0000;
const WORDS: u32 = 32;
const ROUNDS: u32 = 3;

extern "C" fn half_done() {
    record(0x10, read(DMA_INTR) & 1);
    write(DMA_INTR, 1);
    // AL1_TRANS_COUNT_TRIG: again, the ring goes on where it is.
    write(DMA + 0x1c, WORDS / 2);
    count_handled();
}

#[unsafe(no_mangle)]
extern "C" fn main() -> ! {
    let blocks = clocks::DMA | clocks::PIO0 | clocks::IO_BANK0 | clocks::PADS_BANK0;
    clocks::start(blocks);
    for pin in [SAMPLED, WAVE] {
        write(IO_BANK0 + 8 * pin + 4, 6);
        write(PADS_BANK0 + 4 + 4 * pin, 0x52);
    }
    // 0: in pins, 1. 1: set pins, 1 [6]; 2: set pins, 0 [2]; 3: set pins, 1; 4: set pins, 0 [11].
    for (n, word) in (0..).zip([0x4001, 0xe601, 0xe200, 0xe001, 0xeb00]) {
        write(INSTR_MEM + 4 * n, word);
    }
    // State machine 0: every 15 cycles, autopush at 32 bits, shifting left.
    write(SM0, 15 << 16);
    write(SM0 + 4, 0);
    write(SM0 + 8, 1 << 16);
    write(SM0 + 0x14, SAMPLED << 15);
    // State machine 1: every 3 cycles, wrapped over 1 to 4, SET pin 8.
    write(SM1, 3 << 16);
    write(SM1 + 4, 4 << 12 | 1 << 7);
    write(SM1 + 0x14, 1 << 26 | WAVE << 5);
    // `set pindirs, 1`, then to its program.
    write(SM1 + 0x10, 0xe081);
    write(SM1 + 0x10, 0x0001);
    // Channel 0: RX FIFO 0 into a ring of 128 bytes, in halves.
    write(DMA + 4, RING);
    write(DMA, PIO0 + 0x20);
    write(DMA + 8, WORDS / 2);
    start::handle(DMA_IRQ_0, 1, half_done);
    write(DMA_INTE0, 1);
    write(DMA + 0xc, 4 << 15 | 1 << 10 | 7 << 6 | 1 << 5 | 2 << 2 | 1);
    record(0x57, 0);
    write(PIO_CTRL, 0b11 << 8 | 0b11);
    while handled() < 2 * ROUNDS {
        wait_for_event();
        record(0x01, handled());
    }
    write(PIO_CTRL, 0);
    record(0x02, read(PIO_FDEBUG));
    for n in 0..WORDS {
        record(0x03, read(RING + 4 * n));
    }
    finish(DONE)
}
