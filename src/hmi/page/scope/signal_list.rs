//! The list from which the signal of a channel is chosen.

use egui::{Rect, vec2};

use crate::defs::scope_signal::ScopeSignal;
use crate::hmi::page::{Scroll, ScrollList};
use crate::hmi::{Area, EditKey, KeyboardInput, PageKey, View, theme, widget};

/// Height of a row and number of columns.
const ROW_HEIGHT: f32 = 46.0;
const COLUMNS: usize = 3;

/// What the operator did.
pub enum Answer {
    /// Nothing yet.
    Open,
    /// The signal; none: the channel is empty.
    Chosen(Option<ScopeSignal>),
    /// The channel stays as it is.
    Cancelled,
}

/// State of the list.
#[derive(Debug)]
pub struct SignalList {
    chosen: Option<ScopeSignal>,
    cursor: Option<usize>,
    scroll: Scroll,
    /// The list has been drawn.
    is_shown: bool,
}

impl SignalList {
    /// A list with the signal that the channel has.
    pub fn new(chosen: Option<ScopeSignal>) -> Self {
        Self { chosen, cursor: None, scroll: Scroll::default(), is_shown: false }
    }

    /// Draws the list over the page.
    pub fn ui(&mut self, rect: Rect, view: &View<'_>, typed: &KeyboardInput) -> Answer {
        let (body, keys) = rect.shrink2(vec2(theme::PAD, 6.0)).split_bottom(widget::KEYS_HEIGHT);
        let (heading, body) = body.trim_bottom(theme::GAP).split_top(30.0);
        view.fit_left(heading, view.text("选一个信号", "choose a signal"), theme::TITLE, view.theme.text);
        let fitted = view.snapshot.fitted();
        let signals: Vec<ScopeSignal> = ScopeSignal::of(fitted).collect();
        let rows = signals.len().div_ceil(COLUMNS);
        let rect = widget::round_to_lines(body, ROW_HEIGHT);
        let chosen = self.chosen.and_then(|chosen| signals.iter().position(|signal| *signal == chosen));
        if !self.is_shown {
            self.scroll.reveal(chosen.unwrap_or(0) / COLUMNS, rect, ROW_HEIGHT);
            self.is_shown = true;
        }
        for edit in &typed.edits {
            // Behind the signals stands the key for none.
            let at = self.cursor.or(chosen).unwrap_or(0);
            if let Some(next) = edit.step(at, signals.len() + 1, COLUMNS) {
                self.cursor = Some(next);
                self.scroll.reveal(next.min(signals.len() - 1) / COLUMNS, rect, ROW_HEIGHT);
            }
            match (edit, self.cursor) {
                (EditKey::Cancel, _) => return Answer::Cancelled,
                (EditKey::Enter, Some(at)) => return Answer::Chosen(signals.get(at).copied()),
                _ => {}
            }
        }
        let list = ScrollList { id: "scope-signals", rect, row: ROW_HEIGHT, gap: 0.0, count: rows };
        let clipped = view.clipped(rect);
        for (row, place) in self.scroll.visible_rows(view, &list, typed.scroll_pages) {
            for column in 0..COLUMNS {
                let index = row * COLUMNS + column;
                let Some(signal) = signals.get(index) else { break };
                let cell = place.trim_bottom(4.0).cell(column, COLUMNS);
                let name = signal.name(fitted);
                let (id, label) = (signal.id(), name.get(view.lang));
                let key = PageKey::new(&id, &label).on(self.chosen == Some(*signal));
                let touched = widget::button(&clipped, cell, key);
                if self.cursor == Some(index) {
                    clipped.frame(cell, view.theme.focus);
                }
                if touched {
                    return Answer::Chosen(Some(*signal));
                }
            }
        }
        self.scroll.draw_bar(view, rect, ROW_HEIGHT, rows);
        let none = PageKey::new("scope-no-signal", view.text("无信号", "NO SIGNAL"));
        let back = PageKey::new("scope-back", view.text("返回", "BACK"));
        if self.cursor == Some(signals.len()) {
            view.frame(keys.cell(0, 2), view.theme.focus);
        }
        if widget::button(view, keys.cell(0, 2), none) {
            return Answer::Chosen(None);
        }
        if widget::button(view, keys.cell(1, 2), back) {
            return Answer::Cancelled;
        }
        Answer::Open
    }
}
