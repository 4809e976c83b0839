//! The file requests and long calculations that a page has started, and the answers to them. Every page has its own
//! list; answers to other pages or to older requests are ignored.
//! Source: spec H8, K7.8.

use super::{Login, Question, View};
use crate::defs::text::{Text, phrase};
use crate::link::Command;
use crate::link::files::{Completion, FileRequest, FilesView, Refusal, Requester, Ticket};
use crate::link::page_command::{PageCommand, PasswordScope};

/// Maximum number of pending requests. An answer can be missing if the command queue was full.
const MAX_PENDING: usize = 8;

/// A request that is sent without waiting for an answer.
pub const fn file_command(requester: Requester, request: FileRequest) -> Command {
    Command::Page(PageCommand::File(Ticket::without_reply(requester), request))
}

/// The pending requests of a page, oldest first, each with its reason.
#[derive(Debug)]
pub struct PendingRequests<W> {
    last: u32,
    waiting: Vec<(u32, W)>,
    /// The password dialog is open for a request (K6.2).
    password_asked: bool,
}

/// What a page that edits a text receives.
#[derive(Debug)]
pub enum RequestEvent<W> {
    /// The password was accepted: the request can be repeated.
    Unlocked,
    /// An answer.
    Answer(W, Result<Completion, Refusal>),
}

impl<W> Default for PendingRequests<W> {
    fn default() -> Self {
        Self { last: 0, waiting: Vec::new(), password_asked: false }
    }
}

impl<W> PendingRequests<W> {
    /// Creates a request; [`Self::poll`] returns the reason with the answer.
    pub fn send(&mut self, requester: Requester, why: W, request: FileRequest) -> Command {
        if self.waiting.len() >= MAX_PENDING {
            self.waiting.remove(0);
        }
        self.last = self.last.wrapping_add(1);
        self.waiting.push((self.last, why));
        Command::Page(PageCommand::File(Ticket { requester, number: self.last }, request))
    }

    /// Whether an answer is pending.
    pub const fn is_waiting(&self) -> bool {
        !self.waiting.is_empty()
    }

    /// The next answer to a request of this page.
    pub fn poll(&mut self, requester: Requester, files: &FilesView) -> Option<(W, Result<Completion, Refusal>)> {
        let own = files.answers.iter().filter(|answer| answer.ticket.requester == requester);
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

    /// The next answer; opens the password dialog if the program password is required (K6.2).
    pub fn poll_protected(&mut self, from: Requester, view: &View<'_>, login: &mut Login) -> Option<RequestEvent<W>> {
        if self.password_asked && !login.is_open() {
            self.password_asked = false;
            if view.snapshot.access.program_unlocked {
                return Some(RequestEvent::Unlocked);
            }
        }
        let (why, answer) = self.poll(from, &view.snapshot.files)?;
        if answer == Err(Refusal::Password) {
            self.password_asked = true;
            login.unlock(view, PasswordScope::Program);
            return None;
        }
        Some(RequestEvent::Answer(why, answer))
    }
}

/// Index of the overwrite key in [`conflict_question`].
pub const OVERWRITE_KEY: usize = 0;

/// The question for a text that was changed on the disk since it was opened: overwrite it, read the disk, or cancel.
pub fn conflict_question() -> Question {
    let body = phrase!(
        "打开之后磁盘上的文件已被改动。读磁盘：放弃这里的改动；覆盖：别处的改动丢失；取消：两者都保留。",
        "The file on the disk was changed after it was opened. READ DISK discards the changes made here, OVERWRITE those on the disk; CANCEL keeps both."
    );
    let keys =
        [("question-overwrite", Text::new("覆盖", "OVERWRITE")), ("question-read", Text::new("读磁盘", "READ DISK"))];
    Question::with_keys(Text::new("文件已被别处改动", "the file was changed elsewhere"), body, &keys)
}

/// The text of the disk has replaced the changed one.
pub const READ_FROM_DISK: Text = Text::new("已读磁盘上的文件", "read from the disk");

/// Asks whether the changes of a text are discarded.
pub fn discard_question(name: &str) -> Question {
    let body = phrase!("{name} 的改动将丢失。", "The changes to {name} will be lost.", name);
    let key = ("question-discard", Text::new("放弃", "DISCARD"));
    Question::new(Text::new("放弃改动？", "discard the changes?"), body, key)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: Requester = Requester::Transfer;

    fn ticket(command: &Command) -> Ticket {
        match command {
            Command::Page(PageCommand::File(ticket, _)) => *ticket,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn h8_every_answer_comes_to_its_own_request_in_any_order() {
        let (mut asking, mut view) = (PendingRequests::default(), FilesView::default());
        // An earlier screen has already sent request 1.
        view.add_answer(Ticket { requester: PAGE, number: 1 }, Ok(Completion::default()));
        assert!(asking.poll(PAGE, &view).is_none());
        let first = ticket(&asking.send(PAGE, 1, FileRequest::ListMedia));
        let second = ticket(&asking.send(PAGE, 2, FileRequest::ListMedia));
        assert!(first.number == 2 && second.number == 3 && asking.is_waiting());
        view.add_answer(Ticket { requester: Requester::Editor, number: first.number }, Err(Refusal::Conflict));
        assert!(asking.poll(PAGE, &view).is_none(), "another page's answer");
        view.add_answer(second, Err(Refusal::Password));
        view.add_answer(first, Ok(Completion::default()));
        assert_eq!(asking.poll(PAGE, &view), Some((2, Err(Refusal::Password))));
        assert_eq!(asking.poll(PAGE, &view), Some((1, Ok(Completion::default()))));
        assert!(asking.poll(PAGE, &view).is_none() && !asking.is_waiting(), "each one once");
    }
}
