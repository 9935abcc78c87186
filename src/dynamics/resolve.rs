//! The problem that settings and a varied variable, as a user writes them, describe.

use videg_model::{Parameters, Quantity};

use super::{DynamicsError, Files, Problem, Varied};
use crate::scenario::Setting;
use crate::sweep::{self, BuiltIn, Request, Sweep, Times, Vary};

/// Most values of what varies.
const MOST: u64 = 100_000;

impl Problem {
    /// The harvester with these settings, over the values of `vary`.
    ///
    /// # Errors
    /// A setting that is no parameter of the model, or whose value it cannot take; what varies is none of its real parameters, or has
    /// less than two values; an excitation that does not repeat.
    pub fn new(settings: &[Setting], vary: Option<&Vary>) -> Result<Self, DynamicsError> {
        // A sweep has at least one run.
        let (files, settings) = Files::read(settings)?;
        let parameters = resolve(&settings, None)?.into_iter().next().unwrap_or_default();
        files.setup(&parameters).validate()?;
        let varied = vary.map(|vary| Varied::new(&settings, vary)).transpose()?;
        let problem = Self { parameters, files, varied };
        problem.check_periodic()?;
        Ok(problem)
    }
}

impl Varied {
    fn new(settings: &[Setting], vary: &Vary) -> Result<Self, DynamicsError> {
        let name = &vary.name;
        let no_range = || DynamicsError::NoRange { name: name.clone() };
        let quantity: Option<&'static Quantity> = Parameters::TABLE.iter().find(|quantity| quantity.name == name);
        let all = resolve(settings, Some(vary))?;
        let quantity = quantity.ok_or_else(no_range)?;
        all.iter().try_for_each(Parameters::validate)?;
        let mut values: Vec<f64> = all.iter().map(|parameters| (quantity.get)(parameters)).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        if values.len() < 2 { Err(no_range()) } else { Ok(Self { quantity, values }) }
    }
}

/// The parameters at each value of `vary`, or those of the settings alone.
fn resolve(settings: &[Setting], vary: Option<&Vary>) -> Result<Vec<Parameters>, DynamicsError> {
    let description = sweep::harvester_description().map_err(sweep::SweepError::from)?;
    let times = Times { until: 1.0, step: None, window: [0.5, 1.0] };
    let request = Request {
        vary: vary.into_iter().cloned().collect(),
        ..Request::new("dynamics".to_owned(), &description, settings.to_vec(), times)
    };
    let sweep = Sweep::new(&request)?;
    if sweep.points() > MOST {
        let name = vary.map_or_else(String::new, |vary| vary.name.clone());
        return Err(DynamicsError::TooMany { name, count: sweep.points(), most: MOST });
    }
    let is_parameter = |name: &str| {
        Parameters::TABLE.iter().any(|it| it.name == name) || Parameters::CHOICES.iter().any(|it| it.name == name)
    };
    let Some(built_in) = BuiltIn::new(&sweep) else {
        let names = settings.iter().map(|setting| &setting.name).chain(vary.map(|vary| &vary.name));
        let name = names.into_iter().find(|name| !is_parameter(name)).cloned().unwrap_or_default();
        return Err(DynamicsError::NoParameter { name });
    };
    Ok((0..sweep.runs()).map(|number| built_in.parameters_of(&sweep, number)).collect())
}
