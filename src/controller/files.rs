//! File and calculation requests of pages: whether they are allowed now, and their results. The background thread
//! does the work, one request at a time; requests that only read are also accepted in between.
//! Source: spec B6, K6.2, K7.8.

use std::sync::Arc;

use super::{Controller, Effect, Programs};
use crate::defs::alarm;
use crate::defs::date::Date;
use crate::defs::key::Mode;
use crate::defs::kind::Kind;
use crate::defs::param::{self, Params};
use crate::defs::text::{Said, Text};
use crate::link::drawing::StockBox;
use crate::link::files::{Deed, FileAnswer, FileRequest, FilesView, Refusal, Restored, Ticket};
use crate::link::media::{Direction, Set, Transfer};
use crate::link::snapshot::{Snapshot, Tone};
use crate::nc::{Frames, Memory, REFERENCES, Settings};
use crate::units::PerAxis;

/// Programs whose editing is protected by P23.5.
const GUARDED_SUBPROGRAMS: std::ops::RangeInclusive<u32> = 9_000..=9_999;

const BUSY: Text = Text::new("上一项工作未完成，请稍候或取消", "the work before is not done: wait or cancel it");
const EDIT_MODE: Text = Text::new("先按面板上的 编辑 键", "press EDIT on the panel first");
const IN_RUN: Text = Text::new("程序运行中不能编辑程序", "programs are not edited while one runs");

const CARRY_IN_RUN: Text = Text::new("程序运行中不能读入", "nothing is taken in while a program runs");

/// One job for the background thread, with the values of the core that it needs.
#[derive(Clone, Debug)]
pub struct Job {
    /// Returned with every answer.
    pub ticket: Ticket,
    /// The request.
    pub request: FileRequest,
    /// Interpreter settings.
    pub settings: Settings,
    /// The programs.
    pub programs: Arc<Programs>,
    /// Values of the core; only for a transfer.
    pub holdings: Option<Box<Holdings>>,
    /// Initial state of a check run; only for a drawing.
    pub start: Option<Box<Start>>,
    /// Date and time at the machine, for file names; `None` while unknown.
    pub date: Option<Date>,
}

/// The values that the core holds.
#[derive(Clone, Debug)]
pub struct Holdings {
    /// The kind of machine.
    pub kind: Kind,
    /// Parameters.
    pub params: Params,
    /// Variables.
    pub memory: Memory,
    /// Work frames and offsets.
    pub frames: Frames,
}

/// Initial state of a check run.
#[derive(Clone, Debug)]
pub struct Start {
    /// The kind of machine.
    pub kind: Kind,
    /// Parameters: tools and bar of a lathe.
    pub params: Params,
    /// Variables.
    pub memory: Memory,
    /// Work frames and offsets.
    pub frames: Frames,
    /// Work position, radius mm.
    pub position: PerAxis<f64>,
    /// The reference points, machine coordinates.
    pub references: [PerAxis<f64>; REFERENCES],
    /// System variables stored in parameters: number, value.
    pub system: Vec<(u32, f64)>,
    /// Block skip (跳段) is on.
    pub block_skip: bool,
}

impl PartialEq for Job {
    fn eq(&self, other: &Self) -> bool {
        (self.ticket, &self.request) == (other.ticket, &other.request)
    }
}

/// State of the file requests.
#[derive(Clone, Debug, Default)]
pub struct Files {
    view: Arc<FilesView>,
    /// The pending request. Only an answer with the same ticket ends it.
    pending: Option<(Ticket, Box<FileRequest>)>,
    /// Boxes of the workpiece and its fixture, as far as known.
    pub(super) stock: Arc<[StockBox]>,
}

impl Controller {
    /// Executes one request of a page.
    pub(super) fn take_file(&mut self, ticket: Ticket, request: &FileRequest) {
        match request {
            FileRequest::Look { .. }
            | FileRequest::Media
            | FileRequest::Print(_)
            | FileRequest::Table(_)
            | FileRequest::ReadPage { .. } => {
                return self.order(ticket, request);
            }
            FileRequest::Cancel => {
                if self.files.pending.is_some() {
                    self.order(ticket, request);
                }
                return;
            }
            FileRequest::MayEdit(number) => {
                let may = self.may_edit(*number);
                let ready = Deed { said: Said::new("可以编辑", "ready for editing"), saved: None };
                return Arc::make_mut(&mut self.files.view).answer(ticket, may.map(|()| ready));
            }
            _ => {}
        }
        if let Err(refusal) = self.may(request) {
            self.refuse(refusal.said());
            return Arc::make_mut(&mut self.files.view).answer(ticket, Err(refusal));
        }
        if matches!(request, FileRequest::Transfer(transfer) if transfer.set == Set::Serial) {
            // A new transmission clears the alarms of the last one.
            alarm::SERIAL.for_each(|number| self.alarms.clear(number));
        }
        self.files.pending = Some((ticket, Box::new(request.clone())));
        self.order(ticket, request);
    }

    fn order(&mut self, ticket: Ticket, request: &FileRequest) {
        let settings = super::nc_settings(self.kind, &self.params);
        let holdings = matches!(request, FileRequest::Transfer(_)).then(|| {
            let (params, memory, frames) = (self.params.clone(), self.memory.clone(), self.frames.clone());
            Box::new(Holdings { kind: self.kind, params, memory, frames })
        });
        let start = matches!(request, FileRequest::Draw(_)).then(|| {
            let (params, switches) = (&self.params, self.switches);
            Box::new(Start {
                kind: self.kind,
                params: params.clone(),
                memory: self.memory.clone(),
                frames: self.frames.clone(),
                // L3: a lathe program starts at its own zero.
                position: if settings.zero_at_start { PerAxis::default() } else { self.work() },
                references: super::references(params),
                system: super::PARAM_VARIABLES.iter().map(|(row, at)| (row.first, params.get(*at))).collect(),
                block_skip: switches.block_skip,
            })
        });
        let (programs, date) = (Arc::clone(&self.programs), self.calendar.date(self.now));
        let job = Job { ticket, request: request.clone(), settings, programs, holdings, start, date };
        self.effects.push(Effect::Job(Box::new(job)));
    }

    /// Whether a request is allowed now.
    fn may(&self, request: &FileRequest) -> Result<(), Refusal> {
        if self.files.pending.is_some() {
            return Err(Refusal::Because(BUSY.into()));
        }
        match request {
            FileRequest::Save { number, .. } | FileRequest::New(number) | FileRequest::Delete(number) => {
                self.may_edit(*number)
            }
            FileRequest::Record(_) => self.may_write(0),
            // K6.2: a page has the same protection as its program.
            FileRequest::SavePage { page, .. } | FileRequest::TakePicture { page, .. } => self.may_edit(*page),
            FileRequest::Copy { to, .. } => self.may_edit(*to),
            FileRequest::Rename { from, to } => self.may_edit(*from).and_then(|()| self.may_edit(*to)),
            FileRequest::Transfer(transfer) => self.may_carry(transfer),
            FileRequest::ScrewIn(_) if self.run.is_some() => Err(Refusal::Because(CARRY_IN_RUN.into())),
            FileRequest::ScrewIn(_) if !self.pages.is_builder() => Err(Refusal::Builder),
            FileRequest::ScrewIn(_) | FileRequest::ScrewOut(..) => Ok(()),
            FileRequest::MayEdit(_) | FileRequest::Look { .. } | FileRequest::Draw(_) => Ok(()),
            FileRequest::ReadPage { .. } => Ok(()),
            FileRequest::Media | FileRequest::Print(_) | FileRequest::Table(_) | FileRequest::Cancel => Ok(()),
        }
    }

    /// Export is always allowed. Import is refused while a run is open; programs need the program password, parameters
    /// and a full backup the machine builder's password.
    fn may_carry(&self, transfer: &Transfer) -> Result<(), Refusal> {
        if transfer.direction == Direction::Out {
            return Ok(());
        }
        if self.run.is_some() {
            return Err(Refusal::Because(CARRY_IN_RUN.into()));
        }
        match transfer.set {
            Set::Params | Set::Backup if !self.pages.is_builder() => Err(Refusal::Builder),
            Set::Programs | Set::Serial if self.asks_for_programs(transfer) && !self.pages.may_edit_programs() => {
                Err(Refusal::Password)
            }
            Set::Programs | Set::Serial | Set::Screens | Set::Params | Set::Variables | Set::Backup => Ok(()),
        }
    }

    /// Whether an import needs the program password. A program of unknown name may be one of O9000 to O9999.
    fn asks_for_programs(&self, transfer: &Transfer) -> bool {
        let number = |name: &String| name.get(1..5).and_then(|digits| digits.parse::<u32>().ok());
        let guarded = |name: &String| number(name).is_some_and(|number| GUARDED_SUBPROGRAMS.contains(&number));
        let any = transfer.set == Set::Serial || transfer.names.is_empty() || transfer.names.iter().any(guarded);
        self.params.bit(param::PROGRAM_PASSWORD) || (any && self.params.bit(param::SUBPROGRAM_PASSWORD))
    }

    /// Applies the checked values of a file. Parameters in use are left unchanged and listed in the result.
    fn restore(&mut self, restored: &Restored) -> Said {
        let mut kept = Vec::new();
        for (at, value) in &restored.params {
            let same = self.params.read(*at).is_ok_and(|old| old.to_bits() == value.to_bits());
            if same {
                continue;
            }
            self.set_param(*at, *value);
            if self.message.tone == Tone::Refused {
                kept.push(at.to_string());
            }
        }
        for (number, value) in &restored.variables {
            self.set_variable(*number, Some(*value));
        }
        for (number, geometry, wear) in &restored.offsets {
            (self.frames.geometry[number - 1], self.frames.wear[number - 1]) = (*geometry, *wear);
            self.effects.push(Effect::Offset { number: *number, geometry: *geometry, wear: *wear });
        }
        for (index, origin) in &restored.frames {
            self.frames.work[*index] = *origin;
            self.effects.push(Effect::Frame(*index, *origin));
        }
        let (params, variables) = (restored.params.len(), restored.variables.len());
        if kept.is_empty() {
            return Said::new(
                format!("已读入：参数 {params} 个，变量 {variables} 个"),
                format!("taken: {params} parameters, {variables} variables"),
            );
        }
        let kept = kept.join(" ");
        Said::new(format!("已读入，正在使用而未改的：{kept}"), format!("taken; in use and left as they are: {kept}"))
    }

    /// Editing needs mode EDIT, no open run, and the password where set (K6.2).
    fn may_edit(&self, number: u32) -> Result<(), Refusal> {
        if self.run.is_none() && self.mode != Mode::Edit {
            return Err(Refusal::Because(EDIT_MODE.into()));
        }
        self.may_write(number)
    }

    /// Writing needs no open run, and the password where set.
    fn may_write(&self, number: u32) -> Result<(), Refusal> {
        if self.run.is_some() {
            return Err(Refusal::Because(IN_RUN.into()));
        }
        let asks = match GUARDED_SUBPROGRAMS.contains(&number) {
            true => param::SUBPROGRAM_PASSWORD,
            false => param::PROGRAM_PASSWORD,
        };
        if self.params.bit(asks) && !self.pages.may_edit_programs() { Err(Refusal::Password) } else { Ok(()) }
    }

    /// Handles an answer of the background thread.
    pub(super) fn hear_file(&mut self, ticket: Ticket, answer: &FileAnswer) {
        match answer {
            FileAnswer::Done(said) => self.done(ticket, said.clone(), None),
            FileAnswer::Saved { said, number, stamp } => self.done(ticket, said.clone(), Some((*number, *stamp))),
            FileAnswer::Restored(_) | FileAnswer::Screw(..) if self.run.is_some() => {
                self.not_done(ticket, Refusal::Because(CARRY_IN_RUN.into()));
            }
            FileAnswer::Restored(restored) => {
                let said = self.restore(restored);
                self.done(ticket, said, None);
            }
            FileAnswer::Screw(axis, table, file) => {
                self.set_screw(*axis, table);
                let points = table.points().len();
                let said = Said::new(
                    format!("{axis} 轴：已从 {file} 读入 {points} 点"),
                    format!("axis {axis}: {points} points from {file}"),
                );
                self.done(ticket, said, None);
            }
            FileAnswer::Drawn(drawing) => {
                self.end_pending(ticket);
                let view = Arc::make_mut(&mut self.files.view);
                view.drawing = Some(Arc::clone(drawing));
                view.answer(ticket, Ok(Deed::default()));
            }
            FileAnswer::Refused(refusal) => self.not_done(ticket, refusal.clone()),
            FileAnswer::Progress(..) | FileAnswer::Bytes(..) => self.note_progress(ticket, answer),
            FileAnswer::Media(media) => {
                if self.files.view.media.as_deref() != Some(media) {
                    Arc::make_mut(&mut self.files.view).media = Some(Arc::new(media.clone()));
                }
            }
            FileAnswer::Looked(looked) => {
                Arc::make_mut(&mut self.files.view).looked = Arc::new(looked.clone());
            }
            FileAnswer::Page(page) => Arc::make_mut(&mut self.files.view).page = Some(Arc::clone(page)),
        }
    }

    fn done(&mut self, ticket: Ticket, said: Said, saved: Option<(u32, u64)>) {
        if let Some(request) = self.end_pending(ticket) {
            if matches!(request, FileRequest::Record(_)) {
                self.teach_kept();
            }
            self.follow_up(&request);
        }
        self.say(said.clone());
        Arc::make_mut(&mut self.files.view).answer(ticket, Ok(Deed { said, saved }));
    }

    fn not_done(&mut self, ticket: Ticket, refusal: Refusal) {
        self.end_pending(ticket);
        match &refusal {
            Refusal::Alarm(number, detail) => self.raise(*number, Some(detail.clone())),
            other => self.refuse(other.said()),
        }
        Arc::make_mut(&mut self.files.view).answer(ticket, Err(refusal));
    }

    /// Ends the pending request if the ticket matches; returns the request.
    fn end_pending(&mut self, ticket: Ticket) -> Option<FileRequest> {
        let (_, request) = self.files.pending.take_if(|(of, _)| *of == ticket)?;
        let view = Arc::make_mut(&mut self.files.view);
        (view.busy, view.bytes) = (None, None);
        Some(*request)
    }

    /// Updates the current program after it was renamed or deleted.
    fn follow_up(&mut self, request: &FileRequest) {
        let current = match request {
            FileRequest::Rename { from, to } if *from == self.current => *to,
            FileRequest::Delete(number) if *number == self.current => 0,
            _ => return,
        };
        self.current = current;
        self.place = crate::nc::Place::default();
        self.effects.push(Effect::CurrentProgram(current));
    }

    /// Shows the progress of the pending request. Late answers to other requests are ignored.
    fn note_progress(&mut self, ticket: Ticket, answer: &FileAnswer) {
        if self.files.pending.as_ref().is_none_or(|(of, _)| *of != ticket) {
            return;
        }
        let view = Arc::make_mut(&mut self.files.view);
        match answer {
            FileAnswer::Progress(what, thousandths) => view.busy = Some((*what, *thousandths)),
            FileAnswer::Bytes(what, bytes) => (view.busy, view.bytes) = (Some((*what, 0)), Some(*bytes)),
            _ => {}
        }
    }

    /// Writes the snapshot fields of file requests.
    pub(super) fn files_view(&self, out: &mut Snapshot) {
        if !Arc::ptr_eq(&out.files, &self.files.view) {
            out.files.clone_from(&self.files.view);
        }
        if !Arc::ptr_eq(&out.stock, &self.files.stock) {
            out.stock.clone_from(&self.files.stock);
        }
    }
}
