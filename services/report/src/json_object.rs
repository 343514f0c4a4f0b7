//! An object under construction in a line of text: commas where they belong, and what is not known left out.

use crate::Full;
use crate::json::MOST_TEXT;
use crate::text::Text;

/// An open object.
pub(crate) struct Object<'a, 'b> {
    text: &'a mut Text<'b>,
    is_empty: bool,
}

impl<'a, 'b> Object<'a, 'b> {
    pub(crate) fn open(text: &'a mut Text<'b>) -> Result<Self, Full> {
        text.byte(b'{')?;
        Ok(Object {
            text,
            is_empty: true,
        })
    }

    pub(crate) fn close(self) -> Result<(), Full> {
        self.text.byte(b'}')
    }

    /// Bytes as they are, behind a value that the caller has written.
    pub(crate) fn raw(&mut self, bytes: &[u8]) -> Result<(), Full> {
        self.text.bytes(bytes)
    }

    /// A key, behind which the caller writes the value.
    pub(crate) fn key(&mut self, name: &str) -> Result<&mut Text<'b>, Full> {
        if !self.is_empty {
            self.text.byte(b',')?;
        }
        self.is_empty = false;
        self.text.byte(b'"')?;
        self.text.bytes(name.as_bytes())?;
        self.text.bytes(b"\":")?;
        Ok(self.text)
    }

    /// A key and an object under it.
    pub(crate) fn object<'c>(&'c mut self, name: &str) -> Result<Object<'c, 'b>, Full> {
        Object::open(self.key(name)?)
    }

    pub(crate) fn number(&mut self, name: &str, value: impl Into<i32>) -> Result<(), Full> {
        self.key(name)?.decimal(value.into())
    }

    /// `value` / 10^`decimals`.
    pub(crate) fn scaled(
        &mut self,
        name: &str,
        value: Option<impl Into<i32>>,
        decimals: usize,
    ) -> Result<(), Full> {
        match value {
            Some(value) => self.key(name)?.scaled(value.into(), decimals),
            None => Ok(()),
        }
    }

    pub(crate) fn maybe(&mut self, name: &str, value: Option<impl Into<i32>>) -> Result<(), Full> {
        self.scaled(name, value, 0)
    }

    pub(crate) fn count(&mut self, name: &str, value: Option<u32>) -> Result<(), Full> {
        match value {
            Some(value) => self.key(name)?.digits(value, 1),
            None => Ok(()),
        }
    }

    pub(crate) fn truth(&mut self, name: &str, value: bool) -> Result<(), Full> {
        let word: &[u8] = if value { b"true" } else { b"false" };
        self.key(name)?.bytes(word)
    }

    /// Text, cut to what a message holds; what is no printable ASCII is left out, quotes and backslashes are escaped.
    pub(crate) fn text(&mut self, name: &str, value: &str) -> Result<(), Full> {
        let text = self.key(name)?;
        text.byte(b'"')?;
        for byte in value.bytes().take(MOST_TEXT) {
            match byte {
                b'"' | b'\\' => text.bytes(&[b'\\', byte])?,
                b' '..=b'~' => text.byte(byte)?,
                _ => {}
            }
        }
        text.byte(b'"')
    }
}
