//! Where the lines of an expanded text come from: findings of later stages are about that text,
//! and who mends them needs the file that was written by hand.

use super::conditions;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use urdf2fmu_core::diagnostic::Diagnostic;

/// The files of an expansion, and what of them stands in which line.
#[derive(Debug)]
pub struct Origins {
    /// File and place there, bytes, of the element that begins in a line.
    pub(super) lines: BTreeMap<usize, (Rc<Path>, usize)>,
    /// Texts of the files.
    pub(super) texts: BTreeMap<PathBuf, Rc<str>>,
    /// Names of the macros.
    pub(super) macros: Vec<String>,
}

impl Origins {
    /// Adds to findings in the expanded text, which is called `name`, where it is written.
    pub fn tell(&self, name: &str, findings: &mut [Diagnostic]) {
        let unprefixed = self.unprefixed(name, findings);
        for finding in findings {
            let place = finding.place.as_ref().filter(|place| place.file == name);
            let Some(written) = place.and_then(|place| self.written(place.line)) else {
                continue;
            };
            if let Some(call) = self.call(&finding.message) {
                finding.help = Some(call);
            }
            let left_out = match finding.code {
                "U011" => conditions::unjoined(&self.texts, &finding.message),
                "U016" => conditions::left_out(&self.texts, &finding.message),
                _ => None,
            };
            // Whoever writes the link himself would lose the one that the macro has.
            if let ("U010" | "U011" | "U016", Some(calls)) = (finding.code, &unprefixed) {
                finding.help = Some(calls.clone());
            }
            if let Some(left_out) = left_out {
                finding.help = Some(match finding.help.take() {
                    Some(help) if !help.is_empty() => format!("{left_out}\n{help}"),
                    _ => left_out,
                });
            }
            finding.help = Some(match finding.help.take() {
                Some(help) => format!("{written}\n{help}"),
                None => written,
            });
        }
    }

    /// What helps where a tag that is unknown is a call of a macro without its prefix.
    fn call(&self, message: &str) -> Option<String> {
        let name = self.called(message)?;
        Some(format!("'{name}' is a macro: write <xacro:{name} …>"))
    }

    /// The macro whose name an unknown tag has.
    fn called<'m>(&self, message: &'m str) -> Option<&'m str> {
        let (_, tag) = message.split_once('<')?;
        let (name, _) = tag.split_once("> is unknown here")?;
        self.macros.iter().any(|own| own == name).then_some(name)
    }

    /// What helps where links are missing and macros are called without their prefix, which
    /// releases of ROS before Jade took.
    fn unprefixed(&self, file: &str, findings: &[Diagnostic]) -> Option<String> {
        let calls = findings.iter().filter_map(|finding| {
            let place = finding.place.as_ref().filter(|place| place.file == file)?;
            let name = self.called(&finding.message)?;
            let (file, line) = self.place(place.line)?;
            Some(format!("<xacro:{name} …> in {file}:{line}"))
        });
        let calls: Vec<String> = calls.collect();
        (!calls.is_empty()).then(|| {
            format!(
                "macros are called without their prefix, which may have it: write {}",
                calls.join(", ")
            )
        })
    }

    fn written(&self, line: usize) -> Option<String> {
        let (file, line) = self.place(line)?;
        Some(format!("it is written in {file}:{line}"))
    }

    /// The file and the line there of what begins in a line of the expanded text.
    fn place(&self, line: usize) -> Option<(String, usize)> {
        let (_, (file, at)) = self.lines.range(..=line).next_back()?;
        let text = self.texts.get(file.as_ref())?;
        let line = text.get(..*at)?.split('\n').count();
        Some((file.display().to_string(), line))
    }
}
