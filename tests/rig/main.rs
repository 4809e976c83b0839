//! Scenarios on the EtherCAT rig: drives, terminals and mechanics that were not written here. One process plays one
//! scenario; `tests/rig/run.sh` plays all of them. Without a name the scenarios are listed.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::print_stdout,
    reason = "a test driver: a failure is the message"
)]

mod course;
mod modbus;
mod plant;
mod scenarios;
mod session;
mod wire;

use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(name) = std::env::args().nth(1).filter(|word| !word.starts_with('-')) else {
        scenarios::ALL.iter().for_each(|scenario| println!("{}", scenario.name));
        return ExitCode::SUCCESS;
    };
    let mut known = scenarios::ALL.iter().chain(scenarios::LONG);
    let Some(scenario) = known.find(|known| known.name == name) else {
        eprintln!("there is no scenario {name}");
        return ExitCode::from(2);
    };
    println!("{name}");
    match session::run(scenario) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            println!("{name}: FAILED: {why}");
            ExitCode::FAILURE
        }
    }
}
