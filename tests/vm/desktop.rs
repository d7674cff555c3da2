//! Runs inside the virtual machine of `devices/tests/vm/desktop.sh`: an X server or a Wayland
//! compositor whose libinput reads a uhid tablet through the kernel's wacom driver, and the
//! daemon's window on a software adapter, which reads the same tablet through hidraw. Strokes are
//! drawn with the pen where the window must take them and where it must not. Prints one `VM ok` or
//! `VM FAIL` line for each thing shown.
// A test program: it prints its findings and waits for other programs.
#![allow(clippy::print_stdout, clippy::disallowed_methods)]

#[cfg(target_os = "linux")]
#[path = "desktop/desktops.rs"]
mod desktops;
#[cfg(target_os = "linux")]
#[path = "desktop/drive.rs"]
mod drive;
#[cfg(target_os = "linux")]
#[path = "desktop/moved.rs"]
mod moved;
#[cfg(target_os = "linux")]
#[path = "desktop/show.rs"]
mod show;
#[cfg(target_os = "linux")]
#[path = "../../devices/examples/vm_guest/uhid.rs"]
mod uhid;

fn main() -> std::process::ExitCode {
    #[cfg(target_os = "linux")]
    return show::main();
    #[cfg(not(target_os = "linux"))]
    std::process::ExitCode::SUCCESS
}
