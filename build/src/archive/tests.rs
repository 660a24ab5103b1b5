//! Tests of writing zips.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use super::*;

fn u16_at(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes(bytes[at..at + 2].try_into().unwrap())
}

fn u32_at(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
}

/// The layout is that of PKWARE's APPNOTE 6.3.3: end record 4.3.16, directory 4.3.12.
#[test]
fn zip_has_sorted_entries_fixed_times_and_no_zip64() {
    let mut archive = Archive::default();
    archive.add("resources/model.json", vec![7; 5000]).unwrap();
    archive
        .add_executable("binaries/linux64/a.so", "x", None)
        .unwrap();
    archive.add("modelDescription.xml", "<x/>").unwrap();
    let bytes = archive.to_bytes().unwrap();

    let end = bytes.len() - 22;
    assert_eq!(&bytes[end..end + 4], b"PK\x05\x06");
    assert_eq!(u16_at(&bytes, end + 10), 3);
    let mut at = u32_at(&bytes, end + 16);
    let mut names = Vec::new();
    for _ in 0..3 {
        assert_eq!(&bytes[at..at + 4], b"PK\x01\x02");
        let (version, method) = (u16_at(&bytes, at + 6), u16_at(&bytes, at + 10));
        assert!(version <= 20, "needs version {version}: more than deflate");
        assert!(method == 0 || method == 8, "compression method {method}");
        assert_eq!(u16_at(&bytes, at + 12), 0, "midnight");
        assert_eq!(u16_at(&bytes, at + 14), (1 << 5) | 1, "1980-01-01");
        let (name, extra) = (u16_at(&bytes, at + 28), u16_at(&bytes, at + 30));
        assert_eq!(extra, 0, "extra fields carry zip64 sizes, users and times");
        let mode = u32_at(&bytes, at + 38) >> 16;
        let name = String::from_utf8(bytes[at + 46..at + 46 + usize::from(name)].to_vec());
        let name = name.unwrap();
        let expected = if name.starts_with("binaries/") {
            0o100_755
        } else {
            0o100_644
        };
        assert_eq!(mode, expected, "{name}");
        at += 46 + name.len();
        names.push(name);
    }
    assert_eq!(at, end);
    assert!(names.is_sorted(), "{names:?}");
}

#[test]
fn the_order_in_which_files_are_added_changes_no_byte() {
    let files = [("a", "1"), ("b/c", "22"), ("b/d", "333")];
    let zip = |order: [usize; 3]| {
        let mut archive = Archive::default();
        for i in order {
            archive.add(files[i].0, files[i].1).unwrap();
        }
        archive.to_bytes().unwrap()
    };
    assert_eq!(zip([0, 1, 2]), zip([2, 0, 1]));
}

#[test]
fn names_that_leave_the_folder_are_refused() {
    for name in [
        "",
        "/etc/passwd",
        "../a",
        "a/../b",
        "a//b",
        "a/",
        "C:/a",
        "a\\b",
        "a/./b",
        "nul",
        "x/con.stl",
        "a.",
        "a\n",
    ] {
        let refused = Archive::default().add(name, "");
        assert!(
            matches!(refused, Err(ArchiveError::Name { .. })),
            "{name:?}"
        );
    }
}

#[test]
fn names_that_differ_by_case_alone_clash() {
    let mut archive = Archive::default();
    archive.add("Mesh.STL", "").unwrap();
    assert!(matches!(
        archive.add("mesh.stl", ""),
        Err(ArchiveError::Clash { .. })
    ));
}

#[test]
fn safe_component_is_safe_and_keeps_ordinary_names() {
    for ordinary in ["base_link.stl", "Link 1.STL", "a+b-c.obj", ".hidden"] {
        assert_eq!(safe_component(ordinary), ordinary);
    }
    for odd in [
        "..", ".", "é.stl", "a:b", "aux", "COM1.obj", "dot.", " x", "a/b",
    ] {
        let name = safe_component(odd);
        assert!(is_safe(&name), "{odd} became {name}");
    }
}

/// One stored block (RFC 1951, 3.2.4), which this module would not have made of these bytes.
#[test]
fn what_is_deflated_already_is_copied_as_it_is() {
    const FILE: &[u8] = b"aaaaaaaaaaaaaaaa";
    const DEFLATED: &[u8] = b"\x01\x10\x00\xef\xffaaaaaaaaaaaaaaaa";
    let zip = |deflated| {
        let mut archive = Archive::default();
        archive.add("modelDescription.xml", "<x/>").unwrap();
        archive
            .add_executable("binaries/x/a.so", FILE, deflated)
            .unwrap();
        archive.to_bytes().unwrap()
    };
    let (own, copied) = (zip(None), zip(Some(DEFLATED)));
    assert!(
        copied
            .windows(DEFLATED.len())
            .any(|bytes| bytes == DEFLATED)
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.fmu");
    std::fs::write(&path, &copied).unwrap();
    let entry = read_entry(&path, "binaries/x/a.so").unwrap();
    assert_eq!(entry.as_deref(), Some(FILE));
    // But for sizes, and places that follow from them, the headers are those of any other entry.
    let header = |zip: &[u8]| {
        let start = u32_at(zip, zip.len() - 6);
        let (local, directory) = (&zip[..30 + 15], &zip[start..start + 46 + 15]);
        let sizes = |header: &[u8], at: usize| {
            let mut header = header.to_vec();
            header[at..at + 4].fill(0);
            header
        };
        (sizes(local, 18), sizes(directory, 20))
    };
    assert_eq!(header(&own), header(&copied));
}

/// As unzip, .NET before 4.6.1 and others write and read them; APPNOTE 4.4.17.1 has slashes.
#[test]
fn names_with_backslashes_are_read_as_they_are_unpacked() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.fmu");
    let mut zip = ZipWriter::new(std::fs::File::create(&path).unwrap());
    for (name, text) in [
        ("modelDescription.xml", "<x/>"),
        ("resources\\scene.bin", "scene"),
        ("binaries\\win64\\a.dll", "MZ"),
    ] {
        zip.start_file(name, SimpleFileOptions::default()).unwrap();
        zip.write_all(text.as_bytes()).unwrap();
    }
    zip.finish().unwrap();
    let unpacked = folder.path().join("unpacked");
    unpack(&path, &unpacked).unwrap();
    let scene = std::fs::read(unpacked.join("resources/scene.bin")).unwrap();
    let entry = read_entry(&path, "resources/scene.bin").unwrap();
    assert_eq!(entry, Some(scene));
    let heads = heads(&path, "binaries/").unwrap();
    assert_eq!(heads, [("win64".to_owned(), b"MZ".to_vec())]);
}

#[test]
fn a_zip_without_a_description_is_no_fmu_to_any_reader() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.fmu");
    let mut archive = Archive::default();
    archive.add("rover/modelDescription.xml", "<x/>").unwrap();
    archive.add("resources/model.json", "{}").unwrap();
    std::fs::write(&path, archive.to_bytes().unwrap()).unwrap();
    for refused in [
        read_entry(&path, "resources/model.json").unwrap_err(),
        heads(&path, "binaries/").unwrap_err(),
        unpack(&path, &folder.path().join("unpacked")).unwrap_err(),
    ] {
        assert!(refused.to_string().contains("but in 'rover'"), "{refused}");
    }
}
