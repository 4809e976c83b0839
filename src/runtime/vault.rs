//! Checks and changes passwords, and stores settings such as kind and language, as the pages request.
//! Runs on the disk thread or in a rig; the core receives the answer only.
//! Source: spec B6, K1, K6.2.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::defs::text::Said;
use crate::link::command::Command;
use crate::link::page_command::{Guard, PageAnswer, PageCommand, PageWish, Secret};
use crate::store::{Change, Loaded, Retained, RetainedError, Settings, password};

/// The default passwords, valid until they are changed; the manual lists them.
const fn initial(guard: Guard) -> &'static str {
    match guard {
        Guard::Program => "187350", // K6.2
        Guard::User => "123456",
        Guard::Builder => "830830",
    }
}

const fn key(guard: Guard) -> &'static str {
    match guard {
        Guard::Program => "password-program",
        Guard::User => "password-user",
        Guard::Builder => "password-builder",
    }
}

/// Hashes of the changed passwords, and the folder of the settings.
#[derive(Clone, Debug, Default)]
pub struct Vault {
    hashes: BTreeMap<Guard, String>,
    folder: Option<PathBuf>,
}

impl Vault {
    /// Takes the passwords from retained data; settings are stored in `folder`.
    #[must_use]
    pub fn new(loaded: &Loaded, folder: PathBuf) -> Self {
        let found = |guard: Guard| loaded.texts.get(key(guard)).map(|hash| (guard, hash.clone()));
        Self { hashes: Guard::ALL.into_iter().filter_map(found).collect(), folder: Some(folder) }
    }

    /// Executes a request and returns the answer; without a store a new password is kept in memory only.
    pub fn answer(&mut self, wish: &PageWish, store: Option<&mut Retained>) -> Command {
        let answer = match wish {
            PageWish::Check(guard, secret) => PageAnswer::Checked(*guard, self.fits(*guard, secret)),
            PageWish::Change { of, old, .. } if !self.fits(*of, old) => PageAnswer::Changed(*of, false),
            PageWish::Change { of, new, .. } => match self.replace(*of, new, store) {
                Ok(()) => PageAnswer::Changed(*of, true),
                Err(why) => PageAnswer::Failed(why),
            },
            PageWish::KeepKind(kind) => match self.settings(|settings| settings.kind = Some(*kind)) {
                Ok(()) => PageAnswer::KindKept(*kind),
                Err(why) => PageAnswer::Failed(why),
            },
            PageWish::KeepLight(light) => match self.settings(|settings| settings.light = Some(*light)) {
                Ok(()) => PageAnswer::LangKept,
                Err(why) => PageAnswer::Failed(why),
            },
            PageWish::KeepBrightness(percent) => match self.settings(|settings| settings.brightness = Some(*percent)) {
                Ok(()) => PageAnswer::LangKept,
                Err(why) => PageAnswer::Failed(why),
            },
            PageWish::KeepPort(port) => match self.settings(|settings| settings.serial = Some(port.clone())) {
                Ok(()) => PageAnswer::LangKept,
                Err(why) => PageAnswer::Failed(why),
            },
            PageWish::KeepLang(lang) => match self.settings(|settings| settings.lang = Some(*lang)) {
                Ok(()) => PageAnswer::LangKept,
                Err(why) => PageAnswer::Failed(why),
            },
        };
        Command::Page(PageCommand::Answered(answer))
    }

    fn fits(&self, guard: Guard, secret: &Secret) -> bool {
        match self.hashes.get(&guard) {
            Some(hash) => password::fits(secret.reveal(), hash),
            None => secret.reveal() == initial(guard),
        }
    }

    fn replace(&mut self, guard: Guard, new: &Secret, store: Option<&mut Retained>) -> Result<(), Said> {
        let hash = password::hash(new.reveal()).map_err(|error| said(&error))?;
        if let Some(store) = store {
            let change = Change::Text { key: key(guard).to_owned(), value: Some(hash.clone()) };
            store.commit(&[change]).map_err(|error: RetainedError| said(&error))?;
        }
        self.hashes.insert(guard, hash);
        Ok(())
    }

    fn settings(&self, change: impl FnOnce(&mut Settings)) -> Result<(), Said> {
        let Some(folder) = &self.folder else { return Ok(()) };
        let mut settings = Settings::read(folder).map_err(|error| said(&error))?;
        change(&mut settings);
        settings.write(folder).map_err(|error| said(&error))
    }
}

fn said(error: &dyn std::fmt::Display) -> Said {
    Said::new(error.to_string(), error.to_string())
}
