//! Tutorials as scripts with cells (`# %%`), which editors and Jupyter open as notebooks: they follow from the chapters.

use std::fmt::Write as _;
use std::path::Path;

use crate::block::Block;
use crate::chapter::Chapter;
use crate::console;
use crate::{GOLDEN, root};

/// Chapters and their scripts.
const SCRIPTS: [(&str, &str); 3] = [
    ("docs/tutorial/fmpy.md", "examples/fmpy_tutorial.py"),
    ("docs/tutorial/ngspice.md", "examples/ngspice_coupling.py"),
    ("docs/howto/membrane.md", "examples/own_membrane.py"),
];

#[test]
fn no_tutorial_calls_cargo() {
    for (page, _) in SCRIPTS.into_iter().chain([("docs/tutorial/system.md", "")]) {
        let chapter = Chapter::read(Path::new(page));
        let calls = chapter.blocks.iter().find(|block| block.text.contains("cargo"));
        assert!(calls.is_none(), "{}", calls.map_or_else(String::new, |block| chapter.place(block)));
    }
}

#[test]
fn the_scripts_are_the_tutorials() {
    for (page, script) in SCRIPTS {
        GOLDEN.file(root().join(script), &cells(&Chapter::read(Path::new(page))));
    }
}

/// The page as a script: text as cells of Markdown, code as cells of code. What code prints is left to those who run it.
fn cells(chapter: &Chapter) -> String {
    let page = chapter.path.display();
    let mut script = format!(
        "# Made from {page} by `UPDATE_BOOK=1 cargo test --test book`; run in the root of the source tree.\n\n\
         # %%\nimport sys\n\nsys.path.append(\"examples\")\n"
    );
    let mut at = 0;
    for block in &chapter.blocks {
        let fence = chapter.text[..block.range.start].rfind("```").unwrap();
        words(&mut script, &chapter.text[at..fence]);
        at = block.range.end + chapter.text[block.range.end..].find('\n').unwrap();
        if let Some(code) = code(block) {
            write!(script, "\n# %%\n{code}").unwrap();
        }
    }
    words(&mut script, &chapter.text[at..]);
    script
}

fn words(script: &mut String, text: &str) {
    let lines = text.lines().filter(|line| !line.starts_with("<!--") && !line.starts_with("!["));
    let text = lines.collect::<Vec<_>>().join("\n");
    if !text.trim().is_empty() {
        script.push_str("\n# %% [markdown]\n");
        text.trim().lines().for_each(|line| writeln!(script, "{}", format!("# {line}").trim_end()).unwrap());
    }
}

/// Python as it is, commands as calls of a shell that finds the tool (`examples/find_videg.py`), files as they are written.
fn code(block: &Block) -> Option<String> {
    match (block.language.as_str(), block.file()) {
        ("python", _) => Some(block.text.clone()),
        ("console", _) => {
            let runs = console::steps(&block.text).into_iter().map(|step| format!("run({:?})\n", step.command));
            Some(format!("from find_videg import run\n\n{}", runs.collect::<String>()))
        }
        (_, Some(name)) => {
            let folder = format!("Path({name:?}).parent.mkdir(parents=True, exist_ok=True)");
            Some(format!(
                "from pathlib import Path\n\n{folder}\nPath({name:?}).write_text(r\"\"\"{}\"\"\")\n",
                block.text
            ))
        }
        _ => None,
    }
}
