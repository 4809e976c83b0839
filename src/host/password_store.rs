//! Checks and changes passwords, and stores settings such as kind and language, as the pages request.
//! Runs with the storage of a host; the core receives the answer only.
//! Source: spec B6, K1, K6.2.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::defs::text::LocalizedText;
use crate::link::command::Command;
use crate::link::page_command::{PageCommand, PasswordCheck, PasswordScope, Secret, SettingsRequest, StorageAnswer};
use crate::store::ron_file::{self, ChecksumPolicy, RonError, RonWarning};
use crate::store::{PASSWORD_FILE, RetainedChange, RetainedData, RetainedDatabase, StoredSettings, password};

/// The key of the changed password in the store, and the default one, valid until it is changed; the manual lists them.
const fn password_row(guard: PasswordScope) -> (&'static str, &'static str) {
    match guard {
        PasswordScope::Program => ("password-program", "187350"), // K6.2
        PasswordScope::User => ("password-user", "123456"),
        PasswordScope::Builder => ("password-builder", "830830"),
    }
}

/// The key of the number of changes of passwords: of a database and a copy that differ it says which one is newer.
const CHANGES: &str = "password-changes";

/// What is known of data that were lost and that nobody has accepted yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LostData {
    /// Nothing was lost.
    None,
    /// The last state took their place, with its passwords.
    Restored,
    /// An earlier state took their place: a password may have been changed since.
    Earlier,
    /// No copy was whole.
    Whole,
}

/// State of the copy of the passwords beside the database.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CopyState {
    /// Whole; without rows nothing was changed.
    Whole,
    /// Damaged.
    Damaged,
    /// There is none.
    Missing,
}

/// Hashes of the changed passwords, and the folder of the settings.
#[derive(Clone, Debug, Default)]
pub struct PasswordStore {
    hashes: BTreeMap<PasswordScope, String>,
    /// How often a password was changed.
    changes: u64,
    /// Nobody knows whether a password without a hash was changed: none matches.
    is_locked: bool,
    folder: Option<PathBuf>,
}

impl PasswordStore {
    /// Takes the passwords from retained data, where they lack one from the copy beside them; settings are stored in
    /// `folder`. A whole copy that is not older than the data holds: a database was put back, or is that of another
    /// machine. With data that were lost and a damaged copy, or with neither, what has no password is locked.
    #[must_use]
    pub fn new(loaded: &RetainedData, lost: LostData, folder: PathBuf) -> Self {
        let (copy, state) = Self::copy_in(&folder);
        let is_locked = match lost {
            LostData::None => false,
            LostData::Restored => state == CopyState::Damaged,
            LostData::Earlier | LostData::Whole => state != CopyState::Whole,
        };
        let counts = [changes_in(&loaded.texts), changes_in(&copy)];
        // Changes are committed before they are copied.
        let copy_holds = state == CopyState::Whole && !copy.is_empty() && counts[1] >= counts[0];
        let (first, second) = if copy_holds { (&copy, &loaded.texts) } else { (&loaded.texts, &copy) };
        let found = |guard: PasswordScope| {
            let row = password_row(guard).0;
            Some((guard, first.get(row).or_else(|| second.get(row))?.clone()))
        };
        let hashes: BTreeMap<_, _> = PasswordScope::ALL.into_iter().filter_map(found).collect();
        Self { is_locked, hashes, changes: counts.into_iter().max().unwrap_or_default(), folder: Some(folder) }
    }

    /// Writes the copy beside the database, if it lacks something that is known. What is locked stays as it is.
    ///
    /// # Errors
    /// A disk error; the old copy stays.
    pub(super) fn complete_copy(&self) -> Result<(), RonError> {
        let is_complete = |folder: &Path| Self::copy_in(folder) == (self.rows(), CopyState::Whole);
        match self.is_locked || self.folder.as_deref().is_none_or(is_complete) {
            true => Ok(()),
            false => self.write_copy(),
        }
    }

    /// The rows of the copy.
    fn rows(&self) -> BTreeMap<String, String> {
        let hashes = self.hashes.iter().map(|(guard, hash)| (password_row(*guard).0.to_owned(), hash.clone()));
        let changes = (self.changes > 0).then(|| (CHANGES.to_owned(), self.changes.to_string()));
        hashes.chain(changes).collect()
    }

    /// The rows of the passwords in retained data.
    pub(super) fn rows_of(data: &RetainedData) -> BTreeMap<String, String> {
        let keys = PasswordScope::ALL.into_iter().map(|guard| password_row(guard).0).chain([CHANGES]);
        let rows = keys.filter_map(|key| data.texts.get_key_value(key));
        rows.map(|(key, hash)| (key.clone(), hash.clone())).collect()
    }

    /// Adds the passwords of the copy to data that take the place of lost ones. A damaged copy is an earlier one: it adds
    /// what is missing.
    pub(super) fn add_copy(folder: &Path, data: &mut RetainedData) {
        let (rows, state) = Self::copy_in(folder);
        for (key, hash) in rows {
            match state {
                CopyState::Whole => drop(data.texts.insert(key, hash)),
                CopyState::Damaged | CopyState::Missing => drop(data.texts.entry(key).or_insert(hash)),
            }
        }
    }

    /// The rows of the copy beside the database, and its state: an older copy lacks the last change.
    pub(super) fn copy_in(folder: &Path) -> (BTreeMap<String, String>, CopyState) {
        let read = ron_file::read::<BTreeMap<String, String>>(&folder.join(PASSWORD_FILE), ChecksumPolicy::Strict);
        match read {
            Ok(found) => {
                let is_damaged = found.warnings.iter().any(RonWarning::is_damage);
                (found.value, if is_damaged { CopyState::Damaged } else { CopyState::Whole })
            }
            Err(RonError::Missing(_)) => (BTreeMap::new(), CopyState::Missing),
            Err(_) => (BTreeMap::new(), CopyState::Damaged),
        }
    }

    /// Executes a request and returns the answer; without a store a new password is kept in memory only.
    pub fn answer(&mut self, request: &SettingsRequest, store: Option<&mut RetainedDatabase>) -> Command {
        let answer = self.execute(request, store).unwrap_or_else(StorageAnswer::Failed);
        Command::Page(PageCommand::StorageAnswered(answer))
    }

    fn execute(
        &mut self,
        request: &SettingsRequest,
        store: Option<&mut RetainedDatabase>,
    ) -> Result<StorageAnswer, LocalizedText> {
        match request {
            SettingsRequest::CheckPassword(guard, secret) => {
                return Ok(StorageAnswer::PasswordChecked(*guard, self.check(*guard, secret)));
            }
            SettingsRequest::ChangePassword { scope, old, new } => {
                let allowed = self.matches(*scope, old);
                if allowed {
                    self.set_password(*scope, new, store)?;
                }
                return Ok(StorageAnswer::PasswordChanged(*scope, allowed));
            }
            SettingsRequest::AcceptData(choice) => return Ok(StorageAnswer::DataAccepted(choice.clone())),
            SettingsRequest::SaveKind(kind) => {
                self.update_settings(|settings| settings.kind = Some(*kind))?;
                return Ok(StorageAnswer::KindSaved(*kind));
            }
            SettingsRequest::SaveLightTheme(light) => self.update_settings(|settings| settings.light = Some(*light))?,
            SettingsRequest::SaveBrightness(percent) => self.update_settings(|to| to.brightness = Some(*percent))?,
            SettingsRequest::SaveZoom(percent) => {
                self.update_settings(|to| to.zoom = Some(*percent))?;
            }
            SettingsRequest::SaveSerialPort(port) => self.update_settings(|to| to.serial = Some(port.clone()))?,
            SettingsRequest::SaveFavourites(kept) => {
                self.update_settings(|to| to.favourites = kept.iter().map(ToString::to_string).collect())?;
            }
            SettingsRequest::SaveLang(lang) => self.update_settings(|settings| settings.lang = Some((*lang).into()))?,
        }
        Ok(StorageAnswer::LangSaved)
    }

    fn check(&self, guard: PasswordScope, secret: &Secret) -> PasswordCheck {
        match self.matches(guard, secret) {
            true if self.hashes.contains_key(&guard) => PasswordCheck::Right,
            true => PasswordCheck::Initial,
            false => PasswordCheck::Wrong,
        }
    }

    fn matches(&self, guard: PasswordScope, secret: &Secret) -> bool {
        let secret = secret.reveal();
        let initial = || !self.is_locked && secret == password_row(guard).1;
        self.hashes.get(&guard).map_or_else(initial, |hash| password::verify(secret, hash))
    }

    fn set_password(
        &mut self,
        guard: PasswordScope,
        new: &Secret,
        store: Option<&mut RetainedDatabase>,
    ) -> Result<(), LocalizedText> {
        let hash = password::hash(new.reveal()).map_err(error_text)?;
        let changes = self.changes + 1;
        if let Some(store) = store {
            let row = |key: &str, value: String| RetainedChange::Text { key: key.to_owned(), value: Some(value) };
            let rows = [row(password_row(guard).0, hash.clone()), row(CHANGES, changes.to_string())];
            store.commit(&rows).map_err(error_text)?;
        }
        self.hashes.insert(guard, hash);
        self.changes = changes;
        self.write_copy().map_err(error_text)
    }

    /// Writes the hashes beside the database.
    fn write_copy(&self) -> Result<(), RonError> {
        let Some(folder) = &self.folder else { return Ok(()) };
        ron_file::write(&folder.join(PASSWORD_FILE), ChecksumPolicy::Strict, &self.rows())
    }

    fn update_settings(&self, change: impl FnOnce(&mut StoredSettings)) -> Result<(), LocalizedText> {
        let Some(folder) = &self.folder else { return Ok(()) };
        // A damaged file is put aside and replaced; the kind of machine is that of the retained data.
        let mut settings = StoredSettings::read(folder).unwrap_or_default();
        change(&mut settings);
        settings.write(folder).map_err(error_text)
    }
}

/// The number of changes among rows; 0 without it.
fn changes_in(rows: &BTreeMap<String, String>) -> u64 {
    rows.get(CHANGES).and_then(|number| number.parse().ok()).unwrap_or_default()
}

fn error_text(error: impl std::fmt::Display) -> LocalizedText {
    LocalizedText::same(&error)
}
