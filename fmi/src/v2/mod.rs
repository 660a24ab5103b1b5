//! FMI 2.0: the functions of its headers.
//!
//! | module | holds |
//! |---|---|
//! | `types` | the types of the headers |
//! | `phase` | which function may be called when |
//! | `exports` | the functions, common and co-simulation |
//! | `model_exchange` | those of Model Exchange |

pub(crate) mod exports;
pub(crate) mod model_exchange;
mod phase;
pub mod types;
