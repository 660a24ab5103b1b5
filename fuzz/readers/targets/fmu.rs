//! The description of an FMU, or, where the first byte is that of a zip, an FMU.

#[path = "../../../build/src/archive/mod.rs"]
mod archive;

use super::importer::description::Description;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Largest number of elements of which each is looked at.
const FEW: usize = 4096;

thread_local! {
    /// Of the zips, which are read from files.
    static FOLDER: TempDir = tempfile::tempdir().expect("a folder");
}

pub fn fmu(data: &[u8]) {
    if data.first() == Some(&b'P') {
        FOLDER.with(|folder| zip(folder.path(), data));
    } else {
        description(data);
    }
}

fn description(data: &[u8]) {
    let Ok(found) = Description::from_bytes(data.to_vec()) else {
        return;
    };
    assert!(!found.guid.is_empty());
    for variable in found.variables.iter().take(FEW) {
        if !found.elements.is_empty() {
            let element = found.elements[variable.value_reference as usize];
            assert!(element.index < element.count);
        }
    }
    let names = found.arrays.values().flatten().take(FEW);
    assert!(names.into_iter().all(|name| found.find(name).is_some()));
}

fn zip(folder: &Path, data: &[u8]) {
    let (path, inner) = (folder.join("a.fmu"), folder.join("inner"));
    fs::write(&path, data).expect("a file");
    let text = archive::read_entry(&path, "modelDescription.xml");
    if let Ok(Some(bytes)) = &text {
        description(bytes);
    }
    let heads = archive::heads(&path, "binaries/");
    let unpacked = archive::unpack(&path, &inner);
    // Nothing lands beside the folder that it is unpacked in.
    let beside = fs::read_dir(folder).expect("a folder").count();
    assert!(beside <= 2, "{beside} entries");
    if unpacked.is_ok() {
        assert!(text.is_ok() && heads.is_ok());
        assert!(inner.join("modelDescription.xml").exists());
    }
    if inner.exists() {
        fs::remove_dir_all(&inner).expect("what was unpacked");
    }
}
