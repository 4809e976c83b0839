//! What the control tells the network: a table of data items with the names of MTConnect, and how each is read from the
//! snapshot. Nothing here changes anything. A work coordinate is as displayed: X a diameter where diameter mode is on.
//! Source: ANSI/MTC1.4 (MTConnect 2.2), parts 2 and 3.

use std::fmt::{self, Display, Formatter};

use super::snapshot::{AxisView, RunState, Snapshot};
use crate::defs::equipment::Equipment;
use crate::defs::grinding_phase::GrindingPhase;
use crate::defs::key::{Key, Mode};
use crate::defs::param;
use crate::defs::part_record::PartRecord;
use crate::defs::part_verdict::PartVerdict;
use crate::defs::signal::{Input, Output};
use crate::defs::text::Text;
use crate::units::Axis;

/// Decimals of a number on the network: a tenth of a micrometre.
const DECIMALS: usize = 4;

/// A number as the network is told it: lengths to a tenth of a micrometre.
#[must_use]
pub fn rounded(number: f64) -> f64 {
    let steps = 10_f64.powi(DECIMALS as i32);
    // No negative zero.
    (number * steps).round() / steps + 0.0
}

/// Where a data item stands in the model of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Component {
    /// The machine.
    Device,
    /// The control.
    Controller,
    /// The path of the program.
    Path,
    /// All axes.
    Axes,
    /// A linear axis.
    Axis(Axis),
    /// The wheel; the main spindle of a lathe.
    Spindle,
    /// Coolant.
    Coolant,
    /// Hydraulics.
    Hydraulic,
    /// Lubrication.
    Lubrication,
    /// The gauges on their arms.
    Gauge,
    /// The part that was finished last.
    LastPart,
    /// The guard.
    Door,
}

impl Component {
    /// Whether a machine has it.
    #[must_use]
    pub fn is_fitted(self, snapshot: &Snapshot) -> bool {
        match self {
            Self::Hydraulic => snapshot.fitted().has(Equipment::Hydraulics),
            Self::Gauge => snapshot.fitted().has(Equipment::Gauges),
            Self::Door => snapshot.params.input_port(Input::GuardClosed) > 0,
            Self::Axis(axis) => snapshot.axes[axis].present,
            Self::Device
            | Self::Controller
            | Self::Path
            | Self::Axes
            | Self::Spindle
            | Self::Coolant
            | Self::Lubrication
            | Self::LastPart => true,
        }
    }
}

/// What kind of data an item is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Category {
    /// A measured value, with its unit.
    Sample(&'static str),
    /// A state or a count.
    Event,
    /// An event with a unit.
    EventWithUnits(&'static str),
}

/// Value of a data item.
#[derive(Clone, Debug, PartialEq)]
pub enum ItemValue {
    /// Not known.
    Unavailable,
    /// A number in the unit of the item.
    Number(f64),
    /// A count.
    Count(u64),
    /// A word of the standard.
    Word(&'static str),
    /// A text of the machine.
    Text(String),
}

impl Display for ItemValue {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(value) if value.is_finite() => {
                let rounded = format!("{value:.DECIMALS$}");
                let short = rounded.trim_end_matches('0').trim_end_matches('.');
                f.write_str(if short == "-0" { "0" } else { short })
            }
            Self::Number(_) | Self::Unavailable => f.write_str("UNAVAILABLE"),
            Self::Count(count) => write!(f, "{count}"),
            Self::Word(word) => f.write_str(word),
            Self::Text(text) => f.write_str(text),
        }
    }
}

/// A data item.
#[derive(Clone, Copy, Debug)]
pub struct DataItem {
    /// Where it stands.
    pub component: Component,
    /// Its name; with the axis before it for one of an axis.
    name: &'static str,
    /// Its category.
    pub category: Category,
    /// Its type in the standard.
    pub kind: &'static str,
    /// Its subtype in the standard; empty for none.
    pub sub_type: &'static str,
    /// What it is, for people.
    pub text: Text,
    read: fn(&Snapshot, Component) -> ItemValue,
}

impl DataItem {
    /// Its id, unique in a machine.
    #[must_use]
    pub fn id(&self) -> String {
        match self.axis() {
            Some(axis) => format!("{}_{}", axis.letter().to_ascii_lowercase(), self.name),
            None => self.name.to_owned(),
        }
    }

    /// Whether it is the same item, of the same axis.
    #[must_use]
    pub fn is(&self, other: &Self) -> bool {
        (self.component, self.name) == (other.component, other.name)
    }

    /// A whole number.
    #[must_use]
    pub fn is_count(&self) -> bool {
        ["PART_COUNT", "LINE_NUMBER"].contains(&self.kind) || self.name == "parts_since_dressing"
    }

    /// A measured value that changes all the time: it is looked at less often. What belongs to a part is told with it.
    #[must_use]
    pub fn is_sampled(&self) -> bool {
        matches!(self.category, Category::Sample(_)) && self.component != Component::LastPart
    }

    /// Its value now.
    #[must_use]
    pub fn value(&self, snapshot: &Snapshot) -> ItemValue {
        (self.read)(snapshot, self.component)
    }

    /// The axis that it is one of.
    #[must_use]
    pub const fn axis(&self) -> Option<Axis> {
        match self.component {
            Component::Axis(axis) => Some(axis),
            _ => None,
        }
    }

    /// The coordinate system of a position: `MACHINE` or `WORK`; empty for other items.
    #[must_use]
    pub fn coordinate_system(&self) -> &'static str {
        match self.name {
            "machine" => "MACHINE",
            "work" => "WORK",
            _ => "",
        }
    }
}

macro_rules! data_items {
    ($($list:ident, $doc:literal { $($component:ident $name:literal, $category:expr, $kind:literal $sub_type:literal, $zh:literal, $en:literal, $read:expr;)* })*) => {
        $(#[doc = $doc] const $list: &[DataItem] = &[$(DataItem {
            component: component!($component), name: $name, category: $category, kind: $kind, sub_type: $sub_type,
            text: Text::new($zh, $en), read: $read,
        },)*];)*
    };
}

macro_rules! component {
    (EachAxis) => {
        Component::Axis(Axis::X)
    };
    ($component:ident) => {
        Component::$component
    };
}

const PERCENT: Category = Category::EventWithUnits("PERCENT");
const MM: Category = Category::Sample("MILLIMETER");
const MM_VALUE: Category = Category::EventWithUnits("MILLIMETER");
const RPM: Category = Category::Sample("REVOLUTION/MINUTE");
const SECONDS: Category = Category::Sample("SECOND");

data_items! {
    MACHINE_ITEMS, "The items of the machine." {
        Device "avail", Category::Event, "AVAILABILITY" "", "可用", "available", |_, _| ItemValue::Word("AVAILABLE");
        Controller "estop", Category::Event, "EMERGENCY_STOP" "", "急停", "emergency stop", |snapshot, _| {
            ItemValue::Word(if snapshot.key(Key::EmergencyStop).lamp { "TRIGGERED" } else { "ARMED" })
        };
        Controller "message", Category::Event, "MESSAGE" "", "程序的信息", "message of the program", |snapshot, _| {
            let text = snapshot.waiting_for.as_ref().map(|text| text.en().into_owned());
            ItemValue::Text(text.unwrap_or_default())
        };
        Path "execution", Category::Event, "EXECUTION" "", "运行状态", "execution", |snapshot, _| ItemValue::Word(execution(snapshot));
        Path "mode", Category::Event, "CONTROLLER_MODE" "", "方式", "mode", |snapshot, _| ItemValue::Word(controller_mode(snapshot.mode));
        Path "single_block", Category::Event, "CONTROLLER_MODE_OVERRIDE" "SINGLE_BLOCK", "单段", "single block", |snapshot, _| on_off(snapshot.key(Key::SingleBlock).lamp);
        Path "dry_run", Category::Event, "CONTROLLER_MODE_OVERRIDE" "DRY_RUN", "空运行", "dry run", |snapshot, _| on_off(snapshot.key(Key::DryRun).lamp);
        Path "machine_lock", Category::Event, "CONTROLLER_MODE_OVERRIDE" "MACHINE_AXIS_LOCK", "机床锁", "machine lock", |snapshot, _| on_off(snapshot.key(Key::MachineLock).lamp);
        Path "optional_stop", Category::Event, "CONTROLLER_MODE_OVERRIDE" "OPTIONAL_STOP", "选择停", "optional stop", |snapshot, _| on_off(snapshot.key(Key::OptionalStop).lamp);
        Path "program", Category::Event, "PROGRAM" "MAIN", "程序", "program", |snapshot, _| program(snapshot, snapshot.program.number);
        Path "active_program", Category::Event, "PROGRAM" "ACTIVE", "运行的程序", "running program", |snapshot, _| program(snapshot, snapshot.program.running_program());
        Path "line", Category::Event, "LINE_NUMBER" "ABSOLUTE", "行号", "line", |snapshot, _| ItemValue::Count(snapshot.program.line.into());
        Path "phase", Category::Event, "PROCESS_AGGREGATE_ID" "PROCESS_STEP", "磨削阶段", "phase of the cycle", |snapshot, _| phase(snapshot.cycle.phase);
        Path "order", Category::Event, "PROCESS_AGGREGATE_ID" "ORDER_NUMBER", "订单", "order", |snapshot, _| {
            let active = snapshot.production.active().map(|order| order.number.to_string());
            active.map_or(ItemValue::Unavailable, ItemValue::Text)
        };
        Path "feed", Category::Sample("MILLIMETER/SECOND"), "PATH_FEEDRATE" "COMMANDED", "进给速度", "feed", |snapshot, _| ItemValue::Number(snapshot.feed_mm_min / 60.0);
        Path "feed_override", PERCENT, "PATH_FEEDRATE_OVERRIDE" "PROGRAMMED", "进给倍率", "feed override", |snapshot, _| ItemValue::Count(snapshot.overrides.feed.into());
        Path "rapid_override", PERCENT, "PATH_FEEDRATE_OVERRIDE" "RAPID", "快速倍率", "rapid override", |snapshot, _| ItemValue::Count(snapshot.overrides.rapid.into());
        Path "cycle_time", SECONDS, "PROCESS_TIMER" "PROCESS", "循环时间", "cycle time", |snapshot, _| ItemValue::Number((snapshot.cycle.times.seconds * 10.0).floor() / 10.0);
        Path "parts_all", Category::Event, "PART_COUNT" "ALL", "件数", "parts", |snapshot, _| ItemValue::Count(last_part(snapshot).map_or(0, |part| part.count));
        Path "parts_counted", Category::Event, "PART_COUNT" "COMPLETE", "计数器", "part counter", |snapshot, _| ItemValue::Count(snapshot.parts_counted.into());
        LastPart "part_id", Category::Event, "PART_UNIQUE_ID" "SERIAL_NUMBER", "最后的工件", "last part", |snapshot, _| {
            last_part(snapshot).map_or(ItemValue::Unavailable, |part| ItemValue::Count(part.count))
        };
        LastPart "part_status", Category::Event, "PART_STATUS" "", "最后工件的判定", "verdict of the last part", |snapshot, _| {
            last_part(snapshot).map_or(ItemValue::Unavailable, |part| part_status(part.verdict))
        };
        LastPart "part_size", MM, "LENGTH" "", "最后工件的尺寸", "size of the last part", |snapshot, _| {
            number_of_part(snapshot, |part| part.size)
        };
        LastPart "part_nominal", MM_VALUE, "VARIABLE" "", "最后工件的公称尺寸", "nominal size of the last part", |snapshot, _| {
            number_of_part(snapshot, |part| part.limits.map(|[nominal, ..]| nominal))
        };
        LastPart "part_lower_limit", MM_VALUE, "VARIABLE" "", "最后工件的最小极限尺寸", "lower limit of size of the last part", |snapshot, _| {
            number_of_part(snapshot, |part| part.limits.map(|[_, least, _]| least))
        };
        LastPart "part_upper_limit", MM_VALUE, "VARIABLE" "", "最后工件的最大极限尺寸", "upper limit of size of the last part", |snapshot, _| {
            number_of_part(snapshot, |part| part.limits.map(|[.., greatest]| greatest))
        };
        LastPart "part_time", SECONDS, "PROCESS_TIMER" "PROCESS", "最后工件的循环时间", "cycle time of the last part", |snapshot, _| {
            number_of_part(snapshot, |part| Some(part.cycle_seconds))
        };
        LastPart "part_order", Category::Event, "PROCESS_AGGREGATE_ID" "ORDER_NUMBER", "最后工件的订单", "order of the last part", |snapshot, _| {
            let order = last_part(snapshot).filter(|part| part.order > 0).map(|part| part.order.to_string());
            order.map_or(ItemValue::Unavailable, ItemValue::Text)
        };
        LastPart "part_alarms", Category::Event, "VARIABLE" "", "上一件以来的报警", "alarms since the part before", |snapshot, _| {
            last_part(snapshot).map_or(ItemValue::Unavailable, |part| ItemValue::Text(listed(part.alarms.into_iter().filter(|number| *number > 0))))
        };
        LastPart "part_wheel", MM, "DIAMETER" "", "最后工件时的砂轮直径", "diameter of the wheel at the last part", |snapshot, _| {
            number_of_part(snapshot, |part| part.wheel_mm)
        };
        Spindle "parts_since_dressing", Category::Event, "VARIABLE" "", "修整后件数", "parts since the last dressing", |snapshot, _| {
            if turns_the_part(snapshot) { ItemValue::Unavailable } else { ItemValue::Count(snapshot.params.get(param::PARTS_SINCE_DRESSING) as u64) }
        };
        Spindle "spindle_mode", Category::Event, "ROTARY_MODE" "", "主轴方式", "mode of the spindle", |_, _| ItemValue::Word("SPINDLE");
        Spindle "spindle_power", Category::Event, "POWER_STATE" "CONTROL", "主轴接通", "spindle switched on", |snapshot, _| {
            on_off([Output::Wheel, Output::SpindleForward, Output::SpindleReverse].iter().any(|output| snapshot.outputs.has(*output)))
        };
        Spindle "wheel_diameter", MM, "DIAMETER" "", "砂轮直径", "diameter of the wheel", |snapshot, _| {
            if turns_the_part(snapshot) { ItemValue::Unavailable } else { ItemValue::Number(snapshot.params.get(param::WHEEL_DIAMETER)) }
        };
        Spindle "spindle_commanded", RPM, "ROTARY_VELOCITY" "COMMANDED", "主轴设定转速", "commanded spindle speed", |snapshot, _| {
            if turns_the_part(snapshot) { ItemValue::Unavailable } else { ItemValue::Number(snapshot.wheel_rpm) }
        };
        Spindle "spindle_speed", RPM, "ROTARY_VELOCITY" "ACTUAL", "主轴实际转速", "actual spindle speed", |snapshot, _| actual_speed(snapshot);
        Spindle "spindle_override", PERCENT, "ROTARY_VELOCITY_OVERRIDE" "", "主轴倍率", "spindle override", |snapshot, _| ItemValue::Count(snapshot.overrides.spindle.into());
        Spindle "spindle_load", Category::Sample("PERCENT"), "LOAD" "", "主轴负载", "load of the spindle", |snapshot, _| spindle_load(snapshot);
        Coolant "coolant", Category::Event, "POWER_STATE" "CONTROL", "冷却", "coolant", |snapshot, _| power(snapshot, Output::Coolant);
        Hydraulic "hydraulic", Category::Event, "POWER_STATE" "CONTROL", "液压", "hydraulics", |snapshot, _| power(snapshot, Output::Hydraulic);
        Lubrication "lubrication", Category::Event, "POWER_STATE" "CONTROL", "润滑", "lubrication", |snapshot, _| power(snapshot, Output::Lubrication);
        Gauge "gauge_radial", Category::Event, "ACTUATOR_STATE" "", "径向量仪伸出", "radial gauge extended", |snapshot, _| arm(snapshot, Output::RadialGauge);
        Gauge "gauge_axial", Category::Event, "ACTUATOR_STATE" "", "轴向量仪伸出", "axial gauge extended", |snapshot, _| arm(snapshot, Output::AxialGauge);
        Gauge "gauge_signals", Category::Event, "VARIABLE" "", "量仪信号", "signals of the gauges", |snapshot, _| {
            let given = Input::GAUGES.iter().enumerate().filter(|(_, signal)| snapshot.inputs.has(**signal));
            ItemValue::Text(listed(given.map(|(index, _)| format!("P{}", index + 1))))
        };
        Door "guard", Category::Event, "DOOR_STATE" "", "防护门", "guard", |snapshot, _| {
            ItemValue::Word(if snapshot.inputs.has(Input::GuardClosed) { "CLOSED" } else { "OPEN" })
        };
    }
    AXIS_ITEMS, "The items of each axis." {
        EachAxis "machine", MM, "POSITION" "ACTUAL", "机床坐标", "machine coordinate", slide;
        EachAxis "work", MM, "POSITION" "ACTUAL", "绝对坐标", "work coordinate", |snapshot, component| of_axis(snapshot, component, |axis| axis.work);
        EachAxis "state", Category::Event, "AXIS_STATE" "", "轴状态", "state of the axis", |snapshot, component| {
            let Component::Axis(axis) = component else { return ItemValue::Unavailable };
            ItemValue::Word(if snapshot.axes[axis].moving { "TRAVEL" } else { "STOPPED" })
        };
    }
}

/// The data items of a machine: those of what it is fitted with, then those of each of its axes.
pub fn data_items(snapshot: &Snapshot) -> impl Iterator<Item = DataItem> + use<'_> {
    all_data_items().filter(|item| item.component.is_fitted(snapshot))
}

/// The data items that a machine may have, by their ids.
pub fn all_data_items() -> impl Iterator<Item = DataItem> {
    let of_axis =
        |axis: Axis| AXIS_ITEMS.iter().map(move |item| DataItem { component: Component::Axis(axis), ..*item });
    MACHINE_ITEMS.iter().copied().chain(Axis::ALL.into_iter().flat_map(of_axis))
}

/// Whether the spindle turns the part: a lathe measures its speed.
fn turns_the_part(snapshot: &Snapshot) -> bool {
    snapshot.fitted().has(Equipment::MainSpindle)
}

/// The speed that is measured: by the encoder of a lathe, or by the inverter of the wheel.
fn actual_speed(snapshot: &Snapshot) -> ItemValue {
    let of_inverter = || snapshot.bus.as_ref()?.inverter.as_ref()?.rpm;
    let measured = if turns_the_part(snapshot) { Some(snapshot.wheel_rpm) } else { of_inverter() };
    measured.map_or(ItemValue::Unavailable, ItemValue::Number)
}

/// The load that is measured: the simulation of a lathe has none.
fn spindle_load(snapshot: &Snapshot) -> ItemValue {
    let measured = snapshot.wheel_load_percent().filter(|_| !(turns_the_part(snapshot) && snapshot.bus.is_none()));
    measured.map_or(ItemValue::Unavailable, |load| ItemValue::Number(load.round()))
}

/// Position of a slide in the coordinates of the machine, mm; X is no diameter here.
fn slide(snapshot: &Snapshot, component: Component) -> ItemValue {
    let is_diameter = snapshot.x_as_diameter && component == Component::Axis(Axis::X);
    match of_axis(snapshot, component, |axis| axis.machine) {
        ItemValue::Number(shown) if is_diameter => ItemValue::Number(shown / 2.0),
        value => value,
    }
}

/// What the program does; at rest whether its last run has come to its end.
const fn execution(snapshot: &Snapshot) -> &'static str {
    match snapshot.state {
        RunState::Idle if snapshot.program.is_completed => "PROGRAM_COMPLETED",
        RunState::Idle => "READY",
        RunState::Running | RunState::Homing => "ACTIVE",
        RunState::Held => "FEED_HOLD",
        RunState::Stopped => "PROGRAM_STOPPED",
        RunState::Waiting => "WAIT",
        RunState::Alarm => "STOPPED",
    }
}

const fn controller_mode(mode: Mode) -> &'static str {
    match mode {
        Mode::Edit => "EDIT",
        Mode::Auto => "AUTOMATIC",
        Mode::Mdi => "MANUAL_DATA_INPUT",
        Mode::Home | Mode::Handwheel | Mode::Step | Mode::Manual => "MANUAL",
    }
}

const fn on_off(on: bool) -> ItemValue {
    ItemValue::Word(if on { "ON" } else { "OFF" })
}

fn power(snapshot: &Snapshot, output: Output) -> ItemValue {
    on_off(snapshot.outputs.has(output))
}

fn program(snapshot: &Snapshot, number: u32) -> ItemValue {
    if number == 0 { ItemValue::Unavailable } else { ItemValue::Text(snapshot.title(number)) }
}

const fn phase(phase: Option<GrindingPhase>) -> ItemValue {
    let Some(phase) = phase else { return ItemValue::Unavailable };
    ItemValue::Word(match phase {
        GrindingPhase::Dressing => "DRESSING",
        GrindingPhase::Measuring => "MEASURING",
        GrindingPhase::Approach => "APPROACH",
        GrindingPhase::AirGrinding => "AIR_GRINDING",
        GrindingPhase::Roughing => "ROUGHING",
        GrindingPhase::Finishing => "FINISHING",
        GrindingPhase::SparkOut => "SPARK_OUT",
        GrindingPhase::Retract => "RETRACT",
    })
}

/// The arm of a gauge is in the part.
fn arm(snapshot: &Snapshot, output: Output) -> ItemValue {
    ItemValue::Word(if snapshot.outputs.has(output) { "ACTIVE" } else { "INACTIVE" })
}

/// Words in a row; `NONE` for none: an agent takes an empty value for one that is not known.
fn listed(words: impl Iterator<Item = impl Display>) -> String {
    let words: Vec<String> = words.map(|word| word.to_string()).collect();
    if words.is_empty() { "NONE".to_owned() } else { words.join(" ") }
}

fn number_of_part(snapshot: &Snapshot, read: fn(&PartRecord) -> Option<f64>) -> ItemValue {
    last_part(snapshot).and_then(read).map_or(ItemValue::Unavailable, ItemValue::Number)
}

fn last_part(snapshot: &Snapshot) -> Option<&PartRecord> {
    snapshot.production.parts.last()
}

const fn part_status(verdict: PartVerdict) -> ItemValue {
    match verdict {
        PartVerdict::Good => ItemValue::Word("PASS"),
        PartVerdict::Spoilt(_) | PartVerdict::Out { .. } => ItemValue::Word("FAIL"),
        PartVerdict::NoTolerance | PartVerdict::NotMeasured => ItemValue::Unavailable,
    }
}

fn of_axis(snapshot: &Snapshot, component: Component, read: fn(&AxisView) -> f64) -> ItemValue {
    match component {
        // Before homing nobody knows where an axis stands.
        Component::Axis(axis) if snapshot.axes[axis].homed => ItemValue::Number(read(&snapshot.axes[axis])),
        _ => ItemValue::Unavailable,
    }
}
