//! Creates a control with its simulated machine from the arguments of the call.

use std::path::Path;

use super::CallError;
use super::args::SharedArgs;
use crate::controller::PowerOnState;
use crate::host::bar::{self, program_subfolder};
use crate::host::folders::{Folders, named_programs_beside, program_from_bytes};
use crate::host::headless::{HeadlessHost, HostSetup};
use crate::host::retained_store::RetainedStore;
use crate::io::sim::PartFile;
use crate::link::command::Command;
use crate::nc::CommonVariables;
use crate::store::{DataDir, StoredSettings};

/// Program number of a file without a number in its name.
const DEFAULT_NUMBER: u32 = 9_999;

/// Kind and language: from the call, otherwise from the machine's settings, otherwise GC and Chinese. The settings are
/// read with `--data`, or when the control itself is opened.
///
/// # Errors
/// The data directory or the settings in it cannot be read.
pub fn resolve_settings(mut shared: SharedArgs, opens_control: bool) -> Result<SharedArgs, CallError> {
    let stored = if shared.data.is_some() || opens_control {
        let data = DataDir::resolve(shared.data.as_deref()).map_err(CallError::new)?;
        StoredSettings::read(data.root()).map_err(CallError::new)?
    } else {
        StoredSettings::default()
    };
    shared.kind = shared.requested_kind.or(stored.kind).unwrap_or_default();
    shared.lang = shared.requested_lang.or(stored.lang).unwrap_or_default();
    shared.light = stored.light.unwrap_or_default();
    shared.brightness = stored.brightness.unwrap_or(shared.brightness);
    Ok(shared)
}

/// The folders: from the call, otherwise in the current directory, otherwise in the data directory.
///
/// # Errors
/// A folder cannot be created.
pub fn folders(shared: &SharedArgs) -> Result<Folders, CallError> {
    let data = DataDir::resolve(shared.data.as_deref()).map_err(CallError::new)?;
    let (programs, screens) = (shared.programs.clone(), shared.screens.clone());
    let folders = Folders::resolve(programs, screens, &data, shared.kind).map_err(CallError::new)?;
    match program_subfolder(shared.kind) {
        None => Ok(folders),
        Some(_) if shared.programs.is_some() => Ok(Folders { by_name: true, ..folders }),
        Some(name) => folders.subfolder_by_name(name).map_err(CallError::new),
    }
}

/// Initial data of a check: retained data with `--data` if they are not in use, otherwise factory values.
///
/// # Errors
/// As [`apply_overrides`].
pub fn check_retained(shared: &SharedArgs) -> Result<PowerOnState, CallError> {
    let kept = shared.data.is_some().then(|| {
        let data = DataDir::resolve(shared.data.as_deref()).map_err(CallError::new)?;
        RetainedStore::open(data.root(), shared.kind).map(|(_, found)| found.retained).map_err(CallError::new)
    });
    let retained = match kept {
        Some(Ok(retained)) => retained,
        Some(Err(error)) => {
            eprintln!("kt830: {error}; the check goes by factory values");
            PowerOnState::factory(shared.kind)
        }
        None => PowerOnState::factory(shared.kind),
    };
    apply_overrides(shared, retained)
}

/// Applies `--param` and `--set_variable` to factory or retained data.
///
/// # Errors
/// A parameter or variable does not exist or does not take the value.
pub fn apply_overrides(shared: &SharedArgs, mut retained: PowerOnState) -> Result<PowerOnState, CallError> {
    for (at, value) in &shared.params {
        retained.params.write(*at, *value).map_err(|error| CallError::new(format!("--param {at}={value}: {error}")))?;
    }
    for (number, value) in &shared.sets {
        set_variable(&mut retained.variables, *number, *value)?;
    }
    Ok(retained)
}

fn set_variable(variables: &mut CommonVariables, number: u16, value: f64) -> Result<(), CallError> {
    variables
        .set(u32::from(number), Some(value))
        .map_err(|error| CallError::new(format!("--set #{number}={value}: {error}")))
}

/// Creates a rig for a headless job; it uses retained data only with `--data`.
///
/// # Errors
/// Data, folders or the machine cannot be opened.
pub fn headless_host(shared: &SharedArgs) -> Result<HeadlessHost, CallError> {
    let (keeper, retained, damaged) = match &shared.data {
        Some(_) => {
            let data = DataDir::resolve(shared.data.as_deref()).map_err(CallError::new)?;
            let (keeper, found) = RetainedStore::open(data.root(), shared.kind).map_err(CallError::new)?;
            for value in &found.dropped {
                eprintln!("kt830: retained value {value} is not allowed any more and was left out");
            }
            (Some(keeper), found.retained, found.damaged)
        }
        None => (None, PowerOnState::factory(shared.kind), None),
    };
    let setup = HostSetup {
        kind: shared.kind,
        retained: apply_overrides(shared, retained)?,
        store: keeper,
        folders: folders(shared)?,
        seed: shared.seed,
    };
    let mut rig = HeadlessHost::new(setup).map_err(CallError::new)?;
    let prints = shared.data.is_some().then(|| DataDir::resolve(shared.data.as_deref()).map(|data| data.screenshots()));
    rig.set_drives(prints.transpose().map_err(CallError::new)?, shared.usb.clone());
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
pub fn part(shared: &SharedArgs, number: u32) -> Result<Option<PartFile>, CallError> {
    match &shared.part {
        Some(path) => read_part_file(path).map(Some),
        None => PartFile::builtin(number).map_err(CallError::new),
    }
}

/// The variables of a part, without those that the call sets.
pub fn part_variables(part: &PartFile, sets: &[(u16, f64)]) -> impl Iterator<Item = (u16, f64)> {
    let set = |number: u16| sets.iter().any(|(set, _)| *set == number);
    part.variables.iter().map(|(number, value)| (*number, *value)).filter(move |(number, _)| !set(*number))
}

/// Reads a part file.
///
/// # Errors
/// The file cannot be read.
pub fn read_part_file(path: &Path) -> Result<PartFile, CallError> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| CallError::new(format!("part file {}: {error}; check the path", path.display())))?;
    PartFile::parse(&text).map_err(|error| CallError::new(format!("part file {}: {error}", path.display())))
}

/// Finds the program of the call, a number or name in the folder or a file; adds a file to the rig.
///
/// # Errors
/// There is no such program.
pub fn find_program(rig: &mut HeadlessHost, word: &str) -> Result<u32, CallError> {
    if let Some(number) = crate::story::parse::program(word)
        && rig.has_program(number)
    {
        return Ok(number);
    }
    if let Some(number) = rig.find_program(word) {
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
    let by_name = program_subfolder(rig.kind()).is_some() && !stem.is_empty();
    let named = if by_name { Some(crate::defs::program_number::from_name(&stem)) } else { named };
    let number = named.unwrap_or(DEFAULT_NUMBER);
    rig.add_programs(named_programs_beside(path, rig.kind().dialect()));
    rig.add_program(program_from_bytes(number, word, bytes, rig.kind().dialect()));
    Ok(number)
}

/// Mounts the part of a program, if there is one, and loads the program.
///
/// # Errors
/// The part file cannot be read.
pub fn mount_part(rig: &mut HeadlessHost, shared: &SharedArgs, number: u32) -> Result<(), CallError> {
    let given = match rig.program_source(number) {
        Some(source) if shared.part.is_none() => bar::bar_of_program(shared.kind, &rig.retained().params, &source),
        Some(_) | None => None,
    };
    if let Some(part) = given.map_or_else(|| part(shared, number), |bar| Ok(Some(bar)))? {
        rig.mount_part(&part);
        // A control without retained data has factory variables; the part's program needs its own.
        if shared.data.is_none() {
            for (number, value) in part_variables(&part, &shared.sets) {
                rig.send(Command::SetVariable(number, Some(value)));
            }
        }
    }
    rig.send(Command::LoadProgram(number));
    Ok(())
}
