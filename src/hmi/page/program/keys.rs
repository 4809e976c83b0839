//! Keys of the program page: one table of actions, names, labels and keyboard shortcuts.
//! Source: spec B6.

use egui::Rect;

use super::ProgramPage;
use crate::defs::page::Page;
use crate::defs::text::Text;
use crate::hmi::widget::{self, page_keys};
use crate::hmi::{Area, PageKey, View};

/// Why a text that is not being edited does not change.
pub const EDIT_FIRST: Text = Text::new("先按“编辑”", "press EDIT first");

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
    for (row, acts) in rows(page).into_iter().enumerate() {
        // A kind of machine without grinding pages has no page designer.
        let has = |act: &&EditorAction| **act != OpenDesigner || Page::Designer.exists_on(view.snapshot.kind);
        let acts: Vec<EditorAction> = acts.iter().filter(has).copied().collect();
        let line = rect.band(row as f32 * widget::KEYS_HEIGHT, widget::KEYS_HEIGHT - 2.0);
        for (index, act) in acts.iter().enumerate() {
            let place = line.cell(index, acts.len().max(6));
            let (on, locked) = page.look_of(*act);
            let key = PageKey::new(act.id(), act.label().get(view.lang)).on(on).locked(locked);
            let touched = if on_keys { page.walk.button(view, place, key) } else { widget::button(view, place, key) };
            if touched {
                pressed = Some(*act);
            }
        }
    }
    pressed
}
