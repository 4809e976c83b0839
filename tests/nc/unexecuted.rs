//! A check reads every block of a program and of the programs that it calls, whether its run reaches it or not
//! (rows B1, B3, T4).

use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::Arc;

use kt830::defs::kind::Dialect;
use kt830::defs::program_kind;
use kt830::defs::text::Lang;
use kt830::nc::{CheckReport, EmptyLibrary, Library, NcSettings, SharedLibrary, Source, check};
use proptest::prelude::*;

/// Programs by number.
#[derive(Debug, Default)]
struct Shelf(BTreeMap<u32, Arc<Source>>);

impl Library for Shelf {
    fn find(&self, number: u32) -> Option<Arc<Source>> {
        self.0.get(&number).cloned()
    }
}

/// The check of O1001 on GC, with the other programs at hand.
pub fn check_with(text: &str, others: &[(u32, String)]) -> CheckReport {
    let source =
        |number: u32, text: &str| Arc::new(Source::new(number, format!("O{number:04}.NC"), text, Dialect::LatheA));
    let shelf = others.iter().map(|(number, text)| (*number, source(*number, text))).collect();
    check(&source(1001, text), &(Arc::new(Shelf(shelf)) as _), &NcSettings::lathe_a())
}

/// The mistakes: program, line, stable name.
pub fn faults(report: &CheckReport) -> Vec<(u32, u32, &'static str)> {
    report.faults.iter().map(|fault| (fault.location.program, fault.location.line, fault.error.id())).collect()
}

/// A block with a mistake, and the name of the mistake.
const MISTAKES: &[(&str, &str)] = &[
    ("G00 X1 X2", "double-word"),
    ("G00 X", "missing-number"),
    ("G00 X1.2.3", "bad-number"),
    ("G00 X1 ?", "unexpected-character"),
    ("G00 X[1+2", "unbalanced-bracket"),
    ("G37", "unknown-g"),
    ("G33 Z5 F1", "g-without-encoder"),
    ("M123", "unknown-m"),
    ("G00 G01 X5", "double-group"),
    ("G00 X5 U5", "absolute-and-incremental"),
    ("G01 X5 F0", "out-of-range"),
    ("T9999", "out-of-range"),
    ("G04 P-5", "out-of-range"),
    ("#1=1/0", "division-by-zero"),
    ("#1=SQRT[-4]", "domain"),
    ("#1=#99", "bad-variable"),
    ("#4001=5", "read-only"),
    ("GOTO 77", "missing-target"),
    ("M98 P7777", "missing-program"),
    ("G65 P7777 A1", "missing-program"),
    ("G66 P7777 A1", "missing-program"),
    ("M98", "missing-word"),
    ("G04", "missing-word"),
    ("G01 X5 Q3 F10", "unknown-word"),
    ("WHILE[#1LT5]DO5", "do-number"),
    ("END2", "loop-mismatch"),
    ("#1==5", "assignment-sign"),
    ("G70 P71 Q72", "missing-target"),
    ("G66 A1", "missing-word"),
    ("T9999 X#500", "out-of-range"),
    ("G01 X5 F0 Z#500", "out-of-range"),
];

/// A program, and the programs that it calls.
type Texts = (&'static str, &'static [(u32, &'static str)]);

/// Where a block may stand, mostly out of the run's reach: `{}` is the block; its program and line follow.
const PLACES: &[(Texts, u32, u32)] = &[
    (("{}\nM30\n", &[]), 1001, 1),
    (("G00 X5\nM30\n{}\n", &[]), 1001, 3),
    (("GOTO 900\n{}\nN900 M30\n", &[]), 1001, 2),
    (("WHILE[1EQ2]DO1\n{}\nEND1\nM30\n", &[]), 1001, 2),
    (("N10 IF[#500EQ1]GOTO 20\nGOTO 30\nN20 {}\nN30 M30\n", &[]), 1001, 3),
    (("M98 P8100\nM30\n", &[(8100, "G00 X5\nM99\n{}\n")]), 8100, 3),
    (("G65 P8100 A1\nM30\n", &[(8100, "IF[#1EQ1]GOTO 9\n{}\nN9 M99\n")]), 8100, 2),
    (("M30\nM98 P8100\n", &[(8100, "{}\nM99\n")]), 8100, 1),
    (("M30\nG66 P8100 A2\n", &[(8100, "{}\nM99\n")]), 8100, 1),
    (("G66 P8100 A2\nG67\nM30\n", &[(8100, "{}\nM99\n")]), 8100, 1),
    (("M98 P8000\nM30\n", &[(8000, "M99\nM98 P8100\n"), (8100, "M99\n{}\n")]), 8100, 2),
];

#[test]
fn b1_a_mistake_is_found_wherever_it_stands() {
    let mut missed = String::new();
    for (block, name) in MISTAKES {
        for ((place, others), program, line) in PLACES {
            let put = |text: &str| text.replace("{}", block);
            let others: Vec<_> = others.iter().map(|(number, text)| (*number, put(text))).collect();
            let found = faults(&check_with(&put(place), &others));
            if !found.contains(&(*program, *line, name)) {
                writeln!(missed, "{block} in {place:?} {others:?}: {found:?}").unwrap();
            }
        }
    }
    assert!(missed.is_empty(), "{missed}");
}

/// The block behind THEN of an IF that is false, or the target of its GOTO.
#[test]
fn b3_what_stands_behind_a_false_condition_is_checked() {
    for (line, name) in [
        ("IF[#1EQ2]GOTO 78", "missing-target"),
        ("IF[#1EQ2]THEN #99=1", "bad-variable"),
        ("IF[#1EQ2]THEN #2=5/0", "division-by-zero"),
        ("IF[#1EQ2]THEN #2=SQRT[-4]", "domain"),
        ("IF[#1EQ2]THEN M98 P7777", "missing-program"),
        ("IF[#1EQ2]THEN G00 X1 X2", "double-word"),
        ("IF[#1EQ2]THEN IF[#1EQ3]THEN G01 X1 F0", "out-of-range"),
    ] {
        let found = faults(&check_with(&format!("G00 X5\n{line}\nM30\n"), &[]));
        assert_eq!(found, [(1001, 2, name)], "{line}");
    }
}

/// Once true and once false: both were executed, so nothing is read again.
#[test]
fn b3_a_condition_that_was_true_and_false_is_not_read_again() {
    let text = "#1=0\nWHILE[#1LT2]DO1\n#1=#1+1\nIF[#1EQ2]THEN #2=1/[#1-2+#1]\nEND1\nM30\n";
    assert_eq!(faults(&check_with(text, &[])), []);
}

/// Values, modes and positions of a run decide about these: no errors.
#[test]
fn b1_what_a_run_decides_is_no_error_of_a_block_that_it_does_not_reach() {
    for block in [
        "X10 R5",
        "G02 X50 Z-5 R1",
        "G01 U5",
        "#5=1/#7",
        "#5=SQRT[#7-1]",
        "GOTO #1",
        "M98 P#1",
        "G01 X#1 F#2",
        "T#3",
        "G04 P#4",
        "IF[#1EQ0]THEN #5=1/#1",
        "G90 X30 Z-10",
        "G28 U0 W0",
        "END1",
        "#[100+#1]=5",
    ] {
        let text =
            format!("WHILE[1EQ2]DO1\nG01 X1 F5\nGOTO 8\n{}\nEND1\nN8 M30\n", if block == "END1" { "" } else { block });
        assert_eq!(faults(&check_with(&text, &[])), [], "{block}");
    }
    // The caller of the program has the block.
    let called = [(8100, "G00 X5\nM99\nM99 P100\n".to_owned())];
    assert_eq!(faults(&check_with("M98 P8100\nM30\n", &called)), []);
}

/// Calls are counted through the blocks that the run does not reach: four of M98 or of G65, one inside the other.
#[test]
fn b3_calls_that_nest_too_deep_behind_the_run_are_a_warning() {
    for (call, name) in [("M98 P", "M98"), ("G65 P", "G65")] {
        let chain = |depth: u32| -> Vec<(u32, String)> {
            let call_next =
                |step| if step < depth { format!("{call}{}\nM99\n", 8101 + step) } else { "M99\n".to_owned() };
            (1..=depth).map(|step| (8100 + step, call_next(step))).collect()
        };
        let main = format!("M30\n{call}8101\n");
        assert!(check_with(&main, &chain(4)).warnings.is_empty(), "{name}");
        let report = check_with(&main, &chain(5));
        let told: Vec<_> = report
            .warnings
            .iter()
            .map(|fault| (fault.location.program, fault.error.id(), fault.calls.iter().count()))
            .collect();
        assert_eq!((faults(&report), told), (vec![], vec![(8104, "too-deep", 4)]), "{name}");
        // A program that calls itself under a condition is not followed round and round.
        let own = [(8101, format!("IF[#1GT0]GOTO 9\n{call}8101\nN9 M99\n"))];
        assert!(check_with(&main, &own).warnings.is_empty(), "{name}");
    }
}

/// Of a contour with compensation and of a corner the check says that it has not looked at them, once for a program.
#[test]
fn b1_contours_and_corners_that_the_run_does_not_reach_are_named_as_not_checked() {
    for (text, line) in [
        ("G00 X5 Z5\nM30\nG42 G01 X-20 Z-20 F100 D1\nZ-30\nG28 U0\nG40 X-10\nM30\n", 3),
        ("G00 X5 Z5\nM30\nG01 X-15 F100 ,C1\nG28 U0\nG01 Z-15 F100 ,R1\nM30\n", 3),
    ] {
        let report = check_with(text, &[]);
        let told: Vec<_> = report.warnings.iter().map(|fault| (fault.location.line, fault.error.id())).collect();
        assert_eq!((faults(&report), told), (vec![], vec![(line, "contour-unread")]), "{text}");
    }
}

/// A jump into a loop is named with the line of its WHILE, not as a loop without a partner.
#[test]
fn b3_a_jump_into_a_loop_names_the_while() {
    let report = check_with("GOTO 10\nWHILE[1EQ2]DO1\nN10 #500=1\nEND1\nM30\n", &[]);
    assert_eq!(faults(&report), [(1001, 4, "jump-into-while")]);
    assert!(report.faults[0].text(Lang::En).contains("END1 was reached without the WHILE in line 2"));
}

/// An IF guards against a division by zero.
#[test]
fn b3_a_division_that_an_if_guards_is_neither_error_nor_warning() {
    let report = check_with("#1=0\nIF[#1GT0]THEN #2=10/#1\nM30\n", &[]);
    assert_eq!((faults(&report), report.warnings.len()), (vec![], 0));
}

/// What depends on values that are not known is a warning, never silence.
#[test]
fn t4_what_depends_on_values_that_are_not_known_is_a_warning() {
    for (block, name) in [("M98 P#560", "empty-word"), ("#5=1/[#560]", "division-by-zero")] {
        let report = check_with(&format!("M30\n{block}\n"), &[]);
        assert_eq!(faults(&report), [], "{block}");
        let warned: Vec<_> = report.warnings.iter().map(|fault| (fault.location.line, fault.error.id())).collect();
        assert_eq!(warned, [(2, name)], "{block}");
    }
}

/// Called programs are checked with the values of the call: the second call divides by zero.
#[test]
fn b3_called_programs_are_checked_with_the_values_of_each_call() {
    let called = [(8100, "#2=10/#1\nM99\n".to_owned())];
    assert_eq!(faults(&check_with("G65 P8100 A2\nG65 P8100 A0\nM30\n", &called)), [(8100, 1, "division-by-zero")]);
    assert_eq!(faults(&check_with("G65 P8100 A2\nM30\n", &called)), []);
    // A call that the run does not reach has its values, too.
    let called = [(8100, "G01 X#1 F#2\nM99\n".to_owned())];
    assert_eq!(faults(&check_with("M30\nG65 P8100 A2 B5\n", &called)), []);
}

/// An alarm that the program raises in any case is told; not one that values decide which nobody knows yet.
#[test]
fn b3_an_alarm_that_the_values_of_the_call_raise_is_told() {
    let warned = |text: &str, called: &[(u32, String)]| -> Vec<(u32, u32, &'static str)> {
        let found = check_with(text, called).warnings;
        found.iter().map(|fault| (fault.location.program, fault.location.line, fault.error.id())).collect()
    };
    let called = [(8100, "IF[#1EQ#0]THEN #3000=1(NO A)\nM99\n".to_owned())];
    assert_eq!(warned("G65 P8100\nM30\n", &called), [(8100, 1, "alarm-reached")]);
    assert_eq!(warned("G65 P8100 A1\nM30\n", &called), []);
    // The operator sets #500, the machine the input, a program before #100.
    for text in [
        "IF[#500EQ#0]THEN #3000=1(A)\nM30\n",
        "IF[#5821EQ0]THEN #3000=1(A)\nM30\n",
        "IF[#100LT1]THEN #3000=1(A)\nM30\n",
    ] {
        assert!(!warned(text, &[]).iter().any(|(.., name)| *name == "alarm-reached"), "{text}");
    }
    let told = check_with("G65 P8100\nM30\n", &called).warnings[0].text(Lang::En);
    assert!(told.contains("ends here with alarm 3001: NO A"), "{told}");
}

/// The number of a variable that is computed from an argument which the call does not give.
/// O9071 in force as G71, and `G71 P10 Q20`: behind the alarm about P it read #5830.
#[test]
fn b3_values_that_an_alarm_has_refused_are_no_mistakes_of_the_text() {
    let report = check_with(
        "#1=10\nIF[#1 GT 6]THEN #3000=9(TOO MUCH)\n#2=#[5820+#1]\nG04 P[#1-20]\n#440=1\nG04 P-3\nM30\n",
        &[],
    );
    assert_eq!(faults(&report), [(1001, 5, "bad-variable"), (1001, 6, "out-of-range")]);
    let warned: Vec<_> = report.warnings.iter().map(|fault| (fault.location.line, fault.error.id())).collect();
    assert_eq!(warned, [(2, "alarm-reached"), (3, "bad-variable"), (4, "out-of-range")]);
}

#[test]
fn b3_a_variable_of_an_argument_that_is_not_given_is_no_mistake() {
    let called = [(8100, "IF[#16EQ#0]GOTO 2\nIF[#[5820+#16]EQ1]THEN #3000=9(A)\nN2 M99\n".to_owned())];
    let report = check_with("G65 P8100 A1\nM30\n", &called);
    assert_eq!((faults(&report), report.warnings.len()), (vec![], 0), "{:?}", report.warnings);
}

/// Behind the `%` that ends a text nothing is read.
#[test]
fn b1_behind_the_end_of_the_text_nothing_is_read() {
    assert_eq!(faults(&check_with("%\nO1001\nM30\n%\nthis is no block ?\n", &[])), []);
    assert_eq!(faults(&check_with("%\nO1001\nGOTO 9\nG37\nN9 M30\n%\nG38\n", &[])), [(1001, 4, "unknown-g")]);
}

/// A correct block for a random program.
fn correct_block() -> impl Strategy<Value = String> {
    prop_oneof![
        (1..200, 1..90).prop_map(|(x, z)| format!("G01 X{x}. Z-{z}. F{x}")),
        (1..200, 1..9).prop_map(|(x, u)| format!("G00 X{x} W{u}.5")),
        (1..50).prop_map(|x| format!("G02 U{x}. W-{x}. R{x}.")),
        (1..33, 500..520).prop_map(|(local, common)| format!("#{local}=#{common}+1")),
        (1..9).prop_map(|n| format!("G04 P{n}00")),
        Just("M08".to_owned()),
        (1..33).prop_map(|local| format!("IF[#{local}GT5]THEN #{local}=5")),
        (1..4, 1..20).prop_map(|(n, times)| format!("WHILE[#{times}LT3]DO{n}\n#{times}=#{times}+1\nG00 U1\nEND{n}")),
        (1..200).prop_map(|x| format!("G90 X{x}. Z-5. F2")),
        (1..5).prop_map(|offset| format!("T010{offset}")),
    ]
}

proptest! {
    /// A correct program is correct behind M30, too, and in a program that nothing reaches.
    #[test]
    fn b1_correct_blocks_are_correct_wherever_they_stand(blocks in prop::collection::vec(correct_block(), 1..20)) {
        let body = blocks.join("\n");
        prop_assert_eq!(faults(&check_with(&format!("M30\n{body}\n"), &[])), []);
        prop_assert_eq!(faults(&check_with(&format!("GOTO 9999\n{body}\nN9999 M30\n"), &[])), []);
        let called = [(8100, format!("M99\n{body}\nM99\n"))];
        prop_assert_eq!(faults(&check_with("M98 P8100\nM30\n", &called)), []);
    }
}

/// The shipped programs have nothing to report when nothing of them is reached.
#[test]
fn b1_the_shipped_programs_are_correct_where_no_run_comes() {
    for file in std::fs::read_dir("programs").unwrap().map(|entry| entry.unwrap().path()) {
        if file.extension().is_none_or(|extension| extension != "NC") {
            continue;
        }
        let bytes = std::fs::read(&file).unwrap();
        let kinds = program_kind::kinds_of(String::from_utf8_lossy(&bytes).lines());
        let dialect = kinds.first().map_or(Dialect::LatheA, |kind| kind.dialect());
        let mut text = b"G00 X0 Z0\nGOTO 99999\n".to_vec();
        text.extend(bytes.iter().filter(|byte| **byte != b'%'));
        text.extend(b"\nN99999 M30\n");
        let others: Vec<_> = (8000..10_000).map(|number| (number, "M99\n".to_owned())).collect();
        let source = |number: u32, text: &[u8]| Arc::new(Source::new(number, "P.NC", text, dialect));
        let shelf = others.iter().map(|(number, text)| (*number, source(*number, text.as_bytes()))).collect();
        let report = check(&source(1, &text), &(Arc::new(Shelf(shelf)) as _), &NcSettings::for_dialect(dialect));
        let told: Vec<_> = report.faults.iter().map(ToString::to_string).collect();
        let told: Vec<_> = told.iter().filter(|text| !text.contains("O number")).collect();
        assert!(told.is_empty(), "{}: {told:#?}", file.display());
    }
}

/// What modes and values decide that only a run knows is no error: correct programs that jump into such blocks.
#[test]
fn b1_modes_of_a_run_decide_about_blocks_behind_a_jump() {
    for (dialect, text) in [
        (Dialect::LatheA, "G98 F100\nG00 X10 Z0\nIF[#500 EQ 1]GOTO 10\nG02 X20 Z-5 R5\nGOTO 20\nN10 X5 M08\nN20 M30\n"),
        (
            Dialect::LatheA,
            "G98 F100\nG02 X10 Z0 R9\nIF[#500 EQ 1]GOTO 10\nG00 X20\nGOTO 20\nN10 X5 Z0 R5 M08\nN20 M30\n",
        ),
        (Dialect::Mill, "G90\nIF[#500 EQ 1]GOTO 10\nG91\nG01 X1 F100\nM30\nN10 G53 X0\nM30\n"),
        (
            Dialect::Mill,
            "G17 G90\nG18 F100\nG00 X0 Z0\nIF[#500 EQ 1]GOTO 10\nG17\nGOTO 20\nN10 G02 X5 Z5 R5\nN20 M30\n",
        ),
        (Dialect::LatheA, "IF[#4 EQ #0]GOTO 20\n#[#4]=3\nN20 M30\n"),
    ] {
        let settings = NcSettings::for_dialect(dialect);
        let source = Arc::new(Source::new(1001, "O1001.NC", text, dialect));
        let report = check(&source, &(Arc::new(EmptyLibrary) as SharedLibrary), &settings);
        assert!(report.faults.is_empty(), "{text}: {:?}", report.faults);
    }
}
