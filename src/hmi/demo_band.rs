//! What spectators of a demonstration see below the page: the caption of the story, that a touch takes over, and how long it
//! is until the story goes on.
//! Source: spec T2; issue "the face", part 9.

use std::f32::consts::{FRAC_PI_2, TAU};

use egui::{Align2, Color32, Event, Rect, Shape, Stroke, Ui, vec2};

use super::{Area, View, page_frame, theme};
use crate::link::demo_view::DemoView;

/// Height of the band at the lower edge of the page: two lines.
const HEIGHT: f32 = 76.0;
/// Width of what invites to a touch.
const INVITATION_WIDTH: f32 = 150.0;
/// How much of the page a title hides, its height, that of the name of the machine and of the rule below it.
const VEIL: f32 = 0.92;
const TITLE_HEIGHT: f32 = 220.0;
const TITLE_LETTERS: f32 = 64.0;
const TITLE_RULE: f32 = 28.0;
/// Radius of the ring, its width, and the points of a full one.
const RADIUS: f32 = 15.0;
const RING: f32 = 4.0;
const POINTS: u32 = 60;

/// The room of the page, and that of the band below it, if something is to be said.
pub fn split(content: Rect, demo: &DemoView) -> (Rect, Option<Rect>) {
    if matches!(demo, DemoView::Silent | DemoView::Title(_)) {
        return (content, None);
    }
    let (page, band) = content.split_bottom(HEIGHT);
    (page, Some(band))
}

/// Whether somebody has touched the screen or a key in this frame, wherever, while a demonstration runs.
pub fn takes_over(view: &View<'_>) -> bool {
    view.snapshot.host.demo != DemoView::Silent && is_touched(view.ui)
}

fn is_touched(ui: &Ui) -> bool {
    ui.input(|input| {
        let is_act = |event: &Event| {
            matches!(
                event,
                Event::PointerButton { pressed: true, .. } | Event::Key { pressed: true, .. } | Event::Text(_)
            )
        };
        input.events.iter().any(is_act)
    })
}

/// Draws the band.
pub fn ui(view: &View<'_>, band: Rect) {
    let band = band.trim_sides(theme::GAP).trim_bottom(theme::GAP);
    view.filled_card(band, view.theme.background, view.theme.focus);
    let band = band.shrink2(vec2(theme::PAD, 6.0));
    match &view.snapshot.host.demo {
        DemoView::Silent | DemoView::Title(_) => {}
        DemoView::Caption(caption) => {
            let (words, invitation) = band.split_right(INVITATION_WIDTH);
            view.text_rows(words.trim_right(theme::PAD), &caption.get(view.lang), theme::SECONDARY, view.theme.text, 2);
            let ink = if view.blink { view.theme.info } else { view.theme.muted };
            let centre = invitation.center();
            view.painter.circle_stroke(centre - vec2(0.0, 12.0), 11.0, Stroke::new(2.0, ink));
            view.painter.circle_filled(centre - vec2(0.0, 12.0), if view.blink { 6.0 } else { 4.0 }, ink);
            let below = Rect::from_center_size(centre + vec2(0.0, 17.0), vec2(invitation.width(), 22.0));
            view.fit(below, Align2::CENTER_CENTER, view.text("触摸试一试", "touch to try"), theme::LABEL, ink);
        }
        DemoView::TakenOver { seconds_left, of } => {
            let (ring, words) = band.split_left(2.0 * RADIUS + theme::PAD);
            let left = *seconds_left as f32 / (*of).max(1) as f32;
            paint_ring(view, ring, 1.0 - left);
            let text = format!(
                "{} {seconds_left} s",
                view.text(
                    "现在由您操作；不触摸时演示继续，还有",
                    "it is yours; without a touch the demonstration goes on in"
                )
            );
            view.text_rows(words.trim_left(theme::PAD), &text, theme::TITLE, view.theme.text, 2);
        }
    }
}

/// What the film shows next, in large letters over the page.
pub fn title(view: &View<'_>, page: Rect) {
    let DemoView::Title(title) = &view.snapshot.host.demo else { return };
    view.painter.rect_filled(page, 0.0, view.theme.background.gamma_multiply(VEIL));
    let room = Rect::from_center_size(page.center(), vec2(page.width() - 2.0 * theme::PAD, TITLE_HEIGHT));
    let (name, rest) = room.split_top(TITLE_LETTERS * 1.4);
    let (rule, words) = rest.split_top(TITLE_RULE);
    let machine = page_frame::machine_name(view);
    view.line(name, Align2::CENTER_CENTER, &machine, TITLE_LETTERS, view.theme.text);
    let rule = Rect::from_center_size(rule.center(), vec2(TITLE_LETTERS * 4.0, 2.0 * theme::FRAME));
    view.painter.rect_filled(rule, 0.0, view.theme.info);
    view.centred_text(words, &title.get(view.lang), theme::FIGURE, view.theme.text);
}

/// A ring that fills from the top, clockwise.
fn paint_ring(view: &View<'_>, rect: Rect, filled: f32) {
    let centre = rect.center();
    view.painter.circle_stroke(centre, RADIUS, Stroke::new(RING, view.theme.line));
    let count = (filled.clamp(0.0, 1.0) * POINTS as f32).round() as u32;
    let at = |point: u32| {
        let angle = TAU * point as f32 / POINTS as f32 - FRAC_PI_2;
        centre + RADIUS * vec2(angle.cos(), angle.sin())
    };
    let stroke: (f32, Color32) = (RING, view.theme.info);
    view.painter.add(Shape::line((0..=count).map(at).collect(), stroke));
}
