//! A realistic machine for pictures and tests: O1001 is loaded, homed, hydraulic and coolant on, wheel turning.

#![allow(dead_code)]

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use kt830::defs::alarm::{ALARMS, Alarm};
use kt830::defs::alarm_history::{AlarmEnd, AlarmHistory, PastAlarm};
use kt830::defs::date::DateTime;
use kt830::defs::device_state::DeviceState;
use kt830::defs::hour_record::{HourHistory, HourRecord};
use kt830::defs::key::{Key, Mode};
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::page_meaning::SizeKind;
use kt830::defs::page_text::{self, VariableUse};
use kt830::defs::param::{ParamAddress, Params};
use kt830::defs::part_record::{PartHistory, PartRecord};
use kt830::defs::part_verdict::PartVerdict;
use kt830::defs::port_errors::PortErrors;
use kt830::defs::production_order::{MAX_ORDERS, OrderState, OrderValue, OrderValues, ProductionOrder};
use kt830::defs::scope_signal::ScopeSignal;
use kt830::defs::signal::Input;
use kt830::defs::start_step::StartStep;
use kt830::defs::text::{Lang, LocalizedText, SharedWords, Text};
use kt830::defs::wheel_record::WheelRecord;
use kt830::io::drive::{DriveFault, DriveState};
use kt830::io::fieldbus::bus_fault::BusFault;
use kt830::io::fieldbus::station::StationFault;
use kt830::link::Snapshot;
use kt830::link::bus::{
    BusClock, BusDevice, BusDrive, BusInverter, BusStation, BusView, DescriptionLine, ThreadRights,
};
use kt830::link::cycle_times::CycleTimes;
use kt830::link::edit::ModalView;
use kt830::link::files::FilesView;
use kt830::link::media::{MediaFile, MediaView, TransferSet};
use kt830::link::network::{BrokerState, BrokerView, NetworkView, OpcUaView, ServiceState, ServiceView, TlsView};
use kt830::link::page_file::{PageFile, PageTextId, PictureFile, PictureLocation};
use kt830::link::part_result::{NominalSize, OffsetInForce, PartResult};
use kt830::link::production::ProductionView;
use kt830::link::program_view::ProgramView;
use kt830::link::scope::{SCOPE_SPANS, ScopeRecording, ScopeSetup, ScopeTrigger};
use kt830::link::screens::{FileFault, Picture, ScreenFiles, Screens};
use kt830::link::simulation::{PartSize, SimView};
use kt830::link::snapshot::{AlarmView, AxisView, DirectoryRow, Message, RunState, Tone};
use kt830::link::start_guide::{StartGuide, StepAction, StepState, StepView};
use kt830::link::toolpath::{CycleTime, MoveKind, PathPoint, StockBox, Toolpath};
use kt830::units::{Axis, DisplayPos, Micros, PerAxis, Percentiles, TimeDistribution, WorkPos};

/// The customer's own page text (seed 000).
pub const C0001: &str = "外卡磨削;\n卡尺X轴始磨位置 #500;\n卡尺X轴终点位置 #501;\n卡尺X轴安全位置 #503;\n\
    卡尺Z轴终点位置 #504;\n左卡磨耗余量 #505;\n左卡粗磨余量 #506;\n粗磨进给方式 #507;\n精磨进给方式 #508;\n;\n;\n\
    左卡Z轴始磨位置 #502;\n右尺Z轴始磨位置 #514;\n右卡粗磨余量 #515;\n右卡精磨余量 #516;\n粗磨速度 #512;\n\
    精磨速度 #513;\n光磨次数 #511;\n;\n;\n;\n%\n";

const O1001: &str = "O1001 (外卡磨削 snap gauge)\n(步距 step sizes)\n#101=0.02\n#102=0.005\nN0010 G98 G00 X#503\nN0020 M14\n\
    N0030 M03 S1260\nN0040 M08\nN0050 G00 Z#502\nN0060 G00 X#500\nN0070 WHILE[#110 LT #506] DO1\nN0080 G01 W-#101 F#512\n\
    N0090 G01 X#501 F1200\nN0100 #110=#110+#101\nN0110 END1\n; 精磨\nN0120 G01 W-#102 F#513\nN0130 G01 X#500\n\
    N0140 G04 P500\nN0150 G00 X#503\nN0160 G00 Z#504\nN0170 M09\nN0180 M05\nN0190 M30\n%\n";

/// The page picture in the repository, or a plain one; read once.
pub fn picture(file: &'static str) -> Arc<Picture> {
    static READ: Mutex<BTreeMap<&str, Arc<Picture>>> = Mutex::new(BTreeMap::new());
    let mut read = READ.lock().unwrap_or_else(PoisonError::into_inner);
    Arc::clone(read.entry(file).or_insert_with(|| read_picture(file)))
}

#[allow(clippy::unwrap_used, reason = "a test driver: a failure is the message")]
fn read_picture(file: &str) -> Arc<Picture> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("screens").join(file);
    let plain = || {
        let (rgb, mut bmp) = (image::RgbImage::from_pixel(200, 400, image::Rgb([40; 3])), Vec::new());
        rgb.write_to(&mut std::io::Cursor::new(&mut bmp), image::ImageFormat::Bmp).unwrap();
        bmp
    };
    Arc::new(Picture(std::fs::read(path).unwrap_or_else(|_| plain()).into()))
}

/// The page text of O1001 in the page designer: one variable is missing on it, one is not used.
pub fn page_file() -> PageFile {
    let used = |variable, reads, writes, line, comment: &str| VariableUse {
        variable,
        reads,
        writes,
        place: (1_001, line),
        comment: comment.into(),
    };
    let mut uses: Vec<_> = (500..514).map(|variable| used(variable, true, false, 5, "")).collect();
    uses.extend([used(101, true, true, 3, "步距 step sizes"), used(560, true, false, 12, "修整间隔")]);
    let pictures = [(PictureLocation::Medium, "drawing of the part.png"), (PictureLocation::Screens, "B0001.BMP")];
    PageFile {
        id: PageTextId { page: 1_001, lang: Lang::Zh },
        name: "C0001.TXT".into(),
        text: C0001.into(),
        stamp: 1,
        has_invalid_bytes: false,
        uses: Some(uses),
        pictures: pictures
            .map(|(from, name)| PictureFile { location: from, name: name.into(), size: 240_054 })
            .to_vec(),
    }
}

/// What is missing for the next cycle start: homing, a value, AUTO.
fn start_guide() -> StartGuide {
    use StartStep::{Homing, Hydraulics, Machine, Mode, Program, Tailstock, Values, Wheel};
    let mut guide = StartGuide::default();
    for step in [Machine, Hydraulics, Wheel, Program] {
        guide.steps[step as usize].state = StepState::Met;
    }
    guide.steps[Tailstock as usize].state = StepState::NotNeeded;
    for (step, key) in [(Homing, Key::ModeHome), (Mode, Key::ModeAuto)] {
        let reason = Text::new("先回零再循环启动", "home the axes before cycle start").into();
        guide.steps[step as usize] =
            StepView { state: StepState::Missing, reason, action: Some(StepAction::Press(key)) };
    }
    let reason = Text::new("成品直径 #521 不小于毛坯直径 #520", "the finished diameter is not below the blank").into();
    guide.steps[Values as usize] =
        StepView { state: StepState::Missing, reason, action: Some(StepAction::Open(Page::Grinding, Some(503))) };
    guide
}

/// A running machine on a page.
pub fn snapshot(page: Page) -> Snapshot {
    let mut snapshot = Snapshot::new(Kind::Gc);
    snapshot.now = Micros(54_116_000_000);
    snapshot.page = page;
    snapshot.soft_key_row = page.soft_row();
    snapshot.files = Arc::new(FilesView { page: Some(Arc::new(page_file())), ..FilesView::default() });
    snapshot.mode = Mode::Manual;
    snapshot.x_as_diameter = true;
    let axis = |work: f64, machine: f64, relative: f64| AxisView {
        decimals: 3,
        present: true,
        work,
        machine,
        relative,
        to_go: 0.0,
        homed: true,
        moving: false,
    };
    snapshot.axes[Axis::X] = axis(-743.080, -812.455, 12.340);
    snapshot.axes[Axis::Z] = axis(-139.080, -391.006, -0.005);
    snapshot.program = ProgramView {
        number: 1_001,
        text: O1001.into(),
        block_program: 1_001,
        line: 8,
        block: Some(40),
        ..ProgramView::default()
    };
    snapshot.start_guide = start_guide();
    snapshot.wheel_rpm = 1_260.0;
    snapshot.feed_mm_min = 0.0;
    snapshot.parts_counted = 12;
    snapshot.cycle.times.seconds = 187.0;
    for (number, value) in
        [(500, 40.2), (501, -12.5), (503, 120.0), (504, 85.0), (505, 0.03), (506, 0.25), (507, 0.0), (508, 1.0)]
    {
        snapshot.variables[number] = Some(value);
    }
    for (number, value) in [(502, 12.0), (514, 48.25), (515, 0.2), (512, 300.0), (513, 60.0), (511, 3.0)] {
        snapshot.variables[number] = Some(value);
    }
    for key in [Key::ModeManual, Key::Hydraulic, Key::Coolant, Key::WheelStart, Key::HeadstockStop, Key::Rapid50] {
        snapshot.keys[key as usize].lamp = true;
    }
    for key in [Key::HandwheelX, Key::Step001] {
        snapshot.keys[key as usize].lamp = true;
    }
    snapshot.overrides.rapid = 50;
    snapshot.handwheel.step_mm = 0.01;
    snapshot.keys[Key::Lubrication as usize].pending = true;
    let wheel_on = Text::new("砂轮旋转时液压键无效", "no effect while the wheel turns");
    snapshot.keys[Key::Hydraulic as usize].blocked = Some(wheel_on);
    let text = page_text::parse(C0001).map(Arc::new).map_err(|fault| FileFault {
        file: "C0001.TXT".into(),
        position: Some((fault.line, fault.column)),
        message: fault.message,
    });
    let files = ScreenFiles {
        text,
        english_fault: None,
        picture: Ok(picture("B0001.BMP")),
        labels: Vec::new(),
        labels_fault: None,
    };
    snapshot.screens = Arc::new(Screens { pages: vec![(1_001, files)], dressing: Some(Ok(picture("B0100.BMP"))) });
    snapshot.directory = Arc::new(directory());
    for (index, row) in snapshot.offsets.tools.iter_mut().enumerate() {
        row.geometry = DisplayPos::new([-9_999.999 + index as f64, 0.0, -20.0]);
        row.wear = DisplayPos::new([0.01 * index as f64, 0.0, -999.999]);
    }
    snapshot.offsets.active_tool = 4;
    snapshot.dressing_point[Axis::X] = Some(-1_234.567);
    snapshot.modals = ModalView {
        g: [1, 18, 90, 98, 21, 54, 64, 97, 40],
        feed: Some(1_200.0),
        speed: Some(1_260.0),
        tool: (1, 4),
        m: Some(8),
    };
    snapshot.prepared_mdi = "G01 X120.5 Z-35 F300".into();
    snapshot.scope.recording = Arc::new(scope_recording());
    snapshot
}

/// Four seconds of a scope that a rising speed has triggered.
fn scope_recording() -> ScopeRecording {
    let channels = ["X-actual-speed", "X-error", "input:guard-closed", "X-actual"].map(ScopeSignal::from_id);
    let setup = ScopeSetup { channels, span: SCOPE_SPANS[1], trigger: ScopeTrigger::Rising(-120.5) };
    let row = |k: u32| {
        let wave = (f64::from(k) / 400.0).sin();
        [-6_000.0 * wave, -2_854.6 * wave, f64::from(k / 900 % 2), -812.455 + 12.0 * wave]
    };
    ScopeRecording {
        setup,
        period: Micros(1_000),
        cycle: Micros(1_000),
        number: 1,
        x_as_diameter: true,
        trigger_index: 800,
        samples: (0..4_000).map(row).collect(),
    }
}

fn directory() -> Vec<DirectoryRow> {
    let row = |number: u32, size: u64, comment: &str| DirectoryRow {
        name: format!("O{number:04}"),
        number,
        size,
        comment: comment.into(),
        english: None,
        modified: "2026-06-03 15:01".into(),
        kinds: if number == 1_008 { vec![Kind::Gs] } else { Vec::new() },
    };
    let mut rows = vec![
        row(1_001, 1_812, "外卡磨削"),
        row(1_002, 962, "外圆切入磨削"),
        row(1_003, 2_410, "台阶轴磨削"),
        row(1_008, 120_411, "凸轮轴"),
        row(2_000, 640, "试切程序"),
        row(9_000, 310, "一键回退"),
        row(9_001, 330, "回退返回"),
    ];
    rows.extend((3_001..3_020).map(|number| row(number, 1_000 + u64::from(number), "批量件")));
    rows
}

/// An automatic run in its fine stage, X moving.
pub fn running(page: Page) -> Snapshot {
    let mut snapshot = snapshot(page);
    snapshot.mode = Mode::Auto;
    snapshot.state = RunState::Running;
    snapshot.feed_mm_min = 100.0;
    snapshot.axes[Axis::X].moving = true;
    snapshot.axes[Axis::X].work = 39.964;
    snapshot.axes[Axis::X].to_go = -52.464;
    snapshot.program.line = 13;
    snapshot.program.block = Some(90);
    let why = Text::new("自动运行中此键无效", "not active while a program runs");
    for key in Key::ALL {
        let row = key.row();
        snapshot.keys[*key as usize].blocked = (!row.active_in_run).then_some(why);
    }
    snapshot.keys[Key::ModeManual as usize].lamp = false;
    for key in [Key::ModeAuto, Key::CycleStart, Key::HeadstockHigh] {
        snapshot.keys[key as usize].lamp = true;
    }
    snapshot.keys[Key::HeadstockStop as usize].lamp = false;
    snapshot
}

/// A diameter of the simulated part.
fn size(row: u32) -> PartSize {
    let name = LocalizedText::new(format!("直径 Z{row}0.0"), format!("diameter Z{row}0.0"));
    PartSize { kind: SizeKind::Diameter, name, surface: Some(0), mm: 40.012 }
}

/// The part of a cycle that has ended.
pub fn part_result() -> PartResult {
    let nominal = NominalSize { kind: Some(SizeKind::Diameter), mm: 40.0, limits: Some((39.985, 40.005)) };
    let (nominal, ended_at) = (Some(nominal), Micros::from_millis(90_000));
    PartResult {
        number: 12,
        program: 1_001,
        ended_at,
        times: CycleTimes { seconds: 84.3, ..CycleTimes::default() },
        nominal,
        measured: None,
        typed: None,
        gauged: false,
        is_wheel_fresh: true,
        offset: Some(OffsetInForce { number: 1, axis: Axis::X, displayed_per_mm: 2.0, work_zero: 0.0 }),
        corrected: None,
    }
}

fn longest_value(values: OrderValues, variable: u16) -> OrderValues {
    values.with(OrderValue { variable, number: 88_888.888 }).unwrap_or(values)
}

/// Wheels of the shop: on the machine, worn down, after a crash.
fn wheels() -> Vec<WheelRecord> {
    let day = Some(DateTime(1_795_273_316));
    let wheel = WheelRecord {
        number: 1,
        diameter_mm: 600.0,
        width_mm: 20.0,
        rated_m_s: 35.0,
        dressings: 114,
        is_mounted: true,
        mounted: day,
        balanced: day,
        ..WheelRecord::default()
    };
    let beside = WheelRecord { number: 7, diameter_mm: 480.125, smallest_mm: 480.5, is_mounted: false, ..wheel };
    let crashed = WheelRecord { number: 99, crashes: 12, crashed: day, balanced: None, is_suspect: true, ..beside };
    vec![wheel, beside, crashed]
}

/// Orders of a shop: one is being made, one waits, one is closed.
fn orders() -> Vec<ProductionOrder> {
    let order = |number, program, target, (good, bad), state| ProductionOrder {
        number,
        program,
        target,
        good,
        bad,
        state,
        after: 2,
        values: OrderValues::default(),
    };
    vec![
        order(26_110_501, 1_001, 250, (37, 1), OrderState::Active),
        order(26_110_502, 1_002, 40, (0, 0), OrderState::Waiting),
        order(26_110_488, 1_004, 120, (120, 0), OrderState::Closed),
    ]
}

/// Forty parts that scatter by some micrometres; one is bad.
fn part_history() -> PartHistory {
    let scatter = [0.4, -1.2, 0.8, 1.6, -0.6, -1.9, 1.1, 0.2, -0.9, 1.3];
    let part = |count: u64| {
        let size = 39.995 + 1e-3 * (scatter[count as usize % 10] + if count == 17 { 14.0 } else { 0.0 });
        PartRecord {
            count,
            number: count as u32,
            program: 1_001,
            order: if count > 2 { 26_110_501 } else { 0 },
            ended: DateTime(1_795_273_316 + 90 * count as i64),
            cycle_seconds: 84.3 + scatter[(count as usize + 3) % 10],
            size: Some(size),
            limits: Some([40.0, 39.985, 40.005]),
            verdict: if count == 17 { PartVerdict::Out { partly: false } } else { PartVerdict::Good },
            since_dressing: count as u32 % 10 + 1,
            wheel_mm: None,
            alarms: [0; 4],
        }
    };
    PartHistory::new((1..=40).map(part), 2)
}

/// The day of the sample's parts: on from 5 to 15 o'clock.
fn hour_history() -> HourHistory {
    let midnight = HourRecord::hour_of(DateTime(1_795_273_316)).unwrap_or_default() / 24 * 24;
    let hour = |of_day: u64| HourRecord {
        hour: midnight + of_day,
        seconds: match of_day {
            5 => [0, 0, 0, 1_500],
            9 => [1_900, 0, 1_200, 500],
            12 => [600, 2_400, 0, 600],
            _ => [3_000, 240, 0, 360],
        },
        explained: if of_day == 12 { [1_800, 0, 0, 0, 300, 0] } else { [0; 6] },
        good: if of_day == 5 { 0 } else { 35 },
        bad: u32::from(of_day == 9),
    };
    HourHistory::new((5..16).map(hour), 2)
}

/// A simulated machine, a medium with files, a path: what the pages of work beside the tick show.
pub fn busy(page: Page) -> Snapshot {
    let mut snapshot = running(page);
    snapshot.interrupted = Some((1_001, 12_345));
    snapshot.production = ProductionView {
        parts: part_history(),
        hours: hour_history(),
        downtime_reason: None,
        orders: orders(),
        wheels: wheels(),
    };
    let said = |zh: &str, en: &str| LocalizedText::new(zh, en);
    snapshot.simulated = Some(Arc::new(SimView {
        forced: vec![(Input::HydraulicPressure, true)],
        faults: vec!["drive-x"],
        wheel_diameter_mm: 599.987,
        wheel_dullness: 0.4,
        wheel_load_percent: 63.0,
        sizes: (0..12).map(size).collect(),
        finished_sizes: vec![size(3)],
        finished_defects: Vec::new(),
        events: vec![said("12.3 s burn", "12.3 s burn")],
        grinding_workspace: None,
        lathe_workspace: None,
    }));
    snapshot.bus = Some(Arc::new(bus(None)));
    snapshot.host.network = Some(Arc::new(network(ServiceState::Listening)));
    let set = |name: &str| match name {
        name if name.starts_with('O') => TransferSet::Programs,
        name if name.ends_with("TAR") => TransferSet::Backup,
        _ => TransferSet::Screens,
    };
    let file = |name: &&str| MediaFile { name: (*name).into(), size: 123_456_789, set: set(name) };
    let files = |names: &[&str]| names.iter().map(file).collect();
    let names = ["O1001.NC", "O1002.NC", "C0001.TXT", "B0001.BMP", "KT830-20261121-101112.TAR"];
    let media = MediaView {
        medium_folder: Some("/media/usb".into()),
        free_bytes: Some(7_987_654_321),
        medium_files: files(&names),
        control_files: files(&names[..4]),
        port: Some("/dev/ttyUSB0".into()),
        ports: vec!["/dev/ttyS0".into(), "/dev/ttyUSB0".into()],
    };
    let mut drawing = Toolpath {
        number: snapshot.program.number,
        length_mm: 123_456.7,
        cycle_time: CycleTime::Simulated(36_061.0),
        lines: 1_000_000,
        extents: Some((WorkPos::new([-371.54, -1.0, -139.08]), WorkPos::new([371.54, 1_000.0, 139.08]))),
        finished: true,
        ..Toolpath::default()
    };
    let at = |x: f32, z: f32, way: MoveKind| PathPoint { at: [x, 0.0, z], kind: way };
    drawing.set_path(vec![
        at(0.0, 0.0, MoveKind::Break),
        at(-371.54, -139.08, MoveKind::Rapid),
        at(371.54, 139.08, MoveKind::Feed),
    ]);
    snapshot.files = Arc::new(FilesView {
        media: Some(Arc::new(media)),
        toolpath: Some(Arc::new(drawing)),
        busy: Some((Text::new("正在复制", "copying"), 437)),
        ..(*snapshot.files).clone()
    });
    let corner = |x, y, z| WorkPos::new([x, y, z]);
    snapshot.stock =
        Arc::from([StockBox { low: corner(-20.0, 0.0, 0.0), high: corner(20.0, 10.0, 60.0), is_workpiece: true }]);
    snapshot
}

/// A description of a machine, as its page shows it.
fn description() -> Arc<[DescriptionLine]> {
    let of_drive = |number: u16, axis: char| {
        let property = |zh, en, value: &str| DescriptionLine::Property(Text::new(zh, en), value.to_owned());
        [
            DescriptionLine::Heading(LocalizedText::same(&format!("{number}  drive {axis}"))),
            property("厂商 / 产品 / 版本", "vendor / product / revision", "1DDh / 10305070h / –"),
            property("输出", "outputs", "6040h 16  607Ah 32  6060h 8  – 8  (8 B)"),
            property("输入", "inputs", "6041h 16  6064h 32  603Fh 16  6061h 8  – 8  6077h 16  (12 B)"),
            property("启动时写入", "written at the start", "60C2h:01 = 1  60C2h:02 = -3"),
            property("配置", "set up", "PDO  SYNC0"),
        ]
    };
    (1..).zip(['X', 'Z', 'C', 'U']).flat_map(|(number, axis)| of_drive(number, axis)).collect()
}

/// A field bus in operation, or with a fault: the last two devices do not answer then, and a drive has tripped.
pub fn bus(fault: Option<LocalizedText>) -> BusView {
    let broken = fault.is_some();
    let drive = |axis: Axis| {
        let tripped = broken && axis == Axis::Z;
        let state = if tripped { DriveState::Fault(DriveFault(0x8611)) } else { DriveState::Enabled };
        BusDrive {
            axis,
            state: state.text(),
            tripped,
            raw_count: Some(-1_234_567),
            torque_percent: (!broken).then_some(-37.5),
        }
    };
    let names = ["drive X", "drive Z", "coupler", "inputs 1 to 16", "inputs 17 to 32"];
    let more = ["outputs 1 to 16", "outputs 17 to 32", "analog outputs", "handwheel and spindle encoder"];
    let names: Vec<&str> = names.into_iter().chain(more).collect();
    let device = |(index, name): (usize, &&str)| BusDevice {
        name: (*name).to_owned(),
        identity: (0xe000_0830, 0x03b1_1002),
        state: if broken && index + 2 >= names.len() { DeviceState::Missing } else { DeviceState::Operational },
        drive: [Axis::X, Axis::Z].get(index).map(|axis| drive(*axis)),
        ports: match index {
            // The cable between outputs 17 to 32 and what is behind it.
            6 if broken => [
                PortErrors::default(),
                PortErrors { damaged: 12, lost_links: 1 },
                Default::default(),
                Default::default(),
            ],
            _ => Default::default(),
        },
    };
    let times = |median, p99, max| Percentiles { median: Micros(median), p99: Micros(p99), max: Micros(max) };
    let day = |percentiles, counts| TimeDistribution { percentiles, counts };
    let station = BusStation {
        number: 101,
        name: "wheel inverter".to_owned(),
        address: "192.168.1.20:502".to_owned(),
        is_heard: !broken,
        age: Micros::from_millis(if broken { 1_420 } else { 12 }),
        fault: broken.then(|| StationFault::TimedOut.text()),
        failures: 3,
        round_trip: times(1_100, 2_900, 14_200),
    };
    BusView {
        interface: "enp2s0".to_owned(),
        fault,
        devices: names.iter().enumerate().map(device).collect(),
        stations: vec![station],
        cycles: 86_400_000,
        lost: 1_234,
        working_counter: (!broken).then_some((15, 15)),
        execution: day(times(130, 240, 2_100), [0, 0, 120, 8_214_000, 70_105_000, 8_080_000, 800, 14, 1, 0, 0]),
        round_trip: day(times(70, 110, 1_850), [0, 0, 3_400, 85_190_000, 1_200_000, 6_500, 90, 9, 0, 0, 0]),
        wake_up: day(times(20, 90, 12_340), [9_300_000, 41_000_000, 33_000_000, 3_090_000, 9_950, 640, 31, 4, 2, 0, 1]),
        rights: ThreadRights { has_priority: true, has_locked_memory: !broken, core: Some((3, true)) },
        clock: Some(BusClock {
            distance: day(
                times(10, 80, 410),
                [44_000_000, 39_100_000, 2_100_000, 1_190_000, 8_700, 420, 0, 0, 0, 0, 0],
            ),
            drift_ppm: -12.4,
        }),
        inverter: Some(BusInverter {
            device: 101,
            rpm: Some(if broken { 0.0 } else { 1_478.6 }),
            load_percent: Some(23.0),
            fault: broken.then(|| LocalizedText::new("17 输出过流", "17 overcurrent at the output")),
        }),
        description: description(),
    }
}

/// A service that somebody uses, or one whose port is in use by another program.
fn network(state: ServiceState) -> NetworkView {
    let is_listening = state == ServiceState::Listening;
    let clients = ["192.168.1.10:40112", "192.168.1.11:51834"].map(str::to_owned);
    let service = |port: u16| ServiceView {
        state: state.clone(),
        address: if is_listening { format!("0.0.0.0:{port}") } else { format!(":{port}") },
        clients: if is_listening { clients.to_vec() } else { Vec::new() },
        sent: 1_234_567,
        refused: 12,
        dropped: 3,
        tls: (port == 8_083).then_some(TlsView { valid_until: Some(DateTime(1_900_000_000)) }),
    };
    // The longest of its faults.
    let lost = LocalizedText::new(
        "服务器断开了连接（同一机床编号 P482 的另一台控制？）",
        "closed by the broker (another control with the same P482?)",
    );
    let mqtt = BrokerView {
        state: if is_listening { BrokerState::Connected } else { BrokerState::Failed(lost) },
        address: "broker.hall-2.example:8883".to_owned(),
        tls: Some(TlsView { valid_until: Some(DateTime(1_900_000_000)) }),
        refuses_topic: false,
        sent: 12_345,
        waiting: 1_012,
        lost: 12_345,
        connections: 3,
    };
    let opcua = OpcUaView {
        address: "opc.tcp://grinder12.hall-2.example:4840/".to_owned(),
        clients: 12,
        untrusted: 500,
        certificate_until: Some(DateTime(2_400_000_000)),
    };
    let opcua = if is_listening { opcua } else { OpcUaView::default() };
    NetworkView { mtconnect: service(7_878), web: service(8_083), mqtt, opcua }
}

/// Hydraulic pressure was lost.
pub fn alarm(page: Page) -> Snapshot {
    let mut snapshot = snapshot(page);
    snapshot.state = RunState::Alarm;
    let said = |zh: &str, en: &str| LocalizedText::new(zh, en);
    snapshot.alarms = vec![
        AlarmView {
            number: 180,
            text: said("砂轮启动时液压异常", "hydraulic pressure missing"),
            cause: said("没有压力信号", "no pressure signal"),
            variable: None,
            remedy: said("检查油泵和压力开关，信号恢复后按复位", "find the leak, press RESET once the signal is back"),
            since: snapshot.now,
            place: None,
        },
        AlarmView {
            number: 66,
            text: said("页面文件不全或格式错误", "page files missing"),
            cause: said("", ""),
            variable: None,
            remedy: said("", ""),
            since: snapshot.now,
            place: None,
        },
    ];
    snapshot
}

/// Two functions on one port, both ways, and a history of alarms.
pub fn troubled(page: Page) -> Snapshot {
    let mut snapshot = alarm(page);
    let mut params = Params::factory(snapshot.kind);
    for (number, value) in [(301, 10.0), (302, 10.0), (332, 3.0), (333, 4.0), (352, 22.0)] {
        let taken = params.write(ParamAddress { number, bit: None }, value);
        assert!(taken.is_ok(), "P{number}");
    }
    // A new wheel that the usual speed is too much for, and the offsets open.
    for (number, bit, value) in [(6, Some(7), 1.0), (22, Some(0), 1.0), (79, None, 30.0)] {
        let taken = params.write(ParamAddress { number, bit }, value);
        assert!(taken.is_ok(), "P{number}");
    }
    snapshot.params = Arc::new(params);
    let past = |number: u16, minutes: u64, gone: Option<u64>| {
        let row = ALARMS.iter().find(|row| row.number == number).unwrap_or(&ALARMS[0]);
        let date = |minutes: u64| DateTime(1_795_273_316 - minutes as i64 * 60);
        let place = number.is_multiple_of(2).then_some((1_001, 13));
        let ended =
            gone.map(|minutes| (if number == 102 { AlarmEnd::Reset } else { AlarmEnd::Itself }, Some(date(minutes))));
        let count = 1_000 - minutes;
        let (cause, remedy) = (SharedWords::default(), SharedWords::default());
        PastAlarm { count, number, text: row.text.into(), cause, remedy, place, came: date(minutes), ended }
    };
    let mut history = vec![past(102, 800, Some(799)), past(0, 200, Some(199)), past(181, 60, Some(58))];
    history.extend((1..40).rev().map(|minutes| past(184, minutes + 1, Some(minutes))));
    history.push(past(180, 0, None));
    snapshot.alarm_history = AlarmHistory::new(history, 1);
    snapshot.date = Some(DateTime(1_795_273_316));
    snapshot.bus = Some(Arc::new(bus(Some(BusFault::DeviceMissing { device: 9 }.text()))));
    let why = LocalizedText::new("端口已被别的程序占用", "the port is in use");
    snapshot.host.network = Some(Arc::new(network(ServiceState::Failed(why))));
    snapshot
}

/// Everything as long as it gets: figures with all their digits, a long name, and the alarm with the most to say.
pub fn long(page: Page) -> Snapshot {
    let mut snapshot = busy(page);
    let most = |value: f64| AxisView {
        decimals: 3,
        present: true,
        work: -value,
        machine: -value,
        relative: -value,
        to_go: -value,
        homed: true,
        moving: true,
    };
    snapshot.axes =
        PerAxis::from_fn(|axis| if snapshot.axes[axis].present { most(9_999.999) } else { AxisView::default() });
    (snapshot.feed_mm_min, snapshot.wheel_rpm, snapshot.parts_counted) = (24_000.0, 99_999.0, 999_999);
    (snapshot.cycle.times.seconds, snapshot.strokes_per_min) = (59_999.0, Some(1_234.5));
    (snapshot.overrides.feed, snapshot.overrides.rapid, snapshot.overrides.spindle) = (150, 100, 120);
    snapshot.keys[Key::SingleBlock as usize].lamp = true;
    let order = |place: u32| ProductionOrder {
        number: 99_999_999 - place,
        program: 9_999,
        target: 999_999,
        good: 888_888,
        bad: 99_999,
        state: if place.is_multiple_of(2) { OrderState::Proposed } else { OrderState::Waiting },
        after: 0,
        values: [521, 522, 523, 524, 531, 532, 533, 534].into_iter().fold(OrderValues::default(), longest_value),
    };
    snapshot.production.orders = (0..MAX_ORDERS as u32).map(order).collect();
    for value in snapshot.variables.iter_mut() {
        *value = Some(-99_999.999);
    }
    let mut rows = Vec::clone(&snapshot.directory);
    rows[0].name = "LAGERRING_INNEN".into();
    rows[0].comment = "轴肩端面磨削: 量仪找基准端面, 砂轮左侧磨端面, 然后外圆切入磨削".into();
    (rows[0].size, snapshot.program.block) = (123_456_789, Some(99_999));
    snapshot.directory = Arc::new(rows);
    let length = |row: &Alarm, lang| row.text.get(lang).len() + row.remedy.get(lang).len();
    let longest = |lang| ALARMS.iter().max_by_key(|row| length(row, lang));
    let view = |row: &Alarm| AlarmView {
        number: row.number,
        text: row.text.into(),
        cause: row.cause.into(),
        remedy: row.remedy.into(),
        variable: Some(999),
        since: snapshot.now,
        place: Some((9_999, 999_999)),
    };
    snapshot.alarms = [Lang::En, Lang::Zh].into_iter().filter_map(longest).map(view).collect();
    snapshot.alarms.reverse();
    snapshot
}

/// The core has refused something just now.
pub fn refused(page: Page) -> Snapshot {
    let mut snapshot = snapshot(page);
    let text = LocalizedText::new("头架旋转时尾座不能动作", "the tailstock is locked while the headstock turns");
    snapshot.message = Message { text, tone: Tone::Refused, since: snapshot.now };
    snapshot
}
