//! The command `kt830`: arguments and wiring.

fn main() {}
