//! File and calculation requests of pages: whether they are allowed now, and their results. The background thread
//! does the work, one request at a time; requests that only read are also accepted in between.
//! Source: spec B6, K6.2, K7.8.

use super::{Panel, Parts, PartsView};
use crate::controller::plant::Plant;
use crate::controller::plant::system_variables::nc_settings;
use crate::controller::program::lookahead_state::reference_points;
use crate::controller::storage_request::StorageRequest;
pub use crate::controller::storage_request::{BackgroundJob, DrawingStart, TransferValues};
use crate::defs::alarm;
use crate::defs::key::Mode;
use crate::defs::param;
use crate::defs::program_number;
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::link::files::{Completion, FileAnswer, FileRequest, FilesView, Refusal, RestoredValues, Ticket};
use crate::link::media::{Direction, TransferRequest, TransferSet};
use crate::link::page_file::PageTextId;
use crate::link::snapshot::{Snapshot, Tone};
use crate::link::toolpath::StockBox;
use crate::nc::{CutterShape, OriginPlace};
use crate::units::WorkPos;
use std::sync::Arc;

const BUSY: Text = Text::new("上一项工作未完成，请稍候或取消", "the previous job is not finished: wait or cancel it");
const EDIT_MODE: Text = Text::new("先按面板上的 编辑 键", "press EDIT on the panel first");
const IN_RUN: Text = Text::new("程序运行中不能编辑程序", "programs cannot be edited while one runs");

const TRANSFER_IN_RUN: Text = Text::new("程序运行中不能读入", "nothing can be imported while a program runs");

/// State of the file requests.
#[derive(Clone, Debug, Default)]
pub struct FileRequests {
    view: Arc<FilesView>,
    /// The pending request. Only an answer with the same ticket ends it.
    pending: Option<(Ticket, Box<FileRequest>)>,
    /// Boxes of the workpiece and its fixture, as far as known.
    pub(super) stock: Arc<[StockBox]>,
}

impl Panel {
    /// Executes one request of a page.
    pub fn handle_file_request(&mut self, parts: &mut Parts<'_>, ticket: Ticket, request: &FileRequest) {
        match request {
            FileRequest::CheckLines { .. }
            | FileRequest::ListMedia
            | FileRequest::SaveScreenshot(_)
            | FileRequest::SaveTable(_)
            | FileRequest::SaveReport(_)
            | FileRequest::ReadPage { .. } => return self.submit_job(parts, ticket, request),
            FileRequest::Cancel => {
                if self.files.pending.is_some() {
                    self.submit_job(parts, ticket, request);
                }
                return;
            }
            FileRequest::CheckEditable(number) => {
                let may = self.check_program_edit(parts.view(), *number);
                let ready = may.map(|()| phrase!("可以编辑", "ready for editing").into());
                return Arc::make_mut(&mut self.files.view).add_answer(ticket, ready);
            }
            _ => {}
        }
        if let Err(refusal) = self.check_file_request(parts.view(), request) {
            parts.plant.refuse(refusal.message());
            return Arc::make_mut(&mut self.files.view).add_answer(ticket, Err(refusal));
        }
        if matches!(request, FileRequest::Transfer(transfer) if transfer.set == TransferSet::Serial) {
            // A new transmission clears the alarms of the last one.
            alarm::SERIAL_ALARMS.for_each(|number| parts.plant.alarms.clear(number));
        }
        self.files.pending = Some((ticket, Box::new(request.clone())));
        self.submit_job(parts, ticket, request);
    }

    fn submit_job(&mut self, parts: &mut Parts<'_>, ticket: Ticket, request: &FileRequest) {
        let plant = &*parts.plant;
        let (kind, params, work) = (plant.kind, &plant.params, &plant.work);
        let settings = nc_settings(kind, params);
        let (memory, work_offsets) = (|| work.variables.clone(), || work.offsets.clone());
        let transfer_values = matches!(request, FileRequest::Transfer(_)).then(|| {
            let (memory, work_offsets) = (memory(), work_offsets());
            Box::new(TransferValues { kind, params: params.clone(), memory, work_offsets })
        });
        let start = matches!(request, FileRequest::ComputeToolpath(_)).then(|| {
            Box::new(DrawingStart {
                kind,
                params: params.clone(),
                memory: memory(),
                work_offsets: work_offsets(),
                // L3: a lathe program starts at its own zero.
                position: if settings.start_is_work_zero { WorkPos::default() } else { plant.work_position() },
                reference_points: reference_points(params),
                dress_points: work.dress_points,
                block_skip: plant.operator.switches.block_skip,
            })
        });
        let (programs, date) = (Arc::clone(&work.programs), self.calendar.date(plant.now));
        let subprograms_locked = params.bit(param::SUBPROGRAM_PASSWORD) && !self.access.may_edit_programs();
        let request = request.clone();
        let job =
            BackgroundJob { ticket, request, settings, programs, subprograms_locked, transfer_values, start, date };
        parts.plant.store(StorageRequest::Job(Box::new(job)));
    }

    /// Whether a request is allowed now.
    fn check_file_request(&self, parts: PartsView<'_>, request: &FileRequest) -> Result<(), Refusal> {
        if self.files.pending.is_some() {
            return Err(Refusal::Other(BUSY.into()));
        }
        match request {
            FileRequest::Save { number, .. } | FileRequest::Delete(number) => self.check_program_edit(parts, *number),
            FileRequest::New(number) => self.check_new_program(parts, *number),
            FileRequest::SaveRecording(_) => self.check_program_write(parts, 0),
            // K6.2: a page has the same protection as its program.
            FileRequest::SavePage { id: PageTextId { page, .. }, .. }
            | FileRequest::ImportPicture { page, .. }
            | FileRequest::SavePictureLabels { page, .. } => self.check_program_edit(parts, *page),
            FileRequest::Copy { to, .. } => self.check_new_program(parts, *to),
            FileRequest::Rename { from, to } => {
                self.check_program_edit(parts, *from).and_then(|()| self.check_new_program(parts, *to))
            }
            FileRequest::Transfer(transfer) => self.check_transfer(parts, transfer),
            FileRequest::ImportLeadscrew(_) if parts.program.is_open() => Err(Refusal::Other(TRANSFER_IN_RUN.into())),
            FileRequest::ImportLeadscrew(_) if !self.access.is_builder() => Err(Refusal::Builder),
            FileRequest::ImportLeadscrew(_) | FileRequest::ExportLeadscrew(..) => Ok(()),
            FileRequest::CheckEditable(_) | FileRequest::CheckLines { .. } | FileRequest::ComputeToolpath(_) => Ok(()),
            FileRequest::ReadPage { .. } | FileRequest::ListMedia | FileRequest::Cancel => Ok(()),
            FileRequest::SaveScreenshot(_) | FileRequest::SaveTable(_) | FileRequest::SaveReport(_) => Ok(()),
        }
    }

    /// Whether a program may get a number: one that other programs can call (P418).
    fn check_new_program(&self, parts: PartsView<'_>, number: u32) -> Result<(), Refusal> {
        let most = nc_settings(parts.plant.kind, &parts.plant.params).program_limit;
        if number > most {
            return Err(Refusal::Other(phrase!(
                "程序号应为 1-{most}，位数由 P418 定",
                "program numbers are 1 to {most}; P418 has their digits",
                most = most
            )));
        }
        self.check_program_edit(parts, number)
    }

    /// Export is always allowed. Import is refused while a run is open; programs need the program password, parameters
    /// and a full backup the machine builder's password.
    fn check_transfer(&self, parts: PartsView<'_>, transfer: &TransferRequest) -> Result<(), Refusal> {
        if transfer.direction == Direction::Export {
            return Ok(());
        }
        if parts.program.is_open() {
            return Err(Refusal::Other(TRANSFER_IN_RUN.into()));
        }
        match transfer.set {
            TransferSet::Params | TransferSet::Backup if !self.access.is_builder() => Err(Refusal::Builder),
            TransferSet::Programs | TransferSet::Serial
                if self.needs_program_password(parts, transfer) && !self.access.may_edit_programs() =>
            {
                Err(Refusal::Password)
            }
            TransferSet::Programs | TransferSet::Serial | TransferSet::Screens => Ok(()),
            TransferSet::Params | TransferSet::Variables | TransferSet::Backup => Ok(()),
        }
    }

    /// Whether an import needs the program password. A program of unknown name may be one of O9000 to O9999.
    fn needs_program_password(&self, parts: PartsView<'_>, transfer: &TransferRequest) -> bool {
        let number = |name: &String| program_number::from_name(program_number::stem(name));
        let guarded = |name: &String| program_number::is_protected_subprogram(number(name));
        let any =
            transfer.set == TransferSet::Serial || transfer.names.is_empty() || transfer.names.iter().any(guarded);
        parts.plant.params.bit(param::PROGRAM_PASSWORD) || (any && parts.plant.params.bit(param::SUBPROGRAM_PASSWORD))
    }

    /// Applies the checked values of a file. Parameters in use are left unchanged and listed in the result.
    fn restore_values(parts: &mut Parts<'_>, restored: &RestoredValues) -> LocalizedText {
        let mut kept = Vec::new();
        for (at, value) in &restored.params {
            if parts.plant.params.read(*at).is_ok_and(|old| old.to_bits() == value.to_bits()) {
                continue;
            }
            Self::set_param(parts, *at, *value);
            if parts.plant.outbox.message.tone == Tone::Refused {
                kept.push(at.to_string());
            }
        }
        for (number, value) in &restored.variables {
            parts.program.set_variable(parts.plant, *number, Some(*value));
        }
        for (number, geometry, wear) in &restored.offsets {
            let offsets = &mut parts.plant.work.offsets;
            (offsets.geometry[number - 1], offsets.wear[number - 1]) = (*geometry, *wear);
            parts.plant.store_offset(number - 1);
        }
        for &(number, radius_mm, tip) in &restored.cutters {
            parts.plant.work.offsets.cutter[number - 1] = CutterShape { radius_mm, tip };
            parts.plant.store_cutter(number - 1);
        }
        for (index, origin) in &restored.work_offsets {
            let Some(place) = OriginPlace::of_stored_index(*index) else { continue };
            parts.plant.work.offsets.set_origin(place, *origin);
            parts.plant.store_origin(place);
        }
        let (params, variables) = (restored.params.len(), restored.variables.len());
        if kept.is_empty() {
            return phrase!(
                "已读入：参数 {params} 个，变量 {variables} 个",
                "imported: {params} parameters, {variables} variables",
                params,
                variables
            );
        }
        let kept = kept.join(" ");
        phrase!("已读入，正在使用而未改的：{kept}", "imported; in use and left unchanged: {kept}", kept)
    }

    /// Editing needs mode EDIT, no open run, and the password where set (K6.2).
    fn check_program_edit(&self, parts: PartsView<'_>, number: u32) -> Result<(), Refusal> {
        if !parts.program.is_open() && parts.plant.operator.mode != Mode::Edit {
            return Err(Refusal::Other(EDIT_MODE.into()));
        }
        self.check_program_write(parts, number)
    }

    /// Writing needs no open run, and the password where set.
    fn check_program_write(&self, parts: PartsView<'_>, number: u32) -> Result<(), Refusal> {
        if parts.program.is_open() {
            return Err(Refusal::Other(IN_RUN.into()));
        }
        let asks = match program_number::is_protected_subprogram(number) {
            true => param::SUBPROGRAM_PASSWORD,
            false => param::PROGRAM_PASSWORD,
        };
        if parts.plant.params.bit(asks) && !self.access.may_edit_programs() { Err(Refusal::Password) } else { Ok(()) }
    }

    /// Handles an answer of the background thread.
    pub fn handle_file_answer(&mut self, parts: &mut Parts<'_>, ticket: Ticket, answer: &FileAnswer) {
        match answer {
            FileAnswer::Done(message) => self.finish_file_request(parts, ticket, message.clone().into()),
            FileAnswer::Saved { message, number, stamp } => {
                let done = Completion { message: message.clone(), saved: Some((*number, *stamp)) };
                self.finish_file_request(parts, ticket, done);
            }
            FileAnswer::Restored(_) | FileAnswer::Leadscrew(..) if parts.program.is_open() => {
                self.fail_file_request(parts, ticket, Refusal::Other(TRANSFER_IN_RUN.into()));
            }
            FileAnswer::Restored(restored) => {
                let message = Self::restore_values(parts, restored);
                self.finish_file_request(parts, ticket, message.into());
            }
            FileAnswer::Leadscrew(axis, table, file) => {
                Self::set_leadscrew_table(parts, *axis, table);
                let points = table.points().len();
                let message = phrase!(
                    "{axis} 轴：已从 {file} 读入 {points} 点",
                    "axis {axis}: {points} points from {file}",
                    axis = *axis,
                    file = file.as_str(),
                    points
                );
                self.finish_file_request(parts, ticket, message.into());
            }
            FileAnswer::ToolpathComputed(drawing) => {
                self.end_pending(ticket);
                let view = Arc::make_mut(&mut self.files.view);
                view.toolpath = Some(Arc::clone(drawing));
                view.add_answer(ticket, Ok(Completion::default()));
            }
            FileAnswer::Refused(refusal) => self.fail_file_request(parts, ticket, refusal.clone()),
            FileAnswer::Progress(..) | FileAnswer::BytesReceived(..) => self.update_progress(ticket, answer),
            FileAnswer::Media(media) => {
                if self.files.view.media.as_deref() != Some(media) {
                    Arc::make_mut(&mut self.files.view).media = Some(Arc::new(media.clone()));
                }
            }
            FileAnswer::LinesChecked(looked) => {
                Arc::make_mut(&mut self.files.view).line_check = Arc::new(looked.clone());
            }
            FileAnswer::Page(page) => Arc::make_mut(&mut self.files.view).page = Some(Arc::clone(page)),
        }
    }

    fn finish_file_request(&mut self, parts: &mut Parts<'_>, ticket: Ticket, done: Completion) {
        if let Some(request) = self.end_pending(ticket) {
            if matches!(request, FileRequest::SaveRecording(_)) {
                parts.manual.teach.mark_saved();
            }
            Self::update_current_program(parts.plant, &request);
        }
        parts.plant.show_note(done.message.clone());
        Arc::make_mut(&mut self.files.view).add_answer(ticket, Ok(done));
    }

    fn fail_file_request(&mut self, parts: &mut Parts<'_>, ticket: Ticket, refusal: Refusal) {
        self.end_pending(ticket);
        match &refusal {
            Refusal::Alarm(number, detail) => parts.plant.raise(*number, Some(detail.clone())),
            other => parts.plant.refuse(other.message()),
        }
        Arc::make_mut(&mut self.files.view).add_answer(ticket, Err(refusal));
    }

    /// Ends the pending request if the ticket matches; returns the request.
    fn end_pending(&mut self, ticket: Ticket) -> Option<FileRequest> {
        let (_, request) = self.files.pending.take_if(|(of, _)| *of == ticket)?;
        let view = Arc::make_mut(&mut self.files.view);
        (view.busy, view.bytes_received) = (None, None);
        Some(*request)
    }

    /// Updates the current program after it was renamed or deleted.
    fn update_current_program(plant: &mut Plant, request: &FileRequest) {
        let current = match request {
            FileRequest::Rename { from, to } if *from == plant.execution.current_program => *to,
            FileRequest::Delete(number) if *number == plant.execution.current_program => 0,
            _ => return,
        };
        plant.set_current_program(current);
    }

    /// Shows the progress of the pending request. Late answers to other requests are ignored.
    fn update_progress(&mut self, ticket: Ticket, answer: &FileAnswer) {
        if self.files.pending.as_ref().is_none_or(|(of, _)| *of != ticket) {
            return;
        }
        let view = Arc::make_mut(&mut self.files.view);
        match answer {
            FileAnswer::Progress(what, thousandths) => view.busy = Some((*what, *thousandths)),
            FileAnswer::BytesReceived(what, bytes) => {
                (view.busy, view.bytes_received) = (Some((*what, 0)), Some(*bytes))
            }
            _ => {}
        }
    }

    /// Writes the snapshot fields of file requests.
    pub fn files_view(&self, out: &mut Snapshot) {
        out.files.clone_from(&self.files.view);
        out.stock.clone_from(&self.files.stock);
    }
}
