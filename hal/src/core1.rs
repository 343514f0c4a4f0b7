//! The second core: started once, with its own stack and one value that becomes its own; and its way to wake the first.
//!
//! ```text
//!   core 0: launch(context, entry) ── FIFO 0,0,1,VTOR,SP,entry ──▶ ROM on core 1 ──▶ start: interrupts masked ──▶ entry(context)
//!   core 1: wake_core0() ── one word in the FIFO ──▶ SIO_IRQ_PROC0 pending on core 0 ──▶ WFI ends; drain_wakes() lowers the line
//! ```
//! The stack fills SCRATCH_X, a bank that core 0 and DMA do not use, but for the words of [`crate::kept`] below it. Nothing guards its end: core 1's
//! call depth is fixed, and the twin measured 572 of the 3840 bytes in use on a dense recording.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicPtr, Ordering, fence};
use rp2040_hal::{pac, sio::SioFifo};

/// Bytes of core 1's stack: the bank but for what outlives a reset.
pub const STACK_BYTES: usize = 4096 - 4 * crate::kept::WORDS;

#[repr(C, align(8))]
struct Stack(UnsafeCell<[u8; STACK_BYTES]>);
// SAFETY: only core 1's stack pointer ever points into it.
unsafe impl Sync for Stack {}

#[unsafe(link_section = ".core1_stack")]
static STACK: Stack = Stack(UnsafeCell::new([0; STACK_BYTES]));

static CONTEXT: AtomicPtr<()> = AtomicPtr::new(core::ptr::null_mut());
static ENTRY: AtomicPtr<()> = AtomicPtr::new(core::ptr::null_mut());

/// First address of core 1's stack and the one behind it.
pub(crate) fn stack() -> (u32, u32) {
    let from = STACK.0.get() as u32;
    (from, from + STACK_BYTES as u32)
}

/// The right to start core 1; exists once.
pub struct Core1 {
    pub(crate) psm: pac::PSM,
    pub(crate) fifo: SioFifo,
}

/// Core 0's end of the FIFO after the start.
pub struct Wakes {
    fifo: SioFifo,
}

impl Core1 {
    /// Starts core 1 in `entry` with `context`, interrupts masked.
    pub fn launch<T: Send + 'static>(
        mut self,
        context: &'static mut T,
        entry: fn(&'static mut T) -> !,
    ) -> Wakes {
        CONTEXT.store(core::ptr::from_mut(context).cast(), Ordering::Relaxed);
        ENTRY.store(entry as *mut (), Ordering::Relaxed);
        // Both, and what the context points to, are in memory before core 1 is told anything.
        fence(Ordering::SeqCst);

        // Into its ROM loop, whatever it did before.
        self.psm.frce_off().modify(|_, w| w.proc1().set_bit());
        while self.psm.frce_off().read().proc1().bit_is_clear() {}
        let (from, to) = stack();
        // SAFETY: core 1's stack, and core 1 is held in reset.
        unsafe { crate::stack::mark(from, to) };
        self.psm.frce_off().modify(|_, w| w.proc1().clear_bit());

        // SAFETY: reading VTOR has no effect; core 1 shares core 0's table (it takes nothing but faults).
        let vectors = unsafe { (*pac::PPB::ptr()).vtor().read().bits() };
        let top = STACK.0.get() as u32 + STACK_BYTES as u32;
        let words = [0, 0, 1, vectors, top, start::<T> as *const () as u32];
        // RP2040 datasheet, 2.8.2: each word is echoed; a wrong echo starts over; a zero asks for an empty FIFO first.
        let mut next = 0;
        while next < words.len() {
            if words[next] == 0 {
                self.fifo.drain();
                cortex_m::asm::sev();
            }
            self.fifo.write_blocking(words[next]);
            next = if self.fifo.read_blocking() == words[next] {
                next + 1
            } else {
                0
            };
        }
        Wakes { fifo: self.fifo }
    }
}

impl Wakes {
    /// Empties the FIFO, so that its line falls.
    pub fn drain(&mut self) {
        self.fifo.drain();
    }
}

/// What the ROM jumps to on core 1. `launch` stored both words before it told the ROM.
extern "C" fn start<T: Send + 'static>() -> ! {
    // Masked for good: this core polls what woke it and has no handlers in SRAM.
    cortex_m::interrupt::disable();
    // SAFETY: `launch::<T>` stored a `&'static mut T` that it consumed and a `fn(&'static mut T) -> !`, and named `start::<T>`
    // of the same T; it runs once because `Core1` exists once.
    unsafe {
        let context = &mut *CONTEXT.load(Ordering::Acquire).cast::<T>();
        let entry =
            core::mem::transmute::<*mut (), fn(&'static mut T) -> !>(ENTRY.load(Ordering::Acquire));
        entry(context)
    }
}

/// Called on core 1: ends core 0's sleep. A full FIFO means that a wake-up is under way already.
#[inline(always)]
pub fn wake_core0() {
    // SAFETY: each core has its own end of the FIFO; this is core 1's writing end, which nobody else uses.
    let sio = unsafe { &*pac::SIO::ptr() };
    if sio.fifo_st().read().rdy().bit_is_set() {
        // SAFETY: any word may go into the FIFO.
        sio.fifo_wr().write(|w| unsafe { w.bits(1) });
    }
}

/// Called on core 1: sleeps until anything happens.
#[inline(always)]
pub fn idle() {
    cortex_m::asm::wfi();
}
