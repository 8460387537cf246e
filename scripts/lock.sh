#!/usr/bin/env bash
# Writes requirements.lock (what `ovip up` needs) and requirements-dev.lock (the same pins, and the tools): every
# package by version and hash, for every platform, and not where it came from. Pins stay unless pyproject.toml
# forbids them; `scripts/lock.sh --upgrade` takes the newest, `--upgrade-package NAME` the newest of one.
set -euo pipefail
cd "$(dirname "$0")/.."

compile=(.venv/bin/uv pip compile pyproject.toml --quiet --system-certs --universal --python-version 3.11
    --fork-strategy fewest --constraints constraints/lock.txt --generate-hashes
    --no-emit-index-url --no-emit-find-links --no-annotate --no-header "$@")
"${compile[@]}" --extra embedded --output-file requirements.lock >/dev/null
"${compile[@]}" --extra embedded --extra lab --extra ros --extra dev --constraints requirements.lock --output-file requirements-dev.lock >/dev/null
