//! Guests who join in a browser: their links, and who is connected.

use serde::{Deserialize, Serialize};

use crate::people::PersonRole;

/// Reply of `guests.list`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct GuestsReply {
    /// True if the daemon serves a page for guests: it was started with `--web`.
    pub served: bool,
    /// The valid links, the oldest first.
    pub links: Vec<GuestLink>,
    /// Who is connected, in the order in which they joined.
    pub guests: Vec<GuestInfo>,
}

/// A link by which guests join.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct GuestLink {
    /// Number of the link, for `guests.revoke`.
    pub key: u32,
    /// Permissions of who has it.
    pub role: PersonRole,
    /// The link with its secret: give it to guests only.
    pub link: String,
    /// Seconds until it expires; `null`: it is valid as long as the daemon runs.
    pub expires_s: Option<f64>,
}

/// A connected guest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct GuestInfo {
    /// Number of the guest's person in the sculpture; 0 for a viewer or a tablet.
    pub person: u8,
    /// As the guest wants to be called.
    pub name: String,
    /// Permissions of the guest.
    pub role: PersonRole,
    /// Number of the link that the guest joined by.
    pub key: u32,
}

/// Parameters of `guests.invite`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GuestInviteParams {
    /// Permissions of who has the link.
    pub role: PersonRole,
    /// Minutes until it expires; without it, it is valid as long as the daemon runs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = 0.1, max = 100_000.0)))]
    pub minutes: Option<f64>,
}

/// Parameters of `guests.revoke`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GuestRevokeParams {
    /// Number of the link.
    pub key: u32,
}

/// Reply of `guests.revoke`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct GuestRevokeReply {
    /// Number of guests who had joined by it; they are disconnected.
    pub guests: u32,
}
