#include "commands/options.h"

#include "core/number_option.h"

namespace bench {

CLI::Validator positive() {
  return CLI::Validator(
      [](std::string &text) {
        const bool digits = text.find_first_not_of("0123456789") == std::string::npos;
        const bool zero = text.find_first_not_of('0') == std::string::npos;
        return digits && !zero ? std::string()
                               : "\"" + text + "\" is not a whole number of at least 1";
      },
      "");
}

void add_scene_options(CLI::App &command, SceneOptions &options) {
  command.add_option("--scene", options.name, "name of a scene, or path of a scene file")
      ->type_name("S")
      ->capture_default_str();
  command
      .add_option("--particles", options.particles, "about so many particles, by the scene's rule")
      ->type_name("N")
      ->check(positive());
  command
      .add_option("--finer", options.finer,
                  "so many times as fine, 0.01 … 100: spacing, h and time step shrink, steps make "
                  "up for it")
      ->type_name("F")
      ->check(times_as_fine())
      ->excludes("--particles");
  command.add_option("--steps", options.steps, "in place of the scene's number of steps")
      ->type_name("N")
      ->check(positive());
  command
      .add_option("--set", options.settings,
                  "in place of the scene's parameter, as --set gravity.1=-3; again and again")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

void add_precision_option(CLI::App &command, uint32_t &precision) {
  command
      .add_option_function<std::string>(
          "--precision",
          [&precision](const std::string &name) {
            precision = name == "f64" ? PBF_FLOAT64 : PBF_FLOAT32;
          },
          "f32 or f64 (f32 when not given)")
      ->type_name("P")
      ->check(CLI::IsMember({"f32", "f64"}).description(""));
}

void add_device_option(CLI::App &command, int32_t &device) {
  command.add_option("--device", device, "which device of the backend")
      ->type_name("N")
      ->capture_default_str();
}

void add_determinism_option(CLI::App &command, bool &is_per_machine) {
  command.add_flag("--per-machine", is_per_machine,
                   "bits of this machine's own, which is faster on CPUs with fused multiply-add");
}

void add_worlds_options(CLI::App &command, WorldsOptions &options, const std::string &worlds) {
  command.add_option("--worlds", options.worlds, worlds)
      ->type_name("N")
      ->check(positive())
      ->capture_default_str();
  command.add_option("--backends", options.backends, "which backends")
      ->type_name("B,…")
      ->delimiter(',')
      ->capture_default_str();
  command.add_option("--threads", options.threads, "CPU threads (0: all)")
      ->type_name("N")
      ->capture_default_str();
  add_precision_option(command, options.precision);
  add_device_option(command, options.device);
}

}  // namespace bench
