//! The connection to the adapter port of a control: it is asked for a sign of life, and taken up again when it ends.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

/// Longest wait for a connection, and between two trials of one.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(3);
/// Longest wait for lines.
const READ_TIMEOUT: Duration = Duration::from_millis(200);
/// Time between two pings: the control says that it expects one in 10 s.
const PING_INTERVAL: Duration = Duration::from_secs(5);
/// Time between two looks at the list of orders.
const ORDERS_INTERVAL: Duration = Duration::from_secs(1);
/// A control that says nothing for so long is gone.
const LONGEST_SILENCE: Duration = Duration::from_secs(15);
/// Longest line, bytes.
const LONGEST_LINE: usize = 256 * 1_024;

/// A connection to a control.
pub struct AdapterClient {
    stream: TcpStream,
    received: Vec<u8>,
    pinged_at: Instant,
    asked_at: Instant,
    heard_at: Instant,
}

impl AdapterClient {
    /// Connects to a control.
    ///
    /// # Errors
    /// Nobody listens there.
    pub fn connect(address: &str) -> std::io::Result<Self> {
        let mut last = std::io::Error::new(ErrorKind::NotFound, "the address has no host");
        for place in address.to_socket_addrs()? {
            match TcpStream::connect_timeout(&place, CONNECT_TIMEOUT) {
                Ok(mut stream) => {
                    stream.set_read_timeout(Some(READ_TIMEOUT))?;
                    stream.set_write_timeout(Some(CONNECT_TIMEOUT))?;
                    stream.write_all(b"* PING\n* ORDERS\n")?;
                    let now = Instant::now();
                    return Ok(Self { stream, received: Vec::new(), pinged_at: now, asked_at: now, heard_at: now });
                }
                Err(error) => last = error,
            }
        }
        Err(last)
    }

    /// Proposes an order, JSON in one line; the answer is a line that comes.
    ///
    /// # Errors
    /// The connection has ended.
    pub fn propose(&mut self, order: &str) -> std::io::Result<()> {
        self.stream.write_all(format!("* ORDER {order}\n").as_bytes())
    }

    /// Says how the server does, a line.
    ///
    /// # Errors
    /// The connection has ended.
    pub fn report(&mut self, line: &str) -> std::io::Result<()> {
        self.stream.write_all(line.as_bytes())
    }

    /// The whole lines that have come, waiting a moment for them.
    ///
    /// # Errors
    /// The connection has ended, or the control is silent.
    pub fn lines(&mut self) -> std::io::Result<Vec<String>> {
        if self.pinged_at.elapsed() >= PING_INTERVAL {
            self.stream.write_all(b"* PING\n")?;
            self.pinged_at = Instant::now();
        }
        if self.asked_at.elapsed() >= ORDERS_INTERVAL {
            self.stream.write_all(b"* ORDERS\n")?;
            self.asked_at = Instant::now();
        }
        let mut bytes = [0; 16 * 1_024];
        match self.stream.read(&mut bytes) {
            Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
            Ok(count) => {
                self.received.extend_from_slice(&bytes[..count]);
                self.heard_at = Instant::now();
            }
            Err(error)
                if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted) => {}
            Err(error) => return Err(error),
        }
        if self.heard_at.elapsed() >= LONGEST_SILENCE || self.received.len() > LONGEST_LINE {
            return Err(ErrorKind::TimedOut.into());
        }
        let Some(end) = self.received.iter().rposition(|byte| *byte == b'\n') else { return Ok(Vec::new()) };
        let whole: Vec<u8> = self.received.drain(..=end).collect();
        Ok(String::from_utf8_lossy(&whole).lines().map(str::to_owned).collect())
    }
}
