//! `model.png`, the picture of an FMU that tools show as its icon.

mod canvas;
mod circuit;
mod harvester;
mod letters;

use canvas::Canvas;
use harvester::Dimensions;

use super::error::{PackageError, Result};
use fmu_import::{Kind, ModelDescription};

/// Size of the picture, px.
const SIZE: (u32, u32) = (600, 400);

/// The picture of an FMU as a PNG file, drawn with the start values of its variables; none for a model unknown here.
///
/// # Errors
/// When a length is missing or not positive.
pub(super) fn draw(description: &ModelDescription) -> Result<Option<Vec<u8>>> {
    let Some(mut canvas) = Canvas::new(SIZE.0, SIZE.1) else { return Ok(None) };
    match description.co_simulation.model_identifier.as_str() {
        "VibroImpactHarvester" => harvester::draw(&mut canvas, dimensions(description)?),
        "HarvestingCircuit" => circuit::draw(&mut canvas),
        _ => return Ok(None),
    }
    Ok(canvas.png())
}

fn dimensions(description: &ModelDescription) -> Result<Dimensions> {
    let stretch = start(description, "membrane.prestretch")?;
    Ok(Dimensions {
        cylinder: start(description, "cylinder.length")?,
        frame: start(description, "frame.width")?,
        membrane: stretch * start(description, "membrane.initialRadius")?,
        ball: start(description, "ball.radius")?,
    })
}

fn start(description: &ModelDescription, name: &'static str) -> Result<f64> {
    let variable = description.variables.iter().find(|variable| variable.name == name);
    let value = variable.and_then(|variable| match variable.kind {
        Kind::Real { start, .. } => start,
        _ => None,
    });
    value.filter(|value| *value > 0.0).ok_or(PackageError::Picture { variable: name, found: value })
}

#[cfg(test)]
mod tests {
    use tiny_skia::Pixmap;

    use super::*;

    fn description(identifier: &str) -> ModelDescription {
        let path = format!("{}/modelDescription/{identifier}.xml", env!("CARGO_MANIFEST_DIR"));
        ModelDescription::parse(&std::fs::read(&path).unwrap(), &path).unwrap()
    }

    fn picture(description: &ModelDescription) -> Pixmap {
        Pixmap::decode_png(&draw(description).unwrap().unwrap()).unwrap()
    }

    fn set(description: &mut ModelDescription, name: &str, value: f64) {
        let variable = description.variables.iter_mut().find(|variable| variable.name == name).unwrap();
        let Kind::Real { start, .. } = &mut variable.kind else { panic!("{name} is real") };
        *start = Some(value);
    }

    /// How many pixels have the colour of the ball.
    fn ball_area(picture: &Pixmap) -> usize {
        let orange =
            |pixel: &&tiny_skia::PremultipliedColorU8| (pixel.red(), pixel.green(), pixel.blue()) == (230, 159, 0);
        picture.pixels().iter().filter(orange).count()
    }

    #[test]
    fn both_fmus_have_a_picture_with_a_white_edge() {
        for identifier in ["VibroImpactHarvester", "HarvestingCircuit"] {
            let picture = picture(&description(identifier));
            assert_eq!((picture.width(), picture.height()), SIZE);
            let white = |x, y| picture.pixel(x, y).unwrap().red() == 255;
            assert!((0..600).all(|x| white(x, 0) && white(x, 399)), "{identifier} leaves the canvas");
            assert!((0..400).all(|y| white(0, y) && white(599, y)), "{identifier} leaves the canvas");
        }
    }

    #[test]
    fn the_harvester_is_to_scale() {
        let mut small = description("VibroImpactHarvester");
        set(&mut small, "ball.radius", 0.0025);
        let (whole, small) = (ball_area(&picture(&description("VibroImpactHarvester"))), ball_area(&picture(&small)));
        let ratio = whole as f64 / small as f64;
        // A quarter of the area, but for the outline and the letter.
        assert!((3.0..7.0).contains(&ratio), "{whole} and {small} px");
    }

    #[test]
    fn a_length_that_cannot_be_drawn_is_named() {
        let mut description = description("VibroImpactHarvester");
        set(&mut description, "cylinder.length", 0.0);
        let error = draw(&description).unwrap_err().to_string();
        assert_eq!(
            error,
            "cannot draw the model: the start value of cylinder.length is 0, allowed is a positive number"
        );
    }
}
