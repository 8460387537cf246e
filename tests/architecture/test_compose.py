"""docker-compose.yml and the Dockerfile hold together, without a container being started.

The schema is the Compose Specification's own (`data/README.md`).
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path
from typing import Any

import pytest
import yaml
from jsonschema import Draft7Validator

from ovip.config import KernelSettings
from tests.architecture.env_example import COMPOSE_ONLY, own_fields, service_settings, variable

ROOT = Path(__file__).resolve().parents[2]
DEPLOYED = ("perception", "mapper", "regions", "retrieval", "vlm_gateway", "api")
PUBLISHED = {"api": "8080", "perception": "50051", "perception-gpu": "50051", "retrieval": "50054"}
_VARIABLE = re.compile(r"\$\{(?P<name>[A-Z_]+)(?::(?P<operator>[-?])(?P<rest>[^}]*))?\}")


def interpolated(environment: Mapping[str, str]) -> dict[str, Any]:
    """The compose file with its variables put in, as Compose does for the forms used here."""

    def value(found: re.Match[str]) -> str:
        given = environment.get(found["name"], "")
        if found["operator"] == "?" and not given:
            raise KeyError(f"{found['name']}: {found['rest']}")
        return given or (found["rest"] if found["operator"] == "-" else "")

    def walk(part: Any) -> Any:
        if isinstance(part, dict):
            return {key: walk(item) for key, item in part.items()}
        if isinstance(part, list):
            return [walk(item) for item in part]
        return _VARIABLE.sub(value, part) if isinstance(part, str) else part

    return {key: walk(part) for key, part in raw().items()}


@cache
def raw() -> dict[str, Any]:
    loaded = yaml.safe_load((ROOT / "docker-compose.yml").read_text())
    assert isinstance(loaded, dict)
    return loaded


@cache
def compose() -> dict[str, Any]:
    return interpolated({"OVIP_API_KEY": "key"})


@cache
def dockerfile() -> str:
    return (ROOT / "Dockerfile").read_text()


@cache
def every_settings_class() -> list[type[KernelSettings]]:
    return [KernelSettings, *service_settings().values()]


def built() -> Iterator[tuple[str, dict[str, Any]]]:
    for name, service in compose()["services"].items():
        if "build" in service:
            yield name, service


@pytest.mark.parametrize("environment", [{"OVIP_API_KEY": "key"}, {name: "1" for name, _, _ in COMPOSE_ONLY}])
def test_compose_file_is_valid_against_the_specification(environment: dict[str, str]) -> None:
    schema = json.loads((ROOT / "tests/architecture/data/compose-spec.json").read_text())
    Draft7Validator.check_schema(schema)
    faults = [
        f"{error.json_path}: {error.message}"
        for error in Draft7Validator(schema).iter_errors(interpolated({"OVIP_API_KEY": "key", **environment}))
    ]
    assert faults == []


def test_schema_finds_a_fault_that_is_put_in() -> None:
    schema = json.loads((ROOT / "tests/architecture/data/compose-spec.json").read_text())
    broken = {**compose(), "services": {"api": {**compose()["services"]["api"], "helthcheck": {}}}}
    assert not Draft7Validator(schema).is_valid(broken)


def test_every_service_of_the_house_is_deployed_from_the_one_dockerfile() -> None:
    folders = {path.parent.name for path in (ROOT / "services").glob("*/__main__.py")}
    assert folders - {"standalone"} <= set(DEPLOYED)
    for name in DEPLOYED:
        assert compose()["services"][name]["build"] == {
            "context": ".",
            "args": {"SERVICE": name, **({"EXTRAS": "embedded"} if name == "perception" else {})},
        }
    assert set(compose()["services"]) == {*DEPLOYED, "perception-gpu", "valkey"}


def test_key_must_be_set() -> None:
    with pytest.raises(KeyError, match="OVIP_API_KEY: set it"):
        interpolated({})
    for _, service in built():
        assert service["environment"]["OVIP_API_KEY"] == "key"


def test_every_variable_is_in_the_example_file() -> None:
    text = (ROOT / "docker-compose.yml").read_text()
    used = {found["name"] for found in _VARIABLE.finditer(text)}
    assert used == {name for name, _, _ in COMPOSE_ONLY} - {"COMPOSE_PROFILES"} | {"OVIP_API_KEY"}
    for name, value, _ in COMPOSE_ONLY:
        assert name == "COMPOSE_PROFILES" or f"${{{name}:-{value}}}" in text


def test_only_three_ports_are_published_and_on_loopback() -> None:
    published = {
        name: service["ports"] for name, service in compose()["services"].items() if "ports" in service
    }
    assert published == {name: [f"127.0.0.1:{port}:{port}"] for name, port in PUBLISHED.items()}


def test_environment_names_settings_that_exist() -> None:
    known = {name for settings in every_settings_class() for name in own_fields(settings)}
    ports = {f"OVIP_{name.upper()}_PORT" for name in DEPLOYED}
    for name, service in built():
        assert set(service["environment"]) <= known | ports, name


def test_what_containers_must_agree_on_cannot_be_changed_from_the_env_file() -> None:
    pinned = set(compose()["services"]["mapper"]["environment"])
    for settings in every_settings_class():
        for field in settings.model_fields:
            if field.endswith(("_address", "_port", "_dir")) or field in ("host", "redis_url", "port"):
                assert variable(settings, field) in pinned


def test_every_address_leads_to_a_service_that_listens_there() -> None:
    hosts = {
        alias: name for name, service in compose()["services"].items() for alias in _names(name, service)
    }
    environment = compose()["services"]["api"]["environment"]
    addresses = {key: value for key, value in environment.items() if key.endswith("_ADDRESS")}
    assert len(addresses) == 6
    for key, value in addresses.items():
        host, _, port = value.partition(":")
        service = key.removeprefix("OVIP_").removesuffix("_ADDRESS").lower()
        assert hosts[host] == service
        assert "_" not in host
        assert environment[f"OVIP_{service.upper()}_PORT"] == port
    assert environment["OVIP_HOST"] == "0.0.0.0"
    assert environment["OVIP_REDIS_URL"] == "redis://valkey:6379/0"


def test_services_wait_until_those_they_need_are_healthy() -> None:
    services = compose()["services"]
    order = TopologicalSorter({name: service.get("depends_on", {}) for name, service in services.items()})
    order.prepare()
    for name, service in built():
        assert "valkey" in service["depends_on"], name
        for needed, wait in service["depends_on"].items():
            assert wait["condition"] == "service_healthy"
            assert wait.get("required", True) == ("profiles" not in services[needed])
            assert "healthcheck" in services[needed] or _health_of(
                services[needed]["build"]["args"]["SERVICE"]
            )


def test_health_is_asked_where_each_service_listens() -> None:
    environment = compose()["services"]["api"]["environment"]
    for name in DEPLOYED:
        port = environment[f"OVIP_{name.upper()}_PORT"]
        assert f"127.0.0.1:${{OVIP_{name.upper()}_PORT:-{port}}}" in _health_of(name)


def test_services_come_back_by_themselves_and_hold_no_privileges() -> None:
    for name, service in compose()["services"].items():
        assert service["restart"] == "unless-stopped", name
        assert service["security_opt"] == ["no-new-privileges:true"], name
    for name, service in built():
        assert service["cap_drop"] == ["ALL"], name
    assert re.search(r"^USER [1-9]\d*:[1-9]\d*$", dockerfile(), re.MULTILINE)


def test_store_syncs_every_write_to_a_volume() -> None:
    valkey = compose()["services"]["valkey"]
    command = " ".join(valkey["command"])
    assert valkey["image"].startswith("valkey/valkey:8")
    assert "--appendonly yes" in command
    assert "--appendfsync always" in command
    assert "--maxmemory-policy noeviction" in command
    assert valkey["volumes"] == ["valkey:/data"]
    assert "ports" not in valkey


def test_only_named_volumes_are_mounted_and_all_services_share_the_blobs() -> None:
    for name, service in compose()["services"].items():
        for volume in service["volumes"]:
            assert volume.partition(":")[0] in compose()["volumes"], name
    for name, service in built():
        assert f"data:{service['environment']['OVIP_DATA_DIR']}" in service["volumes"], name


def test_only_the_gateway_sees_the_vlm_endpoints() -> None:
    for name, service in built():
        files = [file["path"] for file in service["env_file"]]
        if name == "vlm_gateway":
            assert "OVIP_VLM_UPSTREAMS" not in service["environment"]
            assert files == [".env", "vlm.env"]
        else:
            assert service["environment"]["OVIP_VLM_UPSTREAMS"] == ""
            assert files == [".env"]


def test_gpu_profile_puts_a_gpu_perception_in_the_place_of_the_other() -> None:
    gpu = compose()["services"]["perception-gpu"]
    assert gpu["profiles"] == ["gpu"]
    assert gpu["build"]["args"] == {"SERVICE": "perception", "EXTRAS": "full"}
    assert gpu["environment"]["OVIP_MODELS"] == "full"
    assert gpu["networks"]["default"]["aliases"] == ["perception"]
    assert gpu["deploy"]["resources"]["reservations"]["devices"][0]["capabilities"] == ["gpu"]
    none = interpolated({"OVIP_API_KEY": "key", "OVIP_PERCEPTION_REPLICAS": "0"})
    assert none["services"]["perception"]["deploy"]["replicas"] == "0"


def test_no_file_of_settings_or_keys_goes_into_an_image() -> None:
    ignored = (ROOT / ".dockerignore").read_text().splitlines()
    rules = [line for line in ignored if line and not line.startswith("#")]
    assert rules[0] == "*"
    assert "**/.env*" in rules
    assert not any(rule.startswith("!") and "env" in rule for rule in rules)
    for rule in rules:
        if rule.startswith("!") and not (ROOT / rule[1:]).exists():
            assert rule[1:] in ("requirements.lock", "constraints")


def _names(name: str, service: dict[str, Any]) -> list[str]:
    aliases = service.get("networks", {}).get("default", {}).get("aliases", [])
    return [name] if "profiles" in service else [name, *aliases]


def _health_of(service: str) -> str:
    """The line of the Dockerfile's health check that asks this service."""
    found = re.search(rf"^\s*{service}\)\s+exec (.+) ;;", dockerfile(), re.MULTILINE)
    assert found, service
    return found[1]
