//! Which systems a library is for, as its first bytes tell. The build script uses this, too.
//!
//! Sources: System V ABI (ELF), chapter 4; Microsoft's PE format, "COFF file header"; Apple's
//! `mach-o/loader.h`, `mach-o/fat.h` and `mach/machine.h`.

/// `CPU_TYPE_X86_64`
pub const X86_64: u32 = 0x0100_0007;
/// `CPU_TYPE_ARM64`
pub const ARM64: u32 = 0x0100_000c;
/// `FAT_MAGIC`, big-endian: a file of several files.
pub const UNIVERSAL: [u8; 4] = [0xca, 0xfe, 0xba, 0xbe];

/// FMI 3.0's names of the systems; none for a file of another kind.
pub fn platforms(file: &[u8]) -> Vec<&'static str> {
    read(file).unwrap_or_default()
}

fn bytes<const N: usize>(file: &[u8], at: usize) -> Option<[u8; N]> {
    file.get(at..)?.first_chunk().copied()
}

fn read(file: &[u8]) -> Option<Vec<&'static str>> {
    let darwin = |processor| match processor {
        X86_64 => Some("x86_64-darwin"),
        ARM64 => Some("aarch64-darwin"),
        _ => None,
    };
    let start: [u8; 4] = bytes(file, 0)?;
    let found = match start {
        [0x7f, b'E', b'L', b'F'] => {
            // e_machine; all of these are little-endian.
            let found = match u16::from_le_bytes(bytes(file, 18)?) {
                3 => "x86-linux",
                62 => "x86_64-linux",
                183 => "aarch64-linux",
                243 => "riscv64-linux",
                _ => return None,
            };
            vec![found]
        }
        [b'M', b'Z', ..] => {
            let header = usize::try_from(u32::from_le_bytes(bytes(file, 0x3c)?)).ok()?;
            let [b'P', b'E', 0, 0] = bytes(file, header)? else {
                return None;
            };
            let found = match u16::from_le_bytes(bytes(file, header + 4)?) {
                0x014c => "x86-windows",
                0x8664 => "x86_64-windows",
                0xaa64 => "aarch64-windows",
                _ => return None,
            };
            vec![found]
        }
        [0xcf, 0xfa, 0xed, 0xfe] => vec![darwin(u32::from_le_bytes(bytes(file, 4)?))?],
        UNIVERSAL => {
            let count = u32::from_be_bytes(bytes(file, 4)?).min(8);
            let parts = (0..count).map_while(|i| bytes(file, 8 + 20 * i as usize));
            parts
                .filter_map(|part| darwin(u32::from_be_bytes(part)))
                .collect()
        }
        _ => return None,
    };
    Some(found)
}
