//! The screen at 150 % or 200 % of its size: the display shows a part of it. Beside that part, always in view: an overview
//! that moves it, and the keys that stop and start; below it the message line.
//! Source: spec H1, H9; issue "the face", part 12.

use egui::accesskit::Role;
use egui::{Id, Rect, Sense, Stroke, StrokeKind, Ui, UiBuilder, Vec2, WidgetInfo, pos2, vec2};

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
    [(Key::Reset, 0.15), (Key::CycleStart, 0.2), (Key::FeedHold, 0.2), (Key::EmergencyStop, 0.25)];
const OVERVIEW_SHARE: f32 = 0.2;
/// Share of the part by which a key moves it.
const STEP: f32 = 0.5;
/// Rows of keys that the panel has no more, as a share of its height.
const PANEL_GAIN: f32 = 0.14;
/// Space around what is brought into view, points.
const MARGIN: f32 = 12.0;

/// Which part of the screen is shown, how large.
#[derive(Debug)]
pub struct ScreenZoom {
    percent: u16,
    /// The upper left corner of the part, from that of the whole screen, points.
    corner: Vec2,
    /// The page of the last frame, and whether something lies over it.
    page: Option<(Page, bool)>,
    /// What was last brought into view, from the corner of the whole screen, and whether the numeric pad was open.
    followed: Option<(Rect, bool)>,
    /// When the part was last moved by itself, s.
    moved_at: Option<f64>,
}

impl Default for ScreenZoom {
    fn default() -> Self {
        Self { percent: ZOOMS[0], corner: Vec2::ZERO, page: None, followed: None, moved_at: None }
    }
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
        let room = regions.panel.with_max_y(regions.panel.max.y + PANEL_GAIN * regions.panel.height());
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
            *self = Self { percent, ..Self::default() };
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
        self.corner = self.corner.clamp(Vec2::ZERO, (size - part.size()).max(Vec2::ZERO)).round();
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
        let is_column = strip.height() > strip.width();
        let mut from = 0.0;
        let mut next = |share: f32| {
            let (begin, end) = (from, from + share);
            from = end;
            let cut = |least: f32, most: f32, at: f32| least + (most - least) * at;
            let cell = if is_column {
                let (top, bottom) = (cut(inside.min.y, inside.max.y, begin), cut(inside.min.y, inside.max.y, end));
                inside.with_min_y(top).with_max_y(bottom)
            } else {
                let (left, right) = (cut(inside.min.x, inside.max.x, begin), cut(inside.min.x, inside.max.x, end));
                inside.with_min_x(left).with_max_x(right)
            };
            cell.shrink(theme::GAP / 2.0)
        };
        self.overview(view, place, next(OVERVIEW_SHARE));
        KEYS.iter().fold(None, |reason, (key, share)| reason.or(key_ui(view, *key, next(*share), presses, out)))
    }

    /// The whole screen in small, with the part in it: a touch moves the part there, and it follows the finger.
    fn overview(&mut self, view: &View<'_>, place: &ZoomedScreen, room: Rect) {
        let response = view.ui.interact(room, Id::unique("overview"), Sense::CLICK | Sense::DRAG);
        let name = view.text("全屏缩图 overview", "the whole screen overview");
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
        if let Some(at) = finger {
            self.corner = (at - small.min) / scale - place.part.size() / 2.0;
            view.ui.ctx().request_repaint();
        }
    }

    /// Shows the upper left corner of a page that has come, and what waits for an answer or an input when that changes; after
    /// that the page takes no touch for a moment. The numeric pad keeps its place at the foot of the part.
    pub fn follow(&mut self, view: &View<'_>, place: &ZoomedScreen, is_covered: bool, is_typing: bool) {
        let (now, is_down) = view.ui.input(|input| (input.time, input.pointer.any_down()));
        if let Some(moved) = self.moved_at.filter(|moved| now - moved < numeric_pad::COVERED_S) {
            numeric_pad::cover(view, place.part, ("moved", moved.to_bits()));
        }
        if is_down {
            return;
        }
        let before = self.corner;
        let page = Some((view.snapshot.page, is_covered));
        if self.page.replace((view.snapshot.page, is_covered)) != page {
            (self.corner, self.followed) = (Vec2::ZERO, None);
        }
        let wanted = view.entry.get().map(|entry| (entry.translate(-place.whole.min.to_vec2()), is_typing));
        if wanted != self.followed {
            self.followed = wanted;
            let pad = if is_typing { numeric_pad::HEIGHT } else { 0.0 };
            if let Some((target, _)) = wanted {
                let room = place.part.size() - vec2(0.0, pad.min(0.7 * place.part.height()));
                self.corner = vec2(
                    brought_into(self.corner.x, room.x, (target.min.x, target.max.x)),
                    brought_into(self.corner.y, room.y, (target.min.y, target.max.y)),
                );
            }
        }
        if self.corner != before {
            self.moved_at = Some(now);
            view.ui.ctx().request_repaint();
        }
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

/// The place of the pad.
pub fn pad_room(place: &ZoomedScreen) -> Rect {
    Rect::from_min_max(place.part.min, pos2(place.part.max.x - theme::GAP, place.part.max.y - theme::GAP))
}
