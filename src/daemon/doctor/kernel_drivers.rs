//! Reports which kernel module drives each tablet, and the effect on its reports.
//!
//! Under Linux a module sits between the tablet and `/dev/hidraw*`. Some modules pass the tablet's
//! reports on unchanged; some replace the tablet's report descriptor with another. `hid_uclogic`
//! and HID-BPF programs change the reports, too. Those reports are parsed by the replaced
//! descriptor (`sculptd_devices::catalogue`) and need no repair. Some tablets send more than a
//! mouse does only with their module; without it they send little.

use std::path::Path;

use super::Check;
use sculptd_devices::catalogue::Catalogue;

const NAME: &str = "kernel drivers of tablets";
/// Modules that replace the tablet's report descriptor.
const REWRITE: [&str; 5] = ["uclogic", "kye", "waltop", "holtek", "viewsonic"];
/// Huion, Gaomon and UC-Logic itself: only strings that hidraw cannot ask for switch these from a
/// mouse's reports to a pen's.
const NEEDS_STRINGS: [u16; 2] = [0x256c, 0x5543];

/// One `hidraw` node as sysfs has it.
struct HidrawNode {
    vid: u16,
    pid: u16,
    name: String,
    driver: String,
    module: Option<String>,
}

impl HidrawNode {
    /// `folder`: an entry of `/sys/class/hidraw`.
    fn read(folder: &Path) -> Option<HidrawNode> {
        let device = folder.join("device");
        let uevent = std::fs::read_to_string(device.join("uevent")).ok()?;
        let value = |key: &str| {
            let mut pairs = uevent.lines().filter_map(|line| line.split_once('='));
            pairs.find(|(k, _)| *k == key).map(|(_, v)| v.trim().to_owned())
        };
        // Bus, vendor and product, in hexadecimal digits.
        let id = value("HID_ID")?;
        let mut ids = id.split(':').skip(1).map(|part| u32::from_str_radix(part, 16).ok());
        let mut next = || ids.next()?.and_then(|n| u16::try_from(n).ok());
        let module = std::fs::read_link(device.join("driver/module")).ok();
        Some(HidrawNode {
            vid: next()?,
            pid: next()?,
            name: value("HID_NAME").unwrap_or_default(),
            driver: value("DRIVER").unwrap_or_default(),
            module: module.and_then(|m| Some(m.file_name()?.to_string_lossy().into_owned())),
        })
    }

    /// Returns the driver's name, with its module if known.
    fn driver(&self) -> String {
        match (&self.module, self.driver.as_str()) {
            (Some(module), _) => format!("module {module}"),
            (None, "") => "no driver".into(),
            (None, driver) => format!("driver {driver}, built into the kernel"),
        }
    }
}

/// `class`: `/sys/class/hidraw`.
pub(super) fn check(class: &Path, catalogue: &Catalogue) -> Check {
    let entries = std::fs::read_dir(class).into_iter().flatten().flatten();
    let mut folders: Vec<_> = entries.map(|e| e.path()).collect();
    folders.sort();
    let known = |n: &HidrawNode| {
        let mut ids = catalogue.tablets().iter().flat_map(|t| &t.id);
        REWRITE.iter().any(|d| n.driver.starts_with(d))
            || ids.any(|id| (id.vid, id.pid) == (n.vid, n.pid))
    };
    let nodes: Vec<HidrawNode> =
        folders.iter().filter_map(|f| HidrawNode::read(f)).filter(known).collect();
    if nodes.is_empty() {
        return Check::skip(NAME, "no tablet is plugged in that a kernel driver has");
    }
    let (mut told, mut lacks): (Vec<String>, Option<&HidrawNode>) = (Vec::new(), None);
    for node in &nodes {
        let effect = if REWRITE.iter().any(|d| node.driver.starts_with(d)) {
            "shows another report descriptor than the tablet's, by which it is read"
        } else if node.driver == "hid-generic" && NEEDS_STRINGS.contains(&node.vid) {
            lacks = lacks.or(Some(node));
            "cannot switch it to a pen's reports"
        } else {
            "leaves its reports as they are"
        };
        let who = format!("{} ({:04x}:{:04x})", node.name, node.vid, node.pid);
        let line = format!("{who}: {} {effect}", node.driver());
        if !told.contains(&line) {
            told.push(line);
        }
    }
    let cause = told.join("; ");
    match lacks {
        Some(_) => {
            Check::warn(NAME, cause, "sudo modprobe hid_uclogic, then plug the tablet in again")
        }
        None => Check::pass(NAME, cause),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::doctor::Verdict;

    fn plug(class: &Path, number: u32, uevent: &str, module: Option<&str>) {
        let device = class.join(format!("hidraw{number}/device"));
        std::fs::create_dir_all(device.join("driver")).expect("a folder");
        sculptd_geometry::io::write_beside(&device.join("uevent"), |out| {
            out.write_all(uevent.as_bytes())
        })
        .expect("written");
        if let Some(module) = module {
            let to = Path::new("/sys/module").join(module);
            std::os::unix::fs::symlink(to, device.join("driver/module")).expect("a link");
        }
    }

    #[test]
    fn each_tablet_names_its_module_and_only_one_that_lacks_it_warns() {
        let catalogue = Catalogue::builtin().expect("the built-in models");
        let class = tempfile::tempdir().expect("a folder");
        let all = || check(class.path(), &catalogue);
        assert_eq!(all().verdict, Verdict::Skip);
        // A mouse is no tablet.
        let mouse = "DRIVER=hid-generic\nHID_ID=0003:0000046D:0000C077\nHID_NAME=Mouse\n";
        plug(class.path(), 0, mouse, Some("hid_generic"));
        assert_eq!(all().verdict, Verdict::Skip);
        let huion = "DRIVER=uclogic\nHID_ID=0003:0000256C:0000006D\nHID_NAME=HUION Tablet\n";
        plug(class.path(), 1, huion, Some("hid_uclogic"));
        let wacom = "DRIVER=wacom\nHID_ID=0003:0000056A:000000B8\nHID_NAME=Wacom PTK-440\n";
        plug(class.path(), 2, wacom, Some("wacom"));
        let good = all();
        assert_eq!(good.verdict, Verdict::Pass, "{}", good.cause);
        assert!(good.cause.contains("(256c:006d): module hid_uclogic shows another"));
        assert!(good.cause.contains("(056a:00b8): module wacom leaves its reports"));
        let generic = huion.replace("uclogic", "hid-generic");
        plug(class.path(), 3, &generic, None);
        let lacks = all();
        assert_eq!(lacks.verdict, Verdict::Warn);
        assert!(lacks.cause.contains("driver hid-generic, built into the kernel cannot"));
        assert!(lacks.repair.is_some_and(|r| r.contains("modprobe hid_uclogic")));
    }
}
