//! The file requests and long calculations that a page has started, and the answers to them. Every page has its own
//! list; answers to other pages or to older requests are ignored.
//! Source: spec H8, K7.8.

use super::login::Login;
use super::question::Question;
use super::view::View;
use crate::defs::text::{Said, Text};
use crate::link::Command;
use crate::link::files::{Asker, Deed, FileRequest, FilesView, Refusal, Ticket};
use crate::link::page_command::{Guard, PageCommand};

/// Maximum number of pending requests. An answer can be missing if the command queue was full.
const WAITING: usize = 8;

/// The reason of a request, returned with its answer.
pub trait Why {
    /// The page that sends the request.
    const ASKER: Asker;
}

/// The pending requests of a page, oldest first.
#[derive(Debug)]
pub struct Asking<W> {
    last: u32,
    waiting: Vec<(u32, W)>,
}

impl<W> Default for Asking<W> {
    fn default() -> Self {
        Self { last: 0, waiting: Vec::new() }
    }
}

impl<W: Why> Asking<W> {
    /// Creates a request; [`Self::hear`] returns the reason with the answer.
    pub fn ask(&mut self, why: W, request: FileRequest) -> Command {
        if self.waiting.len() >= WAITING {
            self.waiting.remove(0);
        }
        self.last = self.last.wrapping_add(1);
        self.waiting.push((self.last, why));
        Command::Page(PageCommand::File(Ticket { asker: W::ASKER, number: self.last }, request))
    }

    /// Whether an answer is pending.
    #[must_use]
    pub const fn waits(&self) -> bool {
        !self.waiting.is_empty()
    }

    /// The next answer to a request of this page.
    pub fn hear(&mut self, files: &FilesView) -> Option<(W, Result<Deed, Refusal>)> {
        let own = files.answers.iter().filter(|answer| answer.ticket.asker == W::ASKER);
        for answer in own {
            let number = answer.ticket.number;
            // The core may have answered an earlier screen: continue after its numbers.
            self.last = self.last.max(number);
            if let Some(at) = self.waiting.iter().position(|(waiting, _)| *waiting == number) {
                return Some((self.waiting.remove(at).1, answer.result.clone()));
            }
        }
        None
    }
}

/// The requests of a page that edits a text; they may need the program password first (K6.2).
#[derive(Debug)]
pub struct Guarded<W> {
    asking: Asking<W>,
    /// The password dialog is open.
    password: bool,
}

impl<W> Default for Guarded<W> {
    fn default() -> Self {
        Self { asking: Asking::default(), password: false }
    }
}

/// What a page that edits a text receives.
#[derive(Debug)]
pub enum Heard<W> {
    /// The password was accepted: the request can be repeated.
    Open,
    /// An answer.
    Answer(W, Result<Deed, Refusal>),
}

impl<W: Why> Guarded<W> {
    /// Creates a request; [`Self::hear`] returns the reason with the answer.
    pub fn ask(&mut self, why: W, request: FileRequest) -> Command {
        self.asking.ask(why, request)
    }

    /// The next answer; opens the password dialog if the password is required.
    pub fn hear(&mut self, view: &View<'_>, login: &mut Login) -> Option<Heard<W>> {
        if self.password && !login.is_open() {
            self.password = false;
            if view.snapshot.access.program {
                return Some(Heard::Open);
            }
        }
        let (why, answer) = self.asking.hear(&view.snapshot.files)?;
        if answer == Err(Refusal::Password) {
            self.password = true;
            login.unlock(view, Guard::Program);
            return None;
        }
        Some(Heard::Answer(why, answer))
    }
}

/// Index of the overwrite key in [`conflict`].
pub const OVERWRITE: usize = 0;

/// The question for a text that was changed on the disk since it was opened: overwrite it, read the disk, or cancel.
#[must_use]
pub fn conflict() -> Question {
    let body = Said::new(
        "打开之后磁盘上的文件已被改动。读磁盘：放弃这里的改动；覆盖：别处的改动丢失；取消：两者都保留。",
        "The file was changed on the disk since it was opened. READ DISK drops the changes made here, OVERWRITE those made there; with CANCEL both stay.",
    );
    let keys =
        [("question-overwrite", Text::new("覆盖", "OVERWRITE")), ("question-read", Text::new("读磁盘", "READ DISK"))];
    Question::of(Text::new("文件已被别处改动", "the file was changed elsewhere"), body, &keys)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq)]
    struct Copying(u8);

    impl Why for Copying {
        const ASKER: Asker = Asker::Transfer;
    }

    fn ticket(command: &Command) -> Ticket {
        match command {
            Command::Page(PageCommand::File(ticket, _)) => *ticket,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn h8_every_answer_comes_to_its_own_request_in_any_order() {
        let (mut asking, mut view) = (Asking::default(), FilesView::default());
        // An earlier screen has already sent request 1.
        view.answer(Ticket { asker: Asker::Transfer, number: 1 }, Ok(Deed::default()));
        assert!(asking.hear(&view).is_none());
        let first = ticket(&asking.ask(Copying(1), FileRequest::Media));
        let second = ticket(&asking.ask(Copying(2), FileRequest::Media));
        assert!(first.number == 2 && second.number == 3 && asking.waits());
        view.answer(Ticket { asker: Asker::Editor, number: first.number }, Err(Refusal::Conflict));
        assert!(asking.hear(&view).is_none(), "another page's answer");
        view.answer(second, Err(Refusal::Password));
        view.answer(first, Ok(Deed::default()));
        assert_eq!(asking.hear(&view), Some((Copying(2), Err(Refusal::Password))));
        assert_eq!(asking.hear(&view), Some((Copying(1), Ok(Deed::default()))));
        assert!(asking.hear(&view).is_none() && !asking.waits(), "each one once");
    }
}
