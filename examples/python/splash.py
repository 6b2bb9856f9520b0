"""A ball of water falls into a pool beside a post: 20 lines to a picture, and to one that moves.

    python examples/python/splash.py      writes splash.png and splash-moving.png
"""
import pbf

fluid = pbf.Solver(capacity=20_000, spacing=0.04, smoothing_radius=0.08, domain_max=(1.6, 1, 0.8))
fluid.add_box((0, 0, 0), (1.6, 0.24, 0.8))
fluid.add_ball((0.6, 0.7, 0.4), 0.18, velocity=(0, -1, 0))
fluid.colliders = [pbf.Capsule((1.2, 0.39, 0.4), radius=0.08, half_length=0.3)]
print(fluid)

with pbf.Movie("splash-moving.png", fps=30, size=(480, 360), limits=(0, 3)) as movie:
    for frame in fluid.frames(45, steps=4):  # 30 frames a second of 1/120 s steps
        movie.add(fluid)
        if frame == 10:
            fluid.save_picture("splash.png", limits=(0, 3))

stats = fluid.stats
print(f"{fluid.time:.2f} s: mean height {stats.center_of_mass[1]:.3f}, fastest {stats.speed_max:.2f}, "
      f"density error {100 * stats.density_error_mean:.2f} %")
