//! Bus page: the field bus of a real machine, its devices and drives, lost frames and times, and the stations beside it.
//! Source: docs/manual, chapter "first start on a machine".

mod times;

use egui::{Rect, vec2};

use super::{HandOver, PageContext, PageUi, Scroll, ScrollList, empty};
use crate::defs::device_state::DeviceState;
use crate::defs::port_errors::PortErrors;
use crate::hmi::widget::{self, PageKey};
use crate::hmi::{Area, EditKey, View, pictogram, round_to_lines, theme};
use crate::link::Command;
use crate::link::bus::{BusDevice, BusDrive, BusInverter, BusStation, BusView, DescriptionLine, ThreadRights};
use crate::units::{Micros, Percentiles};

/// Height of a row.
const ROW_HEIGHT: f32 = 36.0;
/// Height of a line of the figures.
const LINE_HEIGHT: f32 = 27.0;
/// Lines of the figures: the bus, then two columns of two or three.
const LINES: usize = 3;

/// Width of a lamp with its figure.
const LAMP_WIDTH: f32 = 40.0;

/// Width of the number of a device.
const NUMBER_WIDTH: f32 = 36.0;

/// An age beyond it is shown as this.
const MAX_AGE_SHOWN: Micros = Micros::from_millis(99_999);

/// Height of a line of the description, and width of the name of a property.
const PROPERTY_HEIGHT: f32 = 30.0;
const PROPERTY_NAME_SHARE: f32 = 0.34;

/// Width of the key that clears the counters.
const CLEAR_WIDTH: f32 = 150.0;

/// What the page shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Tab {
    /// The devices.
    #[default]
    State,
    /// Charts of the times.
    Times,
    /// The description of the machine.
    Description,
}

impl Tab {
    const ALL: [Self; 3] = [Self::State, Self::Times, Self::Description];

    /// The tab by touch or by the arrow keys.
    fn choose(self, view: &View<'_>, bar: Rect, edits: &[EditKey]) -> Self {
        let count = Self::ALL.len();
        let turn = |at: usize, edit: &EditKey| match edit {
            EditKey::Right | EditKey::Next => (at + 1) % count,
            EditKey::Left | EditKey::Previous => (at + count - 1) % count,
            _ => at,
        };
        let by_key = edits.iter().fold(self as usize, turn);
        let keys = [
            ("bus-state", view.text("状态", "STATE").to_owned()),
            ("bus-times", view.text("时间", "TIMES").to_owned()),
            ("bus-description", view.text("机床描述", "DESCRIPTION").to_owned()),
        ];
        Self::ALL[widget::tabs(view, bar, &keys, self as usize).unwrap_or(by_key)]
    }
}

/// State of the page.
#[derive(Debug, Default)]
pub struct BusPage {
    tab: Tab,
    /// The first device shown.
    first: usize,
    scroll: Scroll,
}

impl PageUi for BusPage {
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<HandOver>) {
        *self = Self::default();
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, out, .. } = ctx;
        let Some(bus) = view.snapshot.bus.as_deref() else {
            let remedy = view.text("控制器运行模拟机床。", "The control runs the simulated machine.");
            return empty::show(view, rect, pictogram::NO_PAGE, view.text("没有总线", "no field bus"), remedy);
        };
        let (bar, body) = rect.shrink(theme::PAD).split_top(widget::KEYS_HEIGHT);
        let (tabs, clear) = bar.split_right(CLEAR_WIDTH);
        self.tab = self.tab.choose(view, tabs.trim_right(theme::GAP), &typed.edits);
        let body = body.trim_top(theme::GAP);
        if self.tab == Tab::Description {
            return self.description(body, view, typed.scroll_pages, &bus.description);
        }
        if widget::button(view, clear, PageKey::new("bus-clear", view.text("计数清零", "CLEAR COUNTS"))) {
            out.push(Command::ClearBusCounters);
        }
        match self.tab {
            Tab::Times => times::ui(body, view, bus),
            Tab::State | Tab::Description => self.state(body, view, typed.scroll_pages, bus),
        }
    }
}

impl BusPage {
    /// The bus and its devices.
    fn state(&mut self, body: Rect, view: &View<'_>, pages: i32, bus: &BusView) {
        let lines = LINES + usize::from(bus.clock.is_some());
        let (figures, list) = body.split_top(lines as f32 * LINE_HEIGHT + 2.0 * theme::PAD);
        show_figures(figures.trim_bottom(theme::GAP), view, bus);
        let list = round_to_lines(list, ROW_HEIGHT);
        let rows = (list.height() / ROW_HEIGHT).max(1.0) as usize;
        let last = (bus.devices.len() + bus.stations.len() + usize::from(bus.inverter.is_some())).saturating_sub(rows);
        self.first = (self.first as i32 + pages * rows as i32).clamp(0, last as i32) as usize;
        let inverter = bus.inverter.as_ref().map(|inverter| inverter_row(view, inverter));
        let devices = bus.devices.iter().zip(1..).map(|(device, number)| device_row(view, number, device));
        let stations = bus.stations.iter().map(|station| station_row(view, station));
        for (index, row) in inverter.into_iter().chain(devices).chain(stations).skip(self.first).take(rows).enumerate()
        {
            show_row(list.band(index as f32 * ROW_HEIGHT, ROW_HEIGHT - 3.0), view, &row);
        }
    }

    /// The description of the machine.
    fn description(&mut self, rect: Rect, view: &View<'_>, pages: i32, lines: &[DescriptionLine]) {
        let list = ScrollList {
            id: "description",
            rect: round_to_lines(rect, PROPERTY_HEIGHT),
            row: PROPERTY_HEIGHT,
            gap: 0.0,
            count: lines.len(),
        };
        let (clipped, places) = self.scroll.rows(view, &list, pages);
        for (index, place) in places {
            match &lines[index] {
                DescriptionLine::Heading(words) => {
                    clipped.card(place.trim_bottom(2.0));
                    let words = words.get(view.lang);
                    clipped.fit_left(place.trim_sides(8.0), &words, theme::LABEL, view.theme.text);
                }
                DescriptionLine::Property(name, value) => {
                    let (left, right) = place.trim_sides(8.0).split_left_right_at_fraction(PROPERTY_NAME_SHARE);
                    clipped.fit_left(left.trim_right(6.0), name.get(view.lang), theme::LABEL, view.theme.muted);
                    clipped.fit_left(right, value, theme::LABEL, view.theme.text);
                }
            }
        }
    }
}

/// State of the bus, cycles, and the times in two columns.
fn show_figures(rect: Rect, view: &View<'_>, bus: &BusView) {
    view.card(rect);
    let inside = rect.shrink2(vec2(theme::PAD, theme::PAD / 2.0));
    let (lamp, title) = inside.band(0.0, LINE_HEIGHT).split_left_right_at_x(inside.min.x + LAMP_WIDTH);
    widget::lamp(view, lamp, bus.fault.is_none());
    let state = match &bus.fault {
        None => format!("{}  {}  {}", bus.interface, view.text("运行", "in operation"), rights_text(view, bus.rights)),
        Some(fault) => format!("{}  {}", bus.interface, fault.get(view.lang)),
    };
    let colour = if bus.fault.is_none() { view.theme.text } else { view.theme.alarm_text };
    view.fit_left(title, &state, theme::SECONDARY, colour);
    let counter = bus.working_counter.map_or_else(|| "–".to_owned(), |(found, whole)| format!("{found} / {whole}"));
    let mut figures = vec![
        [
            (view.text("周期 / 丢失", "cycles / lost"), format!("{} / {}", bus.cycles, bus.lost)),
            (
                view.text("往返 50% / 99% / 最大", "round trip 50% / 99% / max"),
                times::words(bus.round_trip.percentiles),
            ),
        ],
        [
            (view.text("工作计数器", "working counter"), counter),
            (view.text("唤醒 50% / 99% / 最大", "wake-up 50% / 99% / max"), times::words(bus.wake_up.percentiles)),
        ],
    ];
    if let Some(clock) = bus.clock {
        figures.push([
            (view.text("时钟漂移", "clock drift"), format!("{:.1} ppm", clock.drift_ppm)),
            (
                view.text("时钟偏差 50% / 99% / 最大", "off the clock 50% / 99% / max"),
                times::words(clock.distance.percentiles),
            ),
        ]);
    }
    for (index, columns) in figures.iter().enumerate() {
        let line = inside.band((1 + index) as f32 * LINE_HEIGHT, LINE_HEIGHT);
        // The counts are short, the times long.
        for (column, ((name, value), share)) in columns.iter().zip([0.5, 0.56]).enumerate() {
            let place = line.cell(column, 2).trim_right(theme::PAD);
            let (left, right) = place.split_left_right_at_fraction(share);
            view.fit_left(left.trim_right(4.0), name, theme::LABEL, view.theme.muted);
            view.fit_left(right, value, theme::LABEL, view.theme.text);
        }
    }
}

/// What the computer has given to the thread of the control.
fn rights_text(view: &View<'_>, rights: ThreadRights) -> String {
    let time = match rights {
        ThreadRights { has_priority: true, has_locked_memory: true, .. } => view.text("实时", "real time"),
        ThreadRights { has_priority: true, .. } => view.text("内存未锁定", "memory not locked"),
        ThreadRights { .. } => view.text("没有实时权限", "no real-time rights"),
    };
    match rights.core {
        None => time.to_owned(),
        Some((core, true)) => format!("{time}  CPU {core}"),
        Some((core, false)) => format!("{time}  {} {core}", view.text("没有 CPU", "there is no CPU")),
    }
}

/// A device or a station, as its row shows it.
struct BusRow<'a> {
    number: u16,
    /// It takes part in the exchange.
    takes_part: bool,
    name: &'a str,
    state: String,
    /// Drive, identity or address, and whether it is a fault.
    what: String,
    is_fault: bool,
    is_secondary: bool,
}

fn device_row<'a>(view: &View<'_>, number: u16, device: &'a BusDevice) -> BusRow<'a> {
    let (vendor, product) = device.identity;
    let (what, is_fault) = match &device.drive {
        Some(BusDrive { axis, state, tripped, raw_count, torque_percent }) => {
            let torque = torque_percent.map_or_else(String::new, |torque| format!("  {torque:.1} %"));
            let count = raw_count
                .filter(|_| !tripped)
                .map_or_else(String::new, |count| format!("  {count} {}", view.text("脉冲", "counts")));
            (format!("{axis}  {}{torque}{count}", state.get(view.lang)), *tripped)
        }
        None => (format!("{vendor:#x} / {product:#x}"), false),
    };
    let bad_ports = port_words(view, device);
    let is_secondary = device.drive.is_none() && bad_ports.is_none();
    let what = match bad_ports {
        Some(words) if device.drive.is_some() => format!("{what}  {words}"),
        Some(words) => words,
        None => what,
    };
    BusRow {
        number,
        takes_part: device.state == DeviceState::Operational,
        name: &device.name,
        state: device.state.name().get(view.lang).to_owned(),
        what,
        is_fault,
        is_secondary,
    }
}

/// The ports of a device that have met errors: `port 0: damaged 3, link lost 1`.
fn port_words(view: &View<'_>, device: &BusDevice) -> Option<String> {
    let is_bad = |(_, errors): &(usize, &PortErrors)| **errors != PortErrors::default();
    let words = device.ports.iter().enumerate().filter(is_bad).map(|(port, PortErrors { damaged, lost_links })| {
        let lost = view.text("断线", "link lost");
        format!("{} {port}: {} {damaged}, {lost} {lost_links}", view.text("端口", "port"), view.text("坏帧", "damaged"))
    });
    Some(words.collect::<Vec<_>>().join("  ")).filter(|words| !words.is_empty())
}

/// A station: while it is heard its address and the times of its exchanges, otherwise what is wrong.
fn station_row<'a>(view: &View<'_>, station: &'a BusStation) -> BusRow<'a> {
    let what = match &station.fault {
        Some(fault) => format!("{}  {}", station.address, fault.get(view.lang)),
        None => {
            let Percentiles { median, p99, max } = station.round_trip;
            let ms = |time: Micros| time.0 as f64 / 1_000.0;
            format!("{}  {:.1} / {:.1} / {:.1} ms", station.address, ms(median), ms(p99), ms(max))
        }
    };
    BusRow {
        number: station.number,
        takes_part: station.is_heard,
        name: &station.name,
        state: format!("{} {}", station.age.0.min(MAX_AGE_SHOWN.0) / 1_000, view.text("ms 前", "ms ago")),
        what,
        is_fault: station.fault.is_some(),
        is_secondary: true,
    }
}

/// The inverter: its actual speed and load, and its fault.
fn inverter_row<'a>(view: &View<'a>, inverter: &BusInverter) -> BusRow<'a> {
    let rpm = inverter.rpm.map(|rpm| format!("{rpm:.0} r/min"));
    let load = inverter.load_percent.map(|load| format!("{} {load:.0} %", view.text("负载", "load")));
    let fault = inverter.fault.as_ref().map(|fault| fault.get(view.lang).into_owned());
    BusRow {
        number: inverter.device,
        takes_part: inverter.fault.is_none(),
        name: view.text("变频器", "inverter"),
        state: rpm.unwrap_or_else(|| "–".to_owned()),
        what: fault.or(load).unwrap_or_default(),
        is_fault: inverter.fault.is_some(),
        is_secondary: false,
    }
}

/// Number, state, name and the rest of a device or a station.
fn show_row(rect: Rect, view: &View<'_>, row: &BusRow<'_>) {
    view.card(rect);
    let inside = rect.trim_sides(8.0);
    let (place, rest) = inside.split_left(NUMBER_WIDTH);
    let (lamp, rest) = rest.split_left(LAMP_WIDTH);
    view.line_left(place, &row.number.to_string(), theme::LABEL, view.theme.muted);
    widget::lamp(view, lamp, row.takes_part);
    let (left, right) = rest.split_left_right_at_fraction(0.42);
    view.fit_left(left, row.name, theme::LABEL, view.theme.text);
    let (state, what) = right.split_left_right_at_fraction(0.24);
    let colour = if row.takes_part { view.theme.muted } else { view.theme.alarm_text };
    view.fit_left(state.trim_right(6.0), &row.state, theme::LABEL, colour);
    let colour = match (row.is_fault, row.is_secondary) {
        (true, _) => view.theme.alarm_text,
        (false, true) => view.theme.muted,
        (false, false) => view.theme.text,
    };
    view.fit_left(what, &row.what, theme::LABEL, colour);
}
