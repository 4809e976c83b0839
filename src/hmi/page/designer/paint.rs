//! Drawing of the page designer: the text with its errors, the preview, the lists beside it.
//! Source: spec H4, K7.2–K7.4.

use egui::{Id, Rect, Sense, pos2, vec2};

use super::actions::VariableRow;
use super::{DesignerPage, DesignerQuestion};
use crate::defs::page::Page;
use crate::defs::page_text::PageTextFault;
use crate::defs::text::{Text, phrase};
use crate::hmi::page::program::actions::EDIT_FIRST;
use crate::hmi::page::program::listing::{self, LineMarks};
use crate::hmi::page::{ScrollList, VisibleRows, empty};
use crate::hmi::{Area, PageKey, Question, View, page_frame as lines, pictogram, round_to_lines, theme, widget};
use crate::link::Command;
use crate::link::page_file::{PictureFile, PictureLocation};

/// Height of a row of a list.
const ROW_HEIGHT: f32 = 50.0;
/// Width of the key in a row.
const KEY_WIDTH: f32 = 76.0;
/// Width of the line number of the text.
const NUMBER_WIDTH: f32 = 40.0;

/// The program has no page.
pub fn no_page(rect: Rect, view: &View<'_>, number: u32, out: &mut Vec<Command>) {
    let what = match number {
        0 => view.text("没有装入程序", "no program is loaded").to_owned(),
        _ => format!("{} {}", view.snapshot.title(number), view.text("没有磨削页面", "has no grinding page")),
    };
    let remedy = view.text(
        "只有 O1001–O1020 有页面。请在目录中选择其中一个。",
        "Only O1001 to O1020 have a page. Choose one of them in the directory.",
    );
    empty::show(view, rect, pictogram::NO_PAGE, &what, remedy);
    let key = Rect::from_center_size(pos2(rect.center().x, rect.min.y + rect.height() * 0.72), vec2(200.0, 52.0));
    if widget::button(view, key, PageKey::new("to-directory", view.text("打开目录", "DIRECTORY"))) {
        out.push(Command::OpenPage(Page::Directory));
    }
}

impl DesignerPage {
    pub(super) fn title(&self, rect: Rect, view: &View<'_>) {
        let (line, column) = self.document.cursor_position();
        let words = format!("{} {}:{}", view.text("行", "line"), line + 1, column + 1);
        let right = view.line_right(rect, &words, theme::LABEL, view.theme.muted);
        let name = self.file.as_ref().map_or("", |file| file.name.as_str());
        let of = match view.snapshot.kind_page {
            Some(_) => Page::Grinding.title_on(view.snapshot.kind).get(view.lang).to_owned(),
            None => view.snapshot.title(self.document.number),
        };
        let title = format!("{name} · {of}");
        let place = rect.with_max_x(rect.min.x + 260.0);
        lines::title(view, place, &title);
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
        view.fit_left(place, words, theme::LABEL, ink);
    }

    fn fault_in_line(&self, row: usize) -> Option<&PageTextFault> {
        self.reading.faults.iter().find(|fault| fault.line as usize == row + 1)
    }

    /// The text; a line with an error has a red bar.
    pub(super) fn listing(&mut self, rect: Rect, view: &View<'_>, pages: i32) {
        view.card(rect);
        if self.editing {
            view.frame(rect, view.theme.focus);
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
            self.position.follow_cursor(&view.painter, &self.document.rope, (line, column), room);
        }
        let rope = self.document.rope.clone();
        let spec = ScrollList { id: "page-text", rect: list, row: height, gap: 0.0, count };
        let (clipped, rows, tapped) = self.position.handle_input(view, &spec, &rope, NUMBER_WIDTH);
        if let Some((line, column)) = tapped {
            self.document.move_to(line, column);
            self.keys_focused = false;
        }
        for (row, place) in rows {
            // Page texts need two-digit line numbers only; the unused width lies left of the list.
            let wide = place.trim_left(NUMBER_WIDTH - listing::NUMBER_WIDTH);
            let cursor = (self.editing && row == line).then_some(column);
            self.position.paint_line(&clipped, wide, &rope, row, LineMarks { cursor, ..LineMarks::default() });
            if self.fault_in_line(row).is_some() {
                clipped.edge_bar(place, view.theme.alarm);
            }
        }
    }

    /// Message line: last message, bad encoding, error in the cursor's line or else the first one, or format correct.
    pub(super) fn message_line(&self, rect: Rect, view: &View<'_>) {
        let faults = &self.reading.faults;
        let of_file = self.file.as_ref().is_some_and(|file| file.has_invalid_bytes);
        let (words, ink) = if let Some(shown) = self.message.shown(view, view.theme.text) {
            shown
        } else if of_file {
            let words = view.text("含有不是 GBK 或 UTF-8 的字节：只能查看", "bytes neither GBK nor UTF-8: view only");
            (words.to_owned(), view.theme.hold)
        } else if let Some(fault) = self.fault_in_line(self.document.cursor_position().0).or(faults.first()) {
            (fault_text(view, fault), view.theme.alarm_text)
        } else if self.file.is_some() {
            (view.text("文字符合格式", "the text format is correct").to_owned(), view.theme.muted)
        } else {
            return;
        };
        view.fit_left(rect.trim_sides(4.0), &words, theme::LABEL, ink);
    }

    /// Variables of program and page.
    pub(super) fn variable_list(&mut self, rect: Rect, view: &View<'_>) {
        let rows = self.variables(view);
        if self.file.as_ref().is_some_and(|file| file.uses.is_none()) {
            let words =
                view.text("程序不在目录中：不知道它用哪些变量", "the program is missing: its variables are not known");
            view.paragraph(rect.shrink(theme::PAD), words, theme::LABEL, view.theme.hold);
        }
        let (clipped, places) = self.visible_rows(rect, view, rows.len());
        for (index, place) in places {
            if self.variable_row(&clipped, place, index, &rows[index]) {
                self.add_variable(view, &rows[index]);
            }
        }
    }

    /// Available pictures.
    pub(super) fn picture_list(&mut self, rect: Rect, view: &View<'_>) {
        let Some(file) = self.file.clone() else { return };
        let (head, rest) = rect.split_top(66.0);
        let number = self.document.number % 1_000;
        let picture = view.snapshot.screens.find(self.document.number).map(|files| &files.picture);
        let (now, ink) = match picture {
            Some(Ok(_)) => (view.text("符合格式", "format correct").to_owned(), view.theme.text),
            Some(Err(fault)) => (fault.message.get(view.lang).into_owned(), view.theme.alarm_text),
            None => (view.text("没有", "missing").to_owned(), view.theme.hold),
        };
        view.fit_left(head.band(0.0, 22.0), &format!("B{number:04}.BMP: {now}"), theme::LABEL, ink);
        let words = view.text(
            "U 盘或 screens 目录中的 PNG、JPEG、BMP；换用时转换为 200×400、24 位，不足处补白。",
            "PNG, JPEG, BMP from the USB stick or the screens folder; converted to 200×400, 24 bit, on white.",
        );
        view.paragraph(head.trim_top(24.0), words, theme::SMALL, view.theme.muted);
        if file.pictures.is_empty() {
            let words =
                view.text("没有图片：插入 U 盘后再按“图片”", "no pictures: plug in a USB stick, press PICTURES again");
            view.paragraph(rest, words, theme::LABEL, view.theme.hold);
        }
        let mut taken = None;
        let (clipped, places) = self.visible_rows(rest, view, file.pictures.len());
        for (index, place) in places {
            if self.picture_row(&clipped, place, index, &file.pictures[index]) {
                taken = Some(index);
            }
        }
        let Some(chosen) = taken.map(|index| &file.pictures[index]) else { return };
        if !self.editing {
            return self.message.refuse(EDIT_FIRST);
        }
        let name = &chosen.name;
        let body =
            phrase!("B{number:04}.BMP 将换成 {name}。", "B{number:04}.BMP will be replaced by {name}.", number, name);
        let key = ("question-picture", Text::new("换用", "USE"));
        let question = Question::new(Text::new("换图片？", "use this picture?"), body, key);
        self.question.ask(DesignerQuestion::Picture(chosen.location, name.clone()), question);
    }

    /// Errors by line; a touch moves the cursor to the line.
    pub(super) fn faults(&mut self, rect: Rect, view: &View<'_>) {
        let faults = self.reading.faults.clone();
        if faults.is_empty() {
            view.paragraph(rect.shrink(theme::PAD), view.text("没有错误", "no errors"), theme::TITLE, view.theme.muted);
            return;
        }
        let mut chosen = None;
        let (view, places) = &self.visible_rows(rect, view, faults.len());
        for &(index, place) in places {
            let words = fault_text(view, &faults[index]);
            let response = view.touch(place, ("page-fault", index), &words);
            view.card(place);
            view.edge_bar(place, view.theme.alarm);
            view.paragraph(place.shrink2(vec2(10.0, 3.0)), &words, theme::SMALL, view.theme.alarm_text);
            let (reached, entered) = self.walk.item();
            if reached {
                view.frame(place, view.theme.focus);
            }
            if response.clicked() || entered {
                chosen = Some(index);
            }
        }
        if let Some(fault) = chosen.map(|index| &faults[index]) {
            self.document.move_to(fault.line as usize - 1, fault.column as usize - 1);
            (self.position.scroll.user_scrolled, self.keys_focused) = (false, false);
        }
    }

    /// The visible rows of the list on the right, index and place, and the view clipped to them. A touched row is selected.
    fn visible_rows<'v>(&mut self, rect: Rect, view: &View<'v>, count: usize) -> (View<'v>, VisibleRows) {
        let rect = round_to_lines(rect, ROW_HEIGHT);
        let list = ScrollList { id: "page-list", rect, row: ROW_HEIGHT, gap: 4.0, count };
        let (clipped, rows) = self.list.rows(view, &list, 0);
        for (index, place) in &rows {
            if view.ui.interact(place.intersect(rect), Id::unique(("page-row", *index)), Sense::CLICK).clicked() {
                self.selected_row = *index;
            }
        }
        (clipped, rows)
    }
}

fn fault_text(view: &View<'_>, fault: &PageTextFault) -> String {
    let cause = fault.message.get(view.lang);
    let (line, column) = (fault.line, fault.column);
    view.phrase(&phrase!(
        "第{line}行 第{column}列：{cause}",
        "line {line}, column {column}: {cause}",
        line,
        column,
        cause
    ))
}

impl DesignerPage {
    /// The key at the end of a row; true if it is touched.
    fn row_key(&mut self, view: &View<'_>, row: Rect, key: PageKey<'_>) -> bool {
        let place = row.split_right(KEY_WIDTH).1.intersect(view.painter.clip_rect());
        place.height() > 20.0 && self.key(view, place, key)
    }

    /// Number, use by the program, label on the page; true when it is to be added.
    fn variable_row(&mut self, view: &View<'_>, place: Rect, index: usize, row: &VariableRow) -> bool {
        let plate = place.trim_right(if row.missing { KEY_WIDTH + theme::GAP } else { 0.0 });
        view.row_card(plate, self.selected_row == index);
        let (number, words) = plate.shrink2(vec2(10.0, 3.0)).split_left(56.0);
        let name = view.variable_name(row.variable);
        let ink = if row.missing { view.theme.alarm_text } else { view.theme.macros };
        view.fit_left(number, &name, theme::TITLE, ink);
        let (top, below) = words.split_top_bottom_at_fraction(0.52);
        let (label, ink) = match (&row.label, row.elsewhere) {
            (Some(label), _) => (label.clone(), view.theme.text),
            (None, Some(page)) => {
                (format!("{} C{:04}.TXT", view.text("在页面", "on the page"), page % 1_000), view.theme.text)
            }
            (None, None) if row.missing => {
                (view.text("页面上没有", "not on the page").to_owned(), view.theme.alarm_text)
            }
            (None, None) => (view.text("程序内部使用", "program internal").to_owned(), view.theme.muted),
        };
        view.fit_left(top, &label, theme::LABEL, ink);
        let how = match (row.reads, row.writes) {
            (true, true) => view.text("读写", "read, written"),
            (true, false) => view.text("读", "read"),
            (false, true) => view.text("写", "written"),
            (false, false) => view.text("程序没有用", "not used by the program"),
        };
        let place_of_use = view.program_line(row.place).map_or_else(String::new, |place| format!(" · {place}"));
        let words = if row.comment.is_empty() { String::new() } else { format!(" · {}", row.comment) };
        view.fit_left(below, &format!("{how}{place_of_use}{words}"), theme::SMALL, view.theme.muted);
        let (name, label) = (format!("add-{index}-{name}"), view.text("加入", "ADD"));
        row.missing && self.row_key(view, place, PageKey::new(&name, label))
    }

    /// Name, folder and size of a picture; true when it is to be used.
    fn picture_row(&mut self, view: &View<'_>, place: Rect, index: usize, file: &PictureFile) -> bool {
        let plate = place.trim_right(KEY_WIDTH + theme::GAP);
        view.row_card(plate, self.selected_row == index);
        let (top, below) = plate.shrink2(vec2(10.0, 3.0)).split_top_bottom_at_fraction(0.52);
        view.fit_left(top, &file.name, theme::LABEL, view.theme.text);
        let from = match file.location {
            PictureLocation::Medium => view.text("U 盘", "USB stick"),
            PictureLocation::Screens => view.text("screens 目录", "screens folder"),
        };
        let size = format!("{from} · {:.0} kB", file.size as f64 / 1_024.0);
        view.fit_left(below, &size, theme::SMALL, view.theme.muted);
        let (name, label) = (format!("take-{index}"), view.text("换用", "USE"));
        self.row_key(view, place, PageKey::new(&name, label))
    }
}
