"""``chromanoise cite``: how to cite the program and the paper whose equations it computes."""

from collections.abc import Mapping
from dataclasses import dataclass

import click

from chromanoise import __version__
from chromanoise.cli.parsing import command

RELEASE_YEAR = "2026"
"""Of the newest release in the changelog."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """What is cited.

    Attributes
    ----------
    kind
        Of the entry, as BibTeX names it.
    key
        Of the entry.
    fields
        Further fields in their order, as BibTeX names them.
    text
        The reference as one line.
    """

    kind: str
    key: str
    fields: Mapping[str, str]
    text: str


def references(version: str) -> tuple[Reference, Reference]:
    """The program, and the paper.

    Parameters
    ----------
    version
        Of the program that was used.
    """
    title = "chromanoise: from photons to color, with the noise"
    developers = "the chromanoise developers"
    program = Reference(
        kind="software",
        key="chromanoise",
        fields={
            "author": f"{{{developers}}}",
            "title": f"{{{title}}}",
            "version": version,
            "year": RELEASE_YEAR,
            "license": "BSD-3-Clause",
        },
        text=f"{developers.capitalize()}, {title}, version {version} ({RELEASE_YEAR}).",
    )
    of_paper = (
        "Physical noise propagation in color image construction: a geometrical interpretation"
    )
    paper = Reference(
        kind="inproceedings",
        key="clouet2019",
        fields={
            "author": r"Clouet, Axel and Vaillant, J{\'e}r{\^o}me and Alleysson, David",
            "title": f"{{{of_paper}}}",
            "booktitle": "27th Color and Imaging Conference (CIC27)",
            "year": "2019",
        },
        text=f"Axel Clouet, Jérôme Vaillant, David Alleysson, {of_paper}, 27th Color and Imaging "
        "Conference (CIC27), 2019.",
    )
    return program, paper


def as_bibtex(reference: Reference) -> str:
    """The reference as an entry of BibTeX."""
    width = max(map(len, reference.fields))
    lines = [f"  {name:<{width}} = {{{value}}}," for name, value in reference.fields.items()]
    return "\n".join([f"@{reference.kind}{{{reference.key},", *lines, "}"])


@command()
@click.option("--bibtex", is_flag=True, help="Print BibTeX entries.")
def cite(bibtex: bool) -> None:
    """Print how to cite chromanoise and the paper whose equations it computes.

    The version is that of this installation, so that others can repeat the results with it.
    """
    for reference in references(__version__):
        click.echo(as_bibtex(reference) if bibtex else reference.text)
