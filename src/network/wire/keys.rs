//! Public keys, signatures and public values, as bytes.

/// Bytes of a signature (Ed25519, RFC 8032).
pub const SIGNATURE: usize = 64;
/// Bytes of a signed list of members.
pub const MAX_MEMBERSHIP: usize = 96 << 10;

/// A signature.
pub type Signature = [u8; SIGNATURE];
/// A public value of a key agreement (X25519, RFC 7748).
pub type PublicValue = [u8; 32];

/// The public half of a key (Ed25519).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct PublicKey(pub [u8; 32]);
