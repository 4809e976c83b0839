//! `kt830 bus`: looks at the field bus of a real machine. All outputs stay off, and no drive is switched on.
//! Source: docs/manual, chapter "first start on a machine".

use std::time::{Duration, Instant};

use serde_json::json;

use super::args::{BusArgs, OutputFormat, SharedArgs};
use super::{CallError, FAILED, SUCCESS, print_line, setup};
use crate::defs::param::{self, Params};
use crate::defs::signal::{PORTS, Terminals};
use crate::defs::text::Lang;
use crate::io::ethercat::EtherCat;
use crate::io::fieldbus::bus_fault::BusFault;
use crate::io::fieldbus::description::MachineDescription;
use crate::io::fieldbus::station::{Station, StationHealth};
use crate::io::fieldbus::station_description::FIRST_STATION;
use crate::io::fieldbus::{BusStatistics, FieldBusMachine};
use crate::io::{Backend, InputImage, OutputImage};
use crate::units::{Axis, Micros};

/// What was seen.
struct Seen<'a> {
    description: &'a MachineDescription,
    inputs: InputImage,
    statistics: BusStatistics,
    stations: Vec<SeenStation>,
    fault: Option<String>,
    lang: Lang,
}

/// A station, and the registers and bits that it sends, as bytes.
struct SeenStation {
    name: String,
    address: String,
    health: StationHealth,
    inputs: Vec<u8>,
}

/// Connects the bus, watches it and prints what is there; fails if a device is missing or differs, if the bus is lost, or
/// if a station does not answer.
///
/// # Errors
/// The description is wrong.
pub fn bus(shared: &SharedArgs, call: &BusArgs) -> Result<u8, CallError> {
    let description = setup::read_description(&call.description)?;
    let tick = Micros(Params::factory(description.kind).get(param::TICK_TIME) as u64);
    let mut machine = setup::open_bus(description)?;
    machine.connect();
    if machine.fault() == Some(BusFault::NoPermission) {
        warn_line!(
            "kt830: no permission for the network: `sudo setcap cap_net_raw,cap_sys_nice,cap_ipc_lock=ep {}` gives it without root",
            std::env::current_exe().unwrap_or_default().display()
        );
    }
    let end = Instant::now() + Duration::from_secs(call.seconds.into());
    let (mut now, mut inputs) = (Micros::ZERO, InputImage::default());
    let may_look = |machine: &FieldBusMachine<EtherCat>| {
        let beside = !machine.stations().is_empty() && machine.fault() != Some(BusFault::InUse);
        machine.fault().is_none() || beside
    };
    while Instant::now() < end && may_look(&machine) {
        inputs = machine.read(now);
        machine.write(now, &OutputImage::default());
        std::thread::sleep(Duration::from_micros(tick.0));
        now = now + tick;
    }
    let fault = machine.fault().map(|fault| fault.text().get(shared.lang).into_owned());
    let silent = machine.stations().iter().any(Station::is_silent);
    let stations = machine.stations().iter().zip(&machine.description().stations).zip(machine.station_images());
    let stations = stations.map(|((station, described), image)| SeenStation {
        name: described.name.clone(),
        address: described.address.to_string(),
        health: station.health(),
        inputs: image.inputs.clone(),
    });
    let stations = stations.collect();
    let seen = Seen {
        stations,
        description: machine.description(),
        inputs,
        statistics: machine.statistics(),
        fault,
        lang: shared.lang,
    };
    match shared.format {
        OutputFormat::Json => print_line(seen.json()),
        OutputFormat::Text => seen.print(),
    }
    Ok(if seen.fault.is_none() && !silent { SUCCESS } else { FAILED })
}

impl Seen<'_> {
    fn axes(&self) -> impl Iterator<Item = (Axis, f64, String)> + '_ {
        let fitted = self.description.axes();
        Axis::ALL.into_iter().filter(move |axis| fitted[*axis].is_some()).map(|axis| {
            (axis, self.inputs.encoder_mm[axis], self.inputs.drives[axis].text().get(self.lang).into_owned())
        })
    }

    fn ports_on(&self) -> Vec<u8> {
        let Terminals(levels) = self.inputs.terminals;
        (1..=PORTS).filter(|port| levels >> (port - 1) & 1 == 1).collect()
    }

    fn json(&self) -> serde_json::Value {
        let devices: Vec<_> = self.description.devices.iter().map(|device| json!(device.name)).collect();
        let axes: serde_json::Map<_, _> = self
            .axes()
            .map(|(axis, mm, state)| (axis.to_string(), json!({"encoder_mm": mm, "drive": state})))
            .collect();
        let stations: Vec<_> = self
            .stations
            .iter()
            .map(|seen| {
                let StationHealth { exchanges, failures, fault, .. } = seen.health;
                let fault = fault.map(|fault| fault.text().get(self.lang).into_owned());
                json!({"name": seen.name, "address": seen.address, "inputs": seen.inputs, "exchanges": exchanges,
                    "failures": failures, "fault": fault})
            })
            .collect();
        let BusStatistics { cycles, lost } = self.statistics;
        json!({"devices": devices, "stations": stations, "axes": axes, "inputs_on": self.ports_on(), "cycles": cycles, "lost": lost, "fault": self.fault})
    }

    fn print(&self) {
        let words = |zh: &'static str, en: &'static str| self.lang.pick(zh, en);
        if let Some(fault) = &self.fault {
            print_line(format!("{}: {fault}", words("总线故障", "bus fault")));
        }
        for (device, number) in self.description.devices.iter().zip(1..) {
            print_line(format!("{number:3} {} {:X}h/{:X}h", device.name, device.vendor, device.product));
        }
        for (seen, number) in self.stations.iter().zip(FIRST_STATION..) {
            let StationHealth { exchanges, failures, fault, .. } = seen.health;
            let state = fault.map_or_else(String::new, |fault| fault.text().get(self.lang).into_owned());
            let bytes: Vec<_> = seen.inputs.iter().map(|byte| format!("{byte:02x}")).collect();
            print_line(format!("{number:3} {} {} {exchanges}/{failures} {state}", seen.name, seen.address));
            print_line(format!("    {}: {}", words("输入字节", "input bytes"), bytes.join(" ")));
        }
        for (axis, mm, state) in self.axes() {
            print_line(format!("{axis} {mm:12.4} mm  {state}"));
        }
        let ports: Vec<_> = self.ports_on().iter().map(u8::to_string).collect();
        print_line(format!("{}: {}", words("接通的输入口", "input ports on"), ports.join(" ")));
        let BusStatistics { cycles, lost } = self.statistics;
        print_line(format!("{}: {cycles}, {}: {lost}", words("周期", "cycles"), words("丢失", "lost")));
    }
}
