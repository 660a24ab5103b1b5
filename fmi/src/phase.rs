//! Where an instance stands in its life, and the form of the tables that say which function may be
//! called when. The tables are in `v2` and `v3`.

use crate::common::{Interface, Version};

/// Where an instance stands in its life. Each version of FMI has its own subset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Phase {
    /// After its making or a reset.
    Instantiated = 0,
    /// Between the functions that enter and exit initialization mode.
    Initialization = 1,
    /// Initialised, no step under way.
    StepComplete = 2,
    /// FMI 2: the last step was discarded.
    StepFailed = 3,
    /// After the end.
    Terminated = 4,
    /// After an internal error.
    Error = 5,
    /// FMI 3: the importer's callback runs within a step. Never saved.
    IntermediateUpdate = 6,
    /// Model Exchange: initialised, inputs and parameters may jump.
    EventMode = 7,
    /// Model Exchange: the importer integrates.
    ContinuousTime = 8,
}

impl Phase {
    /// Those that a saved state may have.
    pub(crate) const SAVED: [Self; 7] = [
        Self::Instantiated,
        Self::Initialization,
        Self::StepComplete,
        Self::StepFailed,
        Self::Terminated,
        Self::EventMode,
        Self::ContinuousTime,
    ];

    /// Who integrates in it, where it says so.
    pub(crate) fn of(self) -> Option<Interface> {
        match self {
            Self::StepComplete | Self::StepFailed | Self::IntermediateUpdate => {
                Some(Interface::CoSimulation)
            }
            Self::EventMode | Self::ContinuousTime => Some(Interface::ModelExchange),
            Self::Instantiated | Self::Initialization | Self::Terminated | Self::Error => None,
        }
    }

    /// Whether the simulation has begun.
    pub(crate) fn is_initialized(self) -> bool {
        !matches!(self, Self::Instantiated | Self::Initialization)
    }

    /// The phase with this number, if a saved state of this version may have it.
    pub(crate) fn saved(number: u16, version: Version) -> Option<Self> {
        Self::SAVED
            .into_iter()
            .find(|phase| *phase as u16 == number)
            .filter(|phase| version == Version::V2 || *phase != Self::StepFailed)
    }
}

/// A function that needs an instance: a row of a table of phases.
pub(crate) trait Function: Copy + 'static {
    /// Version of FMI.
    const VERSION: Version;
    /// The phases of the table's columns, with their names.
    const COLUMNS: &'static [(Phase, &'static str)];
    /// The one that frees an instance.
    const FREE: Self;

    /// As in the FMI headers.
    fn name(self) -> &'static str;

    /// Whether it may be called, by column.
    fn row(self) -> &'static [bool];

    /// What to say of a function that may never be called.
    fn never(self) -> &'static str;

    /// The interface that it belongs to; none for functions of both.
    fn only(self) -> Option<Interface>;

    /// Whether it may be called in `phase`.
    fn allowed_in(self, phase: Phase) -> bool {
        let columns = Self::COLUMNS.iter().zip(self.row());
        columns
            .into_iter()
            .any(|((column, _), allowed)| *column == phase && *allowed)
    }

    /// Name of a phase.
    fn name_of(phase: Phase) -> &'static str {
        let column = Self::COLUMNS.iter().find(|(column, _)| *column == phase);
        column.map_or("unknown", |(_, name)| name)
    }

    /// What to say when it is called in a phase that does not allow it.
    fn advice(self, phase: Phase) -> String {
        if !self.row().contains(&true) {
            return self.never().into();
        }
        if phase == Phase::Error {
            let (fmi, set_state) = (Self::VERSION, Self::VERSION.set_state());
            return format!(
                "after an internal error only {fmi}Reset, {set_state} and {fmi}FreeInstance help"
            );
        }
        if phase == Phase::StepFailed {
            let (fmi, set_state) = (Self::VERSION, Self::VERSION.set_state());
            return format!(
                "the last {fmi}DoStep failed: only {set_state}, {fmi}Reset and {fmi}FreeInstance go \
                 on from it"
            );
        }
        let allowed: Vec<String> = Self::COLUMNS
            .iter()
            .filter(|(column, _)| self.allowed_in(*column))
            .map(|(_, name)| format!("'{name}'"))
            .collect();
        format!("allowed in {}", allowed.join(", "))
    }
}

/// One column of a row: `x` allowed, `o` not.
macro_rules! mark {
    (x) => {
        true
    };
    (o) => {
        false
    };
}

/// A table of phases: version and prefix, columns with their names, then a row for each function.
macro_rules! table {
    (
        $version:ident $prefix:literal, [$($column:ident $title:literal),* $(,)?], $never:expr, $only:expr;
        $($name:ident $($mark:ident)*;)*
    ) => {
        /// A function that needs an instance.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum Function { $($name),* }

        impl Function {
            /// All of them.
            #[cfg(test)]
            #[allow(dead_code, reason = "a test of all rows asks for it")]
            pub(crate) const ALL: &[Self] = &[$(Self::$name),*];
        }

        impl $crate::phase::Function for Function {
            const VERSION: $crate::common::Version = $crate::common::Version::$version;
            const COLUMNS: &'static [($crate::phase::Phase, &'static str)] =
                &[$(($crate::phase::Phase::$column, $title)),*];
            const FREE: Self = Self::FreeInstance;

            fn name(self) -> &'static str {
                match self { $(Self::$name => concat!($prefix, stringify!($name))),* }
            }

            fn row(self) -> &'static [bool] {
                match self { $(Self::$name => &[$($crate::phase::mark!($mark)),*]),* }
            }

            fn never(self) -> &'static str {
                let never: fn(Self) -> &'static str = $never;
                never(self)
            }

            fn only(self) -> Option<$crate::common::Interface> {
                let only: fn(Self) -> Option<$crate::common::Interface> = $only;
                only(self)
            }
        }
    };
}

pub(crate) use {mark, table};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saved_phases_convert_to_numbers_and_back() {
        for phase in Phase::SAVED {
            assert_eq!(Phase::saved(phase as u16, Version::V2), Some(phase));
        }
        for other in [Phase::Error, Phase::IntermediateUpdate] {
            assert_eq!(Phase::saved(other as u16, Version::V2), None);
        }
        assert_eq!(Phase::saved(Phase::StepFailed as u16, Version::V3), None);
    }
}
