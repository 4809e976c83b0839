//! Actions of the keys of the program page: cursor moves, blocks, undo, search, replace, renumber, save.
//! Source: spec B6.

use egui::Ui;

use super::keys::Act;
use super::work::{Step, Work};
use super::{About, Ask, Program};
use crate::defs::page::Page;
use crate::defs::text::{Said, Text};
use crate::hmi::entry::Edit;
use crate::hmi::login::Login;
use crate::hmi::question::Question;
use crate::hmi::view::View;
use crate::link::Command;

impl Program {
    /// Accepts the prompt input.
    pub(super) fn enter(&mut self) {
        let Some(ask) = self.ask.take() else { return };
        let text = std::mem::take(&mut self.text);
        self.board = self.board && self.editing;
        match ask {
            Ask::Find | Ask::ReplaceWhat if text.is_empty() => {}
            Ask::Find => {
                self.what.clone_from(&text);
                self.work = Some(Work::find(&text, &self.document));
            }
            Ask::ReplaceWhat => (self.what, self.ask) = (text, Some(Ask::ReplaceWith)),
            Ask::ReplaceWith => {
                (self.text, self.replacing) = (text, true);
                self.work = Some(Work::find(&self.what, &self.document));
            }
            Ask::Go => self.go(&text),
            Ask::Renumber => {
                let mut words = text.split([' ', ',', '/']).filter(|word| !word.is_empty()).map(str::parse::<u64>);
                match (words.next().unwrap_or(Ok(10)), words.next().unwrap_or(Ok(10))) {
                    (Ok(first), Ok(by)) if by > 0 => self.work = Some(Work::renumber(first, by)),
                    _ => self.refuse(Said::new("格式：起始 步长，例如 10 10", "first number and step, such as 10 10")),
                }
            }
        }
    }

    /// Goes to a line by its number, or to a block by N.
    fn go(&mut self, text: &str) {
        let text = text.trim();
        if let Ok(line) = text.parse::<usize>() {
            if line == 0 || line > self.document.lines() {
                let last = self.document.lines();
                return self.refuse(Said::new(format!("行号为 1-{last}"), format!("lines are 1 to {last}")));
            }
            self.document.go(line - 1, 0);
            self.keep_in_sight();
        } else if let Some(Ok(number)) = text.strip_prefix(['N', 'n']).map(str::parse) {
            self.what = text.to_owned();
            self.work = Some(Work::block(number));
        } else if !text.is_empty() {
            self.what = text.to_owned();
            self.work = Some(Work::find(text, &self.document));
        }
    }

    /// Runs one slice of the work.
    pub(super) fn go_on(&mut self, ui: &Ui) {
        let Some(work) = &mut self.work else { return };
        let step = work.step(&self.document.rope);
        let name = work.name();
        ui.ctx().request_repaint();
        match step {
            Step::Going(share) => {
                let part = f32::from(share) / 10.0;
                self.told =
                    Some((Said::new(format!("{} {part:.0} %", name.zh), format!("{} {part:.0} %", name.en)), false));
                return;
            }
            Step::Found(from, to) => {
                self.document.cursor = to.min(self.document.rope.len_chars());
                self.told = self.replacing.then(|| {
                    let (with, what) = (&self.text, &self.what);
                    (Said::new(format!("{what} → {with} ？"), format!("{what} → {with} ?")), false)
                });
                let line = self.document.rope.char_to_line(from);
                self.place.left = 0;
                self.place.scroll.by_hand = false;
                self.place.line = line as u32;
            }
            Step::Nothing => {
                self.replacing = false;
                self.refuse(Said::new(format!("没有找到 {}", self.what), format!("{} is not in the text", self.what)));
            }
            Step::Changed(rope, count) => {
                self.document.replace_all(rope);
                self.replacing = false;
                self.told = Some((Said::new(format!("改了 {count} 处"), format!("{count} places changed")), false));
            }
            Step::Refused(why) => self.refuse(why),
        }
        self.work = None;
    }

    pub(super) fn act(&mut self, act: Act, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        if self.work.is_some() && act != Act::Stop || login.is_open() {
            return;
        }
        self.told = None;
        if act.changes() && !self.editing {
            return self.refuse(super::keys::EDIT_FIRST);
        }
        match act {
            Act::Edit if view.snapshot.program.mistaken => {
                self.refuse(Said::new("文件编码不对，不能编辑", "not of a known encoding: not to be edited"));
            }
            Act::Edit => self.wish_edit(out),
            Act::End => self.stop_editing(),
            Act::Board => self.board = !self.board,
            Act::Find => self.begin(Ask::Find),
            Act::Again if self.what.is_empty() => self.begin(Ask::Find),
            Act::Again => self.work = Some(Work::find(&self.what, &self.document)),
            Act::Replace => self.begin(Ask::ReplaceWhat),
            Act::Go => self.begin(Ask::Go),
            Act::Renumber => self.begin(Ask::Renumber),
            Act::First | Act::Last => {
                self.document.go(if act == Act::First { 0 } else { usize::MAX }, 0);
                let row = self.document.place().0;
                self.place.scroll.top = row as f64;
                self.place.scroll.by_hand = true;
            }
            Act::Left => self.edit(Edit::Left, out),
            Act::Right => self.edit(Edit::Right, out),
            Act::Up => self.edit(Edit::Up, out),
            Act::Down => self.edit(Edit::Down, out),
            Act::Save if !self.document.changed => self.told = Some((Said::new("没有改动", "nothing to save"), false)),
            Act::Save => self.save(false, out),
            Act::Discard if !self.document.changed => self.stop_editing(),
            Act::Discard => {
                let name = view.snapshot.title(self.document.number);
                let body = Said::new(format!("{name} 的改动将丢失。"), format!("The changes of {name} will be lost."));
                let title = Text::new("放弃改动？", "discard the changes?");
                let key = ("question-discard", Text::new("放弃", "DISCARD"));
                self.question.ask(About::Discard, Question::new(title, body, key));
            }
            Act::Stop => self.work = None,
            // B5: the core reads the program up to the line and reports the modal state there in the message line.
            Act::Here if self.document.changed => self.refuse(Said::new("先保存改动", "save the changes first")),
            Act::Here => out.push(Command::RestartAt(self.document.place().0 as u32 + 1)),
            Act::Resume => out.push(Command::ResumeInterrupted),
            Act::Design => out.push(Command::OpenPage(Page::Designer)),
            Act::AskDone => self.edit(Edit::Enter, out),
            Act::AskEnd => self.edit(Edit::Cancel, out),
            Act::Undo
            | Act::Redo
            | Act::Mark
            | Act::CopyBlock
            | Act::Cut
            | Act::DeleteBlock
            | Act::Unmark
            | Act::Paste => {
                self.change(act);
            }
            Act::ReplaceThis | Act::Skip | Act::ReplaceAll | Act::EndReplace => self.replace(act),
        }
    }

    fn begin(&mut self, ask: Ask) {
        (self.ask, self.replacing, self.on_keys) = (Some(ask), false, false);
        self.board = true;
        self.text.clear();
        if ask == Ask::Find || ask == Ask::ReplaceWhat {
            self.text.clone_from(&self.what);
        } else if ask == Ask::Renumber {
            self.text = "10 10".to_owned();
        }
    }

    fn change(&mut self, act: Act) {
        let document = &mut self.document;
        match act {
            Act::Undo => drop(document.undo()),
            Act::Redo => drop(document.redo()),
            Act::Mark => document.mark = Some(document.place().0),
            Act::Unmark => document.mark = None,
            Act::CopyBlock | Act::Cut => {
                if document.mark.is_none() {
                    document.mark = Some(document.place().0);
                }
                self.clip = document.copied();
                let count = document.block().map_or(0, |(first, end)| end - first);
                if act == Act::Cut {
                    document.delete_block()
                } else {
                    document.mark = None
                }
                self.told = Some((Said::new(format!("已复制 {count} 行"), format!("{count} lines copied")), false));
            }
            Act::DeleteBlock => document.delete_block(),
            Act::Paste => match &self.clip {
                Some(clip) => document.paste(clip),
                None => self.refuse(Said::new("先复制一块", "copy a block first")),
            },
            _ => {}
        }
        self.keep_in_sight();
    }

    /// Replaces one by one, or all.
    fn replace(&mut self, act: Act) {
        match act {
            Act::ReplaceThis => {
                let length = self.what.chars().count();
                let to = self.document.cursor;
                let with = self.text.clone();
                self.document.replace(to.saturating_sub(length), to, &with);
                self.work = Some(Work::find(&self.what, &self.document));
            }
            Act::Skip => self.work = Some(Work::find(&self.what, &self.document)),
            Act::ReplaceAll => self.work = Some(Work::replace(&self.what, &self.text)),
            _ => self.replacing = false,
        }
    }
}
