"""Protobuf and gRPC stubs generated from proto/ovip/v1 by `make proto`; not edited by hand."""
