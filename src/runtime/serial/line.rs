//! The serial line: 8 data bits, no parity, one stop bit, XON/XOFF. Data are written and read in chunks, so that 取消
//! takes effect. Every wait has a timeout.
//! Source: spec L9.

use std::io::ErrorKind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use serialport::{ClearBuffer, DataBits, FlowControl, Parity, SerialPort, StopBits};

use super::sheet::{Reader, Step, XOFF, XON};
use super::{SERIAL_LIMIT, Trouble};
use crate::defs::param::{self, Params};
use crate::defs::text::Said;

/// Timeout of one read or write; then 取消 is checked.
const LOOK: Duration = Duration::from_millis(100);
/// Chunk size for writing, bytes.
const PIECE: usize = 512;

/// Settings of the line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// The port: `/dev/ttyS0`, `COM1`.
    pub port: String,
    /// Bits a second (P370).
    pub baud: u32,
    /// A pause of this length ends a transmission that has started (P371).
    pub silence: Duration,
    /// How long to wait for the start of a transmission (P372).
    pub start: Duration,
    /// Number of NUL bytes before and after the programs (P373).
    pub leader: usize,
    /// Maximum number of bytes sent or received.
    pub limit: usize,
}

impl Line {
    /// The settings of a port from the parameters.
    #[must_use]
    pub fn of(params: &Params, port: String) -> Self {
        let seconds = |row| Duration::from_secs_f64(params.get(row));
        Self {
            port,
            baud: params.get(param::SERIAL_BAUD) as u32,
            silence: seconds(param::SERIAL_SILENCE),
            start: seconds(param::SERIAL_START),
            leader: params.get(param::SERIAL_LEADER) as usize,
            limit: SERIAL_LIMIT,
        }
    }

    fn open(&self) -> Result<Box<dyn SerialPort>, Trouble> {
        let port = serialport::new(&self.port, self.baud)
            .data_bits(DataBits::Eight)
            .parity(Parity::None)
            .stop_bits(StopBits::One)
            .flow_control(FlowControl::Software)
            .timeout(LOOK);
        port.open().map_err(|error| {
            let words = format!("{} {} bit/s: {error}", self.port, self.baud);
            Trouble::Port(Said::new(words.clone(), words))
        })
    }

    /// Sends bytes; `tell` receives the number of bytes sent.
    ///
    /// # Errors
    /// The port cannot be opened or has disappeared, the other side accepts no data, or the operator has cancelled.
    pub fn send(&self, bytes: &[u8], cancelled: &AtomicBool, tell: &mut dyn FnMut(u64)) -> Result<(), Trouble> {
        if bytes.len() > self.limit {
            return Err(Trouble::TooLong(self.limit));
        }
        let mut port = self.open()?;
        let (mut sent, mut moved) = (0, Instant::now());
        while sent < bytes.len() {
            if cancelled.load(Ordering::Acquire) {
                drop(port.clear(ClearBuffer::Output));
                return Err(Trouble::Cancelled);
            }
            let piece = &bytes[sent..bytes.len().min(sent + PIECE)];
            match port.write(piece) {
                Ok(0) => {}
                Ok(written) => {
                    (sent, moved) = (sent + written, Instant::now());
                    tell(sent as u64);
                }
                Err(error) => pass(&error)?,
            }
            if moved.elapsed() > self.silence {
                drop(port.clear(ClearBuffer::Output));
                return Err(Trouble::Held);
            }
        }
        self.drain(port.as_mut(), cancelled)
    }

    /// Waits until the system's output buffer is empty, before the port is closed.
    fn drain(&self, port: &mut dyn SerialPort, cancelled: &AtomicBool) -> Result<(), Trouble> {
        let (mut left, mut moved) = (u32::MAX, Instant::now());
        loop {
            let now = port.bytes_to_write().map_err(|error| gone(&error))?;
            if now == 0 {
                return Ok(());
            }
            if now < left {
                (left, moved) = (now, Instant::now());
            }
            let trouble = if cancelled.load(Ordering::Acquire) { Trouble::Cancelled } else { Trouble::Held };
            if trouble == Trouble::Cancelled || moved.elapsed() > self.silence {
                drop(port.clear(ClearBuffer::Output));
                return Err(trouble);
            }
            std::thread::sleep(LOOK / 10);
        }
    }

    /// Receives one transmission: sends XON, reads up to the closing `%`, sends XOFF. `tell` receives the bytes so far.
    ///
    /// # Errors
    /// A fault of the port, the line or the data; or the operator has cancelled.
    pub fn receive(&self, cancelled: &AtomicBool, tell: &mut dyn FnMut(u64)) -> Result<Reader, Trouble> {
        let mut port = self.open()?;
        drop(port.clear(ClearBuffer::Input));
        say(port.as_mut(), XON)?;
        let mut reader = Reader::new(self.limit);
        let read = self.read(port.as_mut(), &mut reader, cancelled, tell);
        // The read error has priority over an error of XOFF.
        let told = say(port.as_mut(), XOFF);
        read.and(told).map(|()| reader)
    }

    fn read(
        &self,
        port: &mut dyn SerialPort,
        reader: &mut Reader,
        cancelled: &AtomicBool,
        tell: &mut dyn FnMut(u64),
    ) -> Result<(), Trouble> {
        let mut buffer = [0; 4_096];
        let mut heard = Instant::now();
        loop {
            if cancelled.load(Ordering::Acquire) {
                return Err(Trouble::Cancelled);
            }
            match port.read(&mut buffer) {
                Ok(0) => return Err(gone(&"end of file")),
                Ok(count) => {
                    heard = Instant::now();
                    for byte in &buffer[..count] {
                        if reader.push(*byte)? == Step::Over {
                            return Ok(());
                        }
                    }
                    tell(reader.size() as u64);
                }
                // Nothing follows the last %, not even a line end.
                Err(error) if error.kind() == ErrorKind::TimedOut && reader.is_closing() => return Ok(()),
                Err(error) => pass(&error)?,
            }
            let most = if reader.has_begun() { self.silence } else { self.start };
            if heard.elapsed() > most {
                return Err(reader.broken_off());
            }
        }
    }
}

/// Sends one byte; a timeout is ignored.
fn say(port: &mut dyn SerialPort, byte: u8) -> Result<(), Trouble> {
    port.write_all(&[byte]).or_else(|error| pass(&error))
}

/// Ignores timeouts; any other error means that the port has disappeared.
fn pass(error: &std::io::Error) -> Result<(), Trouble> {
    match error.kind() {
        ErrorKind::TimedOut | ErrorKind::Interrupted | ErrorKind::WouldBlock => Ok(()),
        _ => Err(gone(error)),
    }
}

fn gone(error: &dyn std::fmt::Display) -> Trouble {
    Trouble::Gone(Said::new(error.to_string(), error.to_string()))
}

/// The names of the serial ports of this computer, sorted.
#[must_use]
pub fn ports() -> Vec<String> {
    let mut names: Vec<String> =
        serialport::available_ports().unwrap_or_default().into_iter().map(|port| port.port_name).collect();
    names.sort();
    names.dedup();
    names
}
