//! Device and circuit, drawn with the values of a run. `docs/drawings` draws the templates.

use askama::Template;
use videg_circuit::{Release, Settings, Topology};
use videg_model::{ExcitationKind, Membrane, MembraneLaw, Parameters};
use videg_report::Section;

use super::format::significant;
use crate::cosim::Device;

/// Height of the drawing of a device, px: without and with what stands below it.
const HEIGHTS: [u32; 2] = [228, 330];
/// Corner of the inclined line, and its length, px.
const SLOPE: ([f64; 2], f64) = ([330.0, 312.0], 86.0);

/// The values in the drawing of a device.
#[derive(Template)]
#[template(path = "device.svg", escape = "html")]
struct DeviceDrawing {
    v: DeviceValues,
}

struct DeviceValues {
    mass: String,
    ball_mass: String,
    ball_radius: String,
    drive: String,
    amplitude: String,
    frequency: String,
    radius: String,
    thickness: String,
    contact: String,
    length: String,
    travel: String,
    /// Stiffness and damping.
    suspension: Option<(String, String)>,
    slope: Option<Slope>,
    height: u32,
}

struct Slope {
    angle: String,
    gravity: String,
    friction: String,
    /// x of the upper end, y of the lower and of the upper end, px.
    end: (f64, f64, f64),
}

/// The values in the schematic of a circuit.
struct CircuitValues {
    supply: String,
    release: String,
    load: String,
    membranes: String,
}

/// A schematic for each topology and release element.
macro_rules! schematics {
    ($($name:ident $path:tt)*) => {
        $(#[derive(Template)]
        #[template(path = $path, escape = "html")]
        struct $name<'a> {
            v: &'a CircuitValues,
        })*
    };
}

schematics! {
    SharedZener "circuit-shared-zener.svg"
    SharedSwitch "circuit-shared-switch.svg"
    SharedStorage "circuit-shared-storage.svg"
    IsolatedZener "circuit-isolated-zener.svg"
    IsolatedSwitch "circuit-isolated-switch.svg"
    IsolatedStorage "circuit-isolated-storage.svg"
}

/// The section; none if nothing is known of the harvester.
pub fn section(device: &Device, circuit: Option<&Settings>) -> anyhow::Result<Option<Section>> {
    let Some((parameters, recording)) = &device.parameters else { return Ok(None) };
    let mut drawn = vec![(DeviceDrawing { v: device_values(parameters, recording) }.render()?, DEVICE.to_owned())];
    if let Some(circuit) = circuit {
        drawn.push((schematic(circuit, parameters)?, circuit_caption(circuit)));
    }
    let heading = if circuit.is_some() { "Device and circuit" } else { "Device" };
    Ok(Some(Section::new(heading).figures(drawn)))
}

const DEVICE: &str = "The device with the values of the run, not to scale.";

fn circuit_caption(circuit: &Settings) -> String {
    let diodes = if circuit.exponential { "exponential" } else { "ideal" };
    format!("The circuit with the values of the run; {diodes} diodes.")
}

fn device_values(p: &Parameters, recording: &str) -> DeviceValues {
    let is_force = p.excitation_kind == ExcitationKind::Force;
    let (amplitude, unit, drive) =
        if is_force { (p.amplitude, "N", "force F(t)") } else { (p.acceleration, "m/s\u{b2}", "motion a(t)") };
    let file = recording.rsplit(['/', '\\']).next().unwrap_or_default();
    let (amplitude, frequency) = match (amplitude > 0.0, file.is_empty()) {
        (true, true) => (format!("{} {unit}", short(amplitude)), si(p.frequency, "Hz")),
        (true, false) => (format!("{} {unit}, {}", short(amplitude), si(p.frequency, "Hz")), cut(file)),
        (false, false) => ("recording".to_owned(), cut(file)),
        (false, true) => ("none".to_owned(), String::new()),
    };
    let suspension = (p.suspension_stiffness > 0.0 || p.suspension_damping > 0.0).then(|| {
        (format!("{} N/m", short(p.suspension_stiffness)), format!("{} N\u{b7}s/m", short(p.suspension_damping)))
    });
    let slope = (p.inclination != 0.0 || p.friction > 0.0).then(|| slope(p));
    DeviceValues {
        mass: si(1e3 * p.cylinder_mass, "g"),
        ball_mass: si(1e3 * p.ball_mass, "g"),
        ball_radius: si(p.ball_radius, "m"),
        drive: drive.to_owned(),
        amplitude,
        frequency,
        radius: si(p.membrane_radius(), "m"),
        thickness: si(p.membrane_thickness(), "m"),
        contact: contact(p),
        length: si(p.cylinder_length, "m"),
        travel: si(p.travel(), "m"),
        height: HEIGHTS[usize::from(suspension.is_some() || slope.is_some())],
        suspension,
        slope,
    }
}

/// What an impact loses, or the law of the film if that says it.
fn contact(p: &Parameters) -> String {
    let law = match p.membrane_law {
        MembraneLaw::Power => "",
        MembraneLaw::Table => ", measured film",
        MembraneLaw::Gent => ", Gent's film",
        MembraneLaw::Ogden => ", Ogden's film",
    };
    format!("r = {}{law}", short(p.restitution))
}

fn slope(p: &Parameters) -> Slope {
    let ([x, y], length) = SLOPE;
    let (sine, cosine) = p.inclination.sin_cos();
    // A cylinder that falls to the right begins above.
    let start = if sine < 0.0 { y + length * sine } else { y };
    Slope {
        angle: format!("{}\u{b0}", short(p.inclination.to_degrees())),
        gravity: format!("{} m/s\u{b2}", short(p.gravity)),
        friction: short(p.friction),
        end: (x + length * cosine, start, start - length * sine),
    }
}

fn schematic(circuit: &Settings, p: &Parameters) -> askama::Result<String> {
    let c = &circuit.circuit;
    let leakage = if c.leaks() { format!(", leakage {}", si(c.leakage_time_constant, "s")) } else { String::new() };
    let load = if c.load_resistance.is_finite() { si(c.load_resistance, "\u{3a9}") } else { "open".to_owned() };
    let v = &CircuitValues {
        supply: si(c.supply_voltage, "V"),
        release: si(c.release_voltage(), "V"),
        load,
        membranes: format!("each {} at rest{leakage}", si(Membrane::new(p).rest_capacitance(), "F")),
    };
    match (c.topology, c.release) {
        (Topology::SharedNode, Release::Zener) => SharedZener { v }.render(),
        (Topology::SharedNode, Release::Switch) => SharedSwitch { v }.render(),
        (Topology::SharedNode, Release::Storage) => SharedStorage { v }.render(),
        (Topology::Isolated, Release::Zener) => IsolatedZener { v }.render(),
        (Topology::Isolated, Release::Switch) => IsolatedSwitch { v }.render(),
        (Topology::Isolated, Release::Storage) => IsolatedStorage { v }.render(),
    }
}

/// Four significant digits without zeros at the end.
fn short(value: f64) -> String {
    let text = significant(value, 4);
    match text.split_once('e') {
        Some((digits, exponent)) => format!("{}e{exponent}", trimmed(digits)),
        None => trimmed(&text).to_owned(),
    }
}

fn trimmed(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

/// A value with the prefix of its unit.
fn si(value: f64, unit: &str) -> String {
    const PREFIXES: [(f64, &str); 9] = [
        (1e9, "G"),
        (1e6, "M"),
        (1e3, "k"),
        (1.0, ""),
        (1e-3, "m"),
        (1e-6, "\u{b5}"),
        (1e-9, "n"),
        (1e-12, "p"),
        (1e-15, "f"),
    ];
    let (factor, prefix) =
        PREFIXES.into_iter().find(|(factor, _)| value.abs() >= 0.999_95 * factor).unwrap_or((1.0, ""));
    format!("{} {prefix}{unit}", short(value / factor))
}

/// A name of a file that fits beside the device.
fn cut(name: &str) -> String {
    const MOST: usize = 18;
    if name.chars().count() <= MOST {
        return name.to_owned();
    }
    name.chars().take(MOST - 1).chain(['\u{2026}']).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_the_prefix_of_their_size() {
        let shown = [(0.0, "F"), (1.2345e-11, "F"), (1e9, "\u{3a9}"), (0.0063, "m"), (999.99, "V"), (2450.0, "V")];
        let shown = shown.map(|(value, unit)| si(value, unit));
        assert_eq!(shown, ["0 F", "12.35 pF", "1 G\u{3a9}", "6.3 mm", "1 kV", "2.45 kV"]);
    }

    #[test]
    fn the_drawing_carries_the_values_of_the_run_and_only_what_the_device_has() {
        let draw = |p: &Parameters, file: &str| DeviceDrawing { v: device_values(p, file) }.render().unwrap();
        let paper = draw(&Parameters::default(), "");
        for part in ["124.5 g", "3.5 g", "5 mm", "6.3 mm", "42 mm", "44 mm", "0.5 N", "2 Hz", "r = 0.6", "228"] {
            assert!(paper.contains(part), "{part}");
        }
        assert!(!paper.contains("N\u{b7}s/m") && !paper.contains("\u{b0}"));
        let inclined = Parameters { inclination: 0.5, suspension_stiffness: 20.0, ..Parameters::default() };
        let drawn = draw(&inclined, "/a/<shaker>.csv");
        for part in ["20 N/m", "28.65\u{b0}", "&#60;shaker&#62;.csv", "330"] {
            assert!(drawn.contains(part), "{part}");
        }
    }

    #[test]
    fn every_circuit_has_its_schematic_with_its_values() {
        let mut drawn = std::collections::BTreeSet::new();
        for topology in [Topology::SharedNode, Topology::Isolated] {
            for release in [Release::Zener, Release::Switch, Release::Storage] {
                let mut settings = Settings::default();
                settings.circuit.topology = topology;
                settings.circuit.release = release;
                settings.circuit.zener_voltage = 2345.0;
                settings.circuit.storage_voltage = 2345.0;
                let svg = schematic(&settings, &Parameters::default()).unwrap();
                assert!(svg.contains("2.345 kV") && svg.contains("2 kV") && svg.contains("pF at rest"), "{svg}");
                assert_eq!(svg.contains("1 G\u{3a9}"), release != Release::Storage);
                drawn.insert(svg);
            }
        }
        assert_eq!(drawn.len(), 6);
    }
}
