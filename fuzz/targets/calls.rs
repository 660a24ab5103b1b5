//! A sequence of FMI calls with their arguments, as an importer could make them.

use super::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Calls in all sequences so far.
static CALLS: AtomicU64 = AtomicU64::new(0);

pub fn calls(data: &[u8]) {
    let mut bytes = Bytes(data);
    let start = bytes.byte();
    let mut c = match start {
        // Model Exchange.
        128.. => exchange::kept2(start),
        _ => kept(start % 2 == 1),
    };
    // Only an instance of its own is freed and made again.
    let mut own = false;
    let mut saved: [*mut c_void; 2] = [null_mut(); 2];
    let mut memory: Vec<u8> = Vec::new();
    let (mut time, mut simulated) = (0.0_f64, 0.0);
    for _ in 0..64 {
        if bytes.0.is_empty() {
            break;
        }
        let number = CALLS.fetch_add(1, Ordering::Relaxed);
        if number > 0 && number.is_multiple_of(1_000_000) {
            eprintln!("{number} calls");
        }
        let function = bytes.byte();
        let count = bytes.byte() as usize % 6;
        let references: Vec<u32> = (0..count)
            .map(|_| match bytes.byte() {
                255 => bytes.word(),
                small => u32::from(small),
            })
            .collect();
        let mut reals: Vec<f64> = (0..count).map(|_| bytes.number()).collect();
        let mut integers: Vec<i32> = (0..count).map(|_| i32::from(bytes.byte()) - 2).collect();
        let (kind, slot) = (i32::from(bytes.byte()) - 1, function as usize % 2);
        // Null arrays with any length, as long as nothing may be read or written.
        let absent = bytes.byte() == 1;
        let n = if absent { bytes.word() as usize } else { count };
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
        unsafe {
            match function / 2 % 64 {
                0 | 1 => drop(fmi2SetReal(c, vr, n, real)),
                2 => drop(fmi2GetReal(c, vr, n, real)),
                3 => drop(fmi2SetInteger(c, vr, n, integer)),
                4 => drop(fmi2GetInteger(c, vr, n, integer)),
                5 => drop(fmi2SetBoolean(c, vr, n, integer)),
                6 => drop(fmi2GetBoolean(c, vr, n, integer)),
                7 => {
                    let strings = vec![null::<c_char>(); count];
                    fmi2SetString(c, vr, n, if absent { null() } else { strings.as_ptr() });
                }
                8 => {
                    let mut strings = vec![null::<c_char>(); count];
                    fmi2GetString(
                        c,
                        vr,
                        n,
                        if absent {
                            null_mut()
                        } else {
                            strings.as_mut_ptr()
                        },
                    );
                }
                9 | 10 => drop(fmi2SetRealInputDerivatives(c, vr, n, integer, real)),
                11 => drop(fmi2GetRealOutputDerivatives(c, vr, n, integer, real)),
                12..=15 => {
                    // At most 0.2 s in all: a sequence is to be short.
                    let step = [1e-3, 0.01, 1e-9, bytes.number()][kind.unsigned_abs() as usize % 4];
                    let begin = if slot == 0 { time } else { bytes.number() };
                    let most = short_step(c, 0.05).min(0.2 - simulated);
                    let step = if step > 1e6 || step.is_nan() {
                        step
                    } else {
                        step.min(most)
                    };
                    if fmi2DoStep(c, begin, step, kind) as i32 == 0 {
                        simulated += step.max(0.0);
                    }
                    fmi2GetRealStatus(c, 2, &raw mut time);
                }
                16 => drop(fmi2SetupExperiment(
                    c,
                    kind,
                    bytes.number(),
                    bytes.number(),
                    kind,
                    bytes.number(),
                )),
                17 => drop(fmi2EnterInitializationMode(c)),
                18 => drop(fmi2ExitInitializationMode(c)),
                19 => drop(fmi2Terminate(c)),
                20 => drop(fmi2Reset(c)),
                21 => drop(fmi2GetFMUstate(
                    c,
                    if absent {
                        null_mut()
                    } else {
                        &raw mut saved[slot]
                    },
                )),
                22 => drop(fmi2SetFMUstate(c, saved[slot])),
                23 => drop(fmi2FreeFMUstate(
                    c,
                    if absent {
                        null_mut()
                    } else {
                        &raw mut saved[slot]
                    },
                )),
                24 => {
                    let mut size = 0;
                    if fmi2SerializedFMUstateSize(c, saved[slot], &raw mut size) as i32 == 0 {
                        memory.resize(size - usize::from(kind == 5), 0);
                        fmi2SerializeFMUstate(
                            c,
                            saved[slot],
                            memory.as_mut_ptr().cast(),
                            memory.len(),
                        );
                    }
                }
                25 => {
                    if let Some(byte) = memory.get_mut(n) {
                        *byte ^= bytes.byte();
                    }
                    // What stood in the slot before would be lost.
                    fmi2FreeFMUstate(c, &raw mut saved[slot]);
                    fmi2DeSerializeFMUstate(
                        c,
                        memory.as_ptr().cast(),
                        memory.len(),
                        &raw mut saved[slot],
                    );
                }
                26 => {
                    let mut status = urdf2fmu_fmi::v2::types::fmi2Status::OK;
                    fmi2GetStatus(c, kind, if absent { null_mut() } else { &raw mut status });
                }
                27 => drop(fmi2GetRealStatus(
                    c,
                    kind,
                    if count == 0 {
                        null_mut()
                    } else {
                        reals.as_mut_ptr()
                    },
                )),
                28 => drop(fmi2GetIntegerStatus(c, kind, integers.as_mut_ptr())),
                29 => drop(fmi2GetBooleanStatus(
                    c,
                    kind,
                    if count == 0 {
                        null_mut()
                    } else {
                        integers.as_mut_ptr()
                    },
                )),
                30 => {
                    let mut text = null();
                    fmi2GetStringStatus(c, kind, if absent { null_mut() } else { &raw mut text });
                }
                31 => {
                    let names = [
                        c"logAll".as_ptr(),
                        c"logEvents".as_ptr(),
                        null(),
                        c"no".as_ptr(),
                    ];
                    fmi2SetDebugLogging(
                        c,
                        kind,
                        n.min(4),
                        if absent { null() } else { names.as_ptr() },
                    );
                }
                32 => drop(fmi2GetDirectionalDerivative(c, vr, n, vr, n, real, real)),
                33 => drop(fmi2CancelStep(c)),
                34 => drop(fmi2NewDiscreteStates(c, null_mut())),
                35 => drop(fmi2SetTime(c, bytes.number())),
                36 => drop(fmi2GetDerivatives(c, real, n)),
                37 => drop(fmi2GetContinuousStates(c, real, n)),
                38 => {
                    // A null component is no instance; a new one can go on from the old one's
                    // states.
                    fmi2GetReal(null_mut(), vr, n, real);
                    fmi2FreeInstance(null_mut());
                    if kind > 200 {
                        if own {
                            fmi2FreeInstance(c);
                        }
                        c = if slot == 0 { running() } else { instantiate() };
                        own = true;
                    }
                }
                39 => read_all(c),
                place => exchange::call2(c, place, &mut bytes, &mut time),
            }
        }
    }
    unsafe {
        for state in &mut saved {
            fmi2FreeFMUstate(c, &raw mut *state);
        }
        if own {
            fmi2FreeInstance(c);
        }
    }
}
