//! RON files, program and screen folders, encodings, the watch, the data directory.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use kt830::defs::kind::{Dialect, Kind};
use kt830::host::retained_store::RetainedStore;
use kt830::store::ron_file::{self, ChecksumPolicy, LoadedFile, RonError, RonWarning};
use kt830::store::{
    DataDir, Encoding, FileClass, Folder, FolderChange, FolderError, FolderWatch, PAGE_TEXT, PAGE_TEXT_EN, PICTURE,
    POLL_INTERVAL, PROGRAM, StoredLang, StoredSettings, Values, decode, password, program_stem, stamp,
};
use kt830::units::PerAxis;
use serde::{Deserialize, Serialize};

#[derive(Debug, PartialEq, Serialize, Deserialize)]
enum Language {
    Chinese,
    English,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Settings {
    language: Language,
    part: String,
    params: BTreeMap<String, f64>,
}

fn settings(part: &str) -> Settings {
    Settings { language: Language::Chinese, part: part.to_owned(), params: [("P270".to_owned(), 3000.0)].into() }
}

fn read(path: &Path, care: ChecksumPolicy) -> Result<LoadedFile<Settings>, RonError> {
    ron_file::read(path, care)
}

#[test]
fn a_ron_file_comes_back_as_it_was_written_and_keeps_its_predecessor() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("settings.ron");
    assert!(matches!(read(&path, ChecksumPolicy::Strict), Err(RonError::Missing { .. })));
    ron_file::write(&path, ChecksumPolicy::Strict, &settings("轴套")).unwrap();
    ron_file::write(&path, ChecksumPolicy::Strict, &settings("shaft")).unwrap();
    let found = read(&path, ChecksumPolicy::Strict).unwrap();
    assert_eq!((found.value, found.warnings.len()), (settings("shaft"), 0));
    let backup = read(&folder.path().join("settings.ron.bak"), ChecksumPolicy::Strict).unwrap();
    assert_eq!(backup.value, settings("轴套"));
    let names = fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(names, 2, "no temporary file stays");
}

#[test]
fn a_hand_edited_file_counts_for_people_and_not_where_only_the_control_writes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("settings.ron");
    ron_file::write(&path, ChecksumPolicy::Lenient, &settings("a")).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replace("\"a\"", "\"b\"")).unwrap();
    let found = read(&path, ChecksumPolicy::Lenient).unwrap();
    assert_eq!((found.value, found.warnings), (settings("b"), vec![RonWarning::StaleChecksum(path.clone())]));
    assert!(matches!(read(&path, ChecksumPolicy::Strict), Err(RonError::Checksum { .. })));

    let body = text.split("// checksum").next().unwrap();
    fs::write(&path, format!("\u{FEFF}{body}")).unwrap();
    let found = read(&path, ChecksumPolicy::Lenient).unwrap();
    assert_eq!((found.value, found.warnings), (settings("a"), vec![RonWarning::NoChecksum(path.clone())]));
    assert!(matches!(read(&path, ChecksumPolicy::Strict), Err(RonError::Checksum { .. })));
}

#[test]
fn a_file_cut_off_falls_back_to_its_predecessor_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("settings.ron");
    ron_file::write(&path, ChecksumPolicy::Lenient, &settings("old")).unwrap();
    ron_file::write(&path, ChecksumPolicy::Lenient, &settings("new")).unwrap();
    let text = fs::read(&path).unwrap();
    for length in [0, 1, text.len() / 3, text.len() / 2] {
        fs::write(&path, &text[..length]).unwrap();
        let found = read(&path, ChecksumPolicy::Lenient).unwrap();
        assert_eq!(found.value, settings("old"), "cut to {length}");
        assert!(matches!(found.warnings[0], RonWarning::FromBackup { .. }), "cut to {length}");
    }
    // Writing again puts the cut file aside and leaves the good predecessor alone.
    ron_file::write(&path, ChecksumPolicy::Lenient, &settings("third")).unwrap();
    assert_eq!(read(&path, ChecksumPolicy::Lenient).unwrap().value, settings("third"));
    fs::remove_file(&path).unwrap();
    assert_eq!(read(&path, ChecksumPolicy::Lenient).unwrap().value, settings("old"));
    assert_eq!(fs::read(folder.path().join("settings.ron.damaged")).unwrap(), &text[..text.len() / 2]);
}

#[test]
fn a_ron_error_names_file_line_and_column() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("settings.ron");
    fs::write(&path, "(\n    language: Chinese,\n    part: 7,\n)\n").unwrap();
    let told = read(&path, ChecksumPolicy::Lenient).unwrap_err().to_string();
    assert!(told.contains("settings.ron line 3, column 11"), "{told}");
    fs::write(&path, b"(\n  \xE8\xBD\xAE\xFF").unwrap();
    let told = read(&path, ChecksumPolicy::Lenient).unwrap_err().to_string();
    assert!(told.contains("line 2, column 4"), "{told}");
}

fn folder_with(names: &[&str]) -> (tempfile::TempDir, Folder) {
    let temporary = tempfile::tempdir().unwrap();
    for name in names {
        fs::write(temporary.path().join(name), name).unwrap();
    }
    let folder = Folder::new(temporary.path());
    (temporary, folder)
}

#[test]
fn k7_3_names_count_without_regard_to_case_and_txt_wins() {
    let (temporary, folder) =
        folder_with(&["o1001.nc", "C0001.NC", "c0001.txt", "C0002.nc", "B0001.bmp", "O12.NC", "O1002.TXT"]);
    assert_eq!(folder.read(&PROGRAM, 1001).unwrap().bytes, b"o1001.nc");
    assert_eq!(folder.read(&PAGE_TEXT, 1).unwrap().name, "c0001.txt");
    assert_eq!(folder.read(&PAGE_TEXT, 2).unwrap().name, "C0002.nc");
    assert_eq!(folder.find(&PICTURE, 1).unwrap().name, "B0001.bmp");
    let missing = folder.read(&PROGRAM, 1002).unwrap_err();
    assert!(matches!(missing, FolderError::Missing { .. }) && missing.to_string().contains("O1002.NC"), "{missing}");

    let programs = folder.list(&PROGRAM).unwrap();
    assert_eq!(programs.entries.iter().map(|entry| entry.number).collect::<Vec<_>>(), [1001]);
    assert_eq!(programs.ignored.iter().map(|ignored| ignored.name.as_str()).collect::<Vec<_>>(), ["O12.NC"]);
    let pages = folder.list(&PAGE_TEXT).unwrap();
    assert_eq!(pages.ignored[0].name, "C0001.NC");
    assert!(pages.ignored[0].reason.contains("c0001.txt"));

    // Writing goes to the file that counts, whatever its case: no twin arises.
    assert_eq!(folder.write(&PROGRAM, 1001, b"G0 X1\n").unwrap(), "o1001.nc");
    assert_eq!(folder.write(&PROGRAM, 1003, b"(NEW)\n").unwrap(), "O1003.NC");
    assert!(!temporary.path().join("O1001.NC").exists());
}

#[test]
fn b6_the_directory_shows_size_time_and_comment() {
    let (temporary, folder) = folder_with(&[]);
    fs::write(temporary.path().join("O1001.NC"), b"%\nO1001 (\xCD\xE2\xD4\xB2)\nG0 X1;\n").unwrap();
    fs::write(temporary.path().join("C0001.TXT"), "外圆磨;\n起点 #500;\n").unwrap();
    let entry = folder.find(&PROGRAM, 1001).unwrap();
    assert_eq!((entry.size, entry.comment.as_str()), (22, "外圆"));
    assert!(entry.modified.is_some());
    assert_eq!(folder.list(&PAGE_TEXT).unwrap().entries[0].comment, "外圆磨");
}

#[test]
fn b6_files_are_written_renamed_and_deleted_and_nothing_is_overwritten() {
    let (_temporary, folder) = folder_with(&["O1001.NC", "o1002.nc"]);
    assert!(matches!(folder.check_free(&PROGRAM, 1002), Err(FolderError::Exists { .. })));
    assert!(folder.check_free(&PROGRAM, 1003).is_ok());
    assert!(matches!(folder.rename(&PROGRAM, 1001, 1002), Err(FolderError::Exists { .. })));
    assert!(matches!(folder.rename(&PROGRAM, 1001, 100_000_000), Err(FolderError::BadNumber { .. })));
    assert_eq!(folder.write(&PROGRAM, 1003, b"M30\n").unwrap(), "O1003.NC");
    assert_eq!(folder.rename(&PROGRAM, 1002, 1004).unwrap(), "O1004.NC");
    folder.delete(&PROGRAM, 1001).unwrap();
    assert!(matches!(folder.delete(&PROGRAM, 1001), Err(FolderError::Missing { .. })));
    let numbers: Vec<u32> = folder.list(&PROGRAM).unwrap().entries.iter().map(|entry| entry.number).collect();
    assert_eq!(numbers, [1003, 1004]);
}

#[test]
fn names_that_lead_out_of_the_folder_are_refused() {
    let (_temporary, folder) = folder_with(&["O1001.NC"]);
    for name in ["..", ".", "", "../O1001.NC", "a/b.NC", "a\\b.NC", "C:O1001.NC", "/etc/passwd", "O1001.NC\0"] {
        assert!(matches!(folder.read_named(&PROGRAM, name), Err(FolderError::BadName { .. })), "{name}");
    }
    assert_eq!(folder.read_named(&PROGRAM, "O1001.NC").unwrap().bytes, b"O1001.NC");
}

#[cfg(unix)]
#[test]
fn links_folders_and_devices_are_refused() {
    let (temporary, folder) = folder_with(&["real"]);
    let at = |name: &str| temporary.path().join(name);
    std::os::unix::fs::symlink(at("real"), at("O1001.NC")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", at("O1002.NC")).unwrap();
    fs::create_dir(at("O1003.NC")).unwrap();
    for number in 1001..=1003 {
        assert!(matches!(folder.read(&PROGRAM, number), Err(FolderError::NotRegular { .. })), "{number}");
        assert!(matches!(folder.write(&PROGRAM, number, b""), Err(FolderError::NotRegular { .. })), "{number}");
        let named = folder.read_named(&PROGRAM, &PROGRAM.file_name(number));
        assert!(matches!(named, Err(FolderError::NotRegular { .. })), "{number}");
    }
    assert_eq!(folder.list(&PROGRAM).unwrap().ignored.len(), 3);
    let device = Folder::new("/dev").read_named(&PROGRAM, "null");
    assert!(matches!(device, Err(FolderError::NotRegular { .. })), "{device:?}");
}

#[test]
fn a_file_over_its_limit_is_refused_unread_and_unwritten() {
    let (temporary, folder) = folder_with(&[]);
    let path = temporary.path().join("C0001.TXT");
    fs::File::create(&path).unwrap().set_len(PAGE_TEXT.limit + 1).unwrap();
    assert!(matches!(folder.read(&PAGE_TEXT, 1), Err(FolderError::TooLarge { size: 65_537, limit: 65_536, .. })));
    let large = vec![b' '; 65_537];
    assert!(matches!(folder.write(&PAGE_TEXT, 2, &large), Err(FolderError::TooLarge { .. })));
    assert!(matches!(folder.find(&PAGE_TEXT, 2), Err(FolderError::Missing { .. })));
}

#[test]
fn what_a_power_cut_left_half_written_is_never_listed_and_swept_by_the_control_that_has_the_lock() {
    let (temporary, folder) = folder_with(&["O1001.NC", ".kt830-Ab12Cd.part"]);
    assert_eq!(folder.list(&PROGRAM).unwrap().ignored, []);
    let root = temporary.path();
    let left: Vec<_> = ["", "generations", "programs/vertical", "screens"]
        .map(|inner| root.join(inner).join(".kt830-Ab12Cd.part"))
        .into_iter()
        .collect();
    for path in &left {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, "half").unwrap();
    }
    // Data of another kind, which another control may be using.
    let foreign = root.join("gs/.kt830-Ab12Cd.part");
    fs::create_dir_all(root.join("gs")).unwrap();
    fs::write(root.join("gs/retained.lock"), "").unwrap();
    fs::write(&foreign, "being written").unwrap();
    let opened = RetainedStore::open(root, Kind::Gc).unwrap();
    assert!(foreign.exists());
    assert!(left.iter().all(|path| !path.exists()) && root.join("O1001.NC").exists());
    // A control that finds the data in use touches nothing.
    fs::write(&left[0], "being written").unwrap();
    assert!(RetainedStore::open(root, Kind::Gc).is_err() && left[0].exists());
    drop(opened);
}

#[test]
fn b1_texts_are_read_in_utf8_and_in_gbk() {
    let check = |bytes: &[u8], text: &str, encoding: Encoding| {
        let decoded = decode(bytes).expect("decodes");
        assert_eq!((&*decoded.text, decoded.encoding), (text, encoding));
    };
    check(b"", "", Encoding::Utf8);
    check(b"G0 X1\r\n", "G0 X1\r\n", Encoding::Utf8);
    check("\u{FEFF}砂轮；＃500％\n".as_bytes(), "砂轮；＃500％\n", Encoding::Utf8);
    check(b"\xC9\xB0\xC2\xD6;#500\n", "砂轮;#500\n", Encoding::Gbk);
    // 砂 alone could be UTF-8 too; signs and letters of UTF-8 that could be GBK stay what they are.
    check(b"\xC9\xB0;", "砂;", Encoding::Gbk);
    check("±0.01 µ Ø".as_bytes(), "±0.01 µ Ø", Encoding::Utf8);
    // GB18030 in four bytes, and a GBK trail byte that looks like ASCII.
    check(b"\x81\x30\x84\x36\x81\x40", "¥丂", Encoding::Gbk);
}

#[test]
fn b1_bytes_of_neither_encoding_are_told_with_line_and_byte() {
    let check = |bytes: &[u8], line: usize, column: usize, byte: u8| {
        let wrong = decode(bytes).expect_err("refused");
        assert_eq!((wrong.line, wrong.column, wrong.byte), (line, column, byte), "{wrong}");
    };
    check(b"\xFF", 1, 1, 0xFF);
    check(b"G0\r\nG1 \xFF X1\n", 2, 4, 0xFF);
    check(b"a\rb\n\xC9\xB0\xC2\xD6 \xFF\xFF", 3, 6, 0xFF);
    // A GBK character cut off at the end, and one with a trail that none has.
    check(b"x\n\xC9\xB0\xC2", 2, 3, 0xC2);
    check(b"\xC9\xB0\xC2\x20", 1, 3, 0xC2);
    // With a byte order mark it is UTF-8 and nothing else.
    check(b"\xEF\xBB\xBF;\n \xC2\xD6", 2, 2, 0xC2);
    let wide = decode(b"\xFF\xFEG\x000\x00").expect_err("refused").to_string();
    assert!(wide.contains("UTF-16"), "{wide}");
}

#[test]
fn k7_3_a_copied_file_is_seen_once_and_reading_it_is_no_change() {
    let folder = tempfile::tempdir().unwrap();
    let directory = DataDir::resolve(Some(folder.path())).unwrap();
    let (programs, screens) = (directory.programs(), directory.screens());
    let mut watch = FolderWatch::start(&programs, &screens);
    assert_eq!(watch.polling_because(), None);
    let now = Instant::now();
    assert_eq!(watch.try_recv(now), None);
    for number in 1..=20 {
        fs::write(screens.join(format!("C{number:04}.TXT")), "x;").unwrap();
    }
    let longest = Duration::from_secs(10);
    assert_eq!(watch.recv_timeout(now, longest), Some(FolderChange::Screens));
    Folder::new(&programs).write(&PROGRAM, 1001, b"M30\n").unwrap();
    // Of the many events of twenty files at most a few are told again before the other folder's.
    let mut told = Vec::new();
    while told.last() != Some(&FolderChange::Programs) {
        told.push(watch.recv_timeout(now, longest).expect("the program is seen"));
        assert!(told.len() < 20, "{told:?}");
    }
}

#[test]
fn without_notices_the_folders_are_listed_now_and_then() {
    let folder = tempfile::tempdir().unwrap();
    let directory = DataDir::resolve(Some(folder.path())).unwrap();
    let mut watch = FolderWatch::polling(&directory.programs(), &directory.screens());
    assert!(watch.polling_because().is_some());
    let start = Instant::now();
    assert_eq!(watch.try_recv(start), None);
    fs::write(directory.programs().join("O1001.NC"), "M30").unwrap();
    fs::write(directory.screens().join("C0001.TXT"), "x;").unwrap();
    assert_eq!(watch.try_recv(start), None, "not before the interval is over");
    let later = start + POLL_INTERVAL;
    assert_eq!(watch.try_recv(later), Some(FolderChange::Programs));
    assert_eq!(watch.try_recv(later), Some(FolderChange::Screens));
    assert_eq!(watch.try_recv(later + POLL_INTERVAL), None);
}

#[test]
fn k7_3_folders_beside_the_program_are_watched_by_their_short_names() {
    // `./screens` is what a control started in its folder is given; the system tells whole paths.
    let folder = tempfile::tempdir_in(".").unwrap();
    let short = std::path::Path::new(folder.path().file_name().unwrap());
    let (programs, screens) = (short.join("programs"), short.join("screens"));
    fs::create_dir(&programs).unwrap();
    fs::create_dir(&screens).unwrap();
    let mut watch = FolderWatch::start(&programs, &screens);
    assert_eq!(watch.polling_because(), None);
    fs::write(screens.join("C0001.TXT"), "x;").unwrap();
    assert_eq!(watch.recv_timeout(Instant::now(), Duration::from_secs(10)), Some(FolderChange::Screens));
}

#[test]
fn a_watched_folder_that_is_removed_is_polled_from_then_on() {
    let folder = tempfile::tempdir().unwrap();
    let directory = DataDir::resolve(Some(folder.path())).unwrap();
    let mut watch = FolderWatch::start(&directory.programs(), &directory.screens());
    let now = Instant::now();
    fs::remove_dir(directory.programs()).unwrap();
    // What else changed meanwhile is not known, so both folders are told.
    let mut told = Vec::new();
    while !(told.contains(&FolderChange::Programs) && told.contains(&FolderChange::Screens)) {
        told.push(watch.recv_timeout(now, Duration::from_secs(10)).expect("the removal is seen"));
        assert!(told.len() < 10, "{told:?}");
    }
    assert!(watch.polling_because().is_some());
    fs::create_dir(directory.programs()).unwrap();
    fs::write(directory.programs().join("O1001.NC"), "M30").unwrap();
    assert_eq!(watch.try_recv(now + POLL_INTERVAL), Some(FolderChange::Programs));
}

#[test]
fn a_folder_that_is_not_there_is_polled_until_it_comes() {
    let folder = tempfile::tempdir().unwrap();
    let (programs, screens) = (folder.path().join("programs"), folder.path().join("screens"));
    let mut watch = FolderWatch::start(&programs, &screens);
    assert!(watch.polling_because().is_some());
    let start = Instant::now();
    assert_eq!(watch.try_recv(start), None);
    fs::create_dir(&programs).unwrap();
    fs::write(programs.join("O1001.NC"), "M30").unwrap();
    assert_eq!(watch.try_recv(start + POLL_INTERVAL), Some(FolderChange::Programs));
}

#[test]
fn the_data_directory_is_made_or_refused_with_path_and_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("new").join("data");
    let directory = DataDir::resolve(Some(&root)).unwrap();
    for made in [directory.programs(), directory.screens(), directory.backups(), directory.screenshots()] {
        assert!(made.is_dir() && made.starts_with(&root), "{}", made.display());
    }
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let told = DataDir::resolve(Some(&file)).unwrap_err().to_string();
    assert!(told.contains("file") && told.contains("move away") && told.contains("--data"), "{told}");
}

#[test]
#[cfg(unix)]
fn k7_3_a_page_file_that_cannot_be_read_is_told_by_its_name_in_both_languages() {
    let root = tempfile::tempdir().unwrap();
    let (programs, screens) = (root.path().join("programs"), root.path().join("screens"));
    fs::create_dir(&programs).unwrap();
    fs::create_dir(&screens).unwrap();
    for picture in ["B0004.BMP", "B0005.BMP"] {
        fs::write(screens.join(picture), "BM").unwrap();
    }
    fs::write(root.path().join("elsewhere"), "a;%").unwrap();
    std::os::unix::fs::symlink(root.path().join("elsewhere"), screens.join("C0005.TXT")).unwrap();
    let found = kt830::host::folders::Folders { programs, screens, by_name: false, dialect: Dialect::LatheA }
        .read_screens()
        .unwrap();
    let said = |number: u32| found.find(number).unwrap().text.as_ref().unwrap_err().full_message();
    assert_eq!(said(1_004).zh(), "C0004.TXT：文件不存在，请拷入 screens 目录");
    assert!(said(1_005).zh().contains("C0005.TXT 是链接"), "{}", said(1_005).zh());
    for number in [1_004, 1_005] {
        assert!(!said(number).zh().contains(" is ") && !said(number).zh().contains('/'), "{}", said(number).zh());
        assert!(!said(number).en().contains('/'), "{}", said(number).en());
    }
}

#[test]
fn the_value_never_changes() {
    assert_eq!(stamp(b""), 0xefd0_1f60_ba99_2926);
    assert_ne!(stamp(b"#500=1"), stamp(b"#500=2"));
}

#[test]
fn s1_names_of_programs_are_told_from_other_files() {
    assert_eq!(program_stem("vgrind.mpf").as_deref(), Some("VGRIND"));
    assert_eq!((program_stem("L10.SPF").as_deref(), program_stem("l10").as_deref()), (Some("L10"), Some("L10")));
    for other in ["O1001.NC", "L10.TXT", "LIES", "L", "README", ".MPF", "a b.MPF", "程序.MPF"] {
        assert_eq!(program_stem(other), None, "{other}");
    }
}

#[test]
fn b6_passwords_are_kept_hashed_with_a_salt() {
    let (one, other) = (password::hash("187350").expect("a salt"), password::hash("187350").expect("a salt"));
    assert!(one.starts_with("$argon2id$") && one != other && !one.contains("187350"));
    assert!(password::verify("187350", &one) && password::verify("187350", &other));
    assert!(!password::verify("187351", &one) && !password::verify("", &one) && !password::verify("187350", "187350"));
}

#[test]
fn k1_the_kind_and_the_language_are_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(StoredSettings::read(folder.path()).expect("no file"), StoredSettings::default());
    let chosen = StoredSettings {
        kind: Some(Kind::Ga),
        lang: Some(StoredLang::En),
        light: Some(true),
        ..StoredSettings::default()
    };
    chosen.write(folder.path()).expect("written");
    assert_eq!(StoredSettings::read(folder.path()).expect("a file"), chosen);
    let added = StoredSettings { lang: Some(StoredLang::Added("de".to_owned())), ..chosen };
    added.write(folder.path()).expect("written");
    assert_eq!(StoredSettings::read(folder.path()).expect("a file"), added);
    std::fs::write(folder.path().join("settings.ron"), "(kind: Some(Gs))").expect("written");
    let by_hand = StoredSettings::read(folder.path()).expect("edited by hand");
    assert_eq!(by_hand, StoredSettings { kind: Some(Kind::Gs), ..StoredSettings::default() });
}

#[test]
fn names_are_told_without_regard_to_case_and_nothing_else_passes() {
    assert_eq!(PROGRAM.parse("o1001.nc"), Some((1001, 0)));
    assert_eq!((PROGRAM.parse("O12345678.NC"), PAGE_TEXT.parse("C00001.TXT")), (Some((12_345_678, 0)), None));
    assert_eq!(PAGE_TEXT.parse("c0001.NC"), Some((1, 1)));
    for other in [
        "O101.NC",
        "O123456789.NC",
        "O00001001.NC",
        "O1001.TXT",
        "O1001",
        "O+001.NC",
        "../O1001.NC",
        "O１００１.NC",
        "",
        ".",
    ] {
        assert_eq!(PROGRAM.parse(other), None, "{other}");
    }
    assert_eq!(PROGRAM.file_name(7), "O0007.NC");
}

#[test]
fn the_comment_line_is_the_first_comment_or_the_title() {
    let folder = tempfile::tempdir().unwrap();
    let comment = |class: &FileClass, text: &str| {
        let files = Folder::new(folder.path());
        files.write(class, 1, text.as_bytes()).unwrap();
        files.find(class, 1).unwrap().comment
    };
    assert_eq!(comment(&PROGRAM, "%\nO1001 (JAW FACE)\nG0 X1 ; no"), "JAW FACE");
    assert_eq!(comment(&PROGRAM, "G0 X1;\nG1 ; 快进"), "快进");
    assert_eq!(comment(&PROGRAM, "G0 X1"), "");
    assert_eq!(comment(&PAGE_TEXT, "外圆磨;\n起点 #500;"), "外圆磨");
}

#[test]
fn work_offsets_keep_their_name_in_a_file_of_values() {
    let text = "(frames: {0: ((1.0, 2.0, 3.0))})";
    let read = Values::from_text(text).unwrap();
    assert_eq!(read.work_offsets[&0], PerAxis([1.0, 2.0, 3.0]));
    let written = read.to_text().unwrap();
    assert!(written.contains("frames:") && !written.contains("work_offsets"), "{written}");
    assert_eq!(Values::from_text(&written).unwrap(), read);
}

#[test]
fn h9_english_texts_are_files_of_their_own_beside_the_page_texts() {
    let folder = folder_with(&["C0001.TXT", "c0001.en.txt", "C0002.EN.TXT", "C001.EN.TXT"]);
    let numbers = |class: &FileClass| -> Vec<u32> {
        folder.1.list(class).unwrap().entries.iter().map(|entry| entry.number).collect()
    };
    assert_eq!((numbers(&PAGE_TEXT), numbers(&PAGE_TEXT_EN)), (vec![1], vec![1, 2]));
    assert_eq!(PAGE_TEXT_EN.file_name(7), "C0007.EN.TXT");
    let ignored = |class: &FileClass| -> Vec<String> {
        folder.1.list(class).unwrap().ignored.into_iter().map(|ignored| ignored.name).collect()
    };
    assert_eq!(ignored(&PAGE_TEXT), ["C001.EN.TXT"], "an English text is not a misnamed page text");
}
