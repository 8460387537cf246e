"""How many tokens a question will cost, estimated before it is asked; errs on the high side."""

from __future__ import annotations

import math

from services.vlm_gateway.domain.question import Question

# English runs at 4 bytes a token, other scripts at 2 to 3; the estimate pays for limits, so it rounds up.
BYTES_PER_TOKEN = 3
# Qwen2-VL and its kin merge 28x28 pixels into one token, the densest of the common image encoders
# (a 1024x768 image: 37 * 28 = 1,036 tokens; GPT-4o's tiles make 765 of it).
IMAGE_PATCH = 28
MESSAGE_OVERHEAD = 32


def estimate_tokens(question: Question, image_max_side: int) -> int:
    """Prompt, schema, images (shrunk to `image_max_side` pixels) and the longest reply, in tokens."""
    text = math.ceil((len(question.prompt.encode()) + len(question.schema.text)) / BYTES_PER_TOKEN)
    return MESSAGE_OVERHEAD + text + _image_tokens(question, image_max_side) + question.max_output_tokens


def _image_tokens(question: Question, max_side: int) -> int:
    sizes = (size.fitted(max_side) for size in question.sizes)
    return sum(math.ceil(size.width / IMAGE_PATCH) * math.ceil(size.height / IMAGE_PATCH) for size in sizes)
