#!/usr/bin/env bash
# Makes .venv ready: pinned packages by hash, the project itself (editable), the embedded models.
#   scripts/setup.sh          what `ovip up` needs
#   scripts/setup.sh --dev    and what the tests and checks need
# Quick where nothing has changed since. Environment: PYTHON (interpreter to use), OVIP_MODELS_DIR (model cache).
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/debian.sh

lock=requirements.lock
stamp=.venv/.everyday
if [ "${1:-}" = --dev ]; then
    lock=requirements-dev.lock
    stamp=.venv/.dev
fi
python=""
installer=()
scratch=""
trap 'if [ -n "$scratch" ]; then rm -rf "$scratch"; fi' EXIT

main() {
    if ! environment_is_here; then make_environment; fi
    if ! is_stamped "$stamp" "$(packages_fingerprint "$lock")"; then
        install_packages
        packages_fingerprint requirements.lock >.venv/.everyday
        packages_fingerprint "$lock" >"$stamp" # the tools' lock has the everyday one in it
    fi
    if ! models_are_here; then pull_models; fi
    say ready
}

say() { echo "setup: $*"; }

fail() {
    echo "setup: $*" >&2
    exit 1
}

# ---- the environment ----

# of this very folder: the scripts of an environment name the place it was made in
environment_is_here() {
    [ "$(cat .venv/.place 2>/dev/null)" = "$(pwd -P)" ] && .venv/bin/python -c 'import pip' 2>/dev/null
}

make_environment() {
    find_python || {
        install_debian python3 python3-venv && find_python
    } || fail "Python 3.11 or newer is needed: install Debian's python3 and python3-venv, or set PYTHON=/its/path"
    if ! "$python" -c 'import venv, ensurepip' 2>/dev/null; then
        local package
        package=$("$python" -c 'import sys; print(f"python3.{sys.version_info.minor}-venv")')
        install_debian "$package" || fail "$python cannot make environments: install Debian's python3-venv ($package)"
    fi
    say "new environment .venv with $("$python" --version)"
    "$python" -m venv --clear .venv
    pwd -P >.venv/.place
}

find_python() {
    local candidate
    for candidate in ${PYTHON:+"$PYTHON"} python3 /usr/bin/python3 python3.13 python3.12 python3.11; do
        if "$candidate" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
            python=$candidate
            return 0
        fi
    done
    return 1
}

# ---- the packages ----

packages_fingerprint() {
    {
        cat "$1" constraints/build.txt
        sed '/^\[tool\./,$d' pyproject.toml
        .venv/bin/python --version
    } | sha256sum
}

is_stamped() {
    [ -f "$1" ] && [ "$(cat "$1")" = "$2" ]
}

install_packages() {
    say "installing the packages of $lock"
    scratch=$(mktemp -d)
    if find_uv; then
        if "${installer[@]}" --require-hashes -r "$lock" && "${installer[@]}" "${itself[@]}"; then return 0; fi
        say "uv could not; trying pip"
    fi
    local pip=(.venv/bin/python -m pip --disable-pip-version-check --no-input install --quiet)
    "${pip[@]}" --require-hashes -r "$lock"
    PIP_CONSTRAINT=constraints/build.txt "${pip[@]}" --no-deps -e .
}

itself=(--no-deps --build-constraints constraints/build.txt -e .)

# uv of the version and hash that the lock names, from .venv or brought aside; it installs in a third of pip's time
find_uv() {
    local wanted uv=.venv/bin/uv
    wanted=$(sed -n 's/^uv==\([^ ]*\).*/\1/p' requirements-dev.lock)
    if [ "$("$uv" --version 2>/dev/null | cut -d' ' -f2)" != "$wanted" ]; then
        awk '/^uv==/ { on = 1 } on { print } on && !/\\$/ { exit }' requirements-dev.lock >"$scratch/uv.lock"
        .venv/bin/python -m pip --disable-pip-version-check --no-input install --quiet --no-deps --require-hashes \
            --target "$scratch/uv" -r "$scratch/uv.lock" || return 1
        uv=$scratch/uv/bin/uv
    fi
    installer=("$uv" pip install --quiet --system-certs --python .venv/bin/python)
}

# ---- the models ----

models_fingerprint() {
    {
        cat services/perception/adapters/model_cache.py .env 2>/dev/null || true
        echo "${HOME:-} ${OVIP_MODELS_DIR:-}"
    } | sha256sum
}

# .venv/.models: the fingerprint, then the path of every file that must be there
models_are_here() {
    [ -f .venv/.models ] || return 1
    local fingerprint path
    {
        read -r fingerprint
        [ "$fingerprint" = "$(models_fingerprint)" ] || return 1
        while read -r path; do
            [ -f "$path" ] || return 1
        done
    } <.venv/.models
}

pull_models() {
    say "bringing the embedded models"
    rm -f .venv/.models
    .venv/bin/ovip models pull embedded
    local listed
    listed=$(.venv/bin/ovip models list --json)
    {
        models_fingerprint
        .venv/bin/python -c '
import json, sys
listed = json.load(sys.stdin)
for file in listed["files"]:
    print(listed["folder"] + "/" + file["file"])' <<<"$listed"
    } >.venv/.models.part
    mv .venv/.models.part .venv/.models
}

main
