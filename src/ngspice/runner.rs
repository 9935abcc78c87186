//! ngspice as a program of its own: no shell, nothing to read from, a fresh folder, a time limit.

use std::ffi::OsStr;
use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use super::capacitance::CapacitanceTable;
use super::drain::Drain;
use super::reading::Reading;
use super::template::{FileName, Netlist};
use super::{CapacitanceSource, Elements, NgspiceError, Run, Said, Waveforms};
use videg_system::processes::ProcessGroup;
use videg_system::temporary::TemporaryFolder;
use videg_system::{atomic_file, input};

/// The program.
#[derive(Debug, Clone)]
pub struct Ngspice {
    program: PathBuf,
    /// Longest time that a run may take.
    pub time_limit: Duration,
}

/// A finished run of ngspice, in a folder that is removed with it.
#[derive(Debug)]
pub struct Finished {
    folder: TemporaryFolder,
    said: Said,
}

/// A run in one of the solvers, as far as it got.
#[derive(Debug)]
pub struct Outcome {
    /// The circuit up to there.
    pub waveforms: Waveforms,
    /// What was changed where ngspice found no way on, and from when to when, in words.
    pub repeated: Vec<String>,
    /// Why it ends before the table does.
    pub stop: Option<NgspiceError>,
}

impl From<Waveforms> for Outcome {
    fn from(waveforms: Waveforms) -> Self {
        Self { waveforms, repeated: Vec::new(), stop: None }
    }
}

/// What ngspice runs in one go: the rows `from` to `to` of a table.
struct Piece<'a> {
    elements: &'a Elements,
    table: &'a CapacitanceTable,
    from: usize,
    to: usize,
}

impl Ngspice {
    /// Variable of the environment that names the program.
    pub const VARIABLE: &'static str = "VIDEG_NGSPICE";
    /// Longest time that a run may take unless something else is asked for.
    pub const TIME_LIMIT: Duration = Duration::from_secs(600);
    /// Bytes of ngspice's messages that are kept, of each stream; the rest is read and dropped.
    const OUTPUT: usize = 64 * 1024;

    /// The program `named`, or else that of the environment variable [`Self::VARIABLE`], or else that on the `PATH`.
    ///
    /// # Errors
    /// If there is none.
    pub fn find(named: Option<&Path>) -> Result<Self, NgspiceError> {
        let environment = std::env::var_os(Self::VARIABLE).filter(|value| !value.is_empty()).map(PathBuf::from);
        match named.map(Path::to_owned).or(environment) {
            Some(program) if program.is_file() => {
                // The program is started in another folder.
                let program = std::path::absolute(&program).unwrap_or(program);
                Ok(Self { program, time_limit: Self::TIME_LIMIT })
            }
            Some(program) => Err(NgspiceError::Missing { looked: format!("no file {}", program.display()) }),
            None => Self::on_path(std::env::var_os("PATH").as_deref()),
        }
    }

    fn on_path(path: Option<&OsStr>) -> Result<Self, NgspiceError> {
        let name = format!("ngspice{}", std::env::consts::EXE_SUFFIX);
        let folders = path.into_iter().flat_map(std::env::split_paths);
        // A relative folder on the PATH would mean another one where the program is started.
        let mut candidates = folders.filter(|folder| folder.is_absolute()).map(|folder| folder.join(&name));
        let Some(program) = candidates.find(|candidate| candidate.is_file()) else {
            return Err(NgspiceError::Missing { looked: format!("no {name} on the PATH") });
        };
        Ok(Self { program, time_limit: Self::TIME_LIMIT })
    }

    /// The program, for tests: where there is none, they are skipped, but not by `./test.sh`.
    #[cfg(test)]
    pub(super) fn for_tests() -> Option<Self> {
        let found = Self::find(None);
        assert!(found.is_ok() || std::env::var_os("VIDEG_ALL_TOOLS").is_none(), "{}", found.unwrap_err());
        found.inspect_err(|error| eprintln!("skipped: {error}")).ok()
    }

    /// The program.
    pub fn program(&self) -> &Path {
        &self.program
    }

    /// Runs `elements` over the whole of `table`.
    ///
    /// # Errors
    /// What ngspice says, or does not say: see [`NgspiceError`].
    pub fn simulate(
        &self,
        elements: &Elements,
        table: &CapacitanceTable,
        run: &Run,
    ) -> Result<Waveforms, NgspiceError> {
        let outcome = self.follow(elements, table, run, &|_| ())?;
        outcome.stop.map_or(Ok(outcome.waveforms), Err)
    }

    /// Runs `elements` over `table`, in pieces, as far as ngspice gets; `progress` hears which part is done.
    ///
    /// # Errors
    /// Anything but that ngspice stops.
    pub fn follow(
        &self,
        elements: &Elements,
        table: &CapacitanceTable,
        run: &Run,
        progress: &dyn Fn(f64),
    ) -> Result<Outcome, NgspiceError> {
        let mut reading = Reading::new(elements, table);
        let (mut from, mut repeated, mut stop) = (0, Vec::new(), None);
        for to in table.pieces(run.piece) {
            let piece = Piece { elements, table, from, to };
            match self.piece(&piece, &mut reading, run, &mut repeated) {
                Ok(()) => progress(table.times()[to] / table.until()),
                Err(error) if error.is_stop() => {
                    stop = Some(error);
                    break;
                }
                Err(error) => return Err(error),
            }
            from = to;
        }
        Ok(Outcome { waveforms: reading.finish(), repeated, stop })
    }

    /// Runs a piece, again with changes where ngspice finds no way on.
    fn piece(
        &self,
        piece: &Piece<'_>,
        reading: &mut Reading<'_>,
        run: &Run,
        repeated: &mut Vec<String>,
    ) -> Result<(), NgspiceError> {
        let mark = reading.mark();
        let mut result = self.attempt(piece, reading, run);
        for (change, changed) in run.changed() {
            if !result.as_ref().is_err_and(NgspiceError::is_lost) {
                break;
            }
            let [from, to] = [piece.from, piece.to].map(|row| piece.table.times()[row]);
            repeated.push(format!("{change} from {from} s to {to} s"));
            reading.return_to(&mark);
            result = self.attempt(piece, reading, &changed);
        }
        result
    }

    fn attempt(&self, piece: &Piece<'_>, reading: &mut Reading<'_>, run: &Run) -> Result<(), NgspiceError> {
        let part = piece.table.part(piece.from, piece.to);
        let (source, until) = (CapacitanceSource::Table, part.until());
        let (_, start) = reading.end();
        let netlist = piece.elements.netlist_from(&start, source, part.initial(), &Run { until, ..*run })?;
        let finished = self.run(&netlist, &part)?;
        if let Some(raw) = finished.raw()? {
            reading.take(raw, piece.from)?;
        }
        if reading.has(piece.to) && !finished.said.gave_up() {
            return Ok(());
        }
        let (reached, _) = reading.end();
        Err(NgspiceError::Stopped { reached, until: piece.table.until(), said: finished.said })
    }

    /// Writes netlist and table into `folder`, where `ngspice -b harvesting.cir` runs them by hand.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn export(folder: &Path, netlist: &Netlist, table: &CapacitanceTable) -> Result<(), NgspiceError> {
        let path = folder.join(FileName::Netlist.name());
        atomic_file::write(&path, netlist.text()).map_err(|cause| NgspiceError::File { path, cause })?;
        let path = folder.join(FileName::Table.name());
        let written = atomic_file::fill(&path, |file| table.write(BufWriter::new(file)));
        written.map_err(|cause| NgspiceError::File { path, cause })
    }

    /// Runs `netlist` with `table` beside it.
    ///
    /// # Errors
    /// A program that cannot be started, takes too long, or fails.
    pub fn run(&self, netlist: &Netlist, table: &CapacitanceTable) -> Result<Finished, NgspiceError> {
        let file = |cause| NgspiceError::File { path: std::env::temp_dir(), cause };
        let folder = TemporaryFolder::new("videg-ngspice-").map_err(file)?;
        Self::export(folder.path(), netlist, table)?;
        let failed = |cause| NgspiceError::Start { program: self.program.clone(), cause };
        let mut group = ProcessGroup::start(&mut self.command(folder.path())).map_err(failed)?;
        let (stdout, stderr) = (group.child.stdout.take(), group.child.stderr.take());
        let stdout = stdout.map(|stream| Drain::new(stream, Self::OUTPUT)).transpose().map_err(failed)?;
        let stderr = stderr.map(|stream| Drain::new(stream, Self::OUTPUT)).transpose().map_err(failed)?;
        let has_ended = group.wait(Some(self.time_limit)).map_err(failed)?;
        // With what it has started.
        let status = group.end().map_err(failed)?;
        let text = [stdout, stderr].map(|drain| drain.map(|drain| drain.text()).unwrap_or_default());
        let said = Said::in_output(&text.concat());
        if !has_ended {
            return Err(NgspiceError::TimeLimit { limit: self.time_limit.as_secs_f64(), said });
        }
        if !status.success() {
            return Err(NgspiceError::Failed { status, said });
        }
        Ok(Finished { folder, said })
    }

    fn command(&self, folder: &Path) -> Command {
        let mut command = Command::new(&self.program);
        command.args(["-n", "-b", FileName::Netlist.name()]).current_dir(folder);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        // It would turn the result into ASCII.
        command.env_remove("SPICE_ASCIIRAWFILE");
        command
    }
}

impl Finished {
    /// The result, if there is one.
    ///
    /// # Errors
    /// If it cannot be opened, or is no regular file.
    pub fn raw(&self) -> Result<Option<BufReader<File>>, NgspiceError> {
        let path = self.folder.path().join(FileName::Raw.name());
        match input::open_regular(&path) {
            Ok(file) => Ok(Some(BufReader::with_capacity(1 << 16, file))),
            Err(cause) if cause.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(cause) => Err(NgspiceError::File { path, cause }),
        }
    }

    /// Complaints of ngspice.
    pub fn said(&self) -> &Said {
        &self.said
    }
}

#[cfg(test)]
#[cfg(unix)]
#[path = "runner_tests.rs"]
mod tests;
