//! The part of the last cycle, at the end of the program: size, tolerance, verdict, cycle time, wheel, and the correction
//! that follows from the size. It stays until the next cycle start or until it is closed.
//! Source: spec K7.2, K4.1, K4.5, H8.

use std::borrow::Cow;
use std::collections::VecDeque;

use egui::{Color32, Rect, Stroke, pos2, vec2};

use crate::defs::page_meaning::SizeKind;
use crate::defs::param;
use crate::defs::part_verdict::PartVerdict;
use crate::hmi::field_editor::CoreAnswer;
use crate::hmi::{Area, EditKey, FieldEditor, PageKey, View, format_cycle_time, keycap, pictogram, theme, widget};
use crate::link::part_result::{
    CorrectionAdvice, JudgedSize, OffsetInForce, PartCommand, PartResult, TYPED_SIZE_RANGE,
};
use crate::link::{Command, Snapshot};
use crate::units::Micros;

/// Height of the card with everything in it, points.
pub const HEIGHT: f32 = 412.0;
/// Height of the line with number, time and the key that closes the card.
const HEAD_HEIGHT: f32 = 46.0;
/// Cycles that a new one is compared with.
const CYCLES: usize = 20;
/// Height of what the size says of the offset.
const ADVICE_HEIGHT: f32 = 62.0;
/// Height of the key that takes a correction over.
const TAKE_HEIGHT: f32 = 48.0;

/// The card.
#[derive(Debug, Default)]
pub struct PartCard {
    dismissed: Option<Micros>,
    /// The measured size being typed.
    pub editor: FieldEditor,
    /// Whether the operator types a measured size.
    pub types_size: bool,
    /// The last cycle times of a program, s, and the end of the newest.
    cycles: (u32, VecDeque<f64>, Option<Micros>),
}

impl PartCard {
    /// The result to be shown: of the program whose page is open.
    pub fn shown<'a>(&self, snapshot: &'a Snapshot) -> Option<&'a PartResult> {
        snapshot
            .cycle
            .part
            .as_ref()
            .filter(|part| part.program == snapshot.program.number && self.dismissed != Some(part.ended_at))
    }

    /// The result is not shown any more; false if there was none.
    pub fn dismiss(&mut self, snapshot: &Snapshot) -> bool {
        let Some(part) = self.shown(snapshot) else { return false };
        self.dismissed = Some(part.ended_at);
        self.stop_typing();
        true
    }

    /// Follows the cycles; a result that has gone, or made way for another one, takes its typed size with it.
    pub fn record(&mut self, snapshot: &Snapshot) {
        if self.types_size && self.shown(snapshot).is_none() {
            self.stop_typing();
        }
        let Some(part) = snapshot.cycle.part.as_ref().filter(|part| self.cycles.2 != Some(part.ended_at)) else {
            return;
        };
        self.stop_typing();
        let (program, times, newest) = &mut self.cycles;
        if std::mem::replace(program, part.program) != part.program {
            times.clear();
        }
        *newest = Some(part.ended_at);
        times.push_back(part.times.seconds);
        if times.len() > CYCLES {
            times.pop_front();
        }
    }

    /// Another value is typed, or none.
    pub fn stop_typing(&mut self) {
        (self.types_size, self.editor) = (false, FieldEditor::default());
    }

    /// Handles the keys while a size is typed.
    pub fn handle_keys(&mut self, edits: &[EditKey], out: &mut Vec<Command>) {
        let ended_at = self.cycles.2;
        for edit in edits {
            if self.editor.handle_key(*edit) {
                if *edit == EditKey::Cancel && !self.editor.pad_open {
                    self.stop_typing();
                }
            } else if *edit == EditKey::Enter && !self.editor.text.is_empty() {
                match self.editor.number(99_999.999) {
                    Ok(mm) => {
                        self.editor.send(0);
                        out.extend(ended_at.map(|ended_at| Command::Part(PartCommand::TypeSize { ended_at, mm })));
                    }
                    Err(reason) => self.editor.refused = Some(reason),
                }
            }
        }
    }

    /// Follows the core's answer: an accepted size ends the typing.
    pub fn poll_answer(&mut self, view: &View<'_>) {
        if self.types_size && matches!(self.editor.poll_answer(&view.snapshot.edit_answer), CoreAnswer::Accepted(..)) {
            self.stop_typing();
        }
    }

    /// Draws the card, as much of it as there is room for.
    pub fn ui(&mut self, rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
        let Some(part) = self.shown(view.snapshot) else { return };
        view.filled_card(rect, view.theme.surface, view.theme.line);
        let (verdict, ink) = verdict(view, part);
        view.edge_bar(rect, ink);
        let inside = rect.shrink2(vec2(10.0, 5.0));
        let closes = head(inside, view, part, &verdict);
        let (rest, keys) = inside.trim_top(HEAD_HEIGHT).split_bottom(keys_height(view, part));
        let (mut rest, told) = rest.split_bottom(ADVICE_HEIGHT);
        advice(told, view, part);
        let mut next = |height: f32| {
            let (row, below) = rest.split_top(height);
            let fits = height <= rest.height();
            rest = below;
            fits.then_some(row)
        };
        next(36.0).inspect(|row| figure(*row, view, part, &verdict, ink));
        next(48.0).inspect(|row| tolerance(*row, view, part, ink));
        next(20.0).inspect(|row| source(*row, view, part));
        next(22.0).inspect(|row| wheel(*row, view));
        next(62.0).inspect(|row| self.cycle_times(*row, view));
        let (taken, typing) = keys_ui(keys, view, part, self.types_size);
        out.extend(taken.map(Command::Part));
        if typing && !self.types_size {
            self.types_size = true;
            self.editor.open_pad();
        }
        if closes {
            self.dismiss(view.snapshot);
        }
    }

    /// The last cycles of the program as bars, the newest bright.
    fn cycle_times(&self, rect: Rect, view: &View<'_>) {
        let times = &self.cycles.1;
        let (words, plot) = rect.shrink2(vec2(0.0, 4.0)).split_top(20.0);
        let mean = times.iter().sum::<f64>() / times.len().max(1) as f64;
        let words_of = format!(
            "{} {} · {} {}",
            view.text("循环", "cycle"),
            format_cycle_time(times.back().copied().unwrap_or(0.0)),
            view.text("平均", "mean"),
            format_cycle_time(mean)
        );
        view.fit_left(words, &words_of, theme::SMALL, view.theme.muted);
        let most = times.iter().copied().fold(1e-3, f64::max);
        let width = plot.width() / CYCLES as f32;
        for (index, seconds) in times.iter().enumerate() {
            let height = (seconds / most) as f32 * plot.height();
            let corner = pos2(plot.min.x + index as f32 * width, plot.max.y - height);
            let is_newest = index + 1 == times.len();
            let ink = if is_newest { view.theme.info } else { view.theme.line };
            view.painter.rect_filled(Rect::from_min_size(corner, vec2(width - 1.5, height)), 0.0, ink);
        }
    }
}

/// Number and time of the part, and the key that closes the card; true if it is touched.
fn head(inside: Rect, view: &View<'_>, part: &PartResult, verdict: &str) -> bool {
    let corner = vec2(theme::TOUCH_TARGET, theme::TOUCH_TARGET);
    let key = Rect::from_min_size(pos2(inside.max.x - corner.x + theme::GAP, inside.min.y - 1.0), corner);
    let response = keycap::plain(view, key, "part-result", format!("{verdict} part-result"));
    view.line_centre(key, "×", theme::TITLE, view.theme.text);
    let line = inside.band(0.0, HEAD_HEIGHT).with_max_x(key.min.x - theme::GAP);
    let words = format!("{} {}", view.text("工件", "part"), part.number);
    let taken = view.line_right(line, &format_cycle_time(part.times.seconds), theme::LABEL, view.theme.text);
    view.fit_left(line.with_max_x(taken.min.x - theme::GAP), &words, theme::LABEL, view.theme.muted);
    response.clicked()
}

fn figure(row: Rect, view: &View<'_>, part: &PartResult, verdict: &str, ink: Color32) {
    match part.judged_size(view.snapshot.simulated.as_deref()) {
        Some(size) => {
            let taken = view.line_left(row, &view.length(size.mm()), theme::FIGURE, view.theme.text);
            view.fit_right(row.with_min_x(taken.max.x + theme::GAP), verdict, theme::TITLE, ink);
        }
        None => drop(view.fit_left(row, verdict, theme::SECONDARY, ink)),
    }
}

/// The limits as a bar with the nominal size as a tick and the part as a point: a disc within, a square at the end beyond.
fn tolerance(row: Rect, view: &View<'_>, part: &PartResult, ink: Color32) {
    let (bar, words) = row.split_top(26.0);
    let Some(nominal) = part.nominal else {
        view.fit_left(bar, view.text("没有公称尺寸", "no nominal size"), theme::LABEL, view.theme.muted);
        return;
    };
    let Some((low, high)) = nominal.limits else {
        let told = format!("{} {}", view.text("公称", "nominal"), view.length(nominal.mm));
        view.fit_left(bar, &told, theme::LABEL, view.theme.muted);
        return;
    };
    let theme = view.theme;
    let (span, y) = ((high - low).max(1e-6), bar.center().y);
    // The limits stand at a fifth of the bar from its ends: what is beyond them has room.
    let x = |mm: f64| bar.min.x + bar.width() * (0.2 + 0.6 * ((mm - low) / span) as f32).clamp(0.02, 0.98);
    let band = Rect::from_min_max(pos2(x(low), y - 5.0), pos2(x(high), y + 5.0));
    view.painter.hline(bar.x_range(), y, Stroke::new(theme::HAIRLINE, theme.line));
    view.filled_card(band, theme.background, theme.muted);
    view.painter.vline(x(nominal.mm), y - 9.0..=y + 9.0, Stroke::new(theme::FRAME, theme.muted));
    if let Some(size) = part.judged_size(view.snapshot.simulated.as_deref()) {
        let at = pos2(x(size.mm()), y);
        if nominal.keeps(size.mm()) == Some(false) {
            view.painter.rect_filled(Rect::from_center_size(at, vec2(11.0, 11.0)), 0.0, ink);
        } else {
            view.painter.circle_filled(at, 6.0, ink);
        }
    }
    let deviations = format!("{} {:+.3} {:+.3}", view.length(nominal.mm), high - nominal.mm, low - nominal.mm);
    view.fit_left(words, &deviations, theme::LABEL, theme.muted);
}

/// Where the size comes from.
fn source(row: Rect, view: &View<'_>, part: &PartResult) {
    let words = match part.judged_size(view.snapshot.simulated.as_deref()) {
        Some(JudgedSize::Typed(_)) => Cow::Borrowed(view.text("操作者实测", "measured by the operator")),
        Some(JudgedSize::Measured(_)) => Cow::Borrowed(view.text("程序实测", "measured by the program")),
        Some(JudgedSize::Simulated(compared)) => {
            format!("{} {}", view.text("仿真", "simulated"), compared.worst.name.get(view.lang)).into()
        }
        None => Cow::Borrowed(""),
    };
    view.fit_left(row, &words, theme::LABEL, view.theme.muted);
}

/// Parts since the last dressing, against the interval.
fn wheel(row: Rect, view: &View<'_>) {
    let since = view.snapshot.params.get(param::PARTS_SINCE_DRESSING);
    let due = view.snapshot.dressing_interval();
    let words = match due {
        Some(interval) => format!("{} {since:.0} / {interval:.0}", view.text("修整后件数", "since dressing")),
        None => format!("{} {since:.0}", view.text("修整后件数", "parts since dressing")),
    };
    let is_due = due.is_some_and(|interval| since >= interval);
    let ink = if is_due { view.theme.hold } else { view.theme.muted };
    view.fit_left(row, &words, theme::LABEL, ink);
}

/// What the size says of the offset.
fn advice(row: Rect, view: &View<'_>, part: &PartResult) {
    let muted = view.theme.muted;
    let (words, ink) = match part.advice(view.snapshot.simulated.as_deref()) {
        CorrectionAdvice::Unknown => return,
        CorrectionAdvice::Centred => (view.text("在公差中间，不用修正", "centred: no correction").to_owned(), muted),
        CorrectionAdvice::ByGauge => {
            let words = view.text(
                "尺寸由量仪或程序的测量决定：偏差大时检查对标",
                "sized by gauge or program: check its setting if it is off",
            );
            (words.to_owned(), muted)
        }
        CorrectionAdvice::MayBeWear => {
            let words = view.text("可能是砂轮磨损：修整后再修正", "may be wear of the wheel: dress, then correct");
            (words.to_owned(), muted)
        }
        CorrectionAdvice::TooFar(by) => {
            let words = view.text("相差太大，不像刀补：检查测量和工件", "too far: check size and part");
            (format!("{by:+.3} {words}"), view.theme.hold)
        }
        CorrectionAdvice::Add(offset, _) => {
            (format!("{} {}", view.text("建议修正刀补", "proposed: wear of offset"), offset.number), view.theme.text)
        }
        CorrectionAdvice::Done(by) => {
            let mark = Rect::from_min_size(row.min + vec2(0.0, 3.0), vec2(14.0, 14.0));
            pictogram::draw(&view.painter, mark, pictogram::CHECK, view.theme.run);
            let words = format!("{} {by:+.3}", view.text("已修正", "corrected"));
            view.fit_left(row.trim_left(20.0).band(0.0, 20.0), &words, theme::LABEL, view.theme.run);
            return;
        }
    };
    view.text_rows(row.trim_bottom(theme::GAP), &words, theme::LABEL, ink, 3);
}

/// Whether the operator may type a measured size: it is compared with a nominal diameter or height.
fn takes_size(part: &PartResult) -> bool {
    let kind = part.nominal.and_then(|nominal| nominal.kind);
    matches!(kind, Some(SizeKind::Diameter | SizeKind::Height))
}

/// The correction that the card proposes.
fn proposal(view: &View<'_>, part: &PartResult) -> Option<(OffsetInForce, f64)> {
    match part.advice(view.snapshot.simulated.as_deref()) {
        // A run takes no correction.
        _ if view.snapshot.program.is_open => None,
        CorrectionAdvice::Add(offset, increment) => Some((offset, increment)),
        _ => None,
    }
}

fn keys_height(view: &View<'_>, part: &PartResult) -> f32 {
    let typing = if takes_size(part) { theme::TOUCH_TARGET + theme::GAP } else { 0.0 };
    typing + if proposal(view, part).is_some() { TAKE_HEIGHT } else { 0.0 }
}

/// The keys: take the correction over, type a measured size. Returns the correction that is taken, and whether typing begins.
fn keys_ui(rect: Rect, view: &View<'_>, part: &PartResult, types: bool) -> (Option<PartCommand>, bool) {
    let (mut below, mut taken) = (rect, None);
    if let Some((offset, increment)) = proposal(view, part) {
        let (take, rest) = rect.split_top(TAKE_HEIGHT);
        below = rest;
        let label = format!("{} {} {increment:+.3}", view.text("采用", "TAKE"), offset.axis);
        let key = PageKey::new("take-correction", &label);
        if widget::button(view, take, key) {
            taken = Some(PartCommand::Correct { ended_at: part.ended_at, increment });
        }
    }
    let words = view.text("输入实测尺寸", "MEASURED SIZE");
    let key = PageKey::new("type-size", words).on(types);
    let typing = takes_size(part) && widget::button(view, below.trim_top(theme::GAP), key);
    (taken, typing)
}

/// The prompt of the input line while a size is typed: `工件 12 实测 = 40.003   39.000 … 41.000`
pub fn prompt(view: &View<'_>, part: &PartResult) -> (String, String) {
    let label = format!("{} {} =", view.text("实测 工件", "size of part"), part.number);
    let range = part.nominal.map_or_else(String::new, |nominal| {
        format!("{} … {}", view.length(nominal.mm - TYPED_SIZE_RANGE), view.length(nominal.mm + TYPED_SIZE_RANGE))
    });
    (label, range)
}

/// The verdict and its colour.
fn verdict(view: &View<'_>, part: &PartResult) -> (String, Color32) {
    let verdict = part.verdict(view.snapshot.simulated.as_deref());
    let ink = match verdict {
        PartVerdict::Good => view.theme.run,
        PartVerdict::Spoilt(_) | PartVerdict::Out { .. } => view.theme.alarm_text,
        PartVerdict::NoTolerance | PartVerdict::NotMeasured => view.theme.muted,
    };
    (verdict.name().get(view.lang).to_owned(), ink)
}
