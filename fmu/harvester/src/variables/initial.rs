//! Groups of inputs and parameters that initial values depend on (FMI 2.0.4, section 2.2.8), whatever the contact law. A ball that
//! starts on a membrane, or is put on it, may hit it at once or rest on it: then initial values are those after the impact.
//! What shows in the last digits only, as the time of such an impact is rounded, is no dependency.

/// Whether the ball hits a membrane at the start or rests on it, how fast, and where it is then.
pub(super) const IMPACT: &[&str] = &[
    // The motion of cylinder and ball without the external force.
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
    // How and where they begin, and what they meet.
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
