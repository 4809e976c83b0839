//! The interpreter block by block: one story a row of the specification.

use std::sync::Arc;

use kt830::defs::kind::Dialect;
use kt830::defs::text::Lang;
use kt830::nc::{
    Block, CommonVariables, EmptyLibrary, ExternalState, Feed, Interpreter, Library, LiveValue, NcSettings, NextStatus,
    OfflineMachine, Op, ProgramFault, Source, check,
};
use kt830::units::{Axis, WorkBudget, WorkPos};

fn start(text: impl Into<Vec<u8>>, settings: NcSettings) -> (Interpreter, OfflineMachine, Block) {
    let (world, block) = (OfflineMachine::new(&settings), Block::new(&settings));
    let source = Arc::new(Source::new(1001, "O1001.NC", text.into(), settings.dialect));
    (Interpreter::new(source, Arc::new(EmptyLibrary), settings, CommonVariables::default()), world, block)
}

/// All operations of a text, or its first fault.
fn run_with(text: impl Into<Vec<u8>>, settings: NcSettings) -> Result<Vec<Op>, ProgramFault> {
    let (mut interpreter, mut world, mut block) = start(text, settings);
    let mut ops = Vec::new();
    loop {
        match interpreter.next(&mut world, &mut block)? {
            NextStatus::Block => {
                block.ops.iter().for_each(|op| world.apply(op));
                ops.append(&mut block.ops);
            }
            NextStatus::Drain => {}
            NextStatus::Busy | NextStatus::Waiting => panic!("busy"),
            NextStatus::End => return Ok(ops),
        }
    }
}

fn lines(text: &str, settings: NcSettings) -> Vec<String> {
    run_with(text, settings).unwrap().iter().map(Op::to_string).collect()
}

fn refused(text: &str) -> String {
    run_with(text, NcSettings::lathe_a()).unwrap_err().text(Lang::En)
}

#[test]
fn b3_null_word_is_left_out() {
    assert_eq!(lines("#1=#0\nG0 X10 Z#1\nM#1 G#2 X-#3", NcSettings::lathe_a()), ["rapid x=5 y=0 z=0 [X]"]);
}

#[test]
fn b2_blanks_and_comments_may_stand_behind_every_statement() {
    let text = "N10 #100=0 (A)\nWHILE[#100 LT 3]DO1 (B)\n#100=#100+1 (C)\nEND1 (D)\nIF[#100 EQ 3]GOTO 40 (E)\nG0 X2\n\
                N40 GOTO 50 \t \nG0 X4\nN50 IF[#100 EQ 3]THEN G0 X6 (F)\nGOTO 60 (G) ; G0 X8\nG0 X10\nN60 M30 (H)\n";
    let rapids: Vec<_> =
        lines(text, NcSettings::lathe_a()).into_iter().filter(|line| line.starts_with("rapid")).collect();
    assert_eq!(rapids, ["rapid x=3 y=0 z=0 [X]"]);
    assert!(refused("GOTO 40 X1\nN40 M30").contains('X'), "a word is no comment");
}

#[test]
fn b3_null_reads_as_zero_in_arithmetic_and_the_check_warns() {
    let library: Arc<dyn Library + Send + Sync> = Arc::new(EmptyLibrary);
    let source = Arc::new(Source::new(1001, "", "#100=#110-#162\nM30\n".as_bytes().to_vec(), Dialect::LatheA));
    let checked = check(&source, &library, &NcSettings::lathe_a());
    assert!(checked.faults.is_empty());
    let warning = checked.warnings.first().unwrap().text(Lang::En);
    assert!(warning.starts_with("O1001 line 1, column 10: empty variable #"), "{warning}");
    assert_eq!(lines("#100=#110-#162", NcSettings::lathe_a()), ["set variable=100 value=0"]);
}

#[test]
fn b3_what_empty_variables_cause_is_a_warning_of_the_check_and_a_fault_of_the_run() {
    let library: Arc<dyn Library + Send + Sync> = Arc::new(EmptyLibrary);
    let text = "G98 G1 X10 F#526\nX9\nG4 X#528\n#100=1/#529\nM30\n";
    let source = Arc::new(Source::new(1001, "", text.as_bytes().to_vec(), Dialect::LatheA));
    let checked = check(&source, &library, &NcSettings::lathe_a());
    assert!(checked.faults.is_empty(), "{:?}", checked.faults);
    let alarms: Vec<_> = checked.warnings.iter().map(|fault| (fault.location.line, fault.alarm())).collect();
    assert_eq!(alarms, [(1, 19), (3, 33), (4, 21), (4, 45)]);
    for (text, cause) in [("G4 X#528", "G04 needs"), ("#100=1/#529", "division by zero"), ("G1 X1 F#1", "no feed")] {
        assert!(refused(text).contains(cause), "{text}");
    }
}

#[test]
fn k1_diameter_can_be_switched_to_radius_and_f_stays_true_travel() {
    let text = "G98 G1 X10 U2 F60";
    assert!(refused(text).contains("X and U name the same axis"));
    let text = "G98 G1 X10 F60\nU2";
    assert_eq!(lines(text, NcSettings::lathe_a()), ["feed x=5 y=0 z=0 f=60 [X]", "feed x=6 y=0 z=0 f=60 [X+]"]);
    let radius = NcSettings { diameter: false, ..NcSettings::lathe_a() };
    assert_eq!(lines(text, radius), ["feed x=10 y=0 z=0 f=60 [X]", "feed x=12 y=0 z=0 f=60 [X+]"]);
}

#[test]
fn b1_a_number_without_a_point_can_count_least_increments() {
    let least = NcSettings { least_increment_mm: Some(0.001), ..NcSettings::lathe_a() };
    assert_eq!(lines("G0 X1000 Z1.5\nX#1", least.clone()), ["rapid x=0.5 y=0 z=1.5 [XZ]"]);
    // In inches 0.0001: 1000 is 0.1 inch, 2.54 mm of diameter.
    assert_eq!(lines("G20 G0 X1000 Z1.", least.clone()), ["rapid x=1.27 y=0 z=25.4 [XZ]"]);
    // The angle of a line in 0.001 degrees: 45 degrees, X 2 mm of radius.
    let line = lines("G98 G1 X4000 ,A45000 F60", least);
    assert!(line.iter().all(|op| op.starts_with("feed x=2 y=0 z=2")) && line.len() == 1, "{line:?}");
    assert_eq!(lines("G0 X100", NcSettings::lathe_a()), ["rapid x=50 y=0 z=0 [X]"]);
}

#[test]
fn b1_blocks_end_at_cr_lf_crlf_and_semicolon_and_spaces_are_free() {
    for text in ["G0X2\rZ3\r", "G0X2\nZ3", "g 0 x 2.\r\nz 3\r\n", "G0X2;Z3", "G0X2;Z3;", "%\nO1001;\nG0X2;\nZ3;\n%\nX9"]
    {
        assert_eq!(lines(text, NcSettings::lathe_a()), ["rapid x=1 y=0 z=0 [X]", "rapid x=1 y=0 z=3 [Z]"], "{text:?}");
    }
    // A number, a `/` or a comment before the `;` hides no block behind it.
    for text in ["N1 ; G0X2 ; N2 ; G0Z3", "N1;N2G0X2;(c);Z3", "/;G0X2\n/ N4 ; ; Z3", "N1 (c) ; G0X2; N3 (d) ; ; N4 Z3"]
    {
        assert_eq!(lines(text, NcSettings::lathe_a()), ["rapid x=1 y=0 z=0 [X]", "rapid x=1 y=0 z=3 [Z]"], "{text:?}");
    }
    assert_eq!(lines("N1 ; text X5\nG0X2 ; N3 ; text", NcSettings::lathe_a()), ["rapid x=1 y=0 z=0 [X]"]);
    assert_eq!(lines("\u{feff}G0X2 // Z3\n; X3\n(X4) ; text X5\x1a", NcSettings::lathe_a()), ["rapid x=1 y=0 z=0 [X]"]);
}

#[test]
fn b1_block_skip_leaves_out_blocks_with_a_slash_only_when_the_switch_is_set() {
    let text = "/G0X2\nN5 /Z3\nX4";
    assert_eq!(lines(text, NcSettings::lathe_a()).len(), 3);
    let (mut interpreter, world, mut block) = start(text, NcSettings::lathe_a());
    let mut world = world.with_block_skip(true);
    assert_eq!(interpreter.next(&mut world, &mut block), Ok(NextStatus::Block));
    assert_eq!((block.location.line, block.ops.len()), (3, 1));
    assert_eq!(interpreter.next(&mut world, &mut block), Ok(NextStatus::End));
}

/// The `/` of a block ends with it: the one behind the `;` has its own, or none.
#[test]
fn b1_block_skip_leaves_out_no_block_behind_a_semicolon() {
    let skipping = |text: &str| {
        let (mut interpreter, world, mut block) = start(text, NcSettings::lathe_a());
        let (mut world, mut moves) = (world.with_block_skip(true), Vec::new());
        while interpreter.next(&mut world, &mut block) != Ok(NextStatus::End) {
            moves.extend(block.ops.drain(..).map(|op| op.to_string()));
        }
        moves
    };
    let z3 = ["rapid x=0 y=0 z=3 [Z]"];
    for text in ["/G0 X2 ; Z3", "/2 X5 (a;b) ; G0 Z3", "/N1 #1=#2 ; G0 Z3 ; / X9", "G0 ; /X2 ; Z3", "/ ; G0 Z3"] {
        assert_eq!(skipping(text), z3, "{text:?}");
    }
    assert_eq!(skipping("/G0 X2 ; text\n/X3 // ; Z3\nG0 Z3"), z3, "comments stay comments");
}

/// FANUC, single cycles: codes of group 00 end X, Z and R of G90 and G94, G04 and M codes do not.
#[test]
fn b2_one_shot_codes_end_the_words_of_a_single_cycle() {
    let cycle = "G00 X50 Z2\nG90 X40 Z-30 R-2 F200\n";
    for between in ["G04 P10", "M08", "S900", ""] {
        assert!(run_with(format!("{cycle}{between}\nX38\nM30"), NcSettings::lathe_a()).is_ok(), "{between}");
    }
    for between in ["G50 X40", "G28 U0", "G10 D1 U0.1", "G50 S1000"] {
        let wrong = refused(&format!("{cycle}{between}\nX38\nM30"));
        assert!(wrong.contains("Z / W"), "{between}: {wrong}");
    }
}

/// 1000 least increments under G20 are 0.1 inch: 2.54 mm.
#[test]
fn b2_pecks_under_g20_count_ten_thousandths_of_an_inch() {
    let at = |text: &str| -> Vec<f64> {
        let ops = run_with(text, NcSettings::lathe_a()).unwrap();
        let feeds =
            ops.into_iter().filter_map(|op| if let Op::Feed { to, .. } = op { Some(to[Axis::Z]) } else { None });
        feeds.map(|z| (z * 1e6).round() / 1e6).collect()
    };
    let groove = "G00 X2. Z0\nG75 R0\nG75 X1.5 Z-0.2 Q1000 F2\nM30";
    assert_eq!(at(&format!("G20\n{groove}")), [0.0, -2.54, -5.08]);
    assert_eq!(at("G00 X50 Z0\nG75 R0\nG75 X40 Z-2 Q1000 F50\nM30"), [0.0, -1.0, -2.0]);
}

#[test]
fn b2_a_contour_that_ends_where_it_began_names_its_last_line() {
    let text = |last: &str| {
        format!("G00 X50 Z2\nG71 U2 R1\nG71 P10 Q20 U0 W0 F200\nN10 G00 X20\nG01 Z-30\nX50\n{last}\nG70 P10 Q20\nM30")
    };
    assert!(run_with(text("N20 X52"), NcSettings::lathe_a()).is_ok());
    for last in ["N20 G00 Z2", "N20 G00 G40 Z0.1"] {
        let wrong = refused(&text(last));
        assert!(wrong.contains("line 7") && wrong.contains("turns back"), "{last}: {wrong}");
    }
}

#[test]
fn b2_g40_is_in_force_already() {
    let moved = ["rapid x=5 y=0 z=0 [X]", "m code=30"];
    assert_eq!(lines("G40 G98\nG00 X10\nM30", NcSettings::lathe_a()), moved);
}

#[test]
fn b1_a_mark_of_utf8_and_comment_lines_may_stand_before_the_first_block() {
    for head in ["\u{feff}%\nO1001\n", "\u{feff}O1001\n", "// c\n%\nO1001\n", "%(A)\n\n; b\nO1001 (C)\n"] {
        let text = format!("{head}G0 X10\nM30\n%\nG0 X20\n");
        assert_eq!(lines(&text, NcSettings::lathe_a()), ["rapid x=5 y=0 z=0 [X]", "m code=30"], "{head:?}");
    }
    assert!(refused("G0 X1\nO1001").contains("O"), "behind a block it is no head");
}

#[test]
fn b1_gbk_comments_are_read_and_columns_count_characters() {
    // 外圆 in GBK.
    let mut text = b"O1001 (\xcd\xe2\xd4\xb2)\nG0 (\xcd\xe2\xd4\xb2) X1 Q9\n".to_vec();
    let source = Source::new(1001, "", text.clone(), Dialect::LatheA);
    assert_eq!(source.comment_title().as_deref(), Some("外圆"));
    assert_eq!(source.line(2).as_deref(), Some("G0 (外圆) X1 Q9"));
    let fault = run_with(text.clone(), NcSettings::lathe_a()).unwrap_err();
    assert_eq!((fault.location.line, fault.column), (2, 12));
    // A wide semicolon in GBK, outside a comment.
    text.splice(13.., b"G0 X1 \xa3\xbb".iter().copied());
    let fault = run_with(text, NcSettings::lathe_a()).unwrap_err();
    assert_eq!(fault.text(Lang::Zh), "O1001 第2行 第7列：注释以外出现字符 '；' – 请改用半角英文字符 ';'");
}

/// A world whose live values must be waited for once.
struct Live434 {
    inner: OfflineMachine,
    drained: bool,
}

impl ExternalState for Live434 {
    fn position(&self) -> WorkPos {
        self.inner.position()
    }

    fn system_variable(&mut self, number: u32) -> LiveValue {
        match (number, self.drained) {
            (434 | 1002, true) => LiveValue::Value(Some(1.0)),
            (434 | 1002, false) => LiveValue::Drain,
            _ => LiveValue::Unknown,
        }
    }

    fn block_skip(&self) -> bool {
        false
    }
}

#[test]
fn b3_a_live_value_waits_for_motion_and_the_block_is_read_again() {
    let (mut interpreter, inner, mut block) =
        start("#500=#434+1\nM91 P3 L7\nG0 X9\nN7 #501=#502", NcSettings::lathe_a());
    let mut world = Live434 { inner, drained: false };
    for _ in 0..3 {
        assert_eq!(interpreter.next(&mut world, &mut block), Ok(NextStatus::Drain));
        assert!(block.ops.is_empty());
    }
    world.drained = true;
    assert_eq!(interpreter.next(&mut world, &mut block), Ok(NextStatus::Block));
    assert_eq!(block.ops, [Op::SetVariable { variable: 500, value: Some(2.0) }]);
    world.drained = false;
    assert_eq!(interpreter.next(&mut world, &mut block), Ok(NextStatus::Drain));
    world.drained = true;
    assert_eq!(interpreter.next(&mut world, &mut block), Ok(NextStatus::Block));
    assert_eq!((block.location.line, block.location.n), (4, Some(7)));
    assert_eq!(block.ops, [Op::SetVariable { variable: 501, value: None }]);
}

/// Counts how often the machine is asked.
struct Counting(OfflineMachine, u32);

impl ExternalState for Counting {
    fn position(&self) -> WorkPos {
        self.0.position()
    }

    fn system_variable(&mut self, number: u32) -> LiveValue {
        self.1 += 1;
        self.0.system_variable(number)
    }

    fn block_skip(&self) -> bool {
        self.0.block_skip()
    }
}

#[test]
fn b3_a_loop_that_waits_for_the_machine_asks_it_twice_a_tick_at_most() {
    for text in ["N10 IF[#438 EQ 0]GOTO 10\nG04 P1", "WHILE[#1000 EQ 0]DO1\nEND1\nG04 P1"] {
        let (mut interpreter, world, mut block) = start(text, NcSettings::lathe_a());
        let mut world = Counting(world, 0);
        for tick in 1..=5 {
            assert_eq!(interpreter.next(&mut world, &mut block), Ok(NextStatus::Waiting), "{text}");
            assert!(world.1 <= 2 * tick, "{text}: asked {} times in {tick} ticks", world.1);
        }
        let number = if text.contains("#438") { 438 } else { 1_000 };
        world.0.set_system(number, Some(1.0));
        assert_eq!(interpreter.next(&mut world, &mut block), Ok(NextStatus::Block), "{text}");
    }
}

#[test]
fn b3_loops_without_operations_do_not_hold_up_the_tick() {
    for text in ["WHILE[1]DO1\n#1=1\nEND1", "N1 GOTO 1", "M99", "N1 M99 P1", "N1 G65 H80 P1"] {
        let (mut interpreter, mut world, mut block) = start(text, NcSettings::lathe_a());
        for _ in 0..3 {
            let status = interpreter.next(&mut world, &mut block);
            assert!(matches!(status, Ok(NextStatus::Busy | NextStatus::Waiting)), "{text}: {status:?}");
        }
    }
}

#[test]
fn b3_an_edited_variable_counts_from_the_next_block_read() {
    let (mut interpreter, mut world, mut block) = start("#500=1\nG0 X#500\nX#500", NcSettings::lathe_a());
    interpreter.next(&mut world, &mut block).unwrap();
    interpreter.next(&mut world, &mut block).unwrap();
    assert_eq!(block.ops[0].to_string(), "rapid x=0.5 y=0 z=0 [X]");
    interpreter.update_variable(500, Some(4.0)).unwrap();
    assert!(interpreter.update_variable(570, Some(4.0)).is_err());
    interpreter.next(&mut world, &mut block).unwrap();
    assert_eq!(block.ops[0].to_string(), "rapid x=2 y=0 z=0 [X]");
}

#[test]
fn b2_a_frame_and_a_move_in_one_block_come_in_two_parts() {
    let (mut interpreter, mut world, mut block) = start("G55 T0303 G0 U2", NcSettings::lathe_a());
    interpreter.next(&mut world, &mut block).unwrap();
    assert_eq!(block.ops, [Op::SelectWorkOffset { g: 55 }, Op::T { tool: 3, offset: 3 }]);
    assert!(!block.complete);
    // Frame and offset have moved the origin meanwhile.
    let mut world = world.with_position(WorkPos::new([7.0, 0.0, 0.0]));
    interpreter.next(&mut world, &mut block).unwrap();
    assert_eq!(block.ops[0].to_string(), "rapid x=8 y=0 z=0 [X+]");
    assert!(block.complete);
    assert_eq!(interpreter.next(&mut world, &mut block), Ok(NextStatus::End));
}

/// Reads on until a line is next, the program ends or the budget is spent.
fn advance(interpreter: &mut Interpreter, line: u32, world: &mut OfflineMachine) -> Result<NextStatus, ProgramFault> {
    let (mut block, mut budget) = (Block::new(&NcSettings::lathe_a()), WorkBudget::new(1_000_000));
    while !budget.is_spent() {
        let status = interpreter.read_towards(line, world, &mut block, &mut budget)?;
        if status != NextStatus::Busy {
            return Ok(status);
        }
    }
    Ok(NextStatus::Busy)
}

#[test]
fn b5_a_run_from_a_chosen_block_knows_what_is_in_force_there() {
    let text = "G99 G1 X20 F0.2\nT0202\nG56\nU2\nN70 G0 Z9\nM30";
    let (mut interpreter, mut world, mut block) = start(text, NcSettings::lathe_a());
    assert_eq!(advance(&mut interpreter, 5, &mut world), Ok(NextStatus::Block));
    let modals = *interpreter.modals();
    assert_eq!(
        (modals.work_offset, modals.tool, modals.feed(), modals.motion.g()),
        (56, 2, Some(Feed::PerRev(0.2)), 1)
    );
    assert_eq!(world.position(), WorkPos::new([11.0, 0.0, 0.0]));
    assert_eq!(interpreter.next(&mut world, &mut block), Ok(NextStatus::Block));
    assert_eq!((block.location.line, block.location.n), (5, Some(70)));
    assert_eq!(advance(&mut interpreter, 99, &mut world), Ok(NextStatus::End));
    let (mut interpreter, mut world, _) = start("N1 GOTO 1\nM30", NcSettings::lathe_a());
    assert_eq!(advance(&mut interpreter, 2, &mut world), Ok(NextStatus::Busy));
}

#[test]
fn b2_a_mistake_behind_a_frame_refuses_the_whole_block() {
    let (mut interpreter, mut world, mut block) = start("G55 G0 X2 Q1", NcSettings::lathe_a());
    for _ in 0..2 {
        assert!(interpreter.next(&mut world, &mut block).is_err());
        assert!(block.ops.is_empty());
    }
    assert_eq!(interpreter.modals().work_offset, 54);
}

#[test]
fn b2_a_change_between_g98_and_g99_asks_for_a_new_feed() {
    assert_eq!(run_with("G99 G1 X2 F0.1", NcSettings::lathe_a()).unwrap().len(), 1);
    assert!(refused("G98 F100\nG99 G1 X2").contains("line 2, column 8: no feed"));
    assert_eq!(lines("G98 F100\nG98 G1 X2", NcSettings::lathe_a()).len(), 1);
}

#[test]
fn k4_motion_waits_behind_m80_m00_g31_g28_and_system_writes() {
    for (text, barrier) in [
        ("M80", true),
        ("M89", true),
        ("M00", true),
        ("M01", true),
        ("M30", true),
        ("G31 X1 F1", true),
        ("G28 X1", true),
        ("#2001=1", true),
        ("M79", false),
        ("G0 X1", false),
        ("#500=1", false),
    ] {
        assert_eq!(run_with(text, NcSettings::lathe_a()).unwrap()[0].stops_look_ahead(), barrier, "{text}");
    }
}

#[test]
fn b3_m30_ends_and_nothing_follows() {
    let (mut interpreter, mut world, mut block) = start("M30\nG0 X1", NcSettings::lathe_a());
    assert_eq!(interpreter.next(&mut world, &mut block), Ok(NextStatus::Block));
    assert_eq!(interpreter.next(&mut world, &mut block), Ok(NextStatus::End));
    assert_eq!(interpreter.next(&mut world, &mut block), Ok(NextStatus::End));
}

#[test]
fn b3_modal_system_variables_are_what_is_in_force() {
    let text = "G99 G1 X2 F0.5\nM8\n#100=#4001\n#101=#4109\n#102=#4113\nN30 #1=1\n#103=#4114+#4115\n#104=#4005";
    let found: Vec<_> = run_with(text, NcSettings::lathe_a())
        .unwrap()
        .into_iter()
        .filter_map(|op| if let Op::SetVariable { value, .. } = op { value } else { None })
        .collect();
    assert_eq!(found, [1.0, 0.5, 8.0, 30.0 + 1001.0, 99.0]);
}

/// A macro saves F in #4109 and gives it back with `F#4109`: in inches it was 25.4 times as fast afterwards.
#[test]
fn b3_the_modal_feed_is_read_in_the_unit_in_which_it_is_written() {
    let text = "G20 G98\nG01 X1 F10\n#100=#4109\nF99\nF#100\nX2\n#101=#4109\nM30";
    let ops = run_with(text, NcSettings::lathe_a()).unwrap();
    let feeds: Vec<_> =
        ops.iter().filter_map(|op| if let Op::Feed { feed, .. } = op { Some(*feed) } else { None }).collect();
    let values: Vec<_> =
        ops.iter().filter_map(|op| if let Op::SetVariable { value, .. } = op { *value } else { None }).collect();
    assert_eq!((feeds, values), (vec![Feed::PerMinute(254.0); 2], vec![10.0, 10.0]));
}

#[test]
fn k5_11_g50_and_several_tools_refuse_each_other_in_both_orders() {
    assert!(refused("T0101\nG50 X1\nT0202").contains("line 3, column 1: G50 in a program with several tools"));
    assert!(refused("T0101\nT0202\nG50 X1").contains("line 3, column 1: G50 in a program with several tools"));
    assert_eq!(lines("T0101\nG50 X1\nT0100\nT0101", NcSettings::lathe_a()).len(), 4);
}

#[test]
fn l2_p5_4_zero_reverses_the_arcs() {
    let arcs = |arcs_reversed| {
        let mut settings = NcSettings::for_dialect(Dialect::SuperMan);
        settings.superman.arcs_reversed = arcs_reversed;
        let figure = "N0010G92X60Z100\nN0020G02X120Z10R50F300\nN0030G03X60Z100I0K50\nN0040M02";
        lines(figure, settings).into_iter().filter(|line| line.starts_with("arc")).collect::<Vec<_>>()
    };
    // The two circles of radius 50 through A (30, 100) and C (60, 10) have their centres at (60, 60) and (30, 50).
    let [minor, back] = &arcs(false)[..] else { panic!("two arcs") };
    assert!(minor.contains("cx=60 cz=60 turn=-1") && back.contains("cx=60 cz=60 turn=1"), "{minor}\n{back}");
    let [minor, back] = &arcs(true)[..] else { panic!("two arcs") };
    assert!(minor.contains("cx=30 cz=50 turn=1") && back.contains("cx=60 cz=60 turn=-1"), "{minor}\n{back}");
}

#[test]
fn k4_3_m35_alone_is_the_oscillation_of_the_key() {
    let settings = || NcSettings { oscillation_stroke: (Axis::Z, -160.0), ..NcSettings::lathe_a() };
    let alone = lines("M35\nM36", settings());
    assert_eq!(alone, lines("G35 Z-160\nG36", settings()));
    assert!(alone[0].starts_with("oscillation-on z=-160"), "{alone:?}");
    // With words it is G35, whatever the parameters say.
    assert_eq!(lines("M35 X-120 D200 Q10", settings()), lines("G35 X-120 D200 Q10", settings()));
    for wrong in ["M35 Q10", "M35 D200", "G35"] {
        assert!(refused(wrong).contains("X / Z"), "{wrong}");
    }
}

#[test]
fn t4_the_json_form_is_radius_mm_with_the_named_keys() {
    let ops =
        run_with("G98 G0 X20 Z0\nG03 X40 Z-10 R10 F100\nG99 G1 X2 F0.1\nG4 X1\nM3", NcSettings::lathe_a()).unwrap();
    let axes = NcSettings::lathe_a().axes;
    let found: Vec<_> = ops.iter().map(|op| op.json(axes).to_string()).collect();
    assert_eq!(
        found,
        [
            r#"{"op":"rapid","x":10.0,"z":0.0}"#,
            r#"{"cx":10.0,"cz":-10.0,"f":100.0,"op":"arc","turn":1,"x":20.0,"z":-10.0}"#,
            r#"{"f":0.1,"op":"feed","per":"rev","x":1.0,"z":-10.0}"#,
            r#"{"op":"dwell","s":1.0}"#,
            r#"{"code":3,"op":"m"}"#,
        ]
    );
}

#[test]
fn t4_the_check_measures_way_time_and_extents() {
    let library: Arc<dyn Library + Send + Sync> = Arc::new(EmptyLibrary);
    let text = "G98 G0 X20\nG1 Z-30 F60\nG02 X20 Z-30 K-5\nM30\n";
    let checked = check(
        &Arc::new(Source::new(1, "", text.as_bytes().to_vec(), Dialect::LatheA)),
        &library,
        &NcSettings::lathe_a(),
    );
    assert!(checked.faults.is_empty() && checked.finished);
    let circle = std::f64::consts::TAU * 5.0;
    assert!((checked.length_mm - (10.0 + 30.0 + circle)).abs() < 1e-9);
    assert!((checked.seconds - (0.1 + 30.0 + circle)).abs() < 1e-9);
    let (low, high) = checked.extents.unwrap();
    assert!((low[Axis::Z] + 40.0).abs() < 1e-9 && (high[Axis::X] - 15.0).abs() < 1e-9 && (low[Axis::X]).abs() < 1e-9);
    assert_eq!((checked.lines, checked.blocks), (4, 4));
}

#[test]
fn t4_the_check_leaves_a_loop_that_waits_for_the_machine() {
    let library: Arc<dyn Library + Send + Sync> = Arc::new(EmptyLibrary);
    let text = "WHILE[#1003 EQ 0]DO1\nEND1\nG0 X5 Q1\nM30\n";
    let checked = check(
        &Arc::new(Source::new(1, "", text.as_bytes().to_vec(), Dialect::LatheA)),
        &library,
        &NcSettings::lathe_a(),
    );
    assert_eq!(checked.warnings.len(), 1);
    assert!(checked.faults[0].text(Lang::En).starts_with("O0001 line 3, column 7: unknown word 'Q1'"));
}

/// Lead 4: three leads are 12 mm.
#[test]
fn l5_an_approach_below_three_leads_is_warned_of() {
    let settings = NcSettings::for_dialect(Dialect::SuperMan);
    let library: Arc<dyn Library + Send + Sync> = Arc::new(EmptyLibrary);
    let warnings = |rpm: u32, z: f64| {
        let text = format!("N0010G92X40Z{z}\nN0020M03S{rpm}\nN0025G01U-1F300\nN0030G33W-50F4\nN0040M05\nN0050M02");
        let checked = check(&Arc::new(Source::new(1, "", text.into_bytes(), Dialect::SuperMan)), &library, &settings);
        assert!(checked.faults.is_empty() && checked.finished, "{:?}", checked.faults);
        checked.warnings.iter().map(|warning| warning.text(Lang::En)).collect::<Vec<_>>()
    };
    for (rpm, z) in [(200, 12.0), (220, 12.0), (20, 12.1)] {
        assert!(warnings(rpm, z).is_empty(), "{rpm} {z}: {:?}", warnings(rpm, z));
    }
    for (rpm, z) in [(220, 11.9), (200, 6.0), (20, 1.0), (220, 0.3)] {
        assert!(matches!(&warnings(rpm, z)[..], [one] if one.contains("less than three leads")), "{rpm} {z}");
    }
}

#[test]
fn k4_3_the_check_goes_through_waits_for_the_ends_of_a_stroke() {
    let library: Arc<dyn Library + Send + Sync> = Arc::new(EmptyLibrary);
    let text = "G98\nG35 Z-10 Q10\n#1=0\nWHILE[#1 LT 3]DO1\nN10 IF[#438 EQ 0]GOTO 10\nG01 U-1 F60\n\
                N20 IF[#439 EQ 0]GOTO 20\n#1=#1+1\nEND1\nG36\nM30\n";
    let checked = check(
        &Arc::new(Source::new(1, "", text.as_bytes().to_vec(), Dialect::LatheA)),
        &library,
        &NcSettings::lathe_a(),
    );
    assert!(checked.faults.is_empty() && checked.warnings.is_empty() && checked.finished);
    // Three infeeds of 1 mm of diameter.
    assert!((checked.length_mm - 1.5).abs() < 1e-9, "{}", checked.length_mm);
}

#[test]
fn k7_9_switches_refuse_other_values_from_a_program_too() {
    assert!(refused("#575=2").contains("variable #575 must be 0 or 1"));
    assert_eq!(lines("#575=1\n#575=0", NcSettings::lathe_a()).len(), 2);
}

#[test]
fn b3_a_sign_binds_weaker_than_a_power() {
    let text = "#100=-2**2\n#101=2**-1\n#102=[-2]**2\n#103=3--2\n#1=4\n#104=-#1**0.5*2";
    let values = ["-4", "0.5", "4", "5", "-4"];
    for ((line, value), variable) in lines(text, NcSettings::lathe_a()).iter().zip(values).zip(100..) {
        assert_eq!(*line, format!("set variable={variable} value={value}"));
    }
}

#[test]
fn b3_comments_may_stand_before_numbers_and_statements() {
    let text =
        "#1=0\n(ROUGH) N10 WHILE[#1 LT 2]DO1\n #1=#1+1 (STEP)\n/(X) END1\nIF[#1 EQ 2]GOTO 20\nG0 X9\n (LAST) N20 M30";
    assert_eq!(lines(text, NcSettings::lathe_a()), ["m code=30"]);
}

#[test]
fn b3_g66_is_not_lost_where_a_move_and_a_call_share_a_block() {
    let library: Arc<dyn Library + Send + Sync> = Arc::new(Twice);
    let source =
        Arc::new(Source::new(1, "", "G66 P9000\nG0 X1 M98 P9000\nG67\nM30\n".as_bytes().to_vec(), Dialect::LatheA));
    let checked = check(&source, &library, &NcSettings::lathe_a());
    assert!(checked.faults[0].text(Lang::En).starts_with("O0001 line 2, column 11: G66 and M cannot be in one block"));
}

#[test]
fn b1_a_block_of_more_than_4096_bytes_is_refused_and_does_not_hold_up_the_tick() {
    let long = |length: usize| format!("G0 X2\r\n({})\r\nX4\r\n", "c".repeat(length - 4));
    for length in 4_080..4_092 {
        assert_eq!(lines(&long(length), NcSettings::lathe_a()).len(), 2, "{length}");
    }
    for length in [4_100, 100_000] {
        assert!(refused(&long(length)).contains("line 2, column 1: the block is too long"), "{length}");
    }
    let endless = format!("G0 X2\n#100=1{}\nX4", "+1".repeat(1_000_000));
    assert!(refused(&endless).contains("line 2, column 1"));
}

struct Twice;

impl Library for Twice {
    fn find(&self, number: u32) -> Option<Arc<Source>> {
        Some(Arc::new(Source::new(number, "", "M99\n".as_bytes().to_vec(), Dialect::LatheA)))
    }
}

#[test]
fn b2_a_distance_cannot_lead_past_the_greatest_coordinate() {
    assert!(refused("G0 Z99999\nW5").contains("line 2, column 1: W5 is out of range"));
}

#[test]
fn b2_inch_words_become_millimetres() {
    let ops = run_with("G20 G98 G1 X2 Z-1 F1", NcSettings::lathe_a()).unwrap();
    let Some(Op::Feed { to, feed, .. }) = ops.first() else { panic!("{ops:?}") };
    assert!((to[Axis::X] - 25.4).abs() < 1e-12 && (to[Axis::Z] + 25.4).abs() < 1e-12);
    assert_eq!(*feed, Feed::PerMinute(25.4));
}

/// A text in brackets is one text, whatever stands in it.
#[test]
fn b3_a_line_full_of_messages_is_loaded_at_once() {
    let text = format!("M30\n{})", "#3000(".repeat(200_000));
    assert_eq!(lines(&text, NcSettings::lathe_a()), ["m code=30"]);
}

#[test]
fn b1_a_fault_names_program_line_column_cause_and_remedy_in_both_languages() {
    let source = Arc::new(Source::new(1_001, "O1001.NC", "\nO1001\n\n\n\n\nG0 X1 Z2  Q9\nM30", Dialect::LatheA));
    let library: Arc<dyn Library + Send + Sync> = Arc::new(EmptyLibrary);
    let checked = check(&source, &library, &NcSettings::lathe_a());
    let fault = &checked.faults[0];
    let [en, zh] = [fault.text(Lang::En), fault.text(Lang::Zh)];
    assert!(en.starts_with("O1001 line 7, column 11: ") && en.contains("'Q9' – "), "{en}");
    assert!(zh.starts_with("O1001 第7行 第11列：") && zh.contains("'Q9' – "), "{zh}");
    assert_eq!(fault.alarm(), 1);
}

/// A block with a mistake is left out: what it may have set is missing behind it, and is no second mistake.
#[test]
fn b1_mistakes_that_follow_from_a_block_left_out_are_warnings() {
    type Rows = Vec<(u32, &'static str)>;
    let found = |text: &str| -> (Rows, Rows) {
        let source = Arc::new(Source::new(1001, "", text.as_bytes().to_vec(), Dialect::LatheA));
        let library: Arc<dyn Library + Send + Sync> = Arc::new(EmptyLibrary);
        let report = check(&source, &library, &NcSettings::lathe_a());
        let names = |list: &[ProgramFault]| list.iter().map(|fault| (fault.location.line, fault.error.id())).collect();
        (names(&report.faults), names(&report.warnings))
    };
    let of = |faults: &[(u32, &'static str)], warnings: &[(u32, &'static str)]| (faults.to_vec(), warnings.to_vec());
    // The F of a refused block.
    assert_eq!(found("\"A\" D1 F200\nG01 X20\nM30"), of(&[(1, "unexpected-character")], &[(2, "feed-missing")]));
    assert_eq!(found("\"A\" D1 (F200)\nG01 X20\nM30").0, [(1, "unexpected-character"), (2, "feed-missing")]);
    assert_eq!(found("IF[#1 FF 2]X9\nG01 X20\nM30").0.len(), 2, "a name is no word");
    // A refused block without it explains nothing, and the mistake itself stays one.
    assert_eq!(found("M777\nG01 X20\nM30").0, [(1, "unknown-m"), (2, "feed-missing")]);
}
