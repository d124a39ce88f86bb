"""The verdict of a report in three or four lines."""

from frictionjoint.report.error_figures import arrow, compared
from frictionjoint.report.summary import Summary
from frictionjoint.report.wording import listed, quantity, three

# a remaining error up to this multiple of the noise is hardly more than the noise
AT_THE_NOISE = 1.5


def verdict_lines(s: Summary) -> tuple[tuple[str, str], ...]:
    """Label and sentence of each line: missing, errors, rivals, what to record next."""
    lines = (
        ("Missing", _missing(s)),
        ("Error before and after" if s.changed else "Error", _error_line(s)),
        ("Could also be", _rivals_line(s)),
        ("Record next", s.record_next[0] if s.record_next else "nothing in particular"),
    )
    return tuple((label, text[0].upper() + text[1:]) for label, text in lines if text)


def _missing(s: Summary) -> str:
    """Effects that the model lacks, in a sentence."""
    noise = s.noise_level
    after = next((e for e in s.errors if e.unit == s.units[0] and e.stage == "after"), None)
    error = after.values[s.role] if after else None
    times = ""
    if noise and error is not None and error > AT_THE_NOISE * noise:
        times = f" The remaining error is {error / noise:.2g} times the noise of the instruments."
    elif s.verdict == "partly-explained" and s.effects:
        times = " The remaining error is not noise: it keeps its sign for longer than noise does."
    rest = ""
    if s.unexplained:
        parts = [f"{quantity(v)} ({share:.0%})" for v, share in s.unexplained]
        rest = f" The residual still depends on {listed(parts)}, which no known effect explains."
    if s.verdict == "too-short-to-tell":
        return "these logs are too short for a verdict."
    if not s.effects:
        if s.unexplained:
            return "something that is no known effect." + rest
        if s.suspected:
            best = s.suspected[0]
            return (
                f"nothing for certain; {best.title} would explain {best.gain:.0%} of the squared "
                f"residual (p = {three(best.p_value)}), below the threshold.{times}"
            )
        if noise and error is not None and error <= AT_THE_NOISE * noise:
            return f"nothing that {s.covered} can show; the error is hardly more than the noise."
        return (
            "no effect was found; no known effect and no measured quantity explains a significant "
            "part of the error." + times
        )
    sure = [e.title for e in s.effects if not e.doubt]
    unsure = [f"{e.title} ({e.doubt})" for e in s.effects if e.doubt]
    change = compared(s.error(_drive_name(s), "before"), s.error(_drive_name(s), "after"), s.role)
    if change in ("rises", "no fall") and s.role == "held_out":
        held = "contradict" if change == "rises" else "do not confirm"
        return (
            f"not confirmed: fitted logs suggest {listed(sure or unsure)}, held-out logs {held} it."
            + rest
        )
    text = listed(sure)
    if not sure and change == "falls" and all("size" in e.doubt for e in s.effects):
        names = [e.title for e in s.effects]
        one = "one or more of " if len(names) > 1 else ""
        text = f"{one}{listed(names)}, but these logs do not determine {_doubts(s)}"
    elif unsure:
        text = text or "nothing for certain"
        text += f"; also in the model, but not supported by these logs: {listed(unsure)}"
    if s.laws[0] != s.laws[1]:
        text += f"; the friction law is {s.laws[1]} instead of {s.laws[0]}"
    if sure and s.role == "held_out" and not _falls(s):
        text += "; on held-out logs the error falls by no more than chance explains"
    partly = s.verdict == "partly-explained" or rest
    return text + "." + (rest or (times if partly else ""))


def _falls(s: Summary) -> bool:
    """Whether any stated error falls by more than chance."""
    names = {e.quantity for e in s.errors if not e.quantity.endswith(", rms")}
    changes = [compared(s.error(n, "before"), s.error(n, "after"), s.role) for n in names]
    return any(change in ("falls", "falls by") for change in changes)


def _doubts(s: Summary) -> str:
    """Doubts about effects that lower the error together."""
    return "which of them, or how large each is" if len(s.effects) > 1 else "its size"


def _drive_name(s: Summary) -> str:
    return s.drive.split(" ", 1)[1]


def _error_line(s: Summary) -> str:
    """The errors before and after in one sentence."""
    parts = []
    where = "held-out" if s.role == "held_out" else "fitted"
    shown = [e.quantity for e in s.errors if not e.quantity.endswith(", rms")]
    for name in dict.fromkeys(shown):
        before, after = s.error(name, "before"), s.error(name, "after")
        if after is None or after.values[s.role] is None:
            continue
        if not s.changed or before is None or before.values[s.role] is None:
            parts.append(f"{name} {after.text(s.role)}")
            continue
        text = f"{name} {arrow(before, after, s.role)}"
        change = compared(before, after, s.role)
        if change == "rises" or (change == "no fall" and not before.interval):
            text += ", which is worse"
        elif change in ("may be chance", "no fall"):
            text += ", which may be chance"
        parts.append(text)
    if not parts:
        return ""
    drive = f"; per cent of the {s.drive}" if "%" in parts[0] + parts[-1] else ""
    return f"{'; '.join(parts)} ({where} logs{drive})."


def _rivals_line(s: Summary) -> str:
    """Effects that these logs cannot distinguish from the named ones."""
    tied = [f"{listed(e.rivals)} instead of {e.title}" for e in s.effects if e.rivals]
    if tied:
        return f"{'; '.join(tied)}: these logs do not distinguish them."
    best = [(e, e.next_best) for e in s.effects if e.next_best]
    if not best:
        return ""
    e, (name, gain) = best[0]
    return (
        f"nothing else; the next candidate, {name}, explains {gain:.1%} where {e.title} "
        f"explains {e.gain:.1%}."
    )
