//! Preflight check before program start, one piece per tick: a program with a mistake anywhere does not start.
//!
//! A dialect without variables (超人) is followed to its end, as in a check. In a dialect with R parameters only the
//! syntax is checked, with all called programs: values are known only in the run. Macro programs are not checked.
//! Source: spec L1, L2, L5, L7, S1.

use std::collections::HashSet;
use std::sync::Arc;

use super::check::Checking;
use super::dialect::{self, Provable};
use super::fault::Fault;
use super::memory::Memory;
use super::settings::Settings;
use super::source::{Library, Source};
use super::unread::{self, Unread};
use super::world::CheckWorld;

/// Blocks or lines per call.
const PIECE: u32 = 500;
/// Blocks without a new line after which a loop counts as endless; they take 0.2 s.
const LIMIT: u32 = 100_000;
/// Most texts that are read for one program.
const TEXTS: usize = 100;

/// A preflight check in progress.
pub struct Proof(Manner);

enum Manner {
    Whole(Box<Checking>, Box<CheckWorld>),
    Text(Box<Texts>),
}

/// Syntax check of a program's text and the texts that it calls.
struct Texts {
    settings: Settings,
    library: Arc<dyn Library + Send + Sync>,
    source: Arc<Source>,
    unread: Unread,
    waiting: Vec<u32>,
    seen: HashSet<u32>,
    /// The check of the text as a whole is done.
    begun: bool,
}

/// The result of one piece.
#[derive(Clone, Debug)]
pub enum Proved {
    /// Call again.
    Busy,
    /// No mistake was found.
    Clean,
    /// The program must not start.
    Wrong(Fault),
}

impl Proof {
    /// Starts a preflight; none for a dialect that has none. `world` is the state at program start.
    #[must_use]
    pub fn new(
        source: &Arc<Source>,
        library: &Arc<dyn Library + Send + Sync>,
        settings: &Settings,
        world: CheckWorld,
    ) -> Option<Self> {
        Some(Self(match dialect::provable(settings) {
            Provable::Whole => {
                let checking = Checking::new(source, library, settings, Memory::default()).with_limit(LIMIT);
                Manner::Whole(Box::new(checking), Box::new(world))
            }
            Provable::Text => Manner::Text(Box::new(Texts {
                settings: settings.clone(),
                library: Arc::clone(library),
                source: Arc::clone(source),
                unread: Unread::new(source.line_count()),
                waiting: Vec::new(),
                seen: HashSet::from([source.number()]),
                begun: false,
            })),
            Provable::No => return None,
        }))
    }

    /// Checks the next piece.
    pub fn advance(&mut self) -> Proved {
        match &mut self.0 {
            Manner::Whole(checking, world) => {
                let more = checking.advance(world, &mut |_| true, PIECE);
                match checking.faults().first() {
                    Some(fault) => Proved::Wrong(fault.clone()),
                    None if more => Proved::Busy,
                    None => Proved::Clean,
                }
            }
            Manner::Text(texts) => texts.advance(),
        }
    }
}

impl Texts {
    fn advance(&mut self) -> Proved {
        let mut first = None;
        if !std::mem::replace(&mut self.begun, true) {
            first = unread::whole(&self.source, &self.settings).next();
        }
        let text = (&*self.source, &self.settings);
        let more = self.unread.advance(text, Some(&*self.library), PIECE, &mut |fault| {
            first.get_or_insert(fault);
        });
        if let Some(fault) = first {
            return Proved::Wrong(fault);
        }
        if more {
            return Proved::Busy;
        }
        self.waiting.extend(self.unread.calls.drain(..).map(|(number, _)| number));
        while let Some(number) = self.waiting.pop() {
            if self.seen.len() < TEXTS
                && self.seen.insert(number)
                && let Some(source) = self.library.find(number)
            {
                (self.unread, self.source, self.begun) = (Unread::new(source.line_count()), source, false);
                return Proved::Busy;
            }
        }
        Proved::Clean
    }
}
