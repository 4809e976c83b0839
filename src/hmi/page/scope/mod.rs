//! Scope page: up to four signals, recorded by the core cycle by cycle; cursor, zoom, trigger, CSV; roundness of a circle,
//! response to a step.
//! Source: issue "a real machine", part 6; H9.

mod curves;
mod figures;
mod roundness;
mod signal_list;
mod step_response;

use std::fmt::Write;

use egui::accesskit::Role;
use egui::{Id, Rect, Sense, WidgetInfo, vec2};

use super::{PageContext, PageUi};
use crate::defs::scope_signal::ScopeSignal;
use crate::defs::text::Text;
use crate::hmi::{Area, EditKey, FieldEditor, KeyboardFocus, PageKey, View, file_command, theme, widget};
use crate::link::files::{FileRequest, Requester};
use crate::link::page_command::PageCommand;
use crate::link::scope::{
    DIGITAL_LEVEL, SCOPE_CHANNELS, SCOPE_SPANS, ScopeCommand, ScopeRecording, ScopeSetup, ScopeState, ScopeTrigger,
};
use crate::link::{Command, Snapshot};
use curves::CurveWindow;
use signal_list::SignalList;

/// Width of the names and values of the channels.
const NAMES_WIDTH: f32 = 178.0;
/// Least number of samples that are shown.
const MIN_SAMPLES_SHOWN: f64 = 20.0;
/// How much closer a key shows the curves.
const KEY_ZOOM: f64 = 2.0;

/// What the page shows of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Evaluation {
    /// Its curves.
    Curves,
    /// The roundness of a circle.
    Roundness,
    /// How an axis follows a move.
    Step,
}

impl Evaluation {
    /// Another one, or the curves again.
    fn toggled(self, other: Self) -> Self {
        if self == other { Self::Curves } else { other }
    }
}

/// State of the page.
#[derive(Debug)]
pub struct ScopePage {
    setup: ScopeSetup,
    /// Number of the recording that the page has shown last.
    seen: u32,
    /// The shown part of the recording.
    window: CurveWindow,
    /// The sample at the cursor.
    cursor: Option<usize>,
    /// The channel whose signal is being chosen.
    choosing: Option<(usize, SignalList)>,
    /// Why the last key did nothing.
    hint: Option<Text>,
    /// What the page shows of the recording.
    shown_as: Evaluation,
    /// The level of the trigger that is being typed.
    typing: FieldEditor,
    walk: KeyboardFocus,
}

impl Default for ScopePage {
    fn default() -> Self {
        Self {
            setup: ScopeSetup { span: SCOPE_SPANS[1], ..ScopeSetup::default() },
            seen: 0,
            hint: None,
            window: CurveWindow::default(),
            cursor: None,
            choosing: None,
            shown_as: Evaluation::Curves,
            typing: FieldEditor::default(),
            walk: KeyboardFocus::default(),
        }
    }
}

impl PageUi for ScopePage {
    fn open(&mut self, view: &View<'_>, _handed_over: Option<super::HandOver>) {
        self.choosing = None;
        if self.setup.channels.iter().all(Option::is_none) {
            self.setup.channels = first_signals(view);
        }
    }

    fn close(&mut self) {
        self.choosing = None;
        self.typing.clear();
    }

    fn record(&mut self, snapshot: &Snapshot) {
        let recording = &snapshot.scope.recording;
        // A new recording, of this page or of a story, shows its own signals. After power-on there is none.
        if self.seen != recording.number {
            self.seen = recording.number;
            (self.window, self.cursor) = (CurveWindow::default(), None);
            if recording.number > 0 {
                self.setup = recording.setup;
            }
        }
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, out, .. } = ctx;
        if let Some((channel, mut list)) = self.choosing.take() {
            match list.ui(rect, view, typed) {
                signal_list::Answer::Open => self.choosing = Some((channel, list)),
                signal_list::Answer::Chosen(signal) => self.choose(channel, signal),
                signal_list::Answer::Cancelled => {}
            }
            return;
        }
        if !typed.edits.is_empty() {
            self.hint = None;
        }
        // With a cursor the arrows belong to the curves: to the sides sample by sample, up and down closer and wider.
        let (steps, others): (Vec<EditKey>, Vec<EditKey>) = typed.edits.iter().partition(|edit| {
            self.has_cursor() && matches!(edit, EditKey::Left | EditKey::Right | EditKey::Up | EditKey::Down)
        });
        self.cursor_keys(view, &steps);
        let others = self.type_level(others);
        self.walk.begin_frame(&others);
        if others.contains(&EditKey::Cancel) {
            self.cursor = None;
        }
        let (body, keys) = rect.shrink2(vec2(theme::PAD, 6.0)).split_bottom(widget::KEYS_HEIGHT);
        let (heading, body) = body.trim_bottom(theme::GAP).split_top(26.0);
        self.heading(heading, view);
        match self.shown_as {
            Evaluation::Curves => self.channels(body, view),
            Evaluation::Roundness => roundness::ui(body, view, self.shown(view), self.window),
            Evaluation::Step => step_response::ui(body, view, self.shown(view), self.window),
        }
        self.keys(keys, view, out);
    }
}

/// Speed and following error of the first two axes.
fn first_signals(view: &View<'_>) -> [Option<ScopeSignal>; SCOPE_CHANNELS] {
    use crate::defs::scope_signal::AxisQuantity::{ActualSpeed, FollowingError};
    let mut signals = view.axes().flat_map(|axis| [ActualSpeed, FollowingError].map(|of| ScopeSignal::Axis(axis, of)));
    std::array::from_fn(|_| signals.next())
}

impl ScopePage {
    /// Digits are the level of the trigger, which INPUT takes; returns the other keys.
    fn type_level(&mut self, mut edits: Vec<EditKey>) -> Vec<EditKey> {
        let is_analog = self.setup.channels[0].is_some_and(|signal| !signal.is_digital());
        edits.retain(|edit| match edit {
            _ if !is_analog => true,
            EditKey::Enter | EditKey::Cancel if self.typing.text.is_empty() => true,
            EditKey::Enter => {
                self.take_typed_level();
                false
            }
            edit => !self.typing.handle_key(*edit),
        });
        edits
    }

    fn take_typed_level(&mut self) {
        let Some(level) = self.typing.text.parse().ok().filter(|level: &f64| level.is_finite()) else {
            self.hint = Some(Text::new("触发值应为数值", "the level must be a number"));
            return;
        };
        self.set_level(level);
        self.typing.clear();
    }

    /// Triggers at a level: a falling edge stays one.
    const fn set_level(&mut self, level: f64) {
        self.setup.trigger = match self.setup.trigger {
            ScopeTrigger::Now | ScopeTrigger::Rising(_) => ScopeTrigger::Rising(level),
            ScopeTrigger::Falling(_) => ScopeTrigger::Falling(level),
        };
    }

    /// Whether the curves are shown with a cursor.
    fn has_cursor(&self) -> bool {
        self.cursor.is_some() && self.shown_as == Evaluation::Curves
    }

    fn cursor_keys(&mut self, view: &View<'_>, keys: &[EditKey]) {
        let Some(count) = self.shown(view).map(|recording| recording.samples.len()) else { return };
        for key in keys {
            match key {
                EditKey::Up | EditKey::Down => {
                    let factor = if *key == EditKey::Up { KEY_ZOOM } else { KEY_ZOOM.recip() };
                    self.window.zoom_at(count, factor, self.cursor);
                }
                _ => {
                    let by = if *key == EditKey::Right { 1 } else { -1 };
                    self.cursor = self.cursor.map(|at| at.saturating_add_signed(by).min(count - 1));
                }
            }
        }
    }

    fn choose(&mut self, channel: usize, signal: Option<ScopeSignal>) {
        self.setup.channels[channel] = signal;
        if channel == 0 {
            let level = if signal.is_some_and(ScopeSignal::is_digital) { DIGITAL_LEVEL } else { 0.0 };
            self.setup.trigger = match self.setup.trigger {
                ScopeTrigger::Now => ScopeTrigger::Now,
                ScopeTrigger::Rising(_) => ScopeTrigger::Rising(level),
                ScopeTrigger::Falling(_) => ScopeTrigger::Falling(level),
            };
        }
    }

    /// The recording, if it is of the signals that the page shows.
    fn shown<'a>(&self, view: &View<'a>) -> Option<&'a ScopeRecording> {
        let recording = &*view.snapshot.scope.recording;
        let fits = recording.setup.channels == self.setup.channels;
        (fits && !recording.samples.is_empty()).then_some(recording)
    }

    /// What the scope does, the shown time, the time at the cursor.
    fn heading(&self, rect: Rect, view: &View<'_>) {
        let state = match view.snapshot.scope.state {
            ScopeState::Idle => view.text("未记录", "not recording"),
            ScopeState::Armed => view.text("等待触发…", "waiting for the trigger…"),
            ScopeState::Recording => view.text("正在记录…", "recording…"),
        };
        let is_busy = view.snapshot.scope.state != ScopeState::Idle;
        let ink = if is_busy { view.theme.run } else { view.theme.muted };
        let mut taken = view.fit_left(rect, state, theme::LABEL, ink);
        let told = match self.hint {
            Some(hint) => Some((hint.get(view.lang).to_owned(), view.theme.hold)),
            None => self.trigger_words(view).map(|words| (words, view.theme.text)),
        };
        if let Some((words, ink)) = told {
            let rest = rect.with_min_x(taken.max.x + 2.0 * theme::GAP);
            taken = view.fit_left(rest, &words, theme::LABEL, ink);
        }
        let Some(recording) = self.shown(view) else { return };
        let (from, to) = self.window.range(recording.samples.len());
        let mut words = format!("{:.3} … {:.3} s", recording.seconds(from), recording.seconds(to));
        if let Some(at) = self.cursor.filter(|at| *at < recording.samples.len()) {
            words = format!("{} {:.3} s  ·  {words}", view.text("游标", "cursor"), recording.seconds(at));
        }
        let rest = rect.with_min_x(taken.max.x + theme::GAP);
        view.fit_right(rest, &words, theme::LABEL, view.theme.text);
    }

    /// Edge and level of the trigger.
    fn trigger_words(&self, view: &View<'_>) -> Option<String> {
        let signal = self.setup.channels[0].filter(|signal| !signal.is_digital())?;
        if !self.typing.text.is_empty() {
            return Some(format!("{} {}_", view.text("触发值", "level"), self.typing.text));
        }
        let level = curves::number(signal, self.level()?);
        let unit = signal.unit(view.snapshot.x_as_diameter);
        Some(format!("{} {} {level} {unit}", view.text("触发", "trigger"), self.setup.trigger.arrow()))
    }

    /// Name and value of each channel in front of its curve.
    fn channels(&mut self, rect: Rect, view: &View<'_>) {
        let recording = self.shown(view);
        self.drag(rect.trim_left(NAMES_WIDTH), view, recording.map_or(0, |recording| recording.samples.len()));
        let height = rect.height() / SCOPE_CHANNELS as f32;
        for channel in 0..SCOPE_CHANNELS {
            let lane = rect.band(channel as f32 * height, height - 4.0);
            let (names, plot) = lane.split_left(NAMES_WIDTH - 4.0);
            if self.name(names, view, recording, channel) {
                let list = SignalList::new(self.setup.channels[channel]);
                self.choosing = Some((channel, list));
            }
            let plot = plot.trim_left(4.0);
            view.card(plot);
            if let (Some(recording), Some(signal)) = (recording, self.setup.channels[channel]) {
                let (window, cursor) = (self.window, self.cursor);
                let level = self.level().filter(|_| channel == 0);
                let lane = curves::Lane { window, cursor, channel, signal, level };
                curves::paint(plot.shrink(3.0), view, recording, &lane);
            } else if channel == 0 && recording.is_none() {
                let words = view.text("按 记录 记录这些信号", "RECORD records these signals");
                crate::hmi::page::empty::note(view, plot, words);
            }
        }
    }

    /// The name of a channel as a key; true if it is touched.
    fn name(&mut self, rect: Rect, view: &View<'_>, recording: Option<&ScopeRecording>, channel: usize) -> bool {
        let signal = self.setup.channels[channel];
        let words = self.channel_name(view, channel);
        let name = format!("{words} scope-channel-{}", channel + 1);
        let response = view.touch_row(rect, ("scope-channel", channel), false, name);
        crate::hmi::keycap::plate(view, rect, &response);
        let (chosen, entered) = self.walk.item();
        if chosen {
            view.frame(rect, view.theme.focus);
        }
        let inside = rect.shrink2(vec2(8.0, 4.0));
        let line = inside.height() / 3.0;
        let colour = curves::colour(view, channel);
        view.fit_left(inside.band(0.0, line), &words, theme::LABEL, colour);
        if let (Some(signal), Some(recording)) = (signal, recording) {
            let (from, to) = self.window.range(recording.samples.len());
            let at = self.cursor.unwrap_or(to.saturating_sub(1)).min(recording.samples.len() - 1);
            let unit = signal.unit(recording.x_as_diameter);
            let value = format!("{} {unit}", curves::number(signal, recording.samples[at][channel]));
            view.fit_left(inside.band(line, line), value.trim_end(), theme::TITLE, view.theme.text);
            if let Some((low, high)) = recording.extremes(channel, from..to).filter(|_| !signal.is_digital()) {
                let words = format!("{} … {}", curves::number(signal, low), curves::number(signal, high));
                view.fit_left(inside.band(2.0 * line, line), &words, theme::SMALL, view.theme.muted);
            }
        }
        response.clicked() || entered
    }

    fn channel_name(&self, view: &View<'_>, channel: usize) -> String {
        match self.setup.channels[channel] {
            Some(signal) => signal.name(view.snapshot.fitted()).get(view.lang).into_owned(),
            None => view.text("无信号", "no signal").to_owned(),
        }
    }

    const fn level(&self) -> Option<f64> {
        match self.setup.trigger {
            ScopeTrigger::Now => None,
            ScopeTrigger::Rising(level) | ScopeTrigger::Falling(level) => Some(level),
        }
    }

    /// A touch sets the cursor, two fingers zoom the time; a finger drags the time, or the cursor where all is shown.
    fn drag(&mut self, plot: Rect, view: &View<'_>, count: usize) {
        let response = view.ui.interact(plot, Id::unique("scope-curves"), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, "曲线 scope-curves"));
        if count == 0 {
            return;
        }
        if response.hovered() || response.dragged() {
            self.window.zoom(count, f64::from(view.zoom_factor()));
        }
        // What is shown whole cannot move: there a finger drags the cursor.
        let is_whole = self.window.is_whole();
        self.window.move_by(-f64::from(widget::drag_delta(&response).x) / f64::from(plot.width().max(1.0)));
        if (response.clicked() || is_whole && response.dragged())
            && let Some(at) = response.interact_pointer_pos()
        {
            let share = f64::from((at.x - plot.min.x) / plot.width().max(1.0));
            self.cursor = Some(self.window.sample_at(count, share));
        }
    }

    fn keys(&mut self, rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
        let is_busy = view.snapshot.scope.state != ScopeState::Idle;
        let span = format!("{} {}", view.text("时长", "SPAN"), span_words(self.setup.span.as_secs_f64()));
        let trigger = format!("{} {}", view.text("触发", "TRIG"), self.setup.trigger.arrow());
        let start = if is_busy { view.text("结束", "END") } else { view.text("记录", "RECORD") };
        let has_cursor = self.shown(view).is_some() && self.cursor.is_some();
        let keys = [
            PageKey::new("scope-start", start).on(is_busy),
            PageKey::new("scope-span", &span),
            PageKey::new("scope-trigger", &trigger).on(self.level().is_some()),
            PageKey::new("scope-level", view.text("触发值", "LEVEL")).locked(!has_cursor),
            PageKey::new("scope-all", view.text("全部", "FIT")),
            PageKey::new("scope-round", view.text("圆度", "ROUND")).on(self.shown_as == Evaluation::Roundness),
            PageKey::new("scope-step", view.text("阶跃", "STEP")).on(self.shown_as == Evaluation::Step),
            PageKey::new("scope-export", view.text("存为 CSV", "SAVE CSV")).locked(self.shown(view).is_none()),
        ];
        if let Some(key) = self.walk.keys(view, rect, &keys) {
            self.act(key, view, out);
        }
    }

    /// One of the keys, in their order.
    fn act(&mut self, key: usize, view: &View<'_>, out: &mut Vec<Command>) {
        let send = |command| Command::Page(PageCommand::Scope(command));
        self.hint = None;
        let shown = self.shown(view);
        let at_cursor = shown.zip(self.cursor).and_then(|(shown, at)| Some(shown.samples.get(at)?[0]));
        match key {
            0 if view.snapshot.scope.state != ScopeState::Idle => out.push(send(ScopeCommand::Stop)),
            0 => out.push(send(ScopeCommand::Start(self.setup))),
            1 => {
                let next = SCOPE_SPANS.into_iter().find(|span| *span > self.setup.span);
                self.setup.span = next.unwrap_or(SCOPE_SPANS[0]);
            }
            2 => {
                let is_digital = self.setup.channels[0].is_some_and(ScopeSignal::is_digital);
                let level = if is_digital { DIGITAL_LEVEL } else { at_cursor.unwrap_or(0.0) };
                self.setup.trigger = match self.setup.trigger {
                    ScopeTrigger::Now => ScopeTrigger::Rising(level),
                    ScopeTrigger::Rising(level) => ScopeTrigger::Falling(level),
                    ScopeTrigger::Falling(_) => ScopeTrigger::Now,
                };
            }
            3 => {
                let Some(level) = at_cursor else {
                    self.hint = Some(Text::new("先点曲线放游标", "touch the curves first: the cursor gives the level"));
                    return;
                };
                self.set_level(level);
            }
            4 => (self.window, self.cursor) = (CurveWindow::default(), None),
            5 => self.shown_as = self.shown_as.toggled(Evaluation::Roundness),
            6 => self.shown_as = self.shown_as.toggled(Evaluation::Step),
            _ => {
                let table = shown.map(|shown| FileRequest::SaveTable(csv(shown)));
                if table.is_none() {
                    self.hint = Some(Text::new("还没有记录", "nothing has been recorded yet"));
                }
                out.extend(table.map(|table| file_command(Requester::Screen, table)));
            }
        }
    }
}

/// A time as a key shows it.
fn span_words(seconds: f64) -> String {
    if seconds < 60.0 { format!("{seconds} s") } else { format!("{:.0} min", seconds / 60.0) }
}

/// One line per sample: seconds after the trigger, then the channels by their words.
fn csv(recording: &ScopeRecording) -> String {
    let used: Vec<(usize, ScopeSignal)> =
        recording.setup.channels.into_iter().enumerate().filter_map(|(at, signal)| Some((at, signal?))).collect();
    let heads: String = used.iter().map(|(_, signal)| format!(",{}", head(*signal, recording.x_as_diameter))).collect();
    let mut text = format!("seconds{heads}\r\n");
    for (index, row) in recording.samples.iter().enumerate() {
        let values: String =
            used.iter().map(|(at, signal)| format!(",{}", curves::number(*signal, row[*at]))).collect();
        // Writing to a string does not fail.
        let _ = write!(text, "{:.4}{values}\r\n", recording.seconds(index));
    }
    text
}

/// The head of a column: the word of the signal and its unit.
fn head(signal: ScopeSignal, x_as_diameter: bool) -> String {
    let unit = signal.unit(x_as_diameter);
    if unit.is_empty() { signal.id() } else { format!("{} {unit}", signal.id()) }
}
