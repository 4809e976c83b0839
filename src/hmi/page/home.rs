//! Home page: what matters at a glance, each as a tile that opens the page behind it; the machine at work beside them, the
//! favourites of the operator below.
//! Source: spec H5, H7; issue "the face", part 7.

use egui::{Color32, Rect};

use super::start_strip::{self, StartStrip};
use super::{PageContext, PageUi, favourites};
use crate::defs::alarm;
use crate::defs::equipment::Equipment;
use crate::defs::page::Page;
use crate::defs::param;
use crate::defs::part_verdict::PartVerdict;
use crate::hmi::{Area, View, format_cycle_time, format_feed, format_whole, keycap, page_frame as lines, scene, theme};
use crate::link::Command;
use crate::units::Axis;

/// Columns of tiles beside the machine, and without it.
const COLUMNS: [usize; 2] = [2, 3];
/// Share of the page for the machine at work.
const SCENE_SHARE: f32 = 0.4;
/// Height of the magnifier below the machine.
const MAGNIFIER_HEIGHT: f32 = 132.0;
/// Heights of the heading, of a line and of a large figure of a tile, and the greatest height of a tile.
const HEADING_HEIGHT: f32 = 26.0;
const LINE_HEIGHT: f32 = 24.0;
const FIGURE_HEIGHT: f32 = 38.0;
const TILE_HEIGHT: f32 = 230.0;
/// Heights are sums of fractions of a point.
const ROUNDING: f32 = 0.5;

/// State of the page.
#[derive(Debug, Default)]
pub struct HomePage {
    start: StartStrip,
}

/// A tile: heading, large figures, lines of a name and a value, and the page that it opens.
struct Tile {
    page: Page,
    heading: &'static str,
    /// Each with a name in front of it, or with an empty one.
    figures: Vec<(String, String)>,
    ink: Color32,
    lines: Vec<(String, String)>,
}

impl PageUi for HomePage {
    fn ui(&mut self, mut ctx: PageContext<'_>) {
        let (rest, strip) = ctx.rect.split_bottom(start_strip::HEIGHT + theme::GAP);
        let (body, kept) = rest.split_bottom(favourites::HEIGHT + theme::GAP);
        let has_wheel = ctx.view.snapshot.kind.row().has(Equipment::Wheel);
        let inside = body.trim_sides(theme::PAD).trim_top(theme::PAD).trim_bottom(theme::GAP);
        let (tiles, machine) = inside.split_right(if has_wheel { inside.width() * SCENE_SHARE } else { 0.0 });
        let tiles = tiles.trim_right(if has_wheel { theme::PAD } else { 0.0 });
        show_tiles(tiles, ctx.view, has_wheel, ctx.out);
        if has_wheel {
            ctx.view.card(machine);
            let inside = machine.shrink(theme::PAD);
            match ctx.view.snapshot.program.number {
                0 => ctx
                    .view
                    .note(inside, ctx.view.text("装入程序后显示机床", "load a program to see the machine at work")),
                _ => scene::paint_with_contact(inside, ctx.view, MAGNIFIER_HEIGHT),
            }
        }
        favourites::ui(kept.trim_sides(theme::PAD).trim_bottom(theme::GAP), &mut ctx);
        self.start.ui(strip.trim_sides(theme::PAD).trim_bottom(theme::GAP), &mut ctx);
    }
}

fn show_tiles(rect: Rect, view: &View<'_>, has_wheel: bool, out: &mut Vec<Command>) {
    let (fourth, fifth) = if has_wheel { (wheel(view), dressing(view)) } else { (spindle(view), directory(view)) };
    let tiles = [position(view), program(view), parts(view), fourth, fifth, alarms(view)];
    let columns = COLUMNS[usize::from(!has_wheel)];
    let rows = tiles.len().div_ceil(columns);
    let height = ((rect.height() + theme::GAP) / rows as f32 - theme::GAP).min(TILE_HEIGHT);
    for (index, tile) in tiles.iter().enumerate() {
        let row = rect.band((index / columns) as f32 * (height + theme::GAP), height);
        if show_tile(row.cell(index % columns, columns), view, tile) {
            out.push(Command::OpenPage(tile.page));
        }
    }
}

/// True if it was touched.
fn show_tile(rect: Rect, view: &View<'_>, tile: &Tile) -> bool {
    let name = format!("{} home-{}", tile.heading, tile.page.id());
    let response = keycap::plain(view, rect, ("home-tile", tile.page as u8), name);
    let inside = rect.shrink2(egui::vec2(theme::PAD, 8.0));
    let (heading, rest) = inside.split_top(HEADING_HEIGHT);
    view.fit_left(heading, tile.heading, theme::LABEL, view.theme.muted);
    // A text without a value may take two lines.
    let height_of = |(_, value): &(String, String)| if value.is_empty() { 2.0 * LINE_HEIGHT } else { LINE_HEIGHT };
    let below = tile.lines.iter().map(height_of).sum::<f32>().min(rest.height() * 0.7);
    let (figures, rows) = rest.split_bottom(below);
    let height = (figures.height() / tile.figures.len() as f32).min(FIGURE_HEIGHT);
    let middle = figures.center().y - height * tile.figures.len() as f32 / 2.0 - figures.min.y;
    for (index, (name, value)) in tile.figures.iter().enumerate() {
        let place = figures.band(middle + index as f32 * height, height);
        let named = view.fit_left(place, name, theme::SECONDARY, view.theme.muted);
        match name.is_empty() {
            true => view.fit_left(place, value, theme::FIGURE, tile.ink),
            false => view.fit_right(place.with_min_x(named.max.x + theme::GAP), value, theme::FIGURE, tile.ink),
        };
    }
    let mut top = 0.0;
    for of_line in &tile.lines {
        let (place, (name, value)) = (rows.band(top, height_of(of_line)), of_line);
        top += height_of(of_line);
        if place.max.y > rows.max.y + ROUNDING {
            // A low tile shows the first lines alone.
            break;
        }
        if value.is_empty() {
            view.text_rows(place, name, theme::LABEL, view.theme.text, 2);
            continue;
        }
        let shown = view.fit_right(place, value, theme::LABEL, view.theme.text);
        view.fit_left(place.with_max_x(shown.min.x - theme::GAP), name, theme::LABEL, view.theme.muted);
    }
    response.clicked()
}

/// One large figure.
fn figure(value: impl Into<String>) -> Vec<(String, String)> {
    vec![(String::new(), value.into())]
}

/// A line of a tile.
fn line(name: &str, value: impl Into<String>) -> (String, String) {
    (name.to_owned(), value.into())
}

fn position(view: &View<'_>) -> Tile {
    let axis = |axis: Axis| (axis.to_string(), view.length(view.snapshot.axes[axis].work));
    let lines = vec![line(view.text("进给", "feed"), format!("{} mm/min", format_feed(view.snapshot.feed_mm_min)))];
    let heading = view.text("位置 绝对", "position, absolute");
    Tile { page: Page::Position, heading, figures: view.axes().map(axis).collect(), ink: view.theme.text, lines }
}

fn program(view: &View<'_>) -> Tile {
    let snapshot = view.snapshot;
    let cycle = &snapshot.cycle;
    let mut lines = vec![line(view.text("状态", "state"), snapshot.state_name().get(view.lang))];
    if let Some(phase) = cycle.phase {
        lines.push(line(view.text("阶段", "phase"), phase.name().get(view.lang)));
    }
    if let Some(left) = cycle.seconds_left().filter(|_| snapshot.program.is_open) {
        lines.push(line(view.text("剩余", "left"), format_cycle_time(left)));
    }
    let heading = view.text("程序", "program");
    Tile { page: Page::Program, heading, figures: figure(lines::program_label(view)), ink: view.theme.text, lines }
}

/// The size of the last part large, if it is known; else the number of parts.
fn parts(view: &View<'_>) -> Tile {
    let snapshot = view.snapshot;
    let part = snapshot.cycle.part.as_ref();
    let simulated = snapshot.simulated.as_deref();
    let size = part.and_then(|part| Some((part.judged_size(simulated)?.mm(), part.verdict(simulated))));
    let (value, ink) = match size {
        Some((mm, verdict)) => (format!("{mm:.4}"), verdict_ink(view, verdict)),
        None => (snapshot.parts_counted.to_string(), view.theme.text),
    };
    let time = part.map_or_else(|| "–".to_owned(), |part| format_cycle_time(part.times.seconds));
    let mut lines = vec![
        line(view.text("件数", "parts"), snapshot.parts_counted.to_string()),
        line(view.text("上一件用时", "cycle time"), time),
    ];
    if let Some(order) = snapshot.production.active() {
        let name = format!("{} {}", view.text("订单", "order"), order.number);
        lines.push((name, format!("{} / {}", order.good, order.target)));
    }
    let heading = match size {
        Some(_) => view.text("上一件尺寸 mm", "size of the last part, mm"),
        None => view.text("工件", "parts"),
    };
    let page = if snapshot.kind.row().has(Equipment::Wheel) { Page::Grinding } else { Page::Graphic };
    Tile { page, heading, figures: figure(value), ink, lines }
}

const fn verdict_ink(view: &View<'_>, verdict: PartVerdict) -> Color32 {
    match verdict {
        PartVerdict::Good => view.theme.run,
        PartVerdict::Spoilt(_) | PartVerdict::Out { .. } => view.theme.alarm_text,
        PartVerdict::NoTolerance | PartVerdict::NotMeasured => view.theme.text,
    }
}

fn wheel(view: &View<'_>) -> Tile {
    let (snapshot, diameter) = (view.snapshot, view.snapshot.params.get(param::WHEEL_DIAMETER));
    let mut lines = vec![
        line(view.text("转速", "speed"), format!("{} r/min", format_whole(snapshot.wheel_rpm))),
        line(view.text("直径", "diameter"), format!("{} mm", view.length(diameter))),
    ];
    if let Some(load) = snapshot.wheel_load_percent() {
        lines.push(line(view.text("负载", "load"), format!("{load:.0} %")));
    }
    let ink = if snapshot.wheel_rpm > 0.0 { view.theme.run } else { view.theme.text };
    Tile {
        page: Page::Process,
        heading: view.text("砂轮", "wheel"),
        figures: figure(format!("{:.1} m/s", snapshot.wheel_rim_m_s())),
        ink,
        lines,
    }
}

/// Spindle and tool of a lathe.
fn spindle(view: &View<'_>) -> Tile {
    let snapshot = view.snapshot;
    let tool = snapshot.tool_station.map_or_else(|| "–".to_owned(), |station| format!("T{station}"));
    let lines = vec![line(view.text("刀具", "tool"), tool)];
    let ink = if snapshot.wheel_rpm > 0.0 { view.theme.run } else { view.theme.text };
    let figures = figure(format!("{} r/min", format_whole(snapshot.wheel_rpm)));
    Tile { page: Page::Tools, heading: view.text("主轴", "spindle"), figures, ink, lines }
}

fn directory(view: &View<'_>) -> Tile {
    let count = view.snapshot.directory.len();
    Tile {
        page: Page::Directory,
        heading: view.text("目录 程序数", "directory, programs"),
        figures: figure(count.to_string()),
        ink: view.theme.text,
        lines: Vec::new(),
    }
}

/// The parts to the next dressing.
fn dressing(view: &View<'_>) -> Tile {
    let params = &view.snapshot.params;
    let since = params.get(param::PARTS_SINCE_DRESSING);
    let left = view.snapshot.dressing_interval().map(|interval| (interval - since).max(0.0));
    let undressed = params.bit(param::WHEEL_UNDRESSED);
    let value = match (undressed, left) {
        (true, _) => view.text("未修整", "not dressed").to_owned(),
        (false, Some(left)) => format!("{left:.0}"),
        (false, None) => "–".to_owned(),
    };
    let due = undressed || left.is_some_and(|left| left < 1.0);
    let lines = vec![
        line(view.text("修整后件数", "parts since dressing"), format!("{since:.0}")),
        line(view.text("修整次数", "dressings"), format!("{:.0}", params.get(param::DRESSING_COUNT))),
    ];
    let heading = view.text("距下次修整 件", "parts to dressing");
    Tile {
        page: Page::Dressing,
        heading,
        figures: figure(value),
        ink: if due { view.theme.hold } else { view.theme.text },
        lines,
    }
}

/// The alarm that leads, as in the header; else that there is none.
fn alarms(view: &View<'_>) -> Tile {
    let alarms = &view.snapshot.alarms;
    let (value, ink, lines) = match alarm::leading(alarms, |alarm| alarm.number) {
        Some(leading) => {
            let text = leading.text.get(view.lang).into_owned();
            (leading.number.to_string(), view.theme.alarm_text, vec![(text, String::new())])
        }
        None => (view.text("没有", "none").to_owned(), view.theme.run, Vec::new()),
    };
    let mut lines = lines;
    lines.push(line(view.text("当前报警", "active alarms"), alarms.len().to_string()));
    Tile { page: Page::Alarm, heading: view.text("报警", "alarms"), figures: figure(value), ink, lines }
}
