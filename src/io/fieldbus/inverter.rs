//! The frequency inverter of the wheel (of the main spindle on a lathe): the actual speed and the fault that it reports.
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
        [Some(fault), reset, speed].into_iter().flatten()
    }

    /// What is wrong beside its fields: the place and what must hold.
    pub(super) fn mistake(&self) -> Option<(String, &'static str)> {
        if self.speed.is_some_and(|speed| !speed.counts.is_normal()) {
            return Some(("inverter.speed".to_owned(), "counts must not be 0"));
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

    /// Its actual speed, r/min, where it sends it.
    pub(super) fn rpm<'a>(&self, images: impl FnOnce(u16) -> Option<&'a DeviceImage>) -> Option<f64> {
        let speed = self.speed?;
        let image = images(speed.device)?;
        Some(f64::from(speed.field().read_signed(&image.inputs)) / speed.counts)
    }
}
