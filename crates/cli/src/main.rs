//! The program `etendue`: all of it is in the library of the same name, which other programs have inside.

use std::process::ExitCode;

fn main() -> ExitCode {
    etendue::main()
}
