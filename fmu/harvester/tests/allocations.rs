//! Calls that masters make all the time take no memory.
#![allow(clippy::expect_used)] // helpers outside of #[test] functions fail a test, too

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use common::host::Host;
use fmu_export::abi::fmi2CoSimulation;

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

/// The system's memory, counted.
struct Counting;

// SAFETY: everything is left to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.set(COUNT.get() + 1);
        // SAFETY: the caller keeps the contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const STEP: f64 = 1e-3;

/// How often memory is taken meanwhile, by this thread.
fn allocations(body: impl FnOnce()) -> usize {
    let before = COUNT.get();
    body();
    COUNT.get() - before
}

/// A run in which pulses are under way on both membranes, and the number of steps behind it.
fn between_impacts() -> (Host, u32) {
    let host = Host::stepping(&[("initial.ballVelocity", 0.2), ("membrane.restitution", 0.3)]);
    let steps = (0..20_000).find(|k| {
        let time = f64::from(*k) * STEP;
        let is_calm = host.get("impact.nextTime") > time + 60.0 * STEP;
        if host.count("impact.count") > 10 && is_calm {
            return true;
        }
        host.step(time, STEP);
        false
    });
    (host, steps.expect("a stretch without impact"))
}

#[test]
fn steps_without_an_event_take_no_memory() {
    let (host, steps) = between_impacts();
    let impacts = host.count("impact.count");
    let taken = allocations(|| (steps..steps + 50).for_each(|k| host.step(f64::from(k) * STEP, STEP)));
    assert_eq!(host.count("impact.count"), impacts);
    assert_eq!(taken, 0);
}

#[test]
fn a_state_takes_memory_once_and_none_when_it_is_saved_again() {
    let (host, steps) = between_impacts();
    let time = f64::from(steps) * STEP;
    let try_step = || {
        let state = host.save();
        host.step(time, STEP);
        host.restore(state);
        host.free(state);
    };
    // The list of states, the state itself, and the pulses of both membranes in it; then in the one that it replaces.
    assert!(allocations(try_step) <= 4);
    try_step();
    assert_eq!(allocations(|| (0..50).for_each(|_| try_step())), 0);
}

/// A contact of the compliant law holds the motion up to its end, which no copy takes anew.
#[test]
fn a_state_in_a_contact_takes_no_memory_when_it_is_saved_again() {
    const FINE: f64 = 1e-4;
    let host = Host::initializing(fmi2CoSimulation, 0.0, &[("initial.ballVelocity", 0.3)]);
    host.choose("contact.law", 2);
    fmu_host::ok(host.exit_initialization());
    let in_contact = || host.get("left.deflection") + host.get("right.deflection") > 0.0;
    let begin = (0..100_000).find(|k| {
        let inside = in_contact();
        if !inside {
            host.step(f64::from(*k) * FINE, FINE);
        }
        inside
    });
    let begin = f64::from(begin.expect("a contact")) * FINE;
    // From here on the begin of the last step, from which derivatives count, lies in the contact, too.
    host.step(begin, FINE);
    let time = begin + FINE;
    let try_step = || {
        let state = host.save();
        host.step(time, FINE);
        assert!(in_contact());
        host.restore(state);
        host.free(state);
    };
    let reading = allocations(|| assert!(in_contact()));
    try_step();
    try_step();
    assert_eq!(allocations(|| (0..50).for_each(|_| try_step())), 50 * reading);
}
