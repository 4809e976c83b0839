//! Words that every program of a similar control uses (rows B2, B3, S1).

use std::sync::Arc;

use kt830::defs::kind::Dialect;
use kt830::defs::text::Lang;
use kt830::nc::{
    Block, CheckReport, CommonVariables, EmptyLibrary, ExternalState, Interpreter, LiveValue, NcSettings, NextStatus,
    OfflineMachine, ProgramFault, SharedLibrary, Source, check,
};
use kt830::units::WorkPos;

use crate::running::run_in;

/// The operations of a text, and the common variables behind them.
fn run(text: &str, dialect: Dialect) -> Result<(Vec<String>, CommonVariables), ProgramFault> {
    let settings = NcSettings::for_dialect(dialect);
    let (ops, variables) = run_in(&mut OfflineMachine::new(&settings), text, &settings)?;
    Ok((ops.iter().map(|(_, op)| op.to_string()).collect(), variables))
}

/// What a check says of a text.
fn checked(text: &str, dialect: Dialect) -> CheckReport {
    let source = Arc::new(Source::new(1_001, "O1001.NC", text.as_bytes(), dialect));
    let library: SharedLibrary = Arc::new(EmptyLibrary);
    check(&source, &library, &NcSettings::for_dialect(dialect))
}

fn value_of(expression: &str) -> Option<f64> {
    let (_, variables) = run(&format!("#100={expression}\nM30\n"), Dialect::LatheA).unwrap();
    variables.get(100).unwrap()
}

#[test]
fn b3_functions_of_two_arguments() {
    for (expression, value) in [
        ("ATAN[1,1]", 45.0),
        ("ATAN[-1,-1]", -135.0),
        ("ATAN[1]/[-1]", 135.0),
        ("ATAN[1]", 45.0),
        ("POW[2,10]", 1024.0),
        ("POW[2+1,POW[1,5]+1]", 9.0),
        ("POW[-2,3]", -8.0),
        ("SQRT[POW[3,2]+POW[4,2]]", 5.0),
        ("ADP[2.5]", 2.5),
        // The sine of a bracket in brackets: the comma belongs to the inner one.
        ("ATAN[SIN[ATAN[1,1]]]", 35.264_389_682_754_654),
    ] {
        let found = value_of(expression).unwrap();
        assert!((found - value).abs() < 1e-9, "{expression}: {found}");
    }
    for (text, name) in [
        ("#100=POW[2]", "bad-statement"),
        ("#100=POW[2,3,4]", "bad-statement"),
        ("#100=SQRT[2,3]", "unexpected-character"),
        ("#100=POW[-2,0.5]", "domain"),
    ] {
        assert_eq!(run(&format!("{text}\nM30\n"), Dialect::LatheA).unwrap_err().error.id(), name, "{text}");
    }
}

/// What is never active has its cancelling code: a macro that saves and restores it works.
#[test]
fn b3_modal_variables_of_compensation_and_drilling_cycles() {
    let (_, variables) = run("#100=#4007\n#101=#4010\nG#4007 G#4003\nM30\n", Dialect::LatheA).unwrap();
    assert_eq!([100, 101].map(|number| variables.get(number).unwrap()), [Some(40.0), Some(80.0)]);
    let (_, variables) = run("#100=#4007\n#101=#4009\nG#4009\nM30\n", Dialect::Mill).unwrap();
    assert_eq!([100, 101].map(|number| variables.get(number).unwrap()), [Some(40.0), Some(80.0)]);
}

/// M is an argument of G65 with any value; elsewhere it is a code, and a whole number.
#[test]
fn b3_the_argument_m_of_g65_may_have_decimals() {
    let settings = NcSettings::lathe_a();
    let fault = run("G00 X5 M0.5\nM30\n", Dialect::LatheA).unwrap_err();
    assert_eq!((fault.error.id(), fault.location.line), ("unknown-m", 1));
    struct One(Arc<Source>);
    impl kt830::nc::Library for One {
        fn find(&self, _number: u32) -> Option<Arc<Source>> {
            Some(Arc::clone(&self.0))
        }
    }
    let called = Arc::new(Source::new(8810, "O8810.NC", "#100=#13\nM99\n", Dialect::LatheA));
    let source = Arc::new(Source::new(1001, "O1001.NC", "G65 P8810 A1 M0.02\nM30\n", Dialect::LatheA));
    let (mut world, mut block) = (OfflineMachine::new(&settings), Block::new(&settings));
    let mut interpreter = Interpreter::new(source, Arc::new(One(called)), settings, CommonVariables::default());
    while interpreter.next(&mut world, &mut block).unwrap() != NextStatus::End {}
    assert_eq!(interpreter.common_variables().get(100).unwrap(), Some(0.02));
}

/// A machine that moves: values of it are known only when it stands.
struct Moving(OfflineMachine, bool);

impl ExternalState for Moving {
    fn position(&self) -> WorkPos {
        self.0.position()
    }

    fn system_variable(&mut self, number: u32) -> LiveValue {
        if self.1 { LiveValue::Drain } else { self.0.system_variable(number) }
    }

    fn block_skip(&self) -> bool {
        false
    }
}

/// G53 alone stops reading ahead until the machine stands; it does nothing else.
#[test]
fn b2_g53_alone_waits_for_the_machine() {
    let settings = NcSettings::lathe_a();
    let mut block = Block::new(&settings);
    let mut world = Moving(OfflineMachine::new(&settings), true);
    let source = Arc::new(Source::new(1001, "O1001.NC", "G53\nG00 X5\nM30\n", Dialect::LatheA));
    let mut interpreter = Interpreter::new(source, Arc::new(EmptyLibrary), settings, CommonVariables::default());
    for _ in 0..3 {
        assert_eq!(interpreter.next(&mut world, &mut block), Ok(NextStatus::Drain));
    }
    world.1 = false;
    assert_eq!(interpreter.next(&mut world, &mut block), Ok(NextStatus::Block));
    assert_eq!(block.location.line, 2);
    // With other words it still needs an axis.
    assert_eq!(run("G53 F5\nM30\n", Dialect::LatheA).unwrap_err().error.id(), "missing-word");
}

/// A grinding cycle of another control is named as such: G71 here is a turning cycle.
#[test]
fn b2_a_cycle_of_another_control_is_named() {
    let fault = run("G71 A-0.02 B-0.01 W-60. U1.5 I0.4 K800. H10\nM30\n", Dialect::LatheA).unwrap_err();
    assert_eq!((fault.error.id(), fault.column), ("foreign-cycle", 5));
}

/// 802D: G70 takes lengths in inches, G700 feeds too; G71 and G710 are millimetres. X is a diameter.
#[test]
fn s1_g70_and_g700_are_inches() {
    let of = |text: &str| run(text, Dialect::Sinumerik).unwrap().0;
    let metric = of("G71 G90 G1 X50.8 Z25.4 F254\nM2\n");
    assert_eq!(of("G710 G90 G1 X50.8 Z25.4 F254\nM2\n"), metric);
    assert_eq!(of("G70 G90 G1 X2 Z1 F254\nM2\n"), metric);
    assert_eq!(of("G700 G90 G1 X2 Z1 F10\nM2\n"), metric);
    // Back to millimetres.
    assert_eq!(of("G700\nG71 G90 G1 X50.8 Z25.4 F254\nM2\n"), metric);
    assert_eq!(run("G70 G71\nM2\n", Dialect::Sinumerik).unwrap_err().error.id(), "double-group");
}

#[test]
fn b3_a_printed_line_formats_its_values() {
    let printed = |text: &str| {
        let (ops, _) = run(&format!("#100=25.0125\n#101=-0.0004\n{text}\nM30\n"), Dialect::LatheA).unwrap();
        ops[2].clone()
    };
    for (text, line) in [
        ("DPRNT[X#100[53]]", "X    25.013"),
        // Half away from zero; what rounds to zero has no sign.
        ("DPRNT[#100[33]]", "  25.013"),
        ("DPRNT[#101[13]]", " 0.000"),
        ("DPRNT[#101[14]]", "-0.0004"),
        ("DPRNT[N#[99+1][20]*PARTS]", "N 25 PARTS"),
        // A place before the point is missing: nothing is cut off.
        ("DPRNT[#100[11]]", " 25.0"),
        // Null.
        ("N10 DPRNT[#150[11]] (COMMENT)", " 0.0"),
        ("IF[#100 GT 1]THEN DPRNT[LARGE]", "LARGE"),
        ("DPRNT[]", ""),
    ] {
        assert_eq!(printed(text), format!("print text={line:?}"), "{text}");
    }
    for (text, name) in [
        ("DPRNT", "bad-statement"),
        ("DPRNT[ABC", "unbalanced-bracket"),
        ("DPRNT[#100]", "print-format"),
        ("DPRNT[#100[5]]", "print-format"),
        ("DPRNT[#100[55]]", "out-of-range"),
        ("DPRNT[#0100[00]]", "out-of-range"),
        ("DPRNT[\u{5c3a}]", "foreign-character"),
        ("BPRNT[X#100[3]]", "no-binary-print"),
        (&format!("DPRNT[{}]", "A".repeat(81)), "print-too-long"),
    ] {
        assert_eq!(run(&format!("{text}\nM30\n"), Dialect::LatheA).unwrap_err().error.id(), name, "{text}");
    }
}

#[test]
fn b2_an_arc_with_the_third_axis_is_a_helix_on_a_mill() {
    // A quarter of radius 5 in XY while Z goes down by 5.
    let text = "G17 G98 F100\nG00 X0 Y0 Z0\nG02 X5. Y5. Z-5. I5. J0\nG03 X5. Y5. Z0 I0 J-5.\nM30\n";
    let (ops, _) = run(text, Dialect::Mill).unwrap();
    assert!(ops.iter().any(|op| op.contains("arc x=5 y=5 z=-5 cx=5 cy=0 turn=-1")), "{ops:?}");
    // The second one is a full turn up.
    assert!(ops.iter().any(|op| op.contains("arc x=5 y=5 z=0 cx=5 cy=0 turn=1")), "{ops:?}");
    let refused = |text: &str, dialect| run(text, dialect).unwrap_err().error.id();
    assert_eq!(refused("G98 F100\nG02 X5 Z5 Y1 R5\nM30\n", Dialect::LatheA), "no-axis");
    let beside = "G17 G98 F100\n#2901=1\nG41 D1 G01 X0 Y-10\nX10\nG03 X20 Y0 Z-5 I0 J10\nG40 G01 X30\nM30\n";
    assert_eq!(refused(beside, Dialect::Mill), "not-in-compensation");
}

/// What 200 programs from public sources have that was refused, or read in another way than written.
#[test]
fn b2_words_of_programs_that_others_wrote() {
    let ok = |text: &str, dialect| {
        run(&format!("{text}\nM30\n"), dialect).unwrap_or_else(|fault| panic!("{text}: {fault}")).0
    };
    let refused = |text: &str| run(&format!("{text}\nM30\n"), Dialect::LatheA).unwrap_err().error.id();
    // The safety line has no effect.
    assert_eq!(ok("G21 G40 G49 G69 G80", Dialect::LatheA), ok("G21 G40", Dialect::LatheA));
    // 660 ft/min = 660 · 0.3048 m/min.
    let speed = ok("G20 G96 S660", Dialect::LatheA);
    assert!(speed.iter().any(|op| op.contains("value=201.168")), "{speed:?}");
    assert!(ok("G21 G96 S660", Dialect::LatheA).iter().any(|op| op.contains("value=660")));
    // 0.0002 in/rev.
    assert!(ok("G20 G99 F0.0002\nG01 X1.", Dialect::LatheA).iter().any(|op| op.contains("f=0.00508")));
    // An origin taken from a position: both in inches. 0.5 in are 12.7 mm, also when G10 writes them.
    let origins = ok("G20\n#5221=0.5\nG10 L2 P2 Z0.5\n#5242=#5242*2\n#500=#5221", Dialect::LatheA);
    for wanted in
        ["variable=5221 value=12.7", "variable=5242 value=12.7", "variable=5242 value=25.4", "variable=500 value=0.5"]
    {
        assert!(origins.iter().any(|op| op.ends_with(wanted)), "{wanted}: {origins:?}");
    }
    // G10 adds in inches, too: −25.4 mm + 0.1 in = −22.86 mm; nothing added leaves the origin as it is.
    // 10/25.4 = 0.393701.
    let added = ok("G10 L2 P1 X10. Z-25.4\nG20\nG10 L2 P1 U0. W0.1\n#500=#5222\n#501=#5221", Dialect::LatheA);
    for (variable, wanted) in [(5222, "-22.86"), (5221, "10"), (500, "-0.9"), (501, "0.393701")] {
        let last = added.iter().rev().find(|op| op.contains(&format!("variable={variable} value=")));
        assert!(last.is_some_and(|op| op.ends_with(&format!("value={wanted}"))), "{variable}: {added:?}");
    }
    // FANUC, increment system IS-B: 0.0001 mm/r. A feed per minute has three decimals.
    assert!(ok("G21 G99 F0.0002\nG01 X1.", Dialect::LatheA).iter().any(|op| op.contains("f=0.0002")));
    assert_eq!(refused("G21 G99 F0.00002\nG01 X1."), "out-of-range");
    assert_eq!(refused("G21 G98 F0.0002\nG01 X1."), "out-of-range");
    assert!((value_of("#3101").unwrap() - std::f64::consts::PI).abs() < 1e-15 && value_of("#3100").is_none());
    assert_eq!(value_of("0\nWH[#100 LT 3]DO1\n#100=#100+1\nEND1"), Some(3.0));
    for (text, name) in [
        ("G75 X0. I0.5 F0.1", "foreign-cycle"),
        ("G95 G01 X10. F0.1", "feed-per-rev-by-g99"),
        ("G92 S1300", "preset-by-g50"),
        ("G92 X10. Z5.", "preset-by-g50"),
        ("T01", "tool-without-offset"),
        ("T17", "out-of-range"),
        ("G71 U2000 R500", "point-missing"),
        ("G20\nG71 U930 R500", "point-missing"),
        ("G73 U4. W2. R3\nG73 P10 Q20 U200 W0 F100", "point-missing"),
    ] {
        assert_eq!(refused(text), name, "{text}");
    }
}

/// What 550 more of them have: a code that is repeated, the name behind the first `%`, the end mark of DOS, G74 of one hole.
#[test]
fn b2_words_of_more_programs_that_others_wrote() {
    let ops = |text: &str| run(text, Dialect::LatheA).unwrap_or_else(|fault| panic!("{text}: {fault}")).0;
    for (written, same) in [
        ("G98 F100\nG1 G40 G1 X5.\nM30\n", "G98 F100\nG40 G1 X5.\nM30\n"),
        ("G28 U0. G28 W0.\nM30\n", "G28 U0. W0.\nM30\n"),
        ("G90 G90 G0 X5.\nM30\n", "G0 X5.\nM30\n"),
        ("%00042\nG0 X5.\nM30\n%\n", "G0 X5.\nM30\n"),
        ("%PART-7 (O1)\nG0 X5.\nM30\n%\n", "G0 X5.\nM30\n"),
        ("G0 X5.\nM30\u{1a}", "G0 X5.\nM30\n"),
        ("G0 X5.\nM30\n\u{1a}", "G0 X5.\nM30\n"),
        ("G99 F0.2\nG0 Z0\nG74 R1.\nG74 Z-7. P0 Q2000\nM30\n", "G99 F0.2\nG0 Z0\nG74 R1.\nG74 Z-7. Q2000\nM30\n"),
    ] {
        assert_eq!(ops(written), ops(same), "{written}");
    }
    // Another code of the group, and a step that is needed, are still mistakes.
    let refused = |text: &str| run(text, Dialect::LatheA).unwrap_err().error.id();
    assert_eq!(refused("G1 G98 G0 X5. F100\nM30\n"), "double-group");
    assert_eq!(refused("G99 F0.2\nG0 X40. Z0\nG74 R1.\nG74 X20. Z-7. P0 Q2000\nM30\n"), "out-of-range");
    assert_eq!(refused("M98 P#500\nM30\n"), "empty-word");
    assert_eq!(refused("G43 H1\nM30\n"), "length-by-t");
}

/// The motion code and the feed of a refused block are those of the next ones: one mistake is one message.
#[test]
fn t4_a_refused_block_leaves_its_motion_code_and_feed_to_the_next_ones() {
    let text = "G98 F100\nG00 X20. Z10.\nG01 X15. C-90. F50\nX10. Z5. ,R1.\nX8.\nM30\n";
    let faults = checked(text, Dialect::LatheA).faults;
    let found: Vec<_> = faults.iter().map(|fault| (fault.location.line, fault.error.id())).collect();
    assert_eq!(found, [(3, "no-axis")]);
}

/// A program for another machine counts on XY at power-on, where this one has ZX: an arc in Y would become a helix.
#[test]
fn b2_an_arc_with_y_needs_a_plane_that_the_program_names() {
    let found = |text: &str| run(&format!("G98 F100\n{text}\nM30\n"), Dialect::Mill).map_err(|fault| fault.error.id());
    for text in ["G2 X10. Y10. R10.", "G2 X20. I10. J0", "G2 X10. Y10. I10. J0"] {
        assert_eq!(found(text).unwrap_err(), "plane-unnamed", "{text}");
        assert!(found(&format!("G17\n{text}")).is_ok(), "{text}");
    }
    assert!(found("G2 X10. Z10. R10.").is_ok() && found("G18\nG2 X10. Z10. Y5. R10.").is_ok());
}

/// F0.2 without a unit would be 0.2 mm/min: a check asks which is meant, once.
#[test]
fn t4_a_slow_feed_whose_unit_is_not_named_is_a_warning() {
    let warned = |text: &str, dialect| {
        let told = |fault: &ProgramFault| (fault.location.line, fault.cause(Lang::En), fault.remedy(Lang::En));
        checked(text, dialect).warnings.iter().map(told).collect::<Vec<_>>()
    };
    let cause = "the unit of F0.2 is not named: it is taken as mm/min".to_owned();
    let text = "G01 X5. F0.2\nX6. F0.3\nM30\n";
    assert_eq!(warned(text, Dialect::LatheA), [(1, cause.clone(), "write G98 (mm/min) / G99 (mm/r)".to_owned())]);
    assert_eq!(warned(text, Dialect::Sinumerik), [(1, cause, "write G94 (mm/min) / G95 (mm/r)".to_owned())]);
    for text in ["G98 G01 X5. F0.2\nM30\n", "G99 F0.2\nM30\n", "G01 X5. F2.\nM30\n"] {
        assert_eq!(warned(text, Dialect::LatheA), [], "{text}");
    }
}
