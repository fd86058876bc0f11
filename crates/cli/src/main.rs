//! The program `etendue`. All of its code is in the library of the same name, which other programs
//! can embed.

use std::process::ExitCode;

fn main() -> ExitCode {
    etendue::main()
}
