//! `OMSimulator`'s annotation on the system: its master and step. Without one it refuses the package; other tools pass it over.

use serde::Serialize;

use super::document::number;

/// Relative tolerance that the master asks of the FMUs for; they need none.
const TOLERANCE: &str = "1e-8";

#[derive(Serialize)]
pub(super) struct Annotations {
    #[serde(rename = "ssc:Annotation")]
    annotation: Annotation,
}

#[derive(Serialize)]
struct Annotation {
    #[serde(rename = "@type")]
    kind: &'static str,
    #[serde(rename = "oms:Annotations")]
    content: Content,
}

#[derive(Serialize)]
struct Content {
    #[serde(rename = "@xmlns:oms")]
    namespace: &'static str,
    #[serde(rename = "oms:SimulationInformation")]
    information: Information,
}

#[derive(Serialize)]
struct Information {
    #[serde(rename = "oms:FixedStepMaster")]
    master: Master,
}

#[derive(Serialize)]
struct Master {
    #[serde(rename = "@description")]
    method: &'static str,
    #[serde(rename = "@stepSize")]
    step: String,
    #[serde(rename = "@relativeTolerance")]
    tolerance: &'static str,
}

impl Annotations {
    /// A master with the fixed `step`, s.
    pub(super) fn new(step: f64) -> Self {
        let master = Master { method: "oms-ma", step: number(step), tolerance: TOLERANCE };
        let content = Content {
            namespace: "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd",
            information: Information { master },
        };
        Self { annotation: Annotation { kind: "org.openmodelica", content } }
    }
}
