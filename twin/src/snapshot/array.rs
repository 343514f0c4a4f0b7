//! Arrays longer than serde's own 32 elements, as sequences. For `#[serde(with = "crate::snapshot::array")]`.

use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// An array, or one in a box.
pub trait Long: Sized {
    type Element: Serialize + DeserializeOwned;
    fn elements(&self) -> &[Self::Element];
    /// `None` for another length.
    fn from_elements(elements: Vec<Self::Element>) -> Option<Self>;
}

impl<T: Serialize + DeserializeOwned, const N: usize> Long for [T; N] {
    type Element = T;
    fn elements(&self) -> &[T] {
        self
    }
    fn from_elements(elements: Vec<T>) -> Option<Self> {
        elements.try_into().ok()
    }
}

impl<T: Serialize + DeserializeOwned, const N: usize> Long for Box<[T; N]> {
    type Element = T;
    fn elements(&self) -> &[T] {
        &self[..]
    }
    fn from_elements(elements: Vec<T>) -> Option<Self> {
        elements.into_boxed_slice().try_into().ok()
    }
}

pub fn serialize<A: Long, S: Serializer>(array: &A, to: S) -> Result<S::Ok, S::Error> {
    array.elements().serialize(to)
}

pub fn deserialize<'de, A: Long, D: Deserializer<'de>>(from: D) -> Result<A, D::Error> {
    let elements = Vec::<A::Element>::deserialize(from)?;
    let length = elements.len();
    A::from_elements(elements).ok_or_else(|| {
        D::Error::custom(format_args!(
            "an array of {length} elements is not expected here"
        ))
    })
}
