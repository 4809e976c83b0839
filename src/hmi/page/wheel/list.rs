//! The wheels of the shop: what each is like, and the keys that keep, mount, balance and remove them.
//! Source: spec K5.17; issue "the face", part 6.

use egui::{Align2, Rect, vec2};

use super::{FIELD_HEIGHT, group};
use crate::defs::date::DateTime;
use crate::defs::param;
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::defs::wheel_record::{WHEEL_NUMBERS, WheelRecord};
use crate::hmi::page::{InputPrompt, Scroll, ScrollList, input_line};
use crate::hmi::widget::page_keys;
use crate::hmi::{
    Area, CoreAnswer, EditKey, FieldEditor, KeyboardFocus, PageKey, Question, QuestionDialog, ValueField, View, keycap,
    round_to_lines, theme,
};
use crate::link::wheels::WheelCommand;
use crate::link::{Command, Snapshot};

/// Height of a wheel in the list.
const ROW_HEIGHT: f32 = 52.0;
/// Height of a row of keys.
const KEY_HEIGHT: f32 = 48.0;
/// Keys of a row.
const KEYS_OF_ROW: usize = 3;

page_keys! {
    /// A key of the list.
    WheelKey {
        Mount = "wheel-mount", "装上", "MOUNT";
        Keep = "wheel-keep", "存入", "KEEP";
        Remove = "wheel-remove", "删除", "REMOVE";
        Balanced = "wheel-balanced", "已平衡", "BALANCED";
        Crashed = "wheel-crashed", "碰撞", "CRASHED";
        Back = "wheel-back", "返回", "BACK";
    }
}

use WheelKey::{Back, Balanced, Crashed, Keep, Mount, Remove};

const KEYS: [WheelKey; 6] = [Mount, Keep, Remove, Balanced, Crashed, Back];
const CHOOSE: Text = Text::new("先选一片砂轮", "choose a wheel first");
const NO_NUMBER: Text = Text::new("编号应为整数", "the number must be a whole one");

/// State of the list.
#[derive(Debug, Default)]
pub struct WheelListView {
    /// The chosen wheel.
    chosen: Option<u16>,
    /// The number under which the mounted wheel is kept.
    pub typing: FieldEditor,
    scroll: Scroll,
    /// A wheel that the keyboard has reached: it is brought into sight.
    revealed: Option<usize>,
    walk: KeyboardFocus,
    question: QuestionDialog<WheelCommand>,
    /// The question was open when the frame began: it gets the keys.
    asks: bool,
}

impl WheelListView {
    /// Draws the list; false when it is left.
    pub fn ui(&mut self, rect: Rect, view: &View<'_>, edits: &[EditKey], out: &mut Vec<Command>) -> bool {
        self.asks = self.question.is_open();
        let own: Vec<EditKey> = edits.iter().copied().filter(|_| !self.asks).collect();
        // Digits are the number, the other keys walk over wheels and keys.
        let mut rest: Vec<EditKey> = own.into_iter().filter(|edit| !self.types(*edit)).collect();
        self.follow_arrows(view, &mut rest);
        if let CoreAnswer::Accepted(..) = self.typing.poll_answer(&view.snapshot.edit_answer) {
            self.typing.clear();
        }
        self.walk.begin_frame(&rest);
        let body = group(view, rect, view.text("砂轮库", "wheels of the shop"));
        let (list, keys) = body.split_bottom(2.0 * KEY_HEIGHT + theme::GAP);
        let (number, list) = list.trim_bottom(theme::GAP).split_top(FIELD_HEIGHT);
        self.number_field(number, view);
        self.rows(list.trim_top(theme::GAP), view);
        let pressed = self.keys(keys, view);
        let is_left = pressed == Some(Back);
        if let Some(key) = pressed {
            self.press(key, view, out);
        }
        !is_left
    }

    /// Draws the question over the page.
    pub fn question(&mut self, page: Rect, view: &View<'_>, edits: &[EditKey], out: &mut Vec<Command>) {
        let edits = if self.asks { edits } else { &[] };
        if let Some((command, Some(_))) = self.question.ui(page, view, edits) {
            out.push(Command::Wheel(command));
        }
    }

    /// The line below: the number that is typed.
    pub fn input(&self, rect: Rect, view: &View<'_>) {
        let range = format!("{}–{}", WHEEL_NUMBERS.start(), WHEEL_NUMBERS.end());
        let name = view.text("机床上砂轮的编号", "number of the wheel on the machine");
        input_line::ui(
            view,
            rect,
            &self.typing,
            &InputPrompt { label: view.text("编号=", "number="), name, range: &range },
        );
    }

    fn types(&mut self, edit: EditKey) -> bool {
        match edit {
            EditKey::Char('0'..='9') | EditKey::Backspace | EditKey::Cancel => self.typing.handle_key(edit),
            // The pad lies over the keys: the number stays, the pad goes.
            EditKey::Enter => std::mem::take(&mut self.typing.pad_open),
            _ => false,
        }
    }

    /// Up and down go from wheel to wheel.
    fn follow_arrows(&mut self, view: &View<'_>, edits: &mut Vec<EditKey>) {
        let wheels = &view.snapshot.production.wheels;
        let at = |chosen: Option<u16>| wheels.iter().position(|wheel| Some(wheel.number) == chosen);
        edits.retain(|edit| {
            let next = match (edit, at(self.chosen)) {
                (EditKey::Down, None) => 0,
                (EditKey::Down, Some(at)) => at + 1,
                (EditKey::Up, at) => at.unwrap_or_default().saturating_sub(1),
                _ => return true,
            };
            if let Some(wheel) = wheels.get(next) {
                (self.chosen, self.revealed) = (Some(wheel.number), Some(next));
            }
            false
        });
    }

    /// The number under which KEEP keeps the mounted wheel: typed, its own, or the next free one.
    fn number(&self, snapshot: &Snapshot) -> Result<u16, LocalizedText> {
        if !self.typing.text.is_empty() {
            return self.typing.text.parse().map_err(|_| NO_NUMBER.into());
        }
        let mounted = mounted(snapshot).map_or(0, |wheel| wheel.number);
        let is_free = |number: &u16| snapshot.production.wheels.iter().all(|wheel| wheel.number != *number);
        Ok(if mounted > 0 { mounted } else { WHEEL_NUMBERS.into_iter().find(is_free).unwrap_or_default() })
    }

    fn number_field(&mut self, rect: Rect, view: &View<'_>) {
        let response = keycap::plain(view, rect, "wheel-number", "wheel-number");
        let (label, value) = rect.trim_sides(theme::PAD).split_right(110.0);
        let name = view.text("机床上砂轮的编号", "number of the wheel on the machine");
        view.fit_left(label, name, theme::LABEL, view.theme.text);
        let words = self.number(view.snapshot).map_or_else(|_| String::new(), |number| number.to_string());
        let is_kept = mounted(view.snapshot).is_some();
        let ink = if is_kept { view.theme.text } else { view.theme.muted };
        let field = ValueField { plate: rect, value, size: theme::SECONDARY, words, ink };
        FieldEditor::paint(Some(&self.typing), view, field);
        if response.clicked() {
            self.typing.open_pad();
        }
    }

    fn rows(&mut self, rect: Rect, view: &View<'_>) {
        let wheels = &view.snapshot.production.wheels;
        if wheels.is_empty() {
            let words = view.text(
                "还没有砂轮。按“存入”给机床上的砂轮编号；换下时保留直径、修整次数、平衡日期，再装上时取回。",
                "No wheels yet. KEEP puts the wheel on the machine into the list; its diameter, dressings and balancing are kept when it is taken off and come back with it.",
            );
            view.paragraph(rect.shrink(theme::GAP), words, theme::LABEL, view.theme.muted);
            return;
        }
        let rect = round_to_lines(rect, ROW_HEIGHT);
        let list = ScrollList { id: "wheels", rect, row: ROW_HEIGHT, gap: 4.0, count: wheels.len() };
        if let Some(index) = self.revealed.take() {
            self.scroll.reveal(index, rect, ROW_HEIGHT);
        }
        let (clipped, places) = self.scroll.rows(view, &list, 0);
        for (index, place) in places {
            let wheel = as_it_is(view.snapshot, &wheels[index]);
            let chosen = self.chosen == Some(wheel.number);
            let name = format!("wheel {}", wheel.number);
            let response = clipped.touch_row(place, ("wheel", wheel.number), chosen, name);
            if response.clicked() {
                self.chosen = Some(wheel.number);
            }
            row(&clipped, place, &wheel, chosen);
        }
    }

    fn keys(&mut self, rect: Rect, view: &View<'_>) -> Option<WheelKey> {
        let mut pressed = None;
        for (index, key) in KEYS.into_iter().enumerate() {
            let row = rect.band((index / KEYS_OF_ROW) as f32 * (KEY_HEIGHT + theme::GAP), KEY_HEIGHT);
            let place = row.cell(index % KEYS_OF_ROW, KEYS_OF_ROW);
            if self.walk.button(view, place, PageKey::new(key.id(), key.label().get(view.lang))) {
                pressed = Some(key);
            }
        }
        pressed
    }

    fn press(&mut self, key: WheelKey, view: &View<'_>, out: &mut Vec<Command>) {
        let chosen =
            self.chosen.and_then(|number| view.snapshot.production.wheels.iter().find(|wheel| wheel.number == number));
        match (key, chosen) {
            (Back, _) => {}
            (Keep, _) => match self.number(view.snapshot) {
                Ok(number) => match mounted(view.snapshot).filter(|wheel| wheel.number != number) {
                    Some(wheel) => {
                        self.typing.clear();
                        self.question.ask(WheelCommand::Keep(number), renumber_question(wheel.number, number));
                    }
                    None => {
                        self.typing.send(0);
                        out.push(Command::Wheel(WheelCommand::Keep(number)));
                    }
                },
                Err(why) => self.typing.refused = Some(why),
            },
            (Balanced, _) => out.push(Command::Wheel(WheelCommand::Balanced)),
            (Crashed, _) => self.question.ask(WheelCommand::Crashed, crash_question()),
            (Mount | Remove, None) => self.typing.refused = Some(CHOOSE.into()),
            (Mount, Some(wheel)) => self.question.ask(WheelCommand::Mount(wheel.number), mount_question(wheel)),
            (Remove, Some(wheel)) => self.question.ask(WheelCommand::Remove(wheel.number), remove_question(wheel)),
        }
    }
}

fn mounted(snapshot: &Snapshot) -> Option<&WheelRecord> {
    snapshot.production.wheels.iter().find(|wheel| wheel.is_mounted)
}

/// The wheel on the machine is as the machine has made it.
fn as_it_is(snapshot: &Snapshot, wheel: &WheelRecord) -> WheelRecord {
    if !wheel.is_mounted {
        return *wheel;
    }
    let value = |row| snapshot.params.get(row);
    WheelRecord {
        diameter_mm: value(param::WHEEL_DIAMETER),
        smallest_mm: value(param::WHEEL_MIN_DIAMETER),
        dressings: wheel.dressings + value(param::DRESSING_COUNT) as u32,
        ..*wheel
    }
}

fn row(view: &View<'_>, place: Rect, wheel: &WheelRecord, chosen: bool) {
    view.row_card(place, chosen);
    let (top, below) = place.shrink2(vec2(10.0, 3.0)).split_top_bottom_at_fraction(0.54);
    let (state, ink) = if wheel.is_suspect {
        (view.text("碰撞后未平衡", "not balanced since its crash"), view.theme.alarm_text)
    } else if wheel.is_worn() {
        (view.text("已到最小直径", "worn down"), view.theme.hold)
    } else if wheel.is_mounted {
        (view.text("在机床上", "on the machine"), view.theme.info)
    } else {
        ("", view.theme.muted)
    };
    if wheel.is_mounted {
        view.edge_bar(place, view.theme.info);
    }
    let right = view.line(top, Align2::RIGHT_CENTER, state, theme::SMALL, ink);
    let WheelRecord { number, diameter_mm, width_mm, rated_m_s, dressings, smallest_mm, crashes, .. } = *wheel;
    let words = format!("{number}  Ø{diameter_mm} × {width_mm} mm · {rated_m_s} m/s");
    view.fit_left(top.with_max_x(right.min.x - theme::GAP), &words, theme::LABEL, view.theme.text);
    let day = |date: Option<DateTime>| date.map_or_else(|| "—".to_owned(), |date| date.day());
    let mut words = format!(
        "{} {dressings} · {} {}",
        view.text("修整", "dressed"),
        view.text("平衡", "balanced"),
        day(wheel.balanced)
    );
    if smallest_mm > 0.0 {
        words = format!("{words} · {} Ø{smallest_mm}", view.text("最小", "least"));
    }
    if crashes > 0 {
        words = format!("{words} · {} {crashes} ({})", view.text("碰撞", "crashes"), day(wheel.crashed));
    }
    view.fit_left(below, &words, theme::SMALL, view.theme.muted);
}

fn mount_question(wheel: &WheelRecord) -> Question {
    let WheelRecord { number, diameter_mm, width_mm, rated_m_s, .. } = *wheel;
    let body = phrase!(
        "{number} 号砂轮 Ø{diameter_mm} × {width_mm} mm，{rated_m_s} m/s 已装上？核对砂轮标签。修整之前不能循环启动。",
        "Is wheel {number}, Ø{diameter_mm} × {width_mm} mm, {rated_m_s} m/s, on the machine? Compare its label. No cycle start before it is dressed.",
        number,
        diameter_mm,
        width_mm,
        rated_m_s
    );
    let title = match wheel.is_suspect {
        true => Text::new("已换砂轮？它撞过，尚未平衡", "wheel changed? It has crashed and was not balanced since"),
        false => Text::new("已换砂轮？", "wheel changed?"),
    };
    Question::new(title, body, ("question-mount", Text::new("已装上", "MOUNTED")))
}

fn renumber_question(before: u16, number: u16) -> Question {
    let body = phrase!(
        "机床上的砂轮是 {before} 号。改为 {number} 号？另一片砂轮请先按“装上”或在换砂轮页面输入。",
        "The wheel on the machine is number {before}. Shall it be number {number}? Another wheel is mounted from the list or entered as changed.",
        before,
        number
    );
    Question::new(Text::new("改编号？", "another number?"), body, ("question-renumber", Text::new("改", "RENUMBER")))
}

fn remove_question(wheel: &WheelRecord) -> Question {
    let number = wheel.number;
    let body = phrase!(
        "{number} 号砂轮从砂轮库中删除，直径、修整和碰撞记录一起删除。",
        "Wheel {number} leaves the list with its diameter, dressings and crashes.",
        number
    );
    Question::new(Text::new("删除砂轮？", "remove the wheel?"), body, ("question-remove", Text::new("删除", "REMOVE")))
}

fn crash_question() -> Question {
    let body = Text::new(
        "机床上的砂轮撞过：记入砂轮库。再用之前检查裂纹、敲听、平衡。",
        "The wheel on the machine has hit something: noted in the list. Look for cracks, sound it and balance it before it is used again.",
    );
    Question::new(
        Text::new("记一次碰撞？", "note a crash?"),
        body.into(),
        ("question-crash", Text::new("记入", "NOTE")),
    )
}
