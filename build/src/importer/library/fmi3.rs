//! An instance of an FMI 3.0 FMU.
#![allow(unsafe_code, reason = "loads a library and calls its C functions")]

use super::elements::{Element, Wholes};
use super::interface::Interface;
use super::shared::{
    Completed, LibraryError, Message, Stepped, Update, c_text, check, forget_complaints, functions,
    hear, open, said,
};
use libloading::Library;
use std::cell::RefCell;
use std::ffi::{c_char, c_int, c_uint, c_void};
use std::path::Path;

type Instance = *mut c_void;
type Log = unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char);
/// A get function: references and their number, values and theirs.
type Get<T> = unsafe extern "C" fn(Instance, *const c_uint, usize, *mut T, usize) -> c_int;
/// A set function.
type Set<T> = unsafe extern "C" fn(Instance, *const c_uint, usize, *const T, usize) -> c_int;

type Enter = unsafe extern "C" fn(Instance) -> c_int;
type Read = unsafe extern "C" fn(Instance, *mut f64, usize) -> c_int;

functions! {
    /// Those of both interfaces.
    struct Functions;
    free: "fmi3FreeInstance", fn(Instance) -> ();
    enter: "fmi3EnterInitializationMode", fn(Instance, bool, f64, f64, bool, f64) -> c_int;
    exit: "fmi3ExitInitializationMode", fn(Instance) -> c_int;
    terminate: "fmi3Terminate", fn(Instance) -> c_int;
    reset: "fmi3Reset", fn(Instance) -> c_int;
    get_float64: "fmi3GetFloat64", fn(Instance, *const c_uint, usize, *mut f64, usize) -> c_int;
    get_int32: "fmi3GetInt32", fn(Instance, *const c_uint, usize, *mut i32, usize) -> c_int;
    get_boolean: "fmi3GetBoolean", fn(Instance, *const c_uint, usize, *mut u8, usize) -> c_int;
    set_float64: "fmi3SetFloat64", fn(Instance, *const c_uint, usize, *const f64, usize) -> c_int;
    set_int32: "fmi3SetInt32", fn(Instance, *const c_uint, usize, *const i32, usize) -> c_int;
    set_boolean: "fmi3SetBoolean", fn(Instance, *const c_uint, usize, *const u8, usize) -> c_int;
}

functions! {
    /// Those of co-simulation.
    struct Stepping;
    instantiate: "fmi3InstantiateCoSimulation",
        fn(*const c_char, *const c_char, *const c_char, bool, bool, bool, bool, *const c_uint, usize,
           *mut c_void, Log, *const c_void) -> Instance;
    do_step: "fmi3DoStep",
        fn(Instance, f64, f64, bool, *mut u8, *mut u8, *mut u8, *mut f64) -> c_int;
}

functions! {
    /// Those of Model Exchange.
    struct Exchange;
    instantiate: "fmi3InstantiateModelExchange",
        fn(*const c_char, *const c_char, *const c_char, bool, bool, *mut c_void, Log) -> Instance;
    enter_event: "fmi3EnterEventMode", fn(Instance) -> c_int;
    update: "fmi3UpdateDiscreteStates",
        fn(Instance, *mut u8, *mut u8, *mut u8, *mut u8, *mut u8, *mut f64) -> c_int;
    enter_continuous: "fmi3EnterContinuousTimeMode", fn(Instance) -> c_int;
    completed: "fmi3CompletedIntegratorStep", fn(Instance, bool, *mut u8, *mut u8) -> c_int;
    set_time: "fmi3SetTime", fn(Instance, f64) -> c_int;
    set_states: "fmi3SetContinuousStates", fn(Instance, *const f64, usize) -> c_int;
    get_states: "fmi3GetContinuousStates", fn(Instance, *mut f64, usize) -> c_int;
    get_rates: "fmi3GetContinuousStateDerivatives", fn(Instance, *mut f64, usize) -> c_int;
    get_nominals: "fmi3GetNominalsOfContinuousStates", fn(Instance, *mut f64, usize) -> c_int;
}

/// The functions of the interface that an instance is for.
enum Own {
    Stepping(Stepping),
    Exchange(Exchange),
}

/// `fmi3Discard`
const DISCARD: c_int = 2;

/// An instance of an FMU, with its library.
pub struct Slave {
    instance: Instance,
    functions: Functions,
    own: Own,
    elements: Vec<Element>,
    /// Tolerance, start and stop, s, for the beginning of initialisation.
    experiment: (Option<f64>, f64, Option<f64>),
    /// Where the logger puts its messages; in a box of its own, because the FMU keeps the address.
    heard: Box<RefCell<Vec<Message>>>,
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
        token: &str,
        resources: &str,
        elements: Vec<Element>,
        interface: Interface,
        debug_logging: bool,
    ) -> Result<Self, LibraryError> {
        let library = open(library)?;
        // SAFETY: modelDescription.xml says that it is an FMI 3.0 FMU with this interface.
        let (functions, own) = unsafe {
            let own = match interface {
                Interface::CoSimulation => Own::Stepping(Stepping::find(&library)?),
                Interface::ModelExchange => Own::Exchange(Exchange::find(&library)?),
            };
            (Functions::find(&library)?, own)
        };
        let heard = Box::new(RefCell::new(Vec::new()));
        let texts = ["urdf2fmu", token, resources].map(c_text);
        let [name, token, resources] = texts.each_ref().map(|text| text.as_ptr());
        let environment = (&raw const *heard).cast_mut().cast();
        let debug = debug_logging;
        // SAFETY: strings end with a zero and live during the call, the environment as long as the
        // instance; there are no intermediate variables.
        let (instance, function) = unsafe {
            match own {
                Own::Stepping(Stepping { instantiate, .. }) => (
                    instantiate(
                        name,
                        token,
                        resources,
                        false,
                        debug,
                        false,
                        false,
                        std::ptr::null(),
                        0,
                        environment,
                        log,
                        std::ptr::null(),
                    ),
                    "fmi3InstantiateCoSimulation",
                ),
                Own::Exchange(Exchange { instantiate, .. }) => (
                    instantiate(name, token, resources, false, debug, environment, log),
                    "fmi3InstantiateModelExchange",
                ),
            }
        };
        if instance.is_null() {
            let said = said(&heard.borrow());
            return Err(LibraryError::Instantiate { function, said });
        }
        Ok(Self {
            instance,
            functions,
            own,
            elements,
            experiment: (None, 0.0, None),
            heard,
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

    /// For fmi3EnterInitializationMode
    ///
    /// # Errors
    /// [`LibraryError::Status`], as for all below.
    #[expect(clippy::unnecessary_wraps, reason = "as for FMI 2.0")]
    pub fn setup(
        &mut self,
        tolerance: Option<f64>,
        start: f64,
        stop: Option<f64>,
    ) -> Result<(), LibraryError> {
        self.experiment = (tolerance, start, stop);
        Ok(())
    }

    /// fmi3EnterInitializationMode
    pub fn enter_initialization(&mut self) -> Result<(), LibraryError> {
        let (tolerance, start, stop) = self.experiment;
        // SAFETY: the instance lives as long as `self`; numbers only. So below.
        let status = unsafe {
            (self.functions.enter)(
                self.instance,
                tolerance.is_some(),
                tolerance.unwrap_or(0.0),
                start,
                stop.is_some(),
                stop.unwrap_or(0.0),
            )
        };
        self.check("fmi3EnterInitializationMode", status)
    }

    /// fmi3ExitInitializationMode
    pub fn exit_initialization(&mut self) -> Result<(), LibraryError> {
        // SAFETY: see `enter_initialization`.
        let status = unsafe { (self.functions.exit)(self.instance) };
        self.check("fmi3ExitInitializationMode", status)
    }

    /// fmi3Terminate
    pub fn terminate(&mut self) -> Result<(), LibraryError> {
        // SAFETY: see `enter_initialization`.
        let status = unsafe { (self.functions.terminate)(self.instance) };
        self.check("fmi3Terminate", status)
    }

    /// fmi3Reset
    pub fn reset(&mut self) -> Result<(), LibraryError> {
        // SAFETY: see `enter_initialization`.
        let status = unsafe { (self.functions.reset)(self.instance) };
        self.check("fmi3Reset", status)
    }

    /// fmi3DoStep
    pub fn do_step(&mut self, time: f64, step: f64) -> Result<Stepped, LibraryError> {
        let Own::Stepping(Stepping { do_step, .. }) = self.own else {
            return Err(LibraryError::Missing { name: "fmi3DoStep" });
        };
        let (mut event, mut end, mut early, mut reached) = (0, 0, 0, time);
        // SAFETY: see `enter_initialization`; the places live during the call.
        let status = unsafe {
            do_step(
                self.instance,
                time,
                step,
                true,
                &raw mut event,
                &raw mut end,
                &raw mut early,
                &raw mut reached,
            )
        };
        if status == DISCARD {
            return Ok(Stepped::Discarded(reached));
        }
        self.check("fmi3DoStep", status)?;
        Ok(match (end != 0, early != 0) {
            (true, _) => Stepped::Over(reached),
            (false, true) => Stepped::Early(reached),
            (false, false) => Stepped::Done,
        })
    }

    /// fmi3GetFloat64
    pub fn get_real(&mut self, numbers: &[u32], values: &mut [f64]) -> Result<(), LibraryError> {
        let get = self.functions.get_float64;
        self.get("fmi3GetFloat64", get, numbers, values)
    }

    /// fmi3GetInt32
    pub fn get_integer(&mut self, numbers: &[u32], values: &mut [i32]) -> Result<(), LibraryError> {
        let get = self.functions.get_int32;
        self.get("fmi3GetInt32", get, numbers, values)
    }

    /// fmi3GetBoolean
    pub fn get_boolean(&mut self, numbers: &[u32], values: &mut [i32]) -> Result<(), LibraryError> {
        let mut bytes = vec![0_u8; values.len()];
        let get = self.functions.get_boolean;
        self.get("fmi3GetBoolean", get, numbers, &mut bytes)?;
        for (value, byte) in values.iter_mut().zip(bytes) {
            *value = i32::from(byte);
        }
        Ok(())
    }

    /// fmi3SetFloat64
    pub fn set_real(&mut self, numbers: &[u32], values: &[f64]) -> Result<(), LibraryError> {
        let (get, set) = (self.functions.get_float64, self.functions.set_float64);
        self.set("fmi3SetFloat64", (get, set), numbers, values)
    }

    /// fmi3SetInt32
    pub fn set_integer(&mut self, number: u32, value: i32) -> Result<(), LibraryError> {
        let (get, set) = (self.functions.get_int32, self.functions.set_int32);
        self.set("fmi3SetInt32", (get, set), &[number], &[value])
    }

    /// fmi3SetBoolean
    pub fn set_boolean(&mut self, number: u32, value: bool) -> Result<(), LibraryError> {
        let (get, set) = (self.functions.get_boolean, self.functions.set_boolean);
        self.set("fmi3SetBoolean", (get, set), &[number], &[u8::from(value)])
    }

    /// Reads the arrays whole and picks what was asked for.
    fn get<T: Copy + Default>(
        &self,
        function: &'static str,
        get: Get<T>,
        numbers: &[u32],
        values: &mut [T],
    ) -> Result<(), LibraryError> {
        let wholes = Wholes::of(&self.elements, numbers);
        let mut all = vec![T::default(); wholes.len];
        let references = &wholes.references;
        // SAFETY: both arrays have the lengths that are passed with them. So below.
        let status = unsafe {
            let (n, len) = (references.len(), all.len());
            get(self.instance, references.as_ptr(), n, all.as_mut_ptr(), len)
        };
        self.check(function, status)?;
        for (value, place) in values.iter_mut().zip(wholes.places) {
            *value = all[place];
        }
        Ok(())
    }

    /// Sets arrays whole; elements that were not given stay.
    fn set<T: Copy + Default>(
        &self,
        function: &'static str,
        (get, set): (Get<T>, Set<T>),
        numbers: &[u32],
        values: &[T],
    ) -> Result<(), LibraryError> {
        let wholes = Wholes::of(&self.elements, numbers);
        let mut all = vec![T::default(); wholes.len];
        let (references, n) = (wholes.references.as_ptr(), wholes.references.len());
        if !wholes.is_whole() {
            // SAFETY: see `get`.
            let status = unsafe { get(self.instance, references, n, all.as_mut_ptr(), all.len()) };
            self.check(function, status)?;
        }
        for (value, place) in values.iter().zip(&wholes.places) {
            all[*place] = *value;
        }
        // SAFETY: see `get`.
        let status = unsafe { set(self.instance, references, n, all.as_ptr(), all.len()) };
        self.check(function, status)
    }

    /// fmi3EnterEventMode
    pub fn enter_event_mode(&mut self) -> Result<(), LibraryError> {
        self.enter("fmi3EnterEventMode", |own| own.enter_event)
    }

    /// fmi3UpdateDiscreteStates
    pub fn update_discrete_states(&mut self) -> Result<Update, LibraryError> {
        let name = "fmi3UpdateDiscreteStates";
        let update = self.exchange(name)?.update;
        let (mut again, mut ends, mut nominals, mut states) = (0, 0, 0, 0);
        let (mut defined, mut next) = (0, 0.0);
        // SAFETY: see `enter_initialization`; the places live during the call. So below.
        let status = unsafe {
            update(
                self.instance,
                &raw mut again,
                &raw mut ends,
                &raw mut nominals,
                &raw mut states,
                &raw mut defined,
                &raw mut next,
            )
        };
        self.check(name, status).map(|()| Update {
            again: again != 0,
            ends: ends != 0,
            next: (defined != 0).then_some(next),
        })
    }

    /// fmi3EnterContinuousTimeMode
    pub fn enter_continuous_time_mode(&mut self) -> Result<(), LibraryError> {
        self.enter("fmi3EnterContinuousTimeMode", |own| own.enter_continuous)
    }

    /// fmi3CompletedIntegratorStep; the importer does not go back before it.
    pub fn completed_step(&mut self) -> Result<Completed, LibraryError> {
        let name = "fmi3CompletedIntegratorStep";
        let completed = self.exchange(name)?.completed;
        let (mut event, mut ends) = (0, 0);
        // SAFETY: see `update_discrete_states`.
        let status = unsafe { completed(self.instance, true, &raw mut event, &raw mut ends) };
        self.check(name, status).map(|()| Completed {
            event: event != 0,
            ends: ends != 0,
        })
    }

    /// fmi3SetTime
    pub fn set_time(&mut self, time: f64) -> Result<(), LibraryError> {
        let set = self.exchange("fmi3SetTime")?.set_time;
        // SAFETY: see `enter_initialization`.
        let status = unsafe { set(self.instance, time) };
        self.check("fmi3SetTime", status)
    }

    /// fmi3SetContinuousStates
    pub fn set_states(&mut self, states: &[f64]) -> Result<(), LibraryError> {
        let name = "fmi3SetContinuousStates";
        let set = self.exchange(name)?.set_states;
        // SAFETY: the array has the length that is passed with it.
        let status = unsafe { set(self.instance, states.as_ptr(), states.len()) };
        self.check(name, status)
    }

    /// fmi3GetContinuousStates
    pub fn get_states(&mut self, states: &mut [f64]) -> Result<(), LibraryError> {
        self.read("fmi3GetContinuousStates", |own| own.get_states, states)
    }

    /// fmi3GetContinuousStateDerivatives
    pub fn get_rates(&mut self, rates: &mut [f64]) -> Result<(), LibraryError> {
        self.read(
            "fmi3GetContinuousStateDerivatives",
            |own| own.get_rates,
            rates,
        )
    }

    /// fmi3GetNominalsOfContinuousStates
    pub fn get_nominals(&mut self, nominals: &mut [f64]) -> Result<(), LibraryError> {
        self.read(
            "fmi3GetNominalsOfContinuousStates",
            |own| own.get_nominals,
            nominals,
        )
    }

    /// Changes the mode.
    fn enter(&self, name: &'static str, of: fn(&Exchange) -> Enter) -> Result<(), LibraryError> {
        let enter = of(&self.exchange(name)?);
        // SAFETY: see `enter_initialization`.
        let status = unsafe { enter(self.instance) };
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
        let status = unsafe { read(self.instance, numbers.as_mut_ptr(), numbers.len()) };
        self.check(name, status)
    }

    fn exchange(&self, name: &'static str) -> Result<Exchange, LibraryError> {
        match self.own {
            Own::Exchange(functions) => Ok(functions),
            Own::Stepping(_) => Err(LibraryError::Missing { name }),
        }
    }

    fn check(&self, function: &'static str, status: c_int) -> Result<(), LibraryError> {
        check("fmi3", function, status, &self.heard.borrow())
    }
}

impl Drop for Slave {
    fn drop(&mut self) {
        // SAFETY: made by an instantiate function, freed once; the library is still there.
        unsafe { (self.functions.free)(self.instance) };
    }
}

/// The importer's logger.
///
/// # Safety
/// Called by an FMU with the environment that it was given; strings are null or end with a zero.
unsafe extern "C" fn log(
    environment: *mut c_void,
    status: c_int,
    category: *const c_char,
    message: *const c_char,
) {
    // SAFETY: the caller's promise.
    unsafe {
        hear(environment, status, [category, message], |text| {
            text.replace("##", "#")
        });
    }
}
