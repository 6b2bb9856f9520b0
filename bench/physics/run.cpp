#include "physics/run.h"

#include <cmath>

#include "core/resources.h"

namespace bench::physics {

Scene Run::scene(const std::string &name) const {
  SceneOptions options;
  options.name = data_folder("scenes", PBF_BENCH_SOURCE_SCENES) + "/validation/" + name + ".json";
  options.settings = options_.settings;
  options.finer = options_.finer;
  return load_scene(options);
}

void Run::ratio(const std::string &name, double is, double must, double bar) {
  figures_.push_back({name, is, must, is / must - 1, bar, ""});
}

void Run::difference(const std::string &name, double is, double must, double bar,
                     const std::string &unit) {
  figures_.push_back({name, is, must, is - must, bar, unit});
}

void Run::plain(const std::string &name, double is) {
  figures_.push_back({name, is, std::nan(""), std::nan(""), 0, ""});
}

const std::vector<Case> cases = {
    {"laplace", "Pressure in drops: Laplace", laplace},
    {"rayleigh", "Drops that swing: Rayleigh 1879", rayleigh},
    {"contact-angle", "Contact angles: Young", contact_angles},
    {"couette", "Couette's flows", couette},
    {"poiseuille", "Poiseuille's flow in a channel without ends", poiseuille},
    {"stokes-sphere", "Spheres that settle: Stokes, Hasimoto 1959", stokes},
    {"layers-sort", "Three fluids side by side become layers", layers},
    {"rayleigh-taylor", "Heavy fluid over light: Rayleigh, Taylor 1950", rayleigh_taylor},
    {"lock-exchange", "Fluids side by side: Benjamin 1968", lock_exchange},
    {"taylor-green", "Vortices in a box without walls: Taylor & Green", taylor_green},
    {"volume-flow", "What comes from an opening", volume_flow},
    {"current-tank", "A current that keeps its level", current_tank},
    {"reservoir-level", "A tank with an opening of given level", reservoir_level},
    {"reservoir-channel", "A channel between tanks of given levels", reservoir_channel},
    {"reservoir-pressure", "A pipe between given pressures", reservoir_pressure},
    {"buoyancy", "Bodies that float: Archimedes", buoyancy},
    {"wall-force", "Forces on walls", wall_force},
    {"jet", "A jet on a plate: ρ Q V", jet},
    {"towed-ball", "A ball that is towed", towed_ball},
    {"friction", "Slopes: Coulomb", friction},
    {"queries", "Questions by place", queries},
};

}  // namespace bench::physics
