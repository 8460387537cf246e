"""Retrieval over gRPC: decode, ask, encode."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Any

import grpc

from ovip import codec
from ovip.errors import InvalidInput
from ovip.scene.answers import Observation
from ovip.v1 import retrieval_pb2, retrieval_pb2_grpc
from services.retrieval.robot_search import Cancel, Resume, SearchMessage
from services.retrieval.service import Retrieval

SERVICE_NAME = retrieval_pb2.DESCRIPTOR.services_by_name["RetrievalService"].full_name


class RetrievalServicer(retrieval_pb2_grpc.RetrievalServiceServicer):
    """Translates between protobuf and the use cases."""

    def __init__(self, retrieval: Retrieval) -> None:
        self._retrieval = retrieval

    async def Find(
        self, request: retrieval_pb2.FindRequest, context: Any
    ) -> AsyncIterator[retrieval_pb2.FindResponse]:
        async for search_id, event in self._retrieval.find(codec.query_value(request)):
            yield retrieval_pb2.FindResponse(search_id=search_id, event=codec.event_message(event))

    async def Search(
        self, request_iterator: AsyncIterator[retrieval_pb2.SearchRequest], context: Any
    ) -> AsyncIterator[retrieval_pb2.SearchResponse]:
        async for search_id, event in self._retrieval.search(_messages(request_iterator)):
            yield retrieval_pb2.SearchResponse(search_id=search_id, event=codec.event_message(event))

    async def GetSearch(
        self, request: retrieval_pb2.GetSearchRequest, context: Any
    ) -> retrieval_pb2.GetSearchResponse:
        text, answer = await self._retrieval.get_search(request.scene, request.search_id)
        return retrieval_pb2.GetSearchResponse(
            search_id=request.search_id,
            text=text,
            done=answer is not None,
            answer=None if answer is None else codec.answer_message(answer),
        )


def register(retrieval: Retrieval, server: grpc.aio.Server) -> None:
    """Puts retrieval on a server."""
    retrieval_pb2_grpc.add_RetrievalServiceServicer_to_server(RetrievalServicer(retrieval), server)


async def _messages(requests: AsyncIterator[retrieval_pb2.SearchRequest]) -> AsyncIterator[SearchMessage]:
    async for request in requests:
        yield _message(request)


def _message(request: retrieval_pb2.SearchRequest) -> SearchMessage:
    match request.WhichOneof("message"):
        case "start":
            return codec.query_value(request.start)
        case "resume_search_id":
            return Resume(request.resume_search_id)
        case "observation":
            seen = request.observation
            return Observation(seen.viewpoint_id, seen.frame_id, seen.unreachable)
        case "cancel":
            return Cancel()
        case _:
            raise InvalidInput("search: expected start, resume_search_id, observation or cancel")
