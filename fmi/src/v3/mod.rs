//! FMI 3.0: the functions of its headers.
//!
//! | module | holds |
//! |---|---|
//! | `types` | the types of the headers |
//! | `phase` | which function may be called when |
//! | `exports` | the functions of an instance's life, its states and its steps |
//! | `values` | get and set functions |
//! | `step` | steps in which the importer is called |
//! | `model_exchange` | those of Model Exchange |
//! | `refused` | what this FMU does not offer |

pub(crate) mod exports;
pub(crate) mod model_exchange;
mod phase;
pub(crate) mod refused;
mod step;
pub mod types;
pub(crate) mod values;
