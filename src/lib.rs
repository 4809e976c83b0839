//! KT-830: a CNC control for grinding machines. A touch screen and a controller core in one process, joined by channels;
//! a simulated machine stands in for the real one.
//!
//! This is the short map. `docs/architecture.md` tells the rest: function by function the way of a key press, a block, a
//! set-point and a stored value, where what is decided, and the glossary.
//!
//! # Rooms
//!
//! Who may import whom is checked by `tests/cli/tidy.rs`; siblings never import each other.
//!
//! | room | what it owns | imports |
//! |---|---|---|
//! | [`units`] | time, axes | – |
//! | [`defs`] | one table per concept: keys, signals, M and G codes, parameters, alarms, pages; [`defs::kind`], one file per kind of machine | units |
//! | [`link`] | [`link::Command`] in, [`link::Snapshot`] out: all that screen and core share | units, defs |
//! | [`nc`] | program text → [`nc::Op`]; moves nothing | units, defs, geometry |
//! | [`geometry`] | lines and arcs in a plane, the path of a cutter beside them | – |
//! | [`motion`] | moves → set-points within velocity, acceleration, jerk and tolerance | units, defs |
//! | [`machine`] | the units; [`machine::rules`], the interlock table; [`machine::phase`] of a run; [`machine::panel_key`], what a key requests | units, defs, link |
//! | [`io`] | [`io::Backend`]; the simulated machine and its physics | units, defs |
//! | [`store`] | what survives a power cut, and the folders into which people copy files | units, defs |
//! | [`controller`] | [`controller::Controller::tick`] in a fixed order | the core above |
//! | [`host`] | clock, threads, disk; [`host::Host`], the one way to run the core: stepped or on a thread | controller, machine, nc, io, store, link |
//! | [`story`] | what an operator does, as text; its player | host, io, link |
//! | [`torture`] | random operators, faults and power cuts, and what holds in every tick | story, host, controller |
//! | [`technology`] | proposed speeds, infeeds, spark-out and dressing, with the limits that set them | defs |
//! | [`gateway`] | what the control tells the network, on a thread of its own | units, defs, link |
//! | `hmi` | the screen (feature `hmi`): pages, panel, theme | units, defs, link, technology |
//! | [`cli`] | the command line | all |
//!
//! # The path of a key press
//!
//! finger → `hmi::panel` → [`link::Command`] → bounded channel (reset, hold and emergency stop have one of their own) →
//! [`host::thread`] → [`controller::Controller::tick`]: inputs, commands (`Panel::press_key` sends a request to
//! [`machine::Machine::request`], which asks the table [`machine::rules`]), machine logic and alarms, program, jog and
//! homing, axes, outputs → [`io::Backend::write`] → newest-only [`link::Snapshot`] → page. It never runs back: a lamp
//! shows the output, not the request.
//!
//! # The path of a move
//!
//! text → on the lathe and the 802D [`nc::ProgramPreflight`] reads all of it before anything moves →
//! [`nc::Interpreter::next`] → [`nc::Op`] (radius mm, work coordinates) → `LookaheadState` converts it to machine
//! coordinates and checks the soft limits → `ProgramRun` hands it to [`motion::TrajectoryPlanner`], in order with the
//! actions between the moves → [`motion::TrajectoryPlanner::tick`], one set-point per tick → [`io::OutputImage`].
//! Variables, work offsets and block numbers change when the machine gets there, not when the block is read.
//!
//! # What always holds
//!
//! - Time, inputs and commands are arguments of the core: the same story gives the same trace, bit for bit.
//! - An output changes by a row of the interlock table or a sequence of [`machine`], never by a page.
//! - No axis moves while the drives are off, while another owner moves it, or beyond a soft limit once it is homed.
//! - Every refusal says why; a refused request changes nothing.
//! - A lost screen, a silent bus or a panic leads to the safe output image: spindles and fluids off, clamps hold.
//!
//! # Words
//!
//! *Block*: one line of a program. *Op*: a canonical operation of a block. *Action*: anything other than a move that a
//! run executes in program order. *Barrier*: an operation that must be executed before the next block is read. *Drain*:
//! all motion is over and the axes are in position. *Host*: control, machine and storage; stepped, or paced on a thread.
//! *Slide travel*: true millimetres of an axis; X is shown as twice that in diameter mode.

pub mod cli;
pub mod controller;
pub mod defs;
pub mod gateway;
pub mod geometry;
#[cfg(feature = "hmi")]
pub mod hmi;
pub mod host;
pub mod io;
pub mod link;
pub mod machine;
pub mod motion;
pub mod nc;
pub mod store;
pub mod story;
pub mod technology;
pub mod torture;
pub mod units;
