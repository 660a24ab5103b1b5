//! The floating-point control word: the default inside the library, the host's outside.
//!
//! Hosts change it: a Delphi program unmasks exceptions, a game engine or a library loaded with
//! `-ffast-math` flushes denormals to zero, an interval library turns the rounding direction.
//! Results would then depend on the host, or a division by zero would end it. So every guarded call
//! runs under the default control word (round to nearest, denormals kept, no traps) and gives the
//! host's back, also after a panic.
//!
//! On other processors than x86-64 and 64-bit ARM nothing is done.
#![allow(
    unsafe_code,
    reason = "the control word is read and written by inline assembly"
)]

/// Restores the host's control word when dropped.
pub(crate) struct Guard {
    /// The host's, where it differs from the default.
    host: Option<Word>,
}

impl Guard {
    /// Installs the default control word.
    pub(crate) fn new() -> Self {
        let word = read();
        let host = (word & CONTROL != DEFAULT & CONTROL).then_some(word);
        if host.is_some() {
            write(DEFAULT);
        }
        Self { host }
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        if let Some(word) = self.host {
            write(word);
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod arch {
    /// MXCSR
    pub(super) type Word = u32;
    /// All exceptions masked, round to nearest, denormals kept, no exception raised so far.
    pub(super) const DEFAULT: Word = 0x1F80;
    /// All but the six sticky exception flags, which any arithmetic may raise.
    pub(super) const CONTROL: Word = !0x3F;

    pub(super) fn read() -> Word {
        let mut word: Word = 0;
        // SAFETY: stores the 32-bit register into a local of that size.
        unsafe {
            std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut word, options(nostack, preserves_flags));
        }
        word
    }

    pub(super) fn write(word: Word) {
        // SAFETY: `word` is the default or was read from the register, so no reserved bit is set.
        unsafe {
            std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const word, options(nostack, preserves_flags));
        }
    }
}

#[cfg(target_arch = "aarch64")]
mod arch {
    /// FPCR; the sticky flags are in a register of their own.
    pub(super) type Word = u64;
    /// Round to nearest, denormals kept, no traps.
    pub(super) const DEFAULT: Word = 0;
    /// AHP, DN, FZ, RMode, FZ16 and the trap enables.
    pub(super) const CONTROL: Word = 0x07C8_9F00;

    pub(super) fn read() -> Word {
        let word: Word;
        // SAFETY: reads a register that user code may read.
        unsafe {
            std::arch::asm!("mrs {}, fpcr", out(reg) word, options(nostack, preserves_flags))
        };
        word
    }

    pub(super) fn write(word: Word) {
        // SAFETY: `word` is the default or was read from the register.
        unsafe { std::arch::asm!("msr fpcr, {}", in(reg) word, options(nostack, preserves_flags)) };
    }
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
mod arch {
    pub(super) type Word = u32;
    pub(super) const DEFAULT: Word = 0;
    pub(super) const CONTROL: Word = 0;

    pub(super) fn read() -> Word {
        DEFAULT
    }

    pub(super) fn write(_word: Word) {}
}

use arch::{CONTROL, DEFAULT, Word, read, write};

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;

    #[test]
    fn the_floating_point_control_word_of_the_host_is_restored() {
        // Intel SDM, volume 1, 10.2.3: bits 13–14 = 01 round down, bit 15 flush to zero, bit 6
        // denormals are zero.
        let host = DEFAULT | 0x2000 | 0x8000 | 0x40;
        write(host);
        let inside = {
            let _guard = Guard::new();
            read()
        };
        let after = read();
        write(DEFAULT);
        assert_eq!(inside & CONTROL, DEFAULT & CONTROL);
        assert_eq!(after, host);
    }
}
