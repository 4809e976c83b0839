//! Several programs in one file, as USB and RS232 exports write them: listed, called, edited, imported (rows B1, B6,
//! K7.8).

use std::path::Path;
use std::sync::Arc;

use kt830::controller::files::BackgroundJob;
use kt830::controller::{PowerOnState, Programs, nc_settings};
use kt830::defs::kind::Kind;
use kt830::host::folders::Folders;
use kt830::host::job_runner::JobRunner;
use kt830::link::files::{FileAnswer, FileRequest, Refusal, Requester, Ticket};
use kt830::link::media::{Direction, TransferRequest, TransferSet};
use kt830::nc::Library;
use ropey::Rope;
use tempfile::TempDir;

use crate::command::kt830_in;

/// O0031 calls O0032, which calls O0033; all in O0031.NC. O0040 has a file of its own and calls O0033.
const EXPORT: &str = "%\r\nO0031 (MAIN)\r\nG00 X-50\r\nM98 P0032\r\nM30\r\nO0032 (SECOND)\r\nG00 X-40\r\nM98 P33\r\nM99\r\n:0033\r\n#500=#500+1\r\nM99\r\n%\r\n";

struct Shop {
    files: TempDir,
    runner: JobRunner,
    folders: Folders,
    /// P23.5 asks for the password, and it was not entered.
    subprograms_locked: bool,
}

impl Shop {
    /// A control whose program folder holds these files, and a USB drive.
    fn new(programs: &[(&str, &str)]) -> Self {
        let files = tempfile::tempdir().unwrap();
        let [own, screens, drive] = ["programs", "screens", "stick"].map(|name| files.path().join(name));
        for folder in [&own, &screens, &drive] {
            std::fs::create_dir(folder).unwrap();
        }
        for (name, text) in programs {
            std::fs::write(own.join(name), text).unwrap();
        }
        let folders = Folders { programs: own, screens, by_name: false, dialect: Kind::Gc.dialect() };
        let runner = JobRunner::new(folders.clone()).with_drives(None, Some(drive));
        Self { files, runner, folders, subprograms_locked: false }
    }

    fn programs(&self) -> Programs {
        self.folders.read_programs().unwrap().0
    }

    /// Number, name and comment of the directory rows.
    fn directory(&self) -> Vec<(u32, String, String)> {
        let rows = self.folders.read_programs().unwrap().1;
        rows.into_iter().map(|row| (row.number, row.name, row.comment)).collect()
    }

    fn text(&self, file: &str) -> String {
        std::fs::read_to_string(self.folders.programs.join(file)).unwrap()
    }

    fn ask(&self, request: FileRequest) -> FileAnswer {
        let job = BackgroundJob {
            ticket: Ticket::without_reply(Requester::Transfer),
            request,
            settings: nc_settings(Kind::Gc, &PowerOnState::factory(Kind::Gc).params),
            programs: Arc::new(self.programs()),
            subprograms_locked: self.subprograms_locked,
            transfer_values: None,
            start: None,
            date: None,
        };
        let mut last = None;
        self.runner.run(&job, &mut |answer| last = Some(answer));
        last.unwrap()
    }

    fn save(&self, number: u32, text: &str) -> FileAnswer {
        let base_stamp = self.programs().get(number).unwrap().stamp;
        self.ask(FileRequest::Save { number, text: Rope::from_str(text), base_stamp, overwrite: false })
    }

    fn import(&self, split: Option<bool>) -> FileAnswer {
        self.ask(FileRequest::Transfer(TransferRequest {
            set: TransferSet::Programs,
            direction: Direction::Import,
            names: Vec::new(),
            overwrite: None,
            convert: None,
            split,
        }))
    }

    fn run(&self, words: &[&str]) -> (Option<i32>, String) {
        let folder = self.folders.programs.display().to_string();
        let all = [words, &["--lang", "en", "--programs", &folder]].concat();
        let out = kt830_in(Path::new(&folder), self.files.path(), &all);
        let told = [out.stdout, out.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        (out.status.code(), told.concat())
    }
}

#[test]
fn b1_all_programs_of_a_file_are_listed_and_called() {
    let shop = Shop::new(&[("O0031.NC", EXPORT), ("O0040.NC", "O0040\nM98 P33\nM30\n")]);
    let rows: Vec<_> = shop.directory();
    let told: Vec<_> = rows.iter().map(|(number, name, comment)| (*number, name.as_str(), comment.as_str())).collect();
    assert_eq!(told, [(31, "O0031", "MAIN"), (32, "O0032", "SECOND"), (33, "O0033", ""), (40, "O0040", "")]);
    // The first one ends where the second begins.
    assert!(!String::from_utf8_lossy(shop.programs().find(31).unwrap().bytes()).contains("O0032"));
    for program in ["O0031", "O0040"] {
        let (status, told) = shop.run(&["run", program, "--set", "#500=6"]);
        assert_eq!(status, Some(0), "{program}: {told}");
        assert!(told.contains("#500 = 7"), "{program}: {told}");
    }
}

/// An export has a name: its first program is called by its number as the others are.
#[test]
fn b1_all_programs_of_a_file_with_a_name_have_their_numbers() {
    let export = "%\n(FROM THE OLD CONTROL)\nO0031\nG00 U-1.\n#500=#500+1\nM99\nO0032\nM98 P31\nM30\n%\n";
    for name in ["EXPORT.MPF", "EXPORT.NC"] {
        let shop = Shop::new(&[(name, export), ("O0040.NC", "O0040\nM98 P32\nM30\n")]);
        let rows: Vec<_> = shop.directory().into_iter().map(|(number, name, _)| (number, name)).collect();
        assert_eq!(rows, [31, 32, 40].map(|number| (number, format!("O00{number}"))));
        for program in ["O0032", "O0040"] {
            let (status, told) = shop.run(&["run", program, "--set", "#500=6"]);
            assert!(status == Some(0) && told.contains("#500 = 7"), "{program}: {told}");
        }
        // From a stick, under a name that is none for the folder, and as a file of the folder.
        let stick = shop.files.path().join("stick/ALL PROGRAMS.TXT");
        std::fs::write(&stick, export).unwrap();
        for file in [shop.folders.programs.join(name), stick] {
            let (status, told) = shop.run(&["check", &file.display().to_string()]);
            assert_eq!(status, Some(0), "{told}");
        }
        // It is edited in its place.
        let text = "%\n(FROM THE OLD CONTROL)\nO0031\nG00 U-2.\nM99\n";
        assert!(matches!(shop.save(31, text), FileAnswer::Saved { .. }));
        assert_eq!(shop.text(name), format!("{text}O0032\nM98 P31\nM30\n%\n"));
    }
    // The only program of such a file has its number, too.
    let shop = Shop::new(&[("SHAFT.NC", "O0600 (SHAFT)\n#500=#500+1\nM99\n"), ("O0500.NC", "M98 P600\nM30\n")]);
    let rows: Vec<_> = shop.directory().into_iter().map(|(number, name, _)| (number, name)).collect();
    assert_eq!(rows, [(500, "O0500".to_owned()), (600, "O0600".to_owned())]);
    let (status, told) = shop.run(&["run", "O0500", "--set", "#500=6"]);
    assert!(status == Some(0) && told.contains("#500 = 7"), "{told}");
    assert!(matches!(shop.save(600, "O0600\nM99\n"), FileAnswer::Saved { .. }));
    assert_eq!(shop.text("SHAFT.NC"), "O0600\nM99\n");
    let shop = Shop::new(&[("SHAFT.NC", "O0600\nM99\n"), ("O0600.NC", "M99\n"), ("O0500.NC", "M98 P600\nM30\n")]);
    let (status, told) = shop.run(&["run", "O0500"]);
    assert!(status == Some(1) && told.contains("O0600 exists twice: O0600.NC:1, SHAFT.NC:1"), "{told}");
    // A number that is there twice is an error with both places, as a warning of the directory and in a check.
    let shop = Shop::new(&[("ALL.MPF", "O0031\nM30\nO0032\nM99\nO0031\nM98 P32\nM30\n")]);
    let file = shop.folders.programs.join("ALL.MPF").display().to_string();
    let (status, told) = shop.run(&["check", &file]);
    assert!(status == Some(2) && told.contains("ALL.MPF:1, ALL.MPF:5"), "{told}");
    // It does not start, from its file or from the folder.
    for program in [&file, "O0031"] {
        let (status, told) = shop.run(&["run", program]);
        assert!(status == Some(1) && told.contains("O0031 exists twice: ALL.MPF:1, ALL.MPF:5"), "{program}: {told}");
    }
    assert!(shop.directory()[0].2.contains("ALL.MPF:1, ALL.MPF:5"), "{:?}", shop.directory());
}

/// A run of a file obeys what the folder says of its numbers.
#[test]
fn b1_a_number_that_exists_twice_is_not_called_by_a_run_of_its_file() {
    let two = "O0031\nM98 P32\nM30\nO0032\n#500=1\nM99\n";
    let shop = Shop::new(&[("O0031.NC", two), ("O0032.NC", "O0032\n#500=2\nM99\n")]);
    let file = shop.folders.programs.join("O0031.NC").display().to_string();
    for words in [["check", &file], ["run", &file], ["run", "O0031"]] {
        let (status, told) = shop.run(&words);
        assert!(status != Some(0) && told.contains("exists twice"), "{words:?}: {told}");
    }
}

#[test]
fn b1_program_numbers_of_up_to_eight_digits_are_called_by_parameter() {
    let main = "O12345678\nM98 P50010\nM98 P50010 L2\nG65 P12345679 A3\nM30\nO50010\n#500=#500+1\nM99\n";
    let shop = Shop::new(&[
        ("O12345678.NC", main),
        ("O0010.NC", "O0010\n#501=#501+1\nM99\n"),
        ("O12345679.NC", "#502=#1+#4115\nM99\n"),
    ]);
    let listed: Vec<_> = shop.directory().into_iter().map(|(number, name, _)| (number, name)).collect();
    let own = |number: u32, name: &str| (number, name.to_owned());
    let all = [own(10, "O0010"), own(50_010, "O50010"), own(12_345_678, "O12345678"), own(12_345_679, "O12345679")];
    assert_eq!(listed, all);
    // Eight digits are all of P; L repeats.
    let called = ["run", "12345678", "--param", "P418=8", "--set", "#500=0", "--set", "#501=0"];
    let (status, told) = shop.run(&called);
    assert_eq!(status, Some(0), "{told}");
    assert!(!told.contains("#501"), "{told}");
    for value in ["#500 = 3", "#502 = 12345682"] {
        assert!(told.contains(value), "{value}: {told}");
    }
    // Four digits: `P50010` calls O0010 five times; L and G65 take no more than four.
    let (status, told) = shop.run(&["check", "O12345678.NC"]);
    assert_eq!(status, Some(2), "{told}");
    assert!(told.contains(":3:5: P50010 is out of range 1–9999") && told.contains(":4:5: P12345679 is"), "{told}");
    let five = Shop::new(&[("O0001.NC", "M98 P50010\nM30\n"), ("O0010.NC", "#501=#501+1\nM99\n")]);
    let (_, told) = five.run(&["run", "O0001", "--set", "#501=0"]);
    assert!(told.contains("#501 = 5"), "{told}");
    // Six digits: the two before them repeat.
    let (_, told) = five.run(&["check", "O0001.NC", "--param", "P418=6"]);
    assert!(told.contains("O50010"), "{told}");
}

#[test]
fn b6_a_new_program_has_a_number_that_can_be_called() {
    let shop = Shop::new(&[]);
    assert!(matches!(shop.ask(FileRequest::New(12_345_678)), FileAnswer::Saved { .. } | FileAnswer::Done(_)));
    assert_eq!(shop.directory()[0].1, "O12345678");
    assert!(shop.text("O12345678.NC").starts_with("O12345678"));
    assert!(matches!(shop.ask(FileRequest::New(100_000_000)), FileAnswer::Refused(_)));
}

#[test]
fn b1_a_mistake_in_a_later_program_names_the_line_of_the_file() {
    let shop = Shop::new(&[("O0031.NC", &EXPORT.replace("G00 X-40", "G00 X-40 X-41"))]);
    let (status, told) = shop.run(&["check", "O0031.NC"]);
    assert_eq!(status, Some(2));
    assert!(told.starts_with("O0031.NC:7:10: O0032: 'X' appears twice"), "{told}");
    assert!(told.contains("← O0031.NC:4"), "{told}");
    // Nobody calls it, and it is checked nevertheless.
    let shop = Shop::new(&[("O0050.NC", "O0050\nM30\nO0051\nG37\nM99\n")]);
    let (status, told) = shop.run(&["check", "O0050.NC"]);
    assert_eq!((status, told.starts_with("O0050.NC:4:1: O0051: unknown code G37")), (Some(2), true), "{told}");
}

#[test]
fn b8_a_number_that_two_programs_have_is_an_error_with_both_places_and_is_not_called() {
    let shop = Shop::new(&[("O0031.NC", EXPORT), ("O0032.NC", "O0032\nM99\n")]);
    let (status, told) = shop.run(&["check", "O0031.NC"]);
    assert_eq!(status, Some(2));
    assert!(told.starts_with("O0031.NC:6:1: program O0032 exists twice: O0032.NC:1, O0031.NC:6"), "{told}");
    let marked = shop.directory().into_iter().find(|row| row.0 == 32).unwrap();
    assert_eq!(marked.2, "重号 O0032.NC:1, O0031.NC:6");
    let (status, told) = shop.run(&["run", "O0031"]);
    assert_eq!(status, Some(1), "{told}");
    assert!(told.contains("program O0032 exists twice"), "{told}");
    // Twice in one file.
    let shop = Shop::new(&[("O0050.NC", "O0050\nM30\nO0051\nM99\nO0051\nM99\n")]);
    let (status, told) = shop.run(&["check", "O0050.NC"]);
    assert_eq!(status, Some(2));
    assert!(told.starts_with("O0050.NC:5:1: program O0051 exists twice: O0050.NC:3, O0050.NC:5"), "{told}");
    // The place of the first one is that of its number, behind `%` and comments.
    let shop = Shop::new(&[("O0031.NC", "%\n(EXPORT)\nO0031\nM30\nO0032\nM30\nO0031\nM30\n%\n")]);
    let (_, told) = shop.run(&["check", "O0031.NC"]);
    assert!(told.starts_with("O0031.NC:7:1: program O0031 exists twice: O0031.NC:3, O0031.NC:7"), "{told}");
}

#[test]
fn b6_a_later_program_is_edited_in_its_place() {
    let shop = Shop::new(&[("O0031.NC", EXPORT)]);
    let answer = shop.save(32, "O0032 (SECOND)\r\nG00 X-45\r\nM99\r\n");
    assert!(matches!(answer, FileAnswer::Saved { number: 32, .. }), "{answer:?}");
    assert_eq!(shop.text("O0031.NC"), EXPORT.replace("G00 X-40\r\nM98 P33\r\n", "G00 X-45\r\n"));
    // The first one, too; a text without a line end at its end is closed.
    shop.save(31, "O0031\r\nM30");
    assert!(shop.text("O0031.NC").starts_with("O0031\r\nM30\r\nO0032 (SECOND)\r\n"), "{}", shop.text("O0031.NC"));
    // Without its number it would run on from the program before: it gets the number again.
    shop.save(33, "M99\r\n");
    assert!(shop.text("O0031.NC").ends_with("M99\r\nO0033\r\nM99\r\n"), "{}", shop.text("O0031.NC"));
    assert_eq!(shop.directory().len(), 3);
}

#[test]
fn b6_a_change_from_outside_is_a_conflict_only_in_the_same_program() {
    let shop = Shop::new(&[("O0031.NC", EXPORT)]);
    let base_stamp = shop.programs().get(32).unwrap().stamp;
    let save =
        |overwrite| FileRequest::Save { number: 32, text: Rope::from_str("O0032\r\nM99\r\n"), base_stamp, overwrite };
    std::fs::write(shop.folders.programs.join("O0031.NC"), EXPORT.replace("X-40", "X-44")).unwrap();
    assert!(matches!(shop.ask(save(false)), FileAnswer::Refused(Refusal::Conflict)));
    // Another program of the file was changed: no conflict.
    std::fs::write(shop.folders.programs.join("O0031.NC"), EXPORT.replace("X-50", "X-55")).unwrap();
    assert!(matches!(shop.ask(save(false)), FileAnswer::Saved { .. }));
    assert!(shop.text("O0031.NC").contains("G00 X-55") && !shop.text("O0031.NC").contains("X-40"));
}

/// A character that GBK lacks makes the whole file UTF-8, not a part of it.
#[test]
fn b1_a_file_has_one_encoding() {
    let shop = Shop::new(&[]);
    let (gbk, _, _) = encoding_rs::GBK.encode("O0031 (磨削外圆)\r\nM30\r\nO0032 (修整砂轮)\r\nM99\r\n");
    std::fs::write(shop.folders.programs.join("O0031.NC"), &gbk).unwrap();
    shop.save(32, "O0032 (修整)\r\nM99\r\n");
    let kept = std::fs::read(shop.folders.programs.join("O0031.NC")).unwrap();
    assert_eq!(kept, encoding_rs::GBK.encode("O0031 (磨削外圆)\r\nM30\r\nO0032 (修整)\r\nM99\r\n").0.into_owned());
    shop.save(32, "O0032 (🙂)\r\nM99\r\n");
    assert_eq!(shop.text("O0031.NC"), "O0031 (磨削外圆)\r\nM30\r\nO0032 (🙂)\r\nM99\r\n");
}

#[test]
fn b6_programs_of_a_file_are_copied_renamed_and_deleted_one_by_one() {
    let shop = Shop::new(&[("O0031.NC", EXPORT)]);
    shop.ask(FileRequest::Copy { from: 32, to: 50 });
    assert_eq!(shop.text("O0050.NC"), "O0032 (SECOND)\r\nG00 X-40\r\nM98 P33\r\nM99\r\n");
    shop.ask(FileRequest::Rename { from: 32, to: 60 });
    assert!(shop.text("O0031.NC").contains("O0060 (SECOND)\r\n"));
    // A number in use is refused, in a file of its own or in another file.
    for to in [33, 50] {
        assert!(matches!(shop.ask(FileRequest::Copy { from: 31, to }), FileAnswer::Refused(_)), "{to}");
        assert!(matches!(shop.ask(FileRequest::Rename { from: 60, to }), FileAnswer::Refused(_)), "{to}");
    }
    assert!(matches!(shop.ask(FileRequest::New(33)), FileAnswer::Refused(_)));
    shop.ask(FileRequest::Delete(60));
    assert_eq!(
        shop.text("O0031.NC"),
        "%\r\nO0031 (MAIN)\r\nG00 X-50\r\nM98 P0032\r\nM30\r\n:0033\r\n#500=#500+1\r\nM99\r\n%\r\n"
    );
    // The first one goes: the file gets the number of the next.
    shop.ask(FileRequest::Delete(31));
    assert_eq!(shop.text("O0033.NC"), ":0033\r\n#500=#500+1\r\nM99\r\n%\r\n");
    assert_eq!(shop.directory().iter().map(|row| row.0).collect::<Vec<_>>(), [33, 50]);
}

#[test]
fn k7_8_import_asks_whether_to_divide_a_file_with_several_programs() {
    let shop = Shop::new(&[]);
    let stick = shop.files.path().join("stick");
    std::fs::write(stick.join("O0031.NC"), EXPORT).unwrap();
    std::fs::write(stick.join("ALL-PROG.TXT"), "%\nO0070\nM30\nO0071\nM99\n%\n").unwrap();
    std::fs::write(stick.join("README.TXT"), "no program\n").unwrap();
    let FileAnswer::Refused(Refusal::Split(files)) = shop.import(None) else { panic!("no question") };
    assert_eq!(files, ["ALL-PROG.TXT: O0070.NC  O0071.NC", "O0031.NC: O0031.NC  O0032.NC  O0033.NC"]);
    assert!(shop.directory().is_empty(), "nothing is copied before the answer");
    let answer = shop.import(Some(true));
    assert!(matches!(answer, FileAnswer::Done(_)), "{answer:?}");
    assert_eq!(shop.text("O0032.NC"), "O0032 (SECOND)\r\nG00 X-40\r\nM98 P33\r\nM99\r\n");
    assert_eq!(shop.text("O0071.NC"), "O0071\nM99\n%\n");
    assert!(shop.programs().iter().all(|program| program.part.is_none()));
    // Kept together, where the name is that of a program.
    let shop = Shop::new(&[]);
    std::fs::write(shop.files.path().join("stick/O0031.NC"), EXPORT).unwrap();
    shop.import(Some(false));
    assert_eq!(shop.text("O0031.NC"), EXPORT);
    assert_eq!(shop.directory().len(), 3);
}

#[test]
fn k7_8_an_import_of_one_program_from_two_files_is_refused_and_other_texts_do_not_stop_it() {
    let shop = Shop::new(&[]);
    let stick = shop.files.path().join("stick");
    std::fs::write(stick.join("O0031.NC"), EXPORT).unwrap();
    std::fs::write(stick.join("O0032.NC"), "O0032\nM99\n").unwrap();
    let FileAnswer::Refused(Refusal::Other(told)) = shop.import(Some(true)) else { panic!("not refused") };
    assert_eq!(told.en(), "O0032.NC is in O0031.NC and in O0032.NC; nothing was copied: choose one of the files");
    assert!(shop.directory().is_empty());
    // A text that is no program, and too large to be one, is left out.
    let large = std::fs::File::create(stick.join("LOG.TXT")).unwrap();
    large.set_len(200 * 1024 * 1024).unwrap();
    let answer = shop.import(Some(false));
    assert!(matches!(answer, FileAnswer::Done(_)), "{answer:?}");
    assert_eq!((shop.text("O0031.NC"), shop.text("O0032.NC")), (EXPORT.to_owned(), "O0032\nM99\n".to_owned()));
}

/// Of two programs with one number in a file the mistakes of the second have no place of their own: its error is the number.
#[test]
fn b1_a_number_that_stands_twice_in_a_file_does_not_shift_the_lines_of_a_mistake() {
    let shop = Shop::new(&[("O0100.NC", "%\nO0100\nG199\nO0100\nM19\nM30\nO0101\nG198\nM30\n%\n")]);
    let (status, told) = shop.run(&["check", "O0100.NC"]);
    assert_eq!(status, Some(2));
    for wanted in [
        "O0100.NC:4:1: program O0100 exists twice",
        "O0100.NC:3:1: unknown code G199",
        "O0100.NC:8:1: O0101: unknown code G198",
    ] {
        assert!(told.contains(wanted), "{wanted} in {told}");
    }
    assert!(!told.contains("M19"), "{told}");
}

/// A run says the same place as a check: file and line, and who called.
#[test]
fn t3_a_mistake_in_a_called_program_of_a_file_is_told_with_its_line_and_its_calls() {
    let shop = Shop::new(&[("O0031.NC", "O0031\nM98 P0032\nM30\nO0032\n(SUB)\n#1=1/0\nM99\n")]);
    let (status, told) = shop.run(&["run", "O0031.NC"]);
    assert_eq!(status, Some(1), "{told}");
    let line = "O0032 line 3, column 5: division by zero – check the variable of the divisor  O0031.NC:6  called by O0031 line 2";
    assert!(told.contains(line), "{told}");
    let (_, told) = shop.run(&["run", "O0031.NC", "--format", "json"]);
    for part in [r#""file":"O0031.NC""#, r#""file_line":6"#, r#""line":3"#, r#""cause":"called by O0031 line 2""#] {
        assert!(told.contains(part), "{part} in {told}");
    }
}

/// What is in the folder and cannot be used is listed, with the reason.
#[test]
fn b1_a_program_that_is_too_large_to_be_read_is_listed_with_the_reason() {
    let shop = Shop::new(&[("O0031.NC", "O0031(ONE)\nM30\n")]);
    let large = std::fs::File::create(shop.folders.programs.join("O0032.NC")).unwrap();
    large.set_len(200 * 1024 * 1024).unwrap();
    let too_large = "O0032.NC 太大：209715200 字节，最多 134217728".to_owned();
    let numbered = [(31, "O0031".to_owned(), "ONE".to_owned()), (32, "O0032".to_owned(), too_large)];
    assert_eq!(shop.directory(), numbered);
    assert!(shop.programs().get(32).is_none());
    // The same with names instead of numbers.
    let named = Folders { by_name: true, ..shop.folders.clone() };
    std::fs::rename(named.programs.join("O0032.NC"), named.programs.join("SHAFT.NC")).unwrap();
    let (programs, rows) = named.read_programs().unwrap();
    let told: Vec<_> = rows.iter().map(|row| row.english.as_deref().unwrap_or_default()).collect();
    assert_eq!(told, ["", "SHAFT.NC is too large: 209715200 bytes, 134217728 at most"]);
    assert!(programs.get(rows[1].number).is_none());
}

/// A subprogram stands before the program that calls it; alone it has no feed.
#[test]
fn b1_a_program_that_another_one_of_the_file_calls_is_checked_with_that_one() {
    let text = "O0031\nM30\nO0033\nG01 X5\nM99\nO0034\nG98 F100\nM98 P0033\nM30\n";
    let shop = Shop::new(&[("O0031.NC", text)]);
    let (status, told) = shop.run(&["check", "O0031.NC"]);
    assert_eq!(status, Some(0), "{told}");
    // Without a caller it is wrong.
    let shop = Shop::new(&[("O0031.NC", "O0031\nM30\nO0033\nG01 X5\nM99\n")]);
    assert_eq!(shop.run(&["check", "O0031.NC"]).0, Some(2));
}

/// A mistake in a program that is only called where the run does not come to names the calls.
#[test]
fn b1_a_mistake_behind_an_end_names_the_calls_that_lead_to_it() {
    let shop = Shop::new(&[
        ("O0040.NC", "O0040\nM30\nN5 M98 P0041\n"),
        ("O0041.NC", "O0041\nM98 P0042\nM99\n"),
        ("O0042.NC", "O0042\nG77\nM99\n"),
    ]);
    let (status, told) = shop.run(&["check", "O0040.NC"]);
    assert_eq!(status, Some(2));
    assert!(told.contains("O0042.NC:2:1: O0042") && told.contains("O0041.NC:2 ← O0040.NC:3"), "{told}");
}

#[test]
fn k7_8_an_import_with_a_number_twice_names_both_lines() {
    let shop = Shop::new(&[]);
    std::fs::write(shop.files.path().join("stick/O0031.NC"), "O0031\nM30\nO0032\nM99\nO0032\nM99\n").unwrap();
    let FileAnswer::Refused(Refusal::Other(told)) = shop.import(None) else { panic!("not refused") };
    assert_eq!(told.en(), "O0031.NC: O0032.NC begins in line 3 and again in line 5");
    assert!(shop.directory().is_empty());
}

/// A text without number and block would let the next program of the file take its place, and a comment above a number
/// would go to the program before: both are refused, and the file stays as it is.
#[test]
fn k6_2_a_protected_subprogram_behind_another_program_needs_its_password() {
    let mut shop = Shop::new(&[("O0031.NC", "O0031\nM30\n")]);
    let stick = shop.files.path().join("stick");
    std::fs::write(stick.join("O0077.NC"), "%\nO0077\nM30\nO9001\nM99\n%\n").unwrap();
    shop.subprograms_locked = true;
    for split in [None, Some(false), Some(true)] {
        assert_eq!(shop.import(split), FileAnswer::Refused(Refusal::Password), "{split:?}");
    }
    assert_eq!(shop.save(31, "O0031\nM30\nO9001\nM99\n"), FileAnswer::Refused(Refusal::Password));
    assert_eq!(shop.directory().len(), 1);
    assert_eq!(shop.text("O0031.NC"), "O0031\nM30\n");
    shop.subprograms_locked = false;
    let done = shop.import(Some(true));
    assert!(matches!(done, FileAnswer::Done(_)), "{done:?}");
    assert_eq!(shop.directory().iter().map(|row| row.0).collect::<Vec<_>>(), [31, 77, 9_001]);
}

#[test]
fn b1_a_text_that_would_change_other_programs_of_the_file_is_refused() {
    let shop = Shop::new(&[("O0031.NC", EXPORT)]);
    for (number, text) in [
        (31, "%\r\n(EMPTY)\r\n"),
        (31, "%\r\nO0031\r\nM30\r\nO0050\r\nM99\r\n"),
        (32, "(TITLE)\r\nO0032\r\nM99\r\n"),
        (32, "O0032\r\nM99\r\nO0051\r\nM99\r\n"),
    ] {
        let request = FileRequest::Save { number, text: Rope::from_str(text), base_stamp: 0, overwrite: true };
        let answer = shop.ask(request);
        assert!(matches!(answer, FileAnswer::Refused(Refusal::Other(_))), "{text}: {answer:?}");
        assert_eq!(shop.text("O0031.NC"), EXPORT);
    }
}
