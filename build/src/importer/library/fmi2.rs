//! An instance of an FMI 2.0 FMU.
#![allow(unsafe_code, reason = "loads a library and calls its C functions")]

use super::interface::Interface;
use super::shared::{
    Completed, LAST_GOOD, LibraryError, Message, Stepped, Update, c_text, check, forget_complaints,
    functions, hear, open, said,
};
use libloading::Library;
use std::cell::RefCell;
use std::ffi::{c_char, c_int, c_uint, c_void};
use std::path::Path;

type Component = *mut c_void;

/// `fmi2CallbackFunctions`. The logger is declared variadic in the standard; its named arguments
/// arrive all the same in a function without the dots, on every platform that this program is built
/// for.
#[repr(C)]
struct Callbacks {
    logger: unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char),
    allocate: unsafe extern "C" fn(usize, usize) -> *mut c_void,
    free: unsafe extern "C" fn(*mut c_void),
    step_finished: *const c_void,
    environment: *mut c_void,
}

type Enter = unsafe extern "C" fn(Component) -> c_int;
type Read = unsafe extern "C" fn(Component, *mut f64, usize) -> c_int;

functions! {
    /// Those of both interfaces.
    struct Functions;
    instantiate: "fmi2Instantiate",
        fn(*const c_char, c_int, *const c_char, *const c_char, *const Callbacks, c_int, c_int) -> Component;
    free: "fmi2FreeInstance", fn(Component) -> ();
    setup: "fmi2SetupExperiment", fn(Component, c_int, f64, f64, c_int, f64) -> c_int;
    enter: "fmi2EnterInitializationMode", fn(Component) -> c_int;
    exit: "fmi2ExitInitializationMode", fn(Component) -> c_int;
    terminate: "fmi2Terminate", fn(Component) -> c_int;
    reset: "fmi2Reset", fn(Component) -> c_int;
    get_real: "fmi2GetReal", fn(Component, *const c_uint, usize, *mut f64) -> c_int;
    get_integer: "fmi2GetInteger", fn(Component, *const c_uint, usize, *mut c_int) -> c_int;
    get_boolean: "fmi2GetBoolean", fn(Component, *const c_uint, usize, *mut c_int) -> c_int;
    set_real: "fmi2SetReal", fn(Component, *const c_uint, usize, *const f64) -> c_int;
    set_integer: "fmi2SetInteger", fn(Component, *const c_uint, usize, *const c_int) -> c_int;
    set_boolean: "fmi2SetBoolean", fn(Component, *const c_uint, usize, *const c_int) -> c_int;
}

functions! {
    /// Those of co-simulation.
    struct Stepping;
    set_derivatives: "fmi2SetRealInputDerivatives",
        fn(Component, *const c_uint, usize, *const c_int, *const f64) -> c_int;
    do_step: "fmi2DoStep", fn(Component, f64, f64, c_int) -> c_int;
    real_status: "fmi2GetRealStatus", fn(Component, c_int, *mut f64) -> c_int;
    boolean_status: "fmi2GetBooleanStatus", fn(Component, c_int, *mut c_int) -> c_int;
}

functions! {
    /// Those of Model Exchange.
    struct Exchange;
    enter_event: "fmi2EnterEventMode", fn(Component) -> c_int;
    update: "fmi2NewDiscreteStates", fn(Component, *mut EventInfo) -> c_int;
    enter_continuous: "fmi2EnterContinuousTimeMode", fn(Component) -> c_int;
    completed: "fmi2CompletedIntegratorStep", fn(Component, c_int, *mut c_int, *mut c_int) -> c_int;
    set_time: "fmi2SetTime", fn(Component, f64) -> c_int;
    set_states: "fmi2SetContinuousStates", fn(Component, *const f64, usize) -> c_int;
    get_states: "fmi2GetContinuousStates", fn(Component, *mut f64, usize) -> c_int;
    get_rates: "fmi2GetDerivatives", fn(Component, *mut f64, usize) -> c_int;
    get_nominals: "fmi2GetNominalsOfContinuousStates", fn(Component, *mut f64, usize) -> c_int;
}

/// `fmi2EventInfo`
#[repr(C)]
#[derive(Default)]
struct EventInfo {
    again: c_int,
    ends: c_int,
    nominals_changed: c_int,
    states_changed: c_int,
    next_defined: c_int,
    next: f64,
}

/// The functions of the interface that an instance is for.
enum Own {
    Stepping(Stepping),
    Exchange(Exchange),
}

/// `fmi2Discard`
const DISCARD: c_int = 2;
/// `fmi2LastSuccessfulTime`
const LAST_SUCCESSFUL_TIME: c_int = 2;
/// `fmi2Terminated`
const TERMINATED: c_int = 3;

/// An instance of an FMU, with its library.
pub struct Slave {
    component: Component,
    functions: Functions,
    own: Own,
    /// Where the logger puts its messages; in a box of its own, because the FMU keeps the address.
    heard: Box<RefCell<Vec<Message>>>,
    /// The standard lets an FMU keep a pointer to them.
    _callbacks: Box<Callbacks>,
    /// Last: nothing of it may be used once it is gone.
    _library: Library,
}

impl Slave {
    /// Loads a library and makes an instance.
    ///
    /// # Errors
    /// [`LibraryError`]
    pub fn new(
        library: &Path,
        guid: &str,
        resources: &str,
        interface: Interface,
        debug_logging: bool,
    ) -> Result<Self, LibraryError> {
        let library = open(library)?;
        // SAFETY: modelDescription.xml says that it is an FMI 2.0 FMU with this interface.
        let (functions, own) = unsafe {
            let own = match interface {
                Interface::CoSimulation => Own::Stepping(Stepping::find(&library)?),
                Interface::ModelExchange => Own::Exchange(Exchange::find(&library)?),
            };
            (Functions::find(&library)?, own)
        };
        let heard = Box::new(RefCell::new(Vec::new()));
        let callbacks = Box::new(Callbacks {
            logger: log,
            allocate: libc_calloc,
            free: libc_free,
            step_finished: std::ptr::null(),
            environment: (&raw const *heard).cast_mut().cast(),
        });
        let [name, guid, resources] = ["urdf2fmu", guid, resources].map(c_text);
        // SAFETY: strings end with a zero and live during the call, the callbacks as long as the
        // instance.
        let component = unsafe {
            (functions.instantiate)(
                name.as_ptr(),
                match interface {
                    Interface::ModelExchange => 0,
                    Interface::CoSimulation => 1,
                },
                guid.as_ptr(),
                resources.as_ptr(),
                &raw const *callbacks,
                0,
                c_int::from(debug_logging),
            )
        };
        if component.is_null() {
            let said = said(&heard.borrow());
            let function = "fmi2Instantiate";
            return Err(LibraryError::Instantiate { function, said });
        }
        Ok(Self {
            component,
            functions,
            own,
            heard,
            _callbacks: callbacks,
            _library: library,
        })
    }

    /// What has been said since the last time.
    pub fn messages(&self) -> Vec<Message> {
        self.heard.take()
    }

    /// How many messages there are since the last time.
    pub fn heard(&self) -> usize {
        self.heard.borrow().len()
    }

    /// Takes back the complaints after so many messages.
    pub fn forget_complaints(&self, since: usize) {
        forget_complaints(&mut self.heard.borrow_mut(), since);
    }

    /// fmi2SetupExperiment
    ///
    /// # Errors
    /// [`LibraryError::Status`], as for all below.
    pub fn setup(
        &mut self,
        tolerance: Option<f64>,
        start: f64,
        stop: Option<f64>,
    ) -> Result<(), LibraryError> {
        let (defined, tolerance) = (c_int::from(tolerance.is_some()), tolerance.unwrap_or(0.0));
        let (ends, stop) = (c_int::from(stop.is_some()), stop.unwrap_or(0.0));
        // SAFETY: the component lives as long as `self`; numbers only. So below.
        let status = unsafe {
            (self.functions.setup)(self.component, defined, tolerance, start, ends, stop)
        };
        self.check("fmi2SetupExperiment", status)
    }

    /// fmi2EnterInitializationMode
    pub fn enter_initialization(&mut self) -> Result<(), LibraryError> {
        // SAFETY: see `setup`.
        let status = unsafe { (self.functions.enter)(self.component) };
        self.check("fmi2EnterInitializationMode", status)
    }

    /// fmi2ExitInitializationMode
    pub fn exit_initialization(&mut self) -> Result<(), LibraryError> {
        // SAFETY: see `setup`.
        let status = unsafe { (self.functions.exit)(self.component) };
        self.check("fmi2ExitInitializationMode", status)
    }

    /// fmi2Terminate
    pub fn terminate(&mut self) -> Result<(), LibraryError> {
        // SAFETY: see `setup`.
        let status = unsafe { (self.functions.terminate)(self.component) };
        self.check("fmi2Terminate", status)
    }

    /// fmi2Reset: as after its making
    pub fn reset(&mut self) -> Result<(), LibraryError> {
        // SAFETY: see `setup`.
        let status = unsafe { (self.functions.reset)(self.component) };
        self.check("fmi2Reset", status)
    }

    /// fmi2DoStep
    pub fn do_step(&mut self, time: f64, step: f64) -> Result<Stepped, LibraryError> {
        let Stepping {
            do_step,
            real_status,
            boolean_status,
            ..
        } = self.stepping("fmi2DoStep")?;
        // SAFETY: see `setup`.
        let status = unsafe { do_step(self.component, time, step, 1) };
        if status != DISCARD {
            return self.check("fmi2DoStep", status).map(|()| Stepped::Done);
        }
        // One that cannot tell has not moved, and does not end the simulation.
        let (mut reached, mut over) = (time, 0);
        // SAFETY: as above; the places live during the calls.
        let [known, told] = unsafe {
            [
                real_status(self.component, LAST_SUCCESSFUL_TIME, &raw mut reached),
                boolean_status(self.component, TERMINATED, &raw mut over),
            ]
        };
        let reached = if known <= LAST_GOOD { reached } else { time };
        Ok(if told <= LAST_GOOD && over != 0 {
            Stepped::Over(reached)
        } else {
            Stepped::Discarded(reached)
        })
    }

    /// fmi2GetReal; `values` is as long as `references`.
    pub fn get_real(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), LibraryError> {
        let n = references.len().min(values.len());
        let get = self.functions.get_real;
        // SAFETY: both arrays have `n` elements. So below.
        let status = unsafe { get(self.component, references.as_ptr(), n, values.as_mut_ptr()) };
        self.check("fmi2GetReal", status)
    }

    /// fmi2GetInteger
    pub fn get_integer(
        &mut self,
        references: &[u32],
        values: &mut [i32],
    ) -> Result<(), LibraryError> {
        let n = references.len().min(values.len());
        let get = self.functions.get_integer;
        // SAFETY: see `get_real`.
        let status = unsafe { get(self.component, references.as_ptr(), n, values.as_mut_ptr()) };
        self.check("fmi2GetInteger", status)
    }

    /// fmi2GetBoolean
    pub fn get_boolean(
        &mut self,
        references: &[u32],
        values: &mut [i32],
    ) -> Result<(), LibraryError> {
        let n = references.len().min(values.len());
        let get = self.functions.get_boolean;
        // SAFETY: see `get_real`.
        let status = unsafe { get(self.component, references.as_ptr(), n, values.as_mut_ptr()) };
        self.check("fmi2GetBoolean", status)
    }

    /// fmi2SetReal
    pub fn set_real(&mut self, references: &[u32], values: &[f64]) -> Result<(), LibraryError> {
        let n = references.len().min(values.len());
        let set = self.functions.set_real;
        // SAFETY: see `get_real`.
        let status = unsafe { set(self.component, references.as_ptr(), n, values.as_ptr()) };
        self.check("fmi2SetReal", status)
    }

    /// fmi2SetInteger
    pub fn set_integer(&mut self, reference: u32, value: i32) -> Result<(), LibraryError> {
        let set = self.functions.set_integer;
        // SAFETY: arrays of one element.
        let status = unsafe { set(self.component, &raw const reference, 1, &raw const value) };
        self.check("fmi2SetInteger", status)
    }

    /// fmi2SetBoolean
    pub fn set_boolean(&mut self, reference: u32, value: bool) -> Result<(), LibraryError> {
        let (set, value) = (self.functions.set_boolean, c_int::from(value));
        // SAFETY: arrays of one element.
        let status = unsafe { set(self.component, &raw const reference, 1, &raw const value) };
        self.check("fmi2SetBoolean", status)
    }

    /// fmi2SetRealInputDerivatives of first order
    pub fn set_slopes(&mut self, references: &[u32], slopes: &[f64]) -> Result<(), LibraryError> {
        let n = references.len().min(slopes.len());
        let orders = vec![1; n];
        let set = self
            .stepping("fmi2SetRealInputDerivatives")?
            .set_derivatives;
        // SAFETY: all three arrays have `n` elements.
        let status = unsafe {
            set(
                self.component,
                references.as_ptr(),
                n,
                orders.as_ptr(),
                slopes.as_ptr(),
            )
        };
        self.check("fmi2SetRealInputDerivatives", status)
    }

    /// fmi2EnterEventMode
    pub fn enter_event_mode(&mut self) -> Result<(), LibraryError> {
        self.enter("fmi2EnterEventMode", |own| own.enter_event)
    }

    /// fmi2NewDiscreteStates
    pub fn update_discrete_states(&mut self) -> Result<Update, LibraryError> {
        let name = "fmi2NewDiscreteStates";
        let update = self.exchange(name)?.update;
        let mut info = EventInfo::default();
        // SAFETY: see `setup`; the place lives during the call. So below.
        let status = unsafe { update(self.component, &raw mut info) };
        self.check(name, status).map(|()| Update {
            again: info.again != 0,
            ends: info.ends != 0,
            next: (info.next_defined != 0).then_some(info.next),
        })
    }

    /// fmi2EnterContinuousTimeMode
    pub fn enter_continuous_time_mode(&mut self) -> Result<(), LibraryError> {
        self.enter("fmi2EnterContinuousTimeMode", |own| own.enter_continuous)
    }

    /// fmi2CompletedIntegratorStep; the importer does not go back before it.
    pub fn completed_step(&mut self) -> Result<Completed, LibraryError> {
        let name = "fmi2CompletedIntegratorStep";
        let completed = self.exchange(name)?.completed;
        let (mut event, mut ends) = (0, 0);
        // SAFETY: see `update_discrete_states`.
        let status = unsafe { completed(self.component, 1, &raw mut event, &raw mut ends) };
        self.check(name, status).map(|()| Completed {
            event: event != 0,
            ends: ends != 0,
        })
    }

    /// fmi2SetTime
    pub fn set_time(&mut self, time: f64) -> Result<(), LibraryError> {
        let set = self.exchange("fmi2SetTime")?.set_time;
        // SAFETY: see `setup`.
        let status = unsafe { set(self.component, time) };
        self.check("fmi2SetTime", status)
    }

    /// fmi2SetContinuousStates
    pub fn set_states(&mut self, states: &[f64]) -> Result<(), LibraryError> {
        let name = "fmi2SetContinuousStates";
        let set = self.exchange(name)?.set_states;
        // SAFETY: the array has the length that is passed with it.
        let status = unsafe { set(self.component, states.as_ptr(), states.len()) };
        self.check(name, status)
    }

    /// fmi2GetContinuousStates
    pub fn get_states(&mut self, states: &mut [f64]) -> Result<(), LibraryError> {
        self.read("fmi2GetContinuousStates", |own| own.get_states, states)
    }

    /// fmi2GetDerivatives
    pub fn get_rates(&mut self, rates: &mut [f64]) -> Result<(), LibraryError> {
        self.read("fmi2GetDerivatives", |own| own.get_rates, rates)
    }

    /// fmi2GetNominalsOfContinuousStates
    pub fn get_nominals(&mut self, nominals: &mut [f64]) -> Result<(), LibraryError> {
        self.read(
            "fmi2GetNominalsOfContinuousStates",
            |own| own.get_nominals,
            nominals,
        )
    }

    fn stepping(&self, name: &'static str) -> Result<Stepping, LibraryError> {
        match self.own {
            Own::Stepping(functions) => Ok(functions),
            Own::Exchange(_) => Err(LibraryError::Missing { name }),
        }
    }

    /// Changes the mode.
    fn enter(&self, name: &'static str, of: fn(&Exchange) -> Enter) -> Result<(), LibraryError> {
        let enter = of(&self.exchange(name)?);
        // SAFETY: see `setup`.
        let status = unsafe { enter(self.component) };
        self.check(name, status)
    }

    /// Reads a number for each continuous state.
    fn read(
        &self,
        name: &'static str,
        of: fn(&Exchange) -> Read,
        numbers: &mut [f64],
    ) -> Result<(), LibraryError> {
        let read = of(&self.exchange(name)?);
        // SAFETY: see `set_states`.
        let status = unsafe { read(self.component, numbers.as_mut_ptr(), numbers.len()) };
        self.check(name, status)
    }

    fn exchange(&self, name: &'static str) -> Result<Exchange, LibraryError> {
        match self.own {
            Own::Exchange(functions) => Ok(functions),
            Own::Stepping(_) => Err(LibraryError::Missing { name }),
        }
    }

    fn check(&self, function: &'static str, status: c_int) -> Result<(), LibraryError> {
        check("fmi2", function, status, &self.heard.borrow())
    }
}

impl Drop for Slave {
    fn drop(&mut self) {
        // SAFETY: made by fmi2Instantiate, freed once; the library is still there.
        unsafe { (self.functions.free)(self.component) };
    }
}

/// The importer's logger.
///
/// # Safety
/// Called by an FMU with the environment that it was given; strings are null or end with a zero.
unsafe extern "C" fn log(
    environment: *mut c_void,
    _instance: *const c_char,
    status: c_int,
    category: *const c_char,
    message: *const c_char,
) {
    // SAFETY: the caller's promise.
    unsafe {
        hear(environment, status, [category, message], |text| {
            text.replace("%%", "%").replace("##", "#")
        });
    }
}

unsafe extern "C" {
    #[link_name = "calloc"]
    fn libc_calloc(count: usize, size: usize) -> *mut c_void;
    #[link_name = "free"]
    fn libc_free(memory: *mut c_void);
}
