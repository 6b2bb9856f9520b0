/* Rounds of random calls, each in a process of its own that this one watches: README.md. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "record.h"
#include "round.h"
#include "table.h"

enum { MOST_FINDINGS = 16 };

/* Seconds without a call: a round that hangs. Where others go first it may wait for a core as long:
 * of 2 cores with 13 threads that were ready, one round at nice 10 took nine times what it takes.
 */
static double time_limit(void) {
  const double usual = TEST_INSTRUMENTED ? 900 : 180;
  return getpriority(PRIO_PROCESS, 0) > 0 ? 10 * usual : usual;
}

typedef struct finding {
  uint64_t seed;
  char text[FINDING_SIZE], calls[2000];
} finding;

typedef struct options {
  uint64_t seed, rounds;
  double seconds;
  int actor;
  const char *calls, *json;
} options;

static finding findings[MOST_FINDINGS];
static int finding_count;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- One round --------------------------------------------------------------------------------
 */

/* The library prints nothing, nor do its runtimes. */
static void begin_watched(int output, uint64_t seed, int only) {
  setpgid(0, 0);
  dup2(output, 1);
  dup2(output, 2);
  close(output);
  round_run(seed, only);
}

static uint64_t calls_begun(void) {
  uint64_t sum = 0;
  for (int k = 0; k < MOST_ACTORS; ++k) sum += soak_record->traces[k].come;
  return sum;
}

/* 1 once it has ended; 0 where none of its threads has begun a call for so many seconds. How long
 * all of them take is the machine's. */
static int wait_for(pid_t child, int *status, double seconds) {
  const struct timespec nap = {0, 2000000};
  double end = now() + seconds;
  for (uint64_t come = 0;;) {
    const pid_t ended = waitpid(child, status, WNOHANG);
    const uint64_t calls = calls_begun();
    if (ended == child) return 1;
    if (calls != come) end = now() + seconds;
    if (now() > end) return 0;
    come = calls;
    nanosleep(&nap, NULL);
  }
}

static void say_where(char *text, size_t room) {
  size_t at = strlen(text);
  for (int k = 0; k < MOST_ACTORS && at + 80 < room; ++k) {
    const trace *t = &soak_record->traces[k];
    if (t->come == 0) continue;
    const unsigned row = t->entry[t->come - 1];
    at += (size_t)snprintf(text + at, room - at, "; actor %d in its call %u, %s", k,
                           (unsigned)t->come - 1, row ? table[row - 1].name : "?");
  }
}

static void take_output(FILE *output, char *text, size_t room) {
  char printed[600];
  rewind(output);
  const size_t size = fread(printed, 1, sizeof printed - 1, output);
  printed[size] = 0;
  if (size == 0) return;
  const size_t at = strlen(text);
  snprintf(text + at, room - at, "%sprinted: %s", at ? "; " : "", printed);
}

/* 1 for a finding, whose words go to `text`. */
static int run_round(uint64_t seed, int only, char *text, size_t room) {
  FILE *output = tmpfile();
  int status = 0;
  if (!output) return 0;
  memset(soak_record->traces, 0, sizeof soak_record->traces);
  soak_record->found = 0;
  text[0] = 0;
  fflush(NULL);
  const pid_t child = fork();
  if (child == 0) begin_watched(fileno(output), seed, only);
  const int ended = child > 0 && wait_for(child, &status, time_limit());
  if (!ended) {
    kill(-child, SIGKILL);
    waitpid(child, &status, 0);
    snprintf(text, room, "hangs");
    say_where(text, room);
  } else if (WIFSIGNALED(status)) {
    snprintf(text, room, "signal %d ends the process", WTERMSIG(status));
    say_where(text, room);
  } else if (WEXITSTATUS(status) != 0) {
    if (soak_record->found)
      snprintf(text, room, "actor %u, call %u: %s", soak_record->found_actor,
               soak_record->found_actor < MOST_ACTORS
                   ? (unsigned)soak_record->traces[soak_record->found_actor].come - 1
                   : 0,
               soak_record->finding);
    else
      snprintf(text, room, "the process exits with %d", WEXITSTATUS(status));
    if (!soak_record->found) say_where(text, room);
  }
  take_output(output, text, room);
  fclose(output);
  return text[0] != 0;
}

/* ---- Which calls it takes ----------------------------------------------------------------------
 */

/* What a finding says, without where: of two that begin alike one is taken for the other. */
static const char *words_of(const char *text) {
  const char *words = strstr(text, ": ");
  return words ? words + 2 : text;
}

static int still_found(const finding *f, int only) {
  enum { ALIKE = 28 };
  char text[FINDING_SIZE];
  return run_round(f->seed, only, text, sizeof text) &&
         strncmp(words_of(text), words_of(f->text), ALIKE) == 0;
}

/* Leaves out ever smaller parts of an actor's calls, as long as it is found without them. */
static void make_fewer(const finding *f, int only, double end) {
  unsigned char *out = soak_record->left_out[only];
  for (int part = MOST_CALLS / 2; part > 0; part /= 2)
    for (int from = 0; from < MOST_CALLS && now() < end; from += part) {
      unsigned char before[MOST_CALLS];
      memcpy(before, out, sizeof before);
      for (int k = from; k < from + part && k < MOST_CALLS; ++k) out[k] = 1;
      if (memcmp(before, out, sizeof before) == 0) continue;
      if (!still_found(f, only)) memcpy(out, before, sizeof before);
    }
}

static void list_calls(int only, char *text, size_t room) {
  size_t at = 0;
  text[0] = 0;
  const trace *t = &soak_record->traces[only];
  for (uint32_t k = 0; k < t->come && at + 60 < room; ++k)
    if (t->entry[k])
      at += (size_t)snprintf(text + at, room - at, "%s%u %s", at ? ", " : "", k,
                             table[t->entry[k] - 1].name);
}

/* By the actor that has found it, alone if that will do; what hangs is not tried again. */
static void minimize(finding *f, uint32_t number) {
  char text[FINDING_SIZE];
  if (number >= MOST_ACTORS || strncmp(f->text, "hangs", 5) == 0) return;
  if (!still_found(f, (int)number)) return;
  make_fewer(f, (int)number, now() + 60);
  if (run_round(f->seed, (int)number, text, sizeof text)) {
    char calls[sizeof f->calls];
    list_calls((int)number, calls, sizeof calls);
    snprintf(f->calls, sizeof f->calls, "--actor %u: %.1800s", number, calls);
  }
  memset(soak_record->left_out, 0, sizeof soak_record->left_out);
}

static void keep_finding(uint64_t seed, const char *text, int alone) {
  uint32_t number = soak_record->found ? soak_record->found_actor : 0;
  finding *f = &findings[finding_count++];
  f->seed = seed;
  snprintf(f->text, sizeof f->text, "%s", text);
  printf("seed %llu: %s\n", (unsigned long long)seed, text);
  fflush(stdout);
  if (alone == EVERY_ACTOR) minimize(f, number);
  if (f->calls[0]) printf("  seed %llu again: %s\n", (unsigned long long)seed, f->calls);
}

/* ---- Results ------------------------------------------------------------------------------------
 */

static void put_text(FILE *file, const char *text) {
  fputc('"', file);
  for (; *text; ++text) {
    if (*text == '"' || *text == '\\') fputc('\\', file);
    fputc((unsigned char)*text < 0x20 ? ' ' : *text, file);
  }
  fputc('"', file);
}

static void put_counts(FILE *file, const char *name, const char *(*name_of)(uint32_t),
                       atomic_uint_least64_t *counts, uint32_t count) {
  fprintf(file, " \"%s\": {", name);
  for (uint32_t k = 0; k < count; ++k)
    fprintf(file, "%s\n  \"%s\": %llu", k ? "," : "", name_of(k), (unsigned long long)counts[k]);
  fprintf(file, "\n },\n");
}

static const char *function_name(uint32_t k) { return table[k].name; }
static const char *fault_name(uint32_t k) { return fault_names[k]; }

static int write_json(const options *o, double seconds, uint64_t rounds) {
  FILE *file = fopen(o->json, "w");
  if (!file) return 0;
  fprintf(file, "{\n \"first_seed\": %llu,\n \"next_seed\": %llu,\n \"rounds\": %llu,\n",
          (unsigned long long)o->seed, (unsigned long long)(o->seed + rounds),
          (unsigned long long)rounds);
  fprintf(file, " \"seconds\": %.1f,\n \"steps\": %llu,\n \"particles\": %llu,\n", seconds,
          (unsigned long long)soak_record->steps, (unsigned long long)soak_record->particles);
  put_counts(file, "calls", function_name, soak_record->calls, table_size);
  put_counts(file, "faults", fault_name, soak_record->faults, FAULT_COUNT);
  fprintf(file, " \"findings\": [");
  for (int k = 0; k < finding_count; ++k) {
    fprintf(file, "%s\n  {\"seed\": %llu, \"what\": ", k ? "," : "",
            (unsigned long long)findings[k].seed);
    put_text(file, findings[k].text);
    fprintf(file, ", \"calls\": ");
    put_text(file, findings[k].calls);
    fprintf(file, "}");
  }
  fprintf(file, "\n ]\n}\n");
  return fclose(file) == 0;
}

/* ---- The command
 * ---------------------------------------------------------------------------------- */

static int usage(void) {
  fprintf(stderr,
          "soak [--seconds N | --rounds N] [--seed S] [--actor A [--calls I,J,…]] [--json FILE]\n"
          "soak --list   names the functions that it calls\n");
  return 2;
}

static int list(void) {
  for (uint32_t k = 0; k < table_size; ++k)
    if (!strchr(table[k].name, ' ')) puts(table[k].name);
  return 0;
}

static void keep_only(const options *o) {
  if (!o->calls || o->actor < 0 || o->actor >= MOST_ACTORS) return;
  memset(soak_record->left_out[o->actor], 1, MOST_CALLS);
  for (const char *at = o->calls; at && *at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
    const long k = strtol(at, NULL, 10);
    if (k >= 0 && k < MOST_CALLS) soak_record->left_out[o->actor][k] = 0;
  }
}

static int read_options(int argc, char **argv, options *o) {
  for (int i = 1; i + 1 < argc; i += 2) {
    const char *value = argv[i + 1];
    if (strcmp(argv[i], "--seconds") == 0)
      o->seconds = strtod(value, NULL), o->rounds = UINT64_MAX;
    else if (strcmp(argv[i], "--rounds") == 0)
      o->rounds = strtoull(value, NULL, 10);
    else if (strcmp(argv[i], "--seed") == 0)
      o->seed = strtoull(value, NULL, 10);
    else if (strcmp(argv[i], "--actor") == 0)
      o->actor = atoi(value);
    else if (strcmp(argv[i], "--calls") == 0)
      o->calls = value;
    else if (strcmp(argv[i], "--json") == 0)
      o->json = value;
    else
      return 0;
  }
  return argc % 2 == 1;
}

int main(int argc, char **argv) {
  options o = {.seed = 1, .rounds = 1, .seconds = 1e9, .actor = EVERY_ACTOR};
  if (argc == 2 && strcmp(argv[1], "--list") == 0) return list();
  if (!read_options(argc, argv, &o)) return usage();
  soak_record =
      mmap(NULL, sizeof *soak_record, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (soak_record == MAP_FAILED) return 2;
  keep_only(&o);
  const double begin = now();
  uint64_t rounds = 0;
  for (; rounds < o.rounds && now() - begin < o.seconds && finding_count < MOST_FINDINGS;
       ++rounds) {
    char text[FINDING_SIZE];
    if (run_round(o.seed + rounds, o.actor, text, sizeof text))
      keep_finding(o.seed + rounds, text, o.actor);
  }
  uint64_t calls = 0, faults = 0;
  for (uint32_t k = 0; k < table_size; ++k) calls += soak_record->calls[k];
  for (int k = 0; k < FAULT_COUNT; ++k) faults += soak_record->faults[k];
  printf("%llu rounds, %llu calls, %llu faults, %llu steps: %d found\n", (unsigned long long)rounds,
         (unsigned long long)calls, (unsigned long long)faults,
         (unsigned long long)soak_record->steps, finding_count);
  if (o.json && !write_json(&o, now() - begin, rounds)) return 2;
  return finding_count ? 1 : 0;
}
