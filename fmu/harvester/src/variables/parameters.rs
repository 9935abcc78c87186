//! Rows of the parameters, from the tables of the model.

use fmu_export::{EnumerationType, Variable};
use videg_model::{Choice, Parameters, Quantity};

use crate::harvester::Harvester;

type V = Variable<Harvester>;

static CONTACT_LAW: EnumerationType = EnumerationType {
    name: "ContactLaw",
    description: "Law of the contact between ball and membrane",
    items: &[
        ("impulsive", "An impact takes no time, Eqs. (10) and (11)"),
        ("compliant", "The membrane is a nonlinear spring with losses"),
    ],
};

static EXCITATION_KIND: EnumerationType = EnumerationType {
    name: "ExcitationKind",
    description: "What the excitation prescribes",
    items: &[
        ("force", "The force on the cylinder, Eq. (7)"),
        ("motion", "The acceleration of the cylinder: a shaker moves it, whatever acts on it"),
    ],
};

static MEMBRANE_LAW: EnumerationType = EnumerationType {
    name: "MembraneLaw",
    description: "Force of a membrane over its deflection",
    items: &[
        ("power", "K x^n, Eq. (2)"),
        ("table", "Measured: the table that membrane.file names"),
        ("gent", "Virtual work of a film after Gent: membrane.shearModulus and membrane.stretchLimit"),
        ("ogden", "Virtual work of a film after Ogden: membrane.ogdenModulus and membrane.ogdenExponent 1 to 3"),
    ],
};

static NOISE_MODEL: EnumerationType = EnumerationType {
    name: "NoiseModel",
    description: "How the phase noise of Section 5.2 is read",
    items: &[
        ("held", "A fresh Gaussian sample in each hold interval, as the formula of the paper says"),
        ("wiener", "A Wiener process, sampled at each hold interval"),
    ],
};

static OUTSIDE_GAP: EnumerationType = EnumerationType {
    name: "OutsideGap",
    description: "What a start with abs(z_M - z_m) > s/2 means",
    items: &[
        ("project", "The ball is put on the membrane that it is beyond"),
        ("free", "The ball is free until it has come inside the gap"),
    ],
};

impl AsRef<Parameters> for Harvester {
    fn as_ref(&self) -> &Parameters {
        &self.parameters
    }
}

impl AsMut<Parameters> for Harvester {
    fn as_mut(&mut self) -> &mut Parameters {
        &mut self.parameters
    }
}

const fn real(of: &Quantity<Harvester>) -> V {
    V::parameter(of.name, of.unit, of.start, of.description).min(of.min).max(of.max).access(of.get, of.set)
}

const fn enumeration(of: &Choice<Harvester>, items: &'static EnumerationType) -> V {
    V::enumeration_parameter(of.name, items, of.start, of.description).access(of.get, of.set)
}

const fn real_rows<const N: usize>(table: &[Quantity<Harvester>]) -> [V; N] {
    let mut rows = [real(&table[0]); N];
    let mut k = 1;
    while k < N {
        rows[k] = real(&table[k]);
        k += 1;
    }
    rows
}

const REACTION: Choice<Harvester> = Choice::REACTION;
const FEEDBACK: Choice<Harvester> = Choice::ELECTROSTATIC_FEEDBACK;
const REPEAT: Choice<Harvester> = Choice::FILE_REPEAT;
const SEED: Choice<Harvester> = Choice::SEED;

/// Every real parameter of the model.
static REALS: [V; Parameters::TABLE.len()] = real_rows(Quantity::TABLE);

/// Real parameters from the `first` to the `last` of these names. They are in the table by the release that they came with.
pub(super) const fn reals(first: &str, last: &str) -> &'static [V] {
    rows(&REALS, first, last)
}

/// Parameters that choose or count, in the order of the model.
static CHOICES: [V; Parameters::CHOICES.len()] = [
    V::integer_parameter(SEED.name, SEED.start as i64, SEED.description)
        .access(|slave| slave.parameters.seed.into(), |slave, seed| (SEED.set)(slave, as_i32(seed))),
    enumeration(&Choice::NOISE_MODEL, &NOISE_MODEL),
    enumeration(&Choice::OUTSIDE_GAP, &OUTSIDE_GAP),
    enumeration(&Choice::CONTACT_LAW, &CONTACT_LAW),
    V::boolean_parameter(FEEDBACK.name, FEEDBACK.start != 0, FEEDBACK.description).access(
        |slave| slave.parameters.electrostatic_feedback,
        |slave, on| slave.parameters.electrostatic_feedback = on,
    ),
    V::boolean_parameter(REACTION.name, REACTION.start != 0, REACTION.description)
        .access(|slave| slave.parameters.reaction, |slave, on| slave.parameters.reaction = on),
    enumeration(&Choice::EXCITATION_KIND, &EXCITATION_KIND),
    V::boolean_parameter(REPEAT.name, REPEAT.start != 0, REPEAT.description)
        .access(|slave| slave.parameters.file_repeat, |slave, on| slave.parameters.file_repeat = on),
    enumeration(&Choice::MEMBRANE_LAW, &MEMBRANE_LAW),
];

/// What the bounds of the row let through fits.
fn as_i32(value: i64) -> i32 {
    i32::try_from(value).unwrap_or_default()
}

/// Choices from the `first` to the `last` of these names.
pub(super) const fn choices(first: &str, last: &str) -> &'static [V] {
    rows(&CHOICES, first, last)
}

const fn rows(table: &'static [V], first: &str, last: &str) -> &'static [V] {
    table.split_at(place(table, last) + 1).0.split_at(place(table, first)).1
}

/// Place of the row called `name`. A name that no row has does not compile.
const fn place(table: &[V], name: &str) -> usize {
    let mut place = 0;
    while !is_same(table[place].name(), name) {
        place += 1;
    }
    place
}

const fn is_same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut same = 0;
    while same < a.len() && same < b.len() && a[same] == b[same] {
        same += 1;
    }
    same == a.len() && same == b.len()
}
