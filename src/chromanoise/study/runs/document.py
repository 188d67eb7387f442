"""What a study file may say: light, sensors, exposure rule, matrices, sweeps, pictures, outputs.

The classes are the schema: what they accept is what a study can be.
"""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from chromanoise.scene import BUILTIN_CUBES
from chromanoise.spectra import METRICS
from chromanoise.study.makers import METHODS
from chromanoise.study.priors import DEFAULT_PRIOR, PRIORS
from chromanoise.study.quantities import QUANTITIES
from chromanoise.study.sweeps import SWEEPS

SCHEMA = 1
"""Number of this schema; a later one that reads differently gets another."""

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Beyond = Literal["refuse", "zero", "hold"]


class _Part(BaseModel):
    """Unknown keys are faults, values are not converted from other types, nothing changes later."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class LightPart(_Part):
    """The light on the scene."""

    illuminant: str = Field("E", description="E, A, G173, D65 ..., 3200K, LED660, or a file.")
    level_lux: Positive = Field(10.0, description="Illuminance [lx].")
    beyond: Beyond = Field("refuse", description="What the curve is beyond its end.")


class PixelPart(_Part):
    """What differs from the sensor's own pixel."""

    pitch_um: Positive | None = Field(None, description="Side of the pixel [um].")
    full_well_e: Positive | None = Field(None, description="Electrons at saturation [e-].")
    read_noise_e: NotNegative | None = Field(None, description="Standard deviation [e-].")


class SensorPart(_Part):
    """One sensor."""

    name: str = Field(description="Of the catalogue, or a file of QE curves.")
    beyond: Beyond = Field("refuse", description="What the curves are beyond their end.")
    pixel: PixelPart = Field(PixelPart(), description="Changes to its pixel.")


class ExposurePart(_Part):
    """How long, through which lens, and on which terms the sensors are compared."""

    equal: Literal["exposure", "saturation", "light"] = Field(
        "exposure", description="One time; each filled alike; the same photons for each set."
    )
    time_ms: Positive | None = Field(None, description="One time for all [ms], not solved.")
    saturate: Annotated[float, Field(gt=0, le=1)] = Field(
        0.99, description="Share of full well that a white fills where the time is solved."
    )
    f_number: Positive = Field(1.8, description="Aperture.")
    magnification: Finite | None = Field(None, description="Camera equation instead.")

    @model_validator(mode="after")
    def _one_rule(self) -> "ExposurePart":
        if self.time_ms is not None and self.equal != "exposure":
            raise ValueError(f"time_ms gives all sensors one time, so equal cannot be {self.equal}")
        return self


class SweepPart(_Part):
    """One thing that varies, and what is asked of it."""

    vary: str = Field(description=f"Of {', '.join(SWEEPS)}.")
    first: Finite = Field(description="Lowest value, in the unit of the sweep.")
    last: Finite = Field(description="Highest value.")
    points: Annotated[int, Field(ge=2, le=100_000)] = Field(61, description="How many.")
    quantity: str = Field("snr-y", description=f"Of {', '.join(QUANTITIES)}.")
    all_priors: bool = Field(False, description="Also the band of crossovers over all priors.")


class PicturePart(_Part):
    """One cube through every sensor."""

    cube: str = Field("builtin:checker", description=f"Of {', '.join(BUILTIN_CUBES)}, or a file.")
    scale: Positive | None = Field(None, description="Reflectance per stored unit.")
    clip: bool = Field(False, description="Hold electrons between 0 and full well.")
    beyond: Beyond = Field("refuse", description="What reflectances are beyond the cube's end.")


class OutputsPart(_Part):
    """What is written."""

    budget: bool = Field(True, description="dB per cause of X, Y, Z, contravariant, L*, a*, b*.")
    chart: bool = Field(False, description="Color error and noise of every ColorChecker patch.")
    space: str | None = Field(None, description="Noise of an 18 % grey in this color space.")


class Study(_Part):
    """One reproducible run."""

    schema_number: Literal[1] = Field(1, alias="schema", description="Of this format: 1.")
    title: str = Field("", description="For people.")
    metric: str = Field("quanta", description=f"Light is a vector in {' or '.join(METRICS)}.")
    seed: Annotated[int, Field(ge=0, lt=2**32)] = Field(
        0, description="Of all noise that is drawn."
    )
    light: LightPart = Field(LightPart(), description="The light on the scene.")
    exposure: ExposurePart = Field(ExposurePart(), description="How the time is found.")
    sensors: Annotated[tuple[SensorPart, ...], Field(min_length=1, strict=False)]
    matrices: Annotated[tuple[str, ...], Field(min_length=1, strict=False)] = Field(
        ("kernel",), description=f"Color matrices: {', '.join(METHODS)}; ridge=0.01."
    )
    prior: str = Field(DEFAULT_PRIOR, description=f"Of trained matrices: {', '.join(PRIORS)}.")
    sweeps: Annotated[tuple[SweepPart, ...], Field(strict=False)] = ()
    pictures: Annotated[tuple[PicturePart, ...], Field(strict=False)] = ()
    outputs: OutputsPart = Field(OutputsPart(), description="What is written.")


def study_schema() -> dict[str, Any]:
    """The JSON Schema of a study file, for editors and other programs."""
    return Study.model_json_schema(by_alias=True) | {
        "$schema": "https://json-schema.org/draft/2020-12/schema"
    }
