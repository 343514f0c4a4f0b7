//! Enumerations with numbers and names.
//!
//! ```text
//!   code    0..=99   stored, and the number that the Aerobits dialect writes
//!           100..    stored; the value has a name alone
//! ```
//! Input takes the number, the name or an alias, in any letter case.

/// Codes from here on are no numbers that a user may write.
pub(crate) const UNNUMBERED_FROM: u8 = 100;

/// One value of an enumeration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// What is stored.
    pub code: u8,
    /// Its name, upper case.
    pub name: &'static str,
    /// Other names it is accepted by.
    pub aliases: &'static [&'static str],
}

impl Choice {
    /// The number of the Aerobits dialect.
    pub const fn number(&self) -> Option<u8> {
        if self.code < UNNUMBERED_FROM {
            Some(self.code)
        } else {
            None
        }
    }

    /// Whether this is the value of a number or a name.
    pub fn is_written(&self, text: &str) -> bool {
        let digits = text.len() < 4 && text.bytes().all(|byte| byte.is_ascii_digit());
        match text.parse::<u8>() {
            Ok(number) if digits => self.number() == Some(number),
            _ => {
                self.name.eq_ignore_ascii_case(text)
                    || self.aliases.iter().any(|a| a.eq_ignore_ascii_case(text))
            }
        }
    }
}

/// An enumeration whose values carry code, name and aliases.
macro_rules! choices {
    ($(#[$doc:meta])* $type:ident: $($(#[$about:meta])* $variant:ident = $code:literal $name:literal [$($alias:literal),*])+) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub enum $type {
            $($(#[$about])* $variant = $code,)+
        }

        impl $type {
            /// Every value, in the order of the documents.
            pub const ALL: &'static [Choice] = &[
                $(Choice { code: $code, name: $name, aliases: &[$($alias),*] },)+
            ];

            /// The value of a code.
            pub const fn from_code(code: i32) -> Option<Self> {
                match code {
                    $($code => Some(Self::$variant),)+
                    _ => None,
                }
            }

            /// Its code.
            pub const fn code(self) -> i32 {
                self as i32
            }

            /// Its name.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)+
                }
            }
        }
    };
}
pub(crate) use choices;
