//! System variables: machine data that a program can read.
//! Numbers follow FANUC: #1000 inputs, #1100 outputs, #2001 wear, #3001 times, #3901 counts, #5001 positions.
//! Source: spec B3, K4.3 (#438, #439).

use super::{Plant, key_stroke};
use crate::defs::kind::Kind;
use crate::defs::param::{self, NumberParam, Params};
use crate::defs::program_number;
use crate::defs::signal::Input;
use crate::defs::system_variable::{self, SystemVariableRange};
use crate::link::edit::OffsetPart;
use crate::nc::work_offsets::TOOL_OFFSET_COUNT;
use crate::nc::{CodeMacros, CutterSource, NcSettings, OriginPlace, SpeedUnit, SuperManSettings, ToolOffsetPlace};
use crate::units::{Axis, PerAxis};

/// System variables mapped to parameters.
pub const PARAM_VARIABLES: [(SystemVariableRange, NumberParam); 7] = [
    (system_variable::PARTS_REQUIRED, param::PARTS_REQUIRED),
    (system_variable::WHEEL_DIAMETER, param::WHEEL_DIAMETER),
    (system_variable::WHEEL_WIDTH, param::WHEEL_WIDTH),
    (system_variable::PARTS_SINCE_DRESSING, param::PARTS_SINCE_DRESSING),
    (system_variable::DRESSING_INTERVAL, param::DRESSING_INTERVAL),
    (system_variable::DRESSING_COUNT, param::DRESSING_COUNT),
    (system_variable::DRESSER_SIDE, param::DRESSING_POINT_SIDE),
];
const SECONDS_PER_HOUR: f64 = 3_600.0;

/// The axes of #5811 to #5813, whatever is fitted.
const POINT_AXES: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

/// The system variables that a program without a machine reads: those of parameters, and the dressing points, machine
/// coordinates, radius mm.
pub fn stored_system_variables(
    params: &Params,
    dress_points: PerAxis<Option<f64>>,
) -> impl Iterator<Item = (u32, Option<f64>)> {
    let of_params = PARAM_VARIABLES.iter().map(|(range, row)| (range.first, Some(params.get(*row))));
    let axes = POINT_AXES.into_iter().zip(system_variable::DRESSING_POINT.first..);
    let per_mm = if params.bit(param::RADIUS_PROGRAMMING) { 1.0 } else { 2.0 };
    let shown = move |axis: Axis| dress_points[axis].map(|mm| if axis == Axis::X { mm * per_mm } else { mm });
    of_params.chain(axes.map(move |(axis, number)| (number, shown(axis))))
}

/// Interpreter settings for a kind of machine with these parameters.
#[must_use]
pub fn nc_settings(kind: Kind, params: &Params) -> NcSettings {
    let row = kind.row();
    NcSettings {
        diameter: !params.bit(param::RADIUS_PROGRAMMING),
        axes: params.fitted().axes(),
        least_increment_mm: params.bit(param::INTEGERS_AS_LEAST_INCREMENTS).then_some(0.001),
        inch: false,
        tolerance_mm: params.get(param::PATH_TOLERANCE),
        arc_tolerance_mm: 0.01,
        speed_unit: if params.bit(param::S_IS_SURFACE_SPEED) { SpeedUnit::MetresPerSecond } else { SpeedUnit::Rpm },
        jump_input: params.get(param::JUMP_INPUT) as u32,
        tool_count: TOOL_OFFSET_COUNT as u32,
        program_limit: program_number::o_limit(params.get(param::PROGRAM_DIGITS) as u32),
        cutter_source: match params.get(param::CUTTER_SOURCE) as u32 {
            1 => CutterSource::Offset(params.get(param::DRESSER_OFFSET) as u32),
            2 => CutterSource::WholeWheel,
            _ => CutterSource::ToolOffset,
        },
        g_macros: code_macros(params, &param::G_MACROS),
        m_macros: code_macros(params, &param::M_MACROS),
        oscillation_by_cylinder: params.bit(param::OSCILLATION_BY_CYLINDER),
        oscillation_stroke: key_stroke(params),
        rapid_mm_min: PerAxis::from_fn(|axis| params.get_axis(param::RAPID_X, axis)),
        superman: SuperManSettings {
            line_feed: params.get(param::DEFAULT_LINE_FEED),
            arc_feed: params.get(param::DEFAULT_ARC_FEED),
            rapid_z_per_x: params.get(param::RAPID_Z_PER_X),
            increment_mm: params.get(param::LEAST_INPUT_INCREMENT),
            origin: PerAxis::from_fn(|axis| params.get_axis(param::HOME_X, axis)),
            arcs_reversed: !params.bit(param::ISO_ARC_DIRECTION),
            spindle_rpm: params.get(param::WHEEL_RPM),
            max_rpm: params.get(param::WHEEL_RPM_MAX),
            z_accel_jerk: (params.get_axis(param::ACCELERATION_X, Axis::Z), params.get_axis(param::JERK_X, Axis::Z)),
        },
        ..NcSettings::for_dialect(row.dialect)
    }
}

fn code_macros(params: &Params, rows: &[(NumberParam, NumberParam); 10]) -> CodeMacros {
    rows.map(|(code, program)| (params.get(code) as u16, params.get(program) as u16))
}

impl Plant {
    /// The value of a system variable; `None` if it is null or does not exist.
    #[must_use]
    pub fn system_variable(&self, number: u32) -> Option<f64> {
        self.read_system_variable(number).flatten()
    }

    /// A system variable; `None` if it does not exist, `Some(None)` for null.
    pub fn read_system_variable(&self, number: u32) -> Option<Option<f64>> {
        let switched = |on: bool| Some(f64::from(u8::from(on)));
        let of = |range: SystemVariableRange| range.index(number);
        if let Some(index) = of(system_variable::INPUTS) {
            let inverted = self.params.inverted_inputs() >> index & 1 == 1;
            return Some(switched(self.inputs.image.terminals.is_closed(index as u8 + 1) ^ inverted));
        }
        if let Some(index) = of(system_variable::OUTPUTS) {
            // Switching by the previous block counts at once, one tick before it reaches the terminals.
            return Some(switched(self.outputs_now().1.is_closed(index as u8 + 1)));
        }
        if let Some(index) = of(system_variable::GAUGE_SIGNALS) {
            return Some(switched(self.inputs.raw.has(Input::GAUGES[index])));
        }
        if of(system_variable::CONTACT_SEEN).is_some() {
            let has_monitor = self.params.input_port(Input::WheelContact) != 0;
            return Some(if has_monitor { switched(self.work.contact_seen) } else { None });
        }
        if let Some(index) = of(system_variable::GAUGE_POSITIONS) {
            return Some(self.work.gauge_positions[index]);
        }
        if let Some(value) = self.read_offset(number).map(Some).or_else(|| self.read_position(number)) {
            return Some(value);
        }
        Some(match *system_variable::find(number)? {
            system_variable::OSCILLATION => {
                let (forward, backward) = self.oscillation_flags();
                switched(if number == system_variable::OSCILLATION.first { forward } else { backward })
            }
            system_variable::MILLISECONDS => Some(self.milliseconds() + self.work.timer_offset[0]),
            system_variable::HOURS => Some(self.hours() + self.work.timer_offset[1]),
            system_variable::SINGLE_BLOCK_CONTROL => Some(f64::from(self.work.program_controls.single_block)),
            system_variable::HOLD_CONTROL => Some(f64::from(self.work.program_controls.hold)),
            system_variable::DATE => {
                let [year, month, day, ..] = self.date.parts();
                Some((year * 10_000 + month * 100 + day) as f64)
            }
            system_variable::TIME_OF_DAY => {
                let [.., hour, minute, second] = self.date.parts();
                Some((hour * 10_000 + minute * 100 + second) as f64)
            }
            system_variable::X_SCALE => Some(self.displayed_per_mm(Axis::X)),
            system_variable::PARTS_DONE => Some(f64::from(self.work.part_count)),
            // An axis that is not fitted has no origin.
            system_variable::EXTERNAL_ORIGIN => None,
            system_variable::ORIGINS | system_variable::EXTRA_ORIGINS => {
                OriginPlace::of_variable(number)?;
                None
            }
            range => Some(self.params.get(PARAM_VARIABLES.iter().find(|(of, _)| *of == range)?.1)),
        })
    }

    /// Whole milliseconds since power-on.
    pub const fn milliseconds(&self) -> f64 {
        (self.now.0 / 1_000) as f64
    }

    pub fn hours(&self) -> f64 {
        self.now.as_secs_f64() / SECONDS_PER_HOUR
    }

    pub fn read_offset(&self, number: u32) -> Option<f64> {
        let place = ToolOffsetPlace::of_variable(number);
        place
            .map(|place| self.work.offsets.tool_offset_value(place) * self.displayed_per_mm(place.axis))
            .or_else(|| self.work.offsets.cutter_variable(number))
            .or_else(|| self.read_origin(number))
    }

    fn read_origin(&self, number: u32) -> Option<f64> {
        let (place, index) = OriginPlace::of_variable(number)?;
        let axis = self.axes.present().nth(index)?;
        Some(self.work.offsets.origin(place)[axis] * self.displayed_per_mm(axis))
    }

    /// A position; `Some(None)`, null, for an axis that this machine does not have, or a dressing point that is not set.
    pub fn read_position(&self, number: u32) -> Option<Option<f64>> {
        let ranges = [
            system_variable::BLOCK_END,
            system_variable::MACHINE_POSITION,
            system_variable::WORK_POSITION,
            system_variable::SKIP_POSITION,
            system_variable::DRESSING_POINT,
        ];
        let (which, index) = ranges.iter().enumerate().find_map(|(at, range)| Some((at, range.index(number)?)))?;
        // Positions count the fitted axes, as FANUC does.
        let axis = if which == 4 { POINT_AXES.get(index).copied() } else { self.axes.present().nth(index) };
        let Some(axis) = axis else { return Some(None) };
        let mm = match which {
            0 => self.work.offsets.work_from_machine(self.axes.set_point())[axis],
            1 => self.axes.actual()[axis],
            2 => self.work_position()[axis],
            3 => self.work.skip_position[axis],
            _ => match self.work.dress_points[axis] {
                Some(mm) => mm,
                None => return Some(None),
            },
        };
        Some(Some(mm * self.displayed_per_mm(axis)))
    }
}

/// The offset table that a variable belongs to; origins of work coordinates have the range of the geometry.
pub fn offset_part_of_variable(number: u32) -> Option<OffsetPart> {
    match ToolOffsetPlace::of_variable(number) {
        Some(ToolOffsetPlace { is_wear: true, .. }) => Some(OffsetPart::Wear),
        Some(_) => Some(OffsetPart::Geometry),
        None => OriginPlace::of_variable(number).is_some().then_some(OffsetPart::Geometry),
    }
}
