//! The faults that can be injected into the simulated machine; used by stories, the simulator page and the manual.
//! Source: spec P8, tools.md ("Faults").

use super::equipment::{Needs, needs};
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
    /// The device that has the fault.
    pub needs: Needs,
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

macro_rules! faults {
    ($($name:literal, $argument:ident, $needs:ident, $zh:literal, $en:literal;)*) => {
        /// Every fault.
        pub const FAULTS: [FaultRow; [$($name),*].len()] = [$(FaultRow {
            name: $name, argument: FaultArgument::$argument, needs: needs!($needs), text: Text::new($zh, $en),
        }),*];
    };
}

faults! {
    "stuck-on", Input, ANY, "输入一直接通", "an input that stays on";
    "stuck-off", Input, ANY, "输入一直断开", "an input that stays off";
    "bounce", Input, ANY, "输入抖动", "an input whose contact bounces";
    "pressure-loss", None, Hydraulics, "液压压力丢失", "hydraulic pressure lost";
    "drive-x", None, ANY, "X 驱动故障", "X drive fault";
    "drive-y", None, AxisY, "Y 驱动故障", "Y drive fault";
    "drive-z", None, ANY, "Z 驱动故障", "Z drive fault";
    "following-x", None, ANY, "X 跟随误差", "X following error";
    "following-y", None, AxisY, "Y 跟随误差", "Y following error";
    "following-z", None, ANY, "Z 跟随误差", "Z following error";
    "worn-screw-x", None, ANY, "X 丝杠磨损", "X screw worn";
    "worn-screw-y", None, AxisY, "Y 丝杠磨损", "Y screw worn";
    "worn-screw-z", None, ANY, "Z 丝杠磨损", "Z screw worn";
    "gauge-dead", None, Gauges, "量仪无信号", "no gauge signal";
    "coolant-missing", None, ANY, "冷却无流量", "no coolant flow";
    "lubrication-missing", None, ANY, "润滑液位低", "lubrication low";
    "bus-late", Ticks, ANY, "总线迟到 N 个周期", "the bus answers a tick late for N ticks";
    "bus-silent", Ticks, ANY, "总线 N 个周期无应答", "the bus does not answer for N ticks";
    "supply-loss", None, ANY, "电源丢失", "supply lost";
}

/// The faults without an argument.
pub fn without_argument() -> impl Iterator<Item = &'static FaultRow> {
    FAULTS.iter().filter(|row| row.argument == FaultArgument::None)
}
