//! Drawing of the page designer: the text with its errors, the preview, the lists beside it.
//! Source: spec H4, K7.2–K7.4.

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, TextureId, Ui, WidgetInfo, pos2, vec2};

use super::acts::VariableRow;
use super::{About, Designer};
use crate::defs::page::Page;
use crate::defs::r_parameter;
use crate::defs::screen::TextFault;
use crate::defs::text::{Said, Text};
use crate::hmi::page::program::listing::{self, Mark};
use crate::hmi::page::{empty, grinding};
use crate::hmi::question::Question;
use crate::hmi::view::{View, card, fit, frame, paragraph, put};
use crate::hmi::widget::{self, Look, whole_lines};
use crate::hmi::{frame as lines, pictogram, theme};
use crate::link::Command;
use crate::link::page_file::{PictureFile, PictureFrom};

/// Height of a row of a list.
const ROW: f32 = 50.0;
/// Width of the key in a row.
const KEY: f32 = 76.0;
/// Width of the line number of the text.
const NUMBER: f32 = 40.0;

/// The program has no page.
pub fn no_page(ui: &Ui, rect: Rect, view: &View<'_>, number: u32, out: &mut Vec<Command>) {
    let what = match number {
        0 => view.say("没有装入程序", "no program is loaded").to_owned(),
        _ => format!("{} {}", view.snapshot.title(number), view.say("没有磨削页面", "has no grinding page")),
    };
    let remedy = view.say(
        "只有 O1001–O1020 有页面。请在目录中选择其中一个。",
        "Only O1001 to O1020 have one. Choose one of them in the directory.",
    );
    empty::show(ui, view, rect, pictogram::NO_PAGE, &what, remedy);
    let key = Rect::from_center_size(pos2(rect.center().x, rect.min.y + rect.height() * 0.72), vec2(200.0, 52.0));
    if widget::push(ui, view, key, "to-directory", view.say("打开目录", "DIRECTORY"), Look::default()) {
        out.push(Command::OpenPage(Page::Directory));
    }
}

impl Designer {
    pub(super) fn title(&self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let (line, column) = self.document.place();
        let words = format!("{} {}:{}", view.say("行", "line"), line + 1, column + 1);
        let right = put(ui.painter(), rect, Align2::RIGHT_CENTER, &words, theme::LABEL, view.theme.quiet);
        let name = self.file.as_ref().map_or("", |file| file.name.as_str());
        let of = match view.snapshot.own_page {
            Some(_) => Page::Grinding.title_on(view.snapshot.kind).get(view.lang).to_owned(),
            None => view.snapshot.title(self.document.number),
        };
        let title = format!("{name} · {of}");
        let place = Rect::from_min_max(rect.min, pos2(rect.min.x + 260.0, rect.max.y));
        lines::title(ui, view, place, &title);
        let fresh = self.file.as_ref().is_some_and(|file| file.stamp == 0);
        let (words, ink) = if self.document.changed {
            (view.say("未保存", "not saved"), view.theme.hold)
        } else if self.editing {
            (view.say("编辑", "editing"), view.theme.info)
        } else if fresh {
            (view.say("还没有这个文件", "no such file yet"), view.theme.hold)
        } else {
            return;
        };
        let place = Rect::from_min_max(pos2(place.max.x, rect.min.y), pos2(right.min.x - theme::GAP, rect.max.y));
        fit(ui.painter(), place, Align2::LEFT_CENTER, words, theme::LABEL, ink);
    }

    fn fault(&self, row: usize) -> Option<&TextFault> {
        self.reading.faults.iter().find(|fault| fault.line as usize == row + 1)
    }

    /// The text; a line with an error has a red bar.
    pub(super) fn listing(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, pages: i32) {
        card(ui.painter(), rect, view.theme.surface, view.theme.line);
        if self.editing {
            frame(ui.painter(), rect, view.theme.focus);
        }
        let (list, height) = (whole_lines(rect.shrink2(vec2(3.0, 4.0)), Self::line()), Self::line());
        let count = self.document.lines();
        if pages != 0 {
            self.place.scroll.page(pages, list, height);
        }
        let (line, column) = self.document.place();
        if !self.place.scroll.by_hand {
            self.place.scroll.show(line, list, height);
            let room = list.width() - NUMBER;
            self.place.follow_cursor(ui.painter(), &self.document.rope, (line, column), room);
        }
        let tap = ui.interact(list, Id::unique("page-text"), Sense::CLICK);
        tap.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "page-text"));
        let (first, last) = self.place.scroll.follow(ui, "page-lines", list, height, count);
        self.place.drag(ui, "page-lines", &self.document.rope, first..last.min(count));
        let shift = listing::NUMBER - NUMBER;
        if tap.clicked()
            && let Some(at) = tap.interact_pointer_pos()
        {
            let row = (f64::from((at.y - list.min.y) / height) + self.place.scroll.top).floor().max(0.0) as usize;
            if row < count {
                let x = at.x - list.min.x - NUMBER;
                let column = listing::column_at(ui.painter(), view, &self.document.rope, (row, self.place.left), x);
                self.document.go(row, column);
                self.on_keys = false;
            }
        }
        let painter = &ui.painter().with_clip_rect(list);
        for row in first..last.min(count) {
            let top = list.min.y + ((row as f64 - self.place.scroll.top) * f64::from(height)) as f32;
            // Page texts need two-digit line numbers only; the unused width lies left of the list.
            let place = Rect::from_min_max(pos2(list.min.x - shift, top), pos2(list.max.x - 8.0, top + height));
            let cursor = (self.editing && row == line).then_some(column);
            let mark = Mark { wrong: false, cursor, ..Mark::default() };
            listing::row(painter, place, view, &self.document.rope, (row, self.place.left), mark);
            if self.fault(row).is_some() {
                let bar = Rect::from_min_size(pos2(list.min.x, top), vec2(4.0, height));
                painter.rect_filled(bar, 0.0, view.theme.alarm);
            }
        }
        self.place.scroll.bar(ui, view, list, height, count);
    }

    /// Message line: last message, bad encoding, error in the cursor's line or else the first one, or format correct.
    pub(super) fn told(&self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let faults = &self.reading.faults;
        let of_file = self.file.as_ref().is_some_and(|file| file.mistaken);
        let (words, ink) = if let Some((said, refused)) = &self.told {
            (said.get(view.lang).to_owned(), if *refused { view.theme.alarm_text } else { view.theme.text })
        } else if of_file {
            let words = view.say("含有不是 GBK 或 UTF-8 的字节：只能查看", "bytes neither GBK nor UTF-8: shown only");
            (words.to_owned(), view.theme.hold)
        } else if let Some(fault) = self.fault(self.document.place().0).or(faults.first()) {
            (fault_words(view, fault), view.theme.alarm_text)
        } else if self.file.is_some() {
            (view.say("文字符合格式", "the text is of the format").to_owned(), view.theme.quiet)
        } else {
            return;
        };
        fit(ui.painter(), rect.shrink2(vec2(4.0, 0.0)), Align2::LEFT_CENTER, &words, theme::LABEL, ink);
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
            let words =
                view.say("程序不在目录中：不知道它用哪些变量", "the program is not there: its variables are not known");
            paragraph(ui.painter(), rect.shrink(theme::PAD), words, theme::LABEL, view.theme.hold);
        }
        let mut added = None;
        self.list_of(ui, rect, view, rows.len(), |page, ui, places, index| {
            if page.variable_row(ui, view, places, index, &rows[index]) {
                added = Some(index);
            }
        });
        if let Some(index) = added {
            self.add(view, &rows[index]);
        }
    }

    /// Available pictures.
    pub(super) fn picture_list(&mut self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let Some(file) = self.file.clone() else { return };
        let (head, rest) = rect.split_top_bottom_at_y(rect.min.y + 66.0);
        let number = self.document.number % 1_000;
        let picture = view.snapshot.screens.find(self.document.number).map(|files| &files.picture);
        let (now, ink) = match picture {
            Some(Ok(_)) => (view.say("符合格式", "of the format").to_owned(), view.theme.text),
            Some(Err(fault)) => (fault.said.get(view.lang).to_owned(), view.theme.alarm_text),
            None => (view.say("没有", "missing").to_owned(), view.theme.hold),
        };
        let line = Rect::from_min_size(head.min, vec2(head.width(), 22.0));
        fit(ui.painter(), line, Align2::LEFT_CENTER, &format!("B{number:04}.BMP: {now}"), theme::LABEL, ink);
        let words = view.say(
            "U 盘或 screens 目录中的 PNG、JPEG、BMP；换用时转换为 200×400、24 位，不足处补白。",
            "PNG, JPEG, BMP of the USB stick or the folder screens; converted to 200×400 in 24 bits, on white.",
        );
        let below = Rect::from_min_max(line.left_bottom() + vec2(0.0, 2.0), head.max);
        paragraph(ui.painter(), below, words, theme::SMALL, view.theme.quiet);
        if file.pictures.is_empty() {
            let words =
                view.say("没有图片：插入 U 盘后再按“图片”", "no pictures: plug a stick in, press PICTURES again");
            paragraph(ui.painter(), rest, words, theme::LABEL, view.theme.hold);
        }
        let mut taken = None;
        self.list_of(ui, rest, view, file.pictures.len(), |page, ui, places, index| {
            if page.picture_row(ui, view, places, index, &file.pictures[index]) {
                taken = Some(index);
            }
        });
        let Some(chosen) = taken.map(|index| &file.pictures[index]) else { return };
        if !self.editing {
            return self.refuse(Said::new("先按“编辑”", "press EDIT first"));
        }
        let name = &chosen.name;
        let body = Said::new(
            format!("B{number:04}.BMP 将换成 {name}。"),
            format!("B{number:04}.BMP will be replaced by {name}."),
        );
        let key = ("question-picture", Text::new("换用", "TAKE"));
        let question = Question::new(Text::new("换图片？", "take the picture?"), body, key);
        self.question.ask(About::Picture(chosen.from, name.clone()), question);
    }

    /// Errors by line; a touch moves the cursor to the line.
    pub(super) fn faults(&mut self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let faults = self.reading.faults.clone();
        if faults.is_empty() {
            let words = view.say("没有错误", "no mistakes");
            paragraph(ui.painter(), rect.shrink(theme::PAD), words, theme::TITLE, view.theme.quiet);
            return;
        }
        let mut chosen = None;
        self.list_of(ui, rect, view, faults.len(), |page, ui, (list, place), index| {
            let painter = &ui.painter().with_clip_rect(list);
            let response = ui.interact(place.intersect(list), Id::unique(("page-fault", index)), Sense::CLICK);
            let words = fault_words(view, &faults[index]);
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &words));
            card(painter, place, view.theme.surface, view.theme.line);
            painter.rect_filled(Rect::from_min_size(place.min, vec2(4.0, place.height())), 0.0, view.theme.alarm);
            paragraph(painter, place.shrink2(vec2(10.0, 3.0)), &words, theme::SMALL, view.theme.alarm_text);
            let (reached, entered) = page.walk.pass();
            if reached {
                frame(painter, place, view.theme.focus);
            }
            if response.clicked() || entered {
                chosen = Some(index);
            }
        });
        if let Some(fault) = chosen.map(|index| &faults[index]) {
            self.document.go(fault.line as usize - 1, fault.column as usize - 1);
            (self.place.scroll.by_hand, self.on_keys) = (false, false);
        }
    }

    /// A scrolling list; `one` draws a row, given the list's and the row's rectangle.
    fn list_of(
        &mut self,
        ui: &Ui,
        rect: Rect,
        view: &View<'_>,
        count: usize,
        mut one: impl FnMut(&mut Self, &Ui, (Rect, Rect), usize),
    ) {
        let list = whole_lines(rect, ROW);
        let mut scroll = self.list;
        let (first, last) = scroll.follow(ui, "page-list", list, ROW, count);
        for index in first..last.min(count) {
            let top = list.min.y + ((index as f64 - scroll.top) * f64::from(ROW)) as f32;
            let place = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width() - 8.0, ROW - 4.0));
            let response = ui.interact(place.intersect(list), Id::unique(("page-row", index)), Sense::CLICK);
            if response.clicked() {
                self.row = index;
            }
            one(self, ui, (list, place), index);
        }
        scroll.bar(ui, view, list, ROW, count);
        self.list = scroll;
    }
}

fn fault_words(view: &View<'_>, fault: &TextFault) -> String {
    let said = fault.said.get(view.lang);
    let (line, column) = (fault.line, fault.column);
    match view.lang {
        crate::defs::text::Lang::Zh => format!("第{line}行 第{column}列：{said}"),
        crate::defs::text::Lang::En => format!("line {line}, column {column}: {said}"),
    }
}

/// Paints the card of a row, framed if selected; returns a painter clipped to the list.
fn plate(ui: &Ui, view: &View<'_>, (list, place): (Rect, Rect), chosen: bool) -> egui::Painter {
    let painter = ui.painter().with_clip_rect(list);
    card(&painter, place, if chosen { view.theme.raised } else { view.theme.surface }, view.theme.line);
    if chosen {
        frame(&painter, place, view.theme.focus);
    }
    painter
}

impl Designer {
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
            row_place.max.x -= KEY + theme::GAP;
        }
        let painter = &plate(ui, view, (places.0, row_place), self.row == index);
        let inside = places.1.shrink2(vec2(10.0, 3.0));
        let (number, rest) = inside.split_left_right_at_x(inside.min.x + 56.0);
        let name = r_parameter::name_on(u32::from(row.variable), view.snapshot.kind);
        let ink = if row.missing { view.theme.alarm_text } else { view.theme.macros };
        fit(painter, number, Align2::LEFT_CENTER, &name, theme::TITLE, ink);
        let room = row_place.max.x - 10.0;
        let words = Rect::from_min_max(rest.min, pos2(room, rest.max.y));
        let (top, below) = words.split_top_bottom_at_fraction(0.52);
        let (label, ink) = match (&row.label, row.elsewhere) {
            (Some(label), _) => (label.clone(), view.theme.text),
            (None, Some(page)) => {
                (format!("{} C{:04}.TXT", view.say("在页面", "on the page"), page % 1_000), view.theme.text)
            }
            (None, None) if row.missing => {
                (view.say("页面上没有", "not on the page").to_owned(), view.theme.alarm_text)
            }
            (None, None) => (view.say("程序内部使用", "the program's own").to_owned(), view.theme.quiet),
        };
        fit(painter, top, Align2::LEFT_CENTER, &label, theme::LABEL, ink);
        let how = match (row.reads, row.writes) {
            (true, true) => view.say("读写", "read, written"),
            (true, false) => view.say("读", "read"),
            (false, true) => view.say("写", "written"),
            (false, false) => view.say("程序没有用", "not used by the program"),
        };
        let place = row.place.map_or_else(String::new, |(program, line)| match view.lang {
            crate::defs::text::Lang::Zh => format!(" · {} 第{line}行", view.snapshot.title(program)),
            crate::defs::text::Lang::En => format!(" · {} line {line}", view.snapshot.title(program)),
        });
        let words = if row.comment.is_empty() { String::new() } else { format!(" · {}", row.comment) };
        fit(painter, below, Align2::LEFT_CENTER, &format!("{how}{place}{words}"), theme::SMALL, view.theme.quiet);
        let key =
            Rect::from_min_max(pos2(row_place.max.x + theme::GAP, places.1.min.y), places.1.max).intersect(places.0);
        row.missing
            && key.height() > 20.0
            && self.key(ui, view, key, (&format!("add-{index}-{name}"), view.say("加入", "ADD")), Look::default())
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
        let row_place = Rect::from_min_max(places.1.min, places.1.max - vec2(KEY + theme::GAP, 0.0));
        let painter = &plate(ui, view, (places.0, row_place), self.row == index);
        let words = row_place.shrink2(vec2(10.0, 3.0));
        let (top, below) = words.split_top_bottom_at_fraction(0.52);
        fit(painter, top, Align2::LEFT_CENTER, &file.name, theme::LABEL, view.theme.text);
        let from = match file.from {
            PictureFrom::Medium => view.say("U 盘", "USB stick"),
            PictureFrom::Screens => view.say("screens 目录", "folder screens"),
        };
        let size = format!("{from} · {:.0} kB", file.size as f64 / 1_024.0);
        fit(painter, below, Align2::LEFT_CENTER, &size, theme::SMALL, view.theme.quiet);
        let key =
            Rect::from_min_max(pos2(row_place.max.x + theme::GAP, places.1.min.y), places.1.max).intersect(places.0);
        key.height() > 20.0
            && self.key(ui, view, key, (&format!("take-{index}"), view.say("换用", "TAKE")), Look::default())
    }
}
