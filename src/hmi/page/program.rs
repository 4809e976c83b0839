//! The program page: the listing with the running block marked. Long programs stay fluid: their line starts are found
//! once, and only the visible lines are laid out.
//! Source: spec B6, K7.

use std::sync::Arc;

use egui::{Align2, Painter, Rect, Ui, pos2, vec2};

use super::empty;
use super::scroll::Scroll;
use crate::hmi::view::{View, card, fit, line, put};
use crate::hmi::{frame as lines, pictogram, theme};
use crate::link::Command;

/// Height of a line.
const LINE: f32 = 28.0;

/// What the page keeps: where it stands, and where the lines of the text begin.
#[derive(Debug, Default)]
pub struct Listing {
    scroll: Scroll,
    text: Arc<str>,
    starts: Vec<u32>,
    line: u32,
}

impl Listing {
    /// Draws the page; `pages` come from the keyboard.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, pages: i32) -> Vec<Command> {
        let program = &view.snapshot.program;
        if program.number == 0 {
            let remedy = view.say("按“目录”选择一个程序并装入。", "Choose a program in the directory and load it.");
            empty::show(ui, view, rect, pictogram::NO_PAGE, view.say("没有装入程序", "no program is loaded"), remedy);
            return Vec::new();
        }
        self.read(&program.text);
        let inside = rect.shrink(theme::PAD);
        let (title, list) = inside.split_top_bottom_at_y(inside.min.y + 34.0);
        lines::title(ui, view, title, &view.snapshot.title(program.number));
        let place = format!("{} {} / {}", view.say("行", "line"), program.line, self.starts.len());
        put(ui.painter(), title, Align2::RIGHT_CENTER, &place, theme::LABEL, view.theme.quiet);
        card(ui.painter(), list, view.theme.surface, view.theme.line);
        let list = list.shrink2(vec2(2.0, 4.0));
        let in_subprogram = program.block_program != 0 && program.block_program != program.number;
        if program.line != self.line {
            self.line = program.line;
            self.scroll.by_hand = false;
        }
        if !self.scroll.by_hand && program.line > 0 && !in_subprogram {
            self.scroll.show(program.line as usize - 1, list, LINE);
        }
        if pages != 0 {
            self.scroll.page(pages, list, LINE);
        }
        let (first, last) = self.scroll.follow(ui, "listing", list, LINE, self.starts.len());
        for row in first..last {
            let top = list.min.y + ((row as f64 - self.scroll.top) * f64::from(LINE)) as f32;
            let place = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width() - 8.0, LINE));
            let running = !in_subprogram && row + 1 == program.line as usize;
            self.row(&ui.painter().with_clip_rect(list), place, view, row, running);
        }
        self.scroll.bar(ui, view, list, LINE, self.starts.len());
        if in_subprogram {
            let words = format!(
                "{} {}",
                view.say("正在执行子程序", "running subprogram"),
                view.snapshot.title(program.block_program)
            );
            put(ui.painter(), title, Align2::CENTER_CENTER, &words, theme::LABEL, view.theme.info);
        }
        Vec::new()
    }

    /// The running block and its neighbours, in as many lines as there is room for.
    pub fn strip(&mut self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let program = &view.snapshot.program;
        let count = ((rect.height() - 8.0) / LINE).floor().max(0.0) as usize;
        let elsewhere = program.block_program != 0 && program.block_program != program.number;
        if count < 2 || program.number == 0 || elsewhere {
            return;
        }
        self.read(&program.text);
        card(ui.painter(), rect, view.theme.surface, view.theme.line);
        let first = (program.line as usize).saturating_sub(1 + count / 3);
        for (index, row) in (first..self.starts.len().min(first + count)).enumerate() {
            let corner = pos2(rect.min.x + 2.0, rect.min.y + 4.0 + index as f32 * LINE);
            let place = Rect::from_min_size(corner, vec2(rect.width() - 4.0, LINE));
            self.row(&ui.painter().with_clip_rect(rect), place, view, row, row + 1 == program.line as usize);
        }
    }

    /// Finds the lines of a text that has changed.
    fn read(&mut self, text: &Arc<str>) {
        if Arc::ptr_eq(text, &self.text) && !self.starts.is_empty() {
            return;
        }
        self.text = Arc::clone(text);
        self.starts.clear();
        self.starts.push(0);
        let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(index, _)| index as u32 + 1);
        self.starts.extend(ends.filter(|start| (*start as usize) < text.len()));
        self.scroll = Scroll::default();
    }

    fn row(&self, painter: &Painter, place: Rect, view: &View<'_>, row: usize, running: bool) {
        if running {
            painter.rect_filled(place, theme::RADIUS, view.theme.raised);
            let mark = Rect::from_min_size(place.min, vec2(4.0, place.height()));
            painter.rect_filled(mark, 0.0, view.theme.run);
        }
        let (number, words) = place.split_left_right_at_x(place.min.x + 68.0);
        let number = Rect::from_min_max(number.min, number.max - vec2(theme::PAD, 0.0));
        fit(painter, number, Align2::RIGHT_CENTER, &(row + 1).to_string(), theme::SMALL, view.theme.quiet);
        let start = self.starts.get(row).copied().unwrap_or(0) as usize;
        let end = self.starts.get(row + 1).map_or(self.text.len(), |end| *end as usize);
        // What no screen is wide enough for is not laid out either.
        let text: String = self.text.get(start..end).unwrap_or_default().trim_end().chars().take(200).collect();
        let remark = text.trim_start().starts_with(['(', ';', '%']) || text.trim_start().starts_with("//");
        let ink = if remark { view.theme.quiet } else { view.theme.text };
        let galley = line(painter, &text.replace('\t', "  "), theme::TITLE - 1.0, ink, words.width());
        let top = words.center().y - galley.size().y / 2.0;
        painter.galley(pos2(words.min.x, top.round()), galley, ink);
    }
}
