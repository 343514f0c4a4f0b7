//! `squitter replay`: a recording through front end and receiver, by the shipped image or by its demodulator alone.

use std::cell::RefCell;
use std::io::{BufWriter, Write};
use std::path::PathBuf;

use clap::{Arg, ArgMatches, Command};
use demod::{RawFrame, Reply};
use mode_s::ModeACode;
use twin::beast_stream::Reader;
use twin::completed::Completed;
use twin::front_end::PulseSource;
use twin::native;
use twin::source::PRE_ROLL_PS;

use crate::instruments::{self, Instruments};
use crate::levels::{Levels, Message};
use crate::output::{self, Form, Heard, HeardReply, Printer};
use crate::{Failure, device, radio};

/// Rate that carries every frame the channel can hold in Beast.
const BAUD: u32 = 3_000_000;
/// The device is left running this long after the recording, so that its last second is reported, in milliseconds.
const TAIL_MS: u64 = 1_200;
/// How a Beast client asks for Mode A/C replies, and how long until the device has heard it everywhere, ms.
const ASK_FOR_REPLIES: &[u8] = b"\x1a1J";
const BEAT_MS: u64 = 60;

/// The subcommand's arguments.
pub fn command() -> Command {
    Command::new("replay")
        .about("Play a recording through the radio front end into the receiver and print what it hears")
        .long_about(
            "Plays FILE through the front end's model (log detector, slicer, comparator) into the receiver. Engine `twin` runs the \
             firmware image, `native` the same demodulator on this computer; both sample the same instants and print the same frames. \
             Noise of 5 ms comes before and after. Times are seconds from the recording's first sample to the frame's first edge, by the \
             device's own 12 MHz stamps. What every stage counted goes to standard error with --stats.",
        )
        .arg(radio::file_argument("Recording"))
        .args(radio::arguments())
        .arg(
            Arg::new("engine")
                .long("engine")
                .value_name("ENGINE")
                .value_parser(["twin", "native"])
                .default_value("twin")
                .help("twin: the firmware image, emulated; native: its demodulator on this computer"),
        )
        .arg(output::argument())
        .arg(Arg::new("mode-ac").long("mode-ac").action(clap::ArgAction::SetTrue).help("Print Mode A/C replies, too, as four octal digits or Beast; a few milliseconds out of order"))
        .arg(Arg::new("stats").long("stats").action(clap::ArgAction::SetTrue).help("Print the counters of every stage to standard error"))
        .arg(device::profile_argument())
        .args(instruments::arguments())
        .arg(device::image_argument())
}

/// Runs it.
pub fn run(matches: &ArgMatches) -> Result<(), Failure> {
    let file = matches.get_one::<PathBuf>("file").expect("required");
    let form = *matches.get_one::<Form>("out").expect("has a default");
    let source = radio::recording(file, matches)?;
    let mut printer = Printer::new(BufWriter::new(std::io::stdout().lock()), form);
    let stats = if matches
        .get_one::<String>("engine")
        .is_some_and(|e| e == "native")
    {
        by_native(source, matches.get_flag("mode-ac"), &mut printer)?
    } else {
        by_twin(source, form, matches, &mut printer)?
    };
    printer.finish()?;
    if matches.get_flag("stats") {
        eprint!("{stats}");
    }
    Ok(())
}

fn by_native(
    mut source: Box<dyn PulseSource + Send>,
    tells_replies: bool,
    printer: &mut Printer<impl Write>,
) -> Result<String, Failure> {
    let start = output::start_count(0, PRE_ROLL_PS);
    let options = native::Options {
        trigger_level_mv: Some(twin::board::pwm_level_mv()),
        ..Default::default()
    };
    let printing = RefCell::new((printer, None));
    let mut frame = |raw: RawFrame| {
        // As the device stamps it: from the nearest tick.
        let arrival = raw.arrival + u64::from(raw.arrival_parts >> 7);
        let stamp =
            (arrival + report::beast::STAMP_AFTER_ARRIVAL_TICKS) / report::beast::TICKS_PER_COUNT;
        let heard = Heard {
            count: stamp as i64 - start,
            frame: raw.frame,
            repaired: raw.repaired(),
            level_dbm: raw.level.map(report::whole_decibels),
        };
        let (printer, failed) = &mut *printing.borrow_mut();
        if failed.is_none() {
            *failed = printer.frame(&heard).err();
        }
    };
    let mut reply = |raw: Reply| {
        let stamp =
            (raw.arrival + report::beast::F2_AFTER_F1_TICKS) / report::beast::TICKS_PER_COUNT;
        let heard = HeardReply {
            count: stamp as i64 - start,
            code: ModeACode::of_id13(raw.pulses),
            spi: raw.spi,
        };
        let (printer, failed) = &mut *printing.borrow_mut();
        if failed.is_none() {
            *failed = printer.reply(&heard).err();
        }
    };
    // As in the device: searched for only if somebody asks.
    let counters = if tells_replies {
        native::run_with_replies(source.as_mut(), options, &mut frame, &mut reply)
    } else {
        native::run(source.as_mut(), options, &mut frame)
    };
    if let (_, Some(error)) = printing.into_inner() {
        return Err(error.into());
    }
    let fields = |named: &[(&str, u32)]| -> Vec<String> {
        named
            .iter()
            .map(|(name, n)| format!("{name}={n}"))
            .collect()
    };
    Ok(format!(
        "+STATS=DEMOD,{}\n+STATS=TRIALS,{}\n+STATS=MODE_AC,{}\n",
        fields(&counters.stages()).join(","),
        fields(&counters.trials()).join(","),
        fields(&counters.replies()).join(",")
    ))
}

fn by_twin(
    source: Box<dyn PulseSource + Send>,
    form: Form,
    matches: &ArgMatches,
    printer: &mut Printer<impl Write>,
) -> Result<String, Failure> {
    let mut board = device::start(matches)?;
    device::command(&mut board, &format!("AT+BAUDRATE=COMMS_UART,{BAUD}"))?;
    device::command(&mut board, "AT+PROTOCOL=COMMS_UART,BEAST")?;
    let console = match form {
        Form::Csbee => "CSBEE",
        Form::Hex => "RAW",
        Form::Beast | Form::Json => "NONE",
    };
    device::command(&mut board, &format!("AT+PROTOCOL=CONSOLE,{console}"))?;
    if matches.get_flag("mode-ac") {
        board.comms_write(ASK_FOR_REPLIES);
        board.run_ms(BEAT_MS)?;
    }
    board.run_ms(5)?;
    board.comms_read();
    board.console_read();

    let playback = board.play(source)?;
    let profiling = device::profile(&mut board, matches);
    let mut instruments = Instruments::begin(&mut board, matches)?;
    let start = output::start_count(playback.start_tick, PRE_ROLL_PS);
    let mut reader = Reader::default();
    let mut completed = Completed::default();
    let mut levels = Levels::default();
    let mut left = TAIL_MS;
    let mut tables = None;
    while left > 0 {
        board.run_ms(1)?;
        instruments.look(&mut board)?;
        if board.playback_finished() {
            // The recording alone, not the silence after it.
            if let (Some(profiling), None) = (&profiling, &tables) {
                tables = Some(profiling.tables(&board, matches));
            }
            left -= 1;
        }
        let (comms, said) = (board.comms_read(), board.console_read());
        match form {
            Form::Csbee => printer.bytes(&said)?,
            Form::Beast => printer.bytes(&comms)?,
            Form::Hex | Form::Json => {
                levels.console(&said);
                let messages = reader.read(&comms);
                levels.beast(&messages);
                for message in &messages {
                    if let Ok(bits) = message.bytes.as_slice().try_into() {
                        let count = message.stamp as i64 - start;
                        printer.reply(&HeardReply::of_bits(count, bits))?;
                    }
                }
                while let Some((message, level)) = levels.next_of(form) {
                    printer.frame(&heard(&mut completed, &message, level, start))?;
                }
            }
        }
    }
    for message in levels.rest() {
        printer.frame(&heard(&mut completed, &message, None, start))?;
    }
    if let Some(tables) = tables {
        eprint!("{tables}");
    }
    let told = instruments.end(&mut board, matches)?;
    if matches.get_flag("stats") || matches.get_flag("uninitialised") {
        eprint!("{told}");
    }
    if matches!(form, Form::Csbee | Form::Hex) {
        device::command(&mut board, "AT+PROTOCOL=CONSOLE,NONE")?;
    }
    let stats = device::query(&mut board, "AT+STATS?")?;
    for stage in ["QUEUE", "CONSOLE", "COMMS_UART"] {
        if let Some(n @ 1..) = device::counter(&stats, stage, "dropped") {
            eprintln!("squitter: the device dropped {n} messages at stage {stage}");
        }
    }
    Ok(stats.replace("\r\n", "\n"))
}

/// A Beast message of the device as the receiver believed it; `start` is the count at which the recording began.
fn heard(
    completed: &mut Completed,
    message: &Message,
    level_dbm: Option<i32>,
    start: i64,
) -> Heard {
    let (frame, repaired) = completed.complete(&message.frame);
    Heard {
        count: message.stamp as i64 - start,
        frame,
        repaired,
        level_dbm,
    }
}
