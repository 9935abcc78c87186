//! One instance of an FMU of FMI 3.0 with its log, and the calls that tests make of it.

#![allow(missing_docs)] // Names say what a helper calls.

use super::{Fmu, Functions};
use core::cell::RefCell;
use core::ffi::CStr;
use core::ptr::{null, null_mut};
use fmu_export::abi::fmi3::*;
use std::rc::Rc;

/// A message that the host was sent.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    pub status: fmi3Status,
    pub category: String,
    pub message: String,
}

/// What the importer is shown within a step, and what it may answer: the time at which it wants the step to end.
pub type Look = Box<dyn FnMut(f64, bool) -> Option<f64>>;

/// What the callbacks find behind their pointer.
#[derive(Default)]
pub struct Environment {
    lines: RefCell<Vec<Line>>,
    look: RefCell<Option<Look>>,
}

impl Environment {
    /// The messages since the last call.
    pub fn lines(&self) -> Vec<Line> {
        self.lines.take()
    }
}

/// How an instance is made.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[allow(clippy::struct_excessive_bools)] // each an argument of its own
pub struct Session {
    pub exchange: bool,
    pub event_mode: bool,
    pub early_return: bool,
    pub looks: bool,
}

impl Session {
    pub const EXCHANGE: Self = Self { exchange: true, event_mode: false, early_return: false, looks: false };
    pub const PLAIN: Self = Self { exchange: false, event_mode: false, early_return: false, looks: false };
    pub const EVENTS: Self = Self { event_mode: true, early_return: true, ..Self::PLAIN };
    pub const LOOKS: Self = Self { looks: true, ..Self::EVENTS };
}

/// An instance, with its log; dropping it frees it.
pub struct Host {
    pub functions: Functions,
    pub instance: fmi3Instance,
    pub session: Session,
    /// Moving a `Box` would end what the pointer of the instance may do.
    environment: Rc<Environment>,
}

unsafe extern "C" fn log(
    environment: fmi3InstanceEnvironment,
    status: fmi3Status,
    category: fmi3String,
    message: fmi3String,
) {
    let text = |text| unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned();
    let line = Line { status, category: text(category), message: text(message) };
    unsafe { &*environment.cast::<Environment>() }.lines.borrow_mut().push(line);
}

unsafe extern "C" fn update(
    environment: fmi3InstanceEnvironment,
    time: fmi3Float64,
    set: fmi3Boolean,
    get: fmi3Boolean,
    finished: fmi3Boolean,
    can_return: fmi3Boolean,
    wants: *mut fmi3Boolean,
    wanted: *mut fmi3Float64,
) {
    assert_eq!((set, get, finished), (fmi3False, fmi3True, fmi3True), "values can be read, not set");
    let environment = unsafe { &*environment.cast::<Environment>() };
    let look = environment.look.borrow_mut().take();
    if let Some(mut look) = look {
        if let Some(time) = look(time, can_return != fmi3False) {
            unsafe { (wants.write(fmi3True), wanted.write(time)) };
        }
        environment.look.borrow_mut().get_or_insert(look);
    }
}

impl Session {
    /// Makes an instance; NULL if it is refused. These variables may be read within steps.
    pub fn instantiate(
        self,
        functions: &Functions,
        name: &CStr,
        token: &CStr,
        environment: &Environment,
        required: &[u32],
    ) -> fmi3Instance {
        let pointer = core::ptr::from_ref(environment).cast_mut().cast();
        let Self { exchange, event_mode, early_return, looks } = self;
        // SAFETY: strings are zero-terminated, and the environment outlives the instance.
        unsafe {
            if exchange {
                let instantiate = functions.fmi3InstantiateModelExchange;
                return instantiate(name.as_ptr(), token.as_ptr(), null(), 0, 1, pointer, Some(log));
            }
            (functions.fmi3InstantiateCoSimulation)(
                name.as_ptr(),
                token.as_ptr(),
                null(),
                0,
                1,
                event_mode.into(),
                early_return.into(),
                required.as_ptr(),
                required.len(),
                pointer,
                Some(log),
                looks.then_some(update as _),
            )
        }
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        unsafe { (self.functions.fmi3FreeInstance)(self.instance) };
    }
}

/// What a step returned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stepped {
    pub status: fmi3Status,
    pub event: bool,
    pub terminate: bool,
    pub early: bool,
    pub time: f64,
}

impl Host {
    /// In state `instantiated`, with these variables to be read within steps.
    pub fn requiring(fmu: &Fmu, session: Session, required: &[u32]) -> Self {
        let environment = Rc::<Environment>::default();
        let instance = session.instantiate(&fmu.functions, c"host", &fmu.token, &environment, required);
        // That an FMU with clocks is made without event mode is logged.
        let lines = environment.lines();
        assert!(!instance.is_null() && lines.iter().all(|line| line.category == "logTolerated"), "{lines:?}");
        Self { functions: fmu.functions, instance, session, environment }
    }

    /// From state `instantiated` past the first event.
    pub fn start(&self) {
        assert_eq!((self.enter_initialization(None), self.exit_initialization()), (fmi3OK, fmi3OK));
        if self.session.exchange {
            self.update();
            assert_eq!(unsafe { (self.functions.fmi3EnterContinuousTimeMode)(self.instance) }, fmi3OK);
        } else if self.session.event_mode {
            assert_eq!(unsafe { (self.functions.fmi3EnterStepMode)(self.instance) }, fmi3OK);
        }
    }

    pub fn enter_initialization(&self, stop: Option<f64>) -> fmi3Status {
        unsafe {
            let (defined, stop) = (stop.is_some().into(), stop.unwrap_or_default());
            (self.functions.fmi3EnterInitializationMode)(self.instance, fmi3False, 0.0, 0.0, defined, stop)
        }
    }

    pub fn exit_initialization(&self) -> fmi3Status {
        unsafe { (self.functions.fmi3ExitInitializationMode)(self.instance) }
    }

    /// The messages since the last call.
    pub fn lines(&self) -> Vec<Line> {
        self.environment.lines()
    }

    /// The one message since the last call, which goes with an error.
    pub fn error(&self) -> String {
        let lines = self.lines();
        assert_eq!(lines.len(), 1, "{lines:?}");
        assert_eq!((lines[0].status, lines[0].category.as_str()), (fmi3Error, "logStatusError"));
        lines[0].message.clone()
    }

    /// What the importer does within steps from now on.
    pub fn on_look(&self, look: impl FnMut(f64, bool) -> Option<f64> + 'static) {
        *self.environment.look.borrow_mut() = Some(Box::new(look));
    }

    pub fn step(&self, t: f64, h: f64) -> Stepped {
        let (mut event, mut terminate, mut early, mut time) = (7, 7, 7, f64::NAN);
        let status = unsafe {
            (self.functions.fmi3DoStep)(
                self.instance,
                t,
                h,
                0,
                &raw mut event,
                &raw mut terminate,
                &raw mut early,
                &raw mut time,
            )
        };
        let is = |flag| flag != 0;
        Stepped { status, event: is(event), terminate: is(terminate), early: is(early), time }
    }

    /// A step that succeeds.
    pub fn stepped(&self, t: f64, h: f64) -> (bool, bool, f64) {
        let stepped = self.step(t, h);
        assert!(stepped.status == fmi3OK && !stepped.terminate, "{stepped:?}, {:?}", self.lines());
        (stepped.event, stepped.early, stepped.time)
    }

    pub fn try_float(&self, reference: u32) -> (fmi3Status, f64) {
        let mut value = f64::NAN;
        (unsafe { (self.functions.fmi3GetFloat64)(self.instance, &raw const reference, 1, &raw mut value, 1) }, value)
    }

    pub fn float(&self, reference: u32) -> f64 {
        let (status, value) = self.try_float(reference);
        assert_eq!(status, fmi3OK, "{:?}", self.lines());
        value
    }

    pub fn set_float(&self, reference: u32, value: f64) -> fmi3Status {
        unsafe { (self.functions.fmi3SetFloat64)(self.instance, &raw const reference, 1, &raw const value, 1) }
    }

    pub fn clock(&self, reference: u32) -> bool {
        let mut value = 7;
        let status = unsafe { (self.functions.fmi3GetClock)(self.instance, &raw const reference, 1, &raw mut value) };
        assert_eq!(status, fmi3OK, "{:?}", self.lines());
        value != 0
    }

    pub fn enter_event_mode(&self) -> fmi3Status {
        unsafe { (self.functions.fmi3EnterEventMode)(self.instance) }
    }

    /// Whether states have changed, and the next event.
    pub fn update(&self) -> (bool, Option<f64>) {
        let (mut flags, mut next) = ([7; 5], f64::NAN);
        let [again, terminate, nominals, values, defined] = &mut flags;
        let status = unsafe {
            (self.functions.fmi3UpdateDiscreteStates)(
                self.instance,
                again,
                terminate,
                nominals,
                values,
                defined,
                &raw mut next,
            )
        };
        assert_eq!((status, flags[0], flags[1], flags[2]), (fmi3OK, 0, 0, 0), "{:?}", self.lines());
        (flags[3] != 0, (flags[4] != 0).then_some(next))
    }

    pub fn save(&self) -> fmi3FMUState {
        let mut state = null_mut();
        assert_eq!(
            unsafe { (self.functions.fmi3GetFMUState)(self.instance, &raw mut state) },
            fmi3OK,
            "{:?}",
            self.lines()
        );
        state
    }

    pub fn restore(&self, state: fmi3FMUState) -> fmi3Status {
        unsafe { (self.functions.fmi3SetFMUState)(self.instance, state) }
    }

    pub fn serialize(&self, state: fmi3FMUState) -> Vec<u8> {
        let mut size = 0;
        assert_eq!(unsafe { (self.functions.fmi3SerializedFMUStateSize)(self.instance, state, &raw mut size) }, fmi3OK);
        let mut bytes = vec![0; size];
        assert_eq!(
            unsafe { (self.functions.fmi3SerializeFMUState)(self.instance, state, bytes.as_mut_ptr(), size) },
            fmi3OK
        );
        bytes
    }

    pub fn deserialize(&self, bytes: &[u8]) -> (fmi3Status, fmi3FMUState) {
        let mut state = null_mut();
        let status = unsafe {
            (self.functions.fmi3DeserializeFMUState)(self.instance, bytes.as_ptr(), bytes.len(), &raw mut state)
        };
        (status, state)
    }
}
