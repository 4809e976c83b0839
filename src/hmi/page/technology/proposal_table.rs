//! The right column: each proposed value beside the one in force, and what sets it; speeds, dressing, time; the key that
//! takes the values over.

use egui::Rect;

use super::{PROPOSED, task};
use crate::defs::page_meaning::PageMeaning;
use crate::defs::page_text::PageText;
use crate::defs::text::Text;
use crate::hmi::{Area, PageKey, View, format_value, theme, widget};
use crate::technology::{PlungeProposal, ProposalLimit, TaskError, propose};

/// Height of a row of the table, of a line of figures, and of the key.
const ROW_HEIGHT: f32 = 44.0;
const LINE_HEIGHT: f32 = 27.0;
const KEY_HEIGHT: f32 = 52.0;
/// Lines of figures below the table.
const FIGURES: usize = 5;
/// Share of a row for the name; the number of the variable is below it.
const NAME_SHARE: f32 = 0.54;
/// Two values are the same.
const SAME: f64 = 1e-9;

/// A row: a value of the page that is proposed.
struct ProposedValue {
    meaning: PageMeaning,
    name: Text,
    variable: u16,
    /// The value in force; `None`: it is empty.
    now: Option<f64>,
    proposed: f64,
    limit: ProposalLimit,
}

impl ProposedValue {
    fn differs(&self) -> bool {
        self.now.is_none_or(|now| (now - self.proposed).abs() > SAME)
    }
}

/// Draws the table; returns the variables to set, with their values.
pub fn ui(rect: Rect, view: &View<'_>, text: &PageText) -> Vec<(u16, f64)> {
    view.card(rect);
    let inside = rect.shrink(theme::PAD);
    let found = match propose(&task::task(view, text)) {
        Ok(found) => found,
        Err(cause) => {
            view.paragraph(inside, no_proposal(cause).get(view.lang), theme::TITLE, view.theme.hold);
            return Vec::new();
        }
    };
    let rows = proposed_values(view, text, &found);
    let (table, key) = inside.split_bottom(KEY_HEIGHT);
    let (heading, table) = table.split_top(LINE_HEIGHT);
    header(heading, view);
    let figures_height = FIGURES as f32 * LINE_HEIGHT;
    let height = ((table.height() - figures_height) / rows.len().max(1) as f32).min(ROW_HEIGHT);
    let locked = view.snapshot.values_locked();
    let mut taken = Vec::new();
    for (index, of_row) in rows.iter().enumerate() {
        if row(table.band(index as f32 * height, height - 4.0), view, of_row) && of_row.differs() && !locked {
            taken.push((of_row.variable, of_row.proposed));
        }
    }
    figures(table.trim_top(rows.len() as f32 * height + 4.0), view, &found);
    let changed: Vec<_> = rows.iter().filter(|row| row.differs()).map(|row| (row.variable, row.proposed)).collect();
    let words = match changed.len() {
        0 => view.text("已采用", "TAKEN OVER").to_owned(),
        count => format!("{} ({count})", view.text("采用", "TAKE OVER")),
    };
    let take = PageKey::new("technology-take", &words).locked(locked || changed.is_empty());
    if widget::button(view, key.trim_top(theme::GAP), take) && !locked { changed } else { taken }
}

/// The values that the page has and that are proposed.
fn proposed_values(view: &View<'_>, text: &PageText, found: &PlungeProposal) -> Vec<ProposedValue> {
    let row = |(meaning, name)| {
        let (variable, proposed) = (task::variable_of(text, meaning)?, found.value_of(meaning)?);
        let (now, limit) = (task::value(view, text, meaning), limit_of(found, meaning));
        Some(ProposedValue { meaning, name, variable, now, proposed, limit })
    };
    PROPOSED.into_iter().filter_map(row).collect()
}

fn no_proposal(cause: TaskError) -> Text {
    match cause {
        TaskError::WheelOrMachine => Text::new(
            "砂轮的 P73、P77–P79、头架转速 P74 P75 必须大于 0。",
            "P73 and P77 to P79 of the wheel and P74, P75 of the headstock must be above 0.",
        ),
        TaskError::PartSize => Text::new(
            "成品直径、余量、公差必须大于 0：先在磨削页面输入毛坯和成品直径。",
            "Finished diameter, stock and tolerance must be above 0: type blank and finished diameter on the grinding page.",
        ),
        TaskError::WheelTooNarrow => Text::new(
            "磨削宽度大于砂轮宽度 P78：不是切入磨，没有建议值。",
            "The ground width is more than the wheel's width P78: no plunge, nothing is proposed.",
        ),
    }
}

/// What sets the value with a meaning.
fn limit_of(found: &PlungeProposal, meaning: PageMeaning) -> ProposalLimit {
    match meaning {
        PageMeaning::RoughFeed => found.rough.limit,
        PageMeaning::FinishFeed => found.finish.limit,
        PageMeaning::FinishAllowance => found.finish_allowance_mm.1,
        PageMeaning::SparkOut => found.spark_out_s.1,
        PageMeaning::DressingInterval => ProposalLimit::WheelWear,
        _ => ProposalLimit::Stock,
    }
}

const fn limit_name(limit: ProposalLimit) -> Text {
    match limit {
        ProposalLimit::WheelRating => Text::new("砂轮额定 P79", "wheel rating P79"),
        ProposalLimit::WheelSpeed => Text::new("砂轮转速", "wheel speed"),
        ProposalLimit::Burn => Text::new("烧伤", "burn"),
        ProposalLimit::Power => Text::new("电机功率", "motor power"),
        ProposalLimit::WheelWear => Text::new("砂轮磨损", "wheel wear"),
        ProposalLimit::Roughness => Text::new("粗糙度", "roughness"),
        ProposalLimit::Lag => Text::new("让刀", "deflection"),
        ProposalLimit::Tolerance => Text::new("公差", "tolerance"),
        ProposalLimit::Roundness => Text::new("圆度", "roundness"),
        ProposalLimit::Stock => Text::new("余量", "stock"),
    }
}

/// Places of name, value in force, proposal and limit in a line.
fn columns(line: Rect) -> [Rect; 4] {
    let (name, rest) = line.split_left_right_at_fraction(0.34);
    let (now, rest) = rest.split_left_right_at_fraction(0.27);
    let (proposed, limit) = rest.split_left_right_at_fraction(0.42);
    [name, now, proposed, limit]
}

fn header(line: Rect, view: &View<'_>) {
    let [name, now, proposed, limit] = columns(line.trim_sides(theme::GAP));
    let muted = view.theme.muted;
    view.fit_left(name, view.text("数值", "value"), theme::SMALL, muted);
    view.fit_right(now, view.text("现在", "now"), theme::SMALL, muted);
    view.fit_right(proposed, view.text("建议", "proposed"), theme::SMALL, muted);
    view.fit_left(limit.trim_left(theme::PAD), view.text("限制", "limited by"), theme::SMALL, muted);
}

/// One value; true if it was touched.
fn row(line: Rect, view: &View<'_>, of_row: &ProposedValue) -> bool {
    let number = view.variable_name(of_row.variable);
    let response = view.touch_row(line, ("technology-row", of_row.variable), false, format!("take {number}"));
    view.row_card(line, false);
    let [name, now_place, proposed, limit_place] = columns(line.trim_sides(theme::GAP));
    let (above, below) = name.split_top_bottom_at_fraction(NAME_SHARE);
    view.fit_left(above, of_row.name.get(view.lang), theme::LABEL, view.theme.text);
    view.fit_left(
        below,
        &format!("{number}  {}", of_row.meaning.unit().map_or("", |unit| unit.get(view.lang))),
        theme::SMALL,
        view.theme.muted,
    );
    let before = of_row.now.map_or("–".to_owned(), |now| format_value(now, 0));
    view.fit_right(now_place, &before, theme::TITLE, view.theme.muted);
    let ink = if of_row.differs() { view.theme.info } else { view.theme.text };
    view.fit_right(proposed, &of_row.proposed.to_string(), theme::TITLE, ink);
    let limit = limit_name(of_row.limit).get(view.lang);
    view.fit_left(limit_place.trim_left(theme::PAD), limit, theme::LABEL, view.theme.muted);
    response.clicked()
}

/// Speeds, removal rates, dressing and time.
fn figures(rect: Rect, view: &View<'_>, found: &PlungeProposal) {
    let PlungeProposal { rough, finish, dressing, .. } = found;
    let rows = [
        (
            view.text("砂轮", "wheel"),
            format!(
                "{:.1} m/s  {:.0} r/min  {}",
                found.wheel_m_s.0,
                found.wheel_rpm,
                limit_name(found.wheel_m_s.1).get(view.lang)
            ),
        ),
        (
            view.text("工件", "part"),
            format!("{:.1} m/min  {} {:.0} r/min", found.work_m_min, view.text("宜", "best"), found.advised_work_rpm),
        ),
        (
            view.text("去除率 粗 / 精", "removal rate, rough / fine"),
            format!("{:.2} / {:.2} mm³/mm·s  {:.1} kW", rough.removal_mm2_s, finish.removal_mm2_s, rough.power_kw),
        ),
        (
            view.text("修整", "dressing"),
            format!("{:.0} mm/min  {} mm  Ud {}", dressing.feed_mm_min, dressing.depth_mm, dressing.overlap),
        ),
        (view.text("磨削时间", "grinding time"), format!("{:.0} s", found.time_s)),
    ];
    for (index, (name, value)) in rows.iter().enumerate() {
        let line = rect.band(index as f32 * LINE_HEIGHT, LINE_HEIGHT);
        let shown = view.fit_right(line, value, theme::LABEL, view.theme.text);
        view.fit_left(line.with_max_x(shown.min.x - theme::GAP), name, theme::LABEL, view.theme.muted);
    }
}
