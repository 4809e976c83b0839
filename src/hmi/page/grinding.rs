//! Grinding page: positions, the customer's two columns of macro variables, the picture.
//! Source: spec K7.2–K7.5, H6, H8; seed 000.

use std::sync::Arc;

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, TextureId, Ui, WidgetInfo, pos2, vec2};

use super::position::PositionGroup;
use super::{PageContext, PageUi, empty, position};
use crate::defs::page::Page;
use crate::defs::page_text::{COLUMN_ROWS, PageText, PageTextRow};
use crate::defs::text::Lang;
use crate::defs::{r_parameter_name, variable_name};
use crate::hmi::field_editor::FieldEditor;
use crate::hmi::variable_entry::{self, VariableEntry};
use crate::hmi::view::{View, fit_text, focus_frame, paragraph};
use crate::hmi::widget::{self, ButtonState};
use crate::hmi::{keycap, page_frame as lines, pictogram, theme};
use crate::link::command::{FileFault, Picture, ScreenFiles};
use crate::link::{Command, Snapshot};

/// Column width from which label and value are side by side, if every label fits.
const SIDE_BY_SIDE_WIDTH: f32 = 236.0;
/// Width of a value beside its label.
const VALUE_WIDTH: f32 = 104.0;
/// Field height from which label and value are stacked in normal text sizes.
const STACKED_HEIGHT: f32 = 46.0;
/// The same for smaller text sizes.
const COMPACT_HEIGHT: f32 = 36.0;

/// State of the page.
#[derive(Debug, Default)]
pub struct GrindingPage {
    /// The value being typed.
    pub entry: VariableEntry,
    /// Program and its page; another one drops the typed value.
    shown: (u32, Option<u32>),
}

impl PageUi for GrindingPage {
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<u32>) {
        self.entry.restart();
    }

    fn record(&mut self, snapshot: &Snapshot) {
        let shown = (snapshot.program.number, snapshot.grinding_page_number());
        if self.shown != shown {
            self.shown = shown;
            self.entry.restart();
        }
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(&self.entry.editor)
    }

    fn wants_pad(&self, view: &View<'_>) -> bool {
        self.entry.editor.pad_open && view.snapshot.page_files().is_some_and(|files| files.text.is_ok())
    }

    fn picture<'a>(&self, snapshot: &'a Snapshot) -> Option<&'a Arc<Picture>> {
        snapshot.page_files()?.picture.as_ref().ok()
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        match ctx.view.snapshot.grinding_page_number() {
            Some(shown) => page(shown, &mut self.entry, ctx),
            None => no_page(ctx.ui, ctx.rect, ctx.view, ctx.out),
        }
    }
}

/// Draws the page with a number.
fn page(shown: u32, entry: &mut VariableEntry, ctx: PageContext<'_>) {
    let PageContext { ui, rect, view, typed, picture, out, .. } = ctx;
    let several = view.snapshot.grinding_sheet.1 > 1;
    let places = GrindingLayout::new(rect, several);
    let files = view.snapshot.page_files();
    if several && next_sheet_key(ui, places.title, view) {
        out.push(Command::ShowGrindingSheet(view.snapshot.grinding_sheet.0 + 1));
    }
    position_column(ui, places.left, view);
    show_picture(ui, places.picture, view, files, picture);
    let key = Rect::from_min_max(pos2(places.picture.min.x, places.picture.max.y - 48.0), places.picture.max);
    if key.min.y > places.picture.min.y + theme::PICTURE.y + theme::GAP
        && widget::button(ui, view, key, "design-page", view.text("页面设计", "PAGE DESIGN"), ButtonState::default())
    {
        out.push(Command::OpenPage(Page::Designer));
    }
    match files.map(|files| &files.text) {
        Some(Ok(text)) => {
            let title = heading(view, text);
            let room = if several { places.title.max.x - 104.0 } else { places.title.max.x };
            let place = Rect::from_min_max(places.title.min, pos2(room, places.title.max.y));
            lines::title(ui, view, place, &title);
            let columns = (variables(&text.left), variables(&text.right));
            entry.poll_answer(&view.snapshot.edit_answer);
            for edit in typed.edits {
                out.extend(entry.handle_key(*edit, (&columns.0, &columns.1)));
            }
            fields(ui, &places, view, [&text.left, &text.right], entry);
            input_line(ui, places.input, view, entry, [&text.left, &text.right]);
        }
        Some(Err(fault)) => text_fault(ui, &places, view, fault),
        None => {
            let what = format!("{} C{:04}.TXT", view.text("缺少文件", "missing file"), shown % 1_000);
            let remedy = view.text(
                "把页面文字 C00nn.TXT 和图片 B00nn.BMP 拷贝到 screens 目录；程序不受影响，仍可运行。",
                "Copy the page text C00nn.TXT and the picture B00nn.BMP into the folder screens; the program itself can run.",
            );
            empty::show(ui, view, places.body, pictogram::NO_PAGE, &what, remedy);
        }
    }
}

/// Rectangles of the page.
struct GrindingLayout {
    left: Rect,
    title: Rect,
    body: Rect,
    picture: Rect,
    input: Rect,
}

impl GrindingLayout {
    fn new(rect: Rect, several: bool) -> Self {
        let (main, input) = rect.split_top_bottom_at_y(rect.max.y - theme::INPUT);
        let main = main.shrink2(vec2(theme::GAP, theme::GAP));
        let wide = main.width() > 900.0;
        let left_width = if wide { 190.0 } else { 152.0 };
        let (left, rest) = main.split_left_right_at_x(main.min.x + left_width);
        let (middle, picture) = rest.split_left_right_at_x(rest.max.x - theme::PICTURE.x - 2.0);
        let middle = Rect::from_min_max(middle.min + vec2(theme::GAP, 0.0), middle.max - vec2(theme::GAP, 0.0));
        let (title, body) =
            middle.split_top_bottom_at_y(middle.min.y + if several { theme::TOUCH_TARGET + 4.0 } else { 34.0 });
        Self { left, title, body, picture, input }
    }
}

fn variables(column: &[Option<PageTextRow>; COLUMN_ROWS]) -> Vec<u16> {
    column.iter().flatten().map(|row| row.variable).collect()
}

/// Left column: 位置, [绝对坐标], [移动余量], O and N.
fn position_column(ui: &Ui, rect: Rect, view: &View<'_>) {
    let groups: [PositionGroup<'_>; 2] = [
        (view.text("[绝对坐标]", "[absolute]"), &|_, state| Some(state.work)),
        (view.text("[移动余量]", "[to go]"), &|_, state| Some(state.to_go)),
    ];
    let rest = position::column(ui, rect, view, &groups);
    let block = Rect::from_min_size(rest.min + vec2(0.0, 14.0), vec2(rest.width(), 26.0));
    lines::paint_program_label(ui.painter(), view, block, theme::LABEL);
    position::process_values(ui, Rect::from_min_max(pos2(rest.min.x, block.max.y + 8.0), rest.max), view);
}

/// Rectangle of each field of the two columns, in reading order.
fn field_places(
    body: Rect,
    columns: [&[Option<PageTextRow>; COLUMN_ROWS]; 2],
) -> impl Iterator<Item = (Rect, &PageTextRow)> {
    let width = (body.width() - theme::GAP) / 2.0;
    let height = ((body.height() - 9.0 * 4.0) / COLUMN_ROWS as f32).min(58.0);
    columns.into_iter().enumerate().flat_map(move |(column, rows)| {
        rows.iter().enumerate().filter_map(move |(line, row)| {
            let corner = body.min + vec2(column as f32 * (width + theme::GAP), line as f32 * (height + 4.0));
            Some((Rect::from_min_size(corner, vec2(width, height)), row.as_ref()?))
        })
    })
}

fn fields(
    ui: &Ui,
    places: &GrindingLayout,
    view: &View<'_>,
    columns: [&[Option<PageTextRow>; COLUMN_ROWS]; 2],
    entry: &mut VariableEntry,
) {
    let way = FieldLayout::of(ui, view, places.body, columns);
    for (index, (place, row)) in field_places(places.body, columns).enumerate() {
        let response = ui.interact(place, Id::unique(("field", index)), Sense::CLICK);
        response.widget_info(|| {
            WidgetInfo::labeled(Role::Button, true, format!("{} {}", row.label, variable_name(view, row.variable)))
        });
        if response.clicked() {
            entry.select(index);
        }
        let chosen = entry.cursor == index;
        let state = (chosen.then_some(&*entry), response.is_pointer_button_down_on());
        field(ui, place, view, (row, way), state);
    }
}

/// A text of the page file in the screen language: the known translation, else as written.
fn translated(view: &View<'_>, text: &str, english: impl FnOnce(&str) -> Option<String>) -> String {
    let known = if view.lang == Lang::En { english(text) } else { None };
    known.unwrap_or_else(|| text.to_owned())
}

fn label_of(view: &View<'_>, row: &PageTextRow) -> String {
    translated(view, &row.label, r_parameter_name::english_label)
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
}

impl FieldLayout {
    fn of(ui: &Ui, view: &View<'_>, body: Rect, columns: [&[Option<PageTextRow>; COLUMN_ROWS]; 2]) -> Self {
        let first = field_places(body, columns).next();
        let (width, height) = first.map_or((0.0, 0.0), |(place, _)| (place.width(), place.height()));
        let room = width - 16.0 - VALUE_WIDTH;
        let fits = |row: &PageTextRow| {
            let font = theme::font(theme::LABEL);
            ui.painter().layout_no_wrap(label_of(view, row), font, view.theme.text).size().x <= room
        };
        let beside = width >= SIDE_BY_SIDE_WIDTH && columns.into_iter().flatten().flatten().all(fits);
        match beside {
            true => Self::SideBySide,
            false if height >= STACKED_HEIGHT => Self::Stacked,
            false if height >= COMPACT_HEIGHT => Self::Compact,
            false => Self::Dense,
        }
    }
}

/// Preview for the page designer: title, fields and picture of a page text. Nothing in it reacts to input.
pub fn preview(
    ui: &Ui,
    rect: Rect,
    view: &View<'_>,
    text: &PageText,
    files: Option<&ScreenFiles>,
    texture: Option<TextureId>,
) {
    let columns = [&text.left, &text.right];
    let split = |scale: f32| {
        let (middle, picture) = rect.split_left_right_at_x(rect.max.x - theme::PICTURE.x * scale - 2.0);
        (Rect::from_min_max(middle.min, middle.max - vec2(theme::GAP, 0.0)), picture)
    };
    // On the grinding page every label fits. The preview has less room, so it shrinks the picture.
    let fits = |middle: Rect| {
        let room = (middle.width() - theme::GAP) / 2.0 - 16.0;
        let font = theme::font(theme::SMALL);
        let width = |row: &PageTextRow| {
            ui.painter().layout_no_wrap(label_of(view, row), font.clone(), view.theme.text).size().x
        };
        columns.into_iter().flatten().flatten().all(|row| width(row) <= room)
    };
    let scale = [1.0, 0.75, 0.5].into_iter().find(|scale| fits(split(*scale).0)).unwrap_or(0.5);
    let (middle, picture) = split(scale);
    let (title, body) = middle.split_top_bottom_at_y(middle.min.y + 34.0);
    lines::title(ui, view, title, &heading(view, text));
    let way = FieldLayout::of(ui, view, body, columns);
    for (place, row) in field_places(body, columns) {
        field(ui, place, view, (row, way), (None, false));
    }
    show_picture(ui, Rect::from_min_size(picture.min, theme::PICTURE * scale), view, files, texture);
}

/// The title as the grinding page shows it (K7.2).
fn heading(view: &View<'_>, text: &PageText) -> String {
    let name = translated(view, &text.title, |title| r_parameter_name::english_title(title).map(str::to_owned));
    format!("{name}{}", view.text("参数设置", " · parameters"))
}

/// One label and its value; the selected one is framed and shows the typed text.
fn field(
    ui: &Ui,
    place: Rect,
    view: &View<'_>,
    (row, way): (&PageTextRow, FieldLayout),
    (chosen, pressed): (Option<&VariableEntry>, bool),
) {
    let painter = ui.painter();
    keycap::paint_body(painter, view.theme, place, keycap::KeycapState { pressed, ..keycap::KeycapState::default() });
    let (edge, small, large) = match way {
        FieldLayout::SideBySide | FieldLayout::Stacked => (3.0, theme::LABEL, theme::SECONDARY),
        FieldLayout::Compact => (2.0, theme::SMALL, theme::TITLE),
        FieldLayout::Dense => (1.0, theme::SMALL, theme::LABEL),
    };
    let inside = place.shrink2(vec2(8.0, edge));
    let (label, value) = match way {
        FieldLayout::SideBySide => inside.split_left_right_at_x(inside.max.x - VALUE_WIDTH),
        FieldLayout::Stacked | FieldLayout::Compact => inside.split_top_bottom_at_fraction(0.46),
        FieldLayout::Dense => inside.split_top_bottom_at_fraction(0.5),
    };
    let ink = if chosen.is_some() { view.theme.text } else { view.theme.muted };
    fit_text(painter, label, Align2::LEFT_CENTER, &label_of(view, row), small, ink);
    let (words, colour) = match chosen {
        Some(entry) if entry.editor.refused.is_some() => (entry.editor.text.clone(), view.theme.alarm_text),
        Some(entry) if !entry.editor.text.is_empty() => (format!("{}_", entry.editor.text), view.theme.info),
        _ => (view.variable(row.variable), view.theme.text),
    };
    fit_text(painter, value, Align2::RIGHT_CENTER, &words, large, colour);
    if let Some(entry) = chosen {
        let colour = if entry.editor.refused.is_some() { view.theme.alarm } else { view.theme.focus };
        focus_frame(painter, place, colour);
    }
}

/// `数据输入: #500=40.2_   卡尺X轴始磨位置   范围 ±99999.999 · 原值 40.000`
fn input_line(
    ui: &Ui,
    rect: Rect,
    view: &View<'_>,
    entry: &VariableEntry,
    columns: [&[Option<PageTextRow>; COLUMN_ROWS]; 2],
) {
    let painter = ui.painter();
    painter.rect_filled(rect, 0.0, view.theme.surface);
    painter.hline(rect.x_range(), rect.min.y + 0.5, egui::Stroke::new(theme::HAIRLINE, view.theme.line));
    let Some(row) = columns.into_iter().flatten().flatten().nth(entry.cursor) else { return };
    let line = rect.shrink2(vec2(theme::PAD, 2.0));
    let (left, rest) = line.split_left_right_at_fraction(0.34);
    let words =
        format!("{} {}={}", view.text("数据输入:", "INPUT:"), variable_name(view, row.variable), entry.editor.text);
    let (colour, right) = match entry.refusal(view.lang) {
        Some(reason) => (view.theme.alarm_text, (reason.into_owned(), view.theme.alarm_text)),
        None => {
            let range = variable_entry::range(row.variable).get(view.lang);
            let old = view.variable(row.variable);
            let words = format!("{} {range} · {} {old}", view.text("范围", "range"), view.text("原值", "was"));
            (view.theme.text, (words, view.theme.muted))
        }
    };
    fit_text(painter, left, Align2::LEFT_CENTER, &words, theme::TITLE, colour);
    let (name, range) = rest.split_left_right_at_fraction(0.4);
    let name = Rect::from_min_max(name.min, name.max - vec2(theme::PAD, 0.0));
    fit_text(painter, name, Align2::LEFT_CENTER, &label_of(view, row), theme::LABEL, view.theme.muted);
    fit_text(painter, range, Align2::RIGHT_CENTER, &right.0, theme::LABEL, right.1);
}

fn show_picture(ui: &Ui, rect: Rect, view: &View<'_>, files: Option<&ScreenFiles>, texture: Option<TextureId>) {
    let number = view.snapshot.grinding_page_number().unwrap_or_default() % 1_000;
    let fault = files.and_then(|files| files.picture.as_ref().err());
    empty::picture(ui, rect, view, texture, (&format!("B{number:04}.BMP"), fault));
}

/// The key for the next page of the program, at the end of the title.
fn next_sheet_key(ui: &Ui, title: Rect, view: &View<'_>) -> bool {
    let (sheet, sheets) = view.snapshot.grinding_sheet;
    let size = vec2(96.0, theme::TOUCH_TARGET);
    let place = Rect::from_min_size(pos2(title.max.x - size.x, title.min.y), size);
    let response = ui.interact(place, Id::unique("next-sheet"), Sense::CLICK);
    let words = format!("{} {}/{sheets}", view.text("下页", "NEXT"), sheet + 1);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("{words} next-sheet")));
    let pressed = response.is_pointer_button_down_on();
    keycap::paint_body(
        ui.painter(),
        view.theme,
        place,
        keycap::KeycapState { pressed, ..keycap::KeycapState::default() },
    );
    fit_text(ui.painter(), place.shrink(4.0), Align2::CENTER_CENTER, &words, theme::LABEL, view.theme.text);
    response.clicked()
}

/// Name of a variable on this kind of machine.
fn variable_name(view: &View<'_>, variable: u16) -> String {
    variable_name::variable_name_on(u32::from(variable), view.snapshot.kind)
}

fn text_fault(ui: &Ui, places: &GrindingLayout, view: &View<'_>, fault: &FileFault) {
    let what = match fault.position {
        Some(_) => view.text("页面文件格式错误", "the page file is not of the format"),
        None => view.text("没有可用的页面文件", "there is no page file to show"),
    };
    lines::title(ui, view, places.title, what);
    empty::show(ui, view, places.body, pictogram::NO_PAGE, &fault.file, "");
    let below = Rect::from_min_max(pos2(places.body.min.x + 8.0, places.body.center().y + 20.0), places.body.max);
    paragraph(ui.painter(), below, &fault.full_message().get(view.lang), theme::LABEL, view.theme.alarm_text);
}

/// The program has no grinding page: shows what to do.
fn no_page(ui: &Ui, rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
    let number = view.snapshot.program.number;
    let name = view.snapshot.title(number);
    let what = match (number, view.lang) {
        (0, _) => view.text("没有装入程序", "no program is loaded").to_owned(),
        (_, crate::defs::text::Lang::Zh) => format!("{name} 没有磨削页面"),
        (_, crate::defs::text::Lang::En) => format!("{name} has no grinding page"),
    };
    let remedy = view.text(
        "磨削页面只用于 O1001–O1020，文字和图片在 screens 目录（C00nn.TXT、B00nn.BMP）。请在目录中装入其中一个程序。",
        "Only O1001–O1020 have a grinding page (C00nn.TXT and B00nn.BMP in the folder screens). Load one of them in the directory.",
    );
    empty::show(ui, view, rect, pictogram::NO_PAGE, &what, remedy);
    let key = Rect::from_center_size(pos2(rect.center().x, rect.min.y + rect.height() * 0.72), vec2(200.0, 52.0));
    let response = ui.interact(key, Id::unique("to-directory"), Sense::CLICK);
    let words = view.text("打开目录", "open directory");
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, words));
    let pressed = response.is_pointer_button_down_on();
    keycap::paint_body(
        ui.painter(),
        view.theme,
        key,
        keycap::KeycapState { pressed, ..keycap::KeycapState::default() },
    );
    fit_text(ui.painter(), key, Align2::CENTER_CENTER, words, theme::TITLE, view.theme.text);
    if response.clicked() {
        out.push(Command::OpenPage(Page::Directory));
    }
}
