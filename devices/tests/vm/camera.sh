#!/bin/sh
# The real path of a camera, without hardware: Debian's kernel in software emulation with its virtual camera (`vivid`), and the
# headless program reading /dev/video0. Then the camera is unplugged while it streams, and it is opened by a user without
# permission. Needs the hand models (SCULPTD_CAMERA_MODELS, else the user's folder). About two minutes on two cores.
# Prints "skipped: ..." and exits 0 where it cannot run.
set -eu
. "$(dirname "$0")/kernel.sh"
models=${SCULPTD_CAMERA_MODELS:-$HOME/.local/share/sculptd/hand-models}
[ -f "$models/hand_landmark_full.tflite" ] || skip "no hand models in $models (sculptd camera setup)"
need_tools qemu-system-x86_64:qemu-system-x86 busybox:busybox-static cpio:cpio depmod:kmod
fetch_kernel

daemon=${SCULPTD_VM_BINARY:-$root/target/release/sculptd}
[ -n "${SCULPTD_VM_BINARY:-}" ] || (cd "$root" && cargo build --release --no-default-features --bin sculptd)

initrd=$work/camera-initrd
rm -rf "$initrd"
mkdir -p "$initrd/bin" "$initrd/modules" "$initrd/proc" "$initrd/sys" "$initrd/dev" "$initrd/tmp" "$initrd/models" "$initrd/etc"
cp "$models"/palm_detection_lite.tflite "$models"/hand_landmark_full.tflite "$initrd/models/"
cp "$(command -v busybox)" "$initrd/bin/busybox"
strip -o "$initrd/bin/sculptd" "$daemon"
ldd "$daemon" | grep -o '/[^ ]*' | while read -r library; do
    mkdir -p "$initrd$(dirname "$library")"
    cp -L "$library" "$initrd$library"
done
ln -s busybox "$initrd/bin/sh"
echo "nobody:x:65534:65534::/tmp:/bin/sh" >"$initrd/etc/passwd"
copy_modules "$initrd" rc-core cec mc videodev videobuf2-common videobuf2-memops videobuf2-v4l2 videobuf2-vmalloc videobuf2-dma-contig \
    v4l2-dv-timings v4l2-tpg vivid
[ -f "$initrd/modules/vivid.ko" ] || skip "this kernel has no vivid"
cat >"$initrd/init" <<'INIT'
#!/bin/busybox sh
/bin/busybox mount -t proc proc /proc
/bin/busybox mount -t sysfs sys /sys
/bin/busybox mount -t devtmpfs dev /dev
/bin/busybox mount -t tmpfs tmp /tmp
export HOME=/tmp SCULPTD_CAMERA_MODELS=/models
while read -r m; do
    /bin/busybox insmod "/modules/$m"
done </modules/list
echo "== pictures"
/bin/sculptd camera test 0 --for 15
echo "exit $?"
echo "== permission"
/bin/busybox chmod 600 /dev/video0
/bin/busybox su nobody -c "SCULPTD_CAMERA_MODELS=/models /bin/sculptd camera test 0"
echo "exit $?"
echo "== no such camera"
/bin/sculptd camera test 7
echo "exit $?"
echo "== unplugged"
/bin/sculptd run --headless --camera 0 --for 25 >/tmp/run.log 2>&1 &
/bin/busybox sleep 12
echo vivid.0 >/sys/bus/platform/drivers/vivid/unbind
wait $!
echo "exit $?"
/bin/busybox cat /tmp/run.log
echo "== done"
/bin/busybox poweroff -f
INIT
chmod +x "$initrd/init"
(cd "$initrd" && find . | cpio -o -H newc --quiet | gzip -1) >"$work/camera-initrd.gz"

echo "booting $version"
timeout 280 qemu-system-x86_64 -accel tcg,thread=multi -cpu max -m 1024 -smp 2 -nographic -no-reboot -nodefaults \
    -serial stdio -kernel "$work/kernel/boot/vmlinuz-$version" -initrd "$work/camera-initrd.gz" \
    -append "console=ttyS0 quiet panic=-1 no_timer_check" | tee "$work/camera.log"
# A pattern has no hand, but pictures come (an emulated processor is too slow to look at many); each failure has its message.
grep -Eq 'pictures +[0-9]+ .*, [1-9][0-9]* skipped, 0 damaged' "$work/camera.log"
grep -q 'permission denied' "$work/camera.log"
grep -q 'there is no camera /dev/video7' "$work/camera.log"
grep -q 'camera: there is no camera /dev/video0' "$work/camera.log"
grep -q '== done' "$work/camera.log"
! grep -q 'panicked' "$work/camera.log"
echo "CAMERA PASSED"
