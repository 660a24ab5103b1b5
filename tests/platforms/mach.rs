//! What a library for macOS says of itself.
//!
//! Sources: Apple's `mach-o/loader.h`, `mach-o/nlist.h`, `mach-o/fat.h`, and `cs_blobs.h` for
//! signatures, whose numbers are big-endian.

use sha2::{Digest, Sha256};

/// Bytes of a page of a signature, at least.
pub const SIGNED_PAGE: usize = 4096;

/// A Mach-O file for one processor.
#[derive(Debug, Default)]
pub struct Mach {
    /// Least version of macOS.
    pub minimum: Option<(u32, u32)>,
    /// As which it is loaded.
    pub name: String,
    /// Libraries.
    pub needed: Vec<String>,
    /// `LC_RPATH`
    pub search_paths: Vec<String>,
    /// Symbols that others may use.
    pub defined: Vec<String>,
    /// Symbols of others.
    pub undefined: Vec<String>,
    /// Where there is one.
    pub signature: Option<Signature>,
}

/// Hashes of all pages.
#[derive(Debug)]
pub struct Signature {
    /// "Ad hoc": without a certificate.
    pub of_nobody: bool,
    /// How many pages it covers.
    pub pages: usize,
    /// How many of them are not as signed.
    pub damaged_pages: usize,
}

fn little(file: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(*file[at..].first_chunk().unwrap())
}

fn big(file: &[u8], at: usize) -> usize {
    u32::from_be_bytes(*file[at..].first_chunk().unwrap()) as usize
}

fn text(file: &[u8], at: usize) -> String {
    let end = file[at..].iter().position(|&byte| byte == 0).unwrap();
    String::from_utf8(file[at..at + end].to_vec()).unwrap()
}

impl Mach {
    /// The files in a universal one, with their processors.
    pub fn parts(file: &[u8]) -> Vec<(&'static str, &[u8])> {
        assert_eq!(big(file, 0), 0xcafe_babe, "a universal file");
        (0..big(file, 4))
            .map(|i| {
                let entry = 8 + 20 * i;
                let processor = match big(file, entry) {
                    0x0100_0007 => "x86_64",
                    0x0100_000c => "arm64",
                    other => panic!("processor {other:x}"),
                };
                let (place, size) = (big(file, entry + 8), big(file, entry + 12));
                assert_eq!(place % (1 << big(file, entry + 16)), 0, "from a page on");
                (processor, &file[place..place + size])
            })
            .collect()
    }

    /// Reads the load commands and what they point at.
    pub fn read(file: &[u8]) -> Self {
        const LC_SYMTAB: u32 = 0x2;
        const LC_LOAD_DYLIB: u32 = 0xc;
        const LC_ID_DYLIB: u32 = 0xd;
        const LC_CODE_SIGNATURE: u32 = 0x1d;
        const LC_BUILD_VERSION: u32 = 0x32;
        const LC_VERSION_MIN_MACOSX: u32 = 0x24;
        const LC_RPATH: u32 = 0x8000_001c;
        assert_eq!(little(file, 0), 0xfeed_facf, "64 bits");
        assert_eq!(little(file, 12), 6, "a dynamic library");
        let mut mach = Self::default();
        let mut at = 32;
        for _ in 0..little(file, 16) {
            let named = || text(file, at + little(file, at + 8) as usize);
            let version = |at| (little(file, at) >> 16, little(file, at) >> 8 & 0xff);
            match little(file, at) {
                LC_SYMTAB => mach.symbols(file, at),
                LC_LOAD_DYLIB => mach.needed.push(named()),
                LC_ID_DYLIB => mach.name = named(),
                LC_RPATH => mach.search_paths.push(named()),
                LC_BUILD_VERSION => {
                    assert_eq!(little(file, at + 8), 1, "macOS");
                    mach.minimum = Some(version(at + 12));
                }
                LC_VERSION_MIN_MACOSX => mach.minimum = Some(version(at + 8)),
                LC_CODE_SIGNATURE => {
                    mach.signature = Some(Signature::read(file, little(file, at + 8) as usize));
                }
                _ => {}
            }
            at += little(file, at + 4) as usize;
        }
        mach
    }

    fn symbols(&mut self, file: &[u8], command: usize) {
        let number = |at| little(file, command + at) as usize;
        let (place, count, names) = (number(8), number(12), number(16));
        for i in 0..count {
            let entry = place + 16 * i;
            let (kind, name) = (file[entry + 4], names + little(file, entry) as usize);
            // N_EXT without N_PEXT and N_STAB; N_TYPE zero: of others.
            if kind & 0xf1 == 1 {
                let list = if kind & 0x0e == 0 {
                    &mut self.undefined
                } else {
                    &mut self.defined
                };
                list.push(text(file, name));
            }
        }
    }
}

impl Signature {
    fn read(file: &[u8], place: usize) -> Self {
        const CODE_DIRECTORY: usize = 0xfade_0c02;
        const SHA256: u8 = 2;
        assert_eq!(big(file, place), 0xfade_0cc0, "a signature");
        let blobs = (0..big(file, place + 8)).map(|i| place + big(file, place + 16 + 8 * i));
        let directory = blobs
            .into_iter()
            .find(|at| big(file, *at) == CODE_DIRECTORY);
        let directory = directory.expect("a directory of hashes");
        let number = |at| big(file, directory + at);
        let (hashes, pages, limit) = (directory + number(16), number(28), number(32));
        assert_eq!(
            limit, place,
            "all that comes before the signature is signed"
        );
        assert_eq!((file[directory + 36], file[directory + 37]), (32, SHA256));
        let size = 1_usize << file[directory + 39];
        let damaged = (0..pages).filter(|page| {
            let bytes = &file[page * size..((page + 1) * size).min(limit)];
            let hash = &file[hashes + 32 * page..hashes + 32 * (page + 1)];
            Sha256::digest(bytes).as_slice() != hash
        });
        Self {
            of_nobody: number(12) & 2 != 0,
            pages,
            damaged_pages: damaged.count(),
        }
    }
}
