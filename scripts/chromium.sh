#!/usr/bin/env bash
# Sees to it that Chromium is here for the browser tests: Debian's package where this user may install it,
# else says that they will be skipped.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/debian.sh

if ! command -v chromium >/dev/null && ! install_debian chromium; then
    echo "Chromium is not here (Debian's chromium): the browser tests will be skipped" >&2
fi
