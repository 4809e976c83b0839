//! The description of a machine as its page shows it: every device with its process data, and what they are bound to.
//! Source: docs/manual, chapter "first start on a machine".

use crate::defs::text::{LocalizedText, Text, phrase};
use crate::io::fieldbus::channel::CounterChannel;
use crate::io::fieldbus::description::{
    AnalogChannel, DeviceDescription, DigitalChannels, EtherCatDescription, MachineDescription, PdoEntry, SdoWrite,
    ServoAxisDescription,
};
use crate::io::fieldbus::inverter::InverterDescription;
use crate::io::fieldbus::station_description::{FIRST_STATION, ModbusBlock, StationDescription};
use crate::link::bus::DescriptionLine;
use crate::units::Axis;

/// Widest list of a line, characters: what a narrow screen shows beside its name.
const LINE_WIDTH: usize = 56;
/// Between the words of a list.
const GAP: &str = "  ";
const BINDINGS: Text = Text::new("端子和通道", "terminals and channels");

/// The lines of a description: network, devices, stations, axes, terminals.
#[must_use]
pub fn description_lines(described: &MachineDescription) -> Vec<DescriptionLine> {
    let mut lines = Lines::default();
    lines.heading(described.kind.row().name.into());
    lines.network(&described.ethercat, described.core);
    for (device, number) in described.devices.iter().zip(1_u16..) {
        lines.device(number, device);
    }
    for (station, number) in described.stations.iter().zip(FIRST_STATION..) {
        lines.station(number, station);
    }
    for (axis, servo) in described.axes().iter() {
        if let Some(servo) = servo {
            lines.axis(axis, servo);
        }
    }
    lines.bindings(described);
    lines.0
}

#[derive(Default)]
struct Lines(Vec<DescriptionLine>);

impl Lines {
    fn heading(&mut self, words: LocalizedText) {
        self.0.push(DescriptionLine::Heading(words));
    }

    fn property(&mut self, zh: &'static str, en: &'static str, value: String) {
        if !value.is_empty() {
            self.0.push(DescriptionLine::Property(Text::new(zh, en), value));
        }
    }

    /// A list in as many lines as it needs.
    fn list(&mut self, zh: &'static str, en: &'static str, words: impl IntoIterator<Item = String>) {
        let mut line = String::new();
        for word in words {
            if !line.is_empty() && line.chars().count() + word.chars().count() + GAP.len() > LINE_WIDTH {
                self.property(zh, en, std::mem::take(&mut line));
            }
            if !line.is_empty() {
                line += GAP;
            }
            line += &word;
        }
        self.property(zh, en, line);
    }

    fn network(&mut self, network: &EtherCatDescription, core: Option<u16>) {
        self.heading(LocalizedText::same("EtherCAT"));
        self.property("网卡", "interface", network.interface.clone());
        self.property("报文时限", "reply time", format!("{} µs", network.reply_time_us));
        self.property("允许丢失的报文", "bridged frames", network.bridged_frames.to_string());
        let clock =
            network.distributed_clocks.map(|clock| format!("SYNC0 {} + {} µs", clock.cycle_us, clock.shift_us()));
        self.property("分布时钟", "distributed clocks", clock.unwrap_or_else(|| "–".to_owned()));
        self.property("CPU 核", "CPU core", core.map_or_else(|| "–".to_owned(), |core| core.to_string()));
    }

    fn device(&mut self, number: u16, device: &DeviceDescription) {
        self.heading(LocalizedText::same(&format!("{number}  {}", device.name)));
        let revision = match device.revision {
            0 => "–".to_owned(),
            revision => format!("{revision:X}h"),
        };
        let identity = format!("{:X}h / {:X}h / {revision}", device.vendor, device.product);
        self.property("厂商 / 产品 / 版本", "vendor / product / revision", identity);
        let (inputs, outputs) = device.process_data_bytes();
        self.list("输出", "outputs", entries(&device.outputs, outputs));
        self.list("输入", "inputs", entries(&device.inputs, inputs));
        self.list("启动时写入", "written at the start", device.startup.iter().map(|write| object_value(*write)));
        let options = [(device.assign, "PDO"), (device.sync0, "SYNC0")];
        let modes = options.into_iter().filter(|(is_on, _)| *is_on).map(|(_, name)| name).collect::<Vec<_>>().join(GAP);
        self.property("配置", "set up", modes);
    }

    fn station(&mut self, number: u16, station: &StationDescription) {
        self.heading(LocalizedText::same(&format!("{number}  {}", station.name)));
        self.property("地址 / 站号", "address / unit", format!("{} / {}", station.address, station.unit));
        let times = format!("{} / {} / {} ms", station.period_ms, station.timeout_ms, station.max_age_ms);
        self.property("周期 / 时限 / 最大时龄", "period / time-out / maximum age", times);
        self.list("读", "read", blocks(&station.inputs));
        self.list("写", "written", blocks(&station.outputs));
    }

    fn axis(&mut self, axis: Axis, servo: &ServoAxisDescription) {
        self.heading(phrase!("{axis} 轴", "axis {axis}", axis));
        self.property("设备", "device", servo.device.to_string());
        let sign = if servo.reversed { "-" } else { "" };
        self.property("每毫米脉冲", "counts per mm", format!("{sign}{}", servo.counts_per_mm));
        let absolute = servo.absolute.map(|encoder| encoder.zero_counts.to_string());
        self.property("绝对编码器零点", "absolute encoder, zero at", absolute.unwrap_or_default());
        let probe =
            servo.touch_probe.map(|probe| format!("P{}{}", probe.signal, if probe.falling { " ↓" } else { "" }));
        self.property("G31 G78 由驱动器锁存", "G31, G78 latched by the drive", probe.unwrap_or_default());
        let highest = servo.highest_mm_s.map(|speed| format!("{speed} mm/s"));
        self.property("最高速度", "highest speed", highest.unwrap_or_default());
        let brake = servo.brake.as_ref();
        let brake = brake.map(|brake| format!("{}  {} / {} s", brake.port, brake.release_s, brake.engage_s));
        self.property("抱闸：端子，释放 / 抱紧", "brake: port, release / engage", brake.unwrap_or_default());
    }

    fn bindings(&mut self, described: &MachineDescription) {
        self.heading(BINDINGS.into());
        for block in &described.inputs {
            self.property("输入", "inputs", format!("{} → {}", bits(*block), ports(*block)));
        }
        for block in &described.outputs {
            self.property("输出", "outputs", format!("{} → {}", ports(*block), bits(*block)));
        }
        let analog = |channel: Option<AnalogChannel>| {
            let shown = |channel: AnalogChannel| {
                format!("{}  10 V = {}", place(channel.device, channel.bit, channel.bits), channel.counts_at_10_v)
            };
            channel.map(shown).unwrap_or_default()
        };
        self.property("砂轮（主轴）转速", "speed of wheel or spindle", analog(described.wheel_speed));
        self.property("第二模拟输出", "second analog output", analog(described.analog_2));
        let counter = |channel: Option<CounterChannel>| {
            let shown = |channel: CounterChannel| {
                format!("{}  1 = {}", place(channel.device, channel.bit, channel.bits), channel.counts)
            };
            channel.map(shown).unwrap_or_default()
        };
        if let Some(InverterDescription { fault, reset, speed, load, .. }) = &described.inverter {
            self.property("变频器故障", "fault of the inverter", place(fault.device, fault.bit, fault.bits));
            let reset = reset.map(|reset| place(reset.device, reset.bit, 1));
            self.property("变频器复位", "reset of the inverter", reset.unwrap_or_default());
            self.property("变频器实际转速", "actual speed of the inverter", counter(*speed));
            self.property("变频器负载", "load of the inverter", counter(*load));
        }
        self.property("手轮", "handwheel", counter(described.handwheel));
        self.property("主轴编码器", "spindle encoder", counter(described.spindle_encoder));
    }
}

/// Entries with their bits, and the bytes of all: `6040h 16  607Ah 32  (6 B)`.
fn entries(entries: &[PdoEntry], bytes: u16) -> impl Iterator<Item = String> {
    let shown = entries.iter().map(|entry| {
        let times = if entry.count > 1 { format!("{}×", entry.count) } else { String::new() };
        match (entry.object, entry.sub) {
            (0, _) => format!("– {times}{}", entry.bits),
            (object, 0) => format!("{object:X}h {times}{}", entry.bits),
            (object, sub) => format!("{object:X}h:{sub:02X} {times}{}", entry.bits),
        }
    });
    let all = (!entries.is_empty()).then(|| format!("({bytes} B)"));
    shown.chain(all)
}

fn object_value(write: SdoWrite) -> String {
    format!("{:X}h:{:02X} = {}", write.object, write.sub, write.value)
}

fn blocks(blocks: &[ModbusBlock]) -> impl Iterator<Item = String> {
    blocks.iter().map(|block| format!("{:?} {}–{}", block.table, block.from, block.from + (block.count - 1)))
}

/// From the first to the last of some numbers.
fn span(from: u16, count: u16) -> String {
    match count {
        0 | 1 => from.to_string(),
        _ => format!("{from}–{}", from + count - 1),
    }
}

/// Bits of a device: `4.0–15`.
fn place(device: u16, bit: u16, bits: u16) -> String {
    format!("{device}.{}", span(bit, bits))
}

fn bits(block: DigitalChannels) -> String {
    place(block.device, block.bit, block.count)
}

fn ports(block: DigitalChannels) -> String {
    span(u16::from(block.port), block.count)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(source: &str) -> Vec<String> {
        let lines = description_lines(&MachineDescription::parse(source).unwrap());
        let shown = lines.into_iter().map(|line| match line {
            DescriptionLine::Heading(words) => format!("# {}", words.en()),
            DescriptionLine::Property(name, value) => format!("{}: {value}", name.en),
        });
        shown.collect()
    }

    #[test]
    fn p1_a_long_list_takes_several_lines() {
        let mut lines = Lines::default();
        lines.list("输出", "outputs", (0..30).map(|at| format!("6{at:03X}h 16")));
        let DescriptionLine::Property(_, first) = &lines.0[0] else { panic!("{:?}", lines.0) };
        // 8 characters and a gap of 2 each: 5 of them are 48, a sixth would make 58.
        assert_eq!(first.split(GAP).count(), 5);
        assert_eq!(lines.0.len(), 6, "nothing is left out");
    }

    #[test]
    fn p1_every_part_of_a_description_is_a_line() {
        let source = r#"(kind: Gc, core: 3,
            ethercat: (interface: "ecat0", reply_time_us: 400, distributed_clocks: (cycle_us: 1000)),
            devices: [
                (name: "drive X", vendor: 1, product: 0x2a, revision: 0x10, sync0: true,
                    outputs: [(object: 0x6040, bits: 16), (object: 0x607a, bits: 32)],
                    inputs: [(object: 0x6041, bits: 16), (object: 0x6064, bits: 32)],
                    startup: [(object: 0x6060, bits: 8, value: 8)]),
                (name: "drive Z", vendor: 1, product: 0x2a,
                    outputs: [(object: 0x6040, bits: 16), (object: 0x607a, bits: 32)],
                    inputs: [(object: 0x6041, bits: 16), (object: 0x6064, bits: 32)],
                    startup: [(object: 0x6060, bits: 8, value: 8)]),
                (name: "terminal", vendor: 2, product: 3, outputs: [(object: 0x7000, sub: 1, bits: 1, count: 16)],
                    inputs: [(object: 0x6000, sub: 1, bits: 1, count: 16)]),
            ],
            stations: [(name: "island", address: "10.0.0.2:502", inputs: [(table: InputRegisters, from: 4, count: 2)])],
            x: (device: 1, counts_per_mm: 1000.0, reversed: true, absolute: (zero_counts: -7),
                brake: (port: 20, release_s: 0.05, engage_s: 0.03)),
            z: (device: 2, counts_per_mm: 2000.0, highest_mm_s: 150.0),
            inputs: [(device: 3, count: 16, port: 1)],
            outputs: [(device: 3, bit: 2, count: 3, port: 5), (device: 3, port: 20)],
            handwheel: (device: 101, bit: 0, bits: 16, counts: 4.0),
        )"#;
        let found = shown(source);
        for text in [
            "interface: ecat0",
            "distributed clocks: SYNC0 1000 + 500 µs",
            "CPU core: 3",
            "# 1  drive X",
            "vendor / product / revision: 1h / 2Ah / 10h",
            "outputs: 6040h 16  607Ah 32  (6 B)",
            "written at the start: 6060h:00 = 8",
            "set up: SYNC0",
            "vendor / product / revision: 2h / 3h / –",
            "inputs: 6000h:01 16×1  (2 B)",
            "# 101  island",
            "read: InputRegisters 4–5",
            "counts per mm: -1000",
            "absolute encoder, zero at: -7",
            "brake: port, release / engage: 20  0.05 / 0.03 s",
            "highest speed: 150 mm/s",
            "inputs: 3.0–15 → 1–16",
            "outputs: 5–7 → 3.2–4",
            "handwheel: 101.0–15  1 = 4",
        ] {
            assert!(found.iter().any(|line| line == text), "{text}: {found:#?}");
        }
    }
}
