//! Where a model is used beyond what it holds for: what VHB 4910 bears, in stretch, electric field and tension, and the
//! ratio of masses that Eq. (7) neglects. Nothing in the motion depends on them.

use core::fmt;

use crate::membrane::Membrane;
use crate::membrane::table::ForceTable;
use crate::parameters::{ExcitationKind, Parameters};

/// Stretch, equal in both directions and counted from the unstretched film, beyond which the film ruptures. The value
/// commonly quoted for VHB; rupture as a limit of generators: Koh, Keplinger, Li, Bauer and Suo 2011, IEEE/ASME
/// Transactions on Mechatronics 16, 33.
const RUPTURE_STRETCH: f64 = 6.0;

/// Breakdown field of the unstretched film, V/m, as commonly quoted from Kofod, Sommer-Larsen, Kornbluh and Pelrine
/// 2003, Journal of Intelligent Material Systems and Structures 14, 787.
const BREAKDOWN_UNSTRETCHED: f64 = 18e6;

/// Breakdown field, V/m, of the film strained by 500 % in both directions, a stretch of [`BREAKDOWN_STRETCH`]; from the
/// same place. No film is credited with more.
const BREAKDOWN_STRETCHED: f64 = 218e6;

/// Stretch at which [`BREAKDOWN_STRETCHED`] holds.
const BREAKDOWN_STRETCH: f64 = 6.0;

/// Shear modulus mu of the neo-Hookean film, Pa. The value commonly quoted for VHB; loss of tension as a limit of
/// generators: Koh et al. 2011, as above.
const SHEAR_MODULUS: f64 = 68e3;

/// m / M beyond which "the low mass ratio" of Section 3.2 is none: an impact changes the velocity of a free cylinder by up
/// to (1 + r) m / (m + M) of the relative speed, 18 % at r = 1 and this ratio; in Section 4.2 it is 0.028.
const LOW_MASS_RATIO: f64 = 0.1;

/// A ratio of masses that is not low, in a model that neglects it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NeglectedMass {
    /// m / M.
    pub ratio: f64,
}

impl fmt::Display for NeglectedMass {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            out,
            "ball.mass / cylinder.mass = {:.3} is above {LOW_MASS_RATIO}, but impacts do not slow the cylinder, as Eq. (7) \
             neglects it; with contact.reaction = true they do",
            self.ratio
        )
    }
}

impl Parameters {
    /// The ratio of masses, if it is not low and contacts do not act back on the cylinder (Section 3.2).
    pub fn neglected_mass(&self) -> Option<NeglectedMass> {
        let acts_back = self.reaction || self.excitation_kind == ExcitationKind::Motion;
        let ratio = self.ball_mass / self.cylinder_mass;
        (ratio > LOW_MASS_RATIO && !acts_back).then_some(NeglectedMass { ratio })
    }
}

/// A bound of the material.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// Area ratio `A_3` / `A_2`: the film ruptures.
    Area,
    /// Electric field `U` / `h_3`, V/m: the film breaks down.
    Field,
    /// Maxwell stress, Pa: the film wrinkles, as no tension is left.
    Tension,
    /// The same of a film whose stress `membrane.law` says.
    OwnTension,
    /// Deflection, m: a measured membrane goes on beyond its last point.
    Measured,
}

impl Limit {
    /// Name of the quantity, its unit, and the bound's source.
    fn words(self) -> [&'static str; 3] {
        match self {
            Self::Area => ["area ratio", "", "commonly quoted for VHB 4910 (Koh et al. 2011)"],
            Self::Field => {
                ["electric field", " V/m", "commonly quoted for VHB 4910 at this stretch (Kofod et al. 2003)"]
            }
            Self::Tension => [
                "Maxwell stress",
                " Pa",
                "the elastic stress commonly quoted for VHB 4910: loss of tension (Koh et al. 2011)",
            ],
            Self::OwnTension => ["Maxwell stress", " Pa", "the elastic stress by membrane.law: loss of tension"],
            Self::Measured => [
                "deflection",
                " m",
                "the last point of membrane.file: force and capacitance go on with their last slopes",
            ],
        }
    }
}

/// A quantity that is above its bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excess {
    /// Which.
    pub limit: Limit,
    /// Its value, in the unit of the limit.
    pub value: f64,
    /// The bound.
    pub bound: f64,
    /// When, s.
    pub time: f64,
}

impl fmt::Display for Excess {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { limit, value, bound, time } = self;
        let [name, unit, source] = limit.words();
        let [value, bound] = [value, bound].map(|number| match limit {
            Limit::Area => format!("{number:.3}"),
            Limit::Field | Limit::Tension | Limit::OwnTension => format!("{number:.3e}"),
            Limit::Measured => format!("{number}"),
        });
        write!(out, "{name} {value}{unit} at {time:.6} s is above {bound}{unit}, {source}")
    }
}

impl Membrane {
    /// Limits that are exceeded at `deflection`, m, under `voltage`, V, at `time`, s.
    ///
    /// The breakdown field is the power of the stretch through its two measured values: that it grows as a power is the
    /// finding of Huang, Shian, Diebold, Suo and Clarke 2012, Applied Physics Letters 101, 122905. Tension is lost where
    /// the Maxwell stress eps E^2 is above the elastic one, sigma = L/2 dW/dL of a Gent or Ogden film, mu (L^2 - L^-4) else.
    pub fn excesses(&self, deflection: f64, voltage: f64, time: f64) -> impl Iterator<Item = Excess> {
        // Each step asks: no power is taken where even the unstretched film stands the field.
        let breakdown =
            |stretch, field| if field > BREAKDOWN_UNSTRETCHED { breakdown_field(stretch) } else { f64::INFINITY };
        let above = self.bounded(deflection, voltage, breakdown).into_iter().filter(|(_, value, bound)| value > bound);
        above.map(move |(limit, value, bound)| Excess { limit, value, bound, time })
    }

    /// How much of its limits a film takes at `deflection`, m, under `voltage`, V: area ratio, electric field, Maxwell stress, and
    /// deflection of a measured membrane, each over its bound. Above 1 a limit is exceeded.
    pub fn over_limits(&self, deflection: f64, voltage: f64) -> [f64; 4] {
        self.bounded(deflection, voltage, |stretch, _| breakdown_field(stretch)).map(|(_, value, bound)| value / bound)
    }

    /// Each quantity that has a limit, and its bound; that of the field as `breakdown` says it for a stretch and a field, V/m.
    fn bounded(&self, deflection: f64, voltage: f64, breakdown: impl Fn(f64, f64) -> f64) -> [(Limit, f64, f64); 4] {
        let (stretch, field) = (self.stretch(deflection), self.field(deflection, voltage).abs());
        let tension = match self.material() {
            Some(material) => (Limit::OwnTension, material.stress(stretch.ln())),
            None => (Limit::Tension, elastic_stress(stretch)),
        };
        [
            (Limit::Area, self.area_ratio(deflection), (RUPTURE_STRETCH / self.prestretch).powi(2)),
            (Limit::Field, field, breakdown(stretch, field)),
            (tension.0, self.permittivity * field * field, tension.1),
            (Limit::Measured, deflection, self.table().map_or(f64::INFINITY, ForceTable::end)),
        ]
    }
}

/// Breakdown field at `stretch`, V/m.
fn breakdown_field(stretch: f64) -> f64 {
    if stretch >= BREAKDOWN_STRETCH {
        return BREAKDOWN_STRETCHED;
    }
    let exponent = (BREAKDOWN_STRETCHED / BREAKDOWN_UNSTRETCHED).ln() / BREAKDOWN_STRETCH.ln();
    BREAKDOWN_UNSTRETCHED * stretch.powf(exponent)
}

/// Stress of the neo-Hookean film at `stretch` in both directions, Pa.
fn elastic_stress(stretch: f64) -> f64 {
    SHEAR_MODULUS * (stretch.powi(2) - stretch.powi(-4))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::{MembraneLaw, VACUUM_PERMITTIVITY};
    use approx::assert_relative_eq;

    fn exceeded(membrane: &Membrane, deflection: f64, voltage: f64) -> Vec<Limit> {
        membrane.excesses(deflection, voltage, 0.0).map(|excess| excess.limit).collect()
    }

    #[test]
    fn the_breakdown_field_has_its_measured_values_and_grows_no_further() {
        assert_relative_eq!(breakdown_field(1.0), 18e6);
        assert_relative_eq!(breakdown_field(6.0), 218e6, max_relative = 1e-14); // rounding of ln, exp
        assert!(breakdown_field(2.0) > 18e6 && breakdown_field(2.0) < 218e6);
        assert_eq!(breakdown_field(12.0), breakdown_field(6.0));
    }

    #[test]
    fn each_limit_is_exceeded_just_above_its_bound_only() {
        let membrane = Membrane::new(&Parameters::default());
        // lambda = 2, h_2 = 0.25 mm
        let breakdown = breakdown_field(2.0) * 0.25e-3;
        assert_eq!(exceeded(&membrane, 0.0, 0.999 * breakdown), []);
        assert_eq!(exceeded(&membrane, 0.0, -1.001 * breakdown), [Limit::Field]);
        let slack = (68e3 * (4.0 - 1.0 / 16.0) / (VACUUM_PERMITTIVITY * 3.4)).sqrt() * 0.25e-3;
        assert_eq!(exceeded(&membrane, 0.0, 0.999 * slack), [Limit::Field]);
        assert_eq!(exceeded(&membrane, 0.0, 1.001 * slack), [Limit::Field, Limit::Tension]);
        let deepest = (1..10_000).map(|k| 1e-5 * f64::from(k)).find(|x| membrane.area_ratio(*x) > 9.0).unwrap();
        assert_eq!(exceeded(&membrane, deepest, 0.0), [Limit::Area]);
        assert_eq!(exceeded(&membrane, deepest - 1e-5, 0.0), []);
    }

    /// Voltage at which the flat film of `p` loses its tension, V.
    fn slack(p: &Parameters) -> f64 {
        let membrane = Membrane::new(p);
        let (mut low, mut high) = (0.0, 1e6);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if exceeded(&membrane, 0.0, middle).contains(&Limit::OwnTension) { high = middle } else { low = middle }
        }
        low
    }

    #[test]
    fn a_flat_neo_hookean_film_loses_its_tension_at_the_voltage_of_the_closed_form() {
        // U = h_1 sqrt(mu / eps) sqrt(lambda^-2 - lambda^-8), at most 0.6874 h_1 sqrt(mu / eps), at lambda = 2^(1/3): the pull-in
        // of a film that nothing holds.
        let film = |law, prestretch| Parameters {
            membrane_law: law,
            prestretch,
            initial_radius: 0.006,
            stretch_limit: 1e12,
            shear_modulus: 68e3,
            ogden_modulus_1: 68e3,
            ..Parameters::default()
        };
        let unit = 1e-3 * (68e3 / (VACUUM_PERMITTIVITY * 3.4)).sqrt();
        for law in [MembraneLaw::Gent, MembraneLaw::Ogden] {
            for prestretch in [1.05_f64, 1.2, 2.0, 4.0] {
                let closed = unit * (prestretch.powi(-2) - prestretch.powi(-8)).sqrt();
                assert_relative_eq!(slack(&film(law, prestretch)), closed, max_relative = 1e-9);
            }
            let pull_in = 2.0_f64.powf(1.0 / 3.0);
            let [before, there, after] = [0.99, 1.0, 1.01].map(|factor| slack(&film(law, factor * pull_in)));
            assert!(before < there && after < there);
            assert_relative_eq!(there, 0.687_4 * unit, max_relative = 1e-4);
        }
    }

    #[test]
    fn a_measured_membrane_ends_at_its_last_point() {
        let p = Parameters { membrane_law: MembraneLaw::Table, ..Parameters::default() };
        let table = ForceTable::new(vec![0.0, 1e-3, 2e-3], vec![0.0, 0.1, 0.3], None).unwrap();
        let membrane = Membrane::new(p.with_table(Some(&table)));
        assert_eq!(exceeded(&membrane, 2e-3, 0.0), []);
        assert_eq!(exceeded(&membrane, 2.1e-3, 0.0), [Limit::Measured]);
        let text = membrane.excesses(2.5e-3, 0.0, 1.0).next().unwrap().to_string();
        assert!(text.starts_with("deflection 0.0025 m at 1.000000 s is above 0.002 m, the last point of"), "{text}");
    }

    #[test]
    fn what_a_film_takes_of_its_limits_is_above_1_where_they_are_exceeded() {
        let table = ForceTable::new(vec![0.0, 2e-3, 4e-3], vec![0.0, 0.1, 0.3], None).unwrap();
        let measured = Parameters { membrane_law: MembraneLaw::Table, ..Parameters::default() };
        let gent = Parameters { membrane_law: MembraneLaw::Gent, ..Parameters::default() };
        for membrane in [Membrane::new(&gent), Membrane::new(measured.with_table(Some(&table)))] {
            for (k, j) in (0..40).flat_map(|k| (0..40).map(move |j| (k, j))) {
                let (deflection, voltage) = (5e-4 * f64::from(k), 1e3 * f64::from(j));
                let above = membrane.over_limits(deflection, voltage).into_iter().filter(|share| *share > 1.0);
                let excesses = membrane.excesses(deflection, voltage, 0.0);
                let shares: Vec<f64> = excesses.map(|excess| excess.value / excess.bound).collect();
                assert_eq!(above.collect::<Vec<_>>(), shares, "{deflection} m, {voltage} V");
            }
        }
    }

    #[test]
    fn a_warning_names_quantity_value_time_bound_and_source() {
        let excess = Excess { limit: Limit::Area, value: 40.1, bound: 9.0, time: 12.3 };
        let text = "area ratio 40.100 at 12.300000 s is above 9.000, commonly quoted for VHB 4910 (Koh et al. 2011)";
        assert_eq!(excess.to_string(), text);
        for limit in [Limit::Field, Limit::Tension] {
            assert!(Excess { limit, ..excess }.to_string().contains("commonly quoted for VHB 4910"));
        }
    }

    #[test]
    fn a_heavy_ball_is_neglected_unless_contacts_act_back() {
        let heavy = Parameters { ball_mass: 0.053, cylinder_mass: 0.012, ..Parameters::default() };
        let text = heavy.neglected_mass().unwrap().to_string();
        assert!(text.starts_with("ball.mass / cylinder.mass = 4.417 is above 0.1, "), "{text}");
        assert_eq!(Parameters { reaction: true, ..heavy }.neglected_mass(), None);
        assert_eq!(Parameters { excitation_kind: ExcitationKind::Motion, ..heavy }.neglected_mass(), None);
        assert_eq!(Parameters { ball_mass: 0.1, cylinder_mass: 1.0, ..heavy }.neglected_mass(), None);
        assert_eq!(Parameters::default().neglected_mass(), None);
    }
}
