//! The command `kt830`: arguments and wiring.

fn main() -> std::process::ExitCode {
    kt830::cli::main()
}
