//! The pages: id, title and the soft keys of the two rows.
//! Source: spec K7.1, tools.md (ids).

use serde::{Deserialize, Serialize};

use super::kind::Kind;
use super::text::Text;

macro_rules! pages {
    ($($variant:ident = $id:literal, $zh:literal, $en:literal;)*) => {
        /// A page of the control screen.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
        pub enum Page { #[default] $(#[doc = $en] $variant,)* }

        impl Page {
            /// All pages.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// The word of the command line and of stories.
            #[must_use]
            pub const fn id(self) -> &'static str {
                match self { $(Self::$variant => $id,)* }
            }

            /// The title in the header.
            #[must_use]
            pub const fn title(self) -> Text {
                match self { $(Self::$variant => Text::new($zh, $en),)* }
            }

            /// The page of a word.
            #[must_use]
            pub fn from_id(id: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|page| page.id() == id)
            }
        }
    };
}

pages! {
    Position = "position", "位置", "position";
    Grinding = "grinding", "磨削", "grinding";
    Dressing = "dressing", "砂轮修整", "dressing";
    Program = "program", "程序", "program";
    Mdi = "mdi", "录入", "MDI";
    Directory = "directory", "目录", "directory";
    Offset = "offset", "刀补", "offsets";
    Macro = "macro", "宏变量", "macro variables";
    Teach = "teach", "录返", "teach-in";
    Tools = "tools", "刀具棒料", "tools, bar";
    Wheel = "wheel", "换砂轮", "wheel change";
    Params = "params", "参数", "parameters";
    Diagnosis = "diagnosis", "诊断", "diagnosis";
    Graphic = "graphic", "图形", "graphic";
    Transfer = "transfer", "U盘/通信", "USB transfer";
    Process = "process", "过程", "process";
    Alarm = "alarm", "报警", "alarms";
    Settings = "settings", "设置", "settings";
    Simulator = "simulator", "模拟", "simulator";
    Panel = "panel", "面板", "panel";
    Help = "help", "帮助", "help";
}

/// What a machine that turns the part has beside the pages of all kinds, and what it lacks of theirs (L9).
const TURNING: &[Page] = &[Page::Teach, Page::Tools];
const GRINDING: &[Page] = &[Page::Grinding, Page::Dressing, Page::Wheel, Page::Macro, Page::Process];

impl Page {
    /// Whether a kind has the page.
    #[must_use]
    pub fn is_on(self, kind: Kind) -> bool {
        let without = if kind.face().turns_part { GRINDING } else { TURNING };
        !without.contains(&self)
    }

    /// The title on a kind.
    #[must_use]
    pub const fn title_on(self, kind: Kind) -> Text {
        match self {
            Self::Mdi => kind.face().mdi,
            _ => self.title(),
        }
    }

    /// The page of the panel's keys F4 (磨削) and F5 (砂轮修整).
    #[must_use]
    pub const fn of_f(kind: Kind, fifth: bool) -> Self {
        match (kind.face().turns_part, fifth) {
            (false, false) => Self::Grinding,
            (false, true) => Self::Dressing,
            (true, false) => Self::Teach,
            (true, true) => Self::Tools,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn l9_a_lathe_has_teach_in_and_tools_instead_of_the_grinding_pages() {
        assert!(Page::Teach.is_on(Kind::Lathe) && Page::Tools.is_on(Kind::Lathe));
        assert!(!Page::Grinding.is_on(Kind::Lathe) && !Page::Wheel.is_on(Kind::Lathe));
        for kind in [Kind::Gc, Kind::Gs, Kind::Ga, Kind::Vertical] {
            assert!(Page::Grinding.is_on(kind) && Page::Wheel.is_on(kind) && !Page::Teach.is_on(kind));
            assert_eq!((Page::of_f(kind, false), Page::of_f(kind, true)), (Page::Grinding, Page::Dressing));
        }
        assert!(Page::ALL.iter().all(|page| Kind::ALL.iter().any(|kind| page.is_on(*kind))));
    }
}
