//! The `etalon` program: everything is in the library.

fn main() -> std::process::ExitCode {
    etalon::cli::main(std::env::args_os()).into()
}
