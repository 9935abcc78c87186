//! Messages between the master's process and the worker: one JSON object a line, numbers with all their digits.

use std::io::{self, BufRead, Read as _, Write};

use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// Longest line that is read, bytes: a netlist takes some kilobytes.
const LONGEST_LINE: u64 = 1 << 20;

/// First line to the worker: the circuit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// Lines of the netlist, the title first, `.end` last.
    pub netlist: Vec<String>,
    /// Names of the external sources, in the order of [`Ramp::start`].
    pub sources: Vec<String>,
    /// The vectors that each time point holds after the time, in their order, as a netlist names them: `v(node)`, `i(source)`.
    pub vectors: Vec<String>,
    /// Longest time step that ngspice may take, s.
    pub longest_step: f64,
    /// End of the transient analysis, s: beyond the last communication point.
    pub stop: f64,
}

/// Each further line to the worker: go on until a communication point.
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

/// Each line from the worker.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reply {
    /// Time points that ngspice has accepted, one after the other: the time, s, then the vectors of the job.
    Points(Vec<f64>),
    /// The communication point asked for is reached; the last time point sent is there.
    Reached,
    /// It cannot go on, and why.
    Failure(String),
}

/// Writes a message.
pub fn send(writer: &mut impl Write, message: &impl Serialize) -> io::Result<()> {
    let mut line = serde_json::to_vec(message)?;
    line.push(b'\n');
    writer.write_all(&line)?;
    writer.flush()
}

/// Reads a message; none if the other side has closed.
pub fn receive<T: DeserializeOwned>(reader: &mut impl BufRead) -> io::Result<Option<T>> {
    let mut line = Vec::new();
    reader.take(LONGEST_LINE).read_until(b'\n', &mut line)?;
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
        send(&mut bytes, &Reply::Points(values.clone())).unwrap();
        assert_eq!(receive::<Reply>(&mut bytes.as_slice()).unwrap(), Some(Reply::Points(values)));
    }

    #[test]
    fn the_end_of_the_stream_is_no_message_and_garbage_or_an_endless_line_an_error() {
        assert_eq!(receive::<Reply>(&mut &b""[..]).unwrap(), None);
        let endless = vec![b'['; 3 << 20];
        for garbage in [&b"\n"[..], b"{}\n", b"{\"points\":[null]}\n", b"{\"points\":[1", &endless] {
            let mut reader = garbage;
            assert!(receive::<Reply>(&mut reader).is_err());
            assert!(garbage.len() < 100 || reader.len() >= 2 << 20, "it was read to its end");
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
