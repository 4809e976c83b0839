//! The part of the last cycle, at the end of the program: size, tolerance, verdict and time. It stays until the next
//! cycle start or until it is touched away.
//! Source: spec K7.2, K4.5, H8.

use std::borrow::Cow;

use egui::{Color32, Rect, vec2};

use crate::hmi::{Area, View, format_cycle_time, keycap, theme};
use crate::link::Snapshot;
use crate::link::part_result::{JudgedSize, PartResult, PartVerdict};
use crate::units::Micros;

/// Height of the card, points.
pub const HEIGHT: f32 = 118.0;

/// Which result was touched away.
#[derive(Debug, Default)]
pub struct PartCard {
    dismissed: Option<Micros>,
}

impl PartCard {
    /// The result to be shown: of the program whose page is open.
    pub fn shown<'a>(&self, snapshot: &'a Snapshot) -> Option<&'a PartResult> {
        snapshot
            .cycle
            .part
            .as_ref()
            .filter(|part| part.program == snapshot.program.number && self.dismissed != Some(part.ended_at))
    }

    /// The result is not shown any more; false if there was none.
    pub fn dismiss(&mut self, snapshot: &Snapshot) -> bool {
        let Some(part) = self.shown(snapshot) else { return false };
        self.dismissed = Some(part.ended_at);
        true
    }

    /// Draws the card; a touch dismisses it.
    pub fn ui(&mut self, rect: Rect, view: &View<'_>) {
        let Some(part) = self.shown(view.snapshot) else { return };
        let size = part.judged_size(view.snapshot.simulated.as_deref());
        let (verdict, ink) = verdict(view, part);
        let response = keycap::plain(view, rect, "part-result", format!("{verdict} part-result"));
        view.edge_bar(rect, ink);
        let inside = rect.shrink2(vec2(10.0, 5.0));
        let head = inside.band(0.0, 22.0);
        let title = format!("{} {}", view.text("工件", "part"), part.number);
        view.fit_left(head.trim_right(80.0), &title, theme::LABEL, view.theme.muted);
        let time = format_cycle_time(part.times.seconds);
        view.line_right(head, "×", theme::TITLE, view.theme.muted);
        view.line_right(head.trim_right(24.0), &time, theme::LABEL, view.theme.text);
        let figure = inside.band(24.0, 36.0);
        match size {
            Some(size) => {
                let taken = view.line_left(figure, &view.length(size.mm()), theme::FIGURE, view.theme.text);
                view.fit_right(figure.with_min_x(taken.max.x + theme::GAP), &verdict, theme::TITLE, ink);
            }
            None => drop(view.fit_left(figure, &verdict, theme::SECONDARY, ink)),
        }
        view.fit_left(inside.band(64.0, 20.0), &tolerance(view, part), theme::LABEL, view.theme.muted);
        let foot = inside.band(86.0, 20.0);
        let source = match size {
            Some(JudgedSize::Measured(_)) => Cow::Borrowed(view.text("实测", "measured")),
            Some(JudgedSize::Simulated(compared)) => {
                format!("{} {}", view.text("仿真", "simulated"), compared.worst.name.get(view.lang)).into()
            }
            None => Cow::Borrowed(""),
        };
        view.fit_left(foot, &source, theme::LABEL, view.theme.muted);
        if response.clicked() {
            self.dismiss(view.snapshot);
        }
    }
}

/// The verdict and its colour.
fn verdict(view: &View<'_>, part: &PartResult) -> (String, Color32) {
    let verdict = part.verdict(view.snapshot.simulated.as_deref());
    let ink = match verdict {
        PartVerdict::Good => view.theme.run,
        PartVerdict::Spoilt(_) | PartVerdict::Out { .. } => view.theme.alarm_text,
        PartVerdict::NoTolerance | PartVerdict::NotMeasured => view.theme.muted,
    };
    (verdict.name().get(view.lang).to_owned(), ink)
}

/// `40.000 +0.005 -0.015`
fn tolerance(view: &View<'_>, part: &PartResult) -> String {
    let Some(nominal) = part.nominal else { return view.text("没有公称尺寸", "no nominal size").to_owned() };
    let words = view.length(nominal.mm);
    match nominal.limits {
        Some((low, high)) => format!("{words} {:+.3} {:+.3}", high - nominal.mm, low - nominal.mm),
        None => format!("{} {words}", view.text("公称", "nominal")),
    }
}
