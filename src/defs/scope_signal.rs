//! What the scope can record: set-points and feedback of the axes, speeds, inputs and outputs.
//! Source: issue "a real machine", part 6.

use super::equipment::Equipment;
use super::fitted::Fitted;
use super::signal::{Input, Output};
use super::text::{LocalizedText, Text, phrase};
use crate::units::Axis;

/// What is recorded of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AxisQuantity {
    /// Set-point, machine coordinate as displayed, mm.
    SetPoint,
    /// Position by the encoder, machine coordinate as displayed, mm.
    Actual,
    /// Set-point of the tick before minus position, as displayed, µm.
    FollowingError,
    /// Change of the set-point, as displayed, mm/min.
    SetSpeed,
    /// Change of the position, as displayed, mm/min.
    ActualSpeed,
    /// Torque of the drive in percent of the rated one; 0 where it sends none.
    Torque,
}

impl AxisQuantity {
    /// All of them, in the order of the list.
    pub const ALL: [Self; 6] =
        [Self::SetPoint, Self::Actual, Self::FollowingError, Self::SetSpeed, Self::ActualSpeed, Self::Torque];

    /// The word behind the letter of the axis in a story: `X-error`.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::SetPoint => "set",
            Self::Actual => "actual",
            Self::FollowingError => "error",
            Self::SetSpeed => "set-speed",
            Self::ActualSpeed => "actual-speed",
            Self::Torque => "torque",
        }
    }

    fn name_on(self, axis: Axis) -> LocalizedText {
        match self {
            Self::SetPoint => phrase!("{axis} 设定值", "{axis} set-point", axis),
            Self::Actual => phrase!("{axis} 实际值", "{axis} actual", axis),
            Self::FollowingError => phrase!("{axis} 跟随误差", "{axis} following error", axis),
            Self::SetSpeed => phrase!("{axis} 设定速度", "{axis} set speed", axis),
            Self::ActualSpeed => phrase!("{axis} 实际速度", "{axis} actual speed", axis),
            Self::Torque => phrase!("{axis} 扭矩", "{axis} torque", axis),
        }
    }
}

/// A signal of the scope.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ScopeSignal {
    /// A quantity of an axis.
    Axis(Axis, AxisQuantity),
    /// Speed along the path, mm/min.
    Feed,
    /// Speed of the wheel as set, of the main spindle as measured, r/min.
    Rotation,
    /// An input, 0 or 1.
    Input(Input),
    /// An output, 0 or 1.
    Output(Output),
}

impl ScopeSignal {
    /// All signals of a machine: axes, speeds, inputs, outputs.
    pub fn of(fitted: Fitted) -> impl Iterator<Item = Self> {
        let axes = Axis::ALL.into_iter().filter(move |axis| fitted.axes()[*axis]);
        let of_axis = |axis| AxisQuantity::ALL.into_iter().map(move |quantity| Self::Axis(axis, quantity));
        let inputs = Input::ALL.iter().copied().filter(move |input| input.exists_on(fitted));
        let outputs = Output::ALL.iter().copied().filter(move |output| output.exists_on(fitted));
        axes.flat_map(of_axis)
            .chain([Self::Feed, Self::Rotation])
            .chain(inputs.map(Self::Input))
            .chain(outputs.map(Self::Output))
    }

    /// Whether it is 0 or 1.
    #[must_use]
    pub const fn is_digital(self) -> bool {
        matches!(self, Self::Input(_) | Self::Output(_))
    }

    /// Its word in stories: `X-error`, `feed`, `rotation`, `input:estop`, `output:wheel`.
    #[must_use]
    pub fn id(self) -> String {
        match self {
            Self::Axis(axis, quantity) => format!("{}-{}", axis.letter(), quantity.id()),
            Self::Feed => "feed".to_owned(),
            Self::Rotation => "rotation".to_owned(),
            Self::Input(input) => format!("input:{}", input.id()),
            Self::Output(output) => format!("output:{}", output.id()),
        }
    }

    /// The signal of a word, on whatever machine.
    #[must_use]
    pub fn from_id(id: &str) -> Option<Self> {
        match id {
            "feed" => return Some(Self::Feed),
            "rotation" => return Some(Self::Rotation),
            _ => {}
        }
        if let Some(input) = id.strip_prefix("input:") {
            return Input::from_id(input).map(Self::Input);
        }
        if let Some(output) = id.strip_prefix("output:") {
            return Output::from_id(output).map(Self::Output);
        }
        let (axis, quantity) = id.split_once('-')?;
        let [letter] = axis.chars().collect::<Vec<_>>()[..] else { return None };
        let axis = Axis::from_letter(letter.to_ascii_uppercase())?;
        let quantity = AxisQuantity::ALL.into_iter().find(|known| known.id() == quantity)?;
        Some(Self::Axis(axis, quantity))
    }

    /// Its name.
    #[must_use]
    pub fn name(self, fitted: Fitted) -> LocalizedText {
        match self {
            Self::Axis(axis, quantity) => quantity.name_on(axis),
            Self::Feed => Text::new("进给", "feed").into(),
            Self::Rotation if fitted.kind.row().has(Equipment::MainSpindle) => {
                Text::new("主轴转速", "spindle speed").into()
            }
            Self::Rotation => Text::new("砂轮设定转速", "wheel speed, set").into(),
            Self::Input(input) => input.name().into(),
            Self::Output(output) => output.name().into(),
        }
    }

    /// Its unit, with Ø where the diameter of X counts the way of the slide twice; empty for inputs and outputs.
    #[must_use]
    pub const fn unit(self, x_as_diameter: bool) -> &'static str {
        match self {
            Self::Axis(Axis::X, AxisQuantity::SetPoint | AxisQuantity::Actual) if x_as_diameter => "mm Ø",
            Self::Axis(Axis::X, AxisQuantity::FollowingError) if x_as_diameter => "µm Ø",
            Self::Axis(Axis::X, AxisQuantity::SetSpeed | AxisQuantity::ActualSpeed) if x_as_diameter => "mm/min Ø",
            Self::Axis(_, AxisQuantity::SetPoint | AxisQuantity::Actual) => "mm",
            Self::Axis(_, AxisQuantity::FollowingError) => "µm",
            Self::Axis(_, AxisQuantity::SetSpeed | AxisQuantity::ActualSpeed) | Self::Feed => "mm/min",
            Self::Axis(_, AxisQuantity::Torque) => "%",
            Self::Rotation => "r/min",
            Self::Input(_) | Self::Output(_) => "",
        }
    }
}
