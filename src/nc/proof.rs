//! Proving a program before it starts, a piece in each tick: nothing moves in a program whose text is wrong anywhere.
//!
//! A language without variables is followed to its end as the check follows it. One with R parameters is read for its
//! writing, with all that it calls: what its values bring about is known in the run alone. Macros are not proved.
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

/// Blocks or lines that one call looks at.
const PIECE: u32 = 500;
/// Blocks without a new line after which a loop is left alone: they take a fifth of a second.
const LIMIT: u32 = 100_000;
/// Most texts that are read for one program.
const TEXTS: usize = 100;

/// A proof under way.
pub struct Proof(Manner);

enum Manner {
    Whole(Box<Checking>, Box<CheckWorld>),
    Text(Box<Texts>),
}

/// The texts that a program calls, its own first.
struct Texts {
    settings: Settings,
    library: Arc<dyn Library + Send + Sync>,
    source: Arc<Source>,
    unread: Unread,
    waiting: Vec<u32>,
    seen: HashSet<u32>,
    /// The text as a whole is looked at first.
    begun: bool,
}

/// What one piece came to.
#[derive(Clone, Debug)]
pub enum Proved {
    /// Ask again.
    Busy,
    /// Nothing is wrong.
    Clean,
    /// The program must not start.
    Wrong(Fault),
}

impl Proof {
    /// Begins; none for a language that cannot be proved. The world stands where the program starts.
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

    /// Looks at the next piece.
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
