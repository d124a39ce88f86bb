"""Friction in Gymnasium's MuJoCo environments.

    friction = "ant_with_friction.xml"                       # written by `frictionjoint install`
    environment = Friction(gymnasium.make("Ant-v5", xml_file=friction))
    gymnasium.make_vec("MyArm-v0", num_envs=8, wrappers=[Friction])
    Friction(environment, samples={"elbow": report.samples(1024)})   # another draw per episode

The environment's MJCF contains the parameters. A reset of a ``MujocoEnv`` resets the friction too.
``frictionjoint.enable()`` serves every environment without a wrapper.
"""

from typing import Any

import gymnasium
from gymnasium.utils import seeding

from frictionjoint.simulate.attach import attach
from frictionjoint.simulate.set_parameters import FrictionSamples, Samples


class Friction(gymnasium.Wrapper[Any, Any, Any, Any]):
    """Turn on the friction of a ``MujocoEnv``'s model until the environment closes.

    Args:
        samples: parameter sets by name of the joint; each reset draws one per joint, and the
            numbers are ``info["friction_samples"]`` of the reset. The draws follow the seed of the
            reset and leave the environment's own random numbers unchanged.
    Raises:
        ModelError: the model has no friction, see `frictionjoint.attach`, or not that of the
            samples, see `frictionjoint.set_parameters`.
        TypeError: the environment has no MuJoCo model.
    """

    def __init__(self, env: gymnasium.Env[Any, Any], samples: Samples | None = None) -> None:
        super().__init__(env)
        self._samples = FrictionSamples(samples) if samples else None
        self._random, _ = seeding.np_random()
        # Env declares no model, a MujocoEnv has one
        self._attached = attach(getattr(env.unwrapped, "model", env))

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Reset the environment, with a new draw of friction if there are samples."""
        if self._samples is None:
            return super().reset(seed=seed, options=options)
        if seed is not None:
            self._random, _ = seeding.np_random(seed)
        drawn = self._samples.draw(self._attached.model, self._random)
        observation, info = super().reset(seed=seed, options=options)
        return observation, info | {"friction_samples": drawn}

    def close(self) -> None:
        """Close the environment and release the callback."""
        self._attached.detach()
        super().close()
