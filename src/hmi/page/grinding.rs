//! Grinding page: positions, the customer's two columns of macro variables, the picture, the part of the last cycle.
//! Source: spec K7.2–K7.5, H6, H8; seed 000.

mod dressing_line;
pub use dressing_line::ActingPoint;
mod part_card;
mod picture_column;
pub mod picture_labels;
pub mod preview;

use std::sync::Arc;

use egui::{Rect, Stroke, TextureId, pos2, vec2};

use super::position::{self, PositionGroup};
use super::start_strip::{self, StartStrip};
use super::{HandOver, PageContext, PageUi, empty, input_line};
use crate::defs::page::Page;
use crate::defs::page_text::{COLUMN_ROWS, PageText, PageTextRow};
use crate::defs::text::phrase;
use crate::hmi::variable_entry::{self, VariableEntry};
use crate::hmi::{Area, EditKey, FieldEditor, ValueField, View, keycap, page_frame as lines, pictogram, theme, widget};
use crate::link::screens::{FileFault, Picture, ScreenFiles};
use crate::link::snapshot::AlarmView;
use crate::link::{Command, Snapshot};
use crate::units::Micros;
use picture_column::PictureColumn;

/// Column width from which label and value are side by side, if every label fits.
const SIDE_BY_SIDE_WIDTH: f32 = 236.0;
/// Lines for which the fields have room at least: few fields are not larger than many.
const LEAST_LINES: usize = 8;
/// Space beside the scale of a field.
const SCALE_PAD: f32 = 10.0;
/// Gap between two fields.
const LINE_GAP: f32 = 4.0;
/// Width of a value with its unit beside its label.
const VALUE_WIDTH: f32 = 164.0;
/// Width of the longest value.
const NUMBER_WIDTH: f32 = 98.0;
/// Width of the unit behind a value.
const UNIT_WIDTH: f32 = 60.0;
/// Field height from which label and value are stacked in normal text sizes.
const STACKED_HEIGHT: f32 = 46.0;
/// The same for smaller text sizes.
const COMPACT_HEIGHT: f32 = 36.0;
/// The same for two lines at all.
const DENSE_HEIGHT: f32 = 32.0;

/// State of the page.
#[derive(Debug, Default)]
pub struct GrindingPage {
    /// The value being typed.
    pub entry: VariableEntry,
    /// The part of the last cycle.
    part: part_card::PartCard,
    start: StartStrip,
    /// Program and its page; another one drops the typed value.
    shown: (u32, Option<u32>),
    /// The alarm to whose value the cursor went last: number and time.
    pointed_at: Option<(u16, Micros)>,
    /// Whether a run was active in the last snapshot.
    runs: bool,
    /// Whether the last snapshot had a part.
    has_part: bool,
}

impl PageUi for GrindingPage {
    /// The cursor is at the variable that was handed over, else at that of the latest alarm.
    fn open(&mut self, view: &View<'_>, handed_over: Option<HandOver>) {
        let handed_over = handed_over.and_then(HandOver::variable);
        let variable = handed_over.or(wrong_value(view.snapshot).and_then(|alarm| alarm.variable));
        self.entry = VariableEntry::default();
        self.entry.cursor = variable.and_then(|variable| field_of(view.snapshot, variable)).unwrap_or_default();
    }

    fn record(&mut self, snapshot: &Snapshot) {
        let shown = (snapshot.program.number, snapshot.grinding_page_number());
        if self.shown != shown {
            (self.shown, self.entry) = (shown, VariableEntry::default());
        }
        // The pad makes way for the drawing when a run begins, and for the part.
        let (runs, has_part) = (snapshot.state.is_active(), snapshot.cycle.part.is_some());
        let yields = (runs && !self.runs) || (has_part && !self.has_part);
        if yields && self.entry.editor.text.is_empty() {
            self.entry.editor.pad_open = false;
        }
        (self.runs, self.has_part) = (runs, has_part);
        self.part.record(snapshot);
        self.entry.editor.follow_lock(snapshot);
        let alarm = wrong_value(snapshot);
        let pointed_at = alarm.map(|alarm| (alarm.number, alarm.since));
        if self.pointed_at != pointed_at {
            self.pointed_at = pointed_at;
            let field = alarm.and_then(|alarm| field_of(snapshot, alarm.variable?));
            // A value that is being typed stays.
            if let Some(field) = field.filter(|_| self.entry.editor.text.is_empty()) {
                self.entry.cursor = field;
            }
        }
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(if self.part.types_size { &self.part.editor } else { &self.entry.editor })
    }

    fn wants_pad(&self, view: &View<'_>) -> bool {
        self.part.types_size && self.part.editor.pad_open
            || self.entry.editor.pad_open && view.snapshot.page_files().is_some_and(|files| files.text.is_ok())
    }

    /// Over the picture: no value is beneath it.
    fn pad_room(&self, rect: Rect) -> Rect {
        GrindingLayout::new(rect, false).picture
    }

    fn picture<'a>(&self, snapshot: &'a Snapshot) -> Option<&'a Arc<Picture>> {
        snapshot.page_files()?.picture.as_ref().ok()
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let shown = ctx.view.snapshot.grinding_page_number();
        let Some(shown) = shown else {
            let mut ctx = ctx;
            let (rect, strip) = ctx.rect.shrink(theme::GAP).split_bottom(start_strip::HEIGHT);
            self.start.ui(strip, &mut ctx);
            return no_page(rect, ctx.view, ctx.out);
        };
        if self.entry.editor.text.is_empty()
            && !self.entry.editor.pad_open
            && !self.part.types_size
            && ctx.typed.edits.contains(&EditKey::Cancel)
        {
            self.part.dismiss(ctx.view.snapshot);
        }
        page(shown, self, ctx);
    }
}

/// The latest alarm that names the value that is wrong.
fn wrong_value(snapshot: &Snapshot) -> Option<&AlarmView> {
    snapshot.alarms.iter().rev().find(|alarm| alarm.variable.is_some())
}

/// The field of a variable on the page, in reading order.
fn field_of(snapshot: &Snapshot, variable: u16) -> Option<usize> {
    let text = snapshot.page_files()?.text.as_ref().ok()?;
    text.rows().position(|row| row.variable == variable)
}

/// Draws the page with a number.
fn page(shown: u32, state: &mut GrindingPage, mut ctx: PageContext<'_>) {
    let GrindingPage { entry, part, start, .. } = state;
    let several = ctx.view.snapshot.grinding_sheet.1 > 1;
    let places = GrindingLayout::new(ctx.rect, several);
    if let Some(field) = start.ui(places.start, &mut ctx).and_then(|variable| field_of(ctx.view.snapshot, variable)) {
        entry.select(field);
    }
    let PageContext { view, typed, picture, out, .. } = ctx;
    let files = view.snapshot.page_files();
    if several && next_sheet_key(places.title, view) {
        out.push(Command::ShowGrindingSheet(view.snapshot.grinding_sheet.0 + 1));
    }
    position_column(places.left, view);
    let column = PictureColumn { rect: places.picture, view, number: shown, files, texture: picture };
    column.ui(entry, part, out);
    match files.map(|files| &files.text) {
        Some(Ok(text)) => {
            let title = places.title.trim_right(if several { 104.0 } else { 0.0 });
            let locked = view.snapshot.values_locked();
            let words = view.text("运行中锁定", "locked in run");
            let title = if locked { widget::lock_note(view, title, words) } else { title };
            lines::title(view, title, &heading(view, text));
            let columns = (variables(&text.left), variables(&text.right));
            entry.poll_answer(&view.snapshot.edit_answer);
            if part.types_size {
                part.handle_keys(&typed.edits, out);
            } else {
                for edit in &typed.edits {
                    out.extend(entry.handle_key(*edit, (&columns.0, &columns.1)));
                }
            }
            let (line, body) = places.body.split_top(dressing_line::height(text).unwrap_or(0.0));
            if line.height() > 0.0 {
                dressing_line::paint(line, view, text);
            }
            fields(body, view, [&text.left, &text.right], entry);
            if entry.editor.pad_open {
                part.stop_typing();
            }
            match part.shown(view.snapshot).filter(|_| part.types_size) {
                Some(result) => {
                    let (label, range) = part_card::prompt(view, result);
                    let told = input_line::InputPrompt { label: &label, name: "", range: &range };
                    input_line::ui(view, places.input, &part.editor, &told);
                }
                None => draw_input_line(places.input, view, entry, text),
            }
        }
        Some(Err(fault)) => text_fault(&places, view, fault),
        None => {
            let what = format!("{} C{:04}.TXT", view.text("缺少文件", "missing file"), shown % 1_000);
            let remedy = view.text(
                "把页面文字 C00nn.TXT 和图片 B00nn.BMP 拷贝到 screens 目录；程序不受影响，仍可运行。",
                "Copy the page text C00nn.TXT and the picture B00nn.BMP into the screens folder; the program itself can run.",
            );
            empty::show(view, places.body, pictogram::NO_PAGE, &what, remedy);
        }
    }
}

/// The left and the right column of fields.
type Columns<'a> = [&'a [Option<PageTextRow>; COLUMN_ROWS]; 2];

/// Rectangles of the page.
struct GrindingLayout {
    left: Rect,
    title: Rect,
    body: Rect,
    picture: Rect,
    /// The start guide, in a run the run bar.
    start: Rect,
    input: Rect,
}

impl GrindingLayout {
    fn new(rect: Rect, several: bool) -> Self {
        let (main, input) = rect.split_bottom(theme::INPUT);
        let (main, start) = main.shrink(theme::GAP).split_bottom(start_strip::HEIGHT);
        let main = main.trim_bottom(theme::GAP);
        let (left, rest) = main.split_left(if main.width() > 900.0 { 190.0 } else { 172.0 });
        let (middle, picture) = rest.split_right(theme::PICTURE.x + 2.0);
        let (title, body) =
            middle.trim_sides(theme::GAP).split_top(if several { theme::TOUCH_TARGET + 4.0 } else { 34.0 });
        Self { left, title, body, picture, start, input }
    }
}

fn variables(column: &[Option<PageTextRow>; COLUMN_ROWS]) -> Vec<u16> {
    column.iter().flatten().map(|row| row.variable).collect()
}

/// Left column: 位置, [绝对坐标], [移动余量], O and N.
fn position_column(rect: Rect, view: &View<'_>) {
    let groups: [PositionGroup<'_>; 2] = [
        (view.text("[绝对坐标]", "[absolute]"), &|_, state| Some(state.work)),
        (view.text("[移动余量]", "[to go]"), &|_, state| Some(state.to_go)),
    ];
    let rest = position::column(rect, view, &groups);
    lines::paint_program_label(view, rest.band(14.0, 26.0), theme::LABEL);
    position::process_values(rest.trim_top(48.0), view);
}

/// Lines for which the fields have room.
fn line_count(columns: Columns<'_>) -> usize {
    let used = columns.iter().filter_map(|rows| rows.iter().rposition(Option::is_some)).max();
    used.map_or(0, |last| last + 1).max(LEAST_LINES)
}

/// Rectangle and row of each place for a field, the left column first.
fn cells(body: Rect, columns: Columns<'_>, lines: usize) -> impl Iterator<Item = (Rect, Option<&PageTextRow>)> {
    let rows = columns.into_iter().flat_map(move |rows| rows.iter().take(lines).map(Option::as_ref));
    cell_places(body, lines).zip(rows)
}

/// Rectangle of each field of the two columns, in reading order.
fn field_places(body: Rect, columns: Columns<'_>) -> impl Iterator<Item = (Rect, &PageTextRow)> {
    cells(body, columns, line_count(columns)).filter_map(|(place, row)| Some((place, row?)))
}

/// Rectangle of each place for a field, the left column first.
fn cell_places(body: Rect, lines: usize) -> impl Iterator<Item = Rect> {
    let width = (body.width() - theme::GAP) / 2.0;
    let height = ((body.height() - (lines as f32 - 1.0) * LINE_GAP) / lines as f32).min(58.0);
    (0..2 * lines).map(move |index| {
        let (column, line) = (index / lines, index % lines);
        let corner = body.min + vec2(column as f32 * (width + theme::GAP), line as f32 * (height + LINE_GAP));
        Rect::from_min_size(corner, vec2(width, height))
    })
}

fn fields(body: Rect, view: &View<'_>, columns: Columns<'_>, entry: &mut VariableEntry) {
    let layout = FieldLayout::of(view, body, columns, line_count(columns));
    for (index, (place, row)) in field_places(body, columns).enumerate() {
        let name = format!("{} {}", row.label_in(view.lang), view.variable_name(row.variable));
        let response = view.touch(place, ("field", index), name);
        if response.clicked() {
            entry.select(index);
        }
        keycap::field(view, place, &response);
        field(place, view, row, layout, (entry.cursor == index).then_some(&entry.editor));
        range_scale(place, view, row);
        let refused = view.snapshot.start_guide.refused_variable();
        let wrong = view.snapshot.alarms.iter().map(|alarm| alarm.variable).chain([refused]);
        if wrong.flatten().any(|variable| variable == row.variable) {
            view.edge_bar(place, view.theme.alarm);
        }
    }
}

/// A thin scale at the foot of a field whose value the program bounds on both sides, with the value as a mark.
fn range_scale(place: Rect, view: &View<'_>, row: &PageTextRow) {
    let variables = &*view.snapshot.variables;
    let range = view.snapshot.program.range_of(row.variable, variables);
    let Some(((least, _), (most, _))) = range.least.zip(range.most).filter(|((least, _), (most, _))| least < most)
    else {
        return;
    };
    let Some(value) = variables.get(usize::from(row.variable)).copied().flatten() else { return };
    let line = place.trim_sides(SCALE_PAD);
    let y = place.max.y - 3.0;
    view.painter.hline(line.x_range(), y, Stroke::new(theme::HAIRLINE, view.theme.muted));
    let part = ((value - least) / (most - least)).clamp(0.0, 1.0) as f32;
    let at = pos2(line.min.x + line.width() * part, y);
    let (size, ink) = if range.holds(value) { (5.0, view.theme.info) } else { (8.0, view.theme.hold) };
    view.painter.rect_filled(Rect::from_center_size(at, vec2(size, size)), 1.0, ink);
}

/// Width of a label in one line.
fn label_width(view: &View<'_>, row: &PageTextRow, size: f32) -> f32 {
    view.painter.layout_no_wrap(row.name_in(view.lang).to_owned(), theme::font(size), view.theme.text).size().x
}

/// Arrangement of label and value; the same in all fields of a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FieldLayout {
    SideBySide,
    Stacked,
    /// Stacked in smaller text sizes, for low fields.
    Compact,
    /// Stacked in the smallest text sizes, for the preview of a page.
    Dense,
    /// Side by side in the smallest text sizes, for a preview with ten lines.
    OneLine,
}

impl FieldLayout {
    fn of(view: &View<'_>, body: Rect, columns: Columns<'_>, lines: usize) -> Self {
        let first = cell_places(body, lines).next();
        let (width, height) = first.map_or((0.0, 0.0), |place| (place.width(), place.height()));
        let room = width - 16.0 - VALUE_WIDTH;
        let fits = |row: &PageTextRow| label_width(view, row, theme::LABEL) <= room;
        let beside = width >= SIDE_BY_SIDE_WIDTH && columns.into_iter().flatten().flatten().all(fits);
        match beside {
            true => Self::SideBySide,
            false if height >= STACKED_HEIGHT => Self::Stacked,
            false if height >= COMPACT_HEIGHT => Self::Compact,
            false if height >= DENSE_HEIGHT => Self::Dense,
            false => Self::OneLine,
        }
    }
}

/// The title as the grinding page shows it (K7.2).
fn heading(view: &View<'_>, text: &PageText) -> String {
    format!("{}{}", text.title_in(view.lang), view.text("参数设置", " · parameters"))
}

/// One label and its value; the selected one is framed and shows the typed text.
fn field(place: Rect, view: &View<'_>, row: &PageTextRow, layout: FieldLayout, chosen: Option<&FieldEditor>) {
    let (edge, small, large) = match layout {
        FieldLayout::SideBySide | FieldLayout::Stacked => (3.0, theme::LABEL, theme::SECONDARY),
        FieldLayout::Compact => (2.0, theme::SMALL, theme::TITLE),
        FieldLayout::Dense | FieldLayout::OneLine => (1.0, theme::SMALL, theme::LABEL),
    };
    let inside = place.shrink2(vec2(8.0, edge));
    let (label, value) = match layout {
        FieldLayout::SideBySide => inside.split_right(VALUE_WIDTH),
        FieldLayout::Stacked | FieldLayout::Compact => inside.split_top_bottom_at_fraction(0.46),
        FieldLayout::Dense => inside.split_top_bottom_at_fraction(0.5),
        FieldLayout::OneLine => inside.split_left_right_at_fraction(0.62),
    };
    let ink = if chosen.is_some() { view.theme.text } else { view.theme.muted };
    view.fit_left(label, row.name_in(view.lang), small, ink);
    // The preview of a page may be too narrow for units.
    let has_units = value.width() >= NUMBER_WIDTH + UNIT_WIDTH;
    let (value, unit) = value.split_right(if has_units { UNIT_WIDTH } else { 0.0 });
    if let Some(words) = row.unit().filter(|_| has_units) {
        view.line_left(unit.trim_left(4.0), words.get(view.lang), theme::SMALL, view.theme.muted);
    }
    let (words, ink) = match dressing_line::point_by_key(view.snapshot, row) {
        Some(point) => (view.length(point), view.theme.info),
        None => (view.page_value(row), view.theme.text),
    };
    FieldEditor::paint(chosen, view, ValueField { plate: place, value, size: large, words, ink });
}

/// `数据输入: #500=40.2   卡尺X轴始磨位置   范围 ±99999.999 · 原值 40.000`
fn draw_input_line(rect: Rect, view: &View<'_>, entry: &VariableEntry, text: &PageText) {
    let line = input_line::bar(view, rect);
    let Some(row) = text.rows().nth(entry.cursor) else { return };
    let (left, rest) = line.split_left_right_at_fraction(0.34);
    let ink = input_line::typed_text(view, left, &format!("{}=", view.variable_name(row.variable)), &entry.editor);
    let refusal = entry.editor.refusal(view.lang).map(|reason| (reason.into_owned(), None));
    let (told, told_ink) = refusal.unwrap_or_else(|| {
        let note = ActingPoint::of(view.snapshot, text, row).and_then(|point| point.note(view, row));
        if let Some(note) = note.filter(|_| !view.snapshot.values_locked()) {
            return (note, None);
        }
        let snapshot = view.snapshot;
        let by_program = snapshot.program.range_of(row.variable, &*snapshot.variables).words(view.lang);
        let words =
            if by_program.is_empty() { variable_entry::range(row.variable).get(view.lang) } else { &by_program };
        let range = view.range_and_old(words, &view.page_value(row));
        input_line::range_in_run(view, &range)
    });
    let range = view.fit_right(rest, &told, theme::LABEL, told_ink.unwrap_or(ink));
    let name = rest.with_max_x(range.min.x - theme::PAD);
    // A long note takes the room of the name.
    if name.width() > NUMBER_WIDTH {
        view.fit_left(name, row.name_in(view.lang), theme::LABEL, view.theme.muted);
    }
}

/// The picture of the page with a number.
fn show_picture(rect: Rect, view: &View<'_>, page: u32, files: Option<&ScreenFiles>, texture: Option<TextureId>) {
    let number = page % 1_000;
    let fault = files.and_then(|files| files.picture.as_ref().err());
    empty::picture(rect, view, texture, &format!("B{number:04}.BMP"), fault);
}

/// The key for the next page of the program, at the end of the title.
fn next_sheet_key(title: Rect, view: &View<'_>) -> bool {
    let (sheet, sheets) = view.snapshot.grinding_sheet;
    let size = vec2(96.0, theme::TOUCH_TARGET);
    let place = Rect::from_min_size(pos2(title.max.x - size.x, title.min.y), size);
    let words = format!("{} {}/{sheets}", view.text("下页", "NEXT"), sheet + 1);
    let response = keycap::plain(view, place, "next-sheet", format!("{words} next-sheet"));
    view.fit_centre(place.shrink(4.0), &words, theme::LABEL, view.theme.text);
    response.clicked()
}

fn text_fault(places: &GrindingLayout, view: &View<'_>, fault: &FileFault) {
    let what = match fault.position {
        Some(_) => view.text("页面文件格式错误", "the page file has a format error"),
        None => view.text("没有可用的页面文件", "there is no page file to show"),
    };
    lines::title(view, places.title, what);
    empty::show(view, places.body, pictogram::NO_PAGE, &fault.file, "");
    let below = Rect::from_min_max(pos2(places.body.min.x + 8.0, places.body.center().y + 20.0), places.body.max);
    view.paragraph(below, &fault.full_message().get(view.lang), theme::LABEL, view.theme.alarm_text);
}

/// The program has no grinding page: shows what to do.
fn no_page(rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
    let number = view.snapshot.program.number;
    let name = view.snapshot.title(number);
    let what = match number {
        0 => view.text("没有装入程序", "no program is loaded").to_owned(),
        _ => view.phrase(&phrase!("{name} 没有磨削页面", "{name} has no grinding page", name)),
    };
    let remedy = view.text(
        "磨削页面只用于 O1001–O1020，文字和图片在 screens 目录（C00nn.TXT、B00nn.BMP）。请在目录中装入其中一个程序。",
        "Only O1001–O1020 have a grinding page (C00nn.TXT and B00nn.BMP in the screens folder). Load one of them in the directory.",
    );
    empty::show(view, rect, pictogram::NO_PAGE, &what, remedy);
    let key = Rect::from_center_size(pos2(rect.center().x, rect.min.y + rect.height() * 0.72), vec2(200.0, 52.0));
    let words = view.text("打开目录", "open directory");
    let response = keycap::plain(view, key, "to-directory", words);
    view.fit_centre(key, words, theme::TITLE, view.theme.text);
    if response.clicked() {
        out.push(Command::OpenPage(Page::Directory));
    }
}
