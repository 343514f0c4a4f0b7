//! The thirty pads of bank 0: what drives each one, and what the chip reads back.
//!
//! Source: RP2040 datasheet 2.19 (GPIO), register tables IO_BANK0 and PADS_BANK0.
//!
//! | IO_BANK0 | register | | PADS_BANK0 | register |
//! |---|---|---|---|---|
//! | 8n | GPIOn_STATUS | | 00 | VOLTAGE_SELECT |
//! | 8n+4 | GPIOn_CTRL | | 4+4n | GPIOn |
//! | f0-fc | INTR0-3 | | 7c 80 | SWCLK SWD |
//! | 100-128 | PROC0 INTE INTF INTS | | | |
//! | 130-158 | PROC1 INTE INTF INTS | | | |
//!
//! PULSES is the one fast input. Its edges come from a [`PulseSource`] as picoseconds of playback and are turned into system cycles by
//! [`edge_tick`]; a reader at cycle `c` sees the level two cycles earlier, behind the input synchroniser (datasheet 3.5.6.3). Every other
//! pin changes only between the slices in which the chip runs. A pin that drives itself is read back without the synchroniser's delay.

use crate::front_end::{Edge, PulseSource, edge_tick};

/// Number of pads in bank 0.
pub const PADS: usize = 30;
/// Flip-flops between a pad and its reader (datasheet 3.5.6.3).
pub const SYNC_CYCLES: u64 = 2;
/// How far the pulse source is asked ahead at a time, in picoseconds.
const LOOKAHEAD_PS: u64 = 100_000_000;

/// The radio that plays into PULSES.
struct Playback {
    source: Box<dyn PulseSource + Send>,
    pin: u32,
    /// Cycle at which playback time zero falls.
    start: u64,
    /// Playback time up to which edges were asked for.
    asked_ps: u64,
    /// Edges in cycles, and how many of them were played.
    edges: Vec<(u64, bool)>,
    played: usize,
    scratch: Vec<Edge>,
}

impl Playback {
    /// Cycle from which the next edge is seen behind the synchroniser.
    fn next_visible(&self) -> u64 {
        self.edges
            .get(self.played)
            .map_or(u64::MAX, |e| e.0 + SYNC_CYCLES)
    }
}

/// Pads, function multiplexers and their interrupts.
pub struct Pins {
    ctrl: [u32; PADS],
    pads: [u32; PADS],
    voltage_select: u32,
    /// Levels from outside, and which pins something outside drives.
    external: u32,
    driven: u32,
    /// Outputs after the multiplexer.
    out: u32,
    oe: u32,
    /// Resolved level of every pad.
    level: u32,
    intr: [u32; 4],
    inte: [[u32; 4]; 2],
    intf: [[u32; 4]; 2],
    playback: Option<Playback>,
    /// Cycle from which the next playback edge is visible behind the synchroniser.
    next_visible: u64,
}

/// What the peripherals offer to the multiplexer.
#[derive(Clone, Copy, Default)]
pub struct Drivers {
    pub sio_out: u32,
    pub sio_oe: u32,
    pub pio: [(u32, u32); 2],
}

impl Default for Pins {
    fn default() -> Self {
        Self::new()
    }
}

impl Pins {
    /// Pads as they leave reset, nothing attached.
    pub fn new() -> Self {
        Self {
            ctrl: [0x1f; PADS],
            pads: [0x56; PADS],
            voltage_select: 0,
            external: 0,
            driven: 0,
            out: 0,
            oe: 0,
            level: 0,
            intr: [0; 4],
            inte: [[0; 4]; 2],
            intf: [[0; 4]; 2],
            playback: None,
            next_visible: u64::MAX,
        }
    }

    /// Registers back to their reset values; what is attached outside stays.
    pub fn reset(&mut self) {
        self.ctrl = [0x1f; PADS];
        self.pads = [0x56; PADS];
        self.inte = [[0; 4]; 2];
        self.intf = [[0; 4]; 2];
        self.intr = [0; 4];
    }

    /// Plays `source` into `pin`, its time zero at cycle `start`. Replaces what played before.
    pub fn play(&mut self, source: Box<dyn PulseSource + Send>, pin: u32, start: u64) {
        self.driven |= 1 << pin;
        self.external &= !(1 << pin);
        self.playback = Some(Playback {
            source,
            pin,
            start,
            asked_ps: 0,
            edges: Vec::new(),
            played: 0,
            scratch: Vec::new(),
        });
        self.next_visible = u64::MAX;
        self.resolve_levels();
    }

    /// The source has no further edges and all it gave were played.
    pub fn playback_finished(&self) -> bool {
        self.playback
            .as_ref()
            .is_none_or(|p| p.source.finished() && p.played == p.edges.len())
    }

    /// Hands the trigger level to the front end, millivolts.
    pub fn set_trigger_level_mv(&mut self, millivolts: f64) {
        if let Some(p) = &mut self.playback {
            p.source.set_trigger_level_mv(millivolts);
        }
    }

    /// Makes sure that all edges up to cycle `until` are at hand.
    pub fn look_ahead(&mut self, until: u64) {
        let Some(p) = &mut self.playback else { return };
        while p.start + edge_tick(p.asked_ps) <= until && !p.source.finished() {
            p.edges.drain(..p.played);
            p.played = 0;
            p.asked_ps += LOOKAHEAD_PS;
            p.scratch.clear();
            p.source.next_edges(p.asked_ps, &mut p.scratch);
            let start = p.start;
            let cycles = |e: &Edge| (start + edge_tick(e.at_ps), e.level);
            p.edges.extend(p.scratch.iter().map(cycles));
        }
        self.next_visible = p.next_visible();
    }

    /// Input levels as a reader at cycle `now` sees them. Pins in `bypass` skip the synchroniser; for the playback pin that is exact only
    /// between its edges.
    #[inline]
    pub fn synced(&mut self, now: u64, bypass: u32) -> u32 {
        if now >= self.next_visible || bypass != 0 {
            self.pass_edges(now, bypass);
        }
        self.level
    }

    #[cold]
    fn pass_edges(&mut self, now: u64, bypass: u32) {
        let Some(p) = &mut self.playback else { return };
        let pin = p.pin;
        let delay = if bypass & (1 << pin) != 0 {
            0
        } else {
            SYNC_CYCLES
        };
        let mut changed = 0;
        for &(at, level) in &p.edges[p.played..] {
            if at + delay > now {
                break;
            }
            p.played += 1;
            if level != (self.external & (1 << pin) != 0) {
                self.external ^= 1 << pin;
                changed = 1 << pin;
                self.intr[pin as usize / 8] |= if level { 8 } else { 4 } << (4 * (pin % 8));
            }
        }
        self.next_visible = p.next_visible();
        if changed != 0 {
            self.level = (self.external & changed & !self.oe) | (self.level & (!changed | self.oe));
        }
    }

    /// Sets an input from outside the chip.
    pub fn drive(&mut self, pin: u32, level: bool) {
        self.driven |= 1 << pin;
        if level {
            self.external |= 1 << pin;
        } else {
            self.external &= !(1 << pin);
        }
        self.resolve_levels();
    }

    /// Recomputes the outputs from what the peripherals drive.
    pub fn resolve(&mut self, drivers: &Drivers) {
        let (mut out, mut oe) = (0, 0);
        for n in 0..PADS {
            let bit = 1 << n;
            let (o, e) = match self.ctrl[n] & 0x1f {
                5 => (drivers.sio_out & bit, drivers.sio_oe & bit),
                6 => (drivers.pio[0].0 & bit, drivers.pio[0].1 & bit),
                7 => (drivers.pio[1].0 & bit, drivers.pio[1].1 & bit),
                _ => (0, 0),
            };
            out |= match (self.ctrl[n] >> 8) & 3 {
                1 => o ^ bit,
                2 => 0,
                3 => bit,
                _ => o,
            };
            oe |= match (self.ctrl[n] >> 12) & 3 {
                1 => e ^ bit,
                2 => 0,
                3 => bit,
                _ => e,
            };
        }
        self.out = out;
        self.oe = oe;
        self.resolve_levels();
    }

    fn resolve_levels(&mut self) {
        let mut pulled_up = 0;
        for (n, pad) in self.pads.iter().enumerate() {
            pulled_up |= (pad >> 3 & 1) << n;
        }
        let outside = (self.external & self.driven) | (pulled_up & !self.driven);
        let before = self.level;
        self.level = (self.out & self.oe) | (outside & !self.oe);
        let mut changed = before ^ self.level;
        while changed != 0 {
            let n = changed.trailing_zeros() as usize;
            changed &= changed - 1;
            let rising = self.level & (1 << n) != 0;
            self.intr[n / 8] |= if rising { 8 } else { 4 } << (4 * (n % 8));
        }
    }

    /// Function selected for a pin.
    pub fn function(&self, pin: usize) -> u32 {
        self.ctrl[pin] & 0x1f
    }

    /// Level of a pad as it is now, from either side.
    pub fn level(&self, pin: u32) -> bool {
        self.level & (1 << pin) != 0
    }

    /// Interrupt bits with the level-sensitive ones filled in.
    fn raw_interrupts(&self, group: usize) -> u32 {
        let mut bits = self.intr[group];
        for i in 0..8 {
            let n = group * 8 + i;
            if n < PADS {
                bits |= if self.level & (1 << n) != 0 { 2 } else { 1 } << (4 * i);
            }
        }
        bits
    }

    /// IO_IRQ_BANK0 for one core.
    pub fn irq_line(&self, core: usize) -> bool {
        (0..4).any(|g| {
            (self.inte[core][g] != 0 || self.intf[core][g] != 0)
                && (self.raw_interrupts(g) & self.inte[core][g] | self.intf[core][g]) != 0
        })
    }

    /// Reads IO_BANK0.
    pub fn read_io(&self, offset: u32) -> Option<u32> {
        let group = (offset & 0xc) as usize / 4;
        Some(match offset {
            0x00..=0xec if offset & 4 == 0 => {
                let n = offset as usize / 8;
                let bit = |word: u32| word >> n & 1;
                bit(self.out) << 9
                    | bit(self.oe) << 13
                    | bit(self.level) << 17
                    | bit(self.level) << 19
            }
            0x00..=0xec => self.ctrl[offset as usize / 8],
            0xf0..=0xfc => self.raw_interrupts(group),
            0x100..=0x10c => self.inte[0][group],
            0x110..=0x11c => self.intf[0][group],
            0x120..=0x12c => self.raw_interrupts(group) & self.inte[0][group] | self.intf[0][group],
            0x130..=0x13c => self.inte[1][group],
            0x140..=0x14c => self.intf[1][group],
            0x150..=0x15c => self.raw_interrupts(group) & self.inte[1][group] | self.intf[1][group],
            _ => return None,
        })
    }

    /// Writes IO_BANK0; the caller resolves the outputs afterwards.
    pub fn write_io(&mut self, offset: u32, value: u32) -> bool {
        let group = (offset & 0xc) as usize / 4;
        match offset {
            0x00..=0xec if offset & 4 == 0 => {}
            0x00..=0xec => self.ctrl[offset as usize / 8] = value,
            // Only the edge bits are latched and can be cleared.
            0xf0..=0xfc => self.intr[group] &= !(value & 0xcccc_cccc),
            0x100..=0x10c => self.inte[0][group] = value,
            0x110..=0x11c => self.intf[0][group] = value,
            0x130..=0x13c => self.inte[1][group] = value,
            0x140..=0x14c => self.intf[1][group] = value,
            0x120..=0x12c | 0x150..=0x15c => {}
            _ => return false,
        }
        true
    }

    /// Reads PADS_BANK0.
    pub fn read_pads(&self, offset: u32) -> Option<u32> {
        match offset {
            0 => Some(self.voltage_select),
            0x04..=0x78 => Some(self.pads[offset as usize / 4 - 1]),
            _ => None,
        }
    }

    /// Writes PADS_BANK0.
    pub fn write_pads(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0 => self.voltage_select = value & 1,
            0x04..=0x78 => self.pads[offset as usize / 4 - 1] = value & 0xff,
            _ => return false,
        }
        true
    }
}
