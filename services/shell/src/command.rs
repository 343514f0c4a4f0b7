//! A line cut into command name and kind.
//!
//! ```text
//!   AT                 attention
//!   AT+NAME            bare
//!   AT+NAME?           query; AT+NAME?WORD asks in a way of its own
//!   AT+NAME=?          description
//!   AT+NAME=a,b,c      set, arguments split on ',', a blank one leaves its value unchanged
//! ```

use crate::refusal::Refusal;

/// What is asked of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind<'a> {
    /// `AT+NAME`
    Bare,
    /// `AT+NAME?`, and what follows the sign.
    Query(&'a str),
    /// `AT+NAME=?`
    Describe,
    /// `AT+NAME=…`: the text behind the sign, to be split on commas.
    Set(&'a str),
}

/// A command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Command<'a> {
    /// The name, as typed; empty for `AT` alone.
    pub name: &'a str,
    /// What is asked.
    pub kind: Kind<'a>,
}

impl<'a> Command<'a> {
    /// Cuts a line without its end.
    pub fn parse(line: &'a str) -> Result<Command<'a>, Refusal> {
        if line == "AT" {
            return Ok(Command {
                name: "",
                kind: Kind::Bare,
            });
        }
        let text = line.strip_prefix("AT+").ok_or(Refusal::NotACommand)?;
        let end = text.find(['=', '?']).unwrap_or(text.len());
        let (name, rest) = text.split_at(end);
        if name.is_empty() {
            return Err(Refusal::UnknownCommand);
        }
        let kind = match rest {
            "" => Kind::Bare,
            "=?" => Kind::Describe,
            _ if rest.starts_with('?') => Kind::Query(&rest[1..]),
            _ => Kind::Set(&rest[1..]),
        };
        Ok(Command { name, kind })
    }
}

/// Longest list of arguments.
pub(crate) const MAX_ARGUMENTS: usize = 4;

/// What stands for a secret in replies and dumps. As an argument it leaves the value unchanged, as a blank one does: a dump that is sent again costs no password.
pub(crate) const MASK: &str = "********";

/// Up to `most` arguments of a `Set`; a blank or missing one is `None`, and so is a masked one.
pub(crate) fn arguments(text: &str, most: usize) -> Result<[Option<&str>; MAX_ARGUMENTS], Refusal> {
    let mut found = [None; MAX_ARGUMENTS];
    for (index, piece) in text.split(',').enumerate() {
        if index >= most.min(MAX_ARGUMENTS) {
            return Err(Refusal::ArgumentCount);
        }
        found[index] = (!piece.is_empty() && piece != MASK).then_some(piece);
    }
    Ok(found)
}
