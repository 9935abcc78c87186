//! Where a path of Rust code leads.

use std::collections::{BTreeMap, BTreeSet};

use super::{Module, ModulePath};

type Package = BTreeMap<ModulePath, Module>;

/// Files that define what a path in a module names: one as a rule, none if that is not of this package.
pub fn files(package: &Package, at: &ModulePath, path: &[String]) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    Search { package, seen: BTreeSet::new() }.follow(at, path, &mut found);
    found
}

struct Search<'a> {
    package: &'a Package,
    /// Places looked up, as imports may lead in a circle.
    seen: BTreeSet<(ModulePath, Vec<String>)>,
}

impl Search<'_> {
    fn follow(&mut self, at: &ModulePath, path: &[String], found: &mut BTreeSet<String>) {
        let Some((first, rest)) = path.split_first() else {
            found.insert(self.package[at].file.clone());
            return;
        };
        if !self.seen.insert((at.clone(), path.to_vec())) {
            return;
        }
        let child = [at.as_slice(), std::slice::from_ref(first)].concat();
        let module = &self.package[at];
        match first.as_str() {
            "crate" => self.follow(&Vec::new(), rest, found),
            "self" => self.follow(at, rest, found),
            "super" => self.follow(&at[..at.len() - 1].to_vec(), rest, found),
            _ if self.package.contains_key(&child) => self.follow(&child, rest, found),
            _ if module.items.contains(first) => {
                found.insert(module.file.clone());
            }
            _ => {
                for (name, import) in module.uses.iter().filter(|(_, import)| import.first() != Some(first)) {
                    match name {
                        Some(name) if name == first => self.follow(at, &[import, rest].concat(), found),
                        None if self.is_within(at, import) => self.follow(at, &[import, path].concat(), found),
                        _ => {}
                    }
                }
            }
        }
    }

    /// Whether a path begins at a module of this package.
    fn is_within(&self, at: &ModulePath, path: &[String]) -> bool {
        let child = [at.as_slice(), &path[..1]].concat();
        ["crate", "self", "super"].contains(&path[0].as_str()) || self.package.contains_key(&child)
    }
}
