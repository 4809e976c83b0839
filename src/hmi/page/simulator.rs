//! Simulator page: forced inputs, faults, part and wheel, for learning on a laptop. A real machine has no such page.
//! Source: spec P1–P8.

use egui::{Align2, Rect, Ui, pos2, vec2};

use super::{PageContext, PageUi, empty};
use crate::defs::signal::Input;
use crate::defs::sim_fault;
use crate::defs::text::Text;
use crate::hmi::view::{View, card, fit_text, format_length, format_whole, text_line};
use crate::hmi::widget::{self, ButtonState, KeyboardFocus, round_to_lines};
use crate::hmi::{pictogram, theme};
use crate::link::Command;
use crate::link::simulation::{SimCommand, SimView};

/// Height of a key.
const ROW_HEIGHT: f32 = 48.0;

/// State of the page.
#[derive(Debug, Default)]
pub struct SimulatorPage {
    tab: usize,
    input_page: usize,
    walk: KeyboardFocus,
}

/// The tabs.
const TABS: [(&str, Text); 3] = [
    ("sim-inputs", Text::new("输入", "INPUTS")),
    ("sim-faults", Text::new("故障", "FAULTS")),
    ("sim-part", Text::new("工件与砂轮", "PART, WHEEL")),
];

/// Index of the part tab; its name depends on the kind of machine.
const PART_TAB: usize = 2;

impl PageUi for SimulatorPage {
    /// The tab stays.
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<u32>) {
        *self = Self { tab: self.tab, ..Self::default() };
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { ui, rect, view, typed, out, .. } = ctx;
        let Some(sim) = view.snapshot.simulated.as_deref() else {
            let remedy = view.text("控制器接的是真实的机床。", "A real machine is wired to the control.");
            empty::show(ui, view, rect, pictogram::NO_PAGE, view.text("没有模拟机床", "no simulated machine"), remedy);
            return;
        };
        self.walk.begin_frame(typed.edits);
        let inside = rect.shrink2(vec2(theme::PAD, 6.0));
        let (tabs, body) = inside.split_top_bottom_at_y(inside.min.y + ROW_HEIGHT + theme::GAP);
        let width = (tabs.width() + theme::GAP) / TABS.len() as f32;
        for (index, (name, label)) in TABS.into_iter().enumerate() {
            let corner = pos2(tabs.min.x + index as f32 * width, tabs.min.y);
            let place = Rect::from_min_size(corner, vec2(width - theme::GAP, ROW_HEIGHT));
            let label = if index == PART_TAB { view.snapshot.kind.ui().part_tab } else { label };
            let look = ButtonState { on: self.tab == index, locked: false };
            if self.walk.button(ui, view, place, (name, label.get(view.lang)), look) {
                (self.tab, self.input_page) = (index, 0);
            }
        }
        let done = match self.tab {
            0 => self.inputs(ui, body, view, sim, typed.scroll_pages),
            1 => self.faults(ui, body, view, sim),
            _ => self.part(ui, body, view, sim),
        };
        out.extend(done.map(Command::Simulate));
    }
}

impl SimulatorPage {
    /// Two columns of inputs. A touch forces a free input to its opposite level, a forced 1 to 0; it frees a forced 0.
    fn inputs(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, sim: &SimView, pages: i32) -> Option<SimCommand> {
        let (list, keys) = rect.split_top_bottom_at_y(rect.max.y - ROW_HEIGHT);
        let list = round_to_lines(list, ROW_HEIGHT);
        let each = (list.height() / ROW_HEIGHT) as usize * 2;
        let inputs: Vec<Input> =
            Input::ALL.iter().copied().filter(|input| input.exists_on(view.snapshot.kind)).collect();
        let count = inputs.len().div_ceil(each.max(1));
        self.input_page = (self.input_page as i32 + pages).rem_euclid(count as i32) as usize;
        let half = (list.width() + theme::GAP) / 2.0;
        let mut done = None;
        for (index, input) in inputs.iter().skip(self.input_page * each).take(each).enumerate() {
            let corner = list.min + vec2((index % 2) as f32 * half, (index / 2) as f32 * ROW_HEIGHT);
            let place = Rect::from_min_size(corner, vec2(half - theme::GAP, ROW_HEIGHT - 3.0));
            let forced = sim.forced.iter().find(|(other, _)| other == input).map(|(_, on)| *on);
            let on = view.snapshot.inputs.has(*input);
            card(ui.painter(), place, view.theme.surface, view.theme.line);
            let (lamp, rest) = place.shrink2(vec2(8.0, 0.0)).split_left_right_at_x(place.min.x + 48.0);
            widget::lamp(ui.painter(), view, lamp, on);
            let (name, key) = rest.split_left_right_at_x(rest.max.x - 96.0);
            let name = Rect::from_min_max(name.min, name.max - vec2(6.0, 0.0));
            fit_text(
                ui.painter(),
                name,
                Align2::LEFT_CENTER,
                input.name().get(view.lang),
                theme::LABEL,
                view.theme.text,
            );
            let label = match forced {
                None => view.text("自由", "FREE"),
                Some(true) => view.text("强制 1", "FORCED 1"),
                Some(false) => view.text("强制 0", "FORCED 0"),
            };
            let look = ButtonState { on: forced.is_some(), locked: false };
            if self.walk.button(ui, view, key, (input.id(), label), look) {
                let next = match forced {
                    None => Some(!on),
                    Some(was) if was != on => None,
                    Some(was) => Some(!was).filter(|_| was),
                };
                done = Some(SimCommand::Force(*input, next));
            }
        }
        let words = format!("{} {}/{count}", view.text("下一页", "MORE"), self.input_page + 1);
        let place = Rect::from_min_size(pos2(keys.max.x - 180.0, keys.min.y + 2.0), vec2(180.0, ROW_HEIGHT - 2.0));
        if self.walk.button(ui, view, place, ("sim-more", &words), ButtonState::default()) {
            self.input_page = (self.input_page + 1) % count;
        }
        let hint = Rect::from_min_max(keys.min, pos2(place.min.x - theme::PAD, keys.max.y));
        let words = view.text("触摸：强制 → 释放", "touch: force, then free");
        fit_text(ui.painter(), hint, Align2::LEFT_CENTER, words, theme::LABEL, view.theme.muted);
        done
    }

    fn faults(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, sim: &SimView) -> Option<SimCommand> {
        let mut done = None;
        let half = (rect.width() + theme::GAP) / 2.0;
        for (index, row) in sim_fault::without_argument().enumerate() {
            let name = row.name;
            let corner = rect.min + vec2((index % 2) as f32 * half, (index / 2) as f32 * (ROW_HEIGHT + 8.0));
            let place = Rect::from_min_size(corner, vec2(half - theme::GAP, ROW_HEIGHT));
            let on = sim.faults.contains(&name);
            if self.walk.button(ui, view, place, (name, row.text.get(view.lang)), ButtonState { on, locked: false }) {
                done = Some(SimCommand::Fault(name, !on));
            }
        }
        done
    }

    fn part(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, sim: &SimView) -> Option<SimCommand> {
        let (keys, body) = rect.split_top_bottom_at_y(rect.min.y + ROW_HEIGHT + theme::GAP);
        let wheel = !view.snapshot.kind.is_lathe();
        let count = if wheel { 2.0 } else { 1.0 };
        let half = (keys.width() + theme::GAP) / count;
        let cell = |index: f32| {
            let corner = keys.min + vec2(index * half, 0.0);
            Rect::from_min_size(corner, vec2(half - theme::GAP, ROW_HEIGHT))
        };
        let mut done = None;
        let part = ("sim-new-part", view.text("换上新毛坯", "NEW PART"));
        if self.walk.button(ui, view, cell(0.0), part, ButtonState::default()) {
            done = Some(SimCommand::NewPart);
        }
        let sharp = ("sim-sharpen", view.text("砂轮变锋利", "SHARP WHEEL"));
        if wheel && self.walk.button(ui, view, cell(1.0), sharp, ButtonState::default()) {
            done = Some(SimCommand::SharpenWheel);
        }
        card(ui.painter(), body, view.theme.surface, view.theme.line);
        let inside = body.shrink2(vec2(theme::PAD, 6.0));
        let mut lines = Vec::new();
        if wheel {
            let diameter = view.text("砂轮直径 mm", "wheel diameter mm").to_owned();
            lines.push((diameter, format_length(sim.wheel_diameter_mm)));
            let dull = view.text("砂轮钝化 %", "wheel dullness %").to_owned();
            lines.push((dull, format!("{:.0}", sim.wheel_dullness * 100.0)));
            let load = view.text("砂轮负载 %", "wheel load %").to_owned();
            lines.push((load, format!("{:.0}", sim.wheel_load_percent)));
        } else {
            let speed = view.text("主轴 r/min", "spindle rpm").to_owned();
            lines.push((speed, format_whole(view.snapshot.wheel_rpm)));
            let station = view.snapshot.tool_station.unwrap_or_default();
            lines.push((view.text("刀位", "station").to_owned(), format!("T{station}")));
        }
        lines.extend(sim.sizes.iter().map(|(what, size)| (what.get(view.lang).into_owned(), format_length(*size))));
        lines.extend(sim.events.iter().map(|event| (event.get(view.lang).into_owned(), String::new())));
        let rows = (inside.height() / 27.0).floor().max(1.0) as usize;
        for (index, (name, value)) in lines.iter().enumerate().take(rows * 2) {
            let corner = inside.min + vec2((index / rows) as f32 * inside.width() / 2.0, (index % rows) as f32 * 27.0);
            let line = Rect::from_min_size(corner, vec2(inside.width() / 2.0 - theme::PAD, 27.0));
            let (left, right) = line.split_left_right_at_fraction(0.62);
            fit_text(ui.painter(), left, Align2::LEFT_CENTER, name, theme::LABEL, view.theme.muted);
            text_line(ui.painter(), right, Align2::RIGHT_CENTER, value, theme::LABEL, view.theme.text);
        }
        done
    }
}
