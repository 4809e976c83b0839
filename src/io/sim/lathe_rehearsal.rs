//! A lathe's program gone through on a bar before anything moves: what its tools would crash into (L9). The same bar,
//! tools and rules as while it is cut; time and acceleration are left out.

use super::machine_rows::{ToolFile, ToolPostFile};
use super::part_file::{BodyFile, PartFile};
use super::turning::{Bar, reaches_any, shaped};
use crate::defs::param::Params;
use crate::units::{Axis, PerAxis};

/// Longest piece of a way that is looked at at once, mm: a cell of the bar.
const PIECE_MM: f64 = 0.1;
/// Most pieces: 400 m of way.
const PIECES: u64 = 4_000_000;

/// Tools and bar, as far as the program has come.
#[derive(Clone, Debug)]
pub struct LatheRehearsal {
    bar: Bar,
    bodies: Vec<BodyFile>,
    tools: Vec<ToolFile>,
    crash_mm: f64,
    station: usize,
    /// From work coordinates of the program to the tip in part coordinates, X, Z; none before they are known.
    shift: Option<(f64, f64)>,
    turns: bool,
    pieces: u64,
    met: Option<&'static str>,
}

impl LatheRehearsal {
    /// A new bar, and the tools as the parameters define them; station 1 in front. None without a bar.
    #[must_use]
    pub fn new(part: &PartFile, post: &ToolPostFile, params: &Params) -> Option<Self> {
        let tools = shaped(post, params).tools.to_vec();
        let bar = part.bar.as_ref().map(Bar::new)?;
        let (bodies, crash_mm) = (part.bodies.clone(), post.crash_mm);
        Some(Self { bar, bodies, tools, crash_mm, station: 0, shift: None, turns: false, pieces: 0, met: None })
    }

    /// The spindle is switched.
    pub const fn turn(&mut self, on: bool) {
        self.turns = on;
    }

    /// Another station comes in front; with compensation the slides move by `by`, mm.
    pub fn change(&mut self, station: usize, by: Option<PerAxis<f64>>) {
        let tip = |station: usize| self.tools.get(station).map_or((0.0, 0.0), |tool| tool.tip_mm);
        let (old, new) = (tip(self.station), tip(station));
        if let Some((x, z)) = &mut self.shift {
            let by = by.unwrap_or_default();
            *x += new.0 - old.0 + by[Axis::X];
            *z += new.1 - old.1 + by[Axis::Z];
        }
        self.station = station;
    }

    /// The present point gets other coordinates: the first time it is the bar's own.
    pub fn rename(&mut self, from: PerAxis<f64>, to: PerAxis<f64>) {
        let (x, z) =
            self.shift.map_or((0.0, 0.0), |(x, z)| (x + from[Axis::X] - to[Axis::X], z + from[Axis::Z] - to[Axis::Z]));
        self.shift = Some((x, z));
    }

    /// A straight way in work coordinates: the first thing that it meets, told once as long as it is met.
    pub fn go(&mut self, from: PerAxis<f64>, to: PerAxis<f64>, rapid: bool) -> Option<&'static str> {
        let (shift, tool) = (self.shift?, self.tools.get(self.station)?.clone());
        let length = (to[Axis::X] - from[Axis::X]).hypot(to[Axis::Z] - from[Axis::Z]);
        let pieces = (length / PIECE_MM).ceil().max(1.0) as u64;
        if self.pieces + pieces > PIECES {
            return None;
        }
        self.pieces += pieces;
        let at = |share: f64| {
            let on = |axis: Axis| from[axis] + (to[axis] - from[axis]) * share;
            (on(Axis::X) + shift.0, on(Axis::Z) + shift.1)
        };
        let (mut before, mut newly) = (at(0.0), None);
        for piece in 1..=pieces {
            let here = at(piece as f64 / pieces as f64);
            let chuck = reaches_any(&tool, here, &self.bodies).then_some("chuck");
            let met = chuck.or(self.bar.cut(&tool, (before, here), self.crash_mm, (rapid, !self.turns)));
            newly = newly.or(met.filter(|_| self.met.is_none()));
            self.met = met;
            before = here;
        }
        newly
    }
}
