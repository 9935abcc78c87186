//! Runs the blocks of all pages.

use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

use clap::Command;

use crate::block::{Block, Mark};
use crate::chapter::{self, Chapter};
use crate::clone::Clone;
use crate::compare::{agree, says_nothing};
use crate::console::{self, Step};
use crate::interpreter::Interpreter;
use crate::{GOLDEN, has_ngspice, links, patch, python, root};

/// Languages whose blocks are files for commands of the chapter.
const FILES: [&str; 6] = ["c", "spice", "toml", "json", "xml", "csv"];

/// Where chapters with Rust in them become documentation tests.
const DOCUMENTATION_TESTS: [&str; 2] = ["src/book.rs", "tests/host/src/lib.rs"];

/// At most one of so many blocks has a line that does not run.
const LEFT_OUT: usize = 6;

/// A page while its blocks run.
struct Session<'a> {
    chapter: &'a Chapter,
    clone: Clone,
    interpreter: Option<Interpreter>,
    tool: Command,
    /// What does not hold.
    failures: Vec<String>,
    /// What did not run, and why.
    left_out: Vec<String>,
    /// Parts of the page to replace when updating.
    changes: Vec<(Range<usize>, String)>,
}

impl<'a> Session<'a> {
    fn new(chapter: &'a Chapter) -> Self {
        let files = chapter.blocks.iter().filter_map(|block| Some((block.file()?, block.text.as_str())));
        Self {
            chapter,
            clone: Clone::new(files),
            interpreter: None,
            tool: videg::cli::command(),
            failures: Vec::new(),
            left_out: Vec::new(),
            changes: Vec::new(),
        }
    }

    fn fail(&mut self, block: &Block, what: &str) {
        self.failures.push(format!("{}: {what}", self.chapter.place(block)));
    }

    fn leave_out(&mut self, block: &Block, what: &str, reason: &str) {
        self.left_out.push(format!("{}: {what}: {reason}", self.chapter.place(block)));
    }

    /// Runs all blocks in order.
    fn run(&mut self) {
        let blocks = &self.chapter.blocks;
        for (index, block) in blocks.iter().enumerate() {
            if let Some(reason) = block.not_run() {
                self.leave_out(block, "block", reason);
                continue;
            }
            let output = blocks.get(index + 1).filter(|next| next.language == "text" && next.mark.is_none());
            match block.language.as_str() {
                "console" => self.console(block),
                "sh" | "bash" => self.shell(block),
                "python" => self.python(block, output),
                "rust" => self.rust(block),
                "diff" => self.diff(block),
                "text" if index > 0 && blocks[index - 1].language == "python" => {}
                language if FILES.contains(&language) => self.file(block),
                other => {
                    self.fail(block, &format!("nothing runs a block of language {other:?}; say that it is not run"));
                }
            }
        }
    }

    /// Whether the tool takes the arguments in this command.
    fn parses(&mut self, block: &Block, command: &str) {
        let Some(arguments) = console::arguments(command) else { return };
        let asked = std::iter::once("videg").chain(arguments);
        if let Err(error) = self.tool.clone().try_get_matches_from(asked)
            && error.use_stderr()
        {
            self.fail(block, &format!("{command}: {error}"));
        }
    }

    /// Why a line of a block does not run here.
    fn line_left_out(&mut self, block: &Block, line: &str) -> bool {
        let missing = if line.contains("ngspice") && !line.contains("--export") && !has_ngspice() {
            Some("ngspice is not there")
        } else if (line.contains("python ") || line.contains("python3 ")) && python().is_none() {
            Some("./test.sh setup has not run")
        } else {
            None
        };
        let reason = block.line_not_run(line).or(console::elsewhere(line)).or(missing);
        match (reason, console::stranger(line)) {
            (Some(reason), _) => self.leave_out(block, line, reason),
            (None, Some(part)) => {
                self.fail(block, &format!("{part:?} is not among what runs here; say that it is not run"));
            }
            (None, None) => return false,
        }
        true
    }

    fn console(&mut self, block: &Block) {
        let mut steps = console::steps(&block.text);
        let mut changed = false;
        for step in &mut steps {
            if self.line_left_out(block, &step.command) {
                continue;
            }
            let (done, printed) = self.clone.shell(&step.command);
            if !done {
                self.fail(block, &format!("$ {}\nends with an error:\n{printed}", step.command));
            } else if !agree(&step.shown, &printed) {
                changed = true;
                self.differs(block, &step.command, &step.shown, &printed);
                let end = if printed.is_empty() || printed.ends_with('\n') { "" } else { "\n" };
                *step = Step { shown: printed + end, command: std::mem::take(&mut step.command) };
            }
        }
        if changed {
            self.changes.push((block.range.clone(), console::transcript(&steps)));
        }
    }

    fn differs(&mut self, block: &Block, what: &str, shown: &str, printed: &str) {
        if !GOLDEN.updating() {
            self.fail(block, &format!("{what}\nis shown to print\n{shown}\nbut prints\n{printed}"));
        }
    }

    fn shell(&mut self, block: &Block) {
        for command in console::commands(&block.text) {
            self.parses(block, &command);
            if self.line_left_out(block, &command) {
                continue;
            }
            let (done, printed) = self.clone.shell(&command);
            if !done {
                self.fail(block, &format!("{command}\nends with an error:\n{printed}"));
            }
        }
    }

    fn python(&mut self, block: &Block, output: Option<&Block>) {
        if python().is_none() {
            return self.leave_out(block, "block", "./test.sh setup has not run");
        }
        if block.text.contains("\"ngspice\"") && !has_ngspice() {
            return self.leave_out(block, "block", "ngspice is not there");
        }
        let (done, printed) = self.interpreter.get_or_insert_with(|| Interpreter::start(&self.clone)).run(&block.text);
        let shown = output.map_or("", |output| output.text.as_str());
        if !done {
            self.fail(block, &format!("ends with an error:\n{printed}"));
        } else if !agree(shown, &printed) {
            self.differs(block, "the block", shown, &printed);
            match output {
                Some(output) => self.changes.push((output.range.clone(), printed)),
                None => self.fail(block, &format!("a block of text behind it must show what it prints:\n{printed}")),
            }
        }
    }

    fn rust(&mut self, block: &Block) {
        let chapter = format!("/{}\"", self.chapter.path.display());
        let lists = |file: &&str| std::fs::read_to_string(root().join(file)).unwrap().contains(&chapter);
        if !DOCUMENTATION_TESTS.iter().any(lists) {
            self.fail(
                block,
                &format!("none of {DOCUMENTATION_TESTS:?} lists the chapter, so the block is not compiled"),
            );
        }
    }

    fn diff(&mut self, block: &Block) {
        if let Err(reason) = patch::applies_and_passes(&block.text) {
            self.fail(block, &reason);
        }
    }

    /// A file must be one that a command of the chapter takes; TOML without a name is a case file.
    fn file(&mut self, block: &Block) {
        let Some(name) = block.file() else {
            if block.language != "toml" {
                self.fail(block, "a comment must say which file it is");
            } else if let Err(reason) = videg::scenario::CaseFile::parse(&block.text) {
                self.fail(block, &reason);
            }
            return;
        };
        let used = |other: &&Block| ["console", "sh", "python"].contains(&other.language.as_str());
        if !self.chapter.blocks.iter().filter(used).any(|other| other.text.contains(name)) {
            self.fail(block, &format!("no command of the chapter takes {name}"));
        }
    }

    /// Writes what was printed into the page, and the pictures that its blocks drew beside it.
    fn update(&self) {
        let folder = self.chapter.path.parent().unwrap_or(Path::new(""));
        for name in links::pictures(&self.chapter.text) {
            let drawn = self.clone.path().join("figures").join(&name);
            if drawn.exists() {
                std::fs::copy(drawn, root().join(folder).join(&name)).unwrap();
            }
        }
        let mut text = self.chapter.text.clone();
        for (range, new) in self.changes.iter().rev() {
            text.replace_range(range.clone(), new);
        }
        if text != self.chapter.text {
            std::fs::write(root().join(&self.chapter.path), text).unwrap();
        }
    }
}

/// The commands of a block.
fn lines(block: &Block) -> Vec<String> {
    match block.language.as_str() {
        "console" => console::steps(&block.text).into_iter().map(|step| step.command).collect(),
        "sh" | "bash" => console::commands(&block.text),
        _ => Vec::new(),
    }
}

#[test]
fn every_command_is_of_a_known_program_or_says_why_it_does_not_run() {
    let mut strangers = Vec::new();
    for chapter in chapter::all() {
        for block in chapter.blocks.iter().filter(|block| block.not_run().is_none()) {
            for line in lines(block) {
                let reason = block.line_not_run(&line).or(console::elsewhere(&line));
                let stranger = console::stranger(&line).filter(|_| reason.is_none());
                strangers.extend(stranger.map(|part| format!("{}: {part}", chapter.place(block))));
            }
        }
    }
    assert!(strangers.is_empty(), "{strangers:#?}");
}

#[test]
fn what_is_shown_says_something() {
    for chapter in chapter::all() {
        for block in chapter.blocks.iter().filter(|block| block.not_run().is_none()) {
            let shown: Vec<String> = match block.language.as_str() {
                "console" => console::steps(&block.text).into_iter().map(|step| step.shown).collect(),
                "text" => vec![block.text.clone()],
                _ => Vec::new(),
            };
            assert!(!shown.iter().any(|shown| says_nothing(shown)), "{} shows nothing", chapter.place(block));
        }
    }
}

#[test]
fn changes_of_the_sources_apply() {
    for chapter in chapter::all() {
        for block in chapter.blocks.iter().filter(|block| block.language == "diff") {
            patch::applies(&block.text).unwrap_or_else(|error| panic!("{}: {error}", chapter.place(block)));
        }
    }
}

/// `VIDEG_PAGE=docs/theory` runs only the pages whose path contains that.
#[test]
#[ignore = "slow: ./test.sh book"]
fn every_block_of_every_page_runs_and_prints_what_is_shown() {
    let only = std::env::var("VIDEG_PAGE").unwrap_or_default();
    let (mut failures, mut left_out) = (String::new(), String::new());
    for chapter in chapter::all().iter().filter(|chapter| chapter.path.to_string_lossy().contains(&only)) {
        let mut session = Session::new(chapter);
        session.run();
        session.failures.iter().for_each(|failure| writeln!(failures, "{failure}\n").unwrap());
        session.left_out.iter().for_each(|what| writeln!(left_out, "  {what}").unwrap());
        if GOLDEN.updating() {
            session.update();
        }
    }
    println!("not run:\n{left_out}");
    assert!(failures.is_empty(), "{failures}");
}

#[test]
fn few_blocks_do_not_run_and_each_says_why() {
    let (mut blocks, mut left_out) = (0, Vec::new());
    for chapter in chapter::all() {
        for block in &chapter.blocks {
            blocks += 1;
            if let Some(Mark::NotRun { reason, .. }) = &block.mark {
                assert!(reason.split_whitespace().count() > 1, "{}: {reason:?} is no reason", chapter.place(block));
                left_out.push(chapter.place(block));
            } else if let Some(Mark::RunBy(test)) = &block.mark {
                let said = std::fs::read_to_string(root().join(test))
                    .unwrap_or_else(|error| panic!("{}: {test}: {error}", chapter.place(block)));
                let page = chapter.path.to_str().unwrap();
                assert!(said.contains(&format!("\"{page}\"")), "{}: {test} does not name it", chapter.place(block));
            } else if lines(block).iter().any(|line| console::elsewhere(line).is_some()) {
                left_out.push(chapter.place(block));
            }
        }
    }
    assert!(left_out.len() * LEFT_OUT < blocks, "{} of {blocks} blocks do not run: {left_out:#?}", left_out.len());
}
