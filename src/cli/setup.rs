//! Creates a control with its machine from the arguments of the call.

use std::path::Path;
#[cfg(feature = "hmi")]
use std::path::PathBuf;

use serde::de::IgnoredAny;
use serde::{Deserialize, Deserializer};

use super::args::SharedArgs;
use super::{CallError, languages};
use crate::controller::{PowerOnState, Programs};
use crate::defs::alarm;
use crate::defs::favourite::Favourite;
use crate::defs::kind::Kind;
use crate::defs::param::Params;
use crate::defs::program_number;
use crate::defs::text::{LocalizedText, phrase};
use crate::host::Host;
use crate::host::cycle_time;
use crate::host::folders::{Folders, ProgramUse, named_programs_beside, programs_from_file};
use crate::host::headless::HeadlessHost;
use crate::host::hosted_machine::HostedMachine;
use crate::host::job_runner::JobRunner;
#[cfg(target_os = "linux")]
use crate::host::modbus::ModbusLink;
use crate::host::retained_store::RetainedStore;
use crate::host::simulated::HostedSimulation;
use crate::host::storage::{DirectStorage, RetainedWorker, Storage};
use crate::host::storage::{StorageWorker, ThreadedStorage};
#[cfg(target_os = "linux")]
use crate::io::ethercat::EtherCat;
#[cfg(target_os = "linux")]
use crate::io::fieldbus::FieldBusMachine;
#[cfg(target_os = "linux")]
use crate::io::fieldbus::description::MachineDescription;
#[cfg(target_os = "linux")]
use crate::io::fieldbus::station::StationLink;
use crate::io::sim::{MachineFile, PartFile, SimulatedMachine};
use crate::link::command::Command;
use crate::store::{
    DataDir, PROGRAM_LIMIT, REAL_MACHINE_MARK, StoredLang, StoredSettings, TEXT_LIMIT, read_regular_file,
};
use crate::story::parse;
use crate::units::Micros;

/// Update interval of the simulator page on a display.
const SIM_VIEW_INTERVAL: Micros = Micros::from_millis(100);

/// Kind and language: from the call, otherwise from the machine's settings, otherwise GC and Chinese. The settings are
/// read with `--data`, when the control itself is opened, and for the model of the machine.
///
/// # Errors
/// The data directory or the settings in it cannot be read.
pub fn resolve_settings(mut shared: SharedArgs, opens_control: bool) -> Result<SharedArgs, CallError> {
    let mut stored = StoredSettings::default();
    if shared.data.is_some() || opens_control {
        let data = data_dir(&shared)?;
        let kind = RetainedStore::kind_of(data.root());
        (stored, shared.settings_fault) = read_settings(data.root(), kind);
        // The kind of machine belongs to the retained data.
        stored.kind = kind.or(stored.kind);
        if let (Some(asked), Some(kind)) = (shared.requested_kind, kind)
            && asked != kind
        {
            return Err(CallError::new(format!(
                "--kind {}: the data in {} are those of kind {}; leave --kind out, choose the kind on the settings page, or take another --data",
                asked.id(),
                data.root().display(),
                kind.id()
            )));
        }
    }
    shared.kind = shared.requested_kind.or(stored.kind).unwrap_or_default();
    languages::read(&mut shared, stored.lang.as_ref().map(StoredLang::code), opens_control, data_dir)?;
    shared.light = stored.light.unwrap_or_default();
    shared.favourites = known_favourites(&stored.favourites);
    shared.brightness = stored.brightness.unwrap_or(shared.brightness);
    shared.zoom = shared.zoom.or(stored.zoom);
    Ok(shared)
}

/// The screen as it is set.
#[cfg(feature = "hmi")]
pub fn screen(shared: &SharedArgs) -> crate::hmi::Hmi {
    let mut hmi = crate::hmi::Hmi::new(shared.lang);
    hmi.add_languages(&shared.added_languages, shared.has_language_faults);
    hmi.set_light(shared.light);
    hmi.set_zoom(shared.zoom.unwrap_or_default());
    hmi.set_favourites(shared.favourites.clone());
    hmi
}

/// The favourites that this version knows: an unknown one stops nobody's work.
fn known_favourites(kept: &[String]) -> Vec<Favourite> {
    let known = |text: &String| match text.parse() {
        Ok(favourite) => Some(favourite),
        Err(fault) => {
            warn_line!("kt830: settings: {fault}");
            None
        }
    };
    kept.iter().filter_map(known).collect()
}

/// The settings of a data directory, and what is wrong with them: the control starts with what is whole and says so.
fn read_settings(folder: &Path, data_kind: Option<Kind>) -> (StoredSettings, Option<LocalizedText>) {
    let (stored, warning) = match StoredSettings::read_with_warnings(folder) {
        // A file that was edited by hand cannot be told from one with a flipped bit.
        Ok((stored, warnings)) => (stored, warnings.first().map(ToString::to_string)),
        Err(error) => (StoredSettings::default(), Some(error.to_string())),
    };
    let other = stored.kind.zip(data_kind).filter(|(set, data)| set != data);
    let mismatch = other.map(|(set, data)| {
        let (set, data) = (set.short_name(), data.short_name());
        phrase!("设置为 {set}，数据为 {data}", "settings {set}, data {data}", set, data)
    });
    (stored, mismatch.or(warning.map(|what| LocalizedText::same(&what))))
}

/// The data directory: from the call, otherwise the platform's.
///
/// # Errors
/// The platform has none, or it cannot be created.
pub fn data_dir(shared: &SharedArgs) -> Result<DataDir, CallError> {
    let found = DataDir::resolve(shared.data.as_deref()).map_err(CallError::new)?;
    match shared.data {
        Some(_) => Ok(found),
        None => data_dir_of_kind(found, shared.requested_kind),
    }
}

/// The platform's data directory for a kind that is asked for: its own folder in it, if the data are those of another.
fn data_dir_of_kind(found: DataDir, asked: Option<Kind>) -> Result<DataDir, CallError> {
    let own = RetainedStore::kind_of(found.root());
    match asked.filter(|asked| own.is_some_and(|own| own != *asked)) {
        Some(kind) => DataDir::resolve(Some(&found.root().join(kind.id()))).map_err(CallError::new),
        None => Ok(found),
    }
}

/// The folders: from the call, otherwise in the current directory, otherwise in the data directory.
///
/// # Errors
/// A folder cannot be created.
pub fn folders(shared: &SharedArgs) -> Result<Folders, CallError> {
    let data = data_dir(shared)?;
    let (programs, screens) = (shared.programs.clone(), shared.screens.clone());
    Folders::resolve(programs, screens, &data, shared.kind).map_err(CallError::new)
}

/// Initial data of a check: retained data with `--data` if they are not in use, otherwise factory values.
///
/// # Errors
/// As [`apply_overrides`].
pub fn check_retained(shared: &SharedArgs) -> Result<PowerOnState, CallError> {
    let factory = || PowerOnState::factory(shared.kind);
    let read = |data: DataDir| {
        let found = RetainedStore::read_only(data.root(), shared.kind);
        if found.is_none() {
            warn_line!("kt830: {}: no whole data; the check uses factory values", data.root().display());
        }
        found
    };
    apply_overrides(shared, named_data(shared)?.and_then(read).unwrap_or_else(factory))
}

/// Applies `--param` and `--set` to factory or retained data.
///
/// # Errors
/// A parameter or variable does not exist or does not take the value.
pub fn apply_overrides(shared: &SharedArgs, mut retained: PowerOnState) -> Result<PowerOnState, CallError> {
    for (at, value) in &shared.params {
        retained.params.write(*at, *value).map_err(CallError::at(format!("--param {at}={value}")))?;
    }
    for (number, value) in &shared.sets {
        let set = retained.variables.set(u32::from(*number), Some(*value));
        set.map_err(CallError::at(format!("--set #{number}={value}")))?;
    }
    Ok(retained)
}

/// What a control starts with: retained data, their store, and how it runs jobs.
struct HostParts {
    retained: PowerOnState,
    store: Option<RetainedStore>,
    /// Alarms of data and settings that stand until a person has decided.
    standing: Vec<(u16, LocalizedText)>,
    jobs: JobRunner,
}

/// Opens the retained data of a directory, or takes factory values without one, and the folders.
fn host_parts(shared: &SharedArgs, data: Option<DataDir>) -> Result<HostParts, CallError> {
    let jobs = JobRunner::new(folders(shared)?)
        .with_cycle_timer(cycle_time::simulate)
        .with_drives(data.as_ref().map(DataDir::screenshots), shared.usb.clone())
        .with_serial(shared.serial.clone(), data.as_ref().map(|data| data.root().to_path_buf()));
    let Some(data) = data else {
        let retained = apply_overrides(shared, PowerOnState::factory(shared.kind))?;
        return Ok(HostParts { retained, store: None, standing: Vec::new(), jobs });
    };
    let (store, found) = RetainedStore::open(data.root(), shared.kind).map_err(CallError::new)?;
    for value in &found.dropped {
        warn_line!("kt830: retained value {value} is no longer allowed and was ignored");
    }
    if let Some(loss) = &found.loss {
        warn_line!("kt830: the retained data were damaged or gone and are not accepted yet: {}", loss.message().en());
    }
    if let Some(fault) = &shared.settings_fault {
        warn_line!("kt830: settings: {}", fault.en());
    }
    let settings = shared.settings_fault.clone().map(|what| (alarm::SETTINGS_INVALID, what));
    let mut standing = found.standing();
    // A store that takes nothing has said so itself.
    let unwritable = data.fault().filter(|_| found.unkept.is_none());
    standing.extend(unwritable.map(|what| (alarm::STORE_FAILED, what.clone())));
    standing.extend(settings);
    let retained = apply_overrides(shared, found.retained)?;
    Ok(HostParts { retained, store: Some(store), standing, jobs })
}

/// The data directory, if the call names one.
fn named_data(shared: &SharedArgs) -> Result<Option<DataDir>, CallError> {
    shared.data.is_some().then(|| data_dir(shared)).transpose()
}

/// Name of the description of the machine in a data directory.
const MACHINE_FILE: &str = "machine.ron";

/// Why a simulation is refused on the data of a real machine.
const SIMULATION_WRITES: &str = "a simulation would count its parts and store its values in them";

/// Refuses what would change the data of a real machine from outside its pages, where its passwords guard them.
///
/// # Errors
/// A description of a machine is installed in the directory.
pub fn refuse_real_data(data: &DataDir, what: &str) -> Result<(), CallError> {
    match [MACHINE_FILE, REAL_MACHINE_MARK].iter().find(|name| is_there(&data.root().join(name))) {
        None => Ok(()),
        Some(name) => Err(CallError::new(format!(
            "{}: the data of a real machine; {what}. Copy the folder without {name} and name the copy with --data",
            data.root().join(name).display()
        ))),
    }
}

/// The data directory of a simulation, if the call names one.
fn simulation_data(shared: &SharedArgs) -> Result<Option<DataDir>, CallError> {
    let data = named_data(shared)?;
    if let Some(data) = &data {
        refuse_real_data(data, SIMULATION_WRITES)?;
    }
    Ok(data)
}

/// The file that describes the real machine: that of the call, otherwise the one in the data directory; none if the call
/// names a simulated machine.
///
/// # Errors
/// The file or the data directory cannot be read, or a simulated machine is asked for on the data of a real one.
#[cfg(feature = "hmi")]
pub fn real_machine(shared: &SharedArgs) -> Result<Option<PathBuf>, CallError> {
    if let Some(file) = &shared.machine {
        let text = read_text("machine", file)?;
        if describes_real_machine(&text) {
            return Ok(Some(file.clone()));
        }
        simulated_machine(shared)?;
        refuse_real_data(&data_dir(shared)?, SIMULATION_WRITES)?;
        return Ok(None);
    }
    let root = data_dir(shared)?.root().to_path_buf();
    // A file that is there and cannot be read is no simulated machine, nor is one that was there.
    let is_real = [MACHINE_FILE, REAL_MACHINE_MARK].iter().any(|name| is_there(&root.join(name)));
    Ok(is_real.then(|| root.join(MACHINE_FILE)))
}

/// Notes in the data directory that its data are those of a real machine: no simulation uses them from now on.
///
/// # Errors
/// The data directory cannot be read. A disk that takes nothing has its alarm already.
#[cfg(feature = "hmi")]
pub fn mark_real_machine(shared: &SharedArgs, file: &Path) -> Result<(), CallError> {
    let mark = data_dir(shared)?.root().join(REAL_MACHINE_MARK);
    if is_there(&mark) {
        return Ok(());
    }
    let told = format!("The data of a real machine, described in {}. No simulation uses them.\n", file.display());
    if let Err(error) = crate::store::write_atomic(&mark, told.as_bytes()) {
        warn_line!("kt830: {error}");
    }
    Ok(())
}

/// The parameters in the data directory, or the factory ones. Nothing is written.
///
/// # Errors
/// The data directory cannot be read.
pub fn kept_params(shared: &SharedArgs) -> Result<Params, CallError> {
    let kept = RetainedStore::read_only(data_dir(shared)?.root(), shared.kind);
    Ok(kept.unwrap_or_else(|| PowerOnState::factory(shared.kind)).params)
}

/// Whether something has this name, whether it can be read or not.
fn is_there(path: &Path) -> bool {
    !path.symlink_metadata().is_err_and(|error| error.kind() == std::io::ErrorKind::NotFound)
}

/// Reads the description of a real machine.
///
/// # Errors
/// The file cannot be read, or a value in it is wrong.
#[cfg(target_os = "linux")]
pub fn read_description(file: &Path) -> Result<MachineDescription, CallError> {
    let text = read_text("machine description", file)?;
    MachineDescription::parse(&text).map_err(CallError::at(file.display()))
}

/// A machine on its field bus, which goes into operation with the first tick.
///
/// # Errors
/// The process has opened a bus before.
#[cfg(target_os = "linux")]
pub fn open_bus(description: MachineDescription) -> Result<FieldBusMachine<EtherCat>, CallError> {
    let bus = EtherCat::new(&description.ethercat).ok_or_else(|| CallError::new("the field bus is open already"))?;
    let mut links: Vec<Box<dyn StationLink>> = Vec::new();
    for station in &description.stations {
        links.push(Box::new(ModbusLink::start(station.clone()).map_err(CallError::new)?));
    }
    Ok(FieldBusMachine::new(description, bus, links))
}

/// The simulated machine of the call: that of `--machine`, else the one of the kind.
fn simulated_machine(shared: &SharedArgs) -> Result<MachineFile, CallError> {
    let Some(file) = &shared.machine else { return MachineFile::builtin(shared.kind).map_err(CallError::new) };
    let text = read_text("machine", file)?;
    MachineFile::of_text(&text, shared.kind).map_err(|error| match describes_real_machine(&text) {
        true => CallError::new(format!(
            "--machine {}: only the control itself runs a real machine; `kt830 bus FILE` looks at it",
            file.display()
        )),
        false => CallError::new(format!("--machine {}: {error}", file.display())),
    })
}

/// Whether a file is the description of a real machine.
fn describes_real_machine(text: &str) -> bool {
    /// There, whatever it holds.
    #[derive(Default)]
    struct Present(bool);

    impl<'de> Deserialize<'de> for Present {
        fn deserialize<D: Deserializer<'de>>(field: D) -> Result<Self, D::Error> {
            IgnoredAny::deserialize(field).map(|_| Self(true))
        }
    }

    #[derive(Deserialize)]
    struct Head {
        #[serde(default)]
        ethercat: Present,
    }

    // A text that is not to be read says so as what its words say it is.
    let by_words = || text.lines().any(|line| line.trim_start_matches(['(', ' ', '\t']).starts_with("ethercat:"));
    ron::from_str(text).map_or_else(|_| by_words(), |head: Head| head.ethercat.0)
}

/// The simulated machine of the call. The view of the simulator page is built anew at most every `view_interval`.
fn simulated(shared: &SharedArgs, params: &Params, view_interval: Micros) -> Result<HostedSimulation, CallError> {
    let file = simulated_machine(shared)?;
    Ok(HostedSimulation::new(SimulatedMachine::new(file, None, params, shared.seed), view_interval))
}

/// The simulated machine of the call, for a display.
///
/// # Errors
/// The machine file is invalid.
pub fn simulated_for_display(shared: &SharedArgs, params: &Params) -> Result<HostedSimulation, CallError> {
    simulated(shared, params, SIM_VIEW_INTERVAL)
}

/// Creates a host for a headless job; it uses retained data only with `--data`.
///
/// # Errors
/// Data, folders or the machine cannot be opened.
pub fn headless_host(shared: &SharedArgs) -> Result<HeadlessHost, CallError> {
    let parts = host_parts(shared, simulation_data(shared)?)?;
    let storage = DirectStorage::new(RetainedWorker::new(parts.store), parts.jobs).map_err(CallError::new)?;
    let machine = simulated(shared, &parts.retained.params, Micros::ZERO)?;
    let mut host = Host::connect(shared.kind, parts.retained, machine, storage);
    parts.standing.iter().for_each(|(number, what)| host.report_standing(*number, what));
    Ok(host)
}

/// Creates a host for a headless job that stores nothing.
///
/// # Errors
/// Folders or the machine cannot be opened.
pub fn unstored_host(shared: &SharedArgs, retained: PowerOnState) -> Result<HeadlessHost, CallError> {
    let storage =
        DirectStorage::new(RetainedWorker::new(None), JobRunner::new(folders(shared)?)).map_err(CallError::new)?;
    let machine = simulated(shared, &retained.params, Micros::ZERO)?;
    Ok(Host::connect(shared.kind, retained, machine, storage))
}

/// The program of a run.
#[derive(Clone, Copy, Debug)]
pub enum ProgramToRun<'a> {
    /// The word of the call: a number or name in the folder, or a file.
    Word(&'a str),
    /// A program that was checked, with those that it may call: a program of the folder with its number gives way.
    Checked(u32, &'a Programs),
}

/// Makes the machine ready for a program, with its part; returns the program's number.
///
/// # Errors
/// There is no such program, or the part file cannot be read.
pub fn prepare_run(host: &mut HeadlessHost, shared: &SharedArgs, program: ProgramToRun<'_>) -> Result<u32, CallError> {
    let number = match program {
        ProgramToRun::Word(word) => find_program(host, word)?,
        ProgramToRun::Checked(number, programs) => {
            host.add_programs(programs.iter().cloned().collect());
            number
        }
    };
    make_ready_for(host, shared, number)?;
    host.step();
    Ok(number)
}

/// Makes the machine ready for a program, with its part; the control takes program and part in the next tick.
///
/// # Errors
/// The part file cannot be read.
pub fn make_ready_for(host: &mut HeadlessHost, shared: &SharedArgs, number: u32) -> Result<(), CallError> {
    mount_part(host, shared, number)?;
    host.step(); // the control takes part, program and work offsets
    host.make_ready();
    mount_part(host, shared, number)
}

/// Creates a host for a display, with storage on threads; `machine` opens its machine. The control itself always has a
/// data directory, the demo only with `--data`.
///
/// # Errors
/// Data, folders or the machine cannot be opened.
pub fn threaded_host<P: HostedMachine>(
    shared: &SharedArgs,
    opens_control: bool,
    machine: impl FnOnce(&SharedArgs, &Params) -> Result<P, CallError>,
) -> Result<Host<P, ThreadedStorage>, CallError> {
    let data = if opens_control { Some(data_dir(shared)?) } else { simulation_data(shared)? };
    let parts = host_parts(shared, data)?;
    let worker = StorageWorker::new(parts.jobs);
    let storage = ThreadedStorage::start(RetainedWorker::new(parts.store), worker).map_err(CallError::new)?;
    let machine = machine(shared, &parts.retained.params)?;
    let mut host = Host::connect(shared.kind, parts.retained, machine, storage);
    parts.standing.iter().for_each(|(number, what)| host.report_standing(*number, what));
    Ok(host)
}

/// The part: `--part`, otherwise the part of the program.
///
/// # Errors
/// The file cannot be read.
pub fn part<P: HostedMachine, S: Storage>(
    host: &Host<P, S>,
    shared: &SharedArgs,
    number: u32,
) -> Result<Option<PartFile>, CallError> {
    shared.part.as_ref().map_or_else(|| Ok(host.part_of_program(number)), |path| read_part_file(path).map(Some))
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
    let text = read_text("part file", path)?;
    PartFile::parse(&text).map_err(CallError::at(format!("part file {}", path.display())))
}

/// Reads a file named in a call, if it is a regular file of at most `limit` bytes. A link is followed.
pub fn read_bounded(path: &Path, limit: u64) -> Result<Vec<u8>, String> {
    let named = path.canonicalize().map_err(|error| error.to_string())?;
    read_regular_file(&named, limit).map_err(|error| error.to_string())
}

/// Reads a text file; `what` names it in the error.
///
/// # Errors
/// The file cannot be read.
pub fn read_text(what: &str, path: &Path) -> Result<String, CallError> {
    let refused = |error: String| CallError::new(format!("{what} {}: {error}; check the path", path.display()));
    let bytes = read_bounded(path, TEXT_LIMIT).map_err(refused)?;
    String::from_utf8(bytes).map_err(|_| refused("not UTF-8 text".to_owned()))
}

/// Finds the program of the call, a number or name in the folder or a file; adds a file to the host.
///
/// # Errors
/// There is no such program.
pub fn find_program(host: &mut HeadlessHost, word: &str) -> Result<u32, CallError> {
    let known = |number: &u32| host.has_program(*number);
    if let Some(number) = parse::program(word).filter(known).or_else(|| host.find_program(word)) {
        return Ok(number);
    }
    let path = Path::new(word);
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let named = parse::program(&stem);
    if !path.is_file() {
        return named.filter(known).ok_or_else(|| {
            CallError::new(format!(
                "there is no program {word}: neither in the programs folder nor as a file; `--programs DIR` names another folder"
            ))
        });
    }
    let bytes = read_bounded(path, PROGRAM_LIMIT).map_err(CallError::at(word))?;
    // L1: every program of a lathe has a name of at least one letter.
    let by_name = host.kind().row().programs.by_name && !stem.is_empty();
    let named = named.filter(|_| !by_name);
    let number = named.unwrap_or_else(|| program_number::from_name(&stem));
    let dialect = host.kind().dialect();
    host.add_programs(named_programs_beside(path, dialect, ProgramUse::Execution));
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let own = programs_from_file(number, &name, bytes, dialect, ProgramUse::Execution);
    let number = own.first().map_or(number, |first| first.number);
    // The folder may hold the file itself: then it knows its programs, and which others have their numbers.
    if !own.iter().all(|program| host.programs().holds(program)) {
        host.add_programs(own);
    }
    Ok(number)
}

/// Mounts the part of a program, if there is one, and loads the program.
///
/// # Errors
/// The part file cannot be read.
fn mount_part(host: &mut HeadlessHost, shared: &SharedArgs, number: u32) -> Result<(), CallError> {
    if let Some(part) = part(host, shared, number)? {
        host.mount_part(&part);
        // A control without retained data has factory variables; the part's program needs its own.
        if shared.data.is_none() {
            for (number, value) in part_variables(&part, &shared.sets) {
                host.send(Command::SetVariable(number, Some(value)));
            }
        }
    }
    host.send(Command::LoadProgram(number));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn k1_a_kind_that_is_asked_for_has_data_of_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let root = || DataDir::resolve(Some(folder.path())).unwrap();
        let of = |kind| data_dir_of_kind(root(), kind).ok().unwrap().root().to_path_buf();
        // The first start takes any kind.
        assert_eq!(of(Some(Kind::Gs)), folder.path());
        drop(RetainedStore::open(folder.path(), Kind::Gc).unwrap());
        assert_eq!([of(None), of(Some(Kind::Gc))], [folder.path(), folder.path()]);
        assert_eq!(of(Some(Kind::Gs)), folder.path().join("gs"));
        drop(RetainedStore::open(&of(Some(Kind::Gs)), Kind::Gs).unwrap());
        assert_eq!(of(Some(Kind::Gs)), folder.path().join("gs"));
    }

    #[test]
    fn k1_a_real_machine_is_told_by_its_field_wherever_it_stands() {
        let real = [
            "(kind: Gc, ethercat: (interface: \"eth1\"), devices: [])",
            "(\n  kind: Gc,\n  ethercat: (interface: 5",
            "(ethercat: 1)",
        ];
        let simulated = [
            "(kind: Gc)",
            "(kind: Gc, // ethercat: (\n name: \"ethercat: 1\")",
            include_str!("../../assets/machines/gc.ron"),
        ];
        assert!(real.into_iter().all(describes_real_machine));
        assert!(!simulated.into_iter().any(describes_real_machine));
        assert!(describes_real_machine(include_str!("../../assets/machines/gs_ethercat.ron")));
    }
}
