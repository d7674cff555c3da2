//! Checks that this user may read every tablet, each on its separate node: an open gamepad beside a
//! closed tablet proves nothing.

use std::path::{Path, PathBuf};

use super::Check;
use sculptd_devices::catalogue::{Catalogue, Identification, Identity};

const NAME: &str = "pen tablets";

/// One `hidraw` node.
struct HidNode {
    path: PathBuf,
    /// The kernel's name of the device, `0003:056A:0357.0001`; empty where sysfs does not say.
    kernel: String,
    who: Option<Identity>,
    open: Result<(), std::io::Error>,
}

impl HidNode {
    /// `class`: `/sys/class/hidraw`.
    fn read(path: PathBuf, class: &Path) -> HidNode {
        let name = path.file_name().unwrap_or_default().to_owned();
        let device = class.join(&name).join("device");
        let kernel = std::fs::canonicalize(&device).ok();
        let kernel = kernel.and_then(|d| Some(d.file_name()?.to_string_lossy().into_owned()));
        let open = std::fs::File::open(&path).map(drop);
        HidNode { path, kernel: kernel.unwrap_or_default(), who: identity(&device), open }
    }

    fn is_denied(&self) -> bool {
        self.open.as_ref().is_err_and(|e| e.kind() == std::io::ErrorKind::PermissionDenied)
    }
}

fn identity(device: &Path) -> Option<Identity> {
    let uevent = std::fs::read_to_string(device.join("uevent")).ok()?;
    let value = |key: &str| {
        let mut pairs = uevent.lines().filter_map(|line| line.split_once('='));
        pairs.find(|(k, _)| *k == key).map(|(_, v)| v.trim().to_owned()).unwrap_or_default()
    };
    let id = value("HID_ID");
    let mut ids = id.split(':').skip(1).map(|part| u32::from_str_radix(part, 16).ok());
    let mut next = || ids.next()?.and_then(|n| u16::try_from(n).ok());
    Some(Identity {
        vid: next()?,
        pid: next()?,
        name: value("HID_NAME"),
        uniq: value("HID_UNIQ"),
        driver: value("DRIVER"),
        descriptor: std::fs::read(device.join("report_descriptor")).unwrap_or_default(),
        ..Identity::default()
    })
}

/// Device found on a node: a tablet with its name, another device, or unknown.
enum Kind {
    Tablet(String),
    Other,
    Unknown,
}

fn kind(node: &HidNode, catalogue: &Catalogue) -> Kind {
    let Some(who) = &node.who else { return Kind::Unknown };
    match catalogue.identify(who) {
        Identification::Identified(found) => Kind::Tablet(found.tablet.name.clone()),
        Identification::Ambiguous(_) => Kind::Tablet(who.name.clone()),
        Identification::Declined(_) => Kind::Other,
    }
}

/// Checks the tablets among the nodes of `dev`; `class`: `/sys/class/hidraw`.
pub(super) fn check(dev: &Path, class: &Path, catalogue: &Catalogue) -> Check {
    let entries = std::fs::read_dir(dev).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries
        .filter(|e| e.file_name().to_string_lossy().starts_with("hidraw"))
        .map(|e| e.path())
        .collect();
    paths.sort();
    if paths.is_empty() {
        return Check::skip(
            NAME,
            format!("no {}: nothing is plugged in", dev.join("hidraw*").display()),
        );
    }
    let nodes: Vec<HidNode> = paths.into_iter().map(|path| HidNode::read(path, class)).collect();
    let (mut good, mut closed, mut others) = (Vec::new(), Vec::new(), 0);
    for node in &nodes {
        let name = match kind(node, catalogue) {
            Kind::Tablet(name) => name,
            Kind::Unknown if node.is_denied() => "a device that may be a tablet".to_owned(),
            Kind::Unknown | Kind::Other => {
                others += 1;
                continue;
            }
        };
        let line = format!("{}: {name}", node.path.display());
        match &node.open {
            Ok(()) => good.push(line),
            Err(e) if node.is_denied() => closed.push((node, format!("{line} ({e})"))),
            Err(e) => good.push(format!("{line} ({e})")),
        }
    }
    if let [(first, _), ..] = closed[..] {
        let lines: Vec<&str> = closed.iter().map(|(_, line)| line.as_str()).collect();
        return Check::fail(
            NAME,
            format!("this user may not read {}", lines.join(", ")),
            repair(closed.iter().map(|(node, _)| *node), first),
        );
    }
    match good.len() {
        0 => Check::skip(NAME, format!("none of {others} HID devices is a tablet")),
        _ => Check::pass(NAME, format!("{} can be read", good.join(", "))),
    }
}

/// A line that gives the person who pastes it access now, and whenever the tablet is plugged in. It
/// names the devices themselves and needs no file of this program.
fn repair<'a>(nodes: impl Iterator<Item = &'a HidNode> + Clone, first: &HidNode) -> String {
    let paths: Vec<String> = nodes.clone().map(|n| format!("'{}'", n.path.display())).collect();
    let now = format!("sudo chown \"$(id -un)\" {}", paths.join(" "));
    // `0003:056A:0357.0001` without the number that it has at this plug.
    let models: std::collections::BTreeSet<&str> = nodes
        .filter_map(|n| n.kernel.rsplit_once('.').map(|(model, _)| model))
        .filter(|m| !m.is_empty() && m.bytes().all(|b| b.is_ascii_hexdigit() || b == b':'))
        .collect();
    if models.is_empty() {
        return format!("{now}   # until {} is plugged in again", first.path.display());
    }
    let rules: Vec<String> = models
        .iter()
        .map(|m| {
            format!(
                "'KERNEL==\"hidraw*\", KERNELS==\"{m}.*\", TAG+=\"uaccess\", \
                 OWNER=\"'\"$(id -un)\"'\"'"
            )
        })
        .collect();
    format!(
        "printf '%s\\n' {} | sudo tee /etc/udev/rules.d/70-sculptd-tablets.rules && {now} && \
         sudo udevadm control --reload",
        rules.join(" ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::doctor::Verdict;

    const TABLET: &str = "DRIVER=hid-generic\nHID_ID=0003:0000056A:00000357\n\
                          HID_NAME=Wacom Co.,Ltd. Intuos Pro M\n";
    const GAMEPAD: &str = "DRIVER=hid-generic\nHID_ID=0003:0000054C:00000CE6\n\
                           HID_NAME=Wireless Controller\n";
    const VENDOR: &[u8] = &[
        0x06, 0x0d, 0xff, 0x09, 0x01, 0xa1, 0x01, 0x85, 0x10, 0x75, 0x08, 0x95, 0x1a, 0x09, 0x01,
        0x81, 0x02, 0xc0,
    ];
    const STICK: &[u8] = &[
        0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, 0x15, 0x00, 0x26, 0xff, 0x00, 0x75, 0x08, 0x95, 0x02,
        0x09, 0x30, 0x09, 0x31, 0x81, 0x02, 0xc0,
    ];

    /// A machine with these devices; each may be read or not.
    struct Machine(tempfile::TempDir);

    impl Machine {
        fn with(devices: &[(&str, &[u8], bool)]) -> Machine {
            let machine = Machine(tempfile::tempdir().expect("a folder"));
            for (i, (uevent, descriptor, open)) in devices.iter().enumerate() {
                let id = uevent.lines().find_map(|l| l.strip_prefix("HID_ID=")).expect("an id");
                let mut parts = id.split(':').map(|p| u32::from_str_radix(p, 16).expect("hex"));
                let mut next = || parts.next().expect("three parts");
                let name = format!("{:04X}:{:04X}:{:04X}.{i:04X}", next(), next(), next());
                let device = machine.0.path().join("devices").join(name);
                let class = machine.0.path().join(format!("class/hidraw{i}"));
                std::fs::create_dir_all(&device).expect("a folder");
                std::fs::create_dir_all(&class).expect("a folder");
                write(&device.join("uevent"), uevent.as_bytes());
                write(&device.join("report_descriptor"), descriptor);
                std::os::unix::fs::symlink(&device, class.join("device")).expect("a link");
                std::fs::create_dir_all(machine.0.path().join("dev")).expect("a folder");
                let node = machine.0.path().join(format!("dev/hidraw{i}"));
                write(&node, b"");
                let mode =
                    std::os::unix::fs::PermissionsExt::from_mode(if *open { 0o600 } else { 0 });
                std::fs::set_permissions(&node, mode).expect("permissions");
            }
            machine
        }

        fn check(&self) -> Check {
            let catalogue = Catalogue::builtin().expect("tablets");
            check(&self.0.path().join("dev"), &self.0.path().join("class"), &catalogue)
        }
    }

    fn write(path: &Path, bytes: &[u8]) {
        std::fs::File::create(path)
            .and_then(|mut f| std::io::Write::write_all(&mut f, bytes))
            .expect("a file");
    }

    #[test]
    fn a_closed_tablet_beside_an_open_gamepad_fails_with_a_repair_that_needs_no_file() {
        let machine = Machine::with(&[(TABLET, VENDOR, false), (GAMEPAD, STICK, true)]);
        if std::fs::File::open(machine.0.path().join("dev/hidraw0")).is_ok() {
            return; // The superuser may read everything.
        }
        let found = machine.check();
        assert_eq!(found.verdict, Verdict::Fail, "{}", found.cause);
        let repair = found.repair.expect("a repair");
        assert!(repair.contains("KERNELS==\"0003:056A:0357.*\"") && !repair.contains("config/"));
    }

    #[test]
    fn a_closed_gamepad_is_no_fault_and_an_open_tablet_passes() {
        let machine = Machine::with(&[(TABLET, VENDOR, true), (GAMEPAD, STICK, false)]);
        let found = machine.check();
        assert_eq!(found.verdict, Verdict::Pass, "{}", found.cause);
        assert!(found.cause.contains("PTH-660"), "{}", found.cause);
        let alone = Machine::with(&[(GAMEPAD, STICK, false)]).check();
        assert_eq!(alone.verdict, Verdict::Skip, "{}", alone.cause);
    }

    #[test]
    fn the_repair_names_each_model_once_and_is_one_line_of_shell() {
        let machine = Machine::with(&[(TABLET, VENDOR, false), (TABLET, VENDOR, false)]);
        let class = machine.0.path().join("class");
        let node = |i: u32| HidNode::read(machine.0.path().join(format!("dev/hidraw{i}")), &class);
        let nodes = [node(0), node(1)];
        let line = repair(nodes.iter(), &nodes[0]);
        assert_eq!(line.matches("056A:0357").count(), 1, "{line}");
        // The same line as the shell sees it, without the superuser.
        let tried = line
            .replace("sudo tee /etc/udev/rules.d/70-sculptd-tablets.rules", "cat")
            .replace("sudo udevadm control --reload", "true")
            .replace("sudo chown", "true");
        let out = std::process::Command::new("sh").arg("-c").arg(&tried).output().expect("sh");
        let text = String::from_utf8_lossy(&out.stdout).into_owned();
        assert!(out.status.success(), "{tried}");
        assert!(
            text.starts_with(
                "KERNEL==\"hidraw*\", KERNELS==\"0003:056A:0357.*\", TAG+=\"uaccess\", OWNER=\""
            ),
            "{text}"
        );
    }
}
