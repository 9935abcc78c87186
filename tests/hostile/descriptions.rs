//! Model descriptions that lie, swell or climb.

use super::sandbox::{Input, refused};
use super::toy::{DESCRIPTION, library_name, zipped};

fn check(what: &'static str, description: impl AsRef<[u8]>) -> Input {
    let archive = zipped(&[("modelDescription.xml", description.as_ref()), (&library_name(), b"x")]);
    refused(what, &["fmu", "check", "toy.fmu"], vec![("toy.fmu", archive)])
}

fn with(from: &str, to: &str) -> String {
    assert!(DESCRIPTION.contains(from), "{from}");
    DESCRIPTION.replacen(from, to, 1)
}

const LAUGHS: &str = "?><!DOCTYPE x [<!ENTITY a \"ha\"><!ENTITY b \"&a;&a;&a;&a;\"><!ENTITY c \"&b;&b;&b;&b;\">]>";
const FILE: &str = "?><!DOCTYPE x [<!ENTITY a SYSTEM \"file:///etc/passwd\">]>";

/// 5000 variables of a type whose unit has a million letters: 5 GB, were each to have a copy.
fn shared_unit() -> String {
    let unit = "u".repeat(1_000_000);
    let types =
        format!("<TypeDefinitions><SimpleType name=\"R\"><Real unit=\"{unit}\"/></SimpleType></TypeDefinitions>");
    let variable =
        |k| format!("<ScalarVariable name=\"u{k}\" valueReference=\"{k}\"><Real declaredType=\"R\"/></ScalarVariable>");
    let variables: String = (0..5000).map(variable).collect();
    let typed = with("<LogCategories>", &format!("{types}<LogCategories>"));
    typed.replacen("</ModelVariables>", &format!("{variables}</ModelVariables>"), 1)
}

/// All of them.
pub fn inputs() -> Vec<Input> {
    let attributes = (0..300_000).fold(String::new(), |all, k| all + &format!(" a{k}=''"));
    let variables = format!("<ModelVariables>{}</ModelVariables>", "<ScalarVariable/>".repeat(1_600_000));
    let deep = format!("<fmiModelDescription fmiVersion=\"2.0\">{}", "<a>".repeat(100_000));
    let identifier = |name: &str| with("modelIdentifier=\"Toy\"", &format!("modelIdentifier=\"{name}\""));
    vec![
        check("entities that swell", with("?>", LAUGHS)),
        check("an entity that reads a file", with("?>", FILE)),
        check("an entity that nobody defined", with("{toy}", "&xxe;")),
        check("elements nested 100,000 deep", deep),
        check(
            "an element with 300,000 attributes",
            with("<ModelVariables>", &format!("<New{attributes}/><ModelVariables>")),
        ),
        check("33 MiB of blanks", [DESCRIPTION, &" ".repeat(33 << 20)].concat()),
        check("1.6 million variables that say nothing", with("<LogCategories>", &variables)),
        check("5000 variables that share a unit of a million letters", shared_unit()),
        check("not UTF-8", b"<fmiModelDescription \xff>".as_slice()),
        check("an element that is not closed", with("</ModelVariables>", "")),
        check("another root element", "<html/>"),
        check("two root elements", [DESCRIPTION, "<fmiModelDescription/>"].concat()),
        check("FMI 3.0", with("fmiVersion=\"2.0\"", "fmiVersion=\"3.0\"")),
        check("an identifier that climbs", identifier("../../canary")),
        check("an absolute identifier", identifier("/bin/sh")),
        check("an identifier with a backslash", identifier("..\\canary")),
        check("an identifier of a million letters", identifier(&"x".repeat(1_000_000))),
        check("an identifier with an end of line", identifier("Toy&#10;rm")),
        check("two variables of one name", with("name=\"gain\"", "name=\"y\"")),
        check("an output that is no variable", with("index=\"1\"", "index=\"99\"")),
        check("a value reference beyond 32 bits", with("valueReference=\"1\"", "valueReference=\"4294967296\"")),
        check("a start value that is no number", with("start=\"1\" min", "start=\"heavy\" min")),
        check("a guid with a zero byte", with("{toy}", "a&#0;b")),
        check("a version that commands the terminal", with("fmiVersion=\"2.0\"", "fmiVersion=\"&#27;[2J\"")),
    ]
}
