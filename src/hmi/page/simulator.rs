//! Simulator page: forced inputs, faults, part and wheel, for learning on a laptop. A real machine has no such page.
//! Source: spec P1–P8.

use std::borrow::Cow;

use egui::{Rect, pos2, vec2};

use super::{HandOver, PageContext, PageUi, empty};
use crate::defs::signal::Input;
use crate::defs::sim_fault;
use crate::defs::text::Text;
use crate::hmi::{Area, KeyboardFocus, PageKey, View, format_whole, pictogram, round_to_lines, scene, theme, widget};
use crate::link::Command;
use crate::link::simulation::{SimCommand, SimView};

/// Height of a key.
const ROW_HEIGHT: f32 = 48.0;
/// Maximum number of sizes shown.
const MAX_SIZES: usize = 12;
/// Width of the live scene beside the figures of the part, as a share.
const SCENE_SHARE: f32 = 0.46;
/// Height of the contact in it, as a share.
const CONTACT_SHARE: f32 = 0.42;

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
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<HandOver>) {
        *self = Self { tab: self.tab, ..Self::default() };
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, out, .. } = ctx;
        let Some(sim) = view.snapshot.simulated.as_deref() else {
            let remedy = view.text("控制器接的是真实的机床。", "A real machine is wired to the control.");
            let what = view.text("没有模拟机床", "no simulated machine");
            return empty::show(view, rect, pictogram::NO_PAGE, what, remedy);
        };
        self.walk.begin_frame(&typed.edits);
        let (tabs, body) = rect.shrink2(vec2(theme::PAD, 6.0)).split_top(ROW_HEIGHT + theme::GAP);
        let key = |index: usize| {
            let (name, label) = TABS[index];
            let label = if index == PART_TAB { view.snapshot.kind.ui().part_tab } else { label };
            PageKey::new(name, label.get(view.lang)).on(self.tab == index)
        };
        if let Some(index) = self.walk.keys(view, tabs.trim_bottom(theme::GAP), &[0, 1, 2].map(key)) {
            (self.tab, self.input_page) = (index, 0);
        }
        let done = match self.tab {
            0 => self.inputs(body, view, sim, typed.scroll_pages),
            1 => self.faults(body, view, sim),
            _ => self.part(body, view, sim),
        };
        out.extend(done.map(Command::Simulate));
    }
}

impl SimulatorPage {
    /// Two columns of inputs. A touch forces a free input to its opposite state, a forced 1 to 0; it frees a forced 0.
    fn inputs(&mut self, rect: Rect, view: &View<'_>, sim: &SimView, pages: i32) -> Option<SimCommand> {
        let (list, keys) = rect.split_bottom(ROW_HEIGHT);
        let list = round_to_lines(list, ROW_HEIGHT);
        let each = (list.height() / ROW_HEIGHT) as usize * 2;
        let inputs: Vec<Input> =
            Input::ALL.iter().copied().filter(|input| input.exists_on(view.snapshot.fitted())).collect();
        let count = inputs.len().div_ceil(each.max(1));
        self.input_page = (self.input_page as i32 + pages).rem_euclid(count as i32) as usize;
        let mut done = None;
        for (index, input) in inputs.iter().skip(self.input_page * each).take(each).enumerate() {
            let place = list.band((index / 2) as f32 * ROW_HEIGHT, ROW_HEIGHT - 3.0).cell(index % 2, 2);
            let forced = sim.forced.iter().find(|(other, _)| other == input).map(|(_, on)| *on);
            let on = view.snapshot.inputs.has(*input);
            view.card(place);
            let (lamp, rest) = place.trim_sides(8.0).split_left_right_at_x(place.min.x + 48.0);
            widget::lamp(view, lamp, on);
            let (name, key) = rest.split_right(96.0);
            view.fit_left(name.trim_right(6.0), input.name().get(view.lang), theme::LABEL, view.theme.text);
            let label = match forced {
                None => view.text("自由", "FREE"),
                Some(true) => view.text("强制 1", "FORCED 1"),
                Some(false) => view.text("强制 0", "FORCED 0"),
            };
            if self.walk.button(view, key, PageKey::new(input.id(), label).on(forced.is_some())) {
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
        if self.walk.button(view, place, PageKey::new("sim-more", &words)) {
            self.input_page = (self.input_page + 1) % count;
        }
        let hint = keys.with_max_x(place.min.x - theme::PAD);
        view.fit_left(hint, view.text("触摸：强制 → 释放", "touch: force, then free"), theme::LABEL, view.theme.muted);
        done
    }

    fn faults(&mut self, rect: Rect, view: &View<'_>, sim: &SimView) -> Option<SimCommand> {
        let mut done = None;
        let fitted = view.snapshot.fitted();
        let faults = sim_fault::without_argument().filter(|row| row.exists_on(fitted));
        for (index, row) in faults.enumerate() {
            let name = row.name;
            let place = rect.band((index / 2) as f32 * (ROW_HEIGHT + 8.0), ROW_HEIGHT).cell(index % 2, 2);
            let on = sim.faults.contains(&name);
            if self.walk.button(view, place, PageKey::new(name, row.text.get(view.lang)).on(on)) {
                done = Some(SimCommand::Fault(name, !on));
            }
        }
        done
    }

    fn part(&mut self, rect: Rect, view: &View<'_>, sim: &SimView) -> Option<SimCommand> {
        let (keys, body) = rect.split_top(ROW_HEIGHT + theme::GAP);
        let wheel = !view.snapshot.kind.is_lathe();
        let keys_shown = [
            PageKey::new("sim-new-part", view.text("换上新毛坯", "NEW PART")),
            PageKey::new("sim-sharpen", view.text("砂轮变锋利", "SHARP WHEEL")),
        ];
        let count = if wheel { 2 } else { 1 };
        let touched = self.walk.keys(view, keys.band(0.0, ROW_HEIGHT), &keys_shown[..count]);
        let done = touched.map(|index| if index == 0 { SimCommand::NewPart } else { SimCommand::SharpenWheel });
        let (body, live) = body.split_right(if wheel { body.width() * SCENE_SHARE } else { 0.0 });
        if wheel {
            let live = live.trim_left(theme::GAP);
            view.card(live);
            scene::paint_with_contact(live.shrink(theme::FRAME), view, live.height() * CONTACT_SHARE);
        }
        view.card(body);
        let inside = body.shrink2(vec2(theme::PAD, 6.0));
        let mut lines: Vec<(Cow<'_, str>, String)> = if wheel {
            vec![
                (view.text("砂轮直径 mm", "wheel diameter mm").into(), view.length(sim.wheel_diameter_mm)),
                (view.text("砂轮钝化 %", "wheel dullness %").into(), format!("{:.0}", sim.wheel_dullness * 100.0)),
                (view.text("砂轮负载 %", "wheel load %").into(), format!("{:.0}", sim.wheel_load_percent)),
            ]
        } else {
            let station = view.snapshot.tool_station.unwrap_or_default();
            vec![
                (view.text("主轴 r/min", "spindle rpm").into(), format_whole(view.snapshot.wheel_rpm)),
                (view.text("刀位", "station").into(), format!("T{station}")),
            ]
        };
        lines.extend(sim.sizes.iter().take(MAX_SIZES).map(|size| (size.name.get(view.lang), view.length(size.mm))));
        lines.extend(sim.events.iter().map(|event| (event.get(view.lang), String::new())));
        let rows = (inside.height() / 27.0).floor().max(1.0) as usize;
        for (index, (name, value)) in lines.iter().enumerate().take(rows * 2) {
            let corner = inside.min + vec2((index / rows) as f32 * inside.width() / 2.0, (index % rows) as f32 * 27.0);
            let line = Rect::from_min_size(corner, vec2(inside.width() / 2.0 - theme::PAD, 27.0));
            let (left, right) = line.split_left_right_at_fraction(0.62);
            view.fit_left(left, name, theme::LABEL, view.theme.muted);
            view.line_right(right, value, theme::LABEL, view.theme.text);
        }
        done
    }
}
