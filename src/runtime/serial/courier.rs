//! Transfers programs between line and folder. Received programs are checked completely; before files are overwritten
//! the operator is asked; stored files are read back.
//! Source: spec L9, K7.8.

use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

use super::Trouble;
use super::line::Line;
use super::sheet::{Sheet, outgoing};
use crate::defs::text::{Said, Text};
use crate::link::files::{FileAnswer, Refusal};
use crate::link::media::{Direction, Transfer};
use crate::store::{FolderError, Shelf, stamp};

const SENDING: Text = Text::new("正在发送", "sending");
const RECEIVING: Text = Text::new("正在接收，请在对方启动发送", "receiving: start sending on the other side");

/// Sends and receives programs.
pub struct Courier<'a> {
    /// The folder.
    pub shelf: &'a Shelf,
    /// Programs have names instead of numbers.
    pub named: bool,
    /// The line.
    pub line: &'a Line,
    /// Cancels the transfer.
    pub cancelled: &'a AtomicBool,
    /// Received programs that wait for the answer whether to overwrite.
    pub held: &'a Mutex<Vec<Sheet>>,
}

impl Courier<'_> {
    /// Sends or receives.
    ///
    /// # Errors
    /// Why nothing, or not everything, was transferred.
    pub fn carry(&self, ask: &Transfer, tell: &mut dyn FnMut(FileAnswer)) -> Result<FileAnswer, Refusal> {
        match ask.direction {
            Direction::Out => self.send(&ask.names, tell),
            Direction::In => self.receive(ask, tell),
        }
    }

    fn send(&self, names: &[String], tell: &mut dyn FnMut(FileAnswer)) -> Result<FileAnswer, Refusal> {
        let refused = |error: &FolderError| Refusal::from(Trouble::Store(said(error)));
        if names.is_empty() {
            return Err(Refusal::Because(Said::new("请先选择要发送的程序", "choose the programs to send first")));
        }
        let mut sheets = Vec::new();
        for name in names {
            let read = self.shelf.read(name).map_err(|error| refused(&error))?;
            sheets.push(Sheet { name: read.name, text: read.bytes });
        }
        let bytes = outgoing(&sheets, self.line.leader, self.named)?;
        let all = bytes.len().max(1) as u64;
        self.line.send(&bytes, self.cancelled, &mut |sent| {
            tell(FileAnswer::Progress(SENDING, (sent * 1_000 / all) as u16));
        })?;
        let (count, kilobytes) = (sheets.len(), bytes.len().div_ceil(1_024));
        Ok(FileAnswer::Done(Said::new(
            format!("已发送 {count} 个程序，{kilobytes} kB"),
            format!("{count} programs sent, {kilobytes} kB"),
        )))
    }

    fn receive(&self, ask: &Transfer, tell: &mut dyn FnMut(FileAnswer)) -> Result<FileAnswer, Refusal> {
        let sheets = match ask.overwrite {
            None => self.take(ask, tell)?,
            Some(_) => std::mem::take(&mut *self.held.lock().unwrap_or_else(std::sync::PoisonError::into_inner)),
        };
        if sheets.is_empty() {
            return Err(Refusal::Because(Said::new("请重新接收", "receive it once more")));
        }
        let clashes = |sheet: &Sheet| match self.shelf.read(&sheet.name) {
            Ok(old) => stamp(&old.bytes) != stamp(&sheet.text),
            // A folder or a link is never overwritten; writing reports it.
            Err(FolderError::Missing { .. } | FolderError::NotPlain { .. }) => false,
            // An unreadable file exists nevertheless.
            Err(_) => true,
        };
        let clashing: Vec<String> =
            sheets.iter().filter(|sheet| clashes(sheet)).map(|sheet| sheet.name.clone()).collect();
        if ask.overwrite.is_none() && !clashing.is_empty() {
            *self.held.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = sheets;
            return Err(Refusal::Overwrite(clashing));
        }
        let mut stored = Vec::new();
        for sheet in sheets.iter().filter(|sheet| ask.overwrite == Some(true) || !clashing.contains(&sheet.name)) {
            stored.push(self.store(sheet, &stored)?);
        }
        let names = stored.join(" ");
        Ok(FileAnswer::Done(match stored.is_empty() {
            true => Said::new("未改动", "nothing was changed"),
            false => Said::new(format!("已接收并保存 {names}"), format!("received and stored: {names}")),
        }))
    }

    fn take(&self, ask: &Transfer, tell: &mut dyn FnMut(FileAnswer)) -> Result<Vec<Sheet>, Trouble> {
        tell(FileAnswer::Bytes(RECEIVING, 0));
        let reader = self.line.receive(self.cancelled, &mut |bytes| tell(FileAnswer::Bytes(RECEIVING, bytes)))?;
        reader.finish(ask.names.first().map(String::as_str), self.shelf, self.named)
    }

    /// Stores a program atomically and reads it back.
    fn store(&self, sheet: &Sheet, before: &[String]) -> Result<String, Trouble> {
        let failed = |said: Said| {
            let (zh, en) = match before.is_empty() {
                true => (String::new(), String::new()),
                false => (format!("；已保存 {}", before.join(" ")), format!("; stored before: {}", before.join(" "))),
            };
            Trouble::Store(Said::new(format!("{}{zh}", said.zh), format!("{}{en}", said.en)))
        };
        let name = self.shelf.write(&sheet.name, &sheet.text).map_err(|error| failed(said(&error)))?;
        let back = self.shelf.read(&name).map_err(|error| failed(said(&error)))?;
        if stamp(&back.bytes) == stamp(&sheet.text) {
            return Ok(name);
        }
        Err(failed(Said::new(format!("{name} 校验不符"), format!("{name} does not read back"))))
    }
}

fn said(error: &FolderError) -> Said {
    crate::runtime::office::refused(error).said()
}
