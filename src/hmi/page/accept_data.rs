//! Deciding about retained data after damage or loss (alarms 300 and 305): a key on the alarm page, the choice between the
//! data in force, an earlier state and factory values, a question with the consequence, the builder's password.
//! Source: safety stance; spec B6.

use egui::{Rect, pos2, vec2};

use crate::defs::alarm;
use crate::defs::param::AccessLevel;
use crate::defs::text::{Text, phrase};
use crate::hmi::{Area, EditKey, GuardedQuestion, KeyboardFocus, Login, PageKey, Question, View, theme, widget};
use crate::link::Command;
use crate::link::page_command::{DataChoice, KeptState, PageCommand};

/// Choices in a row.
const COLUMNS: usize = 4;
/// Height of a row of choices, points.
const ROW: f32 = 60.0;

/// State of the key, its choices, its question and its password.
#[derive(Debug, Default)]
pub struct AcceptData {
    /// The choices, while they are shown.
    choices: Option<KeyboardFocus>,
    /// What the question asks about.
    chosen: Option<DataChoice>,
    question: GuardedQuestion,
}

impl AcceptData {
    /// Whether there is something to decide.
    pub fn is_due(view: &View<'_>) -> bool {
        is_lost(view) || view.snapshot.alarms.iter().any(|alarm| alarm.number == alarm::VALUES_DROPPED)
    }

    /// Whether the choices or the question are open and take the input.
    pub const fn is_open(&self) -> bool {
        self.choices.is_some() || self.question.is_open()
    }

    /// Draws the key; a touch opens the choices, or the question where there is nothing to choose.
    pub fn key(&mut self, rect: Rect, view: &View<'_>) {
        if widget::button(view, rect, PageKey::new("accept-data", view.text("接受数据", "ACCEPT DATA"))) {
            match is_lost(view) {
                true => self.choices = Some(KeyboardFocus::default()),
                false => self.ask(DataChoice::Present),
            }
        }
    }

    fn ask(&mut self, choice: DataChoice) {
        self.question.ask(question(&choice));
        self.chosen = Some(choice);
    }

    /// Draws choices and question; sends the decision once the builder's level is unlocked.
    pub fn ui(&mut self, rect: Rect, view: &View<'_>, edits: &[EditKey], login: &mut Login, out: &mut Vec<Command>) {
        if let Some(focus) = &mut self.choices {
            if edits.contains(&EditKey::Cancel) {
                self.choices = None;
            } else if let Some(touched) = choose(rect, view, edits, focus) {
                self.choices = None;
                touched.into_iter().for_each(|choice| self.ask(choice));
            }
            return;
        }
        let is_accepted = self.question.ui(rect, view, edits, (AccessLevel::Builder, login));
        let chosen = if is_accepted { self.chosen.take() } else { None };
        out.extend(chosen.map(|choice| Command::Page(PageCommand::AcceptData(choice))));
    }
}

/// Whether data were damaged or lost, so that others may take their place.
fn is_lost(view: &View<'_>) -> bool {
    view.snapshot.alarms.iter().any(|alarm| alarm.number == alarm::RETAINED_DATA_DAMAGED)
}

/// What is asked before a choice is made, with its consequence.
fn question(choice: &DataChoice) -> Question {
    match choice {
        DataChoice::Present => Question::new(
            Text::new("接受现在的数据？", "accept the data as they are?"),
            phrase!(
                "参数、刀补、修整点、坐标系、螺距补偿和变量可能是旧值或出厂值：已逐项核对，或从备份恢复了。",
                "Parameters, offsets, dressing points, work offsets, leadscrew tables and variables may be old or factory \
                 values: they have been checked one by one, or restored from a backup."
            ),
            ("accept-yes", Text::new("接受", "ACCEPT")),
        ),
        DataChoice::Kept(KeptState { time, .. }) => Question::new(
            Text::new("换成以前的数据？", "take earlier data?"),
            phrase!(
                "下次启动用 {time} 的参数、刀补、修整点、坐标系、螺距补偿和变量。到那时为止改的值不再用。\
                     启动后核对并接受。密码和报警记录保留。",
                "At the next start parameters, offsets, dressing points, work offsets, leadscrew tables and \
                     variables of {time} are used. What is changed until then is lost. Check and accept them then. \
                     Passwords and the alarm history stay.",
                time
            ),
            ("accept-yes", Text::new("更换", "REPLACE")),
        ),
        DataChoice::Factory => Question::new(
            Text::new("换成出厂值？", "take factory values?"),
            phrase!(
                "下次启动用出厂值：参数、刀补、修整点、坐标系、螺距补偿和变量都要重新设定。到那时为止改的值不再用。\
                 启动后核对并接受。密码和报警记录保留。",
                "At the next start factory values are used: parameters, offsets, dressing points, work offsets, leadscrew \
                 tables and variables must be set again. What is changed until then is lost. Check and accept them then. \
                 Passwords and the alarm history stay."
            ),
            ("accept-yes", Text::new("更换", "REPLACE")),
        ),
    }
}

/// Draws the choices. Returns the one that is touched; `Some(None)` for CANCEL (取消).
fn choose(rect: Rect, view: &View<'_>, edits: &[EditKey], focus: &mut KeyboardFocus) -> Option<Option<DataChoice>> {
    let kept = view.snapshot.kept_states.iter().cloned().map(DataChoice::Kept);
    let choices: Vec<DataChoice> =
        std::iter::once(DataChoice::Present).chain(kept).chain(std::iter::once(DataChoice::Factory)).collect();
    let rows = choices.len().div_ceil(COLUMNS);
    let place = view.dialog(rect, "data-veil", vec2(880.0, 190.0 + ROW * rows as f32), view.theme.hold);
    let (title, rest) = place.shrink2(vec2(20.0, 14.0)).split_top(32.0);
    view.fit_left(title, view.text("用哪份数据？", "which data are used?"), theme::SECONDARY, view.theme.text);
    let (body, rest) = rest.split_top(76.0);
    let explained = view.text(
        "现在的数据立即接受（从备份恢复后也选它）；其他的从下次启动起用。",
        "The present data are accepted at once (also after a restore from a backup), the others come with the next start.",
    );
    view.paragraph(body.trim_top(6.0), explained, theme::LABEL, view.theme.text);
    let (grid, bottom) = rest.split_bottom(56.0);
    focus.begin_frame(edits);
    let width = (grid.width() + theme::GAP) / COLUMNS as f32;
    let mut touched = None;
    for (index, choice) in choices.into_iter().enumerate() {
        let corner = pos2(grid.min.x + (index % COLUMNS) as f32 * width, grid.min.y + (index / COLUMNS) as f32 * ROW);
        let place = Rect::from_min_size(corner, vec2(width - theme::GAP, ROW - theme::GAP));
        let (name, label) = match &choice {
            DataChoice::Present => ("data-present".to_owned(), view.text("现在的数据", "PRESENT DATA").to_owned()),
            DataChoice::Kept(state) => (format!("data-kept-{}", state.number), state.time.clone()),
            DataChoice::Factory => ("data-factory".to_owned(), view.text("出厂值", "FACTORY").to_owned()),
        };
        if focus.button(view, place, PageKey::new(&name, &label)) {
            touched = Some(Some(choice));
        }
    }
    let cancel = Rect::from_min_max(pos2(bottom.max.x - 170.0 + theme::GAP, bottom.min.y + 4.0), bottom.max);
    if focus.button(view, cancel, PageKey::new("data-cancel", view.text("取消", "CANCEL"))) {
        touched = Some(None);
    }
    touched
}
