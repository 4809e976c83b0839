//! The dressing assistant: the point, the program with its values, what the wheel is like behind it, and the key that makes
//! the dressing the next cycle start. It moves nothing itself.
//! Source: spec K4.2, K5.17, K7.6; issue "the face", part 6.

use egui::{Color32, Rect, vec2};

use crate::defs::page::Page;
use crate::defs::page_meaning::PageMeaning;
use crate::defs::page_text::{PageText, PageTextRow};
use crate::defs::{key::Key, param, program_number};
use crate::hmi::page::grinding::ActingPoint;
use crate::hmi::page::{HandOver, PageContext};
use crate::hmi::widget::{KEYS_HEIGHT, KeyboardFocus};
use crate::hmi::{Area, PageKey, View, format_length, theme};
use crate::link::snapshot::DirectoryRow;
use crate::link::{Command, Snapshot};
use crate::technology::{DressedWheel, effective_width_mm};
use crate::units::{Axis, Micros};

/// Height of a heading and of a line.
const HEADING_HEIGHT: f32 = 24.0;
const LINE_HEIGHT: f32 = 24.0;
/// Least height of a line where there are many.
const LEAST_LINE_HEIGHT: f32 = 18.0;
/// Width of the key that takes the position of an axis.
const TAKE_WIDTH: f32 = 96.0;
/// Height of the key that selects the dressing.
const DRESS_HEIGHT: f32 = 52.0;
/// How long a program may take to be loaded.
const LOADING_TIME: Micros = Micros::from_millis(2_000);
/// Most dressing programs that have a key.
const MOST_PROGRAMS: usize = 3;
/// Decimals of a lead, mm per turn.
const LEAD_DECIMALS: usize = 3;

/// What the operator chose here.
#[derive(Debug, Default)]
pub struct DressingAssistant {
    focus: KeyboardFocus,
    /// The dressing program whose values are shown; none: the loaded one, else the first.
    chosen: Option<u32>,
    /// The program that was loaded before the dressing.
    before: Option<u32>,
    /// The dressing program that is being loaded, and since when; AUTO follows once it is.
    loading: Option<(u32, Micros)>,
}

/// The dressing programs of the machine (P91, P92), in the order of their numbers.
fn programs(snapshot: &Snapshot) -> impl Iterator<Item = &DirectoryRow> {
    let numbers = snapshot.dressing_programs();
    let rows = snapshot.directory.iter().filter(move |row| numbers.contains(&row.number));
    rows.filter(|row| row.is_for(snapshot.kind))
}

impl DressingAssistant {
    /// The program whose values are shown.
    fn program(&self, snapshot: &Snapshot) -> Option<u32> {
        let is_there = |number: &u32| programs(snapshot).any(|row| row.number == *number);
        let loaded = Some(snapshot.program.number);
        self.chosen.or(loaded).filter(is_there).or_else(|| programs(snapshot).next().map(|row| row.number))
    }

    /// Draws the assistant. Returns the axis whose present place is to be its dressing point.
    pub fn ui(&mut self, rect: Rect, ctx: &mut PageContext<'_>) -> Option<Axis> {
        let view = ctx.view;
        self.focus.begin_frame(&ctx.typed.edits);
        self.follow_loading(view.snapshot, ctx.out);
        let program = self.program(view.snapshot);
        let text = program.and_then(|number| view.snapshot.screens.find(number)?.text.as_deref().ok());
        let points = HEADING_HEIGHT + view.axes().count() as f32 * (KEYS_HEIGHT + theme::GAP);
        let (top, rest) = rect.split_top(points + theme::GAP);
        let wanted = self.points(top.trim_bottom(theme::GAP), view, text);
        let (middle, rest) = rest.split_top(HEADING_HEIGHT + KEYS_HEIGHT + theme::GAP);
        self.program_keys(middle.trim_bottom(theme::GAP), view, program);
        let (values, key) = rest.split_bottom(DRESS_HEIGHT);
        if let Some(text) = text {
            values_of(values.trim_bottom(theme::GAP), ctx, text);
        }
        self.dress_keys(key, view, (program, ctx.out));
        wanted
    }

    /// AUTO once the dressing program is loaded, and only then: a load that is refused leaves the mode as it is.
    fn follow_loading(&mut self, snapshot: &Snapshot, out: &mut Vec<Command>) {
        let loaded = snapshot.program.number;
        self.loading = self.loading.filter(|(_, since)| snapshot.now.since(*since) < LOADING_TIME);
        if self.loading.is_some_and(|(number, _)| number == loaded) && !snapshot.program.is_open {
            self.loading = None;
            out.extend([Command::Press(Key::ModeAuto), Command::Release(Key::ModeAuto)]);
        }
        // Another part was loaded since.
        if self.loading.is_none() && !snapshot.dressing_programs().contains(&loaded) {
            self.before = None;
        }
    }

    /// The point of each axis as the dressing will use it, and the key that takes the present place.
    fn points(&mut self, rect: Rect, view: &View<'_>, text: Option<&PageText>) -> Option<Axis> {
        let (head, rest) = rect.split_top(HEADING_HEIGHT);
        heading(head, view, view.text("修整点，机床坐标", "dressing point, machine"));
        let mut wanted = None;
        for (index, axis) in view.axes().enumerate() {
            let row = rest.band(index as f32 * (KEYS_HEIGHT + theme::GAP), KEYS_HEIGHT);
            let (words, key) = row.split_right(TAKE_WIDTH);
            let (told, ink) = point_words(view, text, axis);
            view.fit_left(words.trim_right(theme::GAP), &told, theme::TITLE, ink);
            let label = format!("{} {axis}", view.text("取此处", "TAKE"));
            if self.focus.button(view, key, PageKey::new(&format!("take-point-{axis}"), &label)) {
                wanted = Some(axis);
            }
        }
        wanted
    }

    /// A key for each dressing program: its number and title.
    fn program_keys(&mut self, rect: Rect, view: &View<'_>, shown: Option<u32>) {
        let (head, row) = rect.split_top(HEADING_HEIGHT);
        let rows: Vec<&DirectoryRow> = programs(view.snapshot).collect();
        if rows.is_empty() {
            heading(head, view, view.text("修整程序", "dressing program"));
            let words = view.text("没有：P91 到 P92 之间没有程序", "none: no program from P91 to P92");
            view.fit_left(row, words, theme::LABEL, view.theme.hold);
            return;
        }
        let title = rows.iter().find(|row| Some(row.number) == shown).map(|row| row.comment_in(view.lang).to_owned());
        heading(head, view, title.as_deref().unwrap_or_default());
        let at = rows.iter().position(|row| Some(row.number) == shown).unwrap_or(0);
        let keys = rows.get((at + 1).saturating_sub(MOST_PROGRAMS)..).unwrap_or_default();
        let count = keys.len().min(MOST_PROGRAMS);
        for (index, of) in keys.iter().take(count).enumerate() {
            let (place, name) = (row.cell(index, count), format!("dressing-program-{}", of.number));
            let key = PageKey::new(&name, &of.name).on(Some(of.number) == shown);
            if self.focus.button(view, place, key) {
                self.chosen = Some(of.number);
            }
        }
    }

    /// The key that makes the dressing the next cycle start; behind it the one that goes back to the part.
    fn dress_keys(&mut self, rect: Rect, view: &View<'_>, (program, out): (Option<u32>, &mut Vec<Command>)) {
        let loaded = view.snapshot.program.number;
        let numbers = view.snapshot.dressing_programs();
        let back = self.before.filter(|before| numbers.contains(&loaded) && *before != loaded);
        let (left, right) = rect.split_right(if back.is_some() { rect.width() * 0.5 } else { 0.0 });
        let left = left.trim_right(if back.is_some() { theme::GAP } else { 0.0 });
        let run_open = view.snapshot.program.is_open;
        if let Some(number) = program {
            let label = view.text("现在修整", "DRESS NOW");
            if self.focus.button(view, left, PageKey::new("dress-now", label).locked(run_open)) {
                // In a run the control refuses it, and says why. Loaded again, it starts at its beginning.
                out.push(Command::LoadProgram(number));
                if !run_open {
                    self.before =
                        Some(loaded).filter(|loaded| *loaded != 0 && !numbers.contains(loaded)).or(self.before);
                    self.loading = Some((number, view.snapshot.now));
                }
            }
        }
        let Some(before) = back else { return };
        let label = format!("{} {}", view.text("返回", "BACK TO"), program_number::name_of(before));
        if self.focus.button(view, right, PageKey::new("back-to-part", &label).locked(run_open)) {
            self.chosen = None;
            out.push(Command::LoadProgram(before));
        }
    }
}

fn heading(rect: Rect, view: &View<'_>, words: &str) {
    view.fit_left(rect, words, theme::LABEL, view.theme.muted);
}

/// `X -320.050 by key`: as the page of the program has it; where it has none, the point set by key. In amber if the program
/// needs a point that is missing or refused.
fn point_words(view: &View<'_>, text: Option<&PageText>, axis: Axis) -> (String, Color32) {
    let row = text.and_then(|text| {
        let row = text.rows().find(|row| row.meaning() == Some(PageMeaning::DressingPoint(axis)))?;
        Some((text, row))
    });
    let (point, theme) = (row.and_then(|(text, row)| ActingPoint::of(view.snapshot, text, row)), view.theme);
    match (point, view.snapshot.dressing_point[axis]) {
        (Some(point), _) => (point.words(view), if point.is_refused() { theme.hold } else { theme.text }),
        (None, Some(at)) => (format!("{axis} {} {}", view.length(at), view.text("按键", "by key")), theme.text),
        (None, None) => {
            let ink = if row.is_some() || text.is_none() { theme.hold } else { theme.muted };
            (format!("{axis} {}", view.text("未设置", "not set")), ink)
        }
    }
}

/// The values of the dressing program, as many as fit, and below them what the wheel will be like. A touch of a value opens
/// the page of the program, if it is loaded.
fn values_of(rect: Rect, ctx: &mut PageContext<'_>, text: &PageText) {
    let view = ctx.view;
    view.card(rect);
    let inside = rect.shrink2(vec2(theme::PAD, 4.0));
    let notes = notes(view, text);
    let (list, below) = inside.split_bottom(notes.len() as f32 * LINE_HEIGHT);
    let is_loaded = view.snapshot.page_files().and_then(|files| files.text.as_deref().ok()) == Some(text);
    let rows: Vec<&PageTextRow> = text.rows().filter(|row| !is_point_or_sum(row)).collect();
    let height = (list.height() / rows.len().max(1) as f32).clamp(LEAST_LINE_HEIGHT, LINE_HEIGHT);
    let room = (list.height() / height + 0.01).floor() as usize;
    for (index, row) in rows.iter().take(room).enumerate() {
        value_line(list.band(index as f32 * height, height), view, row);
    }
    for (index, (words, ink)) in notes.iter().enumerate() {
        view.fit_left(below.band(index as f32 * LINE_HEIGHT, LINE_HEIGHT), words, theme::LABEL, *ink);
    }
    let name = view.text("修整数值 dressing-values", "values dressing-values");
    if is_loaded && view.touch(list, "dressing-values", name).clicked() {
        *ctx.hand_over = rows.first().map(|row| HandOver::Variable(row.variable));
        ctx.out.push(Command::OpenPage(Page::Grinding));
    }
}

fn is_point_or_sum(row: &PageTextRow) -> bool {
    matches!(row.meaning(), Some(PageMeaning::DressingPoint(_) | PageMeaning::DressedAmount))
}

fn value_line(rect: Rect, view: &View<'_>, row: &PageTextRow) {
    let unit = row.unit().map(|unit| format!(" {}", unit.get(view.lang))).unwrap_or_default();
    let value = format!("{}{unit}", view.page_value(row));
    let shown = view.fit_right(rect, &value, theme::LABEL, view.theme.text);
    view.fit_left(rect.with_max_x(shown.min.x - theme::GAP), row.name_in(view.lang), theme::LABEL, view.theme.muted);
}

/// Lead and overlap of a diamond, and how much the wheel has been used.
fn notes(view: &View<'_>, text: &PageText) -> Vec<(String, Color32)> {
    let params = &view.snapshot.params;
    let mut notes = Vec::new();
    let turning = view.snapshot.wheel_rpm;
    let usual = params.get(param::WHEEL_RPM).min(params.get(param::WHEEL_RPM_MAX));
    let rpm = if turning > 0.0 { turning } else { usual };
    if let Some((lead_mm, overlap)) = lead_and_overlap(view.snapshot, text, rpm) {
        let (words, ink) = match DressedWheel::of_overlap(overlap) {
            DressedWheel::Threaded => (view.text("太快：工件有纹", "too fast: marks"), view.theme.hold),
            DressedWheel::Open => (view.text("开放，粗磨", "open, for roughing"), view.theme.text),
            DressedWheel::Fine => (view.text("细，精磨", "fine, for finishing"), view.theme.text),
            DressedWheel::Dull => (view.text("太慢：砂轮钝", "too slow: dull"), view.theme.hold),
        };
        let (lead, named) = (format_length(lead_mm, LEAD_DECIMALS), view.text("导程", "lead"));
        notes.push((format!("{named} {lead} mm · {rpm:.0} r/min"), view.theme.text));
        notes.push((format!("{} {overlap:.1} · {words}", view.text("重叠", "overlap")), ink));
    }
    let since = params.get(param::PARTS_SINCE_DRESSING);
    let undressed = params.bit(param::WHEEL_UNDRESSED);
    let due = view.snapshot.dressing_interval().is_some_and(|interval| since >= interval);
    let (words, ink) = match undressed {
        true => (view.text("换砂轮后未修整", "wheel changed, not dressed").to_owned(), view.theme.hold),
        false => {
            let every = view.snapshot.dressing_interval().map(|every| format!("/{every:.0}")).unwrap_or_default();
            let words = format!("{} {since:.0}{every}", view.text("修整后件数", "parts since dressing"));
            (words, if due { view.theme.hold } else { view.theme.text })
        }
    };
    let diameter = view.length(params.get(param::WHEEL_DIAMETER));
    let count = params.get(param::DRESSING_COUNT);
    let dressed = view.text("修整", "dressed");
    notes.push((format!("Ø {diameter} mm · {dressed} {count:.0} · {words}"), ink));
    notes
}

/// Lead, mm a turn of the wheel, and overlap ratio of the last pass at a speed of the wheel; none where the program does
/// not tell both feed and depth, as for a dressing roll.
fn lead_and_overlap(snapshot: &Snapshot, text: &PageText, rpm: f64) -> Option<(f64, f64)> {
    let row = |meaning: PageMeaning| {
        let variable = text.variable(|of| of == meaning)?;
        text.rows().find(|row| row.variable == variable)
    };
    let value = |row: &PageTextRow| snapshot.variables.get(usize::from(row.variable)).copied().flatten();
    let (depth, feed) = (row(PageMeaning::DressingDepth)?, row(PageMeaning::DressingFeed)?);
    // A depth on the diameter takes half of it off the radius.
    let depth_mm = value(depth)? * if depth.label.contains("直径") { 0.5 } else { 1.0 };
    let lead_mm = match feed.unit()?.en {
        "mm/min" => value(feed)? / rpm,
        "mm/r" => value(feed)?,
        _ => return None,
    };
    let usable = lead_mm.is_finite() && lead_mm > 0.0 && depth_mm > 0.0;
    usable.then(|| (lead_mm, effective_width_mm(depth_mm) / lead_mm))
}
