/* pbf-forces: what the fluid does to solids, against what it must be. Prints a table, and fails
 * where a bar is missed.
 *
 *   pbf-forces [--spacing D] [CASE …]        buoyancy, dam-break, tow; without a name all */
#include <pbf/pbf.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cases.h"

typedef struct named_case {
  const char *name;
  int (*run)(double spacing); /* figures that miss their bars */
  double spacing;             /* its own */
} named_case;

static const named_case cases[] = {
    {"buoyancy", run_buoyancy, 0.025}, {"dam-break", run_dam_break, 0.02}, {"tow", run_tow, 0.025}};

enum { CASES = sizeof cases / sizeof *cases };

static int is_wanted(const char *name, int count, char **names) {
  for (int i = 0; i < count; ++i)
    if (strcmp(names[i], name) == 0) return 1;
  return count == 0;
}

static int is_case(const char *name) {
  for (int k = 0; k < CASES; ++k)
    if (strcmp(cases[k].name, name) == 0) return 1;
  return 0;
}

int main(int argc, char **argv) {
  double spacing = 0;
  int first = 1, missed = 0;
  if (argc > 2 && strcmp(argv[1], "--spacing") == 0) {
    spacing = atof(argv[2]);
    first = 3;
    if (!(spacing > 0)) {
      fprintf(stderr, "pbf-forces: --spacing %s is no length above 0\n", argv[2]);
      return 2;
    }
  }
  for (int i = first; i < argc; ++i)
    if (!is_case(argv[i])) {
      fprintf(stderr, "pbf-forces: %s is no case; buoyancy, dam-break and tow are\n", argv[i]);
      return 2;
    }
  printf("| case | figure | is | must be | error | bar |\n| --- | --- | --: | --: | --: | --- |\n");
  for (int k = 0; k < CASES; ++k)
    if (is_wanted(cases[k].name, argc - first, argv + first))
      missed += cases[k].run(spacing > 0 ? spacing : cases[k].spacing);
  return missed ? 1 : 0;
}
