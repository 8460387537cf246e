"""FAV-Gate (Eq. 1): what is grounded online is what is grounded offline, exactly."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from hypothesis import example, given
from hypothesis import strategies as st

from services.perception.domain.gate import DEFAULT_BLACKLIST, GateParams, VocabularyGate, gate_offline

WORDS = st.sets(st.sampled_from(["cup", "table", "chair", "logo", "lamp"]), max_size=4)
RUNS = st.lists(WORDS, max_size=25)
PARAMS = st.builds(
    GateParams, st.integers(1, 5), st.sampled_from([frozenset(), frozenset({"logo"}), DEFAULT_BLACKLIST])
)

Tags = Sequence[tuple[str, Iterable[str]]]


def _numbered(run: list[set[str]]) -> list[tuple[str, set[str]]]:
    return [(f"f{i}", words) for i, words in enumerate(run, 1)]


def _online(tags: Tags, params: GateParams) -> list[tuple[str, str]]:
    """Every (frame, word) pair in the order in which it was grounded."""
    gate, pairs = VocabularyGate.empty(params), []
    for frame_id, words in tags:
        gate, admission = gate.observe(frame_id, words)
        pairs += [(frame_id, word) for word in admission.words] + list(admission.late)
    return pairs


@given(RUNS, PARAMS)
@example([{"cup"}, {"cup"}, {"cup"}], GateParams(3))
@example([{"cup"}, {"cup"}], GateParams(3))
@example([{"logo"}] * 5, GateParams(1))
def test_online_grounds_exactly_the_pairs_of_offline_each_once(
    run: list[set[str]], params: GateParams
) -> None:
    online = _online(_numbered(run), params)

    assert set(online) == gate_offline(_numbered(run), params)
    assert len(online) == len(set(online))


@given(RUNS, PARAMS, st.integers(0, 25))
def test_online_equals_offline_after_every_frame_not_only_the_last(
    run: list[set[str]], params: GateParams, cut: int
) -> None:
    tags = _numbered(run)[:cut]

    assert set(_online(tags, params)) == gate_offline(tags, params)


@given(RUNS, PARAMS)
def test_a_gate_written_down_and_read_back_goes_on_as_if_never_stopped(
    run: list[set[str]], params: GateParams
) -> None:
    gate, pairs = VocabularyGate.empty(params), []
    for frame_id, words in _numbered(run):
        gate = VocabularyGate(params, {word: tuple(frames) for word, frames in gate.named.items()})
        gate, admission = gate.observe(frame_id, words)
        pairs += [(frame_id, word) for word in admission.words] + list(admission.late)

    assert pairs == _online(_numbered(run), params)


@given(RUNS, PARAMS)
def test_the_gate_remembers_no_more_frames_of_a_word_than_it_needs(
    run: list[set[str]], params: GateParams
) -> None:
    gate = VocabularyGate.empty(params)
    for frame_id, words in _numbered(run):
        gate, _ = gate.observe(frame_id, words)

    assert all(len(frames) <= params.n_min for frames in gate.named.values())


def test_a_word_is_admitted_at_its_third_frame_and_the_first_two_are_caught_up_by_hand() -> None:
    gate = VocabularyGate.empty(GateParams(3, frozenset({"logo"})))
    gate, first = gate.observe("f1", ["cup", "logo"])
    gate, second = gate.observe("f2", ["cup", "logo", "chair"])
    gate, third = gate.observe("f3", ["logo", "cup"])
    gate, fourth = gate.observe("f4", ["cup", "chair"])
    gate, fifth = gate.observe("f5", ["chair"])

    assert (first.words, first.late) == ((), ())
    assert (second.words, second.late) == ((), ())
    assert (third.words, third.late) == (("cup",), (("f1", "cup"), ("f2", "cup")))
    assert (fourth.words, fourth.late) == (("cup",), ())
    assert (fifth.words, fifth.late) == (("chair",), (("f2", "chair"), ("f4", "chair")))
    assert gate.vocabulary == ("chair", "cup")


def test_with_n_min_1_every_word_is_grounded_at_once_and_nothing_late() -> None:
    gate = VocabularyGate.empty(GateParams(1))
    gate, first = gate.observe("f1", ["cup", "table"])
    gate, second = gate.observe("f2", ["cup"])

    assert (first.words, first.late) == (("cup", "table"), ())
    assert (second.words, second.late) == (("cup",), ())


def test_a_blacklisted_word_is_never_grounded() -> None:
    tags = [(f"f{i}", ["logo", "text", "pipe", "cup"]) for i in range(5)]

    assert {word for _, word in _online(tags, GateParams(3))} == {"cup"}
    assert {word for _, word in gate_offline(tags, GateParams(3))} == {"cup"}


def test_a_word_named_twice_in_one_frame_counts_once() -> None:
    gate = VocabularyGate.empty(GateParams(2))
    gate, first = gate.observe("f1", ["cup", "cup"])

    assert first.words == ()
    assert gate.vocabulary == ()


def test_the_order_of_a_frames_words_does_not_matter() -> None:
    params = GateParams(2)
    one = _online([("f1", ["cup", "lamp"]), ("f2", ["lamp", "cup"])], params)
    other = _online([("f1", ["lamp", "cup"]), ("f2", ["cup", "lamp"])], params)

    assert one == other


def test_observing_changes_no_earlier_gate() -> None:
    before = VocabularyGate.empty(GateParams(1))
    before.observe("f1", ["cup"])

    assert before.vocabulary == ()


def test_no_frames_and_no_words_ground_nothing() -> None:
    assert gate_offline([], GateParams()) == set()
    assert _online([("f1", []), ("f2", [])], GateParams(1)) == []
