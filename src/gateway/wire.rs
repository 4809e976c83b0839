//! A stream to the other side, encrypted or not. All calls return at once, after a bounded piece of work: whoever sends
//! without end is not listened to for longer than the others.

use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::Arc;

use super::certificate_end::certificate_end;
use crate::link::network::TlsView;
use rustls::{Connection, ServerConfig, ServerConnection};

/// A stream.
pub enum Wire {
    /// As it is.
    Plain(TcpStream),
    /// In TLS.
    Tls(Box<Connection>, TcpStream),
}

impl Wire {
    /// A stream from a client; in TLS with a configuration for it.
    ///
    /// # Errors
    /// The configuration makes no sense.
    pub fn from_client(stream: TcpStream, tls: Option<&Arc<ServerConfig>>) -> Result<Self, rustls::Error> {
        Ok(match tls {
            None => Self::Plain(stream),
            Some(config) => Self::Tls(Box::new(ServerConnection::new(Arc::clone(config))?.into()), stream),
        })
    }

    /// Reads what has come; what waits to be sent goes on its way, too. In TLS one piece is taken from the system: records
    /// without content keep nobody here.
    ///
    /// # Errors
    /// As `Read::read`; `WouldBlock` where nothing has come.
    pub fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        let (session, stream) = match self {
            Self::Plain(stream) => return stream.read(bytes),
            Self::Tls(session, stream) => (session, stream),
        };
        send_records(session, stream)?;
        match session.reader().read(bytes) {
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            read => return read,
        }
        session.read_tls(stream)?;
        if let Err(fault) = session.process_new_packets() {
            // The other side is told why, if it still listens.
            drop(send_records(session, stream));
            return Err(std::io::Error::new(ErrorKind::InvalidData, fault));
        }
        send_records(session, stream)?;
        session.reader().read(bytes)
    }

    /// Takes bytes to be sent.
    ///
    /// # Errors
    /// As `Write::write`; `WouldBlock` where none is taken.
    pub fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let (session, stream) = match self {
            Self::Plain(stream) => return stream.write(bytes),
            Self::Tls(session, stream) => (session, stream),
        };
        send_records(session, stream)?;
        let taken = session.writer().write(bytes)?;
        send_records(session, stream)?;
        if taken == 0 { Err(ErrorKind::WouldBlock.into()) } else { Ok(taken) }
    }

    /// How it is encrypted, once the other side has proved itself; none where it is not.
    #[must_use]
    pub fn tls(&self) -> Option<TlsView> {
        match self {
            Self::Plain(_) => None,
            Self::Tls(session, _) => {
                Some(TlsView { valid_until: certificate_end(session.peer_certificates().into_iter().flatten()) })
            }
        }
    }

    /// Whether all that was taken is with the system.
    #[must_use]
    pub fn is_flushed(&self) -> bool {
        match self {
            Self::Plain(_) => true,
            Self::Tls(session, _) => !session.wants_write(),
        }
    }

    /// Tells the other side that nothing follows, once all that was taken is sent; whether it was told.
    ///
    /// # Errors
    /// The connection is over.
    pub fn finish(&mut self) -> std::io::Result<bool> {
        let stream = match self {
            Self::Plain(stream) => stream,
            Self::Tls(session, stream) => {
                session.send_close_notify();
                send_records(session, stream)?;
                if session.wants_write() {
                    return Ok(false);
                }
                stream
            }
        };
        stream.shutdown(Shutdown::Write).map(|()| true)
    }
}

/// Gives the system what it takes now.
fn send_records(session: &mut Connection, stream: &mut TcpStream) -> std::io::Result<()> {
    while session.wants_write() {
        match session.write_tls(stream) {
            Ok(0) => return Err(ErrorKind::WriteZero.into()),
            Ok(_) => {}
            Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(()),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}
