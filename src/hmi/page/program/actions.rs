//! Keys of the program page and what they do: one table of actions, names, labels and keyboard shortcuts; then cursor
//! moves, blocks, undo, search, replace, renumber, save.
//! Source: spec B6.

use egui::{Rect, Ui};

use super::text_task::{TaskStep, TextTask};
use super::{EditorQuestion, EditorRequest, ProgramPage, Prompt};
use crate::defs::key::Mode;
use crate::defs::page::Page;
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::hmi::widget::{self, page_keys};
use crate::hmi::{Area, EditKey, Login, PageKey, View, requests};
use crate::link::Command;
use crate::link::snapshot::RunState;

/// Why a text that is not being edited does not change.
pub const EDIT_FIRST: Text = Text::new("先按“编辑”", "press EDIT first");
pub const UNKNOWN_ENCODING: Text = Text::new("文件编码不对，不能编辑", "unknown encoding: cannot be edited");
pub const SAVE_FIRST: Text = Text::new("先保存改动", "save the changes first");
/// The text that is shown is not the one that runs.
pub const UNSAVED: Text = Text::new(
    "改动没有保存：循环启动运行原来的程序；编辑方式下按“编辑”“保存”",
    "not saved: cycle start runs the old text; mode EDIT, then EDIT, SAVE",
);
pub const NOTHING_TO_SAVE: Text = Text::new("没有改动", "nothing to save");

page_keys! {
    /// Action of a key.
    EditorAction {
        Edit = "edit-begin", "编辑", "EDIT";
        End = "edit-end", "结束", "END";
        Keyboard = "edit-board", "键盘", "KEYS";
        Find = "edit-find", "查找", "FIND";
        FindNext = "edit-again", "下一个", "NEXT";
        Replace = "edit-replace", "替换", "REPLACE";
        GoTo = "edit-go", "定位", "GO TO";
        Renumber = "edit-renumber", "重排 N", "RENUM";
        First = "edit-first", "首行", "FIRST";
        Last = "edit-last", "末行", "LAST";
        Left = "edit-left", "←", "←";
        Right = "edit-right", "→", "→";
        Up = "edit-up", "↑", "↑";
        Down = "edit-down", "↓", "↓";
        Undo = "edit-undo", "撤销", "UNDO";
        Redo = "edit-redo", "重做", "REDO";
        Save = "edit-save", "保存", "SAVE";
        Discard = "edit-discard", "放弃", "DISCARD";
        Mark = "edit-mark", "块首", "BLOCK";
        Unmark = "edit-unmark", "取消块", "UNMARK";
        CopyBlock = "edit-copy", "复制", "COPY";
        Cut = "edit-cut", "剪切", "CUT";
        DeleteBlock = "edit-delete", "删除", "DELETE";
        Paste = "edit-paste", "粘贴", "PASTE";
        ReplaceThis = "replace-this", "替换", "REPLACE";
        Skip = "replace-skip", "跳过", "SKIP";
        ReplaceAll = "replace-all", "全部", "ALL";
        EndReplace = "replace-end", "结束", "END";
        PromptAccept = "ask-done", "确定", "OK";
        PromptCancel = "ask-end", "取消", "CANCEL";
        StopTask = "work-stop", "停止", "STOP";
        RestartHere = "run-here", "从此段", "FROM N";
        Resume = "run-resume", "断电续", "RESUME";
        OpenDesigner = "design-page", "页面", "PAGE";
    }
}

impl EditorAction {
    /// Whether the action needs edit mode.
    pub const fn needs_editing(self) -> bool {
        let text = matches!(self, Undo | Redo | Save | Mark | Unmark | CopyBlock | Cut | DeleteBlock | Paste);
        text || matches!(self, Replace | Renumber | ReplaceThis | ReplaceAll)
    }
}

use EditorAction::{
    CopyBlock, Cut, DeleteBlock, Discard, Down, Edit, End, EndReplace, Find, FindNext, First, GoTo, Keyboard, Last,
    Left, Mark, OpenDesigner, Paste, PromptAccept, PromptCancel, Redo, Renumber, Replace, ReplaceAll, ReplaceThis,
    RestartHere, Resume, Right, Save, Skip, StopTask, Undo, Unmark, Up,
};

/// The rows of keys below the listing.
const fn rows(page: &ProgramPage) -> [&'static [EditorAction]; 2] {
    let block = page.document.block_anchor.is_some();
    match (page.editing, page.keyboard_open, block, page.replacing, page.task.is_some()) {
        _ if page.prompt.is_some() => [&[PromptAccept, PromptCancel], &[]],
        (.., true) => [&[StopTask], &[]],
        (false, ..) => [&[Edit, Find, FindNext, GoTo, First, Last, RestartHere, Resume, OpenDesigner], &[]],
        (.., true, false) => [&[ReplaceThis, Skip, ReplaceAll, EndReplace], &[]],
        (true, true, ..) => [&[Keyboard, Left, Right, Up, Down, Undo, Redo, Save], &[]],
        (true, false, true, ..) => {
            [&[Keyboard, Find, Replace, GoTo, Unmark, Undo, Redo, Save], &[CopyBlock, Cut, DeleteBlock, Paste, End]]
        }
        (true, false, false, ..) => [
            &[Keyboard, Find, Replace, GoTo, Mark, Undo, Redo, Save],
            &[Paste, FindNext, Renumber, First, Last, Discard, End],
        ],
    }
}

/// Action of a keyboard key with Ctrl.
pub const fn from_shortcut(key: egui::Key) -> Option<EditorAction> {
    Some(match key {
        egui::Key::S => Save,
        egui::Key::Z => Undo,
        egui::Key::Y => Redo,
        egui::Key::F => Find,
        egui::Key::H => Replace,
        egui::Key::G => GoTo,
        egui::Key::M => Mark,
        egui::Key::C => CopyBlock,
        egui::Key::X => Cut,
        egui::Key::V => Paste,
        egui::Key::R => Renumber,
        egui::Key::E => Edit,
        _ => return None,
    })
}

/// Draws the keys; returns the pressed one.
pub fn ui(view: &View<'_>, rect: Rect, page: &mut ProgramPage) -> Option<EditorAction> {
    let mut pressed = None;
    let on_keys = page.keys_focused || !page.editing;
    for (row, actions) in rows(page).into_iter().enumerate() {
        // A kind of machine without grinding pages has no page designer.
        let has = |action: &&EditorAction| **action != OpenDesigner || Page::Designer.exists_on(view.snapshot.kind);
        let actions: Vec<EditorAction> = actions.iter().filter(has).copied().collect();
        let line = rect.band(row as f32 * widget::KEYS_HEIGHT, widget::KEYS_HEIGHT - 2.0);
        for (index, action) in actions.iter().enumerate() {
            let place = line.cell(index, actions.len().max(6));
            let (on, locked) = page.look_of(*action);
            let key = PageKey::new(action.id(), action.label().get(view.lang)).on(on).locked(locked);
            let touched = if on_keys { page.walk.button(view, place, key) } else { widget::button(view, place, key) };
            if touched {
                pressed = Some(*action);
            }
        }
    }
    pressed
}

impl ProgramPage {
    /// Accepts the prompt input.
    pub(super) fn accept_prompt(&mut self) {
        let Some(ask) = self.prompt.take() else { return };
        let text = std::mem::take(&mut self.prompt_text);
        self.keyboard_open = self.keyboard_open && self.editing;
        match ask {
            Prompt::Find | Prompt::ReplaceOld if text.is_empty() => {}
            Prompt::Find => {
                self.pattern.clone_from(&text);
                self.task = Some(TextTask::find(&text, &self.document));
            }
            Prompt::ReplaceOld => (self.pattern, self.prompt) = (text, Some(Prompt::ReplaceNew)),
            Prompt::ReplaceNew => {
                (self.prompt_text, self.replacing) = (text, true);
                self.task = Some(TextTask::find(&self.pattern, &self.document));
            }
            Prompt::GoTo => self.go_to(&text),
            Prompt::Renumber => {
                let mut words = text.split([' ', ',', '/']).filter(|word| !word.is_empty()).map(str::parse::<u64>);
                match (words.next().unwrap_or(Ok(10)), words.next().unwrap_or(Ok(10))) {
                    (Ok(first), Ok(by)) if by > 0 => self.task = Some(TextTask::renumber(first, by)),
                    _ => self
                        .message
                        .refuse(Text::new("格式：起始 步长，例如 10 10", "first number and step, such as 10 10")),
                }
            }
        }
    }

    /// Goes to a line by its number, or to a block by N.
    fn go_to(&mut self, text: &str) {
        let text = text.trim();
        if let Ok(line) = text.parse::<usize>() {
            if line == 0 || line > self.document.lines() {
                let last = self.document.lines();
                let why = phrase!("行号为 1-{last}", "lines are 1 to {last}", last);
                return self.message.refuse(why);
            }
            self.document.move_to(line - 1, 0);
            self.reveal_cursor();
        } else if let Some(Ok(number)) = text.strip_prefix(['N', 'n']).map(str::parse) {
            self.pattern = text.to_owned();
            self.task = Some(TextTask::find_block(number));
        } else if !text.is_empty() {
            self.pattern = text.to_owned();
            self.task = Some(TextTask::find(text, &self.document));
        }
    }

    /// Runs one slice of the work.
    pub(super) fn run_task(&mut self, ui: &Ui) {
        let Some(work) = &mut self.task else { return };
        let step = work.step(&self.document.rope);
        let name = work.name();
        ui.ctx().request_repaint();
        match step {
            TaskStep::Running(share) => {
                let done = |name: &str| format!("{name} {:.0} %", f32::from(share) / 10.0);
                return self.message.tell(LocalizedText::new(done(name.zh), done(name.en)));
            }
            TaskStep::Found(found) => {
                self.document.cursor = found.end.min(self.document.rope.len_chars());
                self.message.clear();
                if self.replacing {
                    let (with, what) = (&self.prompt_text, &self.pattern);
                    self.message.tell(phrase!("{what} → {with} ？", "{what} → {with} ?", what, with));
                }
                self.position.first_column = 0;
                self.reveal_cursor();
            }
            TaskStep::NotFound => {
                self.replacing = false;
                let what = &self.pattern;
                self.message.refuse(phrase!("没有找到 {what}", "{what} not found", what));
            }
            TaskStep::Changed(rope, count) => {
                self.document.replace_all(rope);
                self.replacing = false;
                self.message.tell(phrase!("改了 {count} 处", "{count} places changed", count));
            }
            TaskStep::Refused(why) => self.message.refuse(why),
        }
        self.task = None;
    }

    pub(super) fn perform(&mut self, action: EditorAction, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        if self.task.is_some() && action != StopTask || login.is_open() {
            return;
        }
        self.message.clear();
        if action.needs_editing() && !self.editing {
            return self.message.refuse(EDIT_FIRST);
        }
        match action {
            Edit if view.snapshot.program.has_invalid_bytes => self.message.refuse(UNKNOWN_ENCODING),
            Edit => self.request_edit(EditorRequest::Edit, out),
            End => self.stop_editing(),
            Keyboard => self.keyboard_open = !self.keyboard_open,
            Find => self.open_prompt(Prompt::Find),
            FindNext if self.pattern.is_empty() => self.open_prompt(Prompt::Find),
            FindNext | Skip => self.task = Some(TextTask::find(&self.pattern, &self.document)),
            Replace => self.open_prompt(Prompt::ReplaceOld),
            GoTo => self.open_prompt(Prompt::GoTo),
            Renumber => self.open_prompt(Prompt::Renumber),
            First => self.show_line(0),
            Last => self.show_line(usize::MAX),
            Left => self.edit(EditKey::Left, out),
            Right => self.edit(EditKey::Right, out),
            Up => self.edit(EditKey::Up, out),
            Down => self.edit(EditKey::Down, out),
            Save if !self.document.changed => self.message.tell(NOTHING_TO_SAVE),
            Save => self.save(false, out),
            Discard if !self.document.changed => self.stop_editing(),
            Discard => {
                let question = requests::discard_question(&view.snapshot.title(self.document.number));
                self.question.ask(EditorQuestion::Discard, question);
            }
            StopTask => self.task = None,
            // B5: the core reads the program up to the line and reports the modal state there.
            RestartHere if self.document.changed => self.message.refuse(SAVE_FIRST),
            RestartHere => self.restart_here(out),
            Resume => out.push(Command::ResumeInterrupted),
            OpenDesigner => out.push(Command::OpenPage(Page::Designer)),
            PromptAccept => self.edit(EditKey::Enter, out),
            PromptCancel => self.edit(EditKey::Cancel, out),
            // Replaces the match that is shown and searches the next one.
            ReplaceThis => {
                let to = self.document.cursor;
                self.document.replace(to.saturating_sub(self.pattern.chars().count()), to, &self.prompt_text);
                self.task = Some(TextTask::find(&self.pattern, &self.document));
            }
            ReplaceAll => self.task = Some(TextTask::replace(&self.pattern, &self.prompt_text)),
            EndReplace => self.replacing = false,
            Undo | Redo | Mark | Unmark | CopyBlock | Cut | DeleteBlock | Paste => self.change_text(action),
        }
    }

    /// Starts at the cursor's line (B5). A line out of sight is shown first: nobody starts where he does not look.
    fn restart_here(&mut self, out: &mut Vec<Command>) {
        let line = self.document.cursor_position().0;
        if self.sight.contains(&line) {
            return out.push(Command::RestartAt(line as u32 + 1));
        }
        let line = line + 1;
        self.message.refuse(phrase!(
            "光标在第 {line} 行，刚才看不见：确认后再按“从此段”，或点要开始的行",
            "the cursor was out of sight, in line {line}: press FROM N again, or touch the line to start from",
            line
        ));
        self.reveal_cursor();
    }

    /// Where cycle start begins, while the cursor stands further down and 从此段 has not been pressed.
    pub(super) fn start_hint(&self, view: &View<'_>) -> Option<String> {
        let (snapshot, line) = (view.snapshot, self.document.cursor_position().0 + 1);
        let ready = snapshot.mode == Mode::Auto && snapshot.state == RunState::Idle && snapshot.restart.is_none();
        let hint = || {
            view.phrase(&phrase!(
                "循环启动从程序开头运行；按“从此段”才从第 {line} 行开始",
                "cycle start begins at the top of the program, FROM N at line {line}",
                line
            ))
        };
        (ready && !self.editing && line > 1).then(hint)
    }

    /// Puts the cursor on a line, or on the last one, and shows it on top.
    fn show_line(&mut self, line: usize) {
        self.document.move_to(line, 0);
        self.position.scroll.top = self.document.cursor_position().0 as f64;
        self.position.scroll.user_scrolled = true;
    }

    fn open_prompt(&mut self, ask: Prompt) {
        (self.prompt, self.replacing, self.keys_focused) = (Some(ask), false, false);
        self.keyboard_open = true;
        self.prompt_text.clear();
        if ask == Prompt::Find || ask == Prompt::ReplaceOld {
            self.prompt_text.clone_from(&self.pattern);
        } else if ask == Prompt::Renumber {
            self.prompt_text = "10 10".to_owned();
        }
    }

    fn change_text(&mut self, action: EditorAction) {
        let document = &mut self.document;
        match action {
            Undo => document.undo(),
            Redo => document.redo(),
            Mark => document.block_anchor = Some(document.cursor_position().0),
            Unmark => document.block_anchor = None,
            CopyBlock | Cut => {
                document.block_anchor = document.block_anchor.or_else(|| Some(document.cursor_position().0));
                self.clipboard = document.copy_block();
                let count = document.block().map_or(0, |(first, end)| end - first);
                if action == Cut {
                    document.delete_block()
                } else {
                    document.block_anchor = None
                }
                self.message.tell(phrase!("已复制 {count} 行", "{count} lines copied", count));
            }
            DeleteBlock => document.delete_block(),
            Paste => match &self.clipboard {
                Some(clip) => document.paste(clip),
                None => self.message.refuse(Text::new("先复制一块", "copy a block first")),
            },
            _ => {}
        }
        self.follow_cursor();
    }
}
