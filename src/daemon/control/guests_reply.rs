//! The replies about guests in browsers.

use std::time::Duration;

use super::host::Host;
use crate::web::{Web, WebKey, WebRole};
use sculptd_control::RpcError;
use sculptd_control::guests::{
    GuestInfo, GuestInviteParams, GuestLink, GuestRevokeParams, GuestRevokeReply, GuestsReply,
};
use sculptd_control::people::PersonRole;

pub(super) fn list(host: &Host) -> GuestsReply {
    let Some(web) = &host.web else { return GuestsReply::default() };
    let now = web.state.clock.now_us();
    let guests = web.state.guests.here().into_iter().map(|g| GuestInfo {
        person: g.person,
        name: g.name,
        role: role(g.role),
        key: g.key,
    });
    GuestsReply {
        served: true,
        links: web.state.keys.all(now).iter().map(|k| link(web, k, now)).collect(),
        guests: guests.collect(),
    }
}

pub(super) fn invite(host: &Host, params: &GuestInviteParams) -> Result<GuestLink, RpcError> {
    let web = served(host)?;
    let role = match params.role {
        PersonRole::Sculptor => WebRole::Sculptor,
        PersonRole::Viewer => WebRole::Viewer,
        PersonRole::Device => WebRole::Device,
    };
    if role == WebRole::Sculptor && !web.state.own_views {
        let text = "in an installation guests watch, or draw as a tablet of the screen: choose \
                    the role viewer or device";
        return Err(RpcError::failed(text));
    }
    let lasts = params.minutes.map(|m| Duration::from_secs_f64(m * 60.0));
    let now = web.state.clock.now_us();
    let key = web.state.keys.issue(role, lasts, now);
    let key = key.map_err(|e| RpcError::failed(format!("no link was made: {e}")))?;
    Ok(link(web, &key, now))
}

pub(super) fn revoke(
    host: &Host,
    params: &GuestRevokeParams,
) -> Result<GuestRevokeReply, RpcError> {
    let web = served(host)?;
    let had = web.state.guests.here().iter().filter(|g| g.key == params.key).count();
    if !web.state.keys.revoke(params.key) {
        let text = format!("no valid link has the number {}; 'guests.list' has them", params.key);
        return Err(RpcError::failed(text));
    }
    Ok(GuestRevokeReply { guests: had as u32 })
}

fn served(host: &Host) -> Result<&Web, RpcError> {
    let text = "no page is served. Start the daemon with --web";
    host.web.as_deref().ok_or_else(|| RpcError::failed(text))
}

fn role(of: WebRole) -> PersonRole {
    match of {
        WebRole::Sculptor => PersonRole::Sculptor,
        WebRole::Viewer => PersonRole::Viewer,
        WebRole::Device => PersonRole::Device,
    }
}

fn link(web: &Web, key: &WebKey, now_us: u64) -> GuestLink {
    let left = |until: u64| until.saturating_sub(now_us) as f64 / 1e6;
    GuestLink {
        key: key.id,
        role: role(key.role),
        link: web.link(key),
        expires_s: key.until_us.map(left),
    }
}
