//! `sculptd invite NAME`: an invitation to a shared sculpture as a link and a QR code (feature
//! `network`).

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};

use serde_json::json;

use super::shared::{JoinRole, data_folder};
use super::{Fail, Outcome, answer};
use sculptd_daemon::qr_code::Code;
use sculptd_geometry::picture::Picture;
use sculptd_network::join_link::{JoinLink, is_endpoint, sculpture_name};
use sculptd_network::keyring::{Invitation, Keyring, fresh};
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
    let (invitation, made) = invitation(args, &folder)?;
    if made {
        eprintln!(
            "sculptd: an invitation was made in {}; a host that is running learns of it when it \
             is started anew",
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

/// The invitation of the folder for this role, or for this person; where there is none, one is
/// made. Whether it was.
fn invitation(args: &InviteArgs, folder: &Path) -> Result<(Invitation, bool), Fail> {
    let config = |e: &dyn std::fmt::Display| Fail::Config(e.to_string());
    let (mut entropy, role) = (system_entropy(), args.role.role());
    let (keyring, made) = Keyring::of_folder(folder, &mut entropy).map_err(|e| config(&e))?;
    let fits = |i: &&Invitation| i.role == role && i.name == args.person;
    if let Some(found) = keyring.0.iter().find(fits) {
        return Ok((found.clone(), made));
    }
    let made = Invitation { role, name: args.person.clone(), secret: fresh(&mut entropy) };
    // Whatever the person's name is, the file's is one.
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let stem: String = match &args.person {
        Some(person) => {
            format!("{}-{}", role.name(), person.chars().map(plain).collect::<String>())
        }
        None => role.name().into(),
    };
    let free = (0..1000).map(|k| match k {
        0 => folder.join(format!("{stem}.key")),
        k => folder.join(format!("{stem}-{k}.key")),
    });
    let path = free.into_iter().find(|p| !p.exists());
    let path = path.ok_or_else(|| Fail::Config(format!("{}: too many keys", folder.display())))?;
    made.write(&path).map_err(|e| config(&e))?;
    Ok((made, true))
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
