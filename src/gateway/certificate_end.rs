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

/// Whether a certificate is valid at a time, s since 1970, UTC.
#[cfg(feature = "opcua")]
pub fn is_valid_at(certificate: &CertificateDer<'_>, time: i64) -> bool {
    X509Certificate::from_der(certificate).is_ok_and(|(_, read)| {
        let validity = read.validity();
        (validity.not_before.timestamp()..validity.not_after.timestamp()).contains(&time)
    })
}

#[cfg(test)]
mod tests {
    use rcgen::{CertificateParams, KeyPair, date_time_ymd};

    use super::*;

    #[test]
    fn the_certificate_that_ends_first_counts() {
        let made = |year: i32| {
            let key = KeyPair::generate().unwrap();
            let mut params = CertificateParams::new(vec!["machine".to_owned()]).unwrap();
            params.not_after = date_time_ymd(year, 2, 27);
            params.self_signed(&key).unwrap().der().clone()
        };
        let chain = [made(2031), made(2029), made(2030)];
        assert_eq!(certificate_end(&chain), DateTime::from_parts([2_029, 2, 27, 0, 0, 0]));
        assert_eq!(certificate_end(&[CertificateDer::from(vec![1, 2, 3])]), None);
    }
}
