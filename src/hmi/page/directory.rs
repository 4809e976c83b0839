//! The directory: every program with size, comment and date; one is chosen by touch and loaded by a key of its own.
//! Source: spec B6. A swipe scrolls and never loads (H9).

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use super::empty;
use super::scroll::Scroll;
use crate::hmi::entry::Edit;
use crate::hmi::keycap::{self, Face};
use crate::hmi::view::{View, card, fit, frame, put};
use crate::hmi::{frame as lines, pictogram, theme};
use crate::link::Command;
use crate::link::snapshot::{DirectoryRow, RunState};

/// Height of a row.
const ROW: f32 = 50.0;

/// What the page keeps.
#[derive(Debug, Default)]
pub struct Directory {
    scroll: Scroll,
    cursor: usize,
}

impl Directory {
    /// Draws the page.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, edits: &[Edit], pages: i32) -> Vec<Command> {
        let rows = view.snapshot.directory.as_slice();
        if rows.is_empty() {
            let remedy = view.say(
                "把程序 O1001.NC … 拷贝到 programs 目录。",
                "Copy programs (O1001.NC …) into the folder programs.",
            );
            empty::show(ui, view, rect, pictogram::NO_PAGE, view.say("没有程序", "no programs"), remedy);
            return Vec::new();
        }
        let inside = rect.shrink(theme::PAD);
        let (title, list) = inside.split_top_bottom_at_y(inside.min.y + 34.0);
        lines::title(ui, view, title, view.say("程序目录", "programs"));
        put(ui.painter(), title, Align2::RIGHT_CENTER, &rows.len().to_string(), theme::LABEL, view.theme.quiet);
        card(ui.painter(), list, view.theme.surface, view.theme.line);
        let list = list.shrink(4.0);
        let mut load = false;
        for edit in edits {
            match edit {
                Edit::Up | Edit::Previous => self.cursor = self.cursor.saturating_sub(1),
                Edit::Down | Edit::Next => self.cursor += 1,
                Edit::Enter => load = true,
                Edit::Char(_) | Edit::Sign | Edit::Back | Edit::Cancel | Edit::Left | Edit::Right => continue,
            }
            self.cursor = self.cursor.min(rows.len() - 1);
            self.scroll.show(self.cursor, list, ROW);
        }
        self.cursor = self.cursor.min(rows.len() - 1);
        if pages != 0 {
            self.scroll.page(pages, list, ROW);
        }
        let (first, last) = self.scroll.follow(ui, "directory", list, ROW, rows.len());
        for (index, row) in rows.iter().enumerate().take(last).skip(first) {
            let top = list.min.y + ((index as f64 - self.scroll.top) * f64::from(ROW)) as f32;
            let place = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width() - 8.0, ROW - 4.0));
            load |= self.row(ui, list, place, view, (index, row));
        }
        self.scroll.bar(ui, view, list, ROW, rows.len());
        let chosen = rows.get(self.cursor).filter(|_| load);
        chosen.map(|row| Command::LoadProgram(row.number)).into_iter().collect()
    }

    fn row(&mut self, ui: &Ui, list: Rect, place: Rect, view: &View<'_>, row: (usize, &DirectoryRow)) -> bool {
        let (index, row) = row;
        let painter = &ui.painter().with_clip_rect(list);
        let current = row.number == view.snapshot.program.number;
        let chosen = index == self.cursor;
        let response = ui.interact(place.intersect(list), Id::unique(("program", index)), Sense::CLICK);
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, row.name.clone()));
        if response.clicked() {
            self.cursor = index;
        }
        if chosen {
            painter.rect_filled(place, theme::RADIUS, view.theme.raised);
            frame(painter, place, view.theme.focus);
        }
        let inside = place.shrink2(vec2(theme::PAD, 3.0));
        let (number, rest) = inside.split_left_right_at_x(inside.min.x + 88.0);
        let ink = if current { view.theme.run } else { view.theme.text };
        fit(painter, number, Align2::LEFT_CENTER, &row.name, theme::SECONDARY, ink);
        let (rest, action) = rest.split_left_right_at_x(rest.max.x - 96.0);
        let (comment, facts) = rest.split_left_right_at_x(rest.max.x - 210.0);
        let comment = Rect::from_min_max(comment.min, comment.max - vec2(theme::PAD, 0.0));
        fit(painter, comment, Align2::LEFT_CENTER, &row.comment, theme::LABEL, view.theme.text);
        let (size, date) = facts.split_left_right_at_fraction(0.34);
        put(painter, size, Align2::RIGHT_CENTER, &kilobytes(row.size), theme::LABEL, view.theme.quiet);
        let date = Rect::from_min_max(date.min, date.max - vec2(theme::PAD, 0.0));
        fit(painter, date, Align2::RIGHT_CENTER, &row.modified, theme::LABEL, view.theme.quiet);
        if current {
            fit(painter, action, Align2::RIGHT_CENTER, view.say("当前", "CURRENT"), theme::LABEL, view.theme.run);
            return false;
        }
        chosen && load_key(ui, action, view)
    }

    /// Brings the current program back into sight when the page opens.
    pub fn open(&mut self, view: &View<'_>) {
        let number = view.snapshot.program.number;
        self.cursor = view.snapshot.directory.iter().position(|row| row.number == number).unwrap_or(0);
    }
}

fn kilobytes(bytes: u64) -> String {
    if bytes < 1_024 { format!("{bytes} B") } else { format!("{:.1} kB", bytes as f64 / 1_024.0) }
}

/// 装入: the only place that loads by touch. The core says no while a program runs.
fn load_key(ui: &Ui, action: Rect, view: &View<'_>) -> bool {
    let place = Rect::from_center_size(action.center() + vec2(2.0, 0.0), vec2(96.0, theme::TARGET));
    let response = ui.interact(place, Id::unique("load"), Sense::CLICK);
    let words = view.say("装入", "LOAD");
    let running = matches!(view.snapshot.state, RunState::Running | RunState::Held | RunState::Waiting);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, !running, format!("{words} load-program")));
    let face = Face { pressed: response.is_pointer_button_down_on(), blocked: running, ..Face::default() };
    keycap::plate(ui.painter(), view.theme, place, face);
    frame(ui.painter(), place, if running { view.theme.line } else { view.theme.focus });
    let ink = if running { view.theme.dim } else { view.theme.text };
    fit(ui.painter(), place, Align2::CENTER_CENTER, words, theme::TITLE, ink);
    response.clicked()
}
