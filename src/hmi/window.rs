//! The window: shows the user interface on a display, feeds it the newest snapshot and sends its commands.
//!
//! A watcher thread checks the newest snapshot 30 times a second and requests a frame only if something shown changed
//! ([`super::repaint`]); the pages record every snapshot that it sees. `Alive` is sent with a frame, at least every half of P76.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use egui::{ViewportBuilder, ViewportCommand, vec2};

use super::app::Hmi;
use super::core_fault::{CoreHealth, paint_core_fault};
use super::pointer_finger::PointerFinger;
use super::repaint::LiveScreen;
use super::sound::{self, Beep, SoundWatcher, Speaker};
use super::theme;
use crate::link::{Command, Snapshot};

/// Period of the watcher.
const WATCH_PERIOD: Duration = Duration::from_millis(33);
/// Longest time between two frames; half of P76 if that is shorter.
const MAX_FRAME_INTERVAL: Duration = Duration::from_millis(1_000);
/// Greatest side of a texture, px.
const TEXTURE_SIDE: usize = 2_048;
/// Shortest time between two `Alive`.
const KEEP_ALIVE_INTERVAL: Duration = Duration::from_millis(100);

/// The connection of the screen to the core: source of snapshots, destination of commands.
pub trait CoreConnection: Send {
    /// The newest snapshot; the same one again if there is no newer one. Must not block.
    fn newest(&mut self) -> &Snapshot;
    /// The age of the newest snapshot, and whether the control has failed.
    fn health(&self) -> CoreHealth;
    /// Whether the control was ended from outside, by a signal: the window closes.
    fn is_ended(&self) -> bool;
    /// The window is open and its graphics libraries are loaded.
    fn window_opened(&self);
    /// Sends a command. Must not block.
    fn send(&mut self, command: Command);
}

/// Why the window could not be opened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WindowError {
    /// There is no display, or this user has no access to it.
    #[error("no display: {0}")]
    NoDisplay(String),
    /// Drawing on the display failed.
    #[error("the display cannot be drawn on: {0}")]
    Graphics(String),
}

type SharedConnection = Arc<Mutex<Box<dyn CoreConnection>>>;
type SharedScreen = Arc<Mutex<LiveScreen>>;
type SharedSpeaker = Arc<Mutex<Option<Box<dyn Speaker>>>>;

/// What the watcher of the snapshots works with.
struct Watched {
    core: SharedConnection,
    screen: SharedScreen,
    speaker: SharedSpeaker,
}

/// Opens the window, full screen or 1024 × 768 points large, and returns when it is closed.
///
/// # Errors
/// [`WindowError::NoDisplay`] if there is no display, [`WindowError::Graphics`] if drawing fails.
pub fn run(
    core: Box<dyn CoreConnection>,
    mut hmi: Hmi,
    fullscreen: bool,
    speaker: Option<Box<dyn Speaker>>,
) -> Result<(), WindowError> {
    let display = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    if cfg!(all(unix, not(target_os = "macos"))) && !display("DISPLAY") {
        return Err(WindowError::NoDisplay("DISPLAY is not set".to_owned()));
    }
    let viewport = ViewportBuilder::default().with_title("KT-830").with_inner_size(vec2(1_024.0, 768.0));
    let viewport = viewport.with_fullscreen(fullscreen).with_decorations(!fullscreen);
    // Flat colours show no banding, and dithering costs time per pixel in software OpenGL.
    let native = eframe::NativeOptions { viewport, dithering: false, ..eframe::NativeOptions::default() };
    let core: SharedConnection = Arc::new(Mutex::new(core));
    let speaker: SharedSpeaker = Arc::new(Mutex::new(speaker));
    let over = Arc::new(AtomicBool::new(false));
    let end = Arc::clone(&over);
    let made = eframe::run_native(
        "kt830",
        native,
        Box::new(move |context| {
            hmi.set_fades(true);
            hmi.install(&context.egui_ctx);
            core.lock().unwrap_or_else(PoisonError::into_inner).window_opened();
            let screen = Arc::new(Mutex::new(LiveScreen::new(hmi)));
            let watched =
                Watched { core: Arc::clone(&core), screen: Arc::clone(&screen), speaker: Arc::clone(&speaker) };
            watch_snapshots(watched, context.egui_ctx.clone(), Arc::clone(&end));
            let finger = PointerFinger::default();
            Ok(Box::new(Window { screen, core, fullscreen, alive_sent: None, sized: false, finger, speaker }))
        }),
    );
    over.store(true, Ordering::Relaxed);
    made.map_err(|error| match error {
        eframe::Error::WinitEventLoop(cause) => WindowError::NoDisplay(cause.to_string()),
        other => WindowError::Graphics(other.to_string()),
    })
}

/// Requests a frame when something shown has changed, and after [`max_frame_interval`] at the latest.
fn watch_snapshots(watched: Watched, ctx: egui::Context, over: Arc<AtomicBool>) {
    thread::spawn(move || {
        let Watched { core, screen, speaker } = watched;
        let mut sounds = SoundWatcher::default();
        let mut fault = None;
        let mut asked = Instant::now();
        while !over.load(Ordering::Relaxed) {
            thread::sleep(WATCH_PERIOD);
            let (changed, interval) = {
                let mut core = core.lock().unwrap_or_else(PoisonError::into_inner);
                let snapshot = core.newest();
                beep(&speaker, sounds.follow(snapshot));
                let mut screen = screen.lock().unwrap_or_else(PoisonError::into_inner);
                let (changed, interval) = (screen.follow(snapshot), max_frame_interval(snapshot));
                let before = std::mem::replace(&mut fault, core.health().fault());
                (changed || fault != before || core.is_ended(), interval)
            };
            if changed || asked.elapsed() >= interval {
                asked = Instant::now();
                // A delayed repaint paints one frame, `request_repaint` paints two.
                ctx.request_repaint_after(Duration::from_millis(1));
            }
        }
    });
}

/// Lets something be heard.
fn beep(speaker: &SharedSpeaker, beep: Option<Beep>) {
    let mut speaker = speaker.lock().unwrap_or_else(PoisonError::into_inner);
    if let (Some(speaker), Some(beep)) = (speaker.as_mut(), beep) {
        speaker.play(beep);
    }
}

/// Longest time between two frames.
fn max_frame_interval(snapshot: &Snapshot) -> Duration {
    let heard_within = snapshot.params.get(crate::defs::param::HMI_KEEP_ALIVE) / 2_000.0;
    MAX_FRAME_INTERVAL.min(Duration::from_secs_f64(heard_within.clamp(0.05, 10.0)))
}

/// The eframe application around the user interface.
struct Window {
    screen: SharedScreen,
    core: SharedConnection,
    fullscreen: bool,
    alive_sent: Option<Instant>,
    sized: bool,
    finger: PointerFinger,
    speaker: SharedSpeaker,
}

impl Window {
    /// Sets the window to the size of the monitor if no window manager does it.
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

    /// Scales everything with the display size (H1) and the size that is set.
    fn apply_scale(&self, ctx: &egui::Context) {
        let now = ctx.pixels_per_point();
        // Why the control has failed fills the screen as it is.
        let has_failed = self.core.lock().unwrap_or_else(PoisonError::into_inner).health().fault().is_some();
        let screen = self.screen.lock().unwrap_or_else(PoisonError::into_inner);
        let zoom = if has_failed { 1.0 } else { screen.hmi.zoom() };
        drop(screen);
        let wanted = zoom * theme::scale(ctx.viewport_rect().size() * now);
        if (wanted - now).abs() > 0.01 {
            ctx.set_pixels_per_point(wanted);
        }
    }
}

impl eframe::App for Window {
    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        self.screen.lock().unwrap_or_else(PoisonError::into_inner).hmi.background().to_normalized_gamma_f32()
    }

    fn raw_input_hook(&mut self, _ctx: &egui::Context, input: &mut egui::RawInput) {
        // The glyph texture has the maximum width; limiting it makes the texture grow in smaller steps.
        input.max_texture_side = input.max_texture_side.map(|side| side.min(TEXTURE_SIDE));
        self.finger.translate(&mut input.events);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.fill_monitor(ui.ctx());
        self.apply_scale(ui.ctx());
        let mut core = self.core.lock().unwrap_or_else(PoisonError::into_inner);
        // Reading the newest snapshot renews its age.
        core.newest();
        let mut screen = self.screen.lock().unwrap_or_else(PoisonError::into_inner);
        let fault = core.health().fault();
        let asked_to_close = ui.input(|input| input.viewport().close_requested());
        // A control that has failed or does not answer holds nobody back.
        let may_close = screen.hmi.may_close() || core.is_ended();
        if asked_to_close && fault.is_none() && !may_close {
            ui.ctx().send_viewport_cmd(ViewportCommand::CancelClose);
            screen.hmi.ask_to_close();
        }
        match fault {
            Some(fault) => paint_core_fault(ui, screen.hmi.theme(), fault),
            None => {
                let commands = screen.ui(ui, core.newest());
                beep(&self.speaker, sound::of_commands(&commands, core.newest()));
                commands.into_iter().for_each(|command| core.send(command));
            }
        }
        if (screen.hmi.may_close() || core.is_ended()) && !asked_to_close {
            ui.ctx().send_viewport_cmd(ViewportCommand::Close);
        }
        if self.alive_sent.is_none_or(|sent| sent.elapsed() >= KEEP_ALIVE_INTERVAL) {
            self.alive_sent = Some(Instant::now());
            core.send(Command::KeepAlive);
        }
    }
}
