//! Why a sculpture cannot be shared, for a person.

/// Why a sculpture cannot be shared.
#[derive(Debug, thiserror::Error)]
pub enum SharedError {
    /// A thread or the network cannot be had.
    #[error("{0}")]
    Start(String),
    /// The host says no.
    #[error("not let in: {0}")]
    Refused(String),
    /// The session's file cannot be made.
    #[error("the sculpture cannot be recorded: {0}")]
    Session(String),
    /// A host answers, and does not know the key, or the wanted sculpture is not there.
    #[error("not let in to '{name}': {why}")]
    NotLetIn {
        /// The sculpture's name.
        name: String,
        /// The host's reason.
        why: String,
    },
    /// Nobody answers.
    #[error("nobody hosts '{name}' here, or nobody answers: {last}")]
    Silent {
        /// The sculpture's name.
        name: String,
        /// The last that was heard.
        last: String,
    },
}
