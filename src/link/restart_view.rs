//! Where cycle start would restart the current program. Source: spec B5.

use super::edit::ModalView;
use crate::defs::text::LocalizedText;
use crate::units::PerAxis;

/// A block of the current program at which cycle start would restart it.
#[derive(Clone, Debug, PartialEq)]
pub struct RestartView {
    /// Program.
    pub program: u32,
    /// Line, from 1.
    pub line: u32,
    /// The modal codes active there.
    pub modals: ModalView,
    /// Start position of the axes, work coordinates as displayed; none for a missing axis.
    pub start: PerAxis<Option<f64>>,
    /// The wheel runs there.
    pub wheel_turns: bool,
    /// The workpiece spindle runs there.
    pub workpiece_turns: bool,
    /// Coolant is on there.
    pub coolant_on: bool,
}

impl RestartView {
    /// Summary in one line, for the message line.
    #[must_use]
    pub fn summary(&self) -> LocalizedText {
        let codes: String = self.modals.g_names().map(|name| name + " ").collect();
        let place: String = self.start.iter().filter_map(|(axis, at)| at.map(|at| format!("{axis}{at:.3} "))).collect();
        let (tool, offset) = self.modals.tool;
        let turning = [
            (self.wheel_turns, "砂轮", "wheel"),
            (self.workpiece_turns, "工件", "workpiece"),
            (self.coolant_on, "冷却", "coolant"),
        ];
        let list = |pick: fn(&(bool, &'static str, &'static str)) -> &'static str| {
            turning.iter().filter(|row| row.0).map(pick).collect::<Vec<_>>().join(" ")
        };
        let (zh, en) = (list(|row| row.1), list(|row| row.2));
        let (program, line) = (self.program, self.line);
        let (first_zh, first_en) = if zh.is_empty() {
            (String::new(), String::new())
        } else {
            (format!("先启动 {zh}；"), format!("start {en} first; "))
        };
        LocalizedText::new(
            format!("O{program:04} 第{line}行：{codes}T{tool:02}{offset:02}，起点 {place}；{first_zh}循环启动"),
            format!("O{program:04} line {line}: {codes}T{tool:02}{offset:02}, from {place}; {first_en}cycle start"),
        )
    }
}
