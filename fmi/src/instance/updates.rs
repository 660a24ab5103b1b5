//! The state of a step of FMI 3 within which the importer is called.

use crate::common::{IntermediateUpdate, Status};
use std::ffi::c_void;
use urdf2fmu_core::simulation::Snapshot;

/// The importer's function that is called within steps, and what it is told.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Callback {
    pub(crate) function: IntermediateUpdate,
    /// Passed back as it came.
    pub(crate) environment: *mut c_void,
    /// Whether the importer takes steps that end early.
    pub(crate) may_end_early: bool,
}

/// How an importer is called within steps.
#[derive(Debug)]
pub(crate) struct Updates {
    pub(super) callback: Callback,
    /// Per variable of the layout, whether the callback may get or set it.
    pub(super) required: Vec<bool>,
    /// Where the step under way began: a step that fails leaves nothing of it.
    pub(super) before: Snapshot,
    pub(super) way: Way,
}

impl Updates {
    /// Whether the callback may get or set a variable.
    pub(super) fn has(&self, index: usize) -> bool {
        self.required[index]
    }
}

/// A step under way.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Way {
    /// s
    pub(super) begin: f64,
    /// Where it will end, s.
    pub(super) end: f64,
    /// Where it was to end, s.
    pub(super) asked: f64,
    /// Tries of a solver step before it.
    pub(super) tries: u64,
}

/// What comes next in a step.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Next {
    /// Nothing: it is done, or was discarded.
    End {
        status: Status,
        /// Whether it ended before it was to.
        early: bool,
        /// Where the simulation stands, s.
        time: f64,
    },
    /// The callback is to be called, outside of the guard.
    Update { callback: Callback, time: f64 },
}
