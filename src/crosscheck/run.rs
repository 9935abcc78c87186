//! A crosscheck: the mechanics once, the circuit in every solver, and the comparison of their results.

use std::path::Path;

use fmu_import::Fmu;
use videg_circuit::{Release, Settings, Topology};

use super::capacitor::{CLOSED_FORMS, GrowingCapacitor};
use super::check::QuantityCheck;
use super::claims::Findings;
use super::compare::ComparedCircuit;
use super::conclude::conclusion;
use super::mechanics::MechanicalRun;
use super::pulses::Pulses;
use super::solver::Solver;
use super::solvers::{Job, JobResult, Solvers};
use super::stop::{Repeat, Stop, microseconds};
use super::sweep::ReleaseSweep;
use crate::cosim::{CircuitRequest, CircuitSummary, TimeProgress, best_release_voltage, label, voltage_warning};
use crate::ngspice::{Elements, Ngspice, NgspiceError, SolverRun, Waveforms};
use crate::progress::Progress;
use crate::scenario::Scenario;

/// What to check.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// The FMU `VibroImpactHarvester`.
    pub harvester: &'a Fmu,
    /// The case with its settings, those of the circuit included.
    pub scenario: &'a Scenario,
    /// ngspice as a program.
    pub ngspice: &'a Ngspice,
    /// The command-line tool of this crate, which runs ngspice's shared library.
    pub program: &'a Path,
    /// Whether to follow the net gain over the voltage of release and the load resistance.
    pub sweep: bool,
}

/// Results of a crosscheck.
#[derive(Debug)]
pub struct Crosscheck {
    /// What was run.
    pub scenario: Scenario,
    /// The mechanics.
    pub mechanics: MechanicalRun,
    /// Name of the circuit asked for.
    pub label: String,
    /// The circuit asked for.
    pub settings: Settings,
    /// It by every solver.
    pub runs: Vec<(Solver, Waveforms)>,
    /// The single pulses, in order of their height.
    pub pulses: Option<Pulses>,
    /// Their peaks on an open circuit, by solver.
    pub open: Vec<(Solver, Vec<f64>)>,
    /// The circuit asked for and others.
    pub compared: Vec<ComparedCircuit>,
    /// All checks.
    pub checks: Vec<QuantityCheck>,
    /// The sweep, if asked for.
    pub sweep: Option<ReleaseSweep>,
    /// Runs of ngspice that ended too early.
    pub stops: Vec<Stop>,
    /// Runs of ngspice that were repeated with changes.
    pub repeats: Vec<Repeat>,
    /// The conclusion in words.
    pub conclusion: Vec<String>,
    /// Warnings about the validity of the numbers.
    pub warnings: Vec<String>,
}

impl Crosscheck {
    /// Whether ngspice got to the end everywhere, and all solvers agree.
    pub fn passed(&self) -> bool {
        self.stops.is_empty() && !self.checks.iter().any(QuantityCheck::failed)
    }

    /// The circuit asked for by `solver`.
    pub fn run(&self, solver: Solver) -> Option<&Waveforms> {
        find(&self.runs, solver)
    }
}

fn find<T>(of: &[(Solver, T)], solver: Solver) -> Option<&T> {
    of.iter().find(|(other, _)| *other == solver).map(|(_, found)| found)
}

/// Runs the mechanics, and the circuit in every solver. The observer first gets the parts of the mechanics, then the tasks.
///
/// # Errors
/// A setting that neither harvester nor circuit takes; an error of a solver other than that ngspice stops.
pub fn run(options: &Options<'_>, progress: &dyn Progress) -> Result<Crosscheck, NgspiceError> {
    let &Options { harvester: fmu, scenario, ngspice, program, sweep } = options;
    let (mechanical, request) = CircuitRequest::split(fmu.description(), &scenario.settings)?;
    let mut time = TimeProgress::new(progress, scenario.until);
    let mechanics = MechanicalRun::new(fmu, scenario, &mechanical, &mut time)?;
    let settings = request.resolve(mechanics.bias_voltage, mechanics.best_ratio());
    let exponential = Settings { exponential: true, ..settings }.parameters();
    Elements::new(&exponential, mechanics.table.growth()).map_err(|error| request.located(error, &settings))?;
    let solvers = Solvers { ngspice, program };
    let others = others(&settings, mechanics.best_ratio());
    let pulses = Pulses::new(&mechanics, settings.circuit.topology)?;
    let jobs = jobs(&mechanics, &settings, &others, pulses.as_ref());
    let roles = jobs.iter().map(|(role, job)| (*role, job.solver)).collect();
    let results = solvers.run_all(jobs.into_iter().map(|(_, job)| job).collect(), progress)?;
    let mut results = Results::new(roles, results, pulses, others.len());
    let capacitor = GrowingCapacitor::new(settings.circuit.supply_voltage, &mechanics)?;
    let capacitor_checks = results.capacitor(ngspice, &capacitor)?;
    let mut checks = results.checks(&mechanics, &settings);
    let compared = results.compared(&solvers, &mechanics, &settings, &others, &mut checks)?;
    checks.extend(capacitor_checks);
    let Results { runs, pulses, open, mut stops, mut repeats, .. } = results;
    let sweep = if sweep { Some(ReleaseSweep::new(&solvers, &mechanics, &settings, progress)?) } else { None };
    if let Some(sweep) = &sweep {
        checks.extend(sweep.checks());
        stops.extend_from_slice(&sweep.stops);
        repeats.extend_from_slice(&sweep.repeats);
    }
    let mut warnings = mechanics.warnings.clone();
    warnings.extend(voltage_warning(&settings, mechanics.bias_voltage));
    warnings.extend(stops.iter().map(Stop::sentence));
    let conclusion = conclusion(&checks, &compared, &stops, &repeats);
    let (scenario, label) = (scenario.clone(), label(&settings));
    Ok(Crosscheck {
        scenario,
        mechanics,
        label,
        settings,
        runs,
        pulses,
        open,
        compared,
        checks,
        sweep,
        stops,
        repeats,
        conclusion,
        warnings,
    })
}

/// What a job is for.
#[derive(Clone, Copy)]
enum Role {
    /// The circuit asked for.
    Asked,
    /// The single pulses on an open circuit.
    Open,
    /// Another circuit, by its index.
    Other(usize),
}

/// All jobs, the longest first.
fn jobs<'a>(
    mechanics: &'a MechanicalRun,
    settings: &Settings,
    others: &[Settings],
    pulses: Option<&'a Pulses>,
) -> Vec<(Role, Job<'a>)> {
    let table = &mechanics.table;
    let asked = |solver: Solver| {
        let open = vec!["whether both ways to run ngspice agree".to_owned()];
        let job = Job { name: solver.name().to_owned(), solver, settings: *settings, table, open, last_row: false };
        (Role::Asked, job)
    };
    let open = |solver: Solver| {
        let pulses = pulses?;
        let highest = pulses.expected(mechanics, Topology::Isolated, 1.0).into_iter().fold(1.0, f64::max);
        let mut settings = *settings;
        settings.circuit.release = Release::Zener;
        // Eq. (12) is of a constant charge.
        settings.circuit.leakage_time_constant = 0.0;
        // Twice the highest `U_DE4`: out of reach.
        settings.circuit.zener_voltage = 2.0 * settings.circuit.supply_voltage * highest;
        let name = format!("open circuit in {}", solver.name());
        let open = vec!["U_DE4 of the pulses from there on, which are the higher ones".to_owned()];
        Some((Role::Open, Job { name, solver, settings, table: &pulses.table, open, last_row: false }))
    };
    let other = |(index, settings): (usize, &Settings)| {
        let (label, settings) = (label(settings), *settings);
        [Solver::Exponential, Solver::Batch].map(|solver| {
            let name = format!("{label} in {}", solver.name());
            let open = vec![format!("{label}: load energy and surplus")];
            (Role::Other(index), Job { name, solver, settings, table, open, last_row: true })
        })
    };
    let mut jobs = vec![asked(Solver::Live), asked(Solver::Batch)];
    jobs.extend(open(Solver::Batch));
    jobs.extend(others.iter().enumerate().flat_map(other));
    jobs.extend([asked(Solver::Exponential), asked(Solver::Ideal)]);
    jobs.extend([Solver::Exponential, Solver::Ideal].into_iter().filter_map(open));
    jobs
}

/// The paper's circuit, the same with an ideal switch, and a storage behind isolated membranes; those that are not the
/// one asked for.
fn others(asked: &Settings, ratio: f64) -> Vec<Settings> {
    let mut paper = *asked;
    paper.circuit.topology = Topology::SharedNode;
    paper.circuit.release = Release::Zener;
    paper.circuit.zener_voltage = paper.circuit.supply_voltage;
    let mut switch = paper;
    switch.circuit.release = Release::Switch;
    let mut storage = paper;
    storage.circuit.topology = Topology::Isolated;
    storage.circuit.release = Release::Storage;
    storage.circuit.storage_voltage = best_release_voltage(&storage, ratio);
    let is_asked = |other: &Settings| {
        let [a, b] = [other, asked].map(|settings| settings.circuit);
        (a.topology, a.release, a.release_voltage()) == (b.topology, b.release, b.release_voltage())
    };
    [paper, switch, storage].into_iter().filter(|other| !is_asked(other)).collect()
}

/// Results of the jobs by their roles.
struct Results {
    runs: Vec<(Solver, Waveforms)>,
    pulses: Option<Pulses>,
    open: Vec<(Solver, Vec<f64>)>,
    /// The other circuits by the embedded solver and by ngspice, each with its number of rows.
    others: Vec<Vec<(Waveforms, usize)>>,
    stops: Vec<Stop>,
    repeats: Vec<Repeat>,
}

impl Results {
    /// Sorts the results; the pulses are cut to those that every solver has to the end.
    fn new(jobs: Vec<(Role, Solver)>, results: Vec<JobResult>, mut pulses: Option<Pulses>, others: usize) -> Self {
        let (mut runs, mut open, mut stops, mut repeats) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut others = vec![Vec::new(); others];
        for ((role, solver), result) in jobs.into_iter().zip(results) {
            stops.extend(result.stop);
            repeats.extend(result.repeats);
            match role {
                Role::Asked => runs.push((solver, result.waveforms)),
                Role::Open => open.extend(pulses.iter().map(|pulses| (solver, pulses.peaks(&result.waveforms)))),
                Role::Other(index) => others[index].push((result.waveforms, result.rows)),
            }
        }
        runs.sort_by_key(|(solver, _)| *solver);
        let count = open.iter().map(|(_, peaks): &(Solver, Vec<f64>)| peaks.len()).min().unwrap_or(0);
        for (_, peaks) in &mut open {
            peaks.truncate(count);
        }
        pulses = pulses.filter(|_| count > 0);
        if let Some(pulses) = &mut pulses {
            pulses.truncate(count);
        }
        Self { runs, pulses, open, others, stops, repeats }
    }

    /// The checks of ngspice's capacitor; where it stops, there is none.
    fn capacitor(
        &mut self,
        ngspice: &Ngspice,
        capacitor: &GrowingCapacitor,
    ) -> Result<Vec<QuantityCheck>, NgspiceError> {
        let mut checks = Vec::new();
        for form in &CLOSED_FORMS {
            match capacitor.check(form, ngspice) {
                Ok(check) => checks.push(check),
                Err(error) if error.is_stop() => {
                    let (run, until) =
                        (SolverRun { stop: Some(error), ..SolverRun::default() }, capacitor.table.until());
                    self.stops.extend(Stop::of("closed forms of the capacitor", &run, until, &[form.about.to_owned()]));
                }
                Err(error) => return Err(error),
            }
        }
        Ok(checks)
    }

    /// The checks of the single pulses and of the circuit asked for, up to where all solvers got.
    fn checks(&mut self, mechanics: &MechanicalRun, settings: &Settings) -> Vec<QuantityCheck> {
        let findings =
            Findings { mechanics, settings, runs: &self.runs, pulses: self.pulses.as_ref(), open: &self.open };
        let mut all = findings.pulse_checks();
        let Some((mechanics, runs)) = common(mechanics, &self.runs) else {
            all.extend(findings.checks());
            return all;
        };
        let is_shorter = mechanics.table.len() < findings.mechanics.table.len();
        let checks = Findings { mechanics: &mechanics, runs: &runs, ..findings }.checks();
        let claims = checks.iter().filter_map(|check| check.claim.as_ref().map(|claim| claim.says.clone()));
        let mut claims: Vec<_> = claims.collect();
        if claims.is_empty() {
            claims = checks.iter().map(|check| check.name.clone()).collect();
        }
        // Claims are about ngspice in batch; its shared library confirms it.
        for stop in self.stops.iter_mut().filter(|stop| stop.task == Solver::Batch.name()) {
            stop.open.clone_from(&claims);
        }
        all.extend(if is_shorter { limited(checks, mechanics.table.until()) } else { checks });
        all
    }

    /// The circuit asked for and the others, by both solvers as far as both got; their checks are added to `checks`.
    fn compared(
        &self,
        solvers: &Solvers<'_>,
        mechanics: &MechanicalRun,
        asked: &Settings,
        others: &[Settings],
        checks: &mut Vec<QuantityCheck>,
    ) -> Result<Vec<ComparedCircuit>, NgspiceError> {
        let eq13 = mechanics.summary.energy_eq13;
        let by_both = [Solver::Exponential, Solver::Batch].map(|solver| find(&self.runs, solver));
        let first = by_both.into_iter().flatten().map(|run| (run.summary(eq13), run.samples.len())).collect();
        let rest = self.others.iter().map(|by| by.iter().map(|(run, rows)| (run.summary(eq13), *rows)).collect());
        let results = std::iter::once(first).chain(rest);
        let mut all = Vec::new();
        for (settings, by_solver) in std::iter::once(asked).chain(others).zip(results) {
            let by_solver: Vec<(CircuitSummary, usize)> = by_solver;
            let [(embedded, _), (ngspice, rows)] = &by_solver[..] else { continue };
            let compare = |mechanics, embedded: &CircuitSummary| {
                ComparedCircuit::new(label(settings), mechanics, settings, embedded.clone(), ngspice.clone())
            };
            if *rows == mechanics.table.len() {
                let compared = compare(mechanics, embedded);
                checks.extend(compared.checks());
                all.push(compared);
            } else if *rows > 1 {
                let mechanics = mechanics.truncated(*rows);
                let run = solvers.run(Solver::Exponential, settings, &mechanics.table, &|_| ())?;
                let compared = compare(&mechanics, &run.waveforms.summary(eq13));
                checks.extend(limited(compared.checks().into(), mechanics.table.until()));
                all.push(compared);
            }
        }
        Ok(all)
    }
}

/// Mechanics and runs up to where the first run stopped, without runs that have no rows. `None` if all are complete.
fn common(
    mechanics: &MechanicalRun,
    runs: &[(Solver, Waveforms)],
) -> Option<(MechanicalRun, Vec<(Solver, Waveforms)>)> {
    let begun = || runs.iter().filter(|(_, run)| run.samples.len() > 1);
    let rows = begun().map(|(_, run)| run.samples.len()).min()?;
    if rows == mechanics.table.len() && begun().count() == runs.len() {
        return None;
    }
    let mut runs: Vec<_> = begun().cloned().collect();
    for (_, run) in &mut runs {
        run.truncate(rows);
    }
    Some((mechanics.truncated(rows), runs))
}

/// Adds to the names of `checks`, and to their claims, that they are about the time up to `reached`, s.
fn limited(checks: Vec<QuantityCheck>, reached: f64) -> Vec<QuantityCheck> {
    let to = format!(", up to {} s", microseconds(reached));
    let limit = |mut check: QuantityCheck| {
        check.name += &to;
        if let Some(claim) = &mut check.claim {
            claim.says += &to;
        }
        check
    };
    checks.into_iter().map(limit).collect()
}
