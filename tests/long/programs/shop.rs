//! A machine with a program and its part, ready for cycle start.

use kt830::controller::PowerOnState;
use kt830::defs::key::Key;
use kt830::defs::kind::Kind;
use kt830::host::headless::{HeadlessHost, HostSetup};
use kt830::io::sim::{EventKind, MachineFile, PartFile, SurfaceFile};
use kt830::link::command::Command;
use kt830::link::snapshot::{RunState, Tone};

use crate::stories::folders;

/// Ticks after cycle start in which the run shows itself.
const START_TICKS: u32 = 5;
/// Longest run, simulated seconds.
const LONGEST_S: f64 = 3_600.0;

/// Machine, control, part.
pub struct Shop {
    pub rig: HeadlessHost,
    pub part: PartFile,
}

/// What a run came to.
#[derive(Debug, PartialEq)]
pub enum End {
    Finished,
    Stopped,
    /// The number of the alarm and its text.
    Alarm(u16, String),
}

/// The part of a program.
pub fn part_of(program: u32) -> PartFile {
    PartFile::builtin(program).unwrap().unwrap()
}

/// A ready machine with a program and its part.
pub fn shop(program: u32) -> Shop {
    shop_with(program, 1, |_| ())
}

/// The same with a seed of chance and changes to the part.
pub fn shop_with(program: u32, seed: u64, change: impl FnOnce(&mut PartFile)) -> Shop {
    let mut part = part_of(program);
    change(&mut part);
    let retained = PowerOnState::factory(part.kind);
    let mut rig =
        HeadlessHost::new(HostSetup { kind: part.kind, retained, store: None, folders: folders(), seed }).unwrap();
    rig.mount_part(&part);
    rig.step();
    rig.make_ready();
    rig.mount_part(&part);
    rig.send(Command::LoadProgram(program));
    rig.step();
    Shop { rig, part }
}

/// Every runout of a part made this much, mm.
pub fn with_runout(part: &mut PartFile, mm: f64) {
    for surface in &mut part.surfaces {
        match surface {
            SurfaceFile::Diameter { runout, .. }
            | SurfaceFile::Cone { runout, .. }
            | SurfaceFile::Bore { runout, .. }
            | SurfaceFile::Disc { runout, .. } => {
                *runout = mm;
            }
            SurfaceFile::Face { .. } | SurfaceFile::Plane { .. } | SurfaceFile::Wall { .. } => {}
        }
    }
}

/// A program ready to start on a machine whose wheel has this grinding ratio.
pub fn shop_with_wheel(program: u32, ratio: f64, change: impl FnOnce(&mut PartFile)) -> Shop {
    let mut shop = shop_with(program, 1, change);
    let mut machine = MachineFile::builtin(shop.part.kind).unwrap();
    machine.wheel.grinding_ratio = ratio;
    shop.rig.swap_machine(machine, 1);
    shop.rig.make_ready();
    let part = shop.part.clone();
    shop.rig.mount_part(&part);
    shop.load(program);
    // The drives switch on.
    crate::stories::tell(&mut shop.rig, "wait 2 s");
    shop
}

impl Shop {
    /// A value of the grinding page.
    pub fn set(&mut self, variable: u16, value: f64) -> &mut Self {
        self.rig.send(Command::SetVariable(variable, Some(value)));
        self.rig.step();
        self
    }

    /// A value as it is now.
    pub fn value(&mut self, variable: usize) -> Option<f64> {
        self.rig.snapshot().variables[variable]
    }

    /// Another program becomes current; the part stays.
    pub fn load(&mut self, program: u32) {
        self.rig.send(Command::LoadProgram(program));
        self.rig.step();
    }

    /// A fresh part of the same kind in place of the old one, as a loader brings it.
    pub fn next_part(&mut self) {
        let part = self.part.clone();
        self.rig.machine_mut().set_part(Some(&part));
    }

    /// Cycle start, to the end of the program.
    pub fn run(&mut self) -> End {
        self.rig.send(Command::Press(Key::CycleStart));
        self.rig.step();
        self.rig.send(Command::Release(Key::CycleStart));
        let begun = self.rig.now();
        for _ in 0..START_TICKS {
            self.rig.step();
        }
        let snapshot = self.rig.snapshot();
        let (message, alarmed) = (snapshot.message.clone(), !snapshot.alarms.is_empty());
        let now = self.rig.now();
        let refused = !alarmed && message.tone == Tone::Refused && now.since(message.since) < now.since(begun);
        assert!(!refused, "cycle start was refused: {}", message.text.zh());
        loop {
            self.rig.step();
            assert!(self.rig.now().since(begun).as_secs_f64() < LONGEST_S, "the program does not end");
            match self.rig.controller().state() {
                RunState::Idle => return End::Finished,
                RunState::Stopped | RunState::Held | RunState::Waiting => return End::Stopped,
                RunState::Alarm if self.rig.controller().is_at_rest() => {
                    let alarm = self.rig.snapshot().alarms[0].clone();
                    return End::Alarm(alarm.number, alarm.text.zh().into_owned());
                }
                RunState::Running | RunState::Homing | RunState::Alarm => {}
            }
        }
    }

    /// Runs to the end; nothing must have happened to machine or part.
    pub fn grind(&mut self) {
        assert_eq!(self.run(), End::Finished);
        assert_eq!(self.events(), []);
    }

    pub fn events(&self) -> Vec<EventKind> {
        self.rig.machine().events().iter().map(|event| event.kind).collect()
    }

    /// Greatest deviation of what the report measures from a size, µm, with its sign.
    pub fn worst_um(&self, wanted: impl Fn(Measured) -> f64) -> f64 {
        let report = self.rig.machine().measure();
        let diameters = report.diameters.iter().map(|at| (Measured::Diameter(at.z), at.d));
        let faces = report.faces.iter().map(|at| (Measured::Face(at.z), at.z));
        let heights = report.heights.iter().map(|at| (Measured::Height(at.z), at.y));
        let off = diameters.chain(faces).chain(heights).map(|(place, found)| (found - wanted(place)) * 1_000.0);
        off.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap()
    }
}

/// Where something was measured.
#[derive(Clone, Copy, Debug)]
pub enum Measured {
    /// Z.
    Diameter(f64),
    /// The Z found.
    Face(f64),
    /// Z.
    Height(f64),
}

/// The programs and the kinds they are for.
pub const PROGRAMS: [(u32, Kind); 20] = [
    (1001, Kind::Gc),
    (1002, Kind::Gc),
    (1003, Kind::Gc),
    (1004, Kind::Gc),
    (1005, Kind::Gc),
    (1006, Kind::Gc),
    (1007, Kind::Gs),
    (1008, Kind::Gs),
    (1009, Kind::Gs),
    (1010, Kind::Ga),
    (1011, Kind::Gc),
    (1012, Kind::Gc),
    (1013, Kind::Gs),
    (1014, Kind::Ga),
    (1015, Kind::Gc),
    (1016, Kind::Gc),
    (1017, Kind::Gc),
    (1018, Kind::Gc),
    (1019, Kind::Gc),
    (1020, Kind::Gc),
];
