//! The certificates of the server: its own one, those of clients that are trusted, and those that were refused. Trusting
//! one is done by a person who has compared its thumbprint.

use std::fs;
use std::path::{Path, PathBuf};

use opcua::crypto::{CertificateStore, X509, X509Data};

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
/// Certificates of strangers that are kept: each stranger could send others without end.
const MOST_REJECTED: usize = 50;

/// Makes the server's own certificate if there is none. `uri` is the name of the application, `hosts` are the names under
/// which clients reach it.
///
/// # Errors
/// A file cannot be written.
pub fn ensure_own(folder: &Path, uri: &str, hosts: Vec<String>) -> Result<(), String> {
    let (certificate, key) = (folder.join(OWN_CERTIFICATE), folder.join(PRIVATE_KEY));
    let at = |path: &Path| format!("{}: ", path.display());
    for name in ["own", "private", TRUSTED, REJECTED] {
        let path = folder.join(name);
        fs::create_dir_all(&path).map_err(|error| at(&path) + &error.to_string())?;
    }
    keep_private(&folder.join("private")).map_err(|error| at(&folder.join("private")) + &error.to_string())?;
    if certificate.exists() && key.exists() {
        return Ok(());
    }
    let data = X509Data {
        key_size: KEY_BITS,
        common_name: "KT-830".to_owned(),
        organization: "KT-830".to_owned(),
        organizational_unit: String::new(),
        country: "CN".to_owned(),
        state: String::new(),
        alt_host_names: X509Data::alt_host_names(uri, Some(hosts), false, true, true),
        certificate_duration_days: VALID_DAYS,
    };
    CertificateStore::create_certificate_and_key(&data, true, &certificate, &key).map(|_| ())
}

/// Nobody else reads what is in a folder.
fn keep_private(folder: &Path) -> std::io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        fs::set_permissions(folder, fs::Permissions::from_mode(0o700))?;
    }
    #[cfg(not(unix))]
    let _ = folder;
    Ok(())
}

/// A certificate of a client that was refused.
pub struct RejectedCertificate {
    /// The file.
    pub path: PathBuf,
    /// SHA-1 of it, hexadecimal: what a client shows of its own certificate.
    pub thumbprint: String,
    /// Who it says to be.
    pub subject: String,
}

/// The certificates of clients that were refused.
#[must_use]
pub fn rejected(folder: &Path) -> Vec<RejectedCertificate> {
    let files = fs::read_dir(folder.join(REJECTED)).into_iter().flatten().flatten().map(|entry| entry.path());
    let read = files.filter_map(|path| {
        let certificate = CertificateStore::read_cert(&path).ok()?;
        let (thumbprint, subject) = (thumbprint_of(&certificate), certificate.subject_name());
        Some(RejectedCertificate { path, thumbprint, subject })
    });
    read.collect()
}

/// Trusts a certificate: a file, or the thumbprint of one that was refused. Returns its thumbprint.
///
/// # Errors
/// There is no such certificate, or the file cannot be moved.
pub fn trust(folder: &Path, certificate: &str) -> Result<String, String> {
    let wanted = certificate.replace([':', ' '], "").to_ascii_lowercase();
    let refused = rejected(folder).into_iter().find(|other| other.thumbprint == wanted);
    let source = refused.as_ref().map_or_else(|| PathBuf::from(certificate), |refused| refused.path.clone());
    let read = CertificateStore::read_cert(&source).map_err(|error| format!("{}: {error}", source.display()))?;
    let name = CertificateStore::cert_file_name(&read);
    let target = folder.join(TRUSTED).join(&name);
    let failed = |error: std::io::Error| format!("{}: {error}", target.display());
    fs::create_dir_all(folder.join(TRUSTED)).map_err(failed)?;
    fs::copy(&source, &target).map_err(failed)?;
    // One that lies among the refused ones stays refused.
    let refused = folder.join(REJECTED).join(&name);
    if refused.exists() {
        fs::remove_file(&refused).map_err(failed)?;
    }
    Ok(thumbprint_of(&read))
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
