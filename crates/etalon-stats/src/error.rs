//! The error type: a parameter out of range, a sampler or pdf that failed, a test that was cancelled.

use std::fmt;

/// Shorthand for the crate's fallible functions.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a test could not be done. A sampler that is wrong is not an error but a rejected [`Outcome`](crate::Outcome).
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// A parameter is out of range.
    Parameter {
        /// The field that holds it, such as `level` of [`Protocol`](crate::Protocol).
        name: &'static str,
        /// What is wrong with its value.
        message: String,
        /// Which values can be used.
        hint: Option<&'static str>,
    },
    /// A sampler or pdf that is computed in another process or read from a file failed with this error.
    External(Box<dyn std::error::Error + Send + Sync>),
    /// [`Protocol::cancelled`](crate::Protocol::cancelled) returned true.
    Cancelled,
}

impl Error {
    /// Wraps the error of a sampler or pdf that is computed in another process or read from a file.
    pub fn external(error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self::External(error.into())
    }

    /// A parameter that is out of range.
    pub(crate) fn parameter(name: &'static str, message: String, hint: &'static str) -> Self {
        Self::Parameter { name, message, hint: Some(hint) }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Parameter { name, message, hint } => {
                write!(f, "{name}: {message}")?;
                hint.map_or(Ok(()), |hint| write!(f, " ({hint})"))
            }
            Self::External(error) => error.fmt(f),
            Self::Cancelled => f.write_str("cancelled"),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::External(error) => error.source(),
            _ => None,
        }
    }
}

/// Whether a test has been cancelled, asked between batches of samples.
pub(crate) type Cancelled = fn() -> bool;

/// Ends a computation that has been cancelled.
pub(crate) fn poll(cancelled: Cancelled) -> Result<()> {
    if cancelled() { Err(Error::Cancelled) } else { Ok(()) }
}
