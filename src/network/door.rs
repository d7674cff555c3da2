//! The host's door: greetings of those who want in, and other hosts of the same name.
//!
//! Laws kept here:
//! * Nobody without a key gets further than a greeting. The signature of a greeting is checked only
//!   where its key is in the list, and only so many a second: junk costs a look into the list, and
//!   keeps nobody out.
//! * Of two hosts of one sculpture one stays: the one with the newer list of members, of equal ones
//!   that of the greater turn.

use std::collections::BTreeMap;

use crate::core::{Core, OtherSculpture, To};
use crate::handshake::{OwnHello, answer, is_genuine, refusal};
use crate::host_limits::{CHECKS, GONE_US, LOOK_US, MAX_MEMBERS, REFUSALS};
use crate::membership::MemberKey;
use crate::rate_limit::RateLimit;
use crate::seal::Seal;
use crate::wire::greeting::{Challenge, Greeting, Hello, VERSION};
use crate::wire::message::{Address, Nonce, Term};

/// What a person without an invitation is told.
pub const NOT_IN_LIST: &str = "the key is not one of this sculpture, or was withdrawn";

/// A station that has said hello and may join next.
#[derive(Debug)]
pub struct Greeted {
    /// From the member.
    pub up: Seal,
    /// To the member.
    pub down: Seal,
    /// What its key allows.
    pub member_key: MemberKey,
    nonce: Nonce,
    answer: Box<Challenge>,
    at_us: u64,
}

/// The door.
#[derive(Debug)]
pub struct Door {
    /// Those who have said hello.
    pub greeted: BTreeMap<Address, Greeted>,
    refusals: RateLimit,
    checks: RateLimit,
    look: Option<OwnHello>,
    look_us: u64,
    told_strangers: bool,
}

impl Door {
    /// A door at which nobody has been.
    pub fn new(now_us: u64) -> Door {
        Door {
            greeted: BTreeMap::new(),
            refusals: RateLimit::new(REFUSALS.0, REFUSALS.1, now_us),
            checks: RateLimit::new(CHECKS.0, CHECKS.1, now_us),
            look: None,
            look_us: now_us,
            told_strangers: false,
        }
    }

    /// Takes a greeting. `here`: the number of people who are here.
    pub fn hello(
        &mut self,
        core: &mut Core,
        from: Address,
        hello: &Hello,
        (term, here): (Term, u8),
        now_us: u64,
    ) {
        if hello.version != VERSION {
            let version = hello.version;
            let reason = format!("the host speaks version {VERSION}, and this is {version}");
            return self.refuse(core, from, hello, &reason, now_us);
        }
        let found = core.members.as_ref().and_then(|m| m.list().find(&hello.key));
        let Some(member_key) = found else {
            return self.refuse(core, from, hello, NOT_IN_LIST, now_us);
        };
        // A greeting that is repeated, because the way is long, has the same answer.
        if let Some(known) = self.greeted.get(&from).filter(|g| g.nonce == hello.nonce) {
            let again = Greeting::Challenge(known.answer.clone());
            return core.greet(To::Peer(from), &again);
        }
        if !self.checks.take(1.0, now_us) {
            return;
        }
        if !is_genuine(hello, from, &member_key) {
            return;
        }
        self.greeted.retain(|_, g| now_us < g.at_us + GONE_US);
        if self.greeted.len() >= MAX_MEMBERS {
            let oldest = self.greeted.iter().min_by_key(|(_, g)| g.at_us).map(|(a, _)| *a);
            oldest.and_then(|oldest| self.greeted.remove(&oldest));
        }
        let Some((challenge, (up, down))) = answer(core, hello, term, here, now_us) else { return };
        let (nonce, at_us, answer) = (hello.nonce, now_us, Box::new(challenge));
        core.greet(To::Peer(from), &Greeting::Challenge(answer.clone()));
        self.greeted.insert(from, Greeted { up, down, member_key, nonce, answer, at_us });
    }

    fn refuse(&mut self, core: &mut Core, from: Address, hello: &Hello, reason: &str, now_us: u64) {
        if self.refusals.take(1.0, now_us) {
            core.note(format!("{from:016x} was not let in: {reason}"));
            let refusal = Box::new(refusal(core, hello, reason));
            core.greet(To::Peer(from), &Greeting::Refused(refusal));
        }
    }

    /// Looks for other hosts of the same name, now and then.
    pub fn look(&mut self, core: &mut Core, now_us: u64) {
        if now_us >= self.look_us {
            self.look_us = now_us + LOOK_US;
            let own = OwnHello::draw(core, false);
            own.send(core);
            self.look = Some(own);
        }
    }

    /// Takes the answer of another host. True: it is a host of the same sculpture, and stays.
    pub fn other_host(
        &mut self,
        core: &mut Core,
        from: Address,
        challenge: &Challenge,
        term: Term,
        now_us: u64,
    ) -> bool {
        let offer = self.look.as_ref().and_then(|own| own.check(core, from, challenge, now_us));
        let Some(offer) = offer else { return false };
        if offer.about.sculpture == core.sculpture {
            let theirs = (offer.members.list().version, offer.term);
            return theirs > (core.members_version(), term);
        }
        let known = core.others.iter_mut().find(|o| o.sculpture == offer.about.sculpture);
        match known {
            Some(known) => *known = offer.about,
            None => {
                core.others.push(offer.about);
                let own = about(core, now_us);
                core.note(format!(
                    "two sculptures are shared under this name: {own}, which is this one, and {}. \
                     Who joins is asked which",
                    offer.about
                ));
            }
        }
        false
    }

    /// Another host does not know this one's key.
    pub fn strangers_host(&mut self, core: &mut Core, to: &Nonce) {
        let is_answer = self.look.as_ref().is_some_and(|own| own.is_answered_by(to));
        if is_answer && !self.told_strangers {
            self.told_strangers = true;
            core.note(
                "another host under this name does not know this key: it shares another sculpture, \
                 or the key was withdrawn",
            );
        }
    }
}

/// The own sculpture as others see it.
fn about(core: &Core, now_us: u64) -> OtherSculpture {
    let age_s = core.now_s(now_us).saturating_sub(core.begun_s) as u32;
    let here = core.log.here().count().min(255) as u8;
    OtherSculpture { sculpture: core.sculpture, here, age_s }
}
