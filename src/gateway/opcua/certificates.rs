//! The certificates of the server: its own one, those of clients that are trusted, and those that were refused. Trusting
//! one is done by a person who has compared its thumbprint.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use opcua::crypto::{CertificateStore, X509, X509Data};
use rustls::pki_types::CertificateDer;

use crate::gateway::certificate_end::{certificate_end, is_valid_at};
use crate::store::{write_atomic, write_private};

/// Its own certificate, in the folder of the server.
pub const OWN_CERTIFICATE: &str = "own/cert.der";
/// The key of it.
pub const PRIVATE_KEY: &str = "private/private.pem";
const TRUSTED: &str = "trusted";
const REJECTED: &str = "rejected";
/// Bits of the key.
const KEY_BITS: u32 = 3_072;
/// A machine runs for longer than anybody remembers to renew a certificate.
const VALID_DAYS: u32 = 20 * 365;
/// A clock that is before this, 2026-11-01, is wrong: it says nothing of a certificate.
const EARLIEST_CLOCK: i64 = 1_793_491_200;
/// Certificates of strangers that are kept: each stranger could send others without end.
const MOST_REJECTED: usize = 500;

/// Makes the server's own certificate if there is none that fits and is valid now; whether one was made. `uri` is the name of the
/// application, `host` the name under which clients reach it.
///
/// # Errors
/// A file cannot be written.
pub fn ensure_own(folder: &Path, uri: &str, host: &str) -> Result<bool, String> {
    for name in ["own", "private", TRUSTED, REJECTED] {
        let path = folder.join(name);
        fs::create_dir_all(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    if own_fits(folder, uri, host) {
        return Ok(false);
    }
    let data = X509Data {
        key_size: KEY_BITS,
        common_name: "KT-830".to_owned(),
        organization: "KT-830".to_owned(),
        organizational_unit: String::new(),
        country: "CN".to_owned(),
        state: String::new(),
        alt_host_names: X509Data::alt_host_names(uri, Some(vec![host.to_owned()]), false, true, true),
        certificate_duration_days: VALID_DAYS,
    };
    let aside = tempfile::tempdir_in(folder).map_err(|error| error.to_string())?;
    let made = [aside.path().join("cert.der"), aside.path().join("key.pem")];
    CertificateStore::create_certificate_and_key(&data, true, &made[0], &made[1])?;
    let [certificate, key] = made.map(|path| fs::read(path).map_err(|error| error.to_string()));
    let (certificate, key) = (certificate?, key?);
    // Without a certificate both are made again: a power cut in between leaves no pair that does not fit.
    remove(&folder.join(OWN_CERTIFICATE))?;
    write_private(&folder.join(PRIVATE_KEY), &key).map_err(|error| error.to_string())?;
    write_atomic(&folder.join(OWN_CERTIFICATE), &certificate).map_err(|error| error.to_string())?;
    Ok(true)
}

/// Whether there is a certificate of these names that is valid now, and the key of it.
fn own_fits(folder: &Path, uri: &str, host: &str) -> bool {
    let certificate = CertificateStore::read_cert(&folder.join(OWN_CERTIFICATE));
    let key = CertificateStore::read_pkey(&folder.join(PRIVATE_KEY));
    certificate.is_ok_and(|own| own.is_application_uri_valid(uri).is_ok() && own.is_hostname_valid(host).is_ok())
        && key.is_ok()
        && is_in_its_time(folder, chrono::Utc::now().timestamp())
}

/// One that has ended, or that a wrong clock has made for a time to come, is of no use to anybody.
fn is_in_its_time(folder: &Path, now: i64) -> bool {
    let own = fs::read(folder.join(OWN_CERTIFICATE)).map(CertificateDer::from);
    now < EARLIEST_CLOCK || own.is_ok_and(|own| is_valid_at(&own, now))
}

/// A certificate of a client.
pub struct ClientCertificate {
    /// The file.
    path: PathBuf,
    /// SHA-1 of it, hexadecimal: what a client shows of its own certificate.
    pub thumbprint: String,
    /// Who it says to be.
    pub subject: String,
}

/// The certificates of clients that were refused.
#[must_use]
pub fn rejected(folder: &Path) -> Vec<ClientCertificate> {
    certificates(&folder.join(REJECTED))
}

/// How many certificates of clients were refused.
#[must_use]
pub fn rejected_count(folder: &Path) -> usize {
    fs::read_dir(folder.join(REJECTED)).into_iter().flatten().count()
}

/// When the server's own certificate ends, s since 1970, UTC; none if it cannot be read.
#[must_use]
pub fn own_end(folder: &Path) -> Option<i64> {
    let own = CertificateDer::from(fs::read(folder.join(OWN_CERTIFICATE)).ok()?);
    Some(certificate_end([&own])?.0)
}

/// The certificates of clients that are trusted.
#[must_use]
pub fn trusted(folder: &Path) -> Vec<ClientCertificate> {
    certificates(&folder.join(TRUSTED))
}

/// The files of the certificates that are trusted.
pub fn trusted_files(folder: &Path) -> BTreeSet<OsString> {
    fs::read_dir(folder.join(TRUSTED)).into_iter().flatten().flatten().map(|entry| entry.file_name()).collect()
}

/// Whether these bytes are a certificate that is trusted.
#[must_use]
pub fn is_trusted(folder: &Path, certificate: &[u8]) -> bool {
    let files = fs::read_dir(folder.join(TRUSTED)).into_iter().flatten().flatten();
    !certificate.is_empty() && files.filter_map(|entry| fs::read(entry.path()).ok()).any(|bytes| bytes == certificate)
}

fn certificates(folder: &Path) -> Vec<ClientCertificate> {
    let files = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let read = files.filter_map(|path| {
        let certificate = CertificateStore::read_cert(&path).ok()?;
        let (thumbprint, subject) = (thumbprint_of(&certificate), certificate.subject_name());
        Some(ClientCertificate { path, thumbprint, subject })
    });
    read.collect()
}

/// Trusts a certificate: a file, or the thumbprint of one that was refused. Returns its thumbprint.
///
/// # Errors
/// There is no such certificate, or the file cannot be written.
pub fn trust(folder: &Path, certificate: &str) -> Result<String, String> {
    let refused = rejected(folder).into_iter().find(|other| is_thumbprint(&other.thumbprint, certificate));
    let source = refused.map_or_else(|| PathBuf::from(certificate), |refused| refused.path);
    let read = CertificateStore::read_cert(&source).map_err(|error| format!("{}: {error}", source.display()))?;
    let name = CertificateStore::cert_file_name(&read);
    let bytes = read.to_der().map_err(|error| format!("{}: {error}", source.display()))?;
    write_atomic(&folder.join(TRUSTED).join(&name), &bytes).map_err(|error| error.to_string())?;
    // One that lies among the refused ones stays refused.
    remove(&folder.join(REJECTED).join(&name))?;
    Ok(thumbprint_of(&read))
}

/// Trusts a certificate no more.
///
/// # Errors
/// None that is trusted has this thumbprint, or the file cannot be removed.
pub fn distrust(folder: &Path, thumbprint: &str) -> Result<(), String> {
    let found = trusted(folder).into_iter().find(|other| is_thumbprint(&other.thumbprint, thumbprint));
    remove(&found.ok_or("no trusted certificate has this thumbprint")?.path)
}

fn remove(path: &Path) -> Result<(), String> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(format!("{}: {error}", path.display())),
        _ => Ok(()),
    }
}

/// As people write them: with colons, blanks, in capitals.
fn is_thumbprint(thumbprint: &str, written: &str) -> bool {
    thumbprint == written.replace([':', ' '], "").to_ascii_lowercase()
}

/// Removes the oldest of the refused certificates beyond those that are kept.
pub fn limit_rejected(folder: &Path) {
    let mut files: Vec<_> = fs::read_dir(folder.join(REJECTED))
        .into_iter()
        .flatten()
        .flatten()
        .filter_map(|entry| Some((entry.metadata().ok()?.modified().ok()?, entry.path())))
        .collect();
    files.sort();
    let surplus = files.len().saturating_sub(MOST_REJECTED);
    for (_, path) in files.into_iter().take(surplus) {
        // One that cannot be removed is tried again.
        drop(fs::remove_file(path));
    }
}

fn thumbprint_of(certificate: &X509) -> String {
    certificate.thumbprint().as_hex_string().to_ascii_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_certificate_out_of_its_time_is_made_anew_unless_the_clock_is_wrong() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("own")).unwrap();
        let mut params = rcgen::CertificateParams::new(vec!["grinder".to_owned()]).unwrap();
        (params.not_before, params.not_after) = (rcgen::date_time_ymd(2_090, 1, 1), rcgen::date_time_ymd(2_110, 1, 1));
        let made = params.self_signed(&rcgen::KeyPair::generate().unwrap()).unwrap();
        std::fs::write(folder.path().join(OWN_CERTIFICATE), made.der()).unwrap();
        let fits_in = |year: i64| is_in_its_time(folder.path(), (year - 1_970) * 31_556_952);
        assert!(!fits_in(2_027), "made by a clock that was ahead");
        assert!(fits_in(2_100) && !fits_in(2_111));
        assert!(fits_in(1_970) && fits_in(2_020), "a clock without its battery");
    }
}
