//! Work shared among threads: results in order, the first error in order, and progress. A system short of threads gives
//! fewer of them, and the work takes longer. A thread pool of a library would fail then, and would return results only at the end; so
//! these few lines replace it.

use std::collections::BTreeMap;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Condvar, Mutex, PoisonError};
use std::thread::Builder;
use std::time::Duration;

use crate::progress::{Progress, Running};

/// Polling interval of a thread that waits for others.
const POLL: Duration = Duration::from_millis(100);

/// How work is shared.
#[derive(Clone, Copy)]
pub struct Sharing<'a> {
    /// Most threads at once.
    pub threads: usize,
    /// Most results that wait for an earlier one.
    pub ahead: u64,
    /// Whether to begin nothing more.
    pub is_stopped: &'a (dyn Fn() -> bool + Sync),
}

struct Queue<R, E, T> {
    /// The next number to work on.
    next: u64,
    /// End of the numbers to work on.
    end: u64,
    /// The number whose result is handed on next.
    first: u64,
    /// Results that wait for earlier ones.
    waiting: BTreeMap<u64, Result<R, E>>,
    /// None while a thread uses it.
    take: Option<T>,
    error: Option<E>,
}

impl<R, E, T> Queue<R, E, T> {
    fn add(&mut self, number: u64, result: Result<R, E>) {
        if result.is_err() {
            self.end = self.end.min(number);
        }
        self.waiting.insert(number, result);
    }

    /// The results that can be handed on, up to an error.
    fn ready(&mut self) -> Vec<R> {
        let mut results = Vec::new();
        while self.error.is_none()
            && let Some(result) = self.waiting.remove(&self.first)
        {
            self.first += 1;
            match result {
                Ok(result) => results.push(result),
                Err(error) => self.error = Some(error),
            }
        }
        results
    }
}

/// Does `work` for each of `numbers` on several threads, this one among them. During the work `take` gets the results in order, all that
/// are ready at a time. If the work is stopped, items that have begun are finished and taken.
///
/// # Errors
/// The first error in the order of the numbers; the results before it are taken.
pub fn in_order<R: Send, E: Send>(
    numbers: Range<u64>,
    sharing: Sharing<'_>,
    work: impl Fn(u64) -> Result<R, E> + Sync,
    take: impl FnMut(Vec<R>) -> Result<(), E> + Send,
) -> Result<(), E> {
    let Range { start, end } = numbers;
    let queue = Queue { next: start, end, first: start, waiting: BTreeMap::new(), take: Some(take), error: None };
    let (queue, changed) = (Mutex::new(queue), Condvar::new());
    let lock = || queue.lock().unwrap_or_else(PoisonError::into_inner);
    let work_off = || {
        loop {
            let mut held = lock();
            while held.next < held.end && held.next - held.first >= sharing.ahead && !(sharing.is_stopped)() {
                held = changed.wait_timeout(held, POLL).unwrap_or_else(PoisonError::into_inner).0;
            }
            if held.next >= held.end || (sharing.is_stopped)() {
                return;
            }
            let number = held.next;
            held.next += 1;
            drop(held);
            let result = work(number);
            let mut held = lock();
            held.add(number, result);
            // One thread takes results; what comes meanwhile it takes together.
            while let Some(mut take) = held.take.take() {
                let results = held.ready();
                if results.is_empty() {
                    held.take = Some(take);
                    break;
                }
                drop(held);
                changed.notify_all();
                let taken = take(results);
                held = lock();
                held.take = Some(take);
                if let Err(error) = taken {
                    held.end = start;
                    held.error = Some(error);
                }
            }
        }
    };
    let share = || {
        catch_unwind(AssertUnwindSafe(work_off)).unwrap_or_else(|panic| {
            lock().end = start; // the others need not go on
            resume_unwind(panic)
        });
    };
    std::thread::scope(|scope| {
        let most = usize::try_from(end.saturating_sub(start)).unwrap_or(usize::MAX).min(sharing.threads);
        let others: Vec<_> = (1..most).map_while(|_| Builder::new().spawn_scoped(scope, share).ok()).collect();
        share();
        // The end of the scope waits for the work of threads, not for what belongs to each.
        for thread in others {
            thread.join().unwrap_or_else(|panic| resume_unwind(panic));
        }
    });
    queue.into_inner().unwrap_or_else(PoisonError::into_inner).error.map_or(Ok(()), Err)
}

type Work<'a, T, E> = dyn Fn(&dyn Fn(f64)) -> Result<T, E> + Send + Sync + 'a;

/// Something to do.
pub struct Task<'a, T, E> {
    /// For the observer; empty: none.
    name: String,
    work: Box<Work<'a, T, E>>,
}

impl<'a, T, E> Task<'a, T, E> {
    /// A task with a name for the observer; `work` gets a function to tell which part of it is done, from 0 to 1.
    pub fn new(name: impl Into<String>, work: impl Fn(&dyn Fn(f64)) -> Result<T, E> + Send + Sync + 'a) -> Self {
        Self { name: name.into(), work: Box::new(work) }
    }
}

/// Runs `tasks` on all cores, the first ones first; results in the same order. Tasks run to their end even if the observer
/// wants to stop.
///
/// # Errors
/// That of the first task that fails; tasks that have not begun by then are left.
pub fn run<T: Send, E: Send>(tasks: &[Task<'_, T, E>], observer: &dyn Progress) -> Result<Vec<T>, E> {
    let mut results = Vec::with_capacity(tasks.len());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let sharing = Sharing { threads: cores, ahead: u64::MAX, is_stopped: &|| false };
    let (total, at_work) = (tasks.len() as u64, Mutex::new((0, BTreeMap::new())));
    let change = |change: &dyn Fn(&mut u64, &mut BTreeMap<usize, Running>)| {
        let mut held = at_work.lock().unwrap_or_else(PoisonError::into_inner);
        let (done, running) = &mut *held;
        change(done, running);
        let named: Vec<_> = running.values().filter(|task| !task.name.is_empty()).cloned().collect();
        observer.advance(*done, total, &named);
    };
    let work = |number: u64| {
        let index = usize::try_from(number).unwrap_or(usize::MAX);
        let Task { name, work } = &tasks[index];
        let show = |percent| Running { name: name.clone(), percent };
        change(&|_, running| drop(running.insert(index, show(None))));
        let shown = std::cell::Cell::new(None);
        let result = work(&|part| {
            let percent = Some(percent(part));
            if shown.replace(percent) != percent {
                change(&|_, running| drop(running.insert(index, show(percent))));
            }
        });
        change(&|done, running| {
            *done += 1;
            running.remove(&index);
        });
        result
    };
    in_order(0..total, sharing, work, |more| {
        results.extend(more);
        Ok(())
    })?;
    Ok(results)
}

/// Does `work` for each of `items` on all cores; results in the same order.
///
/// # Errors
/// That of the first item that fails.
pub fn map<T: Sync, R: Send, E: Send>(
    items: &[T],
    observer: &dyn Progress,
    work: impl Fn(&T) -> Result<R, E> + Send + Sync,
) -> Result<Vec<R>, E> {
    let work = &work;
    let tasks: Vec<_> = items.iter().map(|item| Task::new("", move |_| work(item))).collect();
    run(&tasks, observer)
}

/// A part, from 0 to 1, in whole percent.
fn percent(part: f64) -> u8 {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // 0 to 100
    let percent = (100.0 * part.clamp(0.0, 1.0)) as u8;
    percent
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;

    fn sharing(ahead: u64) -> Sharing<'static> {
        Sharing { threads: 3, ahead, is_stopped: &|| false }
    }

    #[test]
    fn results_come_in_order_and_none_is_too_far_ahead() {
        let (taken, count) = (AtomicU64::new(0), 200);
        let work = |number: u64| {
            if number.is_multiple_of(17) {
                std::thread::sleep(Duration::from_millis(2));
            }
            // Work is at most eight ahead of the results given to `take`, which may have some of them still.
            assert!(number < taken.load(Ordering::SeqCst) + 16, "{number} is too far ahead");
            Ok::<_, ()>(number)
        };
        let take = |numbers: Vec<u64>| {
            for number in numbers {
                assert_eq!(number, taken.fetch_add(1, Ordering::SeqCst));
            }
            Ok(())
        };
        in_order(0..count, sharing(8), work, take).unwrap();
        assert_eq!(taken.into_inner(), count);
        assert_eq!(map(&[3, 1, 2], &(), |k| Ok::<_, ()>(10 * k)).unwrap(), [30, 10, 20]);
        assert!(map(&[0_i32; 0], &(), |_| Err::<(), ()>(())).unwrap().is_empty());
    }

    #[test]
    fn the_first_error_in_order_ends_the_work_and_what_is_before_it_is_taken() {
        let mut taken = Vec::new();
        let work = |number| match number {
            5 => {
                std::thread::sleep(Duration::from_millis(20));
                Err(5)
            }
            7.. => Err(number),
            _ => Ok(number),
        };
        let ended = in_order(0..1000, sharing(4), work, |numbers| {
            taken.extend(numbers);
            Ok(())
        });
        assert_eq!((ended, taken), (Err(5), vec![0, 1, 2, 3, 4]));
        assert_eq!(in_order(0..1_000_000, sharing(4), Ok::<_, &str>, |_| Err("full")), Err("full"));
    }

    #[test]
    fn what_was_begun_when_it_is_stopped_is_finished_and_taken() {
        let (begun, mut taken) = (AtomicU64::new(0), 0);
        let is_stopped = || begun.load(Ordering::SeqCst) >= 10;
        let work = |_| Ok::<_, ()>(begun.fetch_add(1, Ordering::SeqCst));
        in_order(0..1000, Sharing { is_stopped: &is_stopped, ..sharing(4) }, work, |numbers| {
            taken += numbers.len();
            Ok(())
        })
        .unwrap();
        assert!((10..13).contains(&taken) && taken as u64 == begun.load(Ordering::SeqCst), "{taken}");
    }

    #[test]
    fn nobody_waits_for_a_result_that_does_not_come() {
        let ended = |panics_in_work: bool| {
            let fail = |here: bool| assert!(!here, "as expected");
            let work = |number| {
                fail(panics_in_work && number == 3);
                Ok::<_, ()>(())
            };
            let take = |_| {
                fail(!panics_in_work);
                Ok(())
            };
            catch_unwind(|| in_order(0..1_000_000, sharing(1), work, take)).is_err()
        };
        assert!(ended(true) && ended(false));
    }

    #[test]
    fn tasks_are_named_and_tell_how_far_they_are_once_a_percent() {
        #[derive(Default)]
        struct Log(Mutex<Vec<Option<u8>>>);
        impl Progress for Log {
            fn advance(&self, done: u64, total: u64, running: &[Running]) {
                assert_eq!(total, 1);
                assert!(running.iter().all(|task| task.name == "long"));
                let percent = running.iter().map(|task| task.percent);
                self.0.lock().unwrap().extend(percent.filter(|_| done == 0));
            }
        }
        let log = Log::default();
        let work = |progress: &dyn Fn(f64)| {
            (0..=1000_u32).for_each(|k| progress(f64::from(k) / 1000.0));
            Ok::<_, ()>(())
        };
        run(&[Task::new("long", work)], &log).unwrap();
        let expected: Vec<_> = std::iter::once(None).chain((0..=100).map(Some)).collect();
        assert_eq!(*log.0.lock().unwrap(), expected);
    }
}
