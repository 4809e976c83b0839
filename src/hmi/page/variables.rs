//! Macro variables by number, with the labels of the current page text; a variable can be found by its number.
//! Source: spec B6, B3, K7.3, K7.5, K7.7.

use egui::{Rect, vec2};

use super::{HandOver, InputPrompt, PageContext, PageUi, Scroll, ScrollList, input_line};
use crate::defs::page::Page;
use crate::defs::param;
use crate::defs::text::Text;
use crate::hmi::{
    Area, CoreAnswer, EditKey, FieldEditor, KeycapState, ValueField, View, keycap, theme, variable_entry, widget,
};
use crate::link::Command;
use crate::link::edit::LOCKED_IN_RUN;

/// Ranges of the list: first and last variable.
pub const RANGES: [(u16, u16); 4] = [(100, 199), (200, 433), (434, 439), (500, 999)];

/// State of the page.
#[derive(Debug, Default)]
pub struct VariablesPage {
    /// What is being typed: a value, or a number to find.
    typing: FieldEditor,
    scroll: Scroll,
    /// The selected variable; 0 until one is selected.
    selected: u16,
    /// Shows only variables of the current page text.
    only_labelled: bool,
    /// A number to find is being typed.
    searching: bool,
    /// Variables per line, as last drawn.
    columns: usize,
}

/// Variables that the control sets (K4).
const fn is_read_only(variable: u16) -> bool {
    matches!(variable, 434..=439)
}

impl PageUi for VariablesPage {
    /// Selection and filter stay, unless a variable was handed over.
    fn open(&mut self, _view: &View<'_>, handed_over: Option<HandOver>) {
        let handed_over = handed_over.and_then(HandOver::variable);
        let (selected, only_labelled) =
            handed_over.map_or((self.selected, self.only_labelled), |variable| (variable, false));
        *self = Self { selected, only_labelled, ..Self::default() };
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(&self.typing)
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, out, .. } = ctx;
        let numbers = self.numbers(view);
        if !numbers.contains(&self.selected) {
            self.selected = numbers.first().copied().unwrap_or(0);
        }
        self.typing.follow_lock(view.snapshot);
        if let CoreAnswer::Refused(field) = self.typing.poll_answer(&view.snapshot.edit_answer) {
            self.selected = field as u16; // cut: it was a variable's number
            self.searching = false;
        }
        if typed.text.contains(['#', '/']) {
            self.begin_search();
        }
        typed.edits.iter().for_each(|edit| self.edit(*edit, &numbers, out));
        let (page, input) = input_line::split(rect);
        let (top, rest) = page.shrink(theme::PAD).split_top(widget::KEYS_HEIGHT);
        self.tabs(top, view);
        let (note, list) = rest.split_top(28.0);
        head(note, view);
        self.columns = if list.width() > 860.0 { 3 } else { 2 };
        self.list(widget::round_to_lines(list, widget::ROW_HEIGHT), view, typed.scroll_pages, &numbers);
        self.input(input, view);
    }
}

impl VariablesPage {
    /// The listed variables.
    fn numbers(&self, view: &View<'_>) -> Vec<u16> {
        if self.only_labelled {
            let mut found: Vec<u16> = page_rows(view).map(|row| row.variable).collect();
            found.sort_unstable();
            found.dedup();
            if !found.is_empty() {
                return found;
            }
        }
        RANGES.iter().flat_map(|(first, last)| *first..=*last).collect()
    }

    fn begin_search(&mut self) {
        self.typing.clear();
        self.searching = true;
    }

    fn edit(&mut self, edit: EditKey, numbers: &[u16], out: &mut Vec<Command>) {
        self.typing.clear_refused(edit);
        if self.searching && edit == EditKey::Cancel {
            self.searching = false;
            return self.typing.clear();
        }
        if self.typing.handle_key(edit) {
            return;
        }
        let Some(here) = numbers.iter().position(|number| *number == self.selected) else { return };
        match (edit.step(here, numbers.len(), self.columns), edit) {
            (Some(at), _) => self.go(numbers[at]),
            (None, EditKey::Enter) if self.searching => self.find(),
            (None, EditKey::Enter) => self.enter(numbers[(here + 1) % numbers.len()], out),
            (None, _) => {}
        }
    }

    fn go(&mut self, variable: u16) {
        self.selected = variable;
        self.typing.clear();
        self.searching = false;
        self.scroll.user_scrolled = false;
    }

    /// Selects the typed number, wherever it is listed.
    fn find(&mut self) {
        let number = self.typing.text.parse().ok();
        match number.filter(|number| RANGES.iter().any(|(first, last)| (*first..=*last).contains(number))) {
            Some(number) => {
                self.only_labelled = false;
                self.go(number);
            }
            None => {
                let none =
                    Text::new("没有此变量：#100–#439、#500–#999", "no such variable: #100 to #439, #500 to #999");
                self.typing.refused = Some(none.into());
            }
        }
    }

    fn enter(&mut self, next: u16, out: &mut Vec<Command>) {
        if self.typing.text.is_empty() {
            return self.go(next);
        }
        match variable_entry::parse_value(self.selected, &self.typing.text) {
            Ok(value) => {
                self.typing.send(usize::from(self.selected));
                out.push(Command::EnterVariable(self.selected, Some(value)));
                self.go(next);
            }
            Err(reason) => self.typing.refused = Some(reason),
        }
    }

    /// The ranges, the variables of the page, and the search.
    fn tabs(&mut self, rect: Rect, view: &View<'_>) {
        let ids = ["range-100", "range-200", "range-434", "range-500"];
        let mut keys: Vec<_> = ids.into_iter().zip(RANGES).map(|(id, (first, _))| (id, format!("#{first}"))).collect();
        keys.push(("range-page", view.text("本页面", "ON PAGE").to_owned()));
        keys.push(("find-variable", view.text("查找 #", "FIND #").to_owned()));
        let range = RANGES.iter().position(|(first, last)| (*first..=*last).contains(&self.selected));
        let chosen = match (self.searching, self.only_labelled) {
            (true, _) => 5,
            (false, true) => 4,
            (false, false) => range.unwrap_or(0),
        };
        match widget::tabs(view, rect, &keys, chosen) {
            Some(5) => {
                self.begin_search();
                self.typing.pad_open = true;
            }
            Some(4) => {
                self.only_labelled = true;
                self.go(0);
            }
            Some(index) => {
                self.only_labelled = false;
                self.go(RANGES[index].0);
            }
            None => {}
        }
    }

    fn list(&mut self, rect: Rect, view: &View<'_>, pages: i32, numbers: &[u16]) {
        let columns = self.columns;
        let here = numbers.iter().position(|number| *number == self.selected);
        if let (Some(here), false) = (here, self.scroll.user_scrolled) {
            self.scroll.scroll_to(here / columns, rect, widget::ROW_HEIGHT);
        }
        let count = numbers.len().div_ceil(columns);
        let list = ScrollList { id: "variables", rect, row: widget::ROW_HEIGHT, gap: 2.0, count };
        let (clipped, rows) = self.scroll.rows(view, &list, pages);
        for (line, place) in rows {
            let width = place.width() / columns as f32;
            for (column, variable) in numbers.iter().skip(line * columns).take(columns).enumerate() {
                let corner = place.min + vec2(column as f32 * width, 0.0);
                self.field(Rect::from_min_size(corner, vec2(width - theme::GAP, place.height())), &clipped, *variable);
            }
        }
    }

    fn field(&mut self, place: Rect, view: &View<'_>, variable: u16) {
        let (name, read_only) = (view.variable_name(variable), is_read_only(variable));
        let blocked = read_only || view.snapshot.values_locked();
        let response = view.touch(place, ("variable", variable), &name);
        if response.clicked() {
            if self.selected != variable {
                self.go(variable);
            }
            (self.scroll.user_scrolled, self.searching) = (true, false);
            self.typing.open_pad();
        }
        let pressed = response.is_pointer_button_down_on();
        keycap::paint_body(view, place, KeycapState { pressed, blocked, ..KeycapState::default() });
        let (number, rest) = place.shrink2(vec2(8.0, 2.0)).split_left(50.0);
        view.line_left(number, &name, theme::LABEL, view.theme.muted);
        let (label, value) = rest.split_right(106.0);
        let words = if read_only { read_only_name(view, variable) } else { variable_label(view, variable) };
        view.fit_left(label.trim_right(theme::GAP), words, theme::LABEL, view.theme.text);
        let chosen = self.selected == variable;
        let typing = (chosen && !self.searching).then_some(&self.typing);
        let (words, ink) = (view.variable(variable), view.theme.text);
        FieldEditor::paint(typing, view, ValueField { plate: place, value, size: theme::TITLE, words, ink });
        if chosen && self.searching {
            view.frame(place, view.theme.focus);
        }
    }

    fn input(&self, rect: Rect, view: &View<'_>) {
        if self.searching {
            let range = view.text("输入变量号，按输入", "type a number, then INPUT");
            return input_line::ui(view, rect, &self.typing, &InputPrompt { label: "→ #", name: "", range });
        }
        let what = format!("{}=", view.variable_name(self.selected));
        let range = if is_read_only(self.selected) {
            view.text("只读", "read-only").to_owned()
        } else {
            view.range_and_old(variable_entry::range(self.selected).get(view.lang), &view.variable(self.selected))
        };
        let told = InputPrompt { label: &what, name: variable_label(view, self.selected), range: &range };
        input_line::ui_in_run(view, rect, &self.typing, &told);
    }
}

/// Whose labels are shown, and whether the values may be edited.
fn head(rect: Rect, view: &View<'_>) {
    let number = view.snapshot.grinding_page_number().unwrap_or_default();
    let title = view.snapshot.page_files().and_then(|files| files.text.as_ref().ok());
    let words = title.map_or_else(
        || view.text("当前程序没有页面文字", "the current program has no page text").to_owned(),
        |text| format!("C{:04} {}", number % 1_000, text.title_in(view.lang)),
    );
    let lock = match (view.snapshot.params.bit(param::EDIT_OFFSETS), view.snapshot.values_locked()) {
        (false, _) => Some(Text::new("P22.0=0：只能查看", "P22.0=0: view only")),
        (true, true) => Some(LOCKED_IN_RUN),
        (true, false) => None,
    };
    let rest = lock.map_or(rect, |why| widget::lock_note(view, rect, why.get(view.lang)));
    view.fit_left(rest, &words, theme::LABEL, view.theme.muted);
}

pub fn page_rows<'a>(view: &View<'a>) -> impl Iterator<Item = &'a crate::defs::page_text::PageTextRow> {
    let files = view.snapshot.page_files();
    files.and_then(|files| files.text.as_ref().ok()).into_iter().flat_map(|text| text.rows())
}

/// The page where a variable is entered: the grinding page if it is on it.
pub fn entry_page(view: &View<'_>, variable: u16) -> Page {
    if page_rows(view).any(|row| row.variable == variable) { Page::Grinding } else { Page::Macro }
}

/// The label of a variable on the page of the open program; empty without one.
pub fn variable_label<'a>(view: &View<'a>, variable: u16) -> &'a str {
    page_rows(view).find(|row| row.variable == variable).map_or("", |row| row.label_in(view.lang))
}

/// Names of the variables that the control sets (K4.3, K4.5).
fn read_only_name<'a>(view: &View<'a>, variable: u16) -> &'a str {
    match variable {
        434 => view.text("量仪 X", "gauge X"),
        435 => view.text("量仪快速 Z", "gauge fast Z"),
        436 => view.text("量仪精确 Z", "gauge fine Z"),
        437 => view.text("精确-快速", "fine - fast"),
        438 => view.text("振荡前进到位", "oscillation forward"),
        _ => view.text("振荡后退到位", "oscillation backward"),
    }
}
