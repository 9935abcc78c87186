//! One Python interpreter for all blocks of a chapter.

use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

use serde_json::{Value, json};

use crate::clone::Clone;

/// Runs blocks that come as lines of JSON; answers each with what it printed.
const DRIVER: &str = r#"
import contextlib, io, json, sys, traceback
names, answers = {"__name__": "__main__"}, sys.stdout
for number, line in enumerate(sys.stdin):
    printed, done = io.StringIO(), True
    try:
        with contextlib.redirect_stdout(printed):
            exec(compile(json.loads(line), f"block {number + 1}", "exec"), names)
    except BaseException:
        done = False
        printed.write(traceback.format_exc())
    answers.write(json.dumps([done, printed.getvalue()]) + "\n")
    answers.flush()
"#;

/// The interpreter.
pub struct Interpreter {
    child: Child,
    asked: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

impl Interpreter {
    /// An interpreter in the folder of a chapter.
    pub fn start(clone: &Clone) -> Self {
        let mut command = clone.command("python");
        command.args(["-c", DRIVER]).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let (asked, answers) = (child.stdin.take(), BufReader::new(child.stdout.take().unwrap()));
        Self { child, asked, answers }
    }

    /// Runs a block; returns whether it came to its end, and what it printed.
    pub fn run(&mut self, code: &str) -> (bool, String) {
        writeln!(self.asked.as_mut().unwrap(), "{}", json!(code)).unwrap();
        let mut line = String::new();
        self.answers.read_line(&mut line).unwrap();
        match serde_json::from_str::<Value>(&line) {
            Ok(answer) => (answer[0] == true, answer[1].as_str().unwrap_or_default().to_owned()),
            Err(_) => (false, "the interpreter died".to_owned()),
        }
    }
}

impl Drop for Interpreter {
    fn drop(&mut self) {
        self.asked = None; // The end of its input ends it.
        let _ = self.child.wait();
    }
}
