//! The frequency inverter of the wheel (of the main spindle on a lathe): the actual speed, the load and the fault that it
//! reports.
//! Source: docs/manual, chapter "first start on a machine"; the codes are those of the inverter's manual.

use serde::Deserialize;

use super::channel::{BitChannel, CounterChannel, WordChannel};
use super::process_image::{BitField, DeviceImage};

/// What an inverter reports, and how its fault is reset.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InverterDescription {
    /// Its fault; 0 is none.
    pub fault: WordChannel,
    /// What the codes of its faults say.
    #[serde(default)]
    pub faults: Vec<InverterFaultText>,
    /// Output that is on for a second after RESET.
    #[serde(default)]
    pub reset: Option<BitChannel>,
    /// Actual speed; `counts` are those of 1 r/min.
    #[serde(default)]
    pub speed: Option<CounterChannel>,
    /// Load of its motor (current or torque); `counts` are those of 1 % of the rated one.
    #[serde(default)]
    pub load: Option<CounterChannel>,
}

/// What an inverter reports.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InverterReading {
    /// Actual speed, r/min, where it sends it.
    pub rpm: Option<f64>,
    /// Load of its motor in percent of the rated one, where it sends it.
    pub load_percent: Option<f64>,
    /// Code of its fault; 0 is none.
    pub fault_code: u32,
}

/// A code of a fault in words.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InverterFaultText {
    /// The code.
    pub code: u32,
    /// In Chinese.
    pub zh: String,
    /// In English; without it as in Chinese.
    #[serde(default)]
    pub en: String,
}

/// A field of the data of a device: where the description names it, the number of the device, and whether it is an output.
pub(super) type NamedField = (&'static str, u16, BitField, bool);

impl InverterDescription {
    /// What is read and written.
    pub(super) fn fields(&self) -> impl Iterator<Item = NamedField> {
        let fault = ("inverter.fault", self.fault.device, self.fault.field(), false);
        let reset = self.reset.map(|reset| ("inverter.reset", reset.device, reset.field(), true));
        let speed = self.speed.map(|speed| ("inverter.speed", speed.device, speed.field(), false));
        let load = self.load.map(|load| ("inverter.load", load.device, load.field(), false));
        [Some(fault), reset, speed, load].into_iter().flatten()
    }

    /// What is wrong beside its fields: the place and what must hold.
    pub(super) fn mistake(&self) -> Option<(String, &'static str)> {
        let is_idle = |channel: Option<CounterChannel>| channel.is_some_and(|channel| !channel.counts.is_normal());
        let channels = [("inverter.speed", self.speed), ("inverter.load", self.load)];
        if let Some((place, _)) = channels.into_iter().find(|(_, channel)| is_idle(*channel)) {
            return Some((place.to_owned(), "counts must not be 0"));
        }
        let mut codes: Vec<u32> = self.faults.iter().map(|text| text.code).collect();
        codes.sort_unstable();
        let of_code = |code: u32| format!("inverter.faults: code {code}");
        let twice = codes.windows(2).find(|pair| pair[0] == pair[1]);
        let twice = twice.map(|pair| (of_code(pair[0]), "a code has one text"));
        twice.or_else(|| codes.contains(&0).then(|| (of_code(0), "0 is no fault")))
    }

    /// The words of a code, Chinese and English.
    #[must_use]
    pub fn words(&self, code: u32) -> Option<(&str, &str)> {
        let text = self.faults.iter().find(|text| text.code == code)?;
        Some((&text.zh, if text.en.is_empty() { &text.zh } else { &text.en }))
    }

    /// The code of its fault; 0 is none. `images`: the data of a device by its number.
    pub(super) fn fault_code<'a>(&self, images: impl FnOnce(u16) -> Option<&'a DeviceImage>) -> u32 {
        images(self.fault.device).map_or(0, |image| self.fault.field().read(&image.inputs))
    }

    /// What it reports beside its fault. `images`: the data of a device by its number.
    pub(super) fn reading<'a>(
        &self,
        fault_code: u32,
        images: impl Fn(u16) -> Option<&'a DeviceImage>,
    ) -> InverterReading {
        let value = |channel: CounterChannel| {
            Some(f64::from(channel.field().read_signed(&images(channel.device)?.inputs)) / channel.counts)
        };
        InverterReading { rpm: self.speed.and_then(value), load_percent: self.load.and_then(value), fault_code }
    }
}
