"""What is named is simulated: a model that is written and simulated is identified again.

The plants are MuJoCo's own parts with a LuGre joint (`lab/plants`), and a servo with MuJoCo's own
friction (`tests/servo_plant`). `lab/round_trip.py` measures all effects, these and those whose
logs take longer.
"""

import pytest
from round_trip import round_trip

# of each way in which an effect can act: torque, level, load, time of the instruments, motor, drive
QUICK = (
    "spring",
    "load-dependent",
    "direction-asymmetry",
    "back-emf",
    "command-delay",
    "drive-limit",
)
SECONDS = 12.0


@pytest.mark.parametrize("name", QUICK)
def test_the_same_effect_with_the_same_numbers(name, tmp_path):
    trip = round_trip(name, tmp_path, SECONDS)
    assert trip.errors
    assert max(trip.errors.values()) < 2.0, trip.errors
    if trip.before is not None and trip.after is not None:
        # the replay errs less with the effect, and as much as the torque that is left allows: the
        # plant's friction is another law, the model's own is not
        assert trip.after < 0.7 * trip.before
        assert trip.again_free < 1.5 * trip.after * max(1.0, trip.left_again / trip.left)
