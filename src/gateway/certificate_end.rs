//! Until when a certificate is valid: one that ends is told before it ends the connection.

use rustls::pki_types::CertificateDer;
use x509_parser::prelude::{FromDer, X509Certificate};

use crate::defs::date::DateTime;

/// The end of the validity of the certificate of a chain that ends first, UTC; none where none can be read.
pub fn certificate_end<'a>(chain: impl IntoIterator<Item = &'a CertificateDer<'a>>) -> Option<DateTime> {
    let end = |certificate: &CertificateDer<'_>| {
        let (_, read) = X509Certificate::from_der(certificate).ok()?;
        Some(DateTime(read.validity().not_after.timestamp()))
    };
    chain.into_iter().filter_map(end).min()
}
