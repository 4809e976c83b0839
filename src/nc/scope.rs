//! Variable access while a block is read: local, common, modal and system variables. Source: spec B3.

use std::sync::Arc;

use super::expression::{Frame, Scope, Value};
use super::fault::{Outcome, Stop, Wrong, wrong1};
use super::flow::Locals;
use super::memory::Memory;
use super::modal::Modals;
use super::settings::Settings;
use super::source::Source;
use super::world::{Live, World};
use crate::defs::program_error::ProgramError as E;
use crate::defs::variable;
use crate::units::{Axis, MM_PER_INCH, PerAxis};

/// First system variables of the axis positions, machine and work coordinates; they count the machine's axes only.
const MACHINE_POSITION: u32 = 5_021;
const WORK_POSITION: u32 = 5_041;

/// A use of null as 0: text, byte and variable.
pub(crate) type NullUse = (Arc<Source>, usize, u32);

/// Variable access while a block is read.
pub(crate) struct LiveScope<'w> {
    pub locals: &'w Locals,
    pub memory: &'w Memory,
    pub modals: &'w Modals,
    pub settings: &'w Settings,
    pub program: u32,
    pub n: Option<u32>,
    /// Collects the variables that are read; only for a check.
    pub used: Option<&'w mut Vec<u32>>,
    pub nulls: &'w mut Option<Vec<NullUse>>,
    pub last_null: u32,
    pub notes: &'w mut Option<Vec<Wrong>>,
    pub source: &'w Arc<Source>,
    pub world: &'w mut dyn World,
}

impl LiveScope<'_> {
    /// The position at the start of the block.
    #[inline]
    pub fn position(&self) -> PerAxis<f64> {
        self.world.position()
    }

    /// Adds a warning: allowed but rarely intended.
    pub fn note(&mut self, at: usize, error: E, details: [String; 2]) {
        if let Some(notes) = self.notes {
            notes.push(Wrong { at, error, details });
        }
    }
}

impl Scope for LiveScope<'_> {
    const STRICT: bool = true;

    fn read(&mut self, number: u32, at: usize) -> Outcome<Value> {
        let value = self.look_up(number, at)?;
        if let Some(used) = &mut self.used {
            used.push(number);
        }
        if value.is_none() {
            self.last_null = number;
        }
        Ok(value)
    }

    fn axis_position(&mut self, axis: Axis, frame: Frame, at: usize) -> Outcome<Value> {
        let present = |axis: &Axis| self.settings.axes[*axis];
        if !present(&axis) {
            return wrong1(at, E::NoAxis, axis.letter());
        }
        let index = Axis::ALL.into_iter().filter(present).take_while(|other| *other != axis).count() as u32;
        let first = match frame {
            Frame::Machine => MACHINE_POSITION,
            Frame::Work => WORK_POSITION,
        };
        self.look_up(first + index, at)
    }

    fn null_used(&mut self, at: usize) {
        if let Some(nulls) = self.nulls {
            nulls.push((Arc::clone(self.source), at, self.last_null));
        }
    }
}

impl LiveScope<'_> {
    fn look_up(&mut self, number: u32, at: usize) -> Outcome<Value> {
        match number {
            0 => Ok(None),
            1..=33 => Ok(self.locals[number as usize - 1]),
            4114 => Ok(self.n.map(f64::from)),
            4115 => Ok(Some(f64::from(self.program))),
            4000..=4200 => self
                .modals
                .variable(number, self.settings.is_mill())
                .map_or_else(|| wrong1(at, E::BadVariable, format!("#{number}")), Ok),
            434..=439 | 1000.. => match self.world.system(number) {
                Live::Value(Some(length)) if self.modals.inch && variable::is_place(number) => {
                    Ok(Some(length / MM_PER_INCH))
                }
                Live::Value(value) => Ok(value),
                Live::Drain => Err(Box::new(Stop::Drain)),
                Live::Unknown => wrong1(at, E::BadVariable, format!("#{number}")),
            },
            _ => self.memory.get(number).or_else(|_| wrong1(at, E::BadVariable, format!("#{number}"))),
        }
    }
}
