"""The `ovip` command, one file a subcommand."""
