//! Which files of a package import which: every path in the code, followed through re-exports to the file that defines
//! what it names. Code under `#[cfg(test)]` does not count.

mod resolve;
mod visit;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Names from the root of the package to a module; the root itself has none.
pub type ModulePath = Vec<String>;

/// A module as it is written.
#[derive(Default)]
pub struct Module {
    pub file: String,
    /// Items that it defines.
    pub items: BTreeSet<String>,
    /// What it imports: the name under which, or none for all names of a module, and the path.
    pub uses: Vec<(Option<String>, Vec<String>)>,
    /// Paths in its code.
    pub paths: BTreeSet<Vec<String>>,
}

/// For each file of a package, relative to the folder of the root, those files that it imports.
pub struct Imports(BTreeMap<String, BTreeSet<String>>);

impl Imports {
    pub fn read(root: &Path) -> Self {
        let package = visit::package(root);
        let mut imports: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for (at, module) in &package {
            let targets = imports.entry(module.file.clone()).or_default();
            let uses = module.uses.iter().map(|(_, path)| path);
            targets.extend(module.paths.iter().chain(uses).flat_map(|path| resolve::files(&package, at, path)));
            targets.remove(&module.file);
        }
        Self(imports)
    }

    pub fn files(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    pub fn pairs(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().flat_map(|(file, others)| others.iter().map(|other| (file.as_str(), other.as_str())))
    }

    /// Sets of files each of which reaches all others, but for a parent with its own children.
    pub fn circles(&self) -> Vec<BTreeSet<&str>> {
        self.circles_within(&self.files().collect())
    }

    fn circles_within<'a>(&'a self, files: &BTreeSet<&'a str>) -> Vec<BTreeSet<&'a str>> {
        let reached: BTreeMap<&str, BTreeSet<&str>> =
            files.iter().map(|file| (*file, self.reached(file, files))).collect();
        let mut components: Vec<BTreeSet<&str>> = files
            .iter()
            .map(|file| reached[file].iter().filter(|other| reached[*other].contains(file)).copied().collect())
            .filter(|component: &BTreeSet<&str>| component.len() > 1)
            .collect();
        components.sort();
        components.dedup();
        components
            .into_iter()
            .flat_map(|component| {
                match component.iter().find(|parent| component.iter().all(|it| is_in_family(it, parent))) {
                    Some(parent) => {
                        self.circles_within(&component.iter().filter(|it| *it != parent).copied().collect())
                    }
                    None => vec![component],
                }
            })
            .collect()
    }

    /// Files that a file imports, directly or not, by way of the files given.
    fn reached<'a>(&'a self, file: &str, among: &BTreeSet<&'a str>) -> BTreeSet<&'a str> {
        let mut reached = BTreeSet::new();
        let mut open = vec![file];
        while let Some(next) = open.pop() {
            let others = self.0.get(next).into_iter().flatten().map(String::as_str);
            for other in others.filter(|other| among.contains(other)) {
                if reached.insert(other) {
                    open.push(other);
                }
            }
        }
        reached
    }
}

/// Names of the modules that lead to a file.
fn modules(file: &str) -> Vec<&str> {
    let path = file.trim_end_matches(".rs");
    let path = if path == "lib" { "" } else { path.trim_end_matches("/mod") };
    path.split('/').filter(|name| !name.is_empty()).collect()
}

/// Whether a file is a parent or a descendant of it.
fn is_in_family(file: &str, parent: &str) -> bool {
    modules(file).starts_with(&modules(parent))
}

/// Module of the root that a file belongs to, none for the root.
pub fn root_module(file: &str) -> Option<&str> {
    modules(file).first().copied()
}
