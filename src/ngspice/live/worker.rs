//! The worker: a process of its own in which ngspice runs, so that a crash of the library costs no more than this
//! process.
//!
//! ngspice takes its own time steps within one transient analysis over the whole run. Its callbacks wait at each
//! communication point for the next [`Ramp`] and clip the step so that it ends there. Breakpoints would do the same, but
//! they restart the integration at order one.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::io::{self, BufReader, Write};
use std::iter;

use super::library::{Callbacks, LibraryError, Ngspice, VectorValues};
use super::protocol::{Job, Ramp, Reply, receive, send};

/// Lines of ngspice that are kept for the message of a failure.
const KEPT_LINES: usize = 12;
/// Numbers of accepted time points that are kept before they are sent on.
const MOST_KEPT: usize = 4096;
/// Longest line that is kept, characters.
const LONGEST_LINE: usize = 300;
/// Time that differs by less than this part of a time step is the same.
const SAME_TIME: f64 = 1e-9;

type Requests = BufReader<io::Stdin>;

/// What the callbacks share.
struct Session<W> {
    requests: Requests,
    replies: W,
    job: Job,
    ramp: Ramp,
    /// Position of each vector of the job in what ngspice sends; empty before the first time point.
    positions: Vec<usize>,
    /// Accepted time points that have not been sent yet: time and vectors, point by point.
    points: Vec<f64>,
    lines: VecDeque<String>,
}

/// Serves one job: reads it and the ramps from stdin, answers on `replies`, and returns when stdin ends or the job has
/// failed.
pub fn serve<W: Write>(mut replies: W) -> io::Result<()> {
    let mut requests = BufReader::new(io::stdin());
    let Some(job) = receive::<Job>(&mut requests)? else { return Ok(()) };
    let Some(ramp) = receive::<Ramp>(&mut requests)? else { return Ok(()) };
    let library = match Ngspice::load() {
        Ok(library) => library,
        Err(error) => return send(&mut replies, &Reply::Failure(error.to_string())),
    };
    let (positions, points, lines) = (Vec::new(), Vec::new(), VecDeque::new());
    let session = RefCell::new(Session { requests, replies, job, ramp, positions, points, lines });
    let outcome = analyse(&library, &session);
    // ngspice returns only when it cannot go on: the end of the requests ends the process.
    let mut session = session.borrow_mut();
    let reason = outcome.err().map_or_else(|| "the transient analysis ended early".to_owned(), |e| e.to_string());
    session.fail(&reason)
}

fn analyse<W: Write>(library: &Ngspice, session: &RefCell<Session<W>>) -> Result<(), LibraryError> {
    let callbacks = Callbacks {
        text: on_text::<W>,
        exit: on_exit::<W>,
        begin: on_begin,
        data: on_data::<W>,
        voltage: on_voltage::<W>,
        sync: on_sync::<W>,
    };
    // SAFETY: the callbacks take a session of this type, which outlives the library's calls below.
    unsafe { library.initialize(callbacks, std::ptr::from_ref(session).cast_mut().cast()) };
    let (netlist, analysis) = {
        let job = &session.borrow().job;
        (job.netlist.clone(), format!("tran {0:e} {1:e} 0 {0:e} uic", job.longest_step, job.stop))
    };
    library.circuit(&netlist)?;
    // Time points go to the callback; kept, they would fill the memory.
    library.command("save none")?;
    library.command(&analysis)
}

impl<W: Write> Session<W> {
    /// Reports that it cannot go on, with the last words of ngspice.
    fn fail(&mut self, reason: &str) -> io::Result<()> {
        let said = self.lines.iter().map(String::as_str).collect::<Vec<_>>().join(" | ");
        let text = if said.is_empty() { reason.to_owned() } else { format!("{reason}; ngspice said: {said}") };
        send(&mut self.replies, &Reply::Failure(text))
    }

    fn keep(&mut self, line: &str) {
        let line = line.trim_start_matches("stdout ").trim_start_matches("stderr ").trim();
        if line.is_empty() {
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
            for wanted in iter::once("time").chain(self.job.vectors.iter().map(String::as_str)) {
                let name = internal_name(wanted);
                // SAFETY: the vectors are those that ngspice sends.
                let position = vectors.iter().position(|&vector| unsafe { is_named(vector, &name) });
                self.positions.push(position.ok_or_else(|| format!("the circuit has no vector {wanted}"))?);
            }
        }
        for &position in &self.positions {
            let vector = vectors.get(position).ok_or("ngspice sent fewer vectors than before")?;
            // SAFETY: ngspice sends valid pointers.
            let value = unsafe { (**vector).real };
            if !value.is_finite() {
                return Err(format!("a vector is {value} after {} s", self.ramp.from));
            }
            self.points.push(value);
        }
        if self.points.len() >= MOST_KEPT { self.send_points().map_err(|cause| cause.to_string()) } else { Ok(()) }
    }

    fn send_points(&mut self) -> io::Result<()> {
        send(&mut self.replies, &Reply::Points(std::mem::take(&mut self.points)))
    }

    /// At the communication point: answers and waits for the next ramp; whether there is one.
    fn next_ramp(&mut self) -> io::Result<bool> {
        self.send_points()?;
        send(&mut self.replies, &Reply::Reached)?;
        match receive::<Ramp>(&mut self.requests)? {
            Some(ramp) => self.ramp = ramp,
            None => return Ok(false),
        }
        Ok(true)
    }

    /// The step that ngspice may take at `time` when it wants `step`, s. None ends the process.
    fn clip(&mut self, time: f64, step: f64) -> io::Result<Option<f64>> {
        while self.ramp.to - time <= SAME_TIME * self.job.longest_step {
            if !self.next_ramp()? {
                return Ok(None);
            }
        }
        let left = self.ramp.to - time;
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

/// What the library calls a vector that a netlist calls `v(node)` or `i(source)`.
fn internal_name(vector: &str) -> String {
    let inside = |prefix| vector.strip_prefix(prefix).and_then(|rest| rest.strip_suffix(')'));
    match (inside("v("), inside("i(")) {
        (Some(node), _) => node.to_owned(),
        (_, Some(source)) => format!("{source}#branch"),
        _ => vector.to_owned(),
    }
}

/// # Safety
/// `vector` points to what ngspice sends.
unsafe fn is_named(vector: *const super::library::VectorValue, name: &str) -> bool {
    // SAFETY: as the caller promises.
    let found = unsafe { CStr::from_ptr((*vector).name) };
    found.to_bytes().eq_ignore_ascii_case(name.as_bytes())
}

/// The session behind the pointer that ngspice hands back.
///
/// # Safety
/// `user` is the pointer given to [`Ngspice::initialize`] by [`analyse`].
unsafe fn session<'a, W>(user: *mut c_void) -> &'a RefCell<Session<W>> {
    // SAFETY: as the caller promises.
    unsafe { &*user.cast_const().cast() }
}

unsafe extern "C" fn on_text<W: Write>(text: *const c_char, _: c_int, user: *mut c_void) -> c_int {
    // SAFETY: ngspice hands back the session, and a zero-terminated string.
    let (session, text) = unsafe { (session::<W>(user), CStr::from_ptr(text)) };
    if let Ok(mut session) = session.try_borrow_mut() {
        session.keep(&text.to_string_lossy());
    }
    0
}

unsafe extern "C" fn on_exit<W: Write>(status: c_int, _: bool, _: bool, _: c_int, user: *mut c_void) -> c_int {
    // SAFETY: ngspice hands back the session.
    if let Ok(mut session) = unsafe { session::<W>(user) }.try_borrow_mut() {
        // Nobody is left to be told if this fails.
        let _ = session.fail(&format!("ngspice gave up with status {status}"));
    }
    std::process::exit(1)
}

unsafe extern "C" fn on_begin(_: *const c_void, _: c_int, _: *mut c_void) -> c_int {
    0
}

unsafe extern "C" fn on_data<W: Write>(all: *const VectorValues, _: c_int, _: c_int, user: *mut c_void) -> c_int {
    // SAFETY: ngspice hands back the session, and what it documents to send.
    let (session, all) = unsafe { (session::<W>(user), &*all) };
    let Ok(mut session) = session.try_borrow_mut() else { return 1 };
    // SAFETY: as above.
    if let Err(reason) = unsafe { session.accept(all) } {
        let _ = session.fail(&reason);
        std::process::exit(1);
    }
    0
}

unsafe extern "C" fn on_voltage<W: Write>(
    value: *mut f64,
    time: f64,
    name: *const c_char,
    _: c_int,
    user: *mut c_void,
) -> c_int {
    // SAFETY: ngspice hands back the session, and the name of a source.
    let (session, name) = unsafe { (session::<W>(user), CStr::from_ptr(name)) };
    let Ok(session) = session.try_borrow() else { return 1 };
    let is_named = |source: &String| source.as_bytes().eq_ignore_ascii_case(name.to_bytes());
    let found = session.job.sources.iter().position(is_named).and_then(|index| session.ramp.value(index, time));
    if let Some(found) = found {
        // SAFETY: ngspice waits for the value there.
        unsafe { value.write(found) };
    }
    0
}

unsafe extern "C" fn on_sync<W: Write>(
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
    let (session, step) = unsafe { (session::<W>(user), &mut *step) };
    let Ok(mut session) = session.try_borrow_mut() else { return 0 };
    match session.clip(time, *step) {
        Ok(Some(clipped)) => *step = clipped,
        Ok(None) => std::process::exit(0),
        Err(_) => std::process::exit(1),
    }
    0
}
