//! What the OPC UA server says of itself at the adapter port (`* OPCUA {…}`): the page of the control shows it.

use serde::{Deserialize, Serialize};

use crate::defs::date::DateTime;
use crate::link::network::OpcUaView;

/// Begin of the line.
pub const OPCUA_REPORT: &str = "* OPCUA ";
/// Longest address, characters.
const LONGEST_ADDRESS: usize = 100;

/// State of the server.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OpcUaReport {
    /// Where clients reach it.
    pub address: String,
    /// Clients that are connected.
    pub clients: u32,
    /// Certificates that were refused and that nobody has trusted.
    pub untrusted: u32,
    /// When its own certificate ends, s since 1970, UTC.
    pub until: Option<i64>,
}

impl OpcUaReport {
    /// The line, with its end.
    #[must_use]
    pub fn line(&self) -> String {
        // Numbers and a text are always written.
        let report = serde_json::to_string(self).unwrap_or_default();
        format!("{OPCUA_REPORT}{report}\n")
    }

    /// What the page shows of the report that a line has; none for something else.
    #[must_use]
    pub fn view(line: &[u8]) -> Option<OpcUaView> {
        let report = line.strip_prefix(OPCUA_REPORT.as_bytes())?;
        let Self { address, clients, untrusted, until } = serde_json::from_slice(report).ok()?;
        let address = address.chars().filter(|sign| !sign.is_control()).take(LONGEST_ADDRESS).collect();
        Some(OpcUaView { address, clients, untrusted, certificate_until: until.map(DateTime) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_is_read_as_it_was_written_and_nothing_else_is() {
        let report =
            OpcUaReport { address: "opc.tcp://grinder:4840/".into(), clients: 2, untrusted: 1, until: Some(86_400) };
        let line = report.line();
        let view = OpcUaReport::view(line.trim_end().as_bytes()).unwrap();
        assert_eq!((view.address.as_str(), view.clients, view.untrusted), ("opc.tcp://grinder:4840/", 2, 1));
        assert_eq!(view.certificate_until, Some(DateTime(86_400)));
        for other in ["* OPCUA", "* OPCUA {}", "* OPCUA [1]", "* PING", "* OPCUA {\"address\":\"\",\"clients\":-1}"] {
            assert_eq!(OpcUaReport::view(other.as_bytes()), None, "{other}");
        }
        let long = OpcUaReport { address: "a\u{7}".repeat(5_000), ..report };
        let view = OpcUaReport::view(long.line().trim_end().as_bytes()).unwrap();
        assert_eq!(view.address, "a".repeat(LONGEST_ADDRESS));
    }
}
