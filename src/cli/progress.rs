//! Progress bars on stderr. They draw only if that is a terminal, and go when they are dropped.

use std::fmt::Write;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressFinish, ProgressState, ProgressStyle};

use super::format::rate;
use super::message::{plain, say};
use crate::progress::{Progress, Running};

/// Follows the simulated time.
pub struct TimeBar(ProgressBar);

impl TimeBar {
    /// A bar with this text.
    pub fn new(message: &str) -> Self {
        Self(styled("{msg} [{bar:40}] {percent:>3} %, {eta} left").with_message(plain(message)))
    }
}

impl Progress for TimeBar {
    fn advance(&self, done: u64, total: u64, _running: &[Running]) {
        show(&self.0, done, total);
    }
}

/// Follows tasks and names those that run.
pub struct TaskBar(ProgressBar);

impl TaskBar {
    /// A bar for the tasks of `name`.
    pub fn new(name: &str) -> Self {
        let bar = styled("{prefix} [{bar:20}] {pos}/{len}, {elapsed}: {wide_msg}").with_prefix(plain(name));
        Self(ticking(bar, Duration::from_millis(500)))
    }
}

impl Progress for TaskBar {
    fn advance(&self, done: u64, total: u64, running: &[Running]) {
        let task = |task: &Running| match task.percent {
            Some(percent) => format!("{} {percent} %", task.name),
            None => task.name.clone(),
        };
        show(&self.0, done, total);
        self.0.set_message(running.iter().map(task).collect::<Vec<_>>().join(" | "));
    }
}

/// Follows items of unlike length, and the parts of the present one. Without a terminal, a line for each complete item goes to
/// stderr, since it may take minutes.
pub struct ItemBar {
    bar: ProgressBar,
    items: usize,
    begun: AtomicUsize,
}

impl ItemBar {
    /// A bar for this number of items.
    pub fn new(items: usize) -> Self {
        let bar = styled("{prefix} {msg} [{bar:30}] {pos}/{len}, {elapsed}");
        Self { bar: ticking(bar, Duration::from_millis(500)), items, begun: AtomicUsize::new(0) }
    }
}

impl Progress for ItemBar {
    fn begin(&self, name: &str, title: &str) {
        let number = self.begun.fetch_add(1, Ordering::Relaxed) + 1;
        self.bar.set_prefix(format!("{number}/{}", self.items));
        self.bar.set_message(format!("{name}: {title}"));
        show(&self.bar, 0, 1);
    }

    fn end(&self, name: &str, took: Duration) {
        let line = format!("{name} made in {:.1} s", took.as_secs_f64());
        if self.bar.is_hidden() {
            say(&line);
        } else {
            self.bar.println(format!("videg: {line}"));
        }
    }

    fn advance(&self, done: u64, total: u64, _running: &[Running]) {
        show(&self.bar, done, total);
    }
}

/// Follows runs, their rate and the time that is left.
pub struct RunBar<'a> {
    bar: ProgressBar,
    has_begun: AtomicBool,
    stop: &'a AtomicBool,
}

impl<'a> RunBar<'a> {
    /// A bar for the runs of `name`, which end early when `stop` is set.
    pub fn new(name: &str, stop: &'a AtomicBool) -> Self {
        let bar = styled("{msg} [{bar:30}] {human_pos}/{human_len} runs, {rate}/s, {elapsed} gone, {eta} left");
        Self { bar: bar.with_message(plain(name)), has_begun: AtomicBool::new(false), stop }
    }
}

impl Progress for RunBar<'_> {
    fn advance(&self, done: u64, total: u64, _running: &[Running]) {
        show(&self.bar, done, total);
        if !self.has_begun.swap(true, Ordering::Relaxed) {
            // Runs that were there from the beginning took no time.
            self.bar.reset_eta();
        }
    }

    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// A bar with a style that holds the form of its line.
fn styled(template: &str) -> ProgressBar {
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    let written = |state: &ProgressState, out: &mut dyn Write| _ = out.write_str(&rate(state.per_sec()));
    let style = style.with_key("rate", written);
    ProgressBar::new(1).with_style(style.progress_chars("=> ")).with_finish(ProgressFinish::AndClear)
}

fn show(bar: &ProgressBar, done: u64, total: u64) {
    bar.set_length(total);
    bar.set_position(done);
}

/// A spinner for work of unknown length. It goes when this is dropped.
pub struct Spinner;

/// The one that stands on the terminal.
static STANDING: Mutex<Option<ProgressBar>> = Mutex::new(None);

impl Spinner {
    /// A spinner with the name of the `work`.
    pub fn new(work: &'static str) -> Self {
        let spinner = styled("{spinner} {prefix} {wide_msg}").with_prefix(work);
        *Self::standing() = Some(ticking(spinner, Duration::from_millis(100)));
        Self
    }

    /// Shows what the work is at, on the line of the spinner: a line of its own would begin where the spinner ends.
    pub fn tell(part: &str) {
        if let Some(spinner) = &*Self::standing() {
            spinner.set_message(plain(part));
        }
    }

    fn standing() -> MutexGuard<'static, Option<ProgressBar>> {
        STANDING.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Spinner {
    fn drop(&mut self) {
        *Self::standing() = None;
    }
}

/// Redraws a visible bar at intervals, if the system gives a thread for that: without one the library would panic.
fn ticking(bar: ProgressBar, every: Duration) -> ProgressBar {
    if !bar.is_hidden() && std::thread::Builder::new().spawn(|| ()).is_ok() {
        bar.enable_steady_tick(every);
    }
    bar
}
