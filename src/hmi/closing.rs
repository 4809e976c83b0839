//! Closing the window: refused while something moves, else a question with its consequences, and a password if P23.6
//! says so. Source: safety stance; spec B6, H8.

use egui::Rect;

use super::{EditKey, GuardedQuestion, Login, Question, View};
use crate::defs::alarm;
use crate::defs::param::{self, AccessLevel};
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::link::Command;
use crate::link::snapshot::RunState;

/// Why the window stays open now.
pub const MOVES: Text =
    Text::new("机床在运动，不能关闭系统：先按复位", "the machine moves: press RESET before closing the control");

/// The state of a request to close the window.
#[derive(Debug, Default)]
pub struct Closing {
    question: GuardedQuestion,
    login: Login,
    /// The window may close.
    confirmed: bool,
}

impl Closing {
    /// The window manager, or a key of it, asks to close the window. Says why that is refused, or opens the question.
    pub fn ask(&mut self, view: &View<'_>) -> Option<Text> {
        if is_moving(view) {
            return Some(MOVES);
        }
        if !self.is_open() {
            let key = ("question-close", Text::new("关闭", "CLOSE"));
            self.question.ask(Question::new(Text::new("关闭系统？", "close the control?"), consequence(view), key));
        }
        None
    }

    /// Whether the question or the password dialog is open and takes all input.
    pub const fn is_open(&self) -> bool {
        self.question.is_open() || self.login.is_open()
    }

    /// Whether the window may close.
    pub const fn is_confirmed(&self) -> bool {
        self.confirmed
    }

    /// Whether a password is being typed.
    pub const fn wants_pad(&self) -> bool {
        self.login.is_open()
    }

    /// Draws the question or the password dialog. A machine that has begun to move closes them.
    pub fn ui(&mut self, rect: Rect, view: &View<'_>, edits: &[EditKey], out: &mut Vec<Command>) {
        if is_moving(view) {
            *self = Self::default();
            return;
        }
        let is_guarded = view.snapshot.params.bit(param::CLOSE_PASSWORD);
        let level = if is_guarded { AccessLevel::User } else { AccessLevel::Operator };
        self.confirmed |= self.question.ui(rect, view, edits, (level, &mut self.login));
        self.login.ui(rect, view, edits, out);
    }
}

/// Whether a program, homing or an axis moves.
fn is_moving(view: &View<'_>) -> bool {
    view.snapshot.state.is_active() || view.snapshot.axes.iter().any(|(_, axis)| axis.moving)
}

/// What closing does now.
fn consequence(view: &View<'_>) -> LocalizedText {
    if matches!(view.snapshot.state, RunState::Held | RunState::Stopped) {
        return phrase!(
            "程序暂停中：关闭使程序中断，砂轮、冷却和驱动断开。断点已保存，下次回零后可继续。",
            "A program is held: closing ends it; wheel, fluids and drives go off. Its place is kept and offered after \
             the next homing."
        );
    }
    // What the disk has refused may be lost; it is tried once more at the end.
    let unstored = [alarm::STORE_FAILED, alarm::STORE_SLOW];
    if view.snapshot.is_storing || view.snapshot.alarms.iter().any(|alarm| unstored.contains(&alarm.number)) {
        return phrase!(
            "有改动的数据还没有保存（看报警页）：现在关闭可能丢失。砂轮、冷却和驱动断开，夹紧保持。",
            "Changed values are not stored yet (see the alarm page): closing now may lose them. Wheel, fluids and drives \
             go off, clamps hold."
        );
    }
    phrase!(
        "砂轮、冷却和驱动断开，夹紧保持；数据全部保存。",
        "Wheel, fluids and drives go off, clamps hold; all data are stored."
    )
}
