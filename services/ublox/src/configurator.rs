//! The dialogue: a message at a time, each answered, repeated or given up.
//!
//! | state | event | then |
//! |---|---|---|
//! | any | wanted, or no longer | Asking from the first message; Off |
//! | Asking, the first message | refused, or three times no answer | the first one for receivers that know no keys |
//! | Asking, any other | accepted, or refused (noted) | the next one; behind the last Configured, or Refused where one was noted |
//! | Asking, any other | three times no answer | NoAnswer |
//! | Configured, Refused, NoAnswer | a sentence after a silence of five seconds, or the first one ever | Asking from the first message: the receiver was away |
//! | Configured | a sentence that it was told not to send | likewise, ten seconds after the last time at the earliest: it was without supply for a moment |

use crate::answers::{Answers, Fed};
use crate::messages::{FIRST_WITHOUT_KEYS, MESSAGES, Message, is_unwanted};

/// An answer comes within so much, milliseconds: behind a second's sentences at 9600 baud.
const ANSWER_MS: u64 = 1_500;
/// How often a message is sent.
const TRIES: u8 = 3;
/// Without a sentence for so long the receiver was away, milliseconds.
const SILENCE_MS: u64 = 5_000;
/// A receiver that forgets is told again after so much, milliseconds.
const AGAIN_MS: u64 = 10_000;

/// What came of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Not wanted.
    Off,
    /// Under way.
    Asking,
    /// Every message was accepted.
    Configured,
    /// This message was refused, the first if there were more; the others were accepted.
    Refused(&'static str),
    /// The receiver does not answer.
    NoAnswer,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Off,
    /// This message is to be sent or answered.
    Asking(u8),
    Done,
    NoAnswer,
}

/// The dialogue's side that asks.
#[derive(Clone, Debug)]
pub struct Configurator {
    step: Step,
    /// How often the message was sent.
    tries: u8,
    /// The first message that was refused.
    refused: Option<u8>,
    /// When the message was sent last.
    sent_ms: Option<u64>,
    /// When the first message was sent last.
    begun_ms: u64,
    /// When the receiver was heard last.
    heard_ms: Option<u64>,
    answers: Answers,
    ended: u8,
}

impl Default for Configurator {
    fn default() -> Self {
        Self::new()
    }
}

impl Configurator {
    /// Off.
    pub const fn new() -> Self {
        Self {
            step: Step::Off,
            tries: 0,
            refused: None,
            sent_ms: None,
            begun_ms: 0,
            heard_ms: None,
            answers: Answers::new(),
            ended: 0,
        }
    }

    /// Whether the receiver is to be set up. Begins when that is new.
    pub fn want(&mut self, is_wanted: bool) {
        match (is_wanted, self.step) {
            (true, Step::Off) => self.begin(),
            (false, _) => self.step = Step::Off,
            _ => {}
        }
    }

    /// What came of it so far.
    pub fn state(&self) -> State {
        match (self.step, self.refused) {
            (Step::Off, _) => State::Off,
            (Step::Asking(_), _) => State::Asking,
            (Step::NoAnswer, _) => State::NoAnswer,
            (Step::Done, None) => State::Configured,
            (Step::Done, Some(place)) => State::Refused(message(place).name),
        }
    }

    /// How often it came to an end, modulo 256: news for a log.
    pub fn ended(&self) -> u8 {
        self.ended
    }

    /// The message that is to be sent now. To be asked in the loop; [`Configurator::sent`] says that it was.
    pub fn due(&mut self, now_ms: u64) -> Option<&'static [u8]> {
        while let Step::Asking(place) = self.step {
            match self.sent_ms {
                Some(sent_ms) if now_ms.saturating_sub(sent_ms) < ANSWER_MS => return None,
                Some(_) if self.tries >= TRIES => self.give_up(place),
                _ => return Some(message(place).bytes),
            }
        }
        None
    }

    /// The message that was due was sent.
    pub fn sent(&mut self, now_ms: u64) {
        if self.step == Step::Asking(0) && self.tries == 0 {
            self.begun_ms = now_ms;
        }
        self.tries += 1;
        self.sent_ms = Some(now_ms);
    }

    /// Takes a byte of the receiver; whether it was part of an answer and no sentence's.
    pub fn feed(&mut self, byte: u8, now_ms: u64) -> bool {
        if self.step == Step::Off {
            return false;
        }
        match self.answers.feed(byte) {
            Fed::Other => false,
            Fed::Part => true,
            Fed::Answer { kind, accepted } => {
                self.heard_ms = Some(now_ms);
                if let Step::Asking(place) = self.step
                    && self.tries > 0
                    && message(place).kind() == kind
                {
                    self.answered(place, accepted);
                }
                true
            }
        }
    }

    /// A whole sentence came.
    pub fn sentence(&mut self, sentence: &[u8], now_ms: u64) {
        let since_ms = self
            .heard_ms
            .map(|heard_ms| now_ms.saturating_sub(heard_ms));
        let was_away = since_ms.is_none_or(|since_ms| since_ms >= SILENCE_MS);
        self.heard_ms = Some(now_ms);
        let has_forgotten = self.state() == State::Configured
            && is_unwanted(sentence)
            && now_ms.saturating_sub(self.begun_ms) >= AGAIN_MS;
        if matches!(self.step, Step::Done | Step::NoAnswer) && (was_away || has_forgotten) {
            self.begin();
        }
    }

    fn begin(&mut self) {
        self.refused = None;
        self.go_to(0);
    }

    fn go_to(&mut self, place: u8) {
        self.step = Step::Asking(place);
        (self.tries, self.sent_ms) = (0, None);
    }

    fn answered(&mut self, place: u8, accepted: bool) {
        if !accepted {
            if place == 0 {
                return self.go_to(FIRST_WITHOUT_KEYS);
            }
            self.refused.get_or_insert(place);
        }
        let next = place + 1;
        if next == FIRST_WITHOUT_KEYS || usize::from(next) == MESSAGES.len() {
            self.end(Step::Done);
        } else {
            self.go_to(next);
        }
    }

    fn give_up(&mut self, place: u8) {
        if place == 0 {
            self.go_to(FIRST_WITHOUT_KEYS);
        } else {
            self.end(Step::NoAnswer);
        }
    }

    fn end(&mut self, step: Step) {
        self.step = step;
        self.ended = self.ended.wrapping_add(1);
    }
}

/// The message at a place.
fn message(place: u8) -> &'static Message {
    MESSAGES.get(usize::from(place)).unwrap_or(&MESSAGES[0])
}

#[cfg(test)]
#[path = "configurator_tests.rs"]
mod tests;
