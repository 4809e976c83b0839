//! Which axes, keys, signals, M codes and pages a kind of machine has, and how it names them: derived from its row.
//! Source: spec K1, K2.1, K5.3, K7.1, L9.

use super::key::Key;
use super::kind::{Kind, KindRow};
use super::mcode::MCode;
use super::page::Page;
use super::param::{self, Params};
use super::signal::{Input, Output};
use super::text::Text;
use crate::units::{Axis, PerAxis};

impl KindRow {
    /// The axes of a machine of this kind with these parameters.
    #[must_use]
    pub fn fitted(&self, params: &Params) -> PerAxis<bool> {
        PerAxis::from_fn(|axis| self.axes[axis] || axis == Axis::Y && params.bit(param::Y_FITTED))
    }
}

impl Output {
    /// Whether a kind has the function. Of the functions that share a parameter, a kind has at most one.
    #[must_use]
    pub fn exists_on(self, kind: Kind) -> bool {
        kind.row().meets(self.needs())
    }
}

impl Input {
    /// Whether a kind has the switch; pages show only those.
    #[must_use]
    pub fn exists_on(self, kind: Kind) -> bool {
        kind.row().meets(self.needs())
    }
}

impl Page {
    /// Whether a kind has the page.
    #[must_use]
    pub fn exists_on(self, kind: Kind) -> bool {
        let has_offsets = kind.dialect().has_tool_offsets() || !matches!(self, Self::Dressing | Self::Offset);
        kind.row().meets(self.needs()) && has_offsets
    }

    /// The title on a kind.
    #[must_use]
    pub fn title_on(self, kind: Kind) -> Text {
        let own = kind.ui().page_titles.iter().find(|(page, _)| *page == self);
        own.map_or_else(|| self.title(), |(_, title)| *title)
    }
}

/// The M codes of a kind of machine.
pub fn m_codes(kind: Kind) -> impl Iterator<Item = &'static MCode> {
    kind.dialect().m_codes().filter(move |row| kind.row().meets(row.action.needs()))
}

impl Key {
    /// Whether a kind has the key.
    #[must_use]
    pub fn exists_on(self, kind: Kind) -> bool {
        kind.row().meets(self.row().needs)
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

    /// The key of an id or of a Chinese label (full or short) on a kind; an ambiguous label gives `None`.
    #[must_use]
    pub fn from_word(word: &str, kind: Kind) -> Option<Self> {
        let on_kind = || Self::ALL.iter().copied().filter(move |key| key.exists_on(kind));
        let only = |text: fn(Self, Kind) -> Text| {
            let mut matches = on_kind().filter(|key| text(*key, kind).zh == word);
            matches.next().filter(|_| matches.next().is_none())
        };
        let plain = on_kind().find(|key| key.id() == word).or_else(|| only(|key, _| key.label()));
        plain.or_else(|| only(Self::label_on)).or_else(|| only(Self::short_label))
    }
}
