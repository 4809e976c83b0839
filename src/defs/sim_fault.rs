//! The faults that can be injected into the simulated machine; used by stories, the simulator page and the manual.
//! Source: spec P8, tools.md ("Faults").

use super::text::Text;

/// The argument after the name of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultArgument {
    /// None.
    None,
    /// An input id.
    Input,
    /// A number of ticks.
    Ticks,
}

/// One row of the fault table.
#[derive(Clone, Copy, Debug)]
pub struct FaultRow {
    /// The word used in stories.
    pub name: &'static str,
    /// The required argument.
    pub argument: FaultArgument,
    /// Description.
    pub text: Text,
}

impl FaultRow {
    /// The syntax in a story: NAME is an input id, N a number of ticks.
    #[must_use]
    pub fn usage(&self) -> String {
        match self.argument {
            FaultArgument::None => self.name.to_owned(),
            FaultArgument::Input => format!("{} NAME", self.name),
            FaultArgument::Ticks => format!("{} N", self.name),
        }
    }
}

const fn row(name: &'static str, takes: FaultArgument, zh: &'static str, en: &'static str) -> FaultRow {
    FaultRow { name, argument: takes, text: Text::new(zh, en) }
}

/// Every fault.
pub const FAULTS: [FaultRow; 19] = [
    row("stuck-on", FaultArgument::Input, "输入一直接通", "an input that stays on"),
    row("stuck-off", FaultArgument::Input, "输入一直断开", "an input that stays off"),
    row("bounce", FaultArgument::Input, "输入抖动", "an input whose contact bounces"),
    row("pressure-loss", FaultArgument::None, "液压压力丢失", "hydraulic pressure lost"),
    row("drive-x", FaultArgument::None, "X 驱动故障", "X drive fault"),
    row("drive-y", FaultArgument::None, "Y 驱动故障", "Y drive fault"),
    row("drive-z", FaultArgument::None, "Z 驱动故障", "Z drive fault"),
    row("following-x", FaultArgument::None, "X 跟随误差", "X following error"),
    row("following-y", FaultArgument::None, "Y 跟随误差", "Y following error"),
    row("following-z", FaultArgument::None, "Z 跟随误差", "Z following error"),
    row("worn-screw-x", FaultArgument::None, "X 丝杠磨损", "X screw worn"),
    row("worn-screw-y", FaultArgument::None, "Y 丝杠磨损", "Y screw worn"),
    row("worn-screw-z", FaultArgument::None, "Z 丝杠磨损", "Z screw worn"),
    row("gauge-dead", FaultArgument::None, "量仪无信号", "no gauge signal"),
    row("coolant-missing", FaultArgument::None, "冷却无流量", "no coolant flow"),
    row("lubrication-missing", FaultArgument::None, "润滑液位低", "lubrication low"),
    row("bus-late", FaultArgument::Ticks, "总线迟到 N 个周期", "the bus answers a tick late for N ticks"),
    row("bus-silent", FaultArgument::Ticks, "总线 N 个周期无应答", "the bus does not answer for N ticks"),
    row("supply-loss", FaultArgument::None, "电源丢失", "supply lost"),
];

/// The faults without an argument.
pub fn without_argument() -> impl Iterator<Item = &'static FaultRow> {
    FAULTS.iter().filter(|row| row.argument == FaultArgument::None)
}
