//! The parameters of the harvester: name, unit, start value, bounds and meaning of each, in two tables: real numbers, and
//! choices.

use crate::error::ModelError;
use crate::paper::{excitation, gap};

/// Largest rate of a suspension, sqrt(k / M) or c / M, 1/s: it is followed in steps of about one over this.
const MAX_RATE: f64 = 1e5;

/// Shortest relaxation time of a viscous film, s.
const SHORTEST_RELAXATION: f64 = 1e-6;

/// Vacuum permittivity, F/m (CODATA 2022). The paper rounds it to 8.85e-12.
pub const VACUUM_PERMITTIVITY: f64 = 8.854_187_818_8e-12;

/// One real parameter: what a user must know of it, and how to reach it in `P`, the parameters themselves or what holds
/// them.
#[derive(Debug, Clone, Copy)]
pub struct Quantity<P = Parameters> {
    /// Structured name, as the FMU shows it.
    pub name: &'static str,
    /// SI unit; "1" for a pure number.
    pub unit: &'static str,
    /// Start value: Section 4.2 of the paper, with A and r of Fig. 14.
    pub start: f64,
    /// Smallest value allowed.
    pub min: f64,
    /// Largest value allowed.
    pub max: f64,
    /// Symbol and equation of the paper, and meaning.
    pub description: &'static str,
    /// Reads the parameter.
    pub get: fn(&P) -> f64,
    /// Writes the parameter, unchecked.
    pub set: fn(&mut P, f64),
}

/// One parameter that chooses or counts. Its value travels as an integer, as in FMI 2.0: items count from 1, a switch is
/// 0 or 1.
#[derive(Debug, Clone, Copy)]
pub struct Choice<P = Parameters> {
    /// Structured name, as the FMU shows it.
    pub name: &'static str,
    /// Start value.
    pub start: i32,
    /// What it chooses, and where the paper speaks of it.
    pub description: &'static str,
    /// Reads the parameter.
    pub get: fn(&P) -> i32,
    /// Writes the parameter; a number that is no item counts as the last.
    pub set: fn(&mut P, i32),
}

impl Quantity {
    fn check(&self, parameters: &Parameters) -> Result<(), ModelError> {
        let value = (self.get)(parameters);
        // NaN fails the comparison, too.
        if value >= self.min && value <= self.max {
            return Ok(());
        }
        Err(ModelError::Bounds { name: self.name, value, unit: self.unit, min: self.min, max: self.max })
    }
}

macro_rules! parameters {
    (
        $($field:ident: $name:literal, $unit:literal, $start:expr, $min:expr, $max:expr, $description:literal;)*
        @choices $($constant:ident, $choice:ident: $type:ty, $label:literal, $first:literal, $about:literal;)*
    ) => {
        /// Parameters of one harvester. Real ones are listed in [`Parameters::TABLE`], others in [`Parameters::CHOICES`].
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct Parameters {
            $(#[doc = concat!("`", $name, "` in ", $unit, ": ", $description)] pub $field: f64,)*
            $(#[doc = concat!("`", $label, "`: ", $about)] pub $choice: $type,)*
        }

        impl Default for Parameters {
            fn default() -> Self {
                Self { $($field: $start,)* $($choice: Item::of($first),)* }
            }
        }

        impl<P: AsRef<Parameters> + AsMut<Parameters> + 'static> Quantity<P> {
            /// Every real parameter, in the order in which the FMU lists them.
            pub const TABLE: &'static [Self] = &[$(Self {
                name: $name, unit: $unit, start: $start, min: $min, max: $max, description: $description,
                get: |p| p.as_ref().$field, set: |p, value| p.as_mut().$field = value,
            },)*];
        }

        impl<P: AsRef<Parameters> + AsMut<Parameters> + 'static> Choice<P> {
            /// Every parameter that chooses or counts, in the order in which the FMU lists them.
            pub const TABLE: &'static [Self] = &[$(Self::$constant,)*];
            $(
                #[doc = concat!("`", $label, "`")]
                pub const $constant: Self = Self {
                    name: $label, start: $first, description: $about,
                    get: |p| p.as_ref().$choice.item(), set: |p, item| p.as_mut().$choice = Item::of(item),
                };
            )*
        }
    };
}

parameters! {
    cylinder_mass: "cylinder.mass", "kg", 0.1245, 1e-6, 1e6, "M: mass of the outer structure without the ball, Eq. (7)";
    cylinder_length: "cylinder.length", "m", 0.042, 0.0, 100.0, "d: length of the cylinder, Eq. (8)";
    frame_width: "frame.width", "m", 0.006, 0.0, 10.0, "w: width of the frame that holds a membrane, Eq. (8)";
    ball_mass: "ball.mass", "kg", 0.0035, 1e-9, 1e6, "m: mass of the ball, Eq. (9)";
    ball_radius: "ball.radius", "m", 0.005, 1e-6, 1.0, "r_b: radius of the ball, Eq. (4)";
    initial_radius: "membrane.initialRadius", "m", 0.003_15, 1e-6, 1.0, "R_1: radius of the membrane before it is stretched, Table 1";
    initial_thickness: "membrane.initialThickness", "m", 0.001, 1e-9, 0.1, "h_1: thickness of the membrane before it is stretched, Table 1";
    prestretch: "membrane.prestretch", "1", 2.0, 1.0, 20.0, "lambda: radial pre-stretch, R_2 = lambda R_1, Section 2.2";
    relative_permittivity: "membrane.relativePermittivity", "1", 3.4, 1.0, 1e4, "epsilon_r: relative permittivity of the membrane, Eq. (1)";
    stiffness: "membrane.stiffness", "N/m^n", 4.0847e5, 1e-6, 1e15, "K: factor of the force law f = K x^n, Eq. (2)";
    stiffness_exponent: "membrane.stiffnessExponent", "1", 2.6, 1.0, 10.0, "n: exponent of the force law f = K x^n, Eq. (2)";
    restitution: "membrane.restitution", "1", 0.6, 0.0, 1.0, "r: coefficient of restitution, Eq. (11); a pulse of C(t) falls 1/r times slower than it rises, at most 100 times";
    amplitude: "excitation.amplitude", "N", 0.5, 0.0, 1e6, "A: amplitude of the harmonic force on the cylinder, Eq. (7)";
    frequency: "excitation.frequency", "Hz", 2.0, 1e-3, 1e5, "f_0: frequency of the harmonic force, Eq. (7)";
    phase: "excitation.phase", "rad", 0.0, -1e3, 1e3, "Phase of the harmonic force at t = 0; 0 in the paper";
    phase_noise: "excitation.phaseNoise", "rad", 0.0, 0.0, 1e3, "sigma: intensity of the phase noise, D = sigma^2, Section 5.2 (rad/sqrt(s) when read as a Wiener process)";
    noise_hold: "excitation.noiseHold", "s", 1e-5, 1e-9, 1e3, "Time for which one sample xi of the phase noise is held, Section 5.2";
    cylinder_position: "initial.cylinderPosition", "m", 0.0, -1e3, 1e3, "z_M(0): position of the cylinder at the start, Section 4.2";
    cylinder_velocity: "initial.cylinderVelocity", "m/s", 0.0, -1e3, 1e3, "z_M'(0): velocity of the cylinder at the start, Section 4.2";
    ball_position: "initial.ballPosition", "m", 0.0, -1e3, 1e3, "z_m(0): position of the ball at the start, Section 4.2";
    ball_velocity: "initial.ballVelocity", "m/s", 0.0, -1e3, 1e3, "z_m'(0): velocity of the ball at the start, Section 4.2";
    bias_voltage: "biasVoltage", "V", 2000.0, 1e-3, 1e6, "U_in: voltage to which the supply charges the membranes, Eqs. (12) and (13)";
    inclination: "cylinder.inclination", "rad", 0.0, -1.571, 1.571, "beta: inclination of the cylinder's axis, which rises from the left to the right end; 0 in the paper";
    gravity: "gravity", "m/s2", 9.806_65, 0.0, 1e3, "g: acceleration of gravity; acts along an inclined cylinder, and presses the ball on the cylinder for its friction";
    friction: "ball.friction", "1", 0.0, 0.0, 10.0, "mu: coefficient of Coulomb friction between ball and cylinder, static and kinetic; 0 in the paper";
    suspension_stiffness: "cylinder.suspensionStiffness", "N/m", 0.0, 0.0, 1e6, "k: stiffness of the cylinder's suspension, from static equilibrium; 0 in the paper";
    suspension_damping: "cylinder.suspensionDamping", "N.s/m", 0.0, 0.0, 1e4, "c: damping of the cylinder's suspension; 0 in the paper";
    acceleration: "excitation.acceleration", "m/s2", 0.0, 0.0, 1e6, "Amplitude of the cylinder's acceleration, if that is prescribed (excitation.kind = motion)";
    file_scale: "excitation.fileScale", "1", 1.0, -1e6, 1e6, "Factor of the recorded force or acceleration";
    file_offset: "excitation.fileOffset", "s", 0.0, -1e9, 1e9, "Time by which the recorded force or acceleration comes later than its samples say";
    shear_modulus: "membrane.shearModulus", "Pa", 45e3, 1e-3, 1e12, "mu: shear modulus of the film (membrane.law = gent)";
    stretch_limit: "membrane.stretchLimit", "1", 270.0, 1e-3, 1e12, "J: value of 2 L^2 + L^-4 - 3 at which the film is locked, L its stretch in both directions (membrane.law = gent)";
    ogden_modulus_1: "membrane.ogdenModulus1", "Pa", 45e3, -1e12, 1e12, "mu_1: modulus of Ogden's first term, of the sign of its exponent; 0: no such term (membrane.law = ogden)";
    ogden_exponent_1: "membrane.ogdenExponent1", "1", 2.0, -20.0, 20.0, "alpha_1: exponent of Ogden's first term";
    ogden_modulus_2: "membrane.ogdenModulus2", "Pa", 0.0, -1e12, 1e12, "mu_2: modulus of Ogden's second term, likewise";
    ogden_exponent_2: "membrane.ogdenExponent2", "1", 2.0, -20.0, 20.0, "alpha_2: exponent of Ogden's second term";
    ogden_modulus_3: "membrane.ogdenModulus3", "Pa", 0.0, -1e12, 1e12, "mu_3: modulus of Ogden's third term, likewise";
    ogden_exponent_3: "membrane.ogdenExponent3", "1", 2.0, -20.0, 20.0, "alpha_3: exponent of Ogden's third term";
    viscous_modulus: "membrane.viscousModulus", "Pa", 0.0, 0.0, 1e12, "mu_v: shear modulus of a Maxwell branch beside the film (membrane.law = gent or ogden, contact.law = compliant), whose losses take the place of membrane.restitution; 0: none";
    relaxation_time: "membrane.relaxationTime", "s", 0.0, 0.0, 1e9, "tau: relaxation time of the Maxwell branch, at least 1e-6 s; 0: no branch";

    @choices
    SEED, seed: i32, "excitation.seed", 1, "Seed of the phase noise: equal seeds, equal noise";
    NOISE_MODEL, noise_model: NoiseModel, "excitation.noiseModel", 1, "How the phase noise is read, Section 5.2";
    OUTSIDE_GAP, outside_gap: OutsideGap, "initial.outsideGap", 1, "Meaning of a start beyond a membrane, as in Fig. 12";
    CONTACT_LAW, contact_law: ContactLaw, "contact.law", 1, "Law of the contact between ball and membrane, Section 3.2";
    ELECTROSTATIC_FEEDBACK, electrostatic_feedback: bool, "contact.electrostaticFeedback", 0, "The Maxwell force 1/2 U^2 dC/dx of the connected voltages acts on the ball; neglected in Section 2.1";
    REACTION, reaction: bool, "contact.reaction", 0, "The ball acts back on the cylinder, so that impacts keep the momentum; Section 3.2 neglects it: m / M is small";
    EXCITATION_KIND, excitation_kind: ExcitationKind, "excitation.kind", 1, "What is prescribed: the force on the cylinder, Eq. (7), or its acceleration, as a shaker does";
    FILE_REPEAT, file_repeat: bool, "excitation.fileRepeat", 0, "The recording begins again where it ends; otherwise there is nothing after its last sample";
    MEMBRANE_LAW, membrane_law: MembraneLaw, "membrane.law", 1, "Force of a membrane over its deflection: Eq. (2), measured, or that of a film by virtual work";
}

/// What a [`Choice`] chooses.
trait Item: Sized {
    /// Its number.
    fn item(self) -> i32;

    /// What has this number.
    fn of(item: i32) -> Self;
}

impl Item for i32 {
    fn item(self) -> i32 {
        self
    }

    fn of(item: i32) -> Self {
        item
    }
}

impl Item for bool {
    fn item(self) -> i32 {
        i32::from(self)
    }

    fn of(item: i32) -> Self {
        item != 0
    }
}

/// Items in the order of their numbers.
macro_rules! items {
    ($($type:ident: $($item:ident)*, $last:ident;)*) => {$(
        impl Item for $type {
            fn item(self) -> i32 {
                (1..).zip([$(Self::$item,)* Self::$last]).find(|(_, it)| *it == self).map_or(1, |(number, _)| number)
            }

            fn of(item: i32) -> Self {
                (1..).zip([$(Self::$item,)*]).find(|(number, _)| *number == item).map_or(Self::$last, |(_, it)| it)
            }
        }
    )*};
}

items! {
    ExcitationKind: Force, Motion;
    NoiseModel: Held, Wiener;
    OutsideGap: Project, Free;
    ContactLaw: Impulsive, Compliant;
    MembraneLaw: Power Table Gent, Ogden;
}

/// What the excitation prescribes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExcitationKind {
    /// The force on the cylinder, Eq. (7): the paper's.
    Force,
    /// The acceleration of the cylinder: a shaker moves it, whatever acts on it.
    Motion,
}

/// How the phase noise of Section 5.2 is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseModel {
    /// F = A cos(2 pi f0 t + sigma xi), a fresh xi in each hold interval: the paper's formula as it stands.
    Held,
    /// F = A cos(2 pi f0 t + sigma W(t)), W a Wiener process sampled at each hold interval.
    Wiener,
}

/// What a start with `|z_M - z_m| > s/2` means; the paper's Fig. 12 has one and does not say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutsideGap {
    /// The start is taken as it is: the ball is free until it has come inside the gap, and meets membranes from then on.
    Free,
    /// The ball is put on the membrane that it is beyond; all velocities stay.
    Project,
}

/// The law of the contact between ball and membrane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactLaw {
    /// An impact takes no time, Eqs. (10) and (11): the paper's.
    Impulsive,
    /// The membrane is a nonlinear spring with losses, and a contact takes time.
    Compliant,
}

/// The force of a membrane over its deflection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MembraneLaw {
    /// K x^n, Eq. (2): the paper's.
    Power,
    /// Measured: a table.
    Table,
    /// Virtual work of a film after Gent.
    Gent,
    /// Virtual work of a film after Ogden.
    Ogden,
}

impl AsRef<Self> for Parameters {
    fn as_ref(&self) -> &Self {
        self
    }
}

impl AsMut<Self> for Parameters {
    fn as_mut(&mut self) -> &mut Self {
        self
    }
}

impl Parameters {
    /// Every real parameter, in the order in which the FMU lists them.
    pub const TABLE: &'static [Quantity] = Quantity::<Self>::TABLE;

    /// Every parameter that chooses or counts, in the order in which the FMU lists them.
    pub const CHOICES: &'static [Choice] = Choice::<Self>::TABLE;

    /// All real parameters zero: no change of any.
    pub(crate) fn none() -> Self {
        let mut parameters = Self::default();
        for quantity in Self::TABLE {
            (quantity.set)(&mut parameters, 0.0);
        }
        parameters
    }

    /// Whether the phase of the excitation is noisy.
    pub fn is_noisy(&self) -> bool {
        self.phase_noise > 0.0
    }

    /// Checks each parameter against its bounds, and those that depend on each other.
    ///
    /// # Errors
    /// The first parameter that is not finite or out of bounds; `ball.travel` not positive; `membrane.radius` not
    /// greater than `ball.radius` (the ball would not fit through the frame, and Eq. (6) has no solution); feedback without
    /// the compliant law; a suspension beside a prescribed motion, or one too stiff for the cylinder's mass; a Gent film that is
    /// locked when flat; an Ogden film without a stiffness, or with a modulus against the sign of its exponent; a viscous film under
    /// the impulsive law or without a material, or one that relaxes too fast.
    pub fn validate(&self) -> Result<(), ModelError> {
        Self::TABLE.iter().try_for_each(|quantity| quantity.check(self))?;
        self.check_contact()?;
        self.check_mount()?;
        self.check_film()?;
        self.check_viscosity()?;
        exceeds("membrane.radius", self.membrane_radius(), "ball.radius", self.ball_radius)?;
        exceeds("ball.travel", self.travel(), "its lower bound", 0.0)
    }

    /// What an impact that takes no time cannot have.
    fn check_contact(&self) -> Result<(), ModelError> {
        if self.contact_law == ContactLaw::Compliant {
            return Ok(());
        }
        if self.electrostatic_feedback {
            let reason = "an impact that takes no time does no electrical work";
            return Err(ModelError::NeedsCompliantLaw { name: "contact.electrostaticFeedback", reason });
        }
        Ok(())
    }

    /// That the film of a material is one: soft enough to be stretched as it is, and stiff enough to push back.
    fn check_film(&self) -> Result<(), ModelError> {
        match self.membrane_law {
            MembraneLaw::Power | MembraneLaw::Table => Ok(()),
            MembraneLaw::Gent => {
                let square = self.prestretch * self.prestretch;
                let flat = 2.0 * square + 1.0 / (square * square) - 3.0;
                // Closer to the limit than rounding there is no room for a deflection.
                let is_free = flat < self.stretch_limit * (1.0 - 1e-6);
                let locked =
                    ModelError::Locked { limit: self.stretch_limit, prestretch: self.prestretch, invariant: flat };
                if is_free { Ok(()) } else { Err(locked) }
            }
            MembraneLaw::Ogden => self.check_ogden(),
        }
    }

    /// Whether the film has a Maxwell branch.
    pub fn is_viscous(&self) -> bool {
        self.viscous_modulus > 0.0 && self.relaxation_time > 0.0
    }

    /// That a Maxwell branch has a film to be beside, a contact that takes time, and a time in which it can be followed.
    fn check_viscosity(&self) -> Result<(), ModelError> {
        if !self.is_viscous() {
            return Ok(());
        }
        let (modulus, time) = (self.viscous_modulus, self.relaxation_time);
        if self.contact_law != ContactLaw::Compliant || self.material().is_none() {
            return Err(ModelError::NeedsFilm { modulus, time });
        }
        if time < SHORTEST_RELAXATION {
            return Err(ModelError::TooFast { time, least: SHORTEST_RELAXATION });
        }
        Ok(())
    }

    fn check_ogden(&self) -> Result<(), ModelError> {
        /// Pa: as little as a Gent film may have.
        const LEAST: f64 = 1e-3;
        let terms = [
            ("membrane.ogdenModulus1", self.ogden_modulus_1, self.ogden_exponent_1),
            ("membrane.ogdenModulus2", self.ogden_modulus_2, self.ogden_exponent_2),
            ("membrane.ogdenModulus3", self.ogden_modulus_3, self.ogden_exponent_3),
        ];
        if let Some((name, modulus, exponent)) =
            terms.into_iter().find(|(_, modulus, exponent)| modulus * exponent < 0.0)
        {
            return Err(ModelError::OgdenSign { name, modulus, exponent });
        }
        let modulus: f64 = terms.iter().map(|(_, modulus, exponent)| 0.5 * modulus * exponent).sum();
        if modulus >= LEAST { Ok(()) } else { Err(ModelError::NoStiffness { modulus, least: LEAST }) }
    }

    /// Where the ball is at the start, m: on the membrane that it is beyond, if it is put there.
    pub fn initial_ball_position(&self) -> f64 {
        let half = self.travel() / 2.0;
        match self.outside_gap {
            OutsideGap::Free => self.ball_position,
            OutsideGap::Project => {
                self.ball_position.clamp(self.cylinder_position - half, self.cylinder_position + half)
            }
        }
    }

    /// What a shaker that prescribes the motion leaves no room for, and a spring that is too stiff for the cylinder's mass.
    fn check_mount(&self) -> Result<(), ModelError> {
        let suspension = [
            ("cylinder.suspensionStiffness", self.suspension_stiffness, "N/m"),
            ("cylinder.suspensionDamping", self.suspension_damping, "N.s/m"),
        ];
        let is_driven = self.excitation_kind == ExcitationKind::Motion;
        if let Some((name, value, unit)) = suspension.into_iter().find(|(_, value, _)| is_driven && *value > 0.0) {
            return Err(ModelError::NeedsForce { name, value, unit });
        }
        let rates =
            [(self.suspension_stiffness / self.cylinder_mass).sqrt(), self.suspension_damping / self.cylinder_mass];
        for ((name, value, unit), rate) in suspension.into_iter().zip(rates) {
            if rate > MAX_RATE {
                return Err(ModelError::TooStiff {
                    name,
                    value,
                    unit,
                    mass: self.cylinder_mass,
                    rate,
                    limit: MAX_RATE,
                });
            }
        }
        Ok(())
    }

    /// Whether spring or damper hold the cylinder.
    pub fn is_suspended(&self) -> bool {
        self.suspension_stiffness > 0.0 || self.suspension_damping > 0.0
    }

    /// Amplitude of the harmonic part of the cylinder's acceleration, m/s^2: A / M, or what a shaker prescribes.
    pub fn harmonic_acceleration(&self) -> f64 {
        match self.excitation_kind {
            ExcitationKind::Force => self.amplitude / self.cylinder_mass,
            ExcitationKind::Motion => self.acceleration,
        }
    }

    /// g sin(beta), m/s^2: the ball slides down an inclined cylinder, towards its left end if beta > 0.
    pub fn incline(&self) -> f64 {
        self.gravity * self.inclination.sin()
    }

    /// mu g cos(beta), m/s^2: the most that friction accelerates the ball.
    pub fn friction_acceleration(&self) -> f64 {
        // Upright to three digits may be a little beyond upright, where nothing presses the ball on the cylinder.
        self.friction * self.gravity * self.inclination.cos().max(0.0)
    }

    /// m / M if the ball acts back on the cylinder, else 0; nothing slows a shaker.
    pub fn reaction_ratio(&self) -> f64 {
        if self.reaction && self.excitation_kind == ExcitationKind::Force {
            self.ball_mass / self.cylinder_mass
        } else {
            0.0
        }
    }

    /// Mass, kg, whose kinetic energy at the relative speed a membrane takes up, Eq. (10): m, or m M / (m + M) if an impact keeps the
    /// momentum.
    pub(crate) fn impact_mass(&self) -> f64 {
        match self.contact_law {
            ContactLaw::Impulsive => self.ball_mass / (1.0 + self.reaction_ratio()),
            ContactLaw::Compliant => self.ball_mass,
        }
    }

    /// s = d + 2 w - 2 `r_b`, m: the largest distance that the ball moves inside the cylinder (Section 3.2).
    pub fn travel(&self) -> f64 {
        gap::travel(self.cylinder_length, self.frame_width, self.ball_radius)
    }

    /// `R_2` = lambda `R_1`, m (Section 2.2).
    pub fn membrane_radius(&self) -> f64 {
        self.prestretch * self.initial_radius
    }

    /// `h_2` = `h_1` / lambda^2, m (Section 2.2).
    pub fn membrane_thickness(&self) -> f64 {
        self.initial_thickness / (self.prestretch * self.prestretch)
    }

    /// Amplitude of a free cylinder's motion under the harmonic excitation, A / (M (2 pi f0)^2), m (Section 5.1).
    pub fn cylinder_amplitude(&self) -> f64 {
        match self.excitation_kind {
            ExcitationKind::Force => excitation::cylinder_amplitude(self.amplitude, self.cylinder_mass, self.frequency),
            ExcitationKind::Motion => excitation::cylinder_amplitude(self.acceleration, 1.0, self.frequency),
        }
    }

    /// gamma, the cylinder's amplitude over half the ball's travel, Eq. (16).
    pub fn normalized_amplitude(&self) -> f64 {
        excitation::normalized_amplitude(self.cylinder_amplitude(), self.travel() / 2.0)
    }
}

fn exceeds(name: &'static str, value: f64, bound_name: &'static str, bound: f64) -> Result<(), ModelError> {
    if value > bound {
        return Ok(());
    }
    Err(ModelError::Order { name, value, bound_name, bound, unit: "m" })
}
