//! The screen at 150 % or 200 % of its size: the display shows a part of it. Beside that part, always in view: an overview
//! that moves it, and the keys that stop and start; below it the message line.
//! Source: spec H1, H9; issue "the face", part 12.

use egui::accesskit::Role;
use egui::{Id, Rect, Sense, Stroke, StrokeKind, Ui, UiBuilder, Vec2, WidgetInfo, vec2};

use super::key_press::KeyPresses;
use super::layout::Regions;
use super::panel::key_ui;
use super::panel::layout::{PanelLayout, panel_layout};
use super::{Area, View, numeric_pad, theme};
use crate::defs::fitted::Fitted;
use crate::defs::key::Key;
use crate::defs::page::Page;
use crate::defs::text::Text;
use crate::link::Command;
use crate::link::page_command::ZOOMS;

/// Width of the strip beside the part, or its height below it, points.
const STRIP: f32 = 92.0;
/// Least size of the whole screen: every page fits into it, points. Turned for a portrait display.
const LEAST: Vec2 = vec2(1_024.0, 768.0);
/// The keys of the strip and their shares of its length, after the overview; the last is where it is on the panel.
const KEYS: [(Key, f32); 4] =
    [(Key::CycleStart, 0.2), (Key::FeedHold, 0.2), (Key::Reset, 0.15), (Key::EmergencyStop, 0.25)];
const OVERVIEW_SHARE: f32 = 0.16;
/// Share of the strip between cycle start and the keys that stop.
const APART_SHARE: f32 = 0.04;
/// Share of the part by which a key moves it.
const STEP: f32 = 0.5;
/// Height of the rows of keys that the strip replaces, as a share of the panel.
const REPLACED_SHARE: f32 = 0.14;
/// Space around what is brought into view, points.
const MARGIN: f32 = 12.0;
/// Frames in which a page answers a touch or a key.
const ANSWER_FRAMES: u8 = 3;

/// Which part of the screen is shown, how large.
#[derive(Debug)]
pub struct ScreenZoom {
    percent: u16,
    /// The upper left corner of the part, from that of the whole screen, points.
    corner: Vec2,
    /// The page of the last frame, and whether something lies over it.
    page: Option<(Page, bool)>,
    /// The chosen field of the last frame, from the corner of the whole screen, and whether it was typed.
    chosen: Option<Rect>,
    is_typing: bool,
    /// Frames in which another field is brought into view.
    answers: u8,
    /// The size was changed since the last frame.
    is_changed: bool,
    /// When the part was last moved by itself, s, and whether the numeric pad was open then.
    moved: Option<(f64, bool)>,
}

impl Default for ScreenZoom {
    fn default() -> Self {
        Self {
            percent: ZOOMS[0],
            corner: Vec2::ZERO,
            page: None,
            chosen: None,
            is_typing: false,
            answers: 0,
            is_changed: false,
            moved: None,
        }
    }
}

/// What the page has in a frame.
#[derive(Clone, Copy, Debug)]
pub struct ZoomedPage {
    /// Something lies over it.
    pub is_covered: bool,
    /// A value is typed: the numeric pad is open.
    pub is_typing: bool,
    /// A key was typed for it.
    pub has_keys: bool,
}

/// The display of one frame: places on it, points.
#[derive(Clone, Copy, Debug)]
pub struct ZoomedScreen {
    /// The whole screen; the display shows a part of it.
    pub whole: Rect,
    /// That part.
    pub part: Rect,
    message: Rect,
    strip: Rect,
}

impl ZoomedScreen {
    /// The regions of the whole screen; the message line is below the part.
    fn regions(&self) -> Regions {
        let regions = Regions::new(self.whole);
        let content = regions.content.with_max_y(regions.message.max.y);
        Regions { content, message: self.message, ..regions }
    }

    /// The panel without the keys of the strip.
    fn panel(&self, machine: Fitted, regions: &Regions) -> PanelLayout {
        let room = regions.panel.with_max_y(regions.panel.max.y + REPLACED_SHARE * regions.panel.height());
        let mut layout = panel_layout(machine, if regions.portrait { regions.panel } else { room }, regions.portrait);
        layout.keys.retain(|(key, _)| KEYS.iter().all(|(pinned, _)| pinned != key));
        layout
    }
}

impl ScreenZoom {
    /// Percent.
    pub const fn percent(&self) -> u16 {
        self.percent
    }

    /// Shows the screen at a size of [`ZOOMS`]; another one changes nothing.
    pub fn set_percent(&mut self, percent: u16) {
        if ZOOMS.contains(&percent) && percent != self.percent {
            *self = Self { percent, is_changed: true, ..Self::default() };
        }
    }

    /// What is where on a display of this size; none at 100 %.
    pub fn place(&mut self, display: Rect) -> Option<ZoomedScreen> {
        if self.percent == ZOOMS[0] {
            return None;
        }
        let is_portrait = display.height() > display.width();
        let (rest, strip) = if is_portrait { display.split_bottom(STRIP) } else { display.split_right(STRIP) };
        let (part, message) = rest.split_bottom(theme::MESSAGE_OF_TWO_LINES);
        let least = if is_portrait { vec2(LEAST.y, LEAST.x) } else { LEAST };
        let size = display.size().max(least);
        self.corner = within(self.corner, size, part.size());
        Some(ZoomedScreen { whole: Rect::from_min_size(part.min - self.corner, size), part, message, strip })
    }

    /// Moves the part by steps of the keyboard.
    pub fn step(&mut self, place: &ZoomedScreen, steps: Vec2) {
        self.corner += steps * STEP * place.part.size();
    }

    /// Draws the strip and handles its touches; returns why the key that was just pressed is blocked, if it is.
    pub fn strip(
        &mut self,
        view: &View<'_>,
        place: &ZoomedScreen,
        presses: &mut KeyPresses,
        out: &mut Vec<Command>,
    ) -> Option<Text> {
        let strip = place.strip;
        view.painter.rect_filled(strip, 0.0, view.theme.background);
        let edge = Stroke::new(theme::HAIRLINE, view.theme.line);
        view.painter.rect_stroke(strip, 0.0, edge, StrokeKind::Inside);
        let inside = strip.shrink(theme::GAP / 2.0);
        let mut from = 0.0;
        let mut next = |share: f32| {
            let cell = cell_of(inside, from, from + share).shrink(theme::GAP / 2.0);
            from += share;
            cell
        };
        self.overview(view, place, next(OVERVIEW_SHARE));
        KEYS.iter().fold(None, |reason, (key, share)| {
            let blocked = key_ui(view, *key, next(*share), presses, out);
            if *key == Key::CycleStart {
                next(APART_SHARE);
            }
            reason.or(blocked)
        })
    }

    /// The whole screen in small, with the part in it: a touch moves the part there, and it follows the finger.
    fn overview(&mut self, view: &View<'_>, place: &ZoomedScreen, room: Rect) {
        let response = view.ui.interact(room, Id::unique("overview"), Sense::CLICK | Sense::DRAG);
        let name = view.text("全屏缩略图 overview", "the whole screen overview");
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
        let size = place.whole.size();
        let scale = (room.width() / size.x).min(room.height() / size.y);
        let small = Rect::from_center_size(room.center(), size * scale);
        let shrunk = |rect: Rect| {
            let corner = small.min + (rect.min - place.whole.min) * scale;
            Rect::from_min_size(corner, rect.size() * scale)
        };
        let regions = place.regions();
        view.painter.rect_filled(small, 2.0, view.theme.surface);
        view.painter.rect_filled(shrunk(regions.panel), 2.0, view.theme.raised);
        for bar in [regions.header, regions.soft] {
            view.painter.rect_filled(shrunk(bar), 0.0, view.theme.line);
        }
        let part = shrunk(place.part);
        view.painter.rect_filled(part, 2.0, view.theme.glow);
        view.painter.rect_stroke(part, 2.0, Stroke::new(theme::FRAME, view.theme.focus), StrokeKind::Inside);
        let finger = view.finger().filter(|_| response.is_pointer_button_down_on() || response.clicked());
        if let Some(at) = finger.filter(|_| scale > 0.0) {
            let wanted = within((at - small.min) / scale - place.part.size() / 2.0, size, place.part.size());
            if wanted != self.corner {
                self.corner = wanted;
                view.ui.ctx().request_repaint();
            }
        }
    }

    /// Shows the upper left corner of a page that has come. After a touch or a key brings the field into view that it has
    /// chosen, above the numeric pad; what the machine does moves nothing.
    pub fn follow(&mut self, view: &View<'_>, place: &ZoomedScreen, page: ZoomedPage) {
        let (now, is_down, clicks) =
            view.ui.input(|input| (input.time, input.pointer.any_down(), input.pointer.any_click()));
        let (before, was_typing) = (self.corner, self.is_typing);
        let shown = Some((view.snapshot.page, page.is_covered));
        if self.page != shown {
            (self.page, self.corner, self.answers) = (shown, Vec2::ZERO, 0);
        }
        let touches = clicks && view.finger().is_some_and(|at| place.part.contains(at));
        if touches || page.has_keys || page.is_typing != was_typing {
            self.answers = ANSWER_FRAMES;
        }
        let chosen = view.entry.get().map(|entry| entry.translate(-place.whole.min.to_vec2()));
        let is_other = match (chosen, self.chosen) {
            (Some(now), Some(before)) => (now.min - before.min).length() > 1.0 || (now.max - before.max).length() > 1.0,
            (now, before) => now.is_some() != before.is_some(),
        };
        if let Some(target) =
            chosen.filter(|_| self.answers > 0 && !is_down && (is_other || page.is_typing != was_typing))
        {
            let pad = if page.is_typing { numeric_pad::HEIGHT } else { 0.0 };
            let room = place.part.size() - vec2(0.0, pad.min(0.7 * place.part.height()));
            let corner = vec2(
                brought_into(self.corner.x, room.x, (target.min.x, target.max.x)),
                brought_into(self.corner.y, room.y, (target.min.y, target.max.y)),
            );
            self.corner = within(corner, place.whole.size(), place.part.size());
        }
        if !is_down {
            (self.chosen, self.is_typing) = (chosen, page.is_typing);
            self.answers = self.answers.saturating_sub(1);
        }
        if self.corner != before {
            self.moved = Some((now, was_typing));
        }
        if self.corner != before || self.answers > 0 {
            view.ui.ctx().request_repaint();
        }
    }

    /// Takes the touches of what has just come under the finger: called below the numeric pad and above it. A pad that was
    /// open before keeps its keys where they are and goes on taking touches.
    pub fn cover(&mut self, view: &View<'_>, area: Rect, is_above_pad: bool) {
        let now = view.ui.input(|input| input.time);
        if std::mem::take(&mut self.is_changed) {
            self.moved = Some((now, false));
        }
        let Some((since, pad_was_open)) = self.moved.filter(|(since, _)| now - since < numeric_pad::COVERED_S) else {
            return;
        };
        if is_above_pad != pad_was_open {
            numeric_pad::cover(view, area, ("moved", since.to_bits()));
            // The cover of the last frame would take the next touch.
            let rest = numeric_pad::COVERED_S - (now - since);
            view.ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(rest + 0.02));
        }
    }
}

/// A corner that leaves the part in the whole screen, on a whole point.
fn within(corner: Vec2, whole: Vec2, part: Vec2) -> Vec2 {
    corner.clamp(Vec2::ZERO, (whole - part).max(Vec2::ZERO)).round()
}

/// The part of a strip between two shares of its length.
fn cell_of(strip: Rect, from: f32, to: f32) -> Rect {
    let (least, size) = (strip.min, strip.size());
    if size.y > size.x {
        strip.with_min_y(least.y + from * size.y).with_max_y(least.y + to * size.y)
    } else {
        strip.with_min_x(least.x + from * size.x).with_max_x(least.x + to * size.x)
    }
}

/// Where a part of this length begins so that a span is in it, moved as little as possible; the beginning of a longer span.
fn brought_into(begin: f32, length: f32, (from, to): (f32, f32)) -> f32 {
    begin.max(to + MARGIN - length).min(from - MARGIN)
}

/// The screen, of which the display shows a part if it is zoomed.
pub fn screen_of(display: &mut Ui, zoomed: Option<&ZoomedScreen>) -> Ui {
    let whole = zoomed.map_or(display.max_rect(), |place| place.whole);
    let mut screen = display.new_child(UiBuilder::new().max_rect(whole));
    if let Some(place) = zoomed {
        screen.set_clip_rect(place.part.intersect(display.clip_rect()));
    }
    screen
}

/// The regions of the screen and the layout of its panel.
pub fn layout(screen: &Ui, zoomed: Option<&ZoomedScreen>, machine: Fitted) -> (Regions, PanelLayout) {
    let regions = zoomed.map_or_else(|| Regions::new(screen.max_rect()), ZoomedScreen::regions);
    let panel = match zoomed {
        Some(place) => place.panel(machine, &regions),
        None => panel_layout(machine, regions.panel, regions.portrait),
    };
    (regions, panel)
}
