//! Drawing of the page designer: the text with its errors, the preview, the lists beside it.
//! Source: spec H4, K7.2–K7.4.

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, TextureId, Ui, WidgetInfo, pos2, vec2};

use super::actions::VariableRow;
use super::{DesignerPage, DesignerQuestion};
use crate::defs::page::Page;
use crate::defs::page_text::PageTextFault;
use crate::defs::text::{LocalizedText, Text};
use crate::defs::variable_name;
use crate::hmi::page::program::listing::{self, LineMarks};
use crate::hmi::page::{empty, grinding};
use crate::hmi::question::Question;
use crate::hmi::view::{View, card, fit_text, focus_frame, paragraph, text_line};
use crate::hmi::widget::{self, ButtonState, round_to_lines};
use crate::hmi::{page_frame as lines, pictogram, theme};
use crate::link::Command;
use crate::link::page_file::{PictureFile, PictureLocation};

/// Height of a row of a list.
const ROW_HEIGHT: f32 = 50.0;
/// Width of the key in a row.
const KEY_WIDTH: f32 = 76.0;
/// Width of the line number of the text.
const NUMBER_WIDTH: f32 = 40.0;

/// The program has no page.
pub fn no_page(ui: &Ui, rect: Rect, view: &View<'_>, number: u32, out: &mut Vec<Command>) {
    let what = match number {
        0 => view.text("没有装入程序", "no program is loaded").to_owned(),
        _ => format!("{} {}", view.snapshot.title(number), view.text("没有磨削页面", "has no grinding page")),
    };
    let remedy = view.text(
        "只有 O1001–O1020 有页面。请在目录中选择其中一个。",
        "Only O1001 to O1020 have one. Choose one of them in the directory.",
    );
    empty::show(ui, view, rect, pictogram::NO_PAGE, &what, remedy);
    let key = Rect::from_center_size(pos2(rect.center().x, rect.min.y + rect.height() * 0.72), vec2(200.0, 52.0));
    if widget::button(ui, view, key, "to-directory", view.text("打开目录", "DIRECTORY"), ButtonState::default()) {
        out.push(Command::OpenPage(Page::Directory));
    }
}

impl DesignerPage {
    pub(super) fn title(&self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let (line, column) = self.document.cursor_position();
        let words = format!("{} {}:{}", view.text("行", "line"), line + 1, column + 1);
        let right = text_line(ui.painter(), rect, Align2::RIGHT_CENTER, &words, theme::LABEL, view.theme.muted);
        let name = self.file.as_ref().map_or("", |file| file.name.as_str());
        let of = match view.snapshot.kind_page {
            Some(_) => Page::Grinding.title_on(view.snapshot.kind).get(view.lang).to_owned(),
            None => view.snapshot.title(self.document.number),
        };
        let title = format!("{name} · {of}");
        let place = Rect::from_min_max(rect.min, pos2(rect.min.x + 260.0, rect.max.y));
        lines::title(ui, view, place, &title);
        let fresh = self.file.as_ref().is_some_and(|file| file.stamp == 0);
        let (words, ink) = if self.document.changed {
            (view.text("未保存", "not saved"), view.theme.hold)
        } else if self.editing {
            (view.text("编辑", "editing"), view.theme.info)
        } else if fresh {
            (view.text("还没有这个文件", "no such file yet"), view.theme.hold)
        } else {
            return;
        };
        let place = Rect::from_min_max(pos2(place.max.x, rect.min.y), pos2(right.min.x - theme::GAP, rect.max.y));
        fit_text(ui.painter(), place, Align2::LEFT_CENTER, words, theme::LABEL, ink);
    }

    fn fault_in_line(&self, row: usize) -> Option<&PageTextFault> {
        self.reading.faults.iter().find(|fault| fault.line as usize == row + 1)
    }

    /// The text; a line with an error has a red bar.
    pub(super) fn listing(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, pages: i32) {
        card(ui.painter(), rect, view.theme.surface, view.theme.line);
        if self.editing {
            focus_frame(ui.painter(), rect, view.theme.focus);
        }
        let (list, height) = (round_to_lines(rect.shrink2(vec2(3.0, 4.0)), listing::LINE_HEIGHT), listing::LINE_HEIGHT);
        let count = self.document.lines();
        if pages != 0 {
            self.position.scroll.scroll_pages(pages, list, height);
        }
        let (line, column) = self.document.cursor_position();
        if !self.position.scroll.user_scrolled {
            self.position.scroll.scroll_to(line, list, height);
            let room = list.width() - NUMBER_WIDTH;
            self.position.follow_cursor(ui.painter(), &self.document.rope, (line, column), room);
        }
        let tap = ui.interact(list, Id::unique("page-text"), Sense::CLICK);
        tap.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "page-text"));
        let (first, last) = self.position.scroll.handle_input(ui, "page-lines", list, height, count);
        self.position.drag_sideways(ui, "page-lines", &self.document.rope, first..last.min(count));
        let shift = listing::NUMBER_WIDTH - NUMBER_WIDTH;
        if tap.clicked()
            && let Some(at) = tap.interact_pointer_pos()
        {
            let row = (f64::from((at.y - list.min.y) / height) + self.position.scroll.top).floor().max(0.0) as usize;
            if row < count {
                let x = at.x - list.min.x - NUMBER_WIDTH;
                let column =
                    listing::column_at(ui.painter(), view, &self.document.rope, (row, self.position.first_column), x);
                self.document.move_to(row, column);
                self.keys_focused = false;
            }
        }
        let painter = &ui.painter().with_clip_rect(list);
        for row in first..last.min(count) {
            let top = list.min.y + ((row as f64 - self.position.scroll.top) * f64::from(height)) as f32;
            // Page texts need two-digit line numbers only; the unused width lies left of the list.
            let place = Rect::from_min_max(pos2(list.min.x - shift, top), pos2(list.max.x - 8.0, top + height));
            let cursor = (self.editing && row == line).then_some(column);
            let mark = LineMarks { faulty: false, cursor, ..LineMarks::default() };
            listing::paint_line(painter, place, view, &self.document.rope, (row, self.position.first_column), mark);
            if self.fault_in_line(row).is_some() {
                let bar = Rect::from_min_size(pos2(list.min.x, top), vec2(4.0, height));
                painter.rect_filled(bar, 0.0, view.theme.alarm);
            }
        }
        self.position.scroll.draw_bar(ui, view, list, height, count);
    }

    /// Message line: last message, bad encoding, error in the cursor's line or else the first one, or format correct.
    pub(super) fn message_line(&self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let faults = &self.reading.faults;
        let of_file = self.file.as_ref().is_some_and(|file| file.has_invalid_bytes);
        let (words, ink) = if let Some((said, refused)) = &self.message {
            (said.get(view.lang).into_owned(), if *refused { view.theme.alarm_text } else { view.theme.text })
        } else if of_file {
            let words = view.text("含有不是 GBK 或 UTF-8 的字节：只能查看", "bytes neither GBK nor UTF-8: shown only");
            (words.to_owned(), view.theme.hold)
        } else if let Some(fault) = self.fault_in_line(self.document.cursor_position().0).or(faults.first()) {
            (fault_text(view, fault), view.theme.alarm_text)
        } else if self.file.is_some() {
            (view.text("文字符合格式", "the text is of the format").to_owned(), view.theme.muted)
        } else {
            return;
        };
        fit_text(ui.painter(), rect.shrink2(vec2(4.0, 0.0)), Align2::LEFT_CENTER, &words, theme::LABEL, ink);
    }

    /// Preview of the grinding page.
    pub(super) fn preview(&self, ui: &Ui, rect: Rect, view: &View<'_>, texture: Option<TextureId>) {
        let files = view.snapshot.screens.find(self.document.number);
        grinding::preview(ui, rect, view, &self.reading.page, files, texture);
    }

    /// Variables of program and page.
    pub(super) fn variable_list(&mut self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let rows = self.variables(view);
        if self.file.as_ref().is_some_and(|file| file.uses.is_none()) {
            let words = view
                .text("程序不在目录中：不知道它用哪些变量", "the program is not there: its variables are not known");
            paragraph(ui.painter(), rect.shrink(theme::PAD), words, theme::LABEL, view.theme.hold);
        }
        let mut added = None;
        self.scroll_list(ui, rect, view, rows.len(), |page, ui, places, index| {
            if page.variable_row(ui, view, places, index, &rows[index]) {
                added = Some(index);
            }
        });
        if let Some(index) = added {
            self.add_variable(view, &rows[index]);
        }
    }

    /// Available pictures.
    pub(super) fn picture_list(&mut self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let Some(file) = self.file.clone() else { return };
        let (head, rest) = rect.split_top_bottom_at_y(rect.min.y + 66.0);
        let number = self.document.number % 1_000;
        let picture = view.snapshot.screens.find(self.document.number).map(|files| &files.picture);
        let (now, ink) = match picture {
            Some(Ok(_)) => (view.text("符合格式", "of the format").to_owned(), view.theme.text),
            Some(Err(fault)) => (fault.message.get(view.lang).into_owned(), view.theme.alarm_text),
            None => (view.text("没有", "missing").to_owned(), view.theme.hold),
        };
        let line = Rect::from_min_size(head.min, vec2(head.width(), 22.0));
        fit_text(ui.painter(), line, Align2::LEFT_CENTER, &format!("B{number:04}.BMP: {now}"), theme::LABEL, ink);
        let words = view.text(
            "U 盘或 screens 目录中的 PNG、JPEG、BMP；换用时转换为 200×400、24 位，不足处补白。",
            "PNG, JPEG, BMP of the USB stick or the folder screens; converted to 200×400 in 24 bits, on white.",
        );
        let below = Rect::from_min_max(line.left_bottom() + vec2(0.0, 2.0), head.max);
        paragraph(ui.painter(), below, words, theme::SMALL, view.theme.muted);
        if file.pictures.is_empty() {
            let words =
                view.text("没有图片：插入 U 盘后再按“图片”", "no pictures: plug a stick in, press PICTURES again");
            paragraph(ui.painter(), rest, words, theme::LABEL, view.theme.hold);
        }
        let mut taken = None;
        self.scroll_list(ui, rest, view, file.pictures.len(), |page, ui, places, index| {
            if page.picture_row(ui, view, places, index, &file.pictures[index]) {
                taken = Some(index);
            }
        });
        let Some(chosen) = taken.map(|index| &file.pictures[index]) else { return };
        if !self.editing {
            return self.refuse(LocalizedText::new("先按“编辑”", "press EDIT first"));
        }
        let name = &chosen.name;
        let body = LocalizedText::new(
            format!("B{number:04}.BMP 将换成 {name}。"),
            format!("B{number:04}.BMP will be replaced by {name}."),
        );
        let key = ("question-picture", Text::new("换用", "TAKE"));
        let question = Question::new(Text::new("换图片？", "take the picture?"), body, key);
        self.question.ask(DesignerQuestion::Picture(chosen.location, name.clone()), question);
    }

    /// Errors by line; a touch moves the cursor to the line.
    pub(super) fn faults(&mut self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let faults = self.reading.faults.clone();
        if faults.is_empty() {
            let words = view.text("没有错误", "no mistakes");
            paragraph(ui.painter(), rect.shrink(theme::PAD), words, theme::TITLE, view.theme.muted);
            return;
        }
        let mut chosen = None;
        self.scroll_list(ui, rect, view, faults.len(), |page, ui, (list, place), index| {
            let painter = &ui.painter().with_clip_rect(list);
            let response = ui.interact(place.intersect(list), Id::unique(("page-fault", index)), Sense::CLICK);
            let words = fault_text(view, &faults[index]);
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &words));
            card(painter, place, view.theme.surface, view.theme.line);
            painter.rect_filled(Rect::from_min_size(place.min, vec2(4.0, place.height())), 0.0, view.theme.alarm);
            paragraph(painter, place.shrink2(vec2(10.0, 3.0)), &words, theme::SMALL, view.theme.alarm_text);
            let (reached, entered) = page.walk.item();
            if reached {
                focus_frame(painter, place, view.theme.focus);
            }
            if response.clicked() || entered {
                chosen = Some(index);
            }
        });
        if let Some(fault) = chosen.map(|index| &faults[index]) {
            self.document.move_to(fault.line as usize - 1, fault.column as usize - 1);
            (self.position.scroll.user_scrolled, self.keys_focused) = (false, false);
        }
    }

    /// A scrolling list; `one` draws a row, given the list's and the row's rectangle.
    fn scroll_list(
        &mut self,
        ui: &Ui,
        rect: Rect,
        view: &View<'_>,
        count: usize,
        mut one: impl FnMut(&mut Self, &Ui, (Rect, Rect), usize),
    ) {
        let list = round_to_lines(rect, ROW_HEIGHT);
        let mut scroll = self.list;
        let (first, last) = scroll.handle_input(ui, "page-list", list, ROW_HEIGHT, count);
        for index in first..last.min(count) {
            let top = list.min.y + ((index as f64 - scroll.top) * f64::from(ROW_HEIGHT)) as f32;
            let place = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width() - 8.0, ROW_HEIGHT - 4.0));
            let response = ui.interact(place.intersect(list), Id::unique(("page-row", index)), Sense::CLICK);
            if response.clicked() {
                self.selected_row = index;
            }
            one(self, ui, (list, place), index);
        }
        scroll.draw_bar(ui, view, list, ROW_HEIGHT, count);
        self.list = scroll;
    }
}

fn fault_text(view: &View<'_>, fault: &PageTextFault) -> String {
    let said = fault.message.get(view.lang);
    let (line, column) = (fault.line, fault.column);
    match view.lang {
        crate::defs::text::Lang::Zh => format!("第{line}行 第{column}列：{said}"),
        crate::defs::text::Lang::En => format!("line {line}, column {column}: {said}"),
    }
}

/// Paints the card of a row, framed if selected; returns a painter clipped to the list.
fn row_plate(ui: &Ui, view: &View<'_>, (list, place): (Rect, Rect), chosen: bool) -> egui::Painter {
    let painter = ui.painter().with_clip_rect(list);
    card(&painter, place, if chosen { view.theme.raised } else { view.theme.surface }, view.theme.line);
    if chosen {
        focus_frame(&painter, place, view.theme.focus);
    }
    painter
}

impl DesignerPage {
    /// Number, use by the program, label on the page; true when it is to be added.
    fn variable_row(
        &mut self,
        ui: &Ui,
        view: &View<'_>,
        places: (Rect, Rect),
        index: usize,
        row: &VariableRow,
    ) -> bool {
        let mut row_place = places.1;
        if row.missing {
            row_place.max.x -= KEY_WIDTH + theme::GAP;
        }
        let painter = &row_plate(ui, view, (places.0, row_place), self.selected_row == index);
        let inside = places.1.shrink2(vec2(10.0, 3.0));
        let (number, rest) = inside.split_left_right_at_x(inside.min.x + 56.0);
        let name = variable_name::variable_name_on(u32::from(row.variable), view.snapshot.kind);
        let ink = if row.missing { view.theme.alarm_text } else { view.theme.macros };
        fit_text(painter, number, Align2::LEFT_CENTER, &name, theme::TITLE, ink);
        let room = row_place.max.x - 10.0;
        let words = Rect::from_min_max(rest.min, pos2(room, rest.max.y));
        let (top, below) = words.split_top_bottom_at_fraction(0.52);
        let (label, ink) = match (&row.label, row.elsewhere) {
            (Some(label), _) => (label.clone(), view.theme.text),
            (None, Some(page)) => {
                (format!("{} C{:04}.TXT", view.text("在页面", "on the page"), page % 1_000), view.theme.text)
            }
            (None, None) if row.missing => {
                (view.text("页面上没有", "not on the page").to_owned(), view.theme.alarm_text)
            }
            (None, None) => (view.text("程序内部使用", "the program's own").to_owned(), view.theme.muted),
        };
        fit_text(painter, top, Align2::LEFT_CENTER, &label, theme::LABEL, ink);
        let how = match (row.reads, row.writes) {
            (true, true) => view.text("读写", "read, written"),
            (true, false) => view.text("读", "read"),
            (false, true) => view.text("写", "written"),
            (false, false) => view.text("程序没有用", "not used by the program"),
        };
        let place = row.place.map_or_else(String::new, |(program, line)| match view.lang {
            crate::defs::text::Lang::Zh => format!(" · {} 第{line}行", view.snapshot.title(program)),
            crate::defs::text::Lang::En => format!(" · {} line {line}", view.snapshot.title(program)),
        });
        let words = if row.comment.is_empty() { String::new() } else { format!(" · {}", row.comment) };
        fit_text(painter, below, Align2::LEFT_CENTER, &format!("{how}{place}{words}"), theme::SMALL, view.theme.muted);
        let key =
            Rect::from_min_max(pos2(row_place.max.x + theme::GAP, places.1.min.y), places.1.max).intersect(places.0);
        row.missing
            && key.height() > 20.0
            && self.key(
                ui,
                view,
                key,
                (&format!("add-{index}-{name}"), view.text("加入", "ADD")),
                ButtonState::default(),
            )
    }

    /// Name, folder and size of a picture; true when it is to be used.
    fn picture_row(
        &mut self,
        ui: &Ui,
        view: &View<'_>,
        places: (Rect, Rect),
        index: usize,
        file: &PictureFile,
    ) -> bool {
        let row_place = Rect::from_min_max(places.1.min, places.1.max - vec2(KEY_WIDTH + theme::GAP, 0.0));
        let painter = &row_plate(ui, view, (places.0, row_place), self.selected_row == index);
        let words = row_place.shrink2(vec2(10.0, 3.0));
        let (top, below) = words.split_top_bottom_at_fraction(0.52);
        fit_text(painter, top, Align2::LEFT_CENTER, &file.name, theme::LABEL, view.theme.text);
        let from = match file.location {
            PictureLocation::Medium => view.text("U 盘", "USB stick"),
            PictureLocation::Screens => view.text("screens 目录", "folder screens"),
        };
        let size = format!("{from} · {:.0} kB", file.size as f64 / 1_024.0);
        fit_text(painter, below, Align2::LEFT_CENTER, &size, theme::SMALL, view.theme.muted);
        let key =
            Rect::from_min_max(pos2(row_place.max.x + theme::GAP, places.1.min.y), places.1.max).intersect(places.0);
        key.height() > 20.0
            && self.key(ui, view, key, (&format!("take-{index}"), view.text("换用", "TAKE")), ButtonState::default())
    }
}
