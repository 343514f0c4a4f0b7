//! Decoded frames against a scene's truth: decoded is a frame with the bits that were sent; anything else is an invention.

use super::Decoded;
use std::collections::HashSet;
use twin::source::scene::{Role, Scene};

/// How much of a scene was decoded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Score {
    pub wanted: usize,
    pub decoded: usize,
    pub overlapping: usize,
    pub overlapping_decoded: usize,
    /// Frames that nobody sent.
    pub invented: usize,
}

impl Score {
    /// Share of the wanted frames.
    pub fn share(&self) -> f64 {
        self.decoded as f64 / self.wanted.max(1) as f64
    }

    /// Share of the frames that overlap wanted ones.
    pub fn share_overlapping(&self) -> f64 {
        self.overlapping_decoded as f64 / self.overlapping.max(1) as f64
    }
}

/// Counts. A frame that is given twice counts once.
pub fn score(scene: &Scene, decoded: &[Decoded]) -> Score {
    let heard: HashSet<&[u8]> = decoded.iter().map(|frame| frame.bytes.as_slice()).collect();
    let sent: HashSet<&[u8]> = scene
        .emissions
        .iter()
        .filter_map(|emission| emission.frame().map(mode_s::Frame::bytes))
        .collect();
    let count = |role: Role| {
        let frames = scene.of_role(role).filter_map(|emission| emission.frame());
        frames.fold((0, 0), |(all, found), frame| {
            (all + 1, found + usize::from(heard.contains(frame.bytes())))
        })
    };
    let (wanted, found) = count(Role::Wanted);
    let (overlapping, overlapping_decoded) = count(Role::Overlapping);
    Score {
        wanted,
        decoded: found,
        overlapping,
        overlapping_decoded,
        invented: heard.difference(&sent).count(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use twin::source::scene::traffic::Traffic;

    #[test]
    fn what_was_sent_counts_once_and_what_was_not_is_an_invention() {
        let scene = Traffic {
            frames: 4,
            ..Traffic::default()
        }
        .scene();
        let heard = |bytes: &[u8]| Decoded {
            bytes: bytes.to_vec(),
            repaired: 0,
            arrival_ps: None,
        };
        let sent = scene.emissions[1].frame().expect("a frame");
        let score = score(
            &scene,
            &[heard(sent.bytes()), heard(sent.bytes()), heard(&[1; 7])],
        );
        assert_eq!((score.wanted, score.decoded, score.invented), (4, 1, 1));
    }
}
