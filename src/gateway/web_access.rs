//! Who may look from other computers: a certificate of this control, and the password of the viewers, in the file `web.ron`
//! of the data directory. Passwords are tried on a thread of their own, one at a time.
//! Source: docs/manual, chapter "network"; RFC 7617 (basic authentication).

use std::collections::VecDeque;
use std::path::Path;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use chrono::Datelike;
use rcgen::{CertificateParams, DistinguishedName, DnType, ExtendedKeyUsagePurpose, KeyPair};
use rustls::ServerConfig;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use serde::{Deserialize, Serialize};

use super::certificate_end::certificate_end;
use super::in_words;
use crate::defs::date::DateTime;
use crate::defs::text::{LocalizedText, Text};
use crate::store::ron_file::{self, ChecksumPolicy, RonError};
use crate::store::{password, write_private};

/// Name of the file.
const FILE: &str = "web.ron";
/// Certificate and key that the control makes for itself.
const CERTIFICATE: &str = "web.pem";
const KEY: &str = "web.key";
/// A certificate of the control is valid for so long, days.
const VALID_DAYS: i64 = 820;
/// Longest password, bytes.
const LONGEST: usize = 200;
/// After a wrong password no other is tried for so long.
const PENALTY: Duration = Duration::from_secs(1);
/// Headers that are remembered: viewers may call themselves as they like.
const MOST_ADMITTED: usize = 16;
/// The scheme of a request's header.
const SCHEME: &str = "Basic ";

/// The file as it is written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct AccessFile {
    /// Certificate and key: PEM files in the data directory.
    certificate: String,
    key: String,
    /// Argon2id hash of the password of the viewers.
    viewer: String,
}

/// How the view is given to other computers.
pub struct WebAccess {
    /// How connections are encrypted.
    pub config: Arc<ServerConfig>,
    /// When its certificate ends.
    pub valid_until: Option<DateTime>,
    gate: ViewerGate,
}

impl WebAccess {
    /// Reads the file of a data directory.
    ///
    /// # Errors
    /// It is missing, not readable, or its certificate or key is; in words for the page.
    pub fn read(folder: &Path) -> Result<Self, LocalizedText> {
        let read = ron_file::read_newest::<AccessFile>(&folder.join(FILE), ChecksumPolicy::Lenient);
        let AccessFile { certificate, key, viewer } = read.map_err(|error| match error {
            RonError::Missing(_) => LocalizedText::from(Text::new(
                "没有密码：在这台电脑上运行 kt830 web-access",
                "no password: run kt830 web-access on this computer",
            )),
            error => in_words(error),
        })?;
        let wrong = |name: &str, error: &dyn std::fmt::Display| in_words(format!("{name}: {error}"));
        let chain: Result<Vec<_>, _> =
            CertificateDer::pem_file_iter(folder.join(&certificate)).and_then(Iterator::collect);
        let chain = chain.map_err(|error| wrong(&certificate, &error))?;
        let private = PrivateKeyDer::from_pem_file(folder.join(&key)).map_err(|error| wrong(&key, &error))?;
        let valid_until = certificate_end(&chain);
        let config = ServerConfig::builder_with_provider(Arc::new(rustls::crypto::ring::default_provider()))
            .with_safe_default_protocol_versions()
            .map_err(in_words)?
            .with_no_client_auth()
            .with_single_cert(chain, private)
            .map_err(|error| wrong(&certificate, &error))?;
        Ok(Self { config: Arc::new(config), valid_until, gate: ViewerGate::new(viewer) })
    }

    /// Whether a request with this header may look; none until its password has been tried.
    pub fn admits(&mut self, authorization: Option<&[u8]>, now: Duration) -> Option<bool> {
        self.gate.admits(authorization, now)
    }
}

/// When the file of a data directory was written; none without one.
pub fn changed_at(folder: &Path) -> Option<SystemTime> {
    folder.join(FILE).metadata().and_then(|found| found.modified()).ok()
}

/// Sets the password of the viewers. The control makes a certificate for these names of this computer if there is none, and
/// anew where names are given and the certificate is its own. Returns what was done, in words.
///
/// # Errors
/// The password is empty or too long, the certificate is that of somebody else, or a file cannot be written.
pub fn set_viewer_password(folder: &Path, secret: &str, hosts: Vec<String>) -> Result<&'static str, String> {
    if secret.is_empty() || secret.len() > LONGEST {
        return Err(format!("the password has 1 to {LONGEST} bytes"));
    }
    let viewer = password::hash(secret).map_err(|error| error.to_string())?;
    let path = folder.join(FILE);
    let (file, done) = match ron_file::read_newest::<AccessFile>(&path, ChecksumPolicy::Lenient) {
        Ok(read) if hosts.is_empty() => (AccessFile { viewer, ..read }, "password changed"),
        Ok(read) if read.certificate == CERTIFICATE && read.key == KEY => {
            make_certificate(folder, hosts)?;
            (AccessFile { viewer, ..read }, "password changed, certificate made anew")
        }
        Ok(_) => return Err(format!("{FILE} names a certificate of your own: call it without names")),
        Err(RonError::Missing(_)) if [CERTIFICATE, KEY].iter().any(|name| folder.join(name).exists()) => {
            return Err(format!("{CERTIFICATE} or {KEY} is there without {FILE}: remove it, or give it another name"));
        }
        Err(RonError::Missing(_)) => {
            make_certificate(folder, if hosts.is_empty() { vec!["localhost".to_owned()] } else { hosts })?;
            let (certificate, key) = (CERTIFICATE.to_owned(), KEY.to_owned());
            (AccessFile { certificate, key, viewer }, "password set, certificate made")
        }
        Err(error) => return Err(error.to_string()),
    };
    ron_file::write(&path, ChecksumPolicy::Lenient, &file).map_err(|error| error.to_string())?;
    Ok(done)
}

/// A certificate that nobody else vouches for: a browser asks once whether it is to be trusted. Browsers take none that is
/// valid for longer.
fn make_certificate(folder: &Path, hosts: Vec<String>) -> Result<(), String> {
    let in_words = |error: rcgen::Error| error.to_string();
    let key = KeyPair::generate().map_err(in_words)?;
    let mut params = CertificateParams::new(hosts.clone()).map_err(in_words)?;
    let today = chrono::Utc::now().date_naive();
    let day = |days: i64| {
        let date = today + chrono::Duration::days(days);
        let (month, day) = (date.month() as u8, date.day() as u8);
        rcgen::date_time_ymd(date.year(), month, day)
    };
    (params.not_before, params.not_after) = (day(-1), day(VALID_DAYS));
    params.distinguished_name = DistinguishedName::new();
    params.distinguished_name.push(DnType::CommonName, hosts.first().map_or("KT-830", String::as_str));
    params.extended_key_usages = vec![ExtendedKeyUsagePurpose::ServerAuth];
    let certificate = params.self_signed(&key).map_err(in_words)?;
    for (name, text) in [(KEY, key.serialize_pem()), (CERTIFICATE, certificate.pem())] {
        write_private(&folder.join(name), text.as_bytes()).map_err(|error| error.to_string())?;
    }
    Ok(())
}

/// Lets viewers in by their password.
struct ViewerGate {
    hash: Arc<str>,
    /// The headers that were let in last: they are not hashed again.
    admitted: VecDeque<Vec<u8>>,
    trial: Option<(Vec<u8>, JoinHandle<bool>)>,
    /// The header that was refused last, and until when no other is tried.
    refused: Option<(Vec<u8>, Duration)>,
}

impl ViewerGate {
    fn new(hash: String) -> Self {
        Self { hash: hash.into(), admitted: VecDeque::new(), trial: None, refused: None }
    }

    fn admits(&mut self, authorization: Option<&[u8]>, now: Duration) -> Option<bool> {
        let Some(header) = authorization else { return Some(false) };
        self.take_trial(now);
        if self.admitted.iter().any(|admitted| is_same(admitted, header)) {
            return Some(true);
        }
        if let Some((refused, until)) = &self.refused {
            if refused == header {
                return Some(false);
            }
            if now < *until {
                return None;
            }
        }
        if self.trial.is_none() {
            let (told, hash) = (header.to_vec(), Arc::clone(&self.hash));
            let tried = std::thread::Builder::new()
                .name("kt830-password".to_owned())
                .spawn(move || password_of(&told).is_some_and(|secret| password::verify(&secret, &hash)));
            self.trial = tried.ok().map(|trial| (header.to_vec(), trial));
        }
        None
    }

    /// The result of a trial that is over.
    fn take_trial(&mut self, now: Duration) {
        if let Some((header, trial)) = self.trial.take_if(|(_, trial)| trial.is_finished()) {
            match trial.join() {
                Ok(true) => {
                    self.admitted.truncate(MOST_ADMITTED - 1);
                    self.admitted.push_front(header);
                }
                Ok(false) | Err(_) => self.refused = Some((header, now + PENALTY)),
            }
        }
    }
}

/// The password of a header of basic authentication; the name of the user does not matter.
fn password_of(header: &[u8]) -> Option<String> {
    let text = std::str::from_utf8(header).ok()?;
    let encoded =
        text.get(..SCHEME.len()).filter(|scheme| scheme.eq_ignore_ascii_case(SCHEME)).and(text.get(SCHEME.len()..))?;
    let plain = String::from_utf8(BASE64_STANDARD.decode(encoded.trim()).ok()?).ok()?;
    let (_, secret) = plain.split_once(':')?;
    (secret.len() <= LONGEST).then(|| secret.to_owned())
}

/// Compares without telling by its time how far the two are the same.
fn is_same(left: &[u8], right: &[u8]) -> bool {
    left.len() == right.len() && left.iter().zip(right).fold(0, |all, (a, b)| all | (a ^ b)) == 0
}
