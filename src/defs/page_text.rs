//! The page text of a grinding program (C00nn.TXT) and its English text (C00nn.EN.TXT): format and parser.
//! Source: spec K7.2–K7.4, H9. Parses text only; `store` reads the files.

use super::text::{Lang, LocalizedText};
use super::variable_name;

/// Rows of one column.
pub const COLUMN_ROWS: usize = 10;

/// One row of the page: a label and its macro variable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PageTextRow {
    /// Label as written by the customer.
    pub label: String,
    /// Label of the English text, if it has one.
    pub english: Option<String>,
    /// Macro variable number.
    pub variable: u16,
}

impl PageTextRow {
    /// The label in a language; as written by the customer where there is no English.
    #[must_use]
    pub fn label_in(&self, lang: Lang) -> &str {
        lang.pick_of(&self.label, self.english.as_deref())
    }
}

/// A page text: a title and two columns of ten rows; rows may be empty.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PageText {
    /// Title; the page appends 参数设置.
    pub title: String,
    /// Title of the English text, if there is one.
    pub english_title: Option<String>,
    /// Left column.
    pub left: [Option<PageTextRow>; COLUMN_ROWS],
    /// Right column.
    pub right: [Option<PageTextRow>; COLUMN_ROWS],
}

impl PageText {
    /// The rows in reading order: left column, then right.
    pub fn rows(&self) -> impl Iterator<Item = &PageTextRow> {
        self.left.iter().chain(self.right.iter()).flatten()
    }

    /// The title in a language; as written by the customer where there is no English.
    #[must_use]
    pub fn title_in(&self, lang: Lang) -> &str {
        lang.pick_of(&self.title, self.english_title.as_deref())
    }

    /// Takes over the title and the labels of the English text. A label belongs to the row of its variable.
    pub fn add_english(&mut self, english: &Self) {
        self.english_title = Some(english.title.clone());
        for row in self.left.iter_mut().chain(&mut self.right).flatten() {
            row.english = english.label_of(row.variable).map(str::to_owned);
        }
    }

    /// The label of a variable, as written.
    fn label_of(&self, variable: u16) -> Option<&str> {
        self.rows().find(|row| row.variable == variable).map(|row| row.label.as_str())
    }
}

/// Where an English text does not fit its page text: rows of other variables, and rows that it lacks.
#[must_use]
pub fn english_faults(page: &PageText, english: &ParsedPageText) -> Vec<PageTextFault> {
    let slots = english.page.left.iter().chain(&english.page.right).zip(&english.entry_positions);
    let strange = slots.filter_map(|(row, at)| {
        let variable = row.as_ref()?.variable;
        let wrong = || {
            let zh = format!("页面文字中没有 #{variable}：请改正变量号，或删除该行");
            let en = format!("the page text has no #{variable}: correct the variable number, or delete the row");
            fault(*at, zh, en)
        };
        page.label_of(variable).is_none().then(wrong)
    });
    let end = english.end.unwrap_or((1, 1));
    let missing = page.rows().filter(|row| english.page.label_of(row.variable).is_none()).map(|row| {
        let PageTextRow { label, variable, .. } = row;
        let zh = format!("“{label} #{variable}”没有英文，显示原文：请加一行“英文名称 #{variable};”");
        let en =
            format!("'{label} #{variable}' has no English and is shown as written: add a row 'label #{variable};'");
        fault(end, zh, en)
    });
    let mut all: Vec<_> = strange.chain(missing).collect();
    all.sort_by_key(|fault| (fault.line, fault.column));
    all
}

/// Whether a variable is allowed on a page.
#[must_use]
pub const fn is_allowed_on_page(variable: u16) -> bool {
    matches!(variable, 100..=433 | 500..=999)
}

/// How a program uses a variable.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct VariableUse {
    /// Variable number.
    pub variable: u16,
    /// The program reads it.
    pub reads: bool,
    /// The program writes it.
    pub writes: bool,
    /// Program and line of the first use.
    pub place: (u32, u32),
    /// The comment in that line.
    pub comment: String,
}

/// An error in a page text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PageTextFault {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// Error message with cause and remedy.
    pub message: LocalizedText,
}

/// The result of parsing a page text that may contain errors.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ParsedPageText {
    /// The valid part.
    pub page: PageText,
    /// Every error, by line.
    pub faults: Vec<PageTextFault>,
    /// Line and column, from 1, of the start of each entry after the title; at most twenty.
    pub entry_positions: Vec<(u32, u32)>,
    /// Line and column of the `%`.
    pub end: Option<(u32, u32)>,
}

/// Parses a page text.
///
/// # Errors
/// The first error in the text, with line and column.
pub fn parse(text: &str) -> Result<PageText, PageTextFault> {
    let reading = parse_all(text);
    reading.faults.into_iter().next().map_or(Ok(reading.page), Err)
}

/// Parses a page text and collects all errors, for the page designer.
#[must_use]
pub fn parse_all(text: &str) -> ParsedPageText {
    let mut reading = ParsedPageText::default();
    let mut entries = entries(text, &mut reading).into_iter();
    match entries.next() {
        None if reading.faults.iter().all(|fault| fault.line > 1) => {
            let (zh, en) =
                ("文件是空的：第一行应为标题和 ;", "the file is empty: the first line must be the title and ;");
            reading.faults.insert(0, fault((1, 1), zh, en));
            return reading;
        }
        None => return reading,
        Some(title) if title.text.is_empty() => {
            if reading.faults.iter().all(|fault| fault.line != title.at.0) {
                reading.faults.push(fault(title.at, "标题是空的", "the title is empty"));
            }
        }
        Some(title) => title.text.clone_into(&mut reading.page.title),
    }
    let mut count = 0;
    for entry in entries {
        let slot = match count {
            0..COLUMN_ROWS => &mut reading.page.left[count],
            _ if count < 2 * COLUMN_ROWS => &mut reading.page.right[count - COLUMN_ROWS],
            _ => {
                let en = "more than 20 entries: % is expected after ten for the left and ten for the right column";
                reading.faults.push(fault(entry.at, "多于 20 行：左栏 10 行、右栏 10 行后应为 %", en));
                break;
            }
        };
        match row(&entry) {
            Ok(row) => *slot = row,
            Err(wrong) => reading.faults.push(wrong),
        }
        reading.entry_positions.push(entry.at);
        count += 1;
    }
    if count < COLUMN_ROWS && reading.faults.is_empty() {
        let line = text.lines().count().max(1) as u32;
        let en = format!("the left column needs ten entries, found {count}; write ; for an empty one");
        reading.faults.push(fault((line, 1), format!("左栏应有 10 行，只有 {count} 行；空行写一个 ;"), en));
    }
    reading.faults.sort_by_key(|fault| (fault.line, fault.column));
    reading
}

/// One entry of the text, ended by `;`.
struct PageTextEntry<'a> {
    text: &'a str,
    /// Line and column of its start.
    at: (u32, u32),
}

/// Splits the text at `;` up to the `%`. A line with an error counts as one entry.
fn entries<'a>(text: &'a str, reading: &mut ParsedPageText) -> Vec<PageTextEntry<'a>> {
    let mut found = Vec::new();
    let faults = &mut reading.faults;
    for (index, line) in text.lines().enumerate() {
        let number = index as u32 + 1;
        let mut rest = line.trim_start_matches('\u{feff}');
        let mut column = 1;
        while !rest.trim().is_empty() {
            column += skip_blanks(&mut rest);
            if let Some(after) = rest.strip_prefix('%') {
                if !after.trim().is_empty() {
                    faults.push(fault((number, column + 1), "% 之后不能有内容", "nothing may follow %"));
                }
                reading.end = Some((number, column));
                return found;
            }
            let wide = full_width(rest, (number, column)).err();
            let missing = || fault((number, column), "缺少行末的 ;", "the ; at the end of the entry is missing");
            let cut = rest.split_once(';');
            let (Some((piece, after)), None) = (cut, &wide) else {
                faults.push(wide.unwrap_or_else(missing));
                found.push(PageTextEntry { text: "", at: (number, column) });
                break;
            };
            found.push(PageTextEntry { text: piece.trim(), at: (number, column) });
            column += piece.chars().count() as u32 + 1;
            rest = after;
        }
    }
    let line = text.lines().count().max(1) as u32;
    faults.push(fault((line, 1), "缺少文件末尾的 %", "the % at the end of the file is missing"));
    found
}

fn skip_blanks(rest: &mut &str) -> u32 {
    let trimmed = rest.trim_start();
    let skipped = rest.chars().count() - trimmed.chars().count();
    *rest = trimmed;
    skipped as u32
}

/// Finds full-width punctuation and digits, the most common error with a Chinese keyboard.
fn full_width(piece: &str, (line, column): (u32, u32)) -> Result<(), PageTextFault> {
    let signs = [('；', ';'), ('＃', '#'), ('％', '%')];
    for (offset, sign) in piece.chars().enumerate() {
        let at = (line, column + offset as u32);
        if let Some((wide, narrow)) = signs.into_iter().find(|(wide, _)| *wide == sign) {
            let en = format!("full-width '{wide}': type the ASCII '{narrow}'");
            return Err(fault(at, format!("全角符号“{wide}”：请改用英文符号 {narrow}"), en));
        }
        if sign.is_ascii_digit() || sign == ';' && offset > 0 {
            continue;
        }
        if ('０'..='９').contains(&sign) && piece.contains('#') {
            return Err(fault(at, "全角数字：请改用英文数字", "full-width digit: type ASCII digits"));
        }
    }
    Ok(())
}

fn row(entry: &PageTextEntry<'_>) -> Result<Option<PageTextRow>, PageTextFault> {
    if entry.text.is_empty() {
        return Ok(None);
    }
    if let Some((label, variable)) = r_row(entry.text) {
        return named(entry, label, variable);
    }
    let Some((label, number)) = entry.text.rsplit_once('#') else {
        let en = "no macro variable: write the entry as 'label #number;'";
        return Err(fault(entry.at, "缺少宏变量号：应为“名称 #号;”", en));
    };
    let (at, number) = ((entry.at.0, entry.at.1 + label.chars().count() as u32 + 1), number.trim());
    let Ok(variable) = number.parse() else {
        let en = format!("'{number}' is not a variable number");
        return Err(fault(at, format!("宏变量号“{number}”不是数字"), en));
    };
    if !is_allowed_on_page(variable) {
        let zh = format!("宏变量 #{variable} 不能在页面上修改：可用 #100-#433、#500-#999");
        return Err(fault(at, zh, format!("#{variable} cannot be used on a page: use #100-#433 or #500-#999")));
    }
    named(entry, label, variable)
}

fn named(entry: &PageTextEntry<'_>, label: &str, variable: u16) -> Result<Option<PageTextRow>, PageTextFault> {
    if label.trim().is_empty() {
        return Err(fault(entry.at, "缺少名称", "the label is missing"));
    }
    Ok(Some(PageTextRow { label: label.trim().to_owned(), english: None, variable }))
}

/// Parses `名称 R18`: an R parameter after the last blank (S3).
fn r_row(text: &str) -> Option<(&str, u16)> {
    let (label, word) = text.rsplit_once([' ', '\t']).unwrap_or(("", text));
    Some((label, variable_name::parse(word).filter(|_| word.starts_with(['R', 'r']))?))
}

fn fault((line, column): (u32, u32), zh: impl Into<String>, en: impl Into<String>) -> PageTextFault {
    PageTextFault { line, column, message: LocalizedText::new(zh, en) }
}
