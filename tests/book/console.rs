//! Commands of `console` and `sh` blocks.

/// Commands that do not run here, and why: what they do belongs to other stages or takes long.
const ELSEWHERE: &[(&str, &str)] = &[
    ("cargo bench", "a benchmark"),
    ("cargo run --release --example", "shows what benchmarks measure, or valgrind counts"),
    ("cargo test", "the tests themselves"),
    ("cargo +nightly", "needs a nightly compiler"),
    ("cargo fuzz", "needs a nightly compiler"),
    ("VIDEG_FUZZ", "needs a nightly compiler"),
    ("./test.sh", "the tests themselves"),
    (".venv/bin/python -m pytest", "the tests themselves"),
    (".venv/bin/python tests/browser/explorer_speed.py", "a benchmark"),
    ("UPDATE_", "writes what the tests compare with"),
];

/// What may run here: none of these installs anything, or works for hours. Whatever else stands on a page needs a mark.
const PROGRAMS: &[&str] = &[
    "videg",
    "cargo run",
    "cargo build",
    ".venv/bin/python",
    "python",
    "python3",
    "fmpy",
    "ngspice",
    "cc",
    "out/master",
    "cat",
    "cd",
    "cmp",
    "cp",
    "echo",
    "head",
    "ls",
    "mkdir",
];

/// A command of a transcript, and what the page shows behind it.
#[derive(Debug, PartialEq, Eq)]
pub struct Step {
    /// The command, with its continuation lines.
    pub command: String,
    /// What it prints.
    pub shown: String,
}

/// The commands of a `console` block.
pub fn steps(text: &str) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    let mut continued = false;
    for line in text.lines() {
        match (line.strip_prefix("$ "), steps.last_mut()) {
            (_, Some(step)) if continued => step.command.extend(["\n", line]),
            (Some(command), _) => steps.push(Step { command: command.to_owned(), shown: String::new() }),
            (None, Some(step)) => step.shown.extend([line, "\n"]),
            (None, None) => panic!("a console block begins with \"$ \", not with {line:?}"),
        }
        continued = line.ends_with('\\');
    }
    steps
}

/// The block that these are the commands of.
pub fn transcript(steps: &[Step]) -> String {
    steps.iter().flat_map(|step| ["$ ", &step.command, "\n", &step.shown]).collect()
}

/// The commands of a `sh` block, one a line, without comments.
pub fn commands(text: &str) -> Vec<String> {
    let joined = text.replace("\\\n", " ");
    let bare = joined.lines().map(|line| line.split_once(" # ").map_or(line, |(command, _)| command).trim());
    bare.filter(|line| !line.is_empty() && !line.starts_with('#')).map(str::to_owned).collect()
}

/// Why a command runs elsewhere, if it does.
pub fn elsewhere(command: &str) -> Option<&'static str> {
    ELSEWHERE.iter().find(|(prefix, _)| command.starts_with(prefix)).map(|(_, reason)| *reason)
}

/// The part of a command that is a call of no program that may run here, if there is one.
pub fn stranger(command: &str) -> Option<&str> {
    let known =
        |part: &str| PROGRAMS.iter().any(|program| part == *program || part.starts_with(&format!("{program} ")));
    command.split("&&").map(str::trim).find(|part| !known(part))
}

/// The arguments of the tool in a command that is a call of it.
pub fn arguments(command: &str) -> Option<Vec<&str>> {
    let rest = command.strip_prefix("videg ").or(command.strip_prefix("cargo run --release -- "))?;
    let end = rest.find([';', '|', '&', '>']).unwrap_or(rest.len());
    Some(rest[..end].split_whitespace().collect())
}

#[test]
fn a_transcript_is_commands_and_what_they_print() {
    let text = "$ videg cosim \\\n    --json\n{\n}\n$ echo a\na\n";
    let found = steps(text);
    assert_eq!(found[0], Step { command: "videg cosim \\\n    --json".to_owned(), shown: "{\n}\n".to_owned() });
    assert_eq!((found.len(), transcript(&found).as_str()), (2, text));
}

#[test]
fn commands_stand_without_comments_and_on_one_line() {
    let text = "videg ssp    # the package\n\n# words\nvideg cosim \\\n  --json\n";
    assert_eq!(commands(text), ["videg ssp", "videg cosim    --json"]);
    assert_eq!(arguments("videg sweep a.toml && videg x"), Some(vec!["sweep", "a.toml"]));
    assert_eq!(arguments("cargo run --release -- cosim"), Some(vec!["cosim"]));
    assert_eq!((arguments("cargo bench"), elsewhere("cargo bench --bench x")), (None, Some("a benchmark")));
}

#[test]
fn only_known_programs_run() {
    assert_eq!(stranger("cd out && videg cosim --until 1"), None);
    assert_eq!(stranger("videg ssp && fuzz/run.sh 3600"), Some("fuzz/run.sh 3600"));
    assert_eq!(stranger("cargo install --path ."), Some("cargo install --path ."));
    assert_eq!(stranger("videgs"), Some("videgs"));
}
