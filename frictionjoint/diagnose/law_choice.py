"""Which friction law the logs ask for: the integrated one, or a rival that fits clearly better."""

from collections.abc import Callable, Sequence

from frictionjoint.diagnose.floor import noise_floor
from frictionjoint.identify.fit import Fit, fit
from frictionjoint.identify.prepare import Prepared
from frictionjoint.identify.rival_shape import forms_of, prompt_maxwell_slip
from frictionjoint.identify.shape import Shape

# the laws that take the integrated one's place where the residual of one is clearly smaller
OTHERS = (*prompt_maxwell_slip(), *forms_of("lugre"), *forms_of("elastoplastic"))
_CLEARLY = 0.95


def fit_others(prepared: Prepared, own: Fit, progress: Callable[[str], None]) -> Fit:
    """The terms of a fit with the best of the other laws.

    What a law cannot copy stays in its residual and passes for an effect. Generalized Maxwell-slip
    drops as its elements let go one after the other, which no parameters of the integrated law do.
    """
    progress("fit: other laws")
    return fit(prepared, own.terms, forms=OTHERS)


def clearly_better(other: Fit, own: Fit) -> bool:
    """By a share of the error that chance or a few more parameters do not make."""
    return other.drive_rms < _CLEARLY * own.drive_rms


def with_better_law(
    prepared: Prepared, own: Fit, forms: Sequence[Shape], progress: Callable[[str], None]
) -> tuple[Fit, Sequence[Shape]]:
    """A fit of the same terms with another law, and what that tries, where it is clearly better.

    Another of the other laws, too: an effect not yet added may have bent the law first chosen.
    """
    if _CLEARLY * own.rms < noise_floor(prepared, own.gain):
        return own, forms
    other = fit_others(prepared, own, progress)
    return (other, OTHERS) if clearly_better(other, own) else (own, forms)
