//! Parameter list: its lines, search results and cursor moves. Nothing is drawn here.
//! Source: spec B6.

use crate::defs::fitted::Fitted;
use crate::defs::param_row::{ParamRow, ParamType, rows};
use crate::defs::text::Text;

/// What a tab lists.
type ParamFilter = fn(&ParamRow) -> bool;

/// The tabs that filter the list: accessible name, label, what is listed.
pub const FILTERS: [(&str, Text, ParamFilter); 4] = [
    ("params-all", Text::new("全部", "ALL"), |_| true),
    ("params-bits", Text::new("位", "BITS"), |row| row.param_type == ParamType::Bit),
    ("params-numbers", Text::new("数值", "VALUES"), |row| row.param_type == ParamType::Number),
    ("params-ports", Text::new("端口", "PORTS"), |row| {
        matches!(row.param_type, ParamType::Input(_) | ParamType::Output(_))
    }),
];

/// One line of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParamLine {
    /// Parameter number and its bits, bit 7 first, as row indices.
    Bits(u16, [Option<usize>; 8]),
    /// Row index of one number or port.
    Single(usize),
}

impl ParamLine {
    /// The rows of the line, from the left.
    pub fn rows(&self) -> impl Iterator<Item = usize> {
        let (bits, one) = match self {
            Self::Bits(_, bits) => (*bits, None),
            Self::Single(row) => ([None; 8], Some(*row)),
        };
        bits.into_iter().flatten().chain(one)
    }
}

/// Parameters of a machine, and the lines that match tab and search.
#[derive(Debug, Default)]
pub struct ParamList {
    machine: Option<Fitted>,
    /// Index in `FILTERS`.
    filter: usize,
    search: String,
    /// All parameters of the machine.
    pub rows: Vec<ParamRow>,
    /// The lines shown.
    pub lines: Vec<ParamLine>,
    /// Whether each row matches; the other bits of a matching line are shown, too.
    pub matches: Vec<bool>,
}

impl ParamList {
    /// Updates the lines; true if they changed.
    pub fn update(&mut self, machine: Fitted, part: usize, search: &str) -> bool {
        if self.machine == Some(machine) && self.filter == part && self.search == search {
            return false;
        }
        if self.machine != Some(machine) {
            self.rows = rows(machine);
        }
        (self.machine, self.filter) = (Some(machine), part);
        search.clone_into(&mut self.search);
        let wanted = search.trim().to_lowercase();
        self.matches = self.rows.iter().map(|row| (FILTERS[part].2)(row) && matches_search(row, &wanted)).collect();
        self.lines.clear();
        for (index, row) in self.rows.iter().enumerate() {
            match (row.address.bit, self.lines.last_mut()) {
                (Some(bit), Some(ParamLine::Bits(number, bits))) if *number == row.address.number => {
                    bits[7 - usize::from(bit)] = Some(index);
                }
                (Some(bit), _) => {
                    let mut bits = [None; 8];
                    bits[7 - usize::from(bit)] = Some(index);
                    self.lines.push(ParamLine::Bits(row.address.number, bits));
                }
                (None, _) => self.lines.push(ParamLine::Single(index)),
            }
        }
        let found = &self.matches;
        self.lines.retain(|line| line.rows().any(|row| found[row]));
        true
    }

    /// The first row that matches.
    pub fn first(&self) -> Option<usize> {
        self.lines.iter().flat_map(ParamLine::rows).find(|row| self.matches[*row])
    }

    /// The line of a row.
    pub fn line_of(&self, row: usize) -> Option<usize> {
        self.lines.iter().position(|line| line.rows().any(|other| other == row))
    }

    /// The row `lines` further down, on the same bit or the nearest one.
    pub fn row_lines_down(&self, row: usize, lines: isize) -> Option<usize> {
        let here = self.line_of(row)?;
        let there = here.saturating_add_signed(lines).min(self.lines.len().checked_sub(1)?);
        let bit = self.rows[row].address.bit.unwrap_or(7);
        let apart = |other: &usize| self.rows[*other].address.bit.map_or(0, |bit_there| bit_there.abs_diff(bit));
        self.lines[there].rows().min_by_key(apart)
    }

    /// The next or previous row, across lines.
    pub fn adjacent_row(&self, row: usize, forward: bool) -> Option<usize> {
        let all: Vec<usize> = self.lines.iter().flat_map(ParamLine::rows).collect();
        let here = all.iter().position(|other| *other == row)?;
        let there = if forward { (here + 1) % all.len() } else { (here + all.len() - 1) % all.len() };
        all.get(there).copied()
    }
}

/// A number matches from its first digit; a word matches anywhere in either name or in the id.
fn matches_search(row: &ParamRow, wanted: &str) -> bool {
    if wanted.is_empty() {
        return true;
    }
    let number = wanted.strip_prefix('p').unwrap_or(wanted);
    if number.starts_with(|sign: char| sign.is_ascii_digit()) {
        return row.address.to_string()[1..].starts_with(number);
    }
    let id = match row.param_type {
        ParamType::Input(input) => input.id(),
        ParamType::Output(output) => output.id(),
        ParamType::Bit | ParamType::Number => "",
    };
    row.name.zh().contains(wanted) || row.name.en().to_lowercase().contains(wanted) || id.contains(wanted)
}
