//! Checklist of commissioning: every connected input and output is seen off and on, then confirmed by the fitter.
//!
//! What is seen is the signal itself, as the control reads or sets it; that the right device moved is what the fitter
//! confirms. The list is kept until power-off and saved as a table.
//! Source: issue "a real machine", part 6; docs/manual/first_start.md.

use std::fmt::Write;

use egui::Rect;

use crate::defs::fitted::Fitted;
use crate::defs::param::Params;
use crate::defs::signal::{Input, Output};
use crate::defs::text::{Text, phrase};
use crate::hmi::page::{Scroll, ScrollList};
use crate::hmi::{Area, EditKey, KeyboardInput, PageKey, Question, QuestionDialog, View, file_command, theme, widget};
use crate::link::files::{FileRequest, Requester};
use crate::link::{Command, Snapshot};

/// Height of a row: it is touched.
const ROW_HEIGHT: f32 = 44.0;
const HEADING_HEIGHT: f32 = 28.0;
/// Column shares: state, input or output, name, port, seen off, seen on, result.
const COLUMN_SHARES: [f32; 7] = [54.0, 70.0, 200.0, 60.0, 60.0, 60.0, 190.0];

/// An input or an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CheckedSignal {
    Input(Input),
    Output(Output),
}

impl CheckedSignal {
    /// Those of a machine that have a port.
    fn connected(fitted: Fitted, params: &Params) -> impl Iterator<Item = Self> {
        let inputs = Input::ALL.iter().filter(move |input| input.exists_on(fitted) && params.input_port(**input) > 0);
        let outputs =
            Output::ALL.iter().filter(move |output| output.exists_on(fitted) && params.output_port(**output) > 0);
        inputs.map(|input| Self::Input(*input)).chain(outputs.map(|output| Self::Output(*output)))
    }

    const fn index(self) -> usize {
        match self {
            Self::Input(input) => input as usize,
            Self::Output(output) => Input::COUNT + output as usize,
        }
    }

    fn port(self, params: &Params) -> u8 {
        match self {
            Self::Input(input) => params.input_port(input),
            Self::Output(output) => params.output_port(output),
        }
    }

    const fn is_on(self, snapshot: &Snapshot) -> bool {
        match self {
            Self::Input(input) => snapshot.inputs.has(input),
            Self::Output(output) => snapshot.outputs.has(output),
        }
    }

    const fn name(self) -> Text {
        match self {
            Self::Input(input) => input.name(),
            Self::Output(output) => output.name(),
        }
    }

    const fn id(self) -> &'static str {
        match self {
            Self::Input(input) => input.id(),
            Self::Output(output) => output.id(),
        }
    }

    const fn group(self) -> Text {
        match self {
            Self::Input(_) => Text::new("输入", "input"),
            Self::Output(_) => Text::new("输出", "output"),
        }
    }
}

/// What was seen of a signal.
#[derive(Clone, Copy, Debug, Default)]
struct SeenLevels {
    off: bool,
    on: bool,
    is_confirmed: bool,
}

/// State of the list.
#[derive(Debug)]
pub struct Checklist {
    is_running: bool,
    seen: [SeenLevels; Input::COUNT + Output::COUNT],
    cursor: usize,
    scroll: Scroll,
    question: QuestionDialog<()>,
}

impl Default for Checklist {
    fn default() -> Self {
        Self {
            is_running: false,
            seen: [SeenLevels::default(); Input::COUNT + Output::COUNT],
            cursor: 0,
            scroll: Scroll::default(),
            question: QuestionDialog::default(),
        }
    }
}

impl Checklist {
    /// Takes in the signals of a snapshot.
    pub fn record(&mut self, snapshot: &Snapshot) {
        if !self.is_running {
            return;
        }
        for signal in CheckedSignal::connected(snapshot.fitted(), &snapshot.params) {
            let seen = &mut self.seen[signal.index()];
            match signal.is_on(snapshot) {
                true => seen.on = true,
                false => seen.off = true,
            }
        }
    }

    /// Draws the list and its keys.
    pub fn ui(&mut self, rect: Rect, view: &View<'_>, typed: &KeyboardInput, out: &mut Vec<Command>) {
        let (body, keys) = rect.split_bottom(widget::KEYS_HEIGHT);
        let (heading, body) = body.trim_bottom(theme::GAP).split_top(HEADING_HEIGHT);
        let signals: Vec<CheckedSignal> =
            CheckedSignal::connected(view.snapshot.fitted(), &view.snapshot.params).collect();
        self.heading(heading, view, &signals);
        if self.is_running {
            self.rows(body, view, typed, &signals);
        } else {
            let words = view.text(
                "开始后：动作每个开关，按键接通每个输出。看到断和通以后，点该行确认动作的是正确的元件。",
                "BEGIN, then work every switch and switch every output by its key. When off and on have been seen, touch its row if the right device moved.",
            );
            view.note(body, words);
        }
        let start = if self.is_running { view.text("重新开始", "RESTART") } else { view.text("开始", "BEGIN") };
        let save = PageKey::new("check-save", view.text("存为 CSV", "SAVE CSV")).locked(!self.is_running);
        let is_entered = !self.is_running && typed.edits.contains(&EditKey::Enter);
        if widget::button(view, keys.cell(0, 2), PageKey::new("check-start", start)) || is_entered {
            match self.is_running {
                true => self.question.ask((), restart_question()),
                false => self.start(),
            }
        }
        if widget::button(view, keys.cell(1, 2), save) && self.is_running {
            let table = FileRequest::SaveTable(self.csv(&view.snapshot.params, &signals));
            out.push(file_command(Requester::Screen, table));
        }
        if let Some(((), Some(_))) = self.question.ui(rect, view, &typed.edits) {
            self.start();
        }
    }

    fn start(&mut self) {
        *self = Self { is_running: true, ..Self::default() };
    }

    /// How many are confirmed, and how many have been seen off and on.
    fn heading(&self, rect: Rect, view: &View<'_>, signals: &[CheckedSignal]) {
        let count = |wanted: fn(&SeenLevels) -> bool| {
            signals.iter().filter(|signal| wanted(&self.seen[signal.index()])).count()
        };
        let (confirmed, both) = (count(|seen| seen.is_confirmed), count(|seen| seen.off && seen.on));
        let all = signals.len();
        let title = view.text("输入输出核对", "check of inputs and outputs");
        let taken = view.fit_left(rect, title, theme::LABEL, view.theme.muted);
        let words = format!(
            "{} {both}/{all}  ·  {} {confirmed}/{all}",
            view.text("已见断和通", "seen off and on"),
            view.text("已确认", "confirmed")
        );
        let ink = if confirmed == all { view.theme.run } else { view.theme.text };
        view.fit_right(rect.with_min_x(taken.max.x + theme::GAP), &words, theme::LABEL, ink);
    }

    fn rows(&mut self, rect: Rect, view: &View<'_>, typed: &KeyboardInput, signals: &[CheckedSignal]) {
        let is_asking = self.question.is_open();
        for edit in typed.edits.iter().filter(|_| !is_asking) {
            if let Some(next) = edit.step(self.cursor, signals.len(), 1) {
                self.cursor = next;
            } else if *edit == EditKey::Enter
                && let Some(signal) = signals.get(self.cursor)
            {
                self.confirm(*signal);
            }
        }
        let rect = widget::round_to_lines(rect, ROW_HEIGHT);
        let list = ScrollList { id: "checklist", rect, row: ROW_HEIGHT, gap: 4.0, count: signals.len() };
        let (clipped, rows) = self.scroll.rows(view, &list, typed.scroll_pages);
        for (index, place) in rows {
            if self.row(place, &clipped, signals[index], index == self.cursor) {
                self.cursor = index;
                self.confirm(signals[index]);
            }
        }
    }

    /// The fitter confirms a signal that has been seen off and on, or takes it back.
    fn confirm(&mut self, signal: CheckedSignal) {
        let seen = &mut self.seen[signal.index()];
        seen.is_confirmed = seen.off && seen.on && !seen.is_confirmed;
    }

    /// True if it is touched.
    fn row(&self, rect: Rect, view: &View<'_>, signal: CheckedSignal, has_focus: bool) -> bool {
        let seen = self.seen[signal.index()];
        let (name, group) = (signal.name().get(view.lang), signal.group().get(view.lang));
        let key = ("check-row", signal.index());
        let response = view.touch_row(rect, key, seen.is_confirmed, format!("{group} {name} check-{}", signal.id()));
        view.card(rect);
        if has_focus {
            view.frame(rect, view.theme.focus);
        }
        let [state, kind, title, port, off, on, result] = rect.trim_sides(8.0).columns(COLUMN_SHARES);
        widget::lamp(view, state, signal.is_on(view.snapshot));
        view.fit_left(kind, group, theme::LABEL, view.theme.muted);
        view.fit_left(title, name, theme::LABEL, view.theme.text);
        view.fit_left(port, &signal.port(&view.snapshot.params).to_string(), theme::LABEL, view.theme.muted);
        for (place, was_seen, level) in [(off, seen.off, "0"), (on, seen.on, "1")] {
            let words = if was_seen { format!("{level} ✓") } else { format!("{level} –") };
            let ink = if was_seen { view.theme.run } else { view.theme.muted };
            view.fit_left(place, &words, theme::LABEL, ink);
        }
        let (words, ink) = match seen {
            SeenLevels { is_confirmed: true, .. } => (view.text("✓ 已确认", "✓ confirmed"), view.theme.run),
            SeenLevels { off: true, on: true, .. } => (view.text("点此确认", "touch to confirm"), view.theme.info),
            SeenLevels { .. } => (view.text("还没有变化", "no change yet"), view.theme.muted),
        };
        view.fit_left(result, words, theme::LABEL, ink);
        response.clicked()
    }

    /// One line per signal.
    fn csv(&self, params: &Params, signals: &[CheckedSignal]) -> String {
        let mut text = "signal,id,port,seen_off,seen_on,confirmed\r\n".to_owned();
        for signal in signals {
            let SeenLevels { off, on, is_confirmed } = self.seen[signal.index()];
            let (group, id, port) = (signal.group().en, signal.id(), signal.port(params));
            let yes = |flag: bool| if flag { "yes" } else { "no" };
            // Writing to a string does not fail.
            let _ = write!(text, "{group},{id},{port},{},{},{}\r\n", yes(off), yes(on), yes(is_confirmed));
        }
        text
    }
}

fn restart_question() -> Question {
    let body = phrase!(
        "已见和已确认的全部清除；需要时先存为 CSV。",
        "What was seen and confirmed is cleared; SAVE CSV first if needed."
    );
    Question::new(
        Text::new("重新核对？", "start the check again?"),
        body,
        ("question-check", Text::new("重新开始", "RESTART")),
    )
}
