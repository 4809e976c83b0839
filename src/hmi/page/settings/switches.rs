//! Frequently used switches: bits of the parameter table with their password level. Source: spec B6.

use egui::{Rect, Ui};

use super::{group, key_row, title_note};
use crate::defs::param::{self, BitParam};
use crate::defs::text::Text;
use crate::hmi::login::Login;
use crate::hmi::view::View;
use crate::hmi::widget::{ButtonState, KeyboardFocus, cell};
use crate::link::Command;
use crate::link::page_command::{PageCommand, PasswordScope};

/// The bits, each with the id and the label of its key.
const SWITCHES: [(BitParam, &str, Text); 4] = [
    (param::COUNT_ON_M30, "switch-count", Text::new("M30 计件", "M30 COUNTS")),
    (param::EDIT_OFFSETS, "switch-offsets", Text::new("刀补允许修改", "EDIT OFFSETS")),
    (param::EDIT_VALUES_IN_RUN, "switch-values", Text::new("运行中可改数据", "EDIT IN A RUN")),
    (param::WHEEL_RETRACT, "switch-retract", Text::new("一键回退", "RETRACT KEY")),
];

/// State of the group.
#[derive(Debug, Default)]
pub struct SwitchGroup {
    /// Index of the switch that waits for its password.
    pending_switch: Option<usize>,
}

impl SwitchGroup {
    /// Toggles the waiting switch once its level is unlocked; leaves it if the password is not given.
    pub fn send_pending(&mut self, view: &View<'_>, login: &Login, out: &mut Vec<Command>) {
        let Some(index) = self.pending_switch else { return };
        if view.snapshot.access.level >= SWITCHES[index].0.level {
            toggle(view, index, out);
            self.pending_switch = None;
        } else if !login.is_open() {
            self.pending_switch = None;
        }
    }

    /// Draws the group.
    pub fn ui(
        &mut self,
        ui: &Ui,
        rect: Rect,
        view: &View<'_>,
        keys: (f32, &mut KeyboardFocus, &mut Login),
        out: &mut Vec<Command>,
    ) {
        let (key, walk, login) = keys;
        let (body, free) = group(ui, view, rect, view.text("开关", "switches"));
        title_note(ui, view, free, view.text("亮条为开", "a bar: on"));
        for (index, (bit, id, label)) in SWITCHES.iter().enumerate() {
            let row = key_row(body, key, index / 2);
            let locked = view.snapshot.access.level < bit.level;
            let look = ButtonState { on: view.snapshot.params.bit(*bit), locked };
            if !walk.button(ui, view, cell(row, index % 2, 2), (id, label.get(view.lang)), look) {
                continue;
            }
            match PasswordScope::for_level(bit.level).filter(|_| locked) {
                Some(guard) => {
                    self.pending_switch = Some(index);
                    login.unlock(view, guard);
                }
                None => toggle(view, index, out),
            }
        }
    }
}

fn toggle(view: &View<'_>, index: usize, out: &mut Vec<Command>) {
    let bit = SWITCHES[index].0;
    let wanted = if view.snapshot.params.bit(bit) { 0.0 } else { 1.0 };
    out.push(Command::Page(PageCommand::EditParam(bit.address(), wanted)));
}
