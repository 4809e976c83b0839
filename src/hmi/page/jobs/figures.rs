//! What the parts of an order say, in words and figures: on the page and in the report.

use crate::defs::part_record::PartRecord;
use crate::defs::production_order::ProductionOrder;
use crate::defs::text::{Lang, Text};
use crate::hmi::format_cycle_time;
use crate::link::production::like_sizes;
use crate::technology::capability;

/// Names and values, in the order in which they are shown. Statistics are those of the parts that are still kept.
pub fn figures(lang: Lang, order: &ProductionOrder, parts: &[&PartRecord]) -> Vec<(&'static str, String)> {
    let say = |zh: &'static str, en: &'static str| Text::new(zh, en).get(lang);
    let dash = || "–".to_owned();
    let (sizes, limits) = like_sizes(parts);
    let found = capability(&sizes, limits.map(|[_, low, high]| (low, high)));
    let cycle = parts.iter().map(|part| part.cycle_seconds).sum::<f64>() / parts.len().max(1) as f64;
    let timed = |seconds: f64| if parts.is_empty() { dash() } else { format_cycle_time(seconds) };
    let ended = |part: Option<&&PartRecord>| part.map_or_else(dash, |part| part.ended.to_string());
    let deviations =
        |[nominal, low, high]: [f64; 3]| format!("{nominal:.3} {:+.3} {:+.3}", high - nominal, low - nominal);
    vec![
        (say("平均节拍", "mean cycle"), timed(cycle)),
        (say("还需", "time left"), if parts.is_empty() { dash() } else { long_time(f64::from(order.left()) * cycle) }),
        (
            say("Cp / Cpk", "indices Cp / Cpk"),
            found.and_then(|found| found.indices).map_or_else(dash, |(cp, cpk)| format!("{cp:.2} / {cpk:.2}")),
        ),
        (say("平均尺寸 mm", "mean size mm"), found.map_or_else(dash, |found| format!("{:.4}", found.mean))),
        (
            say("标准差 µm", "std. deviation µm"),
            found.map_or_else(dash, |found| format!("{:.2}", found.deviation * 1e3)),
        ),
        (
            say("最小 – 最大 mm", "least – greatest mm"),
            found.map_or_else(dash, |found| format!("{:.4} – {:.4}", found.range.0, found.range.1)),
        ),
        (say("公称尺寸 mm", "nominal size mm"), limits.map_or_else(dash, deviations)),
        (say("第一件", "first part"), ended(parts.first())),
        (say("最后一件", "last part"), ended(parts.last())),
    ]
}

/// `4 h 59 min`
fn long_time(seconds: f64) -> String {
    let minutes = (seconds / 60.0).ceil() as u64;
    format!("{} h {:02} min", minutes / 60, minutes % 60)
}
