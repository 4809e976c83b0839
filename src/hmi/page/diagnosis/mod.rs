//! Diagnosis: live state of every input, output and internal signal, with port and parameter; ports assigned twice; why a
//! key is blocked; and the checklist of commissioning.
//! Source: spec B6, K6.1, K2.4.

mod checklist;

use egui::{Rect, vec2};

use super::{HandOver, PageContext, PageUi, Scroll, ScrollList, VisibleRows, empty};
use crate::defs::key::{Key, KeyGroup};
use crate::defs::port_conflict;
use crate::defs::signal::{Input, Output};
use crate::hmi::{Area, EditKey, View, format_volts, panel, theme, widget};
use crate::link::Snapshot;
use crate::link::internal_signal::InternalSignal;
use checklist::Checklist;

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
    Check,
}

const TABS: [DiagnosisTab; 5] =
    [DiagnosisTab::Inputs, DiagnosisTab::Outputs, DiagnosisTab::Internals, DiagnosisTab::Keys, DiagnosisTab::Check];

/// State of the page.
#[derive(Debug, Default)]
pub struct DiagnosisPage {
    tab: DiagnosisTab,
    scroll: Scroll,
    checklist: Checklist,
}

/// One line of the port table.
#[derive(Default)]
struct PortLine {
    on: bool,
    name: String,
    id: &'static str,
    port: u8,
    in_conflict: bool,
    /// K3.13: the circuit is closed, so that 0 V is measured at the terminal.
    low: Option<bool>,
    normally_closed: Option<bool>,
    param: u16,
    volts: Option<f64>,
}

impl PageUi for DiagnosisPage {
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<HandOver>) {
        (self.tab, self.scroll) = (DiagnosisTab::default(), Scroll::default());
    }

    fn record(&mut self, snapshot: &Snapshot) {
        self.checklist.record(snapshot);
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, out, .. } = ctx;
        let (bar, rest) = rect.shrink(theme::PAD).split_top(widget::KEYS_HEIGHT);
        let dead = blocked_keys(view);
        let keys = [
            ("tab-inputs", view.text("输入", "INPUTS").to_owned()),
            ("tab-outputs", view.text("输出", "OUTPUTS").to_owned()),
            ("tab-internals", view.text("内部", "INTERNAL").to_owned()),
            ("tab-keys", format!("{} {}", view.text("按键", "KEYS"), dead.len())),
            ("tab-check", view.text("核对", "CHECK").to_owned()),
        ];
        let chosen = TABS.iter().position(|tab| *tab == self.tab).unwrap_or(0);
        let step = |edit: &EditKey| match edit {
            EditKey::Right | EditKey::Next => 1,
            EditKey::Left | EditKey::Previous => TABS.len() - 1,
            _ => 0,
        };
        let by_key = (chosen + typed.edits.iter().map(step).sum::<usize>()) % TABS.len();
        let wanted = TABS[widget::tabs(view, bar, &keys, chosen).unwrap_or(by_key)];
        if wanted != self.tab {
            (self.tab, self.scroll) = (wanted, Scroll::default());
        }
        let rest = rest.trim_top(theme::GAP);
        let rest = conflicts(view, rest);
        match self.tab {
            DiagnosisTab::Inputs => self.ports(rest, view, typed.scroll_pages, &inputs(view)),
            DiagnosisTab::Outputs => self.ports(rest, view, typed.scroll_pages, &outputs(view)),
            DiagnosisTab::Internals => internals(rest, view),
            DiagnosisTab::Keys => self.keys(rest, view, typed.scroll_pages, &dead),
            DiagnosisTab::Check => self.checklist.ui(rest, view, typed, out),
        }
    }
}

impl DiagnosisPage {
    fn ports(&mut self, rect: Rect, view: &View<'_>, pages: i32, lines: &[PortLine]) {
        let words = [
            view.text("状态", "STATE"),
            view.text("名称", "NAME"),
            view.text("标识", "ID"),
            view.text("端口", "PORT"),
            view.text("电平", "LEVEL"),
            view.text("触点", "CONTACT"),
            view.text("参数", "PARAM"),
        ];
        let list = ScrollList { id: "ports", rect, row: LINE_HEIGHT, gap: 0.0, count: lines.len() };
        let (clipped, rows) = self.striped_table(view, &list, pages, COLUMN_SHARES, words);
        rows.into_iter().for_each(|(index, place)| port_line(&clipped, place, &lines[index]));
    }

    /// Keys that are blocked now, each with the reason.
    fn keys(&mut self, rect: Rect, view: &View<'_>, pages: i32, dead: &[(Key, &str)]) {
        if dead.is_empty() {
            return empty::note(
                view,
                rect,
                view.text("面板上所有按键现在都有效", "all keys of the panel are active now"),
            );
        }
        const COLUMN_SHARES: [f32; 3] = [120.0, 160.0, 430.0];
        let words = [view.text("现在无效的按键", "INACTIVE"), view.text("标识", "ID"), view.text("原因", "REASON")];
        let list = ScrollList { id: "dead-keys", rect, row: KEY_LINE_HEIGHT, gap: 0.0, count: dead.len() };
        let (clipped, rows) = self.striped_table(view, &list, pages, COLUMN_SHARES, words);
        for (index, place) in rows {
            let (key, reason) = dead[index];
            let [name, id, why] = place.columns(COLUMN_SHARES);
            clipped.fit_left(name, key.label_on(view.snapshot.kind).get(view.lang), theme::LABEL, view.theme.text);
            clipped.fit_left(id, key.id(), theme::LABEL, view.theme.muted);
            clipped.fit_left(why, reason, theme::LABEL, view.theme.hold);
        }
    }

    /// Draws the head and the stripes of a table; returns the view clipped to its rows, and the visible rows.
    fn striped_table<'v, const N: usize>(
        &mut self,
        view: &View<'v>,
        list: &ScrollList<'_>,
        pages: i32,
        shares: [f32; N],
        words: [&str; N],
    ) -> (View<'v>, VisibleRows) {
        let (top, rest) = list.rect.split_top(26.0);
        let inner = |line: Rect| line.trim_left(4.0).trim_right(8.0);
        widget::table_header(view, inner(top), shares, words);
        let rect = widget::round_to_lines(rest, list.row);
        let clipped = view.clipped(rect);
        let rows = self.scroll.visible_rows(view, &ScrollList { rect, ..*list }, pages);
        for (_, place) in rows.iter().filter(|(index, _)| index % 2 == 1) {
            clipped.painter.rect_filled(place.with_max_x(rect.max.x), 0.0, view.theme.surface);
        }
        self.scroll.draw_bar(view, rect, list.row, list.count);
        (clipped, rows.into_iter().map(|(index, place)| (index, place.trim_left(4.0))).collect())
    }
}

/// Panel keys of this machine that are blocked now, with the reason.
fn blocked_keys<'a>(view: &View<'a>) -> Vec<(Key, &'a str)> {
    let on_panel = |key: &&Key| key.exists_on(view.snapshot.fitted()) && key.row().group != KeyGroup::Screen;
    let reason = |key: &Key| panel::key_state(view, *key).blocked.map(|why| (*key, why.get(view.lang)));
    Key::ALL.iter().filter(on_panel).filter_map(reason).collect()
}

/// Ports with more than one function, in amber above the table; returns the rectangle below.
fn conflicts(view: &View<'_>, rect: Rect) -> Rect {
    let params = &view.snapshot.params;
    let mut words = Vec::new();
    for found in port_conflict::input_conflicts(params) {
        let names = found.functions.iter().map(|input| (input.name().get(view.lang), input.port_param()));
        words.push(conflict_text(view, view.text("输入口", "input port"), found.port, names));
    }
    for found in port_conflict::output_conflicts(params) {
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
    let place = rect.band(0.0, words.len() as f32 * 26.0 + 8.0);
    view.filled_card(place, view.theme.surface, view.theme.hold);
    for (index, word) in words.iter().enumerate() {
        let line = place.trim_sides(theme::PAD).band(4.0 + index as f32 * 26.0, 26.0);
        view.fit_left(line, word, theme::LABEL, view.theme.hold);
    }
    rect.with_min_y(place.max.y + theme::GAP)
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
            low: connected.then(|| snapshot.terminals.inputs.is_closed(port)),
            normally_closed: connected.then(|| inverted >> (port - 1) & 1 == 1),
            param: input.port_param(),
            ..PortLine::default()
        }
    };
    Input::ALL.iter().filter(|input| input.exists_on(snapshot.fitted())).map(line).collect()
}

fn outputs(view: &View<'_>) -> Vec<PortLine> {
    let snapshot = view.snapshot;
    let twice = port_conflict::output_conflicts(&snapshot.params);
    let [first, second] = snapshot.kind.ui().analog_output_names.map(|name| name.get(view.lang));
    let analog = [(first, "wheel-speed"), (second, "analog-2")];
    let analog = analog.into_iter().zip(snapshot.terminals.analog_volts).map(|((name, id), volts)| PortLine {
        on: volts > 0.0,
        name: name.to_owned(),
        id,
        volts: Some(volts),
        ..PortLine::default()
    });
    let used = Output::ALL.iter().filter(|output| output.exists_on(snapshot.fitted()));
    let line = |output: &Output| {
        let port = snapshot.params.output_port(*output);
        PortLine {
            on: snapshot.outputs.has(*output),
            name: output.name().get(view.lang).to_owned(),
            id: output.id(),
            port,
            in_conflict: twice.iter().any(|conflict| conflict.functions.contains(output)),
            low: (port > 0).then(|| snapshot.terminals.outputs.is_closed(port)),
            param: output.port_param(),
            ..PortLine::default()
        }
    };
    analog.chain(used.map(line)).collect()
}

fn port_line(view: &View<'_>, place: Rect, line: &PortLine) {
    let [state, name, id, port, level, contact, param] = place.columns(COLUMN_SHARES);
    let (text, quiet) = (view.theme.text, view.theme.muted);
    widget::lamp(view, state, line.on);
    let put = |rect, words: &str, ink| {
        view.fit_left(rect, words, theme::LABEL, ink);
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
    match line.low {
        Some(true) => put(level, view.text("低", "LOW"), text),
        Some(false) => put(level, view.text("高", "HIGH"), quiet),
        None => {}
    }
    if let Some(closed) = line.normally_closed {
        put(contact, if closed { view.text("常闭 NC", "NC") } else { view.text("常开 NO", "NO") }, quiet);
    }
    put(param, &format!("P{}", line.param), quiet);
}

/// Internal signals, in two columns.
fn internals(rect: Rect, view: &View<'_>) {
    let fitted = view.snapshot.fitted();
    let signals: Vec<_> = InternalSignal::ALL.iter().filter(|signal| fitted.meets(signal.needs())).collect();
    let rows = signals.len().div_ceil(2);
    let height = (rect.height() / rows as f32).min(LINE_HEIGHT + 2.0);
    let width = (rect.width() - theme::PAD) / 2.0;
    for (index, state) in signals.into_iter().enumerate() {
        let corner = rect.min + vec2((index / rows) as f32 * (width + theme::PAD), (index % rows) as f32 * height);
        let place = Rect::from_min_size(corner, vec2(width, height));
        if index % rows % 2 == 1 {
            view.painter.rect_filled(place, 0.0, view.theme.surface);
        }
        let [lamp, name, id] = place.trim_sides(4.0).columns([48.0, 170.0, 160.0]);
        widget::lamp(view, lamp, view.snapshot.internals.has(*state));
        view.fit_left(name, state.name().get(view.lang), theme::LABEL, view.theme.text);
        view.fit_left(id, state.id(), theme::LABEL, view.theme.muted);
    }
}
