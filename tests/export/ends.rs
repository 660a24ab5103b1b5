//! How `simulate` ends where an FMU of another program asks for it, or returns early from a step.

use super::*;
use std::time::{Duration, Instant};

/// FMUs of FMI 3.0 whose state grows by 1 in a second. By steps they take at most 0.06 s at once,
/// and both want to end at 0.3125 s. The end of the simulation is written to a file.
const SOURCE: &str = r#"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
typedef void *I;
typedef const unsigned *R;
static double now, x;
static bool stepped;
I fmi3InstantiateCoSimulation(const char *n, const char *t, const char *r, bool v, bool l, bool e,
    bool a, R q, size_t nq, void *m, void *f, void *u) { stepped = true; return &now; }
I fmi3InstantiateModelExchange(const char *n, const char *t, const char *r, bool v, bool l, void *m,
    void *f) { return &now; }
void fmi3FreeInstance(I i) {}
int fmi3EnterInitializationMode(I i, bool t, double e, double start, bool s, double stop)
{ now = start; return 0; }
int fmi3ExitInitializationMode(I i) { return 0; }
int fmi3Reset(I i) { return 0; }
int fmi3Terminate(I i)
{ FILE *f = fopen(TOLD, "w"); if (!f) return 3; fputs("ended", f); fclose(f); return 0; }
int fmi3GetFloat64(I i, R r, size_t n, double *v, size_t nv)
{ for (size_t k = 0; k < n; k++) v[k] = r[k] == 2 ? 1 : r[k] == 0 || stepped ? now : x; return 0; }
int fmi3GetInt32(I i, R r, size_t n, int *v, size_t nv) { return 0; }
int fmi3GetBoolean(I i, R r, size_t n, bool *v, size_t nv) { return 0; }
int fmi3SetFloat64(I i, R r, size_t n, const double *v, size_t nv) { return 0; }
int fmi3SetInt32(I i, R r, size_t n, const int *v, size_t nv) { return 0; }
int fmi3SetBoolean(I i, R r, size_t n, const bool *v, size_t nv) { return 0; }
int fmi3DoStep(I i, double t, double h, bool s, bool *event, bool *end, bool *early, double *last)
{
    while (getenv("HANGS")) sleep(1);
    *event = false;
    *early = h > 0.06;
    now = *early ? t + 0.06 : t + h;
    *end = now >= 0.3125;
    if (*end) { now = 0.3125; *early = true; }
    *last = now;
    return 0;
}
int fmi3EnterEventMode(I i) { return 0; }
int fmi3UpdateDiscreteStates(I i, bool *a, bool *e, bool *n, bool *s, bool *d, double *t)
{ *a = *e = *n = *s = *d = false; return 0; }
int fmi3EnterContinuousTimeMode(I i) { return 0; }
int fmi3CompletedIntegratorStep(I i, bool s, bool *event, bool *end)
{ *event = false; *end = now >= 0.3125; return 0; }
int fmi3SetTime(I i, double t) { now = t; return 0; }
int fmi3SetContinuousStates(I i, const double *v, size_t n) { x = v[0]; return 0; }
int fmi3GetContinuousStates(I i, double *v, size_t n) { v[0] = x; return 0; }
int fmi3GetContinuousStateDerivatives(I i, double *v, size_t n) { v[0] = 1; return 0; }
int fmi3GetNominalsOfContinuousStates(I i, double *v, size_t n) { v[0] = 1; return 0; }
"#;

/// One of FMI 2.0 that takes steps of any length, and ends at 0.3125 s in the way of that version:
/// the step is discarded, and the status tells why and how far it came.
const SOURCE_OF_FMI_2: &str = r#"
#include <stddef.h>
#include <stdio.h>
typedef void *I;
typedef const unsigned *R;
static double now;
I fmi2Instantiate(const char *n, int k, const char *g, const char *r, const void *f, int v, int l)
{ return &now; }
void fmi2FreeInstance(I i) {}
int fmi2SetupExperiment(I i, int t, double e, double start, int s, double stop)
{ now = start; return 0; }
int fmi2EnterInitializationMode(I i) { return 0; }
int fmi2ExitInitializationMode(I i) { return 0; }
int fmi2Reset(I i) { return 0; }
int fmi2Terminate(I i)
{ FILE *f = fopen(TOLD, "w"); if (!f) return 3; fputs("ended", f); fclose(f); return 0; }
int fmi2GetReal(I i, R r, size_t n, double *v)
{ for (size_t k = 0; k < n; k++) v[k] = r[k] == 2 ? 1 : now; return 0; }
int fmi2GetInteger(I i, R r, size_t n, int *v) { return 0; }
int fmi2GetBoolean(I i, R r, size_t n, int *v) { return 0; }
int fmi2SetReal(I i, R r, size_t n, const double *v) { return 0; }
int fmi2SetInteger(I i, R r, size_t n, const int *v) { return 0; }
int fmi2SetBoolean(I i, R r, size_t n, const int *v) { return 0; }
int fmi2SetRealInputDerivatives(I i, R r, size_t n, const int *o, const double *v) { return 0; }
int fmi2DoStep(I i, double t, double h, int s)
{ now = t + h < 0.3125 ? t + h : 0.3125; return now < 0.3125 ? 0 : 2; }
int fmi2GetRealStatus(I i, int kind, double *v) { *v = now; return kind == 2 ? 0 : 2; }
int fmi2GetBooleanStatus(I i, int kind, int *v) { *v = now >= 0.3125; return kind == 3 ? 0 : 2; }
"#;

/// The FMU in `folder`, and the file that tells its end; none without a compiler.
fn foreign(folder: &Path, version: u32, interface: &str) -> Option<(PathBuf, PathBuf)> {
    let [source, library, told, fmu] =
        ["foreign.c", "foreign.so", "told", "foreign.fmu"].map(|name| folder.join(name));
    fs::write(&source, [SOURCE_OF_FMI_2, SOURCE][version as usize - 2]).unwrap();
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    let done = Command::new(compiler)
        .args(["-shared", "-fPIC", "-o"])
        .arg(&library)
        .arg(format!("-DTOLD=\"{}\"", told.display()))
        .arg(&source)
        .output()
        .ok()?;
    assert!(done.status.success(), "{done:?}");
    let (identity, variables, platform) = match version {
        2 => (
            "guid",
            "<ScalarVariable name='x' valueReference='1' causality='output' initial='exact'>\
             <Real start='0'/></ScalarVariable></ModelVariables><ModelStructure>"
                .to_owned(),
            "linux64".to_owned(),
        ),
        _ => (
            "instantiationToken",
            "<Float64 name='time' valueReference='0' causality='independent'/>\
             <Float64 name='x' valueReference='1' causality='output' initial='exact' start='0'/>\
             <Float64 name='der(x)' valueReference='2' causality='local' derivative='1'/>\
             </ModelVariables><ModelStructure><Output valueReference='1'/>\
             <ContinuousStateDerivative valueReference='2'/>"
                .to_owned(),
            format!("{}-linux", std::env::consts::ARCH),
        ),
    };
    let description = format!(
        "<fmiModelDescription fmiVersion='{version}.0' modelName='foreign' {identity}='t'>\
         <{interface} modelIdentifier='foreign' canHandleVariableCommunicationStepSize='true'/>\
         <DefaultExperiment startTime='0' stopTime='1' stepSize='0.125'/><ModelVariables>\
         {variables}</ModelStructure></fmiModelDescription>"
    );
    let mut zip = zip::ZipWriter::new(fs::File::create(&fmu).unwrap());
    let place = format!("binaries/{platform}/foreign.so");
    let library = fs::read(library).unwrap();
    for (name, content) in [
        ("modelDescription.xml", description.as_bytes()),
        (&place, &library),
    ] {
        let options = zip::write::SimpleFileOptions::default();
        zip.start_file(name, options).unwrap();
        std::io::Write::write_all(&mut zip, content).unwrap();
    }
    zip.finish().unwrap();
    Some((fmu, told))
}

#[test]
fn an_fmu_that_asks_for_the_end_is_terminated_and_its_last_values_are_written() {
    for (version, interface, times) in [
        // It goes on where it has returned early, to the end of the step.
        (3, "CoSimulation", [0.0, 0.125, 0.25, 0.3125]),
        // Its integrator goes from one output to the next.
        (3, "ModelExchange", [0.0, 0.125, 0.25, 0.375]),
        (2, "CoSimulation", [0.0, 0.125, 0.25, 0.3125]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let Some((fmu, told)) = foreign(folder.path(), version, interface) else {
            continue;
        };
        let table = folder.path().join("out.csv");
        let done = urdf2fmu(["simulate", text(&fmu), "--output-file", text(&table)]);
        let end = times[3];
        let message = format!("the FMU asked to end the simulation at {end} s of 1 s");
        assert!(done.code == 3 && done.err.contains(&message), "{done:?}");
        let written = fs::read_to_string(&table).unwrap();
        let rows = written.lines().skip(1).map(|line| {
            let numbers = line.split(',').map(|number| number.parse::<f64>().unwrap());
            numbers.collect::<Vec<_>>()
        });
        let rows: Vec<Vec<f64>> = rows.collect();
        assert_eq!(rows.len(), 4, "{version} {interface}: {written}");
        for (row, time) in rows.iter().zip(times) {
            let near = |x: f64| (x - time).abs() < 1e-9;
            assert!(
                near(row[0]) && near(row[1]),
                "{version} {interface}: {written}"
            );
        }
        assert_eq!(
            fs::read_to_string(told).unwrap(),
            "ended",
            "{version} {interface}"
        );
    }
}

/// `timeout`, systemd and servers that run tests send SIGTERM once.
#[test]
fn one_sigterm_ends_a_run_whose_fmu_does_not_come_back_from_a_step() {
    use std::os::unix::process::ExitStatusExt;
    let folder = tempfile::tempdir().unwrap();
    let Some((fmu, _)) = foreign(folder.path(), 3, "CoSimulation") else {
        return;
    };
    let temporary = folder.path().join("temporary");
    fs::create_dir(&temporary).unwrap();
    let mut running = Command::new(env!("CARGO_BIN_EXE_urdf2fmu"))
        .arg("simulate")
        .arg(&fmu)
        .env("HANGS", "1")
        .env("TMPDIR", &temporary)
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    // The step begins soon after the FMU has been unpacked.
    std::thread::sleep(Duration::from_secs(2));
    assert!(running.try_wait().unwrap().is_none(), "it does not hang");
    let sent = Command::new("kill").arg(running.id().to_string()).status();
    assert!(sent.unwrap().success());
    let since = Instant::now();
    let mut status = None;
    while status.is_none() && since.elapsed() < Duration::from_secs(10) {
        std::thread::sleep(Duration::from_millis(20));
        status = running.try_wait().unwrap();
    }
    if status.is_none() {
        running.kill().unwrap();
    }
    assert_eq!(status.expect("it ends").signal(), Some(15));
    assert_eq!(fs::read_dir(&temporary).unwrap().count(), 0, "left behind");
}
