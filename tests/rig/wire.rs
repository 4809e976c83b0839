//! Frames of another sender on the cable: what a reset does to a device is written into its registers.
//! Source: ETG.1000.4 (frame, datagram, registers).

use std::num::NonZeroU32;
use std::os::fd::{AsRawFd, OwnedFd};
use std::time::{Duration, Instant};

use nix::ifaddrs::getifaddrs;
use rustix::net::{AddressFamily, Protocol, RecvFlags, SendFlags, SocketFlags, SocketType};

const ETHERTYPE: u16 = 0x88a4;
/// Commands: read and write by the place on the cable.
const APRD: u8 = 1;
const APWR: u8 = 2;
/// Index of the datagrams, which marks the answers.
const INDEX: u8 = 0xe7;
/// Bytes before and of the headers.
const ETHERNET: usize = 14;
const DATA: usize = ETHERNET + 2 + 10;
/// Registers: station address, AL control, FMMUs, sync managers, offset of the system time.
const STATION_ADDRESS: u16 = 0x0010;
const AL_CONTROL: u16 = 0x0120;
const FMMU: u16 = 0x0600;
const SYNC_MANAGER: u16 = 0x0800;
const TIME_OFFSET: u16 = 0x0920;
/// AL control: initial state, errors acknowledged.
const INIT: u16 = 0x0011;

/// A sender of its own.
pub struct Wire {
    socket: OwnedFd,
}

impl Wire {
    /// On the interface of the rig.
    pub fn open() -> Self {
        let interface = std::env::var("KT_ETHERCAT_IF").expect("interface");
        let protocol = NonZeroU32::new(u32::from(ETHERTYPE.to_be())).map(Protocol::from_raw);
        let flags = SocketFlags::CLOEXEC | SocketFlags::NONBLOCK;
        let socket = rustix::net::socket_with(AddressFamily::PACKET, SocketType::RAW, flags, protocol).expect("socket");
        let mut addresses = getifaddrs().expect("interfaces");
        let link = addresses.find_map(|found| {
            let address = found.address.filter(|_| found.interface_name == interface)?;
            address.as_link_addr().copied()
        });
        nix::sys::socket::bind(socket.as_raw_fd(), &link.expect("interface")).expect("bind");
        Self { socket }
    }

    /// One datagram to the device at a place, from 1; the data that come back. The device must take part.
    fn exchange(&self, command: u8, device: u16, register: u16, data: &[u8]) -> Vec<u8> {
        let mut frame = vec![0xff; 6];
        frame.extend([0x02, 0, 0, 0, 0, 0xe7]);
        frame.extend(ETHERTYPE.to_be_bytes());
        frame.extend((1 << 12 | (data.len() + 12) as u16).to_le_bytes());
        frame.extend([command, INDEX]);
        frame.extend((1_u16.wrapping_sub(device)).to_le_bytes());
        frame.extend(register.to_le_bytes());
        frame.extend((data.len() as u16).to_le_bytes());
        frame.extend([0, 0]);
        frame.extend(data);
        frame.extend([0, 0]);
        frame.resize(frame.len().max(60), 0);
        rustix::net::send(&self.socket, &frame, SendFlags::empty()).expect("send");
        let until = Instant::now() + Duration::from_secs(1);
        let mut answer = [0; 1_536];
        while Instant::now() < until {
            let Ok((count, _)) = rustix::net::recv(&self.socket, &mut answer, RecvFlags::empty()) else {
                // Not a loop without a pause: this thread goes before all others.
                std::thread::sleep(Duration::from_micros(50));
                continue;
            };
            let counter = DATA + data.len();
            if count >= counter + 2 && answer[ETHERNET + 3] == INDEX {
                assert_eq!(answer[counter], 1, "device {device} takes no part");
                return answer[DATA..counter].to_vec();
            }
        }
        panic!("no answer of device {device}");
    }

    /// A device loses what it was told, as by a moment without power.
    pub fn reset_device(&self, device: u16) {
        self.exchange(APWR, device, AL_CONTROL, &INIT.to_le_bytes());
        self.exchange(APWR, device, FMMU, &[0; 64]);
        self.exchange(APWR, device, SYNC_MANAGER, &[0; 32]);
        self.exchange(APWR, device, STATION_ADDRESS, &[0; 2]);
    }

    /// The clock of a device goes forward by so much.
    pub fn move_clock(&self, device: u16, ns: i64) {
        let offset = self.exchange(APRD, device, TIME_OFFSET, &[0; 8]);
        let offset = i64::from_le_bytes(offset.try_into().expect("8 bytes")).wrapping_add(ns);
        self.exchange(APWR, device, TIME_OFFSET, &offset.to_le_bytes());
    }
}
