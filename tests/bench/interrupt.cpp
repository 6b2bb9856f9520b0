/* Ctrl-C: what there is gets written, whole lines, and the exit code says so. */
#include <sys/ioctl.h>
#include <sys/stat.h>

#include <chrono>
#include <thread>

#include "child.h"
#include "program.h"

namespace {

void an_interrupted_run_leaves_whole_files(void **) {
  const std::string folder = work_folder("run");
  skip_unless_available(folder, "reference");
  const pid_t child = start_program(
      folder, {"run", "--scene", "dam-break-2d", "--particles", "200", "--backend", "reference",
               "--steps", "4000000000", "--csv", "t.csv", "--dump", "d"});
  const bool began = wait_for_bytes(folder + "/t.csv", 4096);
  assert_int_equal(exit_code_after_interrupt(child), 130);
  assert_true(began);
  const std::string csv = read_text(folder + "/t.csv");
  assert_int_equal(csv.back(), '\n');
  const std::string last = csv.substr(csv.rfind('\n', csv.size() - 2) + 1);
  assert_int_equal(std::count(last.begin(), last.end(), ','), 11);
  char name[64];
  std::snprintf(name, sizeof name, "/d/positions_%06d.npy", std::stoi(last));
  assert_true(std::filesystem::exists(folder + name));
}

// Of the whole rows that have been written when the pipe is full.
void an_interrupt_while_a_reader_is_slow_tears_no_row(void **) {
  const std::string folder = work_folder("slow");
  skip_unless_available(folder, "reference");
  assert_int_equal(mkfifo((folder + "/t.csv").c_str(), 0600), 0);
  const int reader = open((folder + "/t.csv").c_str(), O_RDONLY | O_NONBLOCK);
  assert_true(reader >= 0 && fcntl(reader, F_SETFL, 0) == 0);
  const pid_t child =
      start_program(folder, {"run", "--scene", "dam-break-2d", "--particles", "50", "--backend",
                             "reference", "--steps", "4000000000", "--csv", "t.csv"});
  int there = 0, before = -1;
  for (int k = 0; k < 600 && (there == 0 || there != before); ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    before = there;
    assert_int_equal(ioctl(reader, FIONREAD, &there), 0);
  }
  assert_int_equal(kill(child, SIGINT), 0);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  std::string csv;
  char chunk[4096];
  for (ssize_t count; (count = read(reader, chunk, sizeof chunk)) > 0;)
    csv.append(chunk, static_cast<size_t>(count));
  close(reader);
  int status = 0;
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFEXITED(status));
  assert_int_equal(WEXITSTATUS(status), 130);
  assert_int_equal(csv.back(), '\n');
}

void an_interrupted_record_can_be_replayed(void **) {
  const std::string folder = work_folder("record");
  skip_unless_available(folder, "reference");
  const pid_t child =
      start_program(folder, {"record", "--scene", "dam-break-2d", "--particles", "200", "--backend",
                             "reference", "--steps", "4000000000", "--to", "r.rec"});
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  assert_int_equal(exit_code_after_interrupt(child), 130);
  const Outcome replay = run_program(folder, "replay r.rec");
  assert_int_equal(replay.exit_code, 0);
  expect_contains(replay.out, "the same: ");
}

// The terminal is closed: nothing is left beside the recording, unless nohup has the signal
// ignored.
void the_end_of_a_terminal_is_an_interrupt(void **) {
  const std::string folder = work_folder("hangup");
  skip_unless_available(folder, "reference");
  const std::vector<std::string> record = {"record",     "--scene",   "dam-break-2d", "--particles",
                                           "200",        "--backend", "reference",    "--steps",
                                           "4000000000", "--to",      "r.rec"};
  for (const bool ignored : {false, true}) {
    std::signal(SIGHUP, ignored ? SIG_IGN : SIG_DFL);
    const pid_t child = start_program(folder, record);
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    assert_int_equal(kill(child, SIGHUP), 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(ignored ? 300 : 0));
    int status = 0;
    if (ignored) {
      assert_int_equal(waitpid(child, &status, WNOHANG), 0);
      assert_int_equal(exit_code_after_interrupt(child), 130);
    } else {
      assert_int_equal(waitpid(child, &status, 0), child);
      assert_true(WIFEXITED(status));
      assert_int_equal(WEXITSTATUS(status), 130);
    }
    for (const auto &entry : std::filesystem::directory_iterator(folder))
      assert_true(entry.path().extension() != ".new");
    expect_contains(run_program(folder, "replay r.rec").out, "the same: ");
  }
  std::signal(SIGHUP, SIG_DFL);
}

void an_interrupted_speedup_still_prints_and_writes(void **) {
  const std::string folder = work_folder("speedup");
  skip_unless_available(folder, "reference");
  const pid_t child = start_program(
      folder, {"speedup", "--scene", "dam-break-2d", "--particles", "200", "--backends",
               "naive,nonesuch", "--steps", "4000000000", "--json", "s.json"});
  const bool began = wait_for_bytes(folder + "/out.txt", 10);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  assert_int_equal(exit_code_after_interrupt(child), 130);
  assert_true(began);
  expect_contains(read_text(folder + "/out.txt"), "| nonesuch ");
  expect_contains(read_text(folder + "/s.json"), "\"error_message\": \"interrupted\"");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(an_interrupted_run_leaves_whole_files),
      cmocka_unit_test(an_interrupt_while_a_reader_is_slow_tears_no_row),
      cmocka_unit_test(an_interrupted_record_can_be_replayed),
      cmocka_unit_test(the_end_of_a_terminal_is_an_interrupt),
      cmocka_unit_test(an_interrupted_speedup_still_prints_and_writes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
