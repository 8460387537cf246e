#!/usr/bin/env bash
# Measures an everyday install from nothing (copy of this tree, empty home, no caches) to a stack that answers, and
# prints it as JSON. Exit status 1 where it is over the budget of 90 s or 900 MB. KEEP=1 leaves the folder.
set -euo pipefail
cd "$(dirname "$0")/.."

place=$(mktemp -d)
if [ -z "${KEEP:-}" ]; then trap 'rm -rf "$place"' EXIT; fi
mkdir "$place/tree" "$place/home"
git ls-files -z --cached --others --exclude-standard | while IFS= read -r -d '' file; do
    if [ -e "$file" ]; then printf '%s\0' "$file"; fi
done | tar --create --null --files-from=- | tar --extract --directory "$place/tree"

cd "$place/tree"
unset VIRTUAL_ENV PYTHONPATH XDG_CACHE_HOME UV_CACHE_DIR PIP_CACHE_DIR OVIP_DATA_DIR
export HOME=$place/home OVIP_MODELS_DIR=$place/models
megabytes() { du --summarize --block-size=1000000 "$@" | cut -f1; }

# timed COMMAND...: sets `timing` to the seconds of wall clock and of processor that it took
TIMEFORMAT='%R %U %S'
exec 3>&2
timed() {
    timing=$({ time "$@" >&3 2>&3; } 2>&1) || { echo "failed: $*" >&2; exit 1; }
}

timed make --no-print-directory setup
install=$timing
timed .venv/bin/ovip scenes --standalone --data-dir "$place/data" --json
answer=$timing
timed make --no-print-directory setup
again=$timing

.venv/bin/python - "$install" "$answer" "$again" "$(megabytes .venv)" "$(megabytes "$OVIP_MODELS_DIR")" <<'END'
import json
import os
import sys

install, answer, again = ([float(part) for part in text.split()] for text in sys.argv[1:4])
venv, models = map(int, sys.argv[4:])
result = {
    "ready_seconds": round(install[0] + answer[0], 1),
    "install_seconds": install[0],
    "install_cpu_seconds": round(sum(install[1:]), 1),
    "first_answer_seconds": answer[0],
    "first_answer_cpu_seconds": round(sum(answer[1:]), 1),
    "setup_again_seconds": again[0],
    "total_mb": venv + models,
    "venv_mb": venv,
    "models_mb": models,
    "load_average": round(os.getloadavg()[0], 1),
    "budget": {"ready_seconds": 90, "total_mb": 900},
}
result["within_budget"] = all(result[name] <= most for name, most in result["budget"].items())
print(json.dumps(result, indent=2))
sys.exit(not result["within_budget"])
END
