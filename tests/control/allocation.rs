//! The tick allocates and frees nothing: neither while a program runs nor when it starts and ends, nor for keys,
//! overrides, MDI lines, a change of program and edits of the operator.
//!
//! The allocator of this test binary counts the calls that a thread makes while it is armed.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use kt830::defs::date::DateTime;
use kt830::defs::key::{Key, Mode};
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::param;
use kt830::defs::production_order::OrderValues;
use kt830::defs::scope_signal::ScopeSignal;
use kt830::defs::text::Lang;
use kt830::host::folders::program_from_bytes;
use kt830::host::headless::HeadlessHost;
use kt830::io::sim::PartFile;
use kt830::link::command::Command;
use kt830::link::edit::OffsetCommand;
use kt830::link::page_command::PageCommand;
use kt830::link::production::{OrderCommand, OrderProposal};
use kt830::link::scope::{ScopeCommand, ScopeSetup, ScopeTrigger};
use kt830::link::snapshot::RunState;
use kt830::link::teach::TeachCommand;
use kt830::units::{Axis, Micros, PerAxis};

use crate::stories::{ready_of, ready_with};

/// Most ticks of a program, an hour of machine time.
const MOST_TICKS: u64 = 3_600_000;

struct CountingAllocator;

thread_local! {
    static ARMED: Cell<bool> = const { Cell::new(false) };
    static CALLS: Cell<u64> = const { Cell::new(0) };
}

fn count() {
    // A thread that ends has no counter any more.
    if ARMED.try_with(Cell::get) == Ok(true) {
        CALLS.set(CALLS.get() + 1);
    }
}

// SAFETY: every call goes to the system allocator unchanged.
#[allow(unsafe_code, reason = "an allocator is unsafe by its trait")]
unsafe impl GlobalAlloc for CountingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        count();
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Steps by one tick; the number of allocations and frees in `Controller::tick`.
fn calls_in_a_tick(host: &mut HeadlessHost) -> u64 {
    let before = CALLS.get();
    host.step_around(|tick| {
        ARMED.set(true);
        tick();
        ARMED.set(false);
    });
    CALLS.get() - before
}

/// Sends a command and counts in its tick.
fn calls_for(host: &mut HeadlessHost, command: Command) -> u64 {
    host.send(command);
    calls_in_a_tick(host)
}

/// A ready machine with the part of a program and the program chosen.
fn with_part_of(number: u32) -> HeadlessHost {
    let part = PartFile::builtin(number).unwrap().unwrap();
    let mut host = ready_of(part.kind);
    host.mount_part(&part);
    host.send(Command::LoadProgram(number));
    host.send(Command::Press(Mode::Auto.key()));
    (0..10).for_each(|_| host.step());
    host
}

/// Runs the current program to its end; the calls in all its ticks, its start and its end included.
fn calls_of_run(host: &mut HeadlessHost) -> u64 {
    let mut calls = calls_for(host, Command::Press(Key::CycleStart));
    assert_eq!(host.controller().state(), RunState::Running);
    let mut ticks = 0;
    while host.controller().state() != RunState::Idle {
        calls += calls_in_a_tick(host);
        if host.controller().state() == RunState::Held {
            calls += calls_for(host, Command::Press(Key::CycleStart));
        }
        ticks += 1;
        assert!(ticks < MOST_TICKS, "the program does not end: {:?}", host.snapshot().message.text.get(Lang::En));
    }
    calls
}

#[test]
fn the_counter_counts() {
    ARMED.set(true);
    drop(std::hint::black_box(Box::new(1_u64)));
    ARMED.set(false);
    assert_eq!(CALLS.get(), 2);
}

#[test]
fn t5_the_tick_allocates_nothing_in_any_shipped_grinding_program() {
    for number in 1001..=1020 {
        let mut host = with_part_of(number);
        assert_eq!(calls_of_run(&mut host), 0, "O{number} on {:?}", host.kind());
        assert!(host.snapshot().alarms.is_empty(), "O{number}: {:?}", host.snapshot().alarms);
    }
}

/// A ready machine of a kind with one of its named programs chosen, and its part or bar.
fn with_named(kind: Kind, name: &str) -> HeadlessHost {
    let mut host = ready_of(kind);
    let number = host.find_program(name).unwrap();
    let part = host.bar_of_program(number).or_else(|| PartFile::builtin(number).unwrap());
    if let Some(part) = part {
        host.mount_part(&part);
        host.step();
        host.make_ready();
        host.mount_part(&part);
    }
    host.send(Command::LoadProgram(number));
    host.send(Command::Press(Mode::Auto.key()));
    (0..10).for_each(|_| host.step());
    host
}

#[test]
fn t5_the_tick_allocates_nothing_in_any_shipped_lathe_program() {
    for path in std::fs::read_dir("programs/lathe").unwrap() {
        let name = path.unwrap().file_name().into_string().unwrap();
        let mut host = with_named(Kind::Lathe, &name);
        assert_eq!(calls_of_run(&mut host), 0, "{name}");
        assert!(host.snapshot().alarms.is_empty(), "{name}: {:?}", host.snapshot().alarms);
    }
}

#[test]
fn t5_the_tick_allocates_nothing_in_any_shipped_vertical_program() {
    for name in ["VGRIND", "VBORE", "RGRIND", "RBORE"] {
        let mut host = with_named(Kind::Vertical, name);
        assert_eq!(calls_of_run(&mut host), 0, "{name}");
        assert!(host.snapshot().alarms.is_empty(), "{name}: {:?}", host.snapshot().alarms);
    }
}

/// Recording, copying for a screen that takes snapshots, waiting for a trigger, the end.
#[test]
fn t5_the_scope_allocates_nothing() {
    let signal = |word| ScopeSignal::from_id(word);
    let channels = [signal("X-error"), signal("X-set"), signal("feed"), signal("input:guard-closed")];
    for trigger in [ScopeTrigger::Now, ScopeTrigger::Falling(-1.0)] {
        let mut host = with_part_of(1002);
        let setup = ScopeSetup { channels, span: Micros::from_millis(4_000), trigger };
        let mut calls = calls_for(&mut host, Command::Page(PageCommand::Scope(ScopeCommand::Start(setup))));
        calls += calls_for(&mut host, Command::Press(Key::CycleStart));
        let mut painted = Vec::new();
        for tick in 0..12_000 {
            calls += calls_in_a_tick(&mut host);
            if tick % 33 == 0 {
                painted.push(host.snapshot().scope.clone());
                painted.drain(..painted.len().saturating_sub(2));
            }
        }
        assert_eq!(calls, 0, "{trigger:?}");
        assert_eq!(host.snapshot().scope.recording.samples.len(), 4_000);
    }
}

#[test]
fn t5_the_tick_allocates_nothing_for_an_mdi_line_and_a_change_of_program() {
    let lines = [
        (Kind::Gc, "G98 G01 U-1 F300; G04 X0.1", 1_002),
        (Kind::Gs, "N10 G91 G01 X-1. F300", 1_012),
        (Kind::Lathe, "G01U-1F300", 0),
        (Kind::Vertical, "N10 G91 G1 X-1 F300", 0),
    ];
    for (kind, line, other) in lines {
        let mut host = ready_of(kind);
        host.send(Command::Press(Mode::Mdi.key()));
        (0..10).for_each(|_| host.step());
        for _ in 0..2 {
            assert_eq!(calls_for(&mut host, Command::PrepareMdi(line.to_owned())), 0, "{line} is prepared");
            assert_eq!(calls_for(&mut host, Command::Press(Key::CycleStart)), 0, "{line} starts");
            assert_eq!(
                host.controller().state(),
                RunState::Running,
                "{:?}",
                host.snapshot().message.text.get(Lang::En)
            );
            while host.controller().state() != RunState::Idle {
                assert_eq!(calls_in_a_tick(&mut host), 0, "{line} runs");
            }
        }
        assert_eq!(calls_for(&mut host, Command::PrepareMdi(String::new())), 0, "{line} is taken back");
        assert_eq!(calls_for(&mut host, Command::Press(Mode::Auto.key())), 0);
        if other != 0 {
            assert_eq!(calls_for(&mut host, Command::LoadProgram(other)), 0, "O{other}");
            assert_eq!(host.snapshot().program.number, other);
        }
    }
}

#[test]
fn t5_the_tick_allocates_nothing_for_the_one_key_retract() {
    let mut host = ready_with("G98 G01 W-40 F600\nM30");
    host.add_program(program_from_bytes(9_000, "O9000.NC", b"G00 U4\nM99".to_vec(), host.kind().dialect()));
    host.send(Command::SetParam(param::WHEEL_RETRACT.address(), 1.0));
    host.send(Command::Press(Mode::Auto.key()));
    (0..10).for_each(|_| host.step());
    assert_eq!(calls_for(&mut host, Command::Press(Key::CycleStart)), 0);
    assert_eq!((0..1_000).map(|_| calls_in_a_tick(&mut host)).sum::<u64>(), 0);
    let x = host.controller().set_point()[Axis::X];
    assert_eq!(calls_for(&mut host, Command::Press(Key::WheelRetract)), 0);
    assert_eq!((0..3_000).map(|_| calls_in_a_tick(&mut host)).sum::<u64>(), 0);
    assert!((host.controller().set_point()[Axis::X] - x - 2.0).abs() < 1e-3, "U4 on the diameter");
}

#[test]
fn t5_the_tick_allocates_nothing_for_keys_overrides_and_edits() {
    let mut host = with_part_of(1001);
    let rapid = param::RAPID_X.address();
    let commands = [
        Command::SetParam(rapid, 5_000.0),
        Command::SetVariable(500, Some(1.5)),
        Command::Page(PageCommand::EditParam(rapid, 5_500.0)),
        Command::EnterVariable(500, Some(2.5)),
        Command::AddWear { number: 1, axis: Axis::X, increment: 0.01 },
        Command::Offset(OffsetCommand::AddGeometry { number: 1, axis: Axis::X, increment: 0.5 }),
        Command::SetWorkOffset(1, PerAxis([1.0, 0.0, 2.0])),
        Command::OpenPage(Page::Offset),
        Command::OpenPage(Page::Grinding),
        Command::Press(Mode::Manual.key()),
        Command::Press(Mode::Auto.key()),
        Command::Press(Key::SingleBlock),
        Command::Press(Key::SingleBlock),
        Command::Press(Key::FeedHold),
        Command::Press(Key::CycleStart),
        Command::Press(Key::FeedOverrideUp),
        Command::Press(Key::FeedOverrideDown),
        Command::Press(Key::Rapid50),
        Command::Press(Key::FeedHold),
    ];
    for command in commands {
        let told = format!("{command:?}");
        assert_eq!(calls_for(&mut host, command), 0, "{told}");
        for _ in 0..500 {
            assert_eq!(calls_in_a_tick(&mut host), 0, "after {told}");
        }
    }
    assert_eq!(host.controller().state(), RunState::Held);
    assert_eq!(calls_for(&mut host, Command::Press(Key::Reset)), 0, "RESET");
}

/// Steps until an alarm ends or holds the run; the calls in all ticks.
fn calls_until_alarm(host: &mut HeadlessHost) -> u64 {
    let mut calls = 0;
    for _ in 0..600_000 {
        calls += calls_in_a_tick(host);
        if !matches!(host.controller().state(), RunState::Running | RunState::Waiting) {
            return calls;
        }
    }
    panic!("no alarm: {:?}", host.snapshot().message.text.get(Lang::En));
}

#[test]
fn t5_the_tick_allocates_nothing_for_alarms_and_their_reset() {
    let mut host = with_part_of(1001);
    for _ in 0..2 {
        assert_eq!(calls_for(&mut host, Command::EmergencyStop(true)), 0);
        assert_eq!((0..100).map(|_| calls_in_a_tick(&mut host)).sum::<u64>(), 0);
        assert!(!host.snapshot().alarms.is_empty());
        assert_eq!(calls_for(&mut host, Command::EmergencyStop(false)), 0);
        assert_eq!(calls_for(&mut host, Command::Press(Key::Reset)), 0);
        assert_eq!((0..100).map(|_| calls_in_a_tick(&mut host)).sum::<u64>(), 0);
    }
}

#[test]
fn t5_the_tick_allocates_nothing_for_a_program_with_a_mistake() {
    let programs = [
        (Kind::Gc, "#1=0\nG98 G01 U-1 F100\n#2=1/#1\nM30", 21),
        (Kind::Gc, "G98 G01 U-1 F100\n#3000=12(WHEEL TOO SMALL 砂轮太小了)\nM30", 3_012),
        (Kind::Gs, "G98 G01 U-1 F1000000\nM30", 20),
        (Kind::Lathe, "N0010G01X10F100\nN0020G01Q5\nN0030M02", 1),
        (Kind::Vertical, "G1 X10 F100\nG1 X20 Q5\nM30", 1),
    ];
    for (kind, text, alarm) in programs {
        let mut host = ready_of(kind);
        host.add_program(program_from_bytes(7_000, "O7000.NC", text.as_bytes().to_vec(), kind.dialect()));
        host.send(Command::LoadProgram(7_000));
        host.send(Command::Press(Mode::Auto.key()));
        (0..10).for_each(|_| host.step());
        assert_eq!(calls_for(&mut host, Command::Press(Key::CycleStart)), 0, "{text}");
        assert_eq!(calls_until_alarm(&mut host), 0, "{text}");
        host.step();
        assert_eq!(host.snapshot().alarms.iter().map(|alarm| alarm.number).collect::<Vec<_>>(), [alarm], "{text}");
        assert_eq!(calls_for(&mut host, Command::Press(Key::Reset)), 0, "{text}");
    }
}

#[test]
fn t5_the_tick_allocates_nothing_for_cycles_over_a_contour() {
    let contour = "N10 G00 U-10\nG01 Z-8 F300\nG02 U4 W-2 R2\nG01 U4 W-5\nN20 U2";
    // 0.05 mm a stroke: 200 strokes of four operations, behind a queue that is full already.
    let many = format!("{}G71 U0.05 R0.5\nG71 P10 Q20 U0.2 W0.1 F600", "#1=1\n".repeat(600));
    for cycle in
        [&*many, "G71 U1 R0.5\nG71 P10 Q20 U0.2 W0.1 F600", "G73 U2 W1 R3\nG73 P10 Q20 U0.2 W0.1 F600", "G70 P10 Q20"]
    {
        let mut host = ready_with(&format!("G98 G00 X-4 Z-4 F600\n{cycle}\n{contour}\nM30"));
        host.send(Command::Press(Mode::Auto.key()));
        (0..10).for_each(|_| host.step());
        assert_eq!(calls_of_run(&mut host), 0, "{cycle}");
        host.step();
        assert!(host.snapshot().alarms.is_empty(), "{cycle}: {:?}", host.snapshot().alarms);
    }
}

#[test]
fn t5_the_tick_allocates_nothing_for_a_start_from_a_block() {
    let mut host = ready_with("G98 G01 X-81 F600\n#500=3\nU1\nU-1\nU1\nM30");
    host.send(Command::Press(Mode::Auto.key()));
    (0..10).for_each(|_| host.step());
    for _ in 0..2 {
        assert_eq!(calls_for(&mut host, Command::RestartAt(4)), 0);
        assert_eq!((0..100).map(|_| calls_in_a_tick(&mut host)).sum::<u64>(), 0, "the search");
        assert!(host.snapshot().restart.is_some());
        assert_eq!(calls_of_run(&mut host), 0);
    }
}

/// Holds a key for some ticks; the calls in them and in half a second after.
fn calls_while_held(host: &mut HeadlessHost, key: Key, ticks: u32) -> u64 {
    let mut calls = calls_for(host, Command::Press(key));
    calls += (0..ticks).map(|_| calls_in_a_tick(host)).sum::<u64>();
    calls += calls_for(host, Command::Release(key));
    calls + (0..500).map(|_| calls_in_a_tick(host)).sum::<u64>()
}

#[test]
fn t5_the_tick_allocates_nothing_for_a_manual_intervention_in_feed_hold() {
    let mut host = ready_with("G98 G01 W-10 F600\nW-10\nG02 U4 W-2 R2\nM30");
    host.send(Command::Press(Mode::Auto.key()));
    (0..10).for_each(|_| host.step());
    assert_eq!(calls_for(&mut host, Command::Press(Key::CycleStart)), 0);
    assert_eq!((0..500).map(|_| calls_in_a_tick(&mut host)).sum::<u64>(), 0);
    assert_eq!(calls_for(&mut host, Command::Press(Key::FeedHold)), 0);
    assert_eq!((0..500).map(|_| calls_in_a_tick(&mut host)).sum::<u64>(), 0);
    assert_eq!(calls_for(&mut host, Command::Press(Mode::Manual.key())), 0);
    let x = host.controller().set_point()[Axis::X];
    assert_eq!(calls_while_held(&mut host, Key::XPlus, 300), 0);
    assert!(host.controller().set_point()[Axis::X] > x, "the axis has moved");
    assert_eq!(calls_for(&mut host, Command::Press(Mode::Auto.key())), 0);
    assert_eq!(calls_of_run(&mut host), 0);
}

#[test]
fn t5_the_tick_allocates_nothing_for_a_teach_in() {
    let mut host = ready_of(Kind::Lathe);
    host.send(Command::Press(Mode::Manual.key()));
    (0..10).for_each(|_| host.step());
    for _ in 0..2 {
        assert_eq!(calls_for(&mut host, Command::Teach(TeachCommand::Start)), 0);
        assert_eq!(calls_while_held(&mut host, Key::ZMinus, 300), 0);
        assert_eq!(calls_while_held(&mut host, Key::XMinus, 100), 0);
        assert_eq!(calls_for(&mut host, Command::Press(Key::Coolant)), 0);
        assert_eq!(calls_for(&mut host, Command::Teach(TeachCommand::Undo)), 0);
        assert_eq!(calls_for(&mut host, Command::Teach(TeachCommand::Stop)), 0);
    }
    host.step();
    assert!(host.snapshot().teach.blocks.len() > 2);
}

#[test]
fn t5_the_tick_allocates_nothing_for_messages_and_jumps_in_an_mdi_line() {
    for (kind, line) in
        [(Kind::Vertical, "MSG(\"WHEEL 砂轮\")"), (Kind::Gc, "#3006=1(CHECK 检查)"), (Kind::Gc, "#1=1 ; #2=#1+SIN[30]")]
    {
        let mut host = ready_of(kind);
        host.send(Command::Press(Mode::Mdi.key()));
        (0..10).for_each(|_| host.step());
        assert_eq!(calls_for(&mut host, Command::PrepareMdi(line.to_owned())), 0, "{line} is prepared");
        assert_eq!(calls_for(&mut host, Command::Press(Key::CycleStart)), 0, "{line} starts");
        assert_eq!((0..100).map(|_| calls_in_a_tick(&mut host)).sum::<u64>(), 0, "{line} runs");
    }
}

/// A part that counts for an order, with a date: part, hour and order change in its ticks.
#[test]
fn t5_the_tick_allocates_nothing_for_a_part_of_an_order() {
    let mut host = ready_with("G04 P500\nM31\nM30");
    let program = host.snapshot().program.number;
    host.send(Command::WallClock(DateTime(1_795_273_316)));
    host.send(Command::Order(OrderCommand::Enter(OrderProposal {
        number: 501,
        program,
        target: 2,
        values: OrderValues::default(),
    })));
    host.send(Command::Order(OrderCommand::Start { number: 501, takes_values: true }));
    host.send(Command::Press(Mode::Auto.key()));
    (0..20).for_each(|_| host.step());
    for parts in 1..=3 {
        // The snapshot holds what the core changes next.
        assert_eq!(host.snapshot().production.orders[0].good, parts - 1);
        assert_eq!(calls_of_run(&mut host), 0, "part {parts}");
        assert_eq!((0..12_000).map(|_| calls_in_a_tick(&mut host)).sum::<u64>(), 0, "the fold of the hour");
    }
    assert!(host.snapshot().production.orders[0].is_complete());
}
