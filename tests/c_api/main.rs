//! The C functions, driven from outside: an importer written in C loads the library with dlopen, as
//! any importer does, and misuses it in many ways. Each test is a run of that program.
//!
//! Skipped, with a message, where there is no C compiler or the command was built without a
//! library.
//!
//! Over 500 lines because all tests share one program in C and the ways to build and run it.

#[path = "../skipped.rs"]
mod skipped;
mod windows;

use skipped::skipped;
use std::ffi::OsStr;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;
use urdf2fmu_core::assemble;
use urdf2fmu_core::model::{Interface, Model};
use urdf2fmu_core::prepared::PreparedModel;
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::urdf::{self, ReadOptions};
use urdf2fmu_core::variables::{Kind, entries, find, table, time_reference};

const GUID: &str = "{5d7a42b4-9b64-8f5c-8f0e-0a86de6d1c11}";

/// Where everything is, made once for all tests of this file.
struct Bench {
    importer: PathBuf,
    library: &'static str,
    /// Holds `model.json`.
    resources: PathBuf,
}

/// Writes what the importer reads of the rover: `robot.h` and `exchange.h` into `folder`, and
/// `model.json` into `resources`, and of the rover with both interfaces into its neighbour.
fn write_robots(folder: &Path, resources: &Path) {
    let (model, exchanged) = (rover(Interface::Cs), rover(Interface::Both));
    let all = table(&exchanged).expect("a table");
    let states = all
        .iter()
        .filter(|variable| variable.state.is_some())
        .count();
    let both = header(&exchanged).replace("#define ", "#define ME_");
    let both = format!("#define ME_STATES {states}\n{both}");
    for (file, text) in [("robot.h", header(&model)), ("exchange.h", both)] {
        fs::write(folder.join(file), text).expect("a file for the tests");
    }
    for (resources, model) in [(resources, model), (&exchange(resources), exchanged)] {
        fs::create_dir_all(resources).expect("a folder for the tests");
        let text = PreparedModel::new(GUID.into(), model).to_json();
        let text = text.expect("a model that can be stored");
        fs::write(resources.join("model.json"), text).expect("a file for the tests");
    }
}

/// Resources of the rover that can be exchanged, beside those of the other.
fn exchange(resources: &Path) -> PathBuf {
    resources.with_file_name("exchanged")
}

/// None where it cannot be made.
static BENCH: LazyLock<Option<Bench>> = LazyLock::new(|| {
    let Some(library) = option_env!("URDF2FMU_HOST_LIBRARY") else {
        skipped("this urdf2fmu was built without a library for its own platform");
        return None;
    };
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    if Command::new(&compiler).arg("--version").output().is_err() {
        skipped(&format!("there is no C compiler '{compiler}'; set CC"));
        return None;
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("c_api");
    let resources = folder.join("resources");
    fs::create_dir_all(&folder).expect("a folder for the tests");
    write_robots(&folder, &resources);

    let importer = folder.join("importer");
    let output = Command::new(compiler)
        .args([
            "-std=gnu11",
            "-O1",
            "-g",
            "-Wall",
            "-Wextra",
            "-Werror",
            "-o",
        ])
        .arg(&importer)
        .arg("-I")
        .arg(&folder)
        .args(sources())
        .args(["-ldl", "-lm", "-lpthread"])
        .output()
        .expect("the compiler answers");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    Some(Bench {
        importer,
        library,
        resources,
    })
});

/// Two FMUs with a library each, in one process.
#[test]
fn two_different_robots_in_one_process_share_no_data() {
    let Some(bench) = &*BENCH else { return };
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/quadruped.urdf");
    let description = urdf::read(&file, &ReadOptions::default()).expect("the example can be read");
    let model = assemble::build(&description, &Settings::default())
        .expect("the example can be built")
        .model;
    let guid = "{11111111-0000-8000-8000-000000000000}";
    let folder = bench.resources.with_file_name("quadruped");
    fs::create_dir_all(&folder).expect("a folder for the test");
    let text = PreparedModel::new(guid.into(), model)
        .to_json()
        .expect("finite");
    fs::write(folder.join("model.json"), text).expect("a file for the test");
    let library = folder.join("quadruped.so");
    fs::copy(bench.library, &library).expect("a file for the test");
    bench.run(&["two", &library.display().to_string(), &uri(&folder), guid]);
}

/// The importer again, its own memory and every call of the allocator watched.
#[cfg(target_os = "linux")]
#[test]
fn address_sanitizer_finds_nothing() {
    let Some(bench) = &*BENCH else { return };
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    let importer = bench.importer.with_file_name("sanitized");
    let output = Command::new(compiler)
        .args([
            "-std=gnu11",
            "-g",
            "-fsanitize=address,undefined",
            "-fno-sanitize-recover=all",
            "-o",
        ])
        .arg(&importer)
        .arg("-I")
        .arg(bench.importer.parent().expect("a folder"))
        .args(sources())
        .args(["-ldl", "-lm", "-lpthread"])
        .output()
        .expect("the compiler answers");
    if !output.status.success() {
        skipped("this C compiler has no sanitizers");
        return;
    }
    let sanitized = Bench {
        importer,
        library: bench.library,
        resources: bench.resources.clone(),
    };
    for test in [
        "null",
        "values",
        "logging",
        "instantiate",
        "states",
        "damage",
        "phases",
        "discard",
        "input_derivatives",
        "output_derivatives",
        "v3_phases",
        "v3_values",
        "v3_states",
        "v3_updates",
        "v3_instantiate",
        "v3_logging",
        "exchange_phases",
        "exchange",
        "v3_exchange_phases",
        "v3_exchange",
    ] {
        sanitized.of(test).run(&[test]);
    }
}

/// Our importer in Rust does the same as the one in C: load, run, read, free.
#[cfg(target_os = "linux")]
#[test]
fn valgrind_finds_nothing_in_a_simulation_by_the_command() {
    if Command::new("valgrind").arg("--version").output().is_err() {
        skipped("there is no valgrind");
        return;
    }
    let Some(bench) = &*BENCH else { return };
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let fmu = bench.importer.with_file_name("rover.fmu");
    let command = env!("CARGO_BIN_EXE_urdf2fmu");
    let made = Command::new(command)
        .args(["export", "--no-documentation"])
        .arg(examples.join("rover.urdf"))
        .arg("-o")
        .arg(&fmu)
        .output()
        .expect("the command runs");
    assert!(made.status.success(), "{}", texts(&made).1);
    let output = Command::new("valgrind")
        .args(["--quiet", "--error-exitcode=9", "--leak-check=full"])
        // Rust's handle of the main thread is reached by a pointer into its middle: "possibly
        // lost".
        .arg("--errors-for-leak-kinds=definite")
        .args(["--show-leak-kinds=definite,indirect", command, "simulate"])
        .arg(&fmu)
        .args([
            "--quiet",
            "--stop-time",
            "0.05",
            "--start-value",
            "cmd.head_joint.velocity",
            "1",
        ])
        .output()
        .expect("valgrind runs");
    let (said, complained) = texts(&output);
    assert!(output.status.success(), "{}\n{complained}", output.status);
    assert!(
        said.lines().count() > 10 && complained.is_empty(),
        "{complained}"
    );
}

/// The importer again, with functions of its own under names that libraries use, visible to all it
/// loads.
#[cfg(target_os = "linux")]
#[test]
fn a_host_with_functions_of_the_same_names_does_not_disturb_the_library() {
    let Some(bench) = &*BENCH else { return };
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    let importer = bench.importer.with_file_name("hostile");
    let object = bench.importer.with_file_name("hostile.o");
    let hostile = sources()[0].with_file_name("hostile.c");
    let made = |arguments: &mut Command| {
        let output = arguments.output().expect("the compiler answers");
        assert!(output.status.success(), "{}", texts(&output).1);
    };
    // Names of the C library mean something else to the compiler.
    made(
        Command::new(&compiler)
            .args(["-c", "-fno-builtin", "-o"])
            .arg(&object)
            .arg(hostile),
    );
    made(
        Command::new(&compiler)
            .args([
                "-std=gnu11",
                "-rdynamic",
                "-Dload=load_library",
                "-fno-builtin",
                "-o",
            ])
            .arg(&importer)
            .arg("-I")
            .arg(bench.importer.parent().expect("a folder"))
            .args(
                sources()
                    .into_iter()
                    .filter(|file| !file.ends_with("long.c")),
            )
            .args(["-DWITHOUT_LONG"])
            .arg(&object)
            .args(["-ldl", "-lm", "-lpthread"]),
    );
    let hostile = Bench {
        importer,
        library: bench.library,
        resources: bench.resources.clone(),
    };
    for test in ["states", "threads", "discard", "null"] {
        hostile.run(&[test]);
    }
}

/// Of the importer.
fn sources() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/c_api");
    let names = [
        "main.c",
        "importer.c",
        "phases.c",
        "misuse.c",
        "states.c",
        "derivatives.c",
        "exchange.c",
        "values.c",
        "long.c",
        "host.c",
        "v3/importer3.c",
        "v3/phases.c",
        "v3/exchange.c",
        "v3/values.c",
        "v3/states.c",
        "v3/steps.c",
        "v3/misuse.c",
    ];
    names.iter().map(|name| folder.join(name)).collect()
}

/// The example rover: four driven wheels on the ground.
fn rover(interface: Interface) -> Model {
    let mut settings = Settings::default();
    settings.fmu.interface = interface;
    rover_by(&settings)
}

fn rover_by(settings: &Settings) -> Model {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/rover.urdf");
    let description = urdf::read(&file, &ReadOptions::default()).expect("the example can be read");
    assemble::build(&description, settings)
        .expect("the example can be built")
        .model
}

/// Value references for the importer, which reads no modelDescription.xml.
fn header(model: &Model) -> String {
    let table = table(model).expect("a table");
    let reference = |name: &str| {
        find(&table, name)
            .unwrap_or_else(|| panic!("no variable '{name}'"))
            .value_reference
    };
    let mut text = String::new();
    for (constant, name) in [
        ("LEFT_VELOCITY", "cmd.left_front_wheel_joint.velocity"),
        ("RIGHT_VELOCITY", "cmd.right_front_wheel_joint.velocity"),
        ("LEFT_REAR_VELOCITY", "cmd.left_rear_wheel_joint.velocity"),
        ("RIGHT_REAR_VELOCITY", "cmd.right_rear_wheel_joint.velocity"),
        ("LEFT_MAX_EFFORT", "cmd.left_front_wheel_joint.max_effort"),
        ("BASE_X", "base.position.x"),
        ("BASE_Z", "base.position.z"),
        ("BASE_VX", "base.linear_velocity.x"),
        ("BASE_VZ", "base.linear_velocity.z"),
        ("BASE_QW", "base.orientation.w"),
        ("BASE_QW_VECTOR", "base.orientation.x"),
        ("INITIAL_X", "initial.base.position.x"),
        ("CONTACT_ACTIVE", "contact.left_front_wheel.active"),
        ("STEP_SIZE", "solver.step_size"),
        ("LEFT_SPEED", "joint.left_front_wheel_joint.velocity"),
        (
            "LEFT_ACCELERATION",
            "joint.left_front_wheel_joint.acceleration",
        ),
        ("LEFT_EFFORT", "joint.left_front_wheel_joint.effort"),
        ("KINETIC", "energy.kinetic"),
        ("POTENTIAL", "energy.potential"),
        ("CONTACT_Z", "contact.left_front_wheel.force.z"),
        ("BASE_MASS", "link.base_link.mass"),
        ("INITIAL_VX", "initial.base.linear_velocity.x"),
        ("INITIAL_WZ", "initial.base.angular_velocity.z"),
        ("STEPS", "solver.steps"),
        ("INITIAL_Z", "initial.base.position.z"),
        ("GRAVITY_Z", "world.gravity.z"),
        ("MAX_STEPS", "solver.max_steps"),
        ("GROUND_FRICTION", "world.ground.friction"),
        ("GROUND_RESTITUTION", "world.ground.restitution"),
    ] {
        writeln!(text, "#define {constant} {}u", reference(name)).expect("a string");
    }
    let reals: Vec<String> = table
        .iter()
        .filter(|variable| variable.kind == Kind::Real)
        .map(|variable| format!("{}u", variable.value_reference))
        .collect();
    let entries = entries(model, &table).expect("no clash");
    let floats = entries
        .iter()
        .filter(|entry| table[entry.rows[0] as usize].kind == Kind::Real);
    let floats: Vec<String> = floats.map(|e| format!("{}u", e.value_reference)).collect();
    writeln!(text, "#define TIME {}u", time_reference(&table)).expect("a string");
    writeln!(text, "#define FLOAT64_COUNT {}", reals.len()).expect("a string");
    writeln!(text, "#define FLOAT64_REFERENCES {}", floats.join(", ")).expect("a string");
    text + &format!("#define REAL_REFERENCES {}\n", reals.join(", "))
}

fn uri(folder: &Path) -> String {
    format!("file://{}", folder.display())
}

impl Bench {
    /// The same with the robot that a test needs.
    fn of(&self, test: &str) -> Self {
        let resources = &self.resources;
        Self {
            importer: self.importer.clone(),
            library: self.library,
            resources: if exchanges(test) {
                exchange(resources)
            } else {
                resources.clone()
            },
        }
    }

    /// The importer, told what to do; `wrapper` is a program that runs it.
    fn command<A: AsRef<OsStr>>(&self, wrapper: &[&str], guid: &str, arguments: &[A]) -> Command {
        let mut command = match wrapper {
            [] => Command::new(&self.importer),
            [program, options @ ..] => {
                let mut command = Command::new(program);
                command.args(options).arg(&self.importer);
                command
            }
        };
        command
            .arg(self.library)
            .arg(uri(&self.resources))
            .arg(guid)
            .args(arguments);
        command
    }

    /// What the importer prints when every check holds and nothing is said on stderr.
    fn run<A: AsRef<OsStr>>(&self, arguments: &[A]) -> String {
        let output = self
            .command(&[], GUID, arguments)
            // Memory in use is exact only without glibc's cache of freed blocks.
            .env("GLIBC_TUNABLES", "glibc.malloc.tcache_count=0")
            .output()
            .expect("the importer runs");
        let (said, complained) = texts(&output);
        assert!(
            output.status.success(),
            "{}\n{said}\n{complained}",
            output.status
        );
        assert_eq!(complained, "", "the library must be silent on stderr");
        said
    }
}

fn texts(output: &Output) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (text(&output.stdout), text(&output.stderr))
}

macro_rules! runs {
    ($($name:ident: $test:literal;)*) => {
        /// What the importer is told to do in these tests.
        const TESTS: &[&str] = &[$($test),*];

        $(
            #[test]
            fn $name() {
                if let Some(bench) = &*BENCH {
                    bench.of($test).run(&[$test]);
                }
            }
        )*
    };
}

/// Whether a test is of Model Exchange, and needs the rover with that interface.
fn exchanges(test: &str) -> bool {
    test.contains("exchange")
}

runs! {
    every_function_in_every_phase_answers_as_the_table_says: "phases";
    a_step_that_cannot_be_done_is_discarded_and_can_be_taken_back: "discard";
    null_pointers_are_errors_or_nothing: "null";
    wrong_references_types_and_values_are_errors_without_effect: "values";
    wrong_times_are_errors_and_near_ones_are_not: "times";
    a_thousand_jittering_steps_land_exactly: "jitter";
    an_fmu_that_cannot_be_instantiated_says_why: "instantiate";
    messages_are_safe_to_print_and_come_as_asked_for: "logging";
    saved_states_go_on_bit_for_bit_in_every_instance: "states";
    damaged_states_are_refused: "damage";
    input_derivatives_take_effect_within_the_step: "input_derivatives";
    output_derivatives_are_velocities_and_accelerations: "output_derivatives";
    outputs_at_the_start_are_right_and_inputs_of_the_initialisation_count: "initialization";
    tunable_parameters_count_from_the_next_step_and_fixed_ones_at_the_start: "parameters";
    a_million_jittering_steps_land_exactly: "million";
    steps_of_any_length_give_the_same_drive: "partitions";
    reset_gives_the_bits_of_a_new_instance: "reset";
    ten_thousand_instances_leave_no_memory_behind: "cycles";
    a_thousand_loads_leave_no_library_and_no_memory_behind: "unload";
    the_hosts_control_word_is_kept_and_changes_nothing: "control_word";
    signal_handlers_stay: "signals";
    sixty_four_instances_on_eight_threads_give_the_bits_of_one: "threads";
    a_thread_of_64_kilobytes_is_enough_for_an_instance: "stack";
    every_function_in_every_phase_of_model_exchange_answers_as_the_table_says: "exchange_phases";
    hostile_calls_of_model_exchange_are_errors_without_effect: "exchange";
    every_function_of_fmi_3_in_every_phase_of_model_exchange_answers_so: "v3_exchange_phases";
    hostile_calls_of_model_exchange_of_fmi_3_are_errors_without_effect: "v3_exchange";
    every_function_of_fmi_3_in_every_phase_answers_as_the_table_says: "v3_phases";
    arrays_are_got_and_set_whole_and_wrong_lengths_have_no_effect: "v3_values";
    output_derivatives_of_arrays_have_all_elements: "v3_derivatives";
    saved_states_of_fmi_3_go_on_and_those_of_fmi_2_are_refused: "v3_states";
    fmi_3_gives_the_bits_of_fmi_2: "v3_bits";
    a_discarded_step_of_fmi_3_leaves_the_state_before_the_call: "v3_discard";
    the_importer_is_called_within_steps_and_can_end_them: "v3_updates";
    an_instance_of_fmi_3_that_cannot_be_made_says_why: "v3_instantiate";
    errors_of_fmi_3_are_always_heard_and_wrong_pointers_refused: "v3_logging";
}

#[test]
fn a_thread_of_64_kilobytes_is_enough_where_shapes_may_touch_each_other() {
    let Some(bench) = &*BENCH else { return };
    assert!(
        !rover(Interface::Cs).has_pairs(),
        "the test above is without"
    );
    let settings = Settings {
        self_collision: true,
        ..Settings::default()
    };
    let model = rover_by(&settings);
    assert!(model.has_pairs());
    let resources = bench.resources.with_file_name("touching");
    fs::create_dir_all(&resources).expect("a folder for the test");
    let text = PreparedModel::new(GUID.into(), model).to_json();
    let text = text.expect("a model that can be stored");
    fs::write(resources.join("model.json"), text).expect("a file for the test");
    let bench = Bench {
        importer: bench.importer.clone(),
        library: bench.library,
        resources,
    };
    bench.run(&["stack"]);
}

#[test]
fn a_saved_state_goes_on_bit_for_bit_in_a_new_process() {
    let Some(bench) = &*BENCH else { return };
    let file = bench.resources.with_file_name("state.bin");
    let argument = |test| [OsStr::new(test), file.as_os_str()];
    let first = bench.run(&argument("save"));
    assert!(first.lines().count() > 50, "{first}");
    assert_eq!(bench.run(&argument("resume")), first);

    // The same robot under another guid is another FMU.
    let other = bench.resources.with_file_name("other");
    let guid = "{00000000-0000-8000-8000-000000000000}";
    fs::create_dir_all(&other).expect("a folder for the test");
    let prepared = PreparedModel::new(guid.into(), rover(Interface::Cs));
    fs::write(
        other.join("model.json"),
        prepared.to_json().expect("finite"),
    )
    .expect("a file for the test");
    let other = Bench {
        importer: bench.importer.clone(),
        library: bench.library,
        resources: other,
    };
    let output = other
        .command(&[], guid, &argument("foreign"))
        .output()
        .expect("it runs");
    assert!(output.status.success(), "{}", texts(&output).0);
}

#[cfg(target_os = "linux")]
#[test]
fn resources_are_found_under_every_spelling_of_their_location() {
    let Some(bench) = &*BENCH else { return };
    let mut locations = Vec::new();
    for name in [
        "plain",
        "a b",
        "café",
        "ä#1",
        "100%",
        "a%20b",
        "q?x=1&y",
        "semi;colon",
    ] {
        let folder = bench
            .resources
            .with_file_name("places")
            .join(name)
            .join("resources");
        fs::create_dir_all(&folder).expect("a folder for the test");
        fs::copy(
            bench.resources.join("model.json"),
            folder.join("model.json"),
        )
        .expect("a file for the test");
        let plain = folder.to_str().expect("Unicode");
        for path in [plain.to_owned(), encoded(plain)] {
            for prefix in [
                "file://",
                "file:",
                "file:///",
                "file://localhost",
                "FILE://",
            ] {
                locations.push(format!("{prefix}{path}"));
                locations.push(format!("{prefix}{path}/"));
            }
        }
        locations.push(plain.to_owned());
    }
    let mut arguments = vec!["locations".to_owned()];
    arguments.extend(locations);
    bench.run(&arguments);
}

/// RFC 3986: all but unreserved characters and slashes as `%HH`.
fn encoded(path: &str) -> String {
    path.bytes()
        .map(|byte| match byte {
            b'/' | b'-' | b'.' | b'_' | b'~' => char::from(byte).to_string(),
            _ if byte.is_ascii_alphanumeric() => char::from(byte).to_string(),
            _ => format!("%{byte:02X}"),
        })
        .collect()
}

#[test]
fn a_missing_or_broken_model_is_an_error_that_names_the_file() {
    let Some(bench) = &*BENCH else { return };
    let good = fs::read_to_string(bench.resources.join("model.json")).expect("written before");
    let cut = &good[..good.len() / 2];
    let other_format = good.replacen("\"format\": ", "\"format\": 99", 1);
    assert_ne!(other_format, good);
    let wild_index = good.replacen("\"parent\": 0", "\"parent\": 4000000000", 1);
    assert_ne!(wild_index, good);
    let not_a_number = good.replacen("\"mass\": ", "\"mass\": null, \"was\": ", 1);
    let mut arguments = vec!["broken".to_owned()];
    for (name, bytes) in [
        ("empty", &b""[..]),
        ("cut", cut.as_bytes()),
        ("format", other_format.as_bytes()),
        ("index", wild_index.as_bytes()),
        ("null", not_a_number.as_bytes()),
        ("binary", &[0xFF, 0xFE, 0x00, 0x80]),
        ("list", b"[1, 2, 3]"),
    ] {
        let folder = bench.resources.with_file_name("broken").join(name);
        fs::create_dir_all(&folder).expect("a folder for the test");
        fs::write(folder.join("model.json"), bytes).expect("a file for the test");
        arguments.push(uri(&folder));
    }
    let folder = bench.resources.with_file_name("broken").join("missing");
    fs::create_dir_all(&folder).expect("a folder for the test");
    arguments.push(uri(&folder));
    bench.run(&arguments);
}

#[test]
fn valgrind_finds_nothing() {
    let Some(bench) = &*BENCH else { return };
    if Command::new("valgrind").arg("--version").output().is_err() {
        skipped("there is no valgrind");
        return;
    }
    let valgrind = [
        "valgrind",
        "--quiet",
        "--error-exitcode=9",
        "--leak-check=full",
        "--show-leak-kinds=definite,indirect",
    ];
    for test in [
        "null",
        "values",
        "logging",
        "instantiate",
        "states",
        "v3_values",
        "v3_states",
        "v3_updates",
        "v3_instantiate",
        "v3_logging",
        "exchange",
        "v3_exchange",
    ] {
        let output = bench
            .of(test)
            .command(&valgrind, GUID, &[test])
            .output()
            .expect("valgrind runs");
        let (said, complained) = texts(&output);
        assert!(
            output.status.success(),
            "{test}: {}\n{said}\n{complained}",
            output.status
        );
        assert_eq!(complained, "", "{test}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn only_fmi_functions_are_visible() {
    let Some(bench) = &*BENCH else { return };
    let Ok(output) = Command::new("nm")
        .args(["-D", "--defined-only", bench.library])
        .output()
    else {
        skipped("there is no nm");
        return;
    };
    let (symbols, _) = texts(&output);
    let names: Vec<&str> = symbols
        .lines()
        .filter_map(|line| line.split(' ').nth(2))
        .collect();
    // FMI 2.0.4: 25 common functions, 10 of Model Exchange, 9 of co-simulation. FMI 3.0: 75.
    for (prefix, count) in [("fmi2", 44), ("fmi3", 75)] {
        let of_version = names.iter().filter(|name| name.starts_with(prefix));
        assert_eq!(of_version.count(), count, "{names:?}");
    }
    assert_eq!(names.len(), 44 + 75, "{names:?}");
}
