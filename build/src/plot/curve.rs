//! The curves and panels that a picture is made of, and the finished picture.

/// A variable over time.
#[derive(Clone, Copy, Debug)]
pub struct Curve<'c> {
    /// Of the variable.
    pub name: &'c str,
    /// FMI's name of the unit; empty where there is none.
    pub unit: &'c str,
    /// Whether it changes in jumps only.
    pub stepped: bool,
    /// As many as there are times; what is not finite is a gap.
    pub values: &'c [f64],
}

/// A picture and what had to be said about it.
#[derive(Debug)]
pub struct Plot {
    /// The file's content.
    pub svg: String,
    /// What was left out.
    pub note: Option<String>,
}
