"""Words and signs of the paper that its claims use."""

GLOSSARY = (
    ("DKI", "Differentiable kinematic integrator: an analytic predictor that learns nothing."),
    ("WM-A", "Learned predictor anchored in physics: it adds learned accelerations to DKI."),
    ("WM-U", "Learned predictor without that anchor: it predicts the whole change of state."),
    ("true-parameter", "The analytic predictor, told the true physical parameters."),
    (
        "DCC",
        "Deployment-consistent conditioning: the repair. The model is trained again on inputs made "
        "wrong as they may be in use; samples, targets, size and budget stay.",
    ),
    ("+DCC", "A model trained so, as in WM-A+DCC or GRU+DCC."),
    (
        "GRU",
        "The learned module that reconstructs wind from flown history, a gated recurrent unit.",
    ),
    ("DOB", "Disturbance observer: reconstructs wind without learning."),
    (
        "e",
        "Calibration error: mass is supplied as m(1 + e), thrust scale as T(1 − e), while the "
        "vehicle stays as it is. At e = +0.1 mass is 10 % too high, thrust scale 10 % too low.",
    ),
    ("e_R, e_P", "The same error at the reconstruction alone, and at the predictor alone."),
    (
        "isolated, shared",
        "Reconstruction-only: the error reaches the reconstruction alone. Shared: it reaches every "
        "module that reads the calibration.",
    ),
    (
        "p*",
        "Break-even frequency: the share of episodes with the fault above which the repair pays, "
        "though it costs success where inputs are correct.",
    ),
    ("L0, L2, L3", "Wind: none, moderate, strong."),
    ("pp", "Percentage points: the difference of two rates of success in percent."),
    (
        "right sign, other size",
        "The effect points the way that the paper says, and is larger or smaller than the paper’s "
        "by more than chance.",
    ),
)
"""Each word, and what it means."""
