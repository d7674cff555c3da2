#!/bin/sh
# The real kernel path, without hardware: Debian's kernel in software emulation, a uhid tablet and serial lines in it, the
# daemon's own binary reading /dev/hidraw*, and the kernel's wacom drivers as oracles. Run from anywhere; needs a Debian
# with root or with the packages named below already installed. About two minutes on two cores.
# Prints "skipped: ..." and exits 0 where it cannot run.
set -eu
. "$(dirname "$0")/kernel.sh"
need_tools qemu-system-x86_64:qemu-system-x86 busybox:busybox-static cpio:cpio depmod:kmod inputattach:inputattach
fetch_kernel

# SCULPTD_VM_BINARY: a daemon that was built already.
daemon=${SCULPTD_VM_BINARY:-$root/target/release/sculptd}
[ -n "${SCULPTD_VM_BINARY:-}" ] || (cd "$root" && cargo build --release --no-default-features --bin sculptd)
(cd "$root" && cargo build --release --workspace --example vm_guest)

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
copy_modules "$initrd" hid hid-generic uhid evdev usb-common usbcore usbhid wacom hid-uclogic usbip-core vhci-hcd \
    serio serport wacom_w8001 wacom_serial4
cat >"$initrd/init" <<'INIT'
#!/bin/busybox sh
/bin/busybox mount -t proc proc /proc
/bin/busybox mount -t sysfs sys /sys
/bin/busybox mount -t devtmpfs dev /dev
/bin/busybox mount -t tmpfs tmp /tmp
/bin/busybox mkdir -p /dev/pts
/bin/busybox mount -t devpts devpts /dev/pts
while read -r m; do
    /bin/busybox insmod "/modules/$m"
done </modules/list
RUST_LOG=warn /bin/vm_guest
/bin/busybox poweroff -f
INIT
chmod +x "$initrd/init"
(cd "$initrd" && find . | cpio -o -H newc --quiet | gzip -1) >"$work/initrd.gz"

# On a busy machine an emulated timer is late, and the kernel gives up at its check of it.
echo "booting $version"
timeout 240 qemu-system-x86_64 -accel tcg,thread=multi -m 512 -smp 2 -nographic -no-reboot -nodefaults \
    -serial stdio -kernel "$work/kernel/boot/vmlinuz-$version" -initrd "$work/initrd.gz" \
    -append "console=ttyS0 quiet panic=-1 no_timer_check" | tee "$work/console.log"
grep -q '^VM PASSED' "$work/console.log"
