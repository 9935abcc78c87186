//! Programs that take every signal as they do in a terminal, whatever this process was started to ignore.

use std::process::Command;

/// The command by way of `env`, which becomes it: the number of the process stays. As it is where `env` cannot do that.
pub fn with_default_signals(command: &Command) -> Command {
    let mut other = if cfg!(target_os = "linux") {
        let mut env = Command::new("env");
        env.arg("--default-signal").arg(command.get_program());
        env
    } else {
        Command::new(command.get_program())
    };
    other.args(command.get_args());
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => other.env(name, value),
            None => other.env_remove(name),
        };
    }
    other
}
