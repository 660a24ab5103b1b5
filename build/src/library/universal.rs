//! One file for both kinds of Mac, as FMI 2.0's single folder for them needs.
//!
//! A universal file is a table of the files in it, and of these files, each of which begins at a
//! memory page. A page of arm64 has 16 kB, one of `x86_64` 4 kB; the file is that which
//! `lipo -create` makes. Signatures are part of the files and stay valid.
//!
//! Source: Apple's `mach-o/fat.h`, whose numbers are big-endian.

use super::header::{ARM64, UNIVERSAL};

/// The universal file of single ones, sorted by the size of their pages.
///
/// # Panics
/// If a part is no Mach-O file with 64 bits, or has 4 GB: the caller has looked at their headers.
pub fn universal(parts: &[&[u8]]) -> Vec<u8> {
    let word = |part: &[u8], at: usize| {
        let bytes = part[at..].first_chunk().copied();
        u32::from_le_bytes(bytes.expect("a Mach-O header has 32 bytes"))
    };
    let page = |part: &[u8]| if word(part, 4) == ARM64 { 14 } else { 12 };
    let mut parts = parts.to_vec();
    parts.sort_by_key(|part| page(part));
    let size = |length: usize| u32::try_from(length).expect("libraries have less than 4 GB");
    let mut table = UNIVERSAL.to_vec();
    table.extend(size(parts.len()).to_be_bytes());
    let mut body: Vec<u8> = Vec::new();
    let head = 8 + 20 * parts.len();
    for part in parts {
        let place = (head + body.len()).next_multiple_of(1 << page(part));
        body.resize(place - head, 0);
        body.extend(part);
        let entry = [
            word(part, 4),
            word(part, 8),
            size(place),
            size(part.len()),
            page(part),
        ];
        table.extend(entry.iter().flat_map(|number| number.to_be_bytes()));
    }
    table.extend(body);
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::header::{X86_64, platforms};

    /// `mach-o/loader.h`: magic, processor, kind of it, and whatever follows.
    fn thin(processor: u32, length: usize) -> Vec<u8> {
        let head = [0xfeed_facf, processor, 3, 6, 0, 0, 0, 0];
        let mut file: Vec<u8> = head.iter().flat_map(|w: &u32| w.to_le_bytes()).collect();
        file.extend((0..length - 32).map(|i| u8::try_from(i % 251).expect("less than 251")));
        file
    }

    #[test]
    fn a_universal_file_has_each_part_whole_from_a_page_of_its_processor_on() {
        let (intel, arm) = (thin(X86_64, 5000), thin(ARM64, 70_001));
        let file = universal(&[&arm, &intel]);
        assert_eq!(file, universal(&[&intel, &arm]), "the order does not count");
        assert_eq!(platforms(&file), ["x86_64-darwin", "aarch64-darwin"]);
        let words: Vec<usize> = file[..48]
            .chunks(4)
            .map(|w| u32::from_be_bytes(w.try_into().expect("four bytes")) as usize)
            .collect();
        assert_eq!(words[4..7], [0x1000, 5000, 12]);
        assert_eq!(words[9..12], [0x4000, 70_001, 14]);
        assert_eq!(file[0x1000..0x1000 + 5000], intel);
        assert_eq!(file[0x4000..], arm);
    }
}
