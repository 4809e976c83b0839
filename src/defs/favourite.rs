//! What an operator keeps on the home page.
//! Source: spec H7; issue "the face", part 7.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use super::page::Page;
use super::param::ParamAddress;

/// The home page has room for so many.
pub const MAX_FAVOURITES: usize = 6;

/// One favourite; written `page grinding`, `param P270`, `variable #521`, `program O1002`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Favourite {
    /// A page.
    Page(Page),
    /// A parameter.
    Param(ParamAddress),
    /// A macro variable by its number.
    Variable(u16),
    /// A program by the name that the directory shows.
    Program(String),
}

impl Display for Favourite {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Page(page) => write!(f, "page {}", page.id()),
            Self::Param(address) => write!(f, "param {address}"),
            Self::Variable(number) => write!(f, "variable #{number}"),
            Self::Program(name) => write!(f, "program {name}"),
        }
    }
}

impl FromStr for Favourite {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (what, name) = text.split_once(' ').unwrap_or((text, ""));
        let found = match what {
            "page" => Page::from_id(name).map(Self::Page),
            "param" => ParamAddress::parse(name).map(Self::Param),
            "variable" => name.strip_prefix('#').and_then(|number| number.parse().ok()).map(Self::Variable),
            "program" if !name.is_empty() => Some(Self::Program(name.to_owned())),
            _ => None,
        };
        found.ok_or_else(|| {
            format!(
                "no favourite `{text}`: write page and an id, param and an address, variable and #number, or program and a name"
            )
        })
    }
}
