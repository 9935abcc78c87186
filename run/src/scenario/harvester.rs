//! The harvester that cases are of.

use fmu_import::{FmiError, ModelDescription};

/// Model description of the harvester FMU; the model behind it has the same parameters.
///
/// # Errors
/// None: it is part of this program.
pub fn harvester_description() -> Result<ModelDescription, FmiError> {
    let document = include_bytes!("../../../modelDescription/VibroImpactHarvester.xml");
    ModelDescription::parse(document, "modelDescription/VibroImpactHarvester.xml")
}
