//! The two interfaces of FMI for what is simulated.

/// Who integrates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interface {
    /// The FMU.
    #[default]
    CoSimulation,
    /// The importer.
    ModelExchange,
}
