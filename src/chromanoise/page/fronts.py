"""The front of a design on the page: its chart, and the data that load each member."""

from pathlib import PurePosixPath
from typing import Any

from chromanoise.charts.front import drawn_front
from chromanoise.design import (
    FRONT_SCHEMA,
    FrontFile,
    FrontMember,
    FrontScene,
    member_csv,
    read_front,
)
from chromanoise.page.uploads import Upload

_HEAD_BYTES = 2000


def is_front(upload: Upload) -> bool:
    """Whether a file declares the schema of a front."""
    if not upload.path.is_file():
        return False
    with upload.path.open("rb") as file:
        return f'"{FRONT_SCHEMA}"'.encode() in file.read(_HEAD_BYTES)


def front_preview(upload: Upload) -> dict[str, Any]:
    """The content of a front: ``chart``, ``scenes``, and by name the ``members`` with their curves.

    Raises
    ------
    InputError
        If the front or the curves of a member are invalid.
    """
    front = read_front(upload.path)
    return {
        "kind": "front",
        "preview": [_content(front), *front.sentences],
        "front": {
            "chart": drawn_front(front),
            "scenes": [_scene(one) for one in front.scenes],
            "members": {one.name: _member(one) for one in front.members},
        },
    }


def _content(front: FrontFile) -> str:
    count = len(front.members)
    objectives = ", ".join(one.what for one in front.objectives)
    return f"A front of {count} sensor{'' if count == 1 else 's'}: {objectives}."


def _scene(scene: FrontScene) -> dict[str, Any]:
    return scene.model_dump(mode="json")


def _member(member: FrontMember) -> dict[str, Any]:
    return {
        "file": f"{PurePosixPath(member.sensor).stem or member.name}.csv",
        "text": member_csv(member),
        **member.model_dump(mode="json", include={"pixel", "exposure", "matrix"}),
    }
