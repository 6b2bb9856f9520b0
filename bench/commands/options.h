/* Options that several subcommands share, so that they are spelt and explained alike. */
#ifndef PBF_BENCH_OPTIONS_H
#define PBF_BENCH_OPTIONS_H

#include <CLI/CLI.hpp>

#include "core/solver.h"
#include "report/portrait.h"
#include "scene/scene.h"
#include "worlds/worlds.h"

namespace bench {

// A whole number of at least 1.
CLI::Validator positive();

void add_scene_options(CLI::App &command, SceneOptions &options);
void add_precision_option(CLI::App &command, uint32_t &precision);
void add_device_option(CLI::App &command, int32_t &device);
void add_determinism_option(CLI::App &command, bool &is_per_machine);
// `worlds` describes the option of that name.
void add_worlds_options(CLI::App &command, WorldsOptions &options, const std::string &worlds);
void add_portrait_options(CLI::App &command, Portrait &portrait);

void write_picture(const std::string &path, const std::string &png);

}  // namespace bench

#endif
