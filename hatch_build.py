"""The README and the links of a distribution, with the address of the repository if it is known."""

import os
import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

REPOSITORY_VARIABLE = "CHROMANOISE_REPOSITORY"
"""Names the environment variable with the address of the repository, as a release sets it."""

_RELATIVE = re.compile(r"(!?)\[([^\]]*)\]\((?!https?:|#)([^)\s]+)\)")
_PAGES = {
    "Documentation": "docs/index.md",
    "Changelog": "CHANGELOG.md",
    "Deprecations": "docs/stability.md",
}


def _revision(version: str) -> str:
    """The tag of a released version, else the newest commit."""
    return f"v{version}" if re.fullmatch(r"[0-9.]+", version) else "HEAD"


def portable_readme(text: str, *, repository: str | None, version: str) -> str:
    """The README with absolute links to the repository.

    Parameters
    ----------
    text
        Markdown.
    repository
        Its address; None if it is unknown: then pictures and links to files become their words.
    version
        Of the distribution; a released version is the name of a tag behind a ``v``.
    """

    def replaced(match: re.Match[str]) -> str:
        picture, words, target = match.groups()
        if not repository:
            return f"*{words}*" if picture else words
        kind = "raw" if picture else "blob"
        return f"{picture}[{words}]({repository.rstrip('/')}/{kind}/{_revision(version)}/{target})"

    return _RELATIVE.sub(replaced, text)


def project_links(*, repository: str | None, version: str) -> dict[str, str]:
    """The addresses that a package index shows, by their names; none without a repository."""
    if not repository:
        return {}
    home = repository.rstrip("/")
    pages = {name: f"{home}/blob/{_revision(version)}/{page}" for name, page in _PAGES.items()}
    return {"Repository": home, "Issues": f"{home}/issues", **pages}


class CustomMetadataHook(MetadataHookInterface):
    """Adds README and links to the metadata of a build."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Set ``readme`` and ``urls``."""
        repository = os.environ.get(REPOSITORY_VARIABLE) or None
        version = str(metadata.get("version", ""))
        readme = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        text = portable_readme(readme, repository=repository, version=version)
        metadata["readme"] = {"content-type": "text/markdown", "text": text}
        metadata["urls"] = project_links(repository=repository, version=version)
