//! Parses a story into statements. An unknown word is an error with line and column.
//! Source: spec tools.md, "Story language".

use super::statement::{
    DiskCondition, Expectation, InputForce, Quantity, Statement, StoryError, StoryLine, WaitCondition,
};
use crate::defs;
use crate::defs::key::{Key, Mode};
use crate::defs::kind::Kind;
use crate::defs::page::Page;
use crate::defs::param::ParamAddress;
use crate::defs::production_order::{OrderValue, OrderValues};
use crate::defs::scope_signal::ScopeSignal;
use crate::defs::signal::{Input, Output, PORTS};
use crate::defs::text::LocalizedText;
use crate::io::sim::{EventKind, SimulatedMachine};
use crate::link::demo_view::DemoView;
use crate::link::media::{Direction, TransferSet};
use crate::link::page_command::{DataChoice, PageCommand, PasswordScope, Secret};
use crate::link::production::{OrderCommand, OrderProposal};
use crate::link::scope::{SCOPE_CHANNELS, SCOPE_SPANS, ScopeCommand, ScopeSetup, ScopeTrigger};
use crate::link::snapshot::RunState;
use crate::link::teach::TeachCommand;
use crate::units::{Axis, Micros};

/// Maximum number of statements in a story.
pub const MAX_STATEMENTS: usize = 100_000;
/// Default timeout of `wait until`, seconds.
pub const DEFAULT_WAIT_S: f64 = 60.0;
/// Maximum time in a statement, seconds: about four months.
pub const MAX_TIME_S: f64 = 1e7;
/// Default tolerance of a value, mm: half a micrometre, less than the display resolution.
pub const DEFAULT_TOLERANCE_MM: f64 = 0.000_5;

/// Parses a story for a kind; its first line may select another kind.
///
/// # Errors
/// The first invalid line.
pub fn parse(text: &str, kind: Kind) -> Result<(Kind, Vec<StoryLine>), StoryError> {
    let (mut kind, mut lines) = (kind, Vec::new());
    for (index, whole) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let number = index as u32 + 1;
        let words = LineParser::from_line(whole, number)?;
        if words.is_at_end() {
            continue;
        }
        if lines.len() >= MAX_STATEMENTS {
            return Err(words.error("the story is too long"));
        }
        let text = words.text.clone();
        let statement = words.statement(kind)?;
        if let Statement::Kind(named) = statement {
            if !lines.is_empty() {
                let cause = "`kind` is the first line of a story".into();
                return Err(StoryError { line: number, column: 1, cause });
            }
            kind = named;
        }
        lines.push(StoryLine { number, text, statement });
    }
    Ok((kind, lines))
}

/// A time as stories give it, such as `12.5 s` or `800 ms`; in seconds.
///
/// # Errors
/// What is wrong with the text.
pub fn parse_duration(text: &str) -> Result<f64, String> {
    let read = LineParser::from_line(text, 1).and_then(|mut words| {
        let seconds = words.duration()?;
        words.expect_end().map(|()| seconds)
    });
    read.map_err(|error| error.cause)
}

/// The words of one line and the read position.
struct LineParser {
    line: u32,
    text: String,
    words: Vec<(u32, String)>,
    next: usize,
}

impl LineParser {
    fn from_line(whole: &str, line: u32) -> Result<Self, StoryError> {
        let text = whole.split_once("#!").map_or(whole, |(before, _)| before).trim_end();
        let mut words = Vec::new();
        let mut chars = (1_u32..).zip(text.chars()).peekable();
        while let Some((column, sign)) = chars.next() {
            if sign.is_whitespace() {
                continue;
            }
            let mut word = String::from(sign);
            if sign == '"' || sign == '“' {
                let closing = if sign == '"' { '"' } else { '”' };
                word = String::from('"');
                loop {
                    match chars.next() {
                        Some((_, sign)) if sign == closing => break,
                        Some((_, sign)) => word.push(sign),
                        None => return Err(StoryError { line, column, cause: "the closing quote is missing".into() }),
                    }
                }
            } else {
                while let Some((_, sign)) = chars.next_if(|(_, sign)| !sign.is_whitespace()) {
                    word.push(sign);
                }
            }
            words.push((column, word));
        }
        Ok(Self { line, text: text.trim_start().to_owned(), words, next: 0 })
    }

    fn is_at_end(&self) -> bool {
        self.next >= self.words.len()
    }

    /// An error at the last word read.
    fn error(&self, cause: impl Into<String>) -> StoryError {
        let last = self.next.checked_sub(1).and_then(|last| self.words.get(last));
        self.error_at(last.map_or(1, |(column, _)| *column), cause)
    }

    fn error_at(&self, column: u32, cause: impl Into<String>) -> StoryError {
        StoryError { line: self.line, column, cause: cause.into() }
    }

    fn word(&mut self, wanted: &str) -> Result<String, StoryError> {
        let word = self.words.get(self.next).map(|(_, word)| word.clone());
        self.next += 1;
        word.ok_or_else(|| self.error_at(self.text.chars().count() as u32 + 1, format!("{wanted} is missing")))
    }

    fn expect_end(&self) -> Result<(), StoryError> {
        let Some((column, word)) = self.words.get(self.next) else { return Ok(()) };
        Err(self.error_at(*column, format!("unexpected '{word}' at the end")))
    }

    fn statement(mut self, kind: Kind) -> Result<Statement, StoryError> {
        let verb = self.word("a statement")?;
        let statement = match verb.as_str() {
            "kind" => {
                let kinds = Kind::ALL.map(Kind::id).join(", ");
                Statement::Kind(self.one_of(&format!("a kind: {kinds}"), Kind::from_id)?)
            }
            "power" => self.one_of("`on` or `cut`", |word| match word {
                "on" => Some(Statement::PowerOn),
                "cut" => Some(Statement::PowerCut),
                _ => None,
            })?,
            "param" => {
                Statement::Param(self.one_of("a parameter such as P270 or P16.0", ParamAddress::parse)?, self.number()?)
            }
            "set" => self.set()?,
            "type" => Statement::Type(self.variable()?, self.optional_number()?),
            "load" if kind.row().programs.by_name => {
                Statement::LoadNamed(self.word("the name of a program, such as SHAFT")?)
            }
            "load" => self.load()?,
            "mode" => Statement::Mode(self.one_of("edit, auto, mdi, home, handwheel, step or jog", Mode::from_id)?),
            "home" => self.one_of("`all`", |word| (word == "all").then_some(Statement::HomeAll))?,
            "key" => Statement::Key(self.key(kind)?),
            "press" => Statement::Press(self.key(kind)?),
            "release" => Statement::Release(self.key(kind)?),
            "hold" => Statement::Hold(self.one_of("axis and sign such as X-", jog_key)?, self.duration()?),
            "handwheel" => self.handwheel()?,
            "mdi" => {
                self.next = self.words.len();
                Statement::Mdi(self.text.trim_start_matches("mdi").trim().to_owned())
            }
            "page" => Statement::Page(self.one_of("a page", Page::from_id)?),
            "write" => Statement::WriteProgram(self.o_number()?, self.quoted()?),
            "delete" => Statement::DeleteProgram(self.o_number()?),
            "export" => Statement::Transfer(Direction::Export, self.transfer_set()?),
            "import" => Statement::Transfer(Direction::Import, self.transfer_set()?),
            "stall" => Statement::Stall,
            "unlock" | "password" | "accept" | "scope" => Statement::Settings(self.settings(&verb)?),
            "order" => Statement::Order(self.order()?),
            "propose-order" => Statement::ProposeOrder(self.order_of_shop()?),
            "disk" => Statement::Disk(self.disk()?),
            "screen" => Statement::ScreenHangs(self.screen_hangs()?),
            "teach" => Statement::Teach(self.one_of("start, stop, undo or keep", TeachCommand::from_id)?),
            "caption" => Statement::ShowDemo(self.caption()?),
            "title" => Statement::ShowDemo(DemoView::Title(LocalizedText::new(self.quoted()?, self.quoted()?))),
            "prepared" => Statement::Prepared,
            "sheet" => Statement::Sheet(self.one_of("a sheet from 1", |word| word.parse().ok().filter(|n| *n > 0))?),
            "input" => self.input()?,
            "fault" => self.fault()?,
            "wait" => self.wait()?,
            "seed" => Statement::Seed(self.one_of("a whole number", |word| word.parse().ok())?),
            "part" => Statement::Part(self.file()?),
            "screw" => Statement::Screw(self.one_of("an axis", axis)?, self.file()?),
            "expect" => Statement::Expect(self.expect(kind)?),
            verb => return Err(self.error(format!("'{verb}' is not a statement"))),
        };
        self.expect_end()?;
        Ok(statement)
    }

    fn one_of<T>(&mut self, wanted: &str, read: impl Fn(&str) -> Option<T>) -> Result<T, StoryError> {
        let word = self.word(wanted)?;
        read(&word).ok_or_else(|| self.error(format!("'{word}' is not {wanted}")))
    }

    fn o_number(&mut self) -> Result<u32, StoryError> {
        self.one_of("a program such as O2001", |word| {
            program(word).filter(|number| !defs::program_number::is_named(*number))
        })
    }

    fn settings(&mut self, verb: &str) -> Result<PageCommand, StoryError> {
        if verb == "scope" {
            return Ok(PageCommand::Scope(self.scope()?));
        }
        if verb == "accept" {
            let choice = |word: &str| (word == "data").then_some(DataChoice::Present);
            return Ok(PageCommand::AcceptData(self.one_of("`data`", choice)?));
        }
        let scope = self.one_of("program, user or builder", PasswordScope::from_id)?;
        if verb == "unlock" {
            return Ok(PageCommand::Unlock(scope, self.password("a password")?));
        }
        let (old, new) = (self.password("the old password")?, self.password("the new password")?);
        Ok(PageCommand::ChangePassword { scope, old, new })
    }

    /// `order 501 O1002 50` enters an order, `order accept 501 O1002 50` accepts one of the shop; `start` (`keep-values`
    /// behind it: without its values), `close`, `delete` and its number.
    fn order(&mut self) -> Result<OrderCommand, StoryError> {
        let word = self.word("a number, accept, start, close or delete")?;
        let count = |word: &str| word.parse::<u32>().ok();
        if let Some(number) = count(&word) {
            return Ok(OrderCommand::Enter(self.proposal(number)?));
        }
        let number = self.one_of("the number of an order", count)?;
        match word.as_str() {
            "start" => {
                let keeps = |word: &str| (word == "keep-values").then_some(());
                let takes_values = self.is_at_end() || self.one_of("keep-values", keeps).map(|()| false)?;
                Ok(OrderCommand::Start { number, takes_values })
            }
            "accept" => Ok(OrderCommand::Accept(self.proposal(number)?)),
            "close" => Ok(OrderCommand::Close(number)),
            "delete" => Ok(OrderCommand::Delete(number)),
            _ => Err(self.error(format!("'{word}' is not a number, accept, start, close or delete"))),
        }
    }

    /// `propose-order 501 O1002 50`: an order of the shop.
    fn order_of_shop(&mut self) -> Result<OrderProposal, StoryError> {
        let number = self.one_of("the number of an order", |word| word.parse().ok())?;
        self.proposal(number)
    }

    /// `O1002 50 #501=30 #502=0.01`: program, parts and values of the order of the shop with this number.
    fn proposal(&mut self, number: u32) -> Result<OrderProposal, StoryError> {
        let (program, target) = (self.o_number()?, self.one_of("a number of parts", |word| word.parse().ok())?);
        let mut values = OrderValues::default();
        while !self.is_at_end() {
            let value = self.one_of("a variable and its value, such as #501=30", |word| {
                let (variable, number) = word.split_once('=')?;
                Some(OrderValue { variable: defs::variable_name::parse(variable)?, number: number.parse().ok()? })
            })?;
            values = values.with(value).ok_or_else(|| self.error("too many values, or one twice".to_owned()))?;
        }
        Ok(OrderProposal { number, program, target, values })
    }

    /// `scope stop`, or the signals and how they are recorded.
    fn scope(&mut self) -> Result<ScopeCommand, StoryError> {
        let mut setup = ScopeSetup { span: SCOPE_SPANS[1], ..ScopeSetup::default() };
        let mut count = 0;
        loop {
            let word = self.word("a signal such as X-error, or `stop`")?;
            match (word.as_str(), setup.channels.get_mut(count)) {
                ("stop", _) if count == 0 => return Ok(ScopeCommand::Stop),
                ("span", _) if count > 0 => setup.span = Micros::from_secs_f64(self.duration()?),
                ("rising", _) if count > 0 => setup.trigger = ScopeTrigger::Rising(self.number()?),
                ("falling", _) if count > 0 => setup.trigger = ScopeTrigger::Falling(self.number()?),
                (_, None) => return Err(self.error(format!("'{word}': the scope has {SCOPE_CHANNELS} channels"))),
                (id, Some(channel)) => {
                    let signal = ScopeSignal::from_id(id);
                    *channel = Some(signal.ok_or_else(|| {
                        self.error(format!("'{word}' is not a signal such as X-error, feed, input:guard-closed"))
                    })?);
                    count += 1;
                }
            }
            if self.is_at_end() {
                return Ok(ScopeCommand::Start(setup));
            }
        }
    }

    fn password(&mut self, wanted: &str) -> Result<Secret, StoryError> {
        self.word(wanted).map(Secret::new)
    }

    /// `load O1001` or the name of a program.
    fn load(&mut self) -> Result<Statement, StoryError> {
        let (number, name) =
            self.one_of("a program such as O1001", |word| program(word).map(|number| (number, word.to_owned())))?;
        Ok(match defs::program_number::is_named(number) {
            true => Statement::LoadNamed(name),
            false => Statement::Load(number),
        })
    }

    fn transfer_set(&mut self) -> Result<TransferSet, StoryError> {
        self.one_of("programs, screens, params, variables or backup", |word| {
            let sets = TransferSet::ALL.into_iter().filter(|set| *set != TransferSet::Serial);
            sets.into_iter().find(|set| set.id().strip_prefix("set-") == Some(word))
        })
    }

    /// `screen hangs 4 s`: for how long, seconds.
    fn screen_hangs(&mut self) -> Result<f64, StoryError> {
        self.one_of("`hangs`", |word| (word == "hangs").then_some(()))?;
        self.duration()
    }

    fn disk(&mut self) -> Result<DiskCondition, StoryError> {
        let condition = self.word("good, slow, hangs, full or flips")?;
        Ok(match condition.as_str() {
            "good" => DiskCondition::Good,
            "full" => DiskCondition::Full,
            "slow" => DiskCondition::Slow(self.duration()?),
            "hangs" => DiskCondition::Hangs(self.duration()?),
            "flips" => DiskCondition::Flips(self.one_of("a number of bits", |word| word.parse().ok())?),
            word => return Err(self.error(format!("'{word}' is not good, slow, hangs, full or flips"))),
        })
    }

    fn number(&mut self) -> Result<f64, StoryError> {
        self.one_of("a number", |word| word.parse().ok().filter(|value: &f64| value.is_finite()))
    }

    fn variable(&mut self) -> Result<u16, StoryError> {
        self.one_of("a variable such as #500", variable)
    }

    fn key(&mut self, kind: Kind) -> Result<Key, StoryError> {
        self.one_of("a key of this kind (a label that two keys share is given by its id)", |word| {
            Key::from_word(word, kind)
        })
    }

    fn optional_number(&mut self) -> Result<Option<f64>, StoryError> {
        if self.is_at_end() { Ok(None) } else { self.number().map(Some) }
    }

    /// `1.5 s`, `200 ms`, `2 min`; the space before the unit is optional.
    fn duration(&mut self) -> Result<f64, StoryError> {
        let word = self.word("a time such as 1.5 s")?;
        let digits = word.trim_end_matches(char::is_alphabetic);
        let mut unit = word[digits.len()..].to_owned();
        if unit.is_empty() {
            unit = self.word("a unit: ms, s, min")?;
        }
        let factor = match unit.as_str() {
            "ms" => 0.001,
            "s" => 1.0,
            "min" => 60.0,
            unit => return Err(self.error(format!("'{unit}' is not a unit of time: ms, s, min"))),
        };
        match digits.parse::<f64>() {
            Ok(value) if value >= 0.0 && value * factor <= MAX_TIME_S => Ok(value * factor),
            Ok(value) if value > 0.0 => Err(self.error(format!("'{word}' is longer than {MAX_TIME_S} s"))),
            _ => Err(self.error(format!("'{word}' is not a time"))),
        }
    }

    fn set(&mut self) -> Result<Statement, StoryError> {
        let word = self.word("a variable such as #500")?;
        // `set #500=40.2` is equal to `set #500 = 40.2`.
        let (name, close) = word.split_once('=').map_or((word.as_str(), None), |(name, value)| (name, Some(value)));
        let number = variable(name).ok_or_else(|| self.error(format!("'{name}' is not a variable such as #500")))?;
        let value = match close {
            Some(value) if !value.is_empty() => {
                let read = value.parse().ok().filter(|value: &f64| value.is_finite());
                Some(read.ok_or_else(|| self.error(format!("'{value}' is not a number")))?)
            }
            Some(_) => self.optional_number()?,
            None => {
                self.one_of("=", |word| (word == "=").then_some(()))?;
                self.optional_number()?
            }
        };
        Ok(Statement::Set(number, value))
    }

    fn handwheel(&mut self) -> Result<Statement, StoryError> {
        let axis = self.one_of("an axis", axis)?;
        let detents = self.one_of("a whole number of detents", |word| word.parse().ok())?;
        let step = self.one_of("x0.001, x0.01 or x0.1", |word| match word.trim_start_matches(['x', 'X', '×']) {
            "0.001" => Some(Key::Step0001),
            "0.01" => Some(Key::Step001),
            "0.1" => Some(Key::Step01),
            _ => None,
        })?;
        Ok(Statement::Handwheel(axis, detents, step))
    }

    fn fault(&mut self) -> Result<Statement, StoryError> {
        self.word("a fault")?;
        let text = self.text.trim_start_matches("fault").trim().to_owned();
        if text == "list" {
            return Ok(Statement::FaultList);
        }
        let ended = text.strip_suffix(" off").map(str::trim_end);
        let checked = match ended {
            Some(text) => SimulatedMachine::check_ended_fault(text),
            None => SimulatedMachine::check_fault(&text),
        };
        checked.map_err(|error| self.error(error.to_string()))?;
        self.next = self.words.len();
        Ok(ended.map_or_else(|| Statement::Fault(text.clone()), |text| Statement::FaultOff(text.to_owned())))
    }

    fn input(&mut self) -> Result<Statement, StoryError> {
        let name = self.one_of("an input or a port from 1 to 64", |word| {
            let port = word.parse::<u8>().is_ok_and(|port| (1..=PORTS).contains(&port));
            (port || Input::from_id(word).is_some()).then(|| word.to_owned())
        })?;
        let force = self.one_of("on, off or free", |word| match word {
            "free" => Some(InputForce::Released),
            word => on_off(word).map(InputForce::To),
        })?;
        Ok(Statement::Input(name, force))
    }

    fn wait(&mut self) -> Result<Statement, StoryError> {
        if self.words.get(self.next).is_none_or(|(_, word)| word != "until") {
            return Ok(Statement::Wait(self.duration()?));
        }
        self.next += 1;
        let wanted = "idle, running, held, stopped, waiting, homing, alarm, or such as X<10.5";
        let until = self.one_of(wanted, |word| state(word).map(WaitCondition::State).or_else(|| comparison(word)))?;
        let most = match self.words.get(self.next) {
            Some((_, word)) if word == "max" => {
                self.next += 1;
                self.duration()?
            }
            _ => DEFAULT_WAIT_S,
        };
        Ok(Statement::WaitUntil(until, most))
    }

    fn expect(&mut self, kind: Kind) -> Result<Expectation, StoryError> {
        let what = self.word("an expectation")?;
        Ok(match what.as_str() {
            "output" => Expectation::Output(self.one_of("an output", Output::from_id)?, self.on_off()?),
            "input" => Expectation::Input(self.one_of("an input", Input::from_id)?, self.on_off()?),
            "lamp" => Expectation::Lamp(self.key(kind)?, self.on_off()?),
            "alarm" => self.one_of("an alarm number, `any` or a text in quotes", |word| match word {
                "any" => Some(Expectation::AnyAlarm),
                word => match word.strip_prefix('"') {
                    Some(text) => Some(Expectation::AlarmText(text.to_owned())),
                    None => word.parse().ok().map(Expectation::Alarm),
                },
            })?,
            "no" => self.one_of("`alarm` or `event`", |word| match word {
                "alarm" => Some(Expectation::NoAlarm),
                "event" => Some(Expectation::NoEvent),
                _ => None,
            })?,
            "event" => {
                Expectation::Event(self.one_of("a kind of event: crash, burn, flat, overspeed", EventKind::from_id)?)
            }
            "state" => Expectation::State(self.one_of("a state", state)?),
            "message" => Expectation::Message(self.quoted()?),
            "page" => {
                let page = self.one_of("a page", Page::from_id)?;
                self.one_of("`shows`", |word| (word == "shows").then_some(()))?;
                Expectation::Page(page, self.quoted()?)
            }
            word => {
                let of = self.quantity(word)?;
                let is = self.number()?;
                let tolerance = if self.is_at_end() { DEFAULT_TOLERANCE_MM } else { self.tolerance()? };
                Expectation::Value { of, is, tolerance }
            }
        })
    }

    fn quantity(&mut self, word: &str) -> Result<Quantity, StoryError> {
        match word {
            "machine" => Ok(Quantity::Machine(self.one_of("an axis", axis)?)),
            "wear" => {
                let number =
                    self.one_of("an offset from 1 to 16", |word| word.parse().ok().filter(|n| (1..=16).contains(n)))?;
                Ok(Quantity::Wear(number, self.one_of("an axis", axis)?))
            }
            "part" => self.part(),
            word => axis(word)
                .map(Quantity::Work)
                .or_else(|| variable(word).map(Quantity::Variable))
                .ok_or_else(|| self.error(format!("'{word}' cannot be used after `expect`"))),
        }
    }

    fn part(&mut self) -> Result<Quantity, StoryError> {
        let what = self.word("diameter, face or height")?;
        self.one_of("`at`", |word| (word == "at").then_some(()))?;
        match what.as_str() {
            "diameter" => Ok(Quantity::PartDiameter(self.one_of("a place such as Z-20", coordinate('Z'))?)),
            "face" => Ok(Quantity::PartFace(self.one_of("a place such as X30", coordinate('X'))?)),
            "height" => Ok(Quantity::PartHeight(
                self.one_of("a place such as X10", coordinate('X'))?,
                self.one_of("a place such as Z5", coordinate('Z'))?,
            )),
            what => Err(self.error(format!("'{what}' is not diameter, face or height"))),
        }
    }

    fn tolerance(&mut self) -> Result<f64, StoryError> {
        self.one_of("a tolerance such as ±0.001", |word| {
            let digits = word.strip_prefix('±').or_else(|| word.strip_prefix("+-"))?;
            digits.parse().ok().filter(|value: &f64| value.is_finite() && *value >= 0.0)
        })
    }

    fn on_off(&mut self) -> Result<bool, StoryError> {
        self.one_of("on or off", on_off)
    }

    fn file(&mut self) -> Result<String, StoryError> {
        self.word("a file").map(|word| word.trim_start_matches('"').to_owned())
    }

    fn caption(&mut self) -> Result<DemoView, StoryError> {
        let zh = self.one_of("off, or two texts in quotes", |word| {
            (word == "off").then(String::new).or_else(|| word.strip_prefix('"').map(str::to_owned))
        })?;
        if zh.is_empty() {
            return Ok(DemoView::Silent);
        }
        Ok(DemoView::Caption(LocalizedText::new(zh, self.quoted()?)))
    }

    fn quoted(&mut self) -> Result<String, StoryError> {
        self.one_of("a text in quotes", |word| word.strip_prefix('"').map(str::to_owned))
    }
}

fn on_off(word: &str) -> Option<bool> {
    match word {
        "on" => Some(true),
        "off" => Some(false),
        _ => None,
    }
}

/// `O1001`, `o1001`, `1001`.
#[must_use]
pub fn program(word: &str) -> Option<u32> {
    let number =
        word.trim_start_matches(['O', 'o']).parse().ok().filter(|number| defs::program_number::is_o_number(*number));
    number.or_else(|| defs::program_number::is_name(word).then(|| defs::program_number::from_name(word)))
}

/// `#500`, `R18`.
#[must_use]
pub fn variable(word: &str) -> Option<u16> {
    defs::variable_name::parse(word)
}

fn axis(word: &str) -> Option<Axis> {
    let mut letters = word.chars();
    let axis = Axis::from_letter(letters.next()?)?;
    letters.next().is_none().then_some(axis)
}

fn jog_key(word: &str) -> Option<Key> {
    let (letter, sign) = word.split_at_checked(1)?;
    let plus = match sign {
        "+" => true,
        "-" => false,
        _ => return None,
    };
    Some(Key::from_jog(axis(letter)?, plus))
}

fn state(word: &str) -> Option<RunState> {
    use RunState::{Alarm, Held, Homing, Idle, Running, Stopped, Waiting};
    [Idle, Running, Held, Stopped, Waiting, Homing, Alarm].into_iter().find(|state| state.id() == word)
}

fn comparison(word: &str) -> Option<WaitCondition> {
    let at = word.find(['<', '>'])?;
    let axis = axis(&word[..at])?;
    let below = word.as_bytes()[at] == b'<';
    let value = word[at + 1..].trim_start_matches('=').parse().ok().filter(|value: &f64| value.is_finite())?;
    Some(WaitCondition::Axis(axis, below, value))
}

fn coordinate(letter: char) -> impl Fn(&str) -> Option<f64> {
    move |word| word.strip_prefix(letter)?.parse().ok().filter(|value: &f64| value.is_finite())
}
