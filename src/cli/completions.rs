//! `etalon completions`: a script that completes the program's options in a shell.

use super::console::Console;
use super::global::Verdict;
use clap::{Args, Command, value_parser};
use clap_complete::{Shell, generate};
use etalon_core::error::{Error, Result};

/// Print a script that completes options in a shell
#[derive(Args)]
#[command(
    after_long_help = "Examples:\n  etalon completions bash > ~/.local/share/bash-completion/completions/etalon\n  etalon \
                        completions zsh > ~/.zfunc/_etalon\n  etalon completions fish > ~/.config/fish/completions/etalon.fish"
)]
pub struct Completions {
    /// The shell
    #[arg(value_name = "SHELL", value_parser = value_parser!(Shell))]
    shell: Shell,
}

impl Completions {
    /// Prints the script for `command`, the program.
    pub fn run(&self, mut command: Command, console: &Console) -> Result<Verdict> {
        let mut script = Vec::new();
        generate(self.shell, &mut command, "etalon", &mut script);
        let script = String::from_utf8(script).map_err(|_| Error::parameter("shell", "its script is not UTF-8"))?;
        console.result(&std::collections::BTreeMap::from([("script", &script)]), || script.clone());
        Ok(Verdict::Good)
    }
}
