"""Friction in Gymnasium's MuJoCo environments.

    environment = Friction(gymnasium.make("MyArm-v0"))       # its MJCF carries friction
    gymnasium.make_vec("MyArm-v0", num_envs=8, wrappers=[Friction])

The environment's MJCF carries the parameters (`frictionjoint install` writes one). A reset of a
``MujocoEnv`` is ``mj_resetData``, so the friction starts afresh with it.
"""

from typing import Any

import gymnasium

from frictionjoint.simulate.attach import attach


class Friction(gymnasium.Wrapper[Any, Any, Any, Any]):
    """Lets the friction carried by a ``MujocoEnv``'s model act until the environment closes.

    Raises:
        ModelError: the model carries no friction, see `frictionjoint.attach`.
        TypeError: the environment has no MuJoCo model.
    """

    def __init__(self, env: gymnasium.Env[Any, Any]) -> None:
        super().__init__(env)
        # Env declares no model, a MujocoEnv has one
        self._attached = attach(getattr(env.unwrapped, "model", env))

    def close(self) -> None:
        """Close the environment and let go of the callback."""
        self._attached.detach()
        super().close()
