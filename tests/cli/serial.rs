//! Programs over RS232, tried against a pseudo-terminal: the other side is a thread that reads and writes its end.
//! Source: spec L9.

use std::fs;
use std::io::{Read, Write};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use kt830::defs::alarm;
use kt830::defs::kind::Kind;
use kt830::host::folders::Folders;
use kt830::host::headless::HeadlessHost;
use kt830::host::serial::format::{SerialProgram, XOFF, XON};
use kt830::host::serial::port::{SerialLine, SerialWait};
use kt830::host::serial::transfer::SerialTransfer;
use kt830::host::serial::{SERIAL_LIMIT, SerialError};
use kt830::link::Command;
use kt830::link::files::{FileAnswer, FileRequest, Refusal, Requester, Ticket};
use kt830::link::media::{Direction, TransferRequest, TransferSet};
use kt830::link::page_command::{PageCommand, PasswordScope, Secret};
use kt830::store::ProgramFolder;
use serialport::{SerialPort, TTYPort};
use tempfile::TempDir;

/// The other side of the line, and a folder of programs on this one.
struct Shop {
    folder: TempDir,
    other: Option<TTYPort>,
    /// Keeps the pseudo-terminal alive while nobody has it open.
    _kept: fs::File,
    line: SerialLine,
    cancelled: AtomicBool,
    /// The control has ended its transfer: what the other side has not heard by now never comes.
    ended: Arc<AtomicBool>,
    /// When the other side had sent its bytes. Until then the time of the line stands still, however long the other
    /// side takes on a busy computer.
    sent_at: Arc<Mutex<Option<Instant>>>,
    held: Mutex<Vec<SerialProgram>>,
    named: bool,
}

impl Shop {
    fn new() -> Self {
        let (mut other, own) = TTYPort::pair().expect("a pseudo-terminal");
        other.set_timeout(Duration::from_millis(300)).unwrap();
        let port = own.name().expect("its name");
        let kept = fs::File::open(&port).unwrap();
        let line = SerialLine {
            port,
            baud: 115_200,
            silence_timeout: Duration::from_millis(400),
            start_timeout: Duration::from_secs(20),
            leader: 4,
            limit: SERIAL_LIMIT,
        };
        let (folder, other) = (tempfile::tempdir().unwrap(), Some(other));
        Self {
            folder,
            other,
            _kept: kept,
            line,
            cancelled: AtomicBool::new(false),
            ended: Arc::default(),
            sent_at: Arc::new(Mutex::new(Some(Instant::now()))),
            held: Mutex::default(),
            named: false,
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_default()
    }

    fn ask(&self, direction: Direction, names: &[&str], overwrite: Option<bool>) -> Result<FileAnswer, Refusal> {
        let shelf = ProgramFolder::new(self.folder.path(), self.named);
        let names = names.iter().map(|name| (*name).to_owned()).collect();
        let ask = TransferRequest { set: TransferSet::Serial, direction, names, overwrite, convert: None, split: None };
        let start = Instant::now();
        let now = || start + self.sent_at.lock().unwrap().map_or(Duration::ZERO, |sent| sent.elapsed());
        let wait = SerialWait { stopped: &|| self.cancelled.load(Ordering::Acquire), now: &now };
        let transfer =
            SerialTransfer { folder: &shelf, by_name: self.named, port: &self.line, wait, received: &self.held };
        let done = transfer.run(&ask, &mut |_| {});
        self.ended.store(true, Ordering::Release);
        done
    }

    /// The other side's end of the line, before the control begins a transfer.
    fn take_other(&mut self) -> (TTYPort, Arc<AtomicBool>) {
        self.ended.store(false, Ordering::Release);
        (self.other.take().unwrap(), Arc::clone(&self.ended))
    }

    /// The other side hears XON, then sends these bytes.
    fn sender(&mut self, bytes: &[u8]) -> JoinHandle<TTYPort> {
        let ((mut port, ended), bytes) = (self.take_other(), bytes.to_vec());
        let sent_at = Arc::clone(&self.sent_at);
        *sent_at.lock().unwrap() = None;
        thread::spawn(move || {
            assert!(hear(&mut port, &ended, |heard| heard.contains(&XON)).contains(&XON));
            port.write_all(&bytes).unwrap();
            *sent_at.lock().unwrap() = Some(Instant::now());
            port
        })
    }

    /// Receives while the other side sends these bytes.
    fn receive(&mut self, bytes: &[u8], names: &[&str]) -> Result<FileAnswer, Refusal> {
        let sender = self.sender(bytes);
        let done = self.ask(Direction::Import, names, None);
        self.other = Some(sender.join().unwrap());
        done
    }

    /// Sends a program while the other side listens to its end; what it heard.
    fn send(&mut self, names: &[&str]) -> (Result<FileAnswer, Refusal>, Vec<u8>) {
        let (mut port, ended) = self.take_other();
        let listener = thread::spawn(move || {
            let heard = hear(&mut port, &ended, |heard| heard.ends_with(b"%\r\n\0\0\0\0"));
            (port, heard)
        });
        let done = self.ask(Direction::Export, names, None);
        let (port, heard) = listener.join().unwrap();
        self.other = Some(port);
        (done, heard)
    }
}

/// Reads until what was heard is enough, or until the control's transfer has ended and nothing is left to read. However
/// long the control takes on a busy computer, silence alone ends nothing.
fn hear(port: &mut TTYPort, ended: &AtomicBool, enough: impl Fn(&[u8]) -> bool) -> Vec<u8> {
    let mut heard = Vec::new();
    while !enough(&heard) {
        // Asked before the read: what was sent before the end is still read.
        let last = ended.load(Ordering::Acquire);
        if !hear_some(port, &mut heard) && last {
            break;
        }
    }
    heard
}

/// Reads what comes within the port's timeout; false for silence, or if nobody has the other end open yet.
fn hear_some(port: &mut TTYPort, heard: &mut Vec<u8>) -> bool {
    let mut buffer = [0; 8_192];
    let count = port.read(&mut buffer).unwrap_or_default();
    heard.extend_from_slice(&buffer[..count]);
    count > 0
}

fn number(done: &Result<FileAnswer, Refusal>) -> Option<u16> {
    match done {
        Err(Refusal::Alarm(number, _)) => Some(*number),
        _ => None,
    }
}

#[test]
fn l9_a_program_is_sent_with_percents_and_cr_lf() {
    let mut shop = Shop::new();
    fs::write(shop.path("O1001.NC"), "O1001 (JAW)\nG00 X50\nM30\n").unwrap();
    let (done, heard) = shop.send(&["O1001.NC"]);
    assert!(matches!(done, Ok(FileAnswer::Done(_))), "{done:?}");
    assert_eq!(heard, b"\0\0\0\0%\r\nO1001 (JAW)\r\nG00 X50\r\nM30\r\n%\r\n\0\0\0\0");
}

#[test]
fn l9_a_program_is_received_stored_and_asked_about_before_it_overwrites() {
    let mut shop = Shop::new();
    let done = shop.receive(b"\0\0%\r\nO1234\r\nG00 X1\r\nM30\r\n%\r\n\0\0", &[]);
    assert!(matches!(done, Ok(FileAnswer::Done(_))), "{done:?}");
    assert_eq!(shop.text("O1234.NC"), "O1234\r\nG00 X1\r\nM30\r\n");
    // The same again is no clash, another text is: it waits for the answer.
    assert!(shop.receive(b"%\nO1234\nG00 X1\nM30\n%", &[]).is_ok(), "a closing % with nothing behind it");
    let done = shop.receive(b"%\nO1234\nG00 X2\nM30\n%\n", &[]);
    assert_eq!(done, Err(Refusal::Overwrite(vec!["O1234.NC".into()])));
    assert_eq!(shop.text("O1234.NC"), "O1234\r\nG00 X1\r\nM30\r\n");
    assert!(shop.ask(Direction::Import, &[], Some(true)).is_ok());
    assert_eq!(shop.text("O1234.NC"), "O1234\r\nG00 X2\r\nM30\r\n");
    assert!(shop.ask(Direction::Import, &[], Some(true)).is_err(), "it is held once");
    assert!(shop.receive(b"%\nM30\n%\n", &["O0077.NC"]).is_ok());
    assert_eq!(shop.text("O0077.NC"), "M30\r\n");
}

#[test]
fn l9_the_lathes_programs_go_by_name() {
    let mut shop = Shop::new();
    shop.named = true;
    fs::write(shop.path("shaft.NC"), "N0010M02\n").unwrap();
    let (done, heard) = shop.send(&["shaft.NC"]);
    assert!(done.is_ok(), "{done:?}");
    assert_eq!(heard, b"\0\0\0\0%\r\n<shaft>\r\nN0010M02\r\n%\r\n\0\0\0\0");
    let done = shop.receive(b"%\n<BOLT>\nN0010M02\n%\n", &[]);
    assert!(done.is_ok(), "{done:?}");
    assert_eq!(shop.text("BOLT.NC"), "N0010M02\r\n");
    // The name counts without regard to case, as on a stick.
    assert_eq!(shop.receive(b"%\n<SHAFT>\nN0020M02\n%\n", &[]), Err(Refusal::Overwrite(vec!["SHAFT.NC".into()])));
    assert!(shop.ask(Direction::Import, &[], Some(true)).is_ok());
    assert_eq!(shop.text("shaft.NC"), "N0020M02\r\n");
}

#[test]
fn s1_programs_of_the_802d_go_over_the_line() {
    let mut shop = Shop::new();
    let done = shop.receive(b"%_N_VGRIND_MPF\r\n;main\r\nR1=5\r\nM2\r\n%_N_L10_SPF\r\nRET\r\n%\r\n", &[]);
    assert!(done.is_ok(), "{done:?}");
    assert_eq!((shop.text("VGRIND.MPF"), shop.text("L10.SPF")), (";main\r\nR1=5\r\nM2\r\n".into(), "RET\r\n".into()));
}

/// A program of 300 000 blocks, 2.4 MB: far more than any buffer on the way holds.
fn long() -> String {
    let mut text = String::from("O0001\r\n");
    text.extend(std::iter::repeat_n("G1X1.\r\n", 300_000));
    text
}

#[test]
fn l9_xoff_holds_the_sender_and_xon_lets_it_go_on() {
    let mut shop = Shop::new();
    shop.line.silence_timeout = Duration::from_secs(20);
    fs::write(shop.path("O0001.NC"), long()).unwrap();
    let (mut port, ended) = shop.take_other();
    let listener = thread::spawn(move || {
        let mut heard = hear(&mut port, &ended, |heard| heard.len() > 1_000);
        port.write_all(&[XOFF]).unwrap();
        // What was on its way still comes; then there is silence although we listen.
        while hear_some(&mut port, &mut heard) {}
        let held_at = heard.len();
        port.write_all(&[XON]).unwrap();
        heard.extend(hear(&mut port, &ended, |rest| rest.ends_with(b"\0\0\0\0")));
        // The end stays open: the sender looks at its line once more after the last byte was heard.
        (held_at, heard, port)
    });
    let done = shop.ask(Direction::Export, &["O0001.NC"], None);
    let (held_at, heard, _port) = listener.join().unwrap();
    assert!(done.is_ok(), "{done:?}");
    let whole = [b"\0\0\0\0%\r\n", long().as_bytes(), b"%\r\n\0\0\0\0"].concat();
    assert!(held_at < whole.len(), "held at {held_at} of {}", whole.len());
    assert!(heard == whole, "{} of {} bytes", heard.len(), whole.len());
}

#[test]
fn l9_a_receiver_that_holds_for_ever_is_an_alarm() {
    let mut shop = Shop::new();
    fs::write(shop.path("O0001.NC"), long()).unwrap();
    let (mut port, ended) = shop.take_other();
    let listener = thread::spawn(move || {
        let mut heard = hear(&mut port, &ended, |heard| heard.len() > 1_000);
        port.write_all(&[XOFF]).unwrap();
        while hear_some(&mut port, &mut heard) {}
        port
    });
    let done = shop.ask(Direction::Export, &["O0001.NC"], None);
    assert_eq!(number(&done), Some(alarm::SERIAL_SEND_TIMEOUT), "{done:?}");
    drop(listener.join().unwrap());
}

#[test]
fn l9_nothing_and_half_a_program_are_alarms_and_nothing_is_stored() {
    let mut shop = Shop::new();
    shop.line.start_timeout = Duration::from_millis(300);
    let done = shop.receive(b"", &[]);
    assert_eq!(done, Err(SerialError::NoData(None).into()));
    let done = shop.receive(b"%\nO1234\nG00 X1\nG0", &[]);
    assert_eq!(done, Err(SerialError::NoData(Some(4)).into()));
    assert!(!shop.path("O1234.NC").exists());
}

#[test]
fn l9_garbled_data_parity_and_length_are_alarms_of_their_own() {
    let mut shop = Shop::new();
    // What never begins is waited for.
    shop.line.start_timeout = Duration::from_secs(1);
    for (bytes, expected) in [
        (b"%\nO1\nG0\0X1\nM30\n%\n".as_slice(), alarm::SERIAL_GARBLED),
        (b"\xF8\x03\x9C\xE0\x1C\xFE\xC7", alarm::SERIAL_GARBLED),
        // "%\r\nO1001\r\n" in 7 bits with even parity.
        (b"\xA5\x8D\x0A\xCF\xB1\x30\x30\xB1\x8D\x0A\xA5\x8D\x0A\xCF\xB1", alarm::SERIAL_PARITY),
        (b"O1001\nG00 X1\nM30\n", alarm::SERIAL_BAD_FORMAT),
        (b"%\nG00 X1\nM30\n%\n", alarm::SERIAL_BAD_FORMAT),
        (b"%\nO0001\nG00 (50% OF IT)\nM30\n%\n", alarm::SERIAL_BAD_FORMAT),
    ] {
        let done = shop.receive(bytes, &[]);
        assert_eq!(number(&done), Some(expected), "{done:?}");
    }
    shop.line.limit = 20;
    assert_eq!(number(&shop.receive(b"%\nO0001\nG00 X1\nG00 X2\nM30\n%\n", &[])), Some(alarm::SERIAL_TOO_LONG));
    fs::write(shop.path("O0002.NC"), "O0002\nG00 X1\nG00 X2\nM30\n").unwrap();
    assert_eq!(number(&shop.ask(Direction::Export, &["O0002.NC"], None)), Some(alarm::SERIAL_TOO_LONG));
    assert_eq!(fs::read_dir(shop.folder.path()).unwrap().count(), 1, "nothing was stored");
}

#[test]
fn l9_a_port_that_is_not_there_and_one_that_goes_are_alarms() {
    let mut shop = Shop::new();
    // The other end goes while it is waited for: the adapter was pulled out.
    let (mut port, ended) = shop.take_other();
    let gone = thread::spawn(move || hear(&mut port, &ended, |heard| heard.contains(&XON)));
    let done = shop.ask(Direction::Import, &[], None);
    assert_eq!(number(&done), Some(alarm::SERIAL_DISCONNECTED), "{done:?}");
    gone.join().unwrap();
    shop.line.port = "/dev/kt830-no-such-port".into();
    assert_eq!(number(&shop.ask(Direction::Import, &[], None)), Some(alarm::SERIAL_PORT_NOT_OPEN));
}

#[test]
fn h8_a_reception_is_cancelled() {
    let mut shop = Shop::new();
    let ((mut port, ended), shop) = (shop.take_other(), shop);
    thread::scope(|scope| {
        scope.spawn(|| {
            assert!(hear(&mut port, &ended, |heard| heard.contains(&XON)).contains(&XON));
            shop.cancelled.store(true, Ordering::Release);
        });
        assert_eq!(shop.ask(Direction::Import, &[], None), Err(SerialError::Cancelled.into()));
    });
}

#[test]
fn l9_a_program_that_cannot_be_stored_or_sent_is_named() {
    let mut shop = Shop::new();
    fs::create_dir(shop.path("O0005.NC")).unwrap();
    let done = shop.receive(b"%\nO0004\nM30\nO0005\nM30\n%\n", &[]);
    assert_eq!(number(&done), Some(alarm::SERIAL_FILE_ERROR), "{done:?}");
    assert!(done.unwrap_err().message().zh().contains("已保存 O0004.NC"));
    fs::write(shop.path("O0006.NC"), "O0006\nG00 X1 (50%)\n").unwrap();
    let done = shop.ask(Direction::Export, &["O0006.NC"], None);
    assert_eq!(number(&done), Some(alarm::SERIAL_NOT_SENDABLE));
    assert!(done.unwrap_err().message().zh().contains("第2行"));
    assert_eq!(number(&shop.ask(Direction::Export, &["../O0001.NC"], None)), Some(alarm::SERIAL_FILE_ERROR));
}

/// Why the last request was refused.
fn refusal(rig: &mut HeadlessHost) -> Option<Refusal> {
    rig.snapshot().files.answers.last()?.result.clone().err()
}

fn request(rig: &mut HeadlessHost, direction: Direction, names: &[&str]) {
    let names = names.iter().map(|name| (*name).to_owned()).collect();
    let ask =
        TransferRequest { set: TransferSet::Serial, direction, names, overwrite: None, convert: None, split: None };
    rig.send(Command::Page(PageCommand::File(Ticket::without_reply(Requester::Transfer), FileRequest::Transfer(ask))));
    (0..4).for_each(|_| rig.step());
}

#[test]
fn l9_the_control_receives_a_program_with_its_password_and_tells_an_alarm() {
    let mut shop = Shop::new();
    let folders = Folders {
        programs: shop.folder.path().to_path_buf(),
        screens: crate::stories::folders().screens,
        by_name: false,
        dialect: Kind::Gc.dialect(),
    };
    let mut rig = crate::stories::rig_of(Kind::Gc, folders);
    request(&mut rig, Direction::Import, &[]);
    assert_eq!(refusal(&mut rig), Some(Refusal::Password));
    rig.send(Command::Page(PageCommand::Unlock(PasswordScope::Program, Secret::new("187350".into()))));
    (0..4).for_each(|_| rig.step());
    request(&mut rig, Direction::Import, &[]);
    assert_eq!(
        rig.snapshot().alarms.first().map(|alarm| alarm.number),
        Some(alarm::SERIAL_PORT_NOT_OPEN),
        "none is chosen"
    );
    rig.set_serial_port(shop.line.port.clone());
    let sender = shop.sender(b"%\r\nO1234 (NEW)\r\nM30\r\n%\r\n");
    request(&mut rig, Direction::Import, &[]);
    shop.ended.store(true, Ordering::Release);
    drop(sender.join().unwrap());
    assert!(rig.has_program(1_234), "{:?}", refusal(&mut rig));
    assert!(rig.snapshot().alarms.is_empty(), "a new transmission takes the old alarm away");
}

#[test]
fn l9_the_baud_rate_is_a_parameter_with_a_range() {
    let mut rig = crate::stories::rig();
    crate::stories::tell(&mut rig, "param P370 19200");
    let line = SerialLine::from_params(&rig.retained().params, "/dev/ttyS0".into());
    assert_eq!(
        (line.baud, line.silence_timeout, line.start_timeout),
        (19_200, Duration::from_secs(10), Duration::from_secs(120))
    );
    for wrong in [0.0, 299.0, 115_201.0, 9_600.5] {
        assert!(
            rig.retained().params.clone().write(kt830::defs::param::SERIAL_BAUD.address(), wrong).is_err(),
            "{wrong}"
        );
    }
}
