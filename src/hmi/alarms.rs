//! The alarms present, over the page: number, what is the matter, cause and remedy of each.
//! Source: spec H7, B8. It opens by a touch on the message line or by the soft key 报警.

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use super::theme;
use super::view::{View, card, fit, paragraph, put};
use crate::defs::alarm::ALARMS;
use crate::link::snapshot::AlarmView;

/// Height of one alarm.
const ROW: f32 = 104.0;

/// Draws the list over the page; true when it was touched and is to close.
pub fn ui(ui: &Ui, view: &View<'_>, rect: Rect) -> bool {
    let response = ui.interact(rect, Id::unique("alarms"), Sense::CLICK | Sense::DRAG);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, "关闭报警 close-alarms"));
    card(ui.painter(), rect, view.theme.surface, view.theme.focus);
    let inside = rect.shrink(theme::PAD);
    let (title, rest) = inside.split_top_bottom_at_y(inside.min.y + 34.0);
    let words = view.say("当前报警（触摸关闭）", "alarms present (touch closes)");
    fit(ui.painter(), title, Align2::LEFT_CENTER, words, theme::TITLE, view.theme.text);
    let alarms = &view.snapshot.alarms;
    if alarms.is_empty() {
        put(
            ui.painter(),
            rest,
            Align2::CENTER_CENTER,
            view.say("没有报警", "no alarm"),
            theme::SECONDARY,
            view.theme.quiet,
        );
    }
    let room = (rest.height() / ROW).floor().max(1.0) as usize;
    for (index, alarm) in alarms.iter().take(room).enumerate() {
        let corner = rest.min + vec2(0.0, index as f32 * ROW);
        row(ui, view, Rect::from_min_size(corner, vec2(rest.width(), ROW - theme::GAP)), alarm);
    }
    if alarms.len() > room {
        let more = format!("+{}", alarms.len() - room);
        put(ui.painter(), title, Align2::RIGHT_CENTER, &more, theme::TITLE, view.theme.alarm_text);
    }
    response.clicked()
}

fn row(ui: &Ui, view: &View<'_>, place: Rect, alarm: &AlarmView) {
    let painter = ui.painter();
    card(painter, place, view.theme.raised, view.theme.line);
    painter.rect_filled(Rect::from_min_size(place.min, vec2(4.0, place.height())), 0.0, view.theme.alarm);
    let inside = place.shrink2(vec2(theme::PAD, theme::GAP));
    let (number, words) = inside.split_left_right_at_x(inside.min.x + 60.0);
    let head = Rect::from_min_size(number.min, vec2(number.width(), 28.0));
    put(painter, head, Align2::LEFT_CENTER, &format!("{:03}", alarm.number), theme::SECONDARY, view.theme.alarm_text);
    let head = Rect::from_min_size(words.min, vec2(words.width(), 28.0));
    fit(painter, head, Align2::LEFT_CENTER, alarm.text.get(view.lang), theme::TITLE, view.theme.text);
    let cause = ALARMS.iter().find(|row| row.number == alarm.number).map_or("", |row| row.cause.get(view.lang));
    let below = Rect::from_min_max(pos2(words.min.x, head.max.y), words.max);
    let remedy = alarm.remedy.get(view.lang);
    let parts: Vec<&str> = [cause, remedy].into_iter().filter(|part| !part.is_empty()).collect();
    paragraph(painter, below, &parts.join(" → "), theme::LABEL, view.theme.quiet);
}
