//! What is still missing for the next cycle start, for the strip of the start guide.
//! Source: spec K2.2, B5, H7.

use crate::defs::key::Key;
use crate::defs::page::Page;
use crate::defs::start_step::StartStep;
use crate::defs::text::LocalizedText;

/// The state of one condition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StepState {
    /// The machine does not have it.
    #[default]
    Absent,
    /// The chosen program does not need it.
    NotNeeded,
    /// It is met.
    Met,
    /// It is on its way.
    Pending,
    /// It is missing.
    Missing,
}

/// What the operator does for a condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepAction {
    /// Press a key that selects or switches: a touch of the strip presses it, too.
    Press(Key),
    /// Press a key that moves an axis or starts the program: only on the panel.
    PressOnPanel(Key),
    /// Open a page; a variable of the grinding page is handed over.
    Open(Page, Option<u16>),
}

/// One condition.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepView {
    /// Whether it is met.
    pub state: StepState,
    /// Why it is not.
    pub reason: LocalizedText,
    /// What the operator does; none: the reason says it.
    pub action: Option<StepAction>,
}

/// The conditions of the next cycle start.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StartGuide {
    /// In the order of [`StartStep::ALL`]. All are absent while a run is open.
    pub steps: [StepView; StartStep::ALL.len()],
}

impl StartGuide {
    /// One condition.
    #[must_use]
    pub fn step(&self, step: StartStep) -> &StepView {
        &self.steps[step as usize]
    }

    /// The conditions that the machine has.
    pub fn present(&self) -> impl Iterator<Item = (StartStep, &StepView)> {
        StartStep::ALL.into_iter().zip(&self.steps).filter(|(_, view)| view.state != StepState::Absent)
    }

    /// The first condition that is not met.
    #[must_use]
    pub fn next(&self) -> Option<(StartStep, &StepView)> {
        self.present().find(|(_, view)| matches!(view.state, StepState::Missing | StepState::Pending))
    }

    /// The variable whose value the chosen program refuses.
    #[must_use]
    pub fn refused_variable(&self) -> Option<u16> {
        match self.step(StartStep::Values).action {
            Some(StepAction::Open(_, variable)) => variable,
            Some(StepAction::Press(_) | StepAction::PressOnPanel(_)) | None => None,
        }
    }

    /// Whether cycle start would start the program.
    #[must_use]
    pub fn is_ready(&self) -> bool {
        self.present().next().is_some() && self.next().is_none()
    }

    /// The key of the panel that comes next; cycle start if nothing is missing.
    #[must_use]
    pub fn next_key(&self) -> Option<Key> {
        match self.next() {
            Some((_, StepView { state: StepState::Missing, action, .. })) => match *action {
                Some(StepAction::Press(key) | StepAction::PressOnPanel(key)) => Some(key),
                Some(StepAction::Open(..)) | None => None,
            },
            Some(_) => None,
            None => self.is_ready().then_some(Key::CycleStart),
        }
    }
}
