//! A source tree that cannot be written: verbs run all the same, with FMUs in the user's folder of caches.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::LazyLock;

use fmu_import::Archive;
use tempfile::TempDir;

use crate::command::{done, stderr as said, videg};

const NAMES: [&str; 2] = ["VibroImpactHarvester", "HarvestingCircuit"];

/// FMUs as they are packaged here.
static PACKAGED: LazyLock<TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    done(videg(&["fmu", "build", "--output"]).arg(folder.path()));
    folder
});

/// What of a source tree a program needs that was built in it, and a folder to work in.
struct Tree {
    guard: TempDir,
}

impl Tree {
    fn new() -> Self {
        let tree = Self { guard: tempfile::tempdir().unwrap() };
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        for name in ["Cargo.toml", "fmu/harvester/Cargo.toml", "fmu/circuit/Cargo.toml"] {
            tree.copy(name, &root.join(name));
        }
        tree.copy("target/release/videg", Path::new(env!("CARGO_BIN_EXE_videg")));
        for name in NAMES {
            let description = format!("modelDescription/{name}.xml");
            tree.copy(&description, &root.join(&description));
            let unpacked = Archive::open(PACKAGED.path().join(format!("{name}.fmu"))).unwrap().unpack().unwrap();
            let library = unpacked.path().join(format!("binaries/linux64/{name}.so"));
            tree.copy(&format!("target/release/lib{name}.so"), &library);
        }
        fs::create_dir(tree.path("work")).unwrap();
        tree
    }

    fn path(&self, name: &str) -> PathBuf {
        self.guard.path().join(name)
    }

    fn copy(&self, name: &str, from: &Path) {
        let path = self.path(&format!("tree/{name}"));
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::copy(from, path).unwrap();
    }

    /// Rights do not bind those who may do anything: a file stands where the folder should be.
    fn without_room_for_fmus(self) -> Self {
        fs::write(self.path("tree/target/fmu"), "").unwrap();
        self
    }

    /// The program that was built in the tree, as a user starts it elsewhere.
    fn videg(&self, arguments: &[&str]) -> Command {
        self.started_by(Command::new(self.path("tree/target/release/videg")), arguments)
    }

    fn started_by(&self, mut command: Command, arguments: &[&str]) -> Command {
        command.args(arguments).current_dir(self.path("work")).env("XDG_CACHE_HOME", self.path("cache"));
        command.env_remove("CARGO").env_remove("CARGO_TARGET_DIR").stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Folders of FMUs in the cache, each with both and nothing else.
    fn cached(&self) -> BTreeSet<PathBuf> {
        let entries = fs::read_dir(self.path("cache/videg")).into_iter().flatten();
        let folders: BTreeSet<_> = entries.map(|entry| entry.unwrap().path()).collect();
        for folder in &folders {
            let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
            let expected = NAMES.map(|name| format!("{name}.fmu").into());
            assert_eq!(names.collect::<BTreeSet<_>>(), expected.into(), "{}", folder.display());
        }
        folders
    }
}

#[test]
fn where_there_is_no_room_for_fmus_verbs_take_them_from_a_cache_and_say_so_once() {
    let tree = Tree::new().without_room_for_fmus();
    for arguments in [
        &["simulate", "--until", "1"][..],
        &["cosim", "--until", "1", "--circuit", "fmu"],
        &["sweep", "--vary", "membrane.restitution=0.5,0.6", "--record", "ball.position", "--until", "1"],
        &["ssp", "--output", "out"],
    ] {
        let said = said(&done(&mut tree.videg(arguments)));
        let cached = tree.cached();
        let folder = cached.first().unwrap().to_string_lossy().into_owned();
        let lines: Vec<_> = said.lines().filter(|line| line.contains("the FMUs are in")).collect();
        assert!(lines.len() == 1 && lines[0].ends_with(&folder), "{arguments:?}: {said}");
        assert!(said.contains("tree/target/fmu"), "{said}");
        assert_eq!(cached.len(), 1, "{cached:?}");
    }
}

#[test]
fn first_runs_at_once_share_one_cache_and_a_changed_program_has_its_own() {
    let tree = Tree::new().without_room_for_fmus();
    let at_once: Vec<_> = (0..6)
        .map(|run| {
            let output = format!("out/{run}");
            tree.videg(&["simulate", "--until", "1", "--output", &output]).spawn().unwrap()
        })
        .collect();
    for run in at_once {
        let output = run.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", said(&output));
    }
    let before = tree.cached();
    assert_eq!(before.len(), 1);
    // A byte more at the end of a library is another program; the loader does not mind.
    let library = tree.path("tree/target/release/libVibroImpactHarvester.so");
    fs::write(&library, [&fs::read(&library).unwrap()[..], b"\0"].concat()).unwrap();
    let said = said(&done(&mut tree.videg(&["simulate", "--until", "1"])));
    let after = tree.cached();
    let new: Vec<_> = after.difference(&before).collect();
    assert!(new.len() == 1 && said.contains(&*new[0].to_string_lossy()), "{said}");
    let unpacked = Archive::open(new[0].join("VibroImpactHarvester.fmu")).unwrap().unpack().unwrap();
    let inside = fs::read(unpacked.path().join("binaries/linux64/VibroImpactHarvester.so")).unwrap();
    assert!(inside == fs::read(&library).unwrap(), "not the library of this program");
}

#[test]
fn a_tree_that_is_mounted_read_only_does_not_keep_a_verb_from_running() {
    let tree = Tree::new();
    let mounted = "mount --bind \"$0\" \"$0\" && mount -o remount,ro,bind \"$0\" || exit 77; exec \"$@\"";
    let run = |program: &Path| {
        let mut command = Command::new("unshare");
        command.args(["--mount", "sh", "-c", mounted]).arg(tree.path("tree")).arg(program);
        tree.started_by(command, &["simulate", "--until", "1"]).output().unwrap()
    };
    let output = run(&tree.path("tree/target/release/videg"));
    if !output.status.success() && tree.cached().is_empty() && !said(&output).contains("videg: ") {
        println!("not run: no mount may be made here: {}", said(&output));
        return;
    }
    assert!(output.status.success(), "{}", said(&output));
    assert!(said(&output).contains("Read-only file system"), "{}", said(&output));
    assert_eq!(tree.cached().len(), 1);
}
