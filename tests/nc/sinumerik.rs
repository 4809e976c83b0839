//! The language of the SINUMERIK 802D: programs and their operations side by side, and wrong programs with their errors
//! (row S1).

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kt830::defs::kind::Dialect;
use kt830::defs::program_number;
use kt830::defs::text::Lang;
use kt830::nc::{CheckReport, CommonVariables, Library, NcSettings, OfflineMachine, ProgramCheck, Source};

/// Subprograms of one folder, by number.
struct Folder(HashMap<u32, Arc<Source>>);

impl Library for Folder {
    fn find(&self, number: u32) -> Option<Arc<Source>> {
        self.0.get(&number).cloned()
    }
}

fn files(folder: &str, extension: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|found| found == extension));
    files.sort();
    files
}

fn source(path: &Path) -> Arc<Source> {
    let name = path.file_name().unwrap().to_str().unwrap();
    let number = program_number::from_name(program_number::stem(name));
    Arc::new(Source::new(number, name.to_uppercase(), std::fs::read(path).unwrap(), Dialect::Sinumerik))
}

fn run(source: &Arc<Source>) -> (String, CheckReport) {
    let settings = NcSettings::for_dialect(Dialect::Sinumerik);
    let subs = files("tests/nc/802d/sub", "SPF").iter().map(|path| source_of(path)).collect();
    let library: Arc<dyn Library + Send + Sync> = Arc::new(Folder(subs));
    let mut world = OfflineMachine::new(&settings);
    let mut ops = String::new();
    let checking = ProgramCheck::new(source, &library, &settings, CommonVariables::default());
    let checked = checking.run(&mut world, &mut |block| {
        let name = if block.location.program == source.number() {
            source.title()
        } else {
            program_number::name_of(block.location.program)
        };
        for op in &block.ops {
            ops.push_str(&format!("{name}:{} {op}\n", block.location.line));
        }
    });
    (ops, checked)
}

fn source_of(path: &Path) -> (u32, Arc<Source>) {
    let source = source(path);
    (source.number(), source)
}

/// What a text comes to, as one line a mistake.
fn mistakes(checked: &CheckReport) -> Vec<String> {
    checked
        .faults
        .iter()
        .map(|fault| format!("{}:{} {}", fault.location.line, fault.column, fault.cause(Lang::En)))
        .collect()
}

#[test]
fn s1_golden_programs_give_their_operations() {
    for path in files("tests/nc/802d", "MPF") {
        let (ops, checked) = run(&source(&path));
        assert_eq!(mistakes(&checked), [""; 0], "{}", path.display());
        let expected = std::fs::read_to_string(path.with_extension("ops")).unwrap_or_default();
        assert_eq!(ops, expected, "{}\n{ops}", path.display());
    }
}

/// The first line says what is wrong: `; line:column cause`, several parted by ` | `.
#[test]
fn s1_wrong_programs_name_every_error_with_line_and_column() {
    let mut wrong = Vec::new();
    for path in files("tests/nc/802d/bad", "MPF") {
        let (_, checked) = run(&source(&path));
        let text = std::fs::read_to_string(&path).unwrap();
        let expected = text.lines().next().unwrap().trim_start_matches([';', ' ']);
        let found = mistakes(&checked).join(" | ");
        if found != expected {
            wrong.push(format!("{}\nfound    {found}\nexpected {expected}", path.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What to do about it, in the words of this language: no G98, no [expression], no J, no comment in brackets.
#[test]
fn s1_remedies_name_what_this_language_has() {
    let rows = [
        ("G1 X5", "give F in this block or before; G94/G95 requires a new one", "G94/G95"),
        ("G2 X10 F100", "write the radius CR=, or the centre I K", "CR="),
        ("G2 X10 R5.5", "write CR=5.5", "CR=5.5"),
        ("G98 F100", "available are G94 (mm/min) G95 (mm/r)", "G94 (mm/min)"),
        ("G0 X", "write the value", "请在其后写出数值"),
        ("X10 (comment)", "type ; instead", "半角英文字符 ;"),
        ("R1=FOO(1)", "available are SIN COS TAN ASIN ACOS SQRT ABS TRUNC ROUND LN EXP POT ATAN2", "可用 SIN COS"),
        ("IF: R1=1", "and must not be a code word", "且不能是指令字"),
    ];
    for (block, en, zh) in rows {
        let (_, checked) =
            run(&Arc::new(Source::new(7_000, "T.MPF", format!("{block}\nM2\n").into_bytes(), Dialect::Sinumerik)));
        let [fault] = checked.faults.as_slice() else { panic!("{block}: {:?}", checked.faults) };
        assert!(fault.remedy(Lang::En).contains(en), "{block}: {}", fault.remedy(Lang::En));
        assert!(fault.remedy(Lang::Zh).contains(zh), "{block}: {}", fault.remedy(Lang::Zh));
    }
}

/// `X=$AA_IW[X]` is no move, whichever way X is read.
#[test]
fn s1_actual_positions_are_read_as_x_words_are() {
    for (mode, read) in [("DIAMON", -20), ("DIAM90", -20), ("DIAMOF", -10)] {
        let text = format!("G0 X-20\n{mode}\nR1=$AA_IW[X] R2=$AA_IM[X]\nG0 X=$AA_IW[X]\nM2\n");
        let (ops, checked) = run(&Arc::new(Source::new(7_000, "T.MPF", text.into_bytes(), Dialect::Sinumerik)));
        assert_eq!(mistakes(&checked), [""; 0]);
        let [one, two] = [601, 602].map(|number| format!("set variable={number} value={read}\n"));
        assert!(ops.contains(&one) && ops.contains(&two), "{mode}: {ops}");
        assert_eq!(ops.matches("rapid x=-10 ").count(), 2, "{mode}: {ops}");
    }
}

#[test]
fn s1_exp_is_the_inverse_of_ln() {
    let (ops, checked) =
        run(&Arc::new(Source::new(7_000, "T.MPF", b"R1=LN(EXP(2))\nR2=EXP(0)\nM2\n".to_vec(), Dialect::Sinumerik)));
    assert_eq!(mistakes(&checked), [""; 0]);
    assert!(ops.contains("set variable=601 value=2\n") && ops.contains("set variable=602 value=1\n"), "{ops}");
}

/// Behind an end, and in a subprogram behind its return, is read what the run does not reach; so is a program that only
/// such a line calls.
#[test]
fn s1_a_subprogram_that_the_run_does_not_reach_is_read() {
    let of = |number: u32, name: &str, text: &str| Arc::new(Source::new(number, name, text, Dialect::Sinumerik));
    let main = of(1001, "MAIN.MPF", "L10\nM2\nL20\n");
    let (ten, twenty) = (program_number::from_l(10), program_number::from_l(20));
    let subs = HashMap::from([
        (ten, of(ten, "L10.SPF", "G1 X800 F100\nRET\nG504\n")),
        (twenty, of(twenty, "L20.SPF", "R1=5\nSPOS=3\nRET\n")),
    ]);
    let library: Arc<dyn Library + Send + Sync> = Arc::new(Folder(subs));
    let settings = NcSettings::for_dialect(Dialect::Sinumerik);
    let check = ProgramCheck::new(&main, &library, &settings, CommonVariables::default());
    let checked = check.run(&mut OfflineMachine::new(&settings), &mut |_| {});
    let found: Vec<_> = checked
        .faults
        .iter()
        .map(|fault| (program_number::name_of(fault.location.program), fault.location.line, fault.error.id()))
        .collect();
    let wanted = [("L10", 3, "no-such-code"), ("L20", 2, "no-spindle-position")];
    assert_eq!(found, wanted.map(|(name, line, error)| (name.to_owned(), line, error)));
}

/// A condition may stand in brackets, DOS ends a text with 0x1A, and statements of larger controls are named.
#[test]
fn s1_what_programs_of_others_have() {
    let check = |text: &str| {
        let source = Arc::new(Source::new(1001, "A.MPF", text, Dialect::Sinumerik));
        let library: Arc<dyn Library + Send + Sync> = Arc::new(Folder(HashMap::new()));
        let settings = NcSettings::for_dialect(Dialect::Sinumerik);
        let check = ProgramCheck::new(&source, &library, &settings, CommonVariables::default());
        mistakes(&check.run(&mut OfflineMachine::new(&settings), &mut |_| {}))
    };
    assert_eq!(check("R3=5\nMARK1:\nR3=R3-1\nIF(R3>2)GOTOB MARK1\nIF (R3+1)*2>100 GOTOB MARK1\nM2\n\u{1a}"), [""; 0]);
    // 1500, 0.000001 and 20 by their exponents: a run that goes on to an error would say so.
    let exponents = "R1=1.5EX3 R2=1EX-6 R3=2ex+1\nIF R1<>1500 GOTOF EE\nIF R2<>0.000001 GOTOF EE\nIF R3==20 GOTOF AA\nEE: G1 X800\nAA: M2\n";
    assert_eq!(check(exponents), [""; 0]);
    assert_eq!(check(&exponents.replace("ex+1", "ex+0")), ["5:8 no feed F has been given"]);
    assert!(!check("R3=5\nIF(R3>2 GOTOF A1\nA1:\nM2\n").is_empty());
    // A jump goes to a block number, too, and a label may begin with N.
    assert_eq!(check("R1=0\nN5 R1=R1+1\nIF R1<3 GOTOB N5\nGOTOF N0020\nN20 GOTOF NEXT\nN30\nNEXT: M2\n"), [""; 0]);
    let wrong = check("GOTOB N5\nGOTOF N9\nGOTOF NINE\nN5 M2\n");
    let wanted = ["1:7 label N5 is not in this direction", "2:7 there is no block N9", "3:7 there is no label NINE"];
    assert_eq!(wrong, wanted);
    assert_eq!(check("M3 S100\nG0 X120 M9 M30 M5\n"), [""; 0]);
    assert_eq!(check("M2 M30\n"), ["1:4 M2 and M30 cannot be combined in one block"]);
    for (line, wanted) in [
        ("DEF REAL X", "1:1 this control has no DEF"),
        ("PROC GRIND", "1:1 this control has no PROC"),
        ("CYCLE406(1,2)", "1:1 this control has no CYCLE406"),
        ("SOFT", "1:1 this control has no SOFT"),
        // What to do instead is another thing for each.
        ("ENDIF", "1:1 there is no IF … ENDIF"),
        ("ELSE", "1:1 there is no IF … ENDIF"),
        ("WHILE R1<3", "1:1 there is no loop with WHILE"),
        ("REPEAT", "1:1 there is no loop with REPEAT"),
        ("IF R1>2 AND R2>1 GOTOF AA", "1:9 conditions have no AND"),
        // A name alone is a call of another program.
        ("PAR_INI", "1:1 there is no call PAR_INI(…)"),
        ("N30 S_PAR_INI ; values", "1:5 there is no call S_PAR_INI(…)"),
        ("C=R17", "1:1 this machine has no axis C"),
        ("G0 V-1", "1:4 this machine has no axis V"),
        ("G17", "1:1 G17 (XY plane) does not exist on this machine"),
    ] {
        let found = check(&format!("{line}\nM2\n"));
        assert_eq!(found.first().map(String::as_str), Some(wanted), "{line}: {found:?}");
    }
}
