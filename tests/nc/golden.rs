//! The interpreter against texts: programs and their operations side by side, and wrong programs with their errors.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kt830::defs::kind::Dialect;
use kt830::defs::text::Lang;
use kt830::nc::{
    CheckReport, CommonVariables, EmptyLibrary, Library, NcSettings, OfflineMachine, ProgramCheck, Source,
};

/// Programs of one folder, by number.
struct Folder(HashMap<u32, Arc<Source>>);

impl Library for Folder {
    fn find(&self, number: u32) -> Option<Arc<Source>> {
        self.0.get(&number).cloned()
    }
}

fn settings_for(text: &str) -> NcSettings {
    if text.contains("(MILL") { NcSettings::for_dialect(Dialect::Mill) } else { NcSettings::lathe_a() }
}

fn files(folder: &str, extension: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|found| found == extension));
    files.sort();
    files
}

fn run(path: &Path) -> (String, CheckReport) {
    run_as(path, None)
}

fn run_as(path: &Path, settings: Option<NcSettings>) -> (String, CheckReport) {
    let bytes = std::fs::read(path).unwrap();
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let settings = settings.unwrap_or_else(|| settings_for(&text));
    let library: HashMap<_, _> = files("tests/nc/sub", "NC")
        .iter()
        .filter_map(|path| {
            let number = path.file_stem()?.to_str()?.strip_prefix('O')?.parse().ok()?;
            Some((number, Arc::new(Source::new(number, "", std::fs::read(path).unwrap(), settings.dialect))))
        })
        .collect();
    let library: Arc<dyn Library + Send + Sync> = Arc::new(Folder(library));
    let source = Arc::new(Source::new(1001, path.file_name().unwrap().to_string_lossy(), bytes, settings.dialect));
    let mut world = OfflineMachine::new(&settings);
    let mut ops = String::new();
    let checking = ProgramCheck::new(&source, &library, &settings, CommonVariables::default());
    let checked = checking.run(&mut world, &mut |block| {
        for op in &block.ops {
            ops.push_str(&format!("{}:{} {op}\n", block.location.program, block.location.line));
        }
    });
    (ops, checked)
}

#[test]
fn t4_golden_programs_give_their_operations() {
    let programs = files("tests/nc", "NC");
    assert!(!programs.is_empty());
    for path in programs {
        let (ops, checked) = run(&path);
        let faults: Vec<_> = checked.faults.iter().map(|fault| fault.text(Lang::En)).collect();
        assert!(faults.is_empty(), "{}: {faults:#?}", path.display());
        let golden = path.with_extension("ops");
        let expected = std::fs::read_to_string(&golden).unwrap_or_default();
        assert_eq!(ops, expected, "{}\n{ops}", path.display());
    }
}

/// The first line says what is wrong: `; line:column cause`, several parted by ` | `.
#[test]
fn b1_wrong_programs_name_every_error_with_line_and_column() {
    for path in files("tests/nc/bad", "NC") {
        let (_, checked) = run(&path);
        let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        let expected = text.lines().next().unwrap().trim_start_matches([';', ' ']);
        let found: Vec<_> = checked
            .faults
            .iter()
            .map(|fault| format!("{}:{} {}", fault.location.line, fault.column, fault.cause(Lang::En)))
            .collect();
        assert_eq!(found.join(" | "), expected, "{}", path.display());
    }
}

/// The manual's own examples and a shaft: operations worked out from its text stand beside the tests.
#[test]
fn l1_to_l8_the_manuals_examples_give_their_operations() {
    let mut programs = files("programs/lathe", "NC");
    assert!(programs.len() >= 12);
    programs.extend(files("tests/nc/lathe", "NC"));
    for path in programs {
        let (ops, checked) = run_as(&path, Some(NcSettings::for_dialect(Dialect::SuperMan)));
        let faults: Vec<_> = checked.faults.iter().map(|fault| fault.text(Lang::En)).collect();
        assert!(faults.is_empty() && checked.finished, "{}: {faults:#?}", path.display());
        // L5: the printed two-start thread, lead 4, begins at Z6: less than three leads.
        let short = checked.warnings.iter().filter(|warning| warning.text(Lang::En).contains("less than three leads"));
        assert_eq!(short.count() > 0, path.ends_with("TWOSTART.NC"), "{}", path.display());
        let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/nc/lathe");
        let golden = golden.join(path.file_name().unwrap()).with_extension("ops");
        let expected = std::fs::read_to_string(&golden).unwrap_or_default();
        assert_eq!(ops, expected, "{}\n{ops}", path.display());
    }
}

/// The first line says what is wrong: `(line:column cause)`, warnings behind a `?`, several parted by ` | `.
#[test]
fn l1_to_l8_wrong_programs_name_every_error_with_line_and_column() {
    let programs = files("tests/nc/lathe/bad", "NC");
    assert!(programs.len() >= 10);
    for path in programs {
        let (_, checked) = run_as(&path, Some(NcSettings::for_dialect(Dialect::SuperMan)));
        let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        let expected = text.lines().next().unwrap().trim_start_matches("; ");
        let told = |fault: &kt830::nc::ProgramFault| {
            format!("{}:{} {}", fault.location.line, fault.column, fault.cause(Lang::En))
        };
        let found: Vec<_> = checked.faults.iter().map(told).collect();
        let remarks = checked.warnings.iter().map(|fault| format!("?{}", told(fault)));
        let found: Vec<_> = found.into_iter().chain(remarks).collect();
        assert_eq!(found.join(" | "), expected, "{}", path.display());
    }
}

#[test]
fn b1_an_empty_library_has_no_programs() {
    assert!(EmptyLibrary.find(1).is_none());
}

/// What to do about it, in the words of the 超人 lathe: no variables, no brackets, no J.
#[test]
fn l1_remedies_name_what_this_language_has() {
    let rows = [
        ("G01X", "write the value", "请在其后写出数值"),
        ("G02U10W-5", "write the radius R, or the centre I K", "请写半径 R，或圆心坐标 I K"),
        ("G32W-50F14.1", "33.2 is 33½", "33.2 是 33½"),
    ];
    for (block, en, zh) in rows {
        let text = format!("N0010G01U-1F300\nN0015M03\nN0020{block}\nN0030M02\n");
        let library: Arc<dyn Library + Send + Sync> = Arc::new(EmptyLibrary);
        let source = Arc::new(Source::new(7_000, "T.NC", text.into_bytes(), Dialect::SuperMan));
        let checked = kt830::nc::check(&source, &library, &NcSettings::for_dialect(Dialect::SuperMan));
        let [fault] = checked.faults.as_slice() else { panic!("{block}: {:?}", checked.faults) };
        assert!(fault.remedy(Lang::En).contains(en), "{block}: {}", fault.remedy(Lang::En));
        assert!(fault.remedy(Lang::Zh).contains(zh), "{block}: {}", fault.remedy(Lang::Zh));
    }
    // 256 loops one in the other.
    let text = format!("{}{}N0003M02\n", "N0001G22L0001\n".repeat(256), "N0002G80\n".repeat(256));
    let library: Arc<dyn Library + Send + Sync> = Arc::new(EmptyLibrary);
    let source = Arc::new(Source::new(7_000, "T.NC", text.into_bytes(), Dialect::SuperMan));
    let checked = kt830::nc::check(&source, &library, &NcSettings::for_dialect(Dialect::SuperMan));
    assert_eq!(checked.faults[0].cause(Lang::En), "G22 nested deeper than 255");
    assert_eq!(checked.faults[0].cause(Lang::Zh), "G22 嵌套超过 255 层");
}
