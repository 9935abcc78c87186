//! Groups of inputs and parameters that initial values depend on (FMI 2.0.4, section 2.2.8), whatever the contact law. A ball that
//! starts on a membrane, or is put on it, may hit it at once or rest on it: then initial values are those after the impact.
//! What shows in the last digits only, as the time of such an impact is rounded, is no dependency.

/// The motion of cylinder and ball without the external force.
const DRIVE: &[&str] = &[
    "cylinder.mass",
    "excitation.amplitude",
    "excitation.frequency",
    "excitation.phase",
    "excitation.phaseNoise",
    "excitation.noiseHold",
    "excitation.noiseModel",
    "excitation.seed",
    "excitation.kind",
    "excitation.acceleration",
    "cylinder.inclination",
    "gravity",
    "ball.friction",
    "cylinder.suspensionStiffness",
    "cylinder.suspensionDamping",
    "ball.mass",
    "contact.reaction",
    "excitation.file",
    "excitation.fileScale",
    "excitation.fileOffset",
    "excitation.fileRepeat",
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
    DRIVE[8],
    DRIVE[9],
    DRIVE[10],
    DRIVE[11],
    DRIVE[12],
    DRIVE[13],
    DRIVE[14],
    DRIVE[15],
    DRIVE[16],
    DRIVE[17],
    DRIVE[18],
    DRIVE[19],
    DRIVE[20],
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

/// The capacitance of a flat membrane.
pub(super) const FILM: &[&str] = &[
    "membrane.initialRadius",
    "membrane.initialThickness",
    "membrane.prestretch",
    "membrane.relativePermittivity",
    "membrane.law",
    "membrane.file",
];

/// Eq. (2), and other laws.
pub(super) const FORCE_LAW: &[&str] = &[
    "membrane.stiffness",
    "membrane.stiffnessExponent",
    "membrane.shearModulus",
    "membrane.stretchLimit",
    "membrane.ogdenModulus1",
    "membrane.ogdenExponent1",
    "membrane.ogdenModulus2",
    "membrane.ogdenExponent2",
    "membrane.ogdenModulus3",
    "membrane.ogdenExponent3",
    "membrane.viscousModulus",
    "membrane.relaxationTime",
];

/// Options of a contact.
pub(super) const OPTIONS: &[&str] = &["contact.electrostaticFeedback"];
