//! The worker: a process of its own in which ngspice runs, so that a crash of the library costs no more than this
//! process.
//!
//! ngspice takes its own time steps within one transient analysis over the whole run. Its callbacks wait at each
//! communication point for the next [`Ramp`] and clip the step so that it ends there. Breakpoints would do the same, but
//! they restart the integration at order one.

use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap, VecDeque};
use std::ffi::{CStr, c_char, c_int, c_void};
use std::fs::File;
use std::io;
use std::iter;

use super::ledger::ElementLedger;
use super::library::{Callbacks, LibraryError, Ngspice, VectorValue, VectorValues};
use super::listing;
use super::network::Network;
use super::protocol::{Circuit, Job, Ramp, Reply, Request, State, Wanted, build};
use videg_system::messages::send;
use videg_system::worker::{Requests, take_streams};

/// Lines of ngspice that are kept for the message of a failure.
const KEPT_LINES: usize = 12;
/// Most elements of a circuit: the ledger is summed up at each time point.
const MOST_ELEMENTS: usize = 5000;
/// Most lines of a listing that are read: elements and models.
const MOST_LINES: usize = 4 * MOST_ELEMENTS;
/// Longest line that is kept, characters.
const LONGEST_LINE: usize = 300;
/// Time that differs by less than this part of a time step is the same.
const SAME_TIME: f64 = 1e-9;

/// What the callbacks share.
struct Session {
    requests: Requests,
    replies: File,
    job: Job,
    ramp: Ramp,
    wanted: Wanted,
    /// From the listing of the circuit on.
    ledger: Option<ElementLedger>,
    /// Voltages of nodes at 0 s, V, where they are given.
    initial: BTreeMap<String, f64>,
    /// Position in what ngspice sends of the time, each vector of the ledger and each probe; empty before the first time point.
    positions: Vec<usize>,
    /// Their values at the last time point.
    values: Vec<f64>,
    /// The lines of a listing that is being printed.
    listing: Option<Vec<String>>,
    lines: VecDeque<String>,
}

/// Serves one job: takes stdin and stdout of this process, reads the job and what follows, answers, and returns when the requests
/// end or the job has failed.
///
/// # Errors
/// If the streams cannot be taken, or the other side cannot be read or written.
pub fn serve() -> io::Result<()> {
    let (mut requests, mut replies) = take_streams()?;
    let Some(host) = requests.receive::<String>()? else { return Ok(()) };
    if host != build() {
        return send(&mut replies, &Reply::Failure(format!("the worker is of videg {}, and this is {host}", build())));
    }
    let Some(job) = requests.receive::<Job>()? else { return Ok(()) };
    if let Some(bytes) = job.memory {
        limit_memory(bytes)?;
    }
    let library = match Ngspice::load() {
        Ok(library) => library,
        Err(error) => return send(&mut replies, &Reply::Failure(error.to_string())),
    };
    let session = RefCell::new(Session {
        requests,
        replies,
        job,
        ramp: Ramp { from: 0.0, to: 0.0, start: Vec::new(), end: Vec::new() },
        wanted: Wanted::default(),
        ledger: None,
        initial: BTreeMap::new(),
        positions: Vec::new(),
        values: Vec::new(),
        listing: None,
        lines: VecDeque::new(),
    });
    let outcome = load(&library, &session).and_then(|()| {
        let begun = session.borrow_mut().begin().map_err(|error| error.to_string())?;
        if begun { analyse(&library, &session) } else { std::process::exit(0) }
    });
    // ngspice returns only when it cannot go on: the end of the requests ends the process.
    let mut session = session.borrow_mut();
    let reason = outcome.err().unwrap_or_else(|| "the transient analysis ended early".to_owned());
    session.fail(&reason)
}

/// A circuit that swells without end costs no more than this process.
fn limit_memory(bytes: u64) -> io::Result<()> {
    #[cfg(unix)]
    {
        use rustix::process::{Resource, Rlimit, setrlimit};
        setrlimit(Resource::As, Rlimit { current: Some(bytes), maximum: Some(bytes) })?;
    }
    #[cfg(not(unix))]
    let _ = bytes;
    Ok(())
}

/// Loads the circuit and has its elements listed.
fn load(library: &Ngspice, session: &RefCell<Session>) -> Result<(), String> {
    let callbacks =
        Callbacks { text: on_text, exit: on_exit, begin: on_begin, data: on_data, voltage: on_voltage, sync: on_sync };
    // SAFETY: the callbacks take a session of this type, which outlives the library's calls.
    unsafe { library.initialize(callbacks, std::ptr::from_ref(session).cast_mut().cast()) };
    let said = |error: LibraryError| error.to_string();
    let netlist = session.borrow().job.netlist.clone();
    library.circuit(&netlist).map_err(said)?;
    session.borrow_mut().listing = Some(Vec::new());
    library.command("listing expand").map_err(said)?;
    let lines = session.borrow_mut().listing.take().unwrap_or_default();
    let circuit = listing::Circuit::read(lines.iter().map(String::as_str));
    let count = circuit.elements.len();
    if count == 0 {
        return Err("ngspice does not take the netlist".to_owned());
    }
    if count > MOST_ELEMENTS || lines.len() > MOST_LINES {
        return Err(format!("the circuit has more than {MOST_ELEMENTS} elements, the most that are allowed"));
    }
    let network = Network::new(&circuit, !session.borrow().job.commands.is_empty())?;
    let mut session = session.borrow_mut();
    if session.job.from_initial_conditions {
        session.initial = circuit.initial;
    }
    let voltage = |node: &str| session.initial.get(node).copied().unwrap_or_default();
    let ledger = ElementLedger::new(network, session.job.is_trapezoidal, voltage);
    session.ledger = Some(ledger);
    Ok(())
}

fn analyse(library: &Ngspice, session: &RefCell<Session>) -> Result<(), String> {
    let commands = session.borrow().commands();
    commands.iter().try_for_each(|command| library.command(command)).map_err(|error| error.to_string())
}

impl Session {
    /// The commands from the circuit to the end.
    fn commands(&self) -> Vec<String> {
        let Job { longest_step, stop, from_initial_conditions, commands, .. } = &self.job;
        let parameters =
            self.vectors().filter(|name| name.starts_with('@')).fold(String::new(), |all, name| all + " " + name);
        let start = if *from_initial_conditions { " uic" } else { "" };
        let mut all = commands.clone();
        // Time points go to the callback; kept, they would fill the memory. Parameters of elements must be named.
        all.push(format!("save none{parameters}"));
        all.push(format!("tran {longest_step:e} {stop:e} 0 {longest_step:e}{start}"));
        all
    }

    /// The vectors that ngspice has to send, after the time.
    fn vectors(&self) -> impl Iterator<Item = &str> {
        let ledger = self.ledger.iter().flat_map(|ledger| &ledger.network().vectors);
        ledger.chain(&self.wanted.probes).map(String::as_str)
    }

    /// Tells of the circuit and takes what is wanted; whether anything is.
    fn begin(&mut self) -> io::Result<bool> {
        let circuit = self.ledger.as_ref().map(|ledger| {
            let network = ledger.network();
            Circuit {
                elements: network.accounts.clone(),
                nodes: network.nodes.iter().map(|&node| network.vectors[node].clone()).collect(),
                unread: network.unread().collect(),
            }
        });
        if let Some(circuit) = circuit {
            send(&mut self.replies, &Reply::Circuit(circuit))?;
        }
        let Some(Request::Wanted(wanted)) = self.requests.receive()? else { return Ok(false) };
        self.ramp = Ramp { from: 0.0, to: 0.0, start: wanted.start.clone(), end: wanted.start.clone() };
        self.wanted = wanted;
        Ok(true)
    }

    /// Reports that it cannot go on, with the last words of ngspice.
    fn fail(&mut self, reason: &str) -> io::Result<()> {
        let said = self.lines.iter().map(String::as_str).collect::<Vec<_>>().join(" | ");
        let text = if said.is_empty() { reason.to_owned() } else { format!("{reason}; ngspice said: {said}") };
        send(&mut self.replies, &Reply::Failure(text))
    }

    fn keep(&mut self, line: &str) {
        let line = line.trim_start_matches("stdout ").trim_start_matches("stderr ").trim();
        if let Some(listing) = &mut self.listing {
            return if listing.len() <= MOST_LINES {
                listing.push(line.to_owned());
            };
        }
        // What ngspice says of itself is no complaint.
        if line.is_empty() || ["**", "Note: No compat", "Circuit: "].iter().any(|own| line.starts_with(own)) {
            return;
        }
        if self.lines.len() == KEPT_LINES {
            self.lines.pop_front();
        }
        self.lines.push_back(line.chars().take(LONGEST_LINE).collect());
    }

    /// Takes the vectors of an accepted time point.
    ///
    /// # Safety
    /// `all` is what ngspice sends.
    unsafe fn accept(&mut self, all: &VectorValues) -> Result<(), String> {
        let count = usize::try_from(all.count).unwrap_or(0);
        // SAFETY: ngspice sends `count` pointers to vectors.
        let vectors = unsafe { std::slice::from_raw_parts(all.values, count) };
        if self.positions.is_empty() {
            // SAFETY: the vectors are those that ngspice sends.
            self.positions = unsafe { self.locate(vectors) }?;
        }
        self.values.clear();
        for &position in &self.positions {
            let vector = vectors.get(position).ok_or("ngspice sent fewer vectors than before")?;
            // SAFETY: ngspice sends valid pointers.
            let value = unsafe { (**vector).real };
            if !value.is_finite() {
                return Err(format!("a vector is {value} after {} s", self.ramp.from));
            }
            self.values.push(value);
        }
        if let (Some(ledger), [time, values @ ..]) = (&mut self.ledger, self.values.as_slice()) {
            ledger.add(*time, values);
        }
        Ok(())
    }

    /// Finds the vectors in what ngspice sends.
    ///
    /// # Safety
    /// `vectors` are what ngspice sends.
    unsafe fn locate(&self, vectors: &[*const VectorValue]) -> Result<Vec<usize>, String> {
        // SAFETY: ngspice sends zero-terminated names.
        let name =
            |&vector: &*const VectorValue| unsafe { CStr::from_ptr((*vector).name) }.to_string_lossy().to_lowercase();
        let found: HashMap<_, _> =
            vectors.iter().enumerate().map(|(position, vector)| (name(vector), position)).collect();
        let place = |wanted: &str| {
            // A node whose name begins with a digit is called V(1).
            let place = found.get(wanted).or_else(|| found.get(&format!("v({wanted})")));
            place.copied().ok_or_else(|| format!("the circuit has no vector {wanted}"))
        };
        iter::once("time").chain(self.vectors()).map(place).collect()
    }

    /// The circuit at the last time point.
    fn state(&self) -> State {
        let Some(ledger) = &self.ledger else { return State::default() };
        let count = self.wanted.probes.len();
        // ngspice does not tell the first time point of a run with initial conditions.
        let initial = |probe: &String| self.initial.get(probe).copied().unwrap_or_default();
        let probes = match self.values.len().checked_sub(count) {
            Some(first) if !self.values.is_empty() => self.values[first..].to_vec(),
            _ => self.wanted.probes.iter().map(initial).collect(),
        };
        let groups = self.wanted.groups.iter().map(|group| ledger.group(group)).collect();
        State { membranes: ledger.membranes(), groups, probes }
    }

    /// Answers requests up to the next ramp; whether there is one.
    fn next_ramp(&mut self) -> io::Result<bool> {
        loop {
            match self.requests.receive()? {
                Some(Request::Energies) => {
                    let energies = self.ledger.as_ref().map_or_else(Vec::new, |ledger| ledger.energies().to_vec());
                    send(&mut self.replies, &Reply::Energies(energies))?;
                }
                Some(Request::Ramp(ramp)) => {
                    self.ramp = ramp;
                    return Ok(true);
                }
                Some(Request::Wanted(_)) | None => return Ok(false),
            }
        }
    }

    /// The step that ngspice may take at `time` when it wants `step`, s. None ends the process.
    fn clip(&mut self, time: f64, step: f64) -> io::Result<Option<f64>> {
        while self.ramp.to - time <= SAME_TIME * self.job.longest_step {
            let state = self.state();
            send(&mut self.replies, &Reply::Reached(state))?;
            if !self.next_ramp()? {
                return Ok(None);
            }
        }
        let left = self.ramp.to - time;
        // A corner of a source at the communication point may be a rounding error before it.
        if (left - step).abs() <= SAME_TIME * self.job.longest_step {
            return Ok(Some(step));
        }
        // Halved when the rest would be a sliver: a step far shorter than its neighbours costs accuracy.
        Ok(Some(if step >= left {
            left
        } else if 2.0 * step > left {
            left / 2.0
        } else {
            step
        }))
    }
}

/// The session behind the pointer that ngspice hands back.
///
/// # Safety
/// `user` is the pointer given to [`Ngspice::initialize`] by [`analyse`].
unsafe fn session<'a>(user: *mut c_void) -> &'a RefCell<Session> {
    // SAFETY: as the caller promises.
    unsafe { &*user.cast_const().cast() }
}

unsafe extern "C" fn on_text(text: *const c_char, _: c_int, user: *mut c_void) -> c_int {
    // SAFETY: ngspice hands back the session, and a zero-terminated string.
    let (session, text) = unsafe { (session(user), CStr::from_ptr(text)) };
    if let Ok(mut session) = session.try_borrow_mut() {
        session.keep(&text.to_string_lossy());
    }
    0
}

unsafe extern "C" fn on_exit(status: c_int, _: bool, _: bool, _: c_int, user: *mut c_void) -> c_int {
    // SAFETY: ngspice hands back the session.
    if let Ok(mut session) = unsafe { session(user) }.try_borrow_mut() {
        // Nobody is left to be told if this fails.
        let _ = session.fail(&format!("ngspice gave up with status {status}"));
    }
    std::process::exit(1)
}

unsafe extern "C" fn on_begin(_: *const c_void, _: c_int, _: *mut c_void) -> c_int {
    0
}

unsafe extern "C" fn on_data(all: *const VectorValues, _: c_int, _: c_int, user: *mut c_void) -> c_int {
    // SAFETY: ngspice hands back the session, and what it documents to send.
    let (session, all) = unsafe { (session(user), &*all) };
    let Ok(mut session) = session.try_borrow_mut() else { return 1 };
    // SAFETY: as above.
    if let Err(reason) = unsafe { session.accept(all) } {
        let _ = session.fail(&reason);
        std::process::exit(1);
    }
    0
}

unsafe extern "C" fn on_voltage(value: *mut f64, time: f64, name: *const c_char, _: c_int, user: *mut c_void) -> c_int {
    // SAFETY: ngspice hands back the session, and the name of a source.
    let (session, name) = unsafe { (session(user), CStr::from_ptr(name)) };
    let Ok(session) = session.try_borrow() else { return 1 };
    let is_named = |source: &String| source.as_bytes().eq_ignore_ascii_case(name.to_bytes());
    let found = session.job.sources.iter().position(is_named).and_then(|index| session.ramp.value(index, time));
    if let Some(found) = found {
        // SAFETY: ngspice waits for the value there.
        unsafe { value.write(found) };
    }
    0
}

unsafe extern "C" fn on_sync(
    time: f64,
    step: *mut f64,
    _: f64,
    _: c_int,
    _: c_int,
    place: c_int,
    user: *mut c_void,
) -> c_int {
    // Only place 0 is ahead of a new step; elsewhere ngspice repeats one with a shorter step.
    if place != 0 {
        return 0;
    }
    // SAFETY: ngspice hands back the session, and its time step.
    let (session, step) = unsafe { (session(user), &mut *step) };
    let Ok(mut session) = session.try_borrow_mut() else { return 0 };
    match session.clip(time, *step) {
        Ok(Some(clipped)) => *step = clipped,
        Ok(None) => std::process::exit(0),
        Err(_) => std::process::exit(1),
    }
    0
}
