"""Explanations of charts and their formulas, for the ``?`` of the page, for reports and the demo.

An explanation has words, formulas, their symbols and the source. Formulas are written in LaTeX and
converted to MathML.
"""

from collections.abc import Mapping
from functools import cache
from html import escape
from importlib import resources
from typing import Any

from chromanoise.base import dataclass, json_of


def mathml(latex: str, *, block: bool = False) -> str:
    r"""A formula as one MathML element, which browsers draw and screen readers speak.

    Parameters
    ----------
    latex
        One of the formulas in ``formulas.json``, which ``python tools/make_formulas.py`` writes.
    block
        Whether it stands in a line of its own.

    Examples
    --------
    >>> mathml("Y").startswith("<math")
    True
    """
    return _formulas()["block" if block else "inline"][latex]


@cache
def _formulas() -> dict[str, dict[str, str]]:
    """MathML by LaTeX, of formulas in a line of their own and of those within a line."""
    text = resources.files("chromanoise.charts").joinpath("formulas.json").read_text("utf-8")
    found: dict[str, dict[str, str]] = json_of(text, "formulas.json")
    return found


def coordinate_mathml(coordinate: str) -> str:
    """A contravariant coordinate as one MathML element; the name of its channel is plain text.

    Parameters
    ----------
    coordinate
        ``M^`` and the name of a channel, which a file may give.

    Examples
    --------
    >>> coordinate_mathml("M^<b>").partition("<msup>")[2].partition("</msup>")[0]
    '<mi>M</mi><mtext>&lt;b&gt;</mtext>'
    """
    letter, _, channel = coordinate.partition("^")
    raised = f"<msup><mi>{escape(letter)}</mi><mtext>{escape(channel)}</mtext></msup>"
    return f'<math xmlns="http://www.w3.org/1998/Math/MathML" display="inline">{raised}</math>'


_PAPER = "Clouet, Vaillant & Alleysson, CIC27 (2019)"


@dataclass(frozen=True)
class Symbol:
    """One symbol of a formula.

    Attributes
    ----------
    meaning
        What it stands for.
    unit
        Its unit; ``1`` for a number without unit, empty for a name or an index.
    name
        Its row in docs/nomenclature.md; empty for one without a row.
    """

    latex: str
    meaning: str
    unit: str = ""
    name: str = ""


@dataclass(frozen=True, kw_only=True)
class Explanation:
    """What a chart shows, in words and as formulas.

    Attributes
    ----------
    title
        Name of the quantity.
    words
        What it is, what a large value means, and why it matters, in plain sentences.
    symbols
        Every symbol of the formulas.
    source
        Publication and number of the equation.
    """

    title: str
    words: str
    latex: tuple[str, ...]
    symbols: tuple[Symbol, ...]
    source: str


_ELECTRONS = Symbol("M_i", "electrons that channel i collects on average", unit="e⁻", name="mean_e")
_MEAN = Symbol("M", "mean electrons of all channels, a vector", unit="e⁻", name="mean_e")
_CHANNEL = Symbol("i", "a channel of the sensor, for example R")
_COORDINATE = Symbol("c", "one of X, Y, Z")
_VARIANCE = Symbol(
    "D_{ii}",
    "variance of channel i; dark current, quantization, DSNU, PRNU and the pattern of "
    "crosstalk are added where the sensor has them",
    unit="e⁻²",
    name="raw.covariance",
)
_READ_NOISE = Symbol(
    r"\sigma_{\mathrm{rn}}", "read noise, a standard deviation", unit="e⁻", name="read_noise_e"
)
_LIGHT = Symbol(
    "L", "light from the scene at each wavelength", unit="photons s⁻¹ µm⁻² nm⁻¹", name="light"
)
_REBUILT = Symbol(
    r"\hat{L}",
    "spectrum reconstructed from the electrons",
    unit="photons s⁻¹ µm⁻² nm⁻¹",
    name="light",
)
_TWO_SNRS = (
    Symbol(r"\mathrm{SNR}_{\mathrm{A}}", "color SNR of a sensor", unit="dB"),
    Symbol(r"\mathrm{SNR}_{\mathrm{B}}", "that of another", unit="dB"),
)
_SNR = Symbol(r"\mathrm{SNR}", "signal-to-noise ratio", unit="dB")
_RAW = Symbol(
    "D",
    "covariance of the raw channels; without crosstalk after counting, their variances "
    "on the diagonal",
    unit="e⁻²",
    name="raw.covariance",
)
_BASIS = Symbol(
    "F", "measurement vectors, one column per channel", unit="e⁻ per unit of L", name="basis"
)
_GRAM = Symbol("G", "products of all pairs of channels", name="inverse_gram")
_TRANSPOSED = Symbol(r"\top", "transposed: rows and columns change places")
_MATRIX = Symbol("C", "color matrix, from electrons to X, Y, Z", unit="lx/e⁻", name="matrix")
_NOISE_OF_COLORS = Symbol(r"\Sigma", "covariance of the color, from noise alone", name="covariance")
_WAVELENGTH = Symbol(r"\lambda", "wavelength", unit="nm", name="wavelength_nm")

EXPLANATIONS: Mapping[str, Explanation] = {
    "electrons": Explanation(
        title="Expected electrons",
        words="A pixel turns a part of the photons that reach it into electrons. The quantum "
        "efficiency is that part, at each wavelength. More electrons mean less noise relative to "
        "the signal. More light, a longer exposure time, a larger pixel and a wider aperture all "
        "give more electrons, until the pixel is full.",
        latex=(
            r"M_i = k \sum_{\lambda} \mathrm{QE}_i(\lambda) \, L(\lambda)",
            r"k = \frac{t \, a^2 \, \delta\lambda}{4 f_{\#}^2}",
        ),
        symbols=(
            _ELECTRONS,
            _CHANNEL,
            Symbol(
                r"\mathrm{QE}", "quantum efficiency with all filters", unit="e⁻/photon", name="qe"
            ),
            _LIGHT,
            _WAVELENGTH,
            Symbol("k", "exposure factor", unit="s µm² nm", name="exposure factor"),
            Symbol("t", "exposure time", unit="s", name="time_s"),
            Symbol("a", "pixel pitch", unit="µm", name="pitch_um"),
            Symbol(r"\delta\lambda", "step between wavelengths", unit="nm", name="step_nm"),
            Symbol(r"f_{\#}", "f-number of the lens", unit="1", name="f_number"),
        ),
        source=f"{_PAPER}, eq. 1-2",
    ),
    "picture": Explanation(
        title="The picture",
        words="Each pixel of the scene gives each channel a number of electrons on average. What a "
        "single exposure counts is drawn at random around it, with photon noise and read noise; "
        "counts above a full well are cut off if the picture is clipped. The color matrix turns "
        "the counts into colors, and the picture is scaled so that white is white. So a sensor "
        "that collects more light does not look brighter; only its noise differs.",
        latex=(r"D_{ii} = M_i + \sigma_{\mathrm{rn}}^2",),
        symbols=(_ELECTRONS, _CHANNEL, _VARIANCE, _READ_NOISE),
        source=f"{_PAPER}, eq. 7 and figure 8",
    ),
    "raw": Explanation(
        title="Raw SNR",
        words="The signal of one channel divided by its noise, before any color is computed. "
        "Photons arrive at random, so even a perfect pixel is noisy; the readout adds some noise. "
        "A large value means a smooth raw picture. It does not yet mean smooth colors, because "
        "each color is computed from several channels.",
        latex=(
            r"\mathrm{SNR}_i = 20 \, \log_{10} \frac{M_i}{\sqrt{D_{ii}}}",
            r"D_{ii} = M_i + \sigma_{\mathrm{rn}}^2",
        ),
        symbols=(_SNR, _ELECTRONS, _CHANNEL, _VARIANCE, _READ_NOISE),
        source=f"{_PAPER}, eq. 7",
    ),
    "contravariant": Explanation(
        title="Contravariant SNR",
        words="The curves of the channels overlap: several channels see the same light. Unmixing "
        "subtracts what the channels have in common, and this is the SNR of each channel after "
        "it. Channels with similar curves keep little signal, so the value is low although the "
        "raw SNR is high. It shows why an additional channel can make colors noisier. The value "
        "depends on the metric: spectra as vectors of photons (quanta) or of energy.",
        latex=(
            r"\mathrm{SNR} = 20 \, \log_{10} \frac{|M^i|}{\sqrt{(G^{-1} D G^{-1})_{ii}}}",
            r"M^i = (G^{-1} M)_i",
            r"G = F^{\top} F",
        ),
        symbols=(
            _SNR,
            Symbol(
                "M^i",
                "contravariant coordinate of channel i",
                unit="unit of L squared per e⁻",
                name="contravariant",
            ),
            _CHANNEL,
            _MEAN,
            _RAW,
            _BASIS,
            _GRAM,
            _TRANSPOSED,
        ),
        source=f"{_PAPER}, eq. 3",
    ),
    "spectral": Explanation(
        title="SNR of the reconstructed spectrum",
        words="From its few channels a camera can reconstruct a rough spectrum of the light. This "
        "is the SNR of that whole spectrum in one number. A low value means that noise hides the "
        "spectrum, mostly because some channels have similar curves.",
        latex=(
            r"\mathrm{SNR} = 10 \, \log_{10} "
            r"\frac{M^{\top} G^{-1} M}{\operatorname{tr}(G^{-1} D)}",
            r"\hat{L} = F G^{-1} M",
            r"G = F^{\top} F",
        ),
        symbols=(_SNR, _REBUILT, _MEAN, _RAW, _BASIS, _GRAM, _TRANSPOSED),
        source=f"{_PAPER}, eq. 4",
    ),
    "color": Explanation(
        title="Color SNR of X, Y, Z",
        words="A color matrix computes X, Y and Z from the channels: three numbers that describe "
        "a color as an eye sees it; Y is its brightness (luminance). The noise of all channels "
        "adds up in each of them, and large weights of opposite sign cancel signal but not noise. "
        "A large value means a smooth color picture. The verdict compares the SNR of Y, too.",
        latex=(
            r"\mathrm{SNR}_c = 20 \, \log_{10} \frac{(C M)_c}{\sqrt{(C D C^{\top})_{cc}}}",
            r"C_{\mathrm{kernel}} = H^{\top} F G^{-1}",
            r"G = F^{\top} F",
        ),
        symbols=(
            _SNR,
            _COORDINATE,
            _MEAN,
            _MATRIX,
            Symbol(
                r"C_{\mathrm{kernel}}",
                "the kernel matrix; other matrices are trained on spectra, or given",
                unit="lx/e⁻",
            ),
            Symbol("H", "color axes x, y, z of the observer", unit="lx per unit of L", name="axes"),
            _RAW,
            _BASIS,
            _GRAM,
            _TRANSPOSED,
        ),
        source=f"{_PAPER}, eq. 5-6",
    ),
    "lab": Explanation(
        title="Noise of L*, a*, b* of an 18 % gray",
        words="In CIELAB equal distances look about equally large to an eye: L* is lightness, a* "
        "runs from green to red, b* from blue to yellow. The chart shows the standard deviations "
        "of a gray that reflects 18 % of the light. An eye just sees a difference of about 2 "
        "between two large areas. A large value for L* means grain; for a* or b* it means colored "
        "speckles.",
        latex=(
            r"\sigma_q^2 = \langle q^2 \rangle - \langle q \rangle^2",
            r"L^* = 116 \, g(Y / Y_{\mathrm{w}}) - 16",
            r"a^* = 500 \left( g(X / X_{\mathrm{w}}) - g(Y / Y_{\mathrm{w}}) \right)",
            r"b^* = 200 \left( g(Y / Y_{\mathrm{w}}) - g(Z / Z_{\mathrm{w}}) \right)",
        ),
        symbols=(
            Symbol(r"\sigma_q", "standard deviation of q", unit="1"),
            Symbol("q", "one of L*, a*, b*", unit="1"),
            Symbol(r"\langle q \rangle", "average of q over the noise of X, Y, Z"),
            Symbol("L^*", "lightness", unit="1"),
            Symbol("a^*", "green to red", unit="1"),
            Symbol("b^*", "blue to yellow", unit="1"),
            Symbol("X", "first coordinate of the color", unit="lx"),
            Symbol("Y", "luminance", unit="lx"),
            Symbol("Z", "third coordinate of the color", unit="lx"),
            Symbol(r"X_{\mathrm{w}}", "X of a perfect white; likewise Y and Z"),
            Symbol("g", "the cube root, with a straight line near black"),
        ),
        source="CIE 015:2018, eq. 8.3-8.8; averages: Stroud, Approximate Calculation of Multiple "
        "Integrals (1971), 2.6-2.7",
    ),
    "bound": Explanation(
        title="Bound of any linear readout",
        words="The best SNR that any weighted sum of the channels can have, even if that sum is "
        "not a color. No color matrix can exceed it. It shows how much signal the sensor has "
        "collected; the difference to the SNR of a color is lost in the step from channels to "
        "color.",
        latex=(
            r"\mathrm{SNR}_{\mathrm{bound}} = 10 \, \log_{10} \left( M^{\top} D^{-1} M \right)",
            r"M^{\top} D^{-1} M = \sum_i \frac{M_i^2}{D_{ii}}",
        ),
        symbols=(
            Symbol(
                r"\mathrm{SNR}_{\mathrm{bound}}",
                "SNR of the best linear readout; the sum holds for channels whose noise "
                "is independent",
                unit="dB",
                name="optimal_linear_snr_db",
            ),
            _MEAN,
            _ELECTRONS,
            _CHANNEL,
            _RAW,
            _TRANSPOSED,
        ),
        source="Cauchy-Schwarz inequality in noise-whitened channels",
    ),
    "price": Explanation(
        title="Color SNR loss",
        words="How far the SNR of the luminance Y is below that of the best readout of the same "
        "channels. A large loss means that the sensor collects much light, but that computing a "
        "color costs most of the advantage.",
        latex=(r"\Delta = \mathrm{SNR}_{\mathrm{bound}} - \mathrm{SNR}_Y",),
        symbols=(
            Symbol(r"\Delta", "color SNR loss", unit="dB", name="color_snr_loss_db"),
            Symbol(
                r"\mathrm{SNR}_{\mathrm{bound}}",
                "SNR of the best linear readout",
                unit="dB",
                name="optimal_linear_snr_db",
            ),
            Symbol(r"\mathrm{SNR}_Y", "SNR of Y, the luminance", unit="dB"),
        ),
        source="this library; follows from the bound of any linear readout",
    ),
    "budget": Explanation(
        title="The dB budget",
        words="The budget starts with all photons that hit the pixels and ends with the SNR of one "
        "color; each bar is what one cause costs or gives back. Filters absorb light, and the "
        "readout adds noise. The color target is the cost of the weights that give the color "
        "instead of the lowest noise; correlation is the cost of subtracting channels with similar "
        "curves. Infrared electrons add noise without signal; some SNR comes back where the matrix "
        "counts them as luminance (infrared leaking into Y). What a cause costs depends on the "
        "causes before it, so each bar is the mean over all orders, with crosstalk last, and the "
        "bars add up exactly; the gain of removing a cause, the SNR without it minus the SNR, is "
        "another number.",
        latex=(
            r"\ell_j = \frac{1}{n} \sum_{\pi} \left( S_{\pi}^{-j} - S_{\pi}^{+j} \right)",
            r"\mathrm{SNR}_c = S_0 - \sum_j \ell_j",
            r"g_j = \mathrm{SNR}_c^{-j} - \mathrm{SNR}_c",
        ),
        symbols=(
            Symbol(r"\ell_j", "cost of cause j, the length of its bar", unit="dB", name="cost_db"),
            Symbol("g_j", "gain if cause j is removed", unit="dB", name="gain_if_removed_db"),
            Symbol("j", "a cause, for example read noise"),
            Symbol(
                r"\pi",
                "an order of the causes; the filters come first, the weights of the color come "
                "before the correlation, and crosstalk comes last",
            ),
            Symbol("n", "number of such orders", unit="1"),
            Symbol(
                r"S_{\pi}^{-j}", "SNR with all causes that come before j in that order", unit="dB"
            ),
            Symbol(r"S_{\pi}^{+j}", "the same with j too", unit="dB"),
            Symbol("S_0", "SNR of counting all photons", unit="dB", name="photons_db"),
            Symbol(r"\mathrm{SNR}_c", "SNR of the color coordinate c", unit="dB"),
            Symbol(r"\mathrm{SNR}_c^{-j}", "the same of a sensor without cause j", unit="dB"),
        ),
        source="Shapley, Contributions to the Theory of Games II (1953), 307-317; orders with "
        "precedence: Faigle & Kern, Int. J. Game Theory 21 (1992) 249-266",
    ),
    "vectors": Explanation(
        title="Vectors and the ellipsoid of uncertainty",
        words="Each channel is an arrow in the space of all spectra; the chart shows the three "
        "directions that an eye distinguishes. Two arrows that point nearly the same way are hard "
        "to tell apart: noise then moves the reconstructed light far along their difference. The "
        "ellipsoid shows how far noise moves the light: long and thin is bad.",
        latex=(
            r"\Sigma_L = F G^{-1} D G^{-1} F^{\top}",
            r"G = F^{\top} F",
            r"s = \frac{|Q^{\top} v|^2}{|v|^2}",
        ),
        symbols=(
            Symbol(
                r"\Sigma_L",
                "covariance of the reconstructed light, the shape of the ellipsoid",
                name="reconstructed.covariance",
            ),
            _BASIS,
            _GRAM,
            _RAW,
            _TRANSPOSED,
            Symbol(
                "s",
                "share of the norm: how much of a vector lies in the drawn directions",
                unit="1",
                name="norm_share",
            ),
            Symbol("v", "any of the drawn vectors", name="norm_share"),
            Symbol("Q", "orthonormal axes that span x, y, z", name="norm_share"),
        ),
        source=f"{_PAPER}, eq. 4",
    ),
    "ellipses": Explanation(
        title="Noise ellipses",
        words="Each cross is the true color of a patch. The center of its ellipse is the color "
        "that the camera gives on average, and the ellipse contains about 86 % of the single "
        "readings. A center far from its cross is a wrong color; a large ellipse is a noisy one.",
        latex=(r"(q - \bar{q})^{\top} \, \Sigma^{-1} \, (q - \bar{q}) = 2^2",),
        symbols=(
            Symbol("q", "a point of the outline: a*, b* or x, y", unit="1"),
            Symbol(r"\bar{q}", "mean color with noise, the center", unit="1"),
            _NOISE_OF_COLORS,
            _TRANSPOSED,
        ),
        source="CIE 015:2018, eq. 7.1 and 8.3-8.8; Gaussian noise of X, Y, Z",
    ),
    "levels": Explanation(
        title="SNR over the light level",
        words="The same camera at other light levels, with the same exposure time. Ten times the "
        "light raises the SNR by 10 dB where photon noise prevails, and by 20 dB where read noise "
        "prevails. Where two curves cross, the two sensors are equally good; below that light "
        "level one of them is better, above it the other.",
        latex=(
            r"M(N_{\mathrm{lux}}) = \frac{N_{\mathrm{lux}}}{N_0} \, M(N_0)",
            r"\mathrm{SNR}_{\mathrm{A}}(N_{\times}) = \mathrm{SNR}_{\mathrm{B}}(N_{\times})",
        ),
        symbols=(
            _MEAN,
            Symbol(
                r"N_{\mathrm{lux}}",
                "light level (illuminance on the scene)",
                unit="lx",
                name="level_lux",
            ),
            Symbol("N_0", "light level of the study", unit="lx"),
            Symbol(r"N_{\times}", "light level of a crossover", unit="lx"),
            *_TWO_SNRS,
        ),
        source=f"{_PAPER}, eq. 2 and 7; crossovers: Chandrupatla, Adv. Eng. Softw. 28 (1997) "
        "145-149",
    ),
    "map": Explanation(
        title="Two parameters",
        words="One quantity on a grid of two parameters, with the exposure time of the study kept "
        "unless it is a parameter itself. For two sensors the color is the difference between "
        "them, and the line is where they are equal. For more sensors the color names the best "
        "one. Gray means that there is no value, as where a channel is saturated.",
        latex=(r"\Delta = \mathrm{SNR}_{\mathrm{A}} - \mathrm{SNR}_{\mathrm{B}}",),
        symbols=(Symbol(r"\Delta", "difference that the color shows", unit="dB"), *_TWO_SNRS),
        source="this library",
    ),
    "chart": Explanation(
        title="Color error and noise of the chart",
        words="Two different faults of each patch. The color error is how far its mean color is "
        "from the true one; averaging many pictures does not remove it. The color noise is how "
        "far a single pixel is from that mean. A matrix can often lower one only by raising the "
        "other.",
        latex=(r"\Delta E^*_{ab} = \sqrt{(\Delta L^*)^2 + (\Delta a^*)^2 + (\Delta b^*)^2}",),
        symbols=(
            Symbol(
                r"\Delta E^*_{ab}",
                "CIE 1976 color difference; of the error: between the color without "
                "noise and the true one, each on its own white; of the noise: mean over the noise",
                unit="1",
                name="color_error",
            ),
            Symbol(r"\Delta L^*", "difference of lightness", unit="1"),
            Symbol(r"\Delta a^*", "difference from green to red", unit="1"),
            Symbol(r"\Delta b^*", "difference from blue to yellow", unit="1"),
        ),
        source="CIE 015:2018, eq. 8.21",
    ),
    "pareto": Explanation(
        title="Color error against visual noise",
        words="A color matrix can give exact colors or little noise. Of the matrices that keep "
        "the white, each weight of the noise selects the best one, trained on the spectra of the "
        "prior; the sensor may also leave channels out. The curve shows the best of them all: the "
        "color error is the mean over the patches of the chart, the noise that of a gray as "
        "viewed. Sensors are compared at equal color error.",
        latex=(
            r"\min_{C} \; \left\langle |C M - x|^2 \right\rangle "
            r"+ w \operatorname{tr}(C D C^{\top})",
        ),
        symbols=(
            _MATRIX,
            _MEAN,
            Symbol("x", "true X, Y, Z of a training spectrum", unit="lx"),
            Symbol(r"\langle \; \rangle", "average over the training spectra"),
            Symbol(
                "w",
                "weight of the noise: 0 is least squares, infinity the least noise",
                unit="1",
                name="weight",
            ),
            _RAW,
            _TRANSPOSED,
        ),
        source="Vora & Herley, ICIP (1998), with shot noise in D; the white as Finlayson & Drew, "
        "CIC5 (1997)",
    ),
    "machine": Explanation(
        title="Distance of two patches for a machine",
        words="A machine reads the raw values and needs no color. It can tell two patches apart "
        "if their means differ by more than the noise: the distance is that difference in units "
        "of the noise. At a distance of 2, an ideal reader of one pixel classifies 84 % of the "
        "readings correctly. An invertible color matrix does not change the distance.",
        latex=(r"D_{\mathrm{M}}^2 = d^{\top} S^{-1} d", r"P = \Phi(D_{\mathrm{M}} / 2)"),
        symbols=(
            Symbol(
                r"D_{\mathrm{M}}",
                "distance in units of the noise (Mahalanobis)",
                unit="1",
                name="distance",
            ),
            Symbol("d", "difference of the mean raw values", unit="e⁻"),
            Symbol("S", "mean covariance of the two patches", unit="e⁻²"),
            Symbol("P", "share of readings classified correctly", unit="1", name="probability"),
            Symbol(r"\Phi", "cumulative normal distribution", unit="1"),
            _TRANSPOSED,
        ),
        source="Mahalanobis, Proc. Nat. Inst. Sci. India 2 (1936) 49-55; ICRU Report 54 (1996)",
    ),
}
"""By the keys of `chromanoise.charts.registry.SECTIONS`."""


def explanation_as_json(key: str) -> dict[str, Any]:
    """An explanation with its formulas as MathML, for page and report."""
    one = EXPLANATIONS[key]
    return {
        "title": one.title,
        "words": one.words,
        "formulas": [mathml(latex, block=True) for latex in one.latex],
        "symbols": [
            {"symbol": mathml(symbol.latex), "meaning": symbol.meaning, "unit": symbol.unit}
            for symbol in one.symbols
        ],
        "source": one.source,
    }
