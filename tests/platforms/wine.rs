//! Programs for Windows on this machine: a cross-compiler and Wine.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Where Debian's packages wine64 and wine put it, or anybody else.
const PROGRAMS: [&str; 3] = ["wine64", "/usr/lib/wine/wine64", "wine"];
/// The variant with POSIX threads where Debian has both.
const COMPILERS: [&str; 2] = ["x86_64-w64-mingw32-gcc-posix", "x86_64-w64-mingw32-gcc"];

/// Wine with a configuration of its own under `target/`, made at first use.
pub struct Wine {
    program: &'static str,
    compiler: &'static str,
    prefix: PathBuf,
}

/// How a program ended.
pub struct Ended {
    /// Exit code 0.
    pub success: bool,
    /// Its standard output.
    pub said: String,
    /// Its standard error.
    pub complained: String,
}

impl Wine {
    /// Wine and the compiler, or the name of the missing one.
    ///
    /// # Errors
    /// A sentence for a message.
    pub fn find() -> Result<Self, String> {
        let first = |programs: &[&'static str]| {
            programs.iter().copied().find(|program| {
                Command::new(program)
                    .arg("--version")
                    .stdout(Stdio::null())
                    .stderr(Stdio::null())
                    .status()
                    .is_ok_and(|status| status.success())
            })
        };
        let compiler = first(&COMPILERS)
            .ok_or("there is no cross-compiler; on Debian: apt-get install gcc-mingw-w64-x86-64")?;
        let program =
            first(&PROGRAMS).ok_or("there is no wine; on Debian: apt-get install wine64")?;
        let prefix = Path::new(env!("CARGO_TARGET_TMPDIR")).join("wine");
        let wine = Self {
            program,
            compiler,
            prefix,
        };
        wine.prepare();
        Ok(wine)
    }

    /// Makes the configuration, which takes some seconds; two tests at once: the second waits.
    fn prepare(&self) {
        let lock = File::create(self.prefix.with_extension("lock")).expect("target/ is writable");
        lock.lock().expect("target/ can be locked");
        let ready = self.prefix.join("ready");
        if !ready.exists() {
            fs::create_dir_all(&self.prefix).expect("target/ is writable");
            let status = self.command("wineboot", &["-i"]).status();
            assert!(
                status.is_ok_and(|status| status.success()),
                "wineboot failed"
            );
            File::create(ready).expect("target/ is writable");
        }
    }

    fn command<A: AsRef<OsStr>>(&self, program: impl AsRef<OsStr>, arguments: &[A]) -> Command {
        let mut command = Command::new(self.program);
        command
            .arg(program)
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .env("WINEPREFIX", &self.prefix)
            .env("WINEDEBUG", "-all")
            // No questions about optional parts.
            .env("WINEDLLOVERRIDES", "mscoree,mshtml=")
            .env_remove("DISPLAY");
        command
    }

    /// Runs a program. Its output goes through files: Wine's server stays for a while and would
    /// keep a pipe open.
    pub fn run<A: AsRef<OsStr>>(&self, program: &Path, arguments: &[A]) -> Ended {
        let folder = tempfile::tempdir().expect("a folder for the output");
        let (said, complained) = (folder.path().join("out"), folder.path().join("err"));
        let create = |path: &Path| File::create(path).expect("a file for the output");
        let status = self
            .command(program, arguments)
            .stdout(create(&said))
            .stderr(create(&complained))
            .status()
            .expect("wine has just run");
        let read = |path: &Path| fs::read_to_string(path).expect("text");
        Ended {
            success: status.success(),
            // The C library there writes CR LF.
            said: read(&said).replace('\r', ""),
            complained: read(&complained).replace('\r', ""),
        }
    }

    /// Compiles C sources for Windows; the program needs only system DLLs.
    pub fn compile(&self, program: &Path, include: &Path, sources: &[PathBuf]) {
        let output = Command::new(self.compiler)
            .args([
                "-std=gnu11",
                "-O1",
                "-Wall",
                "-Wextra",
                "-Werror",
                "-static",
            ])
            // Formats as in C, not as in Microsoft's old library.
            .arg("-D__USE_MINGW_ANSI_STDIO=1")
            .arg("-I")
            .arg(include)
            .arg("-o")
            .arg(program)
            .args(sources)
            .arg("-lpthread")
            .output()
            .expect("the compiler has just run");
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
}
