//! What the screen tells by a tone: a new alarm, a refusal, a finished part, a key. Off by factory (P487).
//! Source: spec H8; issue "the face", part 10.

use crate::defs::param;
use crate::link::snapshot::Tone as MessageTone;
use crate::link::{Command, Snapshot};
use crate::units::Micros;

/// P487: alarms, refusals and finished parts; the same and keys.
const EVENTS: f64 = 1.0;
const KEYS: f64 = 2.0;

/// What is heard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Beep {
    /// A key was pressed.
    Key,
    /// The control has refused something.
    Refused,
    /// A part is finished.
    PartFinished,
    /// A new alarm.
    Alarm,
}

/// Where tones are played. Must not block.
pub trait Speaker: Send {
    /// Plays a tone, or drops it if the one before is still played.
    fn play(&mut self, beep: Beep);
}

/// What was told last.
#[derive(Clone, Copy, Debug, PartialEq)]
struct LastTold {
    alarm: u64,
    part: Option<Micros>,
    refused: Option<Micros>,
}

/// Follows the snapshots and finds what is to be heard.
#[derive(Debug, Default)]
pub struct SoundWatcher {
    last: Option<LastTold>,
}

impl SoundWatcher {
    /// What a new snapshot is to be heard by; nothing of the first one.
    pub fn follow(&mut self, snapshot: &Snapshot) -> Option<Beep> {
        let message = &snapshot.message;
        let now = LastTold {
            alarm: snapshot.alarm_history.last().map_or(0, |alarm| alarm.count),
            part: snapshot.cycle.part.as_ref().map(|part| part.ended_at),
            refused: (message.tone == MessageTone::Refused).then_some(message.since),
        };
        let before = self.last.replace(now)?;
        if snapshot.params.get(param::SOUND) < EVENTS {
            return None;
        }
        if now.alarm > before.alarm {
            return Some(Beep::Alarm);
        }
        if now.refused.is_some() && now.refused != before.refused {
            return Some(Beep::Refused);
        }
        (now.part.is_some() && now.part != before.part).then_some(Beep::PartFinished)
    }
}

/// What the commands of a frame are to be heard by.
#[must_use]
pub fn of_commands(commands: &[Command], snapshot: &Snapshot) -> Option<Beep> {
    let is_press = |command: &Command| matches!(command, Command::Press(_));
    (snapshot.params.get(param::SOUND) >= KEYS && commands.iter().any(is_press)).then_some(Beep::Key)
}
