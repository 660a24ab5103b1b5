//! The hash of Fowler, Noll and Vo (FNV-1a, 64 bits): names, checksums and comparisons, nothing
//! secret.
//!
//! Each step is a bijection, so a change of any one byte changes the result. Tables of many keys
//! have a quicker one.

use std::hash::Hasher;

/// A hash that is fed piece by piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    /// Takes in more bytes; how they are cut into pieces makes no difference.
    pub fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    /// The hash of all bytes so far.
    pub fn value(self) -> u64 {
        self.0
    }
}

/// A quick hash of a few numbers, for tables whose order nobody sees. Unlike the standard library's
/// it knows no secret: who chooses the numbers can make a table slow, and nothing more.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quick(u64);

impl Quick {
    /// An odd number without a pattern: 2^64 over the golden ratio.
    const FACTOR: u64 = 0x9E37_79B9_7F4A_7C15;

    fn mix(&mut self, x: u64) {
        self.0 = (self.0.rotate_left(23) ^ x).wrapping_mul(Self::FACTOR);
    }
}

impl Hasher for Quick {
    fn write(&mut self, bytes: &[u8]) {
        let (eights, rest) = bytes.as_chunks::<8>();
        for eight in eights {
            self.mix(u64::from_le_bytes(*eight));
        }
        let mut last = [0; 8];
        last[..rest.len()].copy_from_slice(rest);
        if !rest.is_empty() {
            self.mix(u64::from_le_bytes(last));
        }
    }

    fn write_u32(&mut self, x: u32) {
        self.mix(u64::from(x));
    }

    fn write_u64(&mut self, x: u64) {
        self.mix(x);
    }

    fn write_usize(&mut self, x: usize) {
        self.mix(x as u64);
    }

    /// Tables take the lowest bits and the highest: each must depend on all that came in.
    fn finish(&self) -> u64 {
        let x = (self.0 ^ (self.0 >> 32)).wrapping_mul(Self::FACTOR);
        x ^ (x >> 29)
    }
}

/// The hash of `bytes`.
pub fn fnv1a(bytes: &[u8]) -> u64 {
    let mut hash = Fnv::default();
    hash.add(bytes);
    hash.value()
}

#[cfg(test)]
mod tests {
    use super::{Fnv, Quick, fnv1a};
    use std::collections::BTreeSet;
    use std::hash::Hash;
    use std::hash::Hasher;

    #[test]
    fn the_published_values_are_met() {
        // Test vectors of draft-eastlake-fnv.
        assert_eq!(fnv1a(b""), 0xCBF2_9CE4_8422_2325);
        assert_eq!(fnv1a(b"foobar"), 0x8594_4171_F739_67E8);
    }

    #[test]
    fn pieces_hash_like_the_whole() {
        let mut hash = Fnv::default();
        hash.add(b"foo");
        hash.add(b"bar");
        assert_eq!(hash.value(), fnv1a(b"foobar"));
    }

    /// Points of a grid differ in few bits. Random numbers of 16 bits would fill 63 percent of all
    /// places, 1 - 1/e; a tenth more or less is far beyond chance.
    #[test]
    fn points_of_a_grid_spread_over_the_lowest_and_the_highest_bits() {
        let hash = |key: [i32; 3]| {
            let mut hash = Quick::default();
            key.hash(&mut hash);
            hash.finish()
        };
        let axis = || -20..20;
        let grid = axis().flat_map(|x| axis().map(move |y| (x, y)));
        let all: Vec<u64> = grid
            .flat_map(|(x, y)| (0..41).map(move |z| hash([x, y, z])))
            .take(1 << 16)
            .collect();
        for shift in [0, 48] {
            let places: BTreeSet<u64> = all.iter().map(|h| (h >> shift) & 0xFFFF).collect();
            let part = f64::from(u32::try_from(places.len()).expect("few")) / 65536.0;
            assert!((part - 0.632).abs() < 0.06, "{shift}: {part}");
        }
    }
}
