//! Saved states, and their bytes.
//!
//! Bytes, little-endian:
//!
//! | at | size | what |
//! |---|---|---|
//! | 0 | 8 | `urdf2fmu` |
//! | 8 | 4 | [`VERSION`] |
//! | 12 | 2 | phase |
//! | 14 | 2 | version of FMI, 2 or 3 |
//! | 16 | 8 | FNV-1a of the guid |
//! | 24 | 8 | start time, s |
//! | 32 | 8 | stop time, s; infinite if undefined |
//! | 40 | 8 | tolerance; 0 if undefined |
//! | 48 | 8 | length n of the simulation's bytes |
//! | 56 | n | the simulation's bytes, see the core |
//! | 56 + n | 8 | FNV-1a of all before |
//!
//! A saved state holds no pointer, so it serves any instance of the same FMU, in any process, that
//! speaks the same version of FMI. Log settings belong to the importer and are not saved.
#![allow(unsafe_code, reason = "hands states to the importer as pointers")]

use crate::common::Version;
use crate::error::FmiError;
use crate::experiment::Experiment;
use crate::phase::Phase;
use crate::pointers::Out;
use std::ffi::c_void;
use urdf2fmu_core::hash::fnv1a;
use urdf2fmu_core::simulation::{Simulation, Snapshot};

const MAGIC: &[u8; 8] = b"urdf2fmu";
const VERSION: u32 = 3;
const HEADER: usize = 56;
const CHECKSUM: usize = 8;

/// Marks a living saved state, so that most wrong pointers are refused instead of followed.
const TAG: u64 = 0x7564_6632_666d_7573;

/// A copy of an instance's state.
#[derive(Debug)]
#[repr(C)]
pub(crate) struct SavedState {
    /// [`TAG`]; 0 once freed.
    tag: u64,
    pub(crate) guid: GuidHash,
    pub(crate) version: Version,
    pub(crate) phase: Phase,
    pub(crate) experiment: Experiment,
    pub(crate) simulation: Snapshot,
}

/// Identifies the FMU that a state belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct GuidHash(u64);

impl GuidHash {
    /// Of a guid as it stands in modelDescription.xml.
    pub(crate) fn new(guid: &str) -> Self {
        Self(fnv1a(guid.as_bytes()))
    }
}

impl SavedState {
    pub(crate) fn new(
        guid: GuidHash,
        version: Version,
        phase: Phase,
        experiment: Experiment,
        simulation: Snapshot,
    ) -> Self {
        Self {
            tag: TAG,
            guid,
            version,
            phase,
            experiment,
            simulation,
        }
    }

    /// Length of [`Self::to_bytes`].
    pub(crate) fn byte_len(&self) -> usize {
        HEADER + self.simulation.byte_len() + CHECKSUM
    }

    /// See the module's table.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let simulation = self.simulation.to_bytes();
        let mut bytes = Vec::with_capacity(HEADER + simulation.len() + CHECKSUM);
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((self.phase as u16).to_le_bytes());
        bytes.extend((self.version as u16).to_le_bytes());
        bytes.extend(self.guid.0.to_le_bytes());
        bytes.extend(self.experiment.start.to_le_bytes());
        bytes.extend(self.experiment.stop.to_le_bytes());
        bytes.extend(self.experiment.tolerance.to_le_bytes());
        bytes.extend((simulation.len() as u64).to_le_bytes());
        bytes.extend(simulation);
        bytes.extend(fnv1a(&bytes).to_le_bytes());
        bytes
    }

    /// Writes [`Self::to_bytes`] into an array of the importer, which must have their length.
    ///
    /// # Errors
    /// [`FmiError::State`]
    #[cfg_attr(small, optimize(size))]
    pub(crate) fn write_to(&self, place: &mut Out<u8>) -> Result<(), FmiError> {
        let bytes = self.to_bytes();
        if place.len() != bytes.len() {
            return Err(FmiError::State {
                reason: format!("it needs {} bytes, not {}", bytes.len(), place.len()),
            });
        }
        for (index, byte) in bytes.into_iter().enumerate() {
            place.set(index, byte);
        }
        Ok(())
    }

    /// Whether an instance of this FMU and version can continue from it.
    ///
    /// # Errors
    /// [`FmiError::State`] if it cannot.
    #[cfg_attr(small, optimize(size))]
    pub(crate) fn check(&self, guid: GuidHash, version: Version) -> Result<(), FmiError> {
        check(self.guid, self.version, guid, version)
    }

    /// Reads what [`Self::to_bytes`] wrote for the same FMU.
    ///
    /// # Errors
    /// [`FmiError::State`] for anything else.
    #[cfg_attr(small, optimize(size))]
    pub(crate) fn from_bytes(
        guid: GuidHash,
        fmi: Version,
        simulation: &Simulation,
        bytes: &[u8],
    ) -> Result<Self, FmiError> {
        let refused = |reason: &str| FmiError::State {
            reason: reason.to_owned(),
        };
        let mut reader = Reader { rest: bytes };
        let short = || refused("it is too short");
        if reader.take::<8>().ok_or_else(short)? != *MAGIC {
            return Err(refused("it does not begin like a saved state of urdf2fmu"));
        }
        let version = reader.u32().ok_or_else(short)?;
        if version != VERSION {
            return Err(FmiError::State {
                reason: format!("it has version {version}; this library reads version {VERSION}"),
            });
        }
        let phase = reader.u16().ok_or_else(short)?;
        let spoken = reader.u16().ok_or_else(short)?;
        let found = GuidHash(reader.u64().ok_or_else(short)?);
        let experiment = Experiment {
            start: reader.f64().ok_or_else(short)?,
            stop: reader.f64().ok_or_else(short)?,
            tolerance: reader.f64().ok_or_else(short)?,
        };
        let len = reader.u64().ok_or_else(short)?;
        let Some((body, checksum)) = reader.rest.split_last_chunk::<CHECKSUM>() else {
            return Err(short());
        };
        if len != body.len() as u64 {
            return Err(FmiError::State {
                reason: format!("it has {} bytes of simulation instead of {len}", body.len()),
            });
        }
        if fnv1a(&bytes[..bytes.len() - CHECKSUM]) != u64::from_le_bytes(*checksum) {
            return Err(refused("its checksum is wrong: it has been damaged"));
        }
        let spoken = Version::from_number(spoken)
            .ok_or_else(|| refused("its version of FMI does not exist"))?;
        check(found, spoken, guid, fmi)?;
        let phase = Phase::saved(phase, fmi).ok_or_else(|| refused("its phase does not exist"))?;
        if !experiment.is_legal() {
            return Err(refused("its experiment is not legal"));
        }
        let simulation = simulation.saved_from_bytes(body)?;
        if simulation.is_initialized() != phase.is_initialized() {
            return Err(refused("its phase does not fit the simulation"));
        }
        Ok(Self::new(guid, fmi, phase, experiment, simulation))
    }

    /// Hands it to the importer.
    pub(crate) fn into_pointer(self) -> *mut c_void {
        Box::into_raw(Box::new(self)).cast()
    }
}

/// Whether a state of the FMU `found` and the version `spoken` serves `guid` and `fmi`.
#[cfg_attr(small, optimize(size))]
fn check(found: GuidHash, spoken: Version, guid: GuidHash, fmi: Version) -> Result<(), FmiError> {
    let reason = if spoken != fmi {
        format!("it was saved by {spoken} functions; {fmi} functions read their own only")
    } else if found != guid {
        "it belongs to another FMU".to_owned()
    } else {
        return Ok(());
    };
    Err(FmiError::State { reason })
}

/// The saved state behind a pointer from [`SavedState::into_pointer`].
///
/// # Errors
/// [`FmiError`] if it is null or not one of ours.
///
/// # Safety
/// `state` is null or points to readable memory of the size of a saved state, such as this library
/// returned; no other call uses it meanwhile.
pub(crate) unsafe fn saved<'a>(state: *mut c_void) -> Result<&'a mut SavedState, FmiError> {
    let pointer = state.cast::<SavedState>();
    if pointer.is_null() {
        return Err(FmiError::NullPointer {
            argument: "FMUstate",
        });
    }
    // SAFETY: not null and readable by the caller's promise; nothing but the tag is read before it
    // is known.
    if !pointer.is_aligned() || unsafe { (&raw const (*pointer).tag).read() } != TAG {
        return Err(FmiError::State {
            reason: "the pointer does not come from this library, or was freed".into(),
        });
    }
    // SAFETY: the tag says that `into_pointer` made it and `free` has not yet dropped it.
    Ok(unsafe { &mut *pointer })
}

/// Drops the saved state behind `state`; null is legal.
///
/// # Errors
/// [`FmiError`] if it is not one of ours.
///
/// # Safety
/// As [`saved`]; afterwards `state` is dangling.
pub(crate) unsafe fn free(state: *mut c_void) -> Result<(), FmiError> {
    if state.is_null() {
        return Ok(());
    }
    // SAFETY: the caller's promise.
    let saved = unsafe { saved(state) }?;
    // Volatile, or the compiler drops a store to memory that is freed at once.
    // SAFETY: a valid reference.
    unsafe { (&raw mut saved.tag).write_volatile(0) };
    // SAFETY: made by `into_pointer`, and the tag is gone, so that it is not followed again.
    drop(unsafe { Box::from_raw(state.cast::<SavedState>()) });
    Ok(())
}

struct Reader<'a> {
    rest: &'a [u8],
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.rest.split_first_chunk::<N>()?;
        self.rest = rest;
        Some(*first)
    }

    fn u16(&mut self) -> Option<u16> {
        self.take().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    fn f64(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instance::tests::instance;

    #[test]
    fn bytes_read_back_to_the_same_bytes() {
        let instance = instance();
        let state = instance.save();
        let bytes = state.to_bytes();
        assert_eq!(bytes.len(), state.byte_len());
        let read = SavedState::from_bytes(state.guid, Version::V2, instance.simulation(), &bytes)
            .expect("own bytes");
        assert_eq!(read.to_bytes(), bytes);
    }

    #[test]
    fn every_truncation_and_every_flipped_bit_is_refused() {
        let instance = instance();
        let state = instance.save();
        let mut bytes = state.to_bytes();
        let read = |bytes: &[u8]| {
            SavedState::from_bytes(state.guid, Version::V2, instance.simulation(), bytes)
        };
        for len in 0..bytes.len() {
            assert!(read(&bytes[..len]).is_err(), "cut to {len} bytes");
        }
        for bit in 0..8 * bytes.len() {
            bytes[bit / 8] ^= 1 << (bit % 8);
            assert!(read(&bytes).is_err(), "bit {bit} flipped");
            bytes[bit / 8] ^= 1 << (bit % 8);
        }
        bytes.push(0);
        assert!(read(&bytes).is_err(), "one byte too many");
    }

    #[test]
    fn a_state_of_another_fmu_is_refused_with_the_reason() {
        let instance = instance();
        let bytes = instance.save().to_bytes();
        let error = SavedState::from_bytes(
            GuidHash::new("{other}"),
            Version::V2,
            instance.simulation(),
            &bytes,
        )
        .expect_err("another guid");
        assert!(error.to_string().contains("another FMU"), "{error}");
    }

    #[test]
    fn a_state_of_the_other_version_of_fmi_is_refused_with_the_reason() {
        let instance = instance();
        let state = instance.save();
        let bytes = state.to_bytes();
        let error = SavedState::from_bytes(state.guid, Version::V3, instance.simulation(), &bytes)
            .expect_err("the other version");
        assert!(error.to_string().contains("fmi2 functions"), "{error}");
    }

    #[test]
    fn bytes_with_a_forged_checksum_but_an_illegal_phase_are_refused() {
        let instance = instance();
        let state = instance.save();
        let mut bytes = state.to_bytes();
        bytes[12] = Phase::Error as u8;
        let end = bytes.len() - CHECKSUM;
        let checksum = fnv1a(&bytes[..end]).to_le_bytes();
        bytes[end..].copy_from_slice(&checksum);
        assert!(
            SavedState::from_bytes(state.guid, Version::V2, instance.simulation(), &bytes).is_err()
        );
    }

    /// Found by fuzzing: a step from 0.3 s began with a simulation that stood at its beginning, and
    /// made up for all of it in steps of 1e-7 s.
    #[test]
    fn a_phase_that_does_not_fit_the_simulation_is_refused() {
        let instance = instance();
        let state = instance.save();
        let mut accepted = Vec::new();
        for phase in Phase::SAVED {
            let mut bytes = state.to_bytes();
            bytes[12] = phase as u8;
            let end = bytes.len() - CHECKSUM;
            let checksum = fnv1a(&bytes[..end]).to_le_bytes();
            bytes[end..].copy_from_slice(&checksum);
            if SavedState::from_bytes(state.guid, Version::V2, instance.simulation(), &bytes)
                .is_ok()
            {
                accepted.push(phase);
            }
        }
        assert_eq!(accepted, [Phase::Instantiated, Phase::Initialization]);
    }
}
