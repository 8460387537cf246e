#!/usr/bin/env bash
# Checks the contract: buf's lint, no break against the last release (proto/released.binpb, made by
# `make proto-release`), and that the committed code is what proto/ generates.
set -euo pipefail
cd "$(dirname "$0")/.."

.venv/bin/buf lint
.venv/bin/buf breaking --against proto/released.binpb

fresh=$(mktemp -d)
trap 'rm -rf "$fresh"' EXIT
scripts/generate.sh "$fresh"
if ! diff -r --brief --exclude=__init__.py --exclude=__pycache__ "$fresh/ovip/v1" ovip/v1; then
    echo "ovip/v1 is not what proto/ generates: run make proto" >&2
    exit 1
fi
