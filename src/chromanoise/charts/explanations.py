"""The equations behind the ``?`` of each chart, on the page and in reports."""

from collections.abc import Mapping

_PAPER = "Clouet, Vaillant & Alleysson, CIC27 (2019)"

EXPLANATIONS: Mapping[str, Mapping[str, str]] = {
    key: {"title": title, "equation": equation, "source": source}
    for key, title, equation, source in (
        (
            "electrons",
            "Expected electrons",
            "M = k QE^T L, k = t a² δλ / (4 f#²)",
            f"{_PAPER}, eq. 1-2",
        ),
        ("raw", "Raw SNR", "20 log10(M_i / √(M_i + σ_rn²))", f"{_PAPER}, eq. 7"),
        (
            "contravariant",
            "Contravariant SNR",
            "20 log10(|M^i| / √((G⁻¹ D G⁻¹)_ii)), M^i = (G⁻¹ M)_i, G = F^T F",
            f"{_PAPER}, eq. 3",
        ),
        (
            "spectral",
            "SNR of the rebuilt spectrum",
            "10 log10(M^T G⁻¹ M / tr(G⁻¹ D)), L^ = F G⁻¹ M",
            f"{_PAPER}, eq. 4",
        ),
        (
            "color",
            "Color SNR of X, Y, Z",
            "20 log10((C M)_c / √((C D C^T)_cc)); kernel: C = H^T F G⁻¹",
            f"{_PAPER}, eq. 5-6",
        ),
        (
            "lab",
            "Noise of L*, a*, b* of an 18 % gray",
            "σ of CIELAB averaged over normal noise of X, Y, Z",
            "CIE 015:2018, eq. 8.3-8.8; Stroud, Approximate Calculation of Multiple Integrals "
            "(1971), 2.6-2.7",
        ),
        (
            "bound",
            "Bound of any linear readout",
            "SNR² ≤ M^T D⁻¹ M = Σ SNR_i²",
            "Cauchy-Schwarz in noise-whitened channels",
        ),
        (
            "price",
            "Color SNR loss",
            "best linear SNR minus SNR of Y, in dB",
            "this library",
        ),
        (
            "budget",
            "The dB budget",
            "mean cost of each cause over all orders in which filters come first and the weights "
            "come before the unmixing",
            "Shapley, Contributions to the Theory of Games II (1953); Faigle & Kern, Int. J. Game "
            "Theory 21 (1992) 249-266",
        ),
        (
            "vectors",
            "Vectors and the ellipsoid of uncertainty",
            "cov L^ = F G⁻¹ D G⁻¹ F^T, seen in the span of x, y, z; the share of the norm is "
            "|projection|² / |vector|²",
            f"{_PAPER}, eq. 4",
        ),
        (
            "ellipses",
            "Noise ellipses",
            "2 σ of each ColorChecker patch: mean and covariance of a*b* or xy, averaged over "
            "normal noise of X, Y, Z",
            "CIE 015:2018, eq. 7.1 and 8.3-8.8",
        ),
        (
            "levels",
            "SNR over the light level",
            "the time is solved at the level of the study and kept; crossovers by Chandrupatla's "
            "method",
            f"{_PAPER}, eq. 7",
        ),
        (
            "chart",
            "Color error and noise of the chart",
            "error: ΔE*ab between the color without noise and the true one, each on its own "
            "white; noise: mean ΔE*ab that noise makes",
            "CIE 015:2018, eq. 8.21",
        ),
        (
            "pareto",
            "Color error against noise",
            "least E|C M - XYZ|² + w tr(C D C^T); w = 0 is least squares, 1 LMMSE",
            "Vora & Herley (ICIP 1998), with shot noise",
        ),
    )
}
