# Everything a person or CI does with this checkout. `make help` lists it.
.DEFAULT_GOAL := help
.PHONY: help setup demo test check bench bench-install lab eval format proto proto-release lock dev browser \
        check-format check-lint check-types check-imports check-proto check-lock clean
MAKEFLAGS += --no-print-directory
bin := .venv/bin

help:  ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  %-14s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

setup:  ## make .venv and the model cache ready (quick when they are)
	@scripts/setup.sh

demo: setup  ## map a recording or a simulated room, ask five questions, leave the dashboard up (DEMO_EXIT=1: end)
	@$(bin)/python -m lab.demo

test: lab browser  ## run the tests (PYTEST_ARGS="-k kitchen" and the like)
	@$(bin)/python -m pytest -n 2 --dist loadfile $(PYTEST_ARGS)

check: check-lock check-format check-lint check-types check-imports check-proto  ## format, lint, types, layers, API
	@echo "check: all good"

bench: setup  ## measure ingest, perception, answers and the start of a stack (BENCH_ARGS="tier1 --json")
	@$(bin)/ovip bench $(BENCH_ARGS)

lab: dev  ## make the lab ready: Open3D, furniture models and example homes (composed shapes where not to be had)
	@scripts/lab.sh

eval: lab  ## run a protocol of the paper (EVAL_ARGS="ablation --homes 6 --json")
	@$(bin)/ovip eval $(EVAL_ARGS)

bench-install:  ## measure an install from nothing against its budget of 90 s and 900 MB
	@scripts/measure-install.sh

format: dev  ## format the code and mend what ruff can mend
	@$(bin)/ruff format .
	@$(bin)/ruff check --fix .

proto: dev  ## generate ovip/v1 from proto/
	@scripts/generate.sh

proto-release: dev  ## at a release: make today's contract the one that must not break
	@$(bin)/buf build --exclude-source-info --output proto/released.binpb

lock: dev  ## renew the lock files after a change of dependencies (LOCK_ARGS=--upgrade: take the newest)
	@scripts/lock.sh $(LOCK_ARGS)

clean:  ## remove .venv and what the tools leave behind; the model cache stays
	@rm -rf .venv .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache build dist
	@find . -name __pycache__ -type d -prune -exec rm -rf {} +

dev:
	@scripts/setup.sh --dev

browser: dev
	@scripts/chromium.sh

check-format: dev
	@$(bin)/ruff format --check .

check-lint: dev
	@$(bin)/ruff check .

check-types: dev
	@$(bin)/mypy

check-imports: dev
	@$(bin)/lint-imports --no-logo

check-proto: dev
	@scripts/check-proto.sh

# a lock names what to install, never where it came from
check-lock:
	@! grep --line-number --extended-regexp '://|^-|file:' requirements.lock requirements-dev.lock constraints/*.txt
