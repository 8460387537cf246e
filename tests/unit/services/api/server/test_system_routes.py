"""Health, readiness, metrics, headers, the OpenAPI document."""

from __future__ import annotations

import httpx

from services.api.server import models
from tests.unit.services.api.flat import Flat


async def test_healthy_is_not_yet_ready(client: httpx.AsyncClient, home: Flat) -> None:
    assert (await client.get("/readyz")).json()["services"]["mapper"] is True
    home.reachable |= {"mapper": False, "regions": False}
    reply = await client.get("/readyz")
    assert reply.status_code == 503
    assert "not reachable: mapper, regions" in reply.json()["detail"]
    assert (await client.get("/healthz")).json() == {"status": "ok"}


async def test_the_status_says_whether_a_vlm_is_configured(client: httpx.AsyncClient, home: Flat) -> None:
    body = (await client.get("/v1/status")).json()
    assert body["vlm"]["configured"] is False
    assert models.SystemStatus.model_validate(body)
    home.reachable["vlm_gateway"] = False
    assert (await client.get("/v1/status")).json()["vlm"] is None


async def test_requests_are_counted_by_route_and_not_by_name(client: httpx.AsyncClient) -> None:
    await client.get("/v1/scenes/flat/objects/o-001")
    text = (await client.get("/metrics")).text
    assert (
        'ovip_api_requests_total{method="GET",route="/v1/scenes/{scene}/objects/{object_id}",status="200"}'
        in text
    )
    assert "o-001" not in text


async def test_every_answer_keeps_the_page_to_itself(client: httpx.AsyncClient) -> None:
    for path in ("/", "/v1/scenes", "/nope"):
        headers = (await client.get(path, headers={"Origin": "http://elsewhere.example"})).headers
        assert "script-src 'self'" in headers["content-security-policy"]
        assert headers["x-content-type-options"] == "nosniff"
        assert "access-control-allow-origin" not in headers


async def test_the_page_loads_nothing_from_elsewhere(client: httpx.AsyncClient) -> None:
    for name in ("", "static/main.js", "static/style.css", "static/plan.js", "static/space.js"):
        text = (await client.get(f"/{name}")).text.replace("http://www.w3.org/2000/svg", "")
        assert "http://" not in text
        assert "https://" not in text


async def test_the_vendored_files_are_served_with_their_licence(client: httpx.AsyncClient) -> None:
    for name in ("three.module.min.js", "three.core.min.js", "OrbitControls.js"):
        reply = await client.get(f"/static/vendor/{name}")
        assert reply.headers["content-type"].startswith("text/javascript")
    assert "MIT" in (await client.get("/static/vendor/three.LICENSE")).text
    assert "0.185.0" in (await client.get("/static/vendor/NOTICE")).text


async def test_openapi_describes_every_route_with_its_model(client: httpx.AsyncClient) -> None:
    document = (await client.get("/openapi.json")).json()
    paths = document["paths"]
    assert len(paths) >= 20
    for path, methods in paths.items():
        for method in methods.values():
            good = next(reply for status, reply in method["responses"].items() if status.startswith("2"))
            kinds = good["content"]
            assert kinds, path
            for kind, content in kinds.items():
                if kind == "application/json" and path.startswith("/v1"):
                    assert "$ref" in content["schema"], path
            assert "4XX" in method["responses"], path
            if path.startswith("/v1"):
                assert method["security"], path
    assert (await client.get("/docs")).status_code == 404
