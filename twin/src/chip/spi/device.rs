//! What is on an SPI bus, and who of it is selected.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A device on an SPI bus.
pub trait SpiDevice: Send {
    /// Its chip select went low (`true`) or high.
    fn select(&mut self, selected: bool, time_ps: u128);
    /// A frame of `bits` bits while it is selected: what it hears, and what it sends meanwhile.
    fn exchange(&mut self, out: u16, bits: u32, time_ps: u128) -> u16;
    /// For snapshots.
    fn clone_box(&self) -> Box<dyn SpiDevice>;
}

impl Clone for Box<dyn SpiDevice> {
    fn clone(&self) -> Self {
        self.clone_box()
    }
}

#[derive(Clone)]
struct Place {
    device: Box<dyn SpiDevice>,
    cs: u32,
    selected: bool,
}

/// The devices on one controller's wires.
#[derive(Clone, Default)]
pub(super) struct Wire {
    places: Vec<Place>,
}

/// No part of the twin is an SPI device: a bus without devices is all that a snapshot can hold.
impl Serialize for Wire {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        if self.has_devices() {
            return Err(serde::ser::Error::custom("an SPI device is attached"));
        }
        to.serialize_unit()
    }
}

impl<'de> Deserialize<'de> for Wire {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        <()>::deserialize(from).map(|()| Self::default())
    }
}

impl Wire {
    pub(super) fn attach(&mut self, device: Box<dyn SpiDevice>, cs: u32) {
        self.places.push(Place {
            device,
            cs,
            selected: false,
        });
    }

    pub(super) fn has_devices(&self) -> bool {
        !self.places.is_empty()
    }

    /// The levels of all pads now.
    pub(super) fn select(&mut self, levels: u32, time_ps: u128) {
        for place in &mut self.places {
            let selected = levels >> place.cs & 1 == 0;
            if selected != place.selected {
                place.selected = selected;
                place.device.select(selected, time_ps);
            }
        }
    }

    /// A frame: what the selected devices send (wired AND, should there be several); `None` if none is selected.
    pub(super) fn exchange(&mut self, out: u16, bits: u32, time_ps: u128) -> Option<u16> {
        self.places
            .iter_mut()
            .filter(|p| p.selected)
            .map(|p| p.device.exchange(out, bits, time_ps))
            .reduce(|a, b| a & b)
    }
}
