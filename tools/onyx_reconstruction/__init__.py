"""The reconstruction of the paper's sensor curves.

===============  =====================================================================
``curves``       parameters -> curves: splines of logits, one logistic IR-cut edge
``priors``       what silicon and resins look like, chosen by hand, and misfits to it
``predictions``  curves -> the paper's printed figures, by chromanoise itself
``fit``          weights, residuals, starts, least squares
===============  =====================================================================

``tools/reconstruct_onyx.py`` runs it and says what its answer is and is not.
"""
