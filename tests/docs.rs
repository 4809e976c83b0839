//! The tables of the manual come from `defs/`: this test writes them anew and fails when they were not up to date.

#![allow(clippy::unwrap_used, reason = "a test driver: a failure is the message")]

use std::fmt::Write;
use std::path::Path;

use kt830::defs::alarm::ALARMS;
use kt830::defs::key::Key;
use kt830::defs::mcode::MCODES;
use kt830::defs::param::{BITS, NUMBERS, Params};
use kt830::defs::signal::{Input, Output};
use kt830::defs::{kind::Kind, program_error::ProgramError};

fn tables() -> String {
    let mut text = String::from("# 表 Tables\n\n本页由 `defs/` 生成，请勿手改。Generated from `defs/`; do not edit.\n");
    keys(&mut text);
    codes(&mut text);
    alarms(&mut text);
    params(&mut text);
    signals(&mut text);
    text
}

fn keys(text: &mut String) {
    text.push_str("\n## 面板按键 Panel keys\n\n| 按键 | key | id | 运行中 in a run |\n|---|---|---|---|\n");
    for key in Key::ALL {
        let (row, run) = (key.row(), if key.row().in_run { "有效 acts" } else { "–" });
        writeln!(text, "| {} | {} | `{}` | {run} |", row.label.zh, row.label.en, row.id).unwrap();
    }
}

fn codes(text: &mut String) {
    text.push_str("\n## M 代码 M codes\n\n| 代码 | 功能 | function | 依据 row |\n|---|---|---|---|\n");
    for row in MCODES {
        writeln!(text, "| M{:02} | {} | {} | {} |", row.code, row.name.zh, row.name.en, row.row).unwrap();
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

fn params(text: &mut String) {
    text.push_str("\n## 参数 Parameters\n\n| 参数 | 名称 | name | 范围 range | 出厂 factory | 单位 unit |\n|---|---|---|---|---|---|\n");
    for row in BITS {
        let factory = u8::from(row.factory[Kind::Gc as usize]);
        writeln!(text, "| P{}.{} | {} | {} | 0, 1 | {factory} | |", row.number, row.bit, row.name.zh, row.name.en)
            .unwrap();
    }
    for row in NUMBERS {
        let (name, range) = (row.name, format!("{} … {}", row.min, row.max));
        writeln!(text, "| P{} | {} | {} | {range} | {} | {} |", row.number, name.zh, name.en, row.factory, row.unit)
            .unwrap();
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
