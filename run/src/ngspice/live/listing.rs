//! The flattened circuit as ngspice lists it (`listing expand`): one element a line, subcircuits and parameters resolved.

use std::collections::{BTreeMap, BTreeSet};

/// An element of the flattened circuit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Element {
    /// Its name within ngspice, in small letters: `rload`, `d.x1.d2` for one of a subcircuit.
    pub name: String,
    /// Its nodes, as ngspice names them.
    pub nodes: Vec<String>,
    /// The nodes that control a source or a switch.
    pub control: Vec<String>,
    /// Value or model: the word after the nodes.
    pub value: String,
    /// The rest of the line.
    pub rest: String,
}

impl Element {
    /// What it is: the first letter of its name, which is that of the netlist.
    pub fn kind(&self) -> char {
        self.name.chars().next().unwrap_or('?')
    }

    /// Its name as the netlist has it, without the letter that ngspice puts before those of subcircuits.
    pub fn path(&self) -> &str {
        self.name.get(2..).filter(|_| self.name.as_bytes().get(1) == Some(&b'.')).unwrap_or(&self.name)
    }
}

/// The circuit of a listing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Circuit {
    /// The elements, in their order.
    pub elements: Vec<Element>,
    /// Voltages of `.ic`, V, by node.
    pub initial: BTreeMap<String, f64>,
}

impl Circuit {
    /// The circuit of the `lines` that ngspice prints.
    pub fn read<'a>(lines: impl Iterator<Item = &'a str> + Clone) -> Self {
        let cards = lines.filter_map(card);
        let models: BTreeSet<_> =
            cards.clone().filter_map(|card| card.strip_prefix(".model ")?.split_whitespace().next()).collect();
        let mut circuit = Self::default();
        for card in cards {
            if let Some(pairs) = card.strip_prefix(".ic ") {
                circuit.initial.extend(initial_voltages(pairs));
            } else if card.starts_with(|first: char| first.is_ascii_alphabetic()) {
                circuit.elements.extend(element(card, &models));
            }
        }
        circuit
    }
}

/// The card of a line `12 : r1 a b 1k`.
fn card(line: &str) -> Option<&str> {
    let (number, card) = line.split_once(" : ")?;
    number.trim().bytes().all(|byte| byte.is_ascii_digit()).then_some(card.trim())
}

/// `v(a)=1 v(b)=2`, with blanks around the signs.
fn initial_voltages(pairs: &str) -> impl Iterator<Item = (String, f64)> {
    pairs.split("v(").skip(1).filter_map(|pair| {
        let (node, value) = pair.split_once(')')?;
        let value = value.trim().strip_prefix('=')?.split_whitespace().next()?;
        Some((node.trim().to_owned(), number(value)?))
    })
}

/// A number of a netlist, with its suffix.
pub fn number(text: &str) -> Option<f64> {
    const SUFFIXES: [(&str, f64); 10] = [
        ("meg", 1e6),
        ("mil", 25.4e-6),
        ("t", 1e12),
        ("g", 1e9),
        ("k", 1e3),
        ("m", 1e-3),
        ("u", 1e-6),
        ("n", 1e-9),
        ("p", 1e-12),
        ("f", 1e-15),
    ];
    let text = text.to_ascii_lowercase();
    // The longest beginning that is a number: what follows is a suffix and a unit.
    let (value, rest) = (1..=text.len())
        .rev()
        .filter(|&end| text.is_char_boundary(end))
        .find_map(|end| Some((text[..end].parse::<f64>().ok()?, &text[end..])))?;
    let scale = SUFFIXES.iter().find(|(suffix, _)| rest.starts_with(suffix)).map_or(1.0, |(_, scale)| *scale);
    value.is_finite().then_some(value * scale)
}

/// An element from its card; none for a coupling of inductors, which takes no power of its own.
fn element(card: &str, models: &BTreeSet<&str>) -> Option<Element> {
    let words: Vec<_> = card.split_whitespace().collect();
    let (name, rest) = words.split_first()?;
    let most = match name.chars().next()? {
        'k' => return None,
        // Up to their model.
        'q' | 'm' | 'j' | 'z' | 'u' | 'o' | 'p' | 't' | 'y' | 'n' | 'a' => {
            rest.iter().position(|word| models.contains(word)).unwrap_or(rest.len())
        }
        _ => 2,
    };
    let words = |from: usize, to: usize| rest.iter().take(to).skip(from).map(|&word| word.to_owned()).collect();
    // The nodes that control a switch or a source stand between its own and its model or gain.
    let control = match name.chars().next()? {
        's' | 'e' | 'g' => 2,
        _ => 0,
    };
    let after = most + control;
    Some(Element {
        name: (*name).to_owned(),
        nodes: words(0, most),
        control: words(most, after),
        value: rest.get(after).map_or_else(String::new, |&word| word.to_owned()),
        rest: rest.get(after + 1..).unwrap_or_default().join(" "),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LISTING: &str = "* test\n     25 : vin in 0    2.0e+03   \n     26 : d.x1.d1 in x1.m dd\n 19 : g.xr.gcvar de 0 \
                           xr.cvar_int1 0 1\n 9 : q1 c b 0 qn area=2\n 10 : m1 d g s b mn w=1 l=2\n 11 : s1 a b c 0 sw1 on\n \
                           12 : k1 la lb 0.9\n 13 : .model qn npn\n 14 : .model mn nmos(level=1)\n 31 : .ic v(in)=    \
                           2.0e+03     v(x1.m)=2k v( out )=0\n no card : at all\n";

    #[test]
    fn elements_have_names_nodes_and_values_and_initial_voltages_their_nodes() {
        let circuit = Circuit::read(LISTING.lines());
        let shown: Vec<_> = circuit.elements.iter().map(|e| (e.path(), e.nodes.join(" "), e.value.as_str())).collect();
        let expected = [
            ("vin", "in 0", "2.0e+03"),
            ("x1.d1", "in x1.m", "dd"),
            ("xr.gcvar", "de 0", "1"),
            ("q1", "c b 0", "qn"),
            ("m1", "d g s b", "mn"),
            ("s1", "a b", "sw1"),
        ];
        assert_eq!(shown, expected.map(|(name, nodes, value)| (name, nodes.to_owned(), value)));
        assert!(circuit.elements[3].rest == "area=2" && circuit.elements[0].rest.is_empty());
        let initial: Vec<_> = circuit.initial.iter().map(|(node, value)| (node.as_str(), *value)).collect();
        assert_eq!(initial, [("in", 2000.0), ("out", 0.0), ("x1.m", 2000.0)]);
    }

    #[test]
    fn numbers_are_read_as_ngspice_reads_them() {
        for (text, value) in [
            ("1k", 1e3),
            ("2.5meg", 2.5e6),
            ("3MegOhm", 3e6),
            ("1e-3", 1e-3),
            ("15pF", 15e-12),
            ("7V", 7.0),
            ("-1m", -1e-3),
        ] {
            let found = number(text).unwrap();
            assert!((found / value - 1.0).abs() < 1e-15, "{text}: {found}");
        }
        assert_eq!((number("qn"), number(""), number("nan")), (None, None, None));
    }
}
