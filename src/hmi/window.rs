//! The window: puts the face on a display, feeds it the newest snapshot and sends its commands.
//!
//! A watcher looks at the newest snapshot 30 times a second and asks for a frame only when something shown has changed:
//! the clock once a second, the blink while a lamp does. `Alive` goes with every frame, in half of its time at the latest.

use std::fmt;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use egui::{ViewportBuilder, ViewportCommand, vec2};

use super::app::Hmi;
use super::theme;
use crate::defs::key::Key;
use crate::defs::page::Page;
use crate::defs::text::Lang;
use crate::link::{Command, Snapshot};
use crate::units::PerAxis;

/// How often the watcher looks.
const LOOK: Duration = Duration::from_millis(33);
/// A frame comes at least this often, more often where P76 wants to hear of the screen sooner.
const QUIET: Duration = Duration::from_millis(1_000);
/// Greatest side of a texture, px.
const TEXTURE_SIDE: usize = 2_048;
/// `Alive` is sent at most this often.
const ALIVE: Duration = Duration::from_millis(100);

/// The other end of the screen: where snapshots come from and commands go to.
pub trait Desk: Send {
    /// The newest snapshot; the same one again if nothing newer is there. Must not block.
    fn newest(&mut self) -> Arc<Snapshot>;
    /// Hands a command over. Must not block.
    fn send(&mut self, command: Command);
    /// True when the program is to end and the window to close.
    fn is_over(&mut self) -> bool {
        false
    }
}

/// How the window opens.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Over the whole display; otherwise a window of 1024 × 768.
    pub fullscreen: bool,
    /// Language.
    pub lang: Lang,
    /// The light theme.
    pub light: bool,
    /// Brightness of the picture, percent.
    pub brightness: u8,
}

/// Why there is no window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WindowError {
    /// The computer has no display, or this user may not use it.
    NoDisplay(String),
    /// The display is there, drawing on it failed.
    Graphics(String),
}

impl fmt::Display for WindowError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoDisplay(cause) => write!(f, "no display: {cause}"),
            Self::Graphics(cause) => write!(f, "the display cannot be drawn on: {cause}"),
        }
    }
}

impl std::error::Error for WindowError {}

type Shared = Arc<Mutex<Box<dyn Desk>>>;

/// Opens the window and stays until it is closed.
///
/// # Errors
/// [`WindowError::NoDisplay`] where there is no display, [`WindowError::Graphics`] where it cannot be drawn on.
pub fn run(desk: Box<dyn Desk>, options: Options) -> Result<(), WindowError> {
    let display = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    if cfg!(all(unix, not(target_os = "macos"))) && !display("DISPLAY") {
        return Err(WindowError::NoDisplay("DISPLAY is not set".to_owned()));
    }
    let viewport = ViewportBuilder::default().with_title("KT-830").with_inner_size(vec2(1_024.0, 768.0));
    let viewport = viewport.with_fullscreen(options.fullscreen).with_decorations(!options.fullscreen);
    // Flat colours have no bands to hide, and software OpenGL pays for every pixel.
    let native = eframe::NativeOptions { viewport, dithering: false, ..eframe::NativeOptions::default() };
    let desk: Shared = Arc::new(Mutex::new(desk));
    let over = Arc::new(AtomicBool::new(false));
    let end = Arc::clone(&over);
    let made = eframe::run_native(
        "kt830",
        native,
        Box::new(move |context| {
            let mut hmi = Hmi::new(options.lang);
            hmi.set_light(options.light);
            hmi.set_brightness(options.brightness);
            hmi.install(&context.egui_ctx);
            watch(Arc::clone(&desk), context.egui_ctx.clone(), Arc::clone(&end));
            Ok(Box::new(Window { hmi, desk, fullscreen: options.fullscreen, alive: None, sized: false }))
        }),
    );
    over.store(true, Ordering::Relaxed);
    made.map_err(|error| match error {
        eframe::Error::WinitEventLoop(cause) => WindowError::NoDisplay(cause.to_string()),
        other => WindowError::Graphics(other.to_string()),
    })
}

/// Asks for a frame when something shown has changed, and at least twice a second.
fn watch(desk: Shared, ctx: egui::Context, over: Arc<AtomicBool>) {
    thread::spawn(move || {
        let mut last = 0;
        let mut asked = Instant::now();
        while !over.load(Ordering::Relaxed) {
            thread::sleep(LOOK);
            let (snapshot, closing) = {
                let mut desk = desk.lock().unwrap_or_else(PoisonError::into_inner);
                (desk.newest(), desk.is_over())
            };
            if closing {
                ctx.send_viewport_cmd(ViewportCommand::Close);
                ctx.request_repaint();
                return;
            }
            let now = shown(&snapshot);
            if now != last || asked.elapsed() >= quiet(&snapshot) {
                last = now;
                asked = Instant::now();
                // A repaint asked for with a delay is painted once, `request_repaint` twice.
                ctx.request_repaint_after(Duration::from_millis(1));
            }
        }
    });
}

/// How long a frame may be waited for.
fn quiet(snapshot: &Snapshot) -> Duration {
    let heard_within = snapshot.params.get(crate::defs::param::HMI_KEEP_ALIVE) / 2_000.0;
    QUIET.min(Duration::from_secs_f64(heard_within.clamp(0.05, 10.0)))
}

/// A number that changes when something that a page shows has changed.
#[must_use]
pub fn shown(snapshot: &Snapshot) -> u64 {
    let mut hasher = DefaultHasher::new();
    let h = &mut hasher;
    (snapshot.page as u8, snapshot.mode as u8, snapshot.state as u8, snapshot.kind as u8).hash(h);
    snapshot.date.hash(h);
    for (_, axis) in snapshot.axes.iter() {
        let lengths = [axis.work, axis.machine, axis.relative, axis.to_go];
        lengths.map(|length| (length * 1_000.0).round() as i64).hash(h);
        (axis.present, axis.homed, axis.moving).hash(h);
    }
    let program = &snapshot.program;
    (program.number, program.line, program.block, program.block_program, program.stamp).hash(h);
    (snapshot.single_block, snapshot.handwheel_axis, snapshot.step_mm.to_bits(), snapshot.diameter).hash(h);
    (snapshot.feed_override, snapshot.rapid_override, snapshot.spindle_override, snapshot.parts).hash(h);
    (snapshot.feed_mm_min.round() as i64, snapshot.wheel_rpm.round() as i64, snapshot.cycle_seconds as u64).hash(h);
    if snapshot.key(Key::EmergencyStop).lamp || snapshot.keys.iter().any(|key| key.working) {
        (snapshot.now.0 / 500_000).hash(h);
    }
    for key in &snapshot.keys {
        (key.lamp, key.working, key.blocked.map(|text| text.zh)).hash(h);
    }
    for value in snapshot.variables.iter() {
        value.map(f64::to_bits).hash(h);
    }
    for alarm in &snapshot.alarms {
        (alarm.number, &alarm.text.zh).hash(h);
    }
    (&snapshot.message.text.zh, snapshot.message.since).hash(h);
    snapshot.waiting_for.as_ref().map(|said| &said.zh).hash(h);
    if matches!(snapshot.page, Page::Simulator | Page::Process) {
        snapshot.simulated.as_ref().map(|sim| Arc::as_ptr(sim).addr()).hash(h);
        snapshot.inputs.hash(h);
    }
    if snapshot.page == Page::Diagnosis {
        (snapshot.input_terminals, snapshot.output_terminals, snapshot.inputs, snapshot.outputs).hash(h);
        (snapshot.internals, snapshot.analog_volts.map(|volts| (volts * 100.0).round() as i64)).hash(h);
    }
    typed(snapshot, h);
    let access = snapshot.access;
    (access.level as u8, access.asking, access.answers, snapshot.next_kind as u8).hash(h);
    Arc::as_ptr(&snapshot.files).addr().hash(h);
    (Arc::as_ptr(&snapshot.params).addr(), Arc::as_ptr(&snapshot.alarm_history).addr()).hash(h);
    (Arc::as_ptr(&snapshot.screens).addr(), Arc::as_ptr(&snapshot.directory).addr()).hash(h);
    hasher.finish()
}

/// What the pages show of values: offsets, codes in force, the answer to what was typed.
fn typed(snapshot: &Snapshot, h: &mut DefaultHasher) {
    let bits = |values: &PerAxis<f64>| values.map(f64::to_bits).0;
    for row in &snapshot.offsets {
        (bits(&row.geometry), bits(&row.wear)).hash(h);
    }
    (snapshot.edit.count, snapshot.offset_in_force, &snapshot.mdi_ready).hash(h);
    let modals = &snapshot.modals;
    (modals.g, modals.feed.map(f64::to_bits), modals.speed.map(f64::to_bits), modals.tool, modals.m).hash(h);
    snapshot.dressing_point.map(|at| at.map(f64::to_bits)).0.hash(h);
    snapshot.strokes_min.map(|strokes| (strokes * 10.0).round() as i64).hash(h);
}

/// The shell around the face.
struct Window {
    hmi: Hmi,
    desk: Shared,
    fullscreen: bool,
    alive: Option<Instant>,
    sized: bool,
}

impl Window {
    /// Where no window manager honours full screen, the window takes the size of the monitor by itself.
    fn fill_monitor(&mut self, ctx: &egui::Context) {
        if !self.fullscreen || self.sized {
            return;
        }
        let (monitor, inner) =
            ctx.input(|input| (input.viewport().monitor_size, input.viewport().inner_rect.map(|rect| rect.size())));
        if let (Some(monitor), Some(inner)) = (monitor, inner) {
            self.sized = true;
            if (monitor - inner).length() > 2.0 {
                ctx.send_viewport_cmd(ViewportCommand::OuterPosition(egui::Pos2::ZERO));
                ctx.send_viewport_cmd(ViewportCommand::InnerSize(monitor));
            }
        }
    }

    /// Everything grows with the display (H1).
    fn scale(ctx: &egui::Context) {
        let now = ctx.pixels_per_point();
        let wanted = theme::scale(ctx.viewport_rect().size() * now);
        if (wanted - now).abs() > 0.01 {
            ctx.set_pixels_per_point(wanted);
        }
    }
}

impl eframe::App for Window {
    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        self.hmi.ground().to_normalized_gamma_f32()
    }

    fn raw_input_hook(&mut self, _ctx: &egui::Context, input: &mut egui::RawInput) {
        // The glyphs' texture is as wide as it may be: a narrow one grows in smaller steps.
        input.max_texture_side = input.max_texture_side.map(|side| side.min(TEXTURE_SIDE));
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.fill_monitor(ui.ctx());
        Self::scale(ui.ctx());
        let snapshot = {
            let mut desk = self.desk.lock().unwrap_or_else(PoisonError::into_inner);
            desk.newest()
        };
        let commands = self.hmi.ui(ui, &snapshot);
        let mut desk = self.desk.lock().unwrap_or_else(PoisonError::into_inner);
        for command in commands {
            desk.send(command);
        }
        if self.alive.is_none_or(|sent| sent.elapsed() >= ALIVE) {
            self.alive = Some(Instant::now());
            desk.send(Command::Alive);
        }
    }
}
