//! A static that is handed out once, as `&'static mut`: how large state gets an owner without a heap and without `static mut`.

use core::cell::{Cell, UnsafeCell};
use critical_section::Mutex;

/// A value that one caller may take for good.
pub struct TakeOnce<T> {
    taken: Mutex<Cell<bool>>,
    value: UnsafeCell<T>,
}

// SAFETY: the value is reached only through `take`, which succeeds for exactly one caller; T: Send lets that caller be any core.
unsafe impl<T: Send> Sync for TakeOnce<T> {}

impl<T> TakeOnce<T> {
    /// A value nobody has taken.
    pub const fn new(value: T) -> Self {
        Self {
            taken: Mutex::new(Cell::new(false)),
            value: UnsafeCell::new(value),
        }
    }

    /// The value, the first time; `None` ever after.
    #[expect(clippy::mut_from_ref, reason = "the flag makes the reference unique")]
    pub fn take(&'static self) -> Option<&'static mut T> {
        let was_taken = critical_section::with(|cs| self.taken.borrow(cs).replace(true));
        if was_taken {
            return None;
        }
        // SAFETY: `taken` went from false to true inside the critical section just now, so no other reference exists or will.
        Some(unsafe { &mut *self.value.get() })
    }
}
