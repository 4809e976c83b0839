//! Creates a control with its simulated machine from the arguments of the call.

use std::path::Path;

use super::CallError;
use super::args::Shared;
use crate::controller::Retained;
use crate::io::sim::PartFile;
use crate::link::command::Command;
use crate::nc::Memory;
use crate::runtime::bar::{self, own_programs};
use crate::runtime::disk::{Folders, beside, program};
use crate::runtime::keeper::Keeper;
use crate::runtime::rig::{Rig, Setup};
use crate::store::{DataDir, Settings};

/// Program number of a file without a number in its name.
const UNNUMBERED: u32 = 9_999;

/// Kind and language: from the call, otherwise from the machine's settings, otherwise GC and Chinese. The settings are
/// read with `--data`, or when the control itself is opened.
///
/// # Errors
/// The data directory or the settings in it cannot be read.
pub fn settle(mut shared: Shared, opens_control: bool) -> Result<Shared, CallError> {
    let stored = if shared.data.is_some() || opens_control {
        let data = DataDir::resolve(shared.data.as_deref()).map_err(CallError::new)?;
        Settings::read(data.root()).map_err(CallError::new)?
    } else {
        Settings::default()
    };
    shared.kind = shared.kind_asked.or(stored.kind).unwrap_or_default();
    shared.lang = shared.lang_asked.or(stored.lang).unwrap_or_default();
    shared.light = stored.light.unwrap_or_default();
    shared.brightness = stored.brightness.unwrap_or(shared.brightness);
    Ok(shared)
}

/// The folders: from the call, otherwise in the current directory, otherwise in the data directory.
///
/// # Errors
/// A folder cannot be created.
pub fn folders(shared: &Shared) -> Result<Folders, CallError> {
    let data = DataDir::resolve(shared.data.as_deref()).map_err(CallError::new)?;
    let (programs, screens) = (shared.programs.clone(), shared.screens.clone());
    let folders = Folders::resolve(programs, screens, &data, shared.kind).map_err(CallError::new)?;
    match own_programs(shared.kind) {
        None => Ok(folders),
        Some(_) if shared.programs.is_some() => Ok(Folders { named: true, ..folders }),
        Some(name) => folders.by_name(name).map_err(CallError::new),
    }
}

/// Initial data of a check: retained data with `--data` if they are not in use, otherwise factory values.
///
/// # Errors
/// As [`begin`].
pub fn retained(shared: &Shared) -> Result<Retained, CallError> {
    let kept = shared.data.is_some().then(|| {
        let data = DataDir::resolve(shared.data.as_deref()).map_err(CallError::new)?;
        Keeper::open(data.root(), shared.kind).map(|(_, found)| found.retained).map_err(CallError::new)
    });
    let retained = match kept {
        Some(Ok(retained)) => retained,
        Some(Err(error)) => {
            eprintln!("kt830: {error}; the check goes by factory values");
            Retained::factory(shared.kind)
        }
        None => Retained::factory(shared.kind),
    };
    begin(shared, retained)
}

/// Applies `--param` and `--set` to factory or retained data.
///
/// # Errors
/// A parameter or variable does not exist or does not take the value.
pub fn begin(shared: &Shared, mut retained: Retained) -> Result<Retained, CallError> {
    for (at, value) in &shared.params {
        retained.params.write(*at, *value).map_err(|error| CallError::new(format!("--param {at}={value}: {error}")))?;
    }
    for (number, value) in &shared.sets {
        set(&mut retained.variables, *number, *value)?;
    }
    Ok(retained)
}

fn set(variables: &mut Memory, number: u16, value: f64) -> Result<(), CallError> {
    variables
        .set(u32::from(number), Some(value))
        .map_err(|error| CallError::new(format!("--set #{number}={value}: {error}")))
}

/// Creates a rig for a headless job; it uses retained data only with `--data`.
///
/// # Errors
/// Data, folders or the machine cannot be opened.
pub fn rig(shared: &Shared) -> Result<Rig, CallError> {
    let (keeper, retained, damaged) = match &shared.data {
        Some(_) => {
            let data = DataDir::resolve(shared.data.as_deref()).map_err(CallError::new)?;
            let (keeper, found) = Keeper::open(data.root(), shared.kind).map_err(CallError::new)?;
            for value in &found.dropped {
                eprintln!("kt830: retained value {value} is not allowed any more and was left out");
            }
            (Some(keeper), found.retained, found.damaged)
        }
        None => (None, Retained::factory(shared.kind), None),
    };
    let setup = Setup {
        kind: shared.kind,
        retained: begin(shared, retained)?,
        keeper,
        folders: folders(shared)?,
        seed: shared.seed,
    };
    let mut rig = Rig::new(setup).map_err(CallError::new)?;
    let prints = shared.data.is_some().then(|| DataDir::resolve(shared.data.as_deref()).map(|data| data.prints()));
    rig.plug_in(prints.transpose().map_err(CallError::new)?, shared.usb.clone());
    if let Some(damaged) = damaged {
        eprintln!("kt830: the retained data were damaged; the copy is kept as {damaged}; factory values are in force");
        rig.report_damage(&damaged);
    }
    Ok(rig)
}

/// The part: `--part`, otherwise the built-in part of the program.
///
/// # Errors
/// The file cannot be read.
pub fn part(shared: &Shared, number: u32) -> Result<Option<PartFile>, CallError> {
    match &shared.part {
        Some(path) => part_file(path).map(Some),
        None => PartFile::builtin(number).map_err(CallError::new),
    }
}

/// The variables of a part, without those that the call sets.
pub fn own_values(part: &PartFile, sets: &[(u16, f64)]) -> impl Iterator<Item = (u16, f64)> {
    let set = |number: u16| sets.iter().any(|(set, _)| *set == number);
    part.variables.iter().map(|(number, value)| (*number, *value)).filter(move |(number, _)| !set(*number))
}

/// Reads a part file.
///
/// # Errors
/// The file cannot be read.
pub fn part_file(path: &Path) -> Result<PartFile, CallError> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| CallError::new(format!("part file {}: {error}; check the path", path.display())))?;
    PartFile::parse(&text).map_err(|error| CallError::new(format!("part file {}: {error}", path.display())))
}

/// Finds the program of the call, a number or name in the folder or a file; adds a file to the rig.
///
/// # Errors
/// There is no such program.
pub fn find_program(rig: &mut Rig, word: &str) -> Result<u32, CallError> {
    if let Some(number) = crate::story::parse::program(word)
        && rig.has_program(number)
    {
        return Ok(number);
    }
    if let Some(number) = rig.program_named(word) {
        return Ok(number);
    }
    let path = Path::new(word);
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let named = crate::story::parse::program(&stem);
    if !path.is_file()
        && let Some(number) = named
        && rig.has_program(number)
    {
        return Ok(number);
    }
    if !path.is_file() {
        return Err(CallError::new(format!(
            "there is no program {word}: neither in the programs folder nor as a file; `--programs DIR` names another folder"
        )));
    }
    let bytes = std::fs::read(path).map_err(|error| CallError::new(format!("{word}: {error}")))?;
    // L1: every program of a lathe has a name of at least one letter.
    let by_name = own_programs(rig.kind()).is_some() && !stem.is_empty();
    let named = if by_name { Some(crate::defs::program::number(&stem)) } else { named };
    let number = named.unwrap_or(UNNUMBERED);
    rig.add_programs(beside(path));
    rig.add_program(program(number, word, bytes));
    Ok(number)
}

/// Mounts the part of a program, if there is one, and loads the program.
///
/// # Errors
/// The part file cannot be read.
pub fn mount(rig: &mut Rig, shared: &Shared, number: u32) -> Result<(), CallError> {
    let given = match rig.program_source(number) {
        Some(source) if shared.part.is_none() => bar::of_program(shared.kind, &rig.retained().params, &source),
        Some(_) | None => None,
    };
    if let Some(part) = given.map_or_else(|| part(shared, number), |bar| Ok(Some(bar)))? {
        rig.mount(&part);
        // A control without retained data has factory variables; the part's program needs its own.
        if shared.data.is_none() {
            for (number, value) in own_values(&part, &shared.sets) {
                rig.send(Command::SetVariable(number, Some(value)));
            }
        }
    }
    rig.send(Command::LoadProgram(number));
    Ok(())
}
