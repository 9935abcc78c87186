//! Random circuits through `videg crosscheck`, with a table of which run, agree or give up, and why:
//! `cargo build --release && cargo run --release --example random_crosschecks -- 200`.
//!
//! Arguments: how many (200), seed (1). Exit code 1 if a circuit disagrees or ends without saying why, or if more than one in a
//! hundred gives up.

mod draw;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use anyhow::Context as _;
use draw::Outcome;

/// What a run has come to, and what was changed on the way.
struct Ran {
    outcome: Outcome,
    repeated: Vec<String>,
    /// The check that uses up most of its tolerance.
    closest: Option<(f64, String)>,
}

impl Ran {
    /// The outcome as a word, and what is wrong.
    fn words(&self) -> (&'static str, &str) {
        match &self.outcome {
            Outcome::Agrees => ("agrees", ""),
            Outcome::Disagrees(reason) => ("DISAGREES", reason),
            Outcome::GaveUp(reason) => ("gave up", reason),
            Outcome::Broke(reason) => ("BROKE", reason),
        }
    }
}

/// The tool beside the folder of this example.
fn tool() -> anyhow::Result<PathBuf> {
    let own = std::env::current_exe()?;
    let folder = own.parent().and_then(|folder| folder.parent()).context("this program lies in no folder of Cargo")?;
    let program = folder.join(format!("videg{}", std::env::consts::EXE_SUFFIX));
    anyhow::ensure!(program.is_file(), "{} is not there: run cargo build --release", program.display());
    Ok(program)
}

fn argument(index: usize, otherwise: u64) -> anyhow::Result<u64> {
    let Some(text) = std::env::args().nth(index) else { return Ok(otherwise) };
    text.parse().with_context(|| format!("argument {index} = {text}: must be a number"))
}

fn main() -> anyhow::Result<ExitCode> {
    let [count, seed] = [argument(1, 200)?, argument(2, 1)?];
    let program = tool()?;
    let folder = tempfile::tempdir()?;
    let mut ran = Vec::new();
    for index in 0..count {
        let arguments = draw::arguments(seed, index);
        let found = run(&program, &folder.path().join(index.to_string()), &arguments)?;
        show(index, &arguments, &found);
        ran.push(found);
    }
    Ok(sum_up(&ran, seed))
}

fn run(program: &Path, folder: &Path, arguments: &[String]) -> std::io::Result<Ran> {
    let output =
        Command::new(program).args(["crosscheck", "--json", "--output"]).arg(folder).args(arguments).output()?;
    Ok(Ran { outcome: draw::outcome(&output), repeated: draw::repeated(&output), closest: draw::closest(&output) })
}

fn show(index: u64, arguments: &[String], found: &Ran) {
    let (word, reason) = found.words();
    println!("{index:>5}  {word:<9}  {}", arguments.join(" "));
    for line in reason.split("; ").filter(|line| !line.is_empty()) {
        println!("{:>18}{}", "", line.replace('\n', " |"));
    }
    if let Some((part, check)) = &found.closest {
        println!("{:>18}at most {part:.3} of a tolerance, {check}", "");
    }
    for change in &found.repeated {
        println!("{:>18}repeated: {change}", "");
    }
}

fn sum_up(ran: &[Ran], seed: u64) -> ExitCode {
    let count = |word| ran.iter().filter(|found| found.words().0 == word).count();
    let [agree, disagree, gave_up, broke] = ["agrees", "DISAGREES", "gave up", "BROKE"].map(count);
    let repeated = ran.iter().filter(|found| !found.repeated.is_empty()).count();
    let closest = ran.iter().filter_map(|found| Some(found.closest.as_ref()?.0)).fold(0.0, f64::max);
    println!(
        "\n| seed | circuits | run and agree | disagree | gave up | broke | repeated with changes | largest part of a tolerance |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    println!("| {seed} | {} | {agree} | {disagree} | {gave_up} | {broke} | {repeated} | {closest:.3} |", ran.len());
    ExitCode::from(u8::from(disagree + broke > 0 || 100 * gave_up > ran.len()))
}
