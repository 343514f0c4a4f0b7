//! A ring of bytes between one writer and one reader, without a lock: a message goes in whole or not at all.
//!
//! ```text
//!   read ─▶ [....bytes of whole messages....] ◀─ written        written - read = length, both count on for ever (mod 2^32)
//! ```
//! The counts are loads and stores only: the Cortex-M0+ has no compare-and-swap and needs none here. Two writers at once would
//! garble messages (not memory): each ring has one, by construction of the ports.

use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

/// A ring of `N` bytes; `N` is a power of two.
pub struct ByteRing<const N: usize> {
    cells: [AtomicU8; N],
    written: AtomicU32,
    read: AtomicU32,
}

impl<const N: usize> Default for ByteRing<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> ByteRing<N> {
    const MASK: usize = {
        assert!(N.is_power_of_two());
        N - 1
    };

    /// An empty ring.
    pub const fn new() -> Self {
        Self {
            cells: [const { AtomicU8::new(0) }; N],
            written: AtomicU32::new(0),
            read: AtomicU32::new(0),
        }
    }

    /// Bytes waiting.
    pub fn len(&self) -> usize {
        self.written
            .load(Ordering::Acquire)
            .wrapping_sub(self.read.load(Ordering::Acquire)) as usize
    }

    /// No byte waits.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes that still fit.
    pub fn free(&self) -> usize {
        N - self.len()
    }

    /// Writer: puts the whole message in, or none of it.
    pub fn offer(&self, message: &[u8]) -> bool {
        self.offer_both(&[], message)
    }

    /// Writer: the same with something in front of it.
    pub fn offer_both(&self, head: &[u8], message: &[u8]) -> bool {
        let length = head.len() + message.len();
        if length > self.free() {
            return false;
        }
        let start = self.written.load(Ordering::Relaxed) as usize;
        for (offset, &byte) in head.iter().chain(message).enumerate() {
            self.cells[start.wrapping_add(offset) & Self::MASK].store(byte, Ordering::Relaxed);
        }
        self.written.store(
            (start as u32).wrapping_add(length as u32),
            Ordering::Release,
        );
        true
    }

    /// Reader: copies the oldest bytes without taking them; returns how many.
    pub fn peek(&self, into: &mut [u8]) -> usize {
        let count = self.len().min(into.len());
        let start = self.read.load(Ordering::Relaxed) as usize;
        for (offset, slot) in into[..count].iter_mut().enumerate() {
            *slot = self.cells[start.wrapping_add(offset) & Self::MASK].load(Ordering::Relaxed);
        }
        count
    }

    /// Reader: the oldest bytes as they lie in one piece, for hardware that takes them itself. Empty only when nothing waits.
    pub fn front(&self) -> &[AtomicU8] {
        let start = self.read.load(Ordering::Relaxed) as usize & Self::MASK;
        let end = (start + self.len()).min(N);
        &self.cells[start..end]
    }

    /// Reader: takes the oldest `count` bytes away (at most what waits).
    pub fn consume(&self, count: usize) {
        let count = count.min(self.len()) as u32;
        self.read.store(
            self.read.load(Ordering::Relaxed).wrapping_add(count),
            Ordering::Release,
        );
    }

    /// Reader: the oldest byte.
    pub fn pop(&self) -> Option<u8> {
        if self.is_empty() {
            return None;
        }
        let at = self.read.load(Ordering::Relaxed);
        let byte = self.cells[at as usize & Self::MASK].load(Ordering::Relaxed);
        self.read.store(at.wrapping_add(1), Ordering::Release);
        Some(byte)
    }
}
