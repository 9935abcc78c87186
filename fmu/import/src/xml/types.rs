//! The type definitions, read once: however many variables are of a type, its attributes are read once and its texts shared.

use std::collections::HashMap;
use std::sync::Arc;

use super::element::{Element, missing, not_allowed};
use super::{EnumerationItem, EnumerationType, Result};

/// What a variable takes over from its type.
#[derive(Default)]
pub(super) struct SimpleType {
    pub unit: Option<Arc<str>>,
    /// Bounds of a Real.
    pub real: [Option<f64>; 2],
    /// Bounds of an Integer.
    pub integer: [Option<i64>; 2],
    pub is_enumeration: bool,
}

impl SimpleType {
    /// Unit and bounds of a Real.
    fn read_real(&mut self, it: &Element<'_>, place: &str) -> Result<()> {
        self.real = [it.real(place, "min")?, it.real(place, "max")?];
        self.unit = it.attribute("unit")?.map(|unit| shared(place, "unit", unit)).transpose()?.map(Arc::from);
        Ok(())
    }
}

/// Type definitions by name; of those that share one, the first.
pub(super) struct Types(HashMap<String, SimpleType>);

impl Types {
    pub fn read(root: &Element<'_>) -> Result<Self> {
        let mut all = HashMap::new();
        for element in root.list("TypeDefinitions", "SimpleType")? {
            let Some(name) = element.attribute("name")? else { continue };
            if all.contains_key(&name) {
                continue;
            }
            let place = format!("type \"{name}\"");
            let mut simple =
                SimpleType { is_enumeration: element.child("Enumeration")?.is_some(), ..SimpleType::default() };
            if let Some(it) = element.child("Real")? {
                simple.read_real(it, &place)?;
            }
            if let Some(it) = element.child("Integer")? {
                simple.integer = [it.whole(&place, "min")?, it.whole(&place, "max")?];
            }
            all.insert(name, simple);
        }
        Self::read_3(root, &mut all)?;
        Ok(Self(all))
    }

    /// Those of FMI 3.0, whose element is the type itself.
    fn read_3(root: &Element<'_>, all: &mut HashMap<String, SimpleType>) -> Result<()> {
        let Some(list) = root.child("TypeDefinitions")? else { return Ok(()) };
        let elements = list.all_children().filter_map(|it| Some((it.name().strip_suffix("Type")?.to_owned(), it)));
        for (type_name, it) in elements.filter(|(type_name, _)| type_name != "Simple") {
            let Some(name) = it.attribute("name")?.filter(|name| !all.contains_key(name)) else { continue };
            let place = format!("type \"{name}\"");
            let mut simple = SimpleType { is_enumeration: type_name == "Enumeration", ..SimpleType::default() };
            if type_name.starts_with("Float") {
                simple.read_real(it, &place)?;
            } else if type_name.contains("Int") {
                simple.integer = [it.integer(&place, "min")?, it.integer(&place, "max")?];
            }
            all.insert(name, simple);
        }
        Ok(())
    }

    pub fn get(&self, name: Option<&str>) -> Option<&SimpleType> {
        self.0.get(name?)
    }

    /// An error unless `name`, which the variable at `place` declares, is an enumeration.
    pub fn check_enumeration(&self, place: &str, name: &str) -> Result<()> {
        if self.get(Some(name)).is_some_and(|simple| simple.is_enumeration) {
            return Ok(());
        }
        let allowed = format!("an enumeration of TypeDefinitions ({})", self.enumerations().join(", "));
        Err(not_allowed(place, "declaredType", name, &allowed))
    }

    /// Names of the enumerations, sorted.
    fn enumerations(&self) -> Vec<&str> {
        let enumerations = self.0.iter().filter(|(_, simple)| simple.is_enumeration);
        let mut names: Vec<_> = enumerations.map(|(name, _)| name.as_str()).collect();
        names.sort_unstable();
        names
    }
}

/// The enumeration types, in file order.
pub(super) fn enumerations(root: &Element<'_>) -> Result<Vec<EnumerationType>> {
    let mut all = Vec::new();
    let types = root.list("TypeDefinitions", "SimpleType")?;
    for element in types.chain(root.list("TypeDefinitions", "EnumerationType")?) {
        let is_3 = element.name() == "EnumerationType";
        let Some(enumeration) = (if is_3 { Some(element) } else { element.child("Enumeration")? }) else { continue };
        let name = element.required(&element.name(), "name")?;
        let place = format!("enumeration \"{name}\"");
        let items = enumeration.children("Item").map(|item| enumeration_item(item, &place)).collect::<Result<_>>()?;
        all.push(EnumerationType { name, items });
    }
    Ok(all)
}

fn enumeration_item(item: &Element<'_>, place: &str) -> Result<EnumerationItem> {
    let value = item.integer(place, "value")?.ok_or_else(|| missing(place, "value in an Item"))?;
    let name = item.attribute("name")?.ok_or_else(|| missing(place, "name in an Item"))?;
    Ok(EnumerationItem { name: shared(place, "name", name)?, value, description: item.attribute("description")? })
}

/// A text of a type, which is shown with each of its variables.
///
/// # Errors
/// If it is too long for that.
fn shared(place: &str, name: &str, text: String) -> Result<String> {
    const LONGEST: usize = 1024;
    let is_short = text.len() <= LONGEST;
    if is_short { Ok(text) } else { Err(not_allowed(place, name, &text, &format!("at most {LONGEST} bytes"))) }
}
