//! `sculptd run --host NAME` and `--join NAME`: one sculpture, several daemons (feature `network`).

use std::io::{BufRead, Read};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::Fail;
use sculptd_daemon::config::Config;
use sculptd_daemon::local_time::unix_s;
use sculptd_daemon::shared_input::SharedInput;
use sculptd_daemon::startup::{Begun, session_settings};
use sculptd_devices::Clock;
use sculptd_network::join_link::{JoinLink, MAX_LINK, is_link, sculpture_name};
use sculptd_network::keyring::{Entropy, Invitation, OwnerFolder};
use sculptd_network::live::{Entered, Shared, SharedSettings};
use sculptd_network::random::system_entropy;
use sculptd_network::shared_error::SharedError;
use sculptd_network::shared_session::SharedSession;
use sculptd_network::station::{Identity, Station};
use sculptd_network::wire::frame::Role;
use sculptd_network::zenoh_link::{Endpoints, ZenohLink};

/// After so long without a word, or a byte of a first world, nobody hosts.
const PATIENCE: Duration = Duration::from_secs(60);

#[derive(Debug, Clone, Default, clap::Args)]
pub struct SharedArgs {
    /// Share this sculpture under a name: others join with an invitation from the folder --keys. If
    /// your sculpture of this name is shared already, join it.
    #[arg(long, value_name = "NAME", value_parser = sculpture_name,
        conflicts_with_all = ["join", "kiosk"])]
    pub host: Option<String>,
    /// Join the sculpture of this name, with the invitation --key; or the one of a link that
    /// `sculptd invite` made; `-` reads the link from standard input, as others on this computer
    /// see what is typed here.
    #[arg(long, value_name = "NAME|LINK|-", conflicts_with_all = ["mesh", "kiosk"])]
    pub join: Option<JoinText>,
    /// The folder of a host's invitations, a file each; one for each role is made where there is
    /// none. Without it, `invitations/NAME` in the user's data folder.
    #[arg(long, value_name = "FOLDER", requires = "host")]
    pub keys: Option<PathBuf>,
    /// The invitation to join with: a file that the host's person gave.
    #[arg(long, value_name = "FILE", requires = "join")]
    pub key: Option<PathBuf>,
    /// As what to join: a sculptor; a viewer, who does nothing; a device, whose samples go to the
    /// others, and which shows nothing of theirs. Without it, what the invitation says.
    #[arg(long, value_enum, value_name = "ROLE", requires = "join")]
    pub role: Option<JoinRole>,
    /// Join the sculpture of this number, if two are shared under one name: the message about them
    /// shows the numbers.
    #[arg(long, value_name = "NUMBER", requires = "join", value_parser = sculpture_number)]
    pub sculpture: Option<u32>,
    /// Your name for the others; default: the name in the link, or that of your account.
    #[arg(long = "as", value_name = "NAME")]
    pub person: Option<String>,
    /// Listen for others on this endpoint, as tcp/0.0.0.0:7447. May be repeated; default: any port.
    #[arg(long, value_name = "ENDPOINT")]
    pub listen: Vec<String>,
    /// Connect to this endpoint, as tcp/studio.local:7447. May be repeated. Others on the local
    /// network are found without it.
    #[arg(long, value_name = "ENDPOINT")]
    pub connect: Vec<String>,
}

fn sculpture_number(text: &str) -> Result<u32, String> {
    u32::from_str_radix(text, 16).map_err(|_| "expected eight hexadecimal digits".into())
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum JoinRole {
    #[default]
    Sculptor,
    Viewer,
    Device,
}

impl JoinRole {
    /// The same for the network.
    pub fn role(self) -> Role {
        match self {
            JoinRole::Sculptor => Role::Sculptor,
            JoinRole::Viewer => Role::Viewer,
            JoinRole::Device => Role::Device,
        }
    }
}

/// A name or a link. A link holds a key: it is not shown.
#[derive(Clone)]
pub struct JoinText(String);

impl From<String> for JoinText {
    fn from(text: String) -> JoinText {
        JoinText(text)
    }
}

impl std::fmt::Debug for JoinText {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("JoinText(..)")
    }
}

impl SharedArgs {
    /// Returns the link to join. Errors contain no part of a link.
    fn target(&self) -> Result<JoinLink, Fail> {
        let text = self.join.as_ref().map_or("", |j| &j.0);
        let mut read = String::new();
        if text == "-" {
            let most = 2 * MAX_LINK as u64;
            let line = std::io::stdin().lock().take(most).read_line(&mut read);
            line.map_err(|e| Fail::Usage(format!("no link on standard input: {e}")))?;
        }
        let link = if text == "-" { &read } else { text };
        if text != "-" && !is_link(text) {
            let name = sculpture_name(text).map_err(|e| Fail::Usage(format!("--join: {e}")))?;
            let key = self.key.as_deref().ok_or_else(|| {
                let text = "--join NAME needs the invitation, --key FILE; a link brings its own";
                Fail::Usage(text.into())
            })?;
            let invitation = Invitation::read(key).map_err(|e| Fail::Config(e.to_string()))?;
            return Ok(JoinLink { name, invitation, connect: Vec::new() });
        }
        if self.key.is_some() {
            return Err(Fail::Usage("a link brings its own key: leave out --key".into()));
        }
        JoinLink::read(link).map_err(|e| Fail::Usage(format!("--join: not a link to join: {e}")))
    }

    /// Returns true if the sculpture is shared.
    pub fn is_on(&self) -> bool {
        self.host.is_some() || self.join.is_some()
    }

    /// Returns true if this run is only a viewer or a device of another's sculpture. It stores
    /// nothing then.
    pub fn looks_on(&self) -> bool {
        let Some(text) = self.join.as_ref().map(|j| &*j.0) else { return false };
        let of_key = || self.key.as_deref().and_then(|key| Invitation::read(key).ok());
        let of_link = || JoinLink::read(text).ok().map(|link| link.invitation);
        let invited = || of_key().or_else(of_link).map(|i| i.role);
        let role = self.role.map(JoinRole::role).or_else(invited);
        role.is_some_and(|role| role != Role::Sculptor)
    }

    fn link(&self, name: &str, connect: &[String]) -> Result<ZenohLink, Fail> {
        let (listen, connect) = (self.listen.clone(), [connect, &self.connect].concat());
        let endpoints = Endpoints { listen, connect, multicast: true };
        ZenohLink::open(name, &endpoints).map_err(|e| Fail::Usage(format!("the network: {e}")))
    }

    fn identity(
        &self,
        role: Role,
        invitation: Invitation,
        clock: &Clock,
        entropy: Entropy,
    ) -> Identity {
        let account = ["USER", "LOGNAME", "USERNAME"].iter().find_map(|k| std::env::var(k).ok());
        let own = self.person.clone().or_else(|| invitation.name.clone());
        let name = own.or(account).unwrap_or_else(|| "somebody".into());
        let epoch_s = unix_s().saturating_sub(clock.now_us() / 1_000_000);
        Identity { name, role, invitation, epoch_s, entropy }
    }

    /// Joins a shared sculpture, or hosts one. The local loop uses the host's rate. `own` begins
    /// the world of a host, `alone` that of a device, which receives nothing.
    pub fn begin(
        &self,
        config: &mut Config,
        session: Option<&Path>,
        own: impl FnOnce(&Config) -> Result<Begun, Fail>,
        alone: impl FnOnce(&Config) -> Result<Begun, Fail>,
    ) -> Result<(Begun, Box<dyn SharedInput>), Fail> {
        let clock = Clock::monotonic();
        let mut entropy = system_entropy();
        let folder =
            self.host.as_deref().map(|name| self.folder(name, &mut entropy)).transpose()?;
        let (target, role) = match (&self.host, &folder) {
            (Some(name), Some(folder)) => {
                let (name, invitation) = (name.clone(), folder.of_owner());
                (JoinLink { name, invitation, connect: Vec::new() }, Role::Sculptor)
            }
            _ => {
                if let Some(path) = session.filter(|path| path.exists()) {
                    let path = path.display();
                    let text = "who joins begins a new session: name a file that is not there";
                    return Err(Fail::Usage(format!("{path}: {text}")));
                }
                let target = self.target()?;
                let role = self.role.map_or(target.invitation.role, JoinRole::role);
                (target, role)
            }
        };
        let JoinLink { name, invitation, connect } = target;
        let name = &*name;
        let identity = self.identity(role, invitation, &clock, entropy);
        let person = identity.name.clone();
        let is_host = folder.is_some();
        let station = match is_host {
            true => Station::join_or_host(identity, clock.now_us()),
            false => Station::join(identity, self.sculpture, clock.now_us()),
        };
        let link = Box::new(self.link(name, &connect)?);
        let settings = settings(config, name, session, folder, role);
        let shared = Shared::start(station, link, clock, settings);
        let mut shared = shared.map_err(|e| Fail::Check(e.to_string()))?;
        if !is_host {
            eprintln!("sculptd: joining '{name}'");
        }
        let (said, mut next_us) = (Clock::monotonic(), 1_000_000);
        let coming = |bytes: u64| {
            if said.now_us() >= next_us {
                next_us = said.now_us() + 1_000_000;
                eprintln!("sculptd: {:.1} MB of '{name}' are here", bytes as f64 / 1e6);
            }
        };
        let entered = shared.enter(name, role != Role::Device, PATIENCE, coming);
        let entered = entered.map_err(|e| match e {
            SharedError::Refused(_) | SharedError::NotLetIn { .. } => {
                Fail::Permission(e.to_string())
            }
            SharedError::Session(_) => Fail::Input(e.to_string()),
            e => Fail::Check(e.to_string()),
        })?;
        let begun =
            |world, journal| Begun { world, journal, warnings: Vec::new(), started_with: None };
        let begun = match entered {
            Entered::NobodyHosts => {
                let begun = own(config)?;
                shared.host(config.r#loop.rate_hz, begun.world.tick());
                eprintln!(
                    "sculptd: '{name}' is shared; others join with: sculptd run --join {name} \
                     --key {}, or by a link or QR code from: sculptd invite {name}",
                    self.folder_path(name).join("sculptor.key").display()
                );
                begun
            }
            Entered::World((world, journal), rate) => {
                if is_host {
                    eprintln!("sculptd: '{name}' is shared already: '{person}' joins it");
                }
                take_rate(config, rate);
                begun(*world, journal.map(|j| *j))
            }
            // Its world stands still.
            Entered::Device(rate) => {
                take_rate(config, rate);
                begun(alone(config)?.world, None)
            }
        };
        Ok((begun, Box::new(shared.link)))
    }

    fn folder_path(&self, name: &str) -> PathBuf {
        self.keys.clone().unwrap_or_else(|| data_folder("invitations").join(name))
    }

    fn folder(&self, name: &str, entropy: &mut Entropy) -> Result<OwnerFolder, Fail> {
        let path = self.folder_path(name);
        let opened = OwnerFolder::open(&path, entropy).map_err(|e| Fail::Config(e.to_string()));
        opened.map(|(folder, made)| {
            if made {
                eprintln!("sculptd: invitations were made in {}", path.display());
            }
            folder
        })
    }
}

fn take_rate(config: &mut Config, rate: u32) {
    if (30..=1000).contains(&rate) {
        config.r#loop.rate_hz = rate;
    }
}

/// `session`: a file of which a session is made, if it is not one already.
fn settings(
    config: &Config,
    name: &str,
    session: Option<&Path>,
    folder: Option<OwnerFolder>,
    role: Role,
) -> SharedSettings {
    let workers = config.r#loop.worker_count();
    let begun = session_settings(config);
    let session = session.map(|path| SharedSession::new(path, begun));
    let (dumps, is_viewer) = (data_folder("differences").join(name), role == Role::Viewer);
    SharedSettings { workers, dumps, session, folder, is_viewer }
}

/// A folder in the user's data folder.
pub fn data_folder(what: &str) -> PathBuf {
    let own = directories::ProjectDirs::from("", "", "sculptd");
    own.map_or_else(std::env::temp_dir, |d| d.data_dir().to_path_buf()).join(what)
}
