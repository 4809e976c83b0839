//! Ten simulated hours of oscillation: overrides, holds and infeed beside it; not a stroke is missed, doubled or short
//! (K4.3).

use crate::stories::tell;
use kt830::controller::PowerOnState;
use kt830::defs::key::Key;
use kt830::defs::kind::Kind;
use kt830::defs::param;
use kt830::host::folders::program_from_bytes;
use kt830::host::headless::{HeadlessHost, HostSetup};
use kt830::link::Command;
use kt830::link::snapshot::RunState;
use kt830::units::Axis;

/// Tick time, ms: P58 at its greatest.
const TICK_MS: u32 = 4;
/// 10 h in ticks.
const TEN_HOURS: u32 = 10 * 3_600_000 / TICK_MS;
/// One increment, mm.
const INCREMENT_MM: f64 = 0.001;
/// Where the stroke begins (the ready machine), work coordinate.
const BACK_MM: f64 = -150.0;
/// Where it turns.
const FRONT_MM: f64 = -250.0;

/// At every forward end 0.001 mm of diameter is fed in, for ever.
const INFEED: &str = "G98\nG35 Z-250 D400 Q10\n#1=0\nWHILE[#1 LT 99999]DO1\nN10 IF[#438 EQ 0]GOTO 10\nG01 U-0.001 F10\n#1=#1+1\n\
                      #100=#1\nN20 IF[#439 EQ 0]GOTO 20\nEND1\nM30";

/// What the operator does meanwhile: a key every few seconds, the same ones every time. The feed override stays above 0:
/// at 0 the infeed would rightly wait, and the strokes pass it by.
struct Operator {
    seed: u64,
    feed: u16,
}

impl Operator {
    /// A number below `most`.
    fn draw(&mut self, most: u64) -> u64 {
        // Knuth's MMIX generator; the upper bits are the good ones.
        self.seed = self.seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.seed >> 33) % most
    }

    fn act(&mut self, rig: &mut HeadlessHost) {
        let running = matches!(rig.controller().state(), RunState::Running);
        let key = match self.draw(6) {
            0 if self.feed > 10 => {
                self.feed -= 10;
                Key::FeedOverrideDown
            }
            0 | 1 => {
                self.feed = (self.feed + 10).min(150);
                Key::FeedOverrideUp
            }
            2 => Key::Rapid25,
            3 => Key::Rapid100,
            _ if running => Key::FeedHold,
            _ => Key::CycleStart,
        };
        rig.send(Command::Press(key));
    }
}

/// What is counted.
#[derive(Default)]
struct Count {
    /// Ticks of the forward ends.
    forward: Vec<u32>,
    /// Forward ends, and backward ends that follow one.
    strokes: u32,
    /// Forward ends that the program could see.
    seen: u32,
    /// Whether it has seen the present one.
    armed: bool,
}

/// A ready machine with a tick of 4 ms and the infeed program.
fn slow_ticks() -> HeadlessHost {
    let mut retained = PowerOnState::factory(Kind::Gc);
    retained.params.write(param::TICK_TIME.address(), f64::from(TICK_MS) * 1_000.0).unwrap();
    let setup = HostSetup { kind: Kind::Gc, retained, store: None, folders: crate::stories::folders(), seed: 1 };
    let mut rig = HeadlessHost::new(setup).unwrap();
    rig.make_ready();
    rig.add_program(program_from_bytes(7_000, "O7000.NC", INFEED.as_bytes().to_vec(), rig.kind().dialect()));
    tell(&mut rig, "load O7000");
    rig
}

#[test]
fn k4_3_ten_hours_of_strokes_with_overrides_holds_and_infeed() {
    let mut rig = slow_ticks();
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.05 s\nexpect lamp oscillation on");
    let mut operator = Operator { seed: 830, feed: 100 };
    let (mut count, mut last) = (Count { armed: true, ..Count::default() }, (false, false));
    let mut next = 0;
    for tick in 0..TEN_HOURS {
        if tick == next {
            operator.act(&mut rig);
            next += (500 + operator.draw(9_500) as u32) / TICK_MS;
        }
        rig.step();
        let now = rig.controller().oscillation_flags();
        if now != last {
            let forward = now == (true, false);
            assert!(forward || now == (false, true) && last == (true, false), "{last:?} then {now:?} at {tick}");
            let (end, at) = (if forward { FRONT_MM } else { BACK_MM }, rig.controller().actual()[Axis::Z]);
            // Machine and work Z differ by nothing on the ready machine.
            assert!((at - end).abs() <= INCREMENT_MM, "tick {tick}: turned at {at:.4}, not {end}");
            if forward {
                count.forward.push(tick);
            }
            count.strokes += 1;
            last = now;
        }
        look(&rig, last, &mut count);
    }
    judge(&mut rig, &count);
}

/// What the program sees in a tick in which it runs.
fn look(rig: &HeadlessHost, flags: (bool, bool), count: &mut Count) {
    if matches!(rig.controller().state(), RunState::Running) {
        if flags.0 && count.armed {
            count.seen += 1;
            count.armed = false;
        } else if flags.1 {
            count.armed = true;
        }
    }
}

fn judge(rig: &mut HeadlessHost, count: &Count) {
    // One way: 100 mm at 2000 mm/min = 33.333 mm/s with 416.667 mm/s² and 20 000 mm/s³:
    // 100/33.333 + 33.333/416.667 + 416.667/20 000 = 3.0000 + 0.0800 + 0.0208 = 3.1008 s, then the lag dies away to P54.
    let cycles: Vec<u32> = count.forward.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let first = cycles[0];
    assert!((6_202..=6_500).contains(&(first * TICK_MS)), "a cycle of {first} ticks");
    assert!(cycles.iter().all(|cycle| cycle.abs_diff(first) <= 1), "the cycles differ by more than a tick");
    let whole = TEN_HOURS / first;
    assert!((count.forward.len() as u32).abs_diff(whole) <= 1, "{} strokes, {whole} fit in", count.forward.len());
    let fed = rig.snapshot().variables[100].unwrap_or(0.0);
    assert!(f64::from(count.seen).total_cmp(&fed).is_eq(), "{} ends seen, {fed} infeeds", count.seen);
    assert!(count.seen > whole / 3, "holds have left the program something to do");
    // #100 infeeds of 0.001 mm of diameter; the last may be under way.
    let x = 2.0 * rig.controller().set_point()[Axis::X];
    assert!((x - (-80.0 - 0.001 * fed)).abs() < 0.0011, "X {x:.4} after {fed} infeeds");
    tell(rig, "expect no alarm");
}
