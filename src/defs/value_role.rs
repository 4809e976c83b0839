//! What a value of a grinding page is to the grinding process: by it the technology page knows which value to propose.
//! A page names the roles of its values in D00nn.RON.

use serde::Deserialize;

use super::text::Text;

macro_rules! roles {
    ($($(#[$doc:meta])* $variant:ident = $unit:literal, $zh:literal, $en:literal;)*) => {
        /// The role of a value of a grinding page.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
        pub enum ValueRole { $($(#[$doc])* $variant,)* }

        impl ValueRole {
            /// All roles.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// Its name.
            #[must_use]
            pub const fn name(self) -> Text {
                match self { $(Self::$variant => Text::new($zh, $en),)* }
            }

            /// Its unit; empty for a number of parts.
            #[must_use]
            pub const fn unit(self) -> &'static str {
                match self { $(Self::$variant => $unit,)* }
            }
        }
    };
}

roles! {
    /// Diameter of the blank, mm.
    BlankDiameter = "mm", "毛坯直径", "blank diameter";
    /// Finished diameter, mm.
    FinishedDiameter = "mm", "成品直径", "finished diameter";
    /// Upper deviation of the finished diameter, mm.
    UpperDeviation = "mm", "上偏差", "upper deviation";
    /// Lower deviation, mm.
    LowerDeviation = "mm", "下偏差", "lower deviation";
    /// Where roughing begins: left on the diameter, mm.
    RoughAllowance = "mm", "粗磨余量", "roughing from";
    /// Left on the diameter for finishing, mm.
    FinishAllowance = "mm", "精磨余量", "finishing from";
    /// Feed of roughing, mm/min of slide travel.
    RoughFeed = "mm/min", "粗磨速度", "roughing feed";
    /// Feed of finishing, mm/min.
    FinishFeed = "mm/min", "精磨速度", "finishing feed";
    /// Spark-out, s.
    SparkOut = "s", "光磨时间", "spark-out";
    /// Parts between two dressings.
    DressInterval = "", "修整间隔", "parts to dressing";
}
