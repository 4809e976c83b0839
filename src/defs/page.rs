//! The pages: id, the device it belongs to, title, soft key and help texts.
//! Source: spec K7.1, K7.2, tools.md (ids).

use serde::{Deserialize, Serialize};

use super::equipment::{Needs, needs};
use super::text::Text;

macro_rules! pages {
    ($($variant:ident = $id:literal, $needs:ident, $zh:literal, $en:literal,
        row $shown:literal, $(key $row:literal $place:literal $key_zh:literal $key_en:literal,)?
        $for_zh:literal, $for_en:literal, $use_zh:literal, $use_en:literal;)*) => {
        /// A page of the control screen.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
        pub enum Page { #[default] $(#[doc = $en] $variant,)* }

        impl Page {
            /// All pages.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// The word used on the command line and in stories.
            #[must_use]
            pub const fn id(self) -> &'static str {
                match self { $(Self::$variant => $id,)* }
            }

            /// The device that it belongs to.
            #[must_use]
            pub const fn needs(self) -> Needs {
                match self { $(Self::$variant => needs!($needs),)* }
            }

            /// The title in the header.
            #[must_use]
            pub const fn title(self) -> Text {
                match self { $(Self::$variant => Text::new($zh, $en),)* }
            }

            /// The row of soft keys shown when it opens.
            #[must_use]
            pub const fn soft_row(self) -> usize {
                match self { $(Self::$variant => $shown,)* }
            }

            /// Its soft key: row and place in it, and the label; `None` if it is opened in another way.
            #[must_use]
            pub(super) const fn soft_key(self) -> Option<((usize, usize), Text)> {
                match self {
                    $($(Self::$variant => Some((($row, $place), Text::new($key_zh, $key_en))),)?)*
                    _ => None,
                }
            }

            /// Purpose of the page.
            #[must_use]
            pub const fn help(self) -> Text {
                match self { $(Self::$variant => Text::new($for_zh, $for_en),)* }
            }

            /// How to use the page.
            #[must_use]
            pub const fn usage(self) -> Text {
                match self { $(Self::$variant => Text::new($use_zh, $use_en),)* }
            }

            /// The page of an id.
            #[must_use]
            pub fn from_id(id: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|page| page.id() == id)
            }
        }
    };
}

// `row`: the soft keys shown when the page opens, from 0. `key`: row of its own soft key, place in it from 1, label. Pages
// that no kind has together may have the same place; a kind's keys close up over the places that are free.
pages! {
    Position = "position", ANY, "位置", "position", row 0,
        "轴在哪里：相对、综合、机床坐标，余移动量，生效的代码和程序段。", "Axis positions: relative, all, machine; distance to go, active codes, running block.",
        "软键 相对（第 1 行 F1）、综合（第 1 行 F2）、机床（第 1 行 F3）选坐标。相对坐标下按地址键 X、Y、Z，再按输入：手动方式把该轴当前位置设为修整点（须已回零）。", "RELATIVE (row 1 F1), ALL (row 1 F2), MACHINE (row 1 F3) choose the coordinates. On RELATIVE, in JOG, press X, Y or Z, then INPUT: the current position becomes the dressing point of the axis (homed axes only).";
    Grinding = "grinding", Wheel, "磨削", "grinding", row 1, key 0 4 "磨削" "GRINDING",
        "O1001–O1020 的磨削参数：左栏、右栏最多各十项，右边是图；键入的值下一次运行生效。", "The values of O1001 to O1020, up to ten in each column beside the picture; typed values act from the next run.",
        "点一项或用方向键选择，键入数值，按输入；取消恢复原值。运行中不能改（P6.3=1 可改）。#570–#579 只能是 0 或 1。", "Touch a field or choose it with the arrow keys, type, INPUT; CANCEL keeps the old value. Locked during a run unless P6.3=1. #570 to #579 are 0 or 1.";
    Dressing = "dressing", Wheel, "砂轮修整", "dressing", row 0, key 0 5 "砂轮修整" "DRESSING",
        "磨耗表与修整图：与刀补页是同一份数据。", "The wear table and the dressing picture: the same data as on the offsets page.",
        "点一格键入：绝对值；增量键后为累加。运行中不能改（P6.3=1 可改）。", "Touch a cell and type its value; after the increment key the value is added. Locked during a run unless P6.3=1.";
    Program = "program", ANY, "程序", "program", row 2, key 2 1 "程序" "PROGRAM",
        "当前程序：运行的段有标记；编辑方式下可以改。", "The current program with the running block marked; edited in mode EDIT.",
        "编辑（每次开机问一次密码）、查找、定位、替换、重排段号、块复制、撤销、保存。从此段：点一行或用 ↑ ↓ 选行，从框住的行开始运行。断电续：断电的程序从中断段继续。错误行左边有红条，点上去看原因。", "EDIT (asks for the password once per power-on), FIND, GO TO, REPLACE, RENUM, blocks, UNDO, SAVE. FROM N runs from the framed line, chosen by touch or ↑ ↓; RESUME continues after a power failure. A red bar marks an error: touch the line to read it.";
    Designer = "designer", Wheel, "页面设计", "page designer", row 2,
        "磨削页面的文字 C00nn.TXT、英文 C00nn.EN.TXT 和图片 B00nn.BMP：左边改文字，右边立即看到页面。", "The text C00nn.TXT, its English text C00nn.EN.TXT and the picture B00nn.BMP of a grinding page: text on the left, preview on the right.",
        "编辑（编辑方式、密码同程序）后键入；红条为错误行。变量：程序用了而页面没有的，加入即成一行。图片：任意 PNG、JPEG、BMP 换用时转换为 200×400、24 位。", "EDIT (mode and password as for programs), then type; a red bar marks an error. VARS: ADD adds a line for a variable that the program uses and the page lacks. PICTURES: any PNG, JPEG, BMP is converted to 200×400, 24 bit.";
    Mdi = "mdi", ANY, "录入", "MDI", row 2, key 2 2 "录入" "MDI",
        "录入一行程序并执行。", "Enter one program line and execute it.",
        "键入一段，按输入检查并备好，在录入方式按循环启动执行。", "Type a block; INPUT checks it and makes it ready; cycle start in mode MDI executes it.";
    Directory = "directory", ANY, "目录", "directory", row 2, key 2 3 "目录" "DIRECTORY",
        "全部程序：大小、说明、日期。", "All programs with size, comment and date.",
        "选中后按装入成为当前程序。查找按程序号、名称、说明。编辑方式下可新建（立即打开编辑）、复制、改号、删除选中的程序。其他机型的程序变暗。", "Choose one and press LOAD to make it the current program; FIND searches number, name and comment. In mode EDIT: NEW opens for editing at once, COPY, RENAME, DELETE act on the chosen one. Programs of other kinds are dimmed.";
    Offset = "offset", ANY, "刀补", "offsets", row 2, key 2 4 "刀补" "OFFSETS",
        "刀补 1–16：几何和磨耗。", "Offsets 1 to 16: geometry and wear.",
        "绝对值、增量或测量输入；修改磨耗和测量要 P22.0=1。测量要求轴已回零并静止，并清除该轴磨耗。", "Values, increments or measurements; wear and measuring need P22.0=1. Measuring needs homed axes at rest and clears the wear of that axis.";
    Macro = "macro", Wheel, "宏变量", "macro variables", row 2, key 2 5 "宏变量" "MACRO",
        "宏变量，名称来自当前页面文字；显示的是执行到的值。", "Macro variables with names from the current page text; values as executed.",
        "查找号码或名称，键入数值，按输入。要 P22.0=1。", "Search by number or name, type, INPUT. Needs P22.0=1.";
    Teach = "teach", MainSpindle, "录返", "teach-in", row 0, key 0 4 "录返" "TEACH-IN",
        "录返：把手动走的动作记录成程序段。", "Teach-in: manual moves are recorded as program blocks.",
        "按开始录返，用手动、单步或手轮移动；停止后存为程序，即可在自动方式运行。", "START, move by JOG, steps or handwheel, STOP, SAVE; the program then runs in mode AUTO.";
    Tools = "tools", MainSpindle, "刀具棒料", "tools, bar", row 0, key 0 5 "刀具棒料" "TOOLS, BAR",
        "刀架上的刀具和卡盘里的棒料：图形页据此画出切削，并检查干涉。", "The tools on the post and the bar in the chuck: the graphic page uses them to show the cut and to check for collisions.",
        "点一项键入数值，按输入。毫米，直径值。", "Touch a field, type, INPUT. In mm, diameter values.";
    Wheel = "wheel", Wheel, "换砂轮", "wheel change", row 3, key 3 3 "换砂轮" "WHEEL",
        "换砂轮：直径、宽度、额定线速度。", "Wheel change: diameter, width, rated speed.",
        "换上后在第一次修整之前只能运行修整程序。", "After a wheel change only dressing programs start until the wheel has been dressed.";
    Params = "params", ANY, "参数", "parameters", row 1, key 1 1 "参数" "PARAMS",
        "全部参数：位和数值，带名称、单位、范围、出厂值和级别；丝杠误差表。", "All parameters, bits and numbers, with name, unit, range, factory value and level; error tables of the screws.",
        "查找号码或名称。改用户参数、机床参数要密码；程序运行中不能改。", "Search by number or name. User and machine parameters need a password; no parameter can be changed while a program runs.";
    Diagnosis = "diagnosis", ANY, "诊断", "diagnosis", row 1, key 1 2 "诊断" "DIAGNOSIS",
        "每个输入输出的端口、名称和状态，内部信号，按键为什么被拒绝。", "Every input and output with port, name and state; internal signals; why a key is refused.",
        "按页签换组。报警原因先在这里核对信号。调试时在 核对 里逐个确认输入输出。", "Choose a tab. After an alarm, check the signals here first. On CHECK a fitter confirms every input and output.";
    Graphic = "graphic", ANY, "图形", "graphic", row 1, key 1 3 "图形" "GRAPHIC",
        "刀具轨迹：检查运行得到，当前位置实时显示；时间和范围。", "The tool path from a check run with the live position; time and extents.",
        "拖动和双指缩放；全图键恢复。", "Drag and pinch; FIT shows the whole path again.";
    Transfer = "transfer", ANY, "U盘/通信", "USB transfer", row 1, key 1 4 "U盘/通信" "USB/COMM",
        "U 盘与控制器之间拷贝程序、页面文件、参数、变量、全部备份；RS232 收发程序。", "Copies programs, page files, parameters, values, a full backup to and from a USB stick; programs over RS232.",
        "选类别和方向，选文件，开始。同名文件会询问；不合格式的图片可以转换为 200×400、24 位。", "Choose type and direction, choose files, start. It asks before files are replaced; pictures of another format can be converted.";
    Process = "process", Wheel, "过程", "process", row 3, key 3 1 "过程" "PROCESS",
        "运行曲线：轴位置、进给、砂轮负载、量仪；工件趋势；砂轮和修整。", "Live curves of axes, feed, wheel load, gauge; the trend of the parts; wheel and dressings.",
        "拖动、双指缩放曲线；存为 CSV 供电脑分析；清除从头开始。", "Drag and pinch the curves; SAVE CSV for a computer; CLEAR starts again.";
    Alarm = "alarm", ANY, "报警", "alarms", row 3, key 3 2 "报警" "ALARMS",
        "当前报警的原因和处理，以及最近 1000 条历史，断电保留。", "The active alarms with cause and remedy, and the last 1000, retained at power-off.",
        "排除原因后按复位；会自动消失的不用复位。触摸一行（或 ↑ ↓ 输入）：历史中显示原因、处理和清除方式，再按 ? 打开它的帮助。修改 # 打开不对的数值。", "Remove the cause, then RESET; some clear automatically. Touch a row (or ↑ ↓ INPUT): the history shows its cause and remedy; ? opens its help. EDIT # opens the value that is wrong.";
    Settings = "settings", ANY, "设置", "settings", row 3, key 3 4 "设置" "SETTINGS",
        "时钟（日期、时间）、语言、颜色、亮度、画面大小、开关、密码、机型。", "The clock (date and time), language, colours, brightness, screen size, switches, passwords, kind of machine.",
        "密码每级一个；机型下次开机生效。画面放大后，点缩略图看别处。", "One password per level; the kind takes effect at the next power-on. On an enlarged screen, touch the small picture to see another part.";
    Bus = "bus", ANY, "总线", "field bus", row 4, key 4 2 "总线" "BUS",
        "真实机床的 EtherCAT 总线：每个设备的状态，驱动器，丢失的报文，周期和唤醒时间。", "The EtherCAT network of a real machine: state of each device and drive, lost frames, times of cycle and wake-up.",
        "总线故障（报警 402）时看哪个设备不在 OP。接好后按复位。翻页键看其余设备。模拟机床没有总线。", "After a bus fault (alarm 402) look which device is not in OP; RESET when it is back. PAGE keys show more devices. A simulated machine has no bus.";
    Simulator = "simulator", ANY, "模拟", "simulator", row 4, key 4 1 "模拟" "SIMULATOR",
        "模拟的机床：砂轮、工件、信号和故障，用于培训和试程序。", "The simulated machine: wheel, part, signals and faults, for training and for testing programs.",
        "换工件、强制输入、加故障。接真实机床时没有此页内容。", "Change the part, force inputs, add faults. Empty on a real machine.";
    Technology = "technology", Headstock, "工艺", "technology", row 4, key 4 3 "工艺" "TECHNOLOGY",
        "由材料、砂轮、余量、公差、粗糙度算出切入磨的速度、进给、光磨和修整，并说明各由什么限制。", "From material, wheel, stock, tolerance and roughness: speeds, feeds, spark-out and dressing of a plunge, and what limits each.",
        "点一项键入，按输入；材料点一下换下一种。采用 把建议值写到磨削页面，点一行只写一项。工件尺寸取自磨削页面。", "Touch a field, type, INPUT; a touch on the material takes the next one. TAKE OVER writes the proposals to the grinding page, a touch on a row only that one. The part's sizes are those of the grinding page.";
    Home = "home", ANY, "总览", "overview", row 4, key 4 4 "总览" "OVERVIEW",
        "一眼看到的：位置、程序、工件、砂轮、修整、报警，旁边是工作中的机床。", "At a glance: position, program, parts, wheel, dressing, alarms; beside them the machine at work.",
        "点一块打开它的页面；触摸最上面的标题从任何页面到这里。下面一排是收藏，在查找里按 收藏 放上或取下。", "Touch a tile to open its page; a touch of the title at the top comes here from any page. The row below holds favourites: KEEP in the search puts them there and takes them away.";
    Scope = "scope", ANY, "示波器", "scope", row 4, key 4 5 "示波器" "SCOPE",
        "逐周期记录最多四个信号：各轴设定值、实际值、跟随误差、速度，进给、转速，任一输入输出。", "Up to four signals, cycle by cycle: set-point, position, following error and speed of each axis, feed, rotation, any input or output.",
        "点左边的名称选信号；记录 立即开始，或由第一个信号的上升、下降触发。点曲线放游标，双指缩放时间，放大后拖动；存为 CSV。带 Ø 的是直径值。", "Touch a name on the left to choose its signal; RECORD starts at once, or when the first signal rises or falls through the level. A touch on the curves sets the cursor; pinch to zoom, then drag; SAVE CSV. A unit with Ø counts diameters.";
    Jobs = "jobs", ANY, "生产", "production", row 5, key 5 1 "生产" "PRODUCTION",
        "订单：哪个程序做多少件，已做多少；每个订单的尺寸统计和报告。断电保留。", "Orders: how many parts of which program, how many are made; statistics of their sizes, and a report. Retained at power-off.",
        "键入订单号、程序、件数，存入。开始：此后加工完的工件计入该订单，并装入它的程序。点一行选订单。报告存为 HTML。班次：每小时做了什么，各班合计，停机原因。", "Type number, program and parts of an order, ENTER. START: parts finished from now on count for it, and its program is loaded. Touch a row to choose an order. REPORT saves an HTML file. SHIFTS: what the machine did in each hour, sums, stops.";
    Network = "network", ANY, "网络", "network", row 5, key 5 2 "网络" "NETWORK",
        "网络服务：状态、地址、谁已连接，以及告诉网络的每个值。出厂时关。", "The network services: state, address, who is connected, and each value that the network is told. Off by factory.",
        "机床厂参数：P482 机床编号；P480、P481 MTConnect（OPC UA 也用）的端口和范围；P483、P486 浏览器视图；P484 MQTT，P485 车间的订单。网络只能读；订单由操作者接受。", "Builder's parameters: P482 number of the machine; P480, P481 port and reach of MTConnect (OPC UA also uses it); P483, P486 view for browsers; P484 MQTT, P485 orders of the shop. The network reads; orders are for the operator to accept.";
    Panel = "panel", ANY, "面板", "panel", row 0,
        "操作面板：各键和灯。", "The operator panel with its keys and lamps.",
        "面板在屏幕右侧（竖屏在下方），各键的作用见“按键”。", "It is to the right of the page, on a portrait display below it; see KEYS for each key.";
    Help = "help", ANY, "帮助", "help", row 3, key 3 5 "帮助" "HELP",
        "按键、软键、报警、G 和 M 代码、参数的说明；查找也找变量和程序。", "Help on keys, soft keys, alarms, G and M codes and parameters; its search also finds variables and programs.",
        "上面选类别，左边选条目，右边长的说明可以拖动；打开 转到所在的页面，收藏 把它放到总览页。任何页面按 ? 或 F12 打开，先显示该页面；放大镜直接查找。", "Choose a section above and an entry on the left; OPEN goes to its page, KEEP puts it on the overview. ? or F12 opens the help on any page, starting with that page; the magnifier opens its search.";
}
