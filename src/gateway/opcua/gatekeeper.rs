//! What stands before the OPC UA server: it bounds connections, and lets nothing of a stranger through to the library but
//! the question for its endpoints. The library itself would take sessions without encryption and old policies, and looks at
//! them only when a user logs in.
//! Source: OPC 10000-6 7.1 (messages), 6.7 (secure conversation).

use std::collections::BTreeMap;
use std::net::{IpAddr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::time::timeout;

use super::certificates::is_trusted;

/// Most connections, and of one address.
const MOST_CONNECTIONS: usize = 100;
const MOST_OF_ADDRESS: usize = 10;
/// After a connection that the system could not give, ms: it has no descriptors left.
const PAUSE: Duration = Duration::from_millis(200);
/// A stranger may ask for the endpoints, or be refused, for so long.
const STRANGER_TIME: Duration = Duration::from_secs(30);
/// Longest message that is taken, bytes.
pub const LONGEST_MESSAGE: usize = 65_535;
/// Type, kind of chunk and size of a message.
const HEADER: usize = 8;
/// Where the policy of an OPN message begins: after the header and the channel.
const POLICY_AT: usize = HEADER + 4;
/// Where the type of a service begins in a message without encryption: after header, channel, token, sequence and request.
const SERVICE_AT: usize = HEADER + 4 + 4 + 8;
/// Services of discovery, by the numbers of their binary encodings: FindServers, GetEndpoints.
const DISCOVERY: [u16; 2] = [422, 428];
/// Begin of the name of a policy.
const POLICY: &str = "http://opcfoundation.org/UA/SecurityPolicy#";

/// How a connection is secured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Security {
    /// Nothing was said yet.
    Unknown,
    /// Not at all: for discovery.
    Discovery,
    /// With a policy that is offered, and a certificate that nobody has trusted: it is told so, and no more.
    Stranger,
    /// With a certificate that is trusted.
    Trusted,
}

impl Security {
    /// Whether a message may pass, and how the connection is secured after it.
    fn after(self, message: &[u8], is_trusted: &dyn Fn(&[u8]) -> bool) -> Option<Self> {
        match (message.get(..3)?, self) {
            (b"HEL", Self::Unknown) => Some(self),
            (b"OPN", _) => {
                let asked = asked_security(message, is_trusted)?;
                let was_plain = self == Self::Discovery;
                (self == Self::Unknown || was_plain == (asked == Self::Discovery)).then_some(asked)
            }
            (b"MSG", Self::Discovery) => is_discovery(message).then_some(self),
            (b"MSG", Self::Stranger | Self::Trusted) => Some(self),
            (b"CLO", Self::Discovery | Self::Stranger | Self::Trusted) => Some(self),
            _ => None,
        }
    }
}

/// What an OPN message asks for by its policy and certificate; none for a policy that is not offered.
fn asked_security(message: &[u8], is_trusted: &dyn Fn(&[u8]) -> bool) -> Option<Security> {
    let (name, rest) = split_string(message.get(POLICY_AT..)?)?;
    match std::str::from_utf8(name).ok()?.strip_prefix(POLICY)? {
        "None" => Some(Security::Discovery),
        "Basic256Sha256" | "Aes256_Sha256_RsaPss" => {
            let (certificate, _) = split_string(rest)?;
            Some(if is_trusted(certificate) { Security::Trusted } else { Security::Stranger })
        }
        _ => None,
    }
}

/// The first string of bytes, which begins with its length, and what follows it.
fn split_string(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk::<4>()?;
    rest.split_at_checked(usize::try_from(i32::from_le_bytes(*length)).ok()?)
}

/// Whether a message in one piece, without encryption, is a question for servers or endpoints.
fn is_discovery(message: &[u8]) -> bool {
    let service = message.get(SERVICE_AT..SERVICE_AT + 4);
    // A node of namespace 0 in four bytes.
    message.get(3) == Some(&b'F')
        && service.is_some_and(|id| id[..2] == [1, 0] && DISCOVERY.contains(&u16::from_le_bytes([id[2], id[3]])))
}

/// The connections by their addresses.
#[derive(Clone, Default)]
struct Connections(Arc<Mutex<BTreeMap<IpAddr, usize>>>);

impl Connections {
    /// A place for another connection of an address; none if there are too many.
    fn enter(&self, address: IpAddr) -> Option<ConnectionPlace> {
        let mut counts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (all, own): (usize, usize) = (counts.values().sum(), counts.get(&address).copied().unwrap_or(0));
        if all >= MOST_CONNECTIONS || own >= MOST_OF_ADDRESS {
            return None;
        }
        counts.insert(address, own + 1);
        Some(ConnectionPlace { connections: self.clone(), address })
    }
}

/// A place of a connection, given back when it is dropped.
struct ConnectionPlace {
    connections: Connections,
    address: IpAddr,
}

impl Drop for ConnectionPlace {
    fn drop(&mut self) {
        let mut counts = self.connections.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(count) = counts.get_mut(&self.address) {
            *count -= 1;
            if *count == 0 {
                counts.remove(&self.address);
            }
        }
    }
}

/// Lets connections through to the server for ever.
pub async fn keep(listener: Arc<TcpListener>, server: SocketAddr, folder: PathBuf) {
    let connections = Connections::default();
    loop {
        match listener.accept().await {
            Ok((client, address)) => {
                if let Some(place) = connections.enter(address.ip()) {
                    let folder = folder.clone();
                    tokio::spawn(async move {
                        // Whatever ends a connection ends it for both sides.
                        drop(serve(client, server, &folder).await);
                        drop(place);
                    });
                }
            }
            Err(_) => tokio::time::sleep(PAUSE).await,
        }
    }
}

async fn serve(client: TcpStream, server: SocketAddr, folder: &Path) -> std::io::Result<()> {
    let inner = TcpStream::connect(server).await?;
    client.set_nodelay(true)?;
    inner.set_nodelay(true)?;
    let (mut from_client, mut to_client) = client.into_split();
    let (mut from_server, mut to_server) = inner.into_split();
    let questions = async {
        let (mut security, mut message) = (Security::Unknown, Vec::new());
        let begun = tokio::time::Instant::now();
        loop {
            let read = read_message(&mut from_client, &mut message);
            match security {
                Security::Trusted => read.await?,
                Security::Unknown | Security::Discovery | Security::Stranger => {
                    timeout(STRANGER_TIME.saturating_sub(begun.elapsed()), read).await??;
                }
            }
            security = security
                .after(&message, &|certificate| is_trusted(folder, certificate))
                .ok_or(std::io::ErrorKind::PermissionDenied)?;
            to_server.write_all(&message).await?;
        }
    };
    tokio::select! {
        ended = questions => ended,
        ended = tokio::io::copy(&mut from_server, &mut to_client) => ended.map(|_| ()),
    }
}

/// Reads one message with its header.
async fn read_message(from: &mut (impl AsyncReadExt + Unpin), message: &mut Vec<u8>) -> std::io::Result<()> {
    message.resize(HEADER, 0);
    from.read_exact(message).await?;
    let size = u32::from_le_bytes([message[4], message[5], message[6], message[7]]) as usize;
    if !(HEADER..=LONGEST_MESSAGE).contains(&size) {
        return Err(std::io::ErrorKind::InvalidData.into());
    }
    message.resize(size, 0);
    from.read_exact(&mut message[HEADER..]).await.map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(policy: &str) -> Vec<u8> {
        let name = format!("{POLICY}{policy}");
        let length = (name.len() as u32).to_le_bytes();
        [b"OPNF".as_slice(), &[0; 8], &length, name.as_bytes(), &4_u32.to_le_bytes(), b"cert"].concat()
    }

    /// Nobody is trusted.
    fn after(security: Security, message: &[u8]) -> Option<Security> {
        security.after(message, &|_| false)
    }

    fn service(number: u16) -> Vec<u8> {
        [b"MSGF".as_slice(), &[0; 20], &[1, 0], &number.to_le_bytes()].concat()
    }

    #[test]
    fn a_stranger_asks_for_endpoints_and_for_nothing_else() {
        let begun = after(Security::Unknown, b"HELF\0\0\0\0").unwrap();
        let discovery = after(begun, &open("None")).unwrap();
        assert_eq!(discovery, Security::Discovery);
        assert_eq!(after(discovery, &service(428)), Some(Security::Discovery));
        // CreateSession, Read, Browse; one in pieces; another policy in the same connection.
        for message in [service(461), service(631), service(527), open("Basic256Sha256"), b"HELF".to_vec()] {
            assert_eq!(after(discovery, &message), None);
        }
        let mut piece = service(428);
        piece[3] = b'C';
        assert_eq!(after(discovery, &piece), None);
        assert_eq!(after(discovery, b"CLOF"), Some(Security::Discovery));
    }

    #[test]
    fn only_the_policies_that_are_offered_pass() {
        for old in ["Basic128Rsa15", "Basic256", "Aes128_Sha256_RsaOaep", "", "none"] {
            assert_eq!(after(Security::Unknown, &open(old)), None, "{old}");
        }
        let stranger = after(Security::Unknown, &open("Aes256_Sha256_RsaPss")).unwrap();
        assert_eq!(stranger, Security::Stranger);
        assert_eq!(after(stranger, &service(461)), Some(Security::Stranger));
        assert_eq!(after(stranger, &open("None")), None);
    }

    #[test]
    fn a_trusted_certificate_makes_no_stranger_also_later() {
        let trusts = |certificate: &[u8]| certificate == b"cert";
        let stranger = after(Security::Unknown, &open("Basic256Sha256")).unwrap();
        assert_eq!(stranger.after(&open("Basic256Sha256"), &trusts), Some(Security::Trusted));
        assert_eq!(Security::Unknown.after(&open("Basic256Sha256"), &trusts), Some(Security::Trusted));
        let mut cut = open("Basic256Sha256");
        cut.truncate(cut.len() - 1);
        assert_eq!(Security::Unknown.after(&cut, &trusts), None);
    }

    #[test]
    fn nonsense_does_not_pass() {
        for message in
            [b"".as_slice(), b"MS", b"GET / HTTP/1.1", b"OPNF", b"OPNF\0\0\0\0\0\0\0\0\xff\xff\xff\xff", b"MSGF"]
        {
            assert_eq!(after(Security::Unknown, message), None, "{message:?}");
        }
        assert_eq!(after(Security::Unknown, &service(428)), None, "without a channel");
    }

    #[test]
    fn one_address_has_ten_places_and_gives_them_back() {
        let connections = Connections::default();
        let address = IpAddr::from([192, 168, 1, 30]);
        let places: Vec<_> = (0..MOST_OF_ADDRESS).map(|_| connections.enter(address).unwrap()).collect();
        assert!(connections.enter(address).is_none());
        assert!(connections.enter(IpAddr::from([192, 168, 1, 31])).is_some());
        drop(places);
        assert!(connections.enter(address).is_some());
    }
}
