//! A growing file of results: whole rows only, so that it can be read at any time.

use crate::importer::csv::{Table, cells};
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Bytes that are kept back before they are written.
const KEPT: usize = 1 << 16;

/// A recording. A run after a reset gets a file of its own: `out.csv`, then `out-2.csv`.
pub struct Recording {
    asked: PathBuf,
    path: PathBuf,
    file: File,
    names: Vec<String>,
    text: String,
    rows: usize,
}

impl Recording {
    /// Makes the file, with its first line.
    ///
    /// # Errors
    /// The system's.
    pub fn new(path: &Path, names: &[String]) -> io::Result<Self> {
        let mut recording = Self {
            asked: path.to_owned(),
            path: path.to_owned(),
            file: File::create(path)?,
            names: names.to_owned(),
            text: String::new(),
            rows: 0,
        };
        recording.head();
        recording.flush()?;
        Ok(recording)
    }

    fn head(&mut self) {
        let table = Table {
            names: self.names.clone(),
            rows: Vec::new(),
        };
        self.text.push_str(&table.to_text());
        self.rows = 0;
    }

    /// The file that grows now.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Appends a row.
    ///
    /// # Errors
    /// The system's.
    pub fn row(&mut self, row: &[f64]) -> io::Result<()> {
        self.text.push_str(&cells(row).join(","));
        self.text.push('\n');
        self.rows += 1;
        if self.text.len() > KEPT {
            self.flush()
        } else {
            Ok(())
        }
    }

    /// Writes what was kept back.
    ///
    /// # Errors
    /// The system's.
    pub fn flush(&mut self) -> io::Result<()> {
        let text = std::mem::take(&mut self.text);
        self.file.write_all(text.as_bytes())
    }

    /// Begins the next file; a run of one row or none is begun anew in its own.
    ///
    /// # Errors
    /// The system's.
    pub fn next(&mut self) -> io::Result<()> {
        if self.rows > 1 {
            self.flush()?;
            let numbers = 2..u32::MAX;
            let mut free = numbers
                .map(|n| numbered(&self.asked, n))
                .filter(|p| !p.exists());
            self.path = free.next().unwrap_or_else(|| self.asked.clone());
        }
        self.text.clear();
        self.file = File::create(&self.path)?;
        self.head();
        Ok(())
    }
}

/// `out.csv`, 2 → `out-2.csv`
fn numbered(path: &Path, n: u32) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(format!("-{n}"));
    let mut numbered = path.with_file_name(name);
    if let Some(extension) = path.extension() {
        numbered.as_mut_os_string().push(".");
        numbered.as_mut_os_string().push(extension);
    }
    numbered
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_run_has_a_file_and_files_of_others_stay() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.b.csv");
        let names = ["time".to_owned(), "x".to_owned()];
        std::fs::write(folder.path().join("a.b-2.csv"), "mine").expect("a file");
        let mut recording = Recording::new(&path, &names).expect("a file");
        recording.row(&[0.0, 1.0]).expect("a row");
        recording.next().expect("the same file");
        recording.row(&[0.0, 2.0]).expect("a row");
        recording.row(&[0.5, 3.0]).expect("a row");
        recording.next().expect("another file");
        recording.row(&[0.0, 4.0]).expect("a row");
        recording.flush().expect("written");
        let text = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("a file");
        assert_eq!(text("a.b.csv"), "\"time\",\"x\"\n0.0,2.0\n0.5,3.0\n");
        assert_eq!(text("a.b-2.csv"), "mine");
        assert_eq!(text("a.b-3.csv"), "\"time\",\"x\"\n0.0,4.0\n");
        assert!(recording.path().ends_with("a.b-3.csv"));
    }
}
