//! Messages between the master's process and the worker: one JSON object a line, numbers with all their digits.

use std::io::{self, BufRead, Read as _, Write};

use serde::{Deserialize, Serialize, de::DeserializeOwned};

use super::ledger::{Group, Membranes};
use super::network::Account;

/// Longest line that is read, bytes: a netlist may take [`crate::ngspice::UserNetlist::LARGEST`].
const LONGEST_LINE: usize = 1 << 22;

/// First line to the worker: the circuit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// Lines of the netlist, the title first, `.end` last.
    pub netlist: Vec<String>,
    /// Names of the external sources, in the order of [`Ramp::start`].
    pub sources: Vec<String>,
    /// Commands before the analysis.
    pub commands: Vec<String>,
    /// Longest time step that ngspice may take, s.
    pub longest_step: f64,
    /// End of the transient analysis, s: beyond the last communication point.
    pub stop: f64,
    /// Begins with the voltages of `.ic`, 0 for other nodes; otherwise with the operating point.
    pub from_initial_conditions: bool,
    /// ngspice integrates by the trapezoidal rule, otherwise by Gear's method of order 2.
    pub is_trapezoidal: bool,
    /// Memory that the worker may take, bytes.
    pub memory: Option<u64>,
}

/// What the worker tells of the circuit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Circuit {
    /// The elements.
    pub elements: Vec<Account>,
    /// Names of the nodes.
    pub nodes: Vec<String>,
    /// Elements of which ngspice does not tell all currents.
    pub unread: Vec<usize>,
}

/// What the master wants to know at each communication point.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Wanted {
    /// Groups of elements, by their place in [`Circuit::elements`].
    pub groups: Vec<Vec<usize>>,
    /// Vectors: nodes and `source#branch`.
    pub probes: Vec<String>,
    /// Values of the external sources at 0 s, V.
    pub start: Vec<f64>,
}

/// Each further line to the worker.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Request {
    /// What is wanted: begin. The second line.
    Wanted(Wanted),
    /// Go on until a communication point.
    Ramp(Ramp),
    /// The energies of all elements so far.
    Energies,
}

/// A step to a communication point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Ramp {
    /// Where it begins: the communication point reached last, s.
    pub from: f64,
    /// The next communication point, s.
    pub to: f64,
    /// Values of the external sources where it begins, V.
    pub start: Vec<f64>,
    /// Values at its end; linear in between, V.
    pub end: Vec<f64>,
}

impl Ramp {
    /// Value of source `index` at `time`, s; beyond the ends that of the end.
    pub fn value(&self, index: usize, time: f64) -> Option<f64> {
        let (start, end) = (*self.start.get(index)?, *self.end.get(index)?);
        let part = if self.to > self.from { (time - self.from) / (self.to - self.from) } else { 1.0 };
        Some(start + (end - start) * part.clamp(0.0, 1.0))
    }
}

/// The circuit at a communication point.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct State {
    /// The membranes.
    pub membranes: Membranes,
    /// The groups.
    pub groups: Vec<Group>,
    /// The probes, V or A.
    pub probes: Vec<f64>,
}

/// Each line from the worker.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reply {
    /// The circuit is loaded.
    Circuit(Circuit),
    /// The communication point asked for is reached.
    Reached(State),
    /// Energies that the elements took so far, J.
    Energies(Vec<f64>),
    /// It cannot go on, and why.
    Failure(String),
}

/// A message as a line.
pub fn line(message: &impl Serialize) -> io::Result<Vec<u8>> {
    let mut line = serde_json::to_vec(message)?;
    line.push(b'\n');
    Ok(line)
}

/// Takes the first message out of `bytes`, if it is complete.
pub fn take<T: DeserializeOwned>(bytes: &mut Vec<u8>) -> io::Result<Option<T>> {
    let Some(end) = bytes.iter().position(|&byte| byte == b'\n') else {
        return if bytes.len() < LONGEST_LINE { Ok(None) } else { Err(io::Error::other("a line without end")) };
    };
    let message = serde_json::from_slice(&bytes[..end])?;
    bytes.drain(..=end);
    Ok(Some(message))
}

/// Writes a message.
pub fn send(writer: &mut impl Write, message: &impl Serialize) -> io::Result<()> {
    writer.write_all(&line(message)?)?;
    writer.flush()
}

/// Reads a message; none if the other side has closed.
pub fn receive<T: DeserializeOwned>(reader: &mut impl BufRead) -> io::Result<Option<T>> {
    let mut line = Vec::new();
    reader.take(LONGEST_LINE as u64).read_until(b'\n', &mut line)?;
    if line.is_empty() {
        return Ok(None);
    }
    Ok(Some(serde_json::from_slice(&line)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_arrive_with_all_their_bits() {
        let values: Vec<f64> = vec![0.1 + 0.2, 1e-300, -5e-324, f64::MAX, f64::EPSILON];
        let mut bytes = Vec::new();
        send(&mut bytes, &Reply::Energies(values.clone())).unwrap();
        assert_eq!(receive::<Reply>(&mut bytes.as_slice()).unwrap(), Some(Reply::Energies(values)));
    }

    #[test]
    fn messages_are_taken_one_by_one_and_whole() {
        let replies = [Reply::Energies(vec![0.1]), Reply::Failure("two\nlines".to_owned())];
        let mut bytes = replies.iter().flat_map(|reply| line(reply).unwrap()).collect::<Vec<_>>();
        let last = bytes.pop().unwrap();
        assert_eq!(take(&mut bytes).unwrap().as_ref(), Some(&replies[0]));
        assert_eq!(take::<Reply>(&mut bytes).unwrap(), None);
        bytes.push(last);
        assert_eq!(take(&mut bytes).unwrap().as_ref(), Some(&replies[1]));
        assert!(bytes.is_empty());
    }

    #[test]
    fn the_end_of_the_stream_is_no_message_and_garbage_or_an_endless_line_an_error() {
        assert_eq!(receive::<Reply>(&mut &b""[..]).unwrap(), None);
        let endless = vec![b'['; 12 << 20];
        for garbage in [&b"\n"[..], b"{}\n", b"{\"energies\":[null]}\n", b"{\"energies\":[1", &endless] {
            let mut reader = garbage;
            assert!(receive::<Reply>(&mut reader).is_err());
            assert!(garbage.len() < 100 || reader.len() >= 8 << 20, "it was read to its end");
            let mut bytes = garbage.to_vec();
            let is_cut = !garbage.ends_with(b"\n") && garbage.len() < LONGEST_LINE;
            assert_eq!(take::<Reply>(&mut bytes).is_ok_and(|reply| reply.is_none()), is_cut);
        }
    }

    #[test]
    fn a_ramp_is_linear_and_ends_at_its_ends() {
        let ramp = Ramp { from: 1.0, to: 3.0, start: vec![10.0], end: vec![20.0] };
        for (time, expected) in [(0.5, 10.0), (1.0, 10.0), (1.5, 12.5), (3.0, 20.0), (4.0, 20.0)] {
            assert_eq!(ramp.value(0, time), Some(expected));
        }
        assert_eq!(ramp.value(1, 2.0), None);
    }
}
