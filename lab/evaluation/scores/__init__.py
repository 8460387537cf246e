"""The protocols' metrics as pure functions of arrays; `compat` has the evaluators' quirks, `strict` is honest."""
