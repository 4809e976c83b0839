//! Frequently used switches: bits of the parameter table with their password level. Source: spec B6.

use egui::{Rect, Ui};

use super::{beside, cell, group, row_of};
use crate::defs::param::{self, Bit};
use crate::defs::text::Text;
use crate::hmi::login::Login;
use crate::hmi::view::View;
use crate::hmi::widget::{Look, Walk};
use crate::link::Command;
use crate::link::page_command::{Guard, PageCommand};

/// The bits, each with the id and the label of its key.
const SWITCHES: [(Bit, &str, Text); 4] = [
    (param::COUNT_ON_M30, "switch-count", Text::new("M30 计件", "M30 COUNTS")),
    (param::EDIT_OFFSETS, "switch-offsets", Text::new("刀补允许修改", "EDIT OFFSETS")),
    (param::EDIT_VALUES_IN_RUN, "switch-values", Text::new("运行中可改数据", "EDIT IN A RUN")),
    (param::WHEEL_RETRACT, "switch-retract", Text::new("一键回退", "RETRACT KEY")),
];

/// State of the group.
#[derive(Debug, Default)]
pub struct Switches {
    /// Index of the switch that waits for its password.
    waiting: Option<usize>,
}

impl Switches {
    /// Toggles the waiting switch once its level is unlocked; leaves it if the password is not given.
    pub fn send_waiting(&mut self, view: &View<'_>, login: &Login, out: &mut Vec<Command>) {
        let Some(index) = self.waiting else { return };
        if view.snapshot.access.level >= SWITCHES[index].0.level {
            turn(view, index, out);
            self.waiting = None;
        } else if !login.is_open() {
            self.waiting = None;
        }
    }

    /// Draws the group.
    pub fn ui(
        &mut self,
        ui: &Ui,
        rect: Rect,
        view: &View<'_>,
        keys: (f32, &mut Walk, &mut Login),
        out: &mut Vec<Command>,
    ) {
        let (key, walk, login) = keys;
        let (body, free) = group(ui, view, rect, view.say("开关", "switches"));
        beside(ui, view, free, view.say("亮条为开", "a bar: on"));
        for (index, (bit, id, label)) in SWITCHES.iter().enumerate() {
            let row = row_of(body, key, index / 2);
            let locked = view.snapshot.access.level < bit.level;
            let look = Look { on: view.snapshot.params.bit(*bit), locked };
            if !walk.push(ui, view, cell(row, index % 2, 2), (id, label.get(view.lang)), look) {
                continue;
            }
            match Guard::of(bit.level).filter(|_| locked) {
                Some(guard) => {
                    self.waiting = Some(index);
                    login.unlock(view, guard);
                }
                None => turn(view, index, out),
            }
        }
    }
}

fn turn(view: &View<'_>, index: usize, out: &mut Vec<Command>) {
    let bit = SWITCHES[index].0;
    let wanted = if view.snapshot.params.bit(bit) { 0.0 } else { 1.0 };
    out.push(Command::Page(PageCommand::EditParam(bit.address(), wanted)));
}
