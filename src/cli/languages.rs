//! The language of the screen and of the messages: those of the control, shipped ones, those of files. Source: spec H9.

use super::CallError;
use super::args::SharedArgs;
use crate::defs::text::{Lang, Translation};
use crate::store::{AddedLanguages, DataDir};

/// The languages of the language files, and the one that holds: asked for, else stored, else Chinese. Without a use for
/// them no file is read.
///
/// # Errors
/// The call names a folder that is not there, or a language that no file has.
pub fn read(
    shared: &mut SharedArgs,
    stored: Option<&str>,
    opens_control: bool,
    data_dir: fn(&SharedArgs) -> Result<DataDir, CallError>,
) -> Result<(), CallError> {
    let wanted = shared.requested_lang.as_deref().or(stored);
    let own = |code: &str| [Lang::Zh, Lang::En].into_iter().find(|lang| lang.code() == code);
    let known = wanted.map_or(Some(Lang::default()), own);
    if let (None, Some(lang), false) = (&shared.languages, known, opens_control) {
        shared.lang = lang;
        return Ok(());
    }
    let folder = match &shared.languages {
        Some(folder) if !folder.is_dir() => {
            return Err(CallError::new(format!("--languages {}: there is no such folder", folder.display())));
        }
        Some(folder) => Some(folder.clone()),
        None if opens_control || shared.data.is_some() => Some(data_dir(shared)?.languages()),
        None => None,
    };
    let AddedLanguages { languages, faults } =
        folder.as_deref().map_or_else(AddedLanguages::shipped, AddedLanguages::read);
    let place = folder.map_or_else(|| "a folder".to_owned(), |folder| folder.display().to_string());
    faults.iter().for_each(|fault| warn_line!("kt830: language files: {}", fault.en()));
    shared.has_language_faults = !faults.is_empty();
    shared.added_languages = languages.into_iter().map(Translation::keep).collect();
    let added = |code| shared.added_languages.iter().find(|added| added.code == code).map(|added| Lang::Added(added));
    let found = known.or_else(|| wanted.and_then(added));
    if found.is_none()
        && let Some(code) = &shared.requested_lang
    {
        let mut codes = vec!["zh", "en"];
        codes.extend(shared.added_languages.iter().map(|added| added.code.as_str()));
        let codes = codes.join(", ");
        return Err(CallError::new(format!(
            "--lang {code}: the languages are {codes}; others are files in {place} (kt830 texts, --languages DIR)"
        )));
    }
    if found.is_none() {
        let code = wanted.unwrap_or_default();
        warn_line!("kt830: settings: the file of the language '{code}' is not in {place}; English is used");
    }
    shared.lang = found.unwrap_or(Lang::En);
    Ok(())
}
