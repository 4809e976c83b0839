//! Diagnosis: live state of every input, output and internal signal, with port and parameter; ports assigned twice; and
//! why a key is blocked.
//! Source: spec B6, K6.1, K2.4.

use egui::{Align2, Painter, Rect, Ui, pos2, vec2};

use super::scroll::Scroll;
use super::{PageContext, PageUi, TypedInput};
use crate::defs::key::{Key, KeyGroup};
use crate::defs::port_conflict;
use crate::defs::signal::{Input, Output};
use crate::hmi::edit_key::EditKey;
use crate::hmi::view::{View, card, fit_text, format_volts};
use crate::hmi::{panel, theme, widget};
use crate::link::internal_signal::InternalSignal;

/// Heights of a line of the port table and of the key list.
const LINE_HEIGHT: f32 = 30.0;
const KEY_LINE_HEIGHT: f32 = 34.0;
/// Column shares: state, name, id, port, level, contact, parameter.
const COLUMN_SHARES: [f32; 7] = [58.0, 190.0, 196.0, 62.0, 56.0, 84.0, 66.0];
/// Maximum number of conflicts shown above the table.
const MAX_CONFLICTS: usize = 3;

/// Tabs of the page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum DiagnosisTab {
    #[default]
    Inputs,
    Outputs,
    Internals,
    Keys,
}

const TABS: [DiagnosisTab; 4] =
    [DiagnosisTab::Inputs, DiagnosisTab::Outputs, DiagnosisTab::Internals, DiagnosisTab::Keys];

/// State of the page.
#[derive(Debug, Default)]
pub struct DiagnosisPage {
    tab: DiagnosisTab,
    scroll: Scroll,
}

/// One line of the port table.
struct PortLine {
    on: bool,
    name: String,
    id: &'static str,
    port: u8,
    in_conflict: bool,
    level: Option<bool>,
    normally_closed: Option<bool>,
    param: u16,
    volts: Option<f64>,
}

impl PageUi for DiagnosisPage {
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<u32>) {
        *self = Self::default();
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { ui, rect, view, typed, .. } = ctx;
        let inside = rect.shrink(theme::PAD);
        let (bar, rest) = inside.split_top_bottom_at_y(inside.min.y + widget::TABS_HEIGHT);
        let dead = blocked_keys(view);
        let keys = [
            ("tab-inputs", view.text("输入", "INPUTS").to_owned()),
            ("tab-outputs", view.text("输出", "OUTPUTS").to_owned()),
            ("tab-internals", view.text("内部", "INTERNAL").to_owned()),
            ("tab-keys", format!("{} {}", view.text("按键", "KEYS"), dead.len())),
        ];
        let chosen = TABS.iter().position(|tab| *tab == self.tab).unwrap_or(0);
        let step = |edit: &EditKey| match edit {
            EditKey::Right | EditKey::Next => 1,
            EditKey::Left | EditKey::Previous => TABS.len() - 1,
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
            DiagnosisTab::Inputs => self.ports(ui, rest, view, typed, &inputs(view)),
            DiagnosisTab::Outputs => self.ports(ui, rest, view, typed, &outputs(view)),
            DiagnosisTab::Internals => internals(ui.painter(), rest, view),
            DiagnosisTab::Keys => self.keys(ui, rest, view, typed, &dead),
        }
    }
}

impl DiagnosisPage {
    fn ports(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, typed: &TypedInput<'_>, lines: &[PortLine]) {
        let (head, rest) = rect.split_top_bottom_at_y(rect.min.y + 26.0);
        let words = [
            view.text("状态", "STATE"),
            view.text("名称", "NAME"),
            view.text("标识", "ID"),
            view.text("端口", "PORT"),
            view.text("电平", "LEVEL"),
            view.text("触点", "CONTACT"),
            view.text("参数", "PARAM"),
        ];
        let inner = |line: Rect| Rect::from_min_max(line.min + vec2(4.0, 0.0), line.max - vec2(8.0, 0.0));
        widget::table_header(ui.painter(), view, inner(head), COLUMN_SHARES, words);
        let list = widget::round_to_lines(rest, LINE_HEIGHT);
        if typed.scroll_pages != 0 {
            self.scroll.scroll_pages(typed.scroll_pages, list, LINE_HEIGHT);
        }
        let (first, last) = self.scroll.handle_input(ui, "ports", list, LINE_HEIGHT, lines.len());
        let painter = ui.painter().with_clip_rect(list);
        for (index, line) in lines.iter().enumerate().take(last).skip(first) {
            let top = list.min.y + ((index as f64 - self.scroll.top) * f64::from(LINE_HEIGHT)) as f32;
            let place = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width(), LINE_HEIGHT));
            if index % 2 == 1 {
                painter.rect_filled(place, 0.0, view.theme.surface);
            }
            port_line(&painter, view, inner(place), line);
        }
        self.scroll.draw_bar(ui, view, list, LINE_HEIGHT, lines.len());
    }

    /// Keys that are blocked now, each with the reason.
    fn keys(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, typed: &TypedInput<'_>, dead: &[(Key, &str)]) {
        if dead.is_empty() {
            let words = view.text("面板上所有按键现在都有效", "every key of the panel acts now");
            let line = Rect::from_center_size(rect.center(), vec2(rect.width(), 30.0));
            fit_text(ui.painter(), line, Align2::CENTER_CENTER, words, theme::SECONDARY, view.theme.muted);
            return;
        }
        const COLUMN_SHARES: [f32; 3] = [120.0, 160.0, 430.0];
        let (head, rest) = rect.split_top_bottom_at_y(rect.min.y + 26.0);
        let words = [view.text("现在无效的按键", "DEAD NOW"), view.text("标识", "ID"), view.text("原因", "REASON")];
        let inner = |line: Rect| Rect::from_min_max(line.min + vec2(4.0, 0.0), line.max - vec2(8.0, 0.0));
        widget::table_header(ui.painter(), view, inner(head), COLUMN_SHARES, words);
        let list = widget::round_to_lines(rest, KEY_LINE_HEIGHT);
        if typed.scroll_pages != 0 {
            self.scroll.scroll_pages(typed.scroll_pages, list, KEY_LINE_HEIGHT);
        }
        let (first, last) = self.scroll.handle_input(ui, "dead-keys", list, KEY_LINE_HEIGHT, dead.len());
        let painter = ui.painter().with_clip_rect(list);
        for (index, (key, reason)) in dead.iter().enumerate().take(last).skip(first) {
            let top = list.min.y + ((index as f64 - self.scroll.top) * f64::from(KEY_LINE_HEIGHT)) as f32;
            let place = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width(), KEY_LINE_HEIGHT));
            if index % 2 == 1 {
                painter.rect_filled(place, 0.0, view.theme.surface);
            }
            let [name, id, why] = widget::columns(inner(place), COLUMN_SHARES);
            let label = key.label_on(view.snapshot.kind).get(view.lang);
            fit_text(&painter, name, Align2::LEFT_CENTER, label, theme::LABEL, view.theme.text);
            fit_text(&painter, id, Align2::LEFT_CENTER, key.id(), theme::LABEL, view.theme.muted);
            fit_text(&painter, why, Align2::LEFT_CENTER, reason, theme::LABEL, view.theme.hold);
        }
        self.scroll.draw_bar(ui, view, list, KEY_LINE_HEIGHT, dead.len());
    }
}

/// Panel keys of this kind of machine that are blocked now, with the reason.
fn blocked_keys<'a>(view: &View<'a>) -> Vec<(Key, &'a str)> {
    let on_panel = |key: &&Key| key.exists_on(view.snapshot.kind) && key.row().group != KeyGroup::Screen;
    let reason = |key: &Key| panel::key_state(view, *key).blocked.map(|why| (*key, why.get(view.lang)));
    Key::ALL.iter().filter(on_panel).filter_map(reason).collect()
}

/// Ports with more than one function, in amber above the table; returns the rectangle below.
fn conflicts(painter: &Painter, view: &View<'_>, rect: Rect) -> Rect {
    let params = &view.snapshot.params;
    let mut words = Vec::new();
    for found in port_conflict::input_conflicts(params) {
        let names = found.functions.iter().map(|input| (input.name().get(view.lang), input.port_param()));
        words.push(conflict_text(view, view.text("输入口", "input port"), found.port, names));
    }
    for found in port_conflict::output_conflicts(view.snapshot.kind, params) {
        let names = found.functions.iter().map(|output| (output.name().get(view.lang), output.port_param()));
        words.push(conflict_text(view, view.text("输出口", "output port"), found.port, names));
    }
    if words.is_empty() {
        return rect;
    }
    let more = words.len().saturating_sub(MAX_CONFLICTS);
    words.truncate(MAX_CONFLICTS);
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
        fit_text(painter, line, Align2::LEFT_CENTER, word, theme::LABEL, view.theme.hold);
    }
    Rect::from_min_max(pos2(rect.min.x, place.max.y + theme::GAP), rect.max)
}

fn conflict_text<'a>(view: &View<'_>, port: &str, number: u8, names: impl Iterator<Item = (&'a str, u16)>) -> String {
    let names: Vec<String> = names.map(|(name, param)| format!("{name} P{param}")).collect();
    let joint = view.text("、", ", ");
    format!("⚠ {} {port} {number}{}{}", view.text("端口冲突", "conflict"), view.text("：", ": "), names.join(joint))
}

fn inputs(view: &View<'_>) -> Vec<PortLine> {
    let snapshot = view.snapshot;
    let inverted = snapshot.params.inverted_inputs();
    let twice = port_conflict::input_conflicts(&snapshot.params);
    let line = |input: &Input| {
        let port = snapshot.params.input_port(*input);
        let connected = port > 0;
        PortLine {
            on: snapshot.inputs.has(*input),
            name: input.name().get(view.lang).to_owned(),
            id: input.id(),
            port,
            in_conflict: twice.iter().any(|conflict| conflict.functions.contains(input)),
            level: connected.then(|| snapshot.input_terminals.level(port)),
            normally_closed: connected.then(|| inverted >> (port - 1) & 1 == 1),
            param: input.port_param(),
            volts: None,
        }
    };
    Input::ALL.iter().filter(|input| input.exists_on(snapshot.kind)).map(line).collect()
}

fn outputs(view: &View<'_>) -> Vec<PortLine> {
    let snapshot = view.snapshot;
    let twice = port_conflict::output_conflicts(snapshot.kind, &snapshot.params);
    let [first, second] = snapshot.kind.ui().analog_output_names.map(|name| name.get(view.lang));
    let analog = [(first, "wheel-speed"), (second, "analog-2")];
    let analog = analog.into_iter().zip(snapshot.analog_volts).map(|((name, id), volts)| PortLine {
        on: volts > 0.0,
        name: name.to_owned(),
        id,
        port: 0,
        in_conflict: false,
        level: None,
        normally_closed: None,
        param: 0,
        volts: Some(volts),
    });
    let used = Output::ALL.iter().filter(|output| output.exists_on(snapshot.kind));
    let line = |output: &Output| {
        let port = snapshot.params.output_port(*output);
        PortLine {
            on: snapshot.outputs.has(*output),
            name: output.name().get(view.lang).to_owned(),
            id: output.id(),
            port,
            in_conflict: twice.iter().any(|conflict| conflict.functions.contains(output)),
            level: (port > 0).then(|| snapshot.output_terminals.level(port)),
            normally_closed: None,
            param: output.port_param(),
            volts: None,
        }
    };
    analog.chain(used.map(line)).collect()
}

fn port_line(painter: &Painter, view: &View<'_>, place: Rect, line: &PortLine) {
    let [state, name, id, port, level, contact, param] = widget::columns(place, COLUMN_SHARES);
    let (text, quiet) = (view.theme.text, view.theme.muted);
    widget::lamp(painter, view, state, line.on);
    let put = |rect, words: &str, ink| {
        fit_text(painter, rect, Align2::LEFT_CENTER, words, theme::LABEL, ink);
    };
    put(name, &line.name, text);
    put(id, line.id, quiet);
    if let Some(volts) = line.volts {
        put(port.union(level), &format_volts(volts), text);
        return;
    }
    match (line.port, line.in_conflict) {
        (0, _) => put(port, view.text("未接", "none"), quiet),
        (number, true) => put(port, &format!("⚠ {number}"), view.theme.hold),
        (number, false) => put(port, &number.to_string(), text),
    }
    if let Some(high) = line.level {
        put(
            level,
            if high { view.text("高", "HIGH") } else { view.text("低", "LOW") },
            if high { text } else { quiet },
        );
    }
    if let Some(closed) = line.normally_closed {
        put(contact, if closed { view.text("常闭 NC", "NC") } else { view.text("常开 NO", "NO") }, quiet);
    }
    put(param, &format!("P{}", line.param), quiet);
}

/// Internal signals, in two columns.
fn internals(painter: &Painter, rect: Rect, view: &View<'_>) {
    let rows = InternalSignal::ALL.len().div_ceil(2);
    let height = (rect.height() / rows as f32).min(LINE_HEIGHT + 2.0);
    let width = (rect.width() - theme::PAD) / 2.0;
    for (index, state) in InternalSignal::ALL.iter().enumerate() {
        let corner = rect.min + vec2((index / rows) as f32 * (width + theme::PAD), (index % rows) as f32 * height);
        let place = Rect::from_min_size(corner, vec2(width, height));
        if index % rows % 2 == 1 {
            painter.rect_filled(place, 0.0, view.theme.surface);
        }
        let [lamp, name, id] = widget::columns(place.shrink2(vec2(4.0, 0.0)), [48.0, 170.0, 160.0]);
        widget::lamp(painter, view, lamp, view.snapshot.internals.has(*state));
        fit_text(painter, name, Align2::LEFT_CENTER, state.name().get(view.lang), theme::LABEL, view.theme.text);
        fit_text(painter, id, Align2::LEFT_CENTER, state.id(), theme::LABEL, view.theme.muted);
    }
}
