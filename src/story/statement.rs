//! The statements of a story, as parsed.
//! Source: spec tools.md, "Story language".

use crate::defs::key::{Key, Mode};
use crate::defs::kind::Kind;
use crate::defs::page::Page;
use crate::defs::param::ParamAddress;
use crate::defs::signal::{Input, Output};
use crate::io::sim::EventKind;
use crate::link::demo_view::DemoView;
use crate::link::media::{Direction, TransferSet};
use crate::link::page_command::PageCommand;
use crate::link::production::{OrderCommand, OrderProposal};
use crate::link::snapshot::RunState;
use crate::link::teach::TeachCommand;
use crate::units::Axis;

/// A syntax error in a story.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, column {column}: {cause}")]
pub struct StoryError {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// Cause and expected word.
    pub cause: String,
}

/// A line of the story.
#[derive(Clone, Debug, PartialEq)]
pub struct StoryLine {
    /// Its number, from 1.
    pub number: u32,
    /// The text as written, without its comment.
    pub text: String,
    /// Its statement.
    pub statement: Statement,
}

/// How an input is forced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputForce {
    /// Forced to this logical level.
    To(bool),
    /// Not forced.
    Released,
}

/// How the disk of a tortured control behaves from now on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DiskCondition {
    /// It stores at once.
    Good,
    /// It begins with a request up to so many seconds later.
    Slow(f64),
    /// It does nothing for so many seconds.
    Hangs(f64),
    /// It takes nothing more.
    Full,
    /// So many bits of the retained data flip in the next power cut.
    Flips(u32),
}

/// The condition of `wait until`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WaitCondition {
    /// A state.
    State(RunState),
    /// A work coordinate below (true) or above a value.
    Axis(Axis, bool, f64),
}

/// A number that a story can check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// Work coordinate.
    Work(Axis),
    /// Machine coordinate.
    Machine(Axis),
    /// Macro variable.
    Variable(u16),
    /// Wear of an offset.
    Wear(usize, Axis),
    /// Diameter of the part at a Z.
    PartDiameter(f64),
    /// Z of the part's face at a diameter.
    PartFace(f64),
    /// Height of the part at X, Z.
    PartHeight(f64, f64),
}

/// What a story expects.
#[derive(Clone, Debug, PartialEq)]
pub enum Expectation {
    /// An output is on or off.
    Output(Output, bool),
    /// An input is active or not.
    Input(Input, bool),
    /// A lamp is on or off.
    Lamp(Key, bool),
    /// An alarm of this number is present.
    Alarm(u16),
    /// Some alarm is present.
    AnyAlarm,
    /// An alarm with this text is present.
    AlarmText(String),
    /// No alarm is present.
    NoAlarm,
    /// The simulated machine has reported such an event.
    Event(EventKind),
    /// The simulated machine has reported no event.
    NoEvent,
    /// The state.
    State(RunState),
    /// A number within a tolerance.
    Value {
        /// The quantity.
        of: Quantity,
        /// The expected value.
        is: f64,
        /// The tolerance.
        tolerance: f64,
    },
    /// The message line contains this.
    Message(String),
    /// The page shows this.
    Page(Page, String),
}

/// One statement.
#[derive(Clone, Debug, PartialEq)]
pub enum Statement {
    /// `kind gc`
    Kind(Kind),
    /// `power on`
    PowerOn,
    /// `power cut`
    PowerCut,
    /// `param P270 500`
    Param(ParamAddress, f64),
    /// `set #500 = 40.2`; without a value: null
    Set(u16, Option<f64>),
    /// `load O1001`
    Load(u32),
    /// `load SHAFT`: a named program.
    LoadNamed(String),
    /// `mode auto`
    Mode(Mode),
    /// `home all`
    HomeAll,
    /// `key 循环启动`
    Key(Key),
    /// `press …`
    Press(Key),
    /// `release …`
    Release(Key),
    /// `hold X- 1.5 s`
    Hold(Key, f64),
    /// `handwheel X -25 x0.01`
    Handwheel(Axis, i32, Key),
    /// `mdi G00 X50`
    Mdi(String),
    /// `page grinding`
    Page(Page),
    /// `type #505 0.03`
    Type(u16, Option<f64>),
    /// `input hydraulic-pressure off`
    Input(String, InputForce),
    /// `fault pressure-loss`
    Fault(String),
    /// `fault pressure-loss off`: the fault is repaired
    FaultOff(String),
    /// `fault list`: lists the names of all faults; simulates none
    FaultList,
    /// `wait 2 s`
    Wait(f64),
    /// `wait until idle max 60 s`
    WaitUntil(WaitCondition, f64),
    /// `seed 7`
    Seed(u64),
    /// `caption "砂轮启动" "the wheel starts"`, `title "平面磨床" "Surface grinder"`: what spectators are told below the page, or
    /// in large letters over it; `caption off`: nothing
    ShowDemo(DemoView),
    /// `prepared`: a demonstration begins here; the lines before it are played unseen and at once
    Prepared,
    /// `sheet 2` of a grinding page with several sheets; the first is 1
    Sheet(usize),
    /// `write O2001 "G00 X50"`: makes a program, or replaces its text.
    WriteProgram(u32, String),
    /// `delete O2001`
    DeleteProgram(u32),
    /// `disk slow 200 ms`, `disk hangs 5 s`, `disk full`, `disk flips 3`, `disk good`: with `kt830 torture` only
    Disk(DiskCondition),
    /// `screen hangs 4 s`: the screen sends no keep-alive for so long; with `kt830 torture` only
    ScreenHangs(f64),
    /// `export backup`, `import backup`: programs, screens, params, variables or backup, to or from the USB stick
    Transfer(Direction, TransferSet),
    /// `stall`: the computer has held the control up for longer than P475
    Stall,
    /// `unlock builder 830830`: program, user or builder; `password user 123456 246810`: a password takes the place of
    /// another; `accept data`: what took the place of damaged data is accepted; `scope X-error Z-error span 4 s rising 20`:
    /// the scope records up to four signals (`X-set`, `X-actual`, `X-error`, `X-set-speed`, `X-actual-speed`, `feed`,
    /// `rotation`, `input:ID`, `output:ID`), at once or when the first rises or falls to a level; `scope stop`
    Settings(PageCommand),
    /// `order 501 O1002 50`, `order start 501`: the list of production orders.
    Order(OrderCommand),
    /// An order of the shop.
    ProposeOrder(OrderProposal),
    /// `teach start|stop|undo|keep`: records jogged moves (L9)
    Teach(TeachCommand),
    /// `part FILE`
    Part(String),
    /// `screw X FILE`
    Screw(Axis, String),
    /// `expect …`
    Expect(Expectation),
}
