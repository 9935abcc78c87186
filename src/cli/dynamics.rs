//! `videg dynamics`: what the motion of a case is like for long.

use clap::Args;
use clap::builder::RangedU64ValueParser;
use clap::value_parser;

use super::dynamics_report::{self as page, Found};
use super::interruption::Interruption;
use super::options::{CaseOptions, mechanical};
use super::progress::TimeBar;
use super::results::{Identity, OutputOptions, Results, flag};
use super::{Exit, output, packaging, reproduce_files as files, run_output};
use crate::artefact::{Picture, Sheet};
use crate::cosim::Device;
use crate::dynamics::orbits::{self, Branch, Orbit, Search};
use crate::dynamics::{Basins, Diagram, DynamicsError, Motion, Periods, Problem, exponent, pictures, sheets};
use crate::progress::{Progress, during};
use crate::scenario::Scenario;
use crate::sweep::{Vary, harvester_description};

/// Arguments of the verb.
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    case: CaseOptions,
    /// Bifurcation diagram over a real parameter: name=from:to:count, with log: before from for equal ratios, or
    /// name=a,b,c. With --orbits also the branches of periodic orbits
    #[arg(long, value_name = "VARIABLE=VALUES")]
    vary: Option<String>,
    /// Find periodic orbits, stable and unstable, and their Floquet multipliers
    #[arg(long)]
    orbits: bool,
    /// Largest period of the orbits, in periods of the excitation
    #[arg(long, value_name = "N", default_value_t = PERIODS, value_parser = value_parser!(u32).range(1..=32))]
    periods: u32,
    /// Seed of the random starts from which orbits are searched for
    #[arg(long, value_name = "N", default_value_t = SEED)]
    seed: u64,
    /// Basins of attraction over N x N starts [default: 100]
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "100", value_parser = value_parser!(u32).range(2..=1000))]
    basins: Option<u32>,
    /// Largest relative velocity of these starts, m/s [default: 2 pi f0 times the travel of the ball]
    #[arg(long, value_name = "M/S", requires = "basins")]
    basins_speed: Option<f64>,
    /// Periods that pass before a motion is looked at
    #[arg(long, value_name = "N", default_value_t = TRANSIENT, value_parser = value_parser!(u32).range(0..=1_000_000))]
    transient: u32,
    /// Periods at which it is then looked at [default: 1000 for the section, 60 for the diagram]
    #[arg(long, value_name = "N", value_parser = RangedU64ValueParser::<u32>::new().range(4..=1_000_000))]
    samples: Option<u32>,
    #[command(flatten)]
    output: OutputOptions,
    /// Print one JSON object on stdout instead of the table
    #[arg(long)]
    json: bool,
}

const PERIODS: u32 = 4;
const SEED: u64 = 1;
const TRANSIENT: u32 = 200;
/// Periods of a section and of a diagram, and those of each start of basins.
const SECTION: u32 = 1000;
const DIAGRAM: u32 = 60;
const BASINS: u32 = 32;
/// Most flashes of a diagram: what a machine of a few gigabytes holds.
const MOST: u64 = 20_000_000;

/// Runs the verb.
pub fn run(arguments: &Arguments, interruption: &Interruption) -> anyhow::Result<Exit> {
    let scenario = arguments.case.scenario()?;
    let vary = arguments.vary.as_deref().map(Vary::parse).transpose()?;
    let settings = mechanical(&harvester_description()?, &scenario, "dynamics")?;
    let problem = Problem::new(&settings, vary.as_ref())?;
    arguments.check(&problem)?;
    let claimed = Results::claim(&arguments.output, arguments.identity(&scenario)?, interruption)?;
    let bar = TimeBar::new(&format!("dynamics {}", scenario.name));
    let found = arguments.find(&problem, &bar)?;
    drop(bar);
    let (sheets, pictures) = arguments.show(&problem, &found)?;
    let folder = &claimed.folder;
    let mut files = files::write(folder, &sheets, &pictures)?;
    let device = Device::of(&packaging::open("VibroImpactHarvester")?, &scenario)?;
    let report = page::report(&scenario, &problem, &found, &device, pictures)?;
    let path = folder.join("report.html");
    output::write(&path, videg_report::render_html(&report)?)?;
    files.extend([path, folder.join("result.json")]);
    let result = run_output::json(&page::Output::new(&claimed.identity, &scenario, &problem, &found, &files))?;
    let text = page::text(&scenario, &problem, &found, &files);
    run_output::conclude(claimed, arguments.json, &result, &text, &[])?;
    Ok(Exit::Passed)
}

impl Arguments {
    fn identity(&self, scenario: &Scenario) -> anyhow::Result<Identity> {
        let Self { orbits, periods, seed, basins, transient, .. } = self;
        let number = |number: u64, default: u64| (number != default).then(|| number.to_string());
        let options = [
            ("vary", self.vary.clone()),
            ("orbits", flag(*orbits)),
            ("periods", number(u64::from(*periods), u64::from(PERIODS))),
            ("seed", number(*seed, SEED)),
            ("basins", basins.map(|count| count.to_string())),
            ("basins_speed", self.basins_speed.map(|speed| speed.to_string())),
            ("transient", number(u64::from(*transient), u64::from(TRANSIENT))),
            ("samples", self.samples.map(|samples| samples.to_string())),
        ];
        Identity::of("dynamics", scenario, options)
    }

    /// Checks what goes together with what, before anything runs.
    fn check(&self, problem: &Problem) -> anyhow::Result<()> {
        if self.orbits {
            problem.check_orbits()?;
        }
        if let Some(speed) = self.basins_speed {
            anyhow::ensure!(
                speed > 0.0 && speed <= 1e3,
                "--basins-speed {speed}: must lie above 0 and not above 1000 m/s"
            );
        }
        let values = problem.varied.as_ref().map_or(0, |varied| varied.values.len() as u64);
        let flashes = 3 * values * u64::from(self.taken(DIAGRAM));
        let samples = self.taken(DIAGRAM);
        anyhow::ensure!(
            flashes <= MOST,
            "--samples {samples}: three diagrams of {values} values have {flashes} points; at most {MOST} are kept"
        );
        Ok(())
    }

    fn taken(&self, default: u32) -> u32 {
        self.samples.unwrap_or(default)
    }

    /// Does what was asked for.
    fn find(&self, problem: &Problem, observer: &dyn Progress) -> Result<Found, DynamicsError> {
        let (parameters, transient) = (&problem.parameters, self.transient);
        let setup = problem.setup(parameters);
        let (motion, exponent) = during(observer, "section", "Poincare section and Lyapunov exponent", || {
            let motion = Motion::take(setup, transient, self.taken(SECTION))?;
            let exponent = exponent(setup, motion.last(), self.taken(SECTION))?;
            Ok::<_, DynamicsError>((motion, exponent))
        })?;
        let diagram = problem.varied.as_ref().map(|varied| {
            let periods = Periods { transient, taken: self.taken(DIAGRAM) };
            during(observer, "diagram", "bifurcation diagram", || {
                let at = |value| problem.at(value);
                Diagram::new(varied.values.clone(), (at, &problem.files), periods, observer)
            })
        });
        let diagram = diagram.transpose()?;
        let (orbits, branches) = if self.orbits { self.follow(problem, observer)? } else { Default::default() };
        let basins = self.basins.map(|count| {
            let fastest = parameters.travel() * std::f64::consts::TAU * parameters.frequency;
            let periods = Periods { transient, taken: BASINS };
            let fastest = self.basins_speed.unwrap_or(fastest);
            during(observer, "basins", "basins of attraction", || Basins::new(setup, count, fastest, periods, observer))
        });
        Ok(Found {
            transient,
            motion,
            exponent,
            diagram,
            has_orbits: self.orbits,
            orbits,
            branches,
            basins: basins.transpose()?,
        })
    }

    fn follow(&self, problem: &Problem, observer: &dyn Progress) -> Result<(Vec<Orbit>, Vec<Branch>), DynamicsError> {
        let search = Search { periods: self.periods, seed: self.seed, ..Search::default() };
        during(observer, "orbits", "periodic orbits", || {
            let orbits = orbits::orbits(problem, &search, observer)?;
            let branches =
                if problem.varied.is_some() { orbits::branches(problem, &search, observer)? } else { Vec::new() };
            Ok((orbits, branches))
        })
    }

    /// Data and pictures.
    fn show(&self, problem: &Problem, found: &Found) -> Result<(Vec<Sheet>, Vec<Picture>), DynamicsError> {
        let motion = &found.motion;
        let mut data = vec![sheets::section("poincare", motion, self.transient)];
        let mut drawn = vec![pictures::sections("poincare", &[("", motion)], &page::section_caption(found))?];
        let axis = problem.varied.as_ref().map(crate::dynamics::Varied::label).unwrap_or_default();
        if let Some(diagram) = &found.diagram {
            data.push(sheets::diagram("bifurcation", &axis, diagram));
            let caption = page::diagram_caption(found, diagram);
            drawn.push(pictures::diagram("bifurcation", &axis, diagram, &found.branches, &caption)?);
        }
        if found.has_orbits {
            data.extend([sheets::orbits("orbits", &found.orbits), sheets::impacts("orbit-impacts", &found.orbits)]);
        }
        if !found.branches.is_empty() {
            data.push(sheets::branches("branches", &axis, &found.branches));
            data.push(sheets::bifurcations("bifurcations", &axis, &found.branches));
            drawn.push(pictures::multipliers("multipliers", &axis, &found.branches, page::MULTIPLIERS)?);
        }
        if let Some(basins) = &found.basins {
            data.push(sheets::basins("basins", basins));
            drawn.push(pictures::basins("basins", "Basins of attraction", basins, &page::basins_caption(basins))?);
        }
        Ok((data, drawn))
    }
}
