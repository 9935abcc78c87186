//! The writer of `terminalsAndIcons/terminalsAndIcons.xml` of FMI 3.0 (section 2.4.9).

use super::{DescriptionError, document, element, empty, text};
use crate::check::check_fmu;
use crate::slave::Slave;

/// The text of `terminalsAndIcons.xml`: the terminals, and an icon, whose file `terminalsAndIcons/icon.png` the archive must
/// have then.
///
/// # Errors
/// If the variable table has a mistake.
pub fn terminals_and_icons<S: Slave>(icon: bool) -> Result<String, DescriptionError> {
    check_fmu::<S>()?;
    let corners =
        [("x1", "-100"), ("y1", "-100"), ("x2", "100"), ("y2", "100")].map(|(name, at)| (name, at.to_owned()));
    document("fmiTerminalsAndIcons", &[("fmiVersion", "3.0".to_owned())], |xml| {
        if icon {
            element(xml, "GraphicalRepresentation", &[], |xml| empty(xml, "Icon", &corners))?;
        }
        if S::INFO.terminals.is_empty() {
            return Ok(());
        }
        element(xml, "Terminals", &[], |xml| {
            for terminal in S::INFO.terminals {
                let mut attributes = vec![("name", terminal.name.to_owned()), ("matchingRule", "plug".to_owned())];
                attributes.extend(text("description", terminal.description));
                element(xml, "Terminal", &attributes, |xml| {
                    terminal.members.iter().try_for_each(|(member, variable)| {
                        let attributes =
                            [("variableName", *variable), ("memberName", member), ("variableKind", "signal")];
                        empty(xml, "TerminalMemberVariable", &attributes.map(|(name, value)| (name, value.to_owned())))
                    })
                })?;
            }
            Ok(())
        })
    })
}
