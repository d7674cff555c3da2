//! An invitation as a link, to be sent in a message or shown as a QR code:
//! `sculptd://join/NAME?key=KEY&owner=KEY&role=ROLE&as=PERSON&until=S&connect=ENDPOINT&sum=SUM`.
//!
//! Laws kept here:
//! * Any holder of the link may join, because it contains the key. So no error and no `Debug`
//!   shows any of it.
//! * Reading a written link gives the same link. Unknown parts are refused, because a newer program
//!   may give them a meaning.
//! * Reading never panics, and what is read is bounded.

use std::fmt::Write;

use crate::keyring::{Invitation, from_hex};
use crate::seal::{KEY, hex};
use crate::wire::frame::{MAX_NAME, Role};
use crate::wire::keys::PublicKey;

/// Prefix of every link.
pub const SCHEME: &str = "sculptd://";
/// Bytes of a link; as many as a QR code of the largest kind holds.
pub const MAX_LINK: usize = 2048;
/// Endpoints of a link.
pub const MAX_CONNECT: usize = 8;

/// Content of a link.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JoinLink {
    /// The sculpture's name.
    pub name: String,
    /// The key, and what it allows: as what to join, and who is to, if it is for one person only.
    pub invitation: Invitation,
    /// Whom to connect to, as `tcp/studio.local:7447`; none where the local network finds the host.
    pub connect: Vec<String>,
}

/// Why a text is no link. The text itself is not in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum BadLink {
    /// It begins otherwise.
    #[error("expected a link that begins with sculptd://join/")]
    Scheme,
    /// It is longer than [`MAX_LINK`].
    #[error("a link has at most {MAX_LINK} bytes")]
    Long,
    /// The name is none.
    #[error("the name of the sculpture is not one: {NAME_EXPECTED}")]
    Name,
    /// There is no key, or it is none.
    #[error("the key is missing or cut short: expected key= and {} hexadecimal digits", KEY * 2)]
    Key,
    /// There is no key of the owner, or it is none.
    #[error("the owner's key is missing or cut short: ask for a new link")]
    Owner,
    /// The time at which it ends is none.
    #[error("the time at which it ends is not one: expected until= and seconds since 1970")]
    Until,
    /// The sum does not fit the rest.
    #[error("a character of it is wrong or missing: copy the link as a whole")]
    Sum,
    /// The role is none.
    #[error("the role is unknown: expected role=sculptor, role=viewer or role=device")]
    Role,
    /// The person's name is none.
    #[error("the name of the person is not one: expected 1 to {MAX_NAME} bytes of text")]
    Person,
    /// An endpoint is none, or there are too many.
    #[error("an endpoint is not one: expected at most {MAX_CONNECT}, as connect=tcp/HOST:PORT")]
    Connect,
    /// A `%` without two hexadecimal digits of a text behind it.
    #[error("what follows a % in it is damaged: copy the link as a whole")]
    Percent,
    /// A part with another name, or one that is there twice.
    #[error("it has a part that this version does not know, or one twice")]
    Unknown,
}

const NAME_EXPECTED: &str = "expected 1 to 64 letters, digits, '-', '_' or '.'";

/// The name of a sculpture.
///
/// # Errors
/// Says what was expected.
pub fn sculpture_name(text: &str) -> Result<String, String> {
    let fine = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    match (1..=64).contains(&text.len()) && text.chars().all(fine) {
        true => Ok(text.into()),
        false => Err(NAME_EXPECTED.into()),
    }
}

/// Returns true if a text is meant as a link and not as a name: a name has no colon.
pub fn is_link(text: &str) -> bool {
    text.contains(':')
}

/// Appends a text in the encoding of a link (RFC 3986, percent-encoding).
fn encoded(text: &str, out: &mut String) {
    for byte in text.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' | b':' => {
                out.push(byte as char);
            }
            // Writing to a text does not fail.
            _ => drop(write!(out, "%{byte:02X}")),
        }
    }
}

fn decoded(text: &str) -> Result<String, BadLink> {
    let mut bytes = text.bytes();
    let mut out = Vec::with_capacity(text.len());
    while let Some(byte) = bytes.next() {
        if byte != b'%' {
            out.push(byte);
            continue;
        }
        let mut digit = || bytes.next().and_then(|b| (b as char).to_digit(16));
        let (high, low) = (digit().ok_or(BadLink::Percent)?, digit().ok_or(BadLink::Percent)?);
        out.push((high * 16 + low) as u8);
    }
    String::from_utf8(out).map_err(|_| BadLink::Percent)
}

/// Returns true if text is a line of 1 to `most` bytes.
fn is_line(text: &str, most: usize) -> bool {
    (1..=most).contains(&text.len())
        && !text.trim().is_empty()
        && !text.chars().any(char::is_control)
}

/// Returns true if a text has the form of an endpoint; only the network can decide if it is one.
pub fn is_endpoint(text: &str) -> bool {
    let parts = text.split_once('/').is_some_and(|(way, at)| !way.is_empty() && at.contains(':'));
    parts && is_line(text, 256) && !text.contains(char::is_whitespace)
}

/// Four digits over a link, so that a wrong character in it is noticed.
fn sum(link: &str) -> String {
    hex(&ring::digest::digest(&ring::digest::SHA256, link.as_bytes()).as_ref()[..2])
}

impl JoinLink {
    /// The link. It holds the key.
    ///
    /// # Errors
    /// What [`JoinLink::read`] would say of it.
    pub fn write(&self) -> Result<String, BadLink> {
        let Invitation { role, name: person, expires_s, secret, owner } = &self.invitation;
        let mut link = format!("{SCHEME}join/");
        encoded(&self.name, &mut link);
        link += "?key=";
        link += &secret.to_hex();
        link += "&owner=";
        link += &hex(&owner.0);
        link += "&role=";
        link += role.name();
        if let Some(person) = person {
            link += "&as=";
            encoded(person, &mut link);
        }
        if let Some(until) = expires_s {
            link += &format!("&until={until}");
        }
        for endpoint in &self.connect {
            link += "&connect=";
            encoded(endpoint, &mut link);
        }
        link += &format!("&sum={}", sum(&link));
        JoinLink::read(&link).map(|_| link)
    }

    /// Reads a link.
    ///
    /// # Errors
    /// [`BadLink`], which shows nothing of the text.
    pub fn read(text: &str) -> Result<JoinLink, BadLink> {
        let text = text.trim();
        if text.len() > MAX_LINK {
            return Err(BadLink::Long);
        }
        // A scheme is the same in small and capital letters.
        let head = text.get(..SCHEME.len()).filter(|h| h.eq_ignore_ascii_case(SCHEME));
        let path = head.and_then(|h| text[h.len()..].strip_prefix("join/"));
        let path = path.ok_or(BadLink::Scheme)?;
        let (path, stated) = path.rsplit_once("&sum=").ok_or(BadLink::Sum)?;
        if stated != sum(&format!("{SCHEME}join/{path}")) {
            return Err(BadLink::Sum);
        }
        let (name, query) = path.split_once('?').ok_or(BadLink::Key)?;
        let name = sculpture_name(&decoded(name)?).map_err(|_| BadLink::Name)?;
        let (mut key, mut role, mut person, mut connect) = (None, None, None, Vec::new());
        let (mut owner, mut until) = (None, None);
        for part in query.split('&') {
            let (what, value) = part.split_once('=').ok_or(BadLink::Unknown)?;
            let value = decoded(value)?;
            let twice = match what {
                "key" => key.replace(from_hex(&value).ok_or(BadLink::Key)?).is_some(),
                "role" => {
                    let all = [Role::Sculptor, Role::Viewer, Role::Device];
                    let found = all.into_iter().find(|r| r.name() == value);
                    role.replace(found.ok_or(BadLink::Role)?).is_some()
                }
                "owner" => owner.replace(from_hex(&value).ok_or(BadLink::Owner)?).is_some(),
                "until" => until.replace(value.parse().map_err(|_| BadLink::Until)?).is_some(),
                "as" if is_line(&value, MAX_NAME) => person.replace(value).is_some(),
                "as" => return Err(BadLink::Person),
                "connect" if connect.len() < MAX_CONNECT && is_endpoint(&value) => {
                    connect.push(value);
                    false
                }
                "connect" => return Err(BadLink::Connect),
                _ => true,
            };
            if twice {
                return Err(BadLink::Unknown);
            }
        }
        let secret = key.ok_or(BadLink::Key)?;
        let owner = PublicKey(owner.ok_or(BadLink::Owner)?.0);
        let role = role.ok_or(BadLink::Role)?;
        let invitation = Invitation { role, name: person, expires_s: until, secret, owner };
        Ok(JoinLink { name, invitation, connect })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seal::Secret;
    use proptest::prelude::*;

    fn link() -> JoinLink {
        let secret = Secret([0xa7; KEY]);
        let name = Some("Zoë & Bob = 100%".into());
        let owner = PublicKey([0xb8; KEY]);
        let invitation =
            Invitation { role: Role::Viewer, name, expires_s: Some(99), secret, owner };
        let connect = vec!["tcp/studio.local:7447".into(), "tcp/[2001:db8::1]:7447".into()];
        JoinLink { name: "dragon-2".into(), invitation, connect }
    }

    #[test]
    fn a_link_that_was_written_is_read_again() {
        let text = link().write().expect("a link");
        assert_eq!(JoinLink::read(&text), Ok(link()));
        assert!(text.starts_with("sculptd://join/dragon-2?key=a7a7"));
        let rest = "&role=viewer&as=Zo%C3%AB%20%26%20Bob%20%3D%20100%25&until=99&connect=tcp/";
        assert!(text.contains(rest));
        // As a person pastes it.
        assert_eq!(
            JoinLink::read(&format!(" {}\n", text.replace("sculptd", "SCULPTD"))),
            Ok(link())
        );
        let bare = JoinLink { connect: vec![], ..link() };
        assert_eq!(JoinLink::read(&bare.write().expect("a link")), Ok(bare));
    }

    #[test]
    fn a_broken_link_is_refused_by_what_is_wrong_with_it() {
        let text = link().write().expect("a link");
        let key = "a7".repeat(KEY);
        // As one who writes links of another kind would send it: with the sum that fits.
        let summed = |text: &str| {
            let bare = text.rsplit_once("&sum=").map_or(text, |parts| parts.0);
            JoinLink::read(&format!("{bare}&sum={}", sum(bare)))
        };
        let change = |from: &str, to: &str| summed(&text.replacen(from, to, 1));
        assert_eq!(change("sculptd://join/", "https://join/"), Err(BadLink::Scheme));
        assert_eq!(change("join/", "leave/"), Err(BadLink::Scheme));
        assert_eq!(change("dragon-2", "dra/gon"), Err(BadLink::Name));
        assert_eq!(change("dragon-2", ""), Err(BadLink::Name));
        assert_eq!(change(&key, "a7a7"), Err(BadLink::Key));
        assert_eq!(change(&key, &"zz".repeat(KEY)), Err(BadLink::Key));
        assert_eq!(change(&format!("key={key}&"), ""), Err(BadLink::Key));
        assert_eq!(change("role=viewer", "role=king"), Err(BadLink::Role));
        assert_eq!(change("&role=viewer", ""), Err(BadLink::Role));
        assert_eq!(change("%C3%AB", "%C3"), Err(BadLink::Percent));
        assert_eq!(change("%20", "%2"), Err(BadLink::Percent));
        assert_eq!(change("Zo", "%0A"), Err(BadLink::Person));
        assert_eq!(change("tcp/studio.local:7447", "studio"), Err(BadLink::Connect));
        assert_eq!(change("&role=", "&wish=1&role="), Err(BadLink::Unknown));
        assert_eq!(change("&role=", "&role=viewer&role="), Err(BadLink::Unknown));
        assert_eq!(change(&"b8".repeat(KEY), "b8"), Err(BadLink::Owner));
        assert_eq!(change(&format!("owner={}&", "b8".repeat(KEY)), ""), Err(BadLink::Owner));
        assert_eq!(change("until=99", "until=soon"), Err(BadLink::Until));
        assert_eq!(summed(&text[..text.find('?').expect("a ?")]), Err(BadLink::Key));
        // Any other digit of the keys is noticed before anybody is asked.
        for at in text.find("key=").expect("a key") + 4..text.find("&role").expect("a role") {
            let mut wrong = text.clone();
            let digit = if &text[at..=at] == "0" { "1" } else { "0" };
            wrong.replace_range(at..=at, digit);
            assert!(JoinLink::read(&wrong).is_err() || &text[at..=at] == digit, "at {at}");
        }
        assert_eq!(JoinLink::read(&"x".repeat(MAX_LINK + 1)), Err(BadLink::Long));
        let crowd = JoinLink { connect: vec!["tcp/a:1".into(); MAX_CONNECT + 1], ..link() };
        assert_eq!(crowd.write(), Err(BadLink::Connect));
    }

    #[test]
    fn nothing_shows_the_key() {
        let shown = format!("{:?}", link());
        assert!(!shown.contains("a7a7") && !shown.contains("167"), "{shown}");
    }

    proptest! {
        #[test]
        fn any_text_is_read_without_a_panic(text in ".{0,200}", cut in 0usize..300) {
            let _ = JoinLink::read(&text);
            let _ = JoinLink::read(&format!("sculptd://join/a?{text}"));
            let whole = link().write().expect("a link");
            let at = cut.min(whole.len());
            let mut torn = whole[..at].to_owned();
            torn.push_str(&text);
            let _ = JoinLink::read(&torn);
        }

        #[test]
        fn any_person_and_name_come_back(
            person in "[^\\p{Cc}]{1,12}",
            name in "[a-zA-Z0-9._-]{1,64}",
        ) {
            prop_assume!(!person.trim().is_empty());
            let mut link = link();
            (link.name, link.invitation.name) = (name, Some(person));
            let text = link.write().expect("a link");
            prop_assert_eq!(JoinLink::read(&text), Ok(link));
        }
    }
}
