//! A Modbus TCP station on its thread, against the server part of the library and against servers that misbehave.
//! Nothing sleeps for a fixed time: each test waits for a condition, with a deadline.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use kt830::host::modbus::ModbusLink;
use kt830::io::fieldbus::station::{StationFault, StationLink};
use kt830::io::fieldbus::station_description::{ModbusBlock, ModbusTable, StationDescription};
use kt830::units::Micros;
use rmodbus::ModbusProto;
use rmodbus::server::ModbusFrame;
use rmodbus::server::context::ModbusContext;
use rmodbus::server::storage::ModbusStorage;
use rustix::net::{AddressFamily, SocketType};

/// How long a test waits for what must come.
const DEADLINE: Duration = Duration::from_secs(30);

/// Coils, discrete inputs, input registers, holding registers.
type Tables = ModbusStorage<64, 64, 16, 16>;

/// What a server does with a request.
type Serve = dyn FnMut(&[u8]) -> Option<Vec<u8>> + Send;

/// A server that takes one connection after the other, until the test ends. A request without an answer ends the connection.
fn server(mut serve: Box<Serve>) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let mut stream = stream.unwrap();
            while let Some(request) = read_request(&mut stream) {
                let Some(answer) = serve(&request) else { break };
                if stream.write_all(&answer).is_err() {
                    break;
                }
            }
        }
    });
    address
}

fn read_request(stream: &mut TcpStream) -> Option<Vec<u8>> {
    let mut frame = vec![0; 6];
    stream.read_exact(&mut frame).ok()?;
    frame.resize(6 + usize::from(u16::from_be_bytes([frame[4], frame[5]])), 0);
    stream.read_exact(&mut frame[6..]).ok()?;
    Some(frame)
}

/// Unit 7 of the library's server.
fn serve_tables(tables: &Mutex<Tables>, request: &[u8]) -> Vec<u8> {
    let mut buffer = [0; 256];
    buffer[..request.len()].copy_from_slice(request);
    let mut answer = Vec::new();
    let mut frame = ModbusFrame::new(7, &buffer, ModbusProto::TcpUdp, &mut answer);
    frame.parse().unwrap();
    let mut tables = tables.lock().unwrap();
    if frame.processing_required {
        let done = if frame.readonly { frame.process_read(&*tables) } else { frame.process_write(&mut *tables) };
        done.unwrap();
    }
    frame.finalize_response().unwrap();
    answer
}

fn station(address: SocketAddr) -> StationDescription {
    let block = |table, from, count| ModbusBlock { table, from, count };
    StationDescription {
        name: "island".to_owned(),
        address,
        unit: 7,
        period_ms: 5,
        timeout_ms: 200,
        max_age_ms: 300,
        inputs: vec![
            block(ModbusTable::DiscreteInputs, 3, 11),
            block(ModbusTable::InputRegisters, 2, 2),
            block(ModbusTable::Coils, 0, 3),
            block(ModbusTable::HoldingRegisters, 5, 1),
        ],
        outputs: vec![block(ModbusTable::Coils, 8, 10), block(ModbusTable::HoldingRegisters, 4, 2)],
    }
}

/// Bytes of inputs and outputs of the station above: 2 + 4 + 1 + 2, 2 + 4.
const INPUTS: usize = 9;
const OUTPUTS: [u8; 6] = [0b1010_0101, 0b10, 0x34, 0x12, 0xfe, 0xff];

/// Plays ticks until something holds: the control sends outputs and takes inputs.
fn until(link: &mut ModbusLink, outputs: &[u8], mut holds: impl FnMut(&ModbusLink, &[u8; INPUTS]) -> bool) {
    let (begun, mut inputs) = (Instant::now(), [0; INPUTS]);
    loop {
        link.send(outputs);
        link.receive(&mut inputs);
        if holds(link, &inputs) {
            return;
        }
        assert!(begun.elapsed() < DEADLINE, "{:?} {inputs:?}", link.health());
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn p1_all_four_tables_come_and_go_with_the_lower_byte_first() {
    let tables: Arc<Mutex<Tables>> = Arc::default();
    {
        let mut at = tables.lock().unwrap();
        // 3 to 13 are read: the first, the ninth and the last one are on, and so is the one behind.
        for bit in [3, 11, 13, 14] {
            at.set_discrete(bit, true).unwrap();
        }
        at.set_inputs_from_u32(2, 0xabcd_0102).unwrap();
        at.set_coil(1, true).unwrap();
    }
    let served = Arc::clone(&tables);
    let address = server(Box::new(move |request| Some(serve_tables(&served, request))));
    let mut link = ModbusLink::start(station(address)).unwrap();
    // Holding register 5 is the second one that is written: 0xfffe.
    let expected = [0b1, 0b101, 0xcd, 0xab, 0x02, 0x01, 0b10, 0xfe, 0xff];
    until(&mut link, &OUTPUTS, |_, inputs| *inputs == expected);
    {
        let at = tables.lock().unwrap();
        let coils = (8..18).map(|coil| at.get_coil(coil).unwrap()).collect::<Vec<_>>();
        assert_eq!(coils, [true, false, true, false, false, true, false, true, false, true]);
        assert_eq!([at.get_holding(4).unwrap(), at.get_holding(5).unwrap()], [0x1234, 0xfffe]);
        assert!(!at.get_coil(18).unwrap(), "no bit beyond the count");
    }
    assert_eq!(link.health().fault, None);
    // The end: the outputs go off.
    drop(link);
    let at = tables.lock().unwrap();
    assert_eq!((at.get_holding(4).unwrap(), at.get_coil(8).unwrap()), (0, false));
}

fn on(tables: &Mutex<Tables>) -> bool {
    tables.lock().unwrap().get_holding(4).unwrap() == 0x1234
}

/// The control hangs: its outputs are not kept alive by the thread, and do not go on again by themselves.
#[test]
fn b8_outputs_that_nobody_renews_go_off_until_reset() {
    let tables: Arc<Mutex<Tables>> = Arc::default();
    let served = Arc::clone(&tables);
    let address = server(Box::new(move |request| Some(serve_tables(&served, request))));
    let mut link = ModbusLink::start(station(address)).unwrap();
    until(&mut link, &OUTPUTS, |_, _| on(&tables));
    let begun = Instant::now();
    link.send(&OUTPUTS);
    while tables.lock().unwrap().get_holding(4).unwrap() != 0 {
        assert!(begun.elapsed() < DEADLINE, "still on");
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(begun.elapsed() >= Duration::from_millis(300), "they are good for 300 ms: {:?}", begun.elapsed());
    // The health is that of the last answer taken: without taking the newest one, the count would be 300 ms old, and an answer
    // from before the lock would do.
    link.receive(&mut [0; INPUTS]);
    let exchanged = link.health().exchanges;
    until(&mut link, &OUTPUTS, |link, _| link.health().exchanges > exchanged + 20);
    assert_eq!(link.health().locked, Some(StationFault::NotRenewed));
    assert!(!on(&tables), "without RESET they stay off");
    link.release();
    until(&mut link, &OUTPUTS, |link, _| on(&tables) && link.health().locked.is_none());
}

/// A new start of the bus renews nothing for seconds: the outputs are held meanwhile.
#[test]
fn b8_outputs_are_held_for_a_time() {
    let tables: Arc<Mutex<Tables>> = Arc::default();
    let served = Arc::clone(&tables);
    let address = server(Box::new(move |request| Some(serve_tables(&served, request))));
    let mut link = ModbusLink::start(station(address)).unwrap();
    until(&mut link, &OUTPUTS, |_, _| on(&tables));
    link.hold(Micros::from_millis(30_000));
    // Values come all the time; nothing is sent for longer than the outputs are good for without being held.
    let (begun, mut inputs) = (Instant::now(), [0; INPUTS]);
    while begun.elapsed() < Duration::from_millis(400) {
        link.receive(&mut inputs);
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(on(&tables) && link.health().locked.is_none());
}

/// "Off" arrives also at a station that refuses to be read.
#[test]
fn b8_outputs_are_written_where_reading_is_refused() {
    let (tables, refuses) = (Arc::<Mutex<Tables>>::default(), Arc::new(Mutex::new(false)));
    let (served, refusing) = (Arc::clone(&tables), Arc::clone(&refuses));
    let address = server(Box::new(move |request| {
        let answer = serve_tables(&served, request);
        let reads = request[7] <= 4;
        Some(if reads && *refusing.lock().unwrap() { refusal(&answer) } else { answer })
    }));
    let mut link = ModbusLink::start(station(address)).unwrap();
    until(&mut link, &OUTPUTS, |_, _| on(&tables));
    *refuses.lock().unwrap() = true;
    until(&mut link, &OUTPUTS, |link, _| link.health().fault == Some(StationFault::Exception(2)));
    until(&mut link, &[0; 6], |_, _| tables.lock().unwrap().get_holding(4).unwrap() == 0);
    assert_eq!(link.health().fault, Some(StationFault::Exception(2)));
}

/// A control that has sent nothing writes nothing: another one may run the machine.
#[test]
fn b8_a_control_that_asks_for_nothing_writes_nothing() {
    let writes = Arc::new(Mutex::new(0));
    let (tables, counted) = (Arc::<Mutex<Tables>>::default(), Arc::clone(&writes));
    let address = server(Box::new(move |request| {
        *counted.lock().unwrap() += usize::from(request[7] > 4);
        Some(serve_tables(&tables, request))
    }));
    let mut link = ModbusLink::start(station(address)).unwrap();
    let begun = Instant::now();
    while link.health().exchanges < 20 {
        link.receive(&mut [0; INPUTS]);
        assert!(begun.elapsed() < DEADLINE);
        std::thread::sleep(Duration::from_millis(1));
    }
    drop(link);
    assert_eq!(*writes.lock().unwrap(), 0);
}

/// A connection that is lost for a moment: the station may have been without power, its outputs wait for RESET.
#[test]
fn b8_a_station_that_is_connected_anew_keeps_its_outputs_off() {
    let (tables, breaks) = (Arc::<Mutex<Tables>>::default(), Arc::new(Mutex::new(false)));
    let (served, breaking) = (Arc::clone(&tables), Arc::clone(&breaks));
    let address = server(Box::new(move |request| {
        let breaks = std::mem::take(&mut *breaking.lock().unwrap());
        (!breaks).then(|| serve_tables(&served, request))
    }));
    let mut link = ModbusLink::start(station(address)).unwrap();
    until(&mut link, &OUTPUTS, |_, _| on(&tables));
    *breaks.lock().unwrap() = true;
    until(&mut link, &OUTPUTS, |link, _| link.health().locked == Some(StationFault::ConnectedAnew) && !on(&tables));
    link.release();
    until(&mut link, &OUTPUTS, |link, _| on(&tables) && link.health().locked.is_none());
}

/// The connection breaks between the first outputs and the first inputs: no exchange has been whole, and the outputs are
/// on all the same.
#[test]
fn b8_a_station_that_is_lost_in_its_first_exchange_keeps_its_outputs_off() {
    let tables: Arc<Mutex<Tables>> = Arc::default();
    let served = Arc::clone(&tables);
    let was_on = std::cell::Cell::new(false);
    let broken = std::cell::Cell::new(false);
    let address = server(Box::new(move |request| {
        // Functions 1 to 4 read. Nothing is read before the outputs are there, nor once behind them.
        if request[7] <= 4 && !broken.get() {
            broken.set(was_on.get());
            return None;
        }
        let answer = serve_tables(&served, request);
        was_on.set(was_on.get() || on(&served));
        Some(answer)
    }));
    let mut link = ModbusLink::start(station(address)).unwrap();
    until(&mut link, &OUTPUTS, |link, _| link.health().locked == Some(StationFault::ConnectedAnew) && !on(&tables));
    link.release();
    until(&mut link, &OUTPUTS, |link, _| on(&tables) && link.health().locked.is_none());
}

/// The refusal of a request: exception 2.
fn refusal(answer: &[u8]) -> Vec<u8> {
    let mut refusal = answer[..9].to_vec();
    refusal[4..6].copy_from_slice(&[0, 3]);
    (refusal[7], refusal[8]) = (refusal[7] | 0x80, 2);
    refusal
}

/// What a server does wrong, and what is said of it; then it serves, and the station is there again.
#[test]
fn b8_a_station_that_misbehaves_is_told_apart_and_comes_back() {
    type Spoil = fn(Vec<u8>) -> Option<Vec<u8>>;
    let faults: [(Spoil, StationFault); 7] = [
        (|_| None, StationFault::Closed),
        (|_| Some(Vec::new()), StationFault::TimedOut),
        (|answer| Some(refusal(&answer)), StationFault::Exception(2)),
        // The answer to an earlier request.
        (
            |mut answer| {
                answer[1] ^= 1;
                Some(answer)
            },
            StationFault::Garbled,
        ),
        // Fewer values than asked for.
        (
            |mut answer| {
                answer.truncate(answer.len() - 1);
                answer[5] -= 1;
                Some(answer)
            },
            StationFault::Garbled,
        ),
        // A length beyond every frame.
        (
            |mut answer| {
                answer[4] = 0xff;
                Some(answer)
            },
            StationFault::Garbled,
        ),
        // Another unit.
        (
            |mut answer| {
                answer[6] = 9;
                Some(answer)
            },
            StationFault::Garbled,
        ),
    ];
    for (spoil, fault) in faults {
        let (tables, spoils) = (Arc::<Mutex<Tables>>::default(), Arc::new(Mutex::new(true)));
        let spoilt = Arc::clone(&spoils);
        let serve = move |request: &[u8]| {
            let answer = serve_tables(&tables, request);
            if *spoilt.lock().unwrap() { spoil(answer) } else { Some(answer) }
        };
        let mut link = ModbusLink::start(station(server(Box::new(serve)))).unwrap();
        until(&mut link, &OUTPUTS, |link, _| link.health().fault == Some(fault));
        assert_eq!(link.health().exchanges, 0, "{fault:?}");
        *spoils.lock().unwrap() = false;
        until(&mut link, &OUTPUTS, |link, _| link.health().exchanges > 3 && link.health().fault.is_none());
    }
}

#[test]
fn b8_a_station_that_takes_no_connection_is_asked_again() {
    // A port that is bound and does not listen: nobody else gets it meanwhile.
    let bound = rustix::net::socket(AddressFamily::INET, SocketType::STREAM, None).unwrap();
    rustix::net::bind(&bound, &SocketAddr::from(([127, 0, 0, 1], 0))).unwrap();
    let address = rustix::net::getsockname(&bound).unwrap().try_into().unwrap();
    let mut link = ModbusLink::start(station(address)).unwrap();
    until(&mut link, &OUTPUTS, |link, _| link.health().fault == Some(StationFault::ConnectionRefused));
    assert!(!link.receive(&mut [0; INPUTS]), "no inputs have come");
}
