//! The branches of a circuit, and how the charge is known that flows through each in a time step.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::listing::{Circuit, Element, number};

/// A membrane: its subcircuit has a linear capacitor of this name, and a second one for the rest of C(t).
pub const MEMBRANES: [&str; 2] = ["cvidegleft", "cvidegright"];
/// The sources of C(t).
pub const SOURCES: [&str; 2] = ["vvidegleft", "vvidegright"];
/// What ngspice puts behind the name of a capacitor `Q='...'` for the node whose voltage is its current.
const RATE_NODE: &str = "_int1";

/// What flows from the first to the second node of an element; from a terminal of a transistor it flows to ground.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// Which element it is part of.
    pub element: usize,
    /// Its nodes; none is ground.
    pub nodes: [Option<usize>; 2],
    /// How its charge is known.
    pub flow: Flow,
    /// Voltage across it at the start, V, if that is not the one of its nodes.
    pub start: Option<f64>,
}

/// How the charge of a branch is known. Numbers of vectors are places in [`Network::vectors`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Flow {
    /// C V with the capacitance C, F.
    Capacitor(f64),
    /// C V and the vector `change`; the vector `rate` is the current of the latter.
    Membrane { capacitance: f64, change: usize, rate: usize },
    /// From the current G V with the conductance G, S.
    Conductance(f64),
    /// From the current in a vector.
    Current(usize),
    /// From the current of a diode. ngspice tells that of its last iteration but one, with voltage and conductance there.
    Diode { current: usize, voltage: usize, conductance: usize },
    /// What the other branches of a node leave, by Kirchhoff's law.
    Rest(usize),
    /// Not at all.
    Unknown,
}

impl Flow {
    /// Whether the solution of the circuit gives it without an error of its own.
    fn is_exact(self) -> bool {
        !matches!(self, Self::Diode { .. } | Self::Unknown)
    }
}

/// An element as the user knows it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Account {
    /// Its name: `rload`, `x1.d2`, `xl` for a membrane.
    pub name: String,
    /// First letter of the name that it has in the netlist: `r`, `d`, `x`.
    pub kind: char,
}

/// A circuit as branches between nodes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Network {
    /// Values of elements may differ from those of the listing.
    is_altered: bool,
    /// The elements.
    pub accounts: Vec<Account>,
    /// The branches.
    pub branches: Vec<Branch>,
    /// The vectors that ngspice has to send, nodes among them.
    pub vectors: Vec<String>,
    /// Place in `vectors` of each node.
    pub nodes: Vec<usize>,
    /// The branches of the membranes, left and right.
    pub membranes: [Option<usize>; 2],
    /// Branches by [`Flow::Rest`], in an order in which each follows from those before it.
    pub rests: Vec<usize>,
    /// The branches at each node, with the sign of what leaves it.
    pub at: Vec<Vec<(usize, f64)>>,
}

impl Network {
    /// The branches of `circuit`; the values of the listing count unless commands may have altered them.
    ///
    /// # Errors
    /// A membrane that is there twice, or none at all.
    pub fn new(circuit: &Circuit, is_altered: bool) -> Result<Self, String> {
        let mut network = Self { is_altered, ..Self::default() };
        let names: BTreeSet<_> = circuit.elements.iter().map(|element| element.name.as_str()).collect();
        let nodes: BTreeSet<_> = circuit.elements.iter().filter(|e| e.kind() != 'a').flat_map(|e| &e.nodes).collect();
        for element in &circuit.elements {
            let path = element.path();
            if let Some((subcircuit, side)) = membrane(path) {
                network.membrane(element, subcircuit, side)?;
            } else if !SOURCES.contains(&path) && !is_internal(element, &names) {
                network.element(element, |node| nodes.contains(node));
            }
        }
        if network.membranes == [None; 2] {
            return Err("the circuit has no membrane: neither deg_left nor deg_right is part of it".to_owned());
        }
        network.settle();
        Ok(network)
    }

    /// Names of the membranes' elements that are there, left and right.
    pub fn membrane_names(&self) -> [Option<&str>; 2] {
        self.membranes.map(|branch| branch.map(|branch| self.accounts[self.branches[branch].element].name.as_str()))
    }

    /// Elements of which a branch stays unknown.
    pub fn unread(&self) -> impl Iterator<Item = usize> {
        self.branches.iter().filter(|branch| branch.flow == Flow::Unknown).map(|branch| branch.element)
    }

    fn membrane(&mut self, element: &Element, subcircuit: &str, side: usize) -> Result<(), String> {
        let own = MEMBRANES[side];
        let change = format!("{own}_change");
        if element.path() != format!("{subcircuit}.{own}") {
            // The parts of which ngspice makes the rest of C(t).
            return Ok(());
        }
        if let Some(name) = self.membrane_names()[side] {
            let side = ["deg_left", "deg_right"][side];
            return Err(format!(
                "{side} is in the circuit twice, as {name} and {subcircuit}: one membrane is one capacitor"
            ));
        }
        let change_vector = self.vector(format!("l.{subcircuit}.l{change}#branch"));
        let rate = self.vector(format!("{subcircuit}.{change}{RATE_NODE}"));
        let capacitance = number(&element.value).ok_or("a membrane has no capacitance")?;
        self.membranes[side] = Some(self.branches.len());
        self.accounts.push(Account { name: subcircuit.to_owned(), kind: 'x' });
        let flow = Flow::Membrane { capacitance, change: change_vector, rate };
        self.branch(&element.nodes[0], element.nodes.get(1).map_or("0", String::as_str), flow, None);
        Ok(())
    }

    fn element(&mut self, element: &Element, is_node: impl Fn(&String) -> bool) {
        let name = &element.name;
        let [first, second] = [0, 1].map(|k| element.nodes.get(k).map_or("0", String::as_str));
        let path = element.path();
        // A resistor or capacitor with a formula has become a source.
        let last = path.rsplit('.').next().unwrap_or(path);
        let formula = if matches!(element.kind(), 'g' | 'b') { last.get(1..2) } else { None };
        let (kind, shown) = match formula.and_then(|letter| letter.chars().next()) {
            Some('c') if element.kind() == 'g' && second_of(element).is_some_and(|it| it.ends_with(RATE_NODE)) => {
                ('c', path.replacen(last, &last[1..], 1))
            }
            Some('r') if element.kind() == 'b' && element.rest.contains("reciprocm=") => {
                ('r', path.replacen(last, &last[1..], 1))
            }
            _ => (element.kind(), path.to_owned()),
        };
        self.accounts.push(Account { name: shown, kind });
        let value = number(&element.value).filter(|_| !self.is_altered);
        let plain = value.filter(|_| element.rest.is_empty());
        let of = |parameter: &str| format!("@{name}[{parameter}]");
        let flow = match element.kind() {
            'r' => match plain.filter(|&value| value > 0.0) {
                Some(value) => Flow::Conductance(1.0 / value),
                None => Flow::Current(self.vector(of("i"))),
            },
            'c' => match (plain, value, element.rest.strip_prefix("ic=").map(str::trim)) {
                (Some(value), ..) => Flow::Capacitor(value),
                (None, Some(value), Some(start)) if let Some(start) = number(start) => {
                    return self.branch(first, second, Flow::Capacitor(value), Some(start));
                }
                _ => Flow::Current(self.vector(of("i"))),
            },
            'v' | 'l' | 'e' | 'h' => Flow::Current(self.vector(format!("{name}#branch"))),
            'b' if element.value.starts_with("v=") || element.value == "v" => {
                Flow::Current(self.vector(format!("{name}#branch")))
            }
            'b' | 'f' | 'g' | 's' | 'w' => Flow::Current(self.vector(of("i"))),
            'i' => Flow::Current(self.vector(of("current"))),
            'd' => Flow::Diode {
                current: self.vector(of("id")),
                voltage: self.vector(of("vd")),
                conductance: self.vector(of("gd")),
            },
            'q' => return self.terminals(element, &["ic", "ib", "ie", "is"]),
            'm' | 'j' | 'z' => return self.terminals(element, &["id", "ig", "is", "ib"]),
            _ => {
                let nodes: BTreeSet<_> = element.nodes.iter().map(|it| it.trim_matches(['[', ']', '(', ')'])).collect();
                for node in nodes.into_iter().filter(|&node| is_node(&node.to_owned())) {
                    self.branch(node, "0", Flow::Unknown, None);
                }
                return;
            }
        };
        self.branch(first, second, flow, None);
    }

    /// The currents into the terminals of a transistor.
    fn terminals(&mut self, element: &Element, currents: &[&str]) {
        for (node, current) in element.nodes.iter().zip(currents) {
            let vector = self.vector(format!("@{}[{current}]", element.name));
            self.branch(node, "0", Flow::Current(vector), None);
        }
    }

    fn branch(&mut self, first: &str, second: &str, flow: Flow, start: Option<f64>) {
        let nodes = [self.node(first), self.node(second)];
        let element = self.accounts.len() - 1;
        let index = self.branches.len();
        self.branches.push(Branch { element, nodes, flow, start });
        for (node, sign) in nodes.into_iter().zip([1.0, -1.0]) {
            if let Some(node) = node {
                self.at[node].push((index, sign));
            }
        }
    }

    /// The place of a vector.
    fn vector(&mut self, name: String) -> usize {
        self.vectors.iter().position(|other| *other == name).unwrap_or_else(|| {
            self.vectors.push(name);
            self.vectors.len() - 1
        })
    }

    fn node(&mut self, name: &str) -> Option<usize> {
        if matches!(name, "0" | "gnd") {
            return None;
        }
        let vector = self.vector(name.to_owned());
        let found = self.nodes.iter().position(|&other| other == vector);
        Some(found.unwrap_or_else(|| {
            self.nodes.push(vector);
            self.at.push(Vec::new());
            self.nodes.len() - 1
        }))
    }

    /// Finds the branches that follow from Kirchhoff's law: those that alone at a node are not exact.
    fn settle(&mut self) {
        let mut open: BTreeSet<usize> = (0..self.branches.len()).filter(|&k| !self.is_exact(k)).collect();
        loop {
            let lonely = |at: &Vec<(usize, f64)>| {
                let mut inexact = at.iter().filter(|(branch, _)| open.contains(branch));
                inexact.next().filter(|_| inexact.next().is_none()).map(|(branch, _)| *branch)
            };
            let found = self.at.iter().enumerate().find_map(|(node, at)| Some((node, lonely(at)?)));
            let Some((node, branch)) = found else { break };
            self.branches[branch].flow = Flow::Rest(node);
            self.rests.push(branch);
            open.remove(&branch);
        }
    }

    /// Currents of nonlinear elements are those of the last iteration but one.
    fn is_exact(&self, branch: usize) -> bool {
        let Branch { flow, element, .. } = &self.branches[branch];
        let lags = matches!(flow, Flow::Current(vector) if self.vectors[*vector].starts_with('@'))
            && matches!(self.accounts[*element].kind, 'b' | 'q' | 'm' | 'j' | 'z' | 'c' | 'r');
        let is_resistor = matches!(flow, Flow::Current(vector) if self.vectors[*vector].starts_with("@r"));
        flow.is_exact() && (!lags || is_resistor)
    }
}

/// The subcircuit and the side of a part of a membrane.
fn membrane(path: &str) -> Option<(&str, usize)> {
    let (subcircuit, part) = path.rsplit_once('.')?;
    let part = part.strip_suffix("_change").and_then(|part| part.get(1..)).unwrap_or(part);
    MEMBRANES.iter().position(|own| *own == part).map(|side| (subcircuit, side))
}

/// Whether it is one of the two elements that ngspice adds to a source for a capacitor with a formula: they give each
/// other what they take.
fn is_internal(element: &Element, names: &BTreeSet<&str>) -> bool {
    let node = element.nodes.iter().find(|node| node.ends_with(RATE_NODE));
    let Some(owner) = node.map(|node| node.trim_end_matches(RATE_NODE)) else { return false };
    let last = owner.rsplit('.').next().unwrap_or(owner);
    let prefix = owner.strip_suffix(last).unwrap_or_default();
    let source = if prefix.is_empty() { format!("g{last}") } else { format!("g.{prefix}g{last}") };
    matches!(element.kind(), 'l' | 'b') && names.contains(source.as_str())
}

/// The node that controls a source.
fn second_of(element: &Element) -> Option<&str> {
    element.control.first().map(String::as_str)
}
