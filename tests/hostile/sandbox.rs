//! Where an input is tried: a folder of its own with something to lose, and a look at it afterwards.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// How long an input may keep the program busy.
const LIMIT: Duration = Duration::from_secs(120);

/// A hostile input.
pub struct Input {
    /// What it is.
    pub what: &'static str,
    /// How it is given.
    pub given: Given,
    /// The exit code that it must come to.
    pub code: i32,
}

/// What commands that hide in inputs would make: in them it stands for an absolute path that is looked at afterwards.
pub const CANARY: &str = "CANARY";
/// Where names that are absolute lead.
const ROOT_CANARY: &str = "/canary";

/// How an input is given.
pub enum Given {
    /// A command with these words, in a folder with these files.
    Command(Vec<String>, Vec<(&'static str, Vec<u8>)>),
    /// An FMU whose library is compiled with these macros, checked with these options.
    Library(Vec<String>, Vec<&'static str>),
    /// A call from Rust: what it is called, and what it comes to.
    Call(&'static str, fn() -> String),
}

/// What came of it.
pub struct Told {
    pub code: Option<i32>,
    pub line: String,
}

/// A command on files, which must be refused.
pub fn refused(what: &'static str, words: &[&str], files: Vec<(&'static str, Vec<u8>)>) -> Input {
    Input { what, given: Given::Command(words.iter().map(|word| (*word).to_owned()).collect(), files), code: 2 }
}

impl Input {
    /// How it is given, as it is shown.
    pub fn shown(&self) -> String {
        match &self.given {
            Given::Command(words, _) => {
                format!("videg {}", words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" "))
            }
            Given::Library(_, options) => [&["videg fmu check toy.fmu"][..], options].concat().join(" "),
            Given::Call(name, _) => (*name).to_owned(),
        }
    }

    fn words(&self) -> Vec<String> {
        match &self.given {
            Given::Command(words, _) => words.clone(),
            Given::Library(_, options) => {
                [&["fmu", "check", "toy.fmu"][..], options].concat().into_iter().map(str::to_owned).collect()
            }
            Given::Call(..) => Vec::new(),
        }
    }
}

fn quoted(word: &str) -> String {
    let shown: String = word.chars().flat_map(char::escape_debug).collect::<String>().replace("\\'", "'");
    let shown = if shown.len() > 60 { format!("{}[...]", shown.chars().take(50).collect::<String>()) } else { shown };
    if word.chars().all(|c| c.is_ascii_alphanumeric() || "-_.,=/:+".contains(c)) { shown } else { format!("'{shown}'") }
}

fn videg() -> Command {
    Command::new(env!("CARGO_BIN_EXE_videg"))
}

/// Builds the FMUs of this project once, which may take long; the inputs then find them as new as their sources.
pub fn build() {
    let folder = tempfile::tempdir().unwrap();
    let output = videg().args(["fmu", "build", "--output"]).arg(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Tries an input.
pub fn run(input: &Input) -> Told {
    if let Given::Call(_, call) = input.given {
        return Told { code: None, line: call() };
    }
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().canonicalize().unwrap();
    let [work, temporary] = ["work", "tmp"].map(|name| root.join(name));
    for folder in [&work, &temporary, &work.join("out")] {
        fs::create_dir_all(folder).unwrap();
    }
    fs::write(work.join("out/kept.txt"), "a result of yesterday").unwrap();
    match &input.given {
        Given::Command(_, files) => files.iter().for_each(|(name, bytes)| {
            fs::create_dir_all(work.join(name).parent().unwrap()).unwrap();
            fs::write(work.join(name), bytes).unwrap();
        }),
        Given::Library(macros, _) => {
            let macros: Vec<_> = macros.iter().map(String::as_str).collect();
            super::toy::fmu(&work, "toy.fmu", &macros);
        }
        Given::Call(..) => {}
    }
    let before = snapshot(&root);
    let mut command = videg();
    let canary = root.join("canary").display().to_string();
    let words: Vec<_> = input.words().iter().map(|word| word.replace(CANARY, &canary)).collect();
    command.args(&words).current_dir(&work).env("TMPDIR", &temporary);
    let output = limited(&mut command, input.what);
    check_folder(input.what, &root, &before);
    told(input, &output, &root)
}

/// Every file and folder below, with its bytes.
fn snapshot(folder: &Path) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all.extend(snapshot(&path));
            all.insert(path, None);
        } else {
            let bytes = fs::read(&path).unwrap();
            all.insert(path, Some(bytes));
        }
    }
    all
}

fn check_folder(what: &str, root: &Path, before: &BTreeMap<PathBuf, Option<Vec<u8>>>) {
    let after = snapshot(root);
    for (path, bytes) in before {
        assert!(after.get(path) == Some(bytes), "{what}: {} is not what it was", path.display());
    }
    assert!(!Path::new(ROOT_CANARY).exists(), "{what}: {ROOT_CANARY} was written");
    let results = root.join("work/out");
    for path in after.keys().filter(|path| !before.contains_key(*path)) {
        assert!(path.starts_with(&results), "{what}: {} was written", path.display());
        assert!(!path.ends_with("canary"), "{what}: {} was written by a command", path.display());
    }
}

/// Runs a command, which must end.
fn limited(command: &mut Command, what: &str) -> Output {
    let mut child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let read = |mut from: Box<dyn std::io::Read + Send>| {
        std::thread::spawn(move || {
            let mut bytes = Vec::new();
            let _ = from.read_to_end(&mut bytes);
            bytes
        })
    };
    let (stdout, stderr) = (child.stdout.take().unwrap(), child.stderr.take().unwrap());
    let (stdout, stderr) = (read(Box::new(stdout)), read(Box::new(stderr)));
    let end = Instant::now() + LIMIT;
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if Instant::now() > end {
            child.kill().unwrap();
            panic!("{what}: not done after {LIMIT:?}");
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    Output { status, stdout: stdout.join().unwrap(), stderr: stderr.join().unwrap() }
}

/// What an input came to: one line on stderr, without the names of folders.
fn told(input: &Input, output: &Output, root: &Path) -> Told {
    let what = input.what;
    let stderr = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(output.status.code(), Some(input.code), "{what}: {} {stderr}", String::from_utf8_lossy(&output.stdout));
    if input.code != 2 {
        let stdout = String::from_utf8_lossy(&output.stdout);
        let is_check = |line: &str| line.starts_with("ok  ") || line.starts_with("FAILED  ");
        assert!(stdout.lines().all(is_check), "{what}: {stdout}");
        let line = stdout.lines().last().unwrap_or_default().to_owned();
        return Told { code: output.status.code(), line: without_folders(&line, root) };
    }
    assert_eq!(stderr.lines().count(), 1, "{what}: {stderr}");
    assert!(!stderr.trim_end().contains(char::is_control), "{what}: {stderr:?}");
    let line = without_folders(stderr.trim(), root);
    Told { code: Some(2), line: line.trim_start_matches("videg: ").to_owned() }
}

/// `text` without what differs from run to run or with each parameter of the model: folders, numbers of threads, GUIDs.
fn without_folders(text: &str, root: &Path) -> String {
    let text = text.replace(&root.join("canary").display().to_string(), CANARY);
    let root = root.display().to_string();
    let folders = ["/work/", "/tmp/"];
    let text = folders.iter().fold(text, |text, part| text.replace(&format!("{root}{part}"), ""));
    let text = match text.split_once("'main' (") {
        Some((before, after)) => format!("{before}'main'{}", after.split_once(')').map_or("", |(_, after)| after)),
        None => text,
    };
    let guid = |part: &str| {
        part.as_bytes().get(36) == Some(&b'}') && part.bytes().take(36).all(|b| b == b'-' || b.is_ascii_hexdigit())
    };
    let parts = text.split('{').enumerate();
    parts
        .map(|(k, part)| match (k, guid(part)) {
            (0, _) => part.to_owned(),
            (_, true) => format!("{{...{}", &part[36..]),
            (_, false) => format!("{{{part}"),
        })
        .collect()
}
