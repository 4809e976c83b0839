//! Modbus TCP stations: one thread each, beside the tick. It reads and writes every period, and hands the newest values
//! over without a lock. A station that does not answer is connected anew. After that, and when the control does not renew
//! the outputs, they are off until RESET.
//! Source: Modbus Messaging on TCP/IP V1.0b; safety stance ("a late tick, a panicking thread end in the safe output image").

use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded};
use rmodbus::client::ModbusRequest;
use triple_buffer::{Input, Output, TripleBuffer};

use crate::io::fieldbus::process_image::DeviceImage;
use crate::io::fieldbus::station::{StationFault, StationHealth, StationLink};
use crate::io::fieldbus::station_description::{ModbusBlock, ModbusTable, StationDescription};
use crate::units::Micros;

/// Time from one attempt to connect to the next.
const RETRY: Duration = Duration::from_millis(200);
/// Bytes of the header of a frame up to the unit identifier (MBAP): transaction, protocol, length, unit.
const HEADER: usize = 7;
/// Largest frame, bytes.
const MAX_FRAME: usize = 260;
/// Bytes of an answer before the values that were read: header, function, byte count.
const BEFORE_VALUES: usize = HEADER + 2;
/// Bytes of the answer to a write: header, function, address, count.
const WRITE_ANSWER: usize = HEADER + 5;
/// Bytes of a refusal: header, function, exception code.
const REFUSAL: usize = HEADER + 2;
/// Set in the function code of a refusal.
const REFUSED: u8 = 0x80;

/// What the thread hands to the tick.
#[derive(Clone, Default)]
struct NewestInputs {
    inputs: Vec<u8>,
    health: StationHealth,
}

/// What the tick hands to the thread.
#[derive(Clone)]
struct NewestOutputs {
    outputs: Vec<u8>,
    /// Until when they are good. `None` until the control has sent something: then nothing is written at all.
    good_until: Option<Instant>,
    /// Counts RESET.
    releases: u64,
}

/// A station on a thread of its own. Dropping it switches the outputs off and ends the thread.
pub struct ModbusLink {
    answers: Output<NewestInputs>,
    demands: Input<NewestOutputs>,
    max_age: Duration,
    /// The outputs that were sent last; `None` before the first ones.
    last: Option<Vec<u8>>,
    releases: u64,
    taken: u64,
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl ModbusLink {
    /// Starts the thread of a station.
    ///
    /// # Errors
    /// The system cannot create a thread.
    pub fn start(station: StationDescription) -> std::io::Result<Self> {
        let (inputs, outputs) = station.process_data_bytes();
        let image = DeviceImage { inputs: vec![0; inputs.into()], outputs: vec![0; outputs.into()] };
        let answer = NewestInputs { inputs: image.inputs.clone(), health: StationHealth::default() };
        let (tell, answers) = TripleBuffer::new(&answer).split();
        let nothing = NewestOutputs { outputs: image.outputs.clone(), good_until: None, releases: 0 };
        let (demands, asked) = TripleBuffer::new(&nothing).split();
        let (stop, stopped) = bounded(0);
        let max_age = Duration::from_millis(station.max_age_ms);
        let mut client = StationClient::new(station, image, asked);
        let thread = Builder::new().name("kt830-modbus".into()).spawn(move || client.run(tell, &stopped))?;
        let (stop, thread) = (Some(stop), Some(thread));
        Ok(Self { answers, demands, max_age, last: None, releases: 0, taken: 0, stop, thread })
    }
}

impl ModbusLink {
    /// Hands over the last outputs, good for a time.
    fn publish(&mut self, good_for: Duration) {
        let Some(last) = &self.last else { return };
        let demand = self.demands.input_buffer_mut();
        demand.outputs.clone_from(last);
        demand.good_until = Some(Instant::now() + good_for);
        demand.releases = self.releases;
        self.demands.publish();
    }
}

impl StationLink for ModbusLink {
    fn receive(&mut self, inputs: &mut [u8]) -> bool {
        self.answers.update();
        let answer = self.answers.output_buffer();
        let is_new = answer.health.exchanges > self.taken;
        if is_new && answer.inputs.len() == inputs.len() {
            inputs.copy_from_slice(&answer.inputs);
        }
        self.taken = answer.health.exchanges;
        is_new
    }

    fn send(&mut self, outputs: &[u8]) {
        let last = self.last.get_or_insert_default();
        last.clear();
        last.extend_from_slice(outputs);
        self.publish(self.max_age);
    }

    fn hold(&mut self, time: Micros) {
        self.publish(Duration::from_micros(time.0).max(self.max_age));
    }

    fn release(&mut self) {
        self.releases += 1;
    }

    fn health(&self) -> StationHealth {
        self.answers.output_buffer().health
    }
}

impl Drop for ModbusLink {
    fn drop(&mut self) {
        self.stop = None;
        if let Some(thread) = self.thread.take() {
            drop(thread.join());
        }
    }
}

/// The connection to a station.
struct StationClient {
    station: StationDescription,
    image: DeviceImage,
    asked: Output<NewestOutputs>,
    stream: Option<TcpStream>,
    /// Number of the last request: the answer bears it, so that a late one is not taken for another.
    transaction: u16,
    health: StationHealth,
    /// RESETs that were there when the outputs were locked: a later one releases them.
    locked_at: u64,
    /// Outputs have been sent, if only in an exchange that broke off.
    has_written: bool,
}

impl StationClient {
    fn new(station: StationDescription, image: DeviceImage, asked: Output<NewestOutputs>) -> Self {
        let health = StationHealth::default();
        Self { station, image, asked, stream: None, transaction: 0, health, locked_at: 0, has_written: false }
    }

    /// Exchanges every period until the link is dropped.
    fn run(&mut self, mut tell: Input<NewestInputs>, stopped: &Receiver<()>) {
        let period = Duration::from_millis(self.station.period_ms);
        let mut due = Instant::now();
        loop {
            if catch_unwind(AssertUnwindSafe(|| self.exchange_once())).is_err() {
                self.fail(StationFault::Garbled);
            }
            let answer = tell.input_buffer_mut();
            answer.inputs.clone_from(&self.image.inputs);
            answer.health = self.health;
            tell.publish();
            let away = matches!(self.health.fault, Some(StationFault::Unreachable | StationFault::ConnectionRefused));
            // A late exchange is not made up for.
            due = (due + if away { period.max(RETRY) } else { period }).max(Instant::now());
            match stopped.recv_timeout(due.saturating_duration_since(Instant::now())) {
                Err(RecvTimeoutError::Timeout) => {}
                Ok(()) | Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        // The end: off, as the watchdogs of a bus do. A station that does not listen needs a watchdog of its own.
        if self.asked.read().good_until.is_some() {
            self.lock(StationFault::NotRenewed);
            let _ = self.write_outputs();
        }
    }

    /// One exchange and what became of it.
    fn exchange_once(&mut self) {
        let begun = Instant::now();
        let exchanged = self.connect().and_then(|()| {
            // First: "off" must arrive also where reading is refused.
            let written = self.write_outputs();
            if matches!(written, Ok(()) | Err(StationFault::Exception(_))) {
                self.read_inputs().and(written)
            } else {
                written
            }
        });
        self.health.round_trip = Micros(begun.elapsed().as_micros() as u64);
        self.health.fault = None;
        match exchanged {
            Ok(()) => self.health.exchanges += 1,
            Err(fault) => self.fail(fault),
        }
    }

    fn fail(&mut self, fault: StationFault) {
        self.health.failures += 1;
        self.health.fault = Some(fault);
        // A refusal is a whole answer; after anything else the next byte may belong to an earlier request.
        if !matches!(fault, StationFault::Exception(_)) {
            self.stream = None;
        }
    }

    /// Keeps the outputs off until the next RESET.
    fn lock(&mut self, why: StationFault) {
        self.health.locked = Some(why);
        self.locked_at = self.asked.read().releases;
    }

    /// Takes the outputs of this moment. Returns false if the control has not asked for any.
    fn take_outputs(&mut self) -> bool {
        let demand = self.asked.read();
        let Some(good_until) = demand.good_until else { return false };
        let (renewed, released) = (Instant::now() <= good_until, demand.releases != self.locked_at);
        if renewed && demand.outputs.len() == self.image.outputs.len() {
            self.image.outputs.copy_from_slice(&demand.outputs);
        }
        if !renewed {
            self.lock(StationFault::NotRenewed);
        } else if released {
            self.health.locked = None;
        }
        if self.health.locked.is_some() {
            self.image.outputs.fill(0);
        }
        true
    }

    fn connect(&mut self) -> Result<(), StationFault> {
        if self.stream.is_some() {
            return Ok(());
        }
        let timeout = Duration::from_millis(self.station.timeout_ms);
        let stream =
            TcpStream::connect_timeout(&self.station.address, timeout).map_err(|error| match error.kind() {
                ErrorKind::ConnectionRefused => StationFault::ConnectionRefused,
                _ => StationFault::Unreachable,
            })?;
        let set = stream.set_nodelay(true).and_then(|()| stream.set_write_timeout(Some(timeout)));
        set.map_err(|_| StationFault::Unreachable)?;
        self.stream = Some(stream);
        // A connection after the first one: the station may have been without power meanwhile.
        if self.health.exchanges > 0 || self.has_written {
            self.lock(StationFault::ConnectedAnew);
        }
        Ok(())
    }

    /// Reads all blocks; the inputs change only once all of them are there.
    fn read_inputs(&mut self) -> Result<(), StationFault> {
        let mut values = Vec::with_capacity(self.image.inputs.len());
        for at in 0..self.station.inputs.len() {
            let block = self.station.inputs[at];
            let length = usize::from(block.bytes());
            let answer = self.transact(BEFORE_VALUES + length, |request, frame| match block.table {
                ModbusTable::Coils => request.generate_get_coils(block.from, block.count, frame),
                ModbusTable::DiscreteInputs => request.generate_get_discretes(block.from, block.count, frame),
                ModbusTable::HoldingRegisters => request.generate_get_holdings(block.from, block.count, frame),
                ModbusTable::InputRegisters => request.generate_get_inputs(block.from, block.count, frame),
            })?;
            append_values(&mut values, block, &answer[BEFORE_VALUES..]);
        }
        self.image.inputs = values;
        Ok(())
    }

    /// Writes all blocks, also behind one that is refused; each with the outputs of its moment.
    fn write_outputs(&mut self) -> Result<(), StationFault> {
        let (mut first, mut refused) = (0, Ok(()));
        for at in 0..self.station.outputs.len() {
            if !self.take_outputs() {
                return Ok(());
            }
            self.has_written = true;
            let block = self.station.outputs[at];
            let end = first + usize::from(block.bytes());
            let bytes = self.image.outputs[first..end].to_vec();
            first = end;
            let written = self.transact(WRITE_ANSWER, |request, frame| {
                if block.table.is_bits() {
                    let bits = (0..usize::from(block.count)).map(|bit| bytes[bit / 8] >> (bit % 8) & 1);
                    request.generate_set_coils_bulk(block.from, &bits.collect::<Vec<u8>>(), frame)
                } else {
                    let registers = bytes.as_chunks().0.iter().map(|pair| u16::from_le_bytes(*pair));
                    request.generate_set_holdings_bulk(block.from, &registers.collect::<Vec<_>>(), frame)
                }
            });
            match written {
                Ok(_) => {}
                Err(fault @ StationFault::Exception(_)) => refused = refused.and(Err(fault)),
                Err(fault) => return Err(fault),
            }
        }
        refused
    }

    /// Sends a request and returns the whole answer, of this length.
    fn transact(
        &mut self,
        length: usize,
        build: impl FnOnce(&mut ModbusRequest, &mut Vec<u8>) -> Result<(), rmodbus::ErrorKind>,
    ) -> Result<Vec<u8>, StationFault> {
        let Some(stream) = &mut self.stream else { return Err(StationFault::Closed) };
        self.transaction = self.transaction.wrapping_add(1);
        let mut request = ModbusRequest::new_tcp_udp(self.station.unit, self.transaction);
        let mut frame = Vec::with_capacity(MAX_FRAME);
        build(&mut request, &mut frame).map_err(|_| StationFault::Garbled)?;
        stream.write_all(&frame).map_err(|error| from_system(&error))?;
        let end = Instant::now() + Duration::from_millis(self.station.timeout_ms);
        let answer = read_frame(stream, end)?;
        if answer.len() == REFUSAL && answer[HEADER] == frame[HEADER] | REFUSED && answer[..4] == frame[..4] {
            return Err(StationFault::Exception(answer[HEADER + 1]));
        }
        if answer.len() != length || request.parse_ok(&answer).is_err() {
            return Err(StationFault::Garbled);
        }
        Ok(answer)
    }
}

/// Reads a frame whose header says how long it is, until a time.
fn read_frame(stream: &mut TcpStream, end: Instant) -> Result<Vec<u8>, StationFault> {
    let mut frame = vec![0; HEADER];
    read_until(stream, end, &mut frame)?;
    // The length counts from the unit identifier on, the last byte of the header.
    let length = HEADER - 1 + usize::from(u16::from_be_bytes([frame[4], frame[5]]));
    if !(REFUSAL..=MAX_FRAME).contains(&length) {
        return Err(StationFault::Garbled);
    }
    frame.resize(length, 0);
    read_until(stream, end, &mut frame[HEADER..])?;
    Ok(frame)
}

/// Fills the bytes until a time, also where they come one by one.
fn read_until(stream: &mut TcpStream, end: Instant, mut bytes: &mut [u8]) -> Result<(), StationFault> {
    while !bytes.is_empty() {
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(StationFault::TimedOut);
        }
        let read = stream.set_read_timeout(Some(left)).and_then(|()| stream.read(bytes));
        match read.map_err(|error| from_system(&error))? {
            0 => return Err(StationFault::Closed),
            taken => bytes = &mut bytes[taken..],
        }
    }
    Ok(())
}

fn from_system(error: &std::io::Error) -> StationFault {
    match error.kind() {
        ErrorKind::TimedOut | ErrorKind::WouldBlock => StationFault::TimedOut,
        _ => StationFault::Closed,
    }
}

/// Adds the values of a block as they are in the image: registers with the lower byte first, no bits beyond the count.
fn append_values(values: &mut Vec<u8>, block: ModbusBlock, answer: &[u8]) {
    if block.table.is_bits() {
        values.extend_from_slice(answer);
        let unused = (8 - block.count % 8) % 8;
        if let Some(last) = values.last_mut() {
            *last &= 0xff >> unused;
        }
    } else {
        values.extend(answer.as_chunks::<2>().0.iter().flat_map(|[high, low]| [*low, *high]));
    }
}
