//! Macro variables by number, with the labels of the current page text; a variable can be found by its number.
//! Source: spec B6, B3, K7.3, K7.5, K7.7.

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use super::Typed;
use super::input_line::{self, Told};
use super::scroll::Scroll;
use crate::defs::param;
use crate::defs::r_parameter;
use crate::hmi::entry::{self, Edit};
use crate::hmi::keycap::{self, Face};
use crate::hmi::typing::{Heard, Typing};
use crate::hmi::view::{View, fit, frame, length, put};
use crate::hmi::widget;
use crate::hmi::{pictogram, theme};
use crate::link::Command;

/// Height of a line.
const LINE: f32 = 46.0;
/// Digits of a searched number.
const DIGITS: usize = 3;

/// Ranges of the list: first and last variable.
const RANGES: [(u16, u16); 4] = [(100, 199), (200, 433), (434, 439), (500, 999)];

/// State of the page.
#[derive(Debug, Default)]
pub struct Variables {
    /// What is being typed: a value, or a number to find.
    pub typing: Typing,
    scroll: Scroll,
    /// The selected variable; 0 until one is selected.
    chosen: u16,
    /// Shows only variables of the current page text.
    labelled: bool,
    /// A number to find is being typed.
    searching: bool,
    /// Variables per line, as last drawn.
    columns: usize,
}

/// Variables that the control sets (K4).
const fn is_read_only(variable: u16) -> bool {
    matches!(variable, 434..=439)
}

impl Variables {
    /// The page was opened again; selection and filter stay.
    pub fn open(&mut self) {
        let (chosen, labelled) = (self.chosen, self.labelled);
        *self = Self { chosen, labelled, ..Self::default() };
    }

    /// Draws the page.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, typed: &Typed<'_>) -> Vec<Command> {
        let mut out = Vec::new();
        let numbers = self.numbers(view);
        if !numbers.contains(&self.chosen) {
            self.chosen = numbers.first().copied().unwrap_or(0);
        }
        if let Heard::Refused(field) = self.typing.hear(&view.snapshot.edit) {
            self.chosen = field as u16; // cut: it was a variable's number
            self.searching = false;
        }
        if typed.text.contains(['#', '/']) {
            self.search();
        }
        for edit in typed.edits {
            self.edit(*edit, &numbers, &mut out);
        }
        let (page, input) = input_line::split(rect);
        let inside = page.shrink(theme::PAD);
        let (top, rest) = inside.split_top_bottom_at_y(inside.min.y + widget::TABS);
        self.tabs(ui, top, view);
        let (note, list) = rest.split_top_bottom_at_y(rest.min.y + 28.0);
        head(ui, note, view);
        self.columns = if list.width() > 860.0 { 3 } else { 2 };
        let columns = self.columns;
        self.list(ui, widget::whole_lines(list, LINE), view, typed.pages, (&numbers, columns));
        self.input(ui, input, view);
        out
    }

    /// The listed variables.
    fn numbers(&self, view: &View<'_>) -> Vec<u16> {
        if self.labelled {
            let mut found: Vec<u16> = page(view).map(|row| row.variable).collect();
            found.sort_unstable();
            found.dedup();
            if !found.is_empty() {
                return found;
            }
        }
        RANGES.iter().flat_map(|(first, last)| *first..=*last).collect()
    }

    fn search(&mut self) {
        self.typing.clear();
        self.searching = true;
    }

    fn edit(&mut self, edit: Edit, numbers: &[u16], out: &mut Vec<Command>) {
        self.typing.next_key(edit);
        if self.searching && edit == Edit::Cancel {
            self.searching = false;
            return self.typing.clear();
        }
        if self.typing.key(edit) {
            return;
        }
        let Some(here) = numbers.iter().position(|number| *number == self.chosen) else { return };
        let count = numbers.len();
        match edit {
            Edit::Enter if self.searching => self.find(),
            Edit::Enter => self.enter(numbers[(here + 1) % count], out),
            Edit::Up => self.go(numbers[(here + count - self.columns.min(count)) % count]),
            Edit::Down => self.go(numbers[(here + self.columns) % count]),
            Edit::Left | Edit::Previous => self.go(numbers[(here + count - 1) % count]),
            Edit::Right | Edit::Next => self.go(numbers[(here + 1) % count]),
            Edit::Char(_) | Edit::Sign | Edit::Back | Edit::Delete | Edit::LineStart | Edit::LineEnd | Edit::Cancel => {
            }
        }
    }

    fn go(&mut self, variable: u16) {
        self.chosen = variable;
        self.typing.clear();
        self.searching = false;
        self.scroll.by_hand = false;
    }

    /// Selects the typed number, wherever it is listed.
    fn find(&mut self) {
        let number = self.typing.text.get(..DIGITS.min(self.typing.text.len())).and_then(|text| text.parse().ok());
        match number.filter(|number| RANGES.iter().any(|(first, last)| (*first..=*last).contains(number))) {
            Some(number) => {
                self.labelled = false;
                self.go(number);
            }
            None => {
                let none = ("没有此变量：#100–#439、#500–#999", "no such variable: #100 to #439, #500 to #999");
                self.typing.refused = Some(crate::defs::text::Said::new(none.0, none.1));
            }
        }
    }

    fn enter(&mut self, next: u16, out: &mut Vec<Command>) {
        if self.typing.text.is_empty() {
            return self.go(next);
        }
        match entry::check(self.chosen, &self.typing.text) {
            Ok(value) => {
                self.typing.send(usize::from(self.chosen));
                out.push(Command::TypeVariable(self.chosen, Some(value)));
                self.go(next);
            }
            Err(reason) => self.typing.refused = Some(reason),
        }
    }

    /// The ranges, the variables of the page, and the search.
    fn tabs(&mut self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let mut keys: Vec<(&str, String)> = RANGES
            .iter()
            .zip(["range-100", "range-200", "range-434", "range-500"])
            .map(|((first, _), id)| (id, format!("#{first}")))
            .collect();
        keys.push(("range-page", view.say("本页面", "ON PAGE").to_owned()));
        keys.push(("find-variable", view.say("查找 #", "FIND #").to_owned()));
        let range = RANGES.iter().position(|(first, last)| (*first..=*last).contains(&self.chosen));
        let chosen = match (self.searching, self.labelled) {
            (true, _) => 5,
            (false, true) => 4,
            (false, false) => range.unwrap_or(0),
        };
        match widget::tabs(ui, view, rect, &keys, chosen) {
            Some(5) => {
                self.search();
                self.typing.pad = true;
            }
            Some(4) => {
                self.labelled = true;
                self.go(0);
            }
            Some(index) => {
                self.labelled = false;
                self.go(RANGES[index].0);
            }
            None => {}
        }
    }

    fn list(&mut self, ui: &Ui, list: Rect, view: &View<'_>, pages: i32, (numbers, columns): (&[u16], usize)) {
        let count = numbers.len().div_ceil(columns);
        if pages != 0 {
            self.scroll.page(pages, list, LINE);
        }
        let here = numbers.iter().position(|number| *number == self.chosen);
        if let (Some(here), false) = (here, self.scroll.by_hand) {
            self.scroll.show(here / columns, list, LINE);
        }
        let (first, last) = self.scroll.follow(ui, "variables", list, LINE, count);
        let width = (list.width() - 8.0) / columns as f32;
        for line in first..last {
            let top = list.min.y + ((line as f64 - self.scroll.top) * f64::from(LINE)) as f32;
            for (column, variable) in numbers.iter().skip(line * columns).take(columns).enumerate() {
                let left = list.min.x + column as f32 * width;
                let place = Rect::from_min_size(pos2(left, top), vec2(width - theme::GAP, LINE - 2.0));
                self.field(ui, (list, place), view, *variable);
            }
        }
        self.scroll.bar(ui, view, list, LINE, count);
    }

    fn field(&mut self, ui: &Ui, (list, place): (Rect, Rect), view: &View<'_>, variable: u16) {
        let painter = &ui.painter().with_clip_rect(list);
        let response = ui.interact(place.intersect(list), Id::unique(("variable", variable)), Sense::CLICK);
        response.widget_info(|| {
            WidgetInfo::labeled(Role::Button, true, r_parameter::name_on(u32::from(variable), view.snapshot.kind))
        });
        if response.clicked() {
            if self.chosen != variable {
                self.go(variable);
            }
            (self.scroll.by_hand, self.searching, self.typing.pad) = (true, false, true);
        }
        let chosen = self.chosen == variable;
        let face =
            Face { pressed: response.is_pointer_button_down_on(), blocked: is_read_only(variable), ..Face::default() };
        keycap::plate(painter, view.theme, place, face);
        let inside = place.shrink2(vec2(8.0, 2.0));
        let (number, rest) = inside.split_left_right_at_x(inside.min.x + 50.0);
        put(
            painter,
            number,
            Align2::LEFT_CENTER,
            &r_parameter::name_on(u32::from(variable), view.snapshot.kind),
            theme::LABEL,
            view.theme.quiet,
        );
        let (label, value) = rest.split_left_right_at_x(rest.max.x - 106.0);
        let words = if is_read_only(variable) { own(view, variable) } else { label_of(view, variable) };
        let label = Rect::from_min_max(label.min, label.max - vec2(theme::GAP, 0.0));
        fit(painter, label, Align2::LEFT_CENTER, words, theme::LABEL, view.theme.text);
        let typing = chosen && !self.searching && !self.typing.text.is_empty();
        let refused = chosen && !self.searching && self.typing.refused.is_some();
        let (words, ink) = match typing {
            true if refused => (self.typing.text.clone(), view.theme.alarm_text),
            true => (format!("{}_", self.typing.text), view.theme.info),
            false => (shown(view, variable), view.theme.text),
        };
        fit(painter, value, Align2::RIGHT_CENTER, &words, theme::TITLE, ink);
        if chosen {
            frame(painter, place, if refused { view.theme.alarm } else { view.theme.focus });
        }
    }

    fn input(&self, ui: &Ui, rect: Rect, view: &View<'_>) {
        if self.searching {
            let range = view.say("输入变量号，按输入", "type a number, then INPUT");
            return input_line::ui(ui, view, rect, &self.typing, &Told { what: "→ #", name: "", range });
        }
        let what = format!("{}=", r_parameter::name_on(u32::from(self.chosen), view.snapshot.kind));
        let old = shown(view, self.chosen);
        let range = if is_read_only(self.chosen) {
            view.say("只读", "read-only").to_owned()
        } else {
            let range = entry::range(self.chosen).get(view.lang);
            format!("{} {range} · {} {old}", view.say("范围", "range"), view.say("原值", "was"))
        };
        let told = Told { what: &what, name: label_of(view, self.chosen), range: &range };
        input_line::ui(ui, view, rect, &self.typing, &told);
    }
}

/// Whose labels are shown, and whether the values may be edited.
fn head(ui: &Ui, rect: Rect, view: &View<'_>) {
    let painter = ui.painter();
    let number = view.snapshot.grinding_page().unwrap_or_default();
    let title = view.snapshot.page_files().and_then(|files| files.text.as_ref().ok());
    let words = title.map_or_else(
        || view.say("当前程序没有页面文字", "the current program has no page text").to_owned(),
        |text| format!("C{:04} {}", number % 1_000, text.title),
    );
    let locked = !view.snapshot.params.bit(param::EDIT_OFFSETS);
    let rest = if locked {
        let words = view.say("P22.0=0：只能查看", "P22.0 is 0: look only");
        let taken = fit(painter, rect, Align2::RIGHT_CENTER, words, theme::LABEL, view.theme.hold);
        let lock = Rect::from_center_size(pos2(taken.min.x - 14.0, rect.center().y), vec2(13.0, 13.0));
        pictogram::draw(painter, lock, pictogram::LOCK, view.theme.hold);
        Rect::from_min_max(rect.min, pos2(lock.min.x - theme::PAD, rect.max.y))
    } else {
        rect
    };
    fit(painter, rest, Align2::LEFT_CENTER, &words, theme::LABEL, view.theme.quiet);
}

fn page<'a>(view: &View<'a>) -> impl Iterator<Item = &'a crate::defs::screen::Row> {
    let files = view.snapshot.page_files();
    files.and_then(|files| files.text.as_ref().ok()).into_iter().flat_map(|text| text.rows())
}

fn label_of<'a>(view: &View<'a>, variable: u16) -> &'a str {
    page(view).find(|row| row.variable == variable).map_or("", |row| row.label.as_str())
}

/// Names of the variables that the control sets (K4.3, K4.5).
const fn own<'a>(view: &View<'a>, variable: u16) -> &'a str {
    match variable {
        434 => view.say("量仪 X", "gauge X"),
        435 => view.say("量仪快速 Z", "gauge fast Z"),
        436 => view.say("量仪精确 Z", "gauge fine Z"),
        437 => view.say("精确-快速", "fine - fast"),
        438 => view.say("振荡前进到位", "oscillation forward"),
        _ => view.say("振荡后退到位", "oscillation backward"),
    }
}

/// Value of a variable as executed; a null variable is a dash.
fn shown(view: &View<'_>, variable: u16) -> String {
    let value = view.snapshot.variables.get(usize::from(variable)).copied().flatten();
    value.map_or_else(|| "—".to_owned(), length)
}
