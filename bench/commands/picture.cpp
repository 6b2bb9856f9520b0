/* pbf-bench picture: draws saved states. */
#include <filesystem>
#include <memory>

#include "commands/commands.h"
#include "commands/options.h"
#include "core/content.h"
#include "core/error.h"
#include "core/number_option.h"
#include "core/output_file.h"
#include "report/portrait.h"

namespace bench {
namespace {

struct PictureOptions {
  std::vector<std::string> states;
  std::string folder = ".";
  Portrait portrait;
};

int draw(const PictureOptions &options) {
  std::error_code ignored;
  std::filesystem::create_directories(options.folder, ignored);
  for (const std::string &name : options.states) {
    const std::string state = content_of(name, UINTMAX_MAX, "PBFSTATE");
    const std::filesystem::path path =
        std::filesystem::path(options.folder) /
        std::filesystem::path(name).filename().replace_extension(".png");
    std::string png;
    try {
      png = draw_state(state, options.portrait);
    } catch (const Error &error) {
      throw Error(error.code, name + ": " + error.what());
    }
    write_picture(path.string(), png);
    std::printf("%s\n", path.string().c_str());
  }
  return exit_ok;
}

}  // namespace

void write_picture(const std::string &path, const std::string &png) { write_file(path, png); }

void add_portrait_options(CLI::App &command, Portrait &portrait) {
  command.add_option("--width", portrait.width, "pixels")
      ->type_name("N")
      ->check(CLI::Range(16, 8192))
      ->capture_default_str();
  command
      .add_option("--fastest", portrait.fastest,
                  "the speed of the last colour (0: that of the fastest particles)")
      ->type_name("V")
      ->check(at_least_zero())
      ->capture_default_str();
  command
      .add_option("--view", portrait.view,
                  "what is shown: lower and upper corner, two or three numbers each (the domain)")
      ->type_name("X")
      ->expected(4, 6);
}

std::pair<CLI::App *, Command> add_picture(CLI::App &app) {
  auto options = std::make_shared<PictureOptions>();
  CLI::App *command =
      app.add_subcommand("picture", "Draws states that pbf_save has written, as PNG files");
  command->add_option("state", options->states, "files")->type_name("FILE")->required();
  command->add_option("--folder", options->folder, "where NAME.png goes")
      ->type_name("DIR")
      ->capture_default_str();
  add_portrait_options(*command, options->portrait);
  return {command, [options] { return draw(*options); }};
}

}  // namespace bench
