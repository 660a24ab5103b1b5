//! Fuzz targets for arbitrary bytes. A target must return without a crash, a hang, undefined
//! behaviour (`AddressSanitizer` checks this) or a leak.
//!
//! | target | bytes are |
//! |---|---|
//! | `states` | a serialised state, or changes to a good one whose checksums are then put right |
//! | `model` | a prepared model as text, or changes to the numbers or the text of a good one |
//! | `settings` | a settings file |
//! | `calls` | a sequence of FMI 2 calls with their arguments, of co-simulation or Model Exchange |
//! | `calls3` | the same of FMI 3, with calls from within steps |
//! | `viewer` | a request or the frames of a socket, as a live view gets them |
#![allow(
    unsafe_code,
    dead_code,
    clippy::undocumented_unsafe_blocks,
    clippy::print_stderr,
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::too_many_lines,
    missing_docs,
    reason = "calls C functions as an importer would, with pointers that are valid or null"
)]

#[path = "targets/calls.rs"]
mod calls;
#[path = "targets/calls3.rs"]
mod calls3;
#[path = "targets/exchange.rs"]
mod exchange;
#[path = "targets/model.rs"]
mod model;
#[path = "targets/viewer.rs"]
mod viewer;

pub use calls::calls;
pub use calls3::calls3;
pub use model::model;
pub use viewer::viewer;

use std::ffi::{CString, c_char, c_void};
use std::ptr::{null, null_mut};
use std::sync::LazyLock;
use urdf2fmu_core::hash::fnv1a;
use urdf2fmu_core::prepared::PreparedModel;
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::variables::{Kind, Slot, Variable, table};
use urdf2fmu_core::{assemble, urdf};
use urdf2fmu_fmi::v2::types::fmi2CallbackFunctions;
use urdf2fmu_fmi::*;

const GUID: &str = "{fuzz}";

/// A rover with one wheel, an arm with a limit and a force from outside: every kind of variable but
/// sensors.
const ROBOT: &str = r#"<robot name="r">
<link name="base"><inertial><mass value="2"/><inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision></link>
<link name="wheel"><inertial><mass value="0.5"/><inertia ixx="0.002" iyy="0.003" izz="0.002" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><sphere radius="0.1"/></geometry></collision></link>
<link name="arm"><inertial><mass value="0.3"/><inertia ixx="0.002" iyy="0.003" izz="0.002" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="axle" type="continuous"><parent link="base"/><child link="wheel"/><origin xyz="0.1 0 0"/><axis xyz="0 1 0"/>
  <limit effort="5" velocity="20"/><dynamics damping="0.01" friction="0.02"/></joint>
<joint name="elbow" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.1"/><axis xyz="0 1 0"/>
  <limit lower="-1" upper="1" effort="3" velocity="4"/></joint>
</robot>"#;

/// The model of a robot with settings.
fn prepare(robot: &str, settings: &str) -> PreparedModel {
    let options = urdf::ReadOptions::default();
    let folder = std::path::Path::new(".");
    let description = urdf::read_str(robot, "r.urdf", folder, &options).unwrap();
    let settings = Settings::parse(settings, "r.toml").unwrap();
    let assembled = assemble::build(&description, &settings).unwrap();
    PreparedModel::new(GUID.into(), assembled.model)
}

fn good_model() -> PreparedModel {
    prepare(
        ROBOT,
        "[outputs]\nlinks = [\"arm\"]\n[[external_wrench]]\nlink = \"base\"\n\
         [[actuator]]\njoint = \"elbow\"\nmode = \"pd\"\nkp = 5\nkd = 0.5\n",
    )
}

/// The folder that the FMU's library is told to read, as a URI.
static RESOURCES: LazyLock<CString> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("urdf2fmu-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("model.json"), good_model().to_json().unwrap()).unwrap();
    CString::new(format!("file://{}", folder.display())).unwrap()
});

/// Bytes as arguments; zeros when there are no more.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else {
            return 0;
        };
        self.0 = rest;
        *first
    }

    fn word(&mut self) -> u32 {
        u32::from_le_bytes(std::array::from_fn(|_| self.byte()))
    }

    fn number(&mut self) -> f64 {
        match self.byte() {
            0 => 0.0,
            1 => -1.0,
            2 => f64::NAN,
            3 => f64::INFINITY,
            4 => 1e308,
            5 => 5e-324,
            6 => -1e-9,
            7 => 1e-3,
            8 => f64::from_bits(u64::from(self.word()) << 32 | u64::from(self.word())),
            small => f64::from(i16::from(small) - 128) * 0.1,
        }
    }
}

fn instantiate() -> *mut c_void {
    instantiate_as(1, &RESOURCES)
}

/// - `kind`: 0 is Model Exchange, 1 co-simulation
fn instantiate_as(kind: i32, resources: &CString) -> *mut c_void {
    let (name, guid) = (c"fuzz", CString::new(GUID).unwrap());
    let callbacks = fmi2CallbackFunctions {
        logger: None,
        allocateMemory: None,
        freeMemory: None,
        stepFinished: None,
        componentEnvironment: null_mut(),
    };
    unsafe {
        fmi2Instantiate(
            name.as_ptr(),
            kind,
            guid.as_ptr(),
            resources.as_ptr(),
            &raw const callbacks,
            0,
            1,
        )
    }
}

fn running() -> *mut c_void {
    let c = instantiate();
    assert!(!c.is_null());
    unsafe {
        fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0);
        fmi2EnterInitializationMode(c);
        fmi2ExitInitializationMode(c);
    }
    c
}

/// An instance that serves many executions: making one takes longer than everything else. States
/// bring it back to the beginning.
struct Kept {
    c: *mut c_void,
    instantiated: *mut c_void,
    initialised: *mut c_void,
}

thread_local! {
    static KEPT: Kept = {
        let (c, mut instantiated, mut initialised) = (instantiate(), null_mut(), null_mut());
        assert!(!c.is_null());
        unsafe {
            fmi2GetFMUstate(c, &raw mut instantiated);
            fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0);
            fmi2EnterInitializationMode(c);
            fmi2ExitInitializationMode(c);
            fmi2GetFMUstate(c, &raw mut initialised);
        }
        Kept { c, instantiated, initialised }
    };
}

/// The kept instance, fresh or initialised.
fn kept(initialised: bool) -> *mut c_void {
    KEPT.with(|kept| {
        let state = if initialised {
            kept.initialised
        } else {
            kept.instantiated
        };
        let status = unsafe { fmi2SetFMUstate(kept.c, state) };
        assert!(status as i32 == 0);
        kept.c
    })
}

/// Value references of the robot's reals, integers and booleans, and those of its real outputs.
static REFERENCES: LazyLock<[Vec<u32>; 4]> = LazyLock::new(|| {
    let rows = table(&good_model().model).unwrap();
    let of = |wanted: &dyn Fn(&Variable) -> bool| {
        let rows = rows.iter().filter(|row| wanted(row));
        rows.map(|row| row.value_reference).collect()
    };
    let output = |row: &Variable| matches!(row.slot, Slot::Output(_)) && row.kind == Kind::Real;
    [
        of(&|row| row.kind == Kind::Real),
        of(&|row| row.kind == Kind::Integer),
        of(&|row| row.kind == Kind::Boolean),
        of(&output),
    ]
});

/// Reads everything there is.
fn read_all(c: *mut c_void) {
    let [reals, integers, booleans, outputs] = &*REFERENCES;
    let mut numbers = vec![0.0; reals.len()];
    let mut counts = vec![0; integers.len().max(booleans.len())];
    let orders = vec![1; outputs.len()];
    let (real, integer) = (numbers.as_mut_ptr(), counts.as_mut_ptr());
    unsafe {
        fmi2GetReal(c, reals.as_ptr(), reals.len(), real);
        fmi2GetInteger(c, integers.as_ptr(), integers.len(), integer);
        fmi2GetBoolean(c, booleans.as_ptr(), booleans.len(), integer);
        let (vr, n) = (outputs.as_ptr(), outputs.len());
        fmi2GetRealOutputDerivatives(c, vr, n, orders.as_ptr(), real);
    }
}

/// Puts the checksum at the end of `bytes` right.
fn seal(bytes: &mut [u8]) {
    let end = bytes.len() - 8;
    let checksum = fnv1a(&bytes[..end]).to_le_bytes();
    bytes[end..].copy_from_slice(&checksum);
}

/// Bytes of a good state, after some motion.
static STATE: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let c = running();
    unsafe {
        fmi2DoStep(c, 0.0, 0.3, 1);
        let (mut state, mut size) = (null_mut(), 0);
        fmi2GetFMUstate(c, &raw mut state);
        fmi2SerializedFMUstateSize(c, state, &raw mut size);
        let mut bytes = vec![0_u8; size];
        fmi2SerializeFMUstate(c, state, bytes.as_mut_ptr().cast(), size);
        fmi2FreeFMUstate(c, &raw mut state);
        fmi2FreeInstance(c);
        bytes
    }
});

/// Whether an execution goes on with what costs most, by its bytes: one in `many`.
///
/// Reading is what bytes decide about; a step after each would leave a fiftieth of the executions.
fn chosen(data: &[u8], many: u64) -> bool {
    (fnv1a(data) >> 32).is_multiple_of(many)
}

/// Length of what stands before the simulation's own bytes, see `fmi/src/snapshot.rs`.
const HEADER: usize = 56;

/// A communication step, s, of a few of the steps that the parameters ask for, at most `most`: who
/// asks for a hundred nanoseconds or 12 digits waits as long as that takes, which is no finding.
unsafe fn short_step(c: *mut c_void, most: f64) -> f64 {
    let mut asked = [0.0; 2];
    unsafe { fmi2GetReal(c, ASKED.as_ptr(), 2, asked.as_mut_ptr()) };
    match asked {
        [fixed, _] if fixed > 0.0 => (4.0 * fixed).clamp(1e-9, most),
        [_, tolerance] if tolerance > 0.0 && tolerance < 1e-6 => 1e-6,
        _ => most,
    }
}

/// Value references of the length of fixed steps and of the tolerance.
static ASKED: LazyLock<[u32; 2]> = LazyLock::new(|| {
    let rows = table(&good_model().model).unwrap();
    ["solver.step_size", "solver.tolerance"].map(|name| {
        let row = rows.iter().find(|row| row.name == name);
        row.unwrap().value_reference
    })
});

pub fn states(data: &[u8]) {
    let mut bytes = Bytes(data);
    let forged = bytes.byte() % 2 == 1;
    let state = if forged {
        let mut state = STATE.clone();
        while !bytes.0.is_empty() {
            let place = bytes.word() as usize % (state.len() - 16);
            if bytes.byte().is_multiple_of(4) {
                let number = bytes.number().to_le_bytes();
                let place = place / 8 * 8;
                state[place..place + 8].copy_from_slice(&number);
            } else {
                state[place] ^= bytes.byte();
            }
        }
        let end = state.len() - 8;
        seal(&mut state[HEADER..end]);
        seal(&mut state);
        state
    } else {
        bytes.0.to_vec()
    };
    // Setting a state comes first, so that the instance need not be brought back to its beginning.
    let c = KEPT.with(|kept| kept.c);
    unsafe {
        let mut saved = null_mut();
        let accepted =
            fmi2DeSerializeFMUstate(c, state.as_ptr().cast(), state.len(), &raw mut saved) as i32
                == 0;
        assert_eq!(accepted, !saved.is_null());
        if accepted {
            if chosen(data, 8) {
                fmi2SetFMUstate(c, saved);
                let mut time = 0.0;
                fmi2GetRealStatus(c, 2, &raw mut time);
                fmi2DoStep(c, time, short_step(c, 1e-4), 0);
                read_all(c);
                fmi2GetFMUstate(c, &raw mut saved);
            }
            fmi2FreeFMUstate(c, &raw mut saved);
        }
    }
}

pub fn settings(data: &[u8]) {
    _ = Settings::parse(&String::from_utf8_lossy(data), "fuzz.toml");
}
