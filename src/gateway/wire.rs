//! A stream to the other side, encrypted or not. All calls return at once.

use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::Arc;

use rustls::{ClientConnection, ServerConfig, ServerConnection, StreamOwned};

/// A stream.
pub enum Wire {
    /// As it is.
    Plain(TcpStream),
    /// In TLS, to a server.
    ToServer(Box<StreamOwned<ClientConnection, TcpStream>>),
    /// In TLS, from a client.
    ToClient(Box<StreamOwned<ServerConnection, TcpStream>>),
}

impl Wire {
    /// A stream from a client; in TLS with a configuration for it.
    ///
    /// # Errors
    /// The configuration makes no sense.
    pub fn from_client(stream: TcpStream, tls: Option<&Arc<ServerConfig>>) -> Result<Self, rustls::Error> {
        Ok(match tls {
            None => Self::Plain(stream),
            Some(config) => {
                let session = ServerConnection::new(Arc::clone(config))?;
                Self::ToClient(Box::new(StreamOwned::new(session, stream)))
            }
        })
    }

    /// Reads what has come; what waits to be sent goes on its way, too.
    ///
    /// # Errors
    /// As `Read::read`; `WouldBlock` where nothing has come.
    pub fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        match self {
            Self::Plain(stream) => stream.read(bytes),
            Self::ToServer(stream) => stream.read(bytes),
            Self::ToClient(stream) => stream.read(bytes),
        }
    }

    /// Takes bytes to be sent.
    ///
    /// # Errors
    /// As `Write::write`; `WouldBlock` where none is taken.
    pub fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        match self {
            Self::Plain(stream) => stream.write(bytes),
            Self::ToServer(stream) => stream.write(bytes),
            Self::ToClient(stream) => stream.write(bytes),
        }
    }

    /// Tells the other side that nothing follows, once all that was taken is sent; whether it was told.
    ///
    /// # Errors
    /// The connection is over.
    pub fn finish(&mut self) -> std::io::Result<bool> {
        match self {
            Self::Plain(stream) => stream.shutdown(Shutdown::Write).map(|()| true),
            Self::ToServer(stream) => {
                stream.conn.send_close_notify();
                is_flushed(stream.flush())
            }
            Self::ToClient(stream) => {
                stream.conn.send_close_notify();
                is_flushed(stream.flush()).and_then(|flushed| {
                    if flushed { stream.sock.shutdown(Shutdown::Write).map(|()| true) } else { Ok(false) }
                })
            }
        }
    }
}

fn is_flushed(flushed: std::io::Result<()>) -> std::io::Result<bool> {
    match flushed {
        Ok(()) => Ok(true),
        Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => Ok(false),
        Err(error) => Err(error),
    }
}
