//! The raw Ethernet socket of the bus, and the loop that runs the futures of the EtherCAT stack on the thread of the
//! control. A frame that comes back after its time-out is counted and dropped; it ends nothing.
//! Source: packet(7); ETG.1000.4 (EtherType 88A4h).

use std::future::Future;
use std::num::NonZeroU32;
use std::os::fd::{AsRawFd, OwnedFd};
use std::pin::{Pin, pin};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::{Context, Poll, Wake, Waker};

use ethercrab::std::ethercat_now;
use ethercrab::{PduRx, PduTx};
use nix::ifaddrs::getifaddrs;
use nix::sys::socket::SockaddrLike;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use rustix::net::{AddressFamily, Protocol, RecvFlags, SendFlags, SocketAddrUnix, SocketFlags, SocketType};

use crate::io::fieldbus::bus_fault::BusFault;

/// EtherType of EtherCAT.
const ETHERTYPE: u16 = 0x88a4;
/// Longest Ethernet frame, bytes.
const MAX_FRAME: usize = 1_536;
/// The futures are polled at least so often while nothing comes back: they notice their time-outs so.
const POLL_INTERVAL: Timespec = Timespec { tv_sec: 0, tv_nsec: 200_000 };

/// Notes that a future wants to be polled.
#[derive(Default)]
struct WakeFlag(AtomicBool);

impl Wake for WakeFlag {
    fn wake(self: Arc<Self>) {
        self.0.store(true, Ordering::Release);
    }
}

/// The socket and the two ends of the stack's frame queue.
pub struct EtherCatLink {
    tx: PduTx<'static>,
    rx: PduRx<'static>,
    /// `None` until the interface is open.
    socket: Option<OwnedFd>,
    /// Keeps other processes from the bus.
    taken: Option<OwnedFd>,
    woken: Arc<WakeFlag>,
}

/// Takes the bus of an interface for this process, until the socket is closed. Another process that set the devices up
/// would stop the machine in its work.
fn take_bus(interface: &str) -> Result<OwnedFd, BusFault> {
    let name = format!("kt830-ethercat-{interface}");
    let address = SocketAddrUnix::new_abstract_name(name.as_bytes()).map_err(|_| BusFault::NoInterface)?;
    let taken = rustix::net::socket_with(AddressFamily::UNIX, SocketType::DGRAM, SocketFlags::CLOEXEC, None)
        .map_err(|_| BusFault::Other)?;
    rustix::net::bind(&taken, &address).map_err(|_| BusFault::InUse)?;
    Ok(taken)
}

/// Opens a packet socket for EtherCAT frames on an interface.
fn open_socket(interface: &str) -> Result<OwnedFd, BusFault> {
    let protocol = NonZeroU32::new(u32::from(ETHERTYPE.to_be())).map(Protocol::from_raw);
    let flags = SocketFlags::CLOEXEC | SocketFlags::NONBLOCK;
    let socket = rustix::net::socket_with(AddressFamily::PACKET, SocketType::RAW, flags, protocol).map_err(
        |error| match error {
            Errno::PERM | Errno::ACCESS => BusFault::NoPermission,
            _ => BusFault::Other,
        },
    )?;
    let mut addresses = getifaddrs().map_err(|_| BusFault::NoInterface)?;
    let link = addresses.find_map(|found| {
        let address = found.address.filter(|_| found.interface_name == interface)?;
        address.as_link_addr().copied()
    });
    // The address names the interface; the protocol stays that of the socket.
    let link = link.ok_or(BusFault::NoInterface)?;
    assert!(link.len() > 0);
    nix::sys::socket::bind(socket.as_raw_fd(), &link).map_err(|_| BusFault::NoInterface)?;
    Ok(socket)
}

impl EtherCatLink {
    /// A link whose interface is not open.
    pub fn new(tx: PduTx<'static>, rx: PduRx<'static>) -> Self {
        Self { tx, rx, socket: None, taken: None, woken: Arc::default() }
    }

    /// Opens the interface, also anew after it was away.
    ///
    /// # Errors
    /// There is no such interface, or the process may not use it.
    pub fn open(&mut self, interface: &str) -> Result<(), BusFault> {
        self.socket = None;
        if self.taken.is_none() {
            self.taken = Some(take_bus(interface)?);
        }
        self.socket = Some(open_socket(interface)?);
        Ok(())
    }

    /// Polls `work`, sends the frames that it asks for and hands it what comes back, until it is done.
    pub fn run<F: Future>(&mut self, work: F) -> F::Output {
        let mut work = pin!(work);
        loop {
            if let Some(output) = self.turn(work.as_mut()) {
                return output;
            }
        }
    }

    /// The same, but given up after a number of nanoseconds of the clock of the stack.
    pub fn run_for<F: Future>(&mut self, limit_ns: u64, work: F) -> Option<F::Output> {
        let mut work = pin!(work);
        let end = ethercat_now() + limit_ns;
        loop {
            let done = self.turn(work.as_mut());
            if done.is_some() || ethercat_now() >= end {
                return done;
            }
        }
    }

    /// Polls once; sends and receives if it is not done.
    fn turn<F: Future>(&mut self, work: Pin<&mut F>) -> Option<F::Output> {
        let waker = Waker::from(Arc::clone(&self.woken));
        self.woken.0.store(false, Ordering::Release);
        if let Poll::Ready(output) = work.poll(&mut Context::from_waker(&waker)) {
            return Some(output);
        }
        self.send();
        if !self.woken.0.load(Ordering::Acquire) {
            self.wait();
        }
        self.receive();
        None
    }

    fn send(&mut self) {
        self.tx.replace_waker(Waker::noop());
        while let Some(frame) = self.tx.next_sendable_frame() {
            let socket = &self.socket;
            // A frame that cannot be sent is one that is lost: its time-out tells.
            let _ = frame.send_blocking(|bytes| {
                if let Some(socket) = socket {
                    let _ = rustix::net::send(socket, bytes, SendFlags::empty());
                }
                Ok(bytes.len())
            });
        }
    }

    /// Waits for a frame, for the poll interval at most.
    fn wait(&self) {
        let _ = match &self.socket {
            Some(socket) => poll(&mut [PollFd::new(socket, PollFlags::IN)], Some(&POLL_INTERVAL)),
            None => poll(&mut [], Some(&POLL_INTERVAL)),
        };
    }

    /// Waits without listening.
    pub fn pause(&self, time: &Timespec) {
        let _ = poll(&mut [], Some(time));
    }

    fn receive(&mut self) {
        let Some(socket) = &self.socket else { return };
        let mut buffer = [0_u8; MAX_FRAME];
        while let Ok((taken, _)) = rustix::net::recv(socket, &mut buffer, RecvFlags::DONTWAIT) {
            let Some(frame) = buffer.get(..taken).filter(|frame| !frame.is_empty()) else { return };
            // A reply behind its time-out, or a frame of somebody else, belongs to nothing.
            let _ = self.rx.receive_frame(frame);
        }
    }
}
