//! The tables of the manual come from `defs/`: this test writes them anew and fails when they were not up to date.

use std::fmt::Write;
use std::path::Path;

use kt830::defs::alarm::ALARMS;
use kt830::defs::gcode::G_CODES;
use kt830::defs::key::Key;
use kt830::defs::kind::{Dialect, Kind};
use kt830::defs::language_row::LanguageState;
use kt830::defs::mcode::{Gauge, MCODES, Request};
use kt830::defs::param::{BITS, NUMBERS, Params};
use kt830::defs::program_error::ProgramError;
use kt830::defs::signal::{Input, Output};
use kt830::defs::sim_fault::FAULTS;
use kt830::defs::soft_key;
use kt830::defs::system_variable::{SYSTEM_VARIABLES, VariableAccess};
use kt830::defs::text::Text;
use kt830::machine::{interlock::RuleOutcome, rules::RULES};
use kt830::nc::refused_words;

/// One example of every request with its name.
const REQUEST_EXAMPLES: &[(Request, Text)] = &[
    (Request::WheelStart, Text::new("砂轮启动", "wheel start")),
    (Request::WheelStop, Text::new("砂轮停止", "wheel stop")),
    (Request::TailstockAdvance, Text::new("尾座进", "tailstock advance")),
    (Request::TailstockRetract, Text::new("尾座退", "tailstock retract")),
    (Request::WorkDriveHigh, Text::new("头架高速/滚轮/台面", "headstock high, roll, table")),
    (Request::WorkDriveLow, Text::new("头架低速", "headstock low")),
    (Request::WorkDriveStop, Text::new("头架/滚轮/台面停止", "headstock, roll, table stop")),
    (Request::HydraulicOn, Text::new("液压开", "hydraulics on")),
    (Request::HydraulicOff, Text::new("液压关", "hydraulics off")),
    (Request::Magnetise, Text::new("充磁", "magnetise")),
    (Request::Demagnetise, Text::new("退磁", "demagnetise")),
    (Request::MagnetOff, Text::new("断磁", "magnet off")),
    (Request::SecondSpindleStart(false), Text::new("第二主轴启动", "second spindle start")),
    (Request::SecondSpindleStop, Text::new("第二主轴停止", "second spindle stop")),
    (Request::Gauge(Gauge::Radial, true), Text::new("量仪伸出", "gauge out")),
    (Request::Gauge(Gauge::Radial, false), Text::new("量仪缩回", "gauge in")),
    (Request::Gear(0), Text::new("换档", "gear change")),
    (Request::Switch(Output::Coolant, true), Text::new("冷却开", "coolant on")),
    (Request::Switch(Output::Coolant, false), Text::new("冷却关", "coolant off")),
    (Request::Switch(Output::Lubrication, true), Text::new("润滑开", "lubrication on")),
    (Request::Switch(Output::User1, true), Text::new("用户输出开", "user output on")),
    (Request::Port(1, true), Text::new("输出口开/关 (M21 M22)", "port on or off (M21, M22)")),
    (Request::Pulse(1, 1), Text::new("输出口脉冲 (M20)", "port pulse (M20)")),
    (Request::CylinderOn, Text::new("振荡气缸启动", "oscillation cylinder on")),
    (Request::SpindleStart(false), Text::new("主轴启动", "main spindle start")),
    (Request::SpindleStop, Text::new("主轴停止", "main spindle stop")),
    (Request::ToolTurret(1), Text::new("换刀", "tool post")),
    (Request::CycleStart, Text::new("循环启动", "cycle start")),
    (Request::MdiStart, Text::new("录入执行", "MDI line")),
    (Request::HomeAxes, Text::new("回零", "homing")),
    (Request::Jog, Text::new("手动移动", "moving by hand")),
];

fn tables() -> String {
    let mut text = String::from("# 表 Tables\n\n本页由 `defs/` 生成，请勿手改。Generated from `defs/`; do not edit.\n");
    keys(&mut text);
    soft_keys(&mut text);
    codes(&mut text);
    language(&mut text);
    variables(&mut text);
    alarms(&mut text);
    interlocks(&mut text);
    params(&mut text);
    signals(&mut text);
    faults(&mut text);
    text
}

fn keys(text: &mut String) {
    text.push_str("\n## 面板按键 Panel keys\n\n| 按键 | key | id | 运行中 in a run | 作用 | what it does |\n|---|---|---|---|---|---|\n");
    for key in Key::ALL {
        let (row, run) = (key.row(), if key.row().active_in_run { "有效 acts" } else { "–" });
        let (label, help) = (row.label, row.help);
        writeln!(text, "| {} | {} | `{}` | {run} | {} | {} |", label.zh, label.en, row.id, help.zh, help.en).unwrap();
    }
}

/// The soft keys of the kinds, those with the same keys together.
fn soft_keys(text: &mut String) {
    text.push_str("\n## 软键 Soft keys\n");
    let mut tables: Vec<(Vec<&str>, String)> = Vec::new();
    for kind in Kind::ALL {
        let mut table = String::new();
        for row in 0..soft_key::ROWS {
            let keys: Vec<_> = soft_key::row(kind, row).map(|soft| soft.label).collect();
            let cell = |place: usize| keys.get(place).map_or_else(String::new, |key| format!("{} {}", key.zh, key.en));
            writeln!(table, "| {} | {} |", row + 1, (0..5).map(cell).collect::<Vec<_>>().join(" | ")).unwrap();
        }
        match tables.iter_mut().find(|(_, same)| *same == table) {
            Some((kinds, _)) => kinds.push(kind.short_name()),
            None => tables.push((vec![kind.short_name()], table)),
        }
    }
    for (kinds, table) in tables {
        let head = "| 行 row | F1 | F2 | F3 | F4 | F5 |\n|---|---|---|---|---|---|";
        writeln!(text, "\n{}:\n\n{head}\n{}", kinds.join(", "), table.trim_end()).unwrap();
    }
}

fn codes(text: &mut String) {
    text.push_str("\n## M 代码 M codes\n\n| 代码 | 功能 | function | 依据 row | 说明 | what it does |\n|---|---|---|---|---|---|\n");
    for row in MCODES {
        let (name, help) = (row.name, row.help);
        writeln!(
            text,
            "| M{:02} | {} | {} | {} | {} | {} |",
            row.code, name.zh, name.en, row.spec_row, help.zh, help.en
        )
        .unwrap();
    }
    text.push_str("\n## G 代码 G codes\n\n| 代码 | 功能 | function | 说明 | what it does |\n|---|---|---|---|---|\n");
    for row in G_CODES {
        let (name, help) = (row.text, row.help);
        writeln!(text, "| G{:02} | {} | {} | {} | {} |", row.code, name.zh, name.en, help.zh, help.en).unwrap();
    }
}

/// Statements, operators and words beside the codes, by language.
fn language(text: &mut String) {
    let languages = [
        ("外圆磨 GC", Dialect::LatheA),
        ("平磨、圆台磨 GS GA", Dialect::Mill),
        ("立车磨 802D", Dialect::Sinumerik),
        ("超人车床 lathe", Dialect::SuperMan),
    ];
    text.push_str("\n## 语句和地址 Statements and words\n\n全部代码：`kt830 codes --kind gc`。All codes: `kt830 codes --kind gc`.\n");
    for (title, dialect) in languages {
        write!(text, "\n### {title}\n\n| 写法 written | 状态 state | 含义 | meaning |\n|---|---|---|---|\n").unwrap();
        for row in dialect.language_rows() {
            let state = match row.state {
                LanguageState::Supported => "可用 supported",
                LanguageState::NoEffect => "无作用 no effect",
                LanguageState::Refused => "拒绝 refused",
            };
            writeln!(text, "| {} | {state} | {} | {} |", row.word, row.text.zh, row.text.en).unwrap();
        }
        let refused = refused_words(dialect);
        if !refused.is_empty() {
            writeln!(text, "| {} | 拒绝 refused | 较大系统的词 | words of larger controls |", refused.join(" "))
                .unwrap();
        }
    }
}

fn variables(text: &mut String) {
    text.push_str("\n## 系统变量 System variables\n\n| 变量 | 含义 | meaning | 程序可 |\n|---|---|---|---|\n");
    for row in SYSTEM_VARIABLES {
        let access = match row.access {
            VariableAccess::Read => "读 read",
            VariableAccess::ReadWrite => "读写 read, write",
            VariableAccess::Write => "写 write",
        };
        let last = row.first + row.count - 1;
        let numbers = if row.count == 1 { format!("#{}", row.first) } else { format!("#{}–#{last}", row.first) };
        writeln!(text, "| {numbers} | {} | {} | {access} |", row.name.zh, row.name.en).unwrap();
    }
}

fn interlocks(text: &mut String) {
    text.push_str(
        "\n## 联锁 Interlocks\n\n从上到下，第一条成立的起作用。Read from the top; the first that applies answers. 拒绝：信息，程序在该段前等待；\
         无效：信息，程序继续；报警：程序在该段前停止。deny: a message, a program waits before the block; no effect: a message, the program goes \
         on; alarm: the program stops before the block.\n\n| 依据 row | 禁止 | forbids | 结果 outcome | 原因 | reason |\n|---|---|---|---|---|---|\n",
    );
    for rule in RULES {
        let forbidden: Vec<_> = REQUEST_EXAMPLES.iter().filter(|(request, _)| (rule.forbids)(*request)).collect();
        assert!(!forbidden.is_empty(), "{} forbids nothing", rule.reason.en);
        let names = |name: fn(&Text) -> &'static str, comma: &str| {
            forbidden.iter().map(|(_, text)| name(text)).collect::<Vec<_>>().join(comma)
        };
        let (zh, en) = (names(|text| text.zh, "、"), names(|text| text.en, ", "));
        let outcome = match rule.outcome {
            RuleOutcome::NoEffect => "无效 no effect".to_owned(),
            RuleOutcome::Deny => "拒绝 deny".to_owned(),
            RuleOutcome::Alarm(number) => format!("报警 alarm {number:03}"),
        };
        writeln!(text, "| {} | {zh} | {en} | {outcome} | {} | {} |", rule.row, rule.reason.zh, rule.reason.en).unwrap();
    }
}

fn alarms(text: &mut String) {
    text.push_str(
        "\n## 报警 Alarms\n\n| 号 | 报警 | 原因 | 处理 | alarm | cause | remedy |\n|---|---|---|---|---|---|---|\n",
    );
    for row in ALARMS {
        let (a, c, r) = (row.text, row.cause, row.remedy);
        writeln!(text, "| {:03} | {} | {} | {} | {} | {} | {} |", row.number, a.zh, c.zh, r.zh, a.en, c.en, r.en)
            .unwrap();
    }
    text.push_str("\n## 程序报警 Program alarms\n\n| 号 | 报警 | alarm |\n|---|---|---|\n");
    for error in ProgramError::ALL {
        writeln!(text, "| {:03} | {} | {} |", error.number(), error.text().zh, error.text().en).unwrap();
    }
}

/// What holds on the default kind, then the kinds that differ from it.
fn by_kind(of: impl Fn(Kind) -> String) -> String {
    let default = of(Kind::default());
    let others = Kind::ALL.iter().filter(|kind| of(**kind) != default);
    let words: Vec<_> = others.map(|kind| format!("; {} {}", kind.short_name(), of(*kind))).collect();
    format!("{default}{}", words.concat())
}

fn params(text: &mut String) {
    text.push_str("\n## 参数 Parameters\n\n分号后为不同的机型。After a semicolon: the kinds that differ.\n\n| 参数 | 名称 | name | 范围 range | 出厂 factory | 单位 unit |\n|---|---|---|---|---|---|\n");
    for row in BITS {
        let factory = by_kind(|kind| u8::from(row.factory_on(kind)).to_string());
        writeln!(text, "| P{}.{} | {} | {} | 0, 1 | {factory} | |", row.number, row.bit, row.name.zh, row.name.en)
            .unwrap();
    }
    for row in NUMBERS {
        let range = by_kind(|kind| {
            let (min, max) = row.range_on(kind);
            format!("{min} … {max}")
        });
        let (name, factory) = (row.name, by_kind(|kind| Params::factory(kind).get(*row).to_string()));
        writeln!(text, "| P{} | {} | {} | {range} | {factory} | {} |", row.number, name.zh, name.en, row.unit).unwrap();
    }
}

fn signals(text: &mut String) {
    let params = Params::factory(Kind::Gc);
    text.push_str("\n## 输入 Inputs\n\n| 输入 | input | id | 参数 | 出厂口 port |\n|---|---|---|---|---|\n");
    for input in Input::ALL {
        let (name, port) = (input.name(), params.input_port(*input));
        writeln!(text, "| {} | {} | `{}` | P{} | {port} |", name.zh, name.en, input.id(), input.port_param()).unwrap();
    }
    text.push_str("\n## 输出 Outputs\n\n| 输出 | output | id | 参数 | 出厂口 port |\n|---|---|---|---|---|\n");
    for output in Output::ALL {
        let (name, port) = (output.name(), params.output_port(*output));
        writeln!(text, "| {} | {} | `{}` | P{} | {port} |", name.zh, name.en, output.id(), output.port_param())
            .unwrap();
    }
}

fn faults(text: &mut String) {
    text.push_str(
        "\n## 模拟机床的故障 Faults of the simulated machine\n\n故事里写 `fault 名称`；NAME 为输入的 id，N 为周期数。`fault list` 打印本表。In a \
         story: `fault` and the name; NAME is the id of an input, N a number of ticks. `fault list` prints this table.\n\n\
         | 名称 name | 故障 | fault |\n|---|---|---|\n",
    );
    for row in FAULTS {
        writeln!(text, "| `{}` | {} | {} |", row.usage(), row.text.zh, row.text.en).unwrap();
    }
}

#[test]
fn the_tables_of_the_manual_are_those_of_defs() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/manual/tables.md");
    let wanted = tables();
    let present = std::fs::read_to_string(&path).unwrap_or_default();
    if present != wanted {
        std::fs::write(&path, wanted).unwrap();
        panic!("docs/manual/tables.md was not up to date; it has been written anew");
    }
}
