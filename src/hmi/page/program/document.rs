//! Text being edited: cursor, block of lines, undo. The undo states share the text's chunks, so a million lines are
//! held once, however many undo steps there are.
//! Source: spec B6 (程序: edit, copy, undo).

use crate::hmi::EditKey;
use crate::link::files::Completion;
use ropey::{Rope, RopeSlice};

/// Maximum number of undo steps.
const MAX_UNDO: usize = 500;

/// Kind of a change; consecutive typing is one undo step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ChangeKind {
    Typing,
    Deleting,
    Other,
}

/// Text and cursor before a change.
type UndoState = (Rope, usize);

/// A text with its cursor.
#[derive(Clone, Debug, Default)]
pub struct Document {
    /// O number; 0: nothing is open.
    pub number: u32,
    /// Stamp of the file that the text was read from.
    pub base: u64,
    /// The text differs from the file.
    pub changed: bool,
    /// The text.
    pub rope: Rope,
    /// Cursor, in characters from the start of the text.
    pub cursor: usize,
    /// First or last line of the block while one is marked; the cursor's line is the other end.
    pub block_anchor: Option<usize>,
    /// Counts the changes.
    pub version: u64,
    undo: Vec<UndoState>,
    redo: Vec<UndoState>,
    last_change: Option<(ChangeKind, usize)>,
}

/// Length of a line without its line end, characters.
pub fn content_len(line: RopeSlice<'_>) -> usize {
    let mut length = line.len_chars();
    while length > 0 && matches!(line.char(length - 1), '\n' | '\r') {
        length -= 1;
    }
    length
}

impl Document {
    /// Opens a text.
    pub fn open(number: u32, base: u64, rope: &Rope) -> Self {
        Self { number, base, rope: rope.clone(), ..Self::default() }
    }

    /// Number of lines shown; a line end at the end of the text starts no new line.
    pub fn lines(&self) -> usize {
        let lines = self.rope.len_lines();
        if lines > 1 && self.rope.line(lines - 1).len_chars() == 0 { lines - 1 } else { lines }
    }

    /// Line and column of the cursor, from 0.
    pub fn cursor_position(&self) -> (usize, usize) {
        let line = self.rope.char_to_line(self.cursor.min(self.rope.len_chars()));
        (line, self.cursor - self.rope.line_to_char(line))
    }

    /// Lines of the block, first and one past the last.
    pub fn block(&self) -> Option<(usize, usize)> {
        let (mark, here) = (self.block_anchor?, self.cursor_position().0);
        Some((mark.min(here), (mark.max(here) + 1).min(self.rope.len_lines())))
    }

    /// Moves the cursor to a line and column, or as near as the text allows.
    pub fn move_to(&mut self, line: usize, column: usize) {
        let line = line.min(self.lines().saturating_sub(1));
        self.cursor = self.rope.line_to_char(line) + column.min(content_len(self.rope.line(line)));
        self.last_change = None;
    }

    /// Moves the cursor by characters; a line end counts as one.
    pub fn move_chars(&mut self, by: isize) {
        let (line, column) = self.cursor_position();
        let length = content_len(self.rope.line(line));
        match by {
            1.. if column < length => self.cursor += 1,
            1.. if line + 1 < self.lines() => self.move_to(line + 1, 0),
            ..=-1 if column > 0 => self.cursor -= 1,
            ..=-1 if line > 0 => self.move_to(line - 1, usize::MAX),
            _ => {}
        }
        self.last_change = None;
    }

    /// Moves the cursor by lines.
    pub fn move_lines(&mut self, by: isize) {
        let (line, column) = self.cursor_position();
        self.move_to(line.saturating_add_signed(by), column);
    }

    /// Applies an editing key; false if it does nothing here.
    pub fn edit(&mut self, edit: EditKey) -> bool {
        match edit {
            EditKey::Backspace => self.backspace(),
            EditKey::Delete => self.delete(),
            EditKey::LineStart => self.move_to(self.cursor_position().0, 0),
            EditKey::LineEnd => self.move_to(self.cursor_position().0, usize::MAX),
            EditKey::Enter => self.new_line(),
            EditKey::Up => self.move_lines(-1),
            EditKey::Down => self.move_lines(1),
            EditKey::Left => self.move_chars(-1),
            EditKey::Right => self.move_chars(1),
            EditKey::Cancel | EditKey::Char(_) | EditKey::Sign | EditKey::Next | EditKey::Previous => return false,
        }
        true
    }

    /// Inserts a character at the cursor.
    pub fn insert_char(&mut self, sign: char) {
        self.record_undo(ChangeKind::Typing);
        self.rope.insert_char(self.cursor, sign);
        self.cursor += 1;
        self.last_change = Some((ChangeKind::Typing, self.cursor));
    }

    /// Inserts a line end at the cursor, of the same style as in the file.
    pub fn new_line(&mut self) {
        self.record_undo(ChangeKind::Other);
        let end = self.line_end();
        self.rope.insert(self.cursor, end);
        self.cursor += end.len();
    }

    /// Deletes the character before the cursor; at the start of a line the line end.
    pub fn backspace(&mut self) {
        if self.cursor == 0 {
            return;
        }
        self.record_undo(ChangeKind::Deleting);
        let pair =
            self.cursor >= 2 && self.rope.char(self.cursor - 1) == '\n' && self.rope.char(self.cursor - 2) == '\r';
        let from = self.cursor - if pair { 2 } else { 1 };
        self.rope.remove(from..self.cursor);
        self.cursor = from;
        self.last_change = Some((ChangeKind::Deleting, self.cursor));
    }

    /// Deletes the character behind the cursor; at the end of a line the line end.
    pub fn delete(&mut self) {
        let (line, column) = self.cursor_position();
        let end = match content_len(self.rope.line(line)) {
            length if column < length => self.cursor + 1,
            _ if line + 1 < self.lines() => self.rope.line_to_char(line + 1),
            _ => return,
        };
        self.record_undo(ChangeKind::Deleting);
        self.rope.remove(self.cursor..end);
        self.last_change = Some((ChangeKind::Deleting, self.cursor));
    }

    /// Replaces characters by a text and puts the cursor behind it.
    pub fn replace(&mut self, from: usize, to: usize, text: &str) {
        self.record_undo(ChangeKind::Other);
        self.rope.remove(from..to);
        self.rope.insert(from, text);
        self.cursor = from + text.chars().count();
    }

    /// Replaces the whole text, as one undo step.
    pub fn replace_all(&mut self, rope: Rope) {
        self.record_undo(ChangeKind::Other);
        let (line, column) = self.cursor_position();
        self.rope = rope;
        self.move_to(line, column);
        self.block_anchor = None;
    }

    /// Copies the block, whole lines.
    pub fn copy_block(&self) -> Option<Rope> {
        let (first, end) = self.block()?;
        let mut copy = Rope::from(self.rope.slice(self.rope.line_to_char(first)..self.rope.line_to_char(end)));
        if copy.len_chars() > 0 && !matches!(copy.char(copy.len_chars() - 1), '\n' | '\r') {
            copy.insert(copy.len_chars(), self.line_end());
        }
        Some(copy)
    }

    /// Deletes the lines of the block.
    pub fn delete_block(&mut self) {
        let Some((first, end)) = self.block() else { return };
        self.record_undo(ChangeKind::Other);
        self.rope.remove(self.rope.line_to_char(first)..self.rope.line_to_char(end));
        self.block_anchor = None;
        self.move_to(first, 0);
    }

    /// Inserts lines before the cursor's line; the cursor moves behind them.
    pub fn paste(&mut self, lines: &Rope) {
        self.record_undo(ChangeKind::Other);
        let at = self.rope.line_to_char(self.cursor_position().0);
        let rest = self.rope.split_off(at);
        self.rope.append(lines.clone());
        self.rope.append(rest);
        self.block_anchor = None;
        self.cursor = at + lines.len_chars();
    }

    /// Undoes the last change.
    pub fn undo(&mut self) {
        if let Some(past) = self.undo.pop() {
            self.redo.push(self.state());
            self.restore(past);
        }
    }

    /// Redoes the last undone change.
    pub fn redo(&mut self) {
        if let Some(past) = self.redo.pop() {
            self.undo.push(self.state());
            self.restore(past);
        }
    }

    /// Whether undo and redo are possible.
    pub const fn can_undo_redo(&self) -> (bool, bool) {
        (!self.undo.is_empty(), !self.redo.is_empty())
    }

    /// This version was saved to its file; later changes are still unsaved.
    pub fn mark_saved(&mut self, version: u64, completion: &Completion) {
        if let Some((number, stamp)) = completion.saved
            && number == self.number
        {
            (self.base, self.changed) = (stamp, version != self.version);
        }
    }

    fn state(&self) -> UndoState {
        (self.rope.clone(), self.cursor)
    }

    fn restore(&mut self, (rope, cursor): UndoState) {
        self.rope = rope;
        self.cursor = cursor.min(self.rope.len_chars());
        (self.block_anchor, self.last_change, self.changed) = (None, None, true);
        self.version += 1;
    }

    /// Saves the present state for undo, unless the change continues the last one.
    fn record_undo(&mut self, kind: ChangeKind) {
        if self.last_change != Some((kind, self.cursor)) || kind == ChangeKind::Other {
            self.undo.push(self.state());
            if self.undo.len() > MAX_UNDO {
                self.undo.remove(0);
            }
        }
        self.redo.clear();
        (self.last_change, self.changed) = (None, true);
        self.version += 1;
    }

    /// Line end of the first line.
    pub fn line_end(&self) -> &'static str {
        let first = self.rope.line(0);
        let length = first.len_chars();
        match length.checked_sub(1).map(|last| first.char(last)) {
            Some('\r') => "\r",
            Some('\n') if length > 1 && first.char(length - 2) == '\r' => "\r\n",
            Some(_) | None => "\n",
        }
    }
}
