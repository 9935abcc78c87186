//! ngspice as a program: started without a shell or an input, in a fresh folder, with a time limit.

use std::ffi::OsStr;
use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use super::capacitance::CapacitanceTable;
use super::result::ResultReader;
use super::template::{NETLIST_FILE, Netlist, RAW_FILE, TABLE_FILE};
use super::{CapacitanceSource, Complaints, Elements, NgspiceError, Run, Waveforms};
use videg_system::atomic_file;
use videg_system::output::{KeptOutput, Part};
use videg_system::processes::ProcessGroup;
use videg_system::temporary::TemporaryFolder;

/// The program.
#[derive(Debug, Clone)]
pub struct Ngspice {
    program: PathBuf,
    /// Longest time that a run may take.
    pub time_limit: Duration,
}

/// Result and messages of ngspice, in a folder that is removed with it.
#[derive(Debug)]
pub(super) struct BatchOutput {
    folder: TemporaryFolder,
    complaints: Complaints,
}

/// A run in one of the solvers, as far as it got.
#[derive(Debug, Default)]
pub struct SolverRun {
    /// The circuit up to there.
    pub waveforms: Waveforms,
    /// Changes with which a part was repeated after ngspice had stopped, in words with times.
    pub repeated: Vec<String>,
    /// Why it ends before the table does.
    pub stop: Option<NgspiceError>,
}

impl From<Waveforms> for SolverRun {
    fn from(waveforms: Waveforms) -> Self {
        Self { waveforms, ..Self::default() }
    }
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

    /// Runs `elements` over `table` to its end.
    ///
    /// # Errors
    /// What ngspice says, or does not say: see [`NgspiceError`].
    pub fn simulate(
        &self,
        elements: &Elements,
        table: &CapacitanceTable,
        run: &Run,
    ) -> Result<Waveforms, NgspiceError> {
        let found = self.follow(elements, table, run, &|_| ())?;
        found.stop.map_or(Ok(found.waveforms), Err)
    }

    /// Runs `elements` over `table`, in pieces, as far as ngspice gets; a piece in which it stops is repeated with changes.
    /// `progress` gets the part that is done.
    ///
    /// # Errors
    /// Anything but that ngspice stops.
    pub fn follow(
        &self,
        elements: &Elements,
        table: &CapacitanceTable,
        run: &Run,
        progress: &dyn Fn(f64),
    ) -> Result<SolverRun, NgspiceError> {
        let mut reader = ResultReader::new(elements, table);
        let (mut from, mut repeated, mut stop) = (0, Vec::new(), None);
        for to in table.pieces(run.piece) {
            let start = reader.position();
            stop = self.piece(elements, table, [from, to], &mut reader, run)?;
            for (change, changed) in run.changed() {
                if !stop.as_ref().is_some_and(NgspiceError::is_step_too_small) {
                    break;
                }
                let [start_time, end_time] = [from, to].map(|row| table.times()[row]);
                repeated.push(format!("{change} from {start_time} s to {end_time} s"));
                reader.return_to(&start);
                stop = self.piece(elements, table, [from, to], &mut reader, &changed)?;
            }
            if stop.is_some() {
                break;
            }
            progress(table.times()[to] / table.until());
            from = to;
        }
        Ok(SolverRun { waveforms: reader.finish(), repeated, stop })
    }

    /// Runs the rows `from` to `to` of a table in one go; returns why ngspice stops before their end, if it does.
    fn piece(
        &self,
        elements: &Elements,
        table: &CapacitanceTable,
        [from, to]: [usize; 2],
        reader: &mut ResultReader<'_>,
        run: &Run,
    ) -> Result<Option<NgspiceError>, NgspiceError> {
        let part = table.part(from, to);
        let (source, until) = (CapacitanceSource::Table, part.until());
        let (_, start) = reader.end();
        let netlist = elements.netlist_from(&start, source, part.initial(), &Run { until, ..*run })?;
        let output = match self.run(&netlist, &part) {
            Err(error) if error.is_stop() => return Ok(Some(error)),
            other => other?,
        };
        if let Some(raw) = output.raw()? {
            reader.read(raw, from)?;
        }
        let (reached, _) = reader.end();
        let is_complete = reader.has(to) && !output.complaints.give_up();
        let said = output.complaints;
        Ok((!is_complete).then_some(NgspiceError::Stopped { reached, until: table.until(), said }))
    }

    /// Writes netlist and table into `folder`, where `ngspice -b harvesting.cir` runs them by hand.
    pub fn export(folder: &Path, netlist: &Netlist, table: &CapacitanceTable) -> Result<(), NgspiceError> {
        let path = folder.join(NETLIST_FILE);
        atomic_file::write(&path, netlist.text()).map_err(|cause| NgspiceError::File { path, cause })?;
        let path = folder.join(TABLE_FILE);
        let written = atomic_file::fill(&path, |file| table.write(BufWriter::new(file)));
        written.map_err(|cause| NgspiceError::File { path, cause })
    }

    /// Runs `netlist` with `table` beside it.
    pub(super) fn run(&self, netlist: &Netlist, table: &CapacitanceTable) -> Result<BatchOutput, NgspiceError> {
        let file = |cause| NgspiceError::File { path: std::env::temp_dir(), cause };
        let folder = TemporaryFolder::new("videg-ngspice-").map_err(file)?;
        Self::export(folder.path(), netlist, table)?;
        let failed = |cause| NgspiceError::Start { program: self.program.clone(), cause };
        let mut group = ProcessGroup::start(&mut self.command(folder.path())).map_err(failed)?;
        let (stdout, stderr) = (group.child.stdout.take(), group.child.stderr.take());
        let stdout =
            stdout.map(|stream| KeptOutput::new(stream, Part::Beginning(Self::OUTPUT))).transpose().map_err(failed)?;
        let stderr =
            stderr.map(|stream| KeptOutput::new(stream, Part::Beginning(Self::OUTPUT))).transpose().map_err(failed)?;
        let has_ended = group.wait(Some(self.time_limit)).map_err(failed)?;
        // With what it has started.
        let status = group.end().map_err(failed)?;
        let text = [stdout, stderr].map(|kept| kept.map(|kept| kept.text()).unwrap_or_default());
        let said = Complaints::in_output(&text.concat());
        if !has_ended {
            return Err(NgspiceError::TimeLimit { limit: self.time_limit.as_secs_f64(), said });
        }
        if !status.success() {
            return Err(NgspiceError::Failed { status, said });
        }
        Ok(BatchOutput { folder, complaints: said })
    }

    fn command(&self, folder: &Path) -> Command {
        let mut command = Command::new(&self.program);
        command.args(["-n", "-b", NETLIST_FILE]).current_dir(folder);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        // It would turn the result into ASCII.
        command.env_remove("SPICE_ASCIIRAWFILE");
        command
    }
}

impl BatchOutput {
    /// The result, if there is one.
    pub fn raw(&self) -> Result<Option<BufReader<File>>, NgspiceError> {
        let path = self.folder.path().join(RAW_FILE);
        match videg_input::open_regular(&path) {
            Ok(file) => Ok(Some(BufReader::with_capacity(1 << 16, file))),
            Err(cause) if cause.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(cause) => Err(NgspiceError::File { path, cause }),
        }
    }

    /// Complaints of ngspice.
    pub fn complaints(&self) -> &Complaints {
        &self.complaints
    }
}

#[cfg(test)]
#[cfg(unix)]
#[path = "runner_tests.rs"]
mod tests;
