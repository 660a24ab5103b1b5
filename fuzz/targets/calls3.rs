//! A sequence of calls of FMI 3, with an instance of FMI 2 beside it, as an importer could make
//! them.
//!
//! The instance is called within its steps, and the callback calls back what the bytes say.

use super::*;
use std::cell::{Cell, RefCell};
use urdf2fmu_core::variables::entries;
use urdf2fmu_fmi::v3::types::fmi3IntermediateUpdateCallback;

/// An instance of each version that serves many executions; states bring them back.
struct Pair {
    old: *mut c_void,
    new: *mut c_void,
    plain: *mut c_void,
    /// Of Model Exchange.
    exchange: *mut c_void,
    /// States of each: instantiated, initialised.
    states: [[*mut c_void; 2]; 4],
}

/// What the callback does.
#[derive(Clone, Default)]
struct Plan {
    bytes: Vec<u8>,
    calls: usize,
}

thread_local! {
    static PLAN: RefCell<Plan> = RefCell::default();
    static INSTANCE: Cell<*mut c_void> = const { Cell::new(null_mut()) };
    static PAIR: Pair = pair();
}

/// Value references of inputs, and of continuous outputs, with their numbers of elements.
static ENTRIES: LazyLock<Vec<(u32, usize)>> = LazyLock::new(|| {
    let model = good_model().model;
    let rows = table(&model).unwrap();
    let entries = entries(&model, &rows).unwrap();
    let continuous = |row: &Variable| {
        row.kind == Kind::Real && !row.stepped && !matches!(row.slot, Slot::Parameter(_))
    };
    let entries = entries.into_iter();
    let entries = entries.filter(|entry| continuous(&rows[entry.rows[0] as usize]));
    entries.map(|e| (e.value_reference, e.rows.len())).collect()
});

fn make(update: Option<fmi3IntermediateUpdateCallback>) -> *mut c_void {
    let guid = CString::new(GUID).unwrap();
    let required: Vec<u32> = ENTRIES.iter().map(|(reference, _)| *reference).collect();
    let n = if update.is_some() { required.len() } else { 0 };
    let c = unsafe {
        fmi3InstantiateCoSimulation(
            c"fuzz".as_ptr(),
            guid.as_ptr(),
            RESOURCES.as_ptr(),
            0,
            1,
            0,
            1,
            required.as_ptr(),
            n,
            null_mut(),
            None,
            update,
        )
    };
    assert!(!c.is_null());
    c
}

fn pair() -> Pair {
    let (old, new, plain) = (instantiate(), make(Some(update)), make(None));
    let exchange = exchange::make3();
    let mut states = [[null_mut(); 2]; 4];
    unsafe {
        fmi2GetFMUstate(old, &raw mut states[0][0]);
        fmi2EnterInitializationMode(old);
        fmi2ExitInitializationMode(old);
        fmi2GetFMUstate(old, &raw mut states[0][1]);
        for (c, states) in [new, plain, exchange].into_iter().zip(&mut states[1..]) {
            fmi3GetFMUState(c, &raw mut states[0]);
            fmi3EnterInitializationMode(c, 0, 0.0, 0.0, 0, 0.0);
            fmi3ExitInitializationMode(c);
            fmi3GetFMUState(c, &raw mut states[1]);
        }
    }
    Pair {
        old,
        new,
        plain,
        exchange,
        states,
    }
}

/// Within a step: a few calls, allowed or not.
unsafe extern "C" fn update(
    _: *mut c_void,
    time: f64,
    _: u8,
    _: u8,
    _: u8,
    _: u8,
    end: *mut u8,
    when: *mut f64,
) {
    let mut plan = PLAN.with_borrow(Clone::clone);
    plan.calls += 1;
    let calls = plan.calls;
    PLAN.set(plan.clone());
    if calls > 20 {
        return;
    }
    let data: Vec<u8> = plan
        .bytes
        .iter()
        .map(|b| b.wrapping_add(calls as u8))
        .collect();
    let mut bytes = Bytes(&data);
    let c = INSTANCE.get();
    for _ in 0..2 {
        call(c, &mut bytes, &mut [null_mut(); 2], &mut 0.0);
    }
    if bytes.byte().is_multiple_of(4) {
        unsafe {
            *end = 1;
            *when = match bytes.byte() % 3 {
                0 => time,
                1 => time + 1e-3,
                _ => bytes.number(),
            };
        }
    }
}

pub fn calls3(data: &[u8]) {
    let mut bytes = Bytes(data);
    let kind = bytes.byte();
    PLAN.set(Plan {
        bytes: data.iter().rev().copied().take(40).collect(),
        calls: 0,
    });
    PAIR.with(|pair| {
        let (which, phase) = (1 + kind as usize / 2 % 3, kind as usize % 2);
        let c = [pair.old, pair.new, pair.plain, pair.exchange][which];
        INSTANCE.set(c);
        unsafe {
            assert_eq!(fmi2SetFMUstate(pair.old, pair.states[0][phase]) as i32, 0);
            assert_eq!(fmi3SetFMUState(c, pair.states[which][phase]) as i32, 0);
            // Of the other version: nothing happens.
            assert_eq!(fmi3SetFMUState(c, pair.states[0][phase]) as i32, 3);
            assert_eq!(
                fmi2SetFMUstate(pair.old, pair.states[which][phase]) as i32,
                3
            );
            assert_eq!(fmi3Reset(pair.old) as i32, 3);
            assert_eq!(fmi2Reset(c) as i32, 3);
            fmi3FreeInstance(pair.old);
            fmi2FreeInstance(c);
        }
        let mut saved = [null_mut(); 2];
        let mut time = 0.0;
        for _ in 0..48 {
            if bytes.0.is_empty() {
                break;
            }
            call(c, &mut bytes, &mut saved, &mut time);
        }
        for state in &mut saved {
            unsafe { fmi3FreeFMUState(c, &raw mut *state) };
        }
    });
}

/// One call of FMI 3.
fn call(c: *mut c_void, bytes: &mut Bytes, saved: &mut [*mut c_void; 2], time: &mut f64) {
    let function = bytes.byte();
    let count = bytes.byte() as usize % 5;
    let mut elements = 0;
    let references: Vec<u32> = (0..count)
        .map(|_| match bytes.byte() {
            255 => bytes.word(),
            small if small % 2 == 0 => {
                let (reference, len) = ENTRIES[small as usize % ENTRIES.len()];
                elements += len;
                reference
            }
            small => u32::from(small),
        })
        .collect();
    // Often the right number of values.
    let values = match bytes.byte() {
        0 => count,
        1 => bytes.byte() as usize,
        _ => elements,
    };
    let mut reals: Vec<f64> = (0..values).map(|_| bytes.number()).collect();
    let mut integers: Vec<i32> = (0..values.max(count))
        .map(|_| i32::from(bytes.byte()) - 2)
        .collect();
    let mut flags: Vec<u8> = (0..values.max(8)).map(|_| bytes.byte()).collect();
    let absent = bytes.byte() == 1;
    let (n, nv) = if absent {
        (bytes.word() as usize, bytes.word() as usize)
    } else {
        (count, values)
    };
    let vr = if absent { null() } else { references.as_ptr() };
    let real = if absent {
        null_mut()
    } else {
        reals.as_mut_ptr()
    };
    let integer = if absent {
        null_mut()
    } else {
        integers.as_mut_ptr()
    };
    let flag = if absent {
        null_mut()
    } else {
        flags.as_mut_ptr()
    };
    let slot = function as usize % 2;
    unsafe {
        match function / 2 % 47 {
            0..=2 => drop(fmi3SetFloat64(c, vr, n, real, nv)),
            3 | 4 => drop(fmi3GetFloat64(c, vr, n, real, nv)),
            5 => drop(fmi3SetInt32(c, vr, n, integer, nv)),
            6 => drop(fmi3GetInt32(c, vr, n, integer, nv)),
            7 => drop(fmi3SetBoolean(c, vr, n, flag, nv)),
            8 => drop(fmi3GetBoolean(c, vr, n, flag, nv)),
            9 => drop(fmi3GetOutputDerivatives(c, vr, n, integer, real, nv)),
            10 => drop(fmi3GetString(c, vr, n, null_mut(), nv)),
            11 => drop(fmi3SetBinary(c, vr, n, null(), null(), nv)),
            12 => drop(fmi3GetClock(c, vr, n, null_mut())),
            13 => drop(fmi3SetFloat32(c, vr, n, null(), nv)),
            14..=19 => {
                let step = [1e-3, 0.01, 1e-9, bytes.number()][slot * 2 + count % 2];
                let step = if step > 1e6 || step.is_nan() {
                    step
                } else {
                    step.min(0.02)
                };
                let begin = if bytes.byte().is_multiple_of(8) {
                    bytes.number()
                } else {
                    *time
                };
                let mut told = [9_u8; 3];
                let [event, end, early] = &mut told;
                let mut reached = f64::NAN;
                let place = if absent { null_mut() } else { &raw mut reached };
                let status = fmi3DoStep(c, begin, step, 1, event, end, early, place) as i32;
                if status == 0 {
                    assert!(reached.is_finite() && told[0] == 0 && told[1] == 0);
                    *time = reached;
                }
            }
            20 => {
                let (tolerance, start) = (bytes.number(), bytes.number());
                fmi3EnterInitializationMode(c, 1, tolerance, start, 1, bytes.number());
            }
            21 => drop(fmi3EnterInitializationMode(c, 0, 0.0, 0.0, 0, 0.0)),
            22 => drop(fmi3ExitInitializationMode(c)),
            23 => drop(fmi3Terminate(c)),
            24 => drop(fmi3Reset(c)),
            25 | 26 => drop(fmi3GetFMUState(c, &raw mut saved[slot])),
            27 | 28 => drop(fmi3SetFMUState(c, saved[slot])),
            29 => drop(fmi3FreeFMUState(c, &raw mut saved[slot])),
            30 => {
                let (mut size, mut made) = (0, null_mut());
                if fmi3SerializedFMUStateSize(c, saved[slot], &raw mut size) as i32 == 0 {
                    let mut memory = vec![0_u8; size];
                    let length = size - usize::from(absent);
                    fmi3SerializeFMUState(c, saved[slot], memory.as_mut_ptr(), length);
                    fmi3DeserializeFMUState(c, memory.as_ptr(), size, &raw mut made);
                    fmi3FreeFMUState(c, &raw mut made);
                }
            }
            31 => drop(fmi3SetDebugLogging(c, 1, 0, null())),
            32 => drop(fmi3GetDirectionalDerivative(
                c, vr, n, vr, n, real, nv, real, nv,
            )),
            33 => {
                let mut next = 0.0;
                let when = if absent { null_mut() } else { &raw mut next };
                fmi3UpdateDiscreteStates(c, flag, flag, flag, flag, flag, when);
            }
            34 => {
                fmi3GetNumberOfContinuousStates(c, null_mut());
                fmi3GetVariableDependencies(
                    c,
                    0,
                    null_mut(),
                    null_mut(),
                    null_mut(),
                    null_mut(),
                    nv,
                );
                fmi3ActivateModelPartition(c, 0, bytes.number());
            }
            35 => {
                fmi3FreeInstance(null_mut());
                fmi3GetFloat64(null_mut(), vr, n, real, nv);
            }
            place => exchange::call3(c, place, bytes, time),
        }
    }
}
