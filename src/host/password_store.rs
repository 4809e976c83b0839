//! Checks and changes passwords, and stores settings such as kind and language, as the pages request.
//! Runs with the storage of a host; the core receives the answer only.
//! Source: spec B6, K1, K6.2.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::defs::text::LocalizedText;
use crate::link::command::Command;
use crate::link::page_command::{PageCommand, PasswordScope, Secret, SettingsRequest, StorageAnswer};
use crate::store::{RetainedChange, RetainedData, RetainedDatabase, StoredSettings, password};

/// The key of the changed password in the store, and the default one, valid until it is changed; the manual lists them.
const fn password_row(guard: PasswordScope) -> (&'static str, &'static str) {
    match guard {
        PasswordScope::Program => ("password-program", "187350"), // K6.2
        PasswordScope::User => ("password-user", "123456"),
        PasswordScope::Builder => ("password-builder", "830830"),
    }
}

/// Hashes of the changed passwords, and the folder of the settings.
#[derive(Clone, Debug, Default)]
pub struct PasswordStore {
    hashes: BTreeMap<PasswordScope, String>,
    folder: Option<PathBuf>,
}

impl PasswordStore {
    /// Takes the passwords from retained data; settings are stored in `folder`.
    #[must_use]
    pub fn new(loaded: &RetainedData, folder: PathBuf) -> Self {
        let found = |guard: PasswordScope| loaded.texts.get(password_row(guard).0).map(|hash| (guard, hash.clone()));
        Self { hashes: PasswordScope::ALL.into_iter().filter_map(found).collect(), folder: Some(folder) }
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
                return Ok(StorageAnswer::PasswordChecked(*guard, self.matches(*guard, secret)));
            }
            SettingsRequest::ChangePassword { scope, old, new } => {
                let allowed = self.matches(*scope, old);
                if allowed {
                    self.set_password(*scope, new, store)?;
                }
                return Ok(StorageAnswer::PasswordChanged(*scope, allowed));
            }
            SettingsRequest::SaveKind(kind) => {
                self.update_settings(|settings| settings.kind = Some(*kind))?;
                return Ok(StorageAnswer::KindSaved(*kind));
            }
            SettingsRequest::SaveLightTheme(light) => self.update_settings(|settings| settings.light = Some(*light))?,
            SettingsRequest::SaveBrightness(percent) => self.update_settings(|to| to.brightness = Some(*percent))?,
            SettingsRequest::SaveSerialPort(port) => self.update_settings(|to| to.serial = Some(port.clone()))?,
            SettingsRequest::SaveLang(lang) => self.update_settings(|settings| settings.lang = Some(*lang))?,
        }
        Ok(StorageAnswer::LangSaved)
    }

    fn matches(&self, guard: PasswordScope, secret: &Secret) -> bool {
        let secret = secret.reveal();
        self.hashes.get(&guard).map_or_else(|| secret == password_row(guard).1, |hash| password::verify(secret, hash))
    }

    fn set_password(
        &mut self,
        guard: PasswordScope,
        new: &Secret,
        store: Option<&mut RetainedDatabase>,
    ) -> Result<(), LocalizedText> {
        let hash = password::hash(new.reveal()).map_err(error_text)?;
        if let Some(store) = store {
            let change = RetainedChange::Text { key: password_row(guard).0.to_owned(), value: Some(hash.clone()) };
            store.commit(&[change]).map_err(error_text)?;
        }
        self.hashes.insert(guard, hash);
        Ok(())
    }

    fn update_settings(&self, change: impl FnOnce(&mut StoredSettings)) -> Result<(), LocalizedText> {
        let Some(folder) = &self.folder else { return Ok(()) };
        let mut settings = StoredSettings::read(folder).map_err(error_text)?;
        change(&mut settings);
        settings.write(folder).map_err(error_text)
    }
}

fn error_text(error: impl std::fmt::Display) -> LocalizedText {
    LocalizedText::same(&error)
}
