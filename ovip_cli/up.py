"""`ovip up`: the whole stack in this process."""

from __future__ import annotations

import asyncio
from dataclasses import asdict
from typing import TYPE_CHECKING

from ovip.telemetry import configure_logging
from ovip_cli.stacks import DataDir, Json, print_json
from services.standalone.config import Settings

if TYPE_CHECKING:
    from services.standalone.stack import Stack


def up(data_dir: DataDir = None, json: Json = False) -> None:
    """Start every service on one embedded store, until Ctrl-C."""
    settings = Settings() if data_dir is None else Settings(data_dir=data_dir)
    configure_logging(settings.log_level, settings.log_json)
    asyncio.run(_run(settings, json))


async def _run(settings: Settings, as_json: bool) -> None:
    # every service: two seconds that the other commands need not wait
    from ovip.serving import until_told
    from services.standalone.stack import running_stack

    async with running_stack(settings) as stack:
        if as_json:
            print_json({**asdict(stack), "dashboard": stack.dashboard})
        else:
            _say(stack)
        await until_told()


def _say(stack: Stack) -> None:
    for name, address in stack.addresses.items():
        print(f"{name:12} {address}")
    print(f"dashboard    {stack.dashboard}", flush=True)
