//! The broker to which the control connects, and what it proves itself with: the file `mqtt.ron` of the data directory.
//! Source: docs/manual, chapter "network".

use std::net::Ipv6Addr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer, ServerName};
use rustls::{ClientConfig, RootCertStore};
use serde::Deserialize;

use crate::defs::date::DateTime;
use crate::defs::text::{LocalizedText, Text};
use crate::gateway::certificate_end::certificate_end;
use crate::gateway::in_words;
use crate::store::ron_file::{self, ChecksumPolicy, RonError};

/// Name of the file.
pub const SETTINGS_FILE: &str = "mqtt.ron";
/// Ports of MQTT, and of MQTT in TLS.
const PORTS: [u16; 2] = [1_883, 8_883];
/// Longest name of a group, characters.
const LONGEST_GROUP: usize = 64;

/// The file as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BrokerSettings {
    /// Name or address of the broker, an IPv6 address in brackets; with its port after a colon where that is not 1883, or
    /// 8883 in TLS.
    pub broker: String,
    /// Group of this machine (Sparkplug: group id).
    #[serde(default = "default_group")]
    pub group: String,
    /// User; empty for none.
    #[serde(default)]
    pub user: String,
    /// Password of the user.
    #[serde(default)]
    pub password: String,
    /// TLS; without it everybody in between reads and writes what is sent.
    #[serde(default)]
    pub tls: Option<TlsSettings>,
}

/// Certificates, PEM files in the data directory.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TlsSettings {
    /// Those who may vouch for the broker.
    pub ca: String,
    /// Certificate and key of this machine, where the broker asks for them.
    #[serde(default)]
    pub machine: Option<(String, String)>,
}

fn default_group() -> String {
    "KT-830".to_owned()
}

/// The name of a broker and how a connection to it is encrypted.
pub struct TlsEnds {
    /// What the control accepts and proves itself with.
    pub config: Arc<ClientConfig>,
    /// The name that the certificate of the broker must have.
    pub name: ServerName<'static>,
    /// When the certificate of the control ends; none without one.
    pub machine_until: Option<DateTime>,
}

impl BrokerSettings {
    /// Reads the file of a data directory.
    ///
    /// # Errors
    /// It is missing, not readable, or says something that makes no sense; in words for the page.
    pub fn read(folder: &Path) -> Result<Self, LocalizedText> {
        let read = ron_file::read::<Self>(&folder.join(SETTINGS_FILE), ChecksumPolicy::Lenient);
        let settings = read.map_err(|error| match error {
            RonError::Missing(_) => LocalizedText::from(Text::new(
                "数据目录中没有 mqtt.ron（见手册）",
                "no mqtt.ron in the data directory (manual)",
            )),
            error => in_words(error),
        })?;
        settings.value.check().map(|()| settings.value)
    }

    fn check(&self) -> Result<(), LocalizedText> {
        let is_topic_level = |name: &str| {
            (1..=LONGEST_GROUP).contains(&name.chars().count())
                && !name.contains(|sign: char| matches!(sign, '/' | '+' | '#') || sign.is_control())
        };
        if self.host_and_port().is_none() {
            let text =
                Text::new("mqtt.ron：broker 应为“名称”或“名称:端口”", "mqtt.ron: broker is a name, or name:port");
            return Err(text.into());
        }
        if !is_topic_level(&self.group) {
            let text = Text::new("mqtt.ron：group 不可为空，不可有 / + #", "mqtt.ron: group is empty or has / + #");
            return Err(text.into());
        }
        if self.user.is_empty() && !self.password.is_empty() {
            return Err(Text::new("mqtt.ron：有密码没有用户", "mqtt.ron: a password without a user").into());
        }
        Ok(())
    }

    /// Name or address of the broker, and its port.
    #[must_use]
    pub fn host_and_port(&self) -> Option<(String, u16)> {
        let usual = PORTS[usize::from(self.tls.is_some())];
        let read_port = |port: &str| port.parse().ok().filter(|port| *port > 0);
        if let Some((address, rest)) = self.broker.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
            let port = if rest.is_empty() { usual } else { read_port(rest.strip_prefix(':')?)? };
            return address.parse::<Ipv6Addr>().is_ok().then(|| (address.to_owned(), port));
        }
        let (host, port) = match self.broker.rsplit_once(':') {
            Some((host, port)) => (host, read_port(port)?),
            None => (self.broker.as_str(), usual),
        };
        let is_name =
            !host.is_empty() && !host.contains(|sign: char| sign.is_whitespace() || matches!(sign, '/' | ':'));
        is_name.then(|| (host.to_owned(), port))
    }

    /// How connections are encrypted; `None` without TLS.
    ///
    /// # Errors
    /// A file of a certificate or key is missing or not one; in words for the page.
    pub fn tls_ends(&self, folder: &Path) -> Result<Option<TlsEnds>, LocalizedText> {
        let Some(tls) = &self.tls else { return Ok(None) };
        let host = self.host_and_port().map(|(host, _)| host).unwrap_or_default();
        let name = ServerName::try_from(host).map_err(in_words)?;
        let mut roots = RootCertStore::empty();
        for certificate in certificates(&folder.join(&tls.ca))? {
            roots.add(certificate).map_err(|error| wrong(&folder.join(&tls.ca), &error))?;
        }
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let builder = ClientConfig::builder_with_provider(provider)
            .with_safe_default_protocol_versions()
            .map_err(in_words)?
            .with_root_certificates(roots);
        let mut machine_until = None;
        let config = match &tls.machine {
            None => builder.with_no_client_auth(),
            Some((certificate, key)) => {
                let path = folder.join(key);
                let key = PrivateKeyDer::from_pem_file(&path).map_err(|error| wrong(&path, &error))?;
                let chain = certificates(&folder.join(certificate))?;
                machine_until = certificate_end(&chain);
                builder.with_client_auth_cert(chain, key).map_err(|error| wrong(&path, &error))?
            }
        };
        Ok(Some(TlsEnds { config: Arc::new(config), name, machine_until }))
    }
}

/// The certificates of a PEM file, one at least.
fn certificates(path: &Path) -> Result<Vec<CertificateDer<'static>>, LocalizedText> {
    let read = CertificateDer::pem_file_iter(path).map_err(|error| wrong(path, &error))?;
    let all: Vec<_> = read.collect::<Result<_, _>>().map_err(|error| wrong(path, &error))?;
    if all.is_empty() { Err(wrong(path, &"no certificate in it")) } else { Ok(all) }
}

fn wrong(path: &Path, error: &impl std::fmt::Display) -> LocalizedText {
    let name = PathBuf::from(path.file_name().unwrap_or(path.as_os_str()));
    in_words(format!("{}: {error}", name.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_broker_is_a_name_or_an_address_with_or_without_a_port() {
        let parts = |broker: &str| {
            let none = String::new();
            BrokerSettings {
                broker: broker.to_owned(),
                group: none.clone(),
                user: none.clone(),
                password: none,
                tls: None,
            }
            .host_and_port()
        };
        let cases = [
            ("broker.shop", Some(("broker.shop", 1_883))),
            ("10.0.0.5:8884", Some(("10.0.0.5", 8_884))),
            ("[fd00::5]", Some(("fd00::5", 1_883))),
            ("[fd00::5]:8884", Some(("fd00::5", 8_884))),
            ("fd00::5", None),
            ("[fd00::5]8884", None),
            ("[broker]:8884", None),
            ("broker:0", None),
            ("broker:x", None),
            ("", None),
            (":1883", None),
        ];
        for (broker, expected) in cases {
            let found = parts(broker);
            assert_eq!(found.as_ref().map(|(host, port)| (host.as_str(), *port)), expected, "{broker}");
        }
    }
}
