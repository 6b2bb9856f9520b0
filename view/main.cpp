/* pbf-view: scenes as they run. */
#include <malloc.h>

#include <cstdio>

#include "commands/options.h"
#include "core/command_line.h"
#include "core/error.h"
#include "core/failure_message.h"
#include "core/number_option.h"
#include "core/standard_streams.h"
#include "headless.h"
#include "window.h"

namespace {

using namespace view;

// Mesa's software renderer takes and gives back the memory of its lists in each picture; to map it
// anew takes longer than to fill it.
void keep_memory() {
#if defined(__GLIBC__)
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TOP_PAD, 1 << 26);
#endif
}

void add_options(CLI::App &app, Options &options) {
  options.scene.name = "dam-break-3d";
  options.solver.backend = "auto";
  bench::add_scene_options(app, options.scene);
  app.remove_option(app.get_option("--steps"));
  app.add_option("--backend", options.solver.backend, "which backend")
      ->type_name("B")
      ->capture_default_str();
  app.add_option("--threads", options.solver.threads, "CPU threads (0: all)")->type_name("N");
  bench::add_precision_option(app, options.solver.precision);
  bench::add_device_option(app, options.solver.device);
  std::map<std::string, Coloring> colorings;
  for (size_t i = 0; i < coloring_names().size(); ++i)
    colorings[coloring_names()[i]] = static_cast<Coloring>(i);
  app.add_option("--color", options.coloring, "what colours: speed, pressure or density_error")
      ->type_name("C")
      ->transform(CLI::CheckedTransformer(colorings).description(""));
  app.add_option("--top", options.top, "the number of the last colour (0: of nearly all particles)")
      ->type_name("X")
      ->check(bench::at_least_zero());
  app.add_option("--width", options.width, "pixels")
      ->check(CLI::Range(16, 8192))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--height", options.height, "pixels")
      ->check(CLI::Range(16, 8192))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--every", options.steps_a_picture, "steps from one picture to the next")
      ->type_name("K")
      ->check(bench::positive())
      ->capture_default_str();
  app.add_option("--record", options.record,
                 "pictures into a video, as water.mp4 (by ffmpeg), or as PNG files into a folder")
      ->type_name("PATH");
  CLI::Option *headless = app.add_option_function<uint32_t>(
                                 "--headless",
                                 [&options](uint32_t steps) {
                                   options.headless = true;
                                   options.steps = steps;
                                 },
                                 "no window: runs so many steps")
                              ->type_name("N");
  app.add_option("--picture", options.picture, "… and writes the last state as a PNG file")
      ->type_name("FILE")
      ->needs(headless);
  app.add_flag("--panel", options.panel, "… with the panel in it")->needs(headless);
  app.add_flag("--measure", options.measure, "… and prints how many pictures a second there are")
      ->needs(headless);
}

}  // namespace

int main(int argc, char **argv) {
  bench::prepare_standard_streams();
  CLI::App app("Position based fluids: scenes as they run", "pbf-view");
  app.failure_message(bench::failure_message);
  app.footer(
      "Keys: space pauses, s steps, r starts again. The left button turns, the right one "
      "shifts, the wheel comes nearer.");
  Options options;
  add_options(app, options);
  try {
    bench::parse(app, argc, argv);
  } catch (const CLI::ParseError &error) {
    return app.exit(error) == 0 ? bench::exit_ok : bench::exit_usage;
  }
  keep_memory();
  try {
    if (options.headless)
      run_headless(options);
    else
      run_window(options);
    return bench::exit_ok;
  } catch (const bench::Error &error) {
    std::fprintf(stderr, "pbf-view: %s\n", bench::one_line(bench::sentence_of(error)).c_str());
    return error.code;
  } catch (const std::exception &error) {
    std::fprintf(stderr, "pbf-view: %s\n", bench::one_line(bench::sentence_of(error)).c_str());
    return bench::exit_failure;
  }
}
