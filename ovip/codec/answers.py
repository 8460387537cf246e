"""Answers with their whole account: tiers, candidates, coverage."""

from __future__ import annotations

from typing import Any

from ovip.codec.geometry import (
    box2_message,
    box2_value,
    box_message,
    box_value,
    vector_message,
    vector_value,
    vectors_value,
)
from ovip.codec.reading import member, parsed
from ovip.scene.answers import (
    Answer,
    Candidate,
    Coverage,
    Goal,
    Outcome,
    RegionCoverage,
    TierReport,
    TierResult,
)
from ovip.v1 import retrieval_pb2

_OUTCOME_NUMBERS = {
    Outcome.FOUND: retrieval_pb2.Answer.OUTCOME_FOUND,
    Outcome.ABSENT: retrieval_pb2.Answer.OUTCOME_ABSENT,
    Outcome.UNRESOLVED: retrieval_pb2.Answer.OUTCOME_UNRESOLVED,
}
_OUTCOMES: dict[int, Outcome] = {number: outcome for outcome, number in _OUTCOME_NUMBERS.items()}
_RESULT_NUMBERS: dict[TierResult, Any] = {
    result: retrieval_pb2.TierReport.Result.Value(f"RESULT_{result.name}") for result in TierResult
}
_RESULTS: dict[int, TierResult] = {number: result for result, number in _RESULT_NUMBERS.items()}


def answer_message(answer: Answer) -> retrieval_pb2.Answer:
    message = retrieval_pb2.Answer(
        outcome=_OUTCOME_NUMBERS[answer.outcome],
        tier=answer.tier,
        path=[vector_message(p) for p in answer.path],
        tiers=[tier_report_message(r) for r in answer.tiers],
        candidates=[_candidate_message(c) for c in answer.candidates],
        rejected=[_candidate_message(c) for c in answer.rejected],
        fallbacks=answer.fallbacks,
        map_version=answer.map_version,
        regions_revision=answer.regions_revision,
        needs=answer.needs,
    )
    if answer.object:
        message.object.CopyFrom(_candidate_message(answer.object))
    if answer.goal:
        message.goal.position.CopyFrom(vector_message(answer.goal.position))
        message.goal.yaw = answer.goal.yaw
    if answer.coverage:
        message.coverage.CopyFrom(_coverage_message(answer.coverage))
    return message


def answer_value(m: retrieval_pb2.Answer) -> Answer:
    return Answer(
        outcome=member(_OUTCOMES, m.outcome, "answer: outcome"),
        tier=m.tier,
        object=_candidate_value(m.object) if m.HasField("object") else None,
        goal=Goal(vector_value(m.goal.position), m.goal.yaw) if m.HasField("goal") else None,
        path=vectors_value(m.path),
        tiers=tuple(tier_report_value(r) for r in m.tiers),
        candidates=tuple(_candidate_value(c) for c in m.candidates),
        rejected=tuple(_candidate_value(c) for c in m.rejected),
        fallbacks=tuple(m.fallbacks),
        map_version=m.map_version,
        regions_revision=m.regions_revision,
        coverage=_coverage_value(m.coverage) if m.HasField("coverage") else None,
        needs=m.needs,
    )


def encode_answer(answer: Answer) -> bytes:
    return answer_message(answer).SerializeToString(deterministic=True)


def decode_answer(data: bytes) -> Answer:
    return answer_value(parsed(retrieval_pb2.Answer, data))


def tier_report_message(r: TierReport) -> retrieval_pb2.TierReport:
    return retrieval_pb2.TierReport(
        tier=r.tier, result=_RESULT_NUMBERS[r.result], why=r.why, vlm_calls=r.vlm_calls, milliseconds=r.ms
    )


def tier_report_value(m: retrieval_pb2.TierReport) -> TierReport:
    result = member(_RESULTS, m.result, "tier report: result")
    return TierReport(m.tier, result, m.why, m.vlm_calls, m.milliseconds)


def _candidate_message(c: Candidate) -> retrieval_pb2.Candidate:
    message = retrieval_pb2.Candidate(
        object_id=c.object_id,
        label=c.label,
        position=vector_message(c.position),
        score=c.score,
        why=c.why,
        frame_id=c.frame_id,
    )
    if c.box is not None:
        message.box.CopyFrom(box_message(c.box))
    if c.box2 is not None:
        message.box2.CopyFrom(box2_message(c.box2))
    return message


def _candidate_value(m: retrieval_pb2.Candidate) -> Candidate:
    return Candidate(
        label=m.label,
        position=vector_value(m.position),
        score=m.score,
        why=m.why,
        object_id=m.object_id,
        box=box_value(m.box) if m.HasField("box") else None,
        frame_id=m.frame_id,
        box2=box2_value(m.box2) if m.HasField("box2") else None,
    )


def _coverage_message(c: Coverage) -> retrieval_pb2.Coverage:
    return retrieval_pb2.Coverage(
        planned=c.planned,
        visited=c.visited,
        unreachable=c.unreachable,
        regions=[
            retrieval_pb2.RegionCoverage(
                region_id=r.region_id, display_name=r.display_name, area=r.area, seen=r.seen, prior=r.prior
            )
            for r in c.regions
        ],
        posterior_present=c.posterior_present,
        complete=c.complete,
    )


def _coverage_value(m: retrieval_pb2.Coverage) -> Coverage:
    return Coverage(
        m.planned,
        m.visited,
        m.unreachable,
        tuple(RegionCoverage(r.region_id, r.display_name, r.area, r.seen, r.prior) for r in m.regions),
        m.posterior_present,
        m.complete,
    )
