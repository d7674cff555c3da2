#!/bin/sh
# The real kernel path, without hardware: Debian's kernel in software emulation, a uhid tablet and serial lines in it, the
# daemon's own binary reading /dev/hidraw*, and the kernel's wacom drivers as oracles. Run from anywhere; needs a Debian
# with root or with the packages named below already installed. About two minutes on two cores.
# Prints "skipped: ..." and exits 0 where it cannot run.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../../.." && pwd)
work=${SCULPTD_VM:-$root/target/vm}
mkdir -p "$work"

skip() {
    echo "skipped: $1"
    exit 0
}

[ "$(uname -m)" = x86_64 ] || skip "written for x86_64, this is $(uname -m)"
command -v apt-get >/dev/null || skip "no apt-get: the kernel is Debian's"
missing=
for tool in qemu-system-x86_64:qemu-system-x86 busybox:busybox-static cpio:cpio depmod:kmod inputattach:inputattach; do
    command -v "${tool%%:*}" >/dev/null || missing="$missing ${tool##*:}"
done
if [ -n "$missing" ]; then
    [ "$(id -u)" = 0 ] || skip "not installed, and not root:$missing"
    { apt-get update -qq && apt-get install -y -qq --no-install-recommends seabios $missing; } >"$work/apt.log" 2>&1 ||
        skip "packages cannot be had:$missing (see $work/apt.log)"
fi

# The kernel's package is unpacked, never installed.
if [ -z "$(ls "$work"/kernel/boot/vmlinuz-* 2>/dev/null)" ]; then
    package=$(apt-cache depends linux-image-amd64 2>/dev/null | awk '/Depends: linux-image-/ { print $2; exit }')
    [ -n "$package" ] || skip "apt knows no linux-image-amd64"
    (cd "$work" && rm -f linux-image-*.deb && apt-get download -qq "$package") >>"$work/apt.log" 2>&1 ||
        skip "$package cannot be downloaded (see $work/apt.log)"
    dpkg-deb -x "$work"/linux-image-*.deb "$work/kernel"
fi
version=$(ls "$work/kernel/lib/modules")

# SCULPTD_VM_BINARY: a daemon that was built already.
daemon=${SCULPTD_VM_BINARY:-$root/target/release/sculptd}
[ -n "${SCULPTD_VM_BINARY:-}" ] || (cd "$root" && cargo build --release --no-default-features --bin sculptd)
(cd "$root" && cargo build --release -p sculptd-devices --example vm_guest)

initrd=$work/initrd
rm -rf "$initrd"
mkdir -p "$initrd/bin" "$initrd/modules" "$initrd/proc" "$initrd/sys" "$initrd/dev" "$initrd/tmp"
cp "$(command -v busybox)" "$initrd/bin/busybox"
for binary in "$daemon" "$root/target/release/examples/vm_guest" "$(command -v inputattach)"; do
    strip -o "$initrd/bin/$(basename "$binary")" "$binary"
    ldd "$binary" | grep -o '/[^ ]*' | while read -r library; do
        mkdir -p "$initrd$(dirname "$library")"
        cp -L "$library" "$initrd$library"
    done
done
# In the order in which they need each other.
for module in hid hid-generic uhid evdev usb-common usbcore usbhid wacom serio serport wacom_w8001 wacom_serial4; do
    file=$(find "$work/kernel/lib/modules/$version" -name "$module.ko*" | head -1)
    [ -z "$file" ] || cp "$file" "$initrd/modules/"
done
cat >"$initrd/init" <<'INIT'
#!/bin/busybox sh
/bin/busybox mount -t proc proc /proc
/bin/busybox mount -t sysfs sys /sys
/bin/busybox mount -t devtmpfs dev /dev
/bin/busybox mount -t tmpfs tmp /tmp
/bin/busybox mkdir -p /dev/pts
/bin/busybox mount -t devpts devpts /dev/pts
for m in hid hid-generic uhid evdev usb-common usbcore usbhid wacom serio serport wacom_w8001 wacom_serial4; do
    [ -e "/modules/$m.ko" ] && /bin/busybox insmod "/modules/$m.ko"
done
RUST_LOG=warn /bin/vm_guest
/bin/busybox poweroff -f
INIT
chmod +x "$initrd/init"
(cd "$initrd" && find . | cpio -o -H newc --quiet | gzip -1) >"$work/initrd.gz"

echo "booting $version"
timeout 240 qemu-system-x86_64 -accel tcg,thread=multi -m 512 -smp 2 -nographic -no-reboot -nodefaults \
    -serial stdio -kernel "$work/kernel/boot/vmlinuz-$version" -initrd "$work/initrd.gz" \
    -append "console=ttyS0 quiet panic=-1" | tee "$work/console.log"
grep -q '^VM PASSED' "$work/console.log"
