//! The dialects of the programs: what the tables hold for each is one row. `nc::dialect` reads and executes them.
//! Source: spec K1, L1–L8, S1.

use super::dialect_word::{self, DialectWord};
use super::language_row::{self, LanguageRow};
use super::mcode::{self, MCode};

/// What the tables hold for a dialect. There is no default: a new dialect answers every question.
struct DialectTables {
    /// G codes of the `gcode` table; the other dialects have their own words.
    kt830: bool,
    /// Of them the milling dialect: G90 and G91 are modal (GS, GA).
    mill: bool,
    /// T selects a tool offset (S1: not in SINUMERIK programs).
    tool_offsets: bool,
    /// R parameters exist, and round brackets belong to expressions (S1).
    r_parameters: bool,
    /// The words; empty with the `gcode` table.
    words: &'static [DialectWord],
    /// Statements, operators and further words: common ones, and its own.
    language: [&'static [LanguageRow]; 2],
    /// The M codes: a table, what comes with it, and the codes of both that the dialect does not have.
    m_codes: [&'static [MCode]; 2],
    excluded_m_codes: &'static [u16],
}

const KT830: DialectTables = DialectTables {
    kt830: true,
    mill: false,
    tool_offsets: true,
    r_parameters: false,
    words: dialect_word::GRINDER,
    language: [language_row::GRINDER, language_row::LATHE_A],
    m_codes: [mcode::MCODES, &[]],
    excluded_m_codes: &[],
};

macro_rules! dialects {
    ($($(#[$doc:meta])* $dialect:ident = $tables:expr;)*) => {
        /// The dialect of the programs.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Dialect { $($(#[$doc])* $dialect,)* }

        impl Dialect {
            const fn tables(self) -> &'static DialectTables {
                match self { $(Self::$dialect => const { &$tables },)* }
            }
        }
    };
}

dialects! {
    /// GC: U, V, W are incremental; G90 and G94 are cycles.
    LatheA = KT830;
    /// GS and GA: G90 and G91 are modal; U, V, W are incremental as well.
    Mill = DialectTables { mill: true, language: [language_row::GRINDER, language_row::MILL], ..KT830 };
    /// SINUMERIK 802D: R parameters, `X=R20`, labels, G90 and G91 modal (S1).
    Sinumerik = DialectTables {
        kt830: false,
        mill: false,
        tool_offsets: false,
        r_parameters: true,
        words: dialect_word::SINUMERIK,
        language: [language_row::SINUMERIK, &[]],
        m_codes: [mcode::MCODES, mcode::EXTRA_802D],
        excluded_m_codes: mcode::EXCLUDED_802D,
    };
    /// 超人 (SuperMan) lathe: X, Z absolute, U, W incremental, all X words diameters (L1–L8).
    SuperMan = DialectTables {
        kt830: false,
        mill: false,
        tool_offsets: true,
        r_parameters: false,
        words: dialect_word::SUPERMAN,
        language: [language_row::SUPERMAN, &[]],
        m_codes: [mcode::LATHE_MCODES, &[]],
        excluded_m_codes: &[],
    };
}

impl Dialect {
    /// The milling dialect: G90 and G91 are modal (GS, GA).
    #[must_use]
    pub const fn is_mill(self) -> bool {
        self.tables().mill
    }

    /// It uses the G codes of the `gcode` table; the other dialects have their own words.
    #[must_use]
    pub const fn is_kt830(self) -> bool {
        self.tables().kt830
    }

    /// T selects a tool offset.
    #[must_use]
    pub const fn has_tool_offsets(self) -> bool {
        self.tables().tool_offsets
    }

    /// Round brackets enclose comments. With R parameters they belong to expressions (S1).
    #[must_use]
    pub const fn has_bracket_comments(self) -> bool {
        !self.has_r_parameters()
    }

    /// R parameters exist, and round brackets belong to expressions.
    #[must_use]
    pub const fn has_r_parameters(self) -> bool {
        self.tables().r_parameters
    }

    /// Its words beside those of the `gcode` table.
    #[must_use]
    pub const fn words(self) -> &'static [DialectWord] {
        self.tables().words
    }

    /// Its statements, operators and words beside the codes.
    pub fn language_rows(self) -> impl Iterator<Item = &'static LanguageRow> {
        self.tables().language.into_iter().flatten()
    }

    /// Its M codes.
    pub fn m_codes(self) -> impl Iterator<Item = &'static MCode> {
        let tables = self.tables();
        tables.m_codes.into_iter().flatten().filter(|row| !tables.excluded_m_codes.contains(&row.code))
    }

    /// The row of an M code.
    #[must_use]
    pub fn m_code(self, code: u16) -> Option<&'static MCode> {
        self.m_codes().find(|row| row.code == code)
    }
}
