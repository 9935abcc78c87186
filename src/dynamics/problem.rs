//! What the dynamics of is looked at: the parameters of a case, and one of them that varies.

use videg_model::{Parameters, Quantity, Setup};

use super::excitation::period;
use super::{DynamicsError, Files};

/// A case, and the parameter over which it is followed.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Its parameters.
    pub parameters: Parameters,
    /// What it has besides them.
    pub files: Files,
    /// The one that varies.
    pub varied: Option<Varied>,
}

/// A real parameter that varies.
#[derive(Debug, Clone)]
pub struct Varied {
    /// The parameter.
    pub quantity: &'static Quantity,
    /// Its values, at least two, the first and the last at the ends.
    pub values: Vec<f64>,
}

impl Varied {
    /// Smallest and largest value.
    pub fn range(&self) -> [f64; 2] {
        let ends = [self.values.first(), self.values.last()].map(|end| end.copied().unwrap_or(f64::NAN));
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    }

    /// Axis label: name and unit.
    pub fn label(&self) -> String {
        format!("{} ({})", self.quantity.name, self.quantity.unit)
    }
}

impl Problem {
    /// The parameters where the one that varies has this `value`.
    pub fn at(&self, value: f64) -> Parameters {
        let mut parameters = self.parameters;
        if let Some(varied) = &self.varied {
            (varied.quantity.set)(&mut parameters, value);
        }
        parameters
    }

    /// What a harvester with these `parameters` is made from.
    pub fn setup<'a>(&'a self, parameters: &'a Parameters) -> Setup<'a> {
        self.files.setup(parameters)
    }

    /// Checks that the excitation is periodic.
    pub(super) fn check_periodic(&self) -> Result<(), DynamicsError> {
        let name = "excitation.phaseNoise";
        let varies = self.varied.as_ref().is_some_and(|varied| varied.quantity.name == name);
        if self.parameters.is_noisy() || varies {
            let value = self.parameters.phase_noise;
            return Err(DynamicsError::NotPeriodic { name, value });
        }
        period(&self.setup(&self.parameters)).map(drop)
    }

    /// Checks that periodic orbits can be followed: under a periodic excitation, over a parameter of the motion.
    ///
    /// # Errors
    /// What stands against it, by name.
    pub fn check_orbits(&self) -> Result<(), DynamicsError> {
        self.check_periodic()?;
        check_elastic(&self.parameters)?;
        if let Some(varied) = &self.varied {
            varied.values.iter().try_for_each(|&value| check_elastic(&self.at(value)))?;
        }
        if self.files.recording.is_some() {
            return Err(DynamicsError::Recording);
        }
        match &self.varied {
            Some(varied) if varied.quantity.name.starts_with("initial.") => {
                Err(DynamicsError::InitialState { name: varied.quantity.name })
            }
            _ => Ok(()),
        }
    }
}

/// Checks that the films keep nothing of a contact that is over.
fn check_elastic(parameters: &Parameters) -> Result<(), DynamicsError> {
    let (name, value) = ("membrane.viscousModulus", parameters.viscous_modulus);
    if parameters.is_viscous() { Err(DynamicsError::Viscous { name, value }) } else { Ok(()) }
}
