//! Every encoder on real traffic, judged by programs that others wrote (and by reference parsers where none exists).
//!
//! ```text
//!   log ─▶ tracker ─┬─▶ encoder ─▶ bytes ─▶ client ─▶ what it understood ─┐
//!                   └─▶ the tracker's accessors ─▶ what must be told ─────┴─▶ compared, every field, both ways
//! ```
//! Expected values come from the accessors and the documents' tables as written here, never from an encoder. A field that the client tells and
//! nobody expected fails as one that is missing does. What it is not: it tests no port and no schedule; the shipped image with its clients
//! does (`docs/acceptance.md`).

mod asterix;
mod compare;
mod csv;
mod gdl90;
mod json;
mod mavlink;
mod pages;
mod raw;
mod samples;
mod tables;
