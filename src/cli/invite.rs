//! `sculptd invite NAME`: an invitation to a shared sculpture as a link and a QR code (feature
//! `network`).

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::json;

use super::shared::{JoinRole, data_folder};
use super::{Fail, Outcome, answer};
use sculptd_daemon::local_time::unix_s;
use sculptd_daemon::qr_code::Code;
use sculptd_geometry::picture::Picture;
use sculptd_network::join_link::{JoinLink, is_endpoint, sculpture_name};
use sculptd_network::keyring::{Invitation, OwnerFolder};
use sculptd_network::random::system_entropy;

/// Squares of the quiet border (ISO/IEC 18004), and pixels of a square in a picture.
const BORDER: usize = 4;
const SCALE: usize = 8;

#[derive(Debug, clap::Args)]
pub struct InviteArgs {
    /// The sculpture, as it is hosted.
    #[arg(value_name = "NAME", value_parser = sculpture_name)]
    pub name: String,
    /// Role of the guest.
    #[arg(long, value_enum, value_name = "ROLE", default_value_t)]
    pub role: JoinRole,
    /// Invite only this person: the invitation gets a separate key, which admits nobody of another
    /// name and can be revoked separately.
    #[arg(long = "as", value_name = "PERSON")]
    pub person: Option<String>,
    /// Let the invitation end after this time, as 90m, 2h or 3d.
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub expires: Option<Duration>,
    /// Withdraw the invitations of this person, or the one whose file has this name, as "viewer".
    /// Everyone who came with them is sent away.
    #[arg(long, value_name = "PERSON",
        conflicts_with_all = ["person", "role", "expires", "output"])]
    pub withdraw: Option<String>,
    /// Address on which the host listens, as tcp/studio.example:7447. May be repeated; without it
    /// the guest looks for the host on the local network.
    #[arg(long, value_name = "ENDPOINT", value_parser = endpoint)]
    pub connect: Vec<String>,
    /// The folder of the host's invitations. Without it, `invitations/NAME` in the user's data
    /// folder.
    #[arg(long, value_name = "FOLDER")]
    pub keys: Option<PathBuf>,
    /// Write the QR code to this file: a picture (.png) or a drawing (.svg). Without it the code is
    /// shown below the link, if the output is a terminal.
    #[arg(short, long, value_name = "FILE", value_parser = picture_file)]
    pub output: Option<PathBuf>,
}

fn duration(text: &str) -> Result<Duration, String> {
    let expected = || "expected a time as 90m, 2h or 3d".to_owned();
    let unit = text.chars().last().ok_or_else(expected)?;
    let seconds = match unit {
        'm' => 60,
        'h' => 3_600,
        'd' => 86_400,
        _ => return Err(expected()),
    };
    let count: u32 = text[..text.len() - 1].parse().map_err(|_| expected())?;
    Ok(Duration::from_secs(u64::from(count) * seconds))
}

fn endpoint(text: &str) -> Result<String, String> {
    match is_endpoint(text) {
        true => Ok(text.into()),
        false => Err("expected an endpoint as tcp/studio.example:7447".into()),
    }
}

fn is_svg(path: &Path) -> Option<bool> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    ["png", "svg"].iter().position(|e| *e == ending).map(|at| at == 1)
}

fn picture_file(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    is_svg(&path)
        .map(|_| path.clone())
        .ok_or_else(|| "expected a name that ends with .png or .svg".into())
}

pub fn run(args: &InviteArgs, json: bool) -> Outcome {
    let folder = args.keys.clone().unwrap_or_else(|| data_folder("invitations").join(&args.name));
    if let Some(whom) = &args.withdraw {
        return withdraw(whom, &folder, json);
    }
    let (invitation, made) = invitation(args, &folder)?;
    if made {
        eprintln!(
            "sculptd: an invitation was made in {}; your running daemon takes it within 2 s",
            folder.display()
        );
    }
    let (name, connect) = (args.name.clone(), args.connect.clone());
    let link = JoinLink { name, invitation, connect };
    let text = link.write().map_err(|e| Fail::Usage(e.to_string()))?;
    let code = Code::of(&text).ok_or_else(|| {
        Fail::Usage("the link is too long for a QR code: name fewer endpoints".into())
    })?;
    if let Some(path) = &args.output {
        let bytes = match is_svg(path) {
            Some(true) => svg(&code).into_bytes(),
            _ => png(&code).map_err(|e| Fail::Input(format!("{}: {e}", path.display())))?,
        };
        write_private(path, &bytes).map_err(|e| Fail::io(path, &e))?;
    }
    let told = json!({
        "link": text,
        "name": link.name,
        "role": link.invitation.role.name(),
        "person": link.invitation.name,
        "expires_s": link.invitation.expires_s,
        "connect": link.connect,
        "file": args.output.as_ref().map(|p| p.display().to_string()),
    });
    let shows = args.output.is_none() && std::io::stdout().is_terminal();
    answer(json, &told, |out| {
        writeln!(out, "{text}")?;
        if shows { out.write_all(terminal(&code).as_bytes()) } else { Ok(()) }
    });
    Ok(())
}

/// The invitation of the folder for this role, person and time, and true if it was made just now.
fn invitation(args: &InviteArgs, folder: &Path) -> Result<(Invitation, bool), Fail> {
    let config = |e: &dyn std::fmt::Display| Fail::Config(e.to_string());
    let (mut entropy, role) = (system_entropy(), args.role.role());
    let (mut all, made) = OwnerFolder::open(folder, &mut entropy).map_err(|e| config(&e))?;
    let fits = |i: &Invitation| i.role == role && i.name == args.person && i.expires_s.is_none();
    let found = all.invitations.iter().map(|(_, i)| i).find(|i| fits(i) && args.expires.is_none());
    if let Some(found) = found {
        return Ok((found.clone(), made));
    }
    let expires_s = args.expires.map(|duration| unix_s() + duration.as_secs());
    let added = all.add(role, args.person.clone(), expires_s, &mut entropy);
    Ok((added.map_err(|e| config(&e))?, true))
}

/// Deletes the invitations of a person, or the files of these names.
fn withdraw(whom: &str, folder: &Path, json: bool) -> Outcome {
    let config = |e: &dyn std::fmt::Display| Fail::Config(e.to_string());
    let (all, _) = OwnerFolder::open(folder, &mut system_entropy()).map_err(|e| config(&e))?;
    let is_meant = |(path, i): &&(PathBuf, Invitation)| {
        let file = path.file_stem().is_some_and(|stem| *stem == *whom);
        i.name.as_deref() == Some(whom) || file
    };
    let meant: Vec<&PathBuf> =
        all.invitations.iter().filter(is_meant).map(|(path, _)| path).collect();
    if meant.is_empty() {
        let text = "no invitation is for a person of this name, nor has it as its file's name";
        return Err(Fail::Usage(format!("{whom}: {text} in {}", folder.display())));
    }
    for path in &meant {
        std::fs::remove_file(path).map_err(|e| Fail::io(path, &e))?;
    }
    let files: Vec<String> = meant.iter().map(|p| p.display().to_string()).collect();
    answer(json, &json!({ "withdrawn": files }), |out| {
        files.iter().try_for_each(|file| writeln!(out, "withdrawn: {file}"))?;
        writeln!(
            out,
            "Your running daemon sends the new list to all within two seconds. If none runs, the \
             invitation is valid until one does."
        )
    });
    Ok(())
}

/// Returns true if a square is dark; border squares are not.
fn is_dark(code: &Code, x: usize, y: usize) -> bool {
    let inner = |k: usize| k.checked_sub(BORDER).filter(|k| *k < code.side);
    inner(x).zip(inner(y)).is_some_and(|(x, y)| code.dark[y * code.side + x])
}

fn svg(code: &Code) -> String {
    let side = code.side + 2 * BORDER;
    let mut squares = String::new();
    for y in 0..side {
        for x in (0..side).filter(|x| is_dark(code, *x, y)) {
            squares += &format!("M{x} {y}h1v1h-1z");
        }
    }
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {side} {side}\" \
         width=\"{0}\" height=\"{0}\"><rect width=\"{side}\" height=\"{side}\" fill=\"#fff\"/>\
         <path d=\"{squares}\"/></svg>\n",
        side * SCALE
    )
}

fn png(code: &Code) -> Result<Vec<u8>, String> {
    let side = (code.side + 2 * BORDER) * SCALE;
    let place = |i: usize| is_dark(code, i % side / SCALE, i / side / SCALE);
    let rgb = (0..side * side).map(|i| if place(i) { [0; 3] } else { [255; 3] }).collect();
    Picture { width: side, height: side, rgb }.png().map_err(|e| e.to_string())
}

/// Two rows of squares to a line, black on white whatever the terminal's colours are.
fn terminal(code: &Code) -> String {
    let side = code.side + 2 * BORDER;
    let mut text = String::new();
    for y in (0..side).step_by(2) {
        text += "\x1b[30;107m";
        text.extend((0..side).map(|x| match (is_dark(code, x, y), is_dark(code, x, y + 1)) {
            (true, true) => '█',
            (true, false) => '▀',
            (false, true) => '▄',
            (false, false) => ' ',
        }));
        text += "\x1b[0m\n";
    }
    text
}

/// Writes a file that only its owner may read, beside its place, and renames it.
fn write_private(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let wrong = || std::io::Error::new(std::io::ErrorKind::InvalidInput, "expected a file's name");
    let mut hidden = std::ffi::OsString::from(".");
    hidden.push(path.file_name().ok_or_else(wrong)?);
    hidden.push(format!(".{}.part", std::process::id()));
    let beside = path.with_file_name(hidden);
    let mut options = std::fs::OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let mut file = options.open(&beside)?;
    let written = file.write_all(bytes).and_then(|()| file.sync_all());
    let done = written.and_then(|()| std::fs::rename(&beside, path));
    done.inspect_err(|_| drop(std::fs::remove_file(&beside)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_is_the_same_in_every_form() {
        let code = Code::of("sculptd://join/dragon?key=00&role=sculptor").expect("a code");
        let side = code.side + 2 * BORDER;
        let dark = code.dark.iter().filter(|d| **d).count();
        assert!(dark > 100);
        assert_eq!(svg(&code).matches("h1v1h-1z").count(), dark);
        let shown = terminal(&code);
        let count = |c: char| shown.matches(c).count();
        assert_eq!(2 * count('█') + count('▀') + count('▄'), dark);
        assert_eq!(shown.lines().count(), side.div_ceil(2));
        assert!(
            (0..side).all(|k| !is_dark(&code, k, 0) && !is_dark(&code, 0, k)),
            "a quiet border"
        );
        assert!(png(&code).expect("a picture").starts_with(b"\x89PNG"));
    }
}
