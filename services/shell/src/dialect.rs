//! How a reply is written.

use core::fmt;

/// Takes reply lines without their ends, in order.
pub trait Out {
    /// One line.
    fn line(&mut self, text: fmt::Arguments<'_>);
}

impl<F: FnMut(fmt::Arguments<'_>)> Out for F {
    fn line(&mut self, text: fmt::Arguments<'_>) {
        self(text);
    }
}

/// Which family's replies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    /// `OK`, `+X=v`, `ERROR <why>`; choices by name.
    Adsbee,
    /// `AT+OK`, `AT+X=v`, `AT+ERROR (<why>)`; choices by number.
    Aerobits,
}

impl Dialect {
    /// What stands before a value's name.
    pub const fn prefix(self) -> &'static str {
        match self {
            Dialect::Adsbee => "+",
            Dialect::Aerobits => "AT+",
        }
    }

    /// The reply to what was done.
    pub const fn ok(self) -> &'static str {
        match self {
            Dialect::Adsbee => "OK",
            Dialect::Aerobits => "AT+OK",
        }
    }

    /// Whether choices are told by name.
    pub(crate) const fn by_name(self) -> bool {
        matches!(self, Dialect::Adsbee)
    }

    /// The reply to what was done or refused.
    pub fn tell<E: fmt::Display>(self, out: &mut dyn Out, result: Result<(), E>) {
        match (result, self) {
            (Ok(()), _) => out.line(format_args!("{}", self.ok())),
            (Err(why), Dialect::Adsbee) => out.line(format_args!("ERROR {why}")),
            (Err(why), Dialect::Aerobits) => out.line(format_args!("AT+ERROR ({why})")),
        }
    }
}
