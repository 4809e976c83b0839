//! The help entries: one per page, soft key, panel key, alarm, G and M code and parameter, each from its table row.
//! Source: spec B6, K2.4, B8; the tables in `defs`.

use std::sync::Arc;

use super::keyboard_map;
use crate::defs::alarm::{self, ALARMS};
use crate::defs::availability;
use crate::defs::fitted::Fitted;
use crate::defs::gcode::{Availability, G_CODES, GCodeGroup};
use crate::defs::key::{self, Key};
use crate::defs::kind::Kind;
use crate::defs::mcode;
use crate::defs::page::Page;
use crate::defs::page_text::PageTextRow;
use crate::defs::param::ParamAddress;
use crate::defs::param_row::{self, ParamRow};
use crate::defs::program_error::ProgramError;
use crate::defs::soft_key::{self, SoftKeyAction};
use crate::defs::text::arg::Arg;
use crate::defs::text::{Lang, LocalizedText, Template, Text, Words, phrase};
use crate::hmi::keyboard::SHORTCUTS;
use crate::hmi::widget::page_keys;
use crate::link::Snapshot;
use crate::link::snapshot::DirectoryRow;

page_keys! {
    /// A section of the help.
    #[derive(Default)]
    Section {
        /// The pages.
        #[default]
        Pages = "help-pages", "页面", "PAGES";
        /// The soft keys.
        SoftKeys = "help-soft", "软键", "F KEYS";
        /// The keys of the panel.
        Keys = "help-keys", "按键", "KEYS";
        /// The alarms.
        Alarms = "help-alarms", "报警", "ALARMS";
        /// G codes; on other dialects all words of their own.
        GCodes = "help-g", "G 代码", "G CODES";
        /// M codes.
        MCodes = "help-m", "M 代码", "M CODES";
        /// The parameters.
        Params = "help-params", "参数", "PARAMS";
        /// The variables of the page text; found by a search alone.
        Variables = "help-variables", "变量", "VARIABLES";
        /// The programs of the folder; found by a search alone.
        Programs = "help-programs", "程序", "PROGRAMS";
    }
}

impl Section {
    /// The sections with a tab.
    pub const ALL: [Self; 7] =
        [Self::Pages, Self::SoftKeys, Self::Keys, Self::Alarms, Self::GCodes, Self::MCodes, Self::Params];
}

/// The subject of an entry; the machine adds live text to some subjects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HelpTopic {
    /// A page.
    Page(Page),
    /// A soft key.
    SoftKey(SoftKeyAction),
    /// A key of the panel.
    Key(Key),
    /// An alarm by its number.
    Alarm(u16),
    /// A G code, or a word of another dialect.
    GCode,
    /// An M code.
    MCode,
    /// A parameter.
    Param(ParamAddress),
    /// A variable.
    Variable(u16),
    /// A program.
    Program(u32),
}

impl HelpTopic {
    /// The section of the subject.
    const fn section(self) -> Section {
        match self {
            Self::Page(_) => Section::Pages,
            Self::SoftKey(_) => Section::SoftKeys,
            Self::Key(_) => Section::Keys,
            Self::Alarm(_) => Section::Alarms,
            Self::GCode => Section::GCodes,
            Self::MCode => Section::MCodes,
            Self::Param(_) => Section::Params,
            Self::Variable(_) => Section::Variables,
            Self::Program(_) => Section::Programs,
        }
    }

    /// The subject of an alarm number; the alarms that programs raise by `#3000` share one entry.
    pub(super) fn for_alarm(number: u16) -> Self {
        Self::Alarm(number.min(alarm::USER_ALARM_FIRST))
    }
}

/// Captions and texts of an entry.
type Paragraphs = Vec<(Text, LocalizedText)>;

/// One entry.
#[derive(Clone, Debug, PartialEq)]
pub struct HelpEntry {
    /// Its section.
    pub section: Section,
    /// Its subject.
    pub topic: HelpTopic,
    /// Its id: `page-grinding`, `alarm-180`, `m-M03`.
    pub id: String,
    /// The short code in front: `F4`, `180`, `M03`.
    pub code: String,
    /// Its name.
    pub name: LocalizedText,
    /// Captions and texts.
    pub paragraphs: Paragraphs,
    /// All texts in lower case, for the search.
    search_text: String,
    /// Its name in an added language in lower case; empty in the languages of the control.
    added_name: String,
}

impl HelpEntry {
    fn new(topic: HelpTopic, id: String, code: String, name: LocalizedText, paragraphs: Paragraphs) -> Self {
        let section = topic.section();
        let mut search_text = format!("{id} {code} {} {}", name.zh(), name.en());
        for (_, text) in &paragraphs {
            search_text.push_str(&format!(" {} {}", text.zh(), text.en()));
        }
        let search_text = search_text.to_lowercase();
        Self { section, topic, id, code, name, paragraphs, search_text, added_name: String::new() }
    }

    /// Its words in an added language are found, too.
    pub fn add_language(&mut self, lang: Lang) {
        self.added_name = self.name.get(lang).to_lowercase();
        self.search_text.push_str(&format!(" {} {}", self.added_name, self.text(lang).to_lowercase()));
    }

    /// Whether the entry contains every word of a search. Case-insensitive.
    pub fn matches(&self, search: &str) -> bool {
        search.to_lowercase().split_whitespace().all(|word| self.search_text.contains(word))
    }

    /// Rank in a search, 0 is best: its own code, then whole words in name or text, then parts of words.
    pub fn rank(&self, search: &str) -> u8 {
        let search = search.trim().to_lowercase();
        let name = format!("{} {} {}", self.name.zh(), self.name.en(), self.added_name).to_lowercase();
        let sign = self.code.to_lowercase();
        let all_in = |text: &str| search.split_whitespace().all(|word| contains_word(text, word));
        match () {
            () if sign == search => 0,
            () if all_in(&name) => 1,
            () if sign.starts_with(&search) => 2,
            () if all_in(&self.search_text) => 3,
            () if name.contains(&search) => 4,
            () if sign.contains(&search) => 5,
            () => 6,
        }
    }

    /// Captions and texts as one text.
    pub fn text(&self, lang: Lang) -> String {
        let parts = self.paragraphs.iter().map(|(caption, text)| format!("{}: {}", caption.get(lang), text.get(lang)));
        parts.collect::<Vec<_>>().join("\n")
    }
}

/// Whether a text contains a whole word: `clock` is not in `clockwise`. Chinese has no spaces between words.
fn contains_word(text: &str, word: &str) -> bool {
    let joins = |sign: Option<char>, edge: Option<char>| {
        let is_part = |sign: char| sign.is_ascii_alphanumeric();
        sign.is_some_and(is_part) && edge.is_some_and(is_part)
    };
    text.match_indices(word).any(|(at, _)| {
        let (before, after) = (text[..at].chars().next_back(), text[at + word.len()..].chars().next());
        !joins(before, word.chars().next()) && !joins(after, word.chars().next_back())
    })
}

/// The entries that change with the program and the folder: variables of the page text, programs.
pub fn changing_entries(snapshot: &Snapshot) -> Vec<HelpEntry> {
    let text = snapshot.page_files().and_then(|files| files.text.as_ref().ok());
    let named = text.into_iter().flat_map(|text| text.rows());
    let names = |row: &PageTextRow| LocalizedText::new(row.label_in(Lang::Zh), row.label_in(Lang::En));
    let variables = named.map(|row| variable_entry(row.variable, names(row)));
    variables.chain(snapshot.directory.iter().map(program_entry)).collect()
}

/// The entry of a variable.
pub fn variable_entry(number: u16, name: LocalizedText) -> HelpEntry {
    let sign = format!("#{number}");
    let parts = vec![(PURPOSE, Text::new("宏变量", "macro variable").into())];
    HelpEntry::new(HelpTopic::Variable(number), format!("variable-{number}"), sign, name, parts)
}

fn program_entry(row: &DirectoryRow) -> HelpEntry {
    let name = LocalizedText::new(row.comment_in(Lang::Zh), row.comment_in(Lang::En));
    let details = format!("{} B · {}", row.size, row.modified);
    let load = Text::new("在目录页按装入成为当前程序", "LOAD on the page directory makes it the current program");
    let parts = vec![(Text::new("文件", "file"), LocalizedText::same(&details)), (USAGE, load.into())];
    HelpEntry::new(HelpTopic::Program(row.number), format!("program-{}", row.number), row.name.clone(), name, parts)
}

const PURPOSE: Text = Text::new("作用", "what it does");
const USAGE: Text = Text::new("操作", "how to use it");
pub const CAUSE: Text = Text::new("原因", "cause");
pub const REMEDY: Text = Text::new("处理", "remedy");
const REACTION: Text = Text::new("反应", "reaction");
const CLEARED_BY: Text = Text::new("清除", "cleared");
const KEYBOARD: Text = Text::new("键盘", "keyboard");
const DURING_RUN: Text = Text::new("运行中", "in a run");
const SCOPE: Text = Text::new("有效", "in force");
const NEXT_BLOCK: Text = Text::new("下一段", "next block");

/// All help entries of a machine.
pub fn entries(machine: impl Into<Fitted>) -> Vec<HelpEntry> {
    let machine = machine.into();
    let kind = machine.kind;
    let pages = Page::ALL.iter().copied().filter(|page| page.exists_on(machine));
    let mut all: Vec<HelpEntry> = pages.map(|page| page_entry(page, kind)).collect();
    soft_keys(kind, &mut all);
    all.extend(Key::ALL.iter().filter(|key| key.exists_on(machine)).map(|key| key_entry(*key, kind)));
    alarms(&mut all);
    g_codes(kind, &mut all);
    all.extend(availability::m_codes(machine).map(mcode_entry));
    all.extend(param_row::rows(machine).iter().map(param_entry));
    all
}

fn param_entry(row: &ParamRow) -> HelpEntry {
    let sign = row.address.to_string();
    let unit = if row.unit.is_empty() { String::new() } else { format!(" {}", row.unit) };
    let factory = format!("{}{unit}", row.factory);
    let where_ = phrase!("参数页，查找 {sign}", "page parameters, search {sign}", sign = &sign);
    let parts = vec![
        (PURPOSE, row.name.clone()),
        (Text::new("范围", "range"), row.range()),
        (Text::new("出厂值", "factory"), LocalizedText::new(factory.clone(), factory)),
        (Text::new("级别", "level"), (*row.level.name()).into()),
        (Text::new("位置", "where"), where_),
    ];
    HelpEntry::new(HelpTopic::Param(row.address), format!("param-{sign}"), sign, row.name.clone(), parts)
}

fn page_entry(page: Page, kind: Kind) -> HelpEntry {
    let keys: Vec<Text> = soft_key::row(kind, page.soft_row()).map(|soft| soft.label).collect();
    let keys = (Text::new("打开时的软键", "its soft keys"), in_a_row(&keys));
    let parts = vec![(PURPOSE, page.help().into()), (USAGE, page.usage().into()), keys];
    let id = format!("page-{}", page.id());
    HelpEntry::new(HelpTopic::Page(page), id, String::new(), page.title_on(kind).into(), parts)
}

/// The soft keys of a row: `F1 参数 · F2 诊断`.
fn in_a_row(keys: &[Text]) -> LocalizedText {
    static ROWS: [Template; 5] = [
        Template::new("F1 {a}", "F1 {a}", &["a"]),
        Template::new("F1 {a} · F2 {b}", "F1 {a} · F2 {b}", &["a", "b"]),
        Template::new("F1 {a} · F2 {b} · F3 {c}", "F1 {a} · F2 {b} · F3 {c}", &["a", "b", "c"]),
        Template::new("F1 {a} · F2 {b} · F3 {c} · F4 {d}", "F1 {a} · F2 {b} · F3 {c} · F4 {d}", &["a", "b", "c", "d"]),
        Template::new(
            "F1 {a} · F2 {b} · F3 {c} · F4 {d} · F5 {e}",
            "F1 {a} · F2 {b} · F3 {c} · F4 {d} · F5 {e}",
            &["a", "b", "c", "d", "e"],
        ),
    ];
    let Some(template) = keys.len().checked_sub(1).and_then(|last| ROWS.get(last)) else {
        return LocalizedText::default();
    };
    let mut args = [const { Arg::None }; 5];
    args.iter_mut().zip(keys).for_each(|(arg, key)| *arg = Arg::Words(Arc::new(Words::new(key.zh, key.en))));
    LocalizedText::phrase(template, args)
}

fn soft_keys(kind: Kind, all: &mut Vec<HelpEntry>) {
    for row in 0..soft_key::ROWS {
        for (index, soft) in soft_key::row(kind, row).enumerate() {
            let (row, key) = (row + 1, index + 1);
            let place = phrase!("第 {row} 行 F{key}，◀ ▶ 换行", "row {row} F{key}; ◀ ▶ turn the rows", row, key);
            let parts = vec![(PURPOSE, soft.action.help().into()), (Text::new("位置", "where"), place)];
            let (id, sign) = (format!("soft-{row}-{key}"), format!("{row}·F{key}"));
            all.push(HelpEntry::new(HelpTopic::SoftKey(soft.action), id, sign, soft.label.into(), parts));
        }
    }
}

fn key_entry(key: Key, kind: Kind) -> HelpEntry {
    let row = key.row();
    let mut parts = vec![(PURPOSE, row.help.into())];
    let shortcuts: Vec<_> =
        SHORTCUTS.iter().filter(|shortcut| shortcut.key == key).map(keyboard_map::shortcut_label).collect();
    if !shortcuts.is_empty() {
        let written = shortcuts.join(" · ");
        parts.push((KEYBOARD, LocalizedText::new(written.clone(), written)));
    }
    if row.group != key::KeyGroup::Screen {
        let acts = if row.active_in_run {
            Text::new("有效", "active")
        } else {
            Text::new("无效；暂停和手动时有效", "not active; active in a hold and in manual modes")
        };
        parts.push((DURING_RUN, acts.into()));
    }
    let sign = shortcuts.into_iter().next().unwrap_or_default();
    HelpEntry::new(HelpTopic::Key(key), format!("key-{}", row.id), sign, key.label_on(kind).into(), parts)
}

/// The entry of an alarm.
pub fn alarm_entry(number: u16) -> Option<HelpEntry> {
    let mut all = Vec::new();
    alarms(&mut all);
    all.into_iter().find(|entry| entry.topic == HelpTopic::for_alarm(number))
}

fn alarms(all: &mut Vec<HelpEntry>) {
    let add = |number: u16, sign: String, name: LocalizedText, [cause, remedy]: [LocalizedText; 2]| {
        let mut parts = Vec::with_capacity(4);
        if !cause.zh().is_empty() {
            parts.push((CAUSE, cause));
        }
        let (reaction, reset) = (alarm::reaction(number).name(), alarm::reset_rule(number).name());
        parts.extend([(REMEDY, remedy), (REACTION, reaction.into()), (CLEARED_BY, reset.into())]);
        HelpEntry::new(HelpTopic::Alarm(number), format!("alarm-{sign}"), sign, name, parts)
    };
    let from = all.len();
    for row in ALARMS {
        let texts = [row.cause.into(), row.remedy.into()];
        all.push(add(row.number, format!("{:03}", row.number), row.text.into(), texts));
    }
    for error in ProgramError::ALL {
        // The alarm itself gives the details.
        let open = |text: &str| text.replace("{2}", "…").replace("{}", "…");
        let words = |text: Text| LocalizedText::new(open(text.zh), open(text.en));
        let number = error.number();
        let cause = Text::new(
            "程序段中有错误；报警带程序、行、列",
            "an error in a block; the alarm shows program, line, column",
        );
        all.push(add(number, format!("{number:03}"), words(error.text()), [cause.into(), words(error.remedy())]));
    }
    all[from..].sort_by(|a, b| a.code.cmp(&b.code));
    let (text, remedy) = alarm::USER_ALARM_TEXTS;
    let texts = [LocalizedText::default(), remedy.into()];
    all.push(add(alarm::USER_ALARM_FIRST, "3000–3999".to_owned(), text.into(), texts));
}

fn g_codes(kind: Kind, all: &mut Vec<HelpEntry>) {
    let dialect = kind.dialect();
    let mill = dialect.is_mill();
    for row in G_CODES.iter().filter(|row| dialect.is_kt830() && row.availability_on(mill) != Availability::No) {
        let stays = if matches!(row.group_on(mill), GCodeGroup::NonModal) {
            Text::new("只在本段", "in this block only")
        } else {
            Text::new("模态，直到同组的另一个代码", "modal, until another code of the group")
        };
        let mut parts = vec![(PURPOSE, row.help.into()), (SCOPE, stays.into())];
        if row.availability_on(mill) == Availability::NoEncoder {
            parts.pop();
        }
        let sign = format!("G{:02}", row.code);
        all.push(HelpEntry::new(HelpTopic::GCode, format!("g-{sign}"), sign, row.text.into(), parts));
    }
    for word in dialect.words() {
        let (id, sign) = (format!("g-{}", word.word), word.word.to_owned());
        all.push(HelpEntry::new(HelpTopic::GCode, id, sign, word.text.into(), vec![(PURPOSE, word.help.into())]));
    }
}

fn mcode_entry(row: &mcode::MCode) -> HelpEntry {
    let waits = if row.waits {
        Text::new("等本段完成后执行", "waits until it is done")
    } else {
        Text::new("不等待", "does not wait")
    };
    let parts = vec![(PURPOSE, row.help.into()), (NEXT_BLOCK, waits.into())];
    let sign = format!("M{:02}", row.code);
    HelpEntry::new(HelpTopic::MCode, format!("m-{sign}"), sign, row.name.into(), parts)
}
