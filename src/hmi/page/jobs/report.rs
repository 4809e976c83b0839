//! The report of an order: one page of HTML with its figures, the chart of the sizes, and every part.

use std::fmt::Write;

use super::figures::figures;
use super::parts_of;
use crate::defs::part_record::PartRecord;
use crate::defs::production_order::ProductionOrder;
use crate::defs::text::{Lang, Text};
use crate::link::Snapshot;
use crate::link::production::like_sizes;
use crate::technology::ewma;

/// Width and height of the chart, px.
const CHART: (f64, f64) = (760.0, 240.0);
/// Dashes of the control limits.
const DASHES: &str = "4 3";
/// How much of its height the sizes fill.
const FILLED: f64 = 0.86;

/// The report in a language.
pub fn html(lang: Lang, snapshot: &Snapshot, order: &ProductionOrder) -> String {
    let parts: Vec<&PartRecord> = parts_of(snapshot, order).collect();
    let say = |zh: &'static str, en: &'static str| Text::new(zh, en).get(lang);
    let title = format!("{} {}", say("订单", "order"), order.number);
    let mut text = format!(
        "<!DOCTYPE html>\n<html lang=\"{}\">\n<meta charset=\"utf-8\">\n<title>{title}</title>\n<style>{STYLE}</style>\n<h1>{title}</h1>\n",
        say("zh", "en"),
    );
    let mut rows = vec![
        (say("程序", "program"), snapshot.title(order.program)),
        (say("合格 / 件数", "good / parts"), format!("{} / {}", order.good, order.target)),
        (say("不良", "NOK"), order.bad.to_string()),
    ];
    rows.extend(figures(lang, order, &parts));
    table(&mut text, &rows);
    if let Some(drawn) = chart(&parts) {
        text.push_str(&drawn);
        let words = say(
            "点：尺寸；方块：不良。粗线：公差；细线：公称尺寸；蓝线：EWMA 及其控制限。",
            "Points: sizes; squares: bad parts. Thick lines: tolerance; thin line: nominal size; blue: EWMA and its control limits.",
        );
        // Writing to a string does not fail.
        let _ = writeln!(text, "<p>{words}</p>");
    }
    let heads = [
        say("件", "part"),
        say("时间", "time"),
        say("尺寸 mm", "size mm"),
        say("偏差 µm", "off nominal µm"),
        say("节拍 s", "cycle s"),
        say("修整后", "since dressing"),
        say("结果", "verdict"),
    ];
    let heads: String = heads.iter().map(|head| format!("<th>{head}</th>")).collect();
    let _ = writeln!(text, "<table><tr>{heads}</tr>");
    for (part, rank) in parts.iter().zip(1..) {
        let size = part.size.map_or_else(|| "–".to_owned(), |size| format!("{size:.4}"));
        let off = part.size.zip(part.limits).map(|(size, [nominal, ..])| format!("{:+.1}", (size - nominal) * 1e3));
        let class = if part.verdict.is_bad() { " class=\"bad\"" } else { "" };
        let _ = writeln!(
            text,
            "<tr{class}><td>{}</td><td>{}</td><td>{size}</td><td>{}</td><td>{:.1}</td><td>{}</td><td>{}</td></tr>",
            rank,
            part.ended,
            off.unwrap_or_else(|| "–".to_owned()),
            part.cycle_seconds,
            part.since_dressing,
            part.verdict.name().get(lang),
        );
    }
    text.push_str("</table>\n</html>\n");
    text
}

const STYLE: &str = "body{font-family:sans-serif;margin:24px;color:#111}table{border-collapse:collapse;margin:12px 0}\
    td,th{border:1px solid #bbb;padding:3px 10px;text-align:right}tr.bad{background:#fbd5d5}svg{border:1px solid #bbb}";

/// A table of names and values.
fn table(text: &mut String, rows: &[(&str, String)]) {
    text.push_str("<table>\n");
    for (name, value) in rows {
        // The name of a program may have any sign.
        let value = value.replace('&', "&amp;").replace('<', "&lt;");
        let _ = writeln!(text, "<tr><th>{name}</th><td>{value}</td></tr>");
    }
    text.push_str("</table>\n");
}

/// The sizes between their limits, with the control chart of those that have the limits of the last one; `None` without
/// a size.
fn chart(parts: &[&PartRecord]) -> Option<String> {
    let sized: Vec<(f64, &PartRecord)> = parts.iter().filter_map(|part| Some((part.size?, *part))).collect();
    let (like, limits) = like_sizes(parts);
    if like.is_empty() {
        return None;
    }
    let points = ewma(&like);
    let all = sized.iter().map(|(size, _)| *size).chain(limits.into_iter().flatten());
    let (low, high) =
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    let (width, height) = CHART;
    let room = (high - low).max(1e-3);
    let y = |value: f64| height / 2.0 - (value - f64::midpoint(low, high)) / room * height * FILLED;
    let x = |index: usize| (index as f64 + 0.5) * width / sized.len() as f64;
    let mut text = format!("<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n");
    if let Some([nominal, low, high]) = limits {
        for (value, stroke) in [(nominal, 0.5), (low, 2.0), (high, 2.0)] {
            let at = y(value);
            let _ = writeln!(
                text,
                "<line x1=\"0\" x2=\"{width}\" y1=\"{at:.1}\" y2=\"{at:.1}\" stroke=\"#666\" stroke-width=\"{stroke}\"/>"
            );
        }
    }
    let first = sized.len() - points.len();
    line(&mut text, points.iter().enumerate().map(|(at, point)| (x(first + at), y(point.mean))), "");
    line(&mut text, points.iter().enumerate().map(|(at, point)| (x(first + at), y(point.limits.0))), DASHES);
    line(&mut text, points.iter().enumerate().map(|(at, point)| (x(first + at), y(point.limits.1))), DASHES);
    for (index, (size, part)) in sized.iter().enumerate() {
        let (x, y) = (x(index), y(*size));
        let _ = match part.verdict.is_bad() {
            true => writeln!(
                text,
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"8\" height=\"8\" fill=\"#c00\"/>",
                x - 4.0,
                y - 4.0
            ),
            false => writeln!(text, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"#080\"/>"),
        };
    }
    text.push_str("</svg>\n");
    Some(text)
}

/// A line through some places.
fn line(text: &mut String, places: impl Iterator<Item = (f64, f64)>, dashes: &str) {
    let places: Vec<String> = places.map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    let _ = writeln!(
        text,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"#06c\" stroke-dasharray=\"{dashes}\"/>",
        places.join(" ")
    );
}
