//! The day of the machine: what it did in each hour, sums and OEE by shift, and which alarms stopped it longest.

use std::ops::Range;

use egui::{Rect, pos2};

use super::oee::{Oee, PlannedCycles};
use crate::defs::alarm::{self, Reaction};
use crate::defs::alarm_history::PastAlarm;
use crate::defs::date::DateTime;
use crate::defs::downtime_reason::DowntimeReason;
use crate::defs::hour_record::{HourRecord, MachineUse};
use crate::defs::param;
use crate::defs::text::LocalizedText;
use crate::hmi::{Area, KeyboardFocus, PageKey, View, theme, widget};
use crate::link::Snapshot;

/// Hours, and seconds of a day and of an hour.
const HOURS: u64 = 24;
const DAY_SECONDS: i64 = 86_400;
const HOUR_SECONDS: f32 = 3_600.0;
/// Share of the page for the hours.
const CHART_SHARE: f32 = 0.38;
/// Heights of the lines of text.
const LINE_HEIGHT: f32 = 28.0;
const LEGEND_HEIGHT: f32 = 24.0;
/// Shares of the columns of the table.
const COLUMNS: [f32; 10] = [1.2, 0.7, 0.75, 0.75, 0.8, 1.05, 1.1, 1.3, 0.85, 0.8];
/// Alarms shown.
const MAX_REASONS: usize = 5;

/// A shift of a day: its hours.
struct Shift {
    name: String,
    hours: Vec<HourRecord>,
}

impl Shift {
    /// Its hours since 1970.
    fn span(&self) -> Range<u64> {
        let first = self.hours.first().map_or(0, |hour| hour.hour);
        first..first + self.hours.len() as u64
    }
}

/// The hour at which a day of production begins: with its first shift (P476).
fn first_hour(snapshot: &Snapshot) -> u64 {
    snapshot.params.get(param::FIRST_SHIFT) as u64
}

/// The day, counted back from the newest one, 0; `None` while no hour is known.
pub fn day_of(snapshot: &Snapshot, back: u64) -> Option<u64> {
    let today = snapshot.date.and_then(HourRecord::hour_of);
    let newest = today.or_else(|| snapshot.production.hours.last().map(|record| record.hour))?;
    (newest.checked_sub(first_hour(snapshot))? / HOURS).checked_sub(back)
}

/// Its hours, from the first shift on.
fn hours_of(snapshot: &Snapshot, day: u64) -> Vec<HourRecord> {
    let of_hour = |hour: u64| {
        let known = snapshot.production.hours.iter().find(|record| record.hour == hour).copied();
        known.unwrap_or(HourRecord { hour, ..HourRecord::default() })
    };
    let begin = day * HOURS + first_hour(snapshot);
    (begin..begin + HOURS).map(of_hour).collect()
}

/// The shifts of a day (P476, P477), of equal length.
fn shifts_of(snapshot: &Snapshot, day: u64) -> Vec<Shift> {
    let first = first_hour(snapshot);
    let count = (snapshot.params.get(param::SHIFTS) as u64).max(1);
    let length = HOURS / count;
    let shift = |(number, hours): (u64, &[HourRecord])| {
        let begin = first + number * length;
        let name = format!("{}  {:02}–{:02}", number + 1, begin % HOURS, (begin + length) % HOURS);
        Shift { name, hours: hours.to_vec() }
    };
    (0..count).zip(hours_of(snapshot, day).chunks(length as usize)).map(shift).collect()
}

fn sum(hours: &[HourRecord]) -> HourRecord {
    hours.iter().fold(HourRecord::default(), |mut sum, hour| {
        sum.add(hour);
        sum
    })
}

/// Draws a day; returns the reason for a stop that is touched.
pub fn ui(rect: Rect, view: &View<'_>, day: Option<u64>, walk: &mut KeyboardFocus) -> Option<DowntimeReason> {
    let Some(day) = day else {
        let words = view.text(
            "还没有记录：控制系统知道日期后，按小时记录运行、等待、报警和件数。",
            "Nothing is recorded yet: once the control knows the date it records running, waiting, alarms and parts by the hour.",
        );
        view.paragraph(rect.shrink(theme::PAD), words, theme::LABEL, view.theme.muted);
        return None;
    };
    let (chart, below) = rect.split_top(rect.height() * CHART_SHARE);
    day_chart(chart.trim_bottom(theme::GAP), view, day);
    // Header, shifts, day.
    let lines = shifts_of(view.snapshot, day).len() + 2;
    let (table, reasons) = below.split_top(lines as f32 * LINE_HEIGHT + 3.0 * theme::GAP);
    shift_table(table.trim_bottom(theme::GAP), view, day);
    let (alarms, stops) = reasons.split_left_right_at_fraction(0.5);
    show_reasons(alarms.trim_right(theme::GAP / 2.0), view, day);
    downtime_reasons(stops.trim_left(theme::GAP / 2.0), view, day, walk)
}

/// The reasons that the operator gives, each a key with its minutes of the day; returns the one that is touched. A reason
/// is given for now: the keys of a day before only show.
fn downtime_reasons(rect: Rect, view: &View<'_>, day: u64, walk: &mut KeyboardFocus) -> Option<DowntimeReason> {
    view.card(rect);
    let inside = rect.shrink2(egui::vec2(theme::PAD, theme::GAP));
    let (head, keys) = inside.split_top(LINE_HEIGHT);
    let sum = sum(&hours_of(view.snapshot, day));
    let minutes = |seconds: u32| (seconds + 30) / 60;
    let open = view.text("停机原因 min · 未说明", "stops by the operator, min · not told");
    let words = format!("{open} {}", minutes(sum.seconds_unexplained()));
    view.fit_left(head, &words, theme::SMALL, view.theme.muted);
    view.hairline(head, head.max.y - 0.5);
    let is_today = day_of(view.snapshot, 0) == Some(day);
    let mut touched = None;
    let height = keys.height() / 2.0;
    for (index, reason) in DowntimeReason::ALL.into_iter().enumerate() {
        let line = keys.band((index / 3) as f32 * height, height).trim_top(theme::GAP);
        let (name, label) = (format!("downtime-{}", reason.id()), reason.name().get(view.lang));
        let label = match minutes(sum.explained[reason as usize]) {
            0 => label.to_owned(),
            time => format!("{label} {time}"),
        };
        let holds = is_today && view.snapshot.production.downtime_reason == Some(reason);
        let key = PageKey::new(&name, &label).on(holds).locked(!is_today);
        if walk.button(view, line.cell(index % 3, 3), key) && is_today {
            touched = Some(reason);
        }
    }
    touched
}

const fn ink(view: &View<'_>, of: MachineUse) -> egui::Color32 {
    match of {
        MachineUse::Running => view.theme.run,
        MachineUse::Waiting => view.theme.hold,
        MachineUse::Alarm => view.theme.alarm,
        MachineUse::Idle => view.theme.line,
    }
}

/// A column for each hour: what the machine did in it from below, and the parts above.
fn day_chart(rect: Rect, view: &View<'_>, day: u64) {
    view.card(rect);
    let inside = rect.shrink2(egui::vec2(theme::PAD, theme::GAP));
    let (head, rest) = inside.split_top(LEGEND_HEIGHT);
    let hours = hours_of(view.snapshot, day);
    let date = hours.first().map_or(DateTime::default(), HourRecord::began).to_string();
    let title = view.line_left(head, date.split(' ').next().unwrap_or_default(), theme::TITLE, view.theme.text);
    let mut left = title.max.x + theme::PAD;
    for of in MachineUse::ALL {
        let mark = Rect::from_min_size(pos2(left, head.center().y - 6.0), egui::vec2(12.0, 12.0));
        view.painter.rect_filled(mark, 2.0, ink(view, of));
        let name =
            view.line_left(head.with_min_x(mark.max.x + 4.0), of.name().get(view.lang), theme::SMALL, view.theme.muted);
        left = name.max.x + theme::PAD;
    }
    let (plot, axis) = rest.split_bottom(18.0);
    let (counts, bars) = plot.split_top(18.0);
    view.hairline(bars, bars.max.y);
    for (index, hour) in hours.iter().enumerate() {
        let column = bars.cell(index, hours.len());
        let mut top = column.max.y;
        for of in MachineUse::ALL {
            let height = hour.seconds[of as usize] as f32 / HOUR_SECONDS * column.height();
            let bar = Rect::from_min_max(pos2(column.min.x, (top - height).max(column.min.y)), pos2(column.max.x, top));
            view.painter.rect_filled(bar, 0.0, ink(view, of));
            top -= height;
        }
        let made = hour.good + hour.bad;
        if made > 0 {
            let ink = if hour.bad > 0 { view.theme.alarm_text } else { view.theme.text };
            view.fit_centre(counts.cell(index, hours.len()), &made.to_string(), theme::SMALL, ink);
        }
        if index % 2 == 0 {
            let words = (hour.hour % HOURS).to_string();
            view.line_centre(axis.cell(index, hours.len()), &words, theme::SMALL, view.theme.muted);
        }
    }
}

/// Sums of the shifts and of the day.
fn shift_table(rect: Rect, view: &View<'_>, day: u64) {
    view.card(rect);
    let inside = rect.shrink2(egui::vec2(theme::PAD, theme::GAP));
    let words = [
        view.text("班次", "shift"),
        view.text("开机 h", "on h"),
        view.text("运行 h", "run h"),
        view.text("等待 h", "wait h"),
        view.text("报警 h", "alarm h"),
        view.text("合格/不良", "good/NOK"),
        view.text("可用率", "availability"),
        view.text("效率", "effectiveness"),
        view.text("合格率", "quality"),
        view.text("OEE", "OEE"),
    ];
    widget::table_header(view, inside.band(0.0, LINE_HEIGHT), COLUMNS, words);
    let whole = Shift { name: view.text("全天", "day").to_owned(), hours: hours_of(view.snapshot, day) };
    let parts = &view.snapshot.production.parts;
    let plan = PlannedCycles::of(parts);
    for (index, shift) in shifts_of(view.snapshot, day).iter().chain([&whole]).enumerate() {
        let line = inside.band((index + 1) as f32 * LINE_HEIGHT, LINE_HEIGHT);
        if line.max.y > inside.max.y + 1.0 {
            break;
        }
        let sum = sum(&shift.hours);
        let hours = |seconds: u32| format!("{:.1}", f64::from(seconds) / f64::from(HOUR_SECONDS));
        let oee = Oee::of(&sum, shift.span(), parts, &plan);
        let used = |of: MachineUse| sum.seconds[of as usize];
        let cells = [
            shift.name.clone(),
            hours(sum.seconds_on()),
            hours(used(MachineUse::Running)),
            hours(used(MachineUse::Waiting)),
            hours(used(MachineUse::Alarm)),
            format!("{} / {}", sum.good, sum.bad),
            percent(oee.availability),
            percent(oee.effectiveness),
            percent(oee.quality_ratio),
            percent(oee.index()),
        ];
        for (place, words) in line.columns(COLUMNS).into_iter().zip(cells) {
            view.fit_left(place, &words, theme::LABEL, view.theme.text);
        }
    }
}

/// A ratio in percent; a dash of nothing.
fn percent(ratio: Option<f64>) -> String {
    ratio.map_or_else(|| "–".to_owned(), |ratio| format!("{:.1} %", 100.0 * ratio))
}

/// The alarms of the day by the time that they stood, the longest first: number, text, how often, seconds.
pub fn reasons(snapshot: &Snapshot, day: u64) -> Vec<(u16, LocalizedText, u32, i64)> {
    let from = HourRecord { hour: day * HOURS + first_hour(snapshot), ..HourRecord::default() }.began().0;
    let to = from + DAY_SECONDS;
    let now = snapshot.date.map_or(to, |date| date.0);
    let mut all: Vec<(u16, LocalizedText, u32, i64)> = Vec::new();
    for PastAlarm { number, text, came, ended, .. } in snapshot.alarm_history.iter() {
        // An alarm that ended with the power stood nobody knows how long; one that stands, until now.
        let end = match ended {
            Some((_, Some(date))) => date.0,
            Some((_, None)) => came.0,
            None => now,
        };
        let stood = end.min(to) - came.0.max(from);
        let stops = alarm::find(*number).is_none_or(|row| row.reaction != Reaction::Show);
        if stood < 0 || came.0 >= to || !stops {
            continue;
        }
        match all.iter_mut().find(|reason| reason.0 == *number) {
            Some(reason) => (reason.2, reason.3) = (reason.2 + 1, reason.3 + stood),
            None => all.push((*number, text.clone(), 1, stood)),
        }
    }
    all.sort_by_key(|reason| std::cmp::Reverse(reason.3));
    all
}

fn show_reasons(rect: Rect, view: &View<'_>, day: u64) {
    view.card(rect);
    let inside = rect.shrink2(egui::vec2(theme::PAD, theme::GAP));
    let head = inside.band(0.0, LINE_HEIGHT);
    view.fit_left(head, view.text("停机原因 (报警)", "stops by alarms"), theme::SMALL, view.theme.muted);
    view.hairline(head, head.max.y - 0.5);
    let all = reasons(view.snapshot, day);
    if all.is_empty() {
        let line = inside.band(LINE_HEIGHT, LINE_HEIGHT);
        view.fit_left(line, view.text("没有报警", "no alarm"), theme::LABEL, view.theme.muted);
    }
    for (index, (_, text, times, seconds)) in all.iter().take(MAX_REASONS).enumerate() {
        let line = inside.band((index + 1) as f32 * LINE_HEIGHT, LINE_HEIGHT);
        if line.max.y > inside.max.y + 1.0 {
            break;
        }
        let words = format!("{times}×  {} min", (seconds + 59) / 60);
        let shown = view.line_right(line, &words, theme::LABEL, view.theme.text);
        view.fit_left(line.with_max_x(shown.min.x - theme::GAP), &text.get(view.lang), theme::LABEL, view.theme.text);
    }
}

/// All hours that are kept, as CSV.
pub fn csv(snapshot: &Snapshot) -> String {
    let reasons: Vec<String> = DowntimeReason::ALL.iter().map(|reason| format!("{}_s", reason.id())).collect();
    let mut text = format!("hour,running_s,waiting_s,alarm_s,idle_s,good,bad,{}\r\n", reasons.join(","));
    let joined = |all: &[u32]| all.iter().map(ToString::to_string).collect::<Vec<_>>().join(",");
    for record in snapshot.production.hours.iter() {
        let (seconds, explained) = (joined(&record.seconds), joined(&record.explained));
        text += &format!("{},{seconds},{},{},{explained}\r\n", record.began(), record.good, record.bad);
    }
    text
}
