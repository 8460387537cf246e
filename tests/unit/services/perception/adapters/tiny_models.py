"""Writes small models with random weights in the formats of the real ones: they see nothing, but they run."""

from __future__ import annotations

import json
from pathlib import Path

import torch
from tokenizers import Tokenizer
from tokenizers.models import WordPiece
from tokenizers.normalizers import Lowercase
from tokenizers.pre_tokenizers import BertPreTokenizer
from tokenizers.processors import BertProcessing
from transformers import (
    BertConfig,
    BitImageProcessor,
    CLIPConfig,
    CLIPImageProcessor,
    CLIPModel,
    CLIPProcessor,
    CLIPTextConfig,
    DetrImageProcessor,
    Dinov2Config,
    Dinov2Model,
    GroundingDinoConfig,
    GroundingDinoForObjectDetection,
    GroundingDinoImageProcessor,
    GroundingDinoProcessor,
    OmDetTurboConfig,
    OmDetTurboForObjectDetection,
    OmDetTurboProcessor,
    Owlv2Config,
    Owlv2ForObjectDetection,
    Owlv2ImageProcessor,
    Owlv2Processor,
    PreTrainedTokenizerFast,
    Sam2Config,
    Sam2ImageProcessor,
    Sam2Model,
    Sam2Processor,
    SwinConfig,
    ViTConfig,
    ViTImageProcessor,
    ViTModel,
)
from transformers.models.sam2.configuration_sam2 import Sam2HieraDetConfig, Sam2VisionConfig

_PIECES = ["[PAD]", "[UNK]", "[CLS]", "[SEP]", ".", ",", *"abcdefghijklmnopqrstuvwxyz"]
_VOCABULARY = {
    piece: number
    for number, piece in enumerate(
        [*_PIECES, *(f"##{letter}" for letter in "abcdefghijklmnopqrstuvwxyz"), "cup", "dining", "table"]
    )
}


def tiny_tokenizer(longest: int) -> PreTrainedTokenizerFast:
    """Letters, and the words cup, dining and table, in BERT's way."""
    made = Tokenizer(WordPiece(_VOCABULARY, unk_token="[UNK]"))
    made.normalizer = Lowercase()
    made.pre_tokenizer = BertPreTokenizer()
    made.post_processor = BertProcessing(("[SEP]", 3), ("[CLS]", 2))
    return PreTrainedTokenizerFast(
        tokenizer_object=made,
        pad_token="[PAD]",
        unk_token="[UNK]",
        cls_token="[CLS]",
        sep_token="[SEP]",
        model_max_length=longest,
    )


def write_grounding_dino(folder: Path) -> Path:
    """A Grounding DINO of 20 queries and 24 text tokens."""
    torch.manual_seed(0)
    config = GroundingDinoConfig(
        backbone_config=_swin(),
        text_config=BertConfig(
            vocab_size=len(_VOCABULARY),
            hidden_size=32,
            num_hidden_layers=1,
            num_attention_heads=2,
            intermediate_size=32,
        ),
        d_model=32,
        encoder_layers=1,
        decoder_layers=2,
        encoder_attention_heads=2,
        decoder_attention_heads=2,
        encoder_ffn_dim=32,
        decoder_ffn_dim=32,
        num_queries=20,
        max_text_len=24,
    )
    GroundingDinoForObjectDetection(config).save_pretrained(folder)
    images = GroundingDinoImageProcessor(size={"shortest_edge": 96, "longest_edge": 128})
    GroundingDinoProcessor(images, tiny_tokenizer(24)).save_pretrained(folder)
    return folder


def write_owlv2(folder: Path) -> Path:
    """An OWLv2 of 16 patches."""
    torch.manual_seed(0)
    config = Owlv2Config(
        text_config={
            "vocab_size": len(_VOCABULARY),
            "hidden_size": 32,
            "intermediate_size": 32,
            "num_hidden_layers": 1,
            "num_attention_heads": 2,
            "max_position_embeddings": 32,
        },
        vision_config={
            "hidden_size": 32,
            "intermediate_size": 32,
            "num_hidden_layers": 1,
            "num_attention_heads": 2,
            "image_size": 64,
            "patch_size": 16,
        },
        projection_dim=32,
    )
    model = Owlv2ForObjectDetection(config)
    for weight in model.box_head.parameters():
        weight.data *= 0.05  # else every box is a line
    model.save_pretrained(folder)
    images = Owlv2ImageProcessor(size={"height": 64, "width": 64})
    Owlv2Processor(images, tiny_tokenizer(32)).save_pretrained(folder)
    return folder


def write_omdet_turbo(folder: Path) -> Path:
    """An OmDet-Turbo of 20 queries."""
    torch.manual_seed(0)
    config = OmDetTurboConfig(
        backbone_config=_swin(),
        text_config=CLIPTextConfig(
            vocab_size=len(_VOCABULARY),
            hidden_size=48,
            intermediate_size=32,
            num_hidden_layers=1,
            num_attention_heads=2,
            max_position_embeddings=80,
            eos_token_id=3,
        ),
        apply_layernorm_after_vision_backbone=False,
        image_size=64,
        text_projection_in_dim=48,
        text_projection_out_dim=48,
        class_embed_dim=48,
        task_encoder_hidden_dim=32,
        encoder_hidden_dim=32,
        vision_features_channels=[32, 32, 32],
        encoder_in_channels=[32, 64, 128],
        encoder_dim_feedforward=32,
        encoder_attention_heads=2,
        decoder_hidden_dim=32,
        decoder_dim_feedforward=32,
        decoder_num_layers=2,
        decoder_num_heads=2,
        num_queries=20,
    )
    OmDetTurboForObjectDetection(config).save_pretrained(folder)
    images = DetrImageProcessor(size={"height": 64, "width": 64})
    OmDetTurboProcessor(images, tiny_tokenizer(77)).save_pretrained(folder)
    return folder


def write_sam2(folder: Path) -> Path:
    """A SAM 2 for images of 128 pixels."""
    torch.manual_seed(0)
    backbone = Sam2HieraDetConfig(
        image_size=[128, 128],
        hidden_size=8,
        blocks_per_stage=[1, 1, 2, 1],
        embed_dim_per_stage=[8, 16, 32, 64],
        num_attention_heads_per_stage=[1, 1, 1, 1],
        window_size_per_stage=[4, 4, 4, 4],
        global_attention_blocks=[3],
    )
    vision = Sam2VisionConfig(
        backbone_config=backbone,
        backbone_channel_list=[64, 32, 16, 8],
        backbone_feature_sizes=[[32, 32], [16, 16], [8, 8]],
        fpn_hidden_size=32,
    )
    config = Sam2Config(
        vision_config=vision,
        prompt_encoder_config={"hidden_size": 32, "image_size": 128},
        mask_decoder_config={
            "hidden_size": 32,
            "iou_head_hidden_dim": 32,
            "mlp_dim": 32,
            "num_attention_heads": 2,
        },
    )
    Sam2Model(config).save_pretrained(folder)
    Sam2Processor(Sam2ImageProcessor(size={"height": 128, "width": 128})).save_pretrained(folder)
    return folder


def write_clip(folder: Path) -> Path:
    """A CLIP of 24 dimensions in transformers' format."""
    torch.manual_seed(0)
    shared = {"hidden_size": 32, "intermediate_size": 32, "num_hidden_layers": 1, "num_attention_heads": 2}
    text = {**shared, "vocab_size": len(_VOCABULARY), "max_position_embeddings": 32, "eos_token_id": 3}
    config = CLIPConfig(
        text_config=text, vision_config={**shared, "image_size": 32, "patch_size": 16}, projection_dim=24
    )
    CLIPModel(config).save_pretrained(folder)
    images = CLIPImageProcessor(size={"shortest_edge": 32}, crop_size={"height": 32, "width": 32})
    CLIPProcessor(images, tiny_tokenizer(32)).save_pretrained(folder)
    return folder


def write_open_clip(folder: Path) -> Path:
    """A CLIP of 24 dimensions in open_clip's format."""
    import open_clip

    torch.manual_seed(0)
    config = {
        "embed_dim": 24,
        "vision_cfg": {"image_size": 32, "layers": 1, "width": 32, "head_width": 16, "patch_size": 16},
        "text_cfg": {"context_length": 16, "vocab_size": 49408, "width": 32, "heads": 2, "layers": 1},
    }
    model = open_clip.model.CLIP(**config)
    folder.mkdir(parents=True, exist_ok=True)
    torch.save(model.state_dict(), folder / "open_clip_pytorch_model.bin")
    settings = {"mean": [0.48, 0.46, 0.41], "std": [0.27, 0.26, 0.28], "interpolation": "bicubic"}
    (folder / "open_clip_config.json").write_text(
        json.dumps({"model_cfg": config, "preprocess_cfg": settings})
    )
    return folder


def write_dinov2(folder: Path) -> Path:
    """A DINOv2 of 32 dimensions for images of 28 pixels."""
    torch.manual_seed(0)
    config = Dinov2Config(
        hidden_size=32, num_hidden_layers=1, num_attention_heads=2, mlp_ratio=2, image_size=28, patch_size=14
    )
    Dinov2Model(config).save_pretrained(folder)
    size = {"height": 28, "width": 28}
    BitImageProcessor(size={"shortest_edge": 32}, crop_size=size).save_pretrained(folder)
    return folder


def write_first_dino(folder: Path) -> Path:
    """A first DINO, which is a ViT without a pooler."""
    torch.manual_seed(0)
    config = ViTConfig(
        hidden_size=32,
        intermediate_size=32,
        num_hidden_layers=1,
        num_attention_heads=2,
        image_size=32,
        patch_size=16,
    )
    ViTModel(config, add_pooling_layer=False).save_pretrained(folder)
    ViTImageProcessor(size={"height": 32, "width": 32}).save_pretrained(folder)
    return folder


def _swin() -> SwinConfig:
    return SwinConfig(
        image_size=64,
        embed_dim=16,
        depths=[1, 1, 1, 1],
        num_heads=[1, 1, 1, 1],
        window_size=4,
        out_indices=[2, 3, 4],
    )
