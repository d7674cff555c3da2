# Sourced by run.sh and desktop.sh: what both need of the machine that they run on. Sets $here to the folder of these scripts,
# $root to the repository's and $work to the folder that they work in (SCULPTD_VM, else target/vm).

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../../.." && pwd)
work=${SCULPTD_VM:-$root/target/vm}
mkdir -p "$work"

skip() {
    echo "skipped: $1"
    exit 0
}

# Tools by the packages that have them, as TOOL:PACKAGE.
need_tools() {
    [ "$(uname -m)" = x86_64 ] || skip "written for x86_64, this is $(uname -m)"
    command -v apt-get >/dev/null || skip "no apt-get: the kernel is Debian's"
    missing=
    for tool in "$@"; do
        command -v "${tool%%:*}" >/dev/null || missing="$missing ${tool##*:}"
    done
    if [ -n "$missing" ]; then
        [ "$(id -u)" = 0 ] || skip "not installed, and not root:$missing"
        { apt-get update -qq && apt-get install -y -qq --no-install-recommends seabios $missing; } >"$work/apt.log" 2>&1 ||
            skip "packages cannot be had:$missing (see $work/apt.log)"
    fi
}

# Debian's kernel in $work/kernel, its version in $version. The package is unpacked, never installed.
fetch_kernel() {
    if [ -z "$(ls "$work"/kernel/boot/vmlinuz-* 2>/dev/null)" ]; then
        package=$(apt-cache depends linux-image-amd64 2>/dev/null | awk '/Depends: linux-image-/ { print $2; exit }')
        [ -n "$package" ] || skip "apt knows no linux-image-amd64"
        (cd "$work" && rm -f linux-image-*.deb && apt-get download -qq "$package") >>"$work/apt.log" 2>&1 ||
            skip "$package cannot be downloaded (see $work/apt.log)"
        dpkg-deb -x "$work"/linux-image-*.deb "$work/kernel"
    fi
    version=$(ls "$work/kernel/lib/modules")
}

# Modules of that kernel into $1/modules, in the order in which they need each other, which its file `list` keeps.
copy_modules() {
    to=$1/modules
    shift
    rm -rf "$to"
    mkdir -p "$to"
    for module in "$@"; do
        file=$(find "$work/kernel/lib/modules/$version" -name "$module.ko*" | head -1)
        [ -z "$file" ] || { cp "$file" "$to/" && basename "$file" >>"$to/list"; }
    done
}
