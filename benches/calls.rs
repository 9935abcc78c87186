//! What a call through FMI costs: `cargo bench --bench calls`.
//!
//! One loop in C (`baseline/loop.c`) drives `VibroImpactHarvester` and, as a measure of what a call costs at least, a plain
//! bouncing ball in C (`baseline/bouncing_ball.c`) in the same run, which does what `BouncingBall` of the Modelica
//! Reference-FMUs does in a call. Where a state is saved, restored and freed with nothing in between, the harvester
//! copies nothing, as nothing has changed; the ball copies twice. With a step in between, the harvester copies once.
//!
//! Steps are timed over a stretch in which no impact comes, from the same saved state again and again; pulses of the impact
//! before are under way. The 100 s of Fig. 14 have all their impacts.
//!
//! The same of FMI 3.0, where the importer lets steps go to their end, and where it handles events and takes steps that end early.

mod baseline;
#[path = "baseline/c.rs"]
mod c;

use std::ffi::{CString, c_char, c_void};
use std::hint::black_box;
use std::path::Path;
use std::ptr::NonNull;
use std::time::Duration;

use anyhow::{Context as _, ensure};
use criterion::Criterion;
use fmu_import::{Archive, LIBRARY_EXTENSION, ModelDescription};
use libloading::Library;
use videg::package::{FmiVersion, Options, build_all};
use videg_model::{Case, Parameters};

/// Communication step of the loop in C, s.
const STEP: f64 = 1e-3;
/// Steps of a stretch without impact, and steps after which one is looked for.
const STRETCH: u64 = 100;
const SETTLED: u64 = 30_000;
/// Duration and step of the paper's runs, s.
const UNTIL: f64 = 100.0;
const DT: f64 = 1e-5;

/// Real values to be set before initialization, as C has them.
#[repr(C)]
struct Settings {
    count: usize,
    references: *const u32,
    values: *const f64,
}

type Instance = NonNull<c_void>;

/// The functions of loop.c.
struct Loop {
    open_fmu: unsafe extern "C" fn(*const c_char, *const c_char, *const Settings) -> Option<Instance>,
    get_real: unsafe extern "C" fn(Instance, u32, *mut f64) -> i32,
    do_steps: unsafe extern "C" fn(Instance, u64) -> i32,
    mark: unsafe extern "C" fn(Instance) -> i32,
    time_steps: unsafe extern "C" fn(Instance, u64, u64) -> i64,
    time_states: unsafe extern "C" fn(Instance, u64) -> i64,
    time_rollbacks: unsafe extern "C" fn(Instance, u64) -> i64,
    _library: Library,
}

/// An initialised instance of an FMU under the loop in C. It lives as long as the process.
struct Driven<'a> {
    calls: &'a Loop,
    fmu: Instance,
}

impl Loop {
    fn load(library: &Path) -> anyhow::Result<Self> {
        // SAFETY: loop.c has no initialisers, and its functions have these signatures.
        unsafe {
            let library = Library::new(library)?;
            Ok(Self {
                open_fmu: *library.get(b"open_fmu")?,
                get_real: *library.get(b"get_real")?,
                do_steps: *library.get(b"do_steps")?,
                mark: *library.get(b"mark")?,
                time_steps: *library.get(b"time_steps")?,
                time_states: *library.get(b"time_states")?,
                time_rollbacks: *library.get(b"time_rollbacks")?,
                _library: library,
            })
        }
    }

    fn open(&self, library: &Path, guid: &str, settings: &[(u32, f64)]) -> anyhow::Result<Driven<'_>> {
        let path = CString::new(library.to_str().context("a path that is not UTF-8")?)?;
        let guid = CString::new(guid)?;
        let (references, values): (Vec<_>, Vec<_>) = settings.iter().copied().unzip();
        let settings = Settings { count: references.len(), references: references.as_ptr(), values: values.as_ptr() };
        // SAFETY: all pointers outlive the call.
        let fmu = unsafe { (self.open_fmu)(path.as_ptr(), guid.as_ptr(), &raw const settings) };
        Ok(Driven { calls: self, fmu: fmu.with_context(|| format!("{} does not start", library.display()))? })
    }
}

impl Driven<'_> {
    fn real(&self, reference: u32) -> anyhow::Result<f64> {
        let mut value = 0.0;
        // SAFETY: the instance is alive.
        let status = unsafe { (self.calls.get_real)(self.fmu, reference, &raw mut value) };
        ensure!(status == 0, "variable {reference} cannot be read");
        Ok(value)
    }

    fn advance(&self, steps: u64) -> anyhow::Result<()> {
        // SAFETY: the instance is alive.
        ensure!(unsafe { (self.calls.do_steps)(self.fmu, steps) } == 0, "a step failed");
        Ok(())
    }

    /// Timed steps start here from now on.
    fn mark(&self) -> anyhow::Result<()> {
        // SAFETY: the instance is alive.
        ensure!(unsafe { (self.calls.mark)(self.fmu) } == 0, "the state cannot be saved");
        Ok(())
    }

    /// Time of `count` runs of so many `steps` from the mark.
    fn runs(&self, count: u64, steps: u64) -> Duration {
        // SAFETY: the instance is alive.
        duration(unsafe { (self.calls.time_steps)(self.fmu, count, steps) })
    }

    /// Time of `count` steps in stretches from the mark.
    fn steps(&self, count: u64) -> Duration {
        let stretches = count.div_ceil(STRETCH);
        self.runs(stretches, STRETCH).mul_f64(count as f64 / (stretches * STRETCH) as f64)
    }

    /// Time of saving, restoring and freeing a state, `count` times.
    fn states(&self, count: u64) -> Duration {
        // SAFETY: the instance is alive.
        duration(unsafe { (self.calls.time_states)(self.fmu, count) })
    }

    /// Time of the same with a step in between, which is taken back.
    fn rollbacks(&self, count: u64) -> Duration {
        // SAFETY: the instance is alive.
        duration(unsafe { (self.calls.time_rollbacks)(self.fmu, count) })
    }
}

fn duration(nanoseconds: i64) -> Duration {
    assert!(nanoseconds >= 0, "a call failed");
    Duration::from_nanos(nanoseconds.unsigned_abs())
}

/// The harvester with these parameters; also the description of its variables.
fn harvester<'a>(
    calls: &'a Loop,
    folder: &Path,
    fmi: FmiVersion,
    parameters: &Parameters,
) -> anyhow::Result<(Driven<'a>, ModelDescription)> {
    let paths = build_all(&Options { fmi, output: Some(folder.to_owned()), ..Options::default() })?;
    let mut archive = Archive::open(paths.first().context("no FMU")?)?;
    let description = archive.description()?;
    let platforms = archive.platforms();
    let platform = platforms.first().context("no library")?;
    let library = format!("binaries/{platform}/{}.{LIBRARY_EXTENSION}", description.co_simulation.model_identifier);
    let settings = Parameters::TABLE
        .iter()
        .map(|quantity| Ok((description.variable(quantity.name)?.value_reference, (quantity.get)(parameters))))
        .collect::<fmu_import::Result<Vec<_>>>()?;
    // The library stays loaded, so its folder may stay, too.
    let unpacked = archive.unpack()?.keep();
    Ok((calls.open(&unpacked.join(library), &description.guid, &settings)?, description))
}

/// Goes on to where no impact comes within a stretch, and marks it.
fn find_stretch(driven: &Driven<'_>, next_impact: u32) -> anyhow::Result<()> {
    driven.advance(SETTLED)?;
    let end = |steps: u64| (steps + STRETCH + 1) as f64 * STEP;
    let mut steps = SETTLED;
    while driven.real(next_impact)? <= end(steps) {
        ensure!(steps < 2 * SETTLED, "no stretch of {STRETCH} steps without impact");
        driven.advance(1)?;
        steps += 1;
    }
    driven.mark()
}

fn time_calls(criterion: &mut Criterion, version: &str, instances: &[(&str, &Driven<'_>)]) {
    type Timed = fn(&Driven<'_>, u64) -> Duration;
    let kinds: [(&str, Timed); 3] = [
        ("doStep without impact", |driven, count| driven.steps(count)),
        ("get, set and free FMU state", |driven, count| driven.states(count)),
        ("get FMU state, doStep, set, free", |driven, count| driven.rollbacks(count)),
    ];
    for (kind, timed) in kinds {
        let mut group = criterion.benchmark_group(format!("{kind}{version}"));
        for (name, driven) in instances {
            group.bench_function(*name, |b| b.iter_custom(|count| timed(driven, count)));
        }
        group.finish();
    }
}

fn main() -> anyhow::Result<()> {
    let fig14 = (Case::find("fig14").context("no fig14")?.parameters)();
    let folder = tempfile::tempdir()?;
    let calls = Loop::load(&c::compile("loop.c", folder.path(), &[])?)?;
    let ball = c::compile("bouncing_ball.c", folder.path(), &["-fvisibility=hidden"])?;
    let ball = calls.open(&ball, "bouncing ball", &[])?;
    ball.mark()?;
    let (between, description) = harvester(&calls, folder.path(), FmiVersion::Fmi2, &fig14)?;
    find_stretch(&between, description.variable("impact.nextTime")?.value_reference)?;
    let (whole, _) = harvester(&calls, folder.path(), FmiVersion::Fmi2, &fig14)?;
    whole.mark()?;

    let mut criterion = Criterion::default().configure_from_args();
    time_calls(&mut criterion, "", &[("harvester", &between), ("bouncing ball in C", &ball)]);
    for (version, options) in [(", FMI 3.0", &["-DFMI3"][..]), (", FMI 3.0 with events", &["-DFMI3", "-DEVENTS"])] {
        let folder = folder.path().join(version.trim_start_matches(", "));
        let of_ball = folder.join("ball");
        std::fs::create_dir_all(&of_ball)?;
        let calls = Loop::load(&c::compile("loop.c", &folder, options)?)?;
        let (between, description) = harvester(&calls, &folder, FmiVersion::Fmi3, &fig14)?;
        find_stretch(&between, description.variable("impact.nextTime")?.value_reference)?;
        // The ball has no event mode: its steps go to their end.
        let plain = Loop::load(&c::compile("loop.c", &of_ball, &["-DFMI3"])?)?;
        let library = c::compile("bouncing_ball.c", &of_ball, &["-fvisibility=hidden"])?;
        let ball = plain.open(&library, "bouncing ball", &[])?;
        ball.mark()?;
        time_calls(&mut criterion, version, &[("harvester", &between), ("bouncing ball in C", &ball)]);
    }
    let mut group = criterion.benchmark_group("100 s of fig14 in calls");
    group.sample_size(10);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a positive number of steps
    let steps = (UNTIL / STEP).round() as u64;
    group.bench_function("doStep, 1 ms", |b| b.iter_custom(|count| whole.runs(count, steps)));
    group.bench_function("Runge-Kutta as the paper", |b| {
        b.iter(|| baseline::runge_kutta(black_box(&fig14), DT, UNTIL));
    });
    group.finish();
    criterion.final_summary();
    Ok(())
}
