//! First-order changes of deflection and capacitance, with the impact and with the parameters.

use crate::membrane::Membrane;
use crate::paper::membrane;
use crate::parameters::Parameters;

/// Changes of a membrane.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct MembraneChange {
    /// Of `R_2`, m.
    pub radius: f64,
    /// Of `r_b`, m.
    pub ball_radius: f64,
    /// Of `C_2`, F.
    pub rest_capacitance: f64,
    /// Of the logarithm of delta at a given speed and n.
    pub log_deflection: f64,
    /// Of n.
    pub exponent: f64,
    /// Of lambda.
    pub prestretch: f64,
    /// Of the logarithm of `h_2`.
    pub log_thickness: f64,
}

impl MembraneChange {
    /// The change of the membrane of `parameters` when they change by `change`.
    pub(crate) fn new(parameters: &Parameters, change: &Parameters) -> Self {
        let (p, d) = (parameters, change);
        let stretch = d.prestretch / p.prestretch;
        let capacitance = d.relative_permittivity / p.relative_permittivity
            + 4.0 * stretch
            + 2.0 * d.initial_radius / p.initial_radius
            - d.initial_thickness / p.initial_thickness;
        Self {
            radius: p.prestretch * d.initial_radius + d.prestretch * p.initial_radius,
            ball_radius: d.ball_radius,
            rest_capacitance: Membrane::new(p).rest_capacitance * capacitance,
            log_deflection: (d.ball_mass / p.ball_mass - d.stiffness / p.stiffness) / (p.stiffness_exponent + 1.0),
            exponent: d.stiffness_exponent,
            prestretch: d.prestretch,
            log_thickness: d.initial_thickness / p.initial_thickness - 2.0 * stretch,
        }
    }
}

impl Membrane {
    /// Change of the deflection `peak`, m, of an impact at `speed`, m/s, when that changes by `speed_change`: Eq. (10).
    pub(crate) fn deflection_change(
        &self,
        speed: f64,
        peak: f64,
        speed_change: f64,
        change: Option<&MembraneChange>,
    ) -> f64 {
        let power = self.exponent(peak) + 1.0;
        let by_membrane = change.map_or(0.0, |d| d.log_deflection + d.exponent * (1.0 / power - peak.ln()) / power);
        if peak > 0.0 { peak * (2.0 / power * speed_change / speed + by_membrane) } else { 0.0 }
    }

    /// Changes of what it shows at `deflection`, m, when that changes by `by`, m: `A_3` / `A_2`, lambda sqrt(`A_3` / `A_2`), the field
    /// per volt 1 / `h_3`, 1/m, and the capacitance, F.
    pub(crate) fn shown_changes(&self, deflection: f64, by: f64, change: Option<&MembraneChange>) -> [f64; 4] {
        let of = |of_change: &dyn Fn(&MembraneChange) -> f64| change.map_or(0.0, of_change);
        let root = self.area_ratio(deflection).sqrt();
        let area = self.area_slope(deflection) * by + of(&|change| self.area_change_by_geometry(deflection, change));
        let rest = of(&|change| change.rest_capacitance * (1.0 + self.capacitance_excess(deflection)));
        [
            area,
            0.5 * self.prestretch / root * area + of(&|change| change.prestretch * root),
            area / self.thickness - of(&|change| change.log_thickness / self.thickness_at(deflection)),
            rest + self.rest_capacitance * self.excess_change(deflection, by, change),
        ]
    }

    /// The change of `A_3` / `A_2` at a given deflection. Eq. (5), `R_2` sin(alpha) - (delta - `r_b`) cos(alpha) = `r_b`,
    /// gives the change of alpha; `A_3` / `A_2` depends on cos(alpha) and, besides, on both radii.
    fn area_change_by_geometry(&self, deflection: f64, change: &MembraneChange) -> f64 {
        let (radius, ball) = (self.radius, self.ball_radius);
        let membrane::Angle { cos, versine, .. } = self.angle(deflection);
        let sin = (versine * (1.0 + cos)).sqrt();
        let angle_change =
            (versine * change.ball_radius - sin * change.radius) / (radius * cos + (deflection - ball) * sin);
        let by_radii = 2.0 * ball * versine * versine / (cos * radius * radius)
            * (ball / radius * change.radius - change.ball_radius);
        by_radii - sin * angle_change * membrane::area_slope(radius, ball, cos)
    }

    /// Change of `C_3` / `C_2` - 1 at `deflection`, m, when that changes by `deflection_change`, m.
    pub(crate) fn excess_change(
        &self,
        deflection: f64,
        deflection_change: f64,
        change: Option<&MembraneChange>,
    ) -> f64 {
        let [_, slope] = self.capacitance_excess_and_slope(deflection);
        slope * deflection_change + self.excess_change_by_geometry(deflection, change)
    }

    /// Change of `C_3` / `C_2` - 1 at a given `deflection`, m.
    pub(crate) fn excess_change_by_geometry(&self, deflection: f64, change: Option<&MembraneChange>) -> f64 {
        let by_geometry = |change| 2.0 * self.area_ratio(deflection) * self.area_change_by_geometry(deflection, change);
        change.map_or(0.0, by_geometry)
    }

    /// Change of [`Membrane::excess_of_chatter`] when the first `speed` changes by `speed_change` and the `restitution` by
    /// `restitution_change`.
    pub(crate) fn excess_of_chatter_change(
        &self,
        speed: f64,
        restitution: f64,
        speed_change: f64,
        restitution_change: f64,
        change: Option<&MembraneChange>,
    ) -> f64 {
        let (mut sum, mut speed_change) = (0.0, speed_change);
        let term_change = |speed: f64, speed_change: f64| {
            let peak = self.deflection(speed);
            self.excess_change(peak, self.deflection_change(speed, peak, speed_change, change), change)
        };
        let (speed, excess) = self.bounces(speed, restitution, |speed, _| {
            sum += term_change(speed, speed_change);
            speed_change = restitution * speed_change + restitution_change * speed;
        });
        if excess == 0.0 {
            return sum;
        }
        // The rest is excess / (1 - r^p) with p = 4 / (n + 1).
        let exponent = self.exponent(self.deflection(speed));
        let power = 4.0 / (exponent + 1.0);
        let power_change = -power / (exponent + 1.0) * change.map_or(0.0, |change| change.exponent);
        let ratio = restitution.powf(power);
        let ratio_change = ratio * (power * restitution_change / restitution + restitution.ln() * power_change);
        sum + (term_change(speed, speed_change) + excess * ratio_change / (1.0 - ratio)) / (1.0 - ratio)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Deflection, area, capacitance, stretch, field of one volt and the sum over a chattering sequence, and their changes
    /// when all parameters of the membrane and the speed change at once.
    fn values_and_changes(p: &Parameters, d: &Parameters, speed: f64, speed_change: f64) -> [[f64; 2]; 6] {
        let (membrane, change) = (Membrane::new(p), MembraneChange::new(p, d));
        let change = Some(&change);
        let peak = membrane.deflection(speed);
        let peak_change = membrane.deflection_change(speed, peak, speed_change, change);
        let [area, stretch, field, capacitance] = membrane.shown_changes(peak, peak_change, change);
        let r = p.restitution;
        [
            [peak, peak_change],
            [membrane.area_ratio(peak), area],
            [membrane.capacitance(peak), capacitance],
            [membrane.stretch(peak), stretch],
            [membrane.field(peak, 1.0), field],
            [
                membrane.excess_of_chatter(speed, r),
                membrane.excess_of_chatter_change(speed, r, speed_change, d.restitution, change),
            ],
        ]
    }

    #[test]
    fn changes_agree_with_central_differences() {
        const H: f64 = 1e-4;
        let p = Parameters::default();
        for quantity in Parameters::TABLE {
            let mut d = Parameters::none();
            (quantity.set)(&mut d, (quantity.get)(&p));
            for (speed, speed_change) in [(0.4, 0.0), (0.03, 0.5), (1e-4, 1e-4)] {
                let with = |h: f64| {
                    let mut moved = p;
                    (quantity.set)(&mut moved, (quantity.get)(&p) * (1.0 + h));
                    values_and_changes(&moved, &d, speed + h * speed_change, speed_change).map(|[value, _]| value)
                };
                let (far, near) = ([with(2.0 * H), with(-2.0 * H)], [with(H), with(-H)]);
                for (k, [value, change]) in values_and_changes(&p, &d, speed, speed_change).into_iter().enumerate() {
                    let slope = (8.0 * (near[0][k] - near[1][k]) - (far[0][k] - far[1][k])) / (12.0 * H);
                    assert_relative_eq!(change, slope, max_relative = 1e-6, epsilon = 1e-9 * value);
                }
            }
        }
    }
}
