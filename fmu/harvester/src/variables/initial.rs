//! Groups of inputs and parameters that initial values depend on (FMI 2.0.4, section 2.2.8), whatever the contact law. A ball that
//! starts on a membrane, or is put on it, may hit it at once or rest on it: then initial values are those after the impact.
//! What shows in the last digits only, as the time of such an impact is rounded, is no dependency.

/// The motion of the cylinder without the external force.
pub(super) const DRIVE: &[&str] = &[
    "cylinder.mass",
    "excitation.amplitude",
    "excitation.frequency",
    "excitation.phase",
    "excitation.phaseNoise",
    "excitation.noiseHold",
    "excitation.noiseModel",
    "excitation.seed",
];

/// Whether the ball hits a membrane at the start or rests on it, how fast, and where it is then.
pub(super) const IMPACT: &[&str] = &[
    DRIVE[0],
    DRIVE[1],
    DRIVE[2],
    DRIVE[3],
    DRIVE[4],
    DRIVE[5],
    DRIVE[6],
    DRIVE[7],
    "cylinder.length",
    "frame.width",
    "ball.radius",
    "initial.cylinderPosition",
    "initial.cylinderVelocity",
    "initial.ballPosition",
    "initial.ballVelocity",
    "initial.outsideGap",
    "contact.law",
    "membrane.restitution",
];

pub(super) const BALL: &[&str] = &["ball.mass"];

/// The capacitance of a flat membrane.
pub(super) const FILM: &[&str] =
    &["membrane.initialRadius", "membrane.initialThickness", "membrane.prestretch", "membrane.relativePermittivity"];

/// Eq. (2).
pub(super) const FORCE_LAW: &[&str] = &["membrane.stiffness", "membrane.stiffnessExponent"];

/// Options of a contact.
pub(super) const OPTIONS: &[&str] = &["contact.electrostaticFeedback", "contact.reaction"];
