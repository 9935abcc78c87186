//! What a shell completes a command line to.

use std::fs;
use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

use crate::command::{done, stderr, videg};

/// A folder with what file names are completed to.
fn place() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in ["my.toml", "notes.txt"] {
        fs::write(folder.path().join(name), "").unwrap();
    }
    fs::create_dir(folder.path().join("runs")).unwrap();
    folder
}

/// What the tool answers to the script of `shell`: the words up to the cursor, the last of them begun.
fn asked(shell: &str, folder: &Path, words: &[&str]) -> String {
    let mut command = videg(&["--"]);
    command.args(words).current_dir(folder);
    command.env("VIDEG_COMPLETE", shell).env("_CLAP_COMPLETE_INDEX", (words.len() - 1).to_string());
    let output = done(command.env("_CLAP_IFS", "\n"));
    assert_eq!(stderr(&output), "", "{words:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// The same as fish gets it: candidates and their help.
fn fish(line: &str) -> Vec<(String, String)> {
    let folder = place();
    let text = asked("fish", folder.path(), &line.split(' ').collect::<Vec<_>>());
    let pair =
        |line: &str| line.split_once('\t').map_or((line.to_owned(), String::new()), |(a, b)| (a.into(), b.into()));
    text.lines().map(pair).collect()
}

fn names(line: &str) -> Vec<String> {
    fish(line).into_iter().map(|(name, _)| name).collect()
}

#[test]
fn each_option_is_completed_to_what_its_verb_takes() {
    for (line, expected) in [
        ("videg simulate --case fig1", "fig10 fig11 fig12 fig13 fig14 fig15"),
        ("videg cases capsule-f", "capsule-friction"),
        ("videg simulate --set membrane.la", "membrane.law="),
        (
            "videg simulate --set membrane.law=",
            "membrane.law=power membrane.law=table membrane.law=gent membrane.law=ogden",
        ),
        ("videg simulate --set=contact.reaction=", "--set=contact.reaction=true --set=contact.reaction=false"),
        ("videg simulate --set membrane.restitution=", ""),
        ("videg simulate --set membrane.file=m", "membrane.file=my.toml"),
        ("videg simulate --set membrane.radius", ""),
        ("videg simulate --set load.", ""),
        ("videg cosim --set load.", "load.resistance="),
        ("videg crosscheck --set load.", "load.resistance="),
        ("videg ssp --set release=s", "release=switch release=storage"),
        ("videg export --set gravi", "gravity="),
        ("videg cosim --columns left.voltage,load.v", "left.voltage,load.voltage"),
        ("videg simulate --columns left.", "left.capacitance left.deflection left.areaRatio"),
        ("videg export --columns left.str", "left.stretch"),
        ("videg sweep --vary ca", "case="),
        ("videg sweep --vary case=fig14,m", "case=fig14,my.toml"),
        ("videg sweep --vary release=zener,s", "release=zener,switch release=zener,storage"),
        ("videg sweep --record net", "net_power"),
        ("videg sweep --precision-of average_v", "average_voltage_gain"),
        ("videg dynamics --vary membrane.rest", "membrane.restitution="),
        ("videg dynamics --vary contact.", ""),
        ("videg map zener.v", "zener.voltage="),
        ("videg map zener.voltage=2200:3400:7 load.r", "load.resistance="),
        ("videg map zener.voltage=2200:3400:7 load.resistance=1e9:1e10:5 m", "my.toml"),
        ("videg map --of load_", "load_power"),
        ("videg reproduce table1 au", "audit"),
        ("videg simulate --law b", "both"),
        ("videg simulate --case-file ", "my.toml runs/"),
        ("videg simulate --output r", "runs/"),
    ] {
        assert_eq!(names(line).join(" "), expected, "{line}");
    }
}

#[test]
fn every_verb_is_offered_and_none_behind_a_word_that_is_no_verb() {
    let command = videg::cli::command();
    let verbs = command.get_subcommands().filter(|verb| !verb.is_hide_set()).map(|verb| verb.get_name().to_owned());
    let offered = names("videg ");
    let offered: Vec<_> = offered.into_iter().filter(|name| !name.starts_with('-')).collect();
    assert_eq!(offered, verbs.chain(["help".to_owned()]).collect::<Vec<_>>());
    for line in
        ["videg nonsense", "videg nonsense ", "videg nonsense sim", "videg fmu nonsense ", "videg fmu nonsense --j"]
    {
        assert_eq!(names(line), [""; 0], "{line}");
    }
}

#[test]
fn a_candidate_comes_with_unit_and_description_where_the_shell_shows_them() {
    let help = |line: &str| fish(line).swap_remove(0).1;
    assert!(help("videg cosim --set load.r").starts_with("Ohm: R: load resistance"));
    assert!(help("videg simulate --set membrane.restit").starts_with("r: coefficient of restitution"));
    assert!(help("videg simulate --set membrane.law=g").starts_with("Virtual work of a film after Gent"));
    assert!(help("videg simulate --case fig14").ends_with("r = 0.6: periodic"));
    let folder = place();
    let words = ["videg", "cosim", "--set", "load.r"];
    let [zsh, elvish] = ["zsh", "elvish"].map(|shell| asked(shell, folder.path(), &words));
    assert!(zsh.starts_with("load.resistance=:Ohm: R: load resistance"), "{zsh}");
    assert_eq!(elvish, "load.resistance=");
}

#[test]
fn a_question_that_makes_no_sense_has_no_answer() {
    let folder = place();
    assert_eq!(asked("tcsh", folder.path(), &["videg", "sim"]), "");
    let mut command = videg(&["--", "videg", "sim"]);
    let output = done(command.env("VIDEG_COMPLETE", "bash").env("_CLAP_COMPLETE_INDEX", "7"));
    assert!(output.stdout.is_empty() && output.stderr.is_empty());
}

/// Words that nobody types on purpose; the answer is nothing or a candidate, never an error.
#[test]
fn strange_words_do_no_harm() {
    use std::os::unix::ffi::OsStringExt as _;
    let folder = place();
    let long = "x".repeat(100_000);
    let of_bytes = std::ffi::OsString::from_vec(b"--set=\xff\xfe".to_vec());
    for word in [long.into(), of_bytes, "--set=\u{1b}[31m\n\t".into(), "--vary=case=\u{7}".into(), "\u{0301}=".into()] {
        for (verb, index) in [("simulate", "2"), ("sweep", "2"), ("sweep", "18446744073709551615"), ("map", "two")] {
            let mut command = videg(&["--", "videg", verb]);
            command.arg(&word).current_dir(folder.path()).env("VIDEG_COMPLETE", "fish").env("_CLAP_IFS", "\n");
            let output = done(command.env("_CLAP_COMPLETE_INDEX", index));
            assert!(output.stderr.is_empty(), "{word:?}: {}", stderr(&output));
        }
    }
}

#[test]
fn a_variable_of_the_environment_alone_asks_nothing() {
    for shell in ["1", "bash"] {
        let output = done(videg(&["cases"]).env("VIDEG_COMPLETE", shell));
        assert!(String::from_utf8(output.stdout).unwrap().contains("fig14"), "{shell}");
    }
}

#[test]
fn names_of_files_that_mean_something_to_a_shell_are_offered_as_words() {
    let folder = place();
    for name in ["a b.toml", "$(touch gone).toml", "x;y.toml", "new\nline.toml", "tab\t.toml"] {
        fs::write(folder.path().join(name), "").unwrap();
    }
    let offered = asked("fish", folder.path(), &["videg", "simulate", "--case-file", ""]);
    assert!(!offered.contains("new") && !offered.contains("tab"), "{offered}");
    let script = "eval \"$(videg completions bash)\"
        COMP_LINE='videg simulate --case-file ' COMP_POINT=${#COMP_LINE} COMP_CWORD=3 COMP_WORDS=(videg simulate --case-file '')
        _videg videg '' && eval \"set -- ${COMPREPLY[*]}\" && printf '%s\\n' \"$@\"";
    let mut bash = Command::new("bash");
    let tool = Path::new(env!("CARGO_BIN_EXE_videg")).parent().unwrap();
    let path = std::env::join_paths([tool, Path::new("/bin"), Path::new("/usr/bin")]).unwrap();
    let output = done(bash.args(["--norc", "-c", script]).env("PATH", path).current_dir(folder.path()));
    let mut words: Vec<_> = std::str::from_utf8(&output.stdout).unwrap().lines().collect();
    words.sort_unstable();
    assert_eq!(words, ["$(touch gone).toml", "a b.toml", "my.toml", "runs/", "x;y.toml"]);
    assert!(!folder.path().join("gone").exists());
}

/// What bash completes a line to at its end, or at its `|`.
fn bash(line: &str) -> Vec<String> {
    const SCRIPT: &str = "eval \"$(videg completions bash)\"
        COMP_LINE=$1 COMP_POINT=$2 COMP_CWORD=$3 begun=$4 COMP_WORDS=(\"${@:5}\")
        _videg videg \"$begun\" && printf '%s\\n' \"${COMPREPLY[@]}\"";
    let (before, after) = line.split_once('|').unwrap_or((line, ""));
    let (line, begun, place) = (format!("{before}{after}"), divided(before), place());
    let last = begun[begun.len() - 1].trim_start_matches(['\'', '=', ':']);
    let numbers = [before.len(), begun.len() - 1].map(|number| number.to_string());
    let tool = Path::new(env!("CARGO_BIN_EXE_videg")).parent().unwrap();
    let path = std::env::join_paths([tool, Path::new("/bin"), Path::new("/usr/bin")]).unwrap();
    let mut bash = Command::new("bash");
    bash.args(["--norc", "-c", SCRIPT, "bash", &line]).args(numbers).arg(last).args(divided(&line));
    let output = done(bash.env("PATH", path).current_dir(place.path()));
    assert_eq!(stderr(&output), "", "{line}");
    assert_eq!(fs::read_dir(place.path()).unwrap().count(), 3, "{line} writes something");
    String::from_utf8(output.stdout).unwrap().lines().filter(|it| !it.is_empty()).map(str::to_owned).collect()
}

/// The words of a line as bash divides them: at spaces, and at `=` and `:`, which are words themselves, unless in quotes.
fn divided(line: &str) -> Vec<&str> {
    let parts = |word| {
        let breaks = str::match_indices(word, ['=', ':']).filter(|_| !word.starts_with('\''));
        let mut from = 0;
        let ends = breaks.flat_map(|(at, _)| [at, at + 1]).chain([word.len()]);
        let parts = ends.map(|end| &word[std::mem::replace(&mut from, end)..end]);
        let parts: Vec<_> = parts.filter(|part| !part.is_empty() || word.is_empty()).collect();
        parts
    };
    line.split(' ').flat_map(parts).collect()
}

#[test]
fn bash_gets_the_part_of_the_word_that_it_replaces() {
    for (line, expected) in [
        ("videg sim", "simulate"),
        ("videg simulate --set membrane.la", "membrane.law="),
        ("videg simulate --set membrane.law=g", "gent"),
        ("videg simulate --set membrane.law=", "power table gent ogden"),
        ("videg simulate --set=membrane.law=o", "ogden"),
        ("videg simulate --set membrane.law='g", "gent"),
        ("videg simulate --set 'membrane.law=g", "membrane.law=gent"),
        ("videg simulate --set membrane.restit|=0.7 --json", "membrane.restitution="),
        ("videg simulate --set membrane.law=g|ent --json", "gent"),
        ("videg simulate --case fi", "fig9 fig10 fig11 fig12 fig13 fig14 fig15"),
        ("videg simulate  --case   capsule-f", "capsule-friction"),
        ("videg sweep --vary release=zener,s", "zener,switch zener,storage"),
        ("videg map zener.voltage=2200:3400:7 load.r", "load.resistance="),
        ("videg reproduce fig1", "fig10 fig11 fig12 fig13 fig14 fig15 fig16 fig17"),
        ("videg simulate --case-file ", "my.toml runs/"),
        ("videg nonsense", ""),
        ("videg nonsense --set membrane.la", ""),
    ] {
        assert_eq!(bash(line).join(" "), expected, "{line}");
    }
}
