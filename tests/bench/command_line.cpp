/* Exit codes, files and JSON of pbf-bench. */
#include <nlohmann/json.hpp>
#include <algorithm>
#include <fstream>
#include <vector>

#include "program.h"

namespace {

using nlohmann::json;

const char *const small = "--scene dam-break-2d --particles 200 ";

void wrong_command_lines_exit_with_2(void **) {
  const std::string folder = work_folder("wrong");
  const char *const wrong[][2] = {
      {"", "subcommand"},
      {"dance", "subcommand"},
      {"run --scene dam-break-2d", "--backend is required"},
      {"run --backend reference", "--scene is required"},
      {"run --scene dam-break-2d --backend reference --bogus", "--bogus"},
      {"run --scene dam-break-2d --backend reference --steps 0", "\"0\" is not a whole number"},
      {"run --scene dam-break-2d --backend reference --steps 1x", "\"1x\" is not a whole number"},
      {"run --scene dam-break-2d --backend reference --particles -3",
       "\"-3\" is not a whole number"},
      {"run --scene dam-break-2d --backend reference --precision f16", "f16"},
      {"run --scene dam-break-2d --backend reference --every 3", "--dump"},
      {"run --scene dam-brake-2d --backend reference", "did you mean dam-break-2d"},
      {"run --scene dam-break-2d --backend reference --set gravitty=1", "did you mean gravity?"},
      {"run --scene dam-break-2d --backend reference --set spacing=1",
       "PBF_ERROR_INVALID_ARGUMENT"},
      {"stability --set gravitty=1", "did you mean gravity?"},
      {"stability --set damping_compensation", "no \"=\""},
      {"speedup --threads 0", "\"0\" is not a whole number"},
      {"run --scene dam-break-2d --backend reference --finer nan", "nan is not a number of 0.01"},
      {"run --scene dam-break-2d --backend reference --fastest nan", "nan is not a number of at"},
      {"run --scene dam-break-2d --backend reference --fastest inf", "inf is not a number of at"},
      {"run --scene dam-break-2d --backend reference --csv ''", "--csv: its value is empty"},
      {"run --scene dam-break-2d --backend reference --dump ''", "--dump: its value is empty"},
      {"--plugin '' list", "--plugin: its value is empty"},
      {"pareto --patience nan", "nan is not a number above 0"},
      {"pareto --patience 1e300", "1e300 is not a number above 0 and below 1e30"},
      {"speedup --backends serial,serial", "stands twice"},
  };
  for (const auto &[arguments, words] : wrong) {
    const Outcome outcome = run_program(folder, arguments);
    expect_contains(outcome.err, words);
    assert_int_equal(outcome.exit_code, 2);
  }
}

void a_backend_that_is_not_there_exits_with_3(void **) {
  const std::string folder = work_folder("absent");
  const Outcome run = run_program(folder, std::string("run --backend nonesuch ") + small);
  assert_int_equal(run.exit_code, 3);
  expect_contains(run.err, "nonesuch");
  const Outcome speedup = run_program(folder, std::string("speedup --backends nonesuch ") + small);
  assert_int_equal(speedup.exit_code, 3);
  expect_contains(speedup.out, "| nonesuch | ");
  expect_contains(speedup.out, "there is no backend of this name");
}

uint32_t big_endian(const std::string &bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes.at(at + i));
  return value;
}

void pictures_are_drawn_at_the_steps_and_in_the_size_that_were_asked_for(void **) {
  const std::string folder = work_folder("pictures");
  skip_unless_available(folder, "reference");
  const std::string run = std::string("run --backend reference --steps 5 ") + small;
  const Outcome drawn = run_program(folder, run + "--pictures drawn --every 2 --width 120");
  assert_int_equal(drawn.exit_code, 0);
  size_t files = 0;
  for (const auto &entry : std::filesystem::directory_iterator(folder + "/drawn")) {
    (void)entry;
    ++files;
  }
  assert_int_equal(files, 4);
  for (const char *name : {"000000", "000002", "000004", "000005"}) {
    const std::string png = read_text(folder + "/drawn/" + name + ".png");
    assert_true(png.compare(0, 4, "\x89PNG") == 0);
    assert_int_equal(big_endian(png, 16), 120); /* IHDR's width */
    assert_int_equal(big_endian(png, 20) > 20, 1);
  }
  assert_true(read_text(folder + "/drawn/000000.png") != read_text(folder + "/drawn/000005.png"));
  std::ofstream(folder + "/no.state") << "this is not a state";
  const Outcome wrong = run_program(folder, "picture no.state");
  assert_int_equal(wrong.exit_code, 1);
  expect_contains(wrong.err, "saved state");
}

void pictures_of_no_part_are_refused(void **) {
  const std::string folder = work_folder("views");
  skip_unless_available(folder, "reference");
  const std::string run = std::string("run --backend reference --steps 1 ") + small;
  const char *const wrong[][2] = {
      {"nan 0 1 1", "along x the lower corner is not below"},
      {"0 0 1 inf", "along y the lower corner is not below"},
      {"0 1 1 0", "along y the lower corner is not below"},
      {"0 0 0 1 1 1", "6 numbers; it takes 4 in 2D"},
      {"0 0 0.000001 100000", "more than 67108864 pixels"},
      {"-1e300 -1e300 1e300 1.7e308", "more than 67108864 pixels"},
  };
  for (const auto &[view, words] : wrong) {
    const Outcome outcome = run_program(folder, run + "--pictures drawn --view " + view);
    expect_contains(outcome.err, words);
    assert_int_equal(outcome.exit_code, 2);
  }
}

void a_recording_runs_again_and_says_where_another_run_parts(void **) {
  const std::string folder = work_folder("recording");
  skip_unless_available(folder, "reference");
  const Outcome recorded = run_program(
      folder, std::string("record --backend reference --steps 20 --every 2 --at 7:gravity.0=3 --to "
                          "run.record --scene moving-paddle --particles 300"));
  assert_string_equal(recorded.err.c_str(), "");
  assert_int_equal(recorded.exit_code, 0);
  const Outcome again = run_program(folder, "replay run.record");
  expect_contains(again.out, "the same: 10 hashes, up to step 20, with 2 changes on the way");
  assert_int_equal(again.exit_code, 0);

  std::string text = read_text(folder + "/run.record");
  const size_t params = text.find("\nparams 7 ");
  assert_true(params != std::string::npos);
  const size_t next = text.find('\n', params + 1);
  std::ofstream(folder + "/without.record") << text.substr(0, params) + text.substr(next);
  const Outcome parted = run_program(folder, "replay without.record");
  expect_contains(parted.out, "the runs part after step 6, by step 8");
  assert_int_equal(parted.exit_code, 1);

  std::ofstream(folder + "/cut.record") << text.substr(0, text.size() - 5);
  expect_contains(run_program(folder, "replay cut.record").out,
                  "the same: 9 hashes, up to step 18");
  std::ofstream(folder + "/wrong.record") << text.substr(0, text.find('\n') + 1) + "hash 2 zz\n";
  const Outcome wrong = run_program(folder, "replay wrong.record");
  expect_contains(wrong.err, "wrong.record:2");
  assert_int_equal(wrong.exit_code, 2);
  const Outcome at =
      run_program(folder, std::string("record --backend reference --to x --at 7 ") + small);
  expect_contains(at.err, "STEP:KEY=VALUE");
  assert_int_equal(at.exit_code, 2);
}

// Taken for one with bits of all machines, it parts.
void a_recording_with_bits_of_its_machine_has_them_again(void **) {
  const std::string folder = work_folder("recording_of_machine"), end = "-fused)";
  skip_unless_available(folder, "serial");
  const Outcome recorded = run_program(
      folder, std::string("record --backend serial --per-machine --steps 20 --every 2 --to "
                          "run.record --scene moving-paddle --particles 300"));
  assert_string_equal(recorded.err.c_str(), "");
  const Outcome again = run_program(folder, "replay run.record");
  expect_contains(again.out, "the same: 10 hashes, up to step 20");
  assert_int_equal(again.exit_code, 0);

  std::string text = read_text(folder + "/run.record");
  const size_t at = text.find(end + "\n");
  if (at == std::string::npos) return;  // nothing is fused here
  std::ofstream(folder + "/other.record") << text.replace(at, end.size(), ")");
  const Outcome other = run_program(folder, "replay other.record");
  expect_contains(other.out, "the runs part");
  assert_int_equal(other.exit_code, 1);
}

// A paddle of four points that turns back after 5 of 20 steps, under a tap, above a drain, in oil.
const char *const mill =
    R"({"version": 1, "description": "a", "purpose": "b", "dimension": 2, "steps": 20, "params": {},
  "phases": [{}, {"rest_density": 0.5}],
  "blocks": [{"shape": "box", "min": [0, 0], "max": [1, 0.3], "phase": 1}],
  "shapes": {"other": {"from": "points", "points": [[0, 0], [0.1, 0], [0, 0.1]], "cell": 0.02},
    "paddle": {"from": "mesh", "vertices": [[-0.2, -0.05], [0.2, -0.05], [0.2, 0.05], [-0.2, 0.05]],
               "faces": [[0, 1], [1, 2], [2, 3], [3, 0]], "cell": 0.02}},
  "colliders": [{"shape": "shape", "geometry": "paddle", "position": [0.5, 0.3],
    "motion": [{"duration": 0.041666667, "angular_velocity": [0, 0, 3]},
               {"duration": 0.2, "angular_velocity": [0, 0, -3]}]}],
  "emitters": [{"shape": "disc", "position": [0.5, 0.8], "radius": 0.1}],
  "drains": [{"shape": "sphere", "position": [0, 0], "radius": 0.2}]})";

void a_recording_has_the_shapes_of_its_scene(void **) {
  const std::string folder = work_folder("recorded_shapes");
  skip_unless_available(folder, "reference");
  write_text(folder + "/mill.json", mill);
  const Outcome recorded =
      run_program(folder, "record --backend reference --to mill.record --scene mill.json");
  assert_string_equal(recorded.err.c_str(), "");
  expect_contains(run_program(folder, "replay mill.record").out,
                  "the same: 20 hashes, up to step 20, with 1 changes on the way");
  // Without the paddle its state can't be, and a collider's number is that of no shape.
  const std::string text = read_text(folder + "/mill.record");
  const size_t other = text.find("\nshape "), paddle = text.find("\nshape ", other + 1);
  write_text(folder + "/none.record",
             text.substr(0, paddle) + text.substr(text.find('\n', paddle + 1)));
  const Outcome none = run_program(folder, "replay none.record");
  expect_contains(none.err, "shape");
  assert_true(none.exit_code == 1 || none.exit_code == 2);
  write_text(folder + "/wrong.record",
             text.substr(0, other) + "\nshape {\"from\": 3}" + text.substr(paddle));
  expect_contains(run_program(folder, "replay wrong.record").err, "wrong.record:4");
}

// A device without an end, with its size or without, a folder, a link to itself, names of odd
// letters: each is told by its name, and a pipe is read as a file.
void what_is_no_file_is_told(void **) {
  const std::string folder = work_folder("no_files");
  std::filesystem::create_symlink("loop", folder + "/loop");
  write_text(folder + "/empty", "");
  for (const char *command : {"replay ", "picture ", "run --backend serial --scene "}) {
    for (const std::string name :
         {"/dev/zero", "/dev/null", "/dev/random", "/proc", "/proc/self/pagemap", "./loop",
          "./empty", "'./of\ntwo lines'", "'./\xc4\xb0\xff'"}) {
      const Outcome it = run_program(folder, command + name);
      std::string told = name[0] == '\'' ? name.substr(1, name.size() - 2) : name;
      std::replace(told.begin(), told.end(), '\n', '?'); /* a sentence is one line */
      expect_contains(it.err, told);
      assert_true(it.exit_code == 1 || it.exit_code == 2);
    }
  }
  write_text(folder + "/mill.json", mill);
  const std::string piped =
      "record --backend reference --to mill.record --scene /dev/stdin <mill.json";
  assert_int_equal(run_program(folder, piped).exit_code, 0);
  expect_contains(run_program(folder, "replay /dev/stdin <mill.record").out, "the same: 20");
}

void output_that_is_lost_exits_with_1(void **) {
  const std::string folder = work_folder("lost"), errors = folder + "/err.txt";
  const std::string program = "'" PBF_TEST_PROGRAM "' ", told = " 2>'" + errors + "'";
  const int full = std::system((program + "list >/dev/full" + told).c_str());
  assert_int_equal(WEXITSTATUS(full), 1);
  expect_contains(read_text(errors), "the standard output can't be written: No space left");
  const int closed = std::system((program + "list >&-" + told).c_str());
  assert_int_equal(WEXITSTATUS(closed), 1);
  expect_contains(read_text(errors), "the standard output can't be written: Bad file");
  assert_int_equal(WEXITSTATUS(std::system((program + "list >/dev/null 2>&-").c_str())), 0);
  const int gone =
      std::system(("( " + program + "list; echo $? >'" + errors + "' ) | true").c_str());
  assert_int_equal(WEXITSTATUS(gone), 0);
  const std::string code = read_text(errors);
  assert_true(code == "1\n" || code == "0\n"); /* 141 would be a signal */
}

void a_file_that_cant_be_written_exits_with_1(void **) {
  const std::string folder = work_folder("unwritable");
  skip_unless_available(folder, "reference");
  const std::string run = std::string("run --backend reference --steps 1 ") + small;
  for (const char *where : {"--csv /nowhere/at/all.csv", "--dump /dev/null/here"}) {
    assert_int_equal(run_program(folder, run + where).exit_code, 1);
  }
}

// A file can't grow beyond half a KB here, as on a full disk: no torn one stands under its name.
void a_full_disk_leaves_what_was_there(void **) {
  const std::string folder = work_folder("full");
  skip_unless_available(folder, "reference");
  const std::string run = std::string("--backend reference --steps 9 ") + small;
  assert_int_equal(run_program(folder, "record " + run + "--to r.rec").exit_code, 0);
  std::filesystem::create_directories(folder + "/p");
  const std::vector<std::pair<std::string, std::string>> ways = {
      {"record " + run + "--to kept.rec", "kept.rec"},
      {"run " + run + "--pictures p", "p/000000.png"},
      {"run " + run + "--dump p", "p/positions_000000.npy"}};
  for (const auto &[arguments, file] : ways) {
    write_text(folder + "/" + file, "kept");
    const std::string command = "cd '" + folder + "' && ulimit -f 1 && '" PBF_TEST_PROGRAM "' " +
                                arguments + " >/dev/null 2>err.txt";
    const int status = std::system(command.c_str());
    assert_int_equal(WEXITSTATUS(status), 1);
    expect_contains(read_text(folder + "/err.txt"), " can't be written: File too large");
    assert_string_equal(read_text(folder + "/" + file).c_str(), "kept");
  }
  for (const auto &entry : std::filesystem::recursive_directory_iterator(folder))
    assert_true(entry.path().extension() != ".new");
}

// It may be read while it grows: its rows are whole.
void a_full_disk_leaves_whole_rows(void **) {
  const std::string folder = work_folder("rows");
  skip_unless_available(folder, "reference");
  const std::string command = "cd '" + folder +
                              "' && ulimit -f 1 && '" PBF_TEST_PROGRAM
                              "' run --backend reference --steps 99 --csv t.csv " +
                              small + " >/dev/null 2>err.txt";
  assert_int_equal(WEXITSTATUS(std::system(command.c_str())), 1);
  expect_contains(read_text(folder + "/err.txt"), "t.csv can't be written: File too large");
  const std::string csv = read_text(folder + "/t.csv");
  assert_true(csv.size() > 200 && csv.back() == '\n');
}

// Through links, in place of pipes and devices, and in a folder where nothing can be made.
void a_file_is_replaced_where_it_is(void **) {
  const std::string folder = work_folder("replaced"),
                    record = std::string("record --backend reference --steps 2 ") + small + "--to ";
  skip_unless_available(folder, "reference");
  std::filesystem::create_directories(folder + "/there");
  std::filesystem::create_symlink("there/to.rec", folder + "/link.rec");
  write_text(folder + "/there/to.rec", "old");
  std::filesystem::permissions(folder + "/there/to.rec", std::filesystem::perms(0640));
  assert_int_equal(run_program(folder, record + "link.rec").exit_code, 0);
  assert_true(std::filesystem::is_symlink(folder + "/link.rec"));
  assert_true(std::filesystem::status(folder + "/there/to.rec").permissions() ==
              std::filesystem::perms(0640));
  expect_contains(run_program(folder, "replay there/to.rec").out, "the same: 2");
  expect_contains(run_program(folder, record + "/dev/stdout").out, "\nhash 2 ");
  assert_int_equal(run_program(folder, record + "/dev/full").exit_code, 1);
  expect_contains(run_program(folder, record + "there").err,
                  "there can't be written: Is a directory");
  assert_true(std::filesystem::is_directory(folder + "/there"));
}

void help_tells_the_exit_codes(void **) {
  const Outcome help = run_program(work_folder("help"), "--help");
  assert_int_equal(help.exit_code, 0);
  expect_contains(help.out, "Exit codes: 0 done; 1 failed");
  expect_contains(help.out, "speedup");
}

void list_shows_scenes_and_backends(void **) {
  const Outcome list = run_program(work_folder("list"), "list");
  assert_int_equal(list.exit_code, 0);
  expect_contains(list.out, "| report-30k ");
  expect_contains(list.out, "| reference ");
}

std::string npy_shape(const std::string &path) {
  const std::string bytes = read_text(path);
  const size_t start = bytes.find("'shape': ") + 9;
  return bytes.substr(start, bytes.find(')', start) + 1 - start);
}

void a_run_writes_its_trace_and_dumps(void **) {
  const std::string folder = work_folder("run");
  skip_unless_available(folder, "reference");
  const Outcome run = run_program(
      folder,
      "run --scene dam-break-2d --backend reference --steps 7 --csv t.csv --dump d --every 3");
  assert_int_equal(run.exit_code, 0);
  assert_string_equal(run.err.c_str(), "");
  std::istringstream csv(read_text(folder + "/t.csv"));
  std::string line;
  std::getline(csv, line);
  assert_string_equal(line.c_str(),
                      "step,time,com_x,com_y,com_z,kinetic_energy,max_x,max_y,max_z,"
                      "density_error_mean,density_error_max,iterations");
  int rows = 0;
  while (std::getline(csv, line)) {
    ++rows;
    assert_int_equal(line.rfind(std::to_string(rows) + ",", 0), 0);
  }
  assert_int_equal(rows, 7);
  for (const char *step : {"000000", "000003", "000006", "000007"}) {
    for (const char *field : {"positions_", "velocities_"}) {
      const std::string file = folder + "/d/" + field + step + ".npy";
      assert_string_equal(npy_shape(file).c_str(), "(5000, 2)");
    }
  }
  assert_false(std::filesystem::exists(folder + "/d/positions_000001.npy"));
}

// What is not a frame stays.
void a_dump_takes_the_place_of_another(void **) {
  const std::string folder = work_folder("again");
  skip_unless_available(folder, "reference");
  const std::string command = std::string("run --backend reference --dump d ") + small;
  assert_int_equal(run_program(folder, command + " --steps 7 --every 3").exit_code, 0);
  std::ofstream(folder + "/d/positions_mine.npy") << "kept";
  assert_int_equal(run_program(folder, command + " --steps 5").exit_code, 0);
  for (const char *field : {"positions_", "velocities_", "pressures_"})
    for (const char *step : {"000003", "000006", "000007"})
      assert_false(std::filesystem::exists(folder + "/d/" + field + step + ".npy"));
  assert_true(std::filesystem::exists(folder + "/d/positions_000005.npy"));
  assert_true(std::filesystem::exists(folder + "/d/positions_mine.npy"));
}

void a_trace_to_standard_output_is_alone_there(void **) {
  const std::string folder = work_folder("stdout");
  skip_unless_available(folder, "reference");
  const Outcome run =
      run_program(folder, std::string("run --backend reference --steps 2 --csv - ") + small);
  assert_int_equal(run.exit_code, 0);
  assert_int_equal(run.out.rfind("step,time,", 0), 0);
  assert_int_equal(std::count(run.out.begin(), run.out.end(), '\n'), 3);
  expect_contains(run.err, "particle-iterations/s");
}

// Steps one by one, many a call, and with dumps between: the same state.
void batches_do_not_change_the_result(void **) {
  const std::string folder = work_folder("batches");
  skip_unless_available(folder, "reference");
  std::vector<std::string> states;
  for (const char *how : {"--csv t.csv", "--steps-per-call 40", "", "--dump d --every 7"}) {
    const Outcome run =
        run_program(folder, std::string("run --backend reference --steps 40 ") + small + how);
    const size_t at = run.out.find("state ");
    assert_true(at != std::string::npos);
    states.push_back(run.out.substr(at, 22));
  }
  for (const std::string &state : states) assert_string_equal(state.c_str(), states[0].c_str());
}

const json &entry(const json &document, const std::string &name) {
  for (const json &benchmark : document.at("benchmarks")) {
    if (benchmark.at("name") == name) return benchmark;
  }
  fail_msg("no entry %s", name.c_str());
  abort();
}

void speedup_writes_google_benchmarks_json(void **) {
  const std::string folder = work_folder("speedup");
  skip_unless_available(folder, "reference");
  const Outcome speedup =
      run_program(folder,
                  "speedup --scene dam-break-2d --steps 3 --backends naive,reference,nonesuch "
                  "--repetitions 2 --json s.json --html deep/er/page.html");
  assert_int_equal(speedup.exit_code, 0);
  expect_contains(speedup.out, "| naive ");
  const json document = json::parse(read_text(folder + "/s.json"));
  assert_int_equal(document.at("benchmarks").size(), 3);
  for (const char *key : {"commit", "cpu_model", "compiler", "build_naive", "device_naive"}) {
    assert_true(document.at("context").contains(key));
  }
  assert_string_equal(document.at("context").at("executable").get<std::string>().c_str(),
                      "pbf-bench");
  const json &row = entry(document, "dam-break-2d/reference/threads:1");
  const double ms = row.at("real_time");
  assert_true(ms > 0);
  assert_string_equal(row.at("time_unit").get<std::string>().c_str(), "ms");
  assert_float_equal(row.at("ms_per_step").get<double>(), ms / 3, 1e-9 * ms);
  const double iterations = 4 * 5000.0;
  assert_float_equal(row.at("particle_iterations_per_second").get<double>(),
                     iterations * 3 / (ms / 1e3), 1e-6 * iterations * 3 / (ms / 1e3));
  assert_true(row.contains("density_error_mean"));
  const json &naive = entry(document, "dam-break-2d/naive/threads:1");
  assert_float_equal(naive.at("speedup_vs_naive").get<double>(), 1, 0);
  assert_float_equal(row.at("speedup_vs_naive").get<double>(),
                     naive.at("real_time").get<double>() / ms, 1e-9);
  const json &absent = entry(document, "dam-break-2d/nonesuch/threads:1");
  assert_true(absent.at("error_occurred").get<bool>());
  expect_contains(absent.at("error_message"), "no backend of this name");
}

void backends_with_threads_take_part_with_each_number(void **) {
  const std::string folder = work_folder("speedup_threads");
  skip_unless_available(folder, "threads");
  const Outcome speedup =
      run_program(folder,
                  "speedup --scene dam-break-2d --steps 2 --backends serial,threads --threads 1,2 "
                  "--repetitions 1 --json s.json");
  assert_int_equal(speedup.exit_code, 0);
  const json document = json::parse(read_text(folder + "/s.json"));
  assert_int_equal(document.at("benchmarks").size(), 3);
  entry(document, "dam-break-2d/threads/threads:1");
  entry(document, "dam-break-2d/threads/threads:2");
}

void the_page_needs_nothing_beside_it(void **) {
  const std::string folder = work_folder("page");
  skip_unless_available(folder, "reference");
  run_program(folder,
              std::string("speedup --steps 2 --backends naive --html deep/page.html ") + small);
  const std::string page = read_text(folder + "/deep/page.html");
  expect_contains(page, "data:image/png;base64,iVBORw0KGgo");
  expect_contains(page, "naive, 1 thread");
  expect_contains(page, "Commit");
  assert_true(page.find("{{") == std::string::npos);
  assert_true(page.find("http://") == std::string::npos);
  assert_true(page.find("https://") == std::string::npos);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(wrong_command_lines_exit_with_2),
      cmocka_unit_test(a_backend_that_is_not_there_exits_with_3),
      cmocka_unit_test(help_tells_the_exit_codes),
      cmocka_unit_test(list_shows_scenes_and_backends),
      cmocka_unit_test(output_that_is_lost_exits_with_1),
      cmocka_unit_test(a_file_that_cant_be_written_exits_with_1),
      cmocka_unit_test(a_full_disk_leaves_what_was_there),
      cmocka_unit_test(a_full_disk_leaves_whole_rows),
      cmocka_unit_test(a_file_is_replaced_where_it_is),
      cmocka_unit_test(pictures_are_drawn_at_the_steps_and_in_the_size_that_were_asked_for),
      cmocka_unit_test(pictures_of_no_part_are_refused),
      cmocka_unit_test(a_recording_runs_again_and_says_where_another_run_parts),
      cmocka_unit_test(a_recording_with_bits_of_its_machine_has_them_again),
      cmocka_unit_test(a_recording_has_the_shapes_of_its_scene),
      cmocka_unit_test(a_run_writes_its_trace_and_dumps),
      cmocka_unit_test(a_dump_takes_the_place_of_another),
      cmocka_unit_test(a_trace_to_standard_output_is_alone_there),
      cmocka_unit_test(batches_do_not_change_the_result),
      cmocka_unit_test(speedup_writes_google_benchmarks_json),
      cmocka_unit_test(backends_with_threads_take_part_with_each_number),
      cmocka_unit_test(what_is_no_file_is_told),
      cmocka_unit_test(the_page_needs_nothing_beside_it),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
