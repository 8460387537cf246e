#!/usr/bin/env bash
# Sets up what the lab wants besides Python packages: libusb for open3d, furniture models, and example homes.
# Run again at any time: what is there stays. What cannot be had is named, with what is then missing; only without
# libusb does this fail.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=scripts/debian.sh
source scripts/debian.sh

cache="${OVIP_LAB_CACHE:-$HOME/.cache/ovip/lab}"
furniture=/usr/share/sweethome3d/furniture
homes="$cache/sweethome3d"
python=python3
[ ! -x .venv/bin/python ] || python=.venv/bin/python
failed=0

missing() { echo "missing: $1" >&2; }

has_libusb() {
    ldconfig -p 2>/dev/null | grep -q 'libusb-1\.0\.so\.0' || compgen -G '/usr/lib/*/libusb-1.0.so.0' >/dev/null
}

# 1. open3d's wheels are linked with it.
if [ "$(uname -s)" = Linux ] && ! has_libusb && ! install_debian libusb-1.0-0; then
    missing "libusb-1.0-0, without which open3d cannot be imported and nothing is rendered;
  as root: apt-get install libusb-1.0-0"
    failed=1
fi

# 2. The models of which homes are furnished.
if ! compgen -G "$furniture/*.sh3f" >/dev/null && ! install_debian sweethome3d-furniture; then
    missing "sweethome3d-furniture: homes are furnished with composed shapes instead;
  as root: apt-get install sweethome3d-furniture"
fi

# 3. The nine example homes: out of Debian's package, which is not installed (it would bring Java).
bring_homes() {
    command -v apt-get >/dev/null && command -v dpkg-deb >/dev/null || return 1
    local scratch
    scratch="$(mktemp -d)"
    trap 'rm -rf "$scratch"' RETURN
    if ! (cd "$scratch" && apt-get -qq download sweethome3d) 2>/dev/null; then
        may_install && _apt_get update && (cd "$scratch" && apt-get -qq download sweethome3d) || return 1
    fi
    dpkg-deb --fsys-tarfile "$scratch"/sweethome3d_*.deb |
        tar -x -C "$scratch" ./usr/share/sweethome3d/sweethome3d.jar || return 1
    unpack_homes "$scratch/usr/share/sweethome3d/sweethome3d.jar"
}

# unpack_homes JAR: the homes' plans and the models that they are furnished with.
unpack_homes() {
    "$python" - "$1" "$homes" <<'PYTHON'
import pathlib
import shutil
import sys
import tempfile
import zipfile

jar, homes = sys.argv[1], pathlib.Path(sys.argv[2])
prefix = "com/eteks/sweethome3d/io/resources/"
homes.parent.mkdir(parents=True, exist_ok=True)
half = pathlib.Path(tempfile.mkdtemp(dir=homes.parent))
with zipfile.ZipFile(jar) as archive:
    for name in archive.namelist():
        inner = name.removeprefix(prefix)
        if inner == name or not inner.endswith((".xml", ".obj", ".mtl", ".jpg")):
            continue
        place = inner if inner.startswith("examples/") else f"resources/{inner}"
        target = half / place
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(archive.read(name))
    (half / "LICENSE.TXT").write_bytes(archive.read("LICENSE.TXT"))
if not (half / "examples").is_dir():
    shutil.rmtree(half)
    sys.exit("the archive holds no example homes")
shutil.rmtree(homes, ignore_errors=True)
half.chmod(0o755)
half.rename(homes)
PYTHON
}

if ! compgen -G "$homes/examples/*.xml" >/dev/null; then
    installed=/usr/share/sweethome3d/sweethome3d.jar
    if [ -f "$installed" ]; then unpack_homes "$installed"; else bring_homes; fi ||
        missing "the Sweet Home 3D example homes (Debian's package sweethome3d could not be read);
  generated homes do not need them"
fi

echo "furniture: $(compgen -G "$furniture/*.sh3f" >/dev/null && echo "$furniture" || echo 'composed shapes')"
echo "example homes: $(compgen -G "$homes/examples/*.xml" | wc -l) in $homes"
exit "$failed"
