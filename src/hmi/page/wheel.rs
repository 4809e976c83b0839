//! Wheel change: the mounted wheel and its permitted speed; size and rating of the new wheel. The new wheel must be
//! dressed before the next cycle start.
//! Source: spec K5.17, P2; seed 000 (the dressing point is set again after the wheel is mounted).

mod list;

use egui::{Rect, pos2, vec2};

use super::{HandOver, InputPrompt, PageContext, PageUi, input_line};
use crate::defs::param::{self, NumberParam};
use crate::defs::text::{LocalizedText, Text};
use crate::hmi::{
    Area, CoreAnswer, EditKey, FieldEditor, PageKey, ValueField, View, format_whole, keycap, page_frame as lines,
    param_range, theme, widget,
};
use crate::link::Command;
use list::WheelListView;

/// Fields of a new wheel: parameter and name.
const FIELDS: [(NumberParam, Text); 3] = [
    (param::WHEEL_DIAMETER, Text::new("直径", "diameter")),
    (param::WHEEL_WIDTH, Text::new("宽度", "width")),
    (param::WHEEL_RATED_SPEED, Text::new("额定线速度", "rated speed")),
];
/// Cursor index of the confirm key, behind the fields.
const CONFIRM: usize = FIELDS.len();
/// Height of a field.
const FIELD_HEIGHT: f32 = 52.0;
/// Height of the banner.
const BANNER_HEIGHT: f32 = 58.0;
/// Width of the key of the list.
const LIST_KEY_WIDTH: f32 = 140.0;

/// State of the page.
#[derive(Debug, Default)]
pub struct WheelPage {
    typing: FieldEditor,
    cursor: usize,
    entered: [Option<f64>; FIELDS.len()],
    /// The confirmation is open.
    confirming: bool,
    /// Why the core refused the change.
    refused: Option<LocalizedText>,
    /// The list of wheels, while it is shown instead of the fields.
    list: Option<WheelListView>,
}

impl PageUi for WheelPage {
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<HandOver>) {
        *self = Self::default();
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, out, .. } = ctx;
        match self.typing.poll_answer(&view.snapshot.edit_answer) {
            CoreAnswer::Refused(_) => {
                self.refused = self.typing.refused.take();
                self.typing.clear();
            }
            CoreAnswer::Accepted(..) => {
                self.entered = [None; FIELDS.len()];
                self.cursor = 0;
            }
            CoreAnswer::Nothing => {}
        }
        if self.list.is_none() {
            typed.edits.iter().for_each(|edit| self.edit(*edit, view, out));
        }
        let (page, input) = input_line::split(rect);
        let (top, rest) = page.shrink(theme::PAD).split_top(BANNER_HEIGHT);
        let (top, key) = top.split_right(LIST_KEY_WIDTH);
        banner(top.trim_right(theme::GAP), view);
        let words = format!("{} {}", view.text("砂轮库", "WHEELS"), view.snapshot.production.wheels.len());
        if widget::button(view, key, PageKey::new("wheel-list", &words).on(self.list.is_some())) {
            self.typing.clear();
            (self.list, self.confirming) = (self.list.is_none().then(WheelListView::default), false);
        }
        let (left, right) = rest.trim_top(theme::PAD).split_left_right_at_fraction(0.44);
        mounted_wheel(left.trim_right(theme::PAD / 2.0), view);
        let right = right.trim_left(theme::PAD / 2.0);
        let Some(list) = &mut self.list else {
            self.new_wheel(right, view, out);
            return self.input(input, view);
        };
        list.input(input, view);
        let stays = list.ui(right, view, &typed.edits, out);
        list.question(page, view, &typed.edits, out);
        if !stays {
            self.list = None;
        }
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(self.list.as_ref().map_or(&self.typing, |list| &list.typing))
    }

    fn wants_pad(&self, _view: &View<'_>) -> bool {
        self.list.as_ref().map_or(self.typing.pad_open && !self.confirming, |list| list.typing.pad_open)
    }
}

impl WheelPage {
    fn edit(&mut self, edit: EditKey, view: &View<'_>, out: &mut Vec<Command>) {
        self.refused = None;
        if self.confirming {
            match edit {
                EditKey::Enter => self.confirm(view, out),
                EditKey::Cancel => self.confirming = false,
                _ => {}
            }
            return;
        }
        if self.cursor != CONFIRM && self.typing.handle_key(edit) {
            return;
        }
        match (edit.step(self.cursor, FIELDS.len() + 1, 1), edit) {
            (Some(place), _) => self.go(place),
            (None, EditKey::Enter) if self.cursor == CONFIRM => self.confirming = true,
            (None, EditKey::Enter) => self.store_entry(),
            (None, _) => {}
        }
    }

    fn go(&mut self, place: usize) {
        self.cursor = place;
        self.typing.clear();
    }

    /// Checks the typed value against its parameter's range and keeps it. Nothing changes before the confirmation.
    fn store_entry(&mut self) {
        if !self.typing.text.is_empty() {
            match self.typing.param_value(FIELDS[self.cursor].0) {
                Ok(value) => self.entered[self.cursor] = Some(value),
                Err(reason) => return self.typing.refused = Some(reason),
            }
        }
        self.go(self.cursor + 1);
    }

    fn confirm(&mut self, view: &View<'_>, out: &mut Vec<Command>) {
        self.confirming = false;
        let [diameter_mm, width_mm, rated_m_s] = self.values(view);
        self.typing.clear();
        self.typing.send(CONFIRM);
        out.push(Command::ChangeWheel { diameter_mm, width_mm, rated_m_s });
    }

    /// Typed values; where nothing is typed, the values in force.
    fn values(&self, view: &View<'_>) -> [f64; 3] {
        std::array::from_fn(|index| self.entered[index].unwrap_or_else(|| view.snapshot.params.get(FIELDS[index].0)))
    }

    /// The fields of the new wheel and the confirm key.
    fn new_wheel(&mut self, rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
        let body = group(view, rect, view.text("新砂轮", "new wheel"));
        for index in 0..FIELDS.len() {
            let top = body.min.y + index as f32 * (FIELD_HEIGHT + theme::GAP);
            if self.field(Rect::from_min_size(pos2(body.min.x, top), vec2(body.width(), FIELD_HEIGHT)), view, index) {
                if self.cursor != index {
                    self.go(index);
                }
                self.typing.pad_open = true;
                self.confirming = false;
                self.refused = None;
            }
        }
        let values = self.values(view);
        let below = body.min.y + FIELDS.len() as f32 * (FIELD_HEIGHT + theme::GAP) + 4.0;
        let line = Rect::from_min_size(pos2(body.min.x, below), vec2(body.width(), 30.0));
        let permitted = max_rpm(values[0], values[2]);
        figure(line, view, view.text("允许最高转速", "maximum speed"), &format!("{permitted:.0}"), "r/min");
        let keys = body.with_min_y(body.max.y - FIELD_HEIGHT);
        let note = Rect::from_min_max(pos2(body.min.x, line.max.y + 6.0), pos2(body.max.x, keys.min.y - 6.0));
        let (words, ink) = match (&self.refused, self.confirming) {
            (Some(why), _) => (why.get(view.lang).into_owned(), view.theme.alarm_text),
            (None, true) => (confirm_text(view, values), view.theme.hold),
            (None, false) if view.snapshot.params.get(param::WHEEL_RPM) > permitted => {
                let words = view.text(
                    "默认转速 P73 超过新砂轮的额定：换后先改 P73 或 S，否则砂轮不能启动。",
                    "P73, the speed without S, exceeds the new rating: change P73 or S, or the wheel will not start.",
                );
                (words.to_owned(), view.theme.hold)
            }
            (None, false) => {
                let words = view.text(
                    "尺寸和线速度以砂轮标签为准；未输入的项保持原值。",
                    "Take size and speed from the wheel label; values not typed stay unchanged.",
                );
                (words.to_owned(), view.theme.muted)
            }
        };
        view.paragraph(note, &words, theme::LABEL, ink);
        self.keys(keys, view, out);
    }

    fn keys(&mut self, rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
        if self.confirming {
            let (yes, no) = rect.split_left_right_at_fraction(0.5);
            let yes = yes.trim_right(theme::GAP);
            view.frame(yes, view.theme.hold);
            if widget::button(view, yes, PageKey::new("wheel-confirm", view.text("确认", "CONFIRM"))) {
                self.confirm(view, out);
            }
            if widget::button(view, no, PageKey::new("wheel-cancel", view.text("取消", "CANCEL"))) {
                self.confirming = false;
            }
            return;
        }
        if widget::button(view, rect, PageKey::new("wheel-changed", view.text("已换砂轮", "WHEEL CHANGED"))) {
            self.typing.clear();
            (self.confirming, self.cursor, self.refused) = (true, CONFIRM, None);
        }
        if self.cursor == CONFIRM {
            view.frame(rect, view.theme.focus);
        }
    }

    /// One field; true if it was touched.
    fn field(&self, rect: Rect, view: &View<'_>, index: usize) -> bool {
        let (row, name) = FIELDS[index];
        let response = keycap::plain(view, rect, ("wheel-field", index), format!("new P{}", row.number));
        let (value, unit) = rect.trim_sides(theme::PAD).split_right(42.0);
        let (label, value) = value.split_right(110.0);
        view.fit_left(label, &format!("{} P{}", name.get(view.lang), row.number), theme::LABEL, view.theme.text);
        view.fit_right(unit, row.unit, theme::LABEL, view.theme.muted);
        let (chosen, entered) = (self.cursor == index, self.entered[index]);
        let ink = if entered.is_some() { view.theme.info } else { view.theme.muted };
        let words = entered.unwrap_or_else(|| view.snapshot.params.get(row)).to_string();
        let field = ValueField { plate: rect, value, size: theme::SECONDARY, words, ink };
        FieldEditor::paint(chosen.then_some(&self.typing), view, field);
        response.clicked()
    }

    fn input(&self, rect: Rect, view: &View<'_>) {
        let Some((row, name)) = FIELDS.get(self.cursor) else {
            return input_line::ui(view, rect, &self.typing, &InputPrompt { label: "", name: "", range: "" });
        };
        let range = format!("{} {}", view.text("范围", "range"), param_range(*row));
        let told = InputPrompt { label: &format!("P{}=", row.number), name: name.get(view.lang), range: &range };
        input_line::ui(view, rect, &self.typing, &told);
    }
}

/// Speed at which the rim reaches its rating, r/min.
fn max_rpm(diameter_mm: f64, rated_m_s: f64) -> f64 {
    (rated_m_s * 60_000.0 / (std::f64::consts::PI * diameter_mm)).floor()
}

fn confirm_text(view: &View<'_>, [diameter, width, rated]: [f64; 3]) -> String {
    let wheel = format!("Ø{diameter} × {width} mm, {rated} m/s");
    let what = view.text("确认已换上砂轮", "Confirm the new wheel");
    let then = view.text("？修整之前不能循环启动。", "? No cycle start before it is dressed.");
    format!("{what} {wheel}{then}")
}

/// What is required before the next cycle start.
fn banner(rect: Rect, view: &View<'_>) {
    let params = &view.snapshot.params;
    let inside = rect.shrink2(vec2(theme::PAD, 4.0));
    let undressed = params.bit(param::WHEEL_UNDRESSED);
    view.filled_card(rect, view.theme.surface, if undressed { view.theme.hold } else { view.theme.line });
    if !undressed {
        view.fit_left(inside, view.text("砂轮已修整", "the wheel is dressed"), theme::TITLE, view.theme.text);
        return;
    }
    view.edge_bar(rect, view.theme.hold);
    let (top, below) = inside.split_top_bottom_at_fraction(0.5);
    let words = view.text("已换砂轮，尚未修整：不能循环启动", "wheel changed and not dressed: no cycle start");
    view.fit_left(top, words, theme::TITLE, view.theme.hold);
    let numbers = view.snapshot.dressing_programs();
    let words = format!(
        "{} O{:04}–O{:04} {}",
        view.text("先重设修整点，再把修整程序", "set the dressing point again, then run"),
        numbers.start(),
        numbers.end(),
        view.text("运行到 M30 (P91 P92)", "to its M30 (P91, P92)"),
    );
    view.fit_left(below, &words, theme::LABEL, view.theme.text);
}

/// The mounted wheel and its speed.
fn mounted_wheel(rect: Rect, view: &View<'_>) {
    let body = group(view, rect, view.text("当前砂轮", "wheel mounted"));
    let params = &view.snapshot.params;
    let [diameter, width, rated] = FIELDS.map(|(row, _)| params.get(row));
    let rpm = view.snapshot.wheel_rpm;
    let most = max_rpm(diameter, rated);
    let rows = [
        (view.text("直径 P77", "diameter P77"), diameter.to_string(), "mm"),
        (view.text("宽度 P78", "width P78"), width.to_string(), "mm"),
        (view.text("额定线速度 P79", "rated speed P79"), rated.to_string(), "m/s"),
        (view.text("允许最高转速", "maximum speed"), format!("{most:.0}"), "r/min"),
        (view.text("当前转速", "speed now"), format_whole(rpm), "r/min"),
        (view.text("当前线速度", "surface speed"), format!("{:.1}", view.snapshot.wheel_rim_m_s()), "m/s"),
    ];
    let mut at = body.min.y;
    for (index, (name, value, unit)) in rows.into_iter().enumerate() {
        // The rating above, the present speed below.
        at += if index == 4 { 14.0 } else { 0.0 };
        figure(Rect::from_min_size(pos2(body.min.x, at), vec2(body.width(), 36.0)), view, name, &value, unit);
        at += 36.0;
    }
    let usual = params.get(param::WHEEL_RPM);
    if usual > most {
        let note = body.with_min_y(at + 6.0);
        let words = format!(
            "{} {usual} r/min {}",
            view.text("默认转速 P73", "P73, the speed without S,"),
            view.text(
                "超过额定：砂轮不能启动，先改 P73 或 S",
                "exceeds the rating: the wheel will not start; change P73 or S"
            ),
        );
        view.paragraph(note, &words, theme::LABEL, view.theme.hold);
    }
}

/// Name, value, unit.
fn figure(rect: Rect, view: &View<'_>, name: &str, value: &str, unit: &str) {
    let (value_place, unit_place) = rect.split_right(46.0);
    let value_at = view.line_right(value_place, value, theme::SECONDARY, view.theme.text);
    view.fit_left(rect.with_max_x(value_at.min.x - theme::GAP), name, theme::LABEL, view.theme.muted);
    view.line_right(unit_place, unit, theme::SMALL, view.theme.muted);
}

/// A card with a title; returns its inside.
fn group(view: &View<'_>, rect: Rect, title: &str) -> Rect {
    view.card(rect);
    let (head, body) = rect.shrink2(vec2(theme::PAD + 2.0, theme::PAD)).split_top(34.0);
    lines::title(view, head, title);
    body
}
