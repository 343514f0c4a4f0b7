//! A line cut into command name and kind.
//!
//! ```text
//!   AT+NAME            bare
//!   AT+NAME?           query
//!   AT+NAME=a,b,c      set, arguments split on ',', a blank one leaves its value unchanged
//! ```

use crate::refusal::Refusal;

/// What is asked of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind<'a> {
    /// `AT+NAME`
    Bare,
    /// `AT+NAME?`
    Query,
    /// `AT+NAME=…`: the text behind the sign, to be split on commas.
    Set(&'a str),
}

/// A command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Command<'a> {
    /// The name, as typed.
    pub name: &'a str,
    /// What is asked.
    pub kind: Kind<'a>,
}

impl<'a> Command<'a> {
    /// Cuts a line without its end.
    pub fn parse(line: &'a str) -> Result<Command<'a>, Refusal> {
        let text = line.strip_prefix("AT+").ok_or(Refusal::NotACommand)?;
        let end = text.find(['=', '?']).unwrap_or(text.len());
        let (name, rest) = text.split_at(end);
        let kind = match rest.as_bytes() {
            [] => Kind::Bare,
            [b'?'] => Kind::Query,
            [b'=', ..] => Kind::Set(&rest[1..]),
            _ => return Err(Refusal::NoQuery),
        };
        Ok(Command { name, kind })
    }
}

/// Exactly `N` arguments of a `Set`; a blank one is `None`.
pub(crate) fn arguments<const N: usize>(text: &str) -> Result<[Option<&str>; N], Refusal> {
    let mut found = [None; N];
    let mut pieces = text.split(',');
    for argument in &mut found {
        let piece = pieces.next().ok_or(Refusal::ArgumentCount)?;
        *argument = (!piece.is_empty()).then_some(piece);
    }
    match pieces.next() {
        None => Ok(found),
        Some(_) => Err(Refusal::ArgumentCount),
    }
}
