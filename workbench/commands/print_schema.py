"""The command schema: the JSON schema of study files, for editors."""

import json


def schema() -> int:
    """Print the JSON schema of study files, by which editors complete keys and mark errors.

    Store it beside a study, workbench schema > study.schema.json, and write #:schema study.schema.json as the first
    line of the study: editors with taplo, such as VS Code with Even Better TOML, then explain each key.
    """
    from studies.language.study_schema import study_schema

    print(json.dumps(study_schema(), indent=2, ensure_ascii=False))
    return 0
