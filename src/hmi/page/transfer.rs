//! U盘/通信: programs, page files, parameters and macro values both ways, everything as one archive; programs over RS232.
//! Source: spec K7.8, L9, H8 (no U盘, progress, cancel), H9.

use std::collections::BTreeSet;

use egui::{Rect, vec2};

use super::serial::{SerialPane, change_port};
use super::{HandOver, PageContext, PageUi, Scroll, ScrollList};
use crate::defs::kind::Kind;
use crate::defs::text::{Lang, LocalizedText, Text, phrase};
use crate::hmi::{
    Area, KeyboardFocus, Login, PageKey, PageMessage, PendingRequests, Question, QuestionDialog, View, file_command,
    format_size, page_frame as lines, requests, round_to_lines, theme, widget,
};
use crate::link::Command;
use crate::link::files::{FileRequest, Refusal, Requester};
use crate::link::media::{Direction, MediaFile, MediaView, TransferRequest as Ask, TransferSet};
use crate::link::page_command::PasswordScope;

/// Height of the keys below.
const KEYS_HEIGHT: f32 = 52.0;
/// Seconds between two checks of the USB drive while the page is open.
const MEDIUM_POLL_SECONDS: f64 = 2.0;

/// The key that divides files with several programs.
const SPLIT_KEY: usize = 0;

/// Subject of a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TransferQuestion {
    /// Files that exist already.
    Overwrite,
    /// Pictures in another format.
    Convert,
    /// Files with several programs.
    Split,
}

/// State of the page.
#[derive(Debug, Default)]
pub struct TransferPage {
    set: TransferSet,
    /// Selected files on the control and on the USB drive.
    chosen: [BTreeSet<String>; 2],
    scroll: [Scroll; 2],
    walk: KeyboardFocus,
    request: Option<Ask>,
    /// The transfer waits for a password.
    awaiting_password: Option<PasswordScope>,
    question: QuestionDialog<TransferQuestion>,
    message: PageMessage,
    asking: PendingRequests<()>,
    last_poll: f64,
    /// The RS232 half.
    serial: SerialPane,
    /// When the running work was first seen, s, and its progress then, per mille.
    work_start: Option<(f64, u16)>,
}

impl PageUi for TransferPage {
    /// The kind of files stays.
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<HandOver>) {
        let asking = std::mem::take(&mut self.asking);
        *self = Self { set: self.set, asking, last_poll: f64::NEG_INFINITY, ..Self::default() };
    }

    fn wants_pad(&self, _view: &View<'_>) -> bool {
        self.set == TransferSet::Serial && self.serial.pad && !self.question.is_open()
    }

    fn refusal(&self, lang: Lang) -> Option<(String, String)> {
        self.message.refusal(lang).map(|why| (String::new(), why))
    }

    fn message(&self, lang: Lang) -> Option<String> {
        self.message.text(lang)
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, login, out, .. } = ctx;
        self.handle_answer(view, login, out);
        let now = view.ui.input(|input| input.time);
        let busy = view.snapshot.files.busy;
        if busy.is_none() && self.request.is_none() && now - self.last_poll > MEDIUM_POLL_SECONDS {
            self.last_poll = now;
            out.push(file_command(Requester::Transfer, FileRequest::ListMedia));
        }
        view.ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(MEDIUM_POLL_SECONDS));
        let free = !self.question.is_open() && !login.is_open();
        let edits = match free {
            true if self.set == TransferSet::Serial => self.serial.handle_edits(&typed.edits),
            true => typed.edits.to_vec(),
            false => Vec::new(),
        };
        self.walk.begin_frame(&edits);
        self.work_start = busy.map(|(_, share)| self.work_start.unwrap_or((now, share)));
        let none = MediaView::default();
        let media = view.snapshot.files.media.as_deref().unwrap_or(&none);
        let (tabs, rest) = rect.shrink2(vec2(theme::PAD, 6.0)).split_top(KEYS_HEIGHT);
        self.tabs(tabs, view);
        let (body, keys) = rest.split_bottom(KEYS_HEIGHT);
        let (body, told) = body.split_bottom(30.0);
        let half = (body.width() - theme::PAD) / 2.0;
        let (left, right) = (body.split_left(half).0, body.trim_left(half + theme::PAD));
        self.side(left, view, 0, media, typed.scroll_pages);
        if self.set == TransferSet::Serial {
            let (head, body) = right.split_top(34.0);
            lines::title(view, head, "RS232");
            view.card(body);
            if self.serial.ui(body.shrink(theme::PAD), view, media, &mut self.walk) {
                change_port(view, media, login, out);
            }
        } else {
            self.side(right, view, 1, media, typed.scroll_pages);
        }
        self.message_line(told, view);
        self.keys(keys, view, media, out);
        match self.question.ui(rect, view, &typed.edits) {
            Some((TransferQuestion::Convert, Some(_))) => {
                self.request.iter_mut().for_each(|ask| ask.convert = Some(true));
                self.send_request(out);
            }
            Some((TransferQuestion::Split, Some(key))) => {
                self.request.iter_mut().for_each(|ask| ask.split = Some(key == SPLIT_KEY));
                self.send_request(out);
            }
            Some((TransferQuestion::Overwrite, Some(key))) => {
                self.request.iter_mut().for_each(|ask| ask.overwrite = Some(key == requests::OVERWRITE_KEY));
                self.send_request(out);
            }
            Some((_, None)) => self.request = None,
            None => {}
        }
    }
}

impl TransferPage {
    fn handle_answer(&mut self, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        let access = view.snapshot.access;
        if let Some(guard) = self.awaiting_password.filter(|_| !login.is_open()) {
            self.awaiting_password = None;
            let open =
                if guard == PasswordScope::Program { access.program_unlocked } else { access.level >= guard.level() };
            if open { self.send_request(out) } else { self.request = None }
        }
        let answer = self.asking.poll(Requester::Transfer, &view.snapshot.files);
        let Some(((), answer)) = answer.filter(|_| self.request.is_some()) else { return };
        self.last_poll = f64::NEG_INFINITY;
        match answer {
            Ok(completion) => {
                self.request = None;
                self.chosen = Default::default();
                self.message.tell(completion.message);
            }
            Err(refusal @ (Refusal::Password | Refusal::Builder)) => {
                let guard = if refusal == Refusal::Builder { PasswordScope::Builder } else { PasswordScope::Program };
                self.awaiting_password = Some(guard);
                login.unlock(view, guard);
            }
            Err(Refusal::Overwrite(names)) => {
                let question = self.overwrite_question(&names);
                self.question.ask(TransferQuestion::Overwrite, question);
            }
            Err(Refusal::Split(files)) => self.question.ask(TransferQuestion::Split, split_question(&files)),
            Err(Refusal::Convert(faults)) => self.question.ask(TransferQuestion::Convert, conversion_question(&faults)),
            Err(refusal) => {
                self.request = None;
                self.message.refuse(refusal.message());
            }
        }
    }

    /// Question about existing files: overwrite, skip or cancel.
    fn overwrite_question(&self, names: &[String]) -> Question {
        let list = names.iter().take(6).cloned().collect::<Vec<_>>().join("  ");
        let more = if names.len() > 6 { "  …" } else { "" };
        let yes = ("question-overwrite", Text::new("覆盖", "OVERWRITE"));
        let skip = ("question-skip", Text::new("跳过", "SKIP"));
        if self.set == TransferSet::Backup {
            let body = phrase!(
                "{list}：程序、页面文件、参数、变量和刀补将被备份中的内容替换。",
                "{list}: programs, page files, parameters, variables and offsets are replaced by those of the backup.",
                list
            );
            return Question::new(Text::new("恢复备份？", "restore the backup?"), body, yes);
        }
        let title = Text::new("文件已存在且内容不同", "files exist with other contents");
        let body = LocalizedText::same(&format!("{list}{more}"));
        if self.set.file_set().has_file_list() {
            Question::with_keys(title, body, &[yes, skip])
        } else {
            Question::new(title, body, yes)
        }
    }

    fn send_request(&mut self, out: &mut Vec<Command>) {
        if let Some(ask) = &self.request {
            out.push(self.asking.send(Requester::Transfer, (), FileRequest::Transfer(ask.clone())));
        }
    }

    fn start(&mut self, kind: Kind, direction: Direction, out: &mut Vec<Command>) {
        let side = usize::from(direction == Direction::Import);
        let names = match (self.set, direction) {
            (TransferSet::Serial, Direction::Import) => match self.serial.file_name(kind) {
                Ok(name) => name.into_iter().collect(),
                Err(message) => return self.message.refuse(message),
            },
            _ => self.chosen[side].iter().cloned().collect(),
        };
        self.serial.pad = false;
        self.message.clear();
        self.request = Some(Ask { set: self.set, direction, names, overwrite: None, convert: None, split: None });
        self.send_request(out);
    }

    fn tabs(&mut self, rect: Rect, view: &View<'_>) {
        let key = |set: TransferSet| PageKey::new(set.id(), set.name().get(view.lang)).on(set == self.set);
        if let Some(index) = self.walk.keys(view, rect.trim_bottom(theme::GAP), &TransferSet::ALL.map(key))
            && self.request.is_none()
        {
            let (set, asking) = (TransferSet::ALL[index], std::mem::take(&mut self.asking));
            *self = Self { set, asking, last_poll: self.last_poll, walk: self.walk, ..Self::default() };
        }
    }

    /// One side: its name, free space, its files.
    fn side(&mut self, rect: Rect, view: &View<'_>, side: usize, media: &MediaView, pages: i32) {
        let (head, body) = rect.split_top(34.0);
        let name = if side == 0 { view.text("本机", "this control") } else { view.text("U 盘", "USB stick") };
        lines::title(view, head, name);
        if let Some(free) = media.free_bytes.filter(|_| side == 1 && media.medium_folder.is_some()) {
            let words = format!("{} {}", view.text("剩余", "free"), format_size(free));
            view.line_right(head, &words, theme::LABEL, view.theme.muted);
        }
        view.card(body);
        let all = if side == 0 { &media.control_files } else { &media.medium_files };
        let files: Vec<&MediaFile> = all.iter().filter(|file| file.set == self.set.file_set()).collect();
        let none = if side == 1 && media.medium_folder.is_none() {
            Some(view.text(
                "没有 U 盘。请插入 U 盘（FAT32 或 exFAT），几秒后自动识别。",
                "No USB stick. Plug one in (FAT32 or exFAT); it is found within seconds.",
            ))
        } else if side == 0 && !self.set.file_set().has_file_list() {
            Some(set_description(self.set, view))
        } else {
            files.is_empty().then(|| view.text("没有此类文件", "no files of this type"))
        };
        if let Some(words) = none {
            let ink = if side == 1 && media.medium_folder.is_none() { view.theme.hold } else { view.theme.muted };
            view.paragraph(body.shrink(theme::PAD), words, theme::LABEL, ink);
            return;
        }
        let list = round_to_lines(body.shrink(4.0), widget::ROW_HEIGHT);
        let id = if side == 0 { "files-here" } else { "files-there" };
        let list = ScrollList { id, rect: list, row: widget::ROW_HEIGHT, gap: 2.0, count: files.len() };
        let (clipped, rows) = self.scroll[side].rows(view, &list, pages);
        rows.into_iter().for_each(|(index, place)| self.file(place, &clipped, side, files[index]));
    }

    fn file(&mut self, place: Rect, view: &View<'_>, side: usize, file: &MediaFile) {
        let chosen = self.chosen[side].contains(&file.name);
        let word = format!("{} file-{side}", file.name);
        let response = view.touch_row(place, ("media-file", side, &file.name), chosen, word);
        let (walked, entered) = self.walk.item();
        if walked {
            view.frame(place, view.theme.info);
        }
        if (response.clicked() || entered) && !self.chosen[side].remove(&file.name) {
            self.chosen[side].insert(file.name.clone());
        }
        if chosen {
            view.painter.rect_filled(place, theme::RADIUS, view.theme.raised);
            view.frame(place, view.theme.focus);
        }
        let (name, bytes) = place.trim_sides(theme::PAD).split_right(86.0);
        view.fit_left(name, &file.name, theme::TITLE, view.theme.text);
        view.line_right(bytes, &format_size(file.size), theme::LABEL, view.theme.muted);
    }

    fn message_line(&self, rect: Rect, view: &View<'_>) {
        if let Some((what, share)) = view.snapshot.files.busy {
            let (line, bar) = rect.split_bottom(8.0);
            widget::progress_bar(view, bar.trim_bottom(2.0), share);
            let words = match view.snapshot.files.bytes_received {
                Some(bytes) => format!("{}  {}", what.get(view.lang), format_size(bytes)),
                None => format!("{} {} %{}", what.get(view.lang), share / 10, self.time_left(view, share)),
            };
            view.fit_left(line, &words, theme::LABEL, view.theme.text);
            return;
        }
        let hint = match self.set {
            TransferSet::Serial => Some(view.text("触摸选择要发送的程序", "touch to choose the programs to send")),
            set => set
                .has_file_list()
                .then(|| view.text("触摸选择文件；不选为全部", "touch to choose files; none chosen: all")),
        };
        let hint = hint.map(|words| (words.to_owned(), view.theme.muted));
        if let Some((words, ink)) = self.message.shown(view, view.theme.run).or(hint) {
            view.fit_left(rect, &words, theme::LABEL, ink);
        }
    }

    /// Remaining time, once 2 % of the work are done since its start was seen (H8).
    fn time_left(&self, view: &View<'_>, share: u16) -> String {
        let Some((since, from)) = self.work_start.filter(|(_, from)| share >= from + 20) else { return String::new() };
        let gone = view.ui.input(|input| input.time) - since;
        let left = (gone * f64::from(1_000 - share.min(1_000)) / f64::from(share - from)).ceil() as u64;
        format!(" · {} {}:{:02}", view.text("还需", "left"), left / 60, left % 60)
    }

    fn keys(&mut self, rect: Rect, view: &View<'_>, media: &MediaView, out: &mut Vec<Command>) {
        let busy = view.snapshot.files.busy.is_some() || self.request.is_some();
        let serial = self.set == TransferSet::Serial;
        let missing = if serial { media.port.is_none() } else { media.medium_folder.is_none() };
        let locked = busy || missing;
        let (to, from) = match serial {
            true => (view.text("本机 → RS232", "TO RS232 →"), view.text("RS232 → 本机", "← FROM RS232")),
            false => (view.text("本机 → U 盘", "TO USB →"), view.text("U 盘 → 本机", "← FROM USB")),
        };
        let keys = [
            PageKey::new("transfer-out", to).locked(locked),
            PageKey::new("transfer-in", from).locked(locked),
            PageKey::new("transfer-cancel", view.text("取消", "CANCEL")).locked(!busy),
        ];
        match self.walk.keys(view, rect.trim_top(2.0), &keys) {
            Some(2) => out.extend(busy.then(|| file_command(Requester::Transfer, FileRequest::Cancel))),
            Some(_) if missing => {
                let message = match serial {
                    true => Text::new("没有选择端口，请按 换端口", "no port is chosen: touch CHANGE"),
                    false => Text::new("没有 U 盘", "no USB stick"),
                };
                self.message.refuse(message);
            }
            Some(0) if !busy => self.start(view.snapshot.kind, Direction::Export, out),
            Some(_) if !busy => self.start(view.snapshot.kind, Direction::Import, out),
            Some(_) | None => {}
        }
    }
}

/// Question about files with several programs: divide, keep or cancel.
fn split_question(files: &[String]) -> Question {
    let more = if files.len() > 3 { "\n…" } else { "" };
    let list = files.iter().take(3).cloned().collect::<Vec<_>>().join("\n");
    let body = LocalizedText::same(&format!("{list}{more}"));
    let divide = ("question-split", Text::new("每个程序一个文件", "ONE FILE EACH"));
    let keep = ("question-keep", Text::new("不分开", "KEEP TOGETHER"));
    Question::with_keys(Text::new("文件里有几个程序", "files with several programs"), body, &[divide, keep])
}

/// K5.12: names pictures in a wrong format with their faults, and offers to convert them.
fn conversion_question(faults: &[LocalizedText]) -> Question {
    let list = |zh: bool| {
        let lines = faults.iter().take(3).map(|message| if zh { message.zh() } else { message.en() });
        let mut text = lines.collect::<Vec<_>>().join("\n");
        if faults.len() > 3 {
            text.push_str("\n…");
        }
        text
    };
    let title = Text::new("转换为 200×400 24 位图片？", "convert to 200×400, 24 bit?");
    let key = ("question-convert", Text::new("转换", "CONVERT"));
    Question::new(title, LocalizedText::new(list(true), list(false)), key)
}

fn set_description(set: TransferSet, view: &View<'_>) -> &'static str {
    match set {
        TransferSet::Params => view.text(
            "全部参数写到 KT830-PARAM.RON，或从该文件读入。读入需要机床厂密码；文件中任何一个值不允许则全部不读入。",
            "All parameters are written to KT830-PARAM.RON, or read from it. Reading needs the machine builder's password; one invalid value rejects the whole file.",
        ),
        TransferSet::Variables => view.text(
            "宏变量 #200-#433、#500-#999 写到 KT830-MACRO.RON，或从该文件读入。",
            "The macro variables #200-#433 and #500-#999 are written to KT830-MACRO.RON, or read from it.",
        ),
        TransferSet::Serial => "",
        TransferSet::Backup | TransferSet::Programs | TransferSet::Screens => view.text(
            "程序、页面文件、参数、变量、刀补和坐标系写成一个带校验的文件 KT830-日期-时间.TAR，或从所选（最新）备份恢复。恢复需要机床厂密码。",
            "Programs, page files, parameters, variables, tool and work offsets are written to one file with checksums, KT830-DATE-TIME.TAR, or restored from the chosen (newest) one. Restoring needs the machine builder's password.",
        ),
    }
}
