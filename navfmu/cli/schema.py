"""``navfmu schema``: what may stand in a kind of file, as a JSON schema for editors."""

from __future__ import annotations

import importlib

import click

from navfmu.errors import NavfmuError, nearest

KINDS = {  # kind of file -> module and class that declare it
    "campaign": ("navfmu.campaign.schema", "CampaignFile"),
    "faults": ("navfmu.faults.schema", "FaultFile"),
    "report": ("navfmu.system.report_file", "Content"),
}


def schema(kind: str) -> str:
    """The JSON schema of a kind of file."""
    import json

    from navfmu.files.schema import json_schema

    if kind not in KINDS:
        raise NavfmuError(f"there is no kind of file '{kind}'{nearest(kind, KINDS)} (there are: {', '.join(KINDS)})")
    module, name = KINDS[kind]
    return json.dumps(json_schema(getattr(importlib.import_module(module), name)), indent=2, ensure_ascii=False)


@click.command("schema")
@click.argument("kind", metavar=f"[{'|'.join(KINDS)}]")
def command(kind: str) -> None:
    """Print the JSON schema of a kind of file, with which editors complete and check it."""
    click.echo(schema(kind))
