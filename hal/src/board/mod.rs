//! Board files: every pin by its net name. One module a board; an image is built for one of them.

pub mod adsbee_1090;
