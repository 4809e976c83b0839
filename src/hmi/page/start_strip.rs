//! The strip of the start guide: what is still missing for the next cycle start, in the order of doing it. A touch of a
//! condition does it where that is allowed from the screen, and says why it is missing.
//! Source: spec K2.2, B5, H3, H7.

use egui::{Color32, Rect, Stroke, pos2, vec2};

use super::{FieldGroup, HandOver, PageContext, run_bar, shown_fields};
use crate::defs::key::Key;
use crate::defs::page::Page;
use crate::defs::start_step::StartStep;
use crate::hmi::{Area, View, pictogram, theme};
use crate::link::start_guide::{StepAction, StepState, StepView};
use crate::link::{Command, Snapshot};
use crate::units::Micros;

/// Height of the strip, points: a touch target with two lines of words.
pub const HEIGHT: f32 = 56.0;
/// Width of one condition: the names of all languages fit.
const STEP_WIDTH: f32 = 62.0;
/// Least width of the words beside the conditions.
const WORDS_WIDTH: f32 = 150.0;
/// Radius of the mark of a condition.
const MARK: f32 = 9.0;
/// How long the words of a touched condition stay.
const ASKED_FOR: Micros = Micros::from_millis(6_000);

/// The condition whose words are shown because it was touched, as it was then.
#[derive(Debug, Default)]
pub struct StartStrip {
    asked: Option<(StartStep, StepState, Micros)>,
}

fn is_shown_on(page: Page) -> bool {
    shown_fields(page).contains(&FieldGroup::StartGuide)
}

/// Whether something of the guide blinks: a condition on its way, or the key that comes next.
#[must_use]
pub fn blinks(snapshot: &Snapshot) -> bool {
    is_shown_on(snapshot.page) && snapshot.start_guide.next().is_some()
}

/// The key that the panel marks as the next one, on pages with the strip.
#[must_use]
pub fn marked_key(snapshot: &Snapshot) -> Option<Key> {
    is_shown_on(snapshot.page).then(|| snapshot.start_guide.next_key()).flatten()
}

impl StartStrip {
    /// Draws the strip, in a run the run bar, and handles its touches. Returns the variable of this page that is to be changed, if its
    /// condition was touched.
    pub fn ui(&mut self, rect: Rect, ctx: &mut PageContext<'_>) -> Option<u16> {
        let view = ctx.view;
        let guide = &view.snapshot.start_guide;
        let count = guide.present().count();
        if count == 0 {
            run_bar::ui(rect, view);
            return None;
        }
        let mut wanted = None;
        view.card(rect);
        let inside = rect.trim_sides(theme::GAP);
        let width = STEP_WIDTH.min((inside.width() - WORDS_WIDTH) / count as f32);
        let (steps, words) = inside.split_left(width * count as f32);
        let next = guide.next().map(|(step, _)| step);
        for (index, (step, state)) in guide.present().enumerate() {
            let place = Rect::from_min_size(steps.min + vec2(index as f32 * width, 0.0), vec2(width, rect.height()));
            if index + 1 < count {
                let y = mark_centre(place).y;
                let line = place.center().x + MARK + 3.0..=place.center().x + width - MARK - 3.0;
                view.painter.hline(line, y, Stroke::new(theme::FRAME, view.theme.line));
            }
            if step_ui(view, place, step, state, next == Some(step)) {
                self.asked = Some((step, state.state, view.snapshot.now));
                wanted = act(state, ctx);
            }
        }
        self.asked = self.asked.filter(|(step, then, since)| {
            guide.step(*step).state == *then && view.snapshot.now.since(*since) < ASKED_FOR
        });
        let shown = self.asked.map(|(step, ..)| step).or(next);
        say(view, words.trim_left(theme::PAD), shown);
        wanted
    }
}

/// Does what a touch of the strip may do; a variable of the open page is left to the page.
fn act(state: &StepView, ctx: &mut PageContext<'_>) -> Option<u16> {
    if state.state != StepState::Missing {
        return None;
    }
    match state.action {
        Some(StepAction::Press(key)) => ctx.out.extend([Command::Press(key), Command::Release(key)]),
        Some(StepAction::Open(page, variable)) if page == ctx.view.snapshot.page => return variable,
        Some(StepAction::Open(page, variable)) => {
            *ctx.hand_over = variable.map(HandOver::Variable);
            ctx.out.push(Command::OpenPage(page));
        }
        Some(StepAction::PressOnPanel(_)) | None => {}
    }
    None
}

fn mark_centre(place: Rect) -> egui::Pos2 {
    pos2(place.center().x, place.min.y + 17.0)
}

/// Draws a condition; true if it is touched.
fn step_ui(view: &View<'_>, place: Rect, step: StartStep, state: &StepView, is_next: bool) -> bool {
    let name = format!("{} guide-{}", step.name().get(view.lang), step.id());
    let response = view.touch(place, ("start-step", step as u8), name);
    if response.is_pointer_button_down_on() {
        view.painter.rect_filled(place.shrink(1.0), theme::RADIUS, view.theme.raised);
    }
    let (centre, theme) = (mark_centre(place), view.theme);
    let ring = |colour: Color32| view.painter.circle_stroke(centre, MARK, Stroke::new(theme::FRAME, colour));
    let square = Rect::from_center_size(centre, vec2(16.0, 16.0));
    let ink = match state.state {
        StepState::Met => {
            view.painter.circle_filled(centre, MARK, theme.run);
            pictogram::draw(&view.painter, square, pictogram::CHECK, theme.on_accent);
            theme.muted
        }
        StepState::Pending => {
            ring(theme.info);
            if view.blink {
                view.painter.circle_filled(centre, MARK - 4.0, theme.info);
            }
            theme.text
        }
        StepState::Missing => {
            if is_next {
                view.painter.circle_filled(centre, MARK, theme.hold);
            } else {
                ring(theme.hold);
            }
            let ink = if is_next { theme.on_accent } else { theme.hold };
            view.line_centre(square, "!", theme::LABEL, ink);
            if is_next { theme.text } else { theme.muted }
        }
        StepState::NotNeeded | StepState::Absent => {
            ring(theme.line);
            theme.muted
        }
    };
    let label = Rect::from_min_max(pos2(place.min.x, centre.y + MARK + 2.0), place.max - vec2(0.0, 2.0));
    view.fit_centre(label.trim_sides(1.0), step.name().get(view.lang), theme::SMALL, ink);
    response.clicked()
}

/// What is to be done, and why; that everything is ready.
fn say(view: &View<'_>, rect: Rect, shown: Option<StartStep>) {
    let guide = &view.snapshot.start_guide;
    let Some((step, state)) = shown.map(|step| (step, guide.step(step))) else {
        let start = Key::CycleStart.label().get(view.lang);
        let words = format!("{} {start}", view.text("可以启动：按", "ready: press"));
        view.fit_left(rect, &words, theme::TITLE, view.theme.run);
        return;
    };
    let lang = view.lang;
    let press = |key: Key| format!("{} {}", view.text("按", "press"), key.label().get(lang));
    let order = match (state.state, state.action) {
        (StepState::Met, _) => format!("{}：{}", step.name().get(lang), view.text("已就绪", "ready")),
        (StepState::NotNeeded, _) => {
            format!("{}：{}", step.name().get(lang), view.text("本程序不需要", "not needed by the program"))
        }
        (StepState::Pending, _) => view.text("请稍候", "wait").to_owned(),
        (StepState::Missing, Some(StepAction::Press(key) | StepAction::PressOnPanel(key))) => press(key),
        (StepState::Missing, Some(StepAction::Open(_, Some(variable)))) => {
            format!("{} {}", view.text("修改", "change"), view.variable_name(variable))
        }
        (StepState::Missing, Some(StepAction::Open(page, None))) if page == view.snapshot.page => String::new(),
        (StepState::Missing, Some(StepAction::Open(page, None))) => {
            format!("{} {}", view.text("打开", "open"), page.title().get(lang))
        }
        (StepState::Missing, None) | (StepState::Absent, _) => String::new(),
    };
    let reason = state.reason.get(lang);
    if reason.is_empty() {
        view.fit_left(rect, &order, theme::TITLE, view.theme.text);
    } else if order.is_empty() {
        view.text_rows(rect.shrink2(vec2(0.0, 6.0)), &reason, theme::LABEL, view.theme.text, 2);
    } else {
        let inside = rect.shrink2(vec2(0.0, 2.0));
        let is_long = view.layout_line(&reason, theme::SMALL, view.theme.muted, inside.width()).elided;
        let (above, below) = inside.split_top(if is_long { 18.0 } else { 24.0 });
        view.fit_left(above, &order, if is_long { theme::LABEL } else { theme::TITLE }, view.theme.text);
        view.text_rows(below, &reason, theme::SMALL, view.theme.muted, 2);
    }
}
