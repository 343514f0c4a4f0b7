//! Long runs of the twin: a device asleep, and a device on the air, watched for drift, leaks and counters that do not balance.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::sync::Arc;

use twin::board::{Board, TICK_HZ};
use twin::chip::pins::Again;
use twin::front_end::{FrontEnd, Player};
use twin::source::{Air, AirOptions, MessageLog};

const RESETS: u32 = 0x4000_c000;
const TIMER: u32 = 0x4005_4000;
const WATCHDOG_CTRL: u32 = 0x4005_8000;
const NVIC_ISER: u32 = 0xe000_e100;
const NVIC_ICER: u32 = 0xe000_e180;
const NVIC_ICPR: u32 = 0xe000_e280;
/// RESETS bits of ADC, DMA, PIO0, PIO1 and USBCTRL.
const OFF: u32 = 1 | 1 << 2 | 1 << 10 | 1 << 11 | 1 << 24;
const CODE: u32 = 0x2003_0000;
const SLEEP: u32 = 0x2003_1000;
const COUNT: u32 = 0x2003_2000;
/// Microseconds from one wake-up to the next.
const PERIOD_US: u32 = 1_000_000;
/// Time between the messages of a log without times; the one that is played has them.
const SPACING_PS: u64 = 1_000_000_000;

/// Wakes by alarm 0 and sets it a period on, counts, sleeps again:
/// `ldr r3,[r0,#16]; adds r3,r3,r1; movs r4,#1; str r4,[r0,#52]; str r3,[r0,#16]; str r4,[r6]; ldr r5,[r2]; adds r5,#1; str r5,[r2]; wfi; b`.
const WAKES: [u16; 11] = [
    0x6903, 0x185b, 0x2401, 0x6344, 0x6103, 0x6034, 0x6815, 0x3501, 0x6015, 0xbf30, 0xe7f4,
];
/// `wfi; b`.
const SLEEPS: [u16; 2] = [0xbf30, 0xe7fd];

/// A device with its receiver off: clocks as the image sets them, capture, converter, DMA and USB in reset, core 1 asleep for ever, core 0 woken once a
/// second by an alarm of the microsecond timer.
pub fn asleep() -> Result<Board, String> {
    let mut board = Board::power_on(&crate::image()).map_err(|e| e.to_string())?;
    board.wait_for_capture().map_err(|e| e.to_string())?;
    let chip = &mut board.chip;
    let code =
        |halfwords: &[u16]| -> Vec<u8> { halfwords.iter().flat_map(|h| h.to_le_bytes()).collect() };
    chip.take_over(1, SLEEP, &code(&SLEEPS), 0);
    chip.take_over(0, CODE, &code(&WAKES), TIMER);
    let bus = &mut chip.bus;
    bus.core_time = bus.now;
    for core in [1, 0] {
        bus.active = core;
        bus.write32(NVIC_ICER, u32::MAX);
        bus.write32(NVIC_ICPR, u32::MAX);
    }
    let held = bus.read32(RESETS);
    for (register, value) in [
        (WATCHDOG_CTRL, 0),
        (RESETS, held | OFF),
        (NVIC_ISER, 1),
        (TIMER + 0x38, 1),
    ] {
        bus.write32(register, value);
    }
    // The first alarm's time is now; the program adds a period.
    let now = bus.read32(TIMER + 0x28);
    bus.write32(TIMER + 0x10, now);
    bus.write32(COUNT, 0);
    let regs = chip.registers_mut(0);
    (regs.r[1], regs.r[2], regs.r[6]) = (PERIOD_US, COUNT, NVIC_ICPR);
    Ok(board)
}

/// What a sleep came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Slept {
    /// Wake-ups counted by the program, the first at the start.
    pub wakes: u32,
    /// Cycles core 0 was awake, and core 1.
    pub busy: [u64; 2],
    /// Microseconds of the timer less those of the chip's time.
    pub drift_us: i64,
}

/// Runs a sleeping board for `seconds`.
pub fn sleep(board: &mut Board, seconds: u64) -> Result<Slept, String> {
    let chip = &mut board.chip;
    let (start, busy) = (chip.now(), chip.busy_cycles());
    let ticks = |board: &mut Board| {
        let bus = &mut board.chip.bus;
        bus.core_time = bus.now;
        u64::from(bus.read32(TIMER + 0x24)) << 32 | u64::from(bus.read32(TIMER + 0x28))
    };
    let first = ticks(board);
    // Half a second more, so that the last wake-up is past.
    let cycles = seconds * TICK_HZ + TICK_HZ / 2;
    board.run_cycles(cycles).map_err(|e| e.to_string())?;
    let passed = ticks(board) - first;
    let chip = &mut board.chip;
    let expected = (chip.now() - start) / (TICK_HZ / 1_000_000);
    let now = chip.busy_cycles();
    Ok(Slept {
        wakes: chip.bus.read32(COUNT),
        busy: [now[0] - busy[0], now[1] - busy[1]],
        drift_us: passed as i64 - expected as i64,
    })
}

/// A device on the air, part after part of a log, its counters asked for after each.
pub struct OnTheAir {
    board: Board,
    log: std::path::PathBuf,
    /// Parts played.
    pub parts: u64,
    /// Cycles and captured words at the last look.
    last: Option<(u64, u64)>,
    pub overruns: u64,
    pub frames: u64,
}

/// The log from its start, as often as it is asked for.
fn source(log: &Path) -> Result<Again, String> {
    MessageLog::open(log, SPACING_PS).map_err(|e| e.to_string())?;
    let log = log.to_owned();
    Ok(Arc::new(move || {
        let messages = MessageLog::open(&log, SPACING_PS).expect("it was opened before");
        let air = Air::new(messages, AirOptions::default());
        Box::new(Player::new(air, &FrontEnd::ADSBEE_1090))
    }))
}

impl OnTheAir {
    /// A device that hears nothing yet.
    pub fn new(log: &Path) -> Result<Self, String> {
        let mut board = Board::power_on(&crate::image()).map_err(|e| e.to_string())?;
        board.wait_for_capture().map_err(|e| e.to_string())?;
        board.wait_for_console().map_err(|e| e.to_string())?;
        Ok(Self {
            board,
            log: log.into(),
            parts: 0,
            last: None,
            overruns: 0,
            frames: 0,
        })
    }

    /// Plays the log from its start for `seconds`: what does not balance, if anything.
    pub fn part(&mut self, seconds: u64) -> Result<(), String> {
        let source = source(&self.log)?;
        self.board
            .play_repeatable(source)
            .map_err(|e| e.to_string())?;
        for _ in 0..seconds * 10 {
            self.board.run_ms(100).map_err(|e| e.to_string())?;
            // What nobody reads must not pile up in the host.
            self.board.console_read();
            self.board.comms_read();
        }
        self.parts += 1;
        self.look()
    }

    /// Keeps device and counts in a file, so that a run that is broken off goes on from there.
    pub fn keep(&self, file: &Path) -> Result<(), String> {
        let (cycles, words) = self.last.ok_or("nothing was played yet")?;
        let head = [self.parts, self.frames, self.overruns, cycles, words];
        let half = file.with_extension("half");
        let write = || -> std::io::Result<()> {
            let mut to = std::fs::File::create(&half)?;
            writeln!(to, "{}", head.map(|n| n.to_string()).join(" "))?;
            self.board.save(&mut to).map_err(std::io::Error::other)?;
            std::fs::rename(&half, file)
        };
        write().map_err(|error| format!("{}: {error}", file.display()))
    }

    /// The device and the counts that [`OnTheAir::keep`] left.
    pub fn go_on(log: &Path, file: &Path) -> Result<Self, String> {
        let read = || -> Result<Self, String> {
            let mut from = BufReader::new(std::fs::File::open(file).map_err(|e| e.to_string())?);
            let mut head = String::new();
            from.read_line(&mut head).map_err(|e| e.to_string())?;
            let numbers: Result<Vec<u64>, _> = head.split_whitespace().map(str::parse).collect();
            let Ok(&[parts, frames, overruns, cycles, words]) = numbers.as_deref() else {
                return Err("not what this bench keeps".into());
            };
            let source = source(log)?;
            let board = Board::resume(&mut from, Some(&source)).map_err(|e| e.to_string())?;
            Ok(Self {
                board,
                log: log.into(),
                parts,
                last: Some((cycles, words)),
                overruns,
                frames,
            })
        };
        read().map_err(|error| format!("{}: {error}", file.display()))
    }

    fn look(&mut self) -> Result<(), String> {
        self.board.console_write(b"AT+PROTOCOL=CONSOLE,NONE\r\n");
        self.board.run_ms(100).map_err(|e| e.to_string())?;
        self.board.console_read();
        self.board.console_write(b"AT+STATS?\r\n");
        self.board.run_ms(100).map_err(|e| e.to_string())?;
        let now = self.board.chip.now();
        let said = self.board.console_read();
        let said = String::from_utf8_lossy(&said).into_owned();
        let count = |stage: &str, name: &str| -> Result<u64, String> {
            let line = said
                .lines()
                .find_map(|l| l.strip_prefix(&format!("+STATS={stage},")));
            line.and_then(|l| {
                l.split(',')
                    .find_map(|f| f.strip_prefix(name)?.strip_prefix('=')?.parse().ok())
            })
            .ok_or_else(|| format!("no {stage} {name} in {said:?}"))
        };
        let words = count("CAPTURE", "words")?;
        if let Some((cycles, before)) = self.last {
            // Capture takes a word every 480 cycles; the looks are answered within a tenth of a second.
            let expected = (now - cycles) / 480;
            let off = (words - before).abs_diff(expected);
            if off > TICK_HZ / 10 / 480 {
                return Err(format!(
                    "{} words where {expected} were due",
                    words - before
                ));
            }
        }
        self.last = Some((now, words));
        let (offered, queued, dropped) = (
            count("QUEUE", "offered")?,
            count("QUEUE", "queued")?,
            count("QUEUE", "dropped")?,
        );
        if offered != queued + dropped {
            return Err(format!(
                "QUEUE does not balance: {offered} {queued} {dropped}"
            ));
        }
        self.overruns = count("DEMOD", "overruns")?;
        self.frames = offered;
        Ok(())
    }
}

/// Memory this process holds, in bytes; 0 where the system does not tell.
pub fn resident_bytes() -> u64 {
    // Linux: the second number counts pages of 4 KiB.
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = text.split_whitespace().nth(1).and_then(|n| n.parse().ok());
    4096 * pages.unwrap_or(0)
}
