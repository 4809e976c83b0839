//! A station that is exchanged beside the tick: the age of its values, and its silence. It knows no driver: a
//! [`StationLink`] hands values over.
//! Source: safety stance ("on doubt: stop, say why"); Modbus Application Protocol V1.1b3 for the exception codes.

use super::process_image::DeviceImage;
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::units::{Histogram, Micros};

/// Why a station does not serve the control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StationFault {
    /// No connection has come about.
    Unreachable,
    /// The computer at its address takes no connection.
    ConnectionRefused,
    /// It has not answered in time.
    TimedOut,
    /// It has closed the connection.
    Closed,
    /// Its answer is none to the request.
    Garbled,
    /// It refuses the request with this exception code.
    Exception(u8),
    /// It has been connected anew: it may have been without power. Its outputs are off until RESET.
    ConnectedAnew,
    /// The control had not renewed its outputs for too long: they are off until RESET.
    NotRenewed,
}

/// Exception codes with a meaning that helps a fitter; others are shown as numbers.
static EXCEPTIONS: &[(u8, Text)] = &[
    (1, Text::new("不支持该功能", "function not supported")),
    (2, Text::new("没有该地址", "no such address")),
    (3, Text::new("数值无效", "invalid value")),
    (4, Text::new("设备故障", "device failure")),
    (6, Text::new("设备忙", "device busy")),
    (10, Text::new("网关没有通路", "no path of the gateway")),
    (11, Text::new("网关后的设备没有应答", "the device behind the gateway does not answer")),
];

impl StationFault {
    /// The fault in words.
    #[must_use]
    pub fn text(self) -> LocalizedText {
        match self {
            Self::Unreachable => phrase!("无法连接", "cannot be reached"),
            Self::ConnectionRefused => phrase!("拒绝连接", "refuses the connection"),
            Self::TimedOut => phrase!("没有应答", "does not answer"),
            Self::Closed => phrase!("关闭了连接", "has closed the connection"),
            Self::Garbled => phrase!("应答不正确", "answers wrongly"),
            Self::ConnectedAnew => phrase!("重新连接，输出断开", "is connected anew, its outputs are off"),
            Self::NotRenewed => phrase!("输出没有刷新，已断开", "had no new outputs, they are off"),
            Self::Exception(code) => match EXCEPTIONS.iter().find(|(known, _)| *known == code) {
                Some((_, says)) => phrase!("异常 {code} {says}", "exception {code} {says}", code, says),
                None => phrase!("异常 {code}", "exception {code}", code),
            },
        }
    }
}

/// How a station fares.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StationHealth {
    /// Exchanges with an answer.
    pub exchanges: u64,
    /// Exchanges without one.
    pub failures: u64,
    /// How long the last exchange took.
    pub round_trip: Micros,
    /// What was wrong in the last exchange.
    pub fault: Option<StationFault>,
    /// Why its outputs are off until RESET.
    pub locked: Option<StationFault>,
}

/// A driver of a station. No duty waits. After a lost connection, and when the control has not renewed the outputs for
/// too long, it keeps them off until they are released.
pub trait StationLink: Send {
    /// Takes the newest inputs. False if no answer has come since the last call; the inputs then stay as they are.
    fn receive(&mut self, inputs: &mut [u8]) -> bool;
    /// Hands over the outputs for the next exchange.
    fn send(&mut self, outputs: &[u8]);
    /// The last outputs are good for so long from now on without being renewed.
    fn hold(&mut self, time: Micros);
    /// RESET: outputs that are kept off may go on.
    fn release(&mut self);
    /// How it fares.
    fn health(&self) -> StationHealth;
}

/// A station as the tick sees it.
pub struct Station {
    link: Box<dyn StationLink>,
    max_age: Micros,
    /// When values came; `None` before the first ones.
    heard_at: Option<Micros>,
    age: Micros,
    was_silent: bool,
    round_trips: Histogram,
}

impl Station {
    /// A station that has not answered yet.
    #[must_use]
    pub fn new(link: Box<dyn StationLink>, max_age: Micros) -> Self {
        Self { link, max_age, heard_at: None, age: Micros::ZERO, was_silent: false, round_trips: Histogram::default() }
    }

    /// The times of its exchanges are counted anew.
    pub fn clear_times(&mut self) {
        self.round_trips.clear();
    }

    /// Takes what has come; returns whether an exchange has been tried at all.
    pub fn take(&mut self, now: Micros, image: &mut DeviceImage) -> bool {
        if self.link.receive(&mut image.inputs) {
            self.heard_at = Some(now);
            self.round_trips.add(self.link.health().round_trip);
        }
        let health = self.link.health();
        health.exchanges + health.failures > 0
    }

    /// Takes what has come; returns whether the station falls silent in this tick.
    pub fn read(&mut self, now: Micros, image: &mut DeviceImage) -> bool {
        self.take(now, image);
        self.age = self.heard_at.map_or(now, |at| now.since(at));
        let (was_silent, is_silent) = (self.was_silent, self.is_silent());
        self.was_silent = is_silent;
        is_silent && !was_silent
    }

    /// Why it is silent.
    #[must_use]
    pub fn why(&self) -> StationFault {
        let health = self.link.health();
        health.fault.or(health.locked).unwrap_or(StationFault::TimedOut)
    }

    /// Hands over what the station gets next.
    pub fn write(&mut self, image: &DeviceImage) {
        self.link.send(&image.outputs);
    }

    /// Its last outputs are good for so long from now on without being renewed.
    pub fn hold(&mut self, time: Micros) {
        self.link.hold(time);
    }

    /// RESET: outputs that are kept off may go on.
    pub fn release(&mut self) {
        self.link.release();
    }

    /// Whether its values are not those of the machine: there are none, they are too old, or its outputs are kept off.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        self.heard_at.is_none() || self.age > self.max_age || self.link.health().locked.is_some()
    }

    /// Age of its values.
    #[must_use]
    pub const fn age(&self) -> Micros {
        self.age
    }

    /// How it fares.
    #[must_use]
    pub fn health(&self) -> StationHealth {
        self.link.health()
    }

    /// Times of its exchanges.
    #[must_use]
    pub const fn round_trips(&self) -> &Histogram {
        &self.round_trips
    }
}
