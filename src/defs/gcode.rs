//! The table of G functions: which code belongs to which group, and on which G-code system it exists.
//! Source: spec B2, K1, K4.

use super::text::Text;

/// Functions of one group exclude each other in a block; all but `Once` and `Call` stay in force until another follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// 00: acts in its own block only.
    Once,
    /// 01: how the axes move.
    Motion,
    /// 02 (lathe): constant surface speed or speed of rotation.
    Speed,
    /// 03 (mill): absolute or incremental.
    Distance,
    /// 05: feed per minute or per revolution.
    FeedMode,
    /// 06: inch or millimetre.
    Units,
    /// 07: wheel radius compensation.
    Compensation,
    /// 12: modal macro call.
    Call,
    /// 14: work frame.
    Frame,
    /// 15: exact stop or continuous path.
    Path,
    /// 16: plane of arcs.
    Plane,
}

/// Whether a G-code system has a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exists {
    /// It has it.
    Yes,
    /// It is named by the specification and not built yet: refused by name, never ignored.
    Later,
    /// This kind of machine does not have it.
    No,
}

/// One G function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GCode {
    /// The number after G.
    pub code: u8,
    /// Stable name, English, with hyphens.
    pub id: &'static str,
    /// Its group on the lathe system A.
    pub group: Group,
    /// Lathe system A (GC).
    pub lathe: Exists,
    /// GS and GA.
    pub mill: Exists,
    /// What it does.
    pub text: Text,
}

macro_rules! g_codes {
    ($($code:literal $id:literal $group:ident $lathe:ident $mill:ident $zh:literal $en:literal;)*) => {
        /// Every G function that the control knows, by number.
        pub const G_CODES: &[GCode] = &[$(GCode {
            code: $code,
            id: $id,
            group: Group::$group,
            lathe: Exists::$lathe,
            mill: Exists::$mill,
            text: Text { zh: $zh, en: $en },
        }),*];
    };
}

g_codes! {
    0 "rapid" Motion Yes Yes "快速定位" "rapid traverse";
    1 "feed" Motion Yes Yes "直线插补" "straight line at feed";
    2 "arc-clockwise" Motion Yes Yes "顺时针圆弧" "arc clockwise";
    3 "arc-counter-clockwise" Motion Yes Yes "逆时针圆弧" "arc counter-clockwise";
    4 "dwell" Once Yes Yes "暂停" "dwell";
    10 "wear-add" Once Yes Yes "修改刀补" "add to wear offset";
    17 "plane-xy" Plane No Yes "XY 平面" "plane XY";
    18 "plane-zx" Plane Yes Yes "ZX 平面" "plane ZX";
    19 "plane-yz" Plane No Yes "YZ 平面" "plane YZ";
    20 "inch" Units Yes Yes "英制" "inch";
    21 "millimetre" Units Yes Yes "公制" "millimetre";
    27 "dressing-point" Once Yes Yes "回砂轮修整点" "return to the dressing point";
    28 "reference" Once Yes Yes "回机械零点" "return to the machine zero";
    30 "other-reference" Once Yes Yes "回第 2–4 参考点" "return to reference point 2, 3 or 4";
    31 "skip" Once Yes Yes "跳转插补" "feed until a signal";
    32 "thread" Motion Later No "螺纹切削" "thread";
    33 "tapping" Motion Later No "攻丝" "tapping with Z";
    34 "variable-thread" Motion Later No "变螺距螺纹" "thread of variable lead";
    35 "oscillation-on" Once Yes Yes "振荡开启" "oscillation on";
    36 "oscillation-off" Once Yes Yes "振荡关闭" "oscillation off";
    40 "compensation-off" Compensation Later Later "取消半径补偿" "wheel radius compensation off";
    41 "compensation-left" Compensation Later Later "左侧半径补偿" "wheel radius compensation left";
    42 "compensation-right" Compensation Later Later "右侧半径补偿" "wheel radius compensation right";
    50 "preset" Once Yes Yes "设定坐标系" "call the present position";
    53 "machine-move" Once Yes Yes "机床坐标定位" "machine coordinates";
    54 "frame-1" Frame Yes Yes "工件坐标系 1" "work frame 1";
    55 "frame-2" Frame Yes Yes "工件坐标系 2" "work frame 2";
    56 "frame-3" Frame Yes Yes "工件坐标系 3" "work frame 3";
    57 "frame-4" Frame Yes Yes "工件坐标系 4" "work frame 4";
    58 "frame-5" Frame Yes Yes "工件坐标系 5" "work frame 5";
    59 "frame-6" Frame Yes Yes "工件坐标系 6" "work frame 6";
    61 "exact-stop" Path Yes Yes "准停方式" "exact stop";
    64 "continuous" Path Yes Yes "连续方式" "continuous path";
    65 "macro-call" Once Yes Yes "宏程序调用" "macro call";
    66 "modal-call" Call Yes Yes "宏程序模态调用" "modal macro call";
    67 "modal-call-off" Call Yes Yes "取消模态调用" "modal macro call off";
    70 "finishing" Once Yes No "精加工循环" "finishing cycle";
    71 "rough-turning" Once Yes No "轴向粗车循环" "roughing along Z";
    72 "rough-facing" Once Yes No "径向粗车循环" "roughing along X";
    73 "rough-contour" Once Yes No "封闭切削循环" "roughing along the contour";
    74 "face-grooving" Once Yes No "轴向切槽循环" "grooving along Z";
    75 "grooving" Once Yes No "径向切槽循环" "grooving along X";
    76 "threading-cycle" Once Later No "复合螺纹循环" "threading cycle";
    78 "gauge-positioning" Once Yes Yes "量仪对刀" "gauge positioning";
    90 "longitudinal-cycle" Motion Yes Yes "轴向切削循环（平磨、圆台磨：绝对编程）" "longitudinal cycle (GS, GA: absolute)";
    91 "incremental" Distance No Yes "增量编程" "incremental";
    92 "thread-cycle" Motion Later No "螺纹切削循环" "thread cycle";
    94 "face-cycle" Motion Yes Yes "径向切削循环（平磨、圆台磨：每分进给）" "face cycle (GS, GA: feed per minute)";
    95 "feed-per-revolution-mill" FeedMode No Yes "每转进给" "feed per revolution";
    96 "surface-speed" Speed Yes Yes "恒线速" "constant surface speed";
    97 "rotation-speed" Speed Yes Yes "恒转速" "constant speed of rotation";
    98 "feed-per-minute" FeedMode Yes Yes "每分进给" "feed per minute";
    99 "feed-per-revolution" FeedMode Yes Yes "每转进给" "feed per revolution";
}

const NONE: u8 = u8::MAX;

const ROW: [u8; 100] = {
    let mut rows = [NONE; 100];
    let mut row = 0;
    while row < G_CODES.len() {
        rows[G_CODES[row].code as usize] = row as u8;
        row += 1;
    }
    rows
};

impl GCode {
    /// The row of a number, if the control knows it.
    #[must_use]
    #[inline]
    pub fn find(code: u32) -> Option<&'static Self> {
        let row = *ROW.get(code as usize)?;
        G_CODES.get(usize::from(row))
    }

    /// The group on one G-code system: on GS and GA `G90` chooses absolute and `G94` feed per minute.
    #[must_use]
    #[inline]
    pub const fn group_on(&self, mill: bool) -> Group {
        match (self.code, mill) {
            (90, true) => Group::Distance,
            (94, true) => Group::FeedMode,
            _ => self.group,
        }
    }

    /// Whether one G-code system has it.
    #[must_use]
    #[inline]
    pub const fn exists_on(&self, mill: bool) -> Exists {
        if mill { self.mill } else { self.lathe }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn b2_every_row_is_found_by_its_number_and_ids_are_unique() {
        for row in G_CODES {
            assert_eq!(GCode::find(u32::from(row.code)).map(|found| found.id), Some(row.id));
            assert_eq!(G_CODES.iter().filter(|other| other.id == row.id).count(), 1);
        }
        assert!(GCode::find(5).is_none() && GCode::find(100).is_none());
    }
}
