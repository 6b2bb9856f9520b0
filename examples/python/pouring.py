"""Pour to a mark: an agent tilts a jug over a glass. Many worlds side by side, as a vector
environment of Gymnasium, and a policy that learns by evolution: NumPy and this file are all that
it needs.

    python examples/python/pouring.py [GENERATIONS [WORLDS]]

With Gymnasium installed `Pouring` is a gymnasium.vector.VectorEnv; without, it has the same
methods.
"""
import sys
import time

import numpy as np

import pbf

try:
    from gymnasium import spaces
    from gymnasium.vector import AutoresetMode, VectorEnv
    from gymnasium.vector.utils import batch_space
except ImportError:
    VectorEnv, spaces = object, None

SPACING = 0.03
PIVOT = np.array([0.62, 0.85])         # the jug's lip, which it turns about
GLASS = (0.75, 1.25)                   # its walls' middles
WALL = 0.04                            # half of a wall's thickness
FULL_TURN = 2.2                        # radians: the jug lies a little below the level


def box(center, half):
    return pbf.Box(position=center, half_extents=half)


def jug():
    """Bottom and two walls, upright, with the lip at the pivot."""
    x, y = PIVOT
    return [box((x - 0.24, y - 0.44), (0.28, WALL)), box((x - 0.48, y - 0.22), (WALL, 0.26)),
            box((x, y - 0.22), (WALL, 0.22))]


def glass():
    left, right = GLASS
    return [box(((left + right) / 2, WALL), ((right - left) / 2 + WALL, WALL)),
            box((left, 0.25), (WALL, 0.25)), box((right, 0.25), (WALL, 0.25))]


class Pouring(VectorEnv):
    """Observation of a world: how far the jug is tilted and the mark (both as parts of 1), how much
    of the water is in the glass, how much is on the way, the time. Action: the speed of tilting,
    -1 … 1. Reward: at the end, minus the distance of what is in the glass from the mark, and minus
    half of what is spilled; 0 before. An episode is `LENGTH` actions long; the call of `step` after
    its last one begins the next one (Gymnasium's autoreset "next step")."""

    LENGTH, STEPS, DT = 50, 4, 1 / 120

    def __init__(self, num_envs=32, backend="auto", threads=0):
        self.num_envs = num_envs
        self.batch = pbf.Batch(
            num_envs, pbf.fill_box((0.24, 0.5), (0.56, 0.8), SPACING), backend=backend,
            threads=threads, spacing=SPACING, smoothing_radius=3 * SPACING, time_step=self.DT,
            domain_max=(1.6, 1.5))
        self.jug, self.glass = jug(), glass()
        self.batch.set_colliders(self.jug + self.glass)
        self.batch.step(20)  # the water comes to rest
        self.batch.set_start()
        self.parts = np.array([part.position[:2] for part in self.jug])
        self.rest = np.array([part.position[:2] for part in self.glass])
        self.random = np.random.default_rng(0)
        self.ended = np.ones(num_envs, bool)
        self.tilt, self.mark, self.length = (np.zeros(num_envs) for _ in range(3))
        if spaces:
            self.metadata = {"autoreset_mode": AutoresetMode.NEXT_STEP}
            self.single_observation_space = spaces.Box(-np.inf, np.inf, (5,), np.float64)
            self.single_action_space = spaces.Box(-1, 1, (1,), np.float64)
            self.observation_space = batch_space(self.single_observation_space, num_envs)
            self.action_space = batch_space(self.single_action_space, num_envs)

    def reset(self, *, seed=None, options=None):
        if seed is not None:
            self.random = np.random.default_rng(seed)
        self.ended[:] = True
        self._begin()
        return self.observe(), {}

    def _begin(self):
        """Those that have ended start anew, each with a mark of its own."""
        self.batch.reset(mask=self.ended)
        self.tilt[self.ended] = self.length[self.ended] = 0
        self.mark[self.ended] = self.random.uniform(0.3, 0.8, self.num_envs)[self.ended]
        self.ended[:] = False

    def water(self):
        """What part of the water is in the glass, on the way, and spilled."""
        x = self.batch.positions
        left, right = GLASS
        inside = (x[..., 0] > left) & (x[..., 0] < right) & (x[..., 1] < 0.5)
        beside = ~inside & (x[..., 1] < 0.3)
        out = ~inside & ~beside & (x[..., 0] > PIVOT[0] + WALL)
        return inside.mean(axis=1), out.mean(axis=1), beside.mean(axis=1)

    def observe(self):
        inside, out, _ = self.water()
        return np.stack([self.tilt / FULL_TURN, self.mark, inside, out,
                         self.length / self.LENGTH], axis=1)

    def _aim(self):
        """Poses of the jug's parts, turned clockwise about the lip; the glass stays."""
        cos, sin = np.cos(self.tilt), np.sin(self.tilt)
        turn = np.stack([np.stack([cos, sin], -1), np.stack([-sin, cos], -1)], axis=1)
        moved = PIVOT + np.einsum("nij,pj->npi", turn, self.parts - PIVOT)
        places = np.concatenate([moved, np.broadcast_to(self.rest, (self.num_envs, 3, 2))], axis=1)
        turns = np.zeros((self.num_envs, 6, 4))
        turns[..., 3] = 1
        turns[:, :3, 2], turns[:, :3, 3] = -np.sin(self.tilt / 2)[:, None], np.cos(self.tilt / 2)[:, None]
        return places, turns

    def step(self, actions):
        begins = self.ended.copy()
        self._begin()
        speed = np.clip(np.asarray(actions, float).reshape(self.num_envs), -1, 1)
        goes = ~begins
        self.tilt[goes] = np.clip(self.tilt + 0.12 * speed, 0, FULL_TURN)[goes]
        places, turns = self._aim()
        self.batch.move_colliders(places, turns, duration=self.STEPS * self.DT, mask=goes)
        self.batch.step(self.STEPS, mask=goes)
        self.length[goes] += 1
        self.ended = self.length >= self.LENGTH
        inside, _, spilled = self.water()
        reward = np.where(self.ended & goes, -abs(inside - self.mark) - 0.5 * spilled, 0.0)
        return self.observe(), reward, np.zeros(self.num_envs, bool), self.ended.copy(), {}

    def close(self, **options):
        self.batch.close()


class Policy:
    """A network of one hidden layer for each world, with weights of its own."""

    SIZES = ((5, 8), (8,), (8, 1), (1,))
    WEIGHTS = sum(int(np.prod(size)) for size in SIZES)

    @classmethod
    def act(cls, weights, seen):
        """Weights of shape (worlds, WEIGHTS), observations (worlds, 5) → actions (worlds, 1)."""
        parts = np.split(weights, np.cumsum([int(np.prod(size)) for size in cls.SIZES])[:-1], axis=1)
        first, bias, second, offset = (part.reshape(len(weights), *size)
                                       for part, size in zip(parts, cls.SIZES))
        hidden = np.tanh(np.einsum("ni,nij->nj", seen, first) + bias)
        return np.tanh(np.einsum("ni,nij->nj", hidden, second) + offset)


def episode(env, weights, seed):
    """The sum of rewards of each world, all with weights of their own."""
    seen, _ = env.reset(seed=seed)
    total, ended = np.zeros(env.num_envs), np.zeros(env.num_envs, bool)
    while not ended.all():
        seen, reward, _, ended, _ = env.step(Policy.act(weights, seen))
        total += reward
    return total


def train(env, generations, report=print):
    """Evolution strategy with mirrored samples and ranks (Salimans et al. 2017): each world tries
    other weights. Returns the weights, and the mean reward with them before and after."""
    random, half = np.random.default_rng(1), env.num_envs // 2
    weights, size, rate = np.zeros(Policy.WEIGHTS), 0.4, 0.4

    def judged():
        return episode(env, np.tile(weights, (env.num_envs, 1)), seed=1000).mean()

    before = judged()
    for generation in range(generations):
        began = time.perf_counter()
        noise = random.standard_normal((half, Policy.WEIGHTS))
        rewards = episode(env, weights + size * np.concatenate([noise, -noise]), generation)
        rank = rewards.argsort().argsort() / (len(rewards) - 1) - 0.5
        weights = weights + rate * (rank[:half] - rank[half:]) @ noise / (half * size) * 2
        seconds = time.perf_counter() - began
        report(f"generation {generation}: reward {rewards.mean():+.3f}, best {rewards.max():+.3f}; "
               f"{env.num_envs * env.LENGTH / seconds:,.0f} steps of environments a second, "
               f"{env.num_envs * env.LENGTH * env.STEPS / seconds:,.0f} of worlds")
    return weights, before, judged()


def main(generations, worlds):
    env = Pouring(worlds)
    print(f"{worlds} worlds of {env.batch.counts[0]} particles on {env.batch[0].backend}, "
          f"{env.batch.threads} threads")
    weights, before, after = train(env, generations)
    print(f"mean reward {before:+.3f} before, {after:+.3f} after")
    pbf.save_png("pouring.png", env.batch[0].render((480, 360)))
    env.close()


if __name__ == "__main__":
    main(*map(int, (*sys.argv[1:], *(30, 32)[len(sys.argv) - 1:])))
