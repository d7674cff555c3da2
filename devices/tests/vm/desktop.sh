#!/bin/sh
# A whole desktop, without hardware: Debian's kernel in software emulation, udev, an X server whose libinput driver reads a
# uhid tablet, and the daemon's own window on a software adapter, reading the same tablet through hidraw. Draws strokes with
# the pen and counts what came of them; see tests/vm/desktop.rs. Needs a Debian with root. About five minutes on two cores.
# Prints "skipped: ..." and exits 0 where it cannot run.
#
# SCULPTD_VM_DESKTOP=sway tries the same under a Wayland compositor, which does not pass: sway starts, makes a pointer of the pen
# and shows the window, but initialises no EGL ("DRI2: failed to load driver"), composes by pixman and lets the window draw one
# frame in four seconds, in which no map is learned.
set -eu
. "$(dirname "$0")/kernel.sh"
need_tools qemu-system-x86_64:qemu-system-x86 busybox:busybox-static cpio:cpio depmod:kmod Xvfb:xvfb
fetch_kernel

# An emulated processor takes half a minute to draw a frame. The pictures are therefore drawn by this machine's own software
# adapter, which the emulated card (virtio-gpu, virgl) hands them to; its display is a window on a screen of Xvfb.
if [ ! -e /usr/lib/x86_64-linux-gnu/qemu/ui-sdl.so ]; then
    [ "$(id -u)" = 0 ] || skip "not installed, and not root: qemu-system-gui"
    apt-get install -y -qq --no-install-recommends qemu-system-gui libgl1-mesa-dri libegl1 libgles2 libgl1 >>"$work/apt.log" 2>&1 ||
        skip "qemu-system-gui cannot be had (see $work/apt.log)"
fi

# The packages of the desktop and all that they depend on are unpacked into a folder, never installed.
packages="base-files udev kmod xserver-xorg-core xserver-xorg-input-libinput xinput xdotool
    libgl1-mesa-dri libegl1 libgles2 libgl1 libgbm1 libx11-6 libx11-xcb1 libxcursor1 libxi6 libxrandr2 libxkbcommon-x11-0 x11-xkb-utils
    xkb-data x11-utils x11-xserver-utils imagemagick sway seatd libwayland-client0 libwayland-cursor0 libwayland-egl1"
system=$work/system
if [ ! -e "$system/unpacked" ]; then
    rm -rf "$system"
    mkdir -p "$work/debs/partial" "$system/usr/bin" "$system/usr/sbin" "$system/usr/lib" "$system/usr/lib64"
    : >"$work/no-packages"
    apt-get install -qq -y --no-install-recommends --download-only -o Dir::State::status="$work/no-packages" \
        -o Dir::Cache::archives="$work/debs" -o APT::Sandbox::User=root $packages >>"$work/apt.log" 2>&1 ||
        skip "the desktop's packages cannot be had (see $work/apt.log)"
    for folder in bin sbin lib lib64; do
        ln -s "usr/$folder" "$system/$folder"
    done
    # Without documentation, languages, and drivers of cards that are not there.
    for package in "$work"/debs/*.deb; do
        dpkg-deb --fsys-tarfile "$package" | tar -x -C "$system" --keep-directory-symlink \
            --exclude='./usr/share/doc' --exclude='./usr/share/man' --exclude='./usr/share/locale' \
            --exclude='./usr/share/icons' --exclude='./usr/share/perl*' --exclude='./usr/share/mime' \
            --exclude='./usr/lib/python3*' --exclude='./usr/lib/*/perl*' \
            --exclude='./usr/lib/*/gconv'
    done
    ldconfig -r "$system"
    printf 'root:x:0:0:root:/root:/bin/sh\nperson:x:1000:1000::/tmp:/bin/sh\n' >"$system/etc/passwd"
    # The groups that udev's rules name.
    n=0
    for group in root input video render kvm audio tty dialout disk cdrom tape lp kmem sgx plugdev; do
        echo "$group:x:$n:" && n=$((n + 1))
    done >"$system/etc/group"
    touch "$system/unpacked"
fi

# SCULPTD_VM_BINARY: a daemon with its window that was built already.
daemon=${SCULPTD_VM_BINARY:-$root/target/release/sculptd}
[ -n "${SCULPTD_VM_BINARY:-}" ] || (cd "$root" && cargo build --release --bin sculptd)
(cd "$root" && cargo build --release --example vm_desktop)
for binary in "$daemon" "$root/target/release/examples/vm_desktop"; do
    strip -o "$system/usr/bin/$(basename "$binary")" "$binary"
done
cp "$(command -v busybox)" "$system/usr/bin/busybox"
# The X server compiles its keymap by way of a shell.
ln -sf busybox "$system/usr/bin/sh"
copy_modules "$system" virtio_ring virtio virtio_pci_modern_dev virtio_pci_legacy_dev virtio_pci drm drm_kms_helper \
    drm_shmem_helper virtio_dma_buf virtio-gpu hid hid-generic uhid evdev usb-common usbcore usbhid wacom
cat >"$system/init" <<'INIT'
#!/usr/bin/busybox sh
export PATH=/usr/bin:/usr/sbin HOME=/root
busybox mkdir -p /proc /sys /dev /run /tmp /root /var/log /var/lib/xkb
busybox mount -t proc proc /proc
busybox mount -t sysfs sys /sys
busybox mount -t devtmpfs dev /dev
busybox mount -t tmpfs run /run
busybox mount -t tmpfs tmp /tmp
busybox mkdir -p /dev/pts /dev/shm /tmp/.X11-unix
busybox mount -t devpts devpts /dev/pts
busybox mount -t tmpfs shm /dev/shm
busybox ip link set lo up
while read -r m; do
    busybox insmod "/modules/$m"
done </modules/list
/usr/lib/systemd/systemd-udevd --daemon
udevadm trigger
udevadm settle
vm_desktop
busybox poweroff -f
INIT
chmod +x "$system/init"
(cd "$system" && find . | cpio -o -H newc --quiet) >"$work/desktop.cpio"

told=$work/display
rm -f "$told"
Xvfb -displayfd 3 -screen 0 1024x640x24 -nolisten tcp 3>"$told" 2>/dev/null &
screen=$!
trap 'kill $screen 2>/dev/null' EXIT
for _ in 1 2 3 4 5 6 7 8 9 10; do
    [ -s "$told" ] || sleep 1
done
[ -s "$told" ] || skip "Xvfb shows no screen"
export DISPLAY=:$(cat "$told")

# Without the kernel's check of its timer: see run.sh.
echo "booting $version"
timeout "${SCULPTD_VM_SECONDS:-900}" qemu-system-x86_64 -accel tcg,thread=multi -cpu max -m 3072 -smp 2 -no-reboot \
    -nodefaults -vga none -device virtio-gpu-gl-pci,xres=1024,yres=640 -display sdl,gl=on -serial stdio \
    -kernel "$work/kernel/boot/vmlinuz-$version" -initrd "$work/desktop.cpio" \
    -append "console=ttyS0 quiet panic=-1 no_timer_check desktop=${SCULPTD_VM_DESKTOP:-x11}" | tee "$work/desktop.log"
grep -q '^VM PASSED' "$work/desktop.log"
