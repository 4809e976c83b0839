//! Production page: the orders, what was made of each, statistics of the sizes, a report; the day of the machine by hours
//! and shifts.
//! Source: spec B6; issue "the face", part 8; issue "a good part, always", part D.

mod figures;
mod oee;
mod order_form;
mod order_values;
mod report;
mod shifts;

use egui::{Color32, Rect};

use super::{HandOver, InputPrompt, PageContext, PageUi, Scroll, ScrollList, input_line};
use crate::defs::part_record::PartRecord;
use crate::defs::production_order::{OrderState, ProductionOrder};
use crate::defs::text::{Text, phrase};
use crate::hmi::widget::page_keys;
use crate::hmi::{
    Area, CoreAnswer, EditKey, FieldEditor, KeyboardFocus, PageKey, Question, QuestionDialog, View, file_command,
    theme, widget,
};
use crate::link::files::{FileRequest, Requester};
use crate::link::page_command::PageCommand;
use crate::link::production::{OrderCommand, OrderProposal};
use crate::link::{Command, Snapshot};
use order_form::{FIELDS, OrderEntry};

/// Share of the page for the list.
const LIST_SHARE: f32 = 0.6;
/// Shares of the columns of the list, and their headings.
const COLUMNS: [f32; 5] = [1.15, 0.9, 1.75, 0.7, 1.3];
/// How far back the days go: the hours of a month are kept.
const MAX_DAYS_BACK: u64 = 30;
/// Height of the header of the list.
const HEADER_HEIGHT: f32 = 28.0;

page_keys! {
    /// The views of the page.
    JobsView {
        /// The list of orders.
        Orders = "jobs-orders", "订单", "ORDERS";
        /// The day of the machine.
        Shifts = "jobs-shifts", "班次", "SHIFTS";
    }
}

page_keys! {
    /// The keys below the day.
    DayKey {
        /// The day before.
        Before = "day-before", "前一天", "DAY BEFORE";
        /// The day after.
        After = "day-after", "后一天", "DAY AFTER";
        /// All hours as CSV.
        Save = "day-save", "存为 CSV", "SAVE CSV";
    }
}

page_keys! {
    /// The keys below the list.
    JobKey {
        /// Enters or changes the order of the form.
        Enter = "job-enter", "存入", "ENTER";
        /// Parts count for the chosen order from now on.
        Start = "job-start", "开始", "START";
        /// Accepts the chosen order of the shop; in the place of CLOSE.
        Accept = "job-accept", "接受", "ACCEPT";
        /// The chosen order is over.
        Close = "job-close", "结束", "CLOSE";
        /// Deletes the chosen order.
        Delete = "job-delete", "删除", "DELETE";
        /// Saves the report of the chosen order.
        Report = "job-report", "报告", "REPORT";
    }
}

const KEYS: [JobKey; 5] = [JobKey::Enter, JobKey::Start, JobKey::Close, JobKey::Delete, JobKey::Report];
/// Places of the cursor: the fields, then the keys.
const PLACES: usize = FIELDS.len() + KEYS.len();

const NOT_ENTERED: Text = Text::new("键入的数值还没有存入", "the typed figures are not entered yet: press ENTER first");
const CHOOSE: Text = Text::new("先选一个订单，或键入新的", "choose an order first, or enter a new one");

/// What the page asks about an order of this number.
#[derive(Clone, Copy, Debug)]
enum JobQuestion {
    /// Whether it is deleted.
    Delete(u32),
    /// Whether its values replace those of the page.
    TakeValues(u32),
}

/// State of the page.
#[derive(Debug, Default)]
pub struct JobsPage {
    typing: FieldEditor,
    cursor: usize,
    entry: OrderEntry,
    scroll: Scroll,
    question: QuestionDialog<JobQuestion>,
    /// The day of the machine is shown, so many days ago; none: the orders.
    day_back: Option<u64>,
    walk: KeyboardFocus,
}

impl PageUi for JobsPage {
    fn open(&mut self, view: &View<'_>, _handed_over: Option<HandOver>) {
        *self = Self { day_back: self.day_back.map(|_| 0), ..Self::default() };
        let made = &view.snapshot.production;
        self.entry.choose(made.active().or(made.orders.last()));
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(&self.typing)
    }

    fn wants_pad(&self, _view: &View<'_>) -> bool {
        self.typing.pad_open && !self.question.is_open() && self.day_back.is_none()
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, out, .. } = ctx;
        if let CoreAnswer::Accepted(..) = self.typing.poll_answer(&view.snapshot.edit_answer) {
            self.entry.forget_typed();
        }
        let (page, input) = input_line::split(rect);
        let (tabs, page) = page.shrink(theme::PAD).split_top(widget::KEYS_HEIGHT);
        self.tabs(tabs, view);
        if let Some(back) = self.day_back {
            return self.shifts(rect.shrink(theme::PAD).trim_top(widget::KEYS_HEIGHT), view, (back, &typed.edits), out);
        }
        if !self.question.is_open() {
            typed.edits.iter().for_each(|edit| self.edit(*edit, view, out));
        }
        let (body, keys) = page.trim_top(theme::GAP).split_bottom(widget::KEYS_HEIGHT);
        let (left, right) = body.trim_bottom(theme::GAP).split_left_right_at_fraction(LIST_SHARE);
        self.list(left.trim_right(theme::PAD / 2.0), view, typed.scroll_pages);
        let right = right.trim_left(theme::PAD / 2.0);
        if let Some(field) = order_form::ui(right, view, &self.entry, (self.cursor, &self.typing)) {
            self.go(field);
            self.typing.open_pad();
        }
        self.keys(keys, view, out);
        self.input(input, view);
        match self.question.ui(rect, view, &typed.edits) {
            Some((JobQuestion::Delete(number), Some(_))) => {
                self.entry = OrderEntry::default();
                out.push(Command::Order(OrderCommand::Delete(number)));
            }
            Some((JobQuestion::TakeValues(number), Some(key))) => {
                out.push(Command::Order(OrderCommand::Start { number, takes_values: key == 0 }));
            }
            Some((_, None)) | None => {}
        }
    }
}

impl JobsPage {
    /// The two views.
    fn tabs(&mut self, rect: Rect, view: &View<'_>) {
        let keys = [JobsView::Orders, JobsView::Shifts].map(|key| (key.id(), key.label().get(view.lang).to_owned()));
        let shown = usize::from(self.day_back.is_some());
        if let Some(touched) = widget::tabs(view, rect.split_left(rect.width() * LIST_SHARE).0, &keys, shown) {
            self.day_back = (touched == 1).then_some(0);
            self.typing.pad_open = false;
            self.go(0);
        }
    }

    /// The day of the machine and its keys.
    fn shifts(&mut self, rect: Rect, view: &View<'_>, (back, edits): (u64, &[EditKey]), out: &mut Vec<Command>) {
        let (body, keys) = rect.trim_top(theme::GAP).split_bottom(widget::KEYS_HEIGHT);
        self.walk.begin_frame(edits);
        let touched =
            shifts::ui(body.trim_bottom(theme::GAP), view, shifts::day_of(view.snapshot, back), &mut self.walk);
        out.extend(touched.map(|reason| {
            let given = Some(reason).filter(|reason| view.snapshot.production.downtime_reason != Some(*reason));
            Command::Page(PageCommand::SetDowntimeReason(given))
        }));
        let words = [DayKey::Before, DayKey::After, DayKey::Save];
        let words = words.map(|key| PageKey::new(key.id(), key.label().get(view.lang)));
        match self.walk.keys(view, keys, &words) {
            Some(0) => self.day_back = Some((back + 1).min(MAX_DAYS_BACK)),
            Some(1) => self.day_back = Some(back.saturating_sub(1)),
            Some(_) => {
                out.push(file_command(Requester::Screen, FileRequest::SaveTable(shifts::csv(view.snapshot))));
            }
            None => {}
        }
    }

    fn edit(&mut self, edit: EditKey, view: &View<'_>, out: &mut Vec<Command>) {
        if self.cursor < FIELDS.len() && self.typing.handle_key(edit) {
            return;
        }
        self.typing.refused = None;
        match (edit.step(self.cursor, PLACES, 1), edit, self.cursor.checked_sub(FIELDS.len())) {
            (Some(place), ..) => self.go(place),
            (None, EditKey::Enter, Some(key)) => self.press(self.key_in_place(KEYS[key], view), view, out),
            (None, EditKey::Enter, None) => self.take_typed(view),
            (None, ..) => {}
        }
    }

    fn go(&mut self, place: usize) {
        self.cursor = place;
        self.typing.clear();
    }

    /// Takes the typed figure into the form. The number of a known order chooses it.
    fn take_typed(&mut self, view: &View<'_>) {
        if !self.typing.text.is_empty() {
            match self.entry.take(self.cursor, &self.typing.text, view.snapshot) {
                Ok(()) => {}
                Err(why) => return self.typing.refused = Some(why),
            }
        }
        self.go(self.cursor + 1);
    }

    /// A figure that is typed when a key is touched counts, too; false if it is refused.
    fn takes_typed(&mut self, view: &View<'_>) -> bool {
        if self.cursor < FIELDS.len() && !self.typing.text.is_empty() {
            self.take_typed(view);
        }
        self.typing.refused.is_none() || self.typing.text.is_empty()
    }

    fn list(&mut self, rect: Rect, view: &View<'_>, pages: i32) {
        let (head, list) = rect.split_top(HEADER_HEIGHT);
        let words = [
            view.text("订单", "order"),
            view.text("程序", "program"),
            view.text("合格 / 件数", "good / parts"),
            view.text("不良", "NOK"),
            view.text("状态", "state"),
        ];
        widget::table_header(view, head.trim_sides(theme::PAD), COLUMNS, words);
        let orders = &view.snapshot.production.orders;
        if orders.is_empty() {
            let words = view.text(
                "还没有订单。在右边键入订单号、程序、件数，按存入，再按开始：工件自动计数。",
                "No orders yet. Type number, program and parts on the right, press ENTER, then START: parts are counted by themselves.",
            );
            view.paragraph(list.shrink(theme::PAD), words, theme::LABEL, view.theme.muted);
            return;
        }
        let rect = widget::round_to_lines(list.trim_top(theme::GAP), widget::ROW_HEIGHT);
        let list = ScrollList { id: "jobs", rect, row: widget::ROW_HEIGHT, gap: 2.0, count: orders.len() };
        let (clipped, rows) = self.scroll.rows(view, &list, pages);
        for (index, place) in rows {
            let order = &orders[index];
            let chosen = self.entry.chosen() == Some(order.number);
            let response = clipped.touch_row(place, ("job", order.number), chosen, format!("order {}", order.number));
            if response.clicked() {
                self.entry.choose(Some(order));
                self.go(0);
            }
            row(&clipped, place, order, chosen);
        }
    }

    fn keys(&mut self, rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
        for (index, key) in KEYS.into_iter().enumerate() {
            let key = self.key_in_place(key, view);
            let place = rect.cell(index, KEYS.len());
            let words = key.label();
            if widget::button(view, place, PageKey::new(key.id(), words.get(view.lang))) && self.takes_typed(view) {
                self.cursor = FIELDS.len() + index;
                self.press(key, view, out);
            }
            if self.cursor == FIELDS.len() + index {
                view.frame(place, view.theme.focus);
            }
        }
    }

    /// An order of the shop is accepted before it can be closed. Not in the place of the start: a second touch must not
    /// start it.
    fn key_in_place(&self, key: JobKey, view: &View<'_>) -> JobKey {
        let chosen = self.entry.chosen().and_then(|number| view.snapshot.production.order(number));
        let is_proposed = chosen.is_some_and(|order| order.state == OrderState::Proposed);
        if key == JobKey::Close && is_proposed { JobKey::Accept } else { key }
    }

    /// Starts an order; asks first if it has other values than the page.
    fn start(&mut self, order: &ProductionOrder, view: &View<'_>, out: &mut Vec<Command>) {
        match order_values::question(view, order) {
            Some(question) => self.question.ask(JobQuestion::TakeValues(order.number), question),
            None => {
                let command = OrderCommand::Start { number: order.number, takes_values: false };
                out.push(Command::Order(command));
            }
        }
    }

    fn press(&mut self, key: JobKey, view: &View<'_>, out: &mut Vec<Command>) {
        self.typing.clear();
        if key == JobKey::Enter {
            match self.entry.command(view.snapshot) {
                Ok(command) => {
                    self.typing.send(0);
                    out.push(Command::Order(command));
                }
                Err(why) => self.typing.refused = Some(why),
            }
            return;
        }
        let order = self.entry.chosen().and_then(|number| view.snapshot.production.order(number));
        let Some(order) = order else { return self.typing.refused = Some(CHOOSE.into()) };
        match key {
            JobKey::Start | JobKey::Accept if self.entry.is_changed() => self.typing.refused = Some(NOT_ENTERED.into()),
            JobKey::Start => self.start(order, view, out),
            JobKey::Accept => {
                out.push(Command::Order(OrderCommand::Accept(OrderProposal::from(order))));
            }
            JobKey::Close => out.push(Command::Order(OrderCommand::Close(order.number))),
            JobKey::Delete => self.question.ask(JobQuestion::Delete(order.number), delete_question(order)),
            JobKey::Report => {
                let text = report::html(view.lang, view.snapshot, order);
                out.push(file_command(Requester::Screen, FileRequest::SaveReport(text)));
            }
            JobKey::Enter => {}
        }
    }

    fn input(&self, rect: Rect, view: &View<'_>) {
        let Some(field) = FIELDS.get(self.cursor) else {
            let words = view.text("输入：执行", "INPUT: act");
            let label = self.key_in_place(KEYS[self.cursor - FIELDS.len()], view).label().get(view.lang);
            return input_line::ui(view, rect, &self.typing, &InputPrompt { label, name: "", range: words });
        };
        let (least, most) = (field.range.start(), field.range.end());
        let range = format!("{} {least} … {most}", view.text("范围", "range"));
        let label = format!("{}=", field.name.get(view.lang));
        input_line::ui(view, rect, &self.typing, &InputPrompt { label: &label, name: "", range: &range });
    }
}

/// One order of the list.
fn row(view: &View<'_>, place: Rect, order: &ProductionOrder, chosen: bool) {
    view.row_card(place, chosen);
    let [number, program, made, bad, state] = place.trim_sides(theme::PAD).columns(COLUMNS);
    view.fit_left(number, &order.number.to_string(), theme::LABEL, view.theme.text);
    let current = order.program == view.snapshot.program.number;
    let ink = if order.state == OrderState::Active && !current { view.theme.alarm_text } else { view.theme.text };
    view.fit_left(program, &view.snapshot.title(order.program), theme::LABEL, ink);
    view.fit_left(made, &format!("{} / {}", order.good, order.target), theme::LABEL, view.theme.text);
    let share = (u64::from(order.good.min(order.target)) * 1_000 / u64::from(order.target.max(1))) as u16;
    widget::progress_bar(view, made.trim_bottom(5.0).split_bottom(4.0).1, share);
    let ink = if order.bad > 0 { view.theme.alarm_text } else { view.theme.muted };
    view.fit_left(bad, &order.bad.to_string(), theme::LABEL, ink);
    view.fit_left(state, order.state.name().get(view.lang), theme::LABEL, state_ink(view, order));
}

const fn state_ink(view: &View<'_>, order: &ProductionOrder) -> Color32 {
    match order.state {
        OrderState::Active if order.is_complete() => view.theme.hold,
        OrderState::Active => view.theme.run,
        OrderState::Waiting => view.theme.text,
        OrderState::Proposed => view.theme.focus,
        OrderState::Closed => view.theme.muted,
    }
}

fn delete_question(order: &ProductionOrder) -> Question {
    let &ProductionOrder { number, good, bad, .. } = order;
    let body = phrase!(
        "订单 {number}：合格 {good} 件，不良 {bad} 件。删除后不再有它的报告；需要时先存报告。",
        "Order {number}: {good} good parts, {bad} bad. Its report is gone then; save it first if needed.",
        number,
        good,
        bad
    );
    Question::new(Text::new("删除订单？", "delete the order?"), body, ("question-delete", Text::new("删除", "DELETE")))
}

/// The finished parts of an order that are still kept, oldest first.
fn parts_of<'a>(snapshot: &'a Snapshot, order: &ProductionOrder) -> impl Iterator<Item = &'a PartRecord> + use<'a> {
    let order = *order;
    snapshot.production.parts.iter().filter(move |part| order.has(part))
}
