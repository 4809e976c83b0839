//! The 超人 lathe by hand and before the first chip: teach-in, steps of a fixed length, names of programs, interference
//! told by the check run, tools as they are defined.

use std::path::Path;
use std::sync::Arc;

use crate::stories::{rig_of, tell};
use kt830::defs::kind::{Dialect, Kind};
use kt830::defs::page::Page;
use kt830::defs::param::ParamAddress;
use kt830::defs::program_number::from_name;
use kt830::host::folders::{Folders, program_from_bytes};
use kt830::host::headless::HeadlessHost;
use kt830::link::Command;
use kt830::link::files::{FileRequest, Requester, Ticket};
use kt830::link::page_command::PageCommand;
use kt830::link::teach::{TaughtBlock, block_text};
use kt830::link::toolpath::Toolpath;
use kt830::units::Axis;

fn screens() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("screens")
}

/// A ready lathe whose programs lie in a folder of their own.
fn lathe(folder: &Path) -> HeadlessHost {
    let mut rig = rig_of(
        Kind::Lathe,
        Folders { programs: folder.to_owned(), screens: screens(), by_name: true, dialect: Dialect::SuperMan },
    );
    rig.make_ready();
    rig.step();
    rig
}

/// The blocks of a recording as its program has them.
fn texts(blocks: &[TaughtBlock]) -> Vec<String> {
    blocks.iter().enumerate().map(|(index, block)| block_text(index, block)).collect()
}

#[test]
fn l9_what_is_moved_by_hand_becomes_a_program_that_does_it_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut rig = lathe(folder.path());
    // P395: steps of 5 mm; two along Z are one block, then one on X (a diameter), spindle and coolant between.
    tell(&mut rig, "mode step\nparam P395 5\nteach start\nkey z-minus\nwait 1 s\nkey z-minus\nwait 1 s");
    tell(&mut rig, "key spindle-forward\nwait 3 s\nkey coolant\nwait 0.5 s\nkey x-plus\nwait 1 s\nteach stop");
    let (x, z) = (rig.snapshot().axes[Axis::X].work, rig.snapshot().axes[Axis::Z].work);
    let blocks = texts(&rig.snapshot().teach.blocks);
    let words: Vec<&str> = blocks.iter().map(|block| block.split('F').next().unwrap()).collect();
    let begun = format!("N0010G92X{}Z{}", x - 5.0, z + 10.0);
    let (along, out) = (format!("N0020G01Z{z}"), format!("N0050G01X{x}"));
    assert_eq!(words, [begun.as_str(), along.as_str(), "N0030M03", "N0040M07", out.as_str()]);
    // F within what a line takes (L2), and it is kept under the first free name.
    let feeds = blocks.iter().filter_map(|block| block.split_once('F')).map(|(_, feed)| feed.parse::<f64>().unwrap());
    assert!(feeds.into_iter().all(|feed| (6.0..=2_000.0).contains(&feed)));
    tell(
        &mut rig,
        "teach keep\nexpect message \"密码\"\nparam P22.5 0\nteach keep\nwait 0.5 s\nexpect message \"TEACH01\"",
    );
    let text = std::fs::read_to_string(folder.path().join("TEACH01.NC")).unwrap();
    assert_eq!(text.lines().collect::<Vec<_>>(), [&blocks[..], &["N0060M02".to_owned()]].concat());
    // From here it goes the same way once more: the slides move by as much.
    let before = rig.controller().set_point();
    tell(&mut rig, "load TEACH01\nmode auto\nkey cycle-start\nwait until idle max 60 s\nexpect no alarm");
    let after = rig.controller().set_point();
    assert!((after[Axis::Z] - before[Axis::Z] + 10.0).abs() < 1e-6, "{before:?} {after:?}");
    assert!((after[Axis::X] - before[Axis::X] - 2.5).abs() < 1e-6, "{before:?} {after:?}");
}

#[test]
fn l9_a_turn_back_a_jog_at_rapid_and_homing_are_blocks_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let mut rig = lathe(folder.path());
    tell(
        &mut rig,
        "teach start\nmode jog\nhold Z- 1 s\nwait 1 s\nhold Z+ 0.5 s\nwait 1 s\nkey rapid\nhold X- 0.3 s\nwait 1 s",
    );
    tell(&mut rig, "key rapid\nmode home\nkey z-plus\nwait until idle max 200 s\nwait 1 s\nteach undo\nteach stop");
    let blocks = texts(&rig.snapshot().teach.blocks);
    let codes: Vec<String> = blocks.iter().map(|block| block[5..9].to_owned()).collect();
    assert_eq!(codes, ["G92X", "G01Z", "G01Z", "G00X"], "{blocks:?}: undo has taken G39 back");
    assert!(blocks[1].contains('F') && !blocks[3].contains('F'));
}

#[test]
fn l9_teach_in_is_refused_in_a_run_and_where_there_is_nothing_and_on_a_grinder() {
    let folder = tempfile::tempdir().unwrap();
    let mut rig = lathe(folder.path());
    tell(&mut rig, "teach keep\nexpect message \"没有录返记录\"\nteach stop\nexpect message \"没有录返记录\"");
    rig.add_program(program_from_bytes(
        from_name("LONG"),
        "LONG.NC",
        b"N0010G04F5\r\nN0020M02".to_vec(),
        rig.kind().dialect(),
    ));
    tell(&mut rig, "load LONG\nmode auto\nkey cycle-start\nwait 1 s\nteach start\nexpect message \"不能录返\"");
    let mut rig = crate::stories::ready();
    tell(&mut rig, "teach start\nexpect message \"没有录返功能\"\npage teach\nexpect message \"本机床没有\"");
    assert_eq!(rig.snapshot().page, Page::Position);
}

#[test]
fn l9_a_program_with_a_name_is_edited_copied_and_deleted() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("PIN.NC"), "N0010G04F1\r\nN0020M02\r\n").unwrap();
    let mut rig = lathe(folder.path());
    let ask = |rig: &mut HeadlessHost, request: FileRequest| {
        rig.send(Command::Page(PageCommand::File(Ticket::without_reply(Requester::Directory), request)));
        (0..5).for_each(|_| rig.step());
    };
    tell(&mut rig, "load PIN\nmode edit\nparam P22.5 0");
    let (of, base) = (rig.snapshot().program.number, rig.snapshot().program.stamp);
    assert_eq!(of, from_name("PIN"));
    let text = ropey::Rope::from_str("N0010G04F2\r\nN0020M02\r\n");
    ask(&mut rig, FileRequest::Save { number: of, text, base_stamp: base, overwrite: false });
    tell(&mut rig, "expect message \"PIN 已保存\"");
    assert!(std::fs::read_to_string(folder.path().join("PIN.NC")).unwrap().starts_with("N0010G04F2"));
    // Somebody else has changed it meanwhile: the stamp is an old one.
    let text = ropey::Rope::from_str("N0010M02\r\n");
    ask(&mut rig, FileRequest::Save { number: of, text, base_stamp: base, overwrite: false });
    tell(&mut rig, "expect message \"文件已被别处改动\"");
    ask(&mut rig, FileRequest::Copy { from: of, to: 5 });
    assert!(folder.path().join("O0005.NC").is_file());
    ask(&mut rig, FileRequest::New(6));
    assert_eq!(std::fs::read_to_string(folder.path().join("O0006.NC")).unwrap(), "N0010M02\r\n");
    ask(&mut rig, FileRequest::Delete(of));
    assert!(!folder.path().join("PIN.NC").exists());
}

/// The drawing of a program on a bar of 45 mm with its face at X0 Z0.
fn drawn(text: &str, params: &[(&str, f64)]) -> Arc<Toolpath> {
    let folder = tempfile::tempdir().unwrap();
    let mut rig = lathe(folder.path());
    rig.add_program(program_from_bytes(from_name("PART"), "PART.NC", text.as_bytes().to_vec(), rig.kind().dialect()));
    for (at, value) in [("P384", 45.0)].iter().chain(params) {
        rig.send(Command::SetParam(ParamAddress::parse(at).unwrap(), *value));
    }
    tell(&mut rig, "load PART");
    rig.send(Command::Page(PageCommand::File(
        Ticket::without_reply(Requester::Graphic),
        FileRequest::ComputeToolpath(from_name("PART")),
    )));
    (0..5).for_each(|_| rig.step());
    rig.snapshot().files.toolpath.clone().unwrap()
}

#[test]
fn l9_interference_is_told_before_anything_moves() {
    let into = |blocks: &str, params: &[(&str, f64)]| {
        let drawing = drawn(&format!("N0010G92X60Z20\n{blocks}\nN0090M02"), params);
        let told: Vec<(u32, String)> = drawing
            .faults
            .iter()
            .map(|fault| (fault.line, fault.message.en().split(',').next().unwrap().to_owned()))
            .collect();
        assert_eq!(drawing.crashes.len(), drawing.faults.len());
        told
    };
    let told = |line: u32, what: &str| vec![(line, format!("interference: {what}"))];
    // The same four as in the run (tests/lathe.rs), by their lines.
    assert_eq!(into("N0020M03\nN0030G00X40\nN0040Z-30", &[]), told(4, "part"));
    assert_eq!(into("N0030G01X40F300\nN0040Z-30", &[]), told(3, "part"));
    assert_eq!(into("N0020M03\nN0030G01Z-125F2000", &[]), told(3, "chuck"));
    // What is cut at feed with the spindle on is none.
    assert_eq!(into("N0020M03\nN0030G01X40F300\nN0040Z-30\nN0050X50", &[]), []);
    // 5 mm deep: the turning tool's edge of 8 mm reaches, an edge of 3 mm does not (P410: edge of tool 1).
    let deep = "N0020M03\nN0030G01X35F300\nN0040Z-30\nN0050X50";
    assert_eq!(into(deep, &[]), []);
    assert_eq!(into(deep, &[("P402", 3.0)]), told(4, "part"));
}

/// Homing by the switches moves the axes at rapid: it is drawn, and out of a groove it crashes.
#[test]
fn l6_l9_homing_is_drawn_and_told_as_interference() {
    let homes = |blocks: &str| drawn(&format!("N0010G92X60Z20\nN0020M03\n{blocks}\nN0090M02"), &[("P402", 3.0)]);
    let free = homes("N0030G01X50Z-10F300\nN0040G36");
    assert_eq!((free.faults.len(), free.crashes.len()), (0, 0), "{:?}", free.faults);
    let still = homes("N0030G01X50Z-10F300");
    let points = |drawing: &Toolpath| drawing.levels[0].points.len();
    assert_eq!(points(&free), points(&still) + 2, "X, then Z");
    let groove = homes("N0030G01Z-10F300\nN0040X42F50\nN0050G39");
    let lines: Vec<u32> = groove.faults.iter().map(|fault| fault.line).collect();
    assert_eq!((lines, groove.crashes.len()), (vec![5], 1), "{:?}", groove.faults);
}

#[test]
fn l9_a_tool_as_it_is_defined_crashes_in_the_run_as_in_the_drawing() {
    let folder = tempfile::tempdir().unwrap();
    let mut rig = lathe(folder.path());
    let text = b"N0010G92X60Z20\nN0020M03\nN0030G01X35F300\nN0040Z-30\nN0050M02".to_vec();
    rig.add_program(program_from_bytes(from_name("PART"), "PART.NC", text, rig.kind().dialect()));
    tell(&mut rig, "param P384 45\nparam P402 3");
    let bar = rig.bar_of_program(from_name("PART")).unwrap();
    rig.mount_part(&bar);
    rig.make_ready();
    rig.mount_part(&bar);
    rig.step();
    tell(&mut rig, "load PART\nmode auto\nkey cycle-start\nwait until alarm max 120 s\nexpect event crash");
    assert_eq!(rig.machine().events()[0].place, "part, tool shank");
}
