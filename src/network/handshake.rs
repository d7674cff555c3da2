//! How a member and a host come to keys: the member's greeting and the host's answer, made and
//! checked.

use crate::core::{Core, OtherSculpture, To};
use crate::membership::{MemberKey, SignedMembership};
use crate::seal::{Agreement, Seal};
use crate::wire::greeting::{Challenge, Greeting, Hello, Refusal, VERSION};
use crate::wire::keys::PublicValue;
use crate::wire::message::{Address, Nonce, Term};

const HELLO: &str = "sculptd hello 2";
const CHALLENGE: &str = "sculptd challenge 2";
const REFUSAL: &str = "sculptd refusal 1";

/// The own greeting.
#[derive(Debug)]
pub struct OwnHello {
    hello: Hello,
    agreement: Agreement,
}

/// A host that answered, with a proof that it may host.
#[derive(Debug, Clone)]
pub struct HostOffer {
    /// The host.
    pub from: Address,
    /// The sculpture, and who is there.
    pub about: OtherSculpture,
    /// The host's turn.
    pub term: Term,
    /// The host's list of members.
    pub members: SignedMembership,
    value: PublicValue,
}

impl OwnHello {
    /// A greeting that is signed by the station's key. `claims`: see [`Hello::claims`].
    pub fn draw(core: &mut Core, claims: bool) -> OwnHello {
        let agreement = Agreement::draw();
        let mut hello = Hello {
            version: VERSION,
            nonce: core.nonce(),
            value: agreement.public,
            key: core.invitation.secret.public().name(),
            claims,
            signature: [0; 64],
        };
        hello.signature = core.invitation.secret.sign(HELLO, &hello.signed(core.address));
        OwnHello { hello, agreement }
    }

    /// Sends it to whoever hosts.
    pub fn send(&self, core: &mut Core) {
        core.greet(To::Host, &Greeting::Hello(self.hello.clone()));
    }

    /// Returns true if an answer is to this greeting.
    pub fn is_answered_by(&self, to: &Nonce) -> bool {
        *to == self.hello.nonce
    }

    /// Checks an answer: the owner's list of members, and that the host may host by it, and by a
    /// newer one if one is known.
    pub fn check(
        &self,
        core: &Core,
        from: Address,
        answer: &Challenge,
        now_us: u64,
    ) -> Option<HostOffer> {
        if !self.is_answered_by(&answer.to) {
            return None;
        }
        let members = SignedMembership::from_bytes(&answer.members, &core.invitation.owner).ok()?;
        let now_s = core.now_s(now_us);
        let may = |members: &SignedMembership| members.list().may_host(&answer.host, now_s);
        let signed = answer.signed(&self.hello.value, from);
        let proved = may(&members)
            && core.members.as_ref().is_none_or(may)
            && answer.host.has_signed(CHALLENGE, &signed, &answer.signature);
        let Challenge { sculpture, here, age_s, term, value, .. } = *answer;
        let about = OtherSculpture { sculpture, here, age_s };
        proved.then_some(HostOffer { from, about, term, members, value })
    }

    /// Returns true if a host with a known key (the owner's, or one in the list) refuses this
    /// greeting.
    pub fn is_refused(&self, core: &Core, from: Address, refusal: &Refusal, now_us: u64) -> bool {
        let now_s = core.now_s(now_us);
        let may = |members: &SignedMembership| members.list().may_host(&refusal.host, now_s);
        self.is_answered_by(&refusal.to)
            && (refusal.host == core.invitation.owner || core.members.as_ref().is_some_and(may))
            && refusal.host.has_signed(REFUSAL, &refusal.signed(from), &refusal.signature)
    }

    /// The keys of an answer.
    pub fn accept(self, offer: &HostOffer) -> Option<(Seal, Seal)> {
        let (own, theirs) = (self.hello.value, offer.value);
        self.agreement.seals(&theirs, &[&own, &theirs, &self.hello.nonce])
    }
}

/// Returns true if the holder of the key signed the greeting, from this address.
pub fn is_genuine(hello: &Hello, from: Address, by: &MemberKey) -> bool {
    by.key.has_signed(HELLO, &hello.signed(from), &hello.signature)
}

/// A host's refusal of a greeting.
pub fn refusal(core: &Core, hello: &Hello, reason: &str) -> Refusal {
    let secret = &core.invitation.secret;
    let (to, reason, host) = (hello.nonce, reason.into(), secret.public());
    let mut refusal = Refusal { to, reason, host, signature: [0; 64] };
    refusal.signature = secret.sign(REFUSAL, &refusal.signed(core.address));
    refusal
}

/// The host's answer to a greeting, and the keys. `None`: the greeting's value is none, or the host
/// has no list of members.
pub fn answer(
    core: &Core,
    hello: &Hello,
    term: Term,
    here: u8,
    now_us: u64,
) -> Option<(Challenge, (Seal, Seal))> {
    let agreement = Agreement::draw();
    let own = agreement.public;
    let age_s = core.now_s(now_us).saturating_sub(core.begun_s);
    let mut challenge = Challenge {
        to: hello.nonce,
        value: own,
        sculpture: core.sculpture,
        term,
        here,
        age_s: age_s.min(u64::from(u32::MAX)) as u32,
        members: core.members.as_ref()?.to_bytes(),
        host: core.invitation.secret.public(),
        signature: [0; 64],
    };
    let signed = challenge.signed(&hello.value, core.address);
    challenge.signature = core.invitation.secret.sign(CHALLENGE, &signed);
    let seals = agreement.seals(&hello.value, &[&hello.value, &own, &hello.nonce])?;
    Some((challenge, seals))
}
