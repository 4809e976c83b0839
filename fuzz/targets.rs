//! What is fuzzed: every reader of bytes that come from outside. Each target reads any bytes and checks what must hold of
//! every answer; a panic or a broken rule is a finding. `cargo fuzz run NAME` looks for them, and the test
//! `cli fuzz_corpus` gives every target the inputs in `fuzz/seeds` and `fuzz/findings` again.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use kt830::defs::dialect::Dialect;
use kt830::defs::kind::Kind;
use kt830::defs::leadscrew::LeadscrewCompensation;
use kt830::defs::page_text;
use kt830::defs::param::{self, ParamAddress};
use kt830::gateway::opcua::adapter_state::AdapterState;
use kt830::gateway::opcua_report::OpcUaReport;
use kt830::gateway::order_inbox::OrderInbox;
use kt830::host::folders::parse_picture;
use kt830::host::picture_labels::{PICTURE_SIZE, parse_picture_labels};
use kt830::host::serial::SERIAL_LIMIT;
use kt830::host::serial::format::{ReadProgress, SerialReader};
use kt830::host::transfer::{convert_picture, read_archive};
use kt830::host::value_set::check_values;
use kt830::io::fieldbus::description::MachineDescription;
use kt830::io::sim::{MachineFile, PartFile};
use kt830::link::snapshot::{DirectoryRow, Snapshot};
use kt830::nc::{
    CommonVariables, EmptyLibrary, NcSettings, OfflineMachine, ProgramCheck, ProgramFault, SharedLibrary, Source,
    check_syntax,
};
use kt830::store::ron_file::{ChecksumPolicy, from_bytes};
use kt830::store::{
    DATABASE_FILE, ProgramFolder, RetainedChange, RetainedData, RetainedDatabase, StoredSettings, ToolOffset, Values,
    decode, stamp,
};
use kt830::story;

/// A reader of any bytes.
pub type Target = fn(&[u8]);

/// Every target by the name of its folder.
pub const TARGETS: [(&str, Target); 19] = [
    ("adapter_lines", adapter_lines),
    ("archive", archive),
    ("encoding", encoding),
    ("leadscrew", leadscrew),
    ("machine_description", machine_description),
    ("machine_file", machine_file),
    ("order_message", order_message),
    ("page", page),
    ("part_file", part_file),
    ("picture", picture),
    ("picture_conversion", picture_conversion),
    ("picture_labels", picture_labels),
    ("program_check", program_check),
    ("program_lines", program_lines),
    ("retained_copies", retained_copies),
    ("retained_database", retained_database),
    ("serial", serial),
    ("settings", settings),
    ("story", story_text),
];

/// A folder of grinder programs; its files are not read.
fn shelf() -> ProgramFolder {
    ProgramFolder::new(Path::new("programs"), false)
}

/// What a control, or whoever stands in its place, tells the OPC UA server: memory is bounded whatever comes.
pub fn adapter_lines(bytes: &[u8]) {
    let mut state = AdapterState::default();
    for line in String::from_utf8_lossy(bytes).lines() {
        let events = state.take(line);
        assert!(events.len() <= 1_000, "{} events", events.len());
    }
    let again = state.clone();
    assert_eq!(state.changes_to(&again), []);
    assert!(state.items().count() <= 1_000 && state.alarms().count() <= 1_000 && state.orders().len() <= 1_000);
    if let Some(view) = OpcUaReport::view(bytes) {
        assert!(view.address.len() <= 400);
    }
}

/// An order of the shop: it becomes a proposal that passes every check, or is answered with a reason.
pub fn order_message(bytes: &[u8]) {
    let mut snapshot = Snapshot::new(Kind::Gc);
    let on = ParamAddress { number: param::SHOP_ORDERS.number, bit: None };
    assert!(Arc::make_mut(&mut snapshot.params).write(on, 1.0).is_ok());
    let row = DirectoryRow { number: 1_002, name: "O1002".to_owned(), ..DirectoryRow::default() };
    snapshot.directory = Arc::new(vec![row]);
    let (proposals, taken) = crossbeam_channel::bounded(1);
    let answer = OrderInbox::new(proposals).take(Duration::ZERO, bytes, &snapshot);
    assert!(answer.len() <= 2_000 && !answer.contains('\n'), "{answer}");
    match taken.try_recv() {
        Ok(proposal) => {
            assert!(answer.contains("\"proposed\":true"), "{answer}");
            assert!(proposal.program == 1_002 && (1..=999_999).contains(&proposal.target), "{proposal:?}");
            assert!(proposal.values.iter().all(|value| value.number.is_finite()), "{proposal:?}");
        }
        Err(_) => assert!(answer.contains("\"why\":\""), "{answer}"),
    }
}

/// A backup on a USB stick: what it names stays inside its folder, and its values are checked. The bytes are read as they
/// are, and as the files of an archive whose checksums are right.
pub fn archive(bytes: &[u8]) {
    read_and_check(bytes);
    if let Some(sealed) = sealed_archive(bytes) {
        read_and_check(&sealed);
    }
}

/// An archive of files that are divided by NUL, each a name, LF and its content.
fn sealed_archive(bytes: &[u8]) -> Option<Vec<u8>> {
    let (mut archive, mut sums) = (tar::Builder::new(Vec::new()), String::new());
    let mut append = |name: &str, content: &[u8]| {
        let mut header = tar::Header::new_gnu();
        header.set_size(content.len() as u64);
        header.set_cksum();
        archive.append_data(&mut header, name, content)
    };
    for file in bytes.split(|byte| *byte == 0).take(50) {
        let end = file.iter().position(|byte| *byte == b'\n')?;
        let name = std::str::from_utf8(&file[..end]).ok()?;
        let content = &file[end + 1..];
        sums.push_str(&format!("{:016x} {name}\n", stamp(content)));
        append(name, content).ok()?;
    }
    append("checksums.txt", sums.as_bytes()).ok()?;
    archive.into_inner().ok()
}

fn read_and_check(bytes: &[u8]) {
    let Ok((values, files)) = read_archive("KT830.TAR", bytes, &shelf()) else { return };
    for (_, name, _) in &files {
        assert!(!name.contains(['/', '\\']) && name != "..", "{name} leaves its folder");
    }
    drop(check_values(&values, Kind::Gc));
}

/// Text in GBK or UTF-8.
pub fn encoding(bytes: &[u8]) {
    if let Err(fault) = decode(bytes) {
        assert!(fault.line >= 1 && fault.column >= 1, "a fault without a place");
    }
}

/// A leadscrew table: what is read is read again from its own text.
pub fn leadscrew(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let Ok(table) = LeadscrewCompensation::parse(text) else { return };
    let again = LeadscrewCompensation::parse(&table.to_text()).ok();
    assert!(again.as_ref() == Some(&table), "another table: {again:?}");
}

/// `machine.ron`.
pub fn machine_description(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Ok(description) = MachineDescription::parse(text) {
        assert!(description.process_data_bytes().count() <= text.len());
    }
}

/// The file of a simulated machine, or a variation of one.
pub fn machine_file(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    drop(MachineFile::parse(text));
    drop(MachineFile::of_text(text, Kind::ALL[bytes.len() % Kind::ALL.len()]));
}

/// A page text C0001.TXT: a fault has its place in the text.
pub fn page(bytes: &[u8]) {
    let Ok(decoded) = decode(bytes) else { return };
    let lines = decoded.text.lines().count() as u32 + 1;
    match page_text::parse(&decoded.text) {
        Ok(page) => assert!(page.rows().count() <= decoded.text.len()),
        Err(fault) => assert!((1..=lines).contains(&fault.line) && fault.column >= 1, "line {}", fault.line),
    }
}

/// A part file.
pub fn part_file(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    drop(PartFile::parse(text));
}

/// A page picture: what is accepted has the size of the page.
pub fn picture(bytes: &[u8]) {
    if let Ok(picture) = parse_picture("B0001.BMP", bytes) {
        // BMP: the size stands in bytes 18 to 25; a height below zero is that of a picture that begins at its top.
        let number = |at: usize| picture.0[at..at + 4].iter().rev().fold(0, |sum, byte| sum << 8 | u32::from(*byte));
        assert_eq!((number(18), (number(22) as i32).unsigned_abs()), PICTURE_SIZE);
    }
}

/// A picture of another format: what is converted is a page picture.
pub fn picture_conversion(bytes: &[u8]) {
    if let Ok(converted) = convert_picture(bytes) {
        assert!(parse_picture("B0001.BMP", &converted).is_ok(), "the converted picture is refused");
    }
}

/// D0001.RON, which links a picture with variables.
pub fn picture_labels(bytes: &[u8]) {
    drop(parse_picture_labels("D0001.RON", bytes));
}

/// The dialects; the length of a program selects one.
const DIALECTS: [Dialect; 4] = [Dialect::LatheA, Dialect::Mill, Dialect::Sinumerik, Dialect::SuperMan];

fn program(bytes: &[u8]) -> (Arc<Source>, NcSettings) {
    let dialect = DIALECTS[bytes.len() % DIALECTS.len()];
    (Arc::new(Source::new(1001, "O1001.NC", bytes, dialect)), NcSettings::for_dialect(dialect))
}

fn have_places(faults: &[ProgramFault], source: &Source) {
    for fault in faults {
        let line = fault.location.line;
        assert!(fault.column >= 1 && (1..=source.line_count().max(1)).contains(&(line as usize)), "line {line}");
        assert!(!fault.text(kt830::defs::text::Lang::Zh).is_empty());
    }
}

/// The lines of a program, as the editor checks them.
pub fn program_lines(bytes: &[u8]) {
    let (source, settings) = program(bytes);
    have_places(&check_syntax(&source, &settings), &source);
}

/// A whole program, followed for some thousand blocks.
pub fn program_check(bytes: &[u8]) {
    let (source, settings) = program(bytes);
    let library: SharedLibrary = Arc::new(EmptyLibrary);
    let mut world = OfflineMachine::new(&settings);
    let check = ProgramCheck::new(&source, &library, &settings, CommonVariables::default());
    let mut blocks = 0;
    let report = check.with_standstill_limit(200).run_until(&mut world, &mut |_| {
        blocks += 1;
        blocks < 2_000
    });
    have_places(&report.faults, &source);
    assert!(report.seconds >= 0.0 && report.length_mm >= 0.0, "{} s, {} mm", report.seconds, report.length_mm);
    assert!(report.lines == source.line_count());
}

/// A folder in memory, if the system has one.
fn scratch_folder() -> Option<tempfile::TempDir> {
    tempfile::tempdir_in(if Path::new("/dev/shm").is_dir() { "/dev/shm" } else { "." }).ok()
}

/// A database with a value of each table, and its data.
fn whole_database() -> Option<(Vec<u8>, RetainedData)> {
    let folder = scratch_folder()?;
    let mut store = RetainedDatabase::open(folder.path()).ok()?.database;
    let offset = ToolOffset::default();
    for number in 500..600_u16 {
        let changes = [
            RetainedChange::Variable { number, value: Some(f64::from(number)) },
            RetainedChange::Param { key: format!("P{number}"), value: Some(1.0) },
            RetainedChange::Offset { number: 1 + (number % 16) as u8, offset },
            RetainedChange::Text { key: format!("t{number}"), value: Some("text ".repeat(20)) },
        ];
        store.commit(&changes).ok()?;
    }
    let data = store.load().ok()?;
    drop(store);
    Some((std::fs::read(folder.path().join(DATABASE_FILE)).ok()?, data))
}

/// The database of retained values: whole, or refused. The bytes are read as they are, and as changes of a whole one: four
/// bytes each, three for the place, one for the bits that flip.
pub fn retained_database(bytes: &[u8]) {
    static WHOLE: OnceLock<Option<(Vec<u8>, RetainedData)>> = OnceLock::new();
    kt830::store::silence_database_check();
    let Some(folder) = scratch_folder() else { return };
    let file = folder.path().join(DATABASE_FILE);
    if std::fs::write(&file, bytes).is_ok() {
        drop(RetainedDatabase::peek(folder.path()));
    }
    let Some((whole, data)) = WHOLE.get_or_init(whole_database) else { return };
    let mut changed = whole.clone();
    for change in bytes.chunks_exact(4) {
        let at = usize::from(change[0]) << 16 | usize::from(change[1]) << 8 | usize::from(change[2]);
        let length = changed.len();
        changed[at % length] ^= change[3];
    }
    if std::fs::write(&file, changed).is_ok()
        && let Some(read) = RetainedDatabase::peek(folder.path())
    {
        assert!(read == *data, "other values are taken for whole");
    }
}

/// What takes the place of a damaged database: the journal, a kept state, the passwords. The bytes are read as they are, and
/// as lines of a journal whose checksums are right.
pub fn retained_copies(bytes: &[u8]) {
    let Some(folder) = scratch_folder() else { return };
    let journal = folder.path().join("retained.journal");
    if std::fs::write(&journal, bytes).is_ok() {
        drop(RetainedDatabase::newest_copy(folder.path()));
    }
    let text = String::from_utf8_lossy(bytes);
    let sealed: String = text.lines().map(|line| format!("{:016x} {line}\n", stamp(line.as_bytes()))).collect();
    if std::fs::write(&journal, sealed).is_ok() {
        drop(RetainedDatabase::newest_copy(folder.path()));
    }
    let path = Path::new("retained-0000000001.ron");
    for care in [ChecksumPolicy::Lenient, ChecksumPolicy::Strict] {
        drop(from_bytes::<RetainedData>(path, care, bytes));
        drop(from_bytes::<BTreeMap<String, String>>(path, care, bytes));
    }
}

/// A transmission over RS232: a program is no longer than what was sent in UTF-8, and names stay inside the folder.
pub fn serial(bytes: &[u8]) {
    let mut reader = SerialReader::new(SERIAL_LIMIT);
    for byte in bytes {
        match reader.push(*byte) {
            Ok(ReadProgress::More) => {}
            Ok(ReadProgress::Done) => break,
            Err(_) => return,
        }
    }
    drop(reader.timeout_error());
    for program in reader.into_programs(None, &shelf(), false).unwrap_or_default() {
        assert!(program.text.len() <= bytes.len() * 3 && shelf().is_program_name(&program.name), "{}", program.name);
    }
}

/// `settings.ron`, and the values of a stick.
pub fn settings(bytes: &[u8]) {
    let path = Path::new("settings.ron");
    for care in [ChecksumPolicy::Lenient, ChecksumPolicy::Strict] {
        drop(from_bytes::<StoredSettings>(path, care, bytes));
        if let Ok(read) = from_bytes::<Values>(path, care, bytes) {
            drop(check_values(&read.value, Kind::Gc));
        }
    }
}

/// A story for the kind that its length selects: its lines are in order.
pub fn story_text(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let kind = Kind::ALL[bytes.len() % Kind::ALL.len()];
    if let Ok((_, lines)) = story::parse(text, kind) {
        assert!(lines.is_sorted_by_key(|line| line.number));
    }
}
