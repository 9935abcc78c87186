//! Runs machines outside of a browser: each line of stdin is `from until name=value ...`, and each line of stdout has the numbers of
//! that run, in the order of the first line, or why there are none.

use std::io::BufRead as _;

use videg_explorer::{Machine, Outcome};

fn main() -> std::io::Result<()> {
    println!("{}", Outcome::names().join(" "));
    for line in std::io::stdin().lock().lines() {
        match run(&line?) {
            Ok(values) => {
                let values: Vec<_> = values.iter().map(|value| format!("{value:?}")).collect();
                println!("{}", values.join(" "));
            }
            Err(reason) => println!("error {reason}"),
        }
    }
    Ok(())
}

fn run(line: &str) -> Result<Vec<f64>, String> {
    let mut words = line.split_whitespace();
    let mut time = || words.next().and_then(|word| word.parse().ok()).ok_or("no times");
    let (from, until) = (time()?, time()?);
    let mut machine = Machine::new();
    for word in words {
        let (name, value) = word.split_once('=').ok_or(format!("{word}: not of the form name=value"))?;
        machine.set(name, value.parse().map_err(|error| format!("{word}: {error}"))?)?;
    }
    Ok(machine.run(from, until)?.values())
}
