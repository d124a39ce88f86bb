"""What is my robot hiding? The closed loop on the shipped log, and its report read in Python.

    python examples/what_is_hidden.py

The log's joint has an effect that its model does not mention; frictionjoint/demo/README.md tells.
"""

from importlib.resources import files
from pathlib import Path

import frictionjoint as fj

DEMO = Path(str(files("frictionjoint.demo")))


def main():
    """Run the loop and print what it found."""
    report = fj.close_loop(
        [DEMO / "pick_and_place.csv", DEMO / "ramps.csv"],
        DEMO / "joint.xml",
        "joint",
        held_out=[DEMO / "multisine.csv"],
    )
    for name, estimate in report.base.items():
        print(f"{name:10} {estimate.value:10.4g} {estimate.unit}")
    for added in report.added:
        evidence = added.evidence
        print(f"hidden: {added.effect} (p = {evidence.p_value:.2g}, next {evidence.runner_up})")
        for name, estimate in added.parameters.items():
            print(f"    {name:10} {estimate.value:10.4g} {estimate.unit}")
    before, after = report.before_torque.held_out, report.after_torque.held_out
    print(f"torque error on the held-out log: {before:.3f} N m before, {after:.3f} N m after")
    for variable, share in report.unexplained:
        print(f"unexplained: {share:.0%} of what is left depends on {variable}")
    print(f"verdict: {report.verdict}")


if __name__ == "__main__":
    main()
