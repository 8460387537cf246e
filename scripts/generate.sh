#!/usr/bin/env bash
# Generates the Python code of proto/ into DIR/ovip/v1 (DIR: the first argument, else this checkout).
set -euo pipefail
out=$(realpath "${1:-$(dirname "$0")/..}")
cd "$(dirname "$0")/.."

mkdir -p "$out/ovip/v1"
.venv/bin/python -m grpc_tools.protoc --proto_path=proto \
    --python_out="$out" --pyi_out="$out" --grpc_python_out="$out" proto/ovip/v1/*.proto
