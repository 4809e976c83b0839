//! The texts that a program gives beside its blocks. Source: spec B8, H9.

use std::path::Path;

use kt830::defs::text::Lang;
use kt830::nc::program_uses::text_row_faults;
use kt830::nc::settings::Dialect;
use kt830::nc::{Op, Source};

const PROGRAM: &str = "\
O1015 (外圆)
IF[[#505 LT 0]OR[#506 LT #507]]THEN #3000=1(余量)
#3000=2(直径 #521 不对)
#3006=7(翻面)
M30
(EN: cylindrical grinding)
(#3000=1 #505 GE 0 #506 GE #507 原因: 余量是负数)
(#3000=1 处理: 改为正数)
(#3000=1 EN: stock)
( #3000=1 Cause：the stock is negative: see the page )
(#3006=7 EN: turn the part over)
";

fn source(text: &str, dialect: Dialect) -> Source {
    Source::new(1_015, "O1015.NC", text.as_bytes(), dialect)
}

/// The operations of a program, as `check --ops` prints them.
fn shown(source: Source) -> Vec<Op> {
    let (source, library) = (std::sync::Arc::new(source), std::sync::Arc::new(kt830::nc::EmptyLibrary) as _);
    let settings = kt830::nc::NcSettings::for_dialect(source.dialect());
    let (mut world, mut ops) = (kt830::nc::OfflineMachine::new(&settings), Vec::new());
    let check = kt830::nc::ProgramCheck::new(&source, &library, &settings, kt830::nc::CommonVariables::default());
    check.run(&mut world, &mut |block| ops.extend(block.ops.iter().cloned()));
    ops
}

#[test]
fn b8_a_program_says_cause_remedy_and_variable_of_its_alarms() {
    let source = source(PROGRAM, Dialect::LatheA);
    let help = source.alarm_help(3_001).unwrap();
    assert_eq!(
        (help.cause.get(Lang::Zh), help.cause.get(Lang::En)),
        ("余量是负数", "the stock is negative: see the page")
    );
    // Without English the Chinese text is shown.
    assert_eq!((help.remedy.get(Lang::Zh), help.remedy.get(Lang::En)), ("改为正数", "改为正数"));
    // The first variable whose rule does not hold; an empty one counts as 0.
    let wrong = |values: [(u16, f64); 2]| {
        help.variable(|variable| values.iter().find(|(number, _)| *number == variable).map(|(_, value)| *value))
    };
    assert_eq!(wrong([(505, -0.1), (506, 0.0)]), Some(505));
    assert_eq!(wrong([(505, 0.0), (506, -0.1)]), Some(506));
    assert_eq!(wrong([(506, 0.1), (507, 0.2)]), Some(506));
    assert_eq!(wrong([(505, 0.1), (506, 0.2)]), Some(505), "all rules hold: the first one named");
    // Without a row the alarm is about the first variable of its text.
    assert_eq!(source.alarm_help(3_002).unwrap().variable(|_| None), Some(521));
    assert!(source.alarm_help(3_003).is_none());
    assert_eq!(text_row_faults(&source), []);
}

#[test]
fn h9_titles_and_messages_of_a_program_have_english() {
    let program = source(PROGRAM, Dialect::LatheA);
    assert_eq!(
        (program.comment_title().as_deref(), program.english_title()),
        (Some("外圆"), Some("cylindrical grinding"))
    );
    let stop = |text: &str| {
        let ops = shown(source(text, Dialect::LatheA));
        ops.into_iter().find_map(|op| if let Op::StopWithMessage { text, .. } = op { Some(text) } else { None })
    };
    let text = stop("#3006=7(翻面)\nM30\n(#3006=7 EN: turn the part over)\n").unwrap();
    let text = kt830::defs::text::LocalizedText::of_program(&text);
    assert_eq!((&*text.get(Lang::Zh), &*text.get(Lang::En)), ("翻面", "turn the part over"));
    // A program without rows shows its own text in both languages.
    let text = kt830::defs::text::LocalizedText::of_program(&stop("#3006=7(翻面)\nM30\n").unwrap());
    assert_eq!((&*text.get(Lang::Zh), &*text.get(Lang::En)), ("翻面", "翻面"));
}

#[test]
fn h9_messages_of_an_802d_program_have_english() {
    let text = "MSG(\"错误01:转速\")\nM2\n;EN: test\n;MSG(\"错误01:转速\") EN: error 01: speed\n";
    let program = source(text, Dialect::Sinumerik);
    assert_eq!((program.english_title(), text_row_faults(&program)), (Some("test"), vec![]));
    let Some(Op::DisplayMessage { text }) = shown(program).into_iter().next() else { panic!("no message") };
    let text = kt830::defs::text::LocalizedText::of_program(&text);
    assert_eq!((&*text.get(Lang::Zh), &*text.get(Lang::En)), ("错误01:转速", "error 01: speed"));
}

#[test]
fn b8_rows_of_texts_that_do_not_fit_are_named_by_their_line() {
    let lines =
        |text: &str| text_row_faults(&source(text, Dialect::LatheA)).iter().map(|at| at.line).collect::<Vec<_>>();
    assert_eq!(lines(&PROGRAM.replace("#3000=1 处理", "#3000=1 对策")), [8], "an unknown word");
    assert_eq!(lines(&PROGRAM.replace("GE 0 #506", "GE")), [7], "a comparison without a value");
    assert_eq!(lines(&PROGRAM.replace("EN: stock", "EN:")), [9], "an empty text");
    assert_eq!(lines(&PROGRAM.replace("(#3006=7 EN", "(#3006=7 CAUSE")), [11], "a message has no cause");
    assert_eq!(lines(&PROGRAM.replace("(#3006=7", "(#3006=8")), [11], "no such message");
    assert_eq!(lines(&PROGRAM.replace("THEN #3000=1", "THEN #3000=4")), [7], "no such alarm");
    // A computed number may be any.
    assert_eq!(lines(&PROGRAM.replace("THEN #3000=1", "THEN #3000=#101")), [0; 0]);
    // Remarks are no rows.
    assert_eq!(lines("O1 (EN)\n(#505 余量)\n(3000 r/min)\nM30\n"), [0; 0]);
    // Nor are blocks that were commented out.
    assert_eq!(lines("O1\n(#3000= 5 old)\n(#3000=1(STOP: no part))\n(#3000=2)\nM30\n"), [0; 0]);
}

/// Every alarm and every message of a shipped program has all its texts, and every title its English.
#[test]
fn h9_b8_the_texts_of_the_shipped_programs_are_complete() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("programs");
    let chinese = |text: &str| text.chars().any(|sign| ('\u{4e00}'..='\u{9fff}').contains(&sign));
    let mut alarms = 0;
    for (sub, dialect) in [("", Dialect::LatheA), ("lathe", Dialect::SuperMan), ("802d", Dialect::Sinumerik)] {
        for entry in std::fs::read_dir(folder.join(sub)).unwrap() {
            let path = entry.unwrap().path();
            if !path.is_file() {
                continue;
            }
            let (name, bytes) = (path.display().to_string(), std::fs::read(&path).unwrap());
            let program = Source::new(1, name.clone(), bytes, dialect);
            assert_eq!(text_row_faults(&program), [], "{name}");
            if program.comment_title().is_some_and(|title| chinese(&title)) {
                assert!(program.english_title().is_some_and(|title| !chinese(title)), "{name}: no English title");
            }
            for line in 1..=program.line_count() as u32 {
                let line = program.line(line).unwrap();
                let Some((_, rest)) = line.split_once("#3000=").filter(|(before, _)| !before.starts_with('(')) else {
                    continue;
                };
                let number: u32 = rest.split_once('(').unwrap().0.parse().unwrap();
                let help = program.alarm_help(3_000 + number).unwrap_or_else(|| panic!("{name}: {number}"));
                for text in [&help.cause, &help.remedy] {
                    let (zh, en) = (text.get(Lang::Zh), text.get(Lang::En));
                    assert!(chinese(zh) && !en.is_empty() && !chinese(en), "{name}: {number}");
                }
                let title = help.text.en();
                assert!(!title.is_empty() && !chinese(&title), "{name}: {number}");
                // The card of the alarm page has room for so many letters at 1024 × 768.
                assert!(title.len() <= 60, "{name}: {number}: {} letters", title.len());
                alarms += 1;
            }
        }
    }
    assert_eq!(alarms, 378);
}
