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

impl Page {
    /// The title on a kind of machine: the 802D's grinding page holds its R parameters (S3).
    #[must_use]
    pub const fn title_on(self, kind: Kind) -> Text {
        match (self, kind) {
            (Self::Grinding, Kind::Vertical) => Text::new("R 参数", "R parameters"),
            _ => self.title(),
        }
    }
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
