//! Progress on a terminal; silence elsewhere.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::message::{plain, say};
use crate::progress::{Progress, Running};

/// A bar that follows the simulated time. It draws on stderr, and only if that is a terminal.
pub struct TimeBar {
    bar: ProgressBar,
}

impl TimeBar {
    /// A bar with this text.
    pub fn new(message: impl Into<String>) -> Self {
        let bar = ProgressBar::new(1).with_message(plain(&message.into()));
        let style = ProgressStyle::with_template("{msg} [{bar:40}] {percent:>3} %, {eta} left");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
        Self { bar }
    }

    /// Removes the bar.
    pub fn finish(self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for TimeBar {
    fn advance(&self, done: u64, total: u64, _running: &[Running]) {
        self.bar.set_length(total);
        self.bar.set_position(done);
    }
}

/// A bar that follows tasks and names those that run. It draws on stderr, and only if that is a terminal.
pub struct TaskBar {
    bar: ProgressBar,
    name: String,
}

impl TaskBar {
    /// A bar for the tasks of `name`.
    pub fn new(name: String) -> Self {
        let bar = ProgressBar::new(1);
        let style = ProgressStyle::with_template("{prefix} [{bar:20}] {pos}/{len}, {elapsed}: {wide_msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
        tick(&bar, Duration::from_millis(500));
        Self { bar, name }
    }

    /// Removes the bar.
    pub fn finish(self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for TaskBar {
    fn advance(&self, done: u64, total: u64, running: &[Running]) {
        let task = |task: &Running| match task.percent {
            Some(percent) => format!("{} {percent} %", task.name),
            None => task.name.clone(),
        };
        self.bar.set_prefix(self.name.clone());
        self.bar.set_length(total);
        self.bar.set_position(done);
        self.bar.set_message(running.iter().map(task).collect::<Vec<_>>().join(" | "));
    }
}

/// A bar that follows items of unlike length, and the parts of the present one. Where nobody looks at a terminal, a line
/// for each item that is done goes to stderr: it may take minutes.
pub struct ItemBar {
    bar: ProgressBar,
    items: usize,
    begun: AtomicUsize,
}

impl ItemBar {
    /// A bar for so many items.
    pub fn new(items: usize) -> Self {
        let bar = ProgressBar::new(1);
        let style = ProgressStyle::with_template("{prefix} {msg} [{bar:30}] {pos}/{len}, {elapsed}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
        tick(&bar, Duration::from_millis(500));
        Self { bar, items, begun: AtomicUsize::new(0) }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for ItemBar {
    fn begin(&self, name: &str, title: &str) {
        let number = self.begun.fetch_add(1, Ordering::Relaxed) + 1;
        self.bar.set_prefix(format!("{number}/{}", self.items));
        self.bar.set_message(format!("{name}: {title}"));
        self.bar.set_length(1);
        self.bar.set_position(0);
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
        self.bar.set_length(total);
        self.bar.set_position(done);
    }
}

/// A bar that follows runs, their rate and the time that is left.
pub struct RunBar<'a> {
    bar: ProgressBar,
    has_begun: AtomicBool,
    stop: &'a AtomicBool,
}

impl<'a> RunBar<'a> {
    /// A bar for the runs of `name`, which end early when `stop` is set.
    pub fn new(name: &str, stop: &'a AtomicBool) -> Self {
        let bar = ProgressBar::new(1).with_message(plain(name));
        let style = ProgressStyle::with_template(
            "{msg} [{bar:30}] {human_pos}/{human_len} runs, {per_sec}, {elapsed} gone, {eta} left",
        );
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
        Self { bar, has_begun: AtomicBool::new(false), stop }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for RunBar<'_> {
    fn advance(&self, done: u64, total: u64, _running: &[Running]) {
        self.bar.set_length(total);
        self.bar.set_position(done);
        if !self.has_begun.swap(true, Ordering::Relaxed) {
            // Runs that were there from the beginning took no time.
            self.bar.reset_eta();
        }
    }

    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// A spinner for work of unknown length.
pub fn spinner(message: &str) -> ProgressBar {
    let spinner = ProgressBar::new_spinner().with_message(message.to_owned());
    tick(&spinner, Duration::from_millis(100));
    spinner
}

/// Has a bar that is seen move by itself, where the system gives a thread for that: if not, the library would panic.
fn tick(bar: &ProgressBar, every: Duration) {
    if !bar.is_hidden() && std::thread::Builder::new().spawn(|| ()).is_ok() {
        bar.enable_steady_tick(every);
    }
}
