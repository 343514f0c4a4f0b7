//! The names of all registers of the chip, as the datasheet writes them.
//!
//! `registers.txt` is read only when a name is wanted: for an error, a trace or the list of what an image uses.
//!
//! ```text
//!   [UART0 UART1]          the blocks that look so
//!   018 UARTFR             offset, name
//!   010+4*4 TXF#           offset + step * count: TXF0 at 010 to TXF3 at 01c
//! ```
//! Source: RP2040 datasheet, "List of registers" of each chapter. The blocks of RAM (USB's DPRAM, the streaming port) have none.

const REGISTERS: &str = include_str!("registers.txt");

/// The name of the register at `offset` bytes of a block; `None` where the datasheet lists none.
pub(super) fn name(block: &str, offset: u32) -> Option<String> {
    rows(block).find_map(|row| row.name_at(offset))
}

/// One line: `count` registers, `step` bytes apart.
struct Row {
    first: u32,
    step: u32,
    count: u32,
    name: &'static str,
}

impl Row {
    fn parse(line: &'static str) -> Option<Self> {
        let (place, name) = line.split_once(' ')?;
        let hex = |text| u32::from_str_radix(text, 16).ok();
        let (first, step, count) = match place.split_once('+') {
            None => (hex(place)?, 4, 1),
            Some((first, repeat)) => {
                let (step, count) = repeat.split_once('*')?;
                (hex(first)?, hex(step)?, count.parse().ok()?)
            }
        };
        Some(Self {
            first,
            step,
            count,
            name,
        })
    }

    fn name_at(&self, offset: u32) -> Option<String> {
        let from_first = offset.checked_sub(self.first)?;
        let index = from_first / self.step;
        (from_first % self.step == 0 && index < self.count)
            .then(|| self.name.replace('#', &index.to_string()))
    }
}

fn rows(block: &str) -> impl Iterator<Item = Row> {
    REGISTERS
        .lines()
        .skip_while(move |line| !heads(line).any(|head| head == block))
        .skip(1)
        .take_while(|line| !line.starts_with('['))
        .filter_map(Row::parse)
}

/// The blocks that a head line names; none for any other line.
fn heads(line: &str) -> impl Iterator<Item = &str> {
    line.strip_prefix('[')
        .and_then(|line| line.strip_suffix(']'))
        .unwrap_or_default()
        .split_whitespace()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_is_a_head_or_a_register() {
        for line in REGISTERS.lines() {
            let row = Row::parse(line);
            assert!(heads(line).next().is_some() || row.is_some(), "{line}");
            if let Some(row) = row {
                assert_eq!(
                    row.name.contains('#'),
                    row.count > 1,
                    "an index where there are several: {line}"
                );
            }
        }
    }

    #[test]
    fn no_place_has_two_names() {
        for head in REGISTERS.lines().flat_map(heads) {
            let mut places: Vec<u32> = rows(head)
                .flat_map(|row| (0..row.count).map(move |n| row.first + n * row.step))
                .collect();
            let all = places.len();
            places.sort_unstable();
            places.dedup();
            assert_eq!(places.len(), all, "{head}");
        }
    }

    #[test]
    fn single_and_repeated_registers_have_their_names() {
        for (block, offset, expected) in [
            ("ADC", 0x04, Some("RESULT")),
            ("UART1", 0x18, Some("UARTFR")),
            ("PIO1", 0xe0, Some("SM1_CLKDIV")),
            ("DMA", 0x2fc, Some("CH11_AL3_READ_ADDR_TRIG")),
            ("IO_BANK0", 0xec, Some("GPIO29_CTRL")),
            ("SIO", 0x17c, Some("SPINLOCK31")),
            ("PPB", 0xd08, Some("VTOR")),
            ("ADC", 0x24, None),
            ("IO_BANK0", 0xe9, None),
            ("nowhere", 0, None),
        ] {
            assert_eq!(
                name(block, offset).as_deref(),
                expected,
                "{block} {offset:#x}"
            );
        }
    }
}
