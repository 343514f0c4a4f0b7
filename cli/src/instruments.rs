//! What looks into the running device: stacks and their limits, reads of SRAM nobody wrote, value change dumps, GDB's port.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::net::{TcpListener, ToSocketAddrs};
use std::path::{Path, PathBuf};

use clap::{Arg, ArgAction, ArgMatches, value_parser};
use object::{Object, ObjectSymbol};
use twin::board::Board;
use twin::chip::trace::Signal;
use twin::gdb;

use crate::profile::Functions;
use crate::{Failure, device};

/// Signals of a dump that names none: the pulses, what samples them, the LED.
const SIGNALS: &str = "PULSES,LED,PIO0.SM0.PC,PIO0.SM0.RX,DMA.BUSY,CORE0.SLEEP,CORE1.SLEEP";

/// The options.
pub fn arguments() -> [Arg; 3] {
    [
        Arg::new("vcd")
            .long("vcd")
            .value_name("FILE")
            .value_parser(value_parser!(PathBuf))
            .help("Record signals as a value change dump for GTKWave; costs speed"),
        Arg::new("vcd-signals")
            .long("vcd-signals")
            .value_name("NAMES")
            .requires("vcd")
            .default_value(SIGNALS)
            .help("The signals: GPIO15, nets of the board, PIO0.SM0.PC (X Y ISR OSR TX RX), DMA.BUSY, CORE0.SLEEP, CORE0.EXCEPTION, [20001234]"),
        Arg::new("uninitialised")
            .long("uninitialised")
            .action(ArgAction::SetTrue)
            .help("Tell at the end who read SRAM that nobody wrote; costs speed"),
    ]
}

/// `--gdb`.
pub fn gdb_argument() -> Arg {
    Arg::new("gdb")
        .long("gdb")
        .value_name("ADDRESS")
        .help("Wait for GDB on this address, such as 127.0.0.1:3333, and let it have the device from the start")
}

/// Starts what must see the device from its power-on.
pub fn at_power_on(board: &mut Board, matches: &ArgMatches) {
    if matches.get_flag("uninitialised") {
        board.chip.watch_uninitialised();
    }
}

/// What is under way.
pub struct Instruments {
    vcd: Option<BufWriter<File>>,
    /// Bytes of each core's stack, where the ELF file tells.
    stacks: [Option<u32>; 2],
}

impl Instruments {
    /// Starts what was asked for, on a device whose app runs.
    pub fn begin(board: &mut Board, matches: &ArgMatches) -> Result<Self, Failure> {
        let elf = device::image(matches).with_file_name("app.elf");
        let stacks = stacks(&elf);
        for (core, stack) in stacks.iter().enumerate() {
            if let Some((lowest, _)) = stack {
                board.chip.set_stack_limit(core, *lowest);
            }
        }
        let vcd = match matches.get_one::<PathBuf>("vcd") {
            Some(path) => {
                let file = File::create(path)
                    .map_err(|e| Failure::Usage(format!("{}: {e}", path.display())))?;
                start_trace(board, matches)?;
                Some(BufWriter::new(file))
            }
            None => None,
        };
        Ok(Self {
            vcd,
            stacks: stacks.map(|stack| Some(stack?.1)),
        })
    }

    /// To be called after each step.
    pub fn look(&mut self, board: &mut Board) -> std::io::Result<()> {
        if let (Some(file), Some(trace)) = (&mut self.vcd, &mut board.chip.bus.trace) {
            file.write_all(trace.take_text().as_bytes())?;
        }
        Ok(())
    }

    /// What there is to tell at the end.
    pub fn end(mut self, board: &mut Board, matches: &ArgMatches) -> std::io::Result<String> {
        self.look(board)?;
        if let Some(file) = &mut self.vcd {
            file.flush()?;
        }
        let stack = |core: usize| {
            let used = board.chip.stack(core).used();
            match self.stacks[core] {
                Some(bytes) => format!("{used} of {bytes}"),
                None => used.to_string(),
            }
        };
        let mut text = format!("stacks, bytes   {}, {}\n", stack(0), stack(1));
        if matches.get_flag("uninitialised") {
            let functions = Functions::beside(&device::image(matches));
            let mut told = 0;
            for (reader, what) in board.chip.uninitialised() {
                told += 1;
                text.push_str(&format!(
                    "uninitialised   core {} at {:#010x} ({}) read {:#010x} first, {} times in all\n",
                    reader.core,
                    reader.pc,
                    functions.at(reader.pc),
                    what.address,
                    what.reads
                ));
            }
            text.push_str(&format!("uninitialised   {told} places in the program\n"));
        }
        Ok(text)
    }
}

fn start_trace(board: &mut Board, matches: &ArgMatches) -> Result<(), Failure> {
    let nets = [
        ("PULSES", board.kind.pulses),
        ("LED", board.kind.led),
        ("COMMS_RX", board.kind.comms_rx),
        ("FLARM_RX", board.kind.flarm_rx),
    ];
    let names = matches.get_one::<String>("vcd-signals");
    let names = names.map_or(SIGNALS, String::as_str);
    let signals = names
        .split(',')
        .map(|name| Ok((name.trim().to_owned(), Signal::parse(name, &nets)?)))
        .collect::<Result<Vec<_>, twin::chip::trace::UnknownSignal>>()
        .map_err(|e| Failure::Usage(e.to_string()))?;
    board.chip.bus.start_trace(&signals);
    Ok(())
}

/// Lowest address and size of both cores' stacks, by the symbols of the app.
fn stacks(elf: &Path) -> [Option<(u32, u32)>; 2] {
    let Ok(bytes) = std::fs::read(elf) else {
        return [None; 2];
    };
    let Ok(file) = object::File::parse(bytes.as_slice()) else {
        return [None; 2];
    };
    let symbol = |wanted: &dyn Fn(&str) -> bool| {
        let found = file.symbols().find(|s| s.name().is_ok_and(wanted))?;
        Some((found.address() as u32, found.size() as u32))
    };
    let named = |name: &'static str| symbol(&move |n: &str| n == name).map(|(at, _)| at);
    let core0 = match (named("_stack_end"), named("_stack_start")) {
        (Some(end), Some(start)) => Some((end, start.saturating_sub(end))),
        _ => None,
    };
    let core1 =
        symbol(&|n: &str| format!("{:#}", rustc_demangle::demangle(n)) == "hal::core1::STACK");
    [core0, core1]
}

/// Lets GDB have the device, if it was asked for. Says whether the device is to go on.
pub fn debug(board: &mut Board, matches: &ArgMatches) -> Result<bool, Failure> {
    let Some(address) = matches.get_one::<String>("gdb") else {
        return Ok(true);
    };
    let told = |e: std::io::Error| Failure::Usage(format!("GDB's port {address}: {e}"));
    let address = address.to_socket_addrs().map_err(told)?.next();
    let address = address.ok_or_else(|| told(std::io::ErrorKind::InvalidInput.into()))?;
    let listener = TcpListener::bind(address).map_err(told)?;
    let at = listener.local_addr().map_err(told)?;
    eprintln!("GDB: waiting at {at}; gdb-multiarch app.elf -ex 'target remote {at}'");
    let (stream, _) = listener.accept().map_err(told)?;
    let end = gdb::serve(board, stream, |board| {
        // A console that cannot be written to is no reason to stop the device.
        let _ = std::io::stdout().write_all(&board.console_read());
    });
    Ok(end.map_err(told)? == gdb::End::Detached)
}
