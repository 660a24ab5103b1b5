//! The Runge–Kutta pairs: their weights, and how each spends the tolerance.
//!
//! Source: Dormand & Prince 1980; Bogacki & Shampine 1989; Hairer, Nørsett & Wanner 1993, sections
//! II.4 to II.6; Kennedy & Carpenter 2003 (`ARK4(3)6L[2]SA`).

use crate::tuning::{DAMPED_SHARE, EXPLICIT_SHARE, LEAST_SHARE};

/// Most stages of a pair; the last one stands at the new state.
pub(super) const STAGES: usize = 7;

/// A Runge–Kutta pair. If it is explicit, its last stage is the first of the next step.
#[derive(Debug)]
pub struct Pair {
    /// Row `i` holds the weights of stages `0 … i` for stage `i + 1`; the last row is the solution.
    pub(super) weights: &'static [&'static [f64]],
    /// The same for the velocity that damping takes, of all rows but the last; empty: damping is
    /// explicit.
    pub(super) implicit: &'static [&'static [f64]],
    /// Weight of a stage in its own velocity that damping takes.
    pub(super) gamma: f64,
    /// Share of the tolerance that a step may use: steps are few and long, and what many of them
    /// add up to shall be of the size of the tolerance still. Damping forgets; without it twice the
    /// steps buy a fiftieth of the error.
    pub(super) share: f64,
    /// Solution minus embedded solution.
    pub(super) error: &'static [f64],
    /// Order of the error estimate plus one: the error of a step of length h grows like h to this
    /// power.
    pub order: i32,
}

impl Pair {
    /// What a step may err by, m or rad at a reach of one metre.
    pub fn allowed(&self, tolerance: f64) -> f64 {
        (self.share * tolerance).max(LEAST_SHARE)
    }

    /// Whether damping is explicit like everything else.
    pub fn is_explicit(&self) -> bool {
        self.implicit.is_empty()
    }
}

/// Dormand–Prince 5(4).
pub static DORMAND_PRINCE: Pair = Pair {
    weights: &[
        &[1.0 / 5.0],
        &[3.0 / 40.0, 9.0 / 40.0],
        &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
        &[
            19372.0 / 6561.0,
            -25360.0 / 2187.0,
            64448.0 / 6561.0,
            -212.0 / 729.0,
        ],
        &[
            9017.0 / 3168.0,
            -355.0 / 33.0,
            46732.0 / 5247.0,
            49.0 / 176.0,
            -5103.0 / 18656.0,
        ],
        &[
            35.0 / 384.0,
            0.0,
            500.0 / 1113.0,
            125.0 / 192.0,
            -2187.0 / 6784.0,
            11.0 / 84.0,
        ],
    ],
    error: &[
        71.0 / 57600.0,
        0.0,
        -71.0 / 16695.0,
        71.0 / 1920.0,
        -17253.0 / 339_200.0,
        22.0 / 525.0,
        -1.0 / 40.0,
    ],
    implicit: &[],
    gamma: 0.0,
    share: EXPLICIT_SHARE,
    order: 5,
};

/// Bogacki–Shampine 3(2).
pub static BOGACKI_SHAMPINE: Pair = Pair {
    weights: &[
        &[1.0 / 2.0],
        &[0.0, 3.0 / 4.0],
        &[2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0],
    ],
    error: &[-5.0 / 72.0, 1.0 / 12.0, 1.0 / 9.0, -1.0 / 8.0],
    implicit: &[],
    gamma: 0.0,
    share: EXPLICIT_SHARE,
    order: 3,
};

/// Kennedy–Carpenter 4(3), additive, of six stages.
pub static KENNEDY_CARPENTER: Pair = Pair {
    weights: &[
        &[1.0 / 2.0],
        &[13_861.0 / 62_500.0, 6_889.0 / 62_500.0],
        &[
            -116_923_316_275.0 / 2_393_684_061_468.0,
            -2_731_218_467_317.0 / 15_368_042_101_831.0,
            9_408_046_702_089.0 / 11_113_171_139_209.0,
        ],
        &[
            -451_086_348_788.0 / 2_902_428_689_909.0,
            -2_682_348_792_572.0 / 7_519_795_681_897.0,
            12_662_868_775_082.0 / 11_960_479_115_383.0,
            3_355_817_975_965.0 / 11_060_851_509_271.0,
        ],
        &[
            647_845_179_188.0 / 3_216_320_057_751.0,
            73_281_519_250.0 / 8_382_639_484_533.0,
            552_539_513_391.0 / 3_454_668_386_233.0,
            3_354_512_671_639.0 / 8_306_763_924_573.0,
            4_040.0 / 17_871.0,
        ],
        &[
            82_889.0 / 524_892.0,
            0.0,
            15_625.0 / 83_664.0,
            69_875.0 / 102_672.0,
            -2_260.0 / 8_211.0,
            1.0 / 4.0,
        ],
    ],
    implicit: &[
        &[1.0 / 4.0],
        &[8_611.0 / 62_500.0, -1_743.0 / 31_250.0],
        &[
            5_012_029.0 / 34_652_500.0,
            -654_441.0 / 2_922_500.0,
            174_375.0 / 388_108.0,
        ],
        &[
            15_267_082_809.0 / 155_376_265_600.0,
            -71_443_401.0 / 120_774_400.0,
            730_878_875.0 / 902_184_768.0,
            2_285_395.0 / 8_070_912.0,
        ],
        &[
            82_889.0 / 524_892.0,
            0.0,
            15_625.0 / 83_664.0,
            69_875.0 / 102_672.0,
            -2_260.0 / 8_211.0,
        ],
    ],
    gamma: 1.0 / 4.0,
    // The solution's weights minus those of the embedded third order.
    error: &[
        82_889.0 / 524_892.0 - 4_586_570_599.0 / 29_645_900_160.0,
        0.0,
        15_625.0 / 83_664.0 - 178_811_875.0 / 945_068_544.0,
        69_875.0 / 102_672.0 - 814_220_225.0 / 1_159_782_912.0,
        -2_260.0 / 8_211.0 + 3_700_637.0 / 11_593_932.0,
        1.0 / 4.0 - 61_727.0 / 225_920.0,
    ],
    share: DAMPED_SHARE,
    order: 4,
};

/// Weights of the stages in the last coefficient of Dormand–Prince's continuous extension.
pub(super) const EXTENSION: [f64; STAGES] = [
    -12_715_105_075.0 / 11_282_082_432.0,
    0.0,
    87_487_479_700.0 / 32_700_410_799.0,
    -10_690_763_975.0 / 1_880_347_072.0,
    701_980_252_875.0 / 199_316_789_632.0,
    -1_453_857_185.0 / 822_651_844.0,
    69_997_945.0 / 29_380_423.0,
];
