"""Runs the whole stack in one process until told to stop."""

from __future__ import annotations

import asyncio
import json
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict

from pydantic import ValidationError

from ovip.config import explain
from ovip.errors import OvipError
from ovip.serving import until_told
from ovip.telemetry import configure_logging
from services.standalone.config import Settings
from services.standalone.stack import running_stack

_THREADS = 16


async def run(settings: Settings) -> None:
    """Says where it is as one JSON line on standard output once everything answers."""
    # whoever waits for the disk must not keep others from the processor
    asyncio.get_running_loop().set_default_executor(ThreadPoolExecutor(_THREADS, "work"))
    async with running_stack(settings) as stack:
        print(json.dumps({**asdict(stack), "dashboard": stack.dashboard}), flush=True)
        await until_told()


def main() -> None:
    """A known error ends with one line and status 1."""
    try:
        settings = Settings()
        configure_logging(settings.log_level, settings.log_json)
        asyncio.run(run(settings))
    except ValidationError as error:
        print(f"ovip: {explain(error)}", file=sys.stderr)
        raise SystemExit(1) from error
    except OvipError as error:
        print(f"ovip: {error}", file=sys.stderr)
        raise SystemExit(1) from error


if __name__ == "__main__":
    main()
