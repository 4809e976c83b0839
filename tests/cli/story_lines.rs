//! How the lines of a story are read.

use kt830::defs::key::{Key, Mode};
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::param::ParamAddress;
use kt830::defs::signal::Output;
use kt830::defs::text::LocalizedText;
use kt830::io::sim::EventKind;
use kt830::link::demo_view::DemoView;
use kt830::link::media::{Direction, TransferSet};
use kt830::link::snapshot::RunState;
use kt830::story::parse::{DEFAULT_TOLERANCE_MM, parse};
use kt830::story::statement::{Expectation, InputForce, Quantity, Statement, WaitCondition};
use kt830::units::Axis;

fn one(line: &str) -> Statement {
    parse(line, Kind::Gc).unwrap().1.remove(0).statement
}

fn fault(line: &str) -> (u32, u32) {
    let error = parse(line, Kind::Gc).unwrap_err();
    (error.line, error.column)
}

#[test]
fn t5_every_statement_of_the_specification_is_read() {
    assert_eq!(one("kind gc"), Statement::Kind(Kind::Gc));
    assert_eq!(one("power cut"), Statement::PowerCut);
    assert_eq!(one("param P16.0 1"), Statement::Param(ParamAddress { number: 16, bit: Some(0) }, 1.0));
    assert_eq!(one("set #500 = 40.2"), Statement::Set(500, Some(40.2)));
    assert_eq!(one("set #500=40.2"), Statement::Set(500, Some(40.2)));
    assert_eq!(one("load O1001"), Statement::Load(1001));
    assert_eq!(one("mode jog"), Statement::Mode(Mode::Manual));
    assert_eq!(one("key 循环启动   #! 启动"), Statement::Key(Key::CycleStart));
    assert_eq!(one("hold X- 1.5 s"), Statement::Hold(Key::XMinus, 1.5));
    assert_eq!(one("handwheel X -25 x0.01"), Statement::Handwheel(Axis::X, -25, Key::Step001));
    assert_eq!(one("mdi G00 X50 Z10"), Statement::Mdi("G00 X50 Z10".into()));
    assert_eq!(one("type #505 0.03"), Statement::Type(505, Some(0.03)));
    assert_eq!(one("input 12 off"), Statement::Input("12".into(), InputForce::To(false)));
    assert_eq!(
        one("input hydraulic-pressure free"),
        Statement::Input("hydraulic-pressure".into(), InputForce::Released)
    );
    assert_eq!(one("fault stuck-on home-x"), Statement::Fault("stuck-on home-x".into()));
    assert_eq!(one("fault list"), Statement::FaultList);
    assert_eq!(one("fault stuck-on home-x off"), Statement::FaultOff("stuck-on home-x".into()));
    assert_eq!(one("fault bus-silent off"), Statement::FaultOff("bus-silent".into()));
    assert_eq!(one("write O2001 \"M30\""), Statement::WriteProgram(2001, "M30".into()));
    assert_eq!(one("export backup"), Statement::Transfer(Direction::Export, TransferSet::Backup));
    assert_eq!(one("import variables"), Statement::Transfer(Direction::Import, TransferSet::Variables));
    assert_eq!(one("stall"), Statement::Stall);
    let told = LocalizedText::new("砂轮启动", "the wheel starts");
    assert_eq!(one("caption \"砂轮启动\" \"the wheel starts\""), Statement::ShowDemo(DemoView::Caption(told)));
    assert_eq!(one("caption off"), Statement::ShowDemo(DemoView::Silent));
    assert_eq!(one("wait 200 ms"), Statement::Wait(0.2));
    assert_eq!(one("wait until X<10.5 max 5 s"), Statement::WaitUntil(WaitCondition::Axis(Axis::X, true, 10.5), 5.0));
    assert_eq!(one("wait until idle"), Statement::WaitUntil(WaitCondition::State(RunState::Idle), 60.0));
}

#[test]
fn t5_every_expectation_of_the_specification_is_read() {
    let expected = |line: &str| match one(&format!("expect {line}")) {
        Statement::Expect(expectation) => expectation,
        statement => panic!("{statement:?}"),
    };
    assert_eq!(expected("output wheel on"), Expectation::Output(Output::Wheel, true));
    assert_eq!(expected("lamp 液压 off"), Expectation::Lamp(Key::Hydraulic, false));
    assert_eq!(expected("alarm 180"), Expectation::Alarm(180));
    assert_eq!(expected("alarm \"液压\""), Expectation::AlarmText("液压".into()));
    assert_eq!(expected("no alarm"), Expectation::NoAlarm);
    assert_eq!(expected("event crash"), Expectation::Event(EventKind::Crash));
    let value = |of, is, tolerance| Expectation::Value { of, is, tolerance };
    assert_eq!(expected("X 50.000 ±0.001"), value(Quantity::Work(Axis::X), 50.0, 0.001));
    assert_eq!(expected("machine Z -3"), value(Quantity::Machine(Axis::Z), -3.0, DEFAULT_TOLERANCE_MM));
    assert_eq!(expected("#437 0.1 +-0.01"), value(Quantity::Variable(437), 0.1, 0.01));
    assert_eq!(expected("wear 4 X 0.1 ±0"), value(Quantity::Wear(4, Axis::X), 0.1, 0.0));
    assert_eq!(expected("part diameter at Z-20 40 ±0.002"), value(Quantity::PartDiameter(-20.0), 40.0, 0.002));
    assert_eq!(expected("part height at X10 Z5 3 ±0.1"), value(Quantity::PartHeight(10.0, 5.0), 3.0, 0.1));
    assert_eq!(expected("message \"振荡\""), Expectation::Message("振荡".into()));
    assert_eq!(expected("page grinding shows \"外卡磨削\""), Expectation::Page(Page::Grinding, "外卡磨削".into()));
}

#[test]
fn t5_what_is_not_of_the_language_is_refused_with_its_place() {
    assert_eq!(fault("power on\n  jump X"), (2, 3));
    assert_eq!(fault("key 台面旋转"), (1, 5)); // not on GC
    assert_eq!(fault("wait 2 parsecs"), (1, 8));
    assert_eq!(fault("wait 2 s s"), (1, 10));
    assert_eq!(fault("expect message \"振荡"), (1, 16));
    assert_eq!(fault("input 65 on"), (1, 7));
    assert_eq!(fault("hold X 1 s"), (1, 6));
    assert_eq!(fault("load"), (1, 5));
    assert_eq!(fault("fault earthquake"), (1, 7));
    assert_eq!(fault("fault earthquake off"), (1, 7));
    assert_eq!(fault("fault off"), (1, 7));
    assert_eq!(fault("fault stuck-on nothing"), (1, 7));
    assert_eq!(fault("expect event bang"), (1, 14));
    assert_eq!(fault("caption words"), (1, 9));
    assert_eq!(fault("caption \"砂轮启动\""), (1, 15));
    assert_eq!(fault("power on\nkind gc"), (2, 1));
}
