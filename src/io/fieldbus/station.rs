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
}

/// A driver of a station. Neither duty waits.
pub trait StationLink: Send {
    /// Takes the newest inputs. False if no answer has come since the last call; the inputs then stay as they are.
    fn receive(&mut self, inputs: &mut [u8]) -> bool;
    /// Hands over the outputs for the next exchange.
    fn send(&mut self, outputs: &[u8]);
    /// How it fares.
    fn health(&self) -> StationHealth;
}

/// A station as the tick sees it.
pub struct Station {
    link: Box<dyn StationLink>,
    max_age: Micros,
    /// When values came; at first when the control looked for the first time.
    heard_at: Option<Micros>,
    age: Micros,
    round_trips: Histogram,
}

impl Station {
    /// A station that has not answered yet.
    #[must_use]
    pub fn new(link: Box<dyn StationLink>, max_age: Micros) -> Self {
        Self { link, max_age, heard_at: None, age: Micros::ZERO, round_trips: Histogram::default() }
    }

    /// Takes what has come; returns the fault at the tick in which the station falls silent.
    pub fn read(&mut self, now: Micros, image: &mut DeviceImage) -> Option<StationFault> {
        let was_silent = self.is_silent();
        if self.link.receive(&mut image.inputs) {
            self.heard_at = Some(now);
            self.round_trips.add(self.link.health().round_trip);
        }
        self.age = now.since(*self.heard_at.get_or_insert(now));
        let falls_silent = self.is_silent() && !was_silent;
        falls_silent.then(|| self.link.health().fault.unwrap_or(StationFault::TimedOut))
    }

    /// Hands over what the station gets next.
    pub fn write(&mut self, image: &DeviceImage) {
        self.link.send(&image.outputs);
    }

    /// Whether its values are too old to be those of the machine.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        self.age > self.max_age
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
