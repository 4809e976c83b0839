//! Wheel change: the mounted wheel and its permitted speed; size and rating of the new wheel. The new wheel must be
//! dressed before the next cycle start.
//! Source: spec K5.17, P2; seed 000 (the dressing point is set again after the wheel is mounted).

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use super::input_line::{self, Told};
use crate::defs::param::{self, Number};
use crate::defs::text::{Said, Text};
use crate::hmi::entry::Edit;
use crate::hmi::keycap::{self, Face};
use crate::hmi::typing::{Heard, Typing};
use crate::hmi::view::{View, card, fit, frame, paragraph, put};
use crate::hmi::widget::{self, Look};
use crate::hmi::{frame as lines, theme};
use crate::link::Command;

/// Fields of a new wheel: parameter and name.
const FIELDS: [(Number, Text); 3] = [
    (param::WHEEL_DIAMETER, Text::new("直径", "diameter")),
    (param::WHEEL_WIDTH, Text::new("宽度", "width")),
    (param::WHEEL_RATED_SPEED, Text::new("额定线速度", "rated speed")),
];
/// Cursor index of the confirm key, behind the fields.
const CONFIRM: usize = FIELDS.len();
/// Height of a field.
const FIELD: f32 = 52.0;
/// Height of the banner.
const BANNER: f32 = 58.0;

/// State of the page.
#[derive(Debug, Default)]
pub struct WheelChange {
    /// The value being typed.
    pub typing: Typing,
    cursor: usize,
    typed: [Option<f64>; FIELDS.len()],
    /// The confirmation is open.
    asking: bool,
    /// Why the core refused the change.
    refused: Option<Said>,
}

impl WheelChange {
    /// Draws the page.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, edits: &[Edit]) -> Vec<Command> {
        let mut out = Vec::new();
        match self.typing.hear(&view.snapshot.edit) {
            Heard::Refused(_) => {
                self.refused = self.typing.refused.take();
                self.typing.clear();
            }
            Heard::Taken(..) => {
                self.typed = [None; FIELDS.len()];
                self.cursor = 0;
            }
            Heard::Nothing => {}
        }
        for edit in edits {
            self.edit(*edit, view, &mut out);
        }
        let (page, input) = input_line::split(rect);
        let inside = page.shrink(theme::PAD);
        let (top, rest) = inside.split_top_bottom_at_y(inside.min.y + BANNER);
        banner(ui, top, view);
        let rest = Rect::from_min_max(rest.min + vec2(0.0, theme::PAD), rest.max);
        let (left, right) = rest.split_left_right_at_fraction(0.44);
        present(ui, Rect::from_min_max(left.min, left.max - vec2(theme::PAD / 2.0, 0.0)), view);
        let right = Rect::from_min_max(right.min + vec2(theme::PAD / 2.0, 0.0), right.max);
        self.new_wheel(ui, right, view, &mut out);
        self.input(ui, input, view);
        out
    }

    /// Whether the numeric pad is shown.
    #[must_use]
    pub const fn wants_pad(&self) -> bool {
        self.typing.pad && !self.asking
    }

    fn edit(&mut self, edit: Edit, view: &View<'_>, out: &mut Vec<Command>) {
        self.refused = None;
        if self.asking {
            match edit {
                Edit::Enter => self.confirm(view, out),
                Edit::Cancel => self.asking = false,
                _ => {}
            }
            return;
        }
        self.typing.next_key(edit);
        if self.cursor != CONFIRM && self.typing.key(edit) {
            return;
        }
        let places = FIELDS.len() + 1;
        match edit {
            Edit::Enter if self.cursor == CONFIRM => self.asking = true,
            Edit::Enter => self.store(),
            Edit::Up | Edit::Left | Edit::Previous => self.go((self.cursor + places - 1) % places),
            Edit::Down | Edit::Right | Edit::Next => self.go((self.cursor + 1) % places),
            Edit::Char(_) | Edit::Sign | Edit::Back | Edit::Delete | Edit::LineStart | Edit::LineEnd | Edit::Cancel => {
            }
        }
    }

    fn go(&mut self, place: usize) {
        self.cursor = place;
        self.typing.clear();
    }

    /// Checks the typed value against its parameter's range and keeps it. Nothing changes before the confirmation.
    fn store(&mut self) {
        if !self.typing.text.is_empty() {
            let row = FIELDS[self.cursor].0;
            let value = match self.typing.number(row.max) {
                Ok(value) if value >= row.min => value,
                Ok(_) | Err(_) => {
                    let range = range(row);
                    self.typing.refused = Some(Said::new(format!("应为 {range}"), format!("it should be {range}")));
                    return;
                }
            };
            self.typed[self.cursor] = Some(value);
        }
        self.go(self.cursor + 1);
    }

    fn confirm(&mut self, view: &View<'_>, out: &mut Vec<Command>) {
        self.asking = false;
        let [diameter_mm, width_mm, rated_m_s] = self.values(view);
        self.typing.clear();
        self.typing.send(CONFIRM);
        out.push(Command::ChangeWheel { diameter_mm, width_mm, rated_m_s });
    }

    /// Typed values; where nothing is typed, the values in force.
    fn values(&self, view: &View<'_>) -> [f64; 3] {
        std::array::from_fn(|index| self.typed[index].unwrap_or_else(|| view.snapshot.params.get(FIELDS[index].0)))
    }

    /// The fields of the new wheel and the confirm key.
    fn new_wheel(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
        let body = group(ui, view, rect, view.say("新砂轮", "new wheel"));
        for index in 0..FIELDS.len() {
            let top = body.min.y + index as f32 * (FIELD + theme::GAP);
            let place = Rect::from_min_size(pos2(body.min.x, top), vec2(body.width(), FIELD));
            if self.field(ui, place, view, index) {
                if self.cursor != index {
                    self.go(index);
                }
                self.typing.pad = true;
                self.asking = false;
                self.refused = None;
            }
        }
        let values = self.values(view);
        let below = body.min.y + FIELDS.len() as f32 * (FIELD + theme::GAP) + 4.0;
        let line = Rect::from_min_size(pos2(body.min.x, below), vec2(body.width(), 30.0));
        figure(
            ui,
            line,
            view,
            view.say("允许最高转速", "greatest speed"),
            &format!("{:.0}", most_rpm(values[0], values[2])),
            "r/min",
        );
        let keys = Rect::from_min_max(pos2(body.min.x, body.max.y - FIELD), body.max);
        let note = Rect::from_min_max(pos2(body.min.x, line.max.y + 6.0), pos2(body.max.x, keys.min.y - 6.0));
        let (words, ink) = match (&self.refused, self.asking) {
            (Some(why), _) => (why.get(view.lang).to_owned(), view.theme.alarm_text),
            (None, true) => (question(view, values), view.theme.hold),
            (None, false) if too_fast(view, values) => (
                view.say(
                    "默认转速 P73 超过新砂轮的额定：换后先改 P73 或 S，否则砂轮不能启动。",
                    "P73, the speed without S, exceeds the new rating: change P73 or S, or the wheel will not start.",
                )
                .to_owned(),
                view.theme.hold,
            ),
            (None, false) => (
                view.say(
                    "尺寸和线速度以砂轮标签为准；未输入的项保持原值。",
                    "Take size and speed from the wheel's label; what is not typed stays.",
                )
                .to_owned(),
                view.theme.quiet,
            ),
        };
        paragraph(ui.painter(), note, &words, theme::LABEL, ink);
        self.keys(ui, keys, view, out);
    }

    fn keys(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
        if self.asking {
            let (yes, no) = rect.split_left_right_at_fraction(0.5);
            let yes = Rect::from_min_max(yes.min, yes.max - vec2(theme::GAP, 0.0));
            frame(ui.painter(), yes, view.theme.hold);
            if widget::push(ui, view, yes, "wheel-confirm", view.say("确认", "CONFIRM"), Look::default()) {
                self.confirm(view, out);
            }
            if widget::push(ui, view, no, "wheel-cancel", view.say("取消", "CANCEL"), Look::default()) {
                self.asking = false;
            }
            return;
        }
        if widget::push(ui, view, rect, "wheel-changed", view.say("已换砂轮", "WHEEL CHANGED"), Look::default()) {
            self.typing.clear();
            (self.asking, self.cursor, self.refused) = (true, CONFIRM, None);
        }
        if self.cursor == CONFIRM {
            frame(ui.painter(), rect, view.theme.focus);
        }
    }

    /// One field; true if it was touched.
    fn field(&self, ui: &Ui, rect: Rect, view: &View<'_>, index: usize) -> bool {
        let (row, name) = FIELDS[index];
        let response = ui.interact(rect, Id::unique(("wheel-field", index)), Sense::CLICK);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("new P{}", row.number)));
        let painter = ui.painter();
        let face = Face { pressed: response.is_pointer_button_down_on(), ..Face::default() };
        keycap::plate(painter, view.theme, rect, face);
        let inside = rect.shrink2(vec2(theme::PAD, 0.0));
        let (value, unit) = inside.split_left_right_at_x(inside.max.x - 42.0);
        let (label, value) = value.split_left_right_at_x(value.max.x - 110.0);
        let words = format!("{} P{}", name.get(view.lang), row.number);
        fit(painter, label, Align2::LEFT_CENTER, &words, theme::LABEL, view.theme.text);
        fit(painter, unit, Align2::RIGHT_CENTER, row.unit, theme::LABEL, view.theme.quiet);
        let chosen = self.cursor == index;
        let refused = chosen && self.typing.refused.is_some();
        let (words, ink) = match (chosen && !self.typing.text.is_empty(), self.typed[index]) {
            (true, _) if refused => (self.typing.text.clone(), view.theme.alarm_text),
            (true, _) => (format!("{}_", self.typing.text), view.theme.info),
            (false, Some(value)) => (value.to_string(), view.theme.info),
            (false, None) => (view.snapshot.params.get(row).to_string(), view.theme.quiet),
        };
        fit(painter, value, Align2::RIGHT_CENTER, &words, theme::SECONDARY, ink);
        if chosen {
            frame(painter, rect, if refused { view.theme.alarm } else { view.theme.focus });
        }
        response.clicked()
    }

    fn input(&self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let Some((row, name)) = FIELDS.get(self.cursor) else {
            let told = Told { what: "", name: "", range: "" };
            return input_line::ui(ui, view, rect, &self.typing, &told);
        };
        let range = format!("{} {}", view.say("范围", "range"), range(*row));
        let what = format!("P{}=", row.number);
        let told = Told { what: &what, name: name.get(view.lang), range: &range };
        input_line::ui(ui, view, rect, &self.typing, &told);
    }
}

fn range(row: Number) -> String {
    format!("{} … {} {}", row.min, row.max, row.unit)
}

/// Speed at which the rim reaches its rating, r/min.
fn most_rpm(diameter_mm: f64, rated_m_s: f64) -> f64 {
    (rated_m_s * 60_000.0 / (std::f64::consts::PI * diameter_mm)).floor()
}

/// Whether the default speed (P73) exceeds the rating of these values.
fn too_fast(view: &View<'_>, [diameter, _, rated]: [f64; 3]) -> bool {
    view.snapshot.params.get(param::WHEEL_RPM) > most_rpm(diameter, rated)
}

fn question(view: &View<'_>, [diameter, width, rated]: [f64; 3]) -> String {
    let wheel = format!("Ø{diameter} × {width} mm, {rated} m/s");
    let what = view.say("确认已换上砂轮", "Confirm the new wheel");
    let then = view.say("？修整之前不能循环启动。", "? No cycle start before it is dressed.");
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
        let words = view.say("砂轮已修整", "the wheel is dressed");
        fit(painter, inside, Align2::LEFT_CENTER, words, theme::TITLE, view.theme.text);
        return;
    }
    painter.rect_filled(Rect::from_min_size(rect.min, vec2(4.0, rect.height())), 0.0, view.theme.hold);
    let (top, below) = inside.split_top_bottom_at_fraction(0.5);
    let words = view.say("已换砂轮，尚未修整：不能循环启动", "wheel changed and not dressed: no cycle start");
    fit(painter, top, Align2::LEFT_CENTER, words, theme::TITLE, view.theme.hold);
    let (first, last) = (params.get(param::DRESSING_FIRST), params.get(param::DRESSING_LAST));
    let words = format!(
        "{} O{first:04.0}–O{last:04.0} {}",
        view.say("先重设修整点，再把修整程序", "set the dressing point anew, then run"),
        view.say("运行到 M30 (P91 P92)", "to its M30 (P91, P92)"),
    );
    fit(painter, below, Align2::LEFT_CENTER, &words, theme::LABEL, view.theme.text);
}

/// The mounted wheel and its speed.
fn present(ui: &Ui, rect: Rect, view: &View<'_>) {
    let body = group(ui, view, rect, view.say("当前砂轮", "wheel mounted"));
    let params = &view.snapshot.params;
    let [diameter, width, rated] = FIELDS.map(|(row, _)| params.get(row));
    let rpm = view.snapshot.wheel_rpm;
    let rim = std::f64::consts::PI * diameter * rpm / 60_000.0;
    let most = most_rpm(diameter, rated);
    let rows = [
        (view.say("直径 P77", "diameter P77"), diameter.to_string(), "mm"),
        (view.say("宽度 P78", "width P78"), width.to_string(), "mm"),
        (view.say("额定线速度 P79", "rated speed P79"), rated.to_string(), "m/s"),
        (view.say("允许最高转速", "greatest speed"), format!("{most:.0}"), "r/min"),
        (view.say("当前转速", "speed now"), format!("{rpm:.0}"), "r/min"),
        (view.say("当前线速度", "rim speed now"), format!("{rim:.1}"), "m/s"),
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
            view.say("默认转速 P73", "P73, the speed without S,"),
            view.say(
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
    let value_at = put(painter, value_place, Align2::RIGHT_CENTER, value, theme::SECONDARY, view.theme.text);
    let name_place = Rect::from_min_max(rect.min, pos2(value_at.min.x - theme::GAP, rect.max.y));
    fit(painter, name_place, Align2::LEFT_CENTER, name, theme::LABEL, view.theme.quiet);
    put(painter, unit_place, Align2::RIGHT_CENTER, unit, theme::SMALL, view.theme.quiet);
}

/// A card with a title; returns its inside.
fn group(ui: &Ui, view: &View<'_>, rect: Rect, title: &str) -> Rect {
    card(ui.painter(), rect, view.theme.surface, view.theme.line);
    let inside = rect.shrink2(vec2(theme::PAD + 2.0, theme::PAD));
    let (head, body) = inside.split_top_bottom_at_y(inside.min.y + 34.0);
    lines::title(ui, view, head, title);
    body
}
