//! documentation/licenses: the licences of everything in `binaries/`, as text for people and as
//! SPDX for programs.

use std::fmt::Write as _;

/// Crates compiled into the FMU's library, with the licence that each is used under. A test holds
/// this list to what cargo says.
const PARTS: [(&str, License); 22] = [
    ("approx", License::Apache),
    ("bytemuck", License::Both),
    ("itoa", License::Both),
    ("libc", License::Both),
    ("libm", License::Mit),
    ("matrixmultiply", License::Both),
    ("memchr", License::Mit),
    ("nalgebra", License::Apache),
    ("num-complex", License::Both),
    ("num-integer", License::Both),
    ("num-rational", License::Both),
    ("num-traits", License::Both),
    ("rawpointer", License::Both),
    ("safe_arch", License::Both),
    ("serde", License::Both),
    ("serde_core", License::Both),
    ("serde_json", License::Both),
    ("simba", License::Apache),
    ("thiserror", License::Both),
    ("typenum", License::Both),
    ("wide", License::Both),
    ("zmij", License::Mit),
];

/// Copyright lines that the licences of parts ask to pass on.
const NOTICES: &str = "
libm: Copyright (c) 2018 Jorge Aparicio. Portions derived from musl libc, Copyright (c) 2005-2020 Rich Felker, et al.;
its math library is Copyright (c) 1993, 2004 Sun Microsystems, 2003-2011 David Schultz, 2003-2009 Steven G. Kargl,
2003-2009 Bruce D. Evans, 2008 Stephen L. Moshier and 2017-2018 Arm Limited. Portions from the CORE-MATH project (MIT).

Compilers add parts of their own. Linux, built by build/platforms.sh: LLVM's libunwind (Apache-2.0 WITH LLVM-exception)
and zig's compiler runtime (MIT, Copyright (c) Zig contributors). macOS: zig's compiler runtime. Windows: the runtime of mingw-w64 (public domain and
ZPL-2.1, Copyright (c) 2009-2022 by the mingw-w64 project) and libgcc (GPL-3.0-or-later WITH GCC-exception-3.1).
";

/// A part of a library that a compiler has added.
struct Added {
    name: &'static str,
    /// As an expression of SPDX.
    license: &'static str,
    /// Endings of the libraries in which it is.
    endings: &'static [&'static str],
    comment: &'static str,
}

/// The same for programs.
const COMPILERS: [Added; 5] = [
    Added {
        name: "rust-std",
        license: "MIT OR Apache-2.0",
        endings: &["so", "dll", "dylib"],
        comment: "Rust's standard library, in all libraries",
    },
    Added {
        name: "llvm-libunwind",
        license: "Apache-2.0 WITH LLVM-exception",
        endings: &["so"],
        comment: "in libraries for Linux",
    },
    Added {
        name: "zig-compiler-rt",
        license: "MIT",
        endings: &["so", "dylib"],
        comment: "in libraries for Linux and macOS",
    },
    Added {
        name: "mingw-w64-runtime",
        license: "ZPL-2.1",
        endings: &["dll"],
        comment: "in libraries for Windows; parts are in the public domain",
    },
    Added {
        name: "libgcc",
        license: "GPL-3.0-or-later WITH GCC-exception-3.1",
        endings: &["dll"],
        comment: "in libraries for Windows",
    },
];

#[derive(Clone, Copy, Debug)]
enum License {
    Mit,
    Apache,
    Both,
}

impl License {
    /// In SPDX's words.
    fn expression(self) -> &'static str {
        match self {
            Self::Mit => "MIT",
            Self::Apache => "Apache-2.0",
            Self::Both => "MIT OR Apache-2.0",
        }
    }
}

/// Whose licences a document of SPDX is about.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// Of the FMU.
    pub name: &'a str,
    /// Of the FMU: a UUID in braces.
    pub guid: &'a str,
    /// When it was made.
    pub date: &'a str,
    /// What its author says of the model's own licence.
    pub license: Option<&'a str>,
    /// Endings of the libraries in it: `so`, `dll`, `dylib`.
    pub endings: &'a [&'a str],
}

/// The text.
pub fn text() -> String {
    let mut out = format!(
        "This FMU was made by urdf2fmu {}.\n\n\
         The robot's description, settings and meshes (resources/) belong to their authors and are under their terms.\n\n\
         The libraries in binaries/ contain the urdf2fmu simulator (MIT OR Apache-2.0), Rust's standard library (MIT OR\n\
         Apache-2.0) and these crates:\n\n",
        env!("CARGO_PKG_VERSION")
    );
    for (name, license) in PARTS {
        _ = writeln!(out, "  {name:<16} {}", license.expression());
    }
    out.push_str(NOTICES);
    for (title, license) in [
        ("MIT", include_str!("../LICENSE-MIT")),
        ("Apache-2.0", include_str!("../LICENSE-APACHE")),
    ] {
        let line = "-".repeat(78);
        _ = write!(out, "\n{line}\n{title}\n{line}\n\n{license}");
    }
    out
}

/// The same as SPDX 2.3, in its form of tags and values: the FMU, of whose own files only their
/// authors can tell, and the parts of its libraries.
pub fn spdx(subject: &Subject) -> String {
    let Subject {
        name,
        guid,
        date,
        license,
        endings,
    } = subject;
    let name = name.replace(['\n', '\r'], " ");
    let mut out = format!(
        "SPDXVersion: SPDX-2.3\nDataLicense: CC0-1.0\nSPDXID: SPDXRef-DOCUMENT\n\
         DocumentName: {name}\nDocumentNamespace: urn:uuid:{}\n\
         Creator: Tool: urdf2fmu-{}\nCreated: {date}\n",
        guid.trim_matches(['{', '}']),
        env!("CARGO_PKG_VERSION"),
    );
    let mut package = |id: &str, name: &str, license: &str, comment: &str| {
        _ = write!(
            out,
            "\nPackageName: {name}\nSPDXID: SPDXRef-{id}\nPackageDownloadLocation: NOASSERTION\n\
             FilesAnalyzed: false\nPackageLicenseConcluded: NOASSERTION\n\
             PackageLicenseDeclared: {license}\nPackageCopyrightText: NOASSERTION\n"
        );
        if !comment.is_empty() {
            _ = writeln!(out, "PackageComment: <text>{comment}</text>");
        }
        if id == "fmu" {
            out.push_str("Relationship: SPDXRef-DOCUMENT DESCRIBES SPDXRef-fmu\n");
        } else {
            _ = writeln!(out, "Relationship: SPDXRef-fmu CONTAINS SPDXRef-{id}");
        }
    };
    let own = "The robot's description, settings and meshes belong to their authors.";
    let told = license.map_or_else(String::new, |license| {
        // A tag would end the text.
        let license = license.replace(['<', '>'], " ");
        format!(" The licence of the model, as its author tells it: {license}")
    });
    package("fmu", &name, "NOASSERTION", &format!("{own}{told}"));
    package("urdf2fmu", "urdf2fmu", "MIT OR Apache-2.0", "");
    for (name, license) in PARTS {
        package(&name.replace('_', "."), name, license.expression(), "");
    }
    for part in COMPILERS {
        if part.endings.iter().any(|ending| endings.contains(ending)) {
            package(part.name, part.name, part.license, part.comment);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail")]
    use super::*;
    use std::collections::BTreeSet;

    /// Procedural macros run at build time and are not part of the library; their dependencies
    /// neither.
    const BUILD_TIME: [&str; 7] = [
        "proc-macro2",
        "quote",
        "serde_derive",
        "syn",
        "thiserror-impl",
        "unicode-ident",
        "urdf2fmu",
    ];

    #[test]
    fn licences_list_the_crates_that_cargo_links_into_the_library() {
        let output = std::process::Command::new(env!("CARGO"))
            .args([
                "tree",
                "--offline",
                "--locked",
                "-p",
                "urdf2fmu-fmi",
                "-e",
                "normal",
            ])
            .args(["--prefix", "none", "-f", "{p}"])
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .output()
            .unwrap();
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        let text = String::from_utf8(output.stdout).unwrap();
        let linked: BTreeSet<&str> = text
            .lines()
            .filter_map(|line| line.split_whitespace().next())
            .filter(|name| !BUILD_TIME.contains(name) && !name.starts_with("urdf2fmu"))
            .collect();
        let listed: BTreeSet<&str> = PARTS.iter().map(|(name, _)| *name).collect();
        let missing: Vec<_> = linked.difference(&listed).collect();
        assert!(missing.is_empty(), "not in license.txt: {missing:?}");
    }
}
