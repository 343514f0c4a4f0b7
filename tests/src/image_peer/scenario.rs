//! The surroundings of each image: what is driven from outside after the mark, which pins are watched, and how long it may take.

/// Something from outside, so many cycles after the record 0x57.
#[derive(Debug, Clone, Copy)]
pub enum Event {
    /// A pin takes a level.
    Pin(u64, u32, bool),
    /// The start bit of a byte comes to UART 0.
    Byte(u64, u8),
}

/// An image and its surroundings.
pub struct Scenario {
    pub image: &'static str,
    pub events: fn() -> Vec<Event>,
    /// Pins whose changes are compared.
    pub watched: u32,
    /// A line that the USB host sends once the port is open.
    pub usb: &'static str,
    /// Whether cycles are compared; without, records and bytes alone (`usb-host` in the table).
    pub stamped: bool,
    /// Most cycles.
    pub most: u64,
}

/// Tag of the record after which events come.
pub const MARK: u32 = 0x57;
/// Cycles of a character at 125 MHz and the image's divisors: 10 × 16 × (67 + 52/64).
const CHARACTER: u64 = 10_850;
/// Cycles from its start to the middle of its stop bit, where the receiver has it.
const RECEIVED: u64 = CHARACTER - CHARACTER / 20;

pub const SCENARIOS: &[Scenario] = &[
    Scenario {
        image: "timer",
        events: Vec::new,
        watched: 0,
        usb: "",
        stamped: true,
        most: 400_000,
    },
    Scenario {
        image: "gpio",
        events: edges,
        watched: 7 << 10,
        usb: "",
        stamped: true,
        most: 400_000,
    },
    Scenario {
        image: "uart",
        events: characters,
        watched: 0,
        usb: "",
        stamped: true,
        most: 1_000_000,
    },
    Scenario {
        image: "capture",
        events: pulses,
        watched: 1 << 8,
        usb: "",
        stamped: true,
        most: 400_000,
    },
    Scenario {
        image: "usb",
        events: Vec::new,
        watched: 0,
        usb: "hello, device\r\n",
        stamped: false,
        most: 60_000_000,
    },
];

/// Edges on three pins, far enough apart that each is handled before the next.
fn edges() -> Vec<Event> {
    let mut events = Vec::new();
    let mut at = 1_000;
    for n in 0..5 {
        events.push(Event::Pin(at, 2, n % 2 == 0));
        at += 901 + 13 * n;
        events.push(Event::Pin(at, 3, n % 2 == 0));
        at += 777;
    }
    for level in [false, true, false, true, false] {
        events.push(Event::Pin(at, 2, level));
        at += 1_003;
        events.push(Event::Pin(at, 4, level));
        at += 333;
    }
    events
}

/// Sixteen bytes, one at a time.
fn characters() -> Vec<Event> {
    (0..16)
        .map(|n| Event::Byte(2_000 + n * (CHARACTER + 7_001), (n * 37 + 5) as u8))
        .collect()
}

/// Pulses of many lengths around the sampler's 15 cycles, as long as the capture lasts.
fn pulses() -> Vec<Event> {
    let (mut events, mut at, mut level) = (Vec::new(), 100, true);
    // A small generator with a long period: x → 5 x + 3 modulo 1009.
    let mut x = 77;
    while at < 60_000 {
        events.push(Event::Pin(at, 19, level));
        level = !level;
        x = (5 * x + 3) % 1009;
        at += 20 + x % 160;
    }
    events
}

impl Scenario {
    /// The scenario as `image_peer.mjs` reads it.
    pub fn text(&self) -> String {
        let mut lines = vec![
            format!("most {}", self.most),
            format!("watch {}", self.watched),
        ];
        if !self.usb.is_empty() {
            let hex: String = self.usb.bytes().map(|byte| format!("{byte:02x}")).collect();
            lines.push(format!("usb {hex}"));
        }
        lines.extend((self.events)().into_iter().map(|event| match event {
            Event::Pin(at, pin, level) => format!("{at} pin {pin} {}", u8::from(level)),
            Event::Byte(at, byte) => format!("{at} uart {byte} {RECEIVED}"),
        }));
        lines.join("\n") + "\n"
    }
}
