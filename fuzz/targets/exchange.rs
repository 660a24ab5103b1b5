//! Model Exchange in sequences of calls: the robot of the other targets as an FMU of both
//! interfaces, kept instances of it, and what an importer calls while it integrates.

use super::*;
use std::sync::Arc;
use urdf2fmu_core::simulation::Simulation;
use urdf2fmu_fmi::v2::types::{fmi2EventInfo, fmi2Status};

/// The robot with continuous states.
fn model() -> PreparedModel {
    let mut prepared = good_model();
    prepared.model.outputs.interface = urdf2fmu_core::model::Interface::Both;
    PreparedModel::new(GUID.into(), prepared.model)
}

/// As [`super::RESOURCES`].
pub static RESOURCES: LazyLock<CString> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("urdf2fmu-fuzz-me-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("model.json"), model().to_json().unwrap()).unwrap();
    CString::new(format!("file://{}", folder.display())).unwrap()
});

/// Number of continuous states.
static COUNT: LazyLock<usize> =
    LazyLock::new(|| Simulation::new(Arc::new(model().model)).states().len());

/// Numbers of the importer: as many as there are states, or, when a byte says so, some.
struct Numbers(Vec<f64>);

impl Numbers {
    fn new(bytes: &mut Bytes) -> Self {
        let count = match bytes.byte() {
            0 => 0,
            1 => bytes.byte() as usize,
            _ => *COUNT,
        };
        let few: Vec<f64> = (0..count.min(6)).map(|_| bytes.number()).collect();
        let number = |i: usize| few.get(i % 6).copied().unwrap_or(0.0);
        Self((0..count).map(number).collect())
    }

    fn pointer(&mut self) -> *mut f64 {
        self.0.as_mut_ptr()
    }
}

/// A step of Euler's method: states along their derivatives.
fn advanced(states: &[f64], rates: &[f64], step: f64) -> Vec<f64> {
    let pairs = states.iter().zip(rates);
    pairs.map(|(state, rate)| state + step * rate).collect()
}

/// The kept instance of FMI 2: fresh, in event mode, or in continuous-time mode.
pub fn kept2(which: u8) -> *mut c_void {
    struct Kept {
        c: *mut c_void,
        states: [*mut c_void; 3],
    }
    thread_local! {
        static KEPT: Kept = {
            let c = instantiate_as(0, &RESOURCES);
            assert!(!c.is_null());
            let mut states = [null_mut(); 3];
            unsafe {
                fmi2GetFMUstate(c, &raw mut states[0]);
                fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0);
                fmi2EnterInitializationMode(c);
                fmi2ExitInitializationMode(c);
                fmi2GetFMUstate(c, &raw mut states[1]);
                assert_eq!(fmi2EnterContinuousTimeMode(c) as i32, 0);
                fmi2GetFMUstate(c, &raw mut states[2]);
            }
            Kept { c, states }
        };
    }
    KEPT.with(|kept| {
        let state = kept.states[which as usize % 3];
        let status = unsafe { fmi2SetFMUstate(kept.c, state) };
        assert!(status as i32 == 0);
        kept.c
    })
}

/// A call of Model Exchange in FMI 2.
pub fn call2(c: *mut c_void, function: u8, bytes: &mut Bytes, time: &mut f64) {
    let mut numbers = Numbers::new(bytes);
    let (x, n) = (numbers.pointer(), numbers.0.len());
    let (mut enter, mut end) = (9, 9);
    unsafe {
        match function % 10 {
            0 => drop(fmi2EnterEventMode(c)),
            1 => {
                let mut info = fmi2EventInfo::default();
                fmi2NewDiscreteStates(c, &raw mut info);
            }
            2 => drop(fmi2EnterContinuousTimeMode(c)),
            3 => drop(fmi2CompletedIntegratorStep(
                c,
                1,
                &raw mut enter,
                &raw mut end,
            )),
            4 => drop(fmi2SetContinuousStates(c, x, n)),
            5 => drop(fmi2GetContinuousStates(c, x, n)),
            6 => drop(fmi2GetEventIndicators(c, x, n)),
            7 => drop(fmi2GetNominalsOfContinuousStates(c, x, n)),
            8 => {
                if fmi2GetDerivatives(c, x, n) == fmi2Status::OK {
                    assert!(numbers.0.iter().all(|rate| rate.is_finite()));
                }
            }
            _ => {
                let (mut states, mut rates) = (vec![0.0; *COUNT], vec![0.0; *COUNT]);
                let ok = fmi2GetContinuousStates(c, states.as_mut_ptr(), *COUNT) == fmi2Status::OK
                    && fmi2GetDerivatives(c, rates.as_mut_ptr(), *COUNT) == fmi2Status::OK;
                let step = [1e-3, 0.1, 1e-9, bytes.number()][n % 4];
                if ok {
                    *time += step;
                    fmi2SetTime(c, *time);
                    let next = advanced(&states, &rates, step);
                    fmi2SetContinuousStates(c, next.as_ptr(), *COUNT);
                    fmi2CompletedIntegratorStep(c, 1, &raw mut enter, &raw mut end);
                }
            }
        }
    }
}

/// An instance of Model Exchange in FMI 3.
pub fn make3() -> *mut c_void {
    let guid = CString::new(GUID).unwrap();
    let (name, resources) = (c"fuzz".as_ptr(), RESOURCES.as_ptr());
    let (token, nothing) = (guid.as_ptr(), null_mut());
    let c = unsafe { fmi3InstantiateModelExchange(name, token, resources, 0, 1, nothing, None) };
    assert!(!c.is_null());
    c
}

/// A call of Model Exchange in FMI 3.
pub fn call3(c: *mut c_void, function: u8, bytes: &mut Bytes, time: &mut f64) {
    let mut numbers = Numbers::new(bytes);
    let (x, n) = (numbers.pointer(), numbers.0.len());
    let (mut enter, mut end) = (9, 9);
    let mut count = 0;
    unsafe {
        match function % 11 {
            0 => drop(fmi3EnterEventMode(c)),
            1 => drop(fmi3SetTime(c, bytes.number())),
            2 => drop(fmi3EnterContinuousTimeMode(c)),
            3 => drop(fmi3CompletedIntegratorStep(
                c,
                1,
                &raw mut enter,
                &raw mut end,
            )),
            4 => drop(fmi3SetContinuousStates(c, x, n)),
            5 => drop(fmi3GetContinuousStates(c, x, n)),
            6 => drop(fmi3GetEventIndicators(c, x, n)),
            7 => drop(fmi3GetNominalsOfContinuousStates(c, x, n)),
            8 => {
                if fmi3GetContinuousStateDerivatives(c, x, n) as i32 == 0 {
                    assert!(numbers.0.iter().all(|rate| rate.is_finite()));
                }
            }
            9 => {
                if fmi3GetNumberOfContinuousStates(c, &raw mut count) as i32 == 0 {
                    assert!(count == *COUNT || count == 0);
                }
                fmi3GetNumberOfEventIndicators(c, &raw mut count);
            }
            _ => {
                let (mut states, mut rates) = (vec![0.0; *COUNT], vec![0.0; *COUNT]);
                let ok = fmi3GetContinuousStates(c, states.as_mut_ptr(), *COUNT) as i32 == 0
                    && fmi3GetContinuousStateDerivatives(c, rates.as_mut_ptr(), *COUNT) as i32 == 0;
                let step = [1e-3, 0.1, 1e-9, bytes.number()][n % 4];
                if ok {
                    *time += step;
                    fmi3SetTime(c, *time);
                    let next = advanced(&states, &rates, step);
                    fmi3SetContinuousStates(c, next.as_ptr(), *COUNT);
                    fmi3CompletedIntegratorStep(c, 1, &raw mut enter, &raw mut end);
                }
            }
        }
    }
}
