//! A disk that loses in a power cut what was not flushed. Source: notes "reliability"; POSIX `fsync`.
//!
//! - A flushed file keeps its bytes. Of later writes any sectors may be there, in any order; so may a change of length.
//! - Names of a folder become durable by flushing the folder. Later changes of its names take effect in their order, and
//!   a power cut keeps a beginning of them, as a file system with a journal does.
//! - A power cut falls before any change of the tick in which it comes.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::TraceHash;
use crate::io::random::SplitMix64;
use crate::store::disk::{DiskChange, DiskObserver};

/// Files by their paths, and their bytes.
pub type Files = BTreeMap<PathBuf, Vec<u8>>;

/// Bytes that are written as one.
const SECTOR: usize = 512;

/// A change of the bytes of a file.
#[derive(Clone, Debug)]
enum ByteChange {
    Write(u64, Vec<u8>),
    SetLength(u64),
}

impl ByteChange {
    fn apply(&self, bytes: &mut Vec<u8>) {
        match self {
            Self::Write(offset, written) => {
                let (from, to) = (*offset as usize, *offset as usize + written.len());
                bytes.resize(bytes.len().max(to), 0);
                bytes[from..to].copy_from_slice(written);
            }
            Self::SetLength(length) => bytes.resize(*length as usize, 0),
        }
    }

    /// The parts that the disk writes one by one.
    fn sectors(&self) -> Vec<Self> {
        match self {
            Self::SetLength(_) => vec![self.clone()],
            Self::Write(offset, written) => {
                let (mut parts, mut from) = (Vec::new(), 0);
                while from < written.len() {
                    let room = SECTOR - (*offset as usize + from) % SECTOR;
                    let to = (from + room).min(written.len());
                    parts.push(Self::Write(offset + from as u64, written[from..to].to_vec()));
                    from = to;
                }
                parts
            }
        }
    }
}

/// A change of the names of a folder.
#[derive(Clone, Debug)]
enum NameChange {
    Add(PathBuf, usize),
    Rename(PathBuf, PathBuf),
    Remove(PathBuf),
    AddFolder(PathBuf),
}

impl NameChange {
    fn apply(&self, names: &mut Names) {
        match self {
            Self::Add(path, file) => drop(names.files.insert(path.clone(), *file)),
            Self::Rename(from, to) => {
                if let Some(file) = names.files.remove(from) {
                    names.files.insert(to.clone(), file);
                }
            }
            Self::Remove(path) => drop(names.files.remove(path)),
            Self::AddFolder(path) => names.folders.push(path.clone()),
        }
    }
}

#[derive(Clone, Debug, Default)]
struct Names {
    files: BTreeMap<PathBuf, usize>,
    folders: Vec<PathBuf>,
}

#[derive(Clone, Debug, Default)]
struct FileState {
    flushed: Vec<u8>,
    unflushed: Vec<ByteChange>,
}

/// A change as the observer keeps it until the tick is over.
#[derive(Clone, Debug)]
enum Change {
    Bytes(PathBuf, ByteChange),
    Name(NameChange),
    FlushFile(PathBuf),
    FlushFolder(PathBuf),
}

impl Change {
    fn of(change: DiskChange<'_>) -> Self {
        match change {
            DiskChange::CreateFolder(path) => Self::Name(NameChange::AddFolder(path.into())),
            DiskChange::CreateFile(path) => Self::Name(NameChange::Add(path.into(), 0)),
            DiskChange::Write { file, offset, bytes } => {
                Self::Bytes(file.into(), ByteChange::Write(offset, bytes.to_vec()))
            }
            DiskChange::SetLength { file, length } => Self::Bytes(file.into(), ByteChange::SetLength(length)),
            DiskChange::FlushFile(path) => Self::FlushFile(path.into()),
            DiskChange::Rename { from, to } => Self::Name(NameChange::Rename(from.into(), to.into())),
            DiskChange::Remove(path) => Self::Name(NameChange::Remove(path.into())),
            DiskChange::FlushFolder(path) => Self::FlushFolder(path.into()),
        }
    }
}

/// What the disk does wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DiskFaults {
    /// A flush of a file does nothing.
    pub flushes_no_file: bool,
    /// A flush of a folder does nothing.
    pub flushes_no_folder: bool,
}

/// What is on the disk, and what is still on its way to it.
#[derive(Clone, Debug, Default)]
struct Contents {
    files: Vec<FileState>,
    /// The names as programs see them.
    current: Names,
    durable: Names,
    /// Per folder, in their order.
    unflushed: BTreeMap<PathBuf, Vec<NameChange>>,
}

impl Contents {
    fn apply(&mut self, change: &Change, faults: DiskFaults) {
        match change {
            Change::Bytes(path, bytes) => {
                if let Some(file) = self.file(path) {
                    file.unflushed.push(bytes.clone());
                }
            }
            Change::Name(name) => self.change_name(name),
            Change::FlushFile(path) if !faults.flushes_no_file => {
                if let Some(file) = self.file(path) {
                    let FileState { flushed, unflushed } = file;
                    unflushed.drain(..).for_each(|change| change.apply(flushed));
                }
            }
            Change::FlushFolder(folder) if !faults.flushes_no_folder => {
                for change in self.unflushed.remove(folder).unwrap_or_default() {
                    change.apply(&mut self.durable);
                }
            }
            Change::FlushFile(_) | Change::FlushFolder(_) => {}
        }
    }

    fn file(&mut self, path: &Path) -> Option<&mut FileState> {
        let file = *self.current.files.get(path)?;
        self.files.get_mut(file)
    }

    fn change_name(&mut self, change: &NameChange) {
        let change = match change {
            NameChange::Add(path, _) => {
                self.files.push(FileState::default());
                NameChange::Add(path.clone(), self.files.len() - 1)
            }
            other => other.clone(),
        };
        let (NameChange::Add(path, _)
        | NameChange::Rename(path, _)
        | NameChange::Remove(path)
        | NameChange::AddFolder(path)) = &change;
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        change.apply(&mut self.current);
        self.unflushed.entry(folder).or_default().push(change);
    }

    /// The bytes of each file by its path, as programs see them.
    fn visible(&self) -> Files {
        let bytes = |file: usize| {
            let FileState { mut flushed, unflushed } = self.files.get(file).cloned().unwrap_or_default();
            unflushed.iter().for_each(|change| change.apply(&mut flushed));
            flushed
        };
        self.current.files.iter().map(|(path, file)| (path.clone(), bytes(*file))).collect()
    }

    /// What a power cut leaves: the bytes of each file by its path, and the folders.
    fn after_power_cut(mut self, chance: &mut SplitMix64) -> (Files, Vec<PathBuf>) {
        for changes in std::mem::take(&mut self.unflushed).into_values() {
            let kept = (chance.next_unit() * (changes.len() + 1) as f64) as usize;
            changes.iter().take(kept).for_each(|change| change.apply(&mut self.durable));
        }
        let folders = self.durable.folders.clone();
        // A name in a folder that is not there is lost with it.
        let created: Vec<&PathBuf> = self.current.folders.iter().filter(|folder| !folders.contains(folder)).collect();
        let files =
            self.durable.files.iter().filter(|(path, _)| !created.iter().any(|folder| path.starts_with(folder)));
        let kept = files.map(|(path, file)| {
            let FileState { mut flushed, unflushed } = self.files[*file].clone();
            // Sometimes nothing of it, sometimes all of it.
            let share = (chance.next_unit() * 3.0 - 1.0).clamp(0.0, 1.0);
            let sectors = unflushed.iter().flat_map(ByteChange::sectors);
            sectors.filter(|_| chance.next_unit() < share).for_each(|sector| sector.apply(&mut flushed));
            (path.clone(), flushed)
        });
        (kept.collect(), folders)
    }
}

/// The disk of one data folder.
#[derive(Debug)]
pub struct SimulatedDisk {
    root: PathBuf,
    contents: Contents,
    /// The changes of this tick.
    tick: Vec<Change>,
    faults: DiskFaults,
    /// The power is off: nothing is written any more.
    is_off: bool,
    /// The disk is full: it takes no bytes.
    pub is_full: bool,
    /// Changes since the start.
    pub changes: u64,
    /// Ticks of a millisecond since the start.
    ticks: u64,
    /// Fingerprint of every byte that was written, where, and in which tick.
    pub written: TraceHash,
}

impl SimulatedDisk {
    /// A disk with what is in a folder now, all of it flushed.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn of_folder(root: &Path, faults: DiskFaults) -> io::Result<Self> {
        let mut disk = Self {
            root: root.to_path_buf(),
            contents: Contents::default(),
            tick: Vec::new(),
            faults,
            is_off: false,
            is_full: false,
            changes: 0,
            ticks: 0,
            written: TraceHash::default(),
        };
        disk.load(root)?;
        Ok(disk)
    }

    fn load(&mut self, folder: &Path) -> io::Result<()> {
        let mut entries = fs::read_dir(folder)?.collect::<io::Result<Vec<_>>>()?;
        entries.sort_by_key(fs::DirEntry::path);
        for entry in entries {
            let path = entry.path();
            if entry.file_type()?.is_dir() {
                self.contents.durable.folders.push(path.clone());
                self.load(&path)?;
            } else {
                self.contents.files.push(FileState { flushed: fs::read(&path)?, unflushed: Vec::new() });
                self.contents.durable.files.insert(path, self.contents.files.len() - 1);
            }
        }
        self.contents.current = self.contents.durable.clone();
        Ok(())
    }

    /// The changes of the tick are over; a later power cut comes behind them.
    pub fn end_tick(&mut self) {
        self.ticks += 1;
        for change in self.tick.drain(..) {
            self.contents.apply(&change, self.faults);
        }
    }

    /// Whether something was changed in this tick.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        !self.tick.is_empty()
    }

    /// The files as programs see them, without the changes of this tick.
    #[must_use]
    pub fn files(&self) -> Files {
        self.contents.visible()
    }

    /// The power is cut now: behind some of the changes of this tick. Nothing is written any more until
    /// [`Self::power_on`]. True if all changes of the tick were made.
    pub fn power_cut(&mut self, chance: &mut SplitMix64) -> bool {
        let made = (chance.next_unit() * (self.tick.len() + 1) as f64) as usize;
        let is_whole = made >= self.tick.len();
        self.tick.truncate(made);
        self.end_tick();
        self.is_off = true;
        is_whole
    }

    /// Puts what the power cut has left into the folder; the disk has it, flushed.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn power_on(&mut self, chance: &mut SplitMix64) -> io::Result<()> {
        let (files, folders) = std::mem::take(&mut self.contents).after_power_cut(chance);
        fs::remove_dir_all(&self.root)?;
        fs::create_dir_all(&self.root)?;
        folders.iter().try_for_each(fs::create_dir_all)?;
        for (path, bytes) in files {
            fs::write(path, bytes)?;
        }
        let root = self.root.clone();
        self.load(&root)?;
        self.is_off = false;
        Ok(())
    }
}

impl DiskObserver for SimulatedDisk {
    fn before(&mut self, change: DiskChange<'_>) -> io::Result<()> {
        if self.is_off {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        if self.is_full && matches!(change, DiskChange::Write { .. } | DiskChange::SetLength { .. }) {
            return Err(io::ErrorKind::StorageFull.into());
        }
        // A stick is no part of the disk.
        if !change.path().starts_with(&self.root) {
            return Ok(());
        }
        self.changes += 1;
        if let DiskChange::Write { offset, bytes, .. } = change {
            self.written.add_word(self.ticks);
            self.written.add_word(offset);
            self.written.add_bytes(bytes);
        }
        self.tick.push(Change::of(change));
        Ok(())
    }

    fn now(&self) -> Duration {
        Duration::from_millis(self.ticks)
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;
    use std::rc::Rc;

    use super::*;
    use crate::store::{disk, write_atomic};

    /// The text of a file after a power cut; `None`: there is no file.
    fn after(faults: DiskFaults, seed: u64, act: impl FnOnce(&Path)) -> Option<String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("O1001.NC");
        fs::write(&path, "old").unwrap();
        let simulated = Rc::new(RefCell::new(SimulatedDisk::of_folder(folder.path(), faults).unwrap()));
        let observed = disk::observe(simulated.clone());
        act(&path);
        drop(observed);
        let mut simulated = simulated.borrow_mut();
        let mut chance = SplitMix64::new(seed);
        simulated.end_tick();
        simulated.power_cut(&mut chance);
        simulated.power_on(&mut chance).unwrap();
        fs::read_to_string(&path).ok()
    }

    #[test]
    fn b3_a_replaced_file_is_the_new_one_after_a_power_cut() {
        for seed in 0..100 {
            let text = after(DiskFaults::default(), seed, |path| write_atomic(path, b"new").unwrap());
            assert_eq!(text.as_deref(), Some("new"), "seed {seed}");
        }
    }

    #[test]
    fn without_flushes_it_is_lost_or_torn() {
        let texts = |faults: DiskFaults| -> Vec<Option<String>> {
            (0..100).map(|seed| after(faults, seed, |path| write_atomic(path, b"new").unwrap())).collect()
        };
        let no_folder = texts(DiskFaults { flushes_no_folder: true, ..DiskFaults::default() });
        assert!(no_folder.contains(&Some("old".to_owned())) && no_folder.contains(&Some("new".to_owned())));
        let no_file = texts(DiskFaults { flushes_no_file: true, ..DiskFaults::default() });
        assert!(no_file.contains(&Some(String::new())), "the name is there, the bytes are not: {no_file:?}");
    }

    #[test]
    fn a_power_cut_falls_between_the_changes_of_a_tick() {
        let mut seen = std::collections::BTreeSet::new();
        for seed in 0..100 {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("A");
            fs::write(&path, "old").unwrap();
            let simulated = SimulatedDisk::of_folder(folder.path(), DiskFaults::default()).unwrap();
            let simulated = Rc::new(RefCell::new(simulated));
            let observed = disk::observe(simulated.clone());
            write_atomic(&path, b"new").unwrap();
            drop(observed);
            let mut chance = SplitMix64::new(seed);
            simulated.borrow_mut().power_cut(&mut chance);
            simulated.borrow_mut().power_on(&mut chance).unwrap();
            seen.insert(fs::read_to_string(&path).unwrap());
        }
        assert_eq!(seen.into_iter().collect::<Vec<_>>(), ["new", "old"]);
    }

    #[test]
    fn sectors_of_an_unflushed_write_come_one_by_one() {
        let parts = ByteChange::Write(500, vec![7; 600]).sectors();
        let lengths: Vec<(u64, usize)> = parts
            .iter()
            .map(|part| match part {
                ByteChange::Write(offset, bytes) => (*offset, bytes.len()),
                ByteChange::SetLength(_) => unreachable!(),
            })
            .collect();
        assert_eq!(lengths, [(500, 12), (512, 512), (1024, 76)]);
    }
}
