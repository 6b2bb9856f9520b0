/* mpi_misuse: what pbf_mpi_create is given wrongly, by all ranks or by the last one alone, and
 * calls that come too late. Prints "good" from rank 0, or what is wrong, for the test
 * ranks.mpi.misuse.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <pbf/mpi.h>

static int rank, size;
static int failures;

static void expect(int holds, const char *what, const char *sentence) {
  if (holds) return;
  printf("rank %d of %d: %s: \"%s\"\n", rank, size, what, sentence);
  fflush(stdout);
  ++failures;
}

typedef struct given {
  pbf_mpi_options options, *options_given;
  pbf_desc desc, *desc_given;
  pbf_params params;
  pbf_solver **solver;
} given;

static given right(pbf_solver **solver) {
  given g = {.solver = solver};
  pbf_mpi_options_init(&g.options, sizeof g.options);
  pbf_desc_init(&g.desc, sizeof g.desc);
  pbf_params_init(&g.params, sizeof g.params);
  g.desc.capacity = 100;
  return g;
}

static pbf_status create(MPI_Comm comm, const given *g) {
  return pbf_mpi_create(comm, g->options_given, g->desc_given, &g->params, g->solver);
}

static void expect_refused(MPI_Comm comm, const given *g, pbf_status status, const char *words) {
  const double begin = MPI_Wtime();
  expect(create(comm, g) == status && strstr(pbf_mpi_last_error(), words), words,
         pbf_mpi_last_error());
  expect(MPI_Wtime() - begin < 20, "it is waited for", words); /* a third of the timeout */
}

/* ---- Of one rank alone --------------------------------------------------------------------- */

enum { TIMEOUT, DESC, SOLVER, OPTIONS_SIZE, RESERVED, BACKEND, CAPACITY, STEP, MISTAKES };

static const char *mistake(int which, given *g) {
  switch (which) {
    case TIMEOUT:
      return g->options.timeout = -NAN, "options->timeout is NaN; it must be above 0";
    case DESC:
      return g->desc_given = NULL, "desc is null";
    case SOLVER:
      return g->solver = NULL, "solver is null";
    case OPTIONS_SIZE:
      return g->options.struct_size = 7, "pbf_mpi_options.struct_size is 7";
    case RESERVED:
      return g->options.reserved = 5, "options->reserved is 5";
    case BACKEND:
      return g->desc.backend = "reference", "\"reference\" does not work on ranks";
    case CAPACITY:
      return g->desc.capacity = 0, "desc.capacity is 0";
    default:
      return g->params.time_step = NAN, "params.time_step is NaN";
  }
}

/* All are told, and at once. */
static void mistakes_of_one(void) {
  for (int which = 0; which < MISTAKES; ++which) {
    static const pbf_status statuses[MISTAKES] = {
        [OPTIONS_SIZE] = PBF_ERROR_STRUCT_SIZE, [BACKEND] = PBF_ERROR_UNSUPPORTED};
    char words[200];
    pbf_solver *s = NULL;
    given g = right(&s), wrong = right(&s);
    wrong.options_given = &wrong.options;
    wrong.desc_given = &wrong.desc;
    const char *what = mistake(which, &wrong);
    g.options_given = &g.options;
    g.desc_given = &g.desc;
    snprintf(words, sizeof words, "rank %d of %d: ", size - 1, size);
    const pbf_status status = statuses[which] ? statuses[which] : PBF_ERROR_INVALID_ARGUMENT;
    const given *mine = rank == size - 1 ? &wrong : &g;
    expect_refused(MPI_COMM_WORLD, mine, status, words);
    expect(strstr(pbf_mpi_last_error(), what) != NULL, what, pbf_mpi_last_error());
    expect(s == NULL, "a solver was given", what);
  }
}

/* ---- Communicators ------------------------------------------------------------------------- */

static void no_communicator(void) {
  pbf_solver *s = NULL;
  given g = right(&s);
  MPI_Comm some, half, both;
  g.desc_given = &g.desc;
  expect_refused(MPI_COMM_NULL, &g, PBF_ERROR_INVALID_ARGUMENT, "comm is MPI_COMM_NULL");
  MPI_Comm_split(MPI_COMM_WORLD, rank == 0 ? MPI_UNDEFINED : 1, 0, &some);
  if (rank == 0) {
    expect_refused(some, &g, PBF_ERROR_INVALID_ARGUMENT, "comm is MPI_COMM_NULL");
  } else {
    expect(create(some, &g) == PBF_OK, "the others of a split", pbf_mpi_last_error());
    pbf_destroy(s);
    MPI_Comm_free(&some);
  }
  MPI_Comm_split(MPI_COMM_WORLD, rank % 2, 0, &half);
  MPI_Intercomm_create(half, 0, MPI_COMM_WORLD, 1 - rank % 2, 7, &both);
  expect_refused(both, &g, PBF_ERROR_INVALID_ARGUMENT, "comm is between two groups");
  MPI_Comm_free(&both);
  MPI_Comm_free(&half);
}

static int refuse_copy(MPI_Comm comm, int key, void *extra, void *in, void *out, int *copied) {
  (void)comm, (void)key, (void)extra, (void)in, (void)out;
  *copied = 0;
  return MPI_ERR_OTHER;
}

/* It has what can't be copied, and by default an error of it ends the program. */
static void no_copy(void) {
  pbf_solver *s = NULL;
  given g = right(&s);
  MPI_Comm comm;
  MPI_Errhandler handler;
  int key;
  g.desc_given = &g.desc;
  MPI_Comm_dup(MPI_COMM_SELF, &comm);
  MPI_Comm_create_keyval(refuse_copy, MPI_COMM_NULL_DELETE_FN, &key, NULL);
  MPI_Comm_set_attr(comm, key, &key);
  expect_refused(comm, &g, PBF_ERROR_UNAVAILABLE, "MPI_Comm_idup failed");
  MPI_Comm_get_errhandler(comm, &handler);
  expect(handler == MPI_ERRORS_ARE_FATAL, "its handler of errors", "is another one");
  MPI_Errhandler_free(&handler);
  MPI_Comm_free_keyval(&key);
}

/* ---- Structs of a newer caller ------------------------------------------------------------- */

typedef struct larger {
  union {
    pbf_desc desc;
    pbf_mpi_options options;
  } of;
  char more[64];
} larger;

static void newer_structs(void) {
  pbf_solver *s = NULL;
  given g = right(&s);
  larger desc, options;
  memset(&desc, 0, sizeof desc);
  memset(&options, 0, sizeof options);
  desc.of.desc = g.desc;
  desc.of.desc.struct_size = sizeof desc;
  pbf_mpi_options_init(&options.of.options, sizeof options);
  g.desc_given = &desc.of.desc;
  g.options_given = &options.of.options;
  expect(create(MPI_COMM_WORLD, &g) == PBF_OK, "larger structs", pbf_mpi_last_error());
  pbf_destroy(s);
  options.more[20] = 1;
  expect_refused(MPI_COMM_WORLD, &g, PBF_ERROR_STRUCT_SIZE, "of a pbf_mpi_options of");
  options.more[20] = 0;
  desc.more[20] = 1;
  expect_refused(MPI_COMM_WORLD, &g, PBF_ERROR_STRUCT_SIZE, "of a pbf_desc of");
}

/* ---- Too late ------------------------------------------------------------------------------ */

static void after_the_end(pbf_solver *s) {
  pbf_solver *other = NULL;
  given g = right(&other);
  g.desc_given = &g.desc;
  const pbf_status status = pbf_step(s, 1);
  expect(status == PBF_ERROR_UNAVAILABLE && strstr(pbf_last_error(), "MPI has ended"),
         "a step after MPI_Finalize", pbf_last_error());
  expect(pbf_step(s, 1) == PBF_ERROR_STATE, "another one", pbf_last_error());
  pbf_destroy(s);
  expect(create(MPI_COMM_WORLD, &g) == PBF_ERROR_STATE, "a solver after it", pbf_mpi_last_error());
}

int main(int count, char **words) {
  const float x[3] = {0.5f, 0.5f, 0.5f};
  pbf_solver *s = NULL;
  given g = right(&s);
  g.desc_given = &g.desc;
  MPI_Init(&count, &words);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  mistakes_of_one();
  no_communicator();
  no_copy();
  newer_structs();
  expect(create(MPI_COMM_WORLD, &g) == PBF_OK, "after all of it", pbf_mpi_last_error());
  expect(pbf_add_particles(s, 1, x, NULL, NULL) == PBF_OK, "a particle", pbf_last_error());
  expect(pbf_step(s, 1) == PBF_OK, "a step", pbf_last_error());
  MPI_Finalize();
  after_the_end(s);
  if (rank == 0 && failures == 0) printf("good\n");
  return failures != 0;
}
