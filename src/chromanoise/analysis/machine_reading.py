"""All that is computed of one sensor for a machine: separation, contrast detection, information."""

from dataclasses import dataclass
from typing import Any

from chromanoise.analysis.analysis import Analysis
from chromanoise.analysis.contrast_detection import (
    ContrastDetection,
    contrast_detection_as_json,
    contrast_detection_of,
)
from chromanoise.analysis.information import (
    InformationChain,
    information_as_json,
    information_chains,
)
from chromanoise.analysis.separation import Separation, separation_as_json, separation_of


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MachineReading:
    """What a machine can know from the raw values of one sensor.

    Attributes
    ----------
    label
        Of the sensor.
    separation, contrast
        ``None`` where a patch or a gray saturates a channel.
    information
        About the whole spectrum of the default prior, then about its visible part; empty where a
        channel is saturated on the white.
    """

    label: str
    separation: Separation | None
    contrast: ContrastDetection | None
    information: tuple[InformationChain, ...]


def machine_reading(analysis: Analysis) -> MachineReading:
    """Separation, contrast detection and information at the operating point of an analysis.

    Parameters
    ----------
    analysis
        With sensor, exposure, light, matrix and pairs.

    Raises
    ------
    InputError
        As `separation_of`.
    """
    return MachineReading(
        label=analysis.sensor.label,
        separation=separation_of(analysis),
        contrast=contrast_detection_of(analysis),
        information=information_chains(analysis),
    )


def machine_reading_as_json(reading: MachineReading) -> dict[str, Any]:
    """The three results by their JSON keys."""
    return {
        "separation": separation_as_json(reading.separation),
        "contrast_detection": contrast_detection_as_json(reading.contrast),
        "information": [information_as_json(one) for one in reading.information],
    }
