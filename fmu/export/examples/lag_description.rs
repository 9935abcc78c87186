//! Prints the `modelDescription.xml` of the FMU in `lag.rs`.

use fmu_export::{DescriptionError, Standard, model_description};

#[path = "lag.rs"]
mod lag;

fn main() -> Result<(), DescriptionError> {
    print!("{}", model_description::<lag::Lag>(Standard::Fmi2)?);
    Ok(())
}
