//! Scripts that import each other, as one script.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

/// Modules in the order in which they run.
#[derive(Default)]
struct Modules {
    paths: Vec<PathBuf>,
    text: String,
}

/// The module at `path` with all that it imports before it, each in a function of its own. Modules import by name only, on one line,
/// `import { a, b } from "./c.js";`, and export where they define.
pub fn script(path: &Path) -> Result<String> {
    let mut modules = Modules::default();
    modules.add(path)?;
    Ok(format!("\"use strict\";\n(() => {{\n{}}})();\n", modules.text))
}

impl Modules {
    /// The number of the module at `path`.
    fn add(&mut self, path: &Path) -> Result<usize> {
        let path = path.canonicalize().with_context(|| format!("no script {}", path.display()))?;
        if let Some(known) = self.paths.iter().position(|known| *known == path) {
            return Ok(known);
        }
        let source = std::fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        let folder = path.parent().context("a folder of scripts")?;
        let (mut own, mut exported) = (String::new(), Vec::new());
        for line in source.lines() {
            if let Some(import) = line.strip_prefix("import {") {
                let fault = || format!("{}: {line}: import {{ a, b }} from \"./c.js\";", path.display());
                let (names, from) = import.split_once("} from \"./").with_context(fault)?;
                let module = self.add(&folder.join(from.strip_suffix("\";").with_context(fault)?))?;
                writeln!(own, "const {{{names}}} = module{module};")?;
            } else if let Some(definition) = line.strip_prefix("export ") {
                exported.push(defined(definition).with_context(|| format!("{}: {line}", path.display()))?);
                writeln!(own, "{definition}")?;
            } else {
                writeln!(own, "{line}")?;
            }
        }
        ensure!(!own.contains("\nexport "), "{}: an export that defines nothing", path.display());
        let number = self.paths.len();
        self.paths.push(path);
        writeln!(self.text, "const module{number} = (() => {{\n{own}return {{ {} }};\n}})();", exported.join(", "))?;
        Ok(number)
    }
}

/// The name that a line defines.
fn defined(line: &str) -> Option<&str> {
    let rest =
        ["const ", "class ", "function ", "async function "].into_iter().find_map(|word| line.strip_prefix(word))?;
    rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().filter(|name| !name.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bundled(modules: &[(&str, &str)]) -> Result<String> {
        let folder = std::env::temp_dir().join(format!("videg-modules-{}-{}", std::process::id(), modules[0].1.len()));
        std::fs::create_dir_all(&folder)?;
        for (name, text) in modules {
            std::fs::write(folder.join(name), text)?;
        }
        let script = script(&folder.join(modules[0].0));
        std::fs::remove_dir_all(&folder)?;
        script
    }

    #[test]
    fn each_module_comes_once_and_after_those_that_it_imports() {
        let modules = [
            ("main.js", "import { b } from \"./b.js\";\nimport { c, d } from \"./c.js\";\nb(c);"),
            ("b.js", "import { d } from \"./c.js\";\nexport function b(x) { return d + x; }"),
            ("c.js", "export const c = 1;\nexport class d {}"),
        ];
        let script = bundled(&modules).unwrap();
        let wanted = [
            "const c = 1;",
            "return { c, d };",
            "const { d } = module0;",
            "return { b };",
            "const { b } = module1;",
            "b(c);",
        ];
        let places: Vec<_> =
            wanted.iter().map(|part| script.find(part).unwrap_or_else(|| panic!("{part}\n{script}"))).collect();
        assert!(places.is_sorted(), "{script}");
        assert_eq!(script.matches("const c = 1").count(), 1);
    }

    #[test]
    fn what_is_no_plain_import_or_export_is_refused() {
        for text in
            ["import { a } from 'b';", "export default 1;", "x\nexport { x };", "import { a } from \"./none.js\";"]
        {
            assert!(bundled(&[("main.js", text)]).is_err(), "{text}");
        }
    }
}
