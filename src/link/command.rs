//! Commands to the core from the operator, a story or the disk thread.

use std::sync::Arc;

use super::edit::OffsetCommand;
use super::page_command::PageCommand;
use super::part_result::PartCommand;
use super::production::{OrderCommand, OrderProposal, PartInspection};
use super::screens::Screens;
use super::simulation::SimCommand;
use super::teach::TeachCommand;
use super::toolpath::StockBox;
use super::wheels::WheelCommand;
use crate::defs::date::DateTime;
use crate::defs::key::Key;
use crate::defs::leadscrew::LeadscrewCompensation;
use crate::defs::page::Page;
use crate::defs::param::ParamAddress;
use crate::defs::soft_key::CoordinateView;
use crate::defs::text::LocalizedText;
use crate::units::{Axis, PerAxis};

/// One request to the core. The tick that takes it either executes it or shows a message with the reason of the
/// refusal.
#[derive(Clone, Debug)]
pub enum Command {
    /// A panel key is pressed. A jog key acts only while [`Command::StillHeld`] is repeated.
    Press(Key),
    /// The emergency stop on the screen: pressed in and latched, or turned out. Pressed twice it stays latched.
    EmergencyStop(bool),
    /// A panel key is released.
    Release(Key),
    /// A jog key is still held; sent at least every 50 ms. After `JOG_KEEP_ALIVE` without it the core stops the jog.
    StillHeld(Key),
    /// Detents by which the on-screen handwheel was turned.
    Handwheel(i32),
    /// Opens a page.
    OpenPage(Page),
    /// Opens the position page with these coordinates, or switches it to them (K7.1).
    ShowCoordinates(CoordinateView),
    /// Shows this row of soft keys, from 0.
    ShowSoftKeyRow(usize),
    /// Shows this sheet of the grinding page, from 0, where the page has several.
    ShowGrindingSheet(usize),
    /// Loads a program of the folder as the current program.
    LoadProgram(u32),
    /// Reads the current program up to a line (from 1); cycle start then runs it from there (B5).
    RestartAt(u32),
    /// Prepares the run that a power cut ended, from the interrupted block (B5).
    ResumeInterrupted,
    /// Executes a line of MDI text.
    Mdi(String),
    /// Sets a macro variable of the open page to a typed value; `None` empties it.
    EnterVariable(u16, Option<f64>),
    /// A request of the offset or dressing page.
    Offset(OffsetCommand),
    /// Adds an increment to the wear of an offset, typed as U, V or W; G10 takes the same path (K4.1).
    AddWear {
        /// 1 to 16.
        number: usize,
        /// Axis.
        axis: Axis,
        /// mm as displayed.
        increment: f64,
    },
    /// The part of the last cycle: its measured size, or the correction that follows from it.
    Part(PartCommand),
    /// The list of production orders.
    Order(OrderCommand),
    /// The shop proposes an order, or changes one that nobody has accepted. The operator decides.
    ProposeOrder(OrderProposal),
    /// The wheel was changed (K5.17): new size and rated speed. The wheel must be dressed before a cycle start.
    ChangeWheel {
        /// Diameter, mm.
        diameter_mm: f64,
        /// Width, mm.
        width_mm: f64,
        /// Rated peripheral speed, m/s.
        rated_m_s: f64,
    },
    /// The list of the wheels of the shop.
    Wheel(WheelCommand),
    /// Prepares a line of MDI text for cycle start; an empty line withdraws it.
    PrepareMdi(String),
    /// Sets a macro variable without a page (`--set`, `set` in a story, a restored backup).
    SetVariable(u16, Option<f64>),
    /// Sets a parameter without a page (`--param`, `param` in a story); no password is needed.
    SetParam(ParamAddress, f64),
    /// Sets a work offset by the index that it is stored by (0 is G54), machine coordinates, radius mm.
    SetWorkOffset(usize, PerAxis<f64>),
    /// Sets the geometry of a tool offset, 1 to 16, radius mm.
    SetGeometry(usize, PerAxis<f64>),
    /// Sets the circle of a tool offset, 1 to 16: radius R in mm, and place T of the programmed point.
    SetCutter(usize, f64, u8),
    /// The simulated machine has mounted the part of the current program and set work offset and geometry for it.
    PartMounted,
    /// The simulated machine has measured the finished part; a real one sends nothing.
    PartInspected(PartInspection),
    /// Sets the boxes of the workpiece and its fixture, for the graphic page.
    SetStock(Arc<[StockBox]>),
    /// Sets the leadscrew error table of an axis (B7).
    SetLeadscrew(Axis, LeadscrewCompensation),
    /// Sets the relative position of an axis to zero.
    ClearRelative(Axis),
    /// The disk thread has read the folder of page texts and pictures.
    ScreensLoaded(Arc<Screens>),
    /// The disk thread has stored everything up to this mark of the core's requests.
    Stored(u64),
    /// The disk thread could not execute a request.
    DiskFailed(LocalizedText),
    /// A request of the parameter or settings page, a file request, or the disk's answer.
    Page(PageCommand),
    /// A request of the simulator page to the simulated machine; the core never handles it.
    Simulate(SimCommand),
    /// The counters and times of the bus page begin anew.
    ClearBusCounters,
    /// A request of the teach-in page (L9).
    Teach(TeachCommand),
    /// Time of the computer's clock, sent periodically. Only displayed dates depend on it.
    WallClock(DateTime),
    /// Keep-alive of the screen; without it the core stops after the keep-alive time (P76, ms).
    KeepAlive,
    /// A finger or a key on the screen of a demonstration: whoever it is takes over.
    TakeOver,
}
