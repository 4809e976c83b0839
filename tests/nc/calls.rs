//! Calls: G65, G66 one inside the other, and what a program knows of its name (rows B3, B8).

use std::collections::BTreeMap;
use std::sync::Arc;

use kt830::defs::kind::Dialect;
use kt830::defs::program_number;
use kt830::nc::{
    Block, CommonVariables, Interpreter, Library, NcSettings, NextStatus, OfflineMachine, ProgramFault, Source, check,
};

#[derive(Debug, Default)]
struct Shelf(BTreeMap<u32, Arc<Source>>);

impl Library for Shelf {
    fn find(&self, number: u32) -> Option<Arc<Source>> {
        self.0.get(&number).cloned()
    }
}

fn source(number: u32, text: &str) -> Arc<Source> {
    Arc::new(Source::new(number, format!("O{number:04}.NC"), text, Dialect::LatheA))
}

/// Runs a program with its macros; returns the common variables.
fn run(text: &str, macros: &[(u32, &str)]) -> Result<CommonVariables, ProgramFault> {
    run_with(&NcSettings::lathe_a(), text, macros)
}

fn run_with(settings: &NcSettings, text: &str, macros: &[(u32, &str)]) -> Result<CommonVariables, ProgramFault> {
    let settings = settings.clone();
    let (mut world, mut block) = (OfflineMachine::new(&settings), Block::new(&settings));
    let shelf = Shelf(macros.iter().map(|(number, text)| (*number, source(*number, text))).collect());
    let mut interpreter = Interpreter::new(source(1001, text), Arc::new(shelf), settings, CommonVariables::default());
    loop {
        match interpreter.next(&mut world, &mut block)? {
            NextStatus::Block => block.ops.iter().for_each(|op| world.apply(op)),
            NextStatus::Drain | NextStatus::Busy | NextStatus::Waiting => {}
            NextStatus::End => return Ok(interpreter.common_variables().clone()),
        }
    }
}

fn value(variables: &CommonVariables, number: u32) -> Option<f64> {
    variables.get(number).unwrap()
}

/// After each move the macro of the last G66 runs; a move of that macro calls the one before; G67 ends the last one.
#[test]
fn b3_g66_calls_nest() {
    // O8008 once, its move W1 calls O8007; G67; Z-115: O8007.
    let macros = [(8007, "#100=#100+#1\nM99\n"), (8008, "#101=#101+1\nG00 W1\nM99\n")];
    let text = "G98\nG66 P8007 A1\nG66 P8008\nG00 X-90\nG67\nG00 Z-115\nG67\nG00 Z-120\nM30\n";
    let variables = run(text, &macros).unwrap();
    assert_eq!((value(&variables, 100), value(&variables, 101)), (Some(2.0), Some(1.0)));
}

/// P6.1: arguments that are lengths count thousandths (in inches tenths of them) without a decimal point; numbers, feeds
/// and computed values are as they are.
#[test]
fn b3_least_increments_hold_in_the_arguments_of_a_macro() {
    let least = NcSettings { least_increment_mm: Some(0.001), ..NcSettings::lathe_a() };
    let macros = [(9100, "#101=#1\n#102=#7\n#103=#11\n#104=#6\n#105=#24\n#106=#9\n#107=#26\n#108=#19\nM99\n")];
    let found = |text: &str| {
        let variables = run_with(&least, text, &macros).unwrap();
        [101, 102, 103, 104, 105, 106, 107, 108].map(|number| value(&variables, number))
    };
    let call = "#1=7\nG65 P9100 A100 D7 H3 K2.5 X-5000 F60 Z#1 S800\nM30\n";
    assert_eq!(found(call), [0.1, 7.0, 3.0, 2.5, -5.0, 60.0, 7.0, 800.0].map(Some));
    assert_eq!(found(&format!("G20\n{call}")), [0.01, 7.0, 3.0, 2.5, -0.5, 60.0, 7.0, 800.0].map(Some));
    assert_eq!(found(&call.replace("#1=7\nG65", "#1=7\nG98\nG66").replace("M30", "G00 W1.\nG67\nM30"))[4], Some(-5.0));
    // The shipped programs that are no cycles take numbers as they are: `G65 P9020 K1`.
    let shipped = [(9020, macros[0].1), (9012, macros[0].1)];
    for program in [9020, 9012] {
        let call = format!("G65 P{program} K1 A30 D2 X5 Z2 F60 H1 S1\nM30\n");
        let variables = run_with(&least, &call, &shipped).unwrap();
        assert_eq!([101, 104, 105].map(|number| value(&variables, number)), [30.0, 1.0, 5.0].map(Some), "O{program}");
    }
    let plain = run(call, &macros).unwrap();
    assert_eq!([101, 105].map(|number| value(&plain, number)), [Some(100.0), Some(-5000.0)]);
}

/// Three deep, each with two moves: the innermost runs once, the middle twice, the outermost four times.
#[test]
fn b3_each_move_of_a_g66_macro_calls_the_one_before() {
    let macros = [
        (8001, "#101=#101+1\nM99\n"),
        (8002, "#102=#102+1\nG00 U1\nG00 U1\nM99\n"),
        (8003, "#103=#103+1\nG00 W1\nG00 W1\nM99\n"),
    ];
    let variables = run("G66 P8001\nG66 P8002\nG66 P8003\nG00 X5\nG67\nG67\nG67\nG00 X9\nM30\n", &macros).unwrap();
    assert_eq!([101, 102, 103].map(|number| value(&variables, number)), [Some(4.0), Some(2.0), Some(1.0)]);
}

/// G66 within a macro acts there only.
#[test]
fn b3_what_a_macro_begins_with_g66_ends_with_it() {
    let macros = [(8001, "#101=#101+1\nM99\n"), (8002, "G66 P8001\nG00 W1\nM99\n")];
    let variables = run("G66 P8002\nG00 X5\nG00 X6\nG67\nG00 X9\nM30\n", &macros).unwrap();
    assert_eq!(value(&variables, 101), Some(2.0));
}

/// The macro of a G65 is one, too, in each of its repetitions; the G66 of its caller acts on, or stays ended if it ends it.
#[test]
fn b3_what_a_macro_of_g65_begins_with_g66_ends_with_it() {
    let macros = [(8001, "#101=#101+1\nM99\n"), (8002, "G66 P8001\nG00 W1\nM99\n"), (8003, "G67\nM99\n")];
    let count = |text: &str| value(&run(text, &macros).unwrap(), 101);
    assert_eq!(count("G65 P8002\nG00 X5\nM30\n"), Some(1.0));
    assert_eq!(count("G65 P8002 L6\nG65 P8002\nG00 X5\nM30\n"), Some(7.0));
    // Within it the macro's own one and then that of the caller: W1 and X5.
    let outer = "G66 P8004\nG65 P8002\nG00 X5\nG67\nG00 X6\nM30\n";
    let both = [(8001, "#101=#101+1\nM99\n"), (8002, "G66 P8001\nG00 W1\nM99\n"), (8004, "#104=#104+1\nM99\n")];
    let variables = run(outer, &both).unwrap();
    assert_eq!([101, 104].map(|number| value(&variables, number)), [Some(1.0), Some(1.0)]);
    assert_eq!(count("G66 P8001\nG00 X5\nG65 P8003\nG00 X6\nM30\n"), Some(1.0));
}

#[test]
fn b3_g66_is_refused_deeper_than_macros_nest() {
    let macros = [(8001, "M99\n")];
    let fault = run("G66 P8001\nG66 P8001\nG66 P8001\nG66 P8001\nG66 P8001\nG00 X1\nM30\n", &macros).unwrap_err();
    assert_eq!((fault.location.line, fault.error.id()), (5, "too-deep"));
    // G67 without G66 ends nothing.
    assert!(run("G67\nG00 X1\nM30\n", &macros).is_ok());
}

/// #4115 of a program without a number is 0.
#[test]
fn b3_the_program_number_of_a_named_program_is_0() {
    let text = "#100=#4115\nM30\n";
    let settings = NcSettings::lathe_a();
    for (number, expected) in [(1001, 1001.0), (program_number::from_name("part-7"), 0.0)] {
        let (mut world, mut block) = (OfflineMachine::new(&settings), Block::new(&settings));
        let source = Arc::new(Source::new(number, "part-7.nc", text, Dialect::LatheA));
        let shelf = Arc::new(Shelf::default());
        let mut interpreter = Interpreter::new(source, shelf, settings.clone(), CommonVariables::default());
        while interpreter.next(&mut world, &mut block).unwrap() != NextStatus::End {}
        assert_eq!(value(interpreter.common_variables(), 100), Some(expected));
    }
}

/// DO without WHILE repeats until a GOTO leaves it.
#[test]
fn b3_do_without_while_repeats_until_a_jump_leaves_it() {
    let variables = run("#100=0\nDO1\n#100=#100+1\nIF[#100EQ7]GOTO 9\nEND1\nN9 M30\n", &[]).unwrap();
    assert_eq!(value(&variables, 100), Some(7.0));
}

/// The message names the thing that is wrong.
#[test]
fn b8_messages_speak_of_the_right_thing() {
    for (text, line, words) in [
        (
            "N5 G00 X9\nG71 P10 Q20 U1 W1 F5\nN10 G00 X5\nN20 G01 Z-5 F5\nM30\n",
            2,
            "G71 P Q has no block G71 U R before it",
        ),
        (
            "N5 G00 X9\nG73 P10 Q20 U1 W1 F5\nN10 G00 X5\nN20 G01 Z-5 F5\nM30\n",
            2,
            "G73 P Q has no block G73 U W R before it",
        ),
        ("G00 X9\no100 while [#1 GT 2]\nM30\n", 2, "there is no statement O100 WHILE"),
        ("G00 X9\n#<depth>=5\nM30\n", 2, "there is no variable #<…>"),
    ] {
        let report = check(&source(1001, text), &(Arc::new(Shelf::default()) as _), &NcSettings::lathe_a());
        let first = report.faults.first().map(ToString::to_string).unwrap_or_default();
        assert!(first.starts_with(&format!("O1001 line {line}, ")) && first.contains(words), "{text}: {first}");
    }
}

/// On a surface grinder G92 sets the work coordinates, as G50 does.
#[test]
fn b2_g92_sets_the_coordinates_on_gs() {
    let settings = NcSettings::for_dialect(Dialect::Mill);
    let ops = |text: &str| {
        let (mut world, mut block) = (OfflineMachine::new(&settings), Block::new(&settings));
        let source = Arc::new(Source::new(1001, "O1001.NC", text, Dialect::Mill));
        let shelf = Arc::new(Shelf::default());
        let mut interpreter = Interpreter::new(source, shelf, settings.clone(), CommonVariables::default());
        let mut ops = Vec::new();
        while interpreter.next(&mut world, &mut block).unwrap() != NextStatus::End {
            ops.append(&mut block.ops);
        }
        ops
    };
    assert_eq!(ops("G92 X1 Y2 Z3\nM30\n"), ops("G50 X1 Y2 Z3\nM30\n"));
    assert_eq!(ops("G92 X1 Y2 Z3\nM30\n").len(), 2);
}

/// Codes that the machine builder gives to macros (FANUC 6050 …, 6080 …).
#[test]
fn b3_a_code_of_the_table_calls_its_macro_with_the_words_as_arguments() {
    let mut settings = NcSettings::lathe_a();
    settings.g_macros[0] = (175, 9030);
    settings.g_macros[1] = (75, 9031);
    settings.m_macros[3] = (61, 9043);
    let grinding = "#500=#500+1\n#501=#24\n#502=#9\nM99\n";
    // In a program that a code has called, a code of the table is the control's own: G75 without its first block is refused.
    let own = "#503=#503+1\nM99\n";
    let by_m = "#504=#19\nG175 X9\nM99\n";
    let macros = [(9030, grinding), (9031, own), (9043, by_m)];
    let done = run_with(&settings, "G175 X12.5 F3 L2\nG75 X1\nM30\n", &macros).unwrap();
    assert_eq!(value(&done, 500), Some(2.0), "L2 repeats it");
    assert_eq!((value(&done, 501), value(&done, 502)), (Some(12.5), Some(3.0)), "X is #24, F is #9");
    assert_eq!(value(&done, 503), Some(1.0), "G75 is replaced");
    let refused = run_with(&settings, "M61 S5\nM30\n", &macros).unwrap_err();
    assert_eq!((refused.location.program, refused.location.line, refused.error.id()), (9043, 2, "unknown-g"));
    let both = run_with(&settings, "G175 G01 X1\nM30\n", &macros).unwrap_err();
    assert_eq!(both.error.id(), "not-together");
    let missing = run_with(&settings, "G175 X1\nM30\n", &[]).unwrap_err();
    assert_eq!(missing.error.id(), "missing-program");
    assert_eq!(run("G175 X1\nM30\n", &macros).unwrap_err().error.id(), "unknown-g", "not in the table");
    // L of the shipped grinding cycles names something else on FANUC: nothing is ground twice.
    settings.g_macros[3] = (77, 9075);
    let cycle = [(9075, "#505=1\nM99\n")];
    assert_eq!(run_with(&settings, "G77 X9 L5\nM30\n", &cycle).unwrap_err().error.id(), "cycle-repeated");
    assert_eq!(value(&run_with(&settings, "G77 X9\nM30\n", &cycle).unwrap(), 505), Some(1.0));
    // The codes that change the flow of a program stay the control's own.
    settings.m_macros[4] = (30, 9030);
    settings.g_macros[2] = (65, 9030);
    let done = run_with(&settings, "G65 P9031\nM30\n", &macros).unwrap();
    assert_eq!((value(&done, 500), value(&done, 503)), (None, Some(1.0)));
}
