//! Transfers programs between line and folder. Received programs are checked completely; before files are overwritten
//! the operator is asked; stored files are read back.
//! Source: spec L9, K7.8.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::SerialError;
use super::format::{SerialProgram, encode_transmission};
use super::port::{SerialLine, SerialWait};
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::host::job_answer::{JobResult, Tell, done, refusal};
use crate::link::files::{FileAnswer, Refusal};
use crate::link::media::{Direction, TransferRequest};
use crate::store::{FolderError, ProgramFolder, stamp};

const SENDING: Text = Text::new("正在发送", "sending");
const RECEIVING: Text = Text::new("正在接收，请在对方启动发送", "receiving: start sending on the other side");

/// Sends and receives programs.
pub struct SerialTransfer<'a> {
    /// The folder.
    pub folder: &'a ProgramFolder,
    /// Programs have names instead of numbers.
    pub by_name: bool,
    /// The line.
    pub port: &'a SerialLine,
    /// What ends a wait for the other side.
    pub wait: SerialWait<'a>,
    /// Received programs that wait for the answer whether to overwrite.
    pub received: &'a Mutex<Vec<SerialProgram>>,
}

impl SerialTransfer<'_> {
    /// Sends or receives.
    ///
    /// # Errors
    /// Why nothing, or not everything, was transferred.
    pub fn run(&self, ask: &TransferRequest, tell: &mut dyn FnMut(FileAnswer)) -> JobResult {
        match ask.direction {
            Direction::Export => self.send(&ask.names, tell),
            Direction::Import => self.receive(ask, tell),
        }
    }

    fn send(&self, names: &[String], tell: Tell<'_>) -> JobResult {
        if names.is_empty() {
            return Err(refusal("请先选择要发送的程序", "choose the programs to send first"));
        }
        let mut sheets = Vec::new();
        for name in names {
            let read = self.folder.read(name).map_err(|error| SerialError::NotStored(error.message()))?;
            sheets.push(SerialProgram { name: read.name, text: read.bytes });
        }
        let bytes = encode_transmission(&sheets, self.port.leader, self.by_name)?;
        let all = bytes.len().max(1) as u64;
        self.port.send(&bytes, self.wait, &mut |sent| {
            tell(FileAnswer::Progress(SENDING, (sent * 1_000 / all) as u16));
        })?;
        let (count, kilobytes) = (sheets.len(), bytes.len().div_ceil(1_024));
        let zh = format!("已发送 {count} 个程序，{kilobytes} kB");
        Ok(done(zh, format!("{count} programs sent, {kilobytes} kB")))
    }

    fn receive(&self, ask: &TransferRequest, tell: Tell<'_>) -> JobResult {
        let sheets = match ask.overwrite {
            None => self.receive_programs(ask, tell)?,
            Some(_) => std::mem::take(&mut *self.waiting()),
        };
        if sheets.is_empty() {
            return Err(refusal("请重新接收", "receive it once more"));
        }
        let clashes = |sheet: &SerialProgram| match self.folder.read(&sheet.name) {
            Ok(old) => stamp(&old.bytes) != stamp(&sheet.text),
            // A folder or a link is never overwritten; writing reports it.
            Err(FolderError::Missing { .. } | FolderError::NotRegular { .. }) => false,
            // An unreadable file exists nevertheless.
            Err(_) => true,
        };
        let clashing: Vec<String> =
            sheets.iter().filter(|sheet| clashes(sheet)).map(|sheet| sheet.name.clone()).collect();
        if ask.overwrite.is_none() && !clashing.is_empty() {
            *self.waiting() = sheets;
            return Err(Refusal::Overwrite(clashing));
        }
        let mut stored = Vec::new();
        for sheet in sheets.iter().filter(|sheet| ask.overwrite == Some(true) || !clashing.contains(&sheet.name)) {
            stored.push(self.store(sheet, &stored)?);
        }
        let names = stored.join(" ");
        Ok(match stored.is_empty() {
            true => done("未改动", "nothing was changed"),
            false => done(format!("已接收并保存 {names}"), format!("received and stored: {names}")),
        })
    }

    /// Received programs that wait for an answer.
    fn waiting(&self) -> MutexGuard<'_, Vec<SerialProgram>> {
        self.received.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn receive_programs(&self, ask: &TransferRequest, tell: Tell<'_>) -> Result<Vec<SerialProgram>, SerialError> {
        tell(FileAnswer::BytesReceived(RECEIVING, 0));
        let reader = self.port.receive(self.wait, &mut |bytes| tell(FileAnswer::BytesReceived(RECEIVING, bytes)))?;
        reader.into_programs(ask.names.first().map(String::as_str), self.folder, self.by_name)
    }

    /// Stores a program atomically and reads it back.
    fn store(&self, sheet: &SerialProgram, before: &[String]) -> Result<String, SerialError> {
        let failed = |message: LocalizedText| {
            let (zh, en) = match before.is_empty() {
                true => (String::new(), String::new()),
                false => (format!("；已保存 {}", before.join(" ")), format!("; stored before: {}", before.join(" "))),
            };
            SerialError::NotStored(LocalizedText::new(format!("{}{zh}", message.zh()), format!("{}{en}", message.en())))
        };
        let name = self.folder.write(&sheet.name, &sheet.text).map_err(|error| failed(error.message()))?;
        let back = self.folder.read(&name).map_err(|error| failed(error.message()))?;
        if stamp(&back.bytes) == stamp(&sheet.text) {
            return Ok(name);
        }
        Err(failed(phrase!("{name} 校验不符", "{name} failed verification", name)))
    }
}
