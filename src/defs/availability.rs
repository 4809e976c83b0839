//! Which keys, signals, faults, M codes and pages a machine has, and how its kind names them: derived from what is fitted.
//! Source: spec K1, K2.1, K5.3, K7.1, L9.

use super::fitted::Fitted;
use super::key::Key;
use super::kind::Kind;
use super::mcode::MCode;
use super::page::Page;
use super::signal::{Input, Output};
use super::sim_fault::FaultRow;
use super::text::Text;

impl Output {
    /// Whether a machine has the function. Of the functions that share a parameter, a machine has at most one.
    #[must_use]
    pub fn exists_on(self, machine: impl Into<Fitted>) -> bool {
        machine.into().meets(self.needs())
    }
}

impl Input {
    /// Whether a machine has the switch; pages show only those.
    #[must_use]
    pub fn exists_on(self, machine: impl Into<Fitted>) -> bool {
        machine.into().meets(self.needs())
    }
}

impl FaultRow {
    /// Whether a machine can have the fault.
    #[must_use]
    pub fn exists_on(&self, machine: impl Into<Fitted>) -> bool {
        machine.into().meets(self.needs)
    }
}

impl Page {
    /// Whether a machine has the page.
    #[must_use]
    pub fn exists_on(self, machine: impl Into<Fitted>) -> bool {
        let machine = machine.into();
        let has_offsets = machine.kind.dialect().has_tool_offsets() || !matches!(self, Self::Dressing | Self::Offset);
        machine.meets(self.needs()) && has_offsets
    }

    /// The title on a kind.
    #[must_use]
    pub fn title_on(self, kind: Kind) -> Text {
        let own = kind.ui().page_titles.iter().find(|(page, _)| *page == self);
        own.map_or_else(|| self.title(), |(_, title)| *title)
    }
}

/// The M codes of a machine.
pub fn m_codes(machine: impl Into<Fitted>) -> impl Iterator<Item = &'static MCode> {
    let machine = machine.into();
    machine.kind.dialect().m_codes().filter(move |row| machine.meets(row.action.needs()))
}

impl Key {
    /// Whether a machine has the key. Those of the axis Y are dead without it, but the keyboard says why.
    #[must_use]
    pub fn exists_on(self, machine: impl Into<Fitted>) -> bool {
        machine.into().meets(self.row().needs)
    }

    /// The full label on a kind.
    #[must_use]
    pub fn label_on(self, kind: Kind) -> Text {
        let own = kind.ui().key_labels.iter().find(|label| label.key == self);
        own.map_or_else(|| self.label(), |label| label.full)
    }

    /// The label on the panel of a kind: shortened where the group caption gives the context.
    #[must_use]
    pub fn short_label(self, kind: Kind) -> Text {
        let own = kind.ui().key_labels.iter().find(|label| label.key == self);
        own.map_or_else(|| self.short(), |label| label.short)
    }

    /// The label on a key that is too narrow for the short one.
    #[must_use]
    pub fn narrow_label(self, kind: Kind) -> Text {
        match self {
            Self::SecondSpindle => Text::new("主轴 2", "SP 2"),
            Self::DressReturn => Text::new("修整点", "POINT"),
            Self::WheelRetract => Text::new("回退", "RETR"),
            Self::Magnetise => Text::new("充磁", "MAG"),
            _ => self.short_label(kind),
        }
    }

    /// The key of an id or of a Chinese label (full or short) that a machine of a kind can have; an ambiguous label gives
    /// `None`.
    #[must_use]
    pub fn from_word(word: &str, kind: Kind) -> Option<Self> {
        let on_kind = || Self::ALL.iter().copied().filter(move |key| key.exists_on(Fitted::fully(kind)));
        let only = |text: fn(Self, Kind) -> Text| {
            let mut matches = on_kind().filter(|key| text(*key, kind).zh == word);
            matches.next().filter(|_| matches.next().is_none())
        };
        let plain = on_kind().find(|key| key.id() == word).or_else(|| only(|key, _| key.label()));
        plain.or_else(|| only(Self::label_on)).or_else(|| only(Self::short_label))
    }
}
