//! The operator: a random course of work and of everything that goes wrong, as lines of a story.

use crate::defs::alarm;
use crate::defs::key::Key;
use crate::defs::kind::Kind;
use crate::defs::page::Page;
use crate::defs::param::Params;
use crate::defs::program_number;
use crate::defs::signal::Input;
use crate::defs::sim_fault::{FAULTS, FaultArgument};
use crate::io::random::SplitMix64;
use crate::link::snapshot::{DirectoryRow, Snapshot};

/// Programs of its own that the operator writes.
const OWN_PROGRAMS: [u32; 4] = [2_001, 2_002, 2_003, 2_004];

/// Parameters that an operator may change without turning the machine into another one, with their values.
const PARAMS: &[(&str, &[f64])] = &[
    ("P270", &[0.0, 200.0, 3_000.0]),
    ("P17.0", &[0.0, 1.0]),
    ("P16.1", &[0.0, 1.0]),
    ("P16.2", &[0.0, 1.0]),
    ("P6.5", &[0.0, 1.0]),
    ("P6.3", &[0.0, 1.0]),
    ("P59", &[0.0, 4.0, 10.0]),
    ("P63", &[500.0, 3_000.0]),
    ("P66", &[50.0, 200.0, 1_000.0]),
    ("P332", &[0.0, 60.0]),
    ("P4.4", &[0.0, 1.0]),
];

/// Inputs that something at the machine, or a hand at a terminal, can change.
const FORCED_INPUTS: [Input; 9] = [
    Input::HydraulicPressure,
    Input::GuardClosed,
    Input::TailstockAdvanced,
    Input::TailstockRetracted,
    Input::ExternalStart,
    Input::ExternalHold,
    Input::User1,
    Input::Gauge1,
    Input::Gauge4,
];

/// Passwords that the operator changes to and from, each as delivered first. The builder's stays, so that alarms of lost
/// data can be accepted.
const PASSWORDS: [(&str, [&str; 2]); 2] = [("program", ["187350", "246810"]), ("user", ["123456", "135790"])];

/// A random operator of a kind of machine.
pub struct RandomOperator {
    kind: Kind,
    keys: Vec<Key>,
    /// The control has values for its programs.
    has_begun: bool,
    chance: SplitMix64,
    lines: Vec<String>,
}

impl RandomOperator {
    /// An operator; the same seed gives the same course.
    #[must_use]
    pub fn new(kind: Kind, seed: u64) -> Self {
        let fitted = Params::factory(kind).fitted();
        let keys = Key::ALL.iter().copied().filter(|key| key.exists_on(fitted)).collect();
        Self { kind, keys, has_begun: false, chance: SplitMix64::new(seed ^ 0x5eed), lines: Vec::new() }
    }

    /// The next lines: one thing that an operator does, or that happens to him, at what he sees.
    pub fn next_lines(&mut self, seen: &Snapshot) -> Vec<String> {
        if !self.has_begun && !seen.directory.is_empty() {
            self.has_begun = true;
            self.begin(seen);
            return std::mem::take(&mut self.lines);
        }
        match self.below(100) {
            0..=11 => self.press_some_key(),
            12..=19 => self.switch_on_and_off(),
            20..=39 => self.run_program(seen),
            40..=47 => self.mdi(),
            48..=57 => self.move_by_hand(),
            58..=65 => self.edit_values(),
            66..=69 => self.stop(),
            70..=77 => self.fault(),
            78..=81 => self.force_input(),
            82..=85 => self.power_cut(),
            86..=87 => self.disk(),
            88 => self.usb_stick(),
            89..=92 => self.edit_programs(),
            93..=94 => self.dressing_point(),
            95..=96 => self.open_page(),
            97 => self.change_password(),
            _ => self.say("wait 20 s"),
        }
        std::mem::take(&mut self.lines)
    }

    /// Loads every program once, so that it has the values of its part, and keeps these.
    fn begin(&mut self, seen: &Snapshot) {
        for program in self.main_programs(seen) {
            self.say(format!("load {program}"));
            self.say("wait 200 ms");
        }
        self.say("export variables");
        self.say("wait 1 s");
    }

    /// Names of the programs of this kind of machine that are no subprograms.
    fn main_programs(&self, seen: &Snapshot) -> Vec<String> {
        let is_main = |row: &&DirectoryRow| {
            row.is_for(self.kind) && !program_number::is_protected_subprogram(row.number) && !row.name.starts_with('L')
        };
        seen.directory.iter().filter(is_main).map(|row| row.name.clone()).collect()
    }

    fn below(&mut self, count: usize) -> usize {
        (self.chance.next_unit() * count as f64) as usize
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }

    fn say(&mut self, line: impl Into<String>) {
        self.lines.push(line.into());
    }

    /// Presses a key, if the machine has it.
    fn press(&mut self, key: Key) {
        if self.keys.contains(&key) {
            self.say(format!("key {}", key.id()));
        }
    }

    /// From a tick to some seconds, the short ones as often as the long ones.
    fn wait(&mut self, most_s: f64) {
        let ms = (1.0 + (most_s * 1_000.0).ln() * self.chance.next_unit()).exp().min(most_s * 1_000.0);
        self.say(format!("wait {ms:.0} ms"));
    }

    fn press_some_key(&mut self) {
        for _ in 0..=self.below(4) {
            let at = self.below(self.keys.len());
            let key = self.keys[at];
            self.press(key);
        }
        self.wait(2.0);
    }

    /// From any state to a machine that can work.
    fn prepare(&mut self, seen: &Snapshot) {
        for fault in FAULTS.iter().filter(|fault| fault.argument == FaultArgument::None) {
            self.say(format!("fault {} off", fault.name));
        }
        for input in FORCED_INPUTS {
            self.say(format!("input {} free", input.id()));
        }
        self.say("disk good");
        for latched in [Key::EmergencyStop, Key::MachineLock, Key::Oscillation] {
            if self.keys.contains(&latched) && seen.key(latched).lamp {
                self.press(latched);
            }
        }
        if seen.alarms.iter().any(|alarm| alarm.number == alarm::HARD_LIMIT) {
            // One direction is refused, the other leads away.
            self.say("key reset");
            self.say("mode jog");
            let way = self.pick(&["X+", "X-", "Z+", "Z-"]);
            self.say(format!("hold {way} 5 s"));
        }
        self.say("key reset");
        for key in [Key::Hydraulic, Key::Magnetise, Key::TailstockAdvance, Key::WheelStart] {
            if self.keys.contains(&key) && !seen.key(key).lamp {
                self.press(key);
                self.say("wait 3 s");
            }
        }
        self.say("key reset");
        if self.below(2) == 0 {
            // Values with which the programs run: those of the first minute.
            self.say("import variables");
            self.say("wait 1 s");
        }
        self.say("home all");
    }

    /// Switches what a machine needs, on or off.
    fn switch_on_and_off(&mut self) {
        self.say("key reset");
        for key in [Key::Hydraulic, Key::Magnetise, Key::TailstockAdvance] {
            if self.below(2) == 0 {
                self.press(key);
                self.wait(4.0);
            }
        }
        if self.below(3) > 0 {
            self.say("home all");
        }
    }

    fn run_program(&mut self, seen: &Snapshot) {
        if self.below(3) > 0 {
            self.prepare(seen);
        }
        let program = match self.below(3) {
            0 => format!("O{}", self.pick(&OWN_PROGRAMS)),
            _ => {
                let programs = self.main_programs(seen);
                let at = self.below(programs.len());
                programs.get(at).cloned().unwrap_or_default()
            }
        };
        if self.below(5) > 0 {
            self.say(format!("load {program}"));
        }
        self.say("mode auto");
        self.say("key cycle-start");
        for _ in 0..self.below(6) {
            self.wait(20.0);
            match self.below(20) {
                0 => self.say("stall"),
                1 => {
                    let seconds = self.pick(&[1, 4]);
                    self.say(format!("screen hangs {seconds} s"));
                    self.say("wait 5 s");
                }
                _ => {}
            }
            let key = self.pick(&[
                Key::FeedHold,
                Key::CycleStart,
                Key::SingleBlock,
                Key::FeedOverrideUp,
                Key::FeedOverrideDown,
                Key::Rapid25,
                Key::Rapid100,
                Key::WheelRetract,
                Key::Reset,
                Key::OptionalStop,
                Key::Coolant,
                Key::WheelStop,
            ]);
            self.press(key);
        }
        match self.below(2) {
            0 => self.wait(60.0),
            _ => {
                let seconds = self.below(90);
                self.say(format!("wait {seconds} s"));
            }
        }
    }

    fn mdi(&mut self) {
        let [x, z] = [(); 2].map(|()| (self.chance.next_unit() * 400.0 - 200.0).round() / 10.0);
        let line = match self.below(8) {
            0 => format!("G00 X{x} Z{z}"),
            1 => format!("G01 X{x} F{}", 50 + self.below(2_000)),
            2 => format!("G00 U{} W{}", x / 10.0, z / 10.0),
            3 => "M03 S1000".to_owned(),
            4 => "M05".to_owned(),
            5 => format!("M{}", self.below(90)),
            6 => format!("G27 X Z F{}", 100 + self.below(900)),
            _ => format!("#{} = {}", 500 + self.below(100), x),
        };
        self.say(format!("mdi {line}"));
        self.wait(3.0);
    }

    fn move_by_hand(&mut self) {
        let axis = self.pick(&["X", "Z"]);
        let sign = self.pick(&["+", "-"]);
        match self.below(5) {
            0 | 1 => {
                self.say("mode jog");
                if self.below(3) == 0 {
                    self.say("key rapid");
                }
                let ms = 20 + self.below(3_000);
                self.say(format!("hold {axis}{sign} {ms} ms"));
            }
            2 => {
                let (detents, step) = (self.below(200) as i32 - 100, self.pick(&["x0.001", "x0.01", "x0.1"]));
                self.say(format!("handwheel {axis} {detents} {step}"));
            }
            3 => {
                self.say("mode step");
                self.say(format!("key {}-{}", axis.to_lowercase(), if sign == "+" { "plus" } else { "minus" }));
            }
            _ => {
                self.press(Key::Oscillation);
                self.wait(10.0);
                let end = self.pick(&[Key::Oscillation, Key::Reset, Key::EmergencyStop, Key::ModeAuto]);
                self.press(end);
            }
        }
        self.wait(2.0);
    }

    fn say_one_of(&mut self, lines: &[&str]) {
        let line = self.pick(lines);
        self.say(line);
    }

    fn pick_text(&mut self, from: &[&str]) -> String {
        self.pick(from).to_owned()
    }

    fn edit_values(&mut self) {
        for _ in 0..=self.below(3) {
            let value = (self.chance.next_unit() * 100_000.0).round() / 1_000.0;
            let line = match self.below(4) {
                0 => {
                    let (name, values) = self.pick(PARAMS);
                    format!("param {name} {}", self.pick(values))
                }
                1 => format!("set #{} = {}", 200 + self.below(234), value),
                2 => format!("type #{} {}", 500 + self.below(70), value),
                3 if self.below(10) == 0 => format!("set #{} = {}", 580 + self.below(400), value / 3.0),
                // Programs do not use these.
                _ => format!("set #{} = {}", 950 + self.below(50), value / 3.0),
            };
            self.say(line);
        }
        self.wait(1.0);
    }

    fn stop(&mut self) {
        if self.below(2) == 0 {
            self.say("input emergency-stop on");
            self.wait(3.0);
            self.say("input emergency-stop free");
        } else {
            self.say("key emergency-stop");
            self.wait(3.0);
            self.say("key emergency-stop");
        }
        self.say("key reset");
        self.wait(1.0);
    }

    fn fault(&mut self) {
        let fault = &FAULTS[self.below(FAULTS.len())];
        match fault.argument {
            FaultArgument::None => {
                self.say(format!("fault {}", fault.name));
                self.wait(20.0);
                if self.below(4) > 0 {
                    self.say(format!("fault {} off", fault.name));
                }
            }
            FaultArgument::Input => {
                let input = self.pick(Input::ALL).id();
                self.say(format!("fault {} {input}", fault.name));
                self.wait(20.0);
                self.say(format!("fault {} {input} off", fault.name));
            }
            FaultArgument::Ticks => {
                let ticks = 1 + self.below(12);
                self.say(format!("fault {} {ticks}", fault.name));
                self.wait(2.0);
            }
        }
        if self.below(2) == 0 {
            self.say("key reset");
        }
    }

    fn force_input(&mut self) {
        let input = self.pick(&FORCED_INPUTS);
        let level = self.pick(&["on", "off"]);
        self.say(format!("input {} {level}", input.id()));
        self.wait(5.0);
        self.say(format!("input {} free", input.id()));
    }

    fn power_cut(&mut self) {
        if self.below(6) == 0 {
            // A bad bit, or a bad sector.
            let bits = if self.below(2) == 0 { 1 + self.below(4) } else { 1_000 };
            self.say(format!("disk flips {bits}"));
        }
        // Often just when something is being stored.
        if self.below(2) == 0 {
            self.edit_values();
            self.lines.pop();
        }
        self.say("power cut");
        self.wait(3.0);
        self.say("power on");
        self.wait(1.0);
        if self.below(4) == 0 {
            self.say_one_of(&["unlock builder 830830", "unlock builder 111111", "unlock program 830830"]);
            self.say("wait 50 ms");
            self.say("accept data");
        }
    }

    fn disk(&mut self) {
        let line = match self.below(5) {
            0 => "disk full".to_owned(),
            1 => format!("disk hangs {} s", 1 + self.below(20)),
            2 => format!("disk slow {} ms", 1 + self.below(400)),
            _ => "disk good".to_owned(),
        };
        self.say(line);
        self.edit_values();
        self.wait(5.0);
        if self.below(2) == 0 {
            self.say("disk good");
        }
    }

    fn edit_programs(&mut self) {
        let program = self.pick(&OWN_PROGRAMS);
        if self.below(5) > 0 {
            let password = self.pick(&PASSWORDS[0].1);
            self.say(format!("unlock program {password}"));
            self.say("mode edit");
            self.say("wait 50 ms");
        }
        if self.below(5) == 0 {
            return self.say(format!("delete O{program}"));
        }
        let mut text = Vec::new();
        for _ in 0..=self.below(12) {
            let [x, z] = [(); 2].map(|()| (self.chance.next_unit() * 200.0 - 100.0).round() / 10.0);
            text.push(match self.below(10) {
                0 => format!("G00 X{x} Z{z}"),
                1 => format!("G01 U{} F{}", x / 10.0, 20 + self.below(3_000)),
                2 => format!("G01 U{} W{} F500", x / 10.0, z / 10.0),
                3 => format!("G04 P{}", self.below(500)),
                4 => self.pick_text(&["M03 S800", "M05", "M08", "M09", "M10", "M11", "M14", "M15", "M60", "M61"]),
                5 => format!("#{} = #{} + 1", 500 + self.below(50), 500 + self.below(50)),
                6 => format!("M{}", self.below(90)),
                7 => self.pick_text(&["M00", "M01", "G35 Z5 Q40", "G36", "G27 X", "G28 U0"]),
                8 => "WHILE[#120 LT 5] DO1\\n#120=#120+1\\nEND1".to_owned(),
                _ => format!("G91 G01 Z{} F1000\\nG90", z / 10.0),
            });
        }
        text.push(self.pick_text(&["M30", "M02", "M99"]));
        self.say(format!("write O{program} \"{}\"", text.join("\\n")));
    }

    /// The old password may be the wrong one: then nothing changes.
    fn change_password(&mut self) {
        let (scope, words) = self.pick(&PASSWORDS);
        let [old, new] = if self.below(3) == 0 { [words[0], words[1]] } else { [words[1], words[0]] };
        self.say(format!("password {scope} {old} {new}"));
        self.wait(1.0);
    }

    fn usb_stick(&mut self) {
        if self.below(3) == 0 {
            self.say("unlock builder 830830");
            self.say("wait 50 ms");
        }
        for _ in 0..=self.below(2) {
            let direction = self.pick(&["export", "import"]);
            let set = self.pick(&["programs", "screens", "params", "backup", "backup"]);
            self.say(format!("{direction} {set}"));
            self.wait(2.0);
        }
    }

    fn dressing_point(&mut self) {
        self.say("mode jog");
        self.say("page position");
        for key in self.pick(&[["address-x", "input"], ["address-z", "input"]]) {
            self.say(format!("key {key}"));
        }
        self.press(Key::DressReturn);
        let axis = self.pick(&[Key::XPlus, Key::ZMinus]);
        self.press(axis);
        self.wait(10.0);
        if self.below(2) == 0 {
            self.press(Key::DressReturn);
        }
    }

    fn open_page(&mut self) {
        let page = self.pick(Page::ALL);
        self.say(format!("page {}", page.id()));
        if self.below(3) == 0 {
            let mode = self.pick(&["edit", "auto", "mdi", "home", "handwheel", "step", "jog"]);
            self.say(format!("mode {mode}"));
        }
    }
}
