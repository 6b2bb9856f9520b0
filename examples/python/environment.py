"""Keep a slug of water in the middle of a tank that an agent tilts: an environment as Gymnasium has
them, and a policy that is one line.

    python examples/python/environment.py [EPISODES]

With Gymnasium installed it is a gymnasium.Env; without, it has the same methods.
"""
import sys

import numpy as np

import pbf

try:
    from gymnasium import Env, spaces
except ImportError:
    Env, spaces = object, None


class Tank(Env):
    """Observation: the water's centre and its mean velocity along the tank. Action: tilt, -1 … 1.
    Reward: minus the distance of the centre from the tank's middle."""

    def __init__(self, backend="auto"):
        self.fluid = pbf.Solver(pbf.fill_box((0, 0), (0.5, 0.3), 0.025), backend=backend,
                                smoothing_radius=0.075, spacing=0.025, domain_max=(2, 1))
        self.start = self.fluid.save()
        if spaces:
            self.observation_space = spaces.Box(-np.inf, np.inf, (2,), np.float64)
            self.action_space = spaces.Box(-1, 1, (1,), np.float64)

    def observe(self):
        stats = self.fluid.stats
        return np.array([stats.center_of_mass[0] - 1, stats.momentum[0]])

    def reset(self, *, seed=None, options=None):
        if Env is not object:
            super().reset(seed=seed)
        self.fluid.load(self.start)  # an episode begins with the same bits
        return self.observe(), {}

    def step(self, action):
        tilt = 0.3 * float(np.clip(np.asarray(action).reshape(-1)[0], -1, 1))
        self.fluid.gravity = (9.81 * np.sin(tilt), -9.81 * np.cos(tilt))
        self.fluid.step(4)
        seen = self.observe()
        return seen, -abs(seen[0]), False, self.fluid.time >= 4, {}

    def render(self):
        return self.fluid.render((480, 240))

    def close(self):
        self.fluid.close()


def main(episodes):
    tank = Tank()
    for episode in range(episodes):
        seen, _ = tank.reset()
        total, ended = 0.0, False
        while not ended:
            action = -2 * seen[0] - 1 * seen[1]  # lean against where it is and where it goes
            seen, reward, _, ended, _ = tank.step([action])
            total += reward
        print(f"episode {episode}: sum of rewards {total:.1f}, ends {seen[0]:+.3f} from the middle")
    pbf.save_png("tank.png", tank.render())


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1)
