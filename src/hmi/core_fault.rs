//! The watchdog of the screen: when the control has failed, or sends no snapshots, the frozen last picture is replaced
//! by a full-screen fault.
//! Source: notes "reliability", safety stance.

use std::time::Duration;

use egui::{Pos2, Rect, Ui, pos2};

use super::theme::{self, Theme};
use super::view::paragraph;
use crate::defs::text::{Lang, Text};

/// A snapshot older than this is not shown: 30 periods of the control's publishing.
pub const MAX_SNAPSHOT_AGE: Duration = Duration::from_millis(500);

/// Height of the title, points.
const TITLE_HEIGHT: f32 = 96.0;

/// What the screen knows of the control beside its snapshots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CoreHealth {
    /// Time since the newest snapshot came.
    pub snapshot_age: Duration,
    /// The control thread has panicked; it has set the outputs to the safe state.
    pub failed: bool,
}

/// Why the snapshot is not shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CoreFault {
    /// The control thread has panicked.
    Failed,
    /// The control sends no snapshots.
    Silent,
}

impl CoreHealth {
    /// The fault to show, if any.
    #[must_use]
    pub fn fault(self) -> Option<CoreFault> {
        if self.failed {
            Some(CoreFault::Failed)
        } else if self.snapshot_age > MAX_SNAPSHOT_AGE {
            Some(CoreFault::Silent)
        } else {
            None
        }
    }
}

impl CoreFault {
    /// Title, what happened, the state of the outputs, what to do.
    #[must_use]
    pub const fn texts(self) -> [Text; 4] {
        match self {
            Self::Failed => [
                Text::new("控制系统故障", "control failed"),
                Text::new(
                    "控制程序出错停止，屏幕不再显示机床状态。",
                    "The control has stopped because of an internal error. The screen no longer shows the machine.",
                ),
                Text::new(
                    "输出已置为安全状态：主轴、冷却、驱动断开，夹紧保持。",
                    "The outputs are in the safe state: spindles, fluids and drives are off, clamps hold.",
                ),
                Text::new(
                    "按急停，确认机床已停止，然后关闭并重新启动系统，重新回零。再次出现时请与厂家联系。",
                    "Press EMERGENCY STOP and make sure that the machine stands still. Restart the control and home \
                     the axes. If it happens again, call the builder.",
                ),
            ],
            Self::Silent => [
                Text::new("控制没有应答", "control does not answer"),
                Text::new(
                    "超过 0.5 秒没有收到控制的数据，屏幕不再显示机床状态。",
                    "No data from the control for more than 0.5 s. The screen no longer shows the machine.",
                ),
                Text::new(
                    "输出状态未知：机床可能仍在运动。",
                    "The state of the outputs is unknown: the machine may still move.",
                ),
                Text::new(
                    "按急停。几秒后仍无应答时，关闭并重新启动系统，重新回零。",
                    "Press EMERGENCY STOP. If the control does not answer within seconds, restart it and home the axes.",
                ),
            ],
        }
    }
}

/// Paints the fault over the whole screen: Chinese on the left, English beside it.
pub fn paint_core_fault(ui: &Ui, theme: &Theme, fault: CoreFault) {
    let all = ui.max_rect();
    let painter = ui.painter();
    painter.rect_filled(all, 0.0, theme.background);
    painter.rect_filled(Rect::from_min_size(all.min, egui::vec2(all.width(), theme::PAD)), 0.0, theme.alarm);
    let inner = all.shrink(4.0 * theme::PAD);
    let (middle, paragraph_height) = (inner.center().x, (inner.height() - TITLE_HEIGHT) / 3.0);
    for (lang, from, to) in [(Lang::Zh, inner.min.x, middle - theme::PAD), (Lang::En, middle + theme::PAD, inner.max.x)]
    {
        let mut at = Pos2::new(from, inner.min.y);
        for (row, text) in fault.texts().into_iter().enumerate() {
            let (height, size, colour) = match row {
                0 => (TITLE_HEIGHT, 1.5 * theme::SECONDARY, theme.alarm_text),
                _ => (paragraph_height, theme::SECONDARY, theme.text),
            };
            paragraph(painter, Rect::from_min_max(at, pos2(to, at.y + height)), text.get(lang), size, colour);
            at.y += height;
        }
    }
}
