//! Wheel change: the mounted wheel and its permitted speed; size and rating of the new wheel. The new wheel must be
//! dressed before the next cycle start.
//! Source: spec K5.17, P2; seed 000 (the dressing point is set again after the wheel is mounted).

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use super::input_line::{self, InputPrompt};
use super::{PageContext, PageUi};
use crate::defs::param::{self, NumberParam};
use crate::defs::text::{LocalizedText, Text};
use crate::hmi::edit_key::EditKey;
use crate::hmi::field_editor::{CoreAnswer, FieldEditor, param_range};
use crate::hmi::keycap::{self, KeycapState};
use crate::hmi::view::{View, card, fit_text, focus_frame, format_whole, paragraph, text_line};
use crate::hmi::widget::{self, ButtonState};
use crate::hmi::{page_frame as lines, theme};
use crate::link::Command;

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

/// State of the page.
#[derive(Debug, Default)]
pub struct WheelPage {
    /// The value being typed.
    typing: FieldEditor,
    cursor: usize,
    entered: [Option<f64>; FIELDS.len()],
    /// The confirmation is open.
    confirming: bool,
    /// Why the core refused the change.
    refused: Option<LocalizedText>,
}

impl PageUi for WheelPage {
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<u32>) {
        *self = Self::default();
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { ui, rect, view, typed, out, .. } = ctx;
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
        for edit in typed.edits {
            self.edit(*edit, view, out);
        }
        let (page, input) = input_line::split(rect);
        let inside = page.shrink(theme::PAD);
        let (top, rest) = inside.split_top_bottom_at_y(inside.min.y + BANNER_HEIGHT);
        banner(ui, top, view);
        let rest = Rect::from_min_max(rest.min + vec2(0.0, theme::PAD), rest.max);
        let (left, right) = rest.split_left_right_at_fraction(0.44);
        mounted_wheel(ui, Rect::from_min_max(left.min, left.max - vec2(theme::PAD / 2.0, 0.0)), view);
        let right = Rect::from_min_max(right.min + vec2(theme::PAD / 2.0, 0.0), right.max);
        self.new_wheel(ui, right, view, out);
        self.input(ui, input, view);
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(&self.typing)
    }

    fn wants_pad(&self, _view: &View<'_>) -> bool {
        self.typing.pad_open && !self.confirming
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
        self.typing.clear_refused(edit);
        if self.cursor != CONFIRM && self.typing.handle_key(edit) {
            return;
        }
        let places = FIELDS.len() + 1;
        match edit {
            EditKey::Enter if self.cursor == CONFIRM => self.confirming = true,
            EditKey::Enter => self.store_entry(),
            EditKey::Up | EditKey::Left | EditKey::Previous => self.go((self.cursor + places - 1) % places),
            EditKey::Down | EditKey::Right | EditKey::Next => self.go((self.cursor + 1) % places),
            EditKey::Char(_)
            | EditKey::Sign
            | EditKey::Backspace
            | EditKey::Delete
            | EditKey::LineStart
            | EditKey::LineEnd
            | EditKey::Cancel => {}
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
    fn new_wheel(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
        let body = group(ui, view, rect, view.text("新砂轮", "new wheel"));
        for index in 0..FIELDS.len() {
            let top = body.min.y + index as f32 * (FIELD_HEIGHT + theme::GAP);
            let place = Rect::from_min_size(pos2(body.min.x, top), vec2(body.width(), FIELD_HEIGHT));
            if self.field(ui, place, view, index) {
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
        figure(
            ui,
            line,
            view,
            view.text("允许最高转速", "greatest speed"),
            &format!("{:.0}", max_rpm(values[0], values[2])),
            "r/min",
        );
        let keys = Rect::from_min_max(pos2(body.min.x, body.max.y - FIELD_HEIGHT), body.max);
        let note = Rect::from_min_max(pos2(body.min.x, line.max.y + 6.0), pos2(body.max.x, keys.min.y - 6.0));
        let (words, ink) = match (&self.refused, self.confirming) {
            (Some(why), _) => (why.get(view.lang).to_owned(), view.theme.alarm_text),
            (None, true) => (confirm_text(view, values), view.theme.hold),
            (None, false) if exceeds_rating(view, values) => (
                view.text(
                    "默认转速 P73 超过新砂轮的额定：换后先改 P73 或 S，否则砂轮不能启动。",
                    "P73, the speed without S, exceeds the new rating: change P73 or S, or the wheel will not start.",
                )
                .to_owned(),
                view.theme.hold,
            ),
            (None, false) => (
                view.text(
                    "尺寸和线速度以砂轮标签为准；未输入的项保持原值。",
                    "Take size and speed from the wheel's label; what is not typed stays.",
                )
                .to_owned(),
                view.theme.muted,
            ),
        };
        paragraph(ui.painter(), note, &words, theme::LABEL, ink);
        self.keys(ui, keys, view, out);
    }

    fn keys(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
        if self.confirming {
            let (yes, no) = rect.split_left_right_at_fraction(0.5);
            let yes = Rect::from_min_max(yes.min, yes.max - vec2(theme::GAP, 0.0));
            focus_frame(ui.painter(), yes, view.theme.hold);
            if widget::button(ui, view, yes, "wheel-confirm", view.text("确认", "CONFIRM"), ButtonState::default()) {
                self.confirm(view, out);
            }
            if widget::button(ui, view, no, "wheel-cancel", view.text("取消", "CANCEL"), ButtonState::default()) {
                self.confirming = false;
            }
            return;
        }
        if widget::button(
            ui,
            view,
            rect,
            "wheel-changed",
            view.text("已换砂轮", "WHEEL CHANGED"),
            ButtonState::default(),
        ) {
            self.typing.clear();
            (self.confirming, self.cursor, self.refused) = (true, CONFIRM, None);
        }
        if self.cursor == CONFIRM {
            focus_frame(ui.painter(), rect, view.theme.focus);
        }
    }

    /// One field; true if it was touched.
    fn field(&self, ui: &Ui, rect: Rect, view: &View<'_>, index: usize) -> bool {
        let (row, name) = FIELDS[index];
        let response = ui.interact(rect, Id::unique(("wheel-field", index)), Sense::CLICK);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("new P{}", row.number)));
        let painter = ui.painter();
        let face = KeycapState { pressed: response.is_pointer_button_down_on(), ..KeycapState::default() };
        keycap::paint_body(painter, view.theme, rect, face);
        let inside = rect.shrink2(vec2(theme::PAD, 0.0));
        let (value, unit) = inside.split_left_right_at_x(inside.max.x - 42.0);
        let (label, value) = value.split_left_right_at_x(value.max.x - 110.0);
        let words = format!("{} P{}", name.get(view.lang), row.number);
        fit_text(painter, label, Align2::LEFT_CENTER, &words, theme::LABEL, view.theme.text);
        fit_text(painter, unit, Align2::RIGHT_CENTER, row.unit, theme::LABEL, view.theme.muted);
        let chosen = self.cursor == index;
        let refused = chosen && self.typing.refused.is_some();
        let (words, ink) = match (chosen && !self.typing.text.is_empty(), self.entered[index]) {
            (true, _) if refused => (self.typing.text.clone(), view.theme.alarm_text),
            (true, _) => (format!("{}_", self.typing.text), view.theme.info),
            (false, Some(value)) => (value.to_string(), view.theme.info),
            (false, None) => (view.snapshot.params.get(row).to_string(), view.theme.muted),
        };
        fit_text(painter, value, Align2::RIGHT_CENTER, &words, theme::SECONDARY, ink);
        if chosen {
            focus_frame(painter, rect, if refused { view.theme.alarm } else { view.theme.focus });
        }
        response.clicked()
    }

    fn input(&self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let Some((row, name)) = FIELDS.get(self.cursor) else {
            let told = InputPrompt { label: "", name: "", range: "" };
            return input_line::ui(ui, view, rect, &self.typing, &told);
        };
        let range = format!("{} {}", view.text("范围", "range"), param_range(*row));
        let what = format!("P{}=", row.number);
        let told = InputPrompt { label: &what, name: name.get(view.lang), range: &range };
        input_line::ui(ui, view, rect, &self.typing, &told);
    }
}

/// Speed at which the rim reaches its rating, r/min.
fn max_rpm(diameter_mm: f64, rated_m_s: f64) -> f64 {
    (rated_m_s * 60_000.0 / (std::f64::consts::PI * diameter_mm)).floor()
}

/// Whether the default speed (P73) exceeds the rating of these values.
fn exceeds_rating(view: &View<'_>, [diameter, _, rated]: [f64; 3]) -> bool {
    view.snapshot.params.get(param::WHEEL_RPM) > max_rpm(diameter, rated)
}

fn confirm_text(view: &View<'_>, [diameter, width, rated]: [f64; 3]) -> String {
    let wheel = format!("Ø{diameter} × {width} mm, {rated} m/s");
    let what = view.text("确认已换上砂轮", "Confirm the new wheel");
    let then = view.text("？修整之前不能循环启动。", "? No cycle start before it is dressed.");
    format!("{what} {wheel}{then}")
}

/// What is required before the next cycle start.
fn banner(ui: &Ui, rect: Rect, view: &View<'_>) {
    let painter = ui.painter();
    let params = &view.snapshot.params;
    let inside = rect.shrink2(vec2(theme::PAD, 4.0));
    let undressed = params.bit(param::WHEEL_UNDRESSED);
    let edge = if undressed { view.theme.hold } else { view.theme.line };
    card(painter, rect, view.theme.surface, edge);
    if !undressed {
        let words = view.text("砂轮已修整", "the wheel is dressed");
        fit_text(painter, inside, Align2::LEFT_CENTER, words, theme::TITLE, view.theme.text);
        return;
    }
    painter.rect_filled(Rect::from_min_size(rect.min, vec2(4.0, rect.height())), 0.0, view.theme.hold);
    let (top, below) = inside.split_top_bottom_at_fraction(0.5);
    let words = view.text("已换砂轮，尚未修整：不能循环启动", "wheel changed and not dressed: no cycle start");
    fit_text(painter, top, Align2::LEFT_CENTER, words, theme::TITLE, view.theme.hold);
    let (first, last) = (params.get(param::DRESSING_PROGRAM_FIRST), params.get(param::DRESSING_PROGRAM_LAST));
    let words = format!(
        "{} O{first:04.0}–O{last:04.0} {}",
        view.text("先重设修整点，再把修整程序", "set the dressing point anew, then run"),
        view.text("运行到 M30 (P91 P92)", "to its M30 (P91, P92)"),
    );
    fit_text(painter, below, Align2::LEFT_CENTER, &words, theme::LABEL, view.theme.text);
}

/// The mounted wheel and its speed.
fn mounted_wheel(ui: &Ui, rect: Rect, view: &View<'_>) {
    let body = group(ui, view, rect, view.text("当前砂轮", "wheel mounted"));
    let params = &view.snapshot.params;
    let [diameter, width, rated] = FIELDS.map(|(row, _)| params.get(row));
    let rpm = view.snapshot.wheel_rpm;
    let rim = std::f64::consts::PI * diameter * rpm / 60_000.0;
    let most = max_rpm(diameter, rated);
    let rows = [
        (view.text("直径 P77", "diameter P77"), diameter.to_string(), "mm"),
        (view.text("宽度 P78", "width P78"), width.to_string(), "mm"),
        (view.text("额定线速度 P79", "rated speed P79"), rated.to_string(), "m/s"),
        (view.text("允许最高转速", "greatest speed"), format!("{most:.0}"), "r/min"),
        (view.text("当前转速", "speed now"), format_whole(rpm), "r/min"),
        (view.text("当前线速度", "rim speed now"), format!("{rim:.1}"), "m/s"),
    ];
    let mut at = body.min.y;
    for (index, (name, value, unit)) in rows.into_iter().enumerate() {
        // The rating above, the present speed below.
        at += if index == 4 { 14.0 } else { 0.0 };
        let line = Rect::from_min_size(pos2(body.min.x, at), vec2(body.width(), 36.0));
        figure(ui, line, view, name, &value, unit);
        at += 36.0;
    }
    let usual = params.get(param::WHEEL_RPM);
    if usual > most {
        let note = Rect::from_min_max(pos2(body.min.x, at + 6.0), body.max);
        let words = format!(
            "{} {usual} r/min {}",
            view.text("默认转速 P73", "P73, the speed without S,"),
            view.text(
                "超过额定：砂轮不能启动，先改 P73 或 S",
                "exceeds the rating: the wheel will not start; change P73 or S"
            ),
        );
        paragraph(ui.painter(), note, &words, theme::LABEL, view.theme.hold);
    }
}

/// Name, value, unit.
fn figure(ui: &Ui, rect: Rect, view: &View<'_>, name: &str, value: &str, unit: &str) {
    let painter = ui.painter();
    let (value_place, unit_place) = rect.split_left_right_at_x(rect.max.x - 46.0);
    let value_at = text_line(painter, value_place, Align2::RIGHT_CENTER, value, theme::SECONDARY, view.theme.text);
    let name_place = Rect::from_min_max(rect.min, pos2(value_at.min.x - theme::GAP, rect.max.y));
    fit_text(painter, name_place, Align2::LEFT_CENTER, name, theme::LABEL, view.theme.muted);
    text_line(painter, unit_place, Align2::RIGHT_CENTER, unit, theme::SMALL, view.theme.muted);
}

/// A card with a title; returns its inside.
fn group(ui: &Ui, view: &View<'_>, rect: Rect, title: &str) -> Rect {
    card(ui.painter(), rect, view.theme.surface, view.theme.line);
    let inside = rect.shrink2(vec2(theme::PAD + 2.0, theme::PAD));
    let (head, body) = inside.split_top_bottom_at_y(inside.min.y + 34.0);
    lines::title(ui, view, head, title);
    body
}
