//! The serial line: 8 data bits, no parity, one stop bit, XON/XOFF. Data are written and read in chunks, so that 取消
//! takes effect. Every wait has a timeout.
//! Source: spec L9.

use std::io::{self, ErrorKind, Write};
use std::time::{Duration, Instant};

use serialport::{ClearBuffer, DataBits, FlowControl, Parity, SerialPort, StopBits};

use super::format::{ReadProgress, SerialReader, XOFF, XON};
use super::{SERIAL_LIMIT, SerialError};
use crate::defs::param::{self, Params};
use crate::defs::text::LocalizedText;

/// Timeout of one read; then 取消 is checked.
const POLL_TIMEOUT: Duration = Duration::from_millis(100);
/// Pause while the system takes no more bytes.
const FULL_PAUSE: Duration = Duration::from_millis(10);
/// Chunk size for writing, bytes.
const CHUNK: usize = 512;

/// What ends a wait for the other side.
#[derive(Clone, Copy)]
pub struct SerialWait<'a> {
    /// Whether the operator has cancelled.
    pub stopped: &'a dyn Fn() -> bool,
    /// The time that the timeouts are measured with; [`Instant::now`] on a real line.
    pub now: &'a dyn Fn() -> Instant,
}

impl SerialWait<'_> {
    fn elapsed_since(&self, start: Instant) -> Duration {
        (self.now)().saturating_duration_since(start)
    }
}

/// Settings of the line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialLine {
    /// The port: `/dev/ttyS0`, `COM1`.
    pub port: String,
    /// Bits a second (P370).
    pub baud: u32,
    /// A pause of this length ends a transmission that has started (P371).
    pub silence_timeout: Duration,
    /// How long to wait for the start of a transmission (P372).
    pub start_timeout: Duration,
    /// Number of NUL bytes before and after the programs (P373).
    pub leader: usize,
    /// Maximum number of bytes sent or received.
    pub limit: usize,
}

impl SerialLine {
    /// The settings of a port from the parameters.
    #[must_use]
    pub fn from_params(params: &Params, port: String) -> Self {
        let seconds = |row| Duration::from_secs_f64(params.get(row));
        Self {
            port,
            baud: params.get(param::SERIAL_BAUD) as u32,
            silence_timeout: seconds(param::SERIAL_PAUSE_TIMEOUT),
            start_timeout: seconds(param::SERIAL_START_TIMEOUT),
            leader: params.get(param::SERIAL_LEADER_LENGTH) as usize,
            limit: SERIAL_LIMIT,
        }
    }

    fn open(&self) -> Result<OpenLine, SerialError> {
        let refused = |error: &dyn std::fmt::Display| {
            SerialError::Port(LocalizedText::same(&format!("{} {} bit/s: {error}", self.port, self.baud)))
        };
        let port = serialport::new(&self.port, self.baud)
            .data_bits(DataBits::Eight)
            .parity(Parity::None)
            .stop_bits(StopBits::One)
            .flow_control(FlowControl::Software)
            .timeout(POLL_TIMEOUT);
        // Before the port is opened for this process alone.
        #[cfg(unix)]
        let out = open_unblocked(&self.port).map_err(|error| refused(&error))?;
        let port = port.open().map_err(|error| refused(&error))?;
        #[cfg(not(unix))]
        let out: Box<dyn Write> = port.try_clone().map_err(|error| refused(&error))?;
        Ok(OpenLine { port, out })
    }

    /// Sends bytes; `tell` receives the number of bytes sent.
    ///
    /// # Errors
    /// The port cannot be opened or has disappeared, the other side accepts no data, or the operator has cancelled.
    pub fn send(&self, bytes: &[u8], wait: SerialWait<'_>, tell: &mut dyn FnMut(u64)) -> Result<(), SerialError> {
        if bytes.len() > self.limit {
            return Err(SerialError::TooLong(self.limit));
        }
        let OpenLine { mut port, mut out } = self.open()?;
        let (mut sent, mut moved) = (0, (wait.now)());
        while sent < bytes.len() {
            if (wait.stopped)() {
                drop(port.clear(ClearBuffer::Output));
                return Err(SerialError::Cancelled);
            }
            let piece = &bytes[sent..bytes.len().min(sent + CHUNK)];
            match out.write(piece) {
                Ok(0) => {}
                Ok(written) => {
                    (sent, moved) = (sent + written, (wait.now)());
                    tell(sent as u64);
                }
                Err(error) => {
                    ignore_timeout(&error)?;
                    std::thread::sleep(FULL_PAUSE);
                }
            }
            if wait.elapsed_since(moved) > self.silence_timeout {
                drop(port.clear(ClearBuffer::Output));
                return Err(SerialError::NotAccepted);
            }
        }
        self.drain(port.as_mut(), wait)
    }

    /// Waits until the system's output buffer is empty, before the port is closed.
    fn drain(&self, port: &mut dyn SerialPort, wait: SerialWait<'_>) -> Result<(), SerialError> {
        let (mut left, mut moved) = (u32::MAX, (wait.now)());
        loop {
            let now = port.bytes_to_write().map_err(|error| disconnected(&error))?;
            if now == 0 {
                return Ok(());
            }
            if now < left {
                (left, moved) = (now, (wait.now)());
            }
            let trouble = if (wait.stopped)() { SerialError::Cancelled } else { SerialError::NotAccepted };
            if trouble == SerialError::Cancelled || wait.elapsed_since(moved) > self.silence_timeout {
                drop(port.clear(ClearBuffer::Output));
                return Err(trouble);
            }
            std::thread::sleep(FULL_PAUSE);
        }
    }

    /// Receives one transmission: sends XON, reads up to the closing `%`, sends XOFF. `tell` receives the bytes so far.
    ///
    /// # Errors
    /// A fault of the port, the line or the data; or the operator has cancelled.
    pub fn receive(&self, wait: SerialWait<'_>, tell: &mut dyn FnMut(u64)) -> Result<SerialReader, SerialError> {
        let OpenLine { mut port, mut out } = self.open()?;
        drop(port.clear(ClearBuffer::Input));
        send_byte(out.as_mut(), XON)?;
        let mut reader = SerialReader::new(self.limit);
        let read = self.read(port.as_mut(), &mut reader, wait, tell);
        // The read error has priority over an error of XOFF.
        let told = send_byte(out.as_mut(), XOFF);
        read.and(told).map(|()| reader)
    }

    fn read(
        &self,
        port: &mut dyn SerialPort,
        reader: &mut SerialReader,
        wait: SerialWait<'_>,
        tell: &mut dyn FnMut(u64),
    ) -> Result<(), SerialError> {
        let mut buffer = [0; 4_096];
        let mut heard = (wait.now)();
        loop {
            if (wait.stopped)() {
                return Err(SerialError::Cancelled);
            }
            match port.read(&mut buffer) {
                Ok(0) => return Err(disconnected(&"end of file")),
                Ok(count) => {
                    heard = (wait.now)();
                    for byte in &buffer[..count] {
                        if reader.push(*byte)? == ReadProgress::Done {
                            return Ok(());
                        }
                    }
                    tell(reader.size() as u64);
                }
                // Nothing follows the last %, not even a line end.
                Err(error) if error.kind() == ErrorKind::TimedOut && reader.is_closing() => return Ok(()),
                Err(error) => ignore_timeout(&error)?,
            }
            let most = if reader.has_begun() { self.silence_timeout } else { self.start_timeout };
            if wait.elapsed_since(heard) > most {
                return Err(reader.timeout_error());
            }
        }
    }
}

/// An open line.
struct OpenLine {
    port: Box<dyn SerialPort>,
    /// Takes the bytes to send. It never waits: while the other side holds by XOFF a write could wait for ever.
    out: Box<dyn Write>,
}

/// Opens a port a second time for writing without waiting. `serialport` waits in its writes.
#[cfg(unix)]
fn open_unblocked(port: &str) -> io::Result<Box<dyn Write>> {
    use rustix::fs::{Mode, OFlags};
    let flags = OFlags::WRONLY | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    Ok(Box::new(std::fs::File::from(rustix::fs::open(port, flags, Mode::empty())?)))
}

/// Sends one byte; a timeout is ignored.
fn send_byte(out: &mut dyn Write, byte: u8) -> Result<(), SerialError> {
    out.write_all(&[byte]).or_else(|error| ignore_timeout(&error))
}

/// Ignores timeouts; any other error means that the port has disappeared.
fn ignore_timeout(error: &std::io::Error) -> Result<(), SerialError> {
    match error.kind() {
        ErrorKind::TimedOut | ErrorKind::Interrupted | ErrorKind::WouldBlock => Ok(()),
        _ => Err(disconnected(error)),
    }
}

fn disconnected(error: &dyn std::fmt::Display) -> SerialError {
    SerialError::Disconnected(LocalizedText::same(&error))
}

/// The names of the serial ports of this computer, sorted.
#[must_use]
pub fn port_names() -> Vec<String> {
    let mut names: Vec<String> =
        serialport::available_ports().unwrap_or_default().into_iter().map(|port| port.port_name).collect();
    names.sort();
    names.dedup();
    names
}
