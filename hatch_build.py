"""The README of a distribution: its pictures and links work outside of the repository."""

import base64
import mimetypes
import os
import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

REPOSITORY_VARIABLE = "CHROMANOISE_REPOSITORY"
"""Names the environment variable with the address of the repository, as a release sets it."""

_RELATIVE = re.compile(r"(!?)\[([^\]]*)\]\((?!https?:|#|data:)([^)\s]+)\)")


def portable_readme(text: str, *, folder: Path, repository: str | None, version: str) -> str:
    """The README with absolute links, or, without a repository, with its pictures inside.

    Parameters
    ----------
    text
        Markdown.
    folder
        The folder of the README.
    repository
        Address of the repository; None if it is unknown: then pictures become ``data:`` addresses
        and links to files become their text.
    version
        Of the distribution; a released version is the name of a tag behind a ``v``.
    """
    revision = f"v{version}" if re.fullmatch(r"[0-9.]+", version) else "HEAD"

    def replaced(match: re.Match[str]) -> str:
        picture, words, target = match.groups()
        if repository:
            kind = "raw" if picture else "blob"
            return f"{picture}[{words}]({repository.rstrip('/')}/{kind}/{revision}/{target})"
        return f"![{words}]({_data_address(folder / target)})" if picture else words

    return _RELATIVE.sub(replaced, text)


def _data_address(path: Path) -> str:
    kind = mimetypes.guess_type(path.name)[0] or "application/octet-stream"
    return f"data:{kind};base64,{base64.b64encode(path.read_bytes()).decode('ascii')}"


class CustomMetadataHook(MetadataHookInterface):
    """Adds the README to the metadata of a build."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Set ``readme``."""
        folder = Path(self.root)
        text = portable_readme(
            (folder / "README.md").read_text(encoding="utf-8"),
            folder=folder,
            repository=os.environ.get(REPOSITORY_VARIABLE) or None,
            version=str(metadata.get("version", "")),
        )
        metadata["readme"] = {"content-type": "text/markdown", "text": text}
