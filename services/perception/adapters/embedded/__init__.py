"""Small real models on the CPU: SSD-MobileNetV2, U2NetP, EfficientNet-Lite with MiniLM (DESIGN 5)."""

from services.perception.adapters.embedded.conse import ConseEncoder
from services.perception.adapters.embedded.detector import DetectorEnumerator, DetectorGrounder, TiledDetector
from services.perception.adapters.embedded.minilm import MiniLm
from services.perception.adapters.embedded.saliency import SaliencySegmenter

__all__ = [
    "ConseEncoder",
    "DetectorEnumerator",
    "DetectorGrounder",
    "MiniLm",
    "SaliencySegmenter",
    "TiledDetector",
]
