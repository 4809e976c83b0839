//! Diagnosis: live state of every input, output and internal signal, with port and parameter; ports assigned twice; and
//! why a key is blocked.
//! Source: spec B6, K6.1, K2.4.

use egui::{Align2, Painter, Rect, Ui, pos2, vec2};

use super::Typed;
use super::scroll::Scroll;
use crate::defs::key::{Group, Key};
use crate::defs::port;
use crate::defs::signal::{Input, Output};
use crate::hmi::entry::Edit;
use crate::hmi::view::{View, card, fit};
use crate::hmi::{panel, theme, widget};
use crate::link::internal::Internal;

/// Heights of a line of the port table and of the key list.
const LINE: f32 = 30.0;
const KEY_LINE: f32 = 34.0;
/// Column shares: state, name, id, port, level, contact, parameter.
const SHARES: [f32; 7] = [58.0, 190.0, 196.0, 62.0, 56.0, 84.0, 66.0];
/// Maximum number of conflicts shown above the table.
const CONFLICTS: usize = 3;

/// Tabs of the page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Tab {
    #[default]
    Inputs,
    Outputs,
    Internals,
    Keys,
}

const TABS: [Tab; 4] = [Tab::Inputs, Tab::Outputs, Tab::Internals, Tab::Keys];

/// State of the page.
#[derive(Debug, Default)]
pub struct Diagnosis {
    tab: Tab,
    scroll: Scroll,
}

/// One line of the port table.
struct Line {
    on: bool,
    name: String,
    id: &'static str,
    port: u8,
    twice: bool,
    level: Option<bool>,
    normally_closed: Option<bool>,
    param: u16,
    volts: Option<f64>,
}

impl Diagnosis {
    /// Draws the page.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, typed: &Typed<'_>) {
        let inside = rect.shrink(theme::PAD);
        let (bar, rest) = inside.split_top_bottom_at_y(inside.min.y + widget::TABS);
        let dead = dead_keys(view);
        let keys = [
            ("tab-inputs", view.say("输入", "INPUTS").to_owned()),
            ("tab-outputs", view.say("输出", "OUTPUTS").to_owned()),
            ("tab-internals", view.say("内部", "INTERNAL").to_owned()),
            ("tab-keys", format!("{} {}", view.say("按键", "KEYS"), dead.len())),
        ];
        let chosen = TABS.iter().position(|tab| *tab == self.tab).unwrap_or(0);
        let step = |edit: &Edit| match edit {
            Edit::Right | Edit::Next => 1,
            Edit::Left | Edit::Previous => TABS.len() - 1,
            _ => 0,
        };
        let by_key = (chosen + typed.edits.iter().map(step).sum::<usize>()) % TABS.len();
        let wanted = TABS[widget::tabs(ui, view, bar, &keys, chosen).unwrap_or(by_key)];
        if wanted != self.tab {
            (self.tab, self.scroll) = (wanted, Scroll::default());
        }
        let rest = Rect::from_min_max(rest.min + vec2(0.0, theme::GAP), rest.max);
        let rest = conflicts(ui.painter(), view, rest);
        match self.tab {
            Tab::Inputs => self.ports(ui, rest, view, typed, &inputs(view)),
            Tab::Outputs => self.ports(ui, rest, view, typed, &outputs(view)),
            Tab::Internals => internals(ui.painter(), rest, view),
            Tab::Keys => self.keys(ui, rest, view, typed, &dead),
        }
    }

    fn ports(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, typed: &Typed<'_>, lines: &[Line]) {
        let (head, rest) = rect.split_top_bottom_at_y(rect.min.y + 26.0);
        let words = [
            view.say("状态", "STATE"),
            view.say("名称", "NAME"),
            view.say("标识", "ID"),
            view.say("端口", "PORT"),
            view.say("电平", "LEVEL"),
            view.say("触点", "CONTACT"),
            view.say("参数", "PARAM"),
        ];
        let inner = |line: Rect| Rect::from_min_max(line.min + vec2(4.0, 0.0), line.max - vec2(8.0, 0.0));
        widget::head(ui.painter(), view, inner(head), SHARES, words);
        let list = widget::whole_lines(rest, LINE);
        if typed.pages != 0 {
            self.scroll.page(typed.pages, list, LINE);
        }
        let (first, last) = self.scroll.follow(ui, "ports", list, LINE, lines.len());
        let painter = ui.painter().with_clip_rect(list);
        for (index, line) in lines.iter().enumerate().take(last).skip(first) {
            let top = list.min.y + ((index as f64 - self.scroll.top) * f64::from(LINE)) as f32;
            let place = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width(), LINE));
            if index % 2 == 1 {
                painter.rect_filled(place, 0.0, view.theme.surface);
            }
            port_line(&painter, view, inner(place), line);
        }
        self.scroll.bar(ui, view, list, LINE, lines.len());
    }

    /// Keys that are blocked now, each with the reason.
    fn keys(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, typed: &Typed<'_>, dead: &[(Key, &str)]) {
        if dead.is_empty() {
            let words = view.say("面板上所有按键现在都有效", "every key of the panel acts now");
            let line = Rect::from_center_size(rect.center(), vec2(rect.width(), 30.0));
            fit(ui.painter(), line, Align2::CENTER_CENTER, words, theme::SECONDARY, view.theme.quiet);
            return;
        }
        const SHARES: [f32; 3] = [120.0, 160.0, 430.0];
        let (head, rest) = rect.split_top_bottom_at_y(rect.min.y + 26.0);
        let words = [view.say("现在无效的按键", "DEAD NOW"), view.say("标识", "ID"), view.say("原因", "REASON")];
        let inner = |line: Rect| Rect::from_min_max(line.min + vec2(4.0, 0.0), line.max - vec2(8.0, 0.0));
        widget::head(ui.painter(), view, inner(head), SHARES, words);
        let list = widget::whole_lines(rest, KEY_LINE);
        if typed.pages != 0 {
            self.scroll.page(typed.pages, list, KEY_LINE);
        }
        let (first, last) = self.scroll.follow(ui, "dead-keys", list, KEY_LINE, dead.len());
        let painter = ui.painter().with_clip_rect(list);
        for (index, (key, reason)) in dead.iter().enumerate().take(last).skip(first) {
            let top = list.min.y + ((index as f64 - self.scroll.top) * f64::from(KEY_LINE)) as f32;
            let place = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width(), KEY_LINE));
            if index % 2 == 1 {
                painter.rect_filled(place, 0.0, view.theme.surface);
            }
            let [name, id, why] = widget::columns(inner(place), SHARES);
            let label = key.name_on(view.snapshot.kind).get(view.lang);
            fit(&painter, name, Align2::LEFT_CENTER, label, theme::LABEL, view.theme.text);
            fit(&painter, id, Align2::LEFT_CENTER, key.id(), theme::LABEL, view.theme.quiet);
            fit(&painter, why, Align2::LEFT_CENTER, reason, theme::LABEL, view.theme.hold);
        }
        self.scroll.bar(ui, view, list, KEY_LINE, dead.len());
    }
}

/// Panel keys of this kind of machine that are blocked now, with the reason.
fn dead_keys<'a>(view: &View<'a>) -> Vec<(Key, &'a str)> {
    let on_panel = |key: &&Key| key.is_on(view.snapshot.kind) && key.row().group != Group::Screen;
    let reason = |key: &Key| panel::state(view, *key).blocked.map(|why| (*key, why.get(view.lang)));
    Key::ALL.iter().filter(on_panel).filter_map(reason).collect()
}

/// Ports with more than one function, in amber above the table; returns the rectangle below.
fn conflicts(painter: &Painter, view: &View<'_>, rect: Rect) -> Rect {
    let params = &view.snapshot.params;
    let mut words = Vec::new();
    for found in port::input_conflicts(params) {
        let names = found.functions.iter().map(|input| (input.name().get(view.lang), input.port_param()));
        words.push(conflict_word(view, view.say("输入口", "input port"), found.port, names));
    }
    for found in port::output_conflicts(view.snapshot.kind, params) {
        let names = found.functions.iter().map(|output| (output.name().get(view.lang), output.port_param()));
        words.push(conflict_word(view, view.say("输出口", "output port"), found.port, names));
    }
    if words.is_empty() {
        return rect;
    }
    let more = words.len().saturating_sub(CONFLICTS);
    words.truncate(CONFLICTS);
    if let Some(last) = words.last_mut().filter(|_| more > 0) {
        last.push_str(&format!(" (+{more})"));
    }
    let height = words.len() as f32 * 26.0 + 8.0;
    let place = Rect::from_min_size(rect.min, vec2(rect.width(), height));
    card(painter, place, view.theme.surface, view.theme.hold);
    for (index, word) in words.iter().enumerate() {
        let line = Rect::from_min_size(
            place.min + vec2(theme::PAD, 4.0 + index as f32 * 26.0),
            vec2(place.width() - 2.0 * theme::PAD, 26.0),
        );
        fit(painter, line, Align2::LEFT_CENTER, word, theme::LABEL, view.theme.hold);
    }
    Rect::from_min_max(pos2(rect.min.x, place.max.y + theme::GAP), rect.max)
}

fn conflict_word<'a>(view: &View<'_>, port: &str, number: u8, names: impl Iterator<Item = (&'a str, u16)>) -> String {
    let names: Vec<String> = names.map(|(name, param)| format!("{name} P{param}")).collect();
    let joint = view.say("、", ", ");
    format!("⚠ {} {port} {number}{}{}", view.say("端口冲突", "conflict"), view.say("：", ": "), names.join(joint))
}

fn inputs(view: &View<'_>) -> Vec<Line> {
    let snapshot = view.snapshot;
    let inverted = snapshot.params.inverted_inputs();
    let twice = port::input_conflicts(&snapshot.params);
    let line = |input: &Input| {
        let port = snapshot.params.input_port(*input);
        let connected = port > 0;
        Line {
            on: snapshot.inputs.has(*input),
            name: input.name().get(view.lang).to_owned(),
            id: input.id(),
            port,
            twice: twice.iter().any(|conflict| conflict.functions.contains(input)),
            level: connected.then(|| snapshot.input_terminals.level(port)),
            normally_closed: connected.then(|| inverted >> (port - 1) & 1 == 1),
            param: input.port_param(),
            volts: None,
        }
    };
    Input::ALL.iter().filter(|input| input.is_of(snapshot.kind)).map(line).collect()
}

fn outputs(view: &View<'_>) -> Vec<Line> {
    let snapshot = view.snapshot;
    let twice = port::output_conflicts(snapshot.kind, &snapshot.params);
    let [first, second] = snapshot.kind.face().analog.map(|name| name.get(view.lang));
    let analog = [(first, "wheel-speed"), (second, "analog-2")];
    let analog = analog.into_iter().zip(snapshot.analog_volts).map(|((name, id), volts)| Line {
        on: volts > 0.0,
        name: name.to_owned(),
        id,
        port: 0,
        twice: false,
        level: None,
        normally_closed: None,
        param: 0,
        volts: Some(volts),
    });
    let used = Output::ALL.iter().filter(|output| output.is_of(snapshot.kind));
    let line = |output: &Output| {
        let port = snapshot.params.output_port(*output);
        Line {
            on: snapshot.outputs.has(*output),
            name: output.name().get(view.lang).to_owned(),
            id: output.id(),
            port,
            twice: twice.iter().any(|conflict| conflict.functions.contains(output)),
            level: (port > 0).then(|| snapshot.output_terminals.level(port)),
            normally_closed: None,
            param: output.port_param(),
            volts: None,
        }
    };
    analog.chain(used.map(line)).collect()
}

fn port_line(painter: &Painter, view: &View<'_>, place: Rect, line: &Line) {
    let [state, name, id, port, level, contact, param] = widget::columns(place, SHARES);
    let (text, quiet) = (view.theme.text, view.theme.quiet);
    widget::lamp(painter, view, state, line.on);
    let put = |rect, words: &str, ink| {
        fit(painter, rect, Align2::LEFT_CENTER, words, theme::LABEL, ink);
    };
    put(name, &line.name, text);
    put(id, line.id, quiet);
    if let Some(volts) = line.volts {
        put(port.union(level), &format!("{volts:.2} V"), text);
        return;
    }
    match (line.port, line.twice) {
        (0, _) => put(port, view.say("未接", "none"), quiet),
        (number, true) => put(port, &format!("⚠ {number}"), view.theme.hold),
        (number, false) => put(port, &number.to_string(), text),
    }
    if let Some(high) = line.level {
        put(level, if high { view.say("高", "HIGH") } else { view.say("低", "LOW") }, if high { text } else { quiet });
    }
    if let Some(closed) = line.normally_closed {
        put(contact, if closed { view.say("常闭 NC", "NC") } else { view.say("常开 NO", "NO") }, quiet);
    }
    put(param, &format!("P{}", line.param), quiet);
}

/// Internal signals, in two columns.
fn internals(painter: &Painter, rect: Rect, view: &View<'_>) {
    let rows = Internal::ALL.len().div_ceil(2);
    let height = (rect.height() / rows as f32).min(LINE + 2.0);
    let width = (rect.width() - theme::PAD) / 2.0;
    for (index, state) in Internal::ALL.iter().enumerate() {
        let corner = rect.min + vec2((index / rows) as f32 * (width + theme::PAD), (index % rows) as f32 * height);
        let place = Rect::from_min_size(corner, vec2(width, height));
        if index % rows % 2 == 1 {
            painter.rect_filled(place, 0.0, view.theme.surface);
        }
        let [lamp, name, id] = widget::columns(place.shrink2(vec2(4.0, 0.0)), [48.0, 170.0, 160.0]);
        widget::lamp(painter, view, lamp, view.snapshot.internals.has(*state));
        fit(painter, name, Align2::LEFT_CENTER, state.name().get(view.lang), theme::LABEL, view.theme.text);
        fit(painter, id, Align2::LEFT_CENTER, state.id(), theme::LABEL, view.theme.quiet);
    }
}
